!> Roughness parameters of profiles and areas (chapter 4 of the thesis; ISO 4287, ISO 25178), about
!> the arithmetic mean.
module roughness
   use errors, only: error_t
   use grid_transform, only: power_of_rows
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: roughness_t, roughness_of, bearing_ratio, height_density, rms_slope, rms_curvature, &
      power_spectrum

   !> Equal parts of a profile over which Rz is averaged.
   integer, parameter :: parts = 5

   !> Height parameters in the unit of the heights. Of an area: Sa, Sq, Sz, Ssk, Sku.
   type :: roughness_t
      !> Mean of |z|.
      real(wp) :: ra = 0.0_wp
      !> Root of the mean of z^2.
      real(wp) :: rq = 0.0_wp
      !> Profile: mean of highest less lowest over five equal parts. Area: highest less lowest.
      real(wp) :: rz = 0.0_wp
      !> Skewness and kurtosis, (4.2), (4.3); 0 for a flat surface.
      real(wp) :: rsk = 0.0_wp, rku = 0.0_wp
   end type roughness_t

contains

   !> Parameters of the heights `z` (nx*ny), a profile if `is_line`. Parts of a profile differ by at
   !> most one node, the longer ones first.
   pure function roughness_of(z, is_line) result(values)
      real(wp), intent(in) :: z(:)
      logical, intent(in) :: is_line
      type(roughness_t) :: values
      real(wp) :: mean
      integer :: first, i, n, nodes

      n = size(z)
      mean = sum(z)/n
      values%ra = sum(abs(z - mean))/n
      values%rq = sqrt(sum((z - mean)**2)/n)
      if (values%rq > 0.0_wp) then
         values%rsk = sum(((z - mean)/values%rq)**3)/n
         values%rku = sum(((z - mean)/values%rq)**4)/n
      end if
      values%rz = maxval(z) - minval(z)
      if (.not. is_line .or. n < parts) return
      values%rz = 0.0_wp
      first = 1
      do i = 1, parts
         nodes = n/parts + merge(1, 0, i <= mod(n, parts))
         values%rz = values%rz + (maxval(z(first:first + nodes - 1)) &
            - minval(z(first:first + nodes - 1)))/parts
         first = first + nodes
      end do
   end function roughness_of

   !> Share of the nodes that are at or above each of `levels`, which rise (Abbott and Firestone,
   !> Mech. Eng. 55, 1933, 569).
   pure function bearing_ratio(z, levels) result(ratio)
      real(wp), intent(in) :: z(:), levels(:)
      real(wp) :: ratio(size(levels))
      integer :: below(0:size(levels)), count, i, k
      real(wp) :: lowest, steps_per_height

      count = size(levels)
      lowest = levels(1)
      steps_per_height = 0.0_wp
      if (levels(count) > lowest) steps_per_height = (count - 1)/(levels(count) - lowest)
      ! below(k): nodes with k levels at or below them; the guess is that of evenly spaced levels.
      below = 0
      do i = 1, size(z)
         k = 1 + int(min(max((z(i) - lowest)*steps_per_height, -1.0_wp), count - 1.0_wp))
         upward: do while (k < count)
            if (z(i) < levels(k + 1)) exit upward
            k = k + 1
         end do upward
         downward: do while (k > 0)
            if (z(i) >= levels(k)) exit downward
            k = k - 1
         end do downward
         below(k) = below(k) + 1
      end do
      ratio = [(real(sum(below(i:)), wp)/size(z), i=1, size(levels))]
   end function bearing_ratio

   !> Share of the nodes between each two neighbouring `edges`, which rise and are evenly spaced,
   !> over their distance.
   pure function height_density(z, edges) result(density)
      real(wp), intent(in) :: z(:), edges(:)
      real(wp) :: density(size(edges) - 1)
      real(wp) :: width
      integer :: i, place

      width = (edges(size(edges)) - edges(1))/(size(edges) - 1)
      density = 0.0_wp
      if (.not. width > 0.0_wp) return
      do i = 1, size(z)
         if (z(i) < edges(1) .or. z(i) > edges(size(edges))) cycle
         place = min(1 + int((z(i) - edges(1))/width), size(density))
         density(place) = density(place) + 1.0_wp/(size(z)*width)
      end do
   end function height_density

   !> Root mean square of the slope of a periodic surface (nx, ny) from differences of neighbours;
   !> of an area of the gradient.
   pure function rms_slope(z, dx, dy) result(slope)
      real(wp), intent(in) :: z(:, :), dx, dy
      real(wp) :: slope

      slope = sum(((cshift(z, 1, 1) - z)/dx)**2)
      if (size(z, 2) > 1) slope = slope + sum(((cshift(z, 1, 2) - z)/dy)**2)
      slope = sqrt(slope/size(z))
   end function rms_slope

   !> Root mean square of the second difference of a periodic surface (nx, ny); of an area of half
   !> the Laplacian.
   pure function rms_curvature(z, dx, dy) result(curvature)
      real(wp), intent(in) :: z(:, :), dx, dy
      real(wp) :: curvature
      real(wp) :: second(size(z, 1), size(z, 2))

      second = (cshift(z, 1, 1) - 2.0_wp*z + cshift(z, -1, 1))/dx**2
      if (size(z, 2) > 1) second = 0.5_wp*(second + (cshift(z, 1, 2) - 2.0_wp*z + cshift(z, -1, &
         2))/dy**2)
      curvature = sqrt(sum(second**2)/size(z))
   end function rms_curvature

   !> Mean square of the heights in harmonic 1 ... nx/2 along x of a periodic surface (nx, ny),
   !> averaged over y: its sum is the variance of the profiles. Fails (internal_error) if FFTW does.
   subroutine power_spectrum(z, power, error)
      real(wp), contiguous, intent(in) :: z(:, :)
      real(wp), allocatable, intent(out) :: power(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: rows(:)
      integer :: n

      n = size(z, 1)
      allocate (power(n/2))
      call power_of_rows(z, rows, error)
      if (allocated(error)) return
      power = 2*rows(1:n/2)/real(n, wp)**2
      if (modulo(n, 2) == 0) power(n/2) = 0.5_wp*power(n/2)
   end subroutine power_spectrum

end module roughness

!> Roughness about the mean of profiles and areas (chapter 4 of the thesis; ISO 4287, ISO 25178).
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
   !> Heights whose positions are computed together.
   integer, parameter :: block = 256

   !> Height parameters in the unit of the heights. For an area: Sa, Sq, Sz, Ssk, Sku.
   type :: roughness_t
      !> Mean of |z|.
      real(wp) :: ra = 0.0_wp
      !> Root of the mean of z^2.
      real(wp) :: rq = 0.0_wp
      !> Highest less lowest height; for a profile the mean of that over five equal parts.
      real(wp) :: rz = 0.0_wp
      !> Skewness and kurtosis, (4.2), (4.3); 0 for a flat surface.
      real(wp) :: rsk = 0.0_wp, rku = 0.0_wp
   end type roughness_t

contains

   !> Parameters of the heights `z` (nx*ny), a profile if `is_line`. Parts of a profile differ by at
   !> most one node, the longer ones first.
   pure function roughness_of(z, is_line) result(values)
      real(wp), contiguous, intent(in) :: z(:)
      logical, intent(in) :: is_line
      type(roughness_t) :: values
      real(wp) :: highest, lowest, mean, ra, rq, rsk, rku
      integer :: first, i, n, nodes

      n = size(z)
      mean = 0.0_wp
      highest = -huge(1.0_wp)
      lowest = huge(1.0_wp)
      !$omp simd reduction(+:mean) reduction(max:highest) reduction(min:lowest)
      do i = 1, n
         mean = mean + z(i)
         highest = max(highest, z(i))
         lowest = min(lowest, z(i))
      end do
      mean = mean/n
      ra = 0.0_wp
      rq = 0.0_wp
      rsk = 0.0_wp
      rku = 0.0_wp
      !$omp simd reduction(+:ra, rq, rsk, rku)
      do i = 1, n
         ra = ra + abs(z(i) - mean)
         rq = rq + (z(i) - mean)**2
         rsk = rsk + (z(i) - mean)**3
         rku = rku + (z(i) - mean)**4
      end do
      values%ra = ra/n
      values%rq = sqrt(rq/n)
      if (values%rq > 0.0_wp) then
         values%rsk = rsk/n/values%rq**2/values%rq
         values%rku = rku/n/values%rq**2/values%rq**2
      end if
      values%rz = highest - lowest
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

   !> Share of nodes at or above rising `levels` (Abbott and Firestone, Mech. Eng. 55, 1933, 569).
   pure function bearing_ratio(z, levels) result(ratio)
      real(wp), contiguous, intent(in) :: z(:)
      real(wp), intent(in) :: levels(:)
      real(wp) :: ratio(size(levels))
      integer :: below(0:size(levels)), count, first, guess(block), i, k, n
      real(wp) :: edge(0:size(levels) + 1), lowest, steps_per_height

      count = size(levels)
      lowest = levels(1)
      steps_per_height = 0.0_wp
      if (levels(count) > lowest) steps_per_height = (count - 1)/(levels(count) - lowest)
      ! below(k): nodes with k levels at or below them; the guess is that of evenly spaced levels.
      below = 0
      edge = [-huge(1.0_wp), levels, huge(1.0_wp)]
      do first = 0, size(z) - 1, block
         n = min(block, size(z) - first)
         do i = 1, n
            guess(i) = 1 + int(min(max((z(first + i) - lowest)*steps_per_height, -1.0_wp), count &
               - 1.0_wp))
         end do
         do i = 1, n
            k = guess(i)
            do while (z(first + i) >= edge(k + 1))
               k = k + 1
            end do
            do while (z(first + i) < edge(k))
               k = k - 1
            end do
            below(k) = below(k) + 1
         end do
      end do
      ratio = [(real(sum(below(i:)), wp)/size(z), i=1, size(levels))]
   end function bearing_ratio

   !> Share of the nodes between neighbouring `edges`, which rise and are evenly spaced, over their
   !> distance, from the share `above` of the nodes at or above each; the last step has its end too.
   pure function height_density(z, edges, above) result(density)
      real(wp), contiguous, intent(in) :: z(:)
      real(wp), intent(in) :: edges(:), above(:)
      real(wp) :: density(size(edges) - 1), width

      associate (steps => size(density))
         width = (edges(steps + 1) - edges(1))/steps
         density = 0.0_wp
         if (.not. width > 0.0_wp) return
         density = (above(:steps) - [above(2:steps), &
            real(count(z > edges(steps + 1)), wp)/size(z)])/width
      end associate
   end function height_density

   !> Rms slope of a periodic surface (nx, ny), of an area rms gradient, from neighbouring nodes.
   pure function rms_slope(z, dx, dy) result(slope)
      real(wp), contiguous, intent(in) :: z(:, :)
      real(wp), intent(in) :: dx, dy
      real(wp) :: slope, across, along
      real(wp), allocatable :: here(:)
      integer :: i, j

      along = 0.0_wp
      across = 0.0_wp
      do j = 1, size(z, 2)
         here = [z(:, j), z(1, j)]
         associate (after => z(:, modulo(j, size(z, 2)) + 1))
            !$omp simd reduction(+:along, across)
            do i = 1, size(z, 1)
               along = along + (here(i + 1) - here(i))**2
               across = across + (after(i) - here(i))**2
            end do
         end associate
      end do
      slope = sqrt((along/dx**2 + across/dy**2)/size(z))
   end function rms_slope

   !> Rms second difference of a periodic surface (nx, ny), of an area half the Laplacian.
   pure function rms_curvature(z, dx, dy) result(curvature)
      real(wp), contiguous, intent(in) :: z(:, :)
      real(wp), intent(in) :: dx, dy
      real(wp) :: curvature, in_x, in_y, total
      real(wp), allocatable :: here(:)
      integer :: i, j, nx, ny

      nx = size(z, 1)
      ny = size(z, 2)
      allocate (here(0:nx + 1))
      in_x = merge(1.0_wp, 0.5_wp, ny == 1)/dx**2
      in_y = 0.5_wp/dy**2
      total = 0.0_wp
      do j = 1, ny
         here = [z(nx, j), z(:, j), z(1, j)]
         associate (before => z(:, modulo(j - 2, ny) + 1), after => z(:, modulo(j, ny) + 1))
            !$omp simd reduction(+:total)
            do i = 1, nx
               total = total + (in_x*(here(i + 1) - 2.0_wp*here(i) + here(i - 1)) &
                  + in_y*(after(i) - 2.0_wp*here(i) + before(i)))**2
            end do
         end associate
      end do
      curvature = sqrt(total/size(z))
   end function rms_curvature

   !> Mean square of the heights in harmonic 1 ... nx/2 along x of a periodic surface (nx, ny),
   !> averaged over y: its sum is the variance of the profiles.
   subroutine power_spectrum(z, power)
      real(wp), contiguous, intent(in) :: z(:, :)
      real(wp), allocatable, intent(out) :: power(:)
      real(wp), allocatable :: rows(:)
      integer :: n

      n = size(z, 1)
      allocate (power(n/2))
      call power_of_rows(z, rows)
      power = 2*rows(1:n/2)/real(n, wp)**2
      if (modulo(n, 2) == 0) power(n/2) = 0.5_wp*power(n/2)
   end subroutine power_spectrum

end module roughness

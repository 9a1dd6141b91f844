!> The Gaussian filter of ISO 16610-21 (profiles) and, direction by direction, ISO 16610-61 (areas).
!>
!> The mean line is the convolution of the heights with the weighting function
!>
!>     s(x) = exp(-pi (x/(alpha Lambda))^2)/(alpha Lambda),  alpha = sqrt(ln 2/pi),
!>
!> whose transmission exp(-pi (alpha Lambda f)^2) = 2^(-(Lambda f)^2) is one half at the cut-off
!> wavelength Lambda. It is applied to the Fourier series. Heights with ends are continued by zeros,
!> and the weights that lie on the heights are scaled to a sum of one, so that a constant stays
!> constant. This changes the mean line over about half a cut-off at each end.
module gauss_filter
   use grid_transform, only: transform_back, transform_field
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: smooth_heights

   !> Fewest nodes in the cut-off: sampling then changes the transmission there by less than 2e-5.
   real(wp), parameter, public :: least_nodes = 4.0_wp
   !> Zeros behind heights with ends, in cut-offs: there the weights are below 1e-13 of the first.
   real(wp), parameter :: zeros = 1.5_wp

contains

   !> Replaces heights on `grid` = nx, ny nodes (ny = 1: a profile), x fastest, which may repeat, by
   !> their mean line or surface; `cutoff` [spacings in x and y] is at least `least_nodes`.
   subroutine smooth_heights(grid, cutoff, is_periodic, z)
      integer, intent(in) :: grid(2)
      real(wp), intent(in) :: cutoff(2)
      logical, intent(in) :: is_periodic
      real(wp), intent(inout) :: z(:)
      real(wp), allocatable :: line(:), weights(:)
      integer :: d, first, i, last, step

      do d = 1, merge(2, 1, grid(2) > 1)
         allocate (weights(grid(d)), source=1.0_wp)   ! the sums of those that lie on the heights
         if (.not. is_periodic) call convolve(cutoff(d), is_periodic, weights)
         do i = 1, grid(3 - d)
            step = merge(1, grid(1), d == 1)
            first = merge((i - 1)*grid(1) + 1, i, d == 1)
            last = first + (grid(d) - 1)*step
            line = z(first:last:step)
            call convolve(cutoff(d), is_periodic, line)
            z(first:last:step) = line/weights
         end do
         deallocate (weights)
      end do
   end subroutine smooth_heights

   !> Convolves a line with the weights.
   subroutine convolve(cutoff, is_periodic, line)
      real(wp), intent(in) :: cutoff
      logical, intent(in) :: is_periodic
      real(wp), intent(inout) :: line(:)
      complex(wp), allocatable :: spectrum(:, :)
      real(wp), allocatable :: padded(:)
      real(wp), parameter :: largest_ratio = 30.0_wp
      real(wp) :: ratio, share
      integer :: k, n

      n = size(line)
      if (.not. is_periodic) n = n + ceiling(zeros*cutoff)
      allocate (padded(n), source=0.0_wp)
      padded(:size(line)) = line
      call transform_field([n, 1], padded, spectrum)
      do k = 0, n/2
         ratio = cutoff*k/n
         share = 0.0_wp   ! of the wave that passes
         if (ratio < largest_ratio) share = exp(-log(2.0_wp)*ratio**2)
         spectrum(k, 0) = spectrum(k, 0)*(share/n)
      end do
      call transform_back([n, 1], spectrum, padded)
      line = padded(:size(line))
   end subroutine convolve

end module gauss_filter

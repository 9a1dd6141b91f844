!> Elastic half-space in plane strain: surface deflection under a pressure that is constant over
!> each cell of a uniform grid. The logarithmic kernel is integrated exactly, so that the matrix is
!> Toeplitz.
module half_space
   use constants, only: pi
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: line_kernel, line_deflection_coefficients

   !> From this cell distance on the series is used: its terms up to j^-12 leave an error of 1e-18
   !> there, while the closed form loses digits by cancellation in proportion to j.
   integer, parameter, public :: series_start = 10

contains

   !> Integral of ln|t| over the cell [j - 1/2, j + 1/2], j = 0 ... `n` (cell widths):
   !>
   !> kappa_j = (j + 1/2)(ln|j + 1/2| - 1) - (j - 1/2)(ln|j - 1/2| - 1) = ln j - sum_m 1/( 2m
   !> (2m + 1) (2j)^(2m) ).
   !>
   !> It is K_ij of (2.68) over dX, less ln dX. (2.68) lacks the outer signs in print: its terms are
   !> (d + dX/2)(ln|d + dX/2| - 1) - (d - dX/2)(ln|d - dX/2| - 1), d = X_i - X_j.
   pure function line_kernel(n) result(kappa)
      integer, intent(in) :: n
      real(wp) :: kappa(0:n), above, below, y
      integer :: j

      do j = 0, min(n, series_start - 1)
         above = real(j, wp) + 0.5_wp
         below = real(j, wp) - 0.5_wp
         kappa(j) = above*(log(above) - 1.0_wp) - below*(log(abs(below)) - 1.0_wp)
      end do
      do j = series_start, n
         y = 1.0_wp/(2.0_wp*real(j, wp))**2
         kappa(j) = log(real(j, wp)) - y*(1.0_wp/6.0_wp + y*(1.0_wp/20.0_wp + y*(1.0_wp/42.0_wp &
                    + y*(1.0_wp/72.0_wp + y*(1.0_wp/110.0_wp + y/156.0_wp)))))
      end do
   end function line_kernel

   !> k_j = K_j/pi = dX (ln dX + kappa_j)/pi, j = 0 ... `n` [-], with `dx` > 0 the grid spacing in
   !> half-widths.
   !>
   !> Deflection in (2.58), (2.67): D_i = - sum_j k_|i-j| P_j (minus: (2.67) brings it to the left
   !> side).
   pure function line_deflection_coefficients(n, dx) result(k)
      integer, intent(in) :: n
      real(wp), intent(in) :: dx
      real(wp) :: k(0:n)

      k = dx*(log(dx) + line_kernel(n))/pi
   end function line_deflection_coefficients

end module half_space

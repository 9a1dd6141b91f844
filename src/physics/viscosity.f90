!> Pressure-viscosity laws, each as ln(mu/mu_0) with its derivative by pressure.
!>
!> The laws take pressure, 1/alpha and P0 in one and the same unit: SI, or all divided by the Hertz
!> pressure. The logarithm is returned because mu itself passes 1e300 within the valid range of
!> alpha p.
module viscosity
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: barus_viscosities, roelands_viscosities

contains

   !> Barus' law on arrays (n):  ln(mu/mu_0) = alpha p; C. Barus, Am. J. Sci. 45, 1893, 87; the
   !> limit z = 1 of (2.26).
   !>
   !> `p` >= 0; `alpha` >= 0; realistic below about 0.3 GPa. Results as in `roelands_viscosities`.
   pure subroutine barus_viscosities(p, alpha, ln_mu, dln_mu)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: alpha
      real(wp), intent(out), contiguous :: ln_mu(:)
      real(wp), intent(out), contiguous, optional :: dln_mu(:)

      ln_mu = alpha*p
      if (present(dln_mu)) dln_mu = alpha
   end subroutine barus_viscosities

   !> Roelands' law (2.26), (2.61) on arrays (n), in one loop that the compiler vectorises:
   !> ln(mu/mu_0) = (alpha P0/z) [ (1 + p/P0)^z - 1 ].
   !>
   !> `p` >= 0; `alpha` >= 0; `p0` > 0; `z` > 0 (0.4 ... 0.8 for oils; z = 1 is Barus).
   !> `ln_mu` = ln(mu/mu_0) [-]; `dln_mu`, where it is asked for, its derivative by p [1/unit of p].
   pure subroutine roelands_viscosities(p, alpha, p0, z, ln_mu, dln_mu)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: alpha, p0, z
      real(wp), intent(out), contiguous :: ln_mu(:)
      real(wp), intent(out), contiguous, optional :: dln_mu(:)
      real(wp) :: unused
      integer :: i

      if (present(dln_mu)) then
         do i = 1, size(p)
            call roelands(p(i), alpha, p0, z, ln_mu(i), dln_mu(i))
         end do
      else
         do i = 1, size(p)
            call roelands(p(i), alpha, p0, z, ln_mu(i), unused)
         end do
      end if
   end subroutine roelands_viscosities

   !> The law at one pressure; private, so that position-independent code inlines it in the loops
   !> too.
   pure elemental subroutine roelands(p, alpha, p0, z, ln_mu, dln_mu)
      real(wp), intent(in) :: p, alpha, p0, z
      real(wp), intent(out) :: ln_mu, dln_mu
      real(wp) :: ratio, power

      ratio = 1.0_wp + p/p0
      power = exp(z*log(ratio))
      ln_mu = (alpha*p0/z)*(power - 1.0_wp)
      dln_mu = alpha*power/ratio
   end subroutine roelands

end module viscosity

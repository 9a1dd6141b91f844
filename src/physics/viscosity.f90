!> Pressure-viscosity laws, each as ln(mu/mu_0) with its derivative by pressure.
!>
!> The laws take pressure, 1/alpha and P0 in one and the same unit: SI, or all divided by the Hertz pressure.
!> The logarithm is returned because mu itself passes 1e300 within the valid range of alpha p.
module viscosity
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: roelands_viscosity, barus_viscosity
   public :: roelands_viscosities, roelands_ln_viscosities
   public :: roelands_alpha, roelands_p0, roelands_z, complete_roelands

   !> Minus the logarithm of the viscosity [Pa s] to which every oil tends on Roelands' chart (6.31e-5 Pa s) [-];
   !> (2.27), C. J. A. Roelands, thesis, Delft 1966.
   real(wp), parameter, public :: roelands_log_shift = 9.67_wp

   !> Largest relative disagreement of alpha, P0 and z when all three are given [-].
   real(wp), parameter, public :: roelands_agreement = 1.0e-3_wp

contains

   !> Roelands' law (2.26), (2.61):  ln(mu/mu_0) = (alpha P0/z) [ (1 + p/P0)^z - 1 ].
   !>
   !> `p` >= 0; `alpha` >= 0; `p0` > 0; `z` > 0 (0.4 ... 0.8 for oils; z = 1 is Barus).
   !> `ln_mu` = ln(mu/mu_0) [-]; `dln_mu` its derivative by p [1/unit of p].
   pure elemental subroutine roelands_viscosity(p, alpha, p0, z, ln_mu, dln_mu)
      real(wp), intent(in) :: p, alpha, p0, z
      real(wp), intent(out) :: ln_mu, dln_mu

      call roelands(p, alpha, p0, z, ln_mu, dln_mu)
   end subroutine roelands_viscosity

   !> Barus' law:  ln(mu/mu_0) = alpha p; C. Barus, Am. J. Sci. 45, 1893, 87; the limit z = 1 of (2.26).
   !>
   !> `p` >= 0; `alpha` >= 0; realistic below about 0.3 GPa. Results as in `roelands_viscosity`.
   pure elemental subroutine barus_viscosity(p, alpha, ln_mu, dln_mu)
      real(wp), intent(in) :: p, alpha
      real(wp), intent(out) :: ln_mu, dln_mu

      ln_mu = alpha*p
      dln_mu = alpha
   end subroutine barus_viscosity

   !> `roelands_viscosity` on arrays (n) in one loop that the compiler vectorises.
   pure subroutine roelands_viscosities(p, alpha, p0, z, ln_mu, dln_mu)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: alpha, p0, z
      real(wp), intent(out), contiguous :: ln_mu(:), dln_mu(:)
      integer :: i

      do i = 1, size(p)
         call roelands(p(i), alpha, p0, z, ln_mu(i), dln_mu(i))
      end do
   end subroutine roelands_viscosities

   !> The value of `roelands_viscosities` without the derivative.
   pure subroutine roelands_ln_viscosities(p, alpha, p0, z, ln_mu)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: alpha, p0, z
      real(wp), intent(out), contiguous :: ln_mu(:)
      real(wp) :: unused
      integer :: i

      do i = 1, size(p)
         call roelands(p(i), alpha, p0, z, ln_mu(i), unused)
      end do
   end subroutine roelands_ln_viscosities

   !> The formula of `roelands_viscosity`; private, so that also position-independent code has it inlined in the loops.
   pure elemental subroutine roelands(p, alpha, p0, z, ln_mu, dln_mu)
      real(wp), intent(in) :: p, alpha, p0, z
      real(wp), intent(out) :: ln_mu, dln_mu
      real(wp) :: ratio, power

      ratio = 1.0_wp + p/p0
      power = exp(z*log(ratio))
      ln_mu = (alpha*p0/z)*(power - 1.0_wp)
      dln_mu = alpha*power/ratio
   end subroutine roelands

   !> Pressure-viscosity coefficient alpha [1/Pa] from (2.27): alpha = z (ln mu_0 + 9.67)/P0.
   !>
   !> `mu_0` [Pa s] > 6.4e-5; `p0` [Pa] > 0; `z` [-] > 0.
   pure elemental function roelands_alpha(mu_0, p0, z) result(alpha)
      real(wp), intent(in) :: mu_0, p0, z
      real(wp) :: alpha

      alpha = z*(log(mu_0) + roelands_log_shift)/p0
   end function roelands_alpha

   !> Roelands' reference pressure P0 [Pa] from (2.27): P0 = z (ln mu_0 + 9.67)/alpha.
   !>
   !> (2.62) is the same equation in dimensionless form. `mu_0` [Pa s] > 6.4e-5; `alpha` [1/Pa] > 0; `z` [-] > 0.
   pure elemental function roelands_p0(mu_0, alpha, z) result(p0)
      real(wp), intent(in) :: mu_0, alpha, z
      real(wp) :: p0

      p0 = z*(log(mu_0) + roelands_log_shift)/alpha
   end function roelands_p0

   !> Roelands' index z [-] from (2.27): z = alpha P0/(ln mu_0 + 9.67).
   !>
   !> `mu_0` [Pa s] > 6.4e-5; `alpha` [1/Pa] > 0; `p0` [Pa] > 0.
   pure elemental function roelands_z(mu_0, alpha, p0) result(z)
      real(wp), intent(in) :: mu_0, alpha, p0
      real(wp) :: z

      z = alpha*p0/(log(mu_0) + roelands_log_shift)
   end function roelands_z

   !> Completes alpha [1/Pa], P0 [Pa] and z [-] by (2.27) from any two of them; a value <= 0 means "not given".
   !>
   !> `mu_0` [Pa s] is the ambient viscosity. Error (input): fewer than two are given, three are given that disagree by
   !> more than `roelands_agreement`, or mu_0 is so small that (2.27) gives no positive value.
   !> The thesis's Table 5.1 gives P0 and z (so alpha = 2.3345e-8), Table 6.1 alpha and P0 (so z = 0.5397).
   pure subroutine complete_roelands(mu_0, alpha, p0, z, error)
      real(wp), intent(in) :: mu_0
      real(wp), intent(inout) :: alpha, p0, z
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: expected

      if (count([alpha, p0, z] > 0.0_wp) < 2) then
         call fail(error, input_error, 'the Roelands law needs two of pressure_viscosity, roelands_p0 and roelands_z')
         return
      end if
      if (mu_0 <= exp(-roelands_log_shift)) then
         call fail(error, input_error, 'the Roelands law needs a viscosity above '// &
                   to_text(exp(-roelands_log_shift), 3)//' Pa s, found '//to_text(mu_0))
         return
      end if
      if (alpha <= 0.0_wp) then
         alpha = roelands_alpha(mu_0, p0, z)
      else if (p0 <= 0.0_wp) then
         p0 = roelands_p0(mu_0, alpha, z)
      else if (z <= 0.0_wp) then
         z = roelands_z(mu_0, alpha, p0)
      else
         expected = roelands_alpha(mu_0, p0, z)
         if (abs(alpha - expected) > roelands_agreement*expected) then
            call fail(error, input_error, 'pressure_viscosity, roelands_p0 and roelands_z contradict each other: '// &
                      'the viscosity, roelands_p0 and roelands_z give pressure_viscosity = '//to_text(expected, 5)// &
                      ' 1/Pa, found '//to_text(alpha, 5)//'; give only two of the three')
         end if
      end if
   end subroutine complete_roelands

end module viscosity

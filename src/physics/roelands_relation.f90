!> The relation between the three parameters of Roelands' law and the ambient viscosity, (2.27): two
!> of them give the third.
module roelands_relation
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: roelands_alpha, roelands_p0, roelands_z, complete_roelands

   !> Minus the logarithm of the viscosity [Pa s] to which every oil tends on Roelands' chart
   !> (6.31e-5 Pa s) [-]; (2.27), C. J. A. Roelands, thesis, Delft 1966.
   real(wp), parameter, public :: roelands_log_shift = 9.67_wp

   !> Largest relative disagreement of alpha, P0 and z when all three are given [-].
   real(wp), parameter :: roelands_agreement = 1.0e-3_wp

contains

   !> Pressure-viscosity coefficient alpha [1/Pa] from (2.27): alpha = z (ln mu_0 + 9.67)/P0.
   !>
   !> `mu_0` [Pa s] > 6.4e-5; `p0` [Pa] > 0; `z` [-] > 0.
   pure elemental real(wp) function roelands_alpha(mu_0, p0, z) result(alpha)
      real(wp), intent(in) :: mu_0, p0, z

      alpha = z*(log(mu_0) + roelands_log_shift)/p0
   end function roelands_alpha

   !> Roelands' reference pressure P0 [Pa] from (2.27): P0 = z (ln mu_0 + 9.67)/alpha.
   !>
   !> (2.62) is the same equation in dimensionless form. `mu_0` [Pa s] > 6.4e-5; `alpha` [1/Pa] > 0;
   !> `z` [-] > 0.
   pure elemental real(wp) function roelands_p0(mu_0, alpha, z) result(p0)
      real(wp), intent(in) :: mu_0, alpha, z

      p0 = z*(log(mu_0) + roelands_log_shift)/alpha
   end function roelands_p0

   !> Roelands' index z [-] from (2.27): z = alpha P0/(ln mu_0 + 9.67).
   !>
   !> `mu_0` [Pa s] > 6.4e-5; `alpha` [1/Pa] > 0; `p0` [Pa] > 0.
   pure elemental real(wp) function roelands_z(mu_0, alpha, p0) result(z)
      real(wp), intent(in) :: mu_0, alpha, p0

      z = alpha*p0/(log(mu_0) + roelands_log_shift)
   end function roelands_z

   !> Completes alpha [1/Pa], P0 [Pa] and z [-] by (2.27) from any two of them; a value <= 0 means
   !> "not given".
   !>
   !> `mu_0` [Pa s] is the ambient viscosity. Error (input): fewer than two are given, three are
   !> given that disagree by more than `roelands_agreement`, or mu_0 is so small that (2.27) gives
   !> no positive value. The thesis's Table 6.1 gives alpha and P0 (so z = 0.5397), its Table 5.1
   !> z = 0.6 alone (with the usual P0 = 1.98e8 Pa alpha = 2.3345e-8).
   pure subroutine complete_roelands(mu_0, alpha, p0, z, error)
      real(wp), intent(in) :: mu_0
      real(wp), intent(inout) :: alpha, p0, z
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: expected

      if (count([alpha, p0, z] > 0.0_wp) < 2) then
         call fail(error, input_error, 'the Roelands law needs two of pressure_viscosity, '// &
            'roelands_p0 and roelands_z')
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
            call fail(error, input_error, 'pressure_viscosity, roelands_p0 and roelands_z '// &
               'contradict each other: '// &
                      'the viscosity, roelands_p0 and roelands_z give pressure_viscosity = ' &
                         //to_text(expected, 5)// &
                      ' 1/Pa, found '//to_text(alpha, 5)//'; give only two of the three')
         end if
      end if
   end subroutine complete_roelands

end module roelands_relation

!> Distance of a film from the limits of its model, in the unit b/R: the two of Reynolds' equation,
!> and the stress over the pressure, at which oils yield; and the temperature rise by sliding.
!>
!> T_max is the largest d tau/dp of sliding at a given shear rate, which the derivation sets to 0
!> (S. Bair, M. Khonsari and W. O. Winer, Tribol. Int. 31, 1998, 573); the slope dh/dx is assumed
!> small. Modules limit_search, film_shear and film_heating compute them, thresholds are in module
!> validity.
module reynolds_limits
   use kinds, only: wp
   use missing_value, only: larger, not_known
   implicit none (type, external)
   private

   public :: reynolds_limits_t, unknown_limits, widen_limits

   !> Limits of one film, or the largest over several.
   type :: reynolds_limits_t
      !> T_max R/b; NaN: speeds not known.
      real(wp) :: stokes_number = 0.0_wp
      !> Largest |dH/dX| between neighbouring nodes under pressure.
      real(wp) :: surface_slope = 0.0_wp
      !> Largest |T_m|/P of the nodes whose pressure counts; NaN: speeds not known.
      real(wp) :: stress_share = 0.0_wp
      !> Temperature rise [K] by sliding; 0: not computed.
      real(wp) :: film_heating = 0.0_wp
   end type reynolds_limits_t

contains

   !> Limits that are not known.
   pure function unknown_limits() result(limits)
      type(reynolds_limits_t) :: limits

      limits = reynolds_limits_t(not_known(), not_known(), not_known(), not_known())
   end function unknown_limits

   !> Widens `limits` by those of another time.
   pure subroutine widen_limits(limits, other)
      type(reynolds_limits_t), intent(inout) :: limits
      type(reynolds_limits_t), intent(in) :: other

      limits%stokes_number = larger(limits%stokes_number, other%stokes_number)
      limits%surface_slope = larger(limits%surface_slope, other%surface_slope)
      limits%stress_share = larger(limits%stress_share, other%stress_share)
      limits%film_heating = larger(limits%film_heating, other%film_heating)
   end subroutine widen_limits

end module reynolds_limits

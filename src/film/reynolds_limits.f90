!> Numbers that say how far a film is from where its model ends, in the unit b/R: the two of
!> Reynolds' equation, and the stress over the pressure, at which oils give way; and how warm
!> sliding would make it.
!>
!> T_max is the largest d tau/dp of the sliding at a given shear rate, which the derivation takes
!> for 0 (S. Bair, M. Khonsari and W. O. Winer, Tribol. Int. 31, 1998, 573); the slope dh/dx is
!> taken for small. Modules limit_search, film_shear and film_heating find them, thresholds are in
!> module validity_table.
module reynolds_limits
   use kinds, only: wp
   use missing_value, only: larger, not_known
   implicit none (type, external)
   private

   public :: reynolds_limits_t, unknown_limits, widen_limits

   !> Of one film, or the largest over several.
   type :: reynolds_limits_t
      !> T_max R/b; NaN where the speeds are not known.
      real(wp) :: stokes_number = 0.0_wp
      !> Largest |dH/dX| between neighbouring nodes under pressure.
      real(wp) :: surface_slope = 0.0_wp
      !> Largest |T_m|/P of the nodes where the pressure counts; NaN where the speeds are not known.
      real(wp) :: stress_share = 0.0_wp
      !> Temperature rise [K] by sliding; 0 where nobody has looked.
      real(wp) :: film_heating = 0.0_wp
   end type reynolds_limits_t

contains

   !> Those that are not known.
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

!> What the shear stresses of a film add up to; module film_shear makes it.
module friction_sums
   use kinds, only: wp
   use missing_value, only: not_known
   implicit none (type, external)
   private

   public :: unknown_friction

   !> Stresses over pressures count where the pressure is above this share of its largest.
   real(wp), parameter, public :: stressed_share = 0.1_wp

   !> Over the film under pressure and the oil in front of the domain.
   type, public :: friction_t
      !> Int T_m dX, positive where u2 > u1; NaN where the speeds are not known.
      real(wp) :: sliding = 0.0_wp
      !> Int (H/2) dP/dX dX: rolling holds back each surface with it.
      real(wp) :: rolling = 0.0_wp
      !> (u2 - u1)/(u1 + u2): times the force of sliding it is the sliding power.
      real(wp) :: sliding_speed = 0.0_wp
      !> Int S H^3/(mu/mu_0) (dP/dX)^2 dX/(2 lambda).
      real(wp) :: rolling_power = 0.0_wp
      !> Largest |T_m|/P of the nodes whose pressure is above `stressed_share` of the largest.
      real(wp) :: stress_share = 0.0_wp
   end type friction_t

contains

   !> That of a film whose stresses are not known.
   pure function unknown_friction() result(friction)
      type(friction_t) :: friction

      friction = friction_t(not_known(), not_known(), not_known(), not_known(), not_known())
   end function unknown_friction

end module friction_sums

!> Integrals of the shear stresses of a film, computed by module film_shear.
module friction_sums
   use kinds, only: wp
   implicit none (type, external)
   private

   !> Stress over pressure counts where the pressure exceeds this share of its largest value.
   real(wp), parameter, public :: stressed_share = 0.1_wp

   !> Integrals over the film under pressure and the oil in front of the domain.
   type, public :: friction_t
      !> Int T_m dX, positive for u2 > u1; NaN: speeds not known.
      real(wp) :: sliding = 0.0_wp
      !> Int (H/2) dP/dX dX: force by which rolling holds back each surface.
      real(wp) :: rolling = 0.0_wp
      !> (u2 - u1)/(u1 + u2): times the sliding force it is the sliding power.
      real(wp) :: sliding_speed = 0.0_wp
      !> Int S H^3/(mu/mu_0) (dP/dX)^2 dX/(2 lambda).
      real(wp) :: rolling_power = 0.0_wp
      !> Largest |T_m|/P of the nodes whose pressure is above `stressed_share` of the largest.
      real(wp) :: stress_share = 0.0_wp
      !> w/w_ref.
      real(wp) :: load = 1.0_wp
      !> Force of the asperities, as `sliding`, and share of the load that they bear; 0: none touch.
      real(wp) :: boundary = 0.0_wp, asperity_share = 0.0_wp
      !> Relative growth of their load by that of the film, negative.
      real(wp) :: asperity_response = 0.0_wp
      !> X of the first node where oil fills the gap, if that is not the first one; 0: it is.
      real(wp) :: meniscus = 0.0_wp
      !> Largest temperature rise of the mean film and of surfaces 1 and 2 [K].
      real(wp) :: rise(3) = 0.0_wp
   end type friction_t

end module friction_sums

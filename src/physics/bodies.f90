!> The two contacting bodies reduced to one elastic cylinder on a rigid plane.
module bodies
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: reduced_radius, reduced_modulus

   !> Data of the bodies in a line contact.
   type, public :: bodies_t
      !> R [m] > 0 of (2.24), see `reduced_radius`.
      real(wp) :: reduced_radius
      !> E' [Pa] > 0 of (2.25), see `reduced_modulus`.
      real(wp) :: reduced_modulus
      !> Speed u1, u2 [m/s] of the surfaces in x; u1 + u2 > 0.
      real(wp) :: speed_1, speed_2
      !> R/R1, the share of surface 1 in the curvature of the gap; 1/2 if only R is known.
      real(wp) :: curvature_share = 0.5_wp
   end type bodies_t

contains

   !> Reduced radius of curvature R [m]:  1/R = 1/R1 + 1/R2, in (2.24).
   !>
   !> `radius_1`, `radius_2` [m]: positive for convex bodies; a negative one (conformal) must be the
   !> larger in size.
   pure elemental real(wp) function reduced_radius(radius_1, radius_2) result(radius)
      real(wp), intent(in) :: radius_1, radius_2

      radius = radius_1*radius_2/(radius_1 + radius_2)
   end function reduced_radius

   !> Effective modulus E' [Pa] of the convention of the field:
   !> 2/E' = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, in (2.25).
   !>
   !> `modulus_1`, `modulus_2` [Pa] > 0; `poisson_1`, `poisson_2` [-] in -1 ... 0.5. Not Hertz'
   !> E* = E'/2.
   pure elemental real(wp) function reduced_modulus(modulus_1, poisson_1, modulus_2, &
      poisson_2) result(modulus)
      real(wp), intent(in) :: modulus_1, poisson_1, modulus_2, poisson_2

      modulus = 2.0_wp/((1.0_wp - poisson_1**2)/modulus_1 + (1.0_wp - poisson_2**2)/modulus_2)
   end function reduced_modulus

end module bodies

!> Two bodies as one elastic cylinder on a rigid plane, and the dry line and point contact of smooth
!> ones (H. Hertz, 1881), with 2/E' = sum of (1 - nu^2)/E.
module hertz
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: line_half_width, line_load_from_pressure, line_peak_pressure, line_pressure, &
      point_load_from_pressure, point_radius, reduced_modulus, reduced_radius

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

   !> Half-width b [m] of the contact, (2.52):  b = sqrt(8 w R/(pi E')).
   !>
   !> `load_per_length` w [N/m] >= 0; `reduced_radius` R [m] > 0; `reduced_modulus` E' [Pa] > 0.
   pure elemental real(wp) function line_half_width(load_per_length, reduced_radius, &
      reduced_modulus) result(half_width)
      real(wp), intent(in) :: load_per_length, reduced_radius, reduced_modulus

      half_width = sqrt(8.0_wp*load_per_length*reduced_radius/(pi*reduced_modulus))
   end function line_half_width

   !> Largest pressure p_h [Pa], (2.52):  p_h = sqrt(w E'/(2 pi R)) = 2 w/(pi b). Arguments as in
   !> `line_half_width`.
   pure elemental real(wp) function line_peak_pressure(load_per_length, reduced_radius, &
      reduced_modulus) result(pressure)
      real(wp), intent(in) :: load_per_length, reduced_radius, reduced_modulus

      pressure = sqrt(load_per_length*reduced_modulus/(2.0_wp*pi*reduced_radius))
   end function line_peak_pressure

   !> Load per length w [N/m] that gives the peak pressure `hertz_pressure` [Pa] >= 0: (2.52)
   !> solved, w = 2 pi R p_h^2/E'.
   pure elemental real(wp) function line_load_from_pressure(hertz_pressure, reduced_radius, &
      reduced_modulus) result(load_per_length)
      real(wp), intent(in) :: hertz_pressure, reduced_radius, reduced_modulus

      load_per_length = 2.0_wp*pi*reduced_radius*hertz_pressure**2/reduced_modulus
   end function line_load_from_pressure

   !> Pressure p/p_h [-] at `x` = position over half-width [-], any value: sqrt(1 - x^2) inside the
   !> contact, 0 outside.
   pure elemental real(wp) function line_pressure(x) result(pressure)
      real(wp), intent(in) :: x

      pressure = sqrt(max((1.0_wp - x)*(1.0_wp + x), 0.0_wp))
   end function line_pressure

   !> Load P [N] of a point contact of bodies of revolution that gives the peak pressure
   !> `hertz_pressure` p_0 [Pa] >= 0: P = (2/3) pi a^2 p_0 with a = pi p_0 R/E'; R [m] of
   !> 1/R = 1/R_1 + 1/R_2.
   pure elemental real(wp) function point_load_from_pressure(hertz_pressure, reduced_radius, &
      reduced_modulus) result(load)
      real(wp), intent(in) :: hertz_pressure, reduced_radius, reduced_modulus

      load = 2.0_wp/3.0_wp*pi*(pi*hertz_pressure*reduced_radius/reduced_modulus)**2*hertz_pressure
   end function point_load_from_pressure

   !> Radius a [m] of a point contact under the load P [N] >= 0:  a = (3 P R/(2 E'))^(1/3).
   !> Arguments as above.
   pure elemental function point_radius(load, reduced_radius, reduced_modulus) result(radius)
      real(wp), intent(in) :: load, reduced_radius, reduced_modulus
      real(wp) :: radius

      radius = (1.5_wp*load*reduced_radius/reduced_modulus)**(1.0_wp/3.0_wp)
   end function point_radius

end module hertz

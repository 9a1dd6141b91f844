!> Dry line and point contact of smooth elastic bodies (H. Hertz, 1881), with E' as in `bodies`
!> (2/E' = sum of (1 - nu^2)/E).
module hertz
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: line_half_width, line_peak_pressure, line_load_from_pressure, line_pressure, &
      point_load_from_pressure, point_radius

contains

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

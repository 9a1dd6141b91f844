!> Two bodies as one elastic cylinder on a rigid plane, and the dry line and point contact of smooth
!> ones (H. Hertz, 1881), with 2/E' = sum of (1 - nu^2)/E. Of an ellipse D = Rx/Ry is the ratio of
!> the reduced radii, kappa = b/a that of the half-axes, a along x.
module hertz
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: ellipse_t, line_half_width, line_load_from_pressure, line_peak_pressure, &
      line_pressure, new_ellipse, point_load_from_pressure, point_radius, reduced_modulus, &
      reduced_radius, track_shear

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

   !> Shape of a point contact.
   type :: ellipse_t
      !> kappa = b/a [-].
      real(wp) :: ratio = 1.0_wp
      !> C = 2 p_h Rx/(pi E' a) [-]: the deflection is C times the integral of P/r.
      real(wp) :: compliance = 2.0_wp/pi**2
   end type ellipse_t

   !> Steps of the arithmetic-geometric mean, for all digits, and of the secant method for kappa.
   integer, parameter :: mean_steps = 7, secant_steps = 50
   !> Depths at which the shear stress under a track is compared, for four digits.
   integer, parameter :: depths = 1000

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

   !> The ellipse of the ratio of radii D = `radius_ratio` > 0: its half-axes by the complete
   !> elliptic integrals, K. L. Johnson, Contact Mechanics, 1985, section 4.2.
   pure function new_ellipse(radius_ratio) result(ellipse)
      real(wp), intent(in) :: radius_ratio
      type(ellipse_t) :: ellipse
      real(wp) :: integral, share, step, x(2), miss(2)
      integer :: i

      x = [0.0_wp, -0.6_wp*log(min(radius_ratio, 1/radius_ratio))]
      if (x(2) > 0.0_wp) then
         miss = [miss_of(x(1)), miss_of(x(2))]
         do i = 1, secant_steps
            if (.not. abs(miss(2) - miss(1)) > 0.0_wp) exit
            step = -miss(2)*(x(2) - x(1))/(miss(2) - miss(1))
            x = [x(2), x(2) + step]
            miss = [miss(2), miss_of(x(2))]
            if (abs(step) < 2*epsilon(1.0_wp)) exit
         end do
      end if
      call sum_means(exp(-x(2)), share, integral)
      if (radius_ratio <= 1.0_wp) then
         ellipse = ellipse_t(exp(x(2)), 1/(2*pi*integral*(1 - share)))
      else
         ellipse = ellipse_t(exp(-x(2)), exp(x(2))/(2*pi*integral*share))
      end if

   contains

      !> ln of the ratio of radii <= 1 at kappa = exp(x) >= 1, less that of this contact.
      pure real(wp) function miss_of(x) result(miss)
         real(wp), intent(in) :: x
         real(wp) :: share, integral

         call sum_means(exp(-x), share, integral)
         miss = log(share/(1 - share)) - 2*x - log(min(radius_ratio, 1/radius_ratio))
      end function miss_of

   end function new_ellipse

   !> Largest shear stress over p_h on planes along the surface under the middle of the track that a
   !> contact without friction leaves in the direction `angle` [rad] from its x axis.
   !>
   !> With l the largest root of X^2/(1 + l) + Y^2/(kappa^2 + l) + Z^2/l = 1 Hertz's potential
   !> (K. L. Johnson, Contact Mechanics, 1985, section 3.5) gives
   !>
   !>     (T_xz, T_yz) = -kappa Z^2/l (X/(1 + l), Y/(kappa^2 + l))/( sqrt((1 + l)(kappa^2 + l) l)
   !>                    (X^2/(1 + l)^2 + Y^2/(kappa^2 + l)^2 + Z^2/l^2) )
   !>
   !> On X^2 = c^2 u, Y^2 = s^2 u it is largest at the root u of a quadratic, for each l.
   pure real(wp) function track_shear(ellipse, angle) result(shear)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: angle
      real(wp) :: a, b, l, m, n, rest, u
      integer :: i

      shear = 0.0_wp
      do i = 1, depths
         l = min(1.0_wp, ellipse%ratio**2)*10.0_wp**(6*real(i, wp)/depths - 5)
         a = 1 + l
         b = ellipse%ratio**2 + l
         m = cos(angle)**2/a + sin(angle)**2/b
         n = cos(angle)**2/a**2 + sin(angle)**2/b**2
         rest = n - m/l
         u = 2/l/(rest + 3*m/l + sqrt((rest + 3*m/l)**2 + 4*m*rest/l))
         shear = max(shear, ellipse%ratio*(1 - m*u)*sqrt(u*n/(a*b*l))/(u*rest + 1/l))
      end do
   end function track_shear

   !> Computes K(m) and the share (K - E)/(m K) at m = 1 - `axes`^2, 0 < axes <= 1, by the
   !> arithmetic-geometric mean, without loss of digits for circles.
   pure subroutine sum_means(axes, share, integral)
      real(wp), intent(in) :: axes
      real(wp), intent(out) :: share, integral
      real(wp) :: a, before, g, weight
      integer :: i

      a = 0.5_wp*(1 + axes)
      g = sqrt(axes)
      share = 0.5_wp + 0.25_wp*(1 - axes)/(1 + axes)
      weight = 1.0_wp
      do i = 1, mean_steps
         weight = 2*weight
         share = share + weight*(0.5_wp*(a - g))**2/max((1 - axes)*(1 + axes), tiny(1.0_wp))
         before = a
         a = 0.5_wp*(a + g)
         g = sqrt(before*g)
      end do
      integral = pi/(2*a)
   end subroutine sum_means

end module hertz

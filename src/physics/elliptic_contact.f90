!> Elliptic point contact of smooth bodies: its dry ellipse (H. Hertz, 1881) and formulas of its
!> film. D = Rx/Ry is the ratio of the reduced radii, kappa = b/a that of the half-axes, a along x.
!>
!> Moes' numbers and films are those of the sum of the speeds: M = w/(E' Rx^2) (2U)^(-3/4), L =
!> alpha E' (2U)^(1/4), film h/Rx (2U)^(-1/2), 2U = mu_0 (u1 + u2)/(E' Rx).
module elliptic_contact
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: central_point_film, ellipse_t, new_ellipse, point_lambda, point_alpha_bar, &
      point_film_unit, track_shear

   !> Shape of the dry contact.
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

   !> t of Moes' number M > 0, sum of speeds: films are in units of t^(2/3) a^2/Rx.
   pure elemental real(wp) function moes_scale(ellipse, moes_m) result(t)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m

      t = 3*moes_m/(pi**2*ellipse%compliance*ellipse%ratio)
   end function moes_scale

   !> lambda = 6 u_s mu_0 Rx^2/(a^3 p_h) [-] of M.
   pure elemental real(wp) function point_lambda(ellipse, moes_m) result(lambda)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m

      lambda = 12/(pi*ellipse%compliance)*moes_scale(ellipse, moes_m)**(-4.0_wp/3.0_wp)
   end function point_lambda

   !> alpha p_h [-] of M and L.
   pure elemental real(wp) function point_alpha_bar(ellipse, moes_m, moes_l) result(alpha_bar)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m, moes_l

      alpha_bar = 0.5_wp*pi*ellipse%compliance*moes_l*moes_scale(ellipse, moes_m)**(1.0_wp/3.0_wp)
   end function point_alpha_bar

   !> a^2/Rx, the unit of the film, in units of Moes.
   pure elemental real(wp) function point_film_unit(ellipse, moes_m) result(factor)
      type(ellipse_t), intent(in) :: ellipse
      real(wp), intent(in) :: moes_m

      factor = moes_scale(ellipse, moes_m)**(2.0_wp/3.0_wp)
   end function point_film_unit

   !> Central film in units of Moes of a smooth incompressible Newtonian contact with entrainment
   !> along x: fit of G. Nijenbanning, C. H. Venner and H. Moes, Wear 176, 1994, 217. M > 0, L >= 0,
   !> D > 0. Within 3 % for M >= 20 and 0.2 <= D <= 1; 20 % high at M = 1.
   pure elemental real(wp) function central_point_film(moes_m, moes_l, radius_ratio) result(film)
      real(wp), intent(in) :: moes_m, moes_l, radius_ratio
      real(wp) :: rigid_iso, elastic_iso, rigid_piezo, elastic_piezo, shape, power, isoviscous

      associate (d => radius_ratio)
         shape = 1 + 0.006_wp*log(d) + 0.63_wp*d**(4.0_wp/7.0_wp)
         rigid_iso = 145*(1 + 0.796_wp*d**(14.0_wp/15.0_wp))**(-15.0_wp/7.0_wp)/(d*moes_m**2)
         elastic_iso = 3.18_wp*shape**(-0.56_wp)*d**(-1.0_wp/15.0_wp)*moes_m**(-2.0_wp/15.0_wp)
         rigid_piezo = 1.29_wp*(1 + 0.691_wp*d)**(-2.0_wp/3.0_wp)*moes_l**(2.0_wp/3.0_wp)
         elastic_piezo = 1.48_wp*shape**(-0.35_wp)*d**(-1.0_wp/24.0_wp) &
            *moes_m**(-1.0_wp/12.0_wp)*moes_l**0.75_wp
         power = 1.5_wp*(1 + exp(-1.2_wp*elastic_iso/rigid_iso))
         isoviscous = (rigid_iso**(1.5_wp*power) + (elastic_iso**(-4) &
            + (1.8_wp/d)**(-4))**(-0.375_wp*power))**(2.0_wp/3.0_wp)
         ! both piezoviscous films are 0 for L = 0
         film = (isoviscous + (max(rigid_piezo, tiny(1.0_wp)**0.02_wp)**(-8) &
            + max(elastic_piezo, tiny(1.0_wp)**0.02_wp)**(-8))**(-power/8))**(1/power)
      end associate
   end function central_point_film

end module elliptic_contact

!> Mean pressure and gap of rough surfaces whose asperities touch, by the separation H of their mean
!> planes, which may be negative. In SI or dimensionless.
!>
!> The logarithm of the pressure is a cubic between the rows of a table, and a straight line beyond
!> both ends: the pressure is positive and falls. Its laws:
!>
!>     exponential      A exp(-H/l)              B. N. J. Persson, Phys. Rev. Lett. 99, 2007, 125502
!>     greenwood_tripp  K E'/2 F_5/2(H/sigma), K = (16 sqrt(2) pi/15) (eta beta sigma)^2
!>                      sqrt(sigma/beta)         J. A. Greenwood and J. H. Tripp, Proc. Instn Mech.
!>                                               Engrs 185, 1970, 625
!>     table            monotone cubics          measured, or by a dry contact of these surfaces
!>
!> with F_n(u) = Int_u^inf (t - u)^n phi(t) dt of the Gaussian phi, F_n' = -n F_(n-1). Oil fills the
!> mean gap: F_1(-H/sigma) sigma of Gaussian heights; with the other laws H is a mean gap already,
!> continued from 0.1 sigma down by 0.1 sigma exp(10 H/sigma - 1). Pressure drives through it what
!> it would drive through a smooth gap, times the factor phi_x/(mean gap)^3 H^3 with phi_x = 1 - 0.9
!> exp(-0.56 H/sigma) of isotropic surfaces (N. Patir and H. S. Cheng, J. Lubr. Technol. 100, 1978,
!> 12), below H = sigma/2 extrapolated along its tangent in ln.
module asperities
   use kinds, only: pi, wp
   use time_table, only: monotone_slopes, row_below
   implicit none (type, external)
   private

   public :: asperities_t, asperity_pressure, flow_factor, greenwood_tripp, mean_gap, new_law, &
      scaled

   !> A pair of rough surfaces.
   type :: asperities_t
      !> Rms height sigma of both together.
      real(wp) :: roughness = 0.0_wp
      !> Force of friction over the load of the asperities.
      real(wp) :: boundary_friction = 0.0_wp
      !> Whether their heights are Gaussian, of greenwood_tripp, and whether the flow has the factor
      !> phi_x.
      logical :: is_gaussian = .false., has_flow_factor = .false.
      !> Rows: separation, rising; ln of the pressure; its slope.
      real(wp), allocatable :: separation(:), ln_pressure(:), slope(:)
   end type asperities_t

   !> Rows of F_5/2 over u, and where its expansion for deep contact begins.
   real(wp), parameter :: first_u = -40.0_wp, step_u = 0.02_wp, deep_u = -8.0_wp
   integer, parameter :: count_u = 2701
   !> Trapezoidal rule over t = s^2 + u, by its symmetry in s; as the integrand ends smoothly its
   !> error falls faster than every power of the step.
   real(wp), parameter :: step_s = 0.05_wp, last_s = 6.0_wp
   !> Mean gap [sigma] below which another law than greenwood_tripp is continued, and u below which
   !> that is, by the line of its logarithm.
   real(wp), parameter :: least_gap = 0.1_wp, least_u = -10.0_wp
   !> Constants of phi_x, and the separation [sigma] below which it is extrapolated.
   real(wp), parameter :: flow_c = 0.9_wp, flow_r = 0.56_wp, least_flow = 0.5_wp
   !> Bound on the logarithm of a pressure.
   real(wp), parameter :: largest_ln = 690.0_wp

contains

   !> The law through rows of separation (rising) and pressure (falling, > 0), two or more: monotone
   !> cubics of its logarithm, at the ends with the slope of the parabola through three rows where
   !> that falls.
   pure function new_law(roughness, separation, pressure) result(law)
      real(wp), intent(in) :: roughness, separation(:), pressure(:)
      type(asperities_t) :: law
      real(wp), dimension(size(separation) - 1) :: gap, rise
      integer :: n

      n = size(gap)
      law%roughness = roughness
      law%separation = separation
      law%ln_pressure = log(pressure)
      gap = separation(2:) - separation(:n)
      rise = (law%ln_pressure(2:) - law%ln_pressure(:n))/gap
      law%slope = monotone_slopes(gap, rise)
      law%slope(1) = end_slope(gap(1), gap(min(2, n)), rise(1), rise(min(2, n)))
      law%slope(n + 1) = end_slope(gap(n), gap(max(n - 1, 1)), rise(n), rise(max(n - 1, 1)))
   end function new_law

   !> Slope at an end from those of the two intervals next to it, within three times that of the
   !> first one.
   pure real(wp) function end_slope(gap, next_gap, rise, next_rise) result(slope)
      real(wp), intent(in) :: gap, next_gap, rise, next_rise

      slope = ((2*gap + next_gap)*rise - gap*next_rise)/(gap + next_gap)
      if (slope >= 0.0_wp) slope = rise
      slope = max(slope, 3*rise)
   end function end_slope

   !> The law of Greenwood and Tripp: density times radius times rms height eta beta sigma, sigma
   !> over the radius beta, and the reduced modulus E'.
   pure function greenwood_tripp(roughness, density_radius_height, height_over_radius, modulus) &
      result(law)
      real(wp), intent(in) :: roughness, density_radius_height, height_over_radius, modulus
      type(asperities_t) :: law
      real(wp) :: u(count_u), f(2, count_u), pressure
      integer :: i

      u = [(first_u + i*step_u, i=0, count_u - 1)]
      do i = 1, count_u
         f(:, i) = half_integrals(u(i))
      end do
      pressure = 16*sqrt(2.0_wp)*pi/15*density_radius_height**2*sqrt(height_over_radius)*modulus/2
      law%roughness = roughness
      law%is_gaussian = .true.
      law%separation = roughness*u
      law%ln_pressure = log(pressure*f(1, :))
      law%slope = -2.5_wp*f(2, :)/(f(1, :)*roughness)
   end function greenwood_tripp

   !> F_5/2(u) and F_3/2(u): below `deep_u` by the moments of the Gaussian, else by quadrature.
   pure function half_integrals(u) result(f)
      real(wp), intent(in) :: u
      real(wp) :: f(2), power(2), term(2), s
      integer :: k

      power = [2.5_wp, 1.5_wp]
      if (u < deep_u) then
         term = abs(u)**power
         f = term
         do k = 1, 12
            term = term*(power - 2*k + 2)*(power - 2*k + 1)/(2*k*u**2)
            f = f + term
         end do
         return
      end if
      f = 0.0_wp
      do k = 1, nint(last_s/step_s)
         s = k*step_s
         f = f + 2*step_s*[s**6, s**4]*gaussian(s**2 + u)
      end do
   end function half_integrals

   !> Density of the standard normal distribution.
   pure elemental real(wp) function gaussian(u)
      real(wp), intent(in) :: u

      gaussian = exp(-0.5_wp*u**2)/sqrt(2*pi)
   end function gaussian

   !> The law in other units: those of length and pressure.
   pure function scaled(law, length, pressure)
      type(asperities_t), intent(in) :: law
      real(wp), intent(in) :: length, pressure
      type(asperities_t) :: scaled

      scaled = law
      scaled%roughness = law%roughness/length
      scaled%separation = law%separation/length
      scaled%ln_pressure = law%ln_pressure - log(pressure)
      scaled%slope = law%slope*length
   end function scaled

   !> Computes the pressure of the asperities at separations `h`, and its slope < 0.
   pure subroutine asperity_pressure(law, h, pressure, slope)
      type(asperities_t), intent(in) :: law
      real(wp), intent(in) :: h(:)
      real(wp), intent(out) :: pressure(:), slope(:)
      real(wp) :: t, gap, rise, c(2:3), ln_p, d, inside
      integer :: i, k, n

      n = size(law%separation)
      do i = 1, size(h)
         inside = min(max(h(i), law%separation(1)), law%separation(n))
         k = row_below(law%separation, inside)
         gap = law%separation(k + 1) - law%separation(k)
         rise = (law%ln_pressure(k + 1) - law%ln_pressure(k))/gap
         c = [3*rise - 2*law%slope(k) - law%slope(k + 1), law%slope(k) + law%slope(k + 1) - 2*rise]
         t = (inside - law%separation(k))/gap
         d = law%slope(k) + t*(2*c(2) + 3*t*c(3))
         ln_p = law%ln_pressure(k) + t*gap*(law%slope(k) + t*(c(2) + t*c(3))) + d*(h(i) - inside)
         pressure(i) = exp(min(max(ln_p, -largest_ln), largest_ln))
         slope(i) = d*pressure(i)
      end do
   end subroutine asperity_pressure

   !> Computes the mean gap at separations `h`, > 0, and its slope.
   pure elemental subroutine mean_gap(law, h, gap, slope)
      type(asperities_t), intent(in) :: law
      real(wp), intent(in) :: h
      real(wp), intent(out) :: gap, slope
      real(wp) :: u

      if (.not. law%is_gaussian) then
         gap = h
         slope = 1.0_wp
         if (h > least_gap*law%roughness) return
         slope = exp(h/(least_gap*law%roughness) - 1)
         gap = least_gap*law%roughness*slope
         return
      end if
      u = max(h/law%roughness, least_u)
      slope = 0.5_wp*erfc(-u/sqrt(2.0_wp))
      gap = law%roughness*(u*slope + gaussian(u))
      if (h/law%roughness > u) return
      gap = gap*exp(slope*(h - u*law%roughness)/gap)
      slope = slope*gap/(law%roughness*(u*slope + gaussian(u)))
   end subroutine mean_gap

   !> Computes the flow by the pressure over that through a smooth gap of the mean `gap`, at
   !> separations `h`, and the slope of its logarithm by h; `gap_slope` as of `mean_gap`.
   pure elemental subroutine flow_factor(law, h, gap, gap_slope, factor, ln_slope)
      type(asperities_t), intent(in) :: law
      real(wp), intent(in) :: h, gap, gap_slope
      real(wp), intent(out) :: factor, ln_slope
      real(wp) :: u, missing, flow

      u = max(h/law%roughness, least_flow)
      missing = flow_c*exp(-flow_r*u)
      ln_slope = (3/u + flow_r*missing/(1 - missing))/law%roughness
      flow = (1 - missing)*(u*law%roughness)**3*exp(ln_slope*min(h - u*law%roughness, 0.0_wp))
      factor = flow/max(gap**3, tiny(1.0_wp))
      ln_slope = ln_slope - 3*gap_slope/gap
   end subroutine flow_factor

end module asperities

!> Eyring's law: slip factor S of the Reynolds-Eyring equation, as ln S with its derivatives, and
!> the mean shear stress of the film.
!>
!> Effective viscosity mu/S: S >= 1, and S -> 1 (Newtonian) for an infinite Eyring stress. S itself
!> overflows at |Sigma| = 722.5, hence the logarithm.
module eyring
   use flow_law, only: flow_law_t, slip_block, slip_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: flow_shapes, mean_stresses, pressure_derivative_of_stress, slip_factor, &
      slip_factors, slip_values

   !> The law in the scales of a contact; tau_0 is `sigma_scale` and B `ln_b_scale`.
   type, extends(flow_law_t), public :: eyring_t
   contains
      procedure :: evaluate_slip, evaluate_stress, ln_slip, stress_rise
      procedure :: flow_shapes => shapes_of_drive
   end type eyring_t

   !> Value of ln B that represents B = 0 (equal surface speeds): far below any ln B that can change
   !> S [-].
   real(wp), parameter, public :: ln_b_of_no_sliding = -1.0e4_wp

   !> Larger |Sigma| and |ln B| are reduced to this, so that no power of them overflows [-].
   real(wp), parameter :: largest_argument = 1.0e60_wp

   !> If ln(B exp(-|Sigma|)) lies outside these two bounds, the 1 or the other term under the root
   !> is negligible [-].
   real(wp), parameter :: lowest_exponent = -300.0_wp, highest_exponent = 100.0_wp

   !> Below this argument arsinh uses its series, whose next term is below 4e-17 of it [-].
   real(wp), parameter :: small_stress = 1.0_wp/256.0_wp

   !> Nodes computed at a time, so that values kept for the derivatives fit into small fixed arrays.
   integer, parameter :: block_size = 64
   !> Nodes whose mean stresses are computed by the same form.
   integer, parameter :: stress_block_size = 16

   !> The series of sinh(x)/x is used up to this |x| [-]: nine terms are cut off below 1e-17 there,
   !> and the closed form above it loses no digit by cancellation (at 0.5 it would lose one).
   real(wp), parameter, public :: series_limit = 1.0_wp

   !> Series of sinh(x)/x = sum s_m x^(2m), s_m = 1/(2m + 1)!, m = 0 ... 8.
   real(wp), parameter, public :: s(0:8) = [1.0_wp, 1.0_wp/6.0_wp, 1.0_wp/120.0_wp, &
      1.0_wp/5040.0_wp, 1.0_wp/362880.0_wp, 1.0_wp/39916800.0_wp, 1.0_wp/6227020800.0_wp, &
      1.0_wp/1307674368000.0_wp, 1.0_wp/355687428096000.0_wp]

   !> Coefficients of the derivative by x, divided by x: 2 m s_m, m = 1 ... 8, and a zero.
   real(wp), parameter, public :: ds(0:8) = 2.0_wp*[s(1), 2.0_wp*s(2), 3.0_wp*s(3), 4.0_wp*s(4), &
      5.0_wp*s(5), 6.0_wp*s(6), 7.0_wp*s(7), 8.0_wp*s(8), 0.0_wp]

   !> Taylor coefficients of 3 (x cosh x - sinh x)/x^3 = sum c_m x^(2m), c_m = 6 (m + 1)/(2m + 3)!,
   !> m = 0 ... 8.
   real(wp), parameter :: c(0:8) = [1.0_wp, 1.0_wp/10.0_wp, 1.0_wp/280.0_wp, 1.0_wp/15120.0_wp, &
      1.0_wp/1330560.0_wp, 1.0_wp/172972800.0_wp, 1.0_wp/31135104000.0_wp, &
      1.0_wp/7410154752000.0_wp, 1.0_wp/2252687044608000.0_wp]

   !> Coefficients of its derivative by x, divided by x: 2 m c_m, m = 1 ... 8, and a zero.
   real(wp), parameter :: dc(0:8) = 2.0_wp*[c(1), 2.0_wp*c(2), 3.0_wp*c(3), 4.0_wp*c(4), &
      5.0_wp*c(5), 6.0_wp*c(6), 7.0_wp*c(7), 8.0_wp*c(8), 0.0_wp]

   !> Values of a block that the derivatives reuse: exp(-2|Sigma|), shear and ratio without their
   !> powers of |Sigma|, and t^2.
   type :: parts_t
      real(wp), dimension(block_size) :: decay, curve, inverse_sinh, t_squared
   end type parts_t

contains

   !> Computes S, with the derivatives if asked for.
   pure subroutine evaluate_slip(self, drive, inverse_film, ln_mu, has_slopes, slip)
      class(eyring_t), intent(in) :: self
      real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
      logical, intent(in) :: has_slopes
      type(slip_t), intent(inout) :: slip
      real(wp), dimension(slip_block) :: sigma, ln_b, by_sigma
      integer :: m

      m = size(drive)
      sigma(:m) = self%sigma_scale*drive
      ln_b(:m) = self%ln_b_scale + ln_mu
      if (.not. has_slopes) then
         call slip_values(sigma(:m), ln_b(:m), inverse_film, slip%growth(:m), slip%factor(:m))
         return
      end if
      call slip_factors(sigma(:m), ln_b(:m), inverse_film, slip%growth(:m), slip%factor(:m), &
         by_sigma(:m), slip%by_ln_mu(:m))
      slip%by_drive(:m) = by_sigma(:m)*self%sigma_scale
      slip%by_ln_film(:m) = by_sigma(:m)*sigma(:m) - slip%by_ln_mu(:m)
   end subroutine evaluate_slip

   !> Computes ln S at one point, and its derivative by the drive.
   pure elemental subroutine ln_slip(self, drive, film, ln_mu, ln_s, by_drive)
      class(eyring_t), intent(in) :: self
      real(wp), intent(in) :: drive, film, ln_mu
      real(wp), intent(out) :: ln_s, by_drive
      real(wp) :: by_ln_b

      call slip_factor(self%sigma_scale*drive, self%ln_b_scale + ln_mu - log(film), ln_s, &
         by_drive, by_ln_b)
      by_drive = by_drive*self%sigma_scale
   end subroutine ln_slip

   !> Computes the mean shear stress, in units of tau_0 = 0.5/sigma_scale [p_h b/R]; 0 where
   !> `couette` is 0, NaN where it is not known.
   pure subroutine evaluate_stress(self, couette, drive, inverse_film, ln_mu, stress)
      class(eyring_t), intent(in) :: self
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
      real(wp), intent(out), contiguous :: stress(:)
      real(wp) :: unit

      call mean_stresses(self%sigma_scale*drive, self%ln_b_scale + ln_mu, inverse_film, stress)
      unit = couette
      if (abs(couette) > 0.0_wp) unit = sign(0.5_wp/self%sigma_scale, couette)
      stress = unit*stress
   end subroutine evaluate_stress

   !> d tau/dp of sliding.
   pure elemental real(wp) function stress_rise(self, newtonian, slope) result(rise)
      class(eyring_t), intent(in) :: self
      real(wp), intent(in) :: newtonian, slope

      rise = pressure_derivative_of_stress(newtonian, 0.5_wp/self%sigma_scale, slope)
   end function stress_rise

   !> d tau/dp [-] of the flow between two walls at a given shear rate, which the derivation of
   !> Reynolds' equation assumes small: d tau/d ln mu times `slope` = d ln mu/dp [1/Pa].
   !>
   !> `newtonian`: stress mu |u2 - u1|/h [Pa] >= 0. With Eyring's tau = tau_0 asinh B, B = mu |u2 -
   !> u1|/(tau_0 h), it is tau_0 B/sqrt(1 + B^2) d ln mu/dp; `eyring`: tau_0 [Pa] > 0, or <= 0 for a
   !> Newtonian oil, for which it is the Newtonian stress times the slope. S. Bair, M. Khonsari and
   !> W. O. Winer, Tribol. Int. 31, 1998, 573.
   pure elemental real(wp) function pressure_derivative_of_stress(newtonian, eyring, &
      slope) result(derivative)
      real(wp), intent(in) :: newtonian, eyring, slope

      derivative = newtonian*slope
      if (eyring > 0.0_wp) derivative = eyring*slope*(newtonian/hypot(newtonian, eyring))
   end function pressure_derivative_of_stress

   !> `flow_shapes` with the drive H dP/dX.
   pure elemental subroutine shapes_of_drive(self, drive, y, sliding, driven)
      class(eyring_t), intent(in) :: self
      real(wp), intent(in) :: drive, y
      real(wp), intent(out) :: sliding, driven

      call flow_shapes(self%sigma_scale*drive, y, sliding, driven)
   end subroutine shapes_of_drive

   !> ln S with its derivatives by Sigma and by ln B.
   !>
   !> S = 3 (Sigma cosh Sigma - sinh Sigma)/Sigma^3 sqrt(1 + B^2 Sigma^2/sinh^2 Sigma), (A.5);
   !> (2.19) prints the same with a wrong sign of the numerator. K. L. Johnson and J. L. Tevaarwerk,
   !> Proc. R. Soc. Lond. A 356, 1977, 215; T. F. Conry, S. Wang and C. Cusano, J. Tribol. 109,
   !> 1987, 648.
   !>
   !> `sigma` = h/(2 tau_0) dp/dx [-]; `ln_b` = ln B, B = mu |u2 - u1|/(tau_0 h) [-]
   !> (`ln_b_of_no_sliding` for B = 0). Every finite argument is valid (beyond 1e60 in size it
   !> counts as 1e60). `ln_s` >= 0 and `dln_s_dln_b` (0 ... 1) are even in sigma, `dln_s_dsigma` is
   !> odd. In loops use `slip_factors`, which is vectorised.
   pure elemental subroutine slip_factor(sigma, ln_b, ln_s, dln_s_dsigma, dln_s_dln_b)
      real(wp), intent(in) :: sigma, ln_b
      real(wp), intent(out) :: ln_s, dln_s_dsigma, dln_s_dln_b
      real(wp) :: growth(1), factor(1), slope_sigma(1), slope_b(1)

      call slip_factors([sigma], [ln_b], [1.0_wp], growth, factor, slope_sigma, slope_b)
      ln_s = growth(1) + log(factor(1))
      dln_s_dsigma = slope_sigma(1)
      dln_s_dln_b = slope_b(1)
   end subroutine slip_factor

   !> Computes S = exp(growth) factor on arrays (n), with the derivatives of `slip_factor`, in loops
   !> that the compiler vectorises. S as a product saves the callers its logarithm, B = scale
   !> exp(ln_b) that of the film; `scale` 1e-40 ... 1e40.
   pure subroutine slip_factors(sigma, ln_b, scale, growth, factor, dln_s_dsigma, dln_s_dln_b)
      real(wp), intent(in), contiguous :: sigma(:), ln_b(:), scale(:)
      real(wp), intent(out), contiguous :: growth(:), factor(:), dln_s_dsigma(:), dln_s_dln_b(:)
      type(parts_t) :: parts
      integer :: first, last, m

      do first = 1, size(sigma), block_size
         last = min(first + block_size - 1, size(sigma))
         m = last - first + 1
         call block_values(sigma(first:last), ln_b(first:last), scale(first:last), &
            growth(first:last), factor(first:last), parts)
         dln_s_dln_b(first:last) = parts%t_squared(:m)/(1.0_wp + parts%t_squared(:m))
         call block_slopes(sigma(first:last), dln_s_dln_b(first:last), parts, &
            dln_s_dsigma(first:last))
      end do
   end subroutine slip_factors

   !> The values of `slip_factors` without the derivatives.
   pure subroutine slip_values(sigma, ln_b, scale, growth, factor)
      real(wp), intent(in), contiguous :: sigma(:), ln_b(:), scale(:)
      real(wp), intent(out), contiguous :: growth(:), factor(:)
      type(parts_t) :: parts
      integer :: first, last

      do first = 1, size(sigma), block_size
         last = min(first + block_size - 1, size(sigma))
         call block_values(sigma(first:last), ln_b(first:last), scale(first:last), &
            growth(first:last), factor(first:last), parts)
      end do
   end subroutine slip_values

   !> Computes S = exp(growth) factor of one block (m <= block_size), B = scale exp(ln_b).
   !>
   !> With x = |Sigma|, 3 (x cosh x - sinh x)/x^3 = exp(shift) shear and x/sinh x = exp(-shift)
   !> ratio: S = exp(shift) shear sqrt(1 + t^2), t = B ratio exp(-shift). Series and closed form are
   !> both evaluated, at arguments safe for them, and a weight of 0 or 1 selects the right one:
   !> gfortran turns `merge` into a branch around a division, which it cannot vectorise.
   pure subroutine block_values(sigma, ln_b, scale, growth, factor, parts)
      real(wp), intent(in), contiguous :: sigma(:), ln_b(:), scale(:)
      real(wp), intent(out), contiguous :: growth(:), factor(:)
      type(parts_t), intent(out) :: parts
      real(wp) :: x, y, inverse, is_small, is_large, shift, shear, ratio, exponent, t
      integer :: i

      do i = 1, size(sigma)
         x = min(abs(sigma(i)), largest_argument)
         is_large = 0.5_wp + sign(0.5_wp, x - series_limit)
         is_small = 1.0_wp - is_large
         y = min(x, series_limit)**2
         inverse = 1.0_wp/max(x, series_limit)
         parts%decay(i) = exp(-2.0_wp*max(series_limit, min(x, highest_exponent)))
         parts%curve(i) = is_small*polynomial(c, y) + is_large*((1.0_wp - inverse) &
            + (1.0_wp + inverse)*parts%decay(i))
         parts%inverse_sinh(i) = 1.0_wp/(is_small*polynomial(s, &
            y) + is_large*(1.0_wp - parts%decay(i)))
         shift = is_large*x
         shear = parts%curve(i)*(is_small + is_large*1.5_wp*inverse*inverse)
         ratio = parts%inverse_sinh(i)*(is_small + 2.0_wp*shift)
         exponent = max(-largest_argument, min(ln_b(i), largest_argument)) - shift
         t = ratio*scale(i)*exp(max(lowest_exponent, min(exponent, highest_exponent)))
         parts%t_squared(i) = t*t
         growth(i) = shift + max(exponent - highest_exponent, 0.0_wp)
         factor(i) = shear*sqrt(1.0_wp + t*t)
      end do
   end subroutine block_values

   !> d ln S/d Sigma of one block from the results of `block_values`: the derivatives of ln( 3 (x
   !> cosh x - sinh x)/x^3 ) and of ln( x/sinh x ), the second times `weight` = t^2/(1 + t^2).
   pure subroutine block_slopes(sigma, weight, parts, slope)
      real(wp), intent(in), contiguous :: sigma(:), weight(:)
      type(parts_t), intent(in) :: parts
      real(wp), intent(out), contiguous :: slope(:)
      real(wp) :: x, y, small, inverse, is_small, is_large, dln_shear, dln_ratio
      integer :: i

      do i = 1, size(sigma)
         x = min(abs(sigma(i)), largest_argument)
         is_large = 0.5_wp + sign(0.5_wp, x - series_limit)
         is_small = 1.0_wp - is_large
         small = min(x, series_limit)
         y = small*small
         inverse = 1.0_wp/max(x, series_limit)
         dln_shear = (is_small*small*polynomial(dc, y) &
            + is_large*((1.0_wp - parts%decay(i)) - 3.0_wp*inverse*parts%curve(i)))/parts%curve(i)
         dln_ratio = is_large*inverse - (is_small*small*polynomial(ds, y) &
            + is_large*(1.0_wp + parts%decay(i)))*parts%inverse_sinh(i)
         slope(i) = sign(1.0_wp, sigma(i))*(dln_shear + weight(i)*dln_ratio)
      end do
   end subroutine block_slopes

   !> Computes the mean shear stress over tau_0, without its sign, on arrays (n), with B = scale
   !> exp(ln_b) as in `slip_factors`:
   !>
   !>     stress = arsinh( B |Sigma|/sinh|Sigma| ) ,
   !>
   !> (2.14), that of the mid-plane: with it the shear rate tau_0/mu sinh(tau/tau_0) of Eyring's law
   !> integrates to u2 - u1 across the film. At the walls tau/tau_0 is that -+ Sigma. Where the
   !> exponent exceeds its bound, arsinh is the logarithm of twice its argument; small arguments use
   !> three terms of the series, which keep the relative accuracy.
   pure subroutine mean_stresses(sigma, ln_b, scale, stress)
      real(wp), intent(in), contiguous :: sigma(:), ln_b(:), scale(:)
      real(wp), intent(out), contiguous :: stress(:)
      integer :: first, last

      do first = 1, size(sigma), stress_block_size
         last = min(first + stress_block_size - 1, size(sigma))
         if (all(abs(sigma(first:last)) <= series_limit)) then
            call gentle_stresses(sigma(first:last), ln_b(first:last), scale(first:last), &
               stress(first:last))
         else
            call steep_stresses(sigma(first:last), ln_b(first:last), scale(first:last), &
               stress(first:last))
         end if
      end do
   end subroutine mean_stresses

   !> `mean_stresses` if every |Sigma| is in the range of the series: one exponential less.
   pure subroutine gentle_stresses(sigma, ln_b, scale, stress)
      real(wp), intent(in), contiguous :: sigma(:), ln_b(:), scale(:)
      real(wp), intent(out), contiguous :: stress(:)
      real(wp) :: exponent
      integer :: i

      do i = 1, size(sigma)
         exponent = max(-largest_argument, min(ln_b(i), largest_argument))
         stress(i) = arsinh(scale(i)*exp(max(lowest_exponent, min(exponent, highest_exponent))) &
            /polynomial(s, sigma(i)**2)) + max(exponent - highest_exponent, 0.0_wp)
      end do
   end subroutine gentle_stresses

   !> `mean_stresses` of any Sigma.
   pure subroutine steep_stresses(sigma, ln_b, scale, stress)
      real(wp), intent(in), contiguous :: sigma(:), ln_b(:), scale(:)
      real(wp), intent(out), contiguous :: stress(:)
      real(wp) :: x, y, is_large, shift, inverse_sinh, exponent, t
      integer :: i

      do i = 1, size(sigma)
         x = min(abs(sigma(i)), largest_argument)
         is_large = 0.5_wp + sign(0.5_wp, x - series_limit)
         shift = is_large*x
         y = min(x, series_limit)**2
         inverse_sinh = ((1.0_wp - is_large) + 2.0_wp*shift)/((1.0_wp - is_large)*polynomial(s, y) &
            + is_large*(1.0_wp - exp(-2.0_wp*max(series_limit, min(x, highest_exponent)))))
         exponent = max(-largest_argument, min(ln_b(i), largest_argument)) - shift
         t = inverse_sinh*scale(i)*exp(max(lowest_exponent, min(exponent, highest_exponent)))
         stress(i) = arsinh(t) + max(exponent - highest_exponent, 0.0_wp)
      end do
   end subroutine steep_stresses

   !> arsinh t, t >= 0, without a branch.
   pure elemental function arsinh(t) result(value)
      real(wp), intent(in) :: t
      real(wp) :: value, y, is_large

      is_large = 0.5_wp + sign(0.5_wp, t - small_stress)
      y = min(t, 1.0_wp)**2
      value = (1.0_wp - is_large)*t*(1.0_wp - y/6.0_wp + 0.075_wp*y*y) &
         + is_large*log(t + sqrt(1.0_wp + t*t))
   end function arsinh

   !> Velocity shapes across the film at y = 2 z/h - 1, from -1 at surface 1 to 1 at surface 2, for
   !> the `sigma` of `slip_factor`: u = (u1 + u2)/2 + (u2 - u1)/2 sliding - S h^2/(12 mu) dp/dx
   !> driven.
   !>
   !> The integral of du/dz = tau_0/mu sinh(tau/tau_0) with the stress of (2.6), where the speeds of
   !> the walls replace the mean stress: sliding = sinh(Sigma y)/sinh Sigma goes from -1 to 1,
   !> driven = Sigma (cosh Sigma - cosh(Sigma y))/(Sigma cosh Sigma - sinh Sigma) is 0 at both and
   !> has mean 1. A Newtonian oil, Sigma = 0, has y and 1.5 (1 - y^2).
   pure elemental subroutine flow_shapes(sigma, y, sliding, driven)
      real(wp), intent(in) :: sigma, y
      real(wp), intent(out) :: sliding, driven
      real(wp) :: x, left, right, decay

      x = min(abs(sigma), largest_argument)
      left = 0.5_wp*x*(1 + y)
      right = 0.5_wp*x*(1 - y)
      if (x <= series_limit) then
         sliding = y*polynomial(s, (x*y)**2)/polynomial(s, x**2)
         driven = 1.5_wp*(1 - y)*(1 + y)*polynomial(s, left**2)*polynomial(s, &
            right**2)/polynomial(c, x**2)
      else
         decay = exp(-2*x)
         sliding = (exp(-2*right) - exp(-2*left))/(1 - decay)
         driven = (1 - exp(-2*left))*(1 - exp(-2*right))/((1 - 1/x) + (1 + 1/x)*decay)
      end if
   end subroutine flow_shapes

   !> a_0 + a_1 y + ... + a_8 y^8.
   pure real(wp) function polynomial(a, y) result(value)
      real(wp), intent(in) :: a(0:8), y

      value = a(0) &
         + y*(a(1) + y*(a(2) + y*(a(3) + y*(a(4) + y*(a(5) + y*(a(6) + y*(a(7) + y*a(8))))))))
   end function polynomial

end module eyring

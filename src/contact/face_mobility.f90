!> Mobility e(i-1/2) = rho H^3 S/mu between two nodes by the mean of the sharp space scheme, with its derivatives:
!>
!>     e(i-1/2) = L(1/mu(i-1), 1/mu(i)) sqrt( rho(i-1) H(i-1)^3 rho(i) H(i)^3 ) S,  L(a, b) = (a - b)/(ln a - ln b)
!>
!> S at the mean ln mu, the film sqrt(H(i-1) H(i)) and the slope (P(i) - P(i-1))/dX. The logarithmic mean L is the exact
!> mean of 1/mu where ln mu is linear, as it nearly is in the inlet, where mu grows by orders of magnitude within a few nodes
!> and the arithmetic mean of e is too large. (The harmonic or geometric mean of the whole e leads to wrong films.)
module face_mobility
   use eyring, only: slip_factors, slip_values
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_density_value, fluid_ln_viscosity, fluid_t, fluid_viscosity
   use mobility, only: largest_exponent
   implicit none (type, external)
   private

   public :: fluid_face_mobility, fluid_face_slopes, face_slopes_t

   !> Faces in a block.
   integer, parameter :: block_size = 128
   !> Up to this difference of ln mu/2 the power series of sinh(x)/x is used; nine terms are cut off below 1e-17 there.
   real(wp), parameter :: series_limit = 1.0_wp
   !> Taylor coefficients 1/(2m + 1)! of sinh(x)/x in x^2, m = 0 ... 8.
   real(wp), parameter :: s(0:8) = [1.0_wp, 1.0_wp/6.0_wp, 1.0_wp/120.0_wp, 1.0_wp/5040.0_wp, 1.0_wp/362880.0_wp, &
      1.0_wp/39916800.0_wp, 1.0_wp/6227020800.0_wp, 1.0_wp/1307674368000.0_wp, 1.0_wp/355687428096000.0_wp]

   !> Mobility of the faces (1:n), face i left of node i, and its partial derivatives by P and H of both nodes.
   type :: face_slopes_t
      real(wp), allocatable :: e(:), by_p_left(:), by_p_right(:), by_h_left(:), by_h_right(:)
   end type face_slopes_t

contains

   !> Mobility of all faces (1:n) and density of all nodes (0:n); p >= 0, h > 0 (0:n). The slope inside S is that of p, and of its
   !> `rest` where that is kept.
   pure subroutine fluid_face_mobility(fluid, dx, p, h, e, rho, rest)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      real(wp), intent(out), contiguous :: e(:), rho(0:)
      real(wp), intent(in), contiguous, optional :: rest(0:)
      real(wp) :: ln_mu(0:block_size)
      real(wp), dimension(block_size) :: ln_b, scale, sigma, growth, factor, exponent, shape_factor, unused
      integer :: first, last, m

      call fluid_density_value(fluid, p, rho)
      do first = 1, ubound(p, 1), block_size
         last = min(first + block_size - 1, ubound(p, 1))
         m = last - first + 1
         call fluid_ln_viscosity(fluid, p(first - 1:last), ln_mu(:m))
         call mean_fluidity(ln_mu(:m), exponent(:m), shape_factor(:m), unused(:m))
         if (fluid%is_eyring) then
            ln_b(:m) = fluid%ln_b_scale + 0.5_wp*(ln_mu(0:m - 1) + ln_mu(1:m))
            call slip_arguments(fluid%sigma_scale/dx, p, h, first, sigma(:m), scale(:m), rest)
            call slip_values(sigma(:m), ln_b(:m), scale(:m), growth(:m), factor(:m))
            exponent(:m) = min(exponent(:m) + growth(:m), largest_exponent)
            shape_factor(:m) = shape_factor(:m)*factor(:m)
         end if
         e(first:last) = exp(exponent(:m))*shape_factor(:m)*(h(first - 1:last - 1)*h(first:last)) &
            *sqrt(h(first - 1:last - 1)*h(first:last)*rho(first - 1:last - 1)*rho(first:last))
      end do
   end subroutine fluid_face_mobility

   !> The same with all derivatives; `rho_p` (0:n) = d rho/dP.
   ! allow(too-many-arguments)  the last is optional
   pure subroutine fluid_face_slopes(fluid, dx, p, h, slopes, rho, rho_p, rest)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      type(face_slopes_t), intent(inout) :: slopes
      real(wp), intent(out), contiguous :: rho(0:), rho_p(0:)
      real(wp), intent(in), contiguous, optional :: rest(0:)
      real(wp), dimension(0:block_size) :: ln_mu, mu_p
      real(wp), dimension(block_size) :: ln_b, scale, sigma, growth, factor, s_sigma, s_b, exponent, shape_factor, slant, by_slope
      integer :: first, last, m

      call fluid_density(fluid, p, rho, rho_p)
      s_sigma = 0.0_wp
      s_b = 0.0_wp
      sigma = 0.0_wp
      do first = 1, ubound(p, 1), block_size
         last = min(first + block_size - 1, ubound(p, 1))
         m = last - first + 1
         call fluid_viscosity(fluid, p(first - 1:last), ln_mu(:m), mu_p(:m))
         call mean_fluidity(ln_mu(:m), exponent(:m), shape_factor(:m), slant(:m))
         if (fluid%is_eyring) then
            ln_b(:m) = fluid%ln_b_scale + 0.5_wp*(ln_mu(0:m - 1) + ln_mu(1:m))
            call slip_arguments(fluid%sigma_scale/dx, p, h, first, sigma(:m), scale(:m), rest)
            call slip_factors(sigma(:m), ln_b(:m), scale(:m), growth(:m), factor(:m), s_sigma(:m), s_b(:m))
            exponent(:m) = min(exponent(:m) + growth(:m), largest_exponent)
            shape_factor(:m) = shape_factor(:m)*factor(:m)
         end if
         associate (e => slopes%e(first:last), h_left => h(first - 1:last - 1), h_right => h(first:last), &
            rho_left => rho(first - 1:last - 1), rho_right => rho(first:last))
            e = exp(exponent(:m))*shape_factor(:m)*(h_left*h_right) &
               *sqrt(h_left*h_right*rho_left*rho_right)
            by_slope(:m) = s_sigma(:m)*fluid%sigma_scale*sqrt(h_left*h_right)/dx
            slopes%by_p_left(first:last) = e*(0.5_wp*rho_p(first - 1:last - 1)/rho_left &
               + 0.5_wp*(s_b(:m) - 1 - slant(:m))*mu_p(0:m - 1) - by_slope(:m))
            slopes%by_p_right(first:last) = e*(0.5_wp*rho_p(first:last)/rho_right &
               + 0.5_wp*(s_b(:m) - 1 + slant(:m))*mu_p(1:m) + by_slope(:m))
            slopes%by_h_left(first:last) = e*0.5_wp*(3 + s_sigma(:m)*sigma(:m) - s_b(:m))/h_left
            slopes%by_h_right(first:last) = e*0.5_wp*(3 + s_sigma(:m)*sigma(:m) - s_b(:m))/h_right
         end associate
      end do
   end subroutine fluid_face_slopes

   !> L(1/mu(i-1), 1/mu(i)) = exp(exponent) shape_factor of the m faces between m + 1 nodes, and `slant`, its relative change
   !> with x = (ln mu(i) - ln mu(i-1))/2 at constant mean: L = exp(-mean) sinh(x)/x, slant = coth x - 1/x.
   pure subroutine mean_fluidity(ln_mu, exponent, shape_factor, slant)
      real(wp), intent(in), contiguous :: ln_mu(0:)
      real(wp), intent(out), contiguous :: exponent(:), shape_factor(:), slant(:)
      real(wp) :: x, y, small, large, decay, is_small, is_large, series
      integer :: i

      do i = 1, size(exponent)
         x = 0.5_wp*(ln_mu(i) - ln_mu(i - 1))
         is_large = 0.5_wp + sign(0.5_wp, abs(x) - series_limit)
         is_small = 1.0_wp - is_large
         small = min(max(x, -series_limit), series_limit)
         large = max(abs(x), series_limit)
         y = small*small
         series = s(0) + y*(s(1) + y*(s(2) + y*(s(3) + y*(s(4) + y*(s(5) + y*(s(6) + y*(s(7) + y*s(8))))))))
         decay = exp(-2*large)
         exponent(i) = is_large*large - 0.5_wp*(ln_mu(i - 1) + ln_mu(i))
         shape_factor(i) = is_small*series + is_large*0.5_wp*(1 - decay)/large
         slant(i) = is_small*2*small*(s(1) + y*(2*s(2) + y*(3*s(3) + y*(4*s(4) + y*(5*s(5) + y*(6*s(6) &
            + y*(7*s(7) + y*8*s(8))))))))/series + is_large*sign(1.0_wp, x)*((1 + decay)/(1 - decay) - 1/large)
      end do
   end subroutine mean_fluidity

   !> Sigma = `sigma_scale` dX H dP/dX of the slip factor at the faces from `first` on, and the factor 1/H of its B.
   pure subroutine slip_arguments(sigma_scale, p, h, first, sigma, inverse_film, rest)
      real(wp), intent(in) :: sigma_scale
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      integer, intent(in) :: first
      real(wp), intent(out), contiguous :: sigma(:), inverse_film(:)
      real(wp), intent(in), contiguous, optional :: rest(0:)
      real(wp) :: film
      integer :: i

      do i = first, first + size(sigma) - 1
         film = sqrt(h(i - 1)*h(i))
         inverse_film(i - first + 1) = 1.0_wp/film
         sigma(i - first + 1) = sigma_scale*film*(p(i) - p(i - 1))
      end do
      if (present(rest)) then
         do i = first, first + size(sigma) - 1
            sigma(i - first + 1) = sigma(i - first + 1) + sigma_scale*(rest(i) - rest(i - 1))/inverse_film(i - first + 1)
         end do
      end if
   end subroutine slip_arguments

end module face_mobility

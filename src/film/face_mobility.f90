!> Mobility e(i-1/2) = rho H^3 S/mu between two nodes by the mean of the kappa space scheme, with
!> its derivatives:
!>
!>     e(i-1/2) = L(1/mu(i-1), 1/mu(i)) sqrt( rho(i-1) H(i-1)^3 rho(i) H(i)^3 ) S,
!>     L(a, b) = (a - b)/(ln a - ln b)
!>
!> S is that of the mean ln mu, the film sqrt(H(i-1) H(i)) and the slope (P(i) - P(i-1))/dX. The
!> logarithmic mean L is the exact mean of 1/mu if ln mu is linear, as it nearly is in the inlet,
!> where mu grows by orders of magnitude within a few nodes and the arithmetic mean of e is too
!> large. (The harmonic or geometric mean of e gives wrong films.)
module face_mobility
   use eyring, only: ds, s, series_limit
   use film_state, only: film_state_t
   use flow_law, only: block_size => slip_block, largest_exponent, slip_t
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_t
   use mobility, only: coefficients_t, mobility_slopes_t, oil_viscosity
   implicit none (type, external)
   private

   public :: fluid_face_mobility, mean_fluidity

contains

   !> Sets the mobility of all faces, density and ln(mu/mu_0) of all nodes for the pressure >= 0 and
   !> the film > 0 of `state` (0:n), and with `slopes` their derivatives. The slope inside S is that
   !> of P, and of its compensation where that is kept. `spacing`: of all intervals (n), or one that
   !> all have (1).
   pure subroutine fluid_face_mobility(fluid, spacing, state, oil, slopes)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in), contiguous :: spacing(:)
      type(film_state_t), intent(in) :: state
      type(coefficients_t), intent(inout) :: oil
      type(mobility_slopes_t), intent(inout), optional :: slopes
      real(wp) :: mu_p(0:block_size)
      real(wp), dimension(block_size) :: mean_ln_mu, drive, inverse_film, exponent, shape_factor, &
         slant, by_slope, dx
      type(slip_t) :: slip
      integer :: first, last, m

      if (present(slopes)) then
         call fluid_density(fluid, state%pressure, oil%density, slopes%rho_p)
      else
         call fluid_density(fluid, state%pressure, oil%density)
      end if
      do first = 1, ubound(state%pressure, 1), block_size
         last = min(first + block_size - 1, ubound(state%pressure, 1))
         m = last - first + 1
         call oil_viscosity(fluid, first - 1, state%pressure(first - 1:last), oil, mu_p)
         call mean_fluidity(oil%ln_mu(first - 1:last - 1), oil%ln_mu(first:last), exponent(:m), &
            shape_factor(:m), slant(:m))
         if (allocated(fluid%rheology)) then
            mean_ln_mu(:m) = 0.5_wp*(oil%ln_mu(first - 1:last - 1) + oil%ln_mu(first:last))
            dx(:m) = spacing(1)
            if (size(spacing) > 1) dx(:m) = spacing(first:last)
            call drive_at_faces(dx(:m), state, first, drive(:m), inverse_film(:m))
            call fluid%rheology%evaluate_slip(drive(:m), inverse_film(:m), mean_ln_mu(:m), &
               present(slopes), slip)
            exponent(:m) = min(exponent(:m) + slip%growth(:m), largest_exponent)
            shape_factor(:m) = shape_factor(:m)*slip%factor(:m)
         end if
         oil%face_mobility(first:last) = exp(exponent(:m))*shape_factor(:m)*(state%film(first &
            - 1:last - 1)*state%film(first:last))*sqrt(state%film(first - 1:last - 1) &
            *state%film(first:last)*oil%density(first - 1:last - 1)*oil%density(first:last))
         if (.not. present(slopes)) cycle
         associate (e => oil%face_mobility(first:last), h_left => state%film(first - 1:last - 1), &
            h_right => state%film(first:last), rho => oil%density, rho_p => slopes%rho_p)
            by_slope(:m) = 0.0_wp
            if (allocated(fluid%rheology)) by_slope(:m) = slip%by_drive(:m)*sqrt(h_left*h_right) &
               /dx(:m)
            slopes%by_p_left(first:last) = e*(0.5_wp*rho_p(first - 1:last - 1)/rho(first - 1:last &
               - 1) + 0.5_wp*(slip%by_ln_mu(:m) - 1 - slant(:m))*mu_p(0:m - 1) - by_slope(:m))
            slopes%by_p_right(first:last) = e*(0.5_wp*rho_p(first:last)/rho(first:last) &
               + 0.5_wp*(slip%by_ln_mu(:m) - 1 + slant(:m))*mu_p(1:m) + by_slope(:m))
            slopes%by_h_left(first:last) = e*0.5_wp*(3 + slip%by_ln_film(:m))/h_left
            slopes%by_h_right(first:last) = e*0.5_wp*(3 + slip%by_ln_film(:m))/h_right
         end associate
      end do
   end subroutine fluid_face_mobility

   !> L(1/mu_1, 1/mu_2) = exp(exponent) shape_factor of m faces between nodes with ln mu `left` and
   !> `right`, and `slant`, its relative change with x = (ln mu_2 - ln mu_1)/2 at constant mean:
   !> L = exp(-mean) sinh(x)/x, slant = coth x - 1/x.
   pure subroutine mean_fluidity(left, right, exponent, shape_factor, slant)
      real(wp), intent(in), contiguous :: left(:), right(:)
      real(wp), intent(out), contiguous :: exponent(:), shape_factor(:), slant(:)
      real(wp) :: x, y, small, large, decay, is_small, is_large, series, slope
      integer :: i

      do i = 1, size(exponent)
         x = 0.5_wp*(right(i) - left(i))
         is_large = 0.5_wp + sign(0.5_wp, abs(x) - series_limit)
         is_small = 1.0_wp - is_large
         small = min(max(x, -series_limit), series_limit)
         large = max(abs(x), series_limit)
         y = small*small
         series = s(0) &
            + y*(s(1) + y*(s(2) + y*(s(3) + y*(s(4) + y*(s(5) + y*(s(6) + y*(s(7) + y*s(8))))))))
         decay = exp(-2*large)
         exponent(i) = is_large*large - 0.5_wp*(left(i) + right(i))
         shape_factor(i) = is_small*series + is_large*0.5_wp*(1 - decay)/large
         slope = ds(0) &
            + y*(ds(1) + y*(ds(2) + y*(ds(3) + y*(ds(4) + y*(ds(5) + y*(ds(6) + y*ds(7)))))))
         slant(i) = is_small*small*slope/series + is_large*sign(1.0_wp, &
            x)*((1 + decay)/(1 - decay) - 1/large)
      end do
   end subroutine mean_fluidity

   !> H dP/dX and 1/H at the faces from `first` on, with their spacings `dx`.
   pure subroutine drive_at_faces(dx, state, first, drive, inverse_film)
      real(wp), intent(in), contiguous :: dx(:)
      type(film_state_t), intent(in) :: state
      integer, intent(in) :: first
      real(wp), intent(out), contiguous :: drive(:), inverse_film(:)
      real(wp) :: film
      integer :: i

      associate (p => state%pressure, h => state%film)
         do i = first, first + size(drive) - 1
            film = sqrt(h(i - 1)*h(i))
            inverse_film(i - first + 1) = 1.0_wp/film
            drive(i - first + 1) = film*(p(i) - p(i - 1))/dx(i - first + 1)
         end do
      end associate
      if (.not. allocated(state%compensation)) return
      do i = first, first + size(drive) - 1
         drive(i - first + 1) = drive(i - first + 1) + (state%compensation(i) &
            - state%compensation(i - 1))/(dx(i - first + 1)*inverse_film(i - first + 1))
      end do
   end subroutine drive_at_faces

end module face_mobility

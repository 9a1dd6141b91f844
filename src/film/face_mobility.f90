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
   use flow_law, only: block_size => slip_block, largest_exponent, slip_t
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_t, fluid_viscosity
   use eyring, only: ds, s, series_limit
   implicit none (type, external)
   private

   public :: face_slopes_t, fluid_face_mobility, fluid_face_slopes

   !> Mobility of the faces (1:n), face i left of node i, and its partial derivatives by P and H of
   !> both nodes.
   type :: face_slopes_t
      real(wp), allocatable :: e(:), by_p_left(:), by_p_right(:), by_h_left(:), by_h_right(:)
   end type face_slopes_t

contains

   !> Mobility of all faces (1:n), density and `all_ln_mu` = ln(mu/mu_0) of all nodes (0:n); p >= 0,
   !> h > 0 (0:n). The slope inside S is that of p, and of its `compensation` where that is kept.
   ! allow(too-many-arguments)  the last are optional
   pure subroutine fluid_face_mobility(fluid, dx, p, h, e, rho, compensation, all_ln_mu)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      real(wp), intent(out), contiguous :: e(:), rho(0:)
      real(wp), intent(in), contiguous, optional :: compensation(0:)
      real(wp), intent(out), contiguous, optional :: all_ln_mu(0:)
      real(wp) :: ln_mu(0:block_size)
      real(wp), dimension(block_size) :: mean_ln_mu, drive, inverse_film, exponent, shape_factor, &
         unused
      type(slip_t) :: slip
      integer :: first, last, m

      call fluid_density(fluid, p, rho)
      do first = 1, ubound(p, 1), block_size
         last = min(first + block_size - 1, ubound(p, 1))
         m = last - first + 1
         call fluid_viscosity(fluid, p(first - 1:last), ln_mu(:m))
         if (present(all_ln_mu)) all_ln_mu(first - 1:last) = ln_mu(:m)
         call mean_fluidity(ln_mu(:m), exponent(:m), shape_factor(:m), unused(:m))
         if (allocated(fluid%rheology)) then
            mean_ln_mu(:m) = 0.5_wp*(ln_mu(0:m - 1) + ln_mu(1:m))
            call drive_at_faces(dx, p, h, first, drive(:m), inverse_film(:m), compensation)
            call fluid%rheology%evaluate_slip(drive(:m), inverse_film(:m), mean_ln_mu(:m), &
               .false., slip)
            exponent(:m) = min(exponent(:m) + slip%growth(:m), largest_exponent)
            shape_factor(:m) = shape_factor(:m)*slip%factor(:m)
         end if
         e(first:last) = exp(exponent(:m))*shape_factor(:m)*(h(first - 1:last - 1)*h(first:last)) &
            *sqrt(h(first - 1:last - 1)*h(first:last)*rho(first - 1:last - 1)*rho(first:last))
      end do
   end subroutine fluid_face_mobility

   !> The same with all derivatives; `rho_p` (0:n) = d rho/dP.
   ! allow(too-many-arguments)  the last is optional
   pure subroutine fluid_face_slopes(fluid, dx, p, h, slopes, rho, rho_p, compensation)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      type(face_slopes_t), intent(inout) :: slopes
      real(wp), intent(out), contiguous :: rho(0:), rho_p(0:)
      real(wp), intent(in), contiguous, optional :: compensation(0:)
      real(wp), dimension(0:block_size) :: ln_mu, mu_p
      real(wp), dimension(block_size) :: mean_ln_mu, drive, inverse_film, exponent, shape_factor, &
         slant, by_slope
      type(slip_t) :: slip
      integer :: first, last, m

      call fluid_density(fluid, p, rho, rho_p)
      do first = 1, ubound(p, 1), block_size
         last = min(first + block_size - 1, ubound(p, 1))
         m = last - first + 1
         call fluid_viscosity(fluid, p(first - 1:last), ln_mu(:m), mu_p(:m))
         call mean_fluidity(ln_mu(:m), exponent(:m), shape_factor(:m), slant(:m))
         if (allocated(fluid%rheology)) then
            mean_ln_mu(:m) = 0.5_wp*(ln_mu(0:m - 1) + ln_mu(1:m))
            call drive_at_faces(dx, p, h, first, drive(:m), inverse_film(:m), compensation)
            call fluid%rheology%evaluate_slip(drive(:m), inverse_film(:m), mean_ln_mu(:m), &
               .true., slip)
            exponent(:m) = min(exponent(:m) + slip%growth(:m), largest_exponent)
            shape_factor(:m) = shape_factor(:m)*slip%factor(:m)
         end if
         associate (e => slopes%e(first:last), h_left => h(first - 1:last - 1), &
            h_right => h(first:last), &
            rho_left => rho(first - 1:last - 1), rho_right => rho(first:last))
            e = exp(exponent(:m))*shape_factor(:m)*(h_left*h_right) &
               *sqrt(h_left*h_right*rho_left*rho_right)
            by_slope(:m) = slip%by_drive(:m)*sqrt(h_left*h_right)/dx
            slopes%by_p_left(first:last) = e*(0.5_wp*rho_p(first - 1:last - 1)/rho_left &
               + 0.5_wp*(slip%by_ln_mu(:m) - 1 - slant(:m))*mu_p(0:m - 1) - by_slope(:m))
            slopes%by_p_right(first:last) = e*(0.5_wp*rho_p(first:last)/rho_right &
               + 0.5_wp*(slip%by_ln_mu(:m) - 1 + slant(:m))*mu_p(1:m) + by_slope(:m))
            slopes%by_h_left(first:last) = e*0.5_wp*(3 + slip%by_ln_film(:m))/h_left
            slopes%by_h_right(first:last) = e*0.5_wp*(3 + slip%by_ln_film(:m))/h_right
         end associate
      end do
   end subroutine fluid_face_slopes

   !> L(1/mu(i-1), 1/mu(i)) = exp(exponent) shape_factor of the m faces between m + 1 nodes, and
   !> `slant`, its relative change with x = (ln mu(i) - ln mu(i-1))/2 at constant mean:
   !> L = exp(-mean) sinh(x)/x, slant = coth x - 1/x.
   pure subroutine mean_fluidity(ln_mu, exponent, shape_factor, slant)
      real(wp), intent(in), contiguous :: ln_mu(0:)
      real(wp), intent(out), contiguous :: exponent(:), shape_factor(:), slant(:)
      real(wp) :: x, y, small, large, decay, is_small, is_large, series, slope
      integer :: i

      do i = 1, size(exponent)
         x = 0.5_wp*(ln_mu(i) - ln_mu(i - 1))
         is_large = 0.5_wp + sign(0.5_wp, abs(x) - series_limit)
         is_small = 1.0_wp - is_large
         small = min(max(x, -series_limit), series_limit)
         large = max(abs(x), series_limit)
         y = small*small
         series = s(0) &
            + y*(s(1) + y*(s(2) + y*(s(3) + y*(s(4) + y*(s(5) + y*(s(6) + y*(s(7) + y*s(8))))))))
         decay = exp(-2*large)
         exponent(i) = is_large*large - 0.5_wp*(ln_mu(i - 1) + ln_mu(i))
         shape_factor(i) = is_small*series + is_large*0.5_wp*(1 - decay)/large
         slope = ds(0) &
            + y*(ds(1) + y*(ds(2) + y*(ds(3) + y*(ds(4) + y*(ds(5) + y*(ds(6) + y*ds(7)))))))
         slant(i) = is_small*small*slope/series + is_large*sign(1.0_wp, &
            x)*((1 + decay)/(1 - decay) - 1/large)
      end do
   end subroutine mean_fluidity

   !> H dP/dX and 1/H at the faces from `first` on.
   pure subroutine drive_at_faces(dx, p, h, first, drive, inverse_film, compensation)
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      integer, intent(in) :: first
      real(wp), intent(out), contiguous :: drive(:), inverse_film(:)
      real(wp), intent(in), contiguous, optional :: compensation(0:)
      real(wp) :: film
      integer :: i

      do i = first, first + size(drive) - 1
         film = sqrt(h(i - 1)*h(i))
         inverse_film(i - first + 1) = 1.0_wp/film
         drive(i - first + 1) = film*(p(i) - p(i - 1))/dx
      end do
      if (present(compensation)) then
         do i = first, first + size(drive) - 1
            drive(i - first + 1) = drive(i - first + 1) &
               + (compensation(i) - compensation(i - 1))/(dx*inverse_film(i - first + 1))
         end do
      end if
   end subroutine drive_at_faces

end module face_mobility

!> Mobility e = rho H^3 S/mu of the Reynolds-Eyring equation on a grid, with its derivatives.
!>
!> All laws are joined in ONE exponential, e = rho H^3 f exp(g - ln mu) with S = f exp(g), to avoid
!> overflow (ln mu reaches 714). Nodes are computed in blocks that stay in cache; each loop calls
!> only the laws' array loops.
!>
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
module mobility
   use eyring, only: ds, s, series_limit
   use film_state, only: film_state_t
   use flow_law, only: block_size => slip_block, largest_exponent, slip_t
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_t, fluid_viscosity
   implicit none (type, external)
   private

   public :: bent_step, coefficients_t, fluid_face_mobility, fluid_mobility, fluidity_between, &
      mobility_slopes_t, oil_viscosity

   !> A step is bent where it changes ln e by more than this.
   real(wp), parameter :: small_change = 0.3_wp
   !> Most exp(-2 |x|) of an x whose sinh(x)/x is not that of the series.
   real(wp), parameter :: most_decay = exp(-2*series_limit)
   !> The oil of a node flows where its mobility exceeds this share of the diagonal (1000 Newtonian
   !> contacts: of 0.02-2 the fastest).
   real(wp), parameter, public :: flowing_share = 0.1_wp

   !> Coefficients of the equation: e (of the upwind2 scheme), rho and ln(mu/mu_0) of the nodes
   !> (0:n), mobility e(i-1/2) of the face left of node i (1:n). Where oil is conserved in cavities,
   !> share theta of the film that it fills (0:n); else not allocated.
   type :: coefficients_t
      real(wp), allocatable :: mobility(:), density(:), ln_mu(:), face_mobility(:), saturation(:)
      !> Of a warm film: ln(mu/mu_0) is factor times the law plus shift (0:n).
      real(wp), allocatable :: factor(:), shift(:)
      !> Mass flux that arrives at most, over (u1 + u2)/u_ref.
      real(wp) :: supply = huge(1.0_wp)
   end type coefficients_t

   !> Their derivatives: of rho by P(i), of e by P(i), H(i) and the slope dP/dX(i) inside S, each
   !> (0:n); of e(i-1/2) by P and H of both nodes (1:n), allocated where the kappa scheme is used.
   type :: mobility_slopes_t
      real(wp), allocatable :: rho_p(:), e_p(:), e_h(:), e_slope(:)
      real(wp), allocatable :: by_p_left(:), by_p_right(:), by_h_left(:), by_h_right(:)
   end type mobility_slopes_t

contains

   !> Sets mobility, density and ln(mu/mu_0) of all nodes for the pressure >= 0 and the film > 0 of
   !> `state` (0:n), and with `slopes` their derivatives. The slope inside S is the central
   !> difference of P, and of its compensation where that is kept, 0 at both ends; S follows its
   !> formula at every node, also where P = 0.
   pure subroutine fluid_mobility(fluid, dx, state, oil, slopes)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: dx
      type(film_state_t), intent(in) :: state
      type(coefficients_t), intent(inout) :: oil
      type(mobility_slopes_t), intent(inout), optional :: slopes
      real(wp), dimension(block_size) :: mu_p, drive, inverse_film
      type(slip_t) :: slip
      integer :: first, last, m, n

      n = ubound(state%pressure, 1)
      do first = 0, n, block_size
         last = min(first + block_size - 1, n)
         m = last - first + 1
         call oil_viscosity(fluid, first, state%pressure(first:last), oil, mu_p)
         if (present(slopes)) then
            call fluid_density(fluid, state%pressure(first:last), oil%density(first:last), &
               slopes%rho_p(first:last))
         else
            call fluid_density(fluid, state%pressure(first:last), oil%density(first:last))
         end if
         if (allocated(fluid%rheology)) then
            call drive_at_nodes(dx, state, first, drive(:m), inverse_film(:m))
            call fluid%rheology%evaluate_slip(drive(:m), inverse_film(:m), oil%ln_mu(first:last), &
               present(slopes), slip)
         end if
         oil%mobility(first:last) = oil%density(first:last)*state%film(first:last)**3 &
            *slip%factor(:m)*exp(min(slip%growth(:m) - oil%ln_mu(first:last), largest_exponent))
         if (.not. present(slopes)) cycle
         associate (e => oil%mobility(first:last), h => state%film(first:last))
            slopes%e_p(first:last) = e*(slopes%rho_p(first:last)/oil%density(first:last) &
               + (slip%by_ln_mu(:m) - 1)*mu_p(:m))
            slopes%e_h(first:last) = e*(3 + slip%by_ln_film(:m))/h
            slopes%e_slope(first:last) = e*slip%by_drive(:m)*h
         end associate
      end do
      if (present(slopes)) slopes%e_slope(0::n) = 0.0_wp
   end subroutine fluid_mobility

   !> Sets ln(mu/mu_0) of the nodes from `first` on, and its slope, at the pressure `p` there.
   pure subroutine oil_viscosity(fluid, first, p, oil, slope)
      type(fluid_t), intent(in) :: fluid
      integer, intent(in) :: first
      real(wp), intent(in), contiguous :: p(:)
      type(coefficients_t), intent(inout) :: oil
      real(wp), intent(inout), contiguous :: slope(:)

      associate (last => first + size(p) - 1)
         call fluid_viscosity(fluid, p, oil%ln_mu(first:last), slope(:size(p)))
         if (.not. allocated(oil%factor)) return
         oil%ln_mu(first:last) = oil%factor(first:last)*oil%ln_mu(first:last) &
            + oil%shift(first:last)
         slope(:size(p)) = oil%factor(first:last)*slope(:size(p))
      end associate
   end subroutine oil_viscosity

   !> H dP/dX at the nodes from `first` on by central differences, 0 at both ends, and 1/H.
   pure subroutine drive_at_nodes(dx, state, first, drive, inverse_film)
      real(wp), intent(in) :: dx
      type(film_state_t), intent(in) :: state
      integer, intent(in) :: first
      real(wp), intent(out), contiguous :: drive(:), inverse_film(:)
      real(wp) :: factor
      integer :: i, n

      n = ubound(state%pressure, 1)
      factor = 0.5_wp/dx
      associate (p => state%pressure, h => state%film)
         do i = max(first, 1), min(first + size(drive) - 1, n - 1)
            drive(i - first + 1) = factor*h(i)*(p(i + 1) - p(i - 1))
         end do
         if (allocated(state%compensation)) then
            do i = max(first, 1), min(first + size(drive) - 1, n - 1)
               drive(i - first + 1) = drive(i - first + 1) + factor*h(i)*(state%compensation(i &
                  + 1) - state%compensation(i - 1))
            end do
         end if
         if (first == 0) drive(1) = 0.0_wp
         if (first + size(drive) - 1 == n) drive(n - first + 1) = 0.0_wp
         inverse_film = 1.0_wp/h(first:first + size(drive) - 1)
      end associate
   end subroutine drive_at_nodes

   !> The `step` of P at a node, bent if it changes the mobility `e` by much; `slope` = de/dP, the
   !> oil flows where e > `flowing`.
   !>
   !> Where oil is nearly solid, its film fixes P, linearly; where it flows, the flow is linear, in
   !> e ~ exp(-a P). A falling pressure goes no further than to where the oil begins to flow, or to
   !> where e has grown as its tangent in P predicts; a rising one as far as e falls by that
   !> tangent, but not past where the flow ends. Unbent, the step overshoots at a spike, which then
   !> comes back by one e-fold, or one node, a step.
   pure elemental real(wp) function bent_step(step, e, slope, flowing)
      real(wp), intent(in) :: step, e, slope, flowing
      real(wp) :: bent, change, flow, rate

      bent_step = step
      if (abs(slope*step) <= small_change*e) return   ! also where e = 0, of a solid
      rate = -slope/e
      change = rate*step
      flow = log(max(e/flowing, tiny(e)))
      bent = flow
      if (change < 1.0_wp) bent = min(flow, -log(1 - change))
      if (bent > change) bent_step = bent/rate
   end function bent_step

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
      real(wp) :: is_large, large, x
      integer :: i

      do i = 1, size(exponent)
         x = 0.5_wp*(right(i) - left(i))
         large = max(abs(x), series_limit)
         call shape_mean(x, exp(-2*large), is_large, shape_factor(i), slant(i))
         exponent(i) = is_large*large - 0.5_wp*(left(i) + right(i))
      end do
   end subroutine mean_fluidity

   !> The mean L itself and `slant`, of nodes whose fluidities 1/mu are known too: no exponentials.
   pure subroutine fluidity_between(left, right, of_left, of_right, mean, slant)
      real(wp), intent(in), contiguous :: left(:), right(:), of_left(:), of_right(:)
      real(wp), intent(out), contiguous :: mean(:), slant(:)
      real(wp) :: decay, is_large, larger, shape_factor
      integer :: i

      do i = 1, size(mean)
         larger = max(of_left(i), of_right(i))
         decay = min(of_left(i), of_right(i))/max(larger, tiny(larger))
         call shape_mean(0.5_wp*(right(i) - left(i)), min(decay, most_decay), is_large, &
            shape_factor, slant(i))
         mean(i) = larger*shape_factor*(is_large + (1.0_wp - is_large)*sqrt(decay))
      end do
   end subroutine fluidity_between

   !> sinh(x)/x, over exp(|x|) if `is_large`, 1 or 0, and `slant`; `decay` = exp(-2 |x|), at most
   !> `most_decay`. Private, so that position-independent code also inlines it in the loops.
   pure elemental subroutine shape_mean(x, decay, is_large, shape_factor, slant)
      real(wp), intent(in) :: x, decay
      real(wp), intent(out) :: is_large, shape_factor, slant
      real(wp) :: y, small, large, is_small, series, slope

      is_large = 0.5_wp + sign(0.5_wp, abs(x) - series_limit)
      is_small = 1.0_wp - is_large
      small = min(max(x, -series_limit), series_limit)
      large = max(abs(x), series_limit)
      y = small*small
      series = s(0) &
         + y*(s(1) + y*(s(2) + y*(s(3) + y*(s(4) + y*(s(5) + y*(s(6) + y*(s(7) + y*s(8))))))))
      shape_factor = is_small*series + is_large*0.5_wp*(1 - decay)/large
      slope = ds(0) &
         + y*(ds(1) + y*(ds(2) + y*(ds(3) + y*(ds(4) + y*(ds(5) + y*(ds(6) + y*ds(7)))))))
      slant = is_small*small*slope/series + is_large*sign(1.0_wp, &
         x)*((1 + decay)/(1 - decay) - 1/large)
   end subroutine shape_mean

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

end module mobility

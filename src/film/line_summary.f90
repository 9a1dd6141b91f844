!> Quantities of a state of a lubricated line contact, or their extremes over several times, each
!> with its known errors.
!>
!> Dimensionless (H, P, X, T).
module line_summary
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: exceeds, larger, not_known, wp
   use line_state, only: friction_t, line_state_t, reynolds_limits_t, turned, unknown_limits, &
      widen_limits
   use quantities, only: h_central, h_min, h_min_node, p_max, parabola_extreme, quantity_count, &
      quantity_rows, quantity_values, rolling_power, rule_between, rule_crest, &
      rule_node, sliding_power, smallest_film
   implicit none (type, external)
   private

   public :: crests_t, keep_extremes, line_summary_t, mean_power, new_quantity, quantity_t, &
      summary_of, summary_of_fields, copy_values, value_between

   !> One quantity, the time at which it was reached, and its errors.
   type :: quantity_t
      real(wp) :: value
      !> Value between the nodes, from which errors are estimated.
      real(wp) :: between
      !> T at which it was reached; 0 in steady state.
      real(wp) :: time
      !> Estimated error of `value`: sum of the five below; NaN = not estimated.
      real(wp) :: error_estimate
      !> Richardson extrapolation of `value`, for x_cavitation of the exit between the nodes; NaN =
      !> not known.
      real(wp) :: extrapolated
      !> Error by grid and time step; NaN = not estimated.
      real(wp) :: error_grid
      !> Errors by the finite domain and by the iteration; 0 = not estimated.
      real(wp) :: error_domain = 0.0_wp, error_iteration = 0.0_wp
      !> Error by the start of a transient: NaN = the quantity includes the start.
      real(wp) :: error_start = 0.0_wp
      !> Error by what was left out of the model; NaN = not known.
      real(wp) :: error_model = 0.0_wp
   end type quantity_t

   !> Maxima of P; NaN: there is none.
   type :: crests_t
      !> The largest one, and the largest except the spike, each by the parabola through three
      !> nodes.
      real(wp) :: highest, other
      !> The spike, the last maximum before the exit if P falls behind it by `spike_drop` of its
      !> value within two spacings: P and H of its top node.
      real(wp) :: spike, spike_film
      !> That maximum if the grid does not resolve its bends: P of its node, and its possible height
      !> between the nodes; 0: resolved; negative: extremes of several times.
      real(wp) :: corner = 0.0_wp, corner_top = 0.0_wp
      !> Part of the spike that grows on finer grids, A of B + A/sqrt(distance); 0: all of it.
      real(wp) :: growing = 0.0_wp
      !> Share by which P falls behind the spike within two spacings, and the most that it reaches
      !> if it is a smooth crest.
      real(wp) :: fall = 0.0_wp, limit = huge(1.0_wp)
   end type crests_t

   !> (Of 90 contacts on 64 to 32768 intervals unresolved spikes fell by 0.3 and more, other maxima
   !> by 0.02 and less; those that fell by 0.08 to 0.3 still grew by up to 7 %.)
   real(wp), parameter :: spike_drop = 0.1_wp
   !> A bend is a corner if the slope changes there, from one spacing to the next, by more than this
   !> share of the steepest slope: by 1 to 2 where flanks meet, by 1/5 at a parabola whose
   !> `spike_drop` takes five spacings.
   real(wp), parameter :: corner_share = 0.2_wp

   !> Quantities of one time, or the extremes over several.
   type :: line_summary_t
      !> In the order of the table of quantities.
      type(quantity_t) :: of(quantity_count)
      !> Maxima from which the error of p_max is estimated; over several times the largest.
      type(crests_t) :: crests
      !> Distance from the limit of Reynolds' equation; over several times the largest.
      type(reynolds_limits_t) :: limits
      !> Relative growth of the load of asperities by that of the film, negative.
      real(wp) :: asperity_response = 0.0_wp
      !> Power of sliding and rolling together at the last time, that time, and what it has added up
      !> to over a span.
      real(wp) :: power = 0.0_wp, last_time = 0.0_wp, work = 0.0_wp, span = 0.0_wp
   end type line_summary_t

contains

   !> Quantities of one state. Of a point contact smallest film, largest pressure and friction are
   !> those of all nodes, maxima those on the row of the largest pressure, others on the middle row.
   pure recursive function summary_of(state) result(summary)
      type(line_state_t), intent(in) :: state
      type(line_summary_t) :: summary
      real(wp) :: highest
      integer :: first, last, top

      if (sum(state%moment%speeds) < 0.0_wp) then   ! the exit is where the oil flows to
         summary = summary_of(turned(state))
         return
      end if
      first = 1
      if (allocated(state%y)) first = size(state%x)*(size(state%y)/2) + 1
      last = first + size(state%x) - 1
      associate (x => state%x, p => state%pressure, h => state%film_thickness, time => state%time)
         summary = summary_of_fields(x, p(first:last), h(first:last), time, state%friction, &
            state%asperity_pressure)
         if (allocated(state%limits)) summary%limits = state%limits
         if (.not. allocated(state%y)) return
         summary%of(h_min) = new_quantity(h_min, spread(smallest_film(x, h), 1, 2), time)
         summary%of(h_min_node) = new_quantity(h_min_node, [minval(h), &
            summary%of(h_min)%value], time)
         summary%of(h_central)%between = summary%of(h_central)%value
         top = size(x)*((maxloc(p, 1) - 1)/size(x))
         summary%crests = crests_of(x, p(top + 1:top + size(x)), h(top + 1:top + size(x)), &
            has_base=.true.)
         highest = maxval(p)
         summary%of(p_max) = new_quantity(p_max, [highest, larger(highest, &
            summary%crests%highest)], time)
      end associate
   end function summary_of

   !> Quantities of pressure `p` and film `h` on the nodes `x` of a rising grid at a time, each
   !> (nx), of their friction if known, and of the pressure `solid` of asperities (nx).
   pure function summary_of_fields(x, p, h, time, friction, solid) result(summary)
      real(wp), intent(in) :: x(:), p(:), h(:), time
      type(friction_t), intent(in), optional :: friction
      real(wp), intent(in), optional :: solid(:)
      type(line_summary_t) :: summary
      type(friction_t) :: forces
      real(wp) :: total(size(p)), values(2, quantity_count)
      integer :: i

      total = p
      if (present(solid)) total = p + solid
      forces = friction_t(not_known(), not_known(), not_known(), not_known(), not_known())
      if (present(friction)) forces = friction
      values = quantity_values(x, p, h, total, forces)
      do i = 1, quantity_count
         summary%of(i) = new_quantity(i, values(:, i), time)
      end do
      summary%crests = crests_of(x, total, h, has_base=.false.)
      summary%limits = unknown_limits()
      summary%asperity_response = forces%asperity_response
      summary%power = summary%of(sliding_power)%value + summary%of(rolling_power)%value
      summary%last_time = time
   end function summary_of_fields

   !> Mean power of sliding and rolling over the times of a summary.
   pure real(wp) function mean_power(summary) result(power)
      type(line_summary_t), intent(in) :: summary

      power = summary%power
      if (summary%span > 0.0_wp) power = summary%work/summary%span
   end function mean_power

   !> Copies the values of `other`, a solution of other equations on the same grid: error estimates
   !> stay, extrapolated values change by as much as the values.
   pure subroutine copy_values(summary, other)
      type(line_summary_t), intent(inout) :: summary
      type(line_summary_t), intent(in) :: other

      associate (of => summary%of)
         of%extrapolated = of%extrapolated + other%of%value - of%value
         of%between = other%of%between
         of%value = other%of%value
      end associate
      summary%limits = other%limits
   end subroutine copy_values

   !> Widens `summary` by the quantities of another time: keeps the smaller or the larger one, as
   !> the table says, or one that is not known; between the nodes that of the known ones.
   pure subroutine keep_extremes(summary, other)
      type(line_summary_t), intent(inout) :: summary
      type(line_summary_t), intent(in) :: other
      type(quantity_t) :: extreme
      real(wp) :: between, side
      integer :: i

      do i = 1, quantity_count
         side = merge(1.0_wp, -1.0_wp, quantity_rows(i)%extreme == 'largest')
         associate (old => summary%of(i), new => other%of(i))
            between = side*larger(side*old%between, side*new%between)
            extreme = old
            if (ieee_is_finite(old%value) .and. .not. ieee_is_finite(new%value)) extreme = new
            if (exceeds(side*(new%value - old%value), 0.0_wp)) extreme = new
            old = new_quantity(i, [extreme%value, between], extreme%time)
         end associate
      end do
      associate (step => other%last_time - summary%last_time)
         summary%work = summary%work + 0.5_wp*step*(summary%power + other%power)
         summary%span = summary%span + step
         summary%power = other%power
         summary%last_time = other%last_time
      end associate
      summary%crests%highest = larger(summary%crests%highest, other%crests%highest)
      summary%crests%other = larger(summary%crests%other, other%crests%other)
      call widen_limits(summary%limits, other%limits)
      summary%crests%corner_top = -1.0_wp
      if (.not. ieee_is_finite(other%crests%spike)) return
      if (ieee_is_finite(summary%crests%spike) &
         .and. other%crests%spike <= summary%crests%spike) return
      summary%crests%spike = other%crests%spike
      summary%crests%spike_film = other%crests%spike_film
      summary%crests%growing = other%crests%growing
      summary%crests%fall = other%crests%fall
   end subroutine keep_extremes

   !> Maxima of a pressure p with the film h on rising nodes x (nx). A plateau counts once.
   !> `has_base`: of a spike only a part grows, A if its flank is B + A/sqrt(distance), 5 to 1
   !> spacings from the edge: the larger one of a linear B, by every other node, and of a constant
   !> one, by the last two.
   pure function crests_of(x, p, h, has_base) result(crests)
      real(wp), intent(in) :: x(:), p(:), h(:)
      logical, intent(in) :: has_base
      type(crests_t) :: crests
      real(wp) :: fall, top
      integer :: i
      logical :: is_last

      crests = crests_t(not_known(), not_known(), not_known(), not_known())
      is_last = .true.
      do i = size(p) - 1, 2, -1
         if (.not. (p(i) > p(i - 1) .and. p(i) >= p(i + 1))) cycle
         if (is_last) call find_corner(x, p, i, crests)
         top = parabola_extreme(x(i - 1:i + 1), p(i - 1:i + 1))
         fall = 1.0_wp - p(min(i + 2, size(p)))/p(i)
         if (is_last .and. fall > spike_drop) then
            crests%fall = fall
            crests%spike = p(i)
            crests%spike_film = h(i)
            if (has_base .and. i > 4) crests%growing = max((p(i) - 2*p(i - 2) + p(i - 4)) &
               /(1.0_wp - 2/sqrt(3.0_wp) + 1/sqrt(5.0_wp)), (p(i) - p(i - 1)) &
               /(1.0_wp - sqrt(0.5_wp)))
         else
            crests%other = larger(crests%other, top)
         end if
         crests%highest = larger(crests%highest, top)
         is_last = .false.
      end do
   end function crests_of

   !> Checks whether the maximum of p on rising nodes x (nx) at node `top` has a corner where P has
   !> not yet fallen by `spike_drop` of its value: it is known to half a spacing, and the height to
   !> half of the largest fall or bend of P over the longer spacing at `top`.
   pure subroutine find_corner(x, p, top, crests)
      real(wp), intent(in) :: x(:), p(:)
      integer, intent(in) :: top
      type(crests_t), intent(inout) :: crests
      real(wp) :: bend, steepest, slope(size(p) - 1)
      logical :: has_fallen(size(p))
      integer :: first, last

      has_fallen = p < (1.0_wp - spike_drop)*p(top)
      first = max(findloc(has_fallen(:top), .true., 1, back=.true.), 2)
      has_fallen(size(p) - 1) = .true.
      last = top - 1 + findloc(has_fallen(top:), .true., 1)
      slope(first - 1:last) = (p(first:last + 1) - p(first - 1:last))/(x(first:last + 1) &
         - x(first - 1:last))
      bend = maxval(slope(first - 1:last - 1) - slope(first:last))
      steepest = maxval(abs(slope(first - 1:last)))
      if (bend <= corner_share*steepest) return
      crests%corner = p(top)
      crests%corner_top = p(top) + 0.5_wp*min(bend, steepest)*max(x(top + 1) - x(top), x(top) &
         - x(top - 1))
   end subroutine find_corner

   !> Value of row `i` that does not depend on the position of the nodes, and is compared between
   !> grids.
   pure real(wp) function value_between(summary, i) result(value)
      type(line_summary_t), intent(in) :: summary
      integer, intent(in) :: i

      value = summary%of(i)%value
      if (quantity_rows(i)%rule == rule_crest) value = summary%crests%highest
      if (any(quantity_rows(i)%rule == [rule_node, rule_between])) value = summary%of(i)%between
   end function value_between

   !> Row `i` without an estimate of its error, from its value and that between the nodes.
   pure function new_quantity(i, values, time) result(quantity)
      integer, intent(in) :: i
      real(wp), intent(in) :: values(2), time
      type(quantity_t) :: quantity

      quantity%value = values(1)
      quantity%between = values(2)
      quantity%time = time
      quantity%error_estimate = not_known()
      quantity%error_grid = not_known()
      quantity%extrapolated = not_known()
      if (quantity_rows(i)%rule == rule_between) quantity%extrapolated = values(2)
   end function new_quantity

end module line_summary

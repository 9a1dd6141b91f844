!> How far off the figures of a result may be: the same case on half and on a quarter of the
!> intervals (in a transient with twice and four times the time step; of a scheme of first order in
!> time also on its own grid with the second-order scheme, which the coarser grids have then too),
!> and what the differences tell.
!>
!> With Q1, Q2, Q4 on n, n/2, n/4 intervals and the observed order p = log2 |Q2 - Q4|/|Q1 - Q2| the
!> error of Q1 is
!> |Q1 - Q2|/(2^p - 1) (Roache, J. Fluids Eng. 116, 1994, 405). p is bounded: an order above the
!> scheme's is chance.
!> In a transient any observed order is (module transient_errors).
module error_bars
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use inlet_change, only: change_by_inlet, inlet_change_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_summary, only: crests_t, line_summary_t, new_quantity, quantity_t
   use pressure_spike, only: ceiling_of_spike, spike_law_t
   use quantities, only: h_central, h_min, not_known, p_max, quantity_count, quantity_rows, &
      rule_between, rule_crest, rule_node
   use solver_settings, only: time_settings_t
   use split_errors, only: apply_forecast, forecast_t
   use transient_errors, only: error_by_reference, error_in_time, limit_in_time, &
      pressure_safety_in_time
   use wave_resolution, only: unseen_waves
   implicit none (type, external)
   private

   public :: error_bars_t, new_error_bars, apply_error_bars, domain_error, estimated_error, &
      error_from_levels, observed_order
   public :: missing_estimate, outlet_error, take_coarser

   !> An estimate is widened by this factor: the observed order is uncertain.
   real(wp), parameter :: safety = 1.5_wp
   !> The same for the largest pressure.
   real(wp), parameter :: pressure_safety = 2.0_wp
   !> In place of the first where four grids change a figure in one direction, the order being the
   !> lower one of the two that they show (255 contacts: of 1.2 to 1.4 the least that holds in 96 %
   !> for h_min).
   real(wp), parameter :: steady_safety = 1.3_wp
   !> Bounds of the observed order in space.
   real(wp), parameter :: orders(2) = [1.0_wp, 2.0_wp]
   !> Error of the exit between two nodes, in spacings: rms 0.2, at most 0.6 in 32 solutions of 8
   !> contacts.
   real(wp), parameter :: exit_jitter = 0.2_wp
   !> Films err by up to twice the share by which the inlet starves them, and the exit by that share
   !> as far as the film is thick (M 0.5-500, L 0-30, against four times the domain).
   real(wp), parameter :: film_safety = 2.0_wp

   !> The companions of a result and what is known of the order of the scheme.
   type :: error_bars_t
      !> Figures on n/2, n/4 and, of a steady contact whose grid was chosen, n/8 intervals; valid
      !> where the logical says so.
      type(line_summary_t) :: half, quarter, eighth
      logical :: has_half = .false., has_quarter = .false., has_eighth = .false.
      !> Of a transient with a scheme of first order: figures with that of second order on its own
      !> grid, known if those on n/2 are.
      type(line_summary_t) :: second_order
      logical :: is_first_order = .false.
      !> Whether the scheme in space is kappa, whose orders have bounds of their own.
      logical :: is_kappa = .false.
      !> How a pressure spike grows on finer grids.
      type(spike_law_t) :: spike_law
      !> Why companions tell nothing of the error; empty or not allocated: they do.
      character(:), allocatable :: unseen
      !> Whether the outlet cuts the film off, and figures on n/2 intervals with one that does not,
      !> at the same spacing.
      logical :: is_cut = .false., has_longer = .false.
      type(line_summary_t) :: longer
      !> What an inlet with a tail changes, in place of the rule of the inlet.
      type(inlet_change_t) :: inlet
      !> Of a transient whose resolution was chosen, in place of companions.
      type(forecast_t) :: forecast
   end type error_bars_t

contains

   !> The solutions on n/2, n/4 and n/8 intervals, as many as there are.
   pure subroutine take_coarser(bars, coarser)
      type(error_bars_t), intent(inout) :: bars
      type(line_summary_t), intent(in) :: coarser(:)

      bars%has_half = size(coarser) >= 1
      bars%has_quarter = size(coarser) >= 2
      bars%has_eighth = size(coarser) >= 3
      if (bars%has_half) bars%half = coarser(1)
      if (bars%has_quarter) bars%quarter = coarser(2)
      if (bars%has_eighth) bars%eighth = coarser(3)
   end subroutine take_coarser

   !> Estimated relative error of h_min of `summary` on its grid; huge without companions.
   pure function estimated_error(bars, summary) result(error)
      type(error_bars_t), intent(in) :: bars
      type(line_summary_t), intent(in) :: summary
      real(wp) :: error
      type(quantity_t) :: smallest

      smallest = summary%of(h_min)
      call estimate_at_rest(bars, h_min, 0.0_wp, smallest)
      error = huge(1.0_wp)
      if (ieee_is_finite(smallest%error_grid)) error = smallest%error_grid/smallest%value
   end function estimated_error

   !> Error estimates and Richardson's values for the figures of a converged result on n intervals
   !> of width `dx`: of grid and time step from the companions, of the length of the domain and of
   !> what the iteration left from the report; their sum, which is not known without the first.
   pure subroutine apply_error_bars(bars, report, dx, summary)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: iteration, domain(quantity_count)
      integer :: i

      if (bars%forecast%is_known) then
         call apply_forecast(bars%forecast, exit_jitter*dx, pressure_safety/safety, summary)
         call allow_for_spike(bars, dx, summary)
      else if (bars%has_half .and. .not. has_unseen_waves(bars)) then
         call estimate_grid_errors(bars, report%steps > 0, dx, summary)
      end if
      iteration = max(report%residual, report%load_error)
      if (report%steps > 0) iteration = max(iteration, report%tolerance_effective)
      domain = inlet_shares(bars, report, summary)
      do i = 1, quantity_count
         call add_up(summary%of(i), domain(i), iteration, cut_error(bars, i))
      end do
   end subroutine apply_error_bars

   !> Relative errors of all quantities because of the inlet: from its companions, else by the rules
   !> in the report.
   pure function inlet_shares(bars, report, summary) result(shares)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      type(line_summary_t), intent(in) :: summary
      real(wp) :: shares(quantity_count)

      if (bars%inlet%is_known) then
         shares = change_by_inlet(bars%inlet)
         where (quantity_rows%field == 'x') shares = shares/max(abs(summary%of%value), tiny(1.0_wp))
         return
      end if
      shares = report%inlet_error*min(1.0_wp, summary%of(h_central)%value)
      where (quantity_rows%field == 'pressure') shares = report%inlet_pressure_error
      where (quantity_rows%field == 'film_thickness') shares = domain_error(report%inlet_error)
   end function inlet_shares

   !> Whether the surfaces have waves that companions do not see; a forecast has seen them.
   pure function has_unseen_waves(bars)
      type(error_bars_t), intent(in) :: bars
      logical :: has_unseen_waves

      has_unseen_waves = .false.
      if (allocated(bars%unseen)) has_unseen_waves = len(bars%unseen) > 0 &
         .and. .not. bars%forecast%is_known
   end function has_unseen_waves

   !> Relative error because the outlet cuts the film off, of that quantity of the closing table for
   !> which it is the largest: 0 if it does not, NaN where that is not known.
   pure function outlet_error(bars) result(error)
      type(error_bars_t), intent(in) :: bars
      real(wp) :: error
      integer :: i

      error = cut_error(bars, h_min)
      if (.not. ieee_is_finite(error)) return
      do i = 1, quantity_count
         if (bars%is_cut .and. len_trim(quantity_rows(i)%short) > 0) error = &
            max(error, cut_error(bars, i)/bars%half%of(i)%value)
      end do
   end function outlet_error

   !> Error of row `i` because the outlet cuts the film off, from its values on n/2 intervals with
   !> that outlet and with one farther out; NaN where these are not known.
   pure function cut_error(bars, i) result(error)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      real(wp) :: error

      error = 0.0_wp
      if (.not. bars%is_cut) return
      error = not_known()
      if (bars%has_half .and. bars%has_longer) error = safety*abs(bars%half%of(i)%value &
         - bars%longer%of(i)%value)
   end function cut_error

   !> Why a quantity of a result has no estimate.
   pure function missing_estimate(bars, report) result(reason)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      character(:), allocatable :: reason

      if (.not. report%converged) then
         reason = 'no solution'
      else if (has_unseen_waves(bars)) then
         reason = bars%unseen
      else if (bars%is_cut .and. .not. bars%has_longer) then
         reason = 'the outlet cuts the film off'
      else if (bars%has_quarter .or. bars%forecast%is_known) then
         reason = 'a pressure spike that this grid does not resolve may pass the largest '// &
            'pressure on finer grids, or grow '// &
            'without a limit'
      else if (bars%has_half) then
         reason = 'only one coarser grid is compared'
      else
         reason = 'no coarser grids are compared'
      end if
   end function missing_estimate

   !> Bound on the relative error of a film because of the length of the domain, from `inlet_error`
   !> of its inlet.
   pure function domain_error(inlet_error) result(error)
      real(wp), intent(in) :: inlet_error
      real(wp) :: error

      error = film_safety*inlet_error
   end function domain_error

   !> Relative errors of inlet (`domain`) and iteration and what the outlet cuts off, beside the
   !> error of the grid, and the sum.
   pure subroutine add_up(quantity, domain, iteration, cut)
      type(quantity_t), intent(inout) :: quantity
      real(wp), intent(in) :: domain, iteration, cut

      quantity%error_domain = domain*abs(quantity%value) + cut
      quantity%error_iteration = iteration*abs(quantity%value)
      quantity%error_estimate = quantity%error_grid + quantity%error_domain &
         + quantity%error_iteration + quantity%error_start
   end subroutine add_up

   !> The part of grid and time step.
   pure subroutine estimate_grid_errors(bars, is_transient, dx, summary)
      type(error_bars_t), intent(in) :: bars
      logical, intent(in) :: is_transient
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      integer :: i

      do i = 1, quantity_count
         if (quantity_rows(i)%rule == rule_crest) then
            call estimate_pressure(bars, is_transient, summary)
            call allow_for_spike(bars, dx, summary)
         else if (is_transient) then
            call estimate_in_time(bars, i, dx, summary%of(i))
         else
            call estimate_at_rest(bars, i, dx, summary%of(i))
         end if
      end do
   end subroutine estimate_grid_errors

   !> Row `i` on n, n/2, n/4 and n/8 intervals, where it is known.
   pure function on_levels(bars, i, full) result(levels)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      type(quantity_t), intent(in) :: full
      type(quantity_t) :: levels(4)

      levels = new_quantity(i, [not_known(), not_known()], 0.0_wp)
      levels(1) = full
      if (bars%has_half) levels(2) = bars%half%of(i)
      if (bars%has_quarter) levels(3) = bars%quarter%of(i)
      if (bars%has_eighth) levels(4) = bars%eighth%of(i)
   end function on_levels

   !> Grid and time step of row `i` of a transient, from its values between the nodes.
   pure subroutine estimate_in_time(bars, i, dx, quantity)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      real(wp), intent(in) :: dx
      type(quantity_t), intent(inout) :: quantity
      type(quantity_t) :: levels(4)
      real(wp) :: limit, error

      levels = on_levels(bars, i, quantity)
      if (bars%is_first_order) levels(1) = bars%second_order%of(i)
      call compare(bars, quantity%between, levels(:3)%between, limit, error)
      quantity%error_grid = error + abs(quantity%value - quantity%between)
      if (quantity_rows(i)%rule == rule_between) then
         quantity%error_grid = quantity%error_grid + exit_jitter*dx
      else
         quantity%extrapolated = limit
      end if
   end subroutine estimate_in_time

   !> Limit and estimated error of a `value` of a transient from those of the second-order scheme on
   !> n, n/2, n/4 intervals.
   pure subroutine compare(bars, value, values, limit, error)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: value
      real(wp), intent(in) :: values(3)
      real(wp), intent(out) :: limit, error

      limit = limit_in_time(values)
      error = error_in_time(values)
      if (bars%is_first_order) error = error_by_reference(value, limit, error)
   end subroutine compare

   !> The largest pressure of a node, from maxima by parabolas.
   pure subroutine estimate_pressure(bars, is_transient, summary)
      type(error_bars_t), intent(in) :: bars
      logical, intent(in) :: is_transient
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: tops(3)

      tops = not_known()
      tops(1) = top_of(summary%crests)
      if (is_transient .and. bars%is_first_order) tops(1) = top_of(bars%second_order%crests)
      tops(2) = top_of(bars%half%crests)
      if (bars%has_quarter) tops(3) = top_of(bars%quarter%crests)
      if (is_transient) then
         call estimate_crest_in_time(bars, tops, summary%crests%highest, summary%of(p_max))
      else if (all(ieee_is_finite(tops))) then
         call estimate_crest(tops, summary%of(p_max))
      end if
   end subroutine estimate_pressure

   !> Error of a nodal maximum of a transient: that of the parabola's, `top`, from those of the
   !> second-order scheme on n, n/2, n/4 intervals, and what the node is off.
   pure subroutine estimate_crest_in_time(bars, highest, top, quantity)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: highest(3), top
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: error, limit

      if (.not. all(ieee_is_finite(highest))) return
      error = pressure_safety_in_time*error_in_time(highest)
      limit = limit_in_time(highest)
      if (bars%is_first_order) error = error_by_reference(top, limit, error)
      quantity%error_grid = error + abs(top - quantity%value)
      quantity%extrapolated = limit
   end subroutine estimate_crest_in_time

   !> Where the grid has a pressure spike the largest pressure may be off by what the
   !> spike may grow above it; not known where that is not.
   pure subroutine allow_for_spike(bars, dx, summary)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: ceiling

      if (.not. ieee_is_finite(summary%crests%highest) &
         .or. .not. ieee_is_finite(summary%of(p_max)%error_grid)) return
      ceiling = ceiling_of_spike(bars%spike_law, summary%crests, summary%of(h_central)%value, dx)
      associate (pressure => summary%of(p_max))
         if (.not. ieee_is_finite(ceiling)) then
            pressure%error_grid = ceiling
            pressure%extrapolated = ceiling
         else if (ceiling > pressure%value + pressure%error_grid) then
            pressure%error_grid = ceiling - pressure%value
            pressure%extrapolated = not_known()
         end if
      end associate
   end subroutine allow_for_spike

   !> The maximum of P that is followed from grid to grid: the largest beside a spike that is below
   !> it, else the largest.
   pure function top_of(crests) result(top)
      type(crests_t), intent(in) :: crests
      real(wp) :: top

      top = crests%highest
      if (.not. (ieee_is_finite(crests%spike) .and. ieee_is_finite(crests%other))) return
      if (crests%spike < crests%other) top = crests%other
   end function top_of

   !> The grid of row `i` at rest.
   pure subroutine estimate_at_rest(bars, i, dx, quantity)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      real(wp), intent(in) :: dx
      type(quantity_t), intent(inout) :: quantity
      type(quantity_t) :: levels(4)
      real(wp) :: bounds(2), between(2), own(2)

      bounds = merge(quantity_rows(i)%kappa_orders, orders, bars%is_kappa)
      levels = on_levels(bars, i, quantity)
      own = estimate(levels%value, bounds)
      between = estimate(levels%between, bounds)
      between(1) = between(1) + abs(quantity%value - quantity%between)
      select case (quantity_rows(i)%rule)
      case (rule_node)
         own(1) = max(own(1), between(1))
      case (rule_between)
         own = [between(1) + exit_jitter*dx, quantity%between]
      case default
         ! its own values are enough
      end select
      quantity%error_grid = own(1)
      quantity%extrapolated = own(2)
   end subroutine estimate_at_rest

   !> Estimated error and extrapolated value of the first of `values` on n, n/2, n/4, n/8 intervals
   !> (NaN: not known), whose observed order has these `bounds`.
   pure function estimate(values, bounds) result(error_and_limit)
      real(wp), intent(in) :: values(4), bounds(2)
      real(wp) :: error_and_limit(2)
      real(wp) :: changes(3), order

      error_and_limit = not_known()
      if (.not. all(ieee_is_finite(values(:2)))) return
      order = observed_order(values(1), values(2), values(3), orders)
      if (ieee_is_finite(values(3))) error_and_limit(2) = values(1) + (values(1) - values(2)) &
         /(2.0_wp**order - 1.0_wp)
      order = observed_order(values(1), values(2), values(3), bounds)
      changes = 0.0_wp
      if (ieee_is_finite(values(4))) then
         order = min(order, observed_order(values(2), values(3), values(4), bounds))
         changes = values(:3) - values(2:)
      end if
      associate (error => error_and_limit(1))
         error = error_from_levels(values(1), values(2), order)
         ! terms of two orders and opposite signs may make the last difference small by chance
         if (ieee_is_finite(values(3))) error = max(error, error_from_levels(values(2), values(3), &
            order)/2.0_wp**orders(2))
         if (all(changes > 0.0_wp) .or. all(changes < 0.0_wp)) error = steady_safety/safety*error
      end associate
   end function estimate

   !> Error of a nodal maximum: that of the parabola's, and what the node is below it.
   pure subroutine estimate_crest(values, quantity)
      real(wp), intent(in) :: values(3)
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: order

      order = observed_order(values(1), values(2), values(3), orders)
      quantity%error_grid = max(error_from_levels(values(1), values(2), order), &
         error_from_levels(values(2), values(3), order)/2.0_wp**orders(2))
      quantity%error_grid = pressure_safety/safety*quantity%error_grid + abs(values(1) &
         - quantity%value)
      quantity%extrapolated = values(1) + (values(1) - values(2))/(2.0_wp**order - 1.0_wp)
   end subroutine estimate_crest

   !> safety |q1 - q2|/(2^order - 1).
   pure elemental function error_from_levels(q1, q2, order) result(error)
      real(wp), intent(in) :: q1, q2, order
      real(wp) :: error

      error = safety*abs(q1 - q2)/(2.0_wp**order - 1.0_wp)
   end function error_from_levels

   !> log2 of the ratio of the differences, within the bounds (lowest, highest).
   pure function observed_order(q1, q2, q4, bounds) result(order)
      real(wp), intent(in) :: q1, q2, q4, bounds(2)
      real(wp) :: order

      order = bounds(1)
      if (.not. ieee_is_finite(q4) .or. abs(q2 - q4) <= tiny(1.0_wp)) return
      order = bounds(2)
      if (abs(q1 - q2) > tiny(1.0_wp)*1.0e10_wp) order = log(abs((q2 - q4)/(q1 - q2)))/log(2.0_wp)
      order = min(max(order, bounds(1)), bounds(2))
   end function observed_order

   !> Nothing is known yet but the orders of the schemes in time and space, and whether a spike is
   !> to be feared.
   pure function new_error_bars(contact, time, space_scheme) result(bars)
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      character(*), intent(in) :: space_scheme
      type(error_bars_t) :: bars

      bars%spike_law = spike_law_t(contact%fluid, contact%lambda)
      bars%is_first_order = time%is_transient .and. time%scheme == 'backward_euler'
      bars%is_kappa = space_scheme == 'kappa'
      bars%unseen = unseen_waves(contact, time)
   end function new_error_bars

end module error_bars

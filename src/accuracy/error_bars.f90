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
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use inlet_change, only: change_by_inlet, inlet_change_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_summary, only: crests_t, figure_t, line_summary_t
   use lubricant, only: viscosity_constant
   use pressure_spike, only: ceiling_of_spike, spike_law_t
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
   !> The same of h_min and of h_central in the kappa scheme: at a spike the order of the one is
   !> chance, and the other falls faster (60 heavy contacts on 512 to 4096 intervals).
   real(wp), parameter :: kappa_orders_min(2) = [1.0_wp, 1.0_wp], &
      kappa_orders_central(2) = [1.0_wp, 2.5_wp]
   !> Error of the exit between two nodes, in spacings: rms 0.2, at most 0.6 in 32 solutions of 8
   !> contacts.
   real(wp), parameter :: exit_jitter = 0.2_wp
   !> An inlet of error e (`inlet_error`) starves the film by 0.4 e to 1.6 e, and changes the
   !> largest pressure by up to 8 e, with constant viscosity 20 e, times the smaller one of 1 and
   !> H_c (M 0.5-500, L 0-30, against four times the domain).
   real(wp), parameter :: film_safety = 2.0_wp, starved_pressure = 8.0_wp, &
      starved_isoviscous = 20.0_wp
   !> The same with a tail in front of the inlet (below 3 in 90 % of 141 contacts without a spike;
   !> with 6 the whole error of 191 others is below its estimate in 96 %, with 4 in 94.8 %).
   real(wp), parameter :: pressure_behind_tail = 6.0_wp

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
      !> Bounds of the observed order in space of h_min and of h_central.
      real(wp) :: orders_min(2) = orders, orders_central(2) = orders
      !> How a pressure spike grows on finer grids.
      type(spike_law_t) :: spike_law
      !> Change of the largest pressure over that of a starved film.
      real(wp) :: starving = starved_pressure
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
      type(figure_t) :: h_min

      h_min = summary%h_min
      call estimate(bars, bars%half%h_min, bars%quarter%h_min, bars%eighth%h_min, &
         bars%orders_min, h_min)
      error = huge(1.0_wp)
      if (ieee_is_finite(h_min%error_grid)) error = h_min%error_grid/h_min%value
   end function estimated_error

   !> Error estimates and Richardson's values for the figures of a converged result on n intervals
   !> of width `dx`: of grid and time step from the companions, of the length of the domain and of
   !> what the iteration left from the report; their sum, which is not known without the first.
   pure subroutine apply_error_bars(bars, report, dx, summary)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: iteration, domain(4)

      if (bars%forecast%is_known) then
         call apply_forecast(bars%forecast, exit_jitter*dx, pressure_safety/safety, summary)
         call allow_for_spike(bars, dx, summary)
      else if (bars%has_half .and. report%steps > 0 .and. .not. has_unseen_waves(bars)) then
         call estimate_errors_in_time(bars, dx, summary)
      else if (bars%has_half .and. .not. has_unseen_waves(bars)) then
         call estimate_grid_errors(bars, dx, summary)
      end if
      iteration = max(report%residual, report%load_error)
      if (report%steps > 0) iteration = max(iteration, report%tolerance_effective)
      domain = inlet_shares(bars, report%inlet_error, summary)
      associate (half => bars%half, longer => bars%longer)
         call add_up(summary%h_min, domain(1), iteration, cut_error(bars, half%h_min, longer%h_min))
         call add_up(summary%h_min_node, domain(1), iteration, cut_error(bars, half%h_min_node, &
            longer%h_min_node))
         call add_up(summary%h_central, domain(2), iteration, cut_error(bars, half%h_central, &
            longer%h_central))
         call add_up(summary%p_max, domain(3), iteration, cut_error(bars, half%p_max, longer%p_max))
         call add_up(summary%x_cavitation, domain(4), iteration, &
            cut_error(bars, half%x_cavitation, longer%x_cavitation))
      end associate
   end subroutine apply_error_bars

   !> Relative errors of h_min, h_central, p_max and x_cavitation because of the inlet: from its
   !> companions, else by its rule, which says that it starves the film by the share `starving`.
   pure function inlet_shares(bars, starving, summary) result(shares)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: starving
      type(line_summary_t), intent(in) :: summary
      real(wp) :: shares(4)

      if (bars%inlet%is_known) then
         shares = change_by_inlet(bars%inlet)
         shares(4) = shares(4)/max(abs(summary%x_cavitation%value), tiny(1.0_wp))
         return
      end if
      shares(:2) = domain_error(starving)
      ! a starved film is thinner everywhere by the same share; pressure and exit follow as far as
      ! it is thick [b^2/R]
      shares(3:) = [bars%starving, 1.0_wp]*starving*min(1.0_wp, summary%h_central%value)
   end function inlet_shares

   !> Whether the surfaces have waves that companions do not see; a forecast has seen them.
   pure function has_unseen_waves(bars)
      type(error_bars_t), intent(in) :: bars
      logical :: has_unseen_waves

      has_unseen_waves = .false.
      if (allocated(bars%unseen)) has_unseen_waves = len(bars%unseen) > 0 &
         .and. .not. bars%forecast%is_known
   end function has_unseen_waves

   !> Relative error of h_min, h_central and p_max, whichever is the largest, because the outlet
   !> cuts the film off: 0 if it does not, NaN where that is not known.
   pure function outlet_error(bars) result(error)
      type(error_bars_t), intent(in) :: bars
      real(wp) :: error

      error = 0.0_wp
      if (.not. bars%is_cut) return
      error = ieee_value(1.0_wp, ieee_quiet_nan)
      if (.not. (bars%has_half .and. bars%has_longer)) return
      associate (half => bars%half, longer => bars%longer)
         error = max(cut_error(bars, half%h_min, longer%h_min)/half%h_min%value, &
            cut_error(bars, half%h_central, longer%h_central)/half%h_central%value, &
            cut_error(bars, half%p_max, longer%p_max)/half%p_max%value)
      end associate
   end function outlet_error

   !> Error of a figure because the outlet cuts the film off, from its values on n/2 intervals with
   !> that outlet and with one farther out; NaN where these are not known.
   pure function cut_error(bars, half, longer) result(error)
      type(error_bars_t), intent(in) :: bars
      type(figure_t), intent(in) :: half, longer
      real(wp) :: error

      error = 0.0_wp
      if (.not. bars%is_cut) return
      error = ieee_value(1.0_wp, ieee_quiet_nan)
      if (bars%has_half .and. bars%has_longer) error = safety*abs(half%value - longer%value)
   end function cut_error

   !> Why a figure of a result has no estimate.
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
   pure subroutine add_up(figure, domain, iteration, cut)
      type(figure_t), intent(inout) :: figure
      real(wp), intent(in) :: domain, iteration, cut

      figure%error_domain = domain*abs(figure%value) + cut
      figure%error_iteration = iteration*abs(figure%value)
      figure%error_estimate = figure%error_grid + figure%error_domain + figure%error_iteration &
         + figure%error_start
   end subroutine add_up

   !> Grid and time step of a transient.
   pure subroutine estimate_errors_in_time(bars, dx, summary)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      type(line_summary_t) :: full
      real(wp) :: exit_limit, error

      full = summary
      if (bars%is_first_order) full = bars%second_order
      associate (half => bars%half, quarter => bars%quarter)
         associate (figure => summary%h_min)
            call compare(bars, figure%value, three(full%h_min%value, half%h_min%value, &
               quarter%h_min%value), figure%extrapolated, &
               figure%error_grid)
         end associate
         associate (figure => summary%h_central, cubic => summary%h_central_cubic)
            call compare(bars, cubic, three(full%h_central_cubic, half%h_central_cubic, &
               quarter%h_central_cubic), &
               figure%extrapolated, error)
            figure%error_grid = error + abs(figure%value - cubic)
         end associate
         associate (node => summary%h_min_node, between => summary%h_min)
            node%error_grid = between%error_grid + abs(node%value - between%value)
            node%extrapolated = between%extrapolated
         end associate
         associate (figure => summary%x_cavitation)
            call compare(bars, figure%extrapolated, three(full%x_cavitation%extrapolated, &
               half%x_cavitation%extrapolated, &
               quarter%x_cavitation%extrapolated), exit_limit, error)
            figure%error_grid = error + abs(figure%value - figure%extrapolated) + exit_jitter*dx
         end associate
         call estimate_pressure_in_time(bars, three(top_of(full%crests), top_of(half%crests), &
            top_of(quarter%crests)), dx, summary)
      end associate

   contains

      !> A figure on n, n/2, n/4 intervals, the last one NaN where there was no solution.
      pure function three(full, half, quarter) result(values)
         real(wp), intent(in) :: full, half, quarter
         real(wp) :: values(3)

         values = [full, half, quarter]
         if (.not. bars%has_quarter) values(3) = ieee_value(1.0_wp, ieee_quiet_nan)
      end function three

   end subroutine estimate_errors_in_time

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

   !> The largest pressure of a transient from its maxima by parabolas, those of the second-order
   !> scheme on n, n/2, n/4 intervals, and what a spike may grow.
   pure subroutine estimate_pressure_in_time(bars, highest, dx, summary)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: highest(3), dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: error, limit

      if (.not. all(ieee_is_finite(highest))) return
      error = pressure_safety_in_time*error_in_time(highest)
      limit = limit_in_time(highest)
      associate (p_max => summary%p_max, top => summary%crests%highest)
         if (bars%is_first_order) error = error_by_reference(top, limit, error)
         p_max%error_grid = error + abs(top - p_max%value)
         p_max%extrapolated = limit
      end associate
      call allow_for_spike(bars, dx, summary)
   end subroutine estimate_pressure_in_time

   !> Where the grid does not resolve a pressure spike the largest pressure may be off by what the
   !> spike may grow above it; not known where that is not.
   pure subroutine allow_for_spike(bars, dx, summary)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: ceiling

      if (.not. ieee_is_finite(summary%crests%highest) &
         .or. .not. ieee_is_finite(summary%p_max%error_grid)) return
      ceiling = ceiling_of_spike(bars%spike_law, summary%crests, summary%h_central%value, dx)
      associate (p_max => summary%p_max)
         if (.not. ieee_is_finite(ceiling)) then
            p_max%error_grid = ceiling
            p_max%extrapolated = ceiling
         else if (ceiling > 0.0_wp) then
            p_max%error_grid = max(ceiling - p_max%value, p_max%error_grid)
            p_max%extrapolated = ieee_value(1.0_wp, ieee_quiet_nan)
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

   !> The part of the grid.
   pure subroutine estimate_grid_errors(bars, dx, summary)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary

      call estimate(bars, bars%half%h_min, bars%quarter%h_min, bars%eighth%h_min, &
         bars%orders_min, summary%h_min)
      call estimate(bars, bars%half%h_min_node, bars%quarter%h_min_node, bars%eighth%h_min_node, &
         bars%orders_min, &
         summary%h_min_node)
      call estimate(bars, bars%half%h_central, bars%quarter%h_central, bars%eighth%h_central, &
         bars%orders_central, &
         summary%h_central)
      call estimate_pressure(bars, dx, summary)
      call estimate_exit(bars, dx, summary%x_cavitation)
      ! nodal figures jump with the position of the nodes, which no difference of levels shows
      summary%h_min_node%error_grid = max(summary%h_min_node%error_grid, &
         summary%h_min%error_grid + abs(summary%h_min_node%value - summary%h_min%value))
   end subroutine estimate_grid_errors

   !> Estimate of the exit: how far it lies from the last node, and the error of its place between
   !> the nodes (`extrapolated`), which jitters with the position of the nodes by `exit_jitter` of
   !> their distance.
   pure subroutine estimate_exit(bars, dx, figure)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: dx
      type(figure_t), intent(inout) :: figure
      type(figure_t) :: between, half, quarter, eighth

      between = figure
      half = bars%half%x_cavitation
      quarter = bars%quarter%x_cavitation
      eighth = bars%eighth%x_cavitation
      between%value = figure%extrapolated
      half%value = half%extrapolated
      quarter%value = quarter%extrapolated
      eighth%value = eighth%extrapolated
      call estimate(bars, half, quarter, eighth, orders, between)
      figure%error_grid = between%error_grid + abs(figure%value - figure%extrapolated) &
         + exit_jitter*dx
   end subroutine estimate_exit

   !> Estimate and extrapolated value of one figure, whose observed order has these `bounds`.
   pure subroutine estimate(bars, half, quarter, eighth, bounds, figure)
      type(error_bars_t), intent(in) :: bars
      type(figure_t), intent(in) :: half, quarter, eighth
      real(wp), intent(in) :: bounds(2)
      type(figure_t), intent(inout) :: figure
      real(wp) :: changes(3), order

      if (.not. bars%has_half) return
      if (.not. (ieee_is_finite(figure%value) .and. ieee_is_finite(half%value))) return
      order = bounds(1)
      if (bars%has_quarter) then
         order = observed_order(figure%value, half%value, quarter%value, orders)
         figure%extrapolated = figure%value + (figure%value - half%value)/(2.0_wp**order - 1.0_wp)
         order = observed_order(figure%value, half%value, quarter%value, bounds)
      end if
      changes = 0.0_wp
      if (bars%has_eighth .and. ieee_is_finite(eighth%value)) then
         order = min(order, observed_order(half%value, quarter%value, eighth%value, bounds))
         changes = [figure%value - half%value, half%value - quarter%value, &
            quarter%value - eighth%value]
      end if
      figure%error_grid = error_from_levels(figure%value, half%value, order)
      ! terms of two orders and opposite signs may make the last difference small by chance
      if (bars%has_quarter .and. ieee_is_finite(quarter%value)) figure%error_grid = &
         max(figure%error_grid, &
         error_from_levels(half%value, quarter%value, order)/2.0_wp**orders(2))
      if (all(changes > 0.0_wp) .or. all(changes < 0.0_wp)) figure%error_grid = steady_safety &
         /safety*figure%error_grid
   end subroutine estimate

   !> Estimate for the largest pressure of a node, from maxima by parabolas; that of a spike which
   !> the grid does not resolve by what it may grow.
   pure subroutine estimate_pressure(bars, dx, summary)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: values(3)

      if (.not. bars%has_quarter) return
      values = [top_of(summary%crests), top_of(bars%half%crests), top_of(bars%quarter%crests)]
      if (.not. all(ieee_is_finite(values))) return
      call estimate_crest(values, summary%p_max)
      call allow_for_spike(bars, dx, summary)
   end subroutine estimate_pressure

   !> Error of a nodal maximum: that of the parabola's, and what the node is below it.
   pure subroutine estimate_crest(values, figure)
      real(wp), intent(in) :: values(3)
      type(figure_t), intent(inout) :: figure
      real(wp) :: order

      order = observed_order(values(1), values(2), values(3), orders)
      figure%error_grid = max(error_from_levels(values(1), values(2), order), &
         error_from_levels(values(2), values(3), order)/2.0_wp**orders(2))
      figure%error_grid = pressure_safety/safety*figure%error_grid + abs(values(1) - figure%value)
      figure%extrapolated = values(1) + (values(1) - values(2))/(2.0_wp**order - 1.0_wp)
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
      if (contact%fluid%viscosity_law == viscosity_constant) bars%starving = starved_isoviscous
      if (contact%domain%inlet == 'tail') bars%starving = pressure_behind_tail
      bars%is_first_order = time%is_transient .and. time%scheme == 'backward_euler'
      if (space_scheme == 'kappa') then
         bars%orders_min = kappa_orders_min
         bars%orders_central = kappa_orders_central
      end if
      bars%unseen = unseen_waves(contact, time)
   end function new_error_bars

end module error_bars

!> How far off the quantities of a result may be: the same case on half and on a quarter of the
!> intervals (in a transient with twice and four times the time step; of a scheme of first order in
!> time also on its own grid with the second-order scheme, which the coarser grids have then too),
!> and what the differences tell (modules grid_errors, transient_errors, pressure_errors).
module error_bars
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use film_waves, only: doubt_lost_waves, film_waves_t, lost_waves, new_film_waves
   use grid_errors, only: error_on_grids, kappa_share, orders, safety
   use inlet_change, only: change_by_inlet, inlet_change_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_summary, only: line_summary_t, new_quantity, quantity_t
   use lubricant, only: fluid_t, fluid_viscosity
   use missing_value, only: exceeds, larger, not_known
   use pressure_errors, only: allow_for_spike, doubt_shear, estimate_crest, &
      estimate_crest_in_time, top_of
   use pressure_spike, only: spike_law_t
   use quantities, only: h_central, h_min, is_chance, p_max, quantity_count, quantity_rows, &
      rule_between, rule_crest, rule_node, sliding_rows
   use rheology, only: thins
   use solver_settings, only: time_settings_t
   use split_errors, only: apart_t, apply_forecast, forecast_t
   use transient_errors, only: error_by_reference, error_in_time, limit_in_time
   use wave_resolution, only: unseen_waves
   implicit none (type, external)
   private

   public :: apply_error_bars, domain_error, error_bars_t, estimated_error, missing_estimate, &
      new_error_bars, outlet_error, take_coarser

   !> Error of the exit between two nodes, in spacings.
   real(wp), parameter :: exit_jitter = 0.2_wp
   !> Films err by up to twice the share by which the inlet starves them, and the exit by that share
   !> as far as the film is thick (M 0.5-500, L 0-30, against four times the domain).
   real(wp), parameter :: film_safety = 2.0_wp
   !> Forces err as films do, that of sliding by up to this many times the share of the pressures
   !> more; that of a Newtonian oil as its viscosity does, where the largest pressure changes by a
   !> third of that share (M 2-70, L 3-9, against a domain twice as long).
   real(wp), parameter :: shear_safety = 1.5_wp, pressure_part = 1.0_wp/3.0_wp

   !> The coarse runs of a result and what is known of the order of the scheme.
   type :: error_bars_t
      !> Quantities on n/2, n/4 and, of a steady contact whose grid was chosen, n/8 intervals; valid
      !> where the logical says so.
      type(line_summary_t) :: half, quarter, eighth
      logical :: has_half = .false., has_quarter = .false., has_eighth = .false.
      !> Of a transient with a scheme of first order: quantities with that of second order on its
      !> own grid, known if those on n/2 are.
      type(line_summary_t) :: second_order
      logical :: is_first_order = .false.
      !> Whether the scheme in space is kappa, whose orders have bounds of their own.
      logical :: is_kappa = .false.
      !> Of a steady contact by the kappa scheme: quantities by that of the thesis on n, n/2 and n/4
      !> intervals; not allocated where they are not known.
      type(line_summary_t), allocatable :: other_scheme(:)
      !> How a pressure spike grows on finer grids, and a wave of the film dies.
      type(spike_law_t) :: spike_law
      !> Waves that features leave in the film.
      type(film_waves_t) :: waves
      !> Why coarse runs tell nothing of the error; empty or not allocated: they do.
      character(:), allocatable :: unseen
      !> Whether the outlet cuts the film off, and quantities on n/2 intervals with one that does
      !> not, at the same spacing.
      logical :: is_cut = .false., has_longer = .false.
      type(line_summary_t) :: longer
      !> What an inlet with a tail changes, in place of the rule of the inlet.
      type(inlet_change_t) :: inlet
      !> Of a transient whose resolution was chosen: what pilots foretold, and coarse runs with
      !> twice the spacing and with twice the time step.
      type(forecast_t) :: forecast
      type(apart_t) :: apart
      !> Bound on the relative change of each quantity by what was left out of the model; NaN: not
      !> known.
      real(wp) :: left_out(quantity_count) = 0.0_wp
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

   !> Estimated relative error of h_min of `summary` on its grid; huge without coarse runs.
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

   !> Error estimates and Richardson's values for the quantities of a converged result on n
   !> intervals of width `dx`: of grid and time step from the coarse runs, of the length of the
   !> domain and of what the iteration left from the report; their sum, which is not known without
   !> the first.
   pure subroutine apply_error_bars(bars, report, dx, summary)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: iteration, domain(quantity_count)
      integer :: i

      if (bars%forecast%is_known) then
         call apply_forecast(bars%forecast, bars%apart, exit_jitter*dx, summary)
         call allow_for_spike(bars%spike_law, dx, summary)
      else if (bars%has_half .and. .not. has_unseen_waves(bars)) then
         call estimate_grid_errors(bars, report%steps > 0, dx, summary)
      end if
      call doubt_shear(bars%spike_law, dx, summary)
      call doubt_lost_waves(bars%waves, bars%spike_law, dx, summary)
      iteration = max(report%residual, report%load_error)
      if (report%steps > 0) iteration = max(iteration, report%tolerance_effective)
      domain = inlet_shares(bars, report, summary)
      do i = 1, quantity_count
         summary%of(i)%error_grid = quantity_rows(i)%widening*summary%of(i)%error_grid
         if (exceeds(abs(summary%of(i)%value), 0.0_wp)) summary%of(i)%error_model = &
            bars%left_out(i)*abs(summary%of(i)%value)
         call add_up(summary%of(i), domain(i), iteration, cut_error(bars, i))
      end do
   end subroutine apply_error_bars

   !> Relative errors of all quantities because of the inlet: from its coarse runs, else by the
   !> rules in the report.
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
      where (quantity_rows%field == 'friction_coefficient' .or. quantity_rows%field == 'power') &
         shares = domain_error(report%inlet_error)
      shares(sliding_rows) = shares(sliding_rows) + shear_response(bars%spike_law%fluid, &
         summary%of(p_max)%value)*report%inlet_pressure_error
   end function inlet_shares

   !> By how many times the share of the pressures that an inlet is missing sliding errs.
   pure function shear_response(fluid, pressure) result(response)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: pressure
      real(wp) :: response, ln_mu(1)

      response = shear_safety
      if (thins(fluid) .or. .not. ieee_is_finite(pressure)) return
      call fluid_viscosity(fluid, [pressure], ln_mu)
      response = max(response, pressure_part*ln_mu(1))
   end function shear_response

   !> Whether the surfaces have waves that coarse runs do not see; a forecast has seen them.
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

      error = 0.0_wp
      if (.not. bars%is_cut) return
      error = not_known()
      if (.not. (bars%has_half .and. bars%has_longer)) return
      error = 0.0_wp
      do i = 1, quantity_count
         if (len_trim(quantity_rows(i)%short) == 0) cycle
         if (exceeds(bars%half%of(i)%value, 0.0_wp)) error = larger(error, cut_error(bars, i) &
            /bars%half%of(i)%value)
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

   !> Why a quantity of the `summary` of a result on a grid of spacing `dx` has no estimate.
   pure function missing_estimate(bars, report, dx, summary) result(reason)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(in) :: summary
      character(:), allocatable :: reason, lost

      lost = ''
      if (report%converged) lost = lost_waves(bars%waves, bars%spike_law, dx, summary)
      if (.not. report%converged) then
         reason = 'no solution'
      else if (any(exceeds(bars%left_out, 0.0_wp))) then
         reason = 'what was left out of the model may change it, or a pressure spike that this '// &
            'grid does not resolve'
      else if (has_unseen_waves(bars)) then
         reason = bars%unseen
      else if (bars%is_cut .and. .not. bars%has_longer) then
         reason = 'the outlet cuts the film off'
      else if (len(lost) > 0) then
         reason = lost
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
         + quantity%error_iteration + quantity%error_start + quantity%error_model
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
            call allow_for_spike(bars%spike_law, dx, summary)
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
      limit = limit_in_time(levels(:3)%between)
      error = error_in_time(levels(:3)%between)
      if (bars%is_first_order) error = error_by_reference(quantity%between, limit, error)
      quantity%error_grid = error + abs(quantity%value - quantity%between)
      if (quantity_rows(i)%rule == rule_between) then
         quantity%error_grid = quantity%error_grid + exit_jitter*dx
      else
         quantity%extrapolated = limit
      end if
   end subroutine estimate_in_time

   !> The largest pressure of a node, from maxima by parabolas.
   pure subroutine estimate_pressure(bars, is_transient, summary)
      type(error_bars_t), intent(in) :: bars
      logical, intent(in) :: is_transient
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: tops(3), nodes(3)

      tops = not_known()
      tops(1) = top_of(summary%crests)
      if (is_transient .and. bars%is_first_order) tops(1) = top_of(bars%second_order%crests)
      tops(2) = top_of(bars%half%crests)
      if (bars%has_quarter) tops(3) = top_of(bars%quarter%crests)
      if (is_transient) then
         call estimate_crest_in_time(bars%is_first_order, tops, summary%crests%highest, &
            summary%of(p_max))
      else if (all(ieee_is_finite(tops))) then
         nodes = [summary%of(p_max)%value, bars%half%of(p_max)%value, bars%quarter%of(p_max)%value]
         call estimate_crest(tops, nodes, summary%of(p_max))
      end if
   end subroutine estimate_pressure

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
      own = error_on_grids(levels%value, bounds)
      between = error_on_grids(levels%between, bounds)
      if (i == h_central) own = [error_of_line(quantity, between), between(2)]
      between(1) = between(1) + abs(quantity%value - quantity%between)
      select case (quantity_rows(i)%rule)
      case (rule_node)
         own(1) = larger(own(1), between(1))
      case (rule_between)
         own = [between(1) + exit_jitter*dx, quantity%between]
      case default
         ! its own values are enough, or what is known of them
      end select
      if (allocated(bars%other_scheme) .and. is_chance(quantity_rows(i))) own(1) = &
         error_by_other_scheme(bars, i) + abs(quantity%value - quantity%between)
      quantity%error_grid = own(1)
      quantity%extrapolated = own(2)
   end subroutine estimate_at_rest

   !> Error of a value on the line between two nodes, from that of the one between the nodes and its
   !> limit (NaN: not known), `between`: what the line is off changes with the place of the nodes,
   !> and has a sign.
   pure function error_of_line(quantity, between) result(error)
      type(quantity_t), intent(in) :: quantity
      real(wp), intent(in) :: between(2)
      real(wp) :: error

      error = between(1) + abs(quantity%value - quantity%between)
      if (ieee_is_finite(between(2))) error = max(between(1)/(2*safety), between(1) &
         + abs(quantity%value - between(2)) - abs(quantity%between - between(2)))
   end function error_of_line

   !> Error of row `i` in the kappa scheme between the nodes: a share of that of the thesis's
   !> scheme, which falls regularly.
   pure function error_by_other_scheme(bars, i) result(error)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      real(wp) :: error, values(4), error_and_limit(2)
      integer :: known

      values = not_known()
      known = min(size(bars%other_scheme), 3)
      values(:known) = bars%other_scheme(:known)%of(i)%between
      error_and_limit = error_on_grids(values, orders)
      error = kappa_share/safety*error_and_limit(1)
   end function error_by_other_scheme

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
      bars%waves = new_film_waves(contact, time)
   end function new_error_bars

end module error_bars

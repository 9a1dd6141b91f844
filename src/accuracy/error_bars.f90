!> Error estimates of the quantities of a result: grid and time step, inlet (module inlet_errors),
!> an outlet that cuts off the film, iteration, and what was left out of the model; their sum, or
!> the reason why it is not known.
!>
!> Errors by grid and time step follow from runs of the same case on n/2 and n/4 intervals
!> (transients: with twice and four times the time step; first-order schemes: these and one on n by
!> the second-order scheme). Rules: modules grid_errors, pressure_errors.
module error_bars
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use film_waves, only: doubt_lost_waves, film_waves_t, lost_waves, new_film_waves
   use grid_errors, only: error_from_levels, error_on_grids, error_with_limit, kappa_share, &
      orders, pressure_safety_in_time, safety
   use inlet_errors, only: domain_change_t, inlet_shares
   use iteration_report, only: report_t
   use kinds, only: exceeds, larger, not_known, quotient, wp
   use line_contact, only: line_contact_t, time_settings_t
   use line_summary, only: line_summary_t, new_quantity, quantity_t
   use pressure_errors, only: allow_for_spike, doubt_shear, estimate_crest, spike_law_t, top_of
   use quantities, only: asperity_share, boundary_friction, friction_coefficient, h_central, &
      is_chance, quantity_count, quantity_rows, rule_between, rule_crest, rule_first, &
      rule_node, sliding_rows
   use wave_resolution, only: unseen_waves
   implicit none (type, external)
   private

   public :: apply_error_bars, copy_coarser, error_bars_t, missing_estimate, new_error_bars, &
      outlet_error

   !> Coarse runs of a result, and everything else its error estimates use.
   type :: error_bars_t
      !> Quantities on n/2, n/4 and, of a steady contact on a chosen grid, n/8 intervals; `grids` of
      !> them are known.
      integer :: grids = 0
      type(line_summary_t) :: coarser(3)
      !> Transients by a first-order scheme: quantities by the second-order scheme on the same grid,
      !> known if those on n/2 are.
      type(line_summary_t) :: second_order
      logical :: is_first_order = .false.
      !> Whether the space scheme is kappa, whose orders have other bounds.
      logical :: is_kappa = .false.
      !> Steady contacts by the kappa scheme: quantities by upwind2 on n, n/2 and n/4 intervals; not
      !> allocated: not known.
      type(line_summary_t), allocatable :: other_scheme(:)
      !> How a pressure spike grows on finer grids and a wave of the film decays.
      type(spike_law_t) :: spike_law
      !> Waves that features leave in the film.
      type(film_waves_t) :: waves
      !> Bounds of the errors by a graded grid, in the order of the table of quantities.
      real(wp), allocatable :: grid_errors(:)
      !> Why coarse runs give no error estimate; empty: they do.
      character(len=120) :: unseen = ''
      !> Whether the outlet cuts off the film, and what a longer one changes, on n/2 intervals or a
      !> graded grid.
      logical :: is_cut = .false.
      type(domain_change_t) :: outlet
      !> Measured influence of the inlet; replaces the inlet rule.
      type(domain_change_t) :: inlet
      !> Bound on the relative change of each quantity by what was left out of the model; NaN: not
      !> known.
      real(wp) :: left_out(quantity_count) = 0.0_wp
   end type error_bars_t

   !> Error of the exit between two nodes, in spacings.
   real(wp), parameter :: exit_jitter = 0.2_wp

contains

   !> Sets error estimates and extrapolated values of a converged result with spacing `dx`: grid and
   !> time step from coarse runs, domain and iteration from the report, and their sum, which is
   !> unknown without coarse runs.
   pure subroutine apply_error_bars(bars, report, dx, summary)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: iteration, oil_share

      if (allocated(bars%grid_errors)) then
         summary%of%error_grid = bars%grid_errors
      else
         call estimate_on_even(bars, report%steps > 0, dx, summary)
      end if
      iteration = max(report%residual, report%load_error)
      if (report%steps > 0) iteration = max(iteration, report%tolerance_effective)
      oil_share = 1.0_wp   ! heat does not change the friction coefficient of asperities
      if (exceeds(summary%of(boundary_friction)%value, 0.0_wp)) oil_share = 1 &
         - summary%of(boundary_friction)%value/summary%of(friction_coefficient)%value
      associate (of => summary%of)
         where (exceeds(abs(of%value), 0.0_wp)) of%error_model = bars%left_out*abs(of%value)
         of(sliding_rows)%error_model = of(sliding_rows)%error_model*oil_share
         of%error_domain = inlet_shares(bars%inlet, bars%spike_law%fluid, report, summary) &
            *abs(of%value) + cut_errors(bars)
         of%error_iteration = iteration*abs(of%value)
         of%error_estimate = of%error_grid + of%error_domain + of%error_iteration &
            + of%error_start + of%error_model
      end associate
   end subroutine apply_error_bars

   !> Sets the errors by an even grid and the time step, and extrapolated values.
   pure subroutine estimate_on_even(bars, is_transient, dx, summary)
      type(error_bars_t), intent(in) :: bars
      logical, intent(in) :: is_transient
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary

      if (bars%grids > 0 .and. bars%unseen == '') then
         call estimate_grid_errors(bars, is_transient, dx, summary)
         call allow_for_spike(bars%spike_law, dx, summary)
      end if
      call doubt_shear(bars%spike_law, dx, summary)
      call doubt_lost_waves(bars%waves, bars%spike_law, dx, summary)
      summary%of%error_grid = quantity_rows%widening*summary%of%error_grid
   end subroutine estimate_on_even

   !> Largest relative error by the outlet among the quantities of the closing table: 0 if it cuts
   !> off nothing, NaN if not known.
   pure real(wp) function outlet_error(bars) result(error)
      type(error_bars_t), intent(in) :: bars
      real(wp) :: errors(quantity_count)

      error = 0.0_wp
      if (bars%is_cut .and. .not. bars%outlet%is_known) error = not_known()
      if (.not. (bars%is_cut .and. bars%outlet%is_known)) return
      errors = quotient(cut_errors(bars), bars%outlet%near%of%value)
      error = max(0.0_wp, maxval(errors, quantity_rows%short /= '' .and. exceeds(errors, 0.0_wp)))
   end function outlet_error

   !> Errors by the outlet, from the values with this and with a longer outlet; NaN if these are not
   !> known.
   pure function cut_errors(bars) result(errors)
      type(error_bars_t), intent(in) :: bars
      real(wp) :: errors(quantity_count)

      errors = 0.0_wp
      if (bars%is_cut) errors = not_known()
      if (bars%is_cut .and. bars%outlet%is_known) errors = safety*abs(bars%outlet%near%of%value &
         - bars%outlet%far%of%value)
   end function cut_errors

   !> Why a quantity of `summary` on a grid of spacing `dx` has no estimate.
   pure function missing_estimate(bars, report, dx, summary) result(reason)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(in) :: summary
      character(:), allocatable :: reason, lost

      lost = ''
      if (report%converged .and. .not. allocated(bars%grid_errors)) lost = lost_waves(bars%waves, &
         bars%spike_law, dx, summary)
      if (.not. report%converged) then
         reason = 'no solution'
      else if (.not. all(exceeds(bars%left_out, -1.0_wp))) then   ! unknown
         reason = 'what was left out of the model may change it, or a pressure spike that this '// &
            'grid does not resolve'
      else if (allocated(bars%grid_errors) .and. (bars%outlet%is_known .or. .not. bars%is_cut)) then
         reason = 'a pressure spike has no end at the lengths of this grid: p_max is at least this'
      else if (bars%unseen /= '') then
         reason = trim(bars%unseen)
      else if (bars%is_cut .and. .not. bars%outlet%is_known) then
         reason = 'the outlet cuts the film off'
      else if (len(lost) > 0) then
         reason = lost
      else if (bars%grids > 1) then
         reason = 'a pressure spike that this grid does not resolve may pass the largest '// &
            'pressure on finer grids, or grow '// &
            'without a limit'
      else if (bars%grids == 1) then
         reason = 'only one coarser grid is compared'
      else
         reason = 'no coarser grids are compared'
      end if
   end function missing_estimate

   !> Error bars before any coarse run: orders of the schemes, and laws of spikes and waves.
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

   !> Copies the solutions on n/2, n/4 and n/8 intervals, as far as known.
   pure subroutine copy_coarser(bars, coarser)
      type(error_bars_t), intent(inout) :: bars
      type(line_summary_t), intent(in) :: coarser(:)

      bars%grids = min(size(coarser), size(bars%coarser))
      bars%coarser(:bars%grids) = coarser(:bars%grids)
   end subroutine copy_coarser

   !> Sets the errors of all quantities by grid and time step.
   pure subroutine estimate_grid_errors(bars, is_transient, dx, summary)
      type(error_bars_t), intent(in) :: bars
      logical, intent(in) :: is_transient
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      type(line_summary_t) :: accurate
      type(quantity_t) :: levels(4)
      integer :: i

      accurate = summary
      if (is_transient .and. bars%is_first_order) accurate = bars%second_order
      do i = 1, quantity_count
         levels = on_levels(bars, i, accurate)
         if (quantity_rows(i)%rule == rule_crest) then
            if (.not. all(ieee_is_finite(levels(:3)%between))) cycle
            if (is_transient) summary%of(i)%between = summary%crests%highest
         end if
         if (is_transient) then
            call estimate_in_time(levels(:3)%between, bars%is_first_order, i, dx, summary%of(i))
         else if (quantity_rows(i)%rule == rule_crest) then
            call estimate_crest(levels(:3)%between, levels(:3)%value, summary%of(i))
         else
            call estimate_at_rest(bars, i, levels, dx, ieee_is_finite(summary%crests%spike), &
               summary%of(i))
         end if
      end do
   end subroutine estimate_grid_errors

   !> Row `i` on n, n/2, n/4 and n/8 intervals, as far as known; between the nodes of the pressure
   !> lies the crest that is compared.
   pure function on_levels(bars, i, full) result(levels)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      type(line_summary_t), intent(in) :: full
      type(quantity_t) :: levels(4)
      integer :: k

      levels = new_quantity(i, [not_known(), not_known()], 0.0_wp)
      levels(1) = full%of(i)
      levels(2:1 + bars%grids) = bars%coarser(:bars%grids)%of(i)
      if (quantity_rows(i)%rule /= rule_crest) return
      levels(1)%between = top_of(full%crests)
      do k = 1, bars%grids
         levels(1 + k)%between = top_of(bars%coarser(k)%crests)
      end do
   end function on_levels

   !> Error of row `i` of a transient by grid and time step, from `values` between nodes of the
   !> second-order scheme on n, n/2 and n/4 intervals.
   pure subroutine estimate_in_time(values, is_first_order, i, dx, quantity)
      real(wp), intent(in) :: values(3), dx
      logical, intent(in) :: is_first_order
      integer, intent(in) :: i
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: found(2)

      found = error_with_limit(quantity%between, is_first_order, values, merge( &
         pressure_safety_in_time, 1.0_wp, quantity_rows(i)%rule == rule_crest))
      quantity%error_grid = found(1) + abs(quantity%value - quantity%between)
      if (quantity_rows(i)%rule == rule_between) then
         quantity%error_grid = quantity%error_grid + exit_jitter*dx
      else
         quantity%extrapolated = found(2)
      end if
   end subroutine estimate_in_time

   !> Error of row `i` of a steady contact by the grid. With a pressure spike, whose position is
   !> known to one spacing, an observed order of the smallest film does not persist.
   pure subroutine estimate_at_rest(bars, i, levels, dx, is_spiked, quantity)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      type(quantity_t), intent(in) :: levels(4)
      real(wp), intent(in) :: dx
      logical, intent(in) :: is_spiked
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: bounds(2), between(2), own(2)
      logical :: lasts

      bounds = merge(quantity_rows(i)%kappa_orders, orders, bars%is_kappa)
      lasts = .not. (is_spiked .and. is_chance(quantity_rows(i)) &
         .or. quantity_rows(i)%field == 'temperature_rise')   ! a maximum that moves with the nodes
      own = error_on_grids(levels%value, bounds, lasts)
      between = error_on_grids(levels%between, bounds, lasts)
      if (i == h_central) then   ! on a line between two nodes, whose error has a sign
         own = [between(1) + abs(quantity%value - quantity%between), between(2)]
         if (ieee_is_finite(between(2))) own(1) = max(between(1)/(2*safety), between(1) &
            + abs(quantity%value - between(2)) - abs(quantity%between - between(2)))
      end if
      between(1) = between(1) + abs(quantity%value - quantity%between)
      select case (quantity_rows(i)%rule)
      case (rule_node)
         own(1) = larger(own(1), between(1))
      case (rule_between)
         own = [between(1) + exit_jitter*dx, quantity%between]
      case (rule_first)
         own = [dx + error_from_levels(max(abs(levels(1)%value - levels(2)%value) - dx, 0.0_wp), &
            0.0_wp, orders(2)), not_known()]
      case default   ! its own values are enough, or what is known of them
      end select
      if (allocated(bars%other_scheme) .and. is_chance(quantity_rows(i))) own(1) = &
         error_by_other_scheme(bars%other_scheme, i) + abs(quantity%value - quantity%between)
      ! loads that fall from grid to grid do not fall below 0
      if (any(i == [asperity_share, boundary_friction]) .and. own(1) > quantity%value &
         .and. levels(2)%value > quantity%value) own = [quantity%value, not_known()]
      quantity%error_grid = own(1)
      quantity%extrapolated = own(2)
   end subroutine estimate_at_rest

   !> Error of row `i` by the kappa scheme between nodes: a share of the error by upwind2, which
   !> falls regularly.
   pure function error_by_other_scheme(other_scheme, i) result(error)
      type(line_summary_t), intent(in) :: other_scheme(:)
      integer, intent(in) :: i
      real(wp) :: error, films(4), error_and_limit(2)
      integer :: known

      films = not_known()
      known = min(size(other_scheme), 3)
      films(:known) = other_scheme(:known)%of(i)%between
      error_and_limit = error_on_grids(films, orders, lasts=.true.)
      error = kappa_share/safety*error_and_limit(1)
   end function error_by_other_scheme

end module error_bars

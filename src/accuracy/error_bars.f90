!> Error estimates of the quantities of a result: grid and time step, inlet, an outlet that cuts off
!> the film, iteration, what was left out of the model; their sum, or the reason why there is none.
!>
!> Errors by grid and time step follow from runs of the same case on n/2 and n/4 intervals
!> (transients: with twice and four times the time step; first-order schemes: these and one on n by
!> the second-order scheme). Rules: modules grid_errors, pressure_errors. Errors by the length of
!> the inlet follow from rules or, with an inlet close to the contact, from graded grids of the same
!> domain and of one with a far inlet, where the pressure next to a spike is compared.
module error_bars
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use film_waves, only: doubt_lost_waves, film_waves_t, lost_waves, new_film_waves
   use grid_errors, only: error_from_levels, error_on_grids, error_with_limit, kappa_share, &
      orders, pressure_safety_in_time, safety
   use iteration_report, only: report_t
   use kinds, only: exceeds, larger, not_known, quotient, wp
   use line_contact, only: line_contact_t, time_settings_t
   use line_summary, only: line_summary_t, quantity_t, value_between
   use lubricant, only: fluid_t, fluid_viscosity, thins
   use pressure_errors, only: allow_for_spike, doubt_shear, estimate_crest, spike_law_t, top_of
   use quantities, only: asperity_share, boundary_friction, friction_coefficient, h_central, &
      is_chance, p_max, quantity_count, quantity_rows, rule_between, rule_crest, rule_first, &
      rule_node, sheared_rows, sliding_rows
   use wave_resolution, only: unseen_waves
   implicit none (type, external)
   private

   public :: apply_error_bars, change_by_inlet, copy_coarser, domain_change_t, error_bars_t, &
      film_loss, missing_estimate, new_error_bars, outlet_error

   !> Films err by up to twice the share lost by starvation, and the exit by that share where the
   !> film is thick (M 0.5-500, L 0-30, against four times the domain).
   real(wp), parameter, public :: film_safety = 2.0_wp
   !> Forces err as films do, sliding by up to this many times the share of the pressures in
   !> addition; with a Newtonian oil as its viscosity does, where the largest pressure changes by a
   !> third of that share (M 2-70, L 3-9, against a domain twice as long).
   real(wp), parameter :: shear_safety = 1.5_wp, pressure_part = 1.0_wp/3.0_wp

   !> An estimate by runs is this many times the change plus this share of the largest change, since
   !> a single one may be small by chance.
   real(wp), parameter :: change_safety = 1.1_wp, doubt = 0.15_wp

   !> Quantities that may be unknown or 0 in a solution.
   logical, parameter :: may_be_unknown(*) = quantity_rows%field == '1' &
      .or. quantity_rows%field == 'x' .or. quantity_rows%field == 'friction_coefficient' &
      .or. quantity_rows%field == 'power'

   !> What a longer domain changes: quantities on the same and on the longer one.
   type :: domain_change_t
      logical :: is_known = .false.
      type(line_summary_t) :: near, far
   end type domain_change_t

   !> Coarse runs of a result, and everything else its error estimates use.
   type :: error_bars_t
      !> Quantities on n/2, n/4 and, at rest on a chosen grid, n/8 intervals: `grids` are known.
      integer :: grids = 0
      type(line_summary_t) :: coarser(3)
      !> Beside a first-order scheme those of second order on the same grid, known if on n/2.
      type(line_summary_t) :: second_order
      logical :: is_first_order = .false.
      !> Whether the space scheme is kappa, whose orders have other bounds.
      logical :: is_kappa = .false.
      !> Beside kappa at rest those of upwind2 on n, n/2 and n/4 intervals, if known.
      type(line_summary_t), allocatable :: other_scheme(:)
      !> How a pressure spike grows on finer grids and a wave of the film decays.
      type(spike_law_t) :: spike_law
      !> Waves that features leave in the film.
      type(film_waves_t) :: waves
      !> Bounds of the errors by a graded grid, in the order of the table of quantities.
      real(wp), allocatable :: grid_errors(:)
      !> Why coarse runs give no error estimate; empty: they do.
      character(len=120) :: unseen = ''
      !> Whether the outlet cuts off the film; what a longer one changes, on n/2 or a graded grid.
      logical :: is_cut = .false.
      type(domain_change_t) :: outlet
      !> Measured influence of the inlet; replaces the inlet rule.
      type(domain_change_t) :: inlet
      !> Bound on the relative change of each quantity by what the model leaves out; NaN: not known.
      real(wp) :: left_out(quantity_count) = 0.0_wp
   end type error_bars_t

   !> Error of the exit between two nodes, in spacings.
   real(wp), parameter :: exit_jitter = 0.2_wp

contains

   !> Sets error estimates and extrapolated values of a converged result with spacing `dx`: grid and
   !> time step from coarse runs, domain and iteration from the report, and their sum.
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

   !> Sets the errors by an even grid and the time step, and extrapolated values. Of the pressure
   !> the crests are compared between grids.
   pure subroutine estimate_on_even(bars, is_transient, dx, summary)
      type(error_bars_t), intent(in) :: bars
      logical, intent(in) :: is_transient
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      type(line_summary_t) :: grids(1 + bars%grids)
      real(wp), dimension(4) :: between, values
      real(wp) :: found(2)
      logical :: is_crest
      integer :: i

      if (bars%grids > 0 .and. bars%unseen == '') then
         grids = [summary, bars%coarser(:bars%grids)]
         if (is_transient .and. bars%is_first_order) grids(1) = bars%second_order
         do i = 1, quantity_count
            values = not_known()
            between = not_known()
            values(:size(grids)) = grids%of(i)%value
            between(:size(grids)) = grids%of(i)%between
            is_crest = quantity_rows(i)%rule == rule_crest
            if (is_crest) between(:size(grids)) = top_of(grids%crests)
            if (is_crest .and. .not. all(ieee_is_finite(between(:3)))) cycle
            associate (quantity => summary%of(i))
               if (is_transient) then
                  if (is_crest) quantity%between = summary%crests%highest
                  found = error_with_limit(quantity%between, bars%is_first_order, between(:3), &
                     merge(pressure_safety_in_time, 1.0_wp, is_crest))
                  quantity%error_grid = found(1) + abs(quantity%value - quantity%between)
                  if (quantity_rows(i)%rule == rule_between) quantity%error_grid = &
                     quantity%error_grid + exit_jitter*dx
                  if (quantity_rows(i)%rule /= rule_between) quantity%extrapolated = found(2)
               else if (is_crest) then
                  call estimate_crest(between(:3), values(:3), quantity)
               else
                  call estimate_at_rest(bars, i, values, between, dx, &
                     ieee_is_finite(summary%crests%spike), quantity)
               end if
            end associate
         end do
         call allow_for_spike(bars%spike_law, dx, summary)
      end if
      call doubt_shear(bars%spike_law, dx, summary)
      call doubt_lost_waves(bars%waves, bars%spike_law, dx, summary)
      summary%of%error_grid = quantity_rows%widening*summary%of%error_grid
   end subroutine estimate_on_even

   !> Largest relative error by the outlet of a quantity of the closing table; NaN: not known.
   pure real(wp) function outlet_error(bars) result(error)
      type(error_bars_t), intent(in) :: bars
      real(wp) :: errors(quantity_count)

      error = 0.0_wp
      if (.not. bars%is_cut) return
      error = not_known()
      if (.not. bars%outlet%is_known) return
      errors = quotient(cut_errors(bars), bars%outlet%near%of%value)
      error = max(0.0_wp, maxval(errors, quantity_rows%short /= '' .and. exceeds(errors, 0.0_wp)))
   end function outlet_error

   !> Errors by the outlet, from the values with this and with a longer outlet; NaN: not known.
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
      character(len=*), parameter :: by_grids(0:2) = [character(len=120) :: &
         'no coarser grids are compared', 'only one coarser grid is compared', &
         'a pressure spike that this grid does not resolve may pass the largest pressure on '// &
         'finer grids, or grow without a limit']

      reason = trim(by_grids(min(bars%grids, 2)))   ! or what follows, the last that holds
      if (report%converged .and. .not. allocated(bars%grid_errors)) then
         lost = lost_waves(bars%waves, bars%spike_law, dx, summary)
         if (lost /= '') reason = lost
      end if
      if (bars%is_cut .and. .not. bars%outlet%is_known) reason = 'the outlet cuts the film off'
      if (bars%unseen /= '') reason = trim(bars%unseen)
      if (allocated(bars%grid_errors) .and. (bars%outlet%is_known .or. .not. bars%is_cut)) reason &
         = 'a pressure spike has no end at the lengths of this grid: p_max is at least this'
      if (.not. all(exceeds(bars%left_out, -1.0_wp))) reason = 'what was left out of the model '// &
         'may change it, or a pressure spike that this grid does not resolve'   ! unknown
      if (.not. report%converged) reason = 'no solution'
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

   !> Error of row `i` of a steady contact by the grid, from its `values` and those `between` the
   !> nodes on n, n/2, n/4 and n/8 intervals. With a pressure spike, whose position is known to one
   !> spacing, an observed order of the smallest film does not persist.
   pure subroutine estimate_at_rest(bars, i, values, between, dx, is_spiked, quantity)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i
      real(wp), intent(in) :: values(4), between(4), dx
      logical, intent(in) :: is_spiked
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: bounds(2), own(2), smooth(2)
      logical :: lasts

      bounds = merge(quantity_rows(i)%kappa_orders, orders, bars%is_kappa)
      lasts = .not. (is_spiked .and. is_chance(quantity_rows(i)) &
         .or. quantity_rows(i)%field == 'temperature_rise')   ! a maximum that moves with the nodes
      own = error_on_grids(values, bounds, lasts)
      smooth = error_on_grids(between, bounds, lasts)
      if (i == h_central) then   ! on a line between two nodes, whose error has a sign
         own = [smooth(1) + abs(quantity%value - quantity%between), smooth(2)]
         if (ieee_is_finite(smooth(2))) own(1) = max(smooth(1)/(2*safety), smooth(1) &
            + abs(quantity%value - smooth(2)) - abs(quantity%between - smooth(2)))
      end if
      smooth(1) = smooth(1) + abs(quantity%value - quantity%between)
      select case (quantity_rows(i)%rule)
      case (rule_node)
         own(1) = larger(own(1), smooth(1))
      case (rule_between)
         own = [smooth(1) + exit_jitter*dx, quantity%between]
      case (rule_first)
         own = [dx + error_from_levels(max(abs(values(1) - values(2)) - dx, 0.0_wp), 0.0_wp, &
            orders(2)), not_known()]
      case default   ! its own values are enough, or what is known of them
      end select
      if (allocated(bars%other_scheme) .and. is_chance(quantity_rows(i))) then
         ! a share of the error by upwind2, which falls regularly
         smooth = error_on_grids(bars%other_scheme%of(i)%between, orders, lasts=.true.)
         own(1) = kappa_share/safety*smooth(1) + abs(quantity%value - quantity%between)
      end if
      ! loads that fall from grid to grid do not fall below 0
      if (any(i == [asperity_share, boundary_friction]) .and. own(1) > quantity%value &
         .and. values(2) > quantity%value) own = [quantity%value, not_known()]
      quantity%error_grid = own(1)
      quantity%extrapolated = own(2)
   end subroutine estimate_at_rest

   !> Relative errors of all quantities by the inlet: from the coarse runs of its `change`, else by
   !> the rules in the report.
   pure function inlet_shares(change, fluid, report, summary) result(shares)
      type(domain_change_t), intent(in) :: change
      type(fluid_t), intent(in) :: fluid
      type(report_t), intent(in) :: report
      type(line_summary_t), intent(in) :: summary
      real(wp) :: shares(quantity_count)
      real(wp) :: ln_mu(1), response

      if (change%is_known) then
         shares = change_by_inlet(change)
         where (quantity_rows%field == 'x' .and. ieee_is_finite(summary%of%value)) shares = &
            shares/max(abs(summary%of%value), tiny(1.0_wp))
         return
      end if
      shares = report%fit%inlet_error*min(1.0_wp, summary%of(h_central)%value)
      where (quantity_rows%field == 'pressure') shares = report%fit%inlet_pressure_error
      where (quantity_rows%field == 'film_thickness' .or. quantity_rows%field == 'power' &
         .or. quantity_rows%field == 'friction_coefficient' &
         .or. quantity_rows%field == 'temperature_rise') shares = film_safety &
         *report%fit%inlet_error
      response = shear_safety
      if (.not. thins(fluid) .and. ieee_is_finite(summary%of(p_max)%value)) then
         call fluid_viscosity(fluid, [summary%of(p_max)%value], ln_mu)
         response = max(response, pressure_part*ln_mu(1))
      end if
      shares(sheared_rows) = shares(sheared_rows) + response*report%fit%inlet_pressure_error
      shares([asperity_share, boundary_friction]) = abs(summary%asperity_response) &
         *(film_safety*report%fit%inlet_error)
   end function inlet_shares

   !> Estimated errors of all quantities by the inlet: relative; of positions in units of b; of
   !> positions or forces that are not known 0 is the change.
   pure function change_by_inlet(self) result(errors)
      type(domain_change_t), intent(in) :: self
      real(wp) :: errors(quantity_count)
      real(wp), dimension(quantity_count) :: near, far
      integer :: i

      near = [(value_between(self%near, i), i=1, quantity_count)]
      far = [(value_between(self%far, i), i=1, quantity_count)]
      if (all(ieee_is_finite([self%near%crests%spike, self%far%crests%spike, &
         self%near%crests%other, self%far%crests%other]))) then
         where (quantity_rows%rule == rule_crest)   ! that next to the spike
            near = self%near%crests%other
            far = self%far%crests%other
         end where
      end if
      errors = abs(1 - quotient(far, near))
      where (quantity_rows%field == 'x') errors = abs(near - far)
      where (may_be_unknown .and. .not. ieee_is_finite(errors)) errors = 0.0_wp
      errors = change_safety*errors + doubt*maxval(errors, quantity_rows%field == 'film_thickness')
      where (quantity_rows%field == 'pressure') errors = errors*(1 + doubt)
   end function change_by_inlet

   !> Share of the central film lost by starvation; 0 if the inlet thickens it.
   pure real(wp) function film_loss(self) result(loss)
      type(domain_change_t), intent(in) :: self

      loss = max(1 - quotient(value_between(self%near, h_central), value_between(self%far, &
         h_central)), 0.0_wp)
   end function film_loss

end module error_bars

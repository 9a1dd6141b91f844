!> Error estimates of the quantities of a result: grid and time step (modules grid_estimates,
!> split_errors), inlet (inlet_errors), an outlet that cuts off the film, iteration, and what was
!> left out of the model; their sum, or the reason why it is not known.
module error_bars
   use film_waves, only: doubt_lost_waves, film_waves_t, lost_waves, new_film_waves
   use grid_errors, only: safety
   use grid_estimates, only: coarse_values_t, estimate_grid_errors, exit_jitter
   use inlet_errors, only: inlet_change_t, inlet_shares
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_summary, only: line_summary_t
   use missing_value, only: exceeds, larger, not_known
   use pressure_errors, only: allow_for_spike, doubt_shear
   use pressure_spike, only: spike_law_t
   use quantities, only: boundary_friction, friction_coefficient, quantity_count, quantity_rows, &
      sliding_rows
   use solver_settings, only: time_settings_t
   use split_errors, only: apart_t, apply_forecast, forecast_t
   use wave_resolution, only: unseen_waves
   implicit none (type, external)
   private

   public :: apply_error_bars, error_bars_t, missing_estimate, new_error_bars, outlet_error

   !> Coarse runs of a result, and everything else its error estimates use.
   type, extends(coarse_values_t) :: error_bars_t
      !> How a pressure spike grows on finer grids and a wave of the film decays.
      type(spike_law_t) :: spike_law
      !> Waves that features leave in the film.
      type(film_waves_t) :: waves
      !> Bounds of the errors by a graded grid, in the order of the table of quantities.
      real(wp), allocatable :: grid_errors(:)
      !> Why coarse runs give no error estimate; empty or not allocated: they do.
      character(:), allocatable :: unseen
      !> Whether the outlet cuts off the film, and quantities with this outlet, on n/2 intervals or
      !> a graded grid, and with a longer one at the same spacing.
      logical :: is_cut = .false., has_longer = .false.
      type(line_summary_t) :: cut, longer
      !> Measured influence of the inlet; replaces the inlet rule.
      type(inlet_change_t) :: inlet
      !> Transients of chosen resolution: predictions of trial runs, and coarse runs with twice the
      !> spacing and with twice the time step.
      type(forecast_t) :: forecast
      type(apart_t) :: apart
      !> Bound on the relative change of each quantity by what was left out of the model; NaN: not
      !> known.
      real(wp) :: left_out(quantity_count) = 0.0_wp
   end type error_bars_t

contains

   !> Sets error estimates and extrapolated values of a converged result with spacing `dx`: grid and
   !> time step from coarse runs, domain and iteration from the report, and their sum, which is
   !> unknown without coarse runs.
   pure subroutine apply_error_bars(bars, report, dx, summary)
      type(error_bars_t), intent(in) :: bars
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: iteration, oil_share, domain(quantity_count)
      integer :: i

      if (allocated(bars%grid_errors)) then
         summary%of%error_grid = bars%grid_errors
      else
         call estimate_on_even(bars, report%steps > 0, dx, summary)
      end if
      iteration = max(report%residual, report%load_error)
      if (report%steps > 0) iteration = max(iteration, report%tolerance_effective)
      domain = inlet_shares(bars%inlet, bars%spike_law%fluid, report, summary)
      oil_share = 1.0_wp   ! heat does not change the friction coefficient of asperities
      if (exceeds(summary%of(boundary_friction)%value, 0.0_wp)) oil_share = 1 &
         - summary%of(boundary_friction)%value/summary%of(friction_coefficient)%value
      do i = 1, quantity_count
         associate (of => summary%of(i))
            if (exceeds(abs(of%value), 0.0_wp)) of%error_model = bars%left_out(i)*abs(of%value)
            if (any(i == sliding_rows)) of%error_model = of%error_model*oil_share
            of%error_domain = domain(i)*abs(of%value) + cut_error(bars, i)
            of%error_iteration = iteration*abs(of%value)
            of%error_estimate = of%error_grid + of%error_domain + of%error_iteration &
               + of%error_start + of%error_model
         end associate
      end do
   end subroutine apply_error_bars

   !> Sets the errors by an even grid and the time step, and extrapolated values.
   pure subroutine estimate_on_even(bars, is_transient, dx, summary)
      type(error_bars_t), intent(in) :: bars
      logical, intent(in) :: is_transient
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary

      if (bars%forecast%is_known) then
         call apply_forecast(bars%forecast, bars%apart, exit_jitter*dx, summary)
         call allow_for_spike(bars%spike_law, dx, summary)
      else if (bars%grids > 0 .and. .not. has_unseen_waves(bars)) then
         call estimate_grid_errors(bars%coarse_values_t, is_transient, dx, summary)
         call allow_for_spike(bars%spike_law, dx, summary)
      end if
      call doubt_shear(bars%spike_law, dx, summary)
      call doubt_lost_waves(bars%waves, bars%spike_law, dx, summary)
      summary%of%error_grid = quantity_rows%widening*summary%of%error_grid
   end subroutine estimate_on_even

   !> Whether the surfaces have waves that coarse runs do not resolve; a prediction resolves them.
   pure logical function has_unseen_waves(bars)
      type(error_bars_t), intent(in) :: bars

      has_unseen_waves = .false.
      if (allocated(bars%unseen)) has_unseen_waves = len(bars%unseen) > 0 &
         .and. .not. bars%forecast%is_known
   end function has_unseen_waves

   !> Largest relative error by the outlet among the quantities of the closing table: 0 if it cuts
   !> off nothing, NaN if not known.
   pure real(wp) function outlet_error(bars) result(error)
      type(error_bars_t), intent(in) :: bars
      integer :: i

      error = 0.0_wp
      if (.not. bars%is_cut) return
      error = not_known()
      if (.not. bars%has_longer) return
      error = 0.0_wp
      do i = 1, quantity_count
         if (len_trim(quantity_rows(i)%short) == 0) cycle
         associate (cut => bars%cut%of(i)%value)
            if (exceeds(cut, 0.0_wp)) error = larger(error, cut_error(bars, i)/cut)
         end associate
      end do
   end function outlet_error

   !> Error of row `i` by the outlet, from its values with this and with a longer outlet; NaN if
   !> these are not known.
   pure real(wp) function cut_error(bars, i) result(error)
      type(error_bars_t), intent(in) :: bars
      integer, intent(in) :: i

      error = 0.0_wp
      if (.not. bars%is_cut) return
      error = not_known()
      if (bars%has_longer) error = safety*abs(bars%cut%of(i)%value - bars%longer%of(i)%value)
   end function cut_error

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
      else if (allocated(bars%grid_errors) .and. (bars%has_longer .or. .not. bars%is_cut)) then
         reason = 'a pressure spike has no end at the lengths of this grid: p_max is at least this'
      else if (has_unseen_waves(bars)) then
         reason = bars%unseen
      else if (bars%is_cut .and. .not. bars%has_longer) then
         reason = 'the outlet cuts the film off'
      else if (len(lost) > 0) then
         reason = lost
      else if (bars%grids > 1 .or. bars%forecast%is_known) then
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

end module error_bars

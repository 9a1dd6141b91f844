!> How far off the figures of a result may be: the same case on half and on a quarter of the intervals (in a transient
!> with twice and four times the time step), and what the differences tell.
!>
!> With Q1, Q2, Q4 on n, n/2, n/4 intervals and the observed order p = log2 |Q2 - Q4|/|Q1 - Q2| the error of Q1 is
!> |Q1 - Q2|/(2^p - 1) (Roache, J. Fluids Eng. 116, 1994, 405). p is bounded: an order above the scheme's is chance.
module error_bars
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use domain_choice, only: choose_domain
   use ehl_line_solver, only: solve_ehl_line
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use line_summary, only: figure_t, keep_extremes, line_summary_t, summary_of
   use observer, only: observer_t, silent_observer_t
   use solver_settings, only: solver_settings_t, time_settings_t
   implicit none (type, external)
   private

   public :: error_bars_t, run_companions, choose_resolution, apply_error_bars, predicted_error, error_from_levels

   !> The companions of a result and what is known of the order of the scheme.
   type :: error_bars_t
      !> Figures on n/2 and n/4 intervals; valid where the logical says so.
      type(line_summary_t) :: half, quarter
      logical :: has_half = .false., has_quarter = .false.
      !> Bounds of the order of convergence: 2 in space, 1 or 2 in time.
      real(wp) :: lowest_order = 1.0_wp, highest_order = 2.0_wp
      !> A Newtonian piezoviscous contact: its pressure spike may be invisible on all three grids and has no limit on finer
      !> ones, so that the largest pressure gets no estimate.
      logical :: may_spike = .false.
   end type error_bars_t

   !> An estimate is widened by this factor: the observed order is uncertain.
   real(wp), parameter :: safety = 1.5_wp
   !> Even a rounded pressure spike sharpens with the grid: the largest pressure may converge this slowly.
   real(wp), parameter :: spike_order = 0.3_wp
   !> Above this alpha p_h a Newtonian contact may have a spike.
   real(wp), parameter :: spike_alpha_bar = 3.0_wp
   !> Companions have at least this many intervals; a resolution is not chosen above the largest.
   integer, parameter :: fewest_intervals = 32, most_intervals = 2**20

   !> Collects the figures of a run: of its state, or the extremes over its time steps.
   type, extends(silent_observer_t) :: collector_t
      type(line_summary_t) :: summary
      logical :: is_empty = .true.
      !> Whoever may stop the run.
      class(observer_t), pointer :: watcher => null()
   contains
      procedure :: on_cycle => look_at_cycle
      procedure :: on_step => collect_step
   end type collector_t

contains

   !> Runs the case on n/2 and n/4 intervals. A companion that finds no solution, or that `watcher` stops, leaves its figures
   !> unknown.
   subroutine run_companions(bars, contact, settings, time, watcher, error)
      type(error_bars_t), intent(out) :: bars
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector

      call bound_order(bars, contact, time)
      collector%watcher => watcher
      call run_companion(contact, settings, time, 4, collector, bars%has_quarter, error)
      if (allocated(error)) return
      bars%quarter = collector%summary
      call run_companion(contact, settings, time, 2, collector, bars%has_half, error)   ! error: the caller looks
      bars%half = collector%summary
   end subroutine run_companions

   !> Sets `contact%domain%intervals` = 2^k and the time step, proportional to dX, to the coarsest that is predicted to keep
   !> the relative error of h_min below `target`; leaves the companions of that resolution.
   subroutine choose_resolution(bars, contact, settings, time, target, watcher, error)
      type(error_bars_t), intent(out) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(inout) :: time
      real(wp), intent(in) :: target
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      real(wp) :: order, eighth
      logical :: has_eighth

      call bound_order(bars, contact, time)
      order = bars%lowest_order
      has_eighth = .false.
      contact%domain%intervals = 0
      call choose_domain(contact)
      time%time_step = 0.0_wp
      collector%watcher => watcher
      call run_companion(contact, settings, time, 4, collector, bars%has_quarter, error)
      if (allocated(error)) return
      bars%quarter = collector%summary
      do
         call run_companion(contact, settings, time, 2, collector, bars%has_half, error)
         if (allocated(error) .or. watcher%wants_stop) return
         bars%half = collector%summary
         if (bars%has_half .and. bars%has_quarter) then
            if (has_eighth) order = observed_order(bars%half%h_min%value, bars%quarter%h_min%value, eighth, &
               [bars%lowest_order, bars%highest_order])
            if (predicted_error(bars, order) <= target*bars%half%h_min%value) return
         end if
         if (2*contact%domain%intervals > most_intervals) return
         contact%domain%intervals = 2*contact%domain%intervals
         has_eighth = bars%has_quarter
         if (has_eighth) eighth = bars%quarter%h_min%value
         bars%quarter = bars%half
         bars%has_quarter = bars%has_half
      end do
   end subroutine choose_resolution

   !> Error of h_min to be expected on n intervals, from the companions alone and a believed order.
   pure function predicted_error(bars, order) result(error)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: order
      real(wp) :: error

      error = error_from_levels(bars%half%h_min%value, bars%quarter%h_min%value, order)/2.0_wp**order
   end function predicted_error

   !> Error estimates and Richardson's values for the figures of a result on n intervals of width `dx`.
   pure subroutine apply_error_bars(bars, dx, summary)
      type(error_bars_t), intent(in) :: bars
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary

      if (.not. bars%has_half) return
      call estimate(bars, bars%half%h_min, bars%quarter%h_min, bars%lowest_order, summary%h_min)
      call estimate(bars, bars%half%h_min_node, bars%quarter%h_min_node, bars%lowest_order, summary%h_min_node)
      call estimate(bars, bars%half%h_central, bars%quarter%h_central, bars%lowest_order, summary%h_central)
      if (.not. bars%may_spike) call estimate(bars, bars%half%p_max, bars%quarter%p_max, spike_order, summary%p_max)
      call estimate(bars, bars%half%x_cavitation, bars%quarter%x_cavitation, bars%lowest_order, summary%x_cavitation)
      ! nodal figures jump with the position of the nodes, which no difference of levels shows
      summary%h_min_node%error_estimate = max(summary%h_min_node%error_estimate, &
         summary%h_min%error_estimate + abs(summary%h_min_node%value - summary%h_min%value))
      summary%x_cavitation%error_estimate = summary%x_cavitation%error_estimate + 2*dx
      summary%p_max%error_estimate = summary%p_max%error_estimate + 0.5_wp*summary%p_max%value*dx**2
   end subroutine apply_error_bars

   !> Estimate and extrapolated value of one figure, whose order is not below `lowest_order`.
   pure subroutine estimate(bars, half, quarter, lowest_order, figure)
      type(error_bars_t), intent(in) :: bars
      type(figure_t), intent(in) :: half, quarter
      real(wp), intent(in) :: lowest_order
      type(figure_t), intent(inout) :: figure
      real(wp) :: order

      if (.not. bars%has_half) return
      if (.not. (ieee_is_finite(figure%value) .and. ieee_is_finite(half%value))) return
      order = lowest_order
      if (bars%has_quarter) then
         order = observed_order(figure%value, half%value, quarter%value, [lowest_order, bars%highest_order])
         figure%extrapolated = figure%value + (figure%value - half%value)/(2.0_wp**order - 1.0_wp)
      end if
      figure%error_estimate = error_from_levels(figure%value, half%value, order)
      ! terms of two orders and opposite signs may make the last difference small by chance
      if (bars%has_quarter .and. ieee_is_finite(quarter%value)) figure%error_estimate = max(figure%error_estimate, &
         error_from_levels(half%value, quarter%value, order)/2.0_wp**bars%highest_order)
   end subroutine estimate

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

   !> Bounds of the order (backward Euler is of first order), and whether a spike is to be feared.
   pure subroutine bound_order(bars, contact, time)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time

      bars%may_spike = contact%fluid%alpha_bar > spike_alpha_bar .and. .not. contact%fluid%is_eyring
      bars%lowest_order = 1.0_wp
      bars%highest_order = 2.0_wp
      if (time%is_transient .and. time%scheme == 'backward_euler') then
         bars%lowest_order = 0.7_wp
         bars%highest_order = 1.0_wp
      end if
   end subroutine bound_order

   !> The case on `factor` times fewer intervals with a time step as much larger; its figures are those of `collector`.
   subroutine run_companion(contact, settings, time, factor, collector, is_known, error)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      integer, intent(in) :: factor
      type(collector_t), intent(inout) :: collector
      logical, intent(out) :: is_known
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: coarse
      type(time_settings_t) :: coarse_time
      type(solver_settings_t) :: coarse_settings
      type(line_state_t) :: state
      type(report_t) :: report

      coarse = contact
      call choose_domain(coarse)
      coarse%domain%intervals = coarse%domain%intervals/factor
      coarse_time = time
      if (time%time_step > 0.0_wp) coarse_time%time_step = factor*time%time_step
      coarse_settings = settings
      coarse_settings%levels = 0
      coarse_settings%explains_failure = .false.
      coarse_settings%film_floor = 0.0_wp
      ! where Newton's method finds nothing on a coarser grid, nothing does: no long search
      if (settings%method == 'auto' .and. settings%smoother == 'auto') coarse_settings%method = 'newton_krylov'
      is_known = .false.
      collector%is_empty = .true.
      if (coarse%domain%intervals < fewest_intervals) return
      call solve_ehl_line(coarse, coarse_settings, coarse_time, collector, state, report, error)
      if (allocated(error)) return
      is_known = report%converged
      if (is_known .and. .not. time%is_transient) collector%summary = summary_of(state)
   end subroutine run_companion

   !> Cycles are of no interest here, but the outside is.
   subroutine look_at_cycle(self, cycle, residual, load_error)
      class(collector_t), intent(inout) :: self
      integer, intent(in) :: cycle
      real(wp), intent(in) :: residual
      real(wp), intent(in) :: load_error

      associate (unused_cycle => cycle, unused_residual => residual, unused_load_error => load_error)
      end associate
      call self%watcher%look_outside()
      self%wants_stop = self%watcher%wants_stop
   end subroutine look_at_cycle

   !> Widens the extremes by one time step.
   subroutine collect_step(self, step, steps, state, report)
      class(collector_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report

      associate (unused_step => step, unused_steps => steps, unused_report => report)
      end associate
      if (self%is_empty) then
         self%summary = summary_of(state)
      else
         call keep_extremes(self%summary, summary_of(state))
      end if
      self%is_empty = .false.
      call self%watcher%look_outside()
      self%wants_stop = self%watcher%wants_stop
   end subroutine collect_step

end module error_bars

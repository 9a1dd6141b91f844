!> Runs of the same case on coarser grids, in a transient with the larger time steps that belong to them, where the run itself
!> has not passed them on its way; and the grid and the time step of a transient for a wanted accuracy.
module companions
   use domain_choice, only: choose_domain, inlet_error
   use ehl_line_solver, only: solve_ehl_line
   use error_bars, only: domain_error, error_bars_t, estimated_error, new_error_bars, observed_order, predicted_error, &
      time_safety, time_safety_minimum
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: intervals_for_waves, line_contact_t
   use line_hierarchy, only: coarsest_for_film, most_intervals
   use line_state, only: line_state_t
   use line_summary, only: keep_extremes, line_summary_t, summary_of
   use observer, only: lookout_t, observer_t
   use solver_settings, only: solver_settings_t, time_settings_t
   implicit none (type, external)
   private

   public :: choose_resolution, run_companions

   !> Companions have at least this many intervals.
   integer, parameter :: fewest_intervals = 32

   !> Collects the figures of a run: of its state, or the extremes over its time steps.
   type, extends(lookout_t) :: collector_t
      type(line_summary_t) :: summary
      logical :: is_empty = .true.
      !> How much larger the time steps are than those of the run that it is compared with, and of how many of those one counts.
      integer :: factor = 1, stride = 1
      !> Coarser grids that a steady run has passed.
      type(error_bars_t) :: passed
   contains
      procedure :: on_step => collect_step
      procedure :: keep_companions => collect_companions
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

      bars = new_error_bars(contact, time)
      collector%watcher => watcher
      call run_companion(contact, settings, time, 2, collector, bars%has_half, error)
      if (allocated(error)) return
      bars%half = collector%summary
      if (collector%passed%has_half) then
         bars%has_quarter = .true.
         bars%quarter = collector%passed%half
      else
         call run_companion(contact, settings, time, 4, collector, bars%has_quarter, error)   ! error: the caller looks
         bars%quarter = collector%summary
      end if
   end subroutine run_companions

   !> In a transient sets `contact%domain%intervals` = 2^k and the time step, proportional to dX, to the coarsest that is predicted
   !> to keep the relative error of h_min below `settings%target`, or that of the last companion if its own estimate is; leaves
   !> the companions of that resolution. Each run costs four times the one before.
   subroutine choose_resolution(bars, contact, settings, time, watcher, error)
      type(error_bars_t), intent(out) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(inout) :: time
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(error_bars_t) :: coarser
      real(wp) :: order, target

      bars = new_error_bars(contact, time)
      target = settings%target
      if (.not. contact%domain%has_inlet) then
         call choose_domain(contact, settings%target)
         target = target - domain_error(inlet_error(contact))
      end if
      call choose_domain(contact)
      contact%domain%intervals = 2*max(coarsest_for_film(contact), fewest_intervals)
      time%time_step = 0.0_wp
      collector%watcher => watcher
      do
         coarser = bars
         bars%has_quarter = bars%has_half
         if (bars%has_half) bars%quarter = bars%half
         call run_companion(contact, settings, time, 2, collector, bars%has_half, error)
         if (allocated(error) .or. watcher%wants_stop) return
         bars%half = collector%summary
         if (bars%has_half .and. bars%has_quarter .and. contact%domain%intervals >= intervals_for_waves(contact)) then
            if (2*intervals_for_waves(contact) <= contact%domain%intervals .and. &
               time_safety_minimum*estimated_error(coarser, bars%half) <= target) then
               contact%domain%intervals = contact%domain%intervals/2
               bars = coarser
               return
            end if
            order = bars%lowest_order
            if (coarser%has_quarter) order = observed_order(bars%half%h_min%value, bars%quarter%h_min%value, &
               coarser%quarter%h_min%value, [bars%lowest_order, bars%highest_order])
            if (time_safety*predicted_error(bars, order) <= target*bars%half%h_min%value) return
         end if
         if (2*contact%domain%intervals > most_intervals) return
         contact%domain%intervals = 2*contact%domain%intervals
      end do
   end subroutine choose_resolution

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
      if (.not. time%is_transient) coarse_settings%method = 'newton_krylov'
      coarse_settings%target = 0.0_wp
      coarse_settings%wants_companions = .true.
      is_known = .false.
      collector%is_empty = .true.
      collector%factor = factor
      collector%stride = time%stride
      collector%passed%has_half = .false.
      if (coarse%domain%intervals < fewest_intervals) return
      call solve_ehl_line(coarse, coarse_settings, coarse_time, collector, state, report, error)
      if (allocated(error)) return
      is_known = report%converged
      if (is_known .and. .not. time%is_transient) collector%summary = summary_of(state)
   end subroutine run_companion

   !> Keeps what a steady run has passed.
   subroutine collect_companions(self, bars)
      class(collector_t), intent(inout) :: self
      type(error_bars_t), intent(in) :: bars

      self%passed = bars
   end subroutine collect_companions

   !> Widens the extremes by one time step, if it is the first one at or behind a time that the other run stores.
   subroutine collect_step(self, step, steps, state, report)
      class(collector_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report

      associate (unused_steps => steps, unused_report => report)
      end associate
      if (self%stride <= self%factor .or. modulo(self%factor*step, self%stride) < self%factor) then
         if (self%is_empty) self%summary = summary_of(state)
         call keep_extremes(self%summary, summary_of(state))
         self%is_empty = .false.
      end if
      call self%look_outside()
   end subroutine collect_step

end module companions

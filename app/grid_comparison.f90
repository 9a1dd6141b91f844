!> What a solved case is compared with for its error bars: itself on coarser grids, and where pilot
!> runs chose its grid, coarse runs that measure whether it is as good as foretold.
module grid_comparison
   use case_notes, only: note_measured_error, note_pressure_error
   use case_record, only: case_t
   use coarse_runs, only: side_runs_t, make_coarse_runs, make_side_runs, new_side_runs, &
      run_apart, copy_side_runs
   use error_bars, only: error_bars_t
   use errors, only: error_t
   use experiment, only: new_experiment
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use run_observer, only: run_observer_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: check_forecast, compare_grids

contains

   !> Coarse runs, unless the `side_runs` of a transient have been made already, and the `seconds`
   !> that they took. Error: memory or a library failed.
   subroutine compare_grids(case, listener, side_runs, seconds, error)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(side_runs_t), allocatable, intent(inout) :: side_runs
      real(wp), intent(out) :: seconds
      type(error_t), allocatable, intent(out) :: error
      type(error_bars_t) :: bars
      real(wp) :: start

      start = wall_seconds()
      if (case%time%is_transient) then
         if (.not. allocated(side_runs)) then
            side_runs = new_side_runs(new_experiment(case%contact, case%solver, case%time))
            call make_side_runs(side_runs, listener)
         end if
         call copy_side_runs(side_runs, bars, error)   ! error: the caller looks
      else
         call make_coarse_runs(bars, new_experiment(case%contact, case%solver, case%time), &
            listener, error)   ! error: the caller looks
      end if
      listener%writer%bars = bars
      seconds = wall_seconds() - start
   end subroutine compare_grids

   !> Whether a solution is as good as wanted: by coarse runs where pilots chose its grid and
   !> time step.
   subroutine check_forecast(case, listener, state, report, seconds, error)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      real(wp), intent(inout) :: seconds
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: start

      call note_pressure_error(case, listener, state, report)
      if (.not. (case%accuracy%has_error_bars .and. listener%writer%bars%forecast%is_known &
         .and. report%converged)) return
      start = wall_seconds()
      call run_apart(listener%writer%bars, new_experiment(case%contact, case%solver, case%time), &
         listener, error)
      if (allocated(error)) return
      seconds = seconds + wall_seconds() - start
      report%converged = .not. listener%is_stopping
      call note_measured_error(case, listener, state, report)
   end subroutine check_forecast

end module grid_comparison

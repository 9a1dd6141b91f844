!> The solution of a lubricated point contact, its quantities with their errors, and what the
!> ingredients of its model change.
module run_point_case
   use case_notes, only: note_case, note_missed_error
   use case_record, only: case_t, list_passage, set_effective
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use passage_times, only: new_passage_times
   use point_adequacy, only: measure_point_adequacy
   use point_errors, only: choose_passage, find_quantities
   use point_solver, only: point_run_t, solve_point
   use result_start, only: usual_stride
   use run_observer, only: run_observer_t
   use system_limits, only: peak_memory, processors
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_point_case

contains

   !> Solves `case`, or goes on from its checkpoint; the listener gets its quantities. Error: memory
   !> or a library failed.
   subroutine solve_point_case(case, listener, state, report, error)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(point_run_t) :: run
      type(line_summary_t) :: summary
      character(:), allocatable :: missing

      run%settings = case%solver
      run%time = case%time   ! with where it goes on
      run%threads = min(listener%threads, processors())
      if (case%time%is_transient) then
         if (case%solver%target > 0.0_wp) then   ! of a resumed passage too
            call choose_passage(run, case%point, listener)
            call move_alloc(listener%error, error)
            if (allocated(error)) return
            case%time = run%time
         end if
         associate (stride => case%output_settings%profile_stride, time => case%time)
            if (stride == 0) stride = usual_stride(time%end_time, time%time_step)
            listener%writer%profile_stride = stride
            listener%writer%run%time_step = time%time_step
         end associate
      end if
      associate (writer => listener%writer, adequacy => listener%writer%adequacy, &
         wish => case%output_settings%adequacy, times => listener%writer%run%passage%times)
         times = new_passage_times(case%point, case%time)
         call note_case(case, case%point, listener)
         missing = 'no solution'
         call solve_point(run, case%point, listener, state, report, error)
         if (allocated(error)) return
         if (.not. listener%is_stopping) then
            if (report%steps > 0) summary = writer%run%passage%extremes(summary_of(state))
            call find_quantities(run, case%point, listener, report, summary, missing)
         end if
         adequacy%is_full = wish == 'full'
         if (.not. listener%is_stopping .and. wish /= '.false.') call &
            measure_point_adequacy(run, case%point, summary, adequacy, listener, report)
         call move_alloc(listener%error, error)
         if (allocated(error)) return
         report%converged = report%converged .and. .not. listener%is_stopping
         report%cost%peak_memory = peak_memory()
         report%cost%wall_seconds = listener%earlier_seconds + wall_seconds() - listener%start
         writer%work = real(run%work, wp)
         writer%summary = summary
         writer%missing = missing
         if (case%solver%target > 0.0_wp) call note_missed_error(case, listener, summary, report)
         associate (domain => case%point%domain)   ! may be chosen by the program
            call set_effective(case, 'domain', 'x_inlet', [domain%x_inlet])
            call set_effective(case, 'domain', 'x_outlet', [domain%x_outlet])
            call set_effective(case, 'domain', 'y_half_width', [domain%y_half_width])
            call set_effective(case, 'domain', 'intervals_x', integer=domain%intervals)
            call set_effective(case, 'domain', 'intervals_y', integer=domain%rows)
         end associate
         if (case%time%is_transient) call set_effective(case, 'output', 'profile_stride', &
            integer=case%output_settings%profile_stride)
         call list_passage(case, case%point, times)
      end associate
   end subroutine solve_point_case

end module run_point_case

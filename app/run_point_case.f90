!> One lubricated point contact from its record to its result file and its exit status.
module run_point_case
   use case_notes, only: add_note, note_coarse_waves, note_target, note_unusual
   use case_outcome, only: case_outcome_t, outcome_of
   use case_record, only: case_t, list_passage, set_effective
   use errors, only: error_t
   use iteration_report, only: phase_output, phase_transient, report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use passage_times, only: new_passage_times, passage_note
   use point_adequacy, only: measure_point_adequacy
   use point_errors, only: choose_passage, find_quantities
   use point_march, only: solve_point
   use point_result, only: write_point_result
   use point_solver, only: point_run_t
   use progress_log, only: progress_log_t
   use result_end, only: close_result, judge_point_limits, suspend_result
   use result_start, only: start_result, usual_stride
   use run_observer, only: run_observer_t
   use system_limits, only: peak_memory, processors
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_point_case

contains

   !> Solves `case` on `threads` threads, or goes on from its checkpoint, writes its result `path`,
   !> and prints its closing table. Error: the result, or a library; there is no result then.
   subroutine solve_point_case(case, path, is_resume, log, threads, ending, error)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      logical, intent(in) :: is_resume
      type(progress_log_t), intent(in) :: log
      integer, intent(in) :: threads
      type(case_outcome_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(run_observer_t) :: listener
      type(point_run_t) :: run
      type(line_summary_t) :: summary
      type(line_state_t) :: state
      type(report_t) :: report
      character(:), allocatable :: missing, note

      listener%log = log
      listener%threads = threads
      listener%log%in_seconds = allocated(case%duty)
      call listener%log%start_case(case%file, case%scaling)
      call start_result(case, path, is_resume, listener, error)
      if (allocated(error)) return
      run%settings = case%solver
      run%time = case%time   ! with where it goes on
      run%threads = min(threads, processors())
      call choose_times(case, run, listener, error)
      if (allocated(error)) then
         call listener%writer%discard()
         return
      end if
      call note_unusual(case, note)
      listener%writer%run%passage%times = new_passage_times(case%point, case%time)
      call note_coarse_waves(case, case%point, listener, note)
      call add_note(case, listener, passage_note(case%point, &
         listener%writer%run%passage%times), note)
      missing = 'no solution'
      call solve_point(run, case%point, listener, state, report, error)
      if (.not. (allocated(error) .or. listener%is_stopping)) then
         if (report%steps > 0) summary = listener%writer%run%passage%extremes(summary_of(state))
         call find_quantities(run, case%point, listener, report, summary, missing, &
            error)   ! error: the condition below looks
      end if
      associate (adequacy => listener%writer%adequacy, wish => case%output_settings%adequacy)
         adequacy%is_full = wish == 'full'
         if (.not. (allocated(error) .or. listener%is_stopping .or. wish == '.false.')) call &
            measure_point_adequacy(run, case%point, summary, adequacy, listener, report, error)
      end associate
      if (allocated(error)) then
         call listener%writer%discard()
         return
      end if
      report%cost%peak_memory = peak_memory()
      associate (seconds => report%cost%phase_seconds)
         seconds(phase_output) = listener%output_seconds
         seconds(phase_transient) = max(seconds(phase_transient) - listener%output_seconds, 0.0_wp)
      end associate
      call listener%name_breakdown(report)
      report%cost%wall_seconds = listener%earlier_seconds + wall_seconds() - listener%start
      if (listener%is_stopping .and. .not. listener%writer%has_failed()) then
         call suspend_result(listener, ending)
         return
      end if
      call move_alloc(note, report%note)
      call note_target(case, summary, report)
      call judge_point_limits(case, state, summary, report, listener)
      associate (domain => case%point%domain)   ! may be chosen by the program
         call set_effective(case, 'domain', 'x_inlet', [domain%x_inlet])
         call set_effective(case, 'domain', 'x_outlet', [domain%x_outlet])
         call set_effective(case, 'domain', 'y_half_width', [domain%y_half_width])
         call set_effective(case, 'domain', 'intervals_x', integer=domain%intervals)
         call set_effective(case, 'domain', 'intervals_y', integer=domain%rows)
      end associate
      if (case%time%is_transient) call set_effective(case, 'output', 'profile_stride', &
         integer=case%output_settings%profile_stride)
      call list_passage(case, case%point, listener%writer%run%passage%times)
      associate (writer => listener%writer)
         call writer%begin_end(case)
         call write_point_result(writer, case, run, state, summary, report, missing)
         call writer%publish(report, error)
         if (allocated(error)) return
      end associate
      call close_result(listener, summary, report)
      ending = outcome_of(report)
   end subroutine solve_point_case

   !> Chooses grid and time step of a passage with a target, of a resumed one too, and the times
   !> whose fields are stored. Error (internal_error): LAPACK or FFTW.
   subroutine choose_times(case, run, listener, error)
      type(case_t), intent(inout) :: case
      type(point_run_t), intent(inout) :: run
      type(run_observer_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error

      if (.not. case%time%is_transient) return
      if (case%solver%target > 0.0_wp) then
         call choose_passage(run, case%point, listener, error)
         if (allocated(error)) return
         case%time = run%time
      end if
      associate (stride => case%output_settings%profile_stride, time => case%time)
         if (stride == 0) stride = usual_stride(time%end_time, time%time_step)
         listener%writer%profile_stride = stride
         listener%writer%run%time_step = time%time_step
      end associate
   end subroutine choose_times

end module run_point_case

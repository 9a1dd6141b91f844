!> One case from its record to its result file and its exit status.
module run_case
   use case_notes, only: unusual_text
   use case_record, only: case_t, result_path
   use command_line, only: command_t
   use errors, only: error_t
   use iteration_report, only: ending_text, has_converged, report_t
   use key_row, only: film, has_word, point
   use line_contact, only: line_contact_t
   use line_model, only: choose_lean_model, follow_momentum, measure_model, prepare_momentum
   use line_solution, only: solve_line_case
   use line_state, only: line_state_t
   use progress_log, only: new_progress_log, progress_log_t
   use result_end, only: case_outcome_t, end_result, give_up, status_converged, &
      status_not_converged
   use result_start, only: find_complete_result, start_result
   use run_dry_case, only: solve_and_write
   use run_point_case, only: solve_point_case
   use run_observer, only: run_observer_t
   use signals, only: begin_activity, begin_subject
   use xdmf_file, only: write_xdmf
   implicit none (type, external)
   private

   public :: run_one_case

contains

   !> Solves `case` as `command` says: folder of results, whether to go on, what to print.
   subroutine run_one_case(case, command, outcome)
      type(case_t), intent(inout) :: case
      type(command_t), intent(in) :: command
      type(case_outcome_t), intent(out) :: outcome
      type(progress_log_t) :: log
      type(error_t), allocatable :: error
      character(:), allocatable :: earlier, path, reason, words
      logical :: is_complete, is_resume

      log = new_progress_log(command%has('--quiet'), command%has('--outcomes'))
      log%is_verbose = command%has('--verbose')
      log%file = case%file
      log%name = case%file(index(case%file, '/', back=.true.) + 1:)
      log%scaling = case%scaling
      call begin_subject(case%file)
      call begin_activity('looking at earlier results')
      path = result_path(case, command%output_dir)
      is_complete = .false.
      is_resume = command%has('--resume') .and. .not. allocated(case%table)
      if (allocated(case%table)) then
         path = case%table%path
         is_complete = allocated(case%table%outcome)
         call move_alloc(case%table%outcome, earlier)
         call move_alloc(case%table%reason, reason)
      end if
      if (is_resume) call find_complete_result(path, case, is_complete, earlier, reason, error)
      if (allocated(error)) then
         call give_up(error, log, outcome)
         return
      end if
      if (is_complete) then
         if (earlier == has_converged) then
            call log%say(case%file//': '//path//' is complete: nothing to do')
         else
            call log%say_error(case%file//': '//path//' is there, ' &
               //ending_text(earlier, reason)//'; without --resume it is computed again')
            outcome = case_outcome_t(status_not_converged, reason)
         end if
         return
      end if
      words = unusual_text(case)
      if (words /= '') call log%say(words(2:))
      if (has_word(film, trim(case%problem))) then
         call run_lubricated_case(case, path, is_resume, command%threads, log, outcome)
      else
         call solve_and_write(case, path, log, command%threads, outcome, error)
         if (allocated(error)) call give_up(error, log, outcome)
      end if
      if (case%has_xdmf .and. any(outcome%status == [status_converged, status_not_converged])) then
         call write_xdmf(path, error)
         if (allocated(error)) call give_up(error, log, outcome)
      end if
   end subroutine run_one_case

   !> Solves a lubricated case on up to `threads` threads and writes its result `path`.
   subroutine run_lubricated_case(case, path, is_resume, threads, log, outcome)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      logical, intent(in) :: is_resume
      integer, intent(in) :: threads
      type(progress_log_t), intent(in) :: log
      type(case_outcome_t), intent(out) :: outcome
      type(run_observer_t) :: listener
      type(line_contact_t) :: rough   ! with all of its roughness
      type(line_state_t) :: state
      type(report_t) :: report
      type(error_t), allocatable :: error

      listener%log = log
      listener%threads = threads
      rough = case%contact
      listener%log%in_seconds = allocated(case%duty)
      call prepare_momentum(case, listener)
      call start_result(case, path, is_resume, listener, error)
      if (.not. allocated(error)) then
         if (case%problem == point) then
            call solve_point_case(case, listener, state, report, error)
         else
            call choose_lean_model(case, listener, error)
            if (.not. allocated(error)) call solve_line_case(case, listener, state, report, error)
            if (.not. allocated(error)) call measure_model(case, listener, state, report, error)
            if (.not. allocated(error)) call follow_momentum(case, listener, state, report, error)
         end if
         if (allocated(error)) call listener%writer%discard()
      end if
      rough%domain = case%contact%domain
      case%contact = rough
      if (allocated(error)) then
         call give_up(error, listener%log, outcome)
      else
         call end_result(case, listener, state, report, outcome)
      end if
   end subroutine run_lubricated_case

end module run_case

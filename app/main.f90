!> asperity: reads the command line and the namelists, runs the cases, ends with the exit status.
program asperity
   use, intrinsic :: iso_c_binding, only: c_int
   use build_info, only: git_commit, program_name, program_version
   use c_library, only: c_exit, standard_error
   use result_end, only: case_outcome_t, count_outcome, status_interrupted, status_not_written
   use case_record, only: case_t
   use command_line, only: command_t, help_text, read_command_line
   use disk_file, only: make_folder
   use errors, only: error_t, output_error
   use input_manual, only: keys_text, template_text
   use progress_log, only: is_terminal, new_progress_log, print_text, progress_log_t, &
      settle_standard_streams
   use read_cases, only: read_all_cases, report_good, status_bad_input
   use result_table, only: print_results
   use run_case, only: run_one_case
   use signals, only: is_interrupted, listen_to_signals, disarm_exit_message, watch_silence
   use system_limits, only: check_stack, settle_memory
   implicit none (type, external)

   type(command_t) :: command
   type(error_t), allocatable :: error
   type(progress_log_t) :: log
   integer :: status

   status = 0
   call settle_standard_streams()
   call check_stack(error)
   if (.not. allocated(error)) call settle_memory(error)
   if (.not. allocated(error)) call read_command_line(command, error)
   if (.not. allocated(error)) call obey(command, status, error)
   if (allocated(error)) then
      log = new_progress_log(is_quiet=.false.)
      call log%say(error%message)
      status = merge(status_not_written, status_bad_input, error%kind == output_error)
   end if
   call disarm_exit_message(is_over=.true.)
   ! without the ends of libraries: a thread of OpenBLAS that gets no memory never returns
   if (status /= 0) call c_exit(int(status, c_int))

contains

   !> Does what the command asks for.
   subroutine obey(command, status, error)
      type(command_t), intent(in) :: command
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error

      select case (command%action)
      case ('help')
         call print_text(help_text(), error)
      case ('version')
         call print_text(program_name // ' ' // program_version // ' (commit ' // git_commit() &
            // ')' // new_line('a'), error)
      case ('template')
         call print_text(template_text(command%problem), error)
      case ('keys', 'keys-markdown')
         call print_text(keys_text(is_page=command%action == 'keys-markdown'), error)
      case ('table')
         call print_results(command%files, command%form, status, error)
      case default
         call check_or_run(command, status, error)
      end select
   end subroutine obey

   !> Reads and checks or runs all cases; `status`: the largest. Error: bad input; output is lost.
   subroutine check_or_run(command, status, error)
      type(command_t), intent(in) :: command
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error
      type(case_t), allocatable :: cases(:)
      type(progress_log_t) :: log
      type(case_outcome_t) :: outcome
      integer :: i

      call listen_to_signals()
      if (.not. command%has('--quiet')) call watch_silence(is_terminal(standard_error))
      call read_all_cases(command, cases, status, error)
      if (allocated(error)) return
      if (command%action == 'check') then
         call report_good(cases, error)
         return
      end if
      call make_folder(command%output_dir)
      do i = 1, size(cases)
         if (is_interrupted()) then   ! no further case is started
            log = new_progress_log(command%has('--quiet'))
            call disarm_exit_message(is_over=.false.)
            if (outcome%status /= status_interrupted) call log%say_error('interrupted before ' &
               // cases(i)%file)
            status = status_interrupted
            return
         end if
         call run_one_case(cases(i), command, outcome)
         call count_outcome(cases(i)%file, outcome, command%has('--outcomes'), status, error)
         if (allocated(error)) return
      end do
   end subroutine check_or_run

end program asperity

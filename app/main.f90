!> asperity: reads the command line and the namelists, runs the cases, ends with the exit status.
program asperity
   use, intrinsic :: iso_fortran_env, only: error_unit, output_unit
   use build_info, only: git_commit, program_name, program_version
   use case_outcome, only: status_interrupted
   use case_record, only: case_t
   use command_line, only: command_t, help_text, read_command_line
   use errors, only: error_t
   use input_manual, only: keys_markdown, keys_text
   use input_template, only: template_text
   use interruption, only: is_interrupted
   use read_cases, only: read_all_cases
   use run_case, only: run_one_case
   implicit none (type, external)

   !> Exit status of bad input, usage or file.
   integer, parameter :: status_bad_input = 1
   type(command_t) :: command
   type(error_t), allocatable :: error
   integer :: status

   status = 0
   call read_command_line(command, error)
   if (.not. allocated(error)) call obey(command, status, error)
   if (allocated(error)) then
      write (error_unit, '(a)') error%message
      status = status_bad_input
   end if
   if (status /= 0) stop status, quiet=.true.

contains

   !> Does what the command asks for.
   subroutine obey(command, status, error)
      type(command_t), intent(in) :: command
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error
      type(case_t), allocatable :: cases(:)
      integer :: i, this_status

      select case (command%action)
      case ('help')
         write (output_unit, '(a)', advance='no') help_text()
      case ('version')
         write (output_unit, '(a)') program_name // ' ' // program_version // ' (commit ' // git_commit() // ')'
      case ('template')
         write (output_unit, '(a)', advance='no') template_text(command%problem)
      case ('keys')
         write (output_unit, '(a)', advance='no') keys_text()
      case ('keys-markdown')
         write (output_unit, '(a)', advance='no') keys_markdown()
      case default
         call read_all_cases(command%files, command%output_dir, cases, error)
         if (allocated(error)) return
         do i = 1, size(cases)
            if (command%action == 'check') then
               write (output_unit, '(a)') cases(i)%file // ': no findings'
               cycle
            end if
            call run_one_case(cases(i), command, this_status)
            status = max(status, this_status)
            if (.not. is_interrupted()) cycle
            if (i < size(cases)) status = status_interrupted
            exit
         end do
      end select
   end subroutine obey

end program asperity

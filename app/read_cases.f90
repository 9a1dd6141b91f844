!> Reads and checks all cases of a call before any of them runs, and reports the findings.
module read_cases
   use case_input, only: read_case
   use case_notes, only: expected_seconds, time_text, unusual_text
   use case_outcome, only: case_outcome_t, count_outcome
   use case_record, only: case_t
   use command_line, only: command_t
   use disk_file, only: file_fault
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use output_names, only: output_findings
   use progress_log, only: new_progress_log, progress_log_t
   use set_entries, only: put_entries
   use signals, only: begin_activity, begin_subject
   use standard_streams, only: print_text, write_text
   use text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: read_all_cases, refused_t, report_good, report_refused

   !> Exit status of bad input, usage or file.
   integer, parameter, public :: status_bad_input = 1

   !> A file with bad input.
   type :: refused_t
      character(:), allocatable :: file, findings
   end type refused_t

contains

   !> Reads the files of `command` into `cases`. `refused` are those with findings, if the others
   !> are to run without them. Error (input_error): the findings of all files, or results that
   !> cannot have their names.
   subroutine read_all_cases(command, cases, refused, error)
      type(command_t), intent(in) :: command
      type(case_t), allocatable, intent(out) :: cases(:)
      type(refused_t), allocatable, intent(out) :: refused(:)
      type(error_t), allocatable, intent(out) :: error
      character(len=len(command%files)), allocatable :: files(:)
      logical :: is_good(size(command%files))
      character(:), allocatable :: problems
      integer :: i

      allocate (refused(0))
      call read_files(command%files, command, cases, is_good, refused)
      if (command%keeps_going .and. .not. all(is_good)) then
         files = pack(command%files, is_good)
         call read_files(files, command, cases, is_good(:size(files)), refused)
      end if
      problems = ''
      if (command%keeps_going .or. all(is_good)) then
         problems = output_findings(cases, command%output_dir, &
            command%is_resume)
      else
         do i = 1, size(refused)
            if (i > 1) problems = problems // new_line('a')
            problems = problems // refused(i)%findings
         end do
      end if
      if (len(problems) > 0) call fail(error, input_error, problems)
   end subroutine read_all_cases

   !> Reads `files` (n) into `cases`; which are good, and what is wrong with the others.
   subroutine read_files(files, command, cases, is_good, refused)
      character(*), intent(in) :: files(:)
      type(command_t), intent(in) :: command
      type(case_t), allocatable, intent(out) :: cases(:)
      logical, intent(out) :: is_good(:)
      type(refused_t), allocatable, intent(inout) :: refused(:)
      type(refused_t), allocatable :: all_files(:)
      integer :: i

      allocate (cases(size(files)), all_files(size(files)))
      do i = 1, size(files)
         all_files(i)%file = trim(files(i))
         call read_one(all_files(i)%file, command, cases(i), all_files(i)%findings)
         is_good(i) = len(all_files(i)%findings) == 0
      end do
      refused = [refused, all_files(pack([(i, i=1, size(files))], .not. is_good))]
   end subroutine read_files

   !> Reads one file; `found` is what is wrong with it, empty if nothing.
   subroutine read_one(file, command, case, found)
      character(*), intent(in) :: file
      type(command_t), intent(in) :: command
      type(case_t), intent(out) :: case
      character(:), allocatable, intent(out) :: found
      character(:), allocatable :: content
      type(findings_t) :: findings
      type(error_t), allocatable :: error

      found = ''
      call begin_subject(file)
      call begin_activity('reading the case')
      call read_text_file(file, content, error)
      if (allocated(error)) then
         found = error%message
         if (file_fault(file) /= '' .and. file_fault(file//'.nml') == '') found = found &
            //'; did you mean '//file//'.nml?'
         return
      end if
      call put_entries(content, command%entries)
      call read_case(content, file, case, findings, command%entries)
      if (findings%count > 0) found = findings%report(file)
   end subroutine read_one

   !> Reports the files that are left out. Error: standard output is lost.
   subroutine report_refused(refused, command, status, error)
      type(refused_t), intent(in) :: refused(:)
      type(command_t), intent(in) :: command
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error
      type(progress_log_t) :: log
      type(case_outcome_t) :: outcome
      integer :: i

      log = new_progress_log(is_quiet=.false.)
      do i = 1, size(refused)
         call log%say(refused(i)%findings)
         outcome%status = status_bad_input
         outcome%reason = refused(i)%findings
         call count_outcome(refused(i)%file, outcome, command%has_outcomes, status, error)
         if (allocated(error)) return
      end do
   end subroutine report_refused

   !> Reports good cases, with the time that long ones take and unusual values, for --check. Error:
   !> standard output is lost.
   subroutine report_good(cases, error)
      type(case_t), intent(in) :: cases(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: lines
      integer :: i

      do i = 1, size(cases)
         lines = cases(i)%file//': no findings'
         if (expected_seconds(cases(i)) >= 60) lines = lines//'; '//time_text(cases(i))
         call write_text(lines//unusual_text(cases(i))//new_line('a'), error)
         if (allocated(error)) return
      end do
      call print_text('', error)   ! error: handed up
   end subroutine report_good

end module read_cases

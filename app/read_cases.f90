!> Reads and checks all cases of a call before any of them runs.
module read_cases
   use case_input, only: read_case
   use case_record, only: case_t
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use life_sign, only: begin_activity, begin_subject
   use output_names, only: output_findings
   use text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: read_all_cases

contains

   !> Reads `files` into `cases`. Error (input_error): the findings of all files, or results that
   !> cannot have their names.
   subroutine read_all_cases(files, output_dir, cases, error)
      character(*), intent(in) :: files(:), output_dir
      type(case_t), allocatable, intent(out) :: cases(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: problems, found
      integer :: i

      allocate (cases(size(files)))
      problems = ''
      do i = 1, size(files)
         call read_one(trim(files(i)), cases(i), found)
         if (len(found) > 0 .and. len(problems) > 0) problems = problems // new_line('a')
         problems = problems // found
      end do
      if (len(problems) == 0) problems = output_findings(cases, output_dir)
      if (len(problems) > 0) call fail(error, input_error, problems)
   end subroutine read_all_cases

   !> Reads one file; `found` is what is wrong with it, empty if nothing.
   subroutine read_one(file, case, found)
      character(*), intent(in) :: file
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
         return
      end if
      call read_case(content, file, case, findings)
      if (findings%count > 0) found = findings%report(file)
   end subroutine read_one

end module read_cases

!> Reads and checks all cases of a call before any of them runs, and reports the findings; whether
!> their results can have their names. No result may take the place of an input, of another result,
!> or of a file that this program has not written. What is compared are files, not paths: device and
!> inode behind all links, or folder and name of what is not there yet.
module read_cases
   use build_info, only: program_name
   use case_input, only: read_case
   use case_notes, only: minute, time_text, unusual_text
   use result_end, only: case_outcome_t, count_outcome
   use case_record, only: case_t, path_from_namelist, result_path
   use command_line, only: command_t
   use disk_file, only: any_mark, file_at, file_fault, file_identity_t, folder_of, hdf5_mark, &
      kind_missing, kind_other, kind_regular, place_fault, xdmf_mark
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use progress_log, only: new_progress_log, print_text, progress_log_t, write_text
   use result_file, only: working_endings
   use set_entries, only: put_entries
   use signals, only: begin_activity, begin_subject
   use summary_head, only: plan_rows
   use text_file, only: read_text_file
   use xdmf_file, only: xdmf_path
   implicit none (type, external)
   private

   public :: read_all_cases, report_good

   !> Exit status of bad input, usage or file.
   integer, parameter, public :: status_bad_input = 1

   !> A file, and what is wrong with it.
   type :: refused_t
      character(:), allocatable :: file, findings
   end type refused_t

   !> An input or output, there or not yet.
   type :: place_t
      character(:), allocatable :: path
      !> 'namelist' or 'height file'; of an output 'result', 'XDMF file' or 'temporary file'.
      character(len=16) :: what = ''
      !> Number of its case.
      integer :: owner = 0
      !> Where the path leads to: the file, or folder and name of what is not there yet.
      character(:), allocatable :: key
      !> Number of the next place with a key of the same hash.
      integer :: next = 0
   end type place_t

contains

   !> Reads the files of `command` into `cases`; those with findings are reported and make `status`
   !> that of bad input, if the others are to run without them. Errors (input_error): else all
   !> findings; results or a table that cannot be as they are named; standard output is lost.
   subroutine read_all_cases(command, cases, status, error)
      type(command_t), intent(in) :: command
      type(case_t), allocatable, intent(out) :: cases(:)
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error
      type(refused_t), allocatable :: refused(:)
      type(case_t), allocatable :: good(:)
      character(:), allocatable :: problems
      type(refused_t) :: files(size(command%files))
      logical :: is_good(size(files))
      integer :: i

      allocate (cases(size(files)))
      do i = 1, size(cases)
         files(i)%file = trim(command%files(i))
         call read_one(files(i)%file, command, cases(i), files(i)%findings)
         is_good(i) = len(files(i)%findings) == 0
      end do
      refused = files(pack([(i, i=1, size(files))], .not. is_good))
      problems = ''
      if (size(refused) > 0 .and. .not. command%has('--keep-going')) then
         do i = 1, size(refused)
            if (i > 1) problems = problems // new_line('a')
            problems = problems // refused(i)%findings
         end do
      else
         if (size(refused) > 0) then
            allocate (good(count(is_good)))
            good = cases(pack([(i, i=1, size(cases))], is_good))
            call move_alloc(good, cases)
         end if
         if (command%summary == '') then
            problems = output_findings(cases, command%output_dir, command%has('--resume'))
         else
            call plan_rows(cases, command%has('--resume'), error)   ! error: handed up
         end if
      end if
      if (len(problems) > 0) call fail(error, input_error, problems)
      if (.not. allocated(error)) call report_refused(refused, command, status, error)
   end subroutine read_all_cases

   !> Reads one file; `found` is what is wrong with it, or nothing.
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
      if (command%summary == '') return
      allocate (case%table)
      case%table%path = command%summary
      if (found == '' .and. case%has_xdmf) found = file//': found &output xdmf = .true. and '// &
         '--summary, expected one of them: a table has no fields'
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
         call count_outcome(refused(i)%file, outcome, command%has('--outcomes'), status, error)
         if (allocated(error)) return
      end do
   end subroutine report_refused

   !> For --check: good cases, long times, unusual values. Error: standard output is lost.
   subroutine report_good(cases, error)
      type(case_t), intent(in) :: cases(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: lines
      integer :: i

      do i = 1, size(cases)
         lines = time_text(cases(i), minute)
         if (lines /= '') lines = '; '//lines
         lines = cases(i)%file//': no findings'//lines
         call write_text(lines//unusual_text(cases(i))//new_line('a'), &
            error)   ! error: stays
      end do
      call print_text('', error)   ! error: handed up
   end subroutine report_good

   !> All objections to the results of `cases` in the folder `output_dir` (empty: where the cases
   !> say), a line each: of two outputs in one place to the later one, if one is a result. A run
   !> that goes on with a checkpoint looks at it itself, and at NAME.part.
   function output_findings(cases, output_dir, is_resume) result(problems)
      type(case_t), intent(in) :: cases(:)
      character(*), intent(in) :: output_dir
      logical, intent(in) :: is_resume
      character(:), allocatable :: path, problems
      type(place_t), allocatable :: places(:)
      integer, allocatable :: last(:)
      integer :: i, j, n

      n = size(cases)*(4 + size(working_endings))
      do i = 1, size(cases)
         n = n + count(cases(i)%effective%key == 'file')
      end do
      allocate (places(n))
      allocate (last(0:n), source=0)   ! the last place of each hash
      n = 0
      problems = ''
      do i = 1, size(cases)
         call add(cases(i)%file, 'namelist', is_output=.false.)
         do j = 1, size(cases(i)%effective)
            associate (entry => cases(i)%effective(j))
               if (entry%key == 'file') call add(path_from_namelist(cases(i), trim(entry%text)), &
                  'height file', is_output=.false.)
            end associate
         end do
      end do
      do i = 1, size(cases)
         path = result_path(cases(i), output_dir)
         call add(path, 'result', is_output=.true.)
         if (cases(i)%has_xdmf) then
            call add(xdmf_path(path), 'XDMF file', is_output=.true.)
            call add(xdmf_path(path)//'.part', 'temporary file', is_output=.true.)
         end if
         do j = 1, size(working_endings)
            call add(path//trim(working_endings(j)), 'temporary file', is_output=.true.)
         end do
      end do

   contains

      !> Adds one more place of case `i`, by a hash of its key, and the objections to an output.
      subroutine add(path, what, is_output)
         character(*), intent(in) :: path, what
         logical, intent(in) :: is_output
         character(:), allocatable :: found
         integer :: bucket, first, k

         n = n + 1
         places(n)%path = path
         places(n)%what = what
         places(n)%owner = i
         places(n)%key = key_of(path)
         bucket = 0
         do k = 1, len(places(n)%key)
            bucket = modulo(31*bucket + iachar(places(n)%key(k:k)), size(last))
         end do
         first = last(bucket)
         do while (first > 0)
            if (places(first)%key == places(n)%key) exit
            first = places(first)%next
         end do
         if (first == 0) then
            places(n)%next = last(bucket)
            last(bucket) = n
            first = n
         end if
         if (.not. is_output) return
         associate (output => places(n), other => places(first))
            if (any(other%what == [character(len=16) :: 'namelist', 'height file'])) then
               found = 'found the '//trim(other%what)//' '//other%path//' as its '//what// &
                  ', expected another &case output'
            else if (other%owner /= i .and. any([other%what, output%what] == 'result')) then
               found = 'found the '//what//' '//path//', which is also that of '// &
                  cases(other%owner)%file//', expected different names'
            else
               found = taken_finding(output, is_resume)
            end if
         end associate
         if (found == '') return
         if (problems /= '') problems = problems//new_line('a')
         problems = problems//cases(i)%file//': '//found
      end subroutine add

   end function output_findings

   !> Where `path` leads to.
   function key_of(path) result(key)
      character(*), intent(in) :: path
      character(:), allocatable :: key
      type(file_identity_t) :: found

      key = path
      found = file_at(path, follows=.true.)
      if (found%kind /= kind_missing) then
         key = found%word
         return
      end if
      found = file_at(folder_of(path), follows=.true.)
      if (found%kind /= kind_missing) key = found%word//path(index('/'//path, '/', back=.true.):)
   end function key_of

   !> The objection to an `output` because of what is there already; empty: nothing, or an older
   !> one. (A folder stops its own case only, later; so does a link instead of a temporary file.)
   function taken_finding(output, is_resume) result(found)
      type(place_t), intent(in) :: output
      logical, intent(in) :: is_resume
      character(:), allocatable :: found
      type(file_identity_t) :: file
      logical :: is_temporary, is_taken

      found = ''
      is_temporary = output%what == 'temporary file'
      if (is_temporary) then
         file = file_at(output%path, follows=.false.)
         is_taken = file%kind == kind_regular .and. place_fault(output%path, any_mark) /= ''
         if (is_resume) is_taken = is_taken .and. index(output%path, '.tmp', back=.true.) &
            == len(output%path) - 3
      else
         file = file_at(output%path, follows=.true.)
         is_taken = file%kind == kind_other .or. place_fault(output%path, merge(hdf5_mark, &
            xdmf_mark, output%what == 'result')) /= ''
      end if
      if (is_taken) found = 'found '//output%path//' as its '//trim(output%what) &
         //', which is there and no '//trim(output%what)//' of '//program_name &
         //', expected another &case output (or remove it)'
   end function taken_finding

end module read_cases

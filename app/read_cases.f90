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
      !> Number of the first place with this key, and of the next one with a key of the same hash.
      integer :: first = 0, next = 0
   end type place_t

contains

   !> Reads the files of `command` into `cases`; those with findings are reported and make `status`
   !> that of bad input, if the others are to run without them. Errors: else the findings of all
   !> files, results that cannot have their names, or a table that cannot take their rows
   !> (input_error); standard output is lost.
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
   !> say), a line each. Of two outputs in one place the later one is objected to, and only a result
   !> can be in the way of another one's files. A run that goes on with a checkpoint looks at it
   !> itself, and at NAME.part.
   function output_findings(cases, output_dir, is_resume) result(problems)
      type(case_t), intent(in) :: cases(:)
      character(*), intent(in) :: output_dir
      character(:), allocatable :: problems
      logical, intent(in) :: is_resume
      type(place_t), allocatable :: places(:)
      character(:), allocatable :: found
      integer :: i, inputs

      call list_places(cases, output_dir, places, inputs)
      call link_places(places)
      problems = ''
      do i = inputs + 1, size(places)
         associate (output => places(i), other => places(places(i)%first))
            if (output%first <= inputs) then
               found = 'found the '//trim(other%what)//' '//other%path//' as its ' &
                  //trim(output%what)//', expected another &case output'
            else if (other%owner /= output%owner .and. any([other%what, output%what] &
               == 'result')) then
               found = 'found the '//trim(output%what)//' '//output%path//', which is also '// &
                  'that of '//cases(other%owner)%file//', expected different names'
            else
               found = taken_finding(output, is_resume)
            end if
            if (found == '') cycle
            if (problems /= '') problems = problems//new_line('a')
            problems = problems//cases(output%owner)%file//': '//found
         end associate
      end do
   end function output_findings

   !> Namelists and height files (`inputs`), then results, each with what its run writes.
   subroutine list_places(cases, output_dir, places, inputs)
      type(case_t), intent(in) :: cases(:)
      character(*), intent(in) :: output_dir
      type(place_t), allocatable, intent(out) :: places(:)
      integer, intent(out) :: inputs
      character(:), allocatable :: path
      integer :: i, j, n

      n = size(cases)*(4 + size(working_endings))
      do i = 1, size(cases)
         n = n + count(cases(i)%effective%key == 'file')
      end do
      allocate (places(n))
      n = 0
      do i = 1, size(cases)
         call add(cases(i)%file, 'namelist')
         do j = 1, size(cases(i)%effective)
            associate (entry => cases(i)%effective(j))
               if (entry%key == 'file') call add(path_from_namelist(cases(i), trim(entry%text)), &
                  'height file')
            end associate
         end do
      end do
      inputs = n
      do i = 1, size(cases)
         path = result_path(cases(i), output_dir)
         call add(path, 'result')
         if (cases(i)%has_xdmf) then
            call add(xdmf_path(path), 'XDMF file')
            call add(xdmf_path(path)//'.part', 'temporary file')
         end if
         do j = 1, size(working_endings)
            call add(path//trim(working_endings(j)), 'temporary file')
         end do
      end do
      places = places(:n)

   contains

      !> One more, of case `i`.
      subroutine add(path, what)
         character(*), intent(in) :: path, what

         n = n + 1
         places(n)%path = path
         places(n)%what = what
         places(n)%owner = i
         places(n)%key = key_of(path)
      end subroutine add

   end subroutine list_places

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

   !> Finds the first of the places with the same key, by a hash of it.
   pure subroutine link_places(places)
      type(place_t), intent(inout) :: places(:)
      integer :: bucket, i, k, last(0:size(places))

      last = 0
      do i = 1, size(places)
         associate (place => places(i))
            bucket = 0
            do k = 1, len(place%key)
               bucket = modulo(31*bucket + iachar(place%key(k:k)), size(last))
            end do
            place%next = last(bucket)
            place%first = place%next
            search: do while (place%first > 0)
               if (places(place%first)%key == place%key) exit search
               place%first = places(place%first)%next
            end do search
            if (place%first > 0) cycle
            place%first = i
            last(bucket) = i
         end associate
      end do
   end subroutine link_places

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

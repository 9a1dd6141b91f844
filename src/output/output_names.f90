!> Whether the results of a call can have their names: no result may take the place of an input, of
!> another result, or of a file that this program has not written. What is compared are files, not
!> paths: device and inode behind all links, or folder and name of what is not there yet.
module output_names
   use build_info, only: program_name
   use case_record, only: path_from_namelist, case_t, result_path
   use disk_file, only: any_mark, file_at, file_identity_t, folder_of, hdf5_mark, kind_missing, &
      kind_other, kind_regular, place_fault, xdmf_mark
   use result_name, only: working_endings
   use xdmf_file, only: xdmf_path
   implicit none (type, external)
   private

   public :: output_findings

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

   !> All objections to the results of `cases` in the folder `output_dir` (empty: where the cases
   !> say), a line each. A run that goes on with a checkpoint looks at it, and at NAME.part, itself.
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
         found = first_finding(places, i, inputs, cases)
         if (found == '') found = taken_finding(places(i), is_resume)
         if (found == '') cycle
         if (problems /= '') problems = problems//new_line('a')
         problems = problems//cases(places(i)%owner)%file//': '//found
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

   !> The first objection to output `number` because of other places, of which this many are
   !> `inputs`; empty: none. Of two outputs in one place the later one is objected to, and only a
   !> result can be in the way of another one's files.
   function first_finding(places, number, inputs, cases) result(found)
      type(place_t), intent(in) :: places(:)
      integer, intent(in) :: number, inputs
      type(case_t), intent(in) :: cases(:)
      character(:), allocatable :: found

      found = ''
      associate (output => places(number), other => places(places(number)%first))
         if (output%first <= inputs) then
            found = 'found the '//trim(other%what)//' '//other%path//' as its ' &
               //trim(output%what)//', expected another &case output'
         else if (other%owner /= output%owner .and. any([other%what, output%what] == 'result')) then
            found = 'found the '//trim(output%what)//' '//output%path//', which is also that of ' &
               //cases(other%owner)%file//', expected different names'
         end if
      end associate
   end function first_finding

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

end module output_names

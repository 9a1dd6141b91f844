!> Whether the results of a call can have their names: no result may take the place of an input, of
!> another result, or of a file that is no result. What is compared are files, not paths: device and
!> inode behind all links, or folder and name of what is not there yet.
module output_names
   use build_info, only: program_name
   use case_record, only: beside_namelist, case_t, effective_t, result_path
   use errors, only: error_t
   use file_identity, only: file_identity_t, is_same_file, kind_folder, kind_missing, &
      kind_regular, look_at_file
   use file_seal, only: has_seal
   use hdf5_input, only: hdf5_input_t, open_hdf5_input
   use operating_system, only: folder_of
   use result_name, only: working_endings
   use xdmf_file, only: has_xdmf_mark, xdmf_path
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
      type(file_identity_t) :: file, folder
      !> Name in its folder.
      character(:), allocatable :: name
   end type place_t

contains

   !> All objections to the results of `cases` in the folder `output_dir` (empty: where the
   !> cases say), a line each.
   function output_findings(cases, output_dir) result(problems)
      type(case_t), intent(in) :: cases(:)
      character(*), intent(in) :: output_dir
      character(:), allocatable :: problems
      type(place_t), allocatable :: inputs(:), outputs(:)
      character(:), allocatable :: found
      integer :: i

      allocate (inputs, source=inputs_of(cases))
      allocate (outputs, source=outputs_of(cases, output_dir))
      problems = ''
      do i = 1, size(outputs)
         found = first_finding(outputs, i, inputs, cases)
         if (found == '') cycle
         if (problems /= '') problems = problems//new_line('a')
         problems = problems//cases(outputs(i)%owner)%file//': '//found
      end do
   end function output_findings

   !> Namelists and height files.
   function inputs_of(cases) result(places)
      type(case_t), intent(in) :: cases(:)
      type(place_t), allocatable :: places(:)
      integer :: i, j

      allocate (places(0))
      do i = 1, size(cases)
         places = [places, new_place(cases(i)%file, 'namelist', i)]
         do j = 1, size(cases(i)%effective)
            associate (entry => cases(i)%effective(j))
               if (entry%key == 'file') places = [places, &
                  new_place(beside_namelist(cases(i), trim(entry%text)), 'height file', i)]
            end associate
         end do
      end do
   end function inputs_of

   !> Results, each followed by what is written beside it.
   function outputs_of(cases, output_dir) result(places)
      type(case_t), intent(in) :: cases(:)
      character(*), intent(in) :: output_dir
      type(place_t), allocatable :: places(:)
      character(:), allocatable :: path
      integer :: i, j

      allocate (places(0))
      do i = 1, size(cases)
         path = result_path(cases(i), output_dir)
         places = [places, new_place(path, 'result', i)]
         if (cases(i)%has_xdmf) places = [places, new_place(xdmf_path(path), 'XDMF file', i)]
         do j = 1, size(working_endings)
            places = [places, new_place(path//trim(working_endings(j)), 'temporary file', i)]
         end do
      end do
   end function outputs_of

   !> Where `path` leads to.
   function new_place(path, what, owner) result(place)
      character(*), intent(in) :: path, what
      integer, intent(in) :: owner
      type(place_t) :: place

      place%path = path
      place%what = what
      place%owner = owner
      place%file = look_at_file(path, follows=.true.)
      place%folder = look_at_file(folder_of(path), follows=.true.)
      place%name = path(index(path, '/', back=.true.) + 1:)
   end function new_place

   !> Whether two places are one file, there or not yet.
   elemental function is_same_place(one, other) result(is_same)
      type(place_t), intent(in) :: one, other
      logical :: is_same

      is_same = is_same_file(one%file, other%file) .or. one%path == other%path
      if (.not. is_same .and. one%name == other%name) is_same = is_same_file(one%folder, &
         other%folder)
   end function is_same_place

   !> The first objection to output `number`; empty: none. Of two outputs in one place the later one
   !> is objected to, and only a result can be in the way of another one's files.
   function first_finding(outputs, number, inputs, cases) result(found)
      type(place_t), intent(in) :: outputs(:), inputs(:)
      integer, intent(in) :: number
      type(case_t), intent(in) :: cases(:)
      character(:), allocatable :: found
      integer :: i

      found = ''
      associate (output => outputs(number))
         do i = 1, size(inputs)
            if (.not. is_same_place(output, inputs(i))) cycle
            found = 'found the '//trim(inputs(i)%what)//' '//inputs(i)%path//' as its ' &
               //trim(output%what)// &
               ', expected another &case output'
            return
         end do
         do i = 1, number - 1
            if (outputs(i)%owner == output%owner) cycle
            if (output%what /= 'result' .and. outputs(i)%what /= 'result') cycle
            if (.not. is_same_place(output, outputs(i))) cycle
            found = 'found the '//trim(output%what)//' '//output%path &
               //', which is also that of '// &
               cases(outputs(i)%owner)%file//', expected different names'
            return
         end do
         if (output%what /= 'temporary file' .and. .not. is_replaceable(output)) found = 'found ' &
            //output%path//' as its '//trim(output%what)//', which is there and no ' &
            //trim(output%what)//' of '//program_name &
            //', expected another &case output (or remove it)'
      end associate
   end function first_finding

   !> Whether a result or XDMF file may take this place: nothing is there, or an older one. (A
   !> folder stops its own case only, later.)
   function is_replaceable(place) result(answer)
      type(place_t), intent(in) :: place
      logical :: answer

      answer = place%file%kind == kind_missing .or. place%file%kind == kind_folder
      if (place%file%kind /= kind_regular) return
      if (place%what == 'result') then
         answer = is_result(place%path)
      else
         answer = has_xdmf_mark(place%path)
      end if
   end function is_replaceable

   !> Whether a file is a result of this program, of whatever version.
   function is_result(path) result(answer)
      character(*), intent(in) :: path
      logical :: answer
      type(hdf5_input_t) :: reader
      type(error_t), allocatable :: error

      answer = has_seal(path)   ! then what is between need not be looked at, damaged or not
      if (answer) return
      call open_hdf5_input(reader, path, error)   ! error: it stays in the reader
      answer = reader%text('/', 'program') == program_name
      call reader%close(error)
      if (allocated(error)) answer = .false.
   end function is_result

end module output_names

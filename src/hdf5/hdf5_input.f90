!> An HDF5 file being read: numbers, texts and attributes by their paths; parts of datasets, with
!> scale_factor and add_offset applied and missing numbers refused.
!>
!> Every return code is checked. The first failure stays in `reader%failure` (kind input_error);
!> what follows it reads nothing, so a caller checks once, at the end.
module hdf5_input
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use disk_file, only: file_fault
   use errors, only: error_t, fail, input_error
   use hdf5, only: h5_real_kind, h5aexists_by_name_f, h5aopen_by_name_f, &
      h5dget_space_f, h5dopen_f, h5dread_f, h5f_acc_rdonly_f, h5fclose_f, h5fis_hdf5_f, h5fopen_f, &
      h5kind_to_type, h5lexists_f, h5s_select_set_f, h5sclose_f, h5screate_simple_f, &
      h5sselect_hyperslab_f, h5t_native_double, hid_t, hsize_t
   use hdf5_library, only: hdf5_handle_t, start_hdf5
   use hdf5_source, only: hdf5_source_t, look_at, number_class, text_class
   use kinds, only: exceeds, wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: hdf5_input_t, is_hdf5, open_hdf5_input, place_words, read_part

   !> Most numbers that are read at once.
   integer, parameter :: max_values = 268435456

   !> An open file for reading.
   type, extends(hdf5_handle_t) :: hdf5_input_t
   contains
      procedure :: has, has_attribute, reals, real_value, number_of, read_numbers, text, &
         text_of, scale_of, refuse
      procedure :: open => open_source
      procedure :: close => close_reader
   end type hdf5_input_t

   !> Relative difference of a mark of missing numbers that was rounded to single precision.
   real(wp), parameter :: same_mark = 1.0e-7_wp

contains

   !> Opens `path`. Error: there is no such file, it is a pipe or a device, or it is not HDF5.
   subroutine open_hdf5_input(reader, path, error)
      type(hdf5_input_t), intent(out) :: reader
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      reader%path = path
      reader%kind = input_error
      if (file_fault(path) /= '') then
         call fail(reader%failure, input_error, 'cannot read '//path//': '//file_fault(path))
      else
         call start_hdf5(status)
         call reader%check(status, 'starting the HDF5 library')
         call h5fopen_f(path, h5f_acc_rdonly_f, reader%id, status)
         call reader%check(status, 'opening the file')
         reader%is_open = .not. allocated(reader%failure)
      end if
      if (allocated(reader%failure)) error = reader%failure
   end subroutine open_hdf5_input

   !> Whether there is a file at `path` that is HDF5 by its content.
   logical function is_hdf5(path)
      character(*), intent(in) :: path
      integer :: status

      is_hdf5 = .false.
      if (file_fault(path) /= '') return
      call start_hdf5(status)
      if (status >= 0) call h5fis_hdf5_f(path, is_hdf5, status)
      is_hdf5 = is_hdf5 .and. status >= 0   ! a file that cannot be read is none
   end function is_hdf5

   !> Keeps "found ..., expected ..." about `name`, unless empty, as the first failure.
   subroutine refuse(self, name, fault)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: name, fault

      if (fault == '' .or. allocated(self%failure)) return
      call fail(self%failure, input_error, 'cannot read '//self%path//' ('//name//'): '//fault)
   end subroutine refuse

   !> Whether the whole path exists.
   logical function has(self, path)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer :: last, slash, status

      has = .not. allocated(self%failure)
      last = 1
      do while (has .and. last <= len_trim(path))
         slash = index(path(last + 1:), '/')
         last = merge(last + slash - 1, len_trim(path), slash > 0)
         call h5lexists_f(self%id, path(:last), has, status)
         has = has .and. status >= 0
         last = last + 1
      end do
   end function has

   !> Whether the object at `path` has this `attribute`.
   logical function has_attribute(self, path, attribute) result(has)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, attribute
      integer :: status

      has = .false.
      if (allocated(self%failure)) return
      call h5aexists_by_name_f(self%id, path, attribute, has, status)
      call self%check(status, attribute)
      has = has .and. status >= 0
   end function has_attribute

   !> Opens the dataset `path`, or the `attribute` of the object there, to be closed unless it
   !> fails. A failure: there is none, the values of a dataset lie elsewhere than in the file, or it
   !> has not `count` values of the `class`, where that is asked for.
   subroutine open_source(self, source, path, attribute, class, count)
      class(hdf5_input_t), intent(inout) :: self
      type(hdf5_source_t), intent(out) :: source
      character(*), intent(in) :: path
      character(*), intent(in), optional :: attribute
      integer, intent(in), optional :: class
      integer(int64), intent(in), optional :: count
      integer(hid_t) :: id
      integer :: status

      if (allocated(self%failure)) return
      source%name = path
      if (present(attribute)) then
         source%name = attribute
         call h5aopen_by_name_f(self%id, path, attribute, id, status)
      else
         call h5dopen_f(self%id, path, id, status)
      end if
      call self%check(status, source%name)
      if (allocated(self%failure)) return
      call look_at(source, id, present(attribute))
      if (.not. present(attribute)) call self%refuse(path, source%fault_of_storage())
      if (present(count)) call self%refuse(source%name, source%fault(class, count))
      if (allocated(self%failure)) call source%close()
   end subroutine open_source

   !> All numbers of a dataset, converted to reals.
   function reals(self, path) result(values)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), allocatable, target :: values(:)
      type(hdf5_source_t) :: source
      integer :: status

      allocate (values(0))
      call self%open(source, path, class=number_class, count=-1_int64)
      if (allocated(self%failure)) return
      if (source%values > max_values) then
         call self%refuse(path, 'found more than '//to_text(max_values)//' values')
      else
         deallocate (values)
         allocate (values(max(source%values, 0_int64)), source=0.0_wp, stat=status)
         if (status /= 0) then
            call self%refuse(path, 'found '//to_text(source%values)//' values, for which there '// &
               'is no memory')
            allocate (values(0))
         end if
      end if
      if (size(values) > 0) then
         call source%read_into(h5kind_to_type(wp, h5_real_kind), c_loc(values), status)
         call self%check(status, path)
      end if
      call source%close()
   end function reals

   !> The number of a dataset or attribute that holds one.
   function real_value(self, path, attribute) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(*), intent(in), optional :: attribute
      real(wp), target :: value

      value = 0.0_wp
      call self%read_numbers(path, 1_int64, h5kind_to_type(wp, h5_real_kind), c_loc(value), &
         attribute)
   end function real_value

   !> The number of the `attribute` of the object at `path`; `default` if there is none.
   real(wp) function number_of(self, path, attribute, default) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, attribute
      real(wp), intent(in) :: default

      value = default
      if (self%has_attribute(path, attribute)) value = self%real_value(path, attribute)
   end function number_of

   !> The one place where numbers are read: the `count` numbers of a dataset or attribute, which
   !> must have just these, converted to `type_id`, to `place`, which has room for them.
   subroutine read_numbers(self, path, count, type_id, place, attribute)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(int64), intent(in) :: count
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: place
      character(*), intent(in), optional :: attribute
      type(hdf5_source_t) :: source
      integer :: status

      call self%open(source, path, attribute, number_class, count)
      if (allocated(self%failure)) return
      call source%read_into(type_id, place, status)
      call self%check(status, source%name)
      call source%close()
   end subroutine read_numbers

   !> The one place where texts are read (dataset or attribute), without null characters behind.
   function text(self, path, attribute)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(*), intent(in), optional :: attribute
      character(:), allocatable :: text
      type(hdf5_source_t) :: source
      character(kind=c_char, len=:), allocatable, target :: buffer
      integer :: status

      text = ''
      call self%open(source, path, attribute, text_class, 1_int64)
      if (allocated(self%failure)) return
      allocate (character(len=source%bytes) :: buffer)
      call source%read_into(source%type_id, c_loc(buffer), status)
      call self%check(status, source%name)
      if (status >= 0) text = buffer(:verify(buffer, c_null_char, back=.true.))
      call source%close()
   end function text

   !> The text of the `attribute` of the object at `path`, of any length; empty if it is not one.
   function text_of(self, path, attribute) result(text)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, attribute
      character(:), allocatable :: text
      type(hdf5_source_t) :: source
      integer :: status

      text = ''
      if (.not. self%has_attribute(path, attribute)) return
      call self%open(source, path, attribute)
      if (allocated(self%failure)) return
      if (source%values == 1_int64 .and. source%is_variable) then
         call source%read_variable(text, status)
         call self%check(status, attribute)
      else if (source%fault(text_class, 1_int64) == '') then
         text = trim(self%text(path, attribute))
      end if
      call source%close()
   end function text_of

   !> Path of the first scale of the `dimension` of a dataset (1: the fastest); empty if none.
   function scale_of(self, path, dimension) result(scale)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer, intent(in) :: dimension
      character(:), allocatable :: scale
      type(hdf5_source_t) :: source

      scale = ''
      if (.not. self%has_attribute(path, 'DIMENSION_LIST')) return
      call self%open(source, path, 'DIMENSION_LIST')
      if (allocated(self%failure)) return
      call source%read_reference(dimension, scale)
      call source%close()
   end function scale_of

   !> Closes the file; twice does nothing.
   subroutine close_reader(self, error)
      class(hdf5_input_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      if (self%is_open) call h5fclose_f(self%id, status)
      self%is_open = .false.
      if (allocated(self%failure)) error = self%failure
   end subroutine close_reader

   !> Numbers of `dataset` from `offset` on, `extents` of them along each of its dimensions. What
   !> cannot be read stays in the reader.
   subroutine read_part(reader, dataset, offset, extents, z)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset
      integer(int64), intent(in) :: offset(2)
      integer(hsize_t), intent(in) :: extents(2)
      real(wp), contiguous, target, intent(out) :: z(:)
      type(hdf5_source_t) :: source
      integer(hid_t) :: file_space, memory_space
      integer(hsize_t) :: start(2)
      type(c_ptr) :: place
      integer :: status

      start = offset
      place = c_loc(z)
      call reader%open(source, dataset)
      if (allocated(reader%failure)) return
      call h5dget_space_f(source%id, file_space, status)
      call reader%check(status, dataset)
      call h5sselect_hyperslab_f(file_space, h5s_select_set_f, start, extents, status)
      call reader%check(status, dataset//': fewer nodes than before')
      call h5screate_simple_f(1, [size(z, kind=hsize_t)], memory_space, status)
      call reader%check(status, dataset)
      if (.not. allocated(reader%failure)) then
         call h5dread_f(source%id, h5t_native_double, place, status, memory_space, file_space)
         call reader%check(status, dataset//' as real numbers')
      end if
      call h5sclose_f(memory_space, status)
      call h5sclose_f(file_space, status)
      call source%close()
      if (.not. allocated(reader%failure)) call unpack(reader, dataset, offset, extents, z)
   end subroutine read_part

   !> Applies the attributes of packing. Failures: a number is missing or not valid; bad attributes.
   subroutine unpack(reader, dataset, offset, extents, z)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset
      integer(int64), intent(in) :: offset(2)
      integer(hsize_t), intent(in) :: extents(2)
      real(wp), intent(inout) :: z(:)
      real(wp) :: factor, marks(2), shift, valid(2)
      integer :: i
      logical :: has_marks

      if (reader%text_of(dataset, '_Unsigned') == 'true') call reader%refuse(dataset, &
         'found _Unsigned = true, expected an unsigned type of HDF5')
      marks = [reader%number_of(dataset, '_FillValue', huge(1.0_wp)), &
         reader%number_of(dataset, 'missing_value', huge(1.0_wp))]
      valid = [reader%number_of(dataset, 'valid_min', -huge(1.0_wp)), &
         reader%number_of(dataset, 'valid_max', huge(1.0_wp))]
      factor = reader%number_of(dataset, 'scale_factor', 1.0_wp)
      shift = reader%number_of(dataset, 'add_offset', 0.0_wp)
      if (.not. all(ieee_is_finite([factor, shift]))) then
         call reader%refuse(dataset, 'found '//to_text(factor, 4)//' and '//to_text(shift, 4)// &
            ' in scale_factor and add_offset, expected numbers')
      else if (abs(factor) <= 0.0_wp) then
         call reader%refuse('scale_factor', 'found 0, expected a number other than 0')
      end if
      if (allocated(reader%failure)) return
      has_marks = any(exceeds(huge(1.0_wp), abs([marks, valid])))
      do i = 1, merge(size(z), 0, has_marks)
         if (.not. is_missing(z(i), marks, valid)) cycle
         call reader%refuse(dataset, 'node '//to_text(offset(1) + i)//': found '// &
            to_text(z(i), 4)//', the mark of a missing point (_FillValue, missing_value, '// &
            'valid_min, valid_max), expected numbers without gaps'// &
            place_words(offset(1) + i, int(extents, int64)))
         return
      end do
      if (abs(factor - 1.0_wp) > 0.0_wp .or. abs(shift) > 0.0_wp) z = z*factor + shift
   end subroutine unpack

   !> Whether a number is one of the marks or not valid; comparing what is not finite would trap.
   pure logical function is_missing(z, marks, valid)
      real(wp), intent(in) :: z, marks(2), valid(2)
      integer :: i

      is_missing = .false.
      if (.not. ieee_is_finite(z)) return
      do i = 1, 2
         if (ieee_is_finite(marks(i))) is_missing = is_missing .or. abs(z - marks(i)) &
            <= same_mark*abs(marks(i))
         if (ieee_is_finite(valid(i))) is_missing = is_missing .or. merge(z < valid(i), &
            z > valid(i), i == 1)
      end do
   end function is_missing

   !> Where node `number` of an area lies, in brackets; empty for a profile.
   pure function place_words(number, grid) result(words)
      integer(int64), intent(in) :: number, grid(2)
      character(:), allocatable :: words

      words = ''
      if (grid(2) > 1) words = ' (node '//to_text(modulo(number - 1, grid(1)) + 1)//' in x, '// &
         to_text((number - 1)/grid(1) + 1)//' in y)'
   end function place_words

end module hdf5_input

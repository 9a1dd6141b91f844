!> An HDF5 file being read: numbers, texts and attributes by their paths.
!>
!> Every return code is checked. The first failure stays in `reader%failure` (kind input_error); what follows it reads
!> nothing, so a caller checks once, at the end.
module hdf5_input
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use hdf5, only: h5aclose_f, h5aget_space_f, h5aget_type_f, h5aopen_by_name_f, h5aread_f, h5dclose_f, h5dget_space_f, &
      h5dget_type_f, h5dopen_f, h5dread_f, h5f_acc_rdonly_f, h5fclose_f, h5fopen_f, &
      h5kind_to_type, h5_integer_kind, h5_real_kind, h5lexists_f, h5sclose_f, h5sget_simple_extent_dims_f, &
      h5sget_simple_extent_ndims_f, h5sget_simple_extent_npoints_f, h5t_string_f, h5tclose_f, h5tget_class_f, h5tget_size_f, &
      h5tis_variable_str_f, hid_t, hsize_t, size_t
   use hdf5_library, only: start_hdf5
   use hdf5_reason, only: keep_hdf5_failure
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: hdf5_input_t, open_hdf5_input

   !> An open file for reading.
   type :: hdf5_input_t
      character(:), allocatable :: path
      !> The first thing that went wrong.
      type(error_t), allocatable :: failure
      !> HDF5 identifier of the file, for the hdf5_* modules only.
      integer(hid_t) :: id = -1_hid_t
      logical, private :: is_open = .false.
   contains
      !> Whether there is a dataset or group of this path.
      procedure :: has
      !> Extents of a dataset as Fortran sees them, the fastest first; none for a single value.
      procedure :: extents
      !> All numbers of a dataset, one after another.
      procedure :: reals
      !> The number of a dataset.
      procedure :: real_value
      procedure :: integer_value
      !> The text of a dataset, of a fixed length.
      procedure :: text
      !> The text of an attribute, of a fixed length.
      procedure :: text_attribute
      procedure :: integer_attribute
      !> An open dataset, to be closed with `close_dataset`.
      procedure :: open_dataset, close_dataset
      procedure :: check
      !> Closes the file; `error` is the first failure.
      procedure :: close => close_reader
   end type hdf5_input_t

contains

   !> Opens `path`. Error: there is no such file, or it is not HDF5.
   subroutine open_hdf5_input(reader, path, error)
      type(hdf5_input_t), intent(out) :: reader
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      logical :: exists
      integer :: status

      reader%path = path
      inquire (file=path, exist=exists)
      if (.not. exists) then
         call fail(reader%failure, input_error, 'cannot read '//path//': no such file')
      else
         call start_hdf5(status)
         call reader%check(status, 'starting the HDF5 library')
         call h5fopen_f(path, h5f_acc_rdonly_f, reader%id, status)
         call reader%check(status, 'opening the file')
         reader%is_open = .not. allocated(reader%failure)
      end if
      if (allocated(reader%failure)) error = reader%failure
   end subroutine open_hdf5_input

   !> Keeps the first failure: `status` < 0 while `doing`.
   subroutine check(self, status, doing)
      class(hdf5_input_t), intent(inout) :: self
      integer, intent(in) :: status
      character(*), intent(in) :: doing

      call keep_hdf5_failure(self%failure, input_error, 'cannot read ' // self%path, status, doing)
   end subroutine check

   !> Whether the whole path exists.
   function has(self, path)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      logical :: has
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

   !> Opens a dataset.
   subroutine open_dataset(self, path, dataset)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t), intent(out) :: dataset
      integer :: status

      dataset = -1_hid_t
      if (allocated(self%failure)) return
      call h5dopen_f(self%id, path, dataset, status)
      call self%check(status, path)
   end subroutine open_dataset

   !> Closes a dataset; `path` is for messages.
   subroutine close_dataset(self, path, dataset)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: dataset
      integer :: status

      if (allocated(self%failure)) return
      call h5dclose_f(dataset, status)
      call self%check(status, path)
   end subroutine close_dataset

   !> Extents of a dataset.
   function extents(self, path)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(int64), allocatable :: extents(:)
      integer(hid_t) :: dataset, space
      integer(hsize_t), allocatable :: present_extents(:), limits(:)
      integer :: rank, status

      allocate (extents(0))
      call self%open_dataset(path, dataset)
      if (allocated(self%failure)) return
      call h5dget_space_f(dataset, space, status)
      call self%check(status, path)
      if (allocated(self%failure)) return
      call h5sget_simple_extent_ndims_f(space, rank, status)
      call self%check(status, path)
      if (rank > 0 .and. .not. allocated(self%failure)) then
         allocate (present_extents(rank), limits(rank), source=0_hsize_t)
         call h5sget_simple_extent_dims_f(space, present_extents, limits, status)
         call self%check(status, path)
         extents = int(present_extents, int64)
      end if
      call h5sclose_f(space, status)
      call self%close_dataset(path, dataset)
   end function extents

   !> All numbers of a dataset, converted to reals.
   function reals(self, path) result(values)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), allocatable, target :: values(:)
      integer(int64), allocatable :: counts(:)

      counts = self%extents(path)
      if (allocated(self%failure)) counts = [0_int64]
      allocate (values(product(counts)), source=0.0_wp)
      if (size(values) > 0) call read_numbers(self, path, h5kind_to_type(wp, h5_real_kind), c_loc(values))
   end function reals

   !> The first number of a dataset.
   function real_value(self, path) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp) :: value
      real(wp), allocatable :: values(:)

      value = 0.0_wp
      values = self%reals(path)
      if (size(values) > 0) value = values(1)
   end function real_value

   !> The number of a dataset that holds one.
   function integer_value(self, path) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(int64), target :: value

      value = 0_int64
      if (product(self%extents(path)) /= 1_int64) call self%check(-1, path//': one number expected')
      call read_numbers(self, path, h5kind_to_type(int64, h5_integer_kind), c_loc(value))
   end function integer_value

   !> All numbers of a dataset, converted to `type_id`, to `place`, which has room for them.
   subroutine read_numbers(reader, path, type_id, place)
      class(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: place
      type(c_ptr) :: address
      integer(hid_t) :: dataset
      integer :: status

      call reader%open_dataset(path, dataset)
      if (allocated(reader%failure)) return
      address = place   ! the argument of h5dread_f is intent(inout)
      call h5dread_f(dataset, type_id, address, status)
      call reader%check(status, path)
      call reader%close_dataset(path, dataset)
   end subroutine read_numbers

   !> The text of a dataset; null characters at its end are cut off.
   function text(self, path)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(:), allocatable :: text
      character(kind=c_char, len=:), allocatable, target :: buffer
      integer(hid_t) :: dataset, type_id
      type(c_ptr) :: place
      integer :: status

      text = ''
      call self%open_dataset(path, dataset)
      if (allocated(self%failure)) return
      call h5dget_type_f(dataset, type_id, status)
      call self%check(status, path)
      call make_buffer(self, path, type_id, buffer)
      if (.not. allocated(self%failure)) then
         place = c_loc(buffer)
         call h5dread_f(dataset, type_id, place, status)
         call self%check(status, path)
         text = without_nulls(buffer)
      end if
      call h5tclose_f(type_id, status)
      call self%close_dataset(path, dataset)
   end function text

   !> The text of the attribute `name` of the object at `path`.
   function text_attribute(self, path, name) result(text)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, name
      character(:), allocatable :: text
      character(kind=c_char, len=:), allocatable, target :: buffer
      integer(hid_t) :: attribute, type_id
      type(c_ptr) :: place
      integer :: status

      text = ''
      if (allocated(self%failure)) return
      call h5aopen_by_name_f(self%id, path, name, attribute, status)
      call self%check(status, name)
      if (allocated(self%failure)) return
      call h5aget_type_f(attribute, type_id, status)
      call self%check(status, name)
      call make_buffer(self, name, type_id, buffer)
      if (.not. allocated(self%failure)) then
         place = c_loc(buffer)
         call h5aread_f(attribute, type_id, place, status)
         call self%check(status, name)
         text = without_nulls(buffer)
      end if
      call h5tclose_f(type_id, status)
      call h5aclose_f(attribute, status)
   end function text_attribute

   !> The number of the attribute `name` of the object at `path`.
   function integer_attribute(self, path, name) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, name
      integer(int64), target :: value
      integer(hid_t) :: attribute, space
      integer(hsize_t) :: points
      type(c_ptr) :: place
      integer :: status

      value = 0_int64
      if (allocated(self%failure)) return
      call h5aopen_by_name_f(self%id, path, name, attribute, status)
      call self%check(status, name)
      if (allocated(self%failure)) return
      call h5aget_space_f(attribute, space, status)
      call self%check(status, name)
      call h5sget_simple_extent_npoints_f(space, points, status)
      call h5sclose_f(space, status)
      if (points /= 1_hsize_t) call self%check(-1, name//': one number expected')
      if (.not. allocated(self%failure)) then
         place = c_loc(value)
         call h5aread_f(attribute, h5kind_to_type(int64, h5_integer_kind), place, status)
         call self%check(status, name)
      end if
      call h5aclose_f(attribute, status)
   end function integer_attribute

   !> Room for a text of the type; a failure if it is not a text of fixed length.
   subroutine make_buffer(reader, name, type_id, buffer)
      class(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: name
      integer(hid_t), intent(in) :: type_id
      character(kind=c_char, len=:), allocatable, target, intent(out) :: buffer
      logical :: is_variable
      integer(size_t) :: length
      integer :: class_id, status

      if (allocated(reader%failure)) return
      call h5tget_class_f(type_id, class_id, status)
      call reader%check(status, name)
      is_variable = .true.
      if (class_id == h5t_string_f) call h5tis_variable_str_f(type_id, is_variable, status)
      if (is_variable) call reader%check(-1, name//': a text of fixed length expected')
      call h5tget_size_f(type_id, length, status)
      call reader%check(status, name)
      if (.not. allocated(reader%failure)) allocate (character(len=length) :: buffer)
   end subroutine make_buffer

   !> A text without the null characters at its end.
   pure function without_nulls(buffer) result(text)
      character(*), intent(in) :: buffer
      character(:), allocatable :: text
      integer :: length

      length = verify(buffer, c_null_char, back=.true.)
      text = buffer(:length)
   end function without_nulls

   !> Closes the file; twice does nothing.
   subroutine close_reader(self, error)
      class(hdf5_input_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      if (self%is_open) call h5fclose_f(self%id, status)
      self%is_open = .false.
      if (allocated(self%failure)) error = self%failure
   end subroutine close_reader

end module hdf5_input

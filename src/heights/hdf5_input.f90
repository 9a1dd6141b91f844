!> An HDF5 file being read: numbers, texts and attributes by their paths.
!>
!> Every return code is checked. The first failure stays in `reader%failure` (kind input_error);
!> what follows it reads nothing, so a caller checks once, at the end.
module hdf5_input
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use file_identity, only: file_fault
   use hdf5, only: h5aclose_f, h5aexists_f, h5aopen_by_name_f, h5aopen_f, h5dclose_f, &
      h5dget_space_f, h5dopen_f, h5f_acc_rdonly_f, h5fclose_f, h5fopen_f, h5kind_to_type, &
      h5_integer_kind, h5_real_kind, h5lexists_f, h5sclose_f, h5sget_simple_extent_dims_f, &
      h5sget_simple_extent_ndims_f, h5tclose_f, hid_t, hsize_t
   use hdf5_library, only: start_hdf5
   use hdf5_reason, only: keep_hdf5_failure
   use hdf5_source, only: fault_of_storage, hdf5_source_t, number_class, text_class
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: hdf5_input_t, open_hdf5_input

   !> Most numbers that are read at once.
   integer, parameter :: most_values = 268435456

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
      !> All numbers of a dataset, of which there must be so many, to an address.
      procedure :: read_numbers
      !> The text of a dataset, of a fixed length.
      procedure :: text
      !> The text of an attribute, of a fixed length.
      procedure :: text_attribute
      procedure :: integer_attribute
      !> The number of an attribute of an open dataset.
      procedure :: number_of
      !> An open dataset, to be closed with `close_dataset`.
      procedure :: open_dataset, close_dataset
      procedure :: check
      procedure :: refuse
      !> Closes the file; `error` is the first failure.
      procedure :: close => close_reader
   end type hdf5_input_t

contains

   !> Opens `path`. Error: there is no such file, it is a pipe or a device, or it is not HDF5.
   subroutine open_hdf5_input(reader, path, error)
      type(hdf5_input_t), intent(out) :: reader
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      reader%path = path
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

   !> Opens a dataset. A failure: there is none, or its values lie elsewhere than in the file.
   subroutine open_dataset(self, path, dataset)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t), intent(out) :: dataset
      integer :: status

      dataset = -1_hid_t
      if (allocated(self%failure)) return
      call h5dopen_f(self%id, path, dataset, status)
      call self%check(status, path)
      if (allocated(self%failure)) return
      call self%refuse(path, fault_of_storage(dataset))
      if (allocated(self%failure)) call h5dclose_f(dataset, status)
   end subroutine open_dataset

   !> Keeps "found ..., expected ..." about the dataset or attribute `name` as the first failure,
   !> unless it is empty.
   subroutine refuse(self, name, fault)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: name, fault

      if (fault == '' .or. allocated(self%failure)) return
      call fail(self%failure, input_error, 'cannot read '//self%path//' ('//name//'): '//fault)
   end subroutine refuse

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
      integer :: status

      allocate (counts, source=self%extents(path))
      if (allocated(self%failure)) counts = [0_int64]
      if (product(real(counts, wp)) > real(most_values, wp)) then
         call self%refuse(path, 'found more than '//to_text(most_values)//' values')
         counts = [0_int64]
      end if
      allocate (values(product(counts)), source=0.0_wp, stat=status)
      if (status /= 0) then
         call self%refuse(path, 'found '//to_text(product(counts)) &
            //' values, for which there is no memory')
         allocate (values(0))
      end if
      if (size(values) > 0) call self%read_numbers(path, size(values, kind=int64), &
         h5kind_to_type(wp, h5_real_kind), c_loc(values))
   end function reals

   !> The number of a dataset that holds one.
   function real_value(self, path) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), target :: value

      value = 0.0_wp
      call self%read_numbers(path, 1_int64, h5kind_to_type(wp, h5_real_kind), c_loc(value))
   end function real_value

   !> The number of a dataset that holds one.
   function integer_value(self, path) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(int64), target :: value

      value = 0_int64
      call self%read_numbers(path, 1_int64, h5kind_to_type(int64, h5_integer_kind), c_loc(value))
   end function integer_value

   !> The `count` numbers of a dataset, converted to `type_id`, to `place`, which has room for them.
   subroutine read_numbers(self, path, count, type_id, place)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(int64), intent(in) :: count
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: place
      integer(hid_t) :: dataset

      call self%open_dataset(path, dataset)
      if (allocated(self%failure)) return
      call read_checked(self, path, hdf5_source_t(dataset), count, type_id, place)
      call self%close_dataset(path, dataset)
   end subroutine read_numbers

   !> The one place where numbers are read: `count` of them from an open dataset or attribute, which
   !> must have just these.
   subroutine read_checked(reader, name, source, count, type_id, place)
      class(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: name
      type(hdf5_source_t), intent(in) :: source
      integer(int64), intent(in) :: count
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: place
      integer :: status

      call reader%refuse(name, source%fault(number_class, count))
      if (allocated(reader%failure)) return
      call source%read_into(type_id, place, status)
      call reader%check(status, name)
   end subroutine read_checked

   !> The text of a dataset; null characters at its end are cut off.
   function text(self, path)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(:), allocatable :: text
      integer(hid_t) :: dataset

      text = ''
      call self%open_dataset(path, dataset)
      if (allocated(self%failure)) return
      call read_text(self, path, hdf5_source_t(dataset), text)
      call self%close_dataset(path, dataset)
   end function text

   !> The text of the attribute `name` of the object at `path`.
   function text_attribute(self, path, name) result(text)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, name
      character(:), allocatable :: text
      integer(hid_t) :: attribute
      integer :: status

      text = ''
      if (allocated(self%failure)) return
      call h5aopen_by_name_f(self%id, path, name, attribute, status)
      call self%check(status, name)
      if (allocated(self%failure)) return
      call read_text(self, name, hdf5_source_t(attribute, is_attribute=.true.), text)
      call h5aclose_f(attribute, status)
   end function text_attribute

   !> The number of the attribute `name` of the object at `path`.
   function integer_attribute(self, path, name) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, name
      integer(int64), target :: value
      integer(hid_t) :: attribute
      integer :: status

      value = 0_int64
      if (allocated(self%failure)) return
      call h5aopen_by_name_f(self%id, path, name, attribute, status)
      call self%check(status, name)
      if (allocated(self%failure)) return
      call read_checked(self, name, hdf5_source_t(attribute, is_attribute=.true.), 1_int64, &
         h5kind_to_type(int64, h5_integer_kind), c_loc(value))
      call h5aclose_f(attribute, status)
   end function integer_attribute

   !> The number of the attribute `name` of an open dataset; `default` if there is none.
   function number_of(self, dataset, name, default) result(value)
      class(hdf5_input_t), intent(inout) :: self
      integer(hid_t), intent(in) :: dataset
      character(*), intent(in) :: name
      real(wp), intent(in) :: default
      real(wp), target :: value
      integer(hid_t) :: attribute
      logical :: exists
      integer :: status

      value = default
      if (allocated(self%failure)) return
      call h5aexists_f(dataset, name, exists, status)
      call self%check(status, name)
      if (allocated(self%failure) .or. .not. exists) return
      call h5aopen_f(dataset, name, attribute, status)
      call self%check(status, name)
      if (allocated(self%failure)) return
      call read_checked(self, name, hdf5_source_t(attribute, is_attribute=.true.), 1_int64, &
         h5kind_to_type(wp, h5_real_kind), &
         c_loc(value))
      call h5aclose_f(attribute, status)
   end function number_of

   !> The one place where texts are read: one of fixed length, its null characters at the end cut
   !> off.
   subroutine read_text(reader, name, source, text)
      class(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: name
      type(hdf5_source_t), intent(in) :: source
      character(:), allocatable, intent(inout) :: text
      character(kind=c_char, len=:), allocatable, target :: buffer
      integer(hid_t) :: type_id
      integer :: status

      call reader%refuse(name, source%fault(text_class, 1_int64))
      if (allocated(reader%failure)) return
      call source%open_type(type_id, status)
      call reader%check(status, name)
      if (allocated(reader%failure)) return
      allocate (character(len=source%value_bytes()) :: buffer)
      call source%read_into(type_id, c_loc(buffer), status)
      call reader%check(status, name)
      if (.not. allocated(reader%failure)) text = without_nulls(buffer)
      call h5tclose_f(type_id, status)
   end subroutine read_text

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

!> Labelled datasets and attributes of an HDF5 file being written: reals, 64-bit integers, UTF-8
!> strings; records, written block by block. Shapes are those of Fortran; h5py shows them reversed.
module hdf5_dataset
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_loc, c_null_char, &
      c_null_ptr, c_ptr
   use hdf5, only: h5aclose_f, h5acreate_f, h5awrite_f, h5dclose_f, h5dcreate_f, h5dget_space_f, &
      h5dwrite_f, h5s_select_set_f, h5sclose_f, h5screate_simple_f, h5sselect_hyperslab_f, hid_t, &
      hsize_t
   use hdf5_file, only: hdf5_file_t
   use hdf5_library, only: creation, link_creation, scalar_space, small_creation
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: attach_values, label_t, new_label, write_attribute, write_dataset, write_records, &
      write_string, write_values

   !> Numbers at most that are stored in the header of their dataset, with no place of their own.
   integer, parameter :: few = 16
   !> Zeros that are written, at most.
   integer, parameter :: many = 4096

   !> What a stored value is. value * si_scale = value in si_units; attribute `units`: of the value.
   type :: label_t
      character(:), allocatable :: long_name
      !> Unit after multiplication by `si_scale`; '1' for a number without unit.
      character(:), allocatable :: si_units
      real(wp) :: si_scale = 1.0_wp
      !> Follows `long_name` where the stored number is another one than in SI.
      character(:), allocatable :: definition
   contains
      procedure :: has_scale
   end type label_t

   !> Stores a labelled dataset; groups above it are made as needed.
   interface write_dataset
      module procedure :: write_reals, write_integers, write_string
   end interface write_dataset

   !> Stores an attribute of an existing group or dataset, named by its path.
   interface write_attribute
      module procedure :: attach_reals, attach_integer, attach_string
   end interface write_attribute

contains

   !> A label; `si_scale` defaults to 1.
   pure function new_label(long_name, si_units, si_scale, definition) result(label)
      character(*), intent(in) :: long_name, si_units
      real(wp), intent(in), optional :: si_scale
      character(*), intent(in), optional :: definition
      type(label_t) :: label

      label%long_name = long_name
      label%si_units = si_units
      if (present(si_scale)) label%si_scale = si_scale
      label%definition = ''
      if (present(definition)) label%definition = definition
   end function new_label

   !> Whether the values are other numbers in SI.
   elemental logical function has_scale(self)
      class(label_t), intent(in) :: self

      has_scale = abs(self%si_scale - 1.0_wp) > 0.0_wp
   end function has_scale

   !> Reals of any rank; with `is_single` the file has them in single precision. Many zeros are not
   !> written: HDF5 gives zeros for what a file does not have.
   subroutine write_reals(file, path, value, label, is_single)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      real(wp), intent(in), contiguous, target :: value(..)
      type(label_t), intent(in) :: label
      logical, intent(in), optional :: is_single
      integer(int64), pointer :: bits(:)
      logical :: is_blank

      call file%check_values(path, value)
      if (allocated(file%row)) call file%row%put(path, '', label%si_units, numbers=value)
      is_blank = size(value) > many
      if (is_blank) then
         call c_f_pointer(c_loc(value), bits, [size(value)])
         is_blank = .not. any(shiftl(bits, 1) /= 0_int64)   ! without the sign
      end if
      call write_values(file, path, file%real_type, shape(value), merge(c_null_ptr, c_loc(value), &
         is_blank), label, is_single)
   end subroutine write_reals

   !> Integers of 64 bits, of any rank.
   subroutine write_integers(file, path, value, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer(int64), intent(in), contiguous, target :: value(..)
      type(label_t), intent(in) :: label
      integer(int64), pointer :: flat(:)

      call c_f_pointer(c_loc(value), flat, [size(value)])
      if (allocated(file%row)) call file%row%put(path, '', label%si_units, numbers=real(flat, wp))
      call write_values(file, path, file%integer_type, shape(value), c_loc(value), label)
   end subroutine write_integers

   !> A string of fixed length, UTF-8.
   subroutine write_string(file, path, value, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, value
      type(label_t), intent(in), optional :: label
      character(kind=c_char, len=:), allocatable, target :: copy

      if (allocated(file%row)) call file%row%put(path, '', '1', value)
      if (allocated(file%failure) .or. allocated(file%row)) return
      copy = stored_text(value)
      call write_values(file, path, file%string_type(len(copy)), [integer ::], c_loc(copy), label)
   end subroutine write_string

   !> Creates, writes and labels a dataset of the `extents` (none: one value), and the groups above
   !> it; `is_single`: in single precision. Null in place of `values`: zero until `write_records`
   !> brings others. (A single number without unit has no `units`: netCDF takes that for '1'.)
   subroutine write_values(file, path, type_id, extents, values, label, is_single)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: type_id
      integer, intent(in) :: extents(:)
      type(c_ptr), intent(in) :: values
      type(label_t), intent(in), optional :: label
      logical, intent(in), optional :: is_single
      integer(hid_t) :: space, dataset, file_type
      character(:), allocatable :: units
      integer :: status

      if (allocated(file%failure) .or. allocated(file%row)) return
      call new_space(extents, space, status)
      associate (is_small => product(int(extents, int64)) <= few .and. any(type_id == &
         [file%real_type, file%integer_type]))
         file_type = type_id
         if (present(is_single)) file_type = merge(file%single_type, type_id, is_single)
         if (status >= 0) call h5dcreate_f(file%id, path, file_type, space, dataset, status, &
            dcpl_id=merge(small_creation, creation, is_small), &
            lcpl_id=link_creation)
      end associate
      if (status >= 0 .and. size(extents) > 0) call h5sclose_f(space, status)
      call file%check(status, path)
      if (allocated(file%failure)) return
      if (present(label)) then
         call file%keep_object(path, dataset)
         call write_attribute(file, path, 'long_name', label%long_name//label%definition)
         call write_attribute(file, path, 'si_units', label%si_units)
         call write_attribute(file, path, 'si_scale', label%si_scale)
         units = '1'   ! what `si_scale` turns into SI
         if (.not. label%has_scale()) units = label%si_units
         if (units /= '1' .or. size(extents) > 0) call write_attribute(file, path, 'units', units)
         if (allocated(file%failure)) return
      end if
      if (all(extents > 0) .and. c_associated(values)) call h5dwrite_f(dataset, type_id, values, &
         status)
      if (status >= 0 .and. .not. present(label)) call h5dclose_f(dataset, status)
      call file%check(status, path)
   end subroutine write_values

   !> A real or several; with `units` they stand in `<name>_units`.
   subroutine attach_reals(file, path, name, value, units)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      real(wp), intent(in), contiguous, target :: value(..)
      character(*), intent(in), optional :: units
      character(:), allocatable :: unit

      unit = '='   ! that of its dataset
      if (present(units)) unit = units
      if (allocated(file%row)) call file%row%put(path, name, unit, numbers=value)
      call attach_values(file, path, name, file%real_type, shape(value), c_loc(value))
      if (present(units) .and. .not. allocated(file%row)) call attach_string(file, path, &
         name//'_units', units)
   end subroutine attach_reals

   !> An integer.
   subroutine attach_integer(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      integer, intent(in) :: value
      integer(int64), target :: copy

      if (allocated(file%row)) call file%row%put(path, name, '', numbers=real(value, wp))
      copy = int(value, int64)
      call attach_values(file, path, name, file%integer_type, [integer ::], c_loc(copy))
   end subroutine attach_integer

   !> A string.
   subroutine attach_string(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name, value
      character(kind=c_char, len=:), allocatable, target :: copy

      if (allocated(file%row)) call file%row%put(path, name, '', value)
      if (allocated(file%failure) .or. allocated(file%row)) return
      copy = stored_text(value)
      call attach_values(file, path, name, file%string_type(len(copy)), [integer ::], c_loc(copy))
   end subroutine attach_string

   !> Attaches values of any type and extents to the object at `path`.
   subroutine attach_values(file, path, name, type_id, extents, values)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      integer(hid_t), intent(in) :: type_id
      integer, intent(in) :: extents(:)
      type(c_ptr), intent(in) :: values
      integer(hid_t) :: object, space, attribute
      integer :: status

      if (allocated(file%failure) .or. allocated(file%row)) return
      object = file%object_at(path)
      if (allocated(file%failure)) return
      call new_space(extents, space, status)
      if (status >= 0) call h5acreate_f(object, name, type_id, space, attribute, status)
      if (status >= 0) call h5awrite_f(attribute, type_id, values, status)
      if (status >= 0) call h5aclose_f(attribute, status)
      if (status >= 0 .and. size(extents) > 0) call h5sclose_f(space, status)
      call file%check(status, name)
   end subroutine attach_values

   !> A dataspace of `extents`, to be closed (none: one value, shared); `status` < 0: failed.
   subroutine new_space(extents, space, status)
      integer, intent(in) :: extents(:)
      integer(hid_t), intent(out) :: space
      integer, intent(out) :: status

      space = scalar_space
      status = 0
      ! gfortran 12: where an expression like int(x, int64) is empty its `shape` here has a -1.
      if (size(extents) > 0) call h5screate_simple_f(size(extents), int(max(extents, 0), &
         hsize_t), space, status)
   end subroutine new_space

   !> A string as HDF5 stores it: an empty one as one null character.
   pure function stored_text(value) result(copy)
      character(*), intent(in) :: value
      character(kind=c_char, len=:), allocatable :: copy

      copy = value
      if (len(value) == 0) copy = c_null_char
   end function stored_text

   !> Writes `values` (n, records), records of the `extents`, behind the first `before` at `path`.
   subroutine write_records(file, path, extents, before, values)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer, intent(in) :: extents(:), before
      real(wp), intent(in), contiguous, target :: values(:, :)
      integer(hid_t) :: dataset, file_space, memory_space
      integer :: status

      if (allocated(file%failure) .or. size(values, 2) == 0) return
      call file%check_values(path, values)
      dataset = file%object_at(path)
      if (allocated(file%failure)) return
      associate (start => int([0*extents, before], hsize_t), &
         count => int([extents, size(values, 2)], hsize_t))
         call h5dget_space_f(dataset, file_space, status)
         if (status >= 0) call h5screate_simple_f(size(count), count, memory_space, status)
         if (status >= 0) call h5sselect_hyperslab_f(file_space, h5s_select_set_f, start, count, &
            status)
         if (status >= 0) call h5dwrite_f(dataset, file%real_type, c_loc(values), status, &
            memory_space, file_space)
         if (status >= 0) call h5sclose_f(memory_space, status)
         if (status >= 0) call h5sclose_f(file_space, status)
      end associate
      call file%check(status, path)
   end subroutine write_records

end module hdf5_dataset

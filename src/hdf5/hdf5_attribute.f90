!> Attributes of HDF5 groups and datasets: reals, 64-bit integers and strings of fixed length in
!> UTF-8; and the HDF5 extents of values, which datasets have too.
module hdf5_attribute
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: h5aclose_f, h5acreate_f, h5awrite_f, h5sclose_f, h5screate_simple_f, hid_t, &
      hsize_t
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: attach_values, close_space, new_space, stored_text, write_attribute

   !> Stores an attribute of an existing group or dataset, named by its path.
   interface write_attribute
      module procedure :: write_reals, write_integer, write_string
   end interface write_attribute

contains

   !> A real or several.
   subroutine write_reals(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      real(wp), intent(in), contiguous, target :: value(..)

      call attach_values(file, path, name, file%real_type, shape(value), c_loc(value))
   end subroutine write_reals

   !> An integer.
   subroutine write_integer(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      integer, intent(in) :: value
      integer(int64), target :: copy

      copy = int(value, int64)
      call attach_values(file, path, name, file%integer_type, [integer ::], c_loc(copy))
   end subroutine write_integer

   !> A string.
   subroutine write_string(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name, value
      character(kind=c_char, len=:), allocatable, target :: copy

      if (allocated(file%failure)) return
      copy = stored_text(value)
      call attach_values(file, path, name, file%string_type(len(copy)), [integer ::], c_loc(copy))
   end subroutine write_string

   !> Attaches values of any type and extents to the object at `path`.
   subroutine attach_values(file, path, name, type_id, extents, values)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      integer(hid_t), intent(in) :: type_id
      integer, intent(in) :: extents(:)
      type(c_ptr), intent(in) :: values
      integer(hid_t) :: object, space, attribute
      integer :: status

      if (allocated(file%failure)) return
      object = file%object_at(path)
      if (allocated(file%failure)) return
      call new_space(file, extents, space, status)
      if (status >= 0) call h5acreate_f(object, name, type_id, space, attribute, status)
      if (status >= 0) call h5awrite_f(attribute, type_id, values, status)
      if (status >= 0) call h5aclose_f(attribute, status)
      if (status >= 0) call close_space(extents, space, status)
      call file%check(status, name)
   end subroutine attach_values

   !> The HDF5 dataspace of values with these `extents` (none: one value), for `close_space`;
   !> `status` < 0: failed.
   subroutine new_space(file, extents, space, status)
      class(hdf5_file_t), intent(in) :: file
      integer, intent(in) :: extents(:)
      integer(hid_t), intent(out) :: space
      integer, intent(out) :: status

      space = file%shared%scalar_space
      status = 0
      ! gfortran 12: where an expression like int(x, int64) is empty its `shape` here has a -1.
      if (size(extents) > 0) call h5screate_simple_f(size(extents), int(max(extents, 0), &
         hsize_t), space, status)
   end subroutine new_space

   !> Gives back a dataspace of `new_space`; `status` < 0: failed.
   subroutine close_space(extents, space, status)
      integer, intent(in) :: extents(:)
      integer(hid_t), intent(in) :: space
      integer, intent(out) :: status

      status = 0
      if (size(extents) > 0) call h5sclose_f(space, status)
   end subroutine close_space

   !> A string as HDF5 stores it: an empty one as one null character.
   pure function stored_text(value) result(copy)
      character(*), intent(in) :: value
      character(kind=c_char, len=:), allocatable :: copy

      copy = value
      if (len(value) == 0) copy = c_null_char
   end function stored_text

end module hdf5_attribute

!> Attributes of HDF5 groups and datasets: reals, 64-bit integers and strings of fixed length in
!> UTF-8; and the HDF5 types and extents of values, which datasets have too.
module hdf5_attribute
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: h5aclose_f, h5acreate_by_name_f, h5awrite_f, h5s_scalar_f, h5sclose_f, &
      h5screate_f, h5screate_simple_f, h5t_c_s1, h5t_cset_utf8_f, h5t_str_nullpad_f, h5tclose_f, &
      h5tcopy_f, h5tset_cset_f, h5tset_size_f, h5tset_strpad_f, hid_t, hsize_t, size_t
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: new_space, new_string, write_attribute

   !> Stores an attribute of an existing group or dataset, named by its path.
   interface write_attribute
      module procedure :: write_reals
      module procedure :: write_integer
      module procedure :: write_string
   end interface write_attribute

contains

   !> A real or several.
   subroutine write_reals(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      real(wp), intent(in), contiguous, target :: value(..)

      call attach(file, path, name, file%real_type, shape(value), c_loc(value))
   end subroutine write_reals

   !> An integer.
   subroutine write_integer(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      integer, intent(in) :: value
      integer(int64), target :: copy

      copy = int(value, int64)
      call attach(file, path, name, file%integer_type, [integer ::], c_loc(copy))
   end subroutine write_integer

   !> A string.
   subroutine write_string(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name, value
      character(kind=c_char, len=:), allocatable, target :: copy
      integer(hid_t) :: string_type
      integer :: status

      if (allocated(file%failure)) return
      call new_string(value, copy, string_type, status)
      call file%check(status, 'string type')
      call attach(file, path, name, string_type, [integer ::], c_loc(copy))
      call h5tclose_f(string_type, status)
   end subroutine write_string

   !> Attaches values of any type and extents to the object at `path`.
   subroutine attach(file, path, name, type_id, extents, values)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, name
      integer(hid_t), intent(in) :: type_id
      integer, intent(in) :: extents(:)
      type(c_ptr), intent(in) :: values
      integer(hid_t) :: space, attribute
      integer :: status

      if (allocated(file%failure)) return
      call new_space(extents, space, status)
      if (status >= 0) call h5acreate_by_name_f(file%id, path, name, type_id, space, attribute, &
         status)
      if (status >= 0) call h5awrite_f(attribute, type_id, values, status)
      if (status >= 0) call h5aclose_f(attribute, status)
      if (status >= 0) call h5sclose_f(space, status)
      call file%check(status, name)
   end subroutine attach

   !> The HDF5 dataspace of values with these `extents` (none: one value); `status` < 0: failed.
   subroutine new_space(extents, space, status)
      integer, intent(in) :: extents(:)
      integer(hid_t), intent(out) :: space
      integer, intent(out) :: status

      if (size(extents) == 0) then
         call h5screate_f(h5s_scalar_f, space, status)
      else
         ! gfortran 12: where an expression like int(x, int64) is empty its `shape` here has a -1.
         call h5screate_simple_f(size(extents), int(max(extents, 0), hsize_t), space, status)
      end if
   end subroutine new_space

   !> A UTF-8 string as HDF5 stores it, an empty one as one null character, and its HDF5 type;
   !> `status` < 0: failed.
   subroutine new_string(value, copy, string_type, status)
      character(*), intent(in) :: value
      character(kind=c_char, len=:), allocatable, intent(out) :: copy
      integer(hid_t), intent(out) :: string_type
      integer, intent(out) :: status

      copy = value
      if (len(value) == 0) copy = c_null_char
      call h5tcopy_f(h5t_c_s1, string_type, status)
      if (status >= 0) call h5tset_size_f(string_type, len(copy, kind=size_t), status)
      if (status >= 0) call h5tset_strpad_f(string_type, h5t_str_nullpad_f, status)
      if (status >= 0) call h5tset_cset_f(string_type, h5t_cset_utf8_f, status)
   end subroutine new_string

end module hdf5_attribute

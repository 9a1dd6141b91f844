!> Attributes of HDF5 groups and datasets: reals, 64-bit integers and strings of fixed length in
!> UTF-8.
module hdf5_attribute
   use, intrinsic :: iso_c_binding, only: c_char, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: h5aclose_f, h5acreate_f, h5awrite_f, h5oclose_f, h5oopen_f, h5s_scalar_f, &
      h5sclose_f, h5screate_f, h5screate_simple_f, h5t_c_s1, h5t_cset_utf8_f, h5t_str_nullpad_f, &
      h5tclose_f, h5tcopy_f, h5tset_cset_f, h5tset_size_f, h5tset_strpad_f, hid_t, hsize_t, size_t
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: attach_real, attach_string, close_type, new_string_type, write_attribute

   !> Stores an attribute of an existing object, named by its path: real, reals, integer or string.
   interface write_attribute
      module procedure :: write_real_attribute
      module procedure :: write_reals_attribute
      module procedure :: write_integer_attribute
      module procedure :: write_string_attribute
   end interface write_attribute

contains

   !> A real attribute of the object at `path`.
   subroutine write_real_attribute(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      character(*), intent(in) :: name
      real(wp), intent(in) :: value
      integer(hid_t) :: object

      call open_object(file, path, object)
      call attach_real(file, object, name, value)
      call close_object(file, object)
   end subroutine write_real_attribute

   !> Several reals as one attribute of the object at `path`.
   subroutine write_reals_attribute(file, path, name, values)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      real(wp), allocatable, target :: copy(:)
      integer(hid_t) :: object

      allocate (copy, source=values)
      call open_object(file, path, object)
      call attach(file, object, name, file%real_type, c_loc(copy), size(copy))
      call close_object(file, object)
   end subroutine write_reals_attribute

   !> An integer attribute of the object at `path`.
   subroutine write_integer_attribute(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      character(*), intent(in) :: name
      integer, intent(in) :: value
      integer(int64), target :: copy
      integer(hid_t) :: object

      copy = int(value, int64)
      call open_object(file, path, object)
      call attach(file, object, name, file%integer_type, c_loc(copy))
      call close_object(file, object)
   end subroutine write_integer_attribute

   !> A string attribute of the object at `path`.
   subroutine write_string_attribute(file, path, name, value)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      character(*), intent(in) :: name
      character(*), intent(in) :: value
      integer(hid_t) :: object

      call open_object(file, path, object)
      call attach_string(file, object, name, value)
      call close_object(file, object)
   end subroutine write_string_attribute

   !> Attaches a real to an open object.
   subroutine attach_real(file, object, name, value)
      class(hdf5_file_t), intent(inout) :: file
      integer(hid_t), intent(in) :: object
      character(*), intent(in) :: name
      real(wp), intent(in), target :: value

      call attach(file, object, name, file%real_type, c_loc(value))
   end subroutine attach_real

   !> Attaches a string to an open object; an empty one becomes one null character.
   subroutine attach_string(file, object, name, value)
      class(hdf5_file_t), intent(inout) :: file
      integer(hid_t), intent(in) :: object
      character(*), intent(in) :: name
      character(*), intent(in) :: value
      character(kind=c_char, len=:), allocatable, target :: copy
      integer(hid_t) :: string_type

      copy = value
      if (len(value) == 0) copy = c_null_char
      call new_string_type(file, len(copy), string_type)
      call attach(file, object, name, string_type, c_loc(copy))
      call close_type(file, string_type)
   end subroutine attach_string

   !> Attaches one value of any type, or a vector of so many, to an open object.
   subroutine attach(file, object, name, type_id, value, count)
      class(hdf5_file_t), intent(inout) :: file
      integer(hid_t), intent(in) :: object
      character(*), intent(in) :: name
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: value
      integer, intent(in), optional :: count
      integer(hid_t) :: space, attribute
      integer :: status

      if (allocated(file%failure)) return
      if (present(count)) then
         call h5screate_simple_f(1, [int(count, hsize_t)], space, status)
      else
         call h5screate_f(h5s_scalar_f, space, status)
      end if
      call file%check(status, name)
      if (allocated(file%failure)) return
      call h5acreate_f(object, name, type_id, space, attribute, status)
      call file%check(status, name)
      if (allocated(file%failure)) return
      call h5awrite_f(attribute, type_id, value, status)
      call file%check(status, name)
      call h5aclose_f(attribute, status)
      call file%check(status, name)
      call h5sclose_f(space, status)
      call file%check(status, name)
   end subroutine attach

   !> The HDF5 type of a UTF-8 string of `length` bytes.
   subroutine new_string_type(file, length, string_type)
      class(hdf5_file_t), intent(inout) :: file
      integer, intent(in) :: length
      integer(hid_t), intent(out) :: string_type
      integer :: status

      string_type = -1_hid_t
      if (allocated(file%failure)) return
      call h5tcopy_f(h5t_c_s1, string_type, status)
      call file%check(status, 'string type')
      if (allocated(file%failure)) return
      call h5tset_size_f(string_type, int(length, size_t), status)
      call file%check(status, 'string type')
      call h5tset_strpad_f(string_type, h5t_str_nullpad_f, status)
      call file%check(status, 'string type')
      call h5tset_cset_f(string_type, h5t_cset_utf8_f, status)
      call file%check(status, 'string type')
   end subroutine new_string_type

   !> Gives a type back.
   subroutine close_type(file, type_id)
      class(hdf5_file_t), intent(inout) :: file
      integer(hid_t), intent(in) :: type_id
      integer :: status

      if (allocated(file%failure)) return
      call h5tclose_f(type_id, status)
      call file%check(status, 'string type')
   end subroutine close_type

   !> Opens a group or dataset.
   subroutine open_object(file, path, object)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer(hid_t), intent(out) :: object
      integer :: status

      object = -1_hid_t
      if (allocated(file%failure)) return
      call h5oopen_f(file%id, path, object, status)
      call file%check(status, path)
   end subroutine open_object

   !> Closes a group or dataset.
   subroutine close_object(file, object)
      class(hdf5_file_t), intent(inout) :: file
      integer(hid_t), intent(in) :: object
      integer :: status

      if (allocated(file%failure)) return
      call h5oclose_f(object, status)
      call file%check(status, 'closing an object')
   end subroutine close_object

end module hdf5_attribute

!> Labelled datasets of an HDF5 file: reals and integers of any rank, strings.
!>
!> Shapes are as Fortran sees them; h5py shows them reversed. Strings have a fixed length and are
!> UTF-8.
module hdf5_dataset
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_loc, c_null_char, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: h5dclose_f, h5dcreate_f, h5dwrite_f, h5p_dataset_create_f, h5pclose_f, &
      h5pcreate_f, h5pset_obj_track_times_f, h5s_scalar_f, h5sclose_f, h5screate_f, &
      h5screate_simple_f, hid_t, hsize_t
   use hdf5_attribute, only: attach_real, attach_string, close_type, new_string_type
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: create_labelled, label_t, new_label, new_properties, write_dataset, write_string, &
      write_values

   !> What a stored value is. value * si_scale = value in si_units.
   type :: label_t
      character(:), allocatable :: long_name
      !> Unit after multiplication by `si_scale`; '1' for a number without unit.
      character(:), allocatable :: si_units
      real(wp) :: si_scale = 1.0_wp
   end type label_t

   !> Stores a labelled dataset; groups above it are made as needed.
   interface write_dataset
      module procedure :: write_reals
      module procedure :: write_integers
      module procedure :: write_string
   end interface write_dataset

contains

   !> A label; `si_scale` defaults to 1.
   pure function new_label(long_name, si_units, si_scale) result(label)
      character(*), intent(in) :: long_name
      character(*), intent(in) :: si_units
      real(wp), intent(in), optional :: si_scale
      type(label_t) :: label

      label%long_name = long_name
      label%si_units = si_units
      if (present(si_scale)) label%si_scale = si_scale
   end function new_label

   !> Reals of any rank.
   subroutine write_reals(file, path, value, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      real(wp), intent(in), contiguous, target :: value(..)
      type(label_t), intent(in) :: label
      real(wp), pointer :: flat(:)

      call c_f_pointer(c_loc(value), flat, [size(value)])
      call file%look_at(path, flat)
      call write_values(file, path, file%real_type, shape(value), c_loc(value), label)
   end subroutine write_reals

   !> Integers of 64 bits, of any rank.
   subroutine write_integers(file, path, value, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer(int64), intent(in), contiguous, target :: value(..)
      type(label_t), intent(in) :: label

      call write_values(file, path, file%integer_type, shape(value), c_loc(value), label)
   end subroutine write_integers

   !> A string of fixed length, UTF-8; an empty one becomes one null character.
   subroutine write_string(file, path, value, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      character(*), intent(in) :: value
      type(label_t), intent(in), optional :: label
      character(kind=c_char, len=:), allocatable, target :: copy
      integer(hid_t) :: string_type

      copy = value
      if (len(value) == 0) copy = c_null_char
      call new_string_type(file, len(copy), string_type)
      call write_values(file, path, string_type, [integer ::], c_loc(copy), label)
      call close_type(file, string_type)
   end subroutine write_string

   !> Properties of a new dataset, for `create_labelled`: without a time stamp.
   subroutine new_properties(file, path, properties)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer(hid_t), intent(out) :: properties
      integer :: status

      properties = -1_hid_t
      if (allocated(file%failure)) return
      call h5pcreate_f(h5p_dataset_create_f, properties, status)
      call file%check(status, path)
      if (allocated(file%failure)) return
      call h5pset_obj_track_times_f(properties, .false., status)
      call file%check(status, path)
   end subroutine new_properties

   !> Creates a dataset, which stays open, and the groups above it, and labels it; `space` and
   !> `properties` are given back.
   subroutine create_labelled(file, path, type_id, space, properties, label, dataset)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: type_id, space, properties
      type(label_t), intent(in), optional :: label
      integer(hid_t), intent(out) :: dataset
      integer :: status

      dataset = -1_hid_t
      if (allocated(file%failure)) return
      call h5dcreate_f(file%id, path, type_id, space, dataset, status, dcpl_id=properties, &
         lcpl_id=file%link_creation)
      call file%check(status, path)
      if (allocated(file%failure)) return
      call h5pclose_f(properties, status)
      call file%check(status, path)
      call h5sclose_f(space, status)
      call file%check(status, path)
      if (.not. present(label)) return
      call attach_string(file, dataset, 'long_name', label%long_name)
      call attach_string(file, dataset, 'si_units', label%si_units)
      call attach_real(file, dataset, 'si_scale', label%si_scale)
   end subroutine create_labelled

   !> Creates, writes and closes a dataset of the `extents` (none: one value), and labels it.
   subroutine write_values(file, path, type_id, extents, values, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: type_id
      integer, intent(in) :: extents(:)
      type(c_ptr), intent(in) :: values
      type(label_t), intent(in), optional :: label
      integer(hid_t) :: space, dataset, properties
      integer :: status

      if (allocated(file%failure)) return
      if (size(extents) == 0) then
         call h5screate_f(h5s_scalar_f, space, status)
      else
         ! gfortran 12: where an expression like int(x, int64) is empty its `shape` here has a -1.
         call h5screate_simple_f(size(extents), int(max(extents, 0), hsize_t), space, status)
      end if
      call file%check(status, path)
      call new_properties(file, path, properties)
      call create_labelled(file, path, type_id, space, properties, label, dataset)
      if (allocated(file%failure)) return
      if (all(extents > 0)) call h5dwrite_f(dataset, type_id, values, status)
      call file%check(status, path)
      call h5dclose_f(dataset, status)
      call file%check(status, path)
   end subroutine write_values

end module hdf5_dataset

!> Axes of datasets as HDF5 dimension scales (as in netCDF-4): readers know all coordinates.
!>
!> The attributes are those of the HDF5 Dimension Scale Specification 1.0: CLASS and NAME of a
!> scale, DIMENSION_LIST of its users, REFERENCE_LIST of a scale in use. NetCDF looks for scales in
!> the group of the dataset, so a coordinate is linked where else it is used.
module hdf5_axes
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_loc, c_null_char, c_sizeof
   use hdf5, only: h5iinc_ref_f, h5lcreate_soft_f, h5offsetof, h5rcreate_f, h5t_c_s1, &
      h5t_compound_f, h5t_native_integer, h5t_std_ref_obj, h5tclose_f, h5tcopy_f, h5tcreate_f, &
      h5tinsert_f, h5tset_size_f, h5tvlen_create_f, hid_t, hobj_ref_t_f, hvl_t, size_t
   use hdf5_dataset, only: attach_values, label_t, new_label, write_dataset, write_values
   use hdf5_file, only: axis_t, axis_use_t, hdf5_file_t
   use hdf5_library, only: link_creation
   use kinds, only: int64, wp
   use text, only: count_of
   implicit none (type, external)
   private

   public :: link_object, make_counter, name_axes, write_field, write_users

contains

   !> Stores reals with their `axes`: names of datasets in their group, the faster one first, or '='
   !> for an axis itself. With `has_si` a dataset below /si has them in SI, if they have a unit.
   subroutine write_field(file, path, values, label, axes, has_si)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, axes
      real(wp), intent(in), contiguous, target :: values(..)
      type(label_t), intent(in) :: label
      logical, intent(in), optional :: has_si
      real(wp), pointer :: flat(:)
      real(wp), allocatable, target :: copy(:)

      call write_dataset(file, path, values, label)
      call name_axes(file, path, axes)
      if (.not. present(has_si)) return
      if (.not. has_si .or. label%si_units == '1') return
      call c_f_pointer(c_loc(values), flat, [size(values)])
      copy = label%si_scale*flat
      call file%check_values('/si'//path, copy)
      call write_values(file, '/si'//path, file%real_type, shape(values), c_loc(copy), &
         new_label(label%long_name, label%si_units))
      call name_axes(file, '/si'//path, axes)
   end subroutine write_field

   !> The dataset at `path` with one dimension becomes a coordinate, of which its name is the name.
   subroutine make_axis(file, path)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer :: k, references, status

      call attach_name(file, path, 'CLASS', 'DIMENSION_SCALE')
      call attach_name(file, path, 'NAME', path(index(path, '/', back=.true.) + 1:))
      if (allocated(file%failure)) return
      k = axis_at(file, path)
      file%axes(k)%object = file%object_at(path)
      call h5iinc_ref_f(file%axes(k)%object, references, status)   ! open until `write_users`
      call file%check(status, path)
   end subroutine make_axis

   !> A string with a null character at its end, as the specification has them.
   subroutine attach_name(file, path, attribute, name)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, attribute, name
      character(kind=c_char, len=:), allocatable, target :: copy
      integer(hid_t) :: name_type
      integer :: status

      if (allocated(file%failure)) return
      copy = name//c_null_char
      call h5tcopy_f(h5t_c_s1, name_type, status)
      if (status >= 0) call h5tset_size_f(name_type, len(copy, kind=size_t), status)
      call file%check(status, attribute)
      call attach_values(file, path, attribute, name_type, [integer ::], c_loc(copy))
      call h5tclose_f(name_type, status)
   end subroutine attach_name

   !> A new coordinate 1, 2, ... `length`.
   subroutine make_counter(file, path, length, long_name)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, long_name
      integer, intent(in) :: length
      integer :: i

      if (allocated(file%row)) return
      call write_dataset(file, path, [(int(i, int64), i=1, length)], new_label(long_name, '1'))
      call make_axis(file, path)
   end subroutine make_counter

   !> Names the coordinates of a dataset, as `write_field` has them.
   subroutine name_axes(file, path, axes)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, axes
      integer(int64), allocatable, target :: places(:)
      type(hvl_t), allocatable, target :: lists(:)
      integer(int64) :: user
      integer(hid_t) :: list_type
      integer :: first, i, k, last, status

      if (allocated(file%row)) return
      if (axes == '=') call make_axis(file, path)
      if (axes == '=' .or. allocated(file%failure)) return
      user = place_of(file, file%object_at(path), '.')
      allocate (places(count_of(' ', axes) + 1), lists(count_of(' ', axes) + 1))
      first = 1
      do i = size(places), 1, -1
         last = first + index(axes(first:)//' ', ' ') - 2
         k = axis_at(file, path(:index(path, '/', back=.true.))//axes(first:last))
         if (allocated(file%failure)) return
         file%axes(k)%uses = [file%axes(k)%uses, axis_use_t(user, i - 1)]
         places(i) = file%axes(k)%place
         lists(i) = hvl_t(1_size_t, c_loc(places(i)))
         first = last + 2
      end do
      call h5tvlen_create_f(h5t_std_ref_obj, list_type, status)
      call file%check(status, path)
      call attach_values(file, path, 'DIMENSION_LIST', list_type, shape(lists), c_loc(lists))
      call h5tclose_f(list_type, status)
   end subroutine name_axes

   !> The dataset or group at `path`, a coordinate or not, under a second name: a soft link, so that
   !> who walks through the file meets it once.
   subroutine link_object(file, path, second)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, second
      integer :: status

      if (allocated(file%failure) .or. allocated(file%row)) return
      call h5lcreate_soft_f(path, file%id, second, status, lcpl_id=link_creation)
      call file%check(status, second)
   end subroutine link_object

   !> Lists in every coordinate the datasets that use it: once, before the file is closed.
   subroutine write_users(file)
      class(hdf5_file_t), intent(inout) :: file
      type(axis_use_t), allocatable, target :: uses(:)
      type(axis_use_t), target :: one
      integer(hid_t) :: use_type
      integer :: i, k, status

      if (allocated(file%failure) .or. size(file%axes) == 0) return
      call h5tcreate_f(h5t_compound_f, c_sizeof(one), use_type, status)
      if (status >= 0) call h5tinsert_f(use_type, 'dataset', h5offsetof(c_loc(one), &
         c_loc(one%user)), h5t_std_ref_obj, status)
      if (status >= 0) call h5tinsert_f(use_type, 'dimension', h5offsetof(c_loc(one), &
         c_loc(one%dimension)), h5t_native_integer, status)
      call file%check(status, 'type of the users of an axis')
      do i = 1, size(file%axes)
         associate (axis => file%axes(i))
            if (axis%object < 0_hid_t) cycle   ! another name
            call file%keep_object(axis%path, axis%object)
            uses = [axis_use_t ::]
            do k = i, size(file%axes)
               if (file%axes(k)%place == axis%place) uses = [uses, file%axes(k)%uses]
            end do
            if (size(uses) > 0) call attach_values(file, axis%path, 'REFERENCE_LIST', use_type, &
               shape(uses), c_loc(uses))
         end associate
      end do
      call h5tclose_f(use_type, status)
   end subroutine write_users

   !> Number of the coordinate at `path`, or of this second name of one; a new path is added.
   integer function axis_at(file, path) result(k)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path

      do k = 1, size(file%axes)
         if (file%axes(k)%path == path) return
      end do
      file%axes = [file%axes, axis_t(path, place=place_of(file, file%id, path), &
         uses=[axis_use_t ::])]
   end function axis_at

   !> The place in the file that stands in references for the dataset `path` of a `location`.
   function place_of(file, location, path) result(place)
      class(hdf5_file_t), intent(inout) :: file
      integer(hid_t), intent(in) :: location
      character(*), intent(in) :: path
      integer(int64) :: place
      type(hobj_ref_t_f) :: reference
      integer :: status

      place = 0_int64
      if (allocated(file%failure)) return
      call h5rcreate_f(location, path, reference, status)
      call file%check(status, path)
      place = int(reference%ref, int64)
   end function place_of

end module hdf5_axes

!> Reads heights from an HDF5 file: a dataset of one or two dimensions and the spacing of its nodes.
module hdf5_reader
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use errors, only: error_t, fail, input_error
   use hdf5, only: h5aclose_f, h5aexists_f, h5aopen_f, h5aread_f, h5dclose_f, h5dget_space_f, h5dopen_f, h5dread_f, &
      h5f_acc_rdonly_f, h5fclose_f, h5fopen_f, h5sclose_f, h5sget_simple_extent_dims_f, &
      h5sget_simple_extent_ndims_f, h5t_native_double, hid_t, hsize_t
   use hdf5_library, only: start_hdf5
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: read_hdf5_heights

contains

   !> Heights `z` (nx*ny, x fastest) of `dataset` in `file`, a dataset (nx) or, as h5py sees it, (ny, nx), times its
   !> attribute `si_scale` if it has one. `spacing` (2) [m] from its attributes `spacing_x`, `spacing_y` or `spacing`; 0 where
   !> there is none. Errors (input_error): no such file or dataset, another number of dimensions.
   subroutine read_hdf5_heights(file, dataset, z, grid, spacing, error)
      character(*), intent(in) :: file, dataset
      real(wp), allocatable, intent(out) :: z(:)
      integer, intent(out) :: grid(2)
      real(wp), intent(out) :: spacing(2)
      type(error_t), allocatable, intent(out) :: error
      integer(hid_t) :: file_id, set_id
      integer :: status

      grid = 0
      spacing = 0.0_wp
      call start_hdf5(status)
      call h5fopen_f(file, h5f_acc_rdonly_f, file_id, status)
      if (status /= 0) then
         call fail(error, input_error, 'cannot read ' // file // ' as HDF5')
         return
      end if
      call h5dopen_f(file_id, dataset, set_id, status)
      if (status /= 0) then
         call fail(error, input_error, 'found no dataset ' // dataset // ' in ' // file)
      else
         call read_set(set_id, file // ' ' // dataset, z, grid, error)
         if (.not. allocated(error)) then
            spacing = attribute_of(set_id, 'spacing', 0.0_wp)
            spacing = [attribute_of(set_id, 'spacing_x', spacing(1)), attribute_of(set_id, 'spacing_y', spacing(2))]
            z = z*attribute_of(set_id, 'si_scale', 1.0_wp)
         end if
         call h5dclose_f(set_id, status)
      end if
      call h5fclose_f(file_id, status)
   end subroutine read_hdf5_heights

   !> The values of an open dataset. Errors: not one or two dimensions, not numbers.
   subroutine read_set(set_id, name, z, grid, error)
      integer(hid_t), intent(in) :: set_id
      character(*), intent(in) :: name
      real(wp), allocatable, target, intent(out) :: z(:)
      integer, intent(out) :: grid(2)
      type(error_t), allocatable, intent(out) :: error
      integer(hid_t) :: space_id
      integer(hsize_t) :: extents(2), largest(2)
      integer :: dimensions, status
      type(c_ptr) :: address

      grid = 0
      call h5dget_space_f(set_id, space_id, status)
      call h5sget_simple_extent_ndims_f(space_id, dimensions, status)
      if (dimensions < 1 .or. dimensions > 2) then
         call fail(error, input_error, 'found ' // to_text(dimensions) // ' dimensions in ' // name // ', expected 1 or 2')
         return
      end if
      extents = 1_hsize_t
      call h5sget_simple_extent_dims_f(space_id, extents, largest, status)
      call h5sclose_f(space_id, status)
      grid = int(extents)
      allocate (z(grid(1)*grid(2)))
      address = c_loc(z)
      call h5dread_f(set_id, h5t_native_double, address, status)
      if (status /= 0) call fail(error, input_error, 'cannot read ' // name // ' as real numbers')
   end subroutine read_set

   !> A real attribute of an open dataset; `default` if there is none.
   function attribute_of(set_id, name, default) result(value)
      integer(hid_t), intent(in) :: set_id
      character(*), intent(in) :: name
      real(wp), intent(in) :: default
      real(wp) :: value
      integer(hid_t) :: attribute_id
      logical :: exists
      integer :: status
      real(wp) :: read_value(1)

      value = default
      call h5aexists_f(set_id, name, exists, status)
      if (status /= 0 .or. .not. exists) return
      call h5aopen_f(set_id, name, attribute_id, status)
      if (status /= 0) return
      call h5aread_f(attribute_id, h5t_native_double, read_value, [1_hsize_t], status)
      if (status == 0) value = read_value(1)
      call h5aclose_f(attribute_id, status)
   end function attribute_of

end module hdf5_reader

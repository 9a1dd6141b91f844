!> Datasets of an HDF5 file written block by block, in memory that does not grow with the run.
module hdf5_series
   use, intrinsic :: iso_c_binding, only: c_loc
   use hdf5, only: h5dclose_f, h5dget_space_f, h5dwrite_f, h5s_select_set_f, h5sclose_f, &
      h5screate_simple_f, h5sselect_hyperslab_f, hid_t, hsize_t
   use hdf5_dataset, only: create_labelled, label_t
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: create_series, series_t

   !> A series in an open file: numbers (n) or rows (row_length, n), in h5py (n, row_length).
   type :: series_t
      !> Records written so far.
      integer :: records = 0
      !> Length of a row; 0 = the records are single numbers.
      integer :: row_length = 0
      character(:), allocatable, private :: path
      integer(hid_t), private :: id = -1_hid_t
   contains
      procedure :: append
      procedure :: close => close_series
   end type series_t

contains

   !> Makes a series at `path` for this many `records`.
   subroutine create_series(series, file, path, row_length, records, label)
      type(series_t), intent(out) :: series
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer, intent(in) :: row_length, records
      type(label_t), intent(in) :: label
      integer(hid_t) :: space
      integer :: status, first

      if (allocated(file%failure)) return
      series%path = path
      series%row_length = row_length
      first = merge(2, 1, row_length == 0)
      associate (extents => [int(row_length, hsize_t), int(records, hsize_t)])
         call h5screate_simple_f(3 - first, extents(first:), space, status)
      end associate
      call file%check(status, path)
      call create_labelled(file, path, file%real_type, space, file%shared%creation, label, &
         series%id)
      if (allocated(file%failure)) return
      call h5sclose_f(space, status)
      call file%check(status, path)
   end subroutine create_series

   !> Writes records behind the last one.
   subroutine append(self, file, values)
      class(series_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      real(wp), intent(in), contiguous, target :: values(:, :)
      integer(hid_t) :: file_space, memory_space
      integer(hsize_t) :: offset(2), extents(2)
      integer :: first, status

      if (allocated(file%failure) .or. size(values, 2) == 0) return
      call file%check_values(self%path, values)
      offset = [0_hsize_t, int(self%records, hsize_t)]
      extents = [int(self%row_length, hsize_t), size(values, 2, kind=hsize_t)]
      first = merge(2, 1, self%row_length == 0)
      associate (start => offset(first:), count => extents(first:))
         call h5dget_space_f(self%id, file_space, status)
         if (status >= 0) call h5screate_simple_f(size(count), count, memory_space, status)
         if (status >= 0) call h5sselect_hyperslab_f(file_space, h5s_select_set_f, start, count, &
            status)
         if (status >= 0) call h5dwrite_f(self%id, file%real_type, c_loc(values), status, &
            memory_space, file_space)
         if (status >= 0) call h5sclose_f(memory_space, status)
         if (status >= 0) call h5sclose_f(file_space, status)
      end associate
      call file%check(status, self%path)
      self%records = self%records + size(values, 2)
   end subroutine append

   !> Closes the dataset of the series.
   subroutine close_series(self, file)
      class(series_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      integer :: status

      if (allocated(file%failure)) return
      call h5dclose_f(self%id, status)
      self%id = -1_hid_t
      call file%check(status, self%path)
   end subroutine close_series

end module hdf5_series

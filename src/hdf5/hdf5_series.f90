!> Datasets of an HDF5 file that grow by one record at a time, so that a long run needs no more
!> memory than a short one.
module hdf5_series
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use hdf5, only: h5dget_space_f, h5dset_extent_f, h5dwrite_f, h5pset_chunk_f, h5pset_deflate_f, &
      h5pset_shuffle_f, h5s_select_set_f, h5s_unlimited_f, h5sclose_f, h5screate_simple_f, &
      h5sselect_hyperslab_f, h5z_filter_deflate_f, h5zfilter_avail_f, hid_t, hsize_t
   use hdf5_dataset, only: create_labelled, label_t, new_properties
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: create_series, series_t

   !> Numbers in one chunk: 256 kB, so that the chunk being filled stays in HDF5's cache of 1 MB.
   integer, parameter :: chunk_numbers = 32768
   !> Level of the deflate filter [1-9].
   integer, parameter :: deflate_level = 4

   !> A series in an open file: numbers (n) or rows (row_length, n); h5py shows rows as (n,
   !> row_length).
   type :: series_t
      !> Records written so far.
      integer :: records = 0
      !> Length of a row; 0 = the records are single numbers.
      integer :: row_length = 0
      character(:), allocatable, private :: path
      integer(hid_t), private :: id = -1_hid_t
   contains
      !> Appends a record or several.
      generic :: append => append_number, append_row, append_rows
      procedure, private :: append_number, append_row, append_rows
   end type series_t

contains

   !> Makes an empty series at `path`; rows are compressed if the library can.
   subroutine create_series(series, file, path, row_length, label)
      type(series_t), intent(out) :: series
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer, intent(in) :: row_length
      type(label_t), intent(in) :: label
      integer(hid_t) :: space, properties
      integer(hsize_t) :: extents(2), limits(2)
      integer :: status, first

      if (allocated(file%failure)) return
      series%path = path
      series%row_length = row_length
      extents = [int(row_length, hsize_t), 0_hsize_t]
      limits = [int(row_length, hsize_t), h5s_unlimited_f]
      first = merge(2, 1, row_length == 0)
      call h5screate_simple_f(3 - first, extents(first:), space, status, limits(first:))
      call file%check(status, path)
      call new_properties(file, path, properties)
      call add_chunks(file, path, row_length, properties)
      call create_labelled(file, path, file%real_type, space, properties, label, series%id)
   end subroutine create_series

   !> Chunks, and compression of rows.
   subroutine add_chunks(file, path, row_length, properties)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer, intent(in) :: row_length
      integer(hid_t), intent(in) :: properties
      integer(hsize_t) :: chunk(2)
      logical :: can_deflate
      integer :: status, rank

      if (allocated(file%failure)) return
      rank = merge(1, 2, row_length == 0)
      chunk(1) = int(min(row_length, chunk_numbers), hsize_t)
      chunk(2) = int(max(chunk_numbers/max(row_length, 32), 1), hsize_t)
      call h5pset_chunk_f(properties, rank, chunk(3 - rank:), status)
      call file%check(status, path)
      if (rank == 1) return
      call h5zfilter_avail_f(h5z_filter_deflate_f, can_deflate, status)
      call file%check(status, path)
      if (.not. can_deflate) return
      call h5pset_shuffle_f(properties, status)
      call file%check(status, path)
      call h5pset_deflate_f(properties, deflate_level, status)
      call file%check(status, path)
   end subroutine add_chunks

   !> Appends a number.
   subroutine append_number(self, file, value)
      class(series_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      real(wp), intent(in), target :: value

      call file%look_at(self%path, [value])
      call append_records(self, file, [int(self%records, hsize_t)], [1_hsize_t], c_loc(value))
   end subroutine append_number

   !> Appends a row of `row_length` numbers.
   subroutine append_row(self, file, values)
      class(series_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      real(wp), intent(in), contiguous, target :: values(:)

      call file%look_at(self%path, values)
      call append_records(self, file, [0_hsize_t, int(self%records, hsize_t)], &
         [int(self%row_length, hsize_t), 1_hsize_t], &
                         c_loc(values))
   end subroutine append_row

   !> Appends several records: rows (row_length, n), or numbers (1, n).
   subroutine append_rows(self, file, values)
      class(series_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      real(wp), intent(in), contiguous, target :: values(:, :)
      integer(hsize_t) :: offset(2), extents(2)
      integer :: first, i

      if (size(values, 2) == 0) return
      do i = 1, size(values, 2)
         call file%look_at(self%path, values(:, i))
      end do
      offset = [0_hsize_t, int(self%records, hsize_t)]
      extents = [int(self%row_length, hsize_t), size(values, 2, kind=hsize_t)]
      first = merge(2, 1, self%row_length == 0)
      call append_records(self, file, offset(first:), extents(first:), c_loc(values))
   end subroutine append_rows

   !> Makes room for records (`extents`) and writes them at `offset`.
   subroutine append_records(series, file, offset, extents, values)
      type(series_t), intent(inout) :: series
      class(hdf5_file_t), intent(inout) :: file
      integer(hsize_t), intent(in) :: offset(:)
      integer(hsize_t), intent(in) :: extents(:)
      type(c_ptr), intent(in) :: values
      integer(hid_t) :: file_space, memory_space
      integer :: status

      if (allocated(file%failure)) return
      call h5dset_extent_f(series%id, offset + extents, status)
      call file%check(status, series%path)
      call h5dget_space_f(series%id, file_space, status)
      call file%check(status, series%path)
      call h5screate_simple_f(size(extents), extents, memory_space, status)
      call file%check(status, series%path)
      if (allocated(file%failure)) return
      call h5sselect_hyperslab_f(file_space, h5s_select_set_f, offset, extents, status)
      call file%check(status, series%path)
      call h5dwrite_f(series%id, file%real_type, values, status, memory_space, file_space)
      call file%check(status, series%path)
      call h5sclose_f(memory_space, status)
      call file%check(status, series%path)
      call h5sclose_f(file_space, status)
      call file%check(status, series%path)
      series%records = series%records + int(extents(size(extents)))
   end subroutine append_records

end module hdf5_series

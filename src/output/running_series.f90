!> Series of numbers in the HDF5 file of a run that is still going on, complete at every moment.
!>
!> The HDF5 library leaves a file that cannot be read while it writes, and one that may never be
!> read again if the process is killed in between. So every series gets its place in the file before
!> the run begins (contiguous, for as many records as there will be; the file system takes up only
!> what is written), and the library closes the file. A record is then written straight to its
!> place, and after it the number of records, 8 bytes in the header of the dataset. Readers may open
!> the file at any time, and a kill at any time leaves a file with all records counted so far.
!>
!> Layout of the header: HDF5 File Format Specification 3.0, IV.A.1.a (version 1 object header),
!> IV.A.2.b (dataspace) and IV.A.2.q (continuation). `create_hdf5_file` asks the library for these
!> oldest versions, and a header of another version is an error before the run begins.
!>
!> Why the library does not write the records itself: docs/decisions.md.
module running_series
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t
   use, intrinsic :: iso_fortran_env, only: int64
   use checksum, only: checksum_t
   use errors, only: fail, output_error
   use file_bytes, only: positional_file_t, real_bytes
   use hdf5, only: h5d_alloc_time_early_f, h5d_fill_time_never_f, h5dclose_f, h5pclose_f, &
      h5pset_alloc_time_f, h5pset_fill_time_f, h5sclose_f, h5screate_simple_f, hid_t, hsize_t
   use hdf5_dataset, only: create_labelled, label_t
   use hdf5_file, only: hdf5_file_t
   use hdf5_library, only: new_properties
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: create_running_series, running_series_t

   !> Message types of the dataspace and of a header that goes on elsewhere; the version of header
   !> and dataspace known here.
   integer(int64), parameter :: dataspace_message = 1_int64, continuation_message = 16_int64, &
      known_version = 1_int64
   !> Numbers that are read at once.
   integer, parameter :: block_numbers = 131072
   !> Bytes of the header before its first message, and of a message before its content.
   integer, parameter :: header_bytes = 16, message_bytes = 8

   !> One series: single numbers, or rows of `row_length` numbers.
   type :: running_series_t
      !> Path of the dataset.
      character(:), allocatable :: path
      !> Length of a row; 0 = single numbers.
      integer :: row_length = 0
      !> Records that are counted in the file.
      integer :: records = 0
      !> Places in the file [bytes from its start]: first number, object header, number of records.
      integer(int64), private :: data_place = 0, header_place = 0, count_place = 0
      !> Checksum of the counted records, and with the one that was put.
      type(checksum_t) :: sums
      type(checksum_t), private :: next_sums
   contains
      !> Finds the place of the count in an open file, if it is not known, and sets the count.
      procedure :: begin
      !> Takes up a series whose places in the file are known, without a look at its header.
      procedure :: take_up
      !> Places in the file of the first number and of the number of records, for `take_up` [bytes].
      procedure :: places
      !> Writes a record behind the counted ones.
      procedure :: put
      !> Counts the record that was put.
      procedure :: count_record
      !> Reads records back (row_length or 1, number of records).
      procedure :: get
   end type running_series_t

   interface
      !> Place of the data of a contiguous dataset in the file [bytes].
      function h5dget_offset(dataset) bind(c, name='H5Dget_offset') result(place)
         import :: c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value :: dataset
         integer(c_int64_t) :: place
      end function h5dget_offset

      !> H5O_info1_t of an object; its second number is the place of the object header in the file
      !> [bytes].
      function h5oget_info1(object, info) bind(c, name='H5Oget_info1') result(status)
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int64_t), value :: object
         integer(c_int64_t), intent(inout) :: info(64)
         integer(c_int) :: status
      end function h5oget_info1
   end interface

contains

   !> Makes room for `capacity` records at `path` of an open HDF5 file, at a fixed place in it.
   subroutine create_running_series(series, file, path, row_length, capacity, label)
      type(running_series_t), intent(out) :: series
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer, intent(in) :: row_length, capacity
      type(label_t), intent(in) :: label
      integer(hid_t) :: space, properties, dataset
      integer(hsize_t) :: extents(2)
      integer(c_int64_t) :: info(64)
      integer :: first, status

      if (allocated(file%failure)) return
      series%path = path
      series%row_length = row_length
      extents = [int(row_length, hsize_t), int(capacity, hsize_t)]
      first = merge(2, 1, row_length == 0)
      call h5screate_simple_f(3 - first, extents(first:), space, status)
      if (status >= 0) call new_properties(properties, status)
      if (status >= 0) call h5pset_alloc_time_f(properties, h5d_alloc_time_early_f, status)
      if (status >= 0) call h5pset_fill_time_f(properties, h5d_fill_time_never_f, status)
      call file%check(status, path)
      call create_labelled(file, path, file%real_type, space, properties, label, dataset)
      if (allocated(file%failure)) return
      info = 0_c_int64_t
      status = int(h5oget_info1(dataset, info))
      series%header_place = info(2)
      series%data_place = h5dget_offset(dataset)
      if (series%data_place <= 0_int64) status = -1
      if (status >= 0) call h5dclose_f(dataset, status)
      if (status >= 0) call h5pclose_f(properties, status)
      if (status >= 0) call h5sclose_f(space, status)
      call file%check(status, path)
   end subroutine create_running_series

   !> The series at `places` of a file, with its first `records` records.
   subroutine take_up(self, file, path, row_length, places, records)
      class(running_series_t), intent(inout) :: self
      type(positional_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      integer, intent(in) :: row_length, records
      integer(int64), intent(in) :: places(2)

      self%path = path
      self%row_length = row_length
      self%data_place = places(1)
      self%count_place = places(2)
      call read_back(self, file, records)
   end subroutine take_up

   !> Where the first number and the number of records stand.
   pure function places(self)
      class(running_series_t), intent(in) :: self
      integer(int64) :: places(2)

      places = [self%data_place, self%count_place]
   end function places

   !> Counts the first `records` records, whose checksum is made again.
   subroutine read_back(series, file, records)
      class(running_series_t), intent(inout) :: series
      type(positional_file_t), intent(inout) :: file
      integer, intent(in) :: records
      real(wp), allocatable :: values(:, :)
      integer :: first, most

      most = min(max(block_numbers/max(series%row_length, 1), 1), records)
      allocate (values(max(series%row_length, 1), most))
      series%sums = checksum_t()
      do first = 1, records, most
         associate (block => values(:, :min(most, records - first + 1)))
            call series%get(file, first, block)
            call series%sums%add(reshape(block, [size(block)]))
         end associate
         if (allocated(file%failure)) return
      end do
      series%records = records
   end subroutine read_back

   !> Finds where the number of records stands and sets it to `records`. (With none, newer HDF5
   !> libraries refuse the dataset.)
   subroutine begin(self, file, records)
      class(running_series_t), intent(inout) :: self
      type(positional_file_t), intent(inout) :: file
      integer, intent(in) :: records

      if (self%count_place == 0_int64) then
         if (file%number_at(self%header_place, 1) == known_version) self%count_place = &
            count_in_block(file, &
            self%header_place + header_bytes, file%number_at(self%header_place + 8, 4))
      end if
      if (self%count_place == 0_int64 &
         .and. .not. allocated(file%failure)) call fail(file%failure, output_error, &
            'cannot write ' &
         //file%path//' ('//self%path//'): the HDF5 library made a header of an unknown version')
      if (allocated(file%failure)) return
      if (records /= self%records) call read_back(self, file, records)
      call file%write_number(self%count_place, int(records, int64))
   end subroutine begin

   !> Place of the first extent of the dataspace, if that is described in the `bytes` of a header
   !> from `start` on, or in a block in which it goes on; 0: it is not.
   recursive function count_in_block(file, start, bytes) result(place)
      type(positional_file_t), intent(inout) :: file
      integer(int64), intent(in) :: start, bytes
      integer(int64) :: place, message, content

      place = 0_int64
      message = start
      do while (message + message_bytes <= start + bytes .and. place == 0_int64 &
         .and. .not. allocated(file%failure))
         content = message + message_bytes
         select case (file%number_at(message, 2))
         case (dataspace_message)
            ! version, rank, flags, 5 bytes of nothing, then the extents, the slowest first
            if (file%number_at(content, 1) == known_version) place = content + 8
         case (continuation_message)
            place = count_in_block(file, file%number_at(content, 8), file%number_at(content + 8, 8))
         case default   ! all others
            continue
         end select
         message = content + file%number_at(message + 2, 2)
      end do
   end function count_in_block

   !> Writes a record (row_length, or 1 number) behind the counted ones.
   subroutine put(self, file, values)
      class(running_series_t), intent(inout) :: self
      type(positional_file_t), intent(inout) :: file
      real(wp), intent(in), contiguous :: values(:)

      self%next_sums = self%sums
      call self%next_sums%add(values)
      call file%write_reals(place_of_record(self, self%records), values)
   end subroutine put

   !> One record more.
   subroutine count_record(self, file)
      class(running_series_t), intent(inout) :: self
      type(positional_file_t), intent(inout) :: file

      if (allocated(file%failure)) return
      self%records = self%records + 1
      self%sums = self%next_sums
      call file%write_number(self%count_place, int(self%records, int64))
   end subroutine count_record

   !> Reads the records from number `first` (1 = the first) into `values` (row_length or 1, number
   !> of records).
   subroutine get(self, file, first, values)
      class(running_series_t), intent(in) :: self
      type(positional_file_t), intent(inout) :: file
      integer, intent(in) :: first
      real(wp), intent(out), contiguous :: values(:, :)

      call file%read_reals(place_of_record(self, first - 1), values)
   end subroutine get

   !> Where a record begins that has `before` records before it.
   pure function place_of_record(series, before) result(place)
      type(running_series_t), intent(in) :: series
      integer, intent(in) :: before
      integer(int64) :: place

      place = series%data_place + real_bytes*int(max(series%row_length, 1), int64)*before
   end function place_of_record

end module running_series

!> An open attribute or dataset of an HDF5 file as the source of values: what it holds is compared
!> with what the reader has room for before anything is read, and everything must lie in the file
!> itself.
module hdf5_source
   use, intrinsic :: iso_c_binding, only: c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: h5aget_space_f, h5aget_type_f, h5aread_f, h5d_chunked_f, h5d_virtual_f, &
      h5dget_create_plist_f, h5dget_space_f, h5dget_storage_size_f, h5dget_type_f, h5dread_f, &
      h5pclose_f, h5pget_chunk_f, h5pget_external_count_f, h5pget_layout_f, h5sclose_f, &
      h5sget_simple_extent_ndims_f, h5sget_simple_extent_npoints_f, h5t_float_f, h5t_integer_f, &
      h5t_string_f, h5tclose_f, h5tget_class_f, h5tget_size_f, h5tis_variable_str_f, hid_t, &
      hsize_t, size_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: fault_of_size, fault_of_storage, hdf5_source_t, number_class, text_class

   !> Classes of values that are read: integers or reals of at most 16 bytes; a text of fixed
   !> length.
   integer, parameter :: number_class = 1, text_class = 2
   !> Largest number and text [bytes].
   integer(size_t), parameter :: largest_number = 16_size_t, largest_text = 16777216_size_t
   !> Largest chunk: the library holds a whole one [bytes].
   integer(int64), parameter :: largest_chunk = 1073741824_int64
   !> Datasets from this size on must be stored, not only declared [bytes]. Largest compression
   !> ratio of deflate.
   integer(int64), parameter :: large_dataset = 67108864_int64
   real(wp), parameter :: most_packed = 1100.0_wp

   !> An open attribute or dataset.
   type :: hdf5_source_t
      integer(hid_t) :: id = -1_hid_t
      logical :: is_attribute = .false.
   contains
      procedure :: fault
      procedure :: value_bytes
      procedure :: open_type
      procedure :: read_into
   end type hdf5_source_t

contains

   !> "found ..., expected ..." where the source is not `count` values of the class; empty if it is.
   !> Below 0: any number of values.
   function fault(self, class, count)
      class(hdf5_source_t), intent(in) :: self
      integer, intent(in) :: class
      integer(int64), intent(in) :: count
      character(:), allocatable :: fault
      integer(hid_t) :: type_id
      integer(size_t) :: bytes
      integer(int64) :: found
      integer :: found_class, status
      logical :: is_right, is_variable

      found_class = -1
      bytes = 0_size_t
      is_variable = .false.
      call self%open_type(type_id, status)
      if (status >= 0) call h5tget_class_f(type_id, found_class, status)
      if (status >= 0) call h5tget_size_f(type_id, bytes, status)
      if (found_class == h5t_string_f) call h5tis_variable_str_f(type_id, is_variable, status)
      call h5tclose_f(type_id, status)
      found = number_of_values(self)
      if (class == number_class) then
         is_right = (found_class == h5t_integer_f .or. found_class == h5t_float_f) &
            .and. bytes <= largest_number
      else
         is_right = found_class == h5t_string_f .and. bytes <= largest_text .and. .not. is_variable
      end if
      fault = ''
      if (.not. is_right) then
         fault = 'found '//class_words(found_class)//', expected ' &
            //trim(merge('numbers               ', &
            'a text of fixed length', class == number_class))
      else if (count >= 0 .and. found /= count) then
         fault = 'found '//to_text(found)//' values, expected '//to_text(count)
      end if
   end function fault

   !> What values of a class of HDF5 are.
   function class_words(class) result(words)
      integer, intent(in) :: class
      character(:), allocatable :: words

      if (class == h5t_string_f) then
         words = 'text'
      else if (class == h5t_integer_f .or. class == h5t_float_f) then
         words = 'numbers'
      else
         words = 'something else (a compound, an enumeration, references, ...)'
      end if
   end function class_words

   !> Bytes of one value of a source.
   function value_bytes(self) result(bytes)
      class(hdf5_source_t), intent(in) :: self
      integer(size_t) :: bytes
      integer(hid_t) :: type_id
      integer :: status

      bytes = 0_size_t
      call self%open_type(type_id, status)
      if (status >= 0) call h5tget_size_f(type_id, bytes, status)
      if (status >= 0) call h5tclose_f(type_id, status)
   end function value_bytes

   !> Reads all values as `type_id` to `place`; what is there must have been looked at with `fault`.
   subroutine read_into(self, type_id, place, status)
      class(hdf5_source_t), intent(in) :: self
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: place
      integer, intent(out) :: status
      type(c_ptr) :: address

      address = place   ! the argument is intent(inout)
      if (self%is_attribute) then
         call h5aread_f(self%id, type_id, address, status)
      else
         call h5dread_f(self%id, type_id, address, status)
      end if
   end subroutine read_into

   !> The type of the values, to be closed.
   subroutine open_type(self, type_id, status)
      class(hdf5_source_t), intent(in) :: self
      integer(hid_t), intent(out) :: type_id
      integer, intent(out) :: status

      if (self%is_attribute) then
         call h5aget_type_f(self%id, type_id, status)
      else
         call h5dget_type_f(self%id, type_id, status)
      end if
   end subroutine open_type

   !> How many values a source has; 0 of an empty one, -1 where it is unknown.
   function number_of_values(source) result(number)
      class(hdf5_source_t), intent(in) :: source
      integer(int64) :: number
      integer(hid_t) :: space
      integer(hsize_t) :: points
      integer :: status

      if (source%is_attribute) then
         call h5aget_space_f(source%id, space, status)
      else
         call h5dget_space_f(source%id, space, status)
      end if
      number = -1_int64
      if (status < 0) return
      call h5sget_simple_extent_npoints_f(space, points, status)
      if (status < 0) points = 0_hsize_t   ! to the library's Fortran side no values are a failure
      number = int(points, int64)
      call h5sclose_f(space, status)
   end function number_of_values

   !> Number of dimensions of a source; 0 where it is unknown.
   function rank_of(source) result(rank)
      class(hdf5_source_t), intent(in) :: source
      integer :: rank
      integer(hid_t) :: space
      integer :: status

      rank = 0
      call h5dget_space_f(source%id, space, status)
      if (status < 0) return
      call h5sget_simple_extent_ndims_f(space, rank, status)
      call h5sclose_f(space, status)
   end function rank_of

   !> "found ..., expected ..." where the values of the open dataset `id` lie in other files, or in
   !> chunks that are too large; else empty.
   function fault_of_storage(id) result(fault)
      integer(hid_t), intent(in) :: id
      character(:), allocatable :: fault
      type(hdf5_source_t) :: source
      integer(hid_t) :: properties
      integer(hsize_t), allocatable :: chunk(:)
      real(wp) :: bytes
      integer :: external_files, layout, status

      fault = 'found properties that cannot be read'
      call h5dget_create_plist_f(id, properties, status)
      if (status < 0) return
      external_files = 0
      call h5pget_layout_f(properties, layout, status)
      if (status >= 0 .and. layout /= h5d_virtual_f) call h5pget_external_count_f(properties, &
         external_files, status)
      source%id = id
      ! for another length the library returns garbage
      allocate (chunk(rank_of(source)), source=1_hsize_t)
      if (status >= 0 .and. layout == h5d_chunked_f) call h5pget_chunk_f(properties, size(chunk), &
         chunk, status)
      if (status < 0) return
      call h5pclose_f(properties, status)
      bytes = product(real(chunk, wp))*real(source%value_bytes(), wp)
      fault = ''
      if (layout == h5d_virtual_f) then
         fault = 'found a virtual dataset, expected its values in the file itself'
      else if (external_files > 0) then
         fault = 'found external storage, expected the values in the file itself'
      else if (bytes > real(largest_chunk, wp)) then
         fault = 'found chunks of '//to_text(nint(bytes, int64))//' bytes, expected at most ' &
            //to_text(largest_chunk)
      end if
   end function fault_of_storage

   !> "found ..., expected ..." where a large dataset is declared but not stored: reading it would
   !> take for ever. Else empty.
   function fault_of_size(id) result(fault)
      integer(hid_t), intent(in) :: id
      character(:), allocatable :: fault
      type(hdf5_source_t) :: source
      integer(hsize_t) :: stored
      real(wp) :: bytes
      integer :: status

      fault = ''
      source%id = id
      bytes = real(source%value_bytes(), wp)*real(number_of_values(source), wp)
      call h5dget_storage_size_f(id, stored, status)
      if (status < 0) stored = 0_hsize_t   ! to the library's Fortran side a size of 0 is a failure
      if (bytes > real(large_dataset, wp) .and. bytes/most_packed > real(stored, wp)) fault = &
         'found a dataset of '// &
         to_text(nint(bytes, int64))//' bytes of which the file stores ' &
            //to_text(int(stored, int64))//', expected all of them'
   end function fault_of_size

end module hdf5_source

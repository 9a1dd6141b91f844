!> An open attribute or dataset of an HDF5 file as a source of values: what it holds is compared
!> with what is wanted before anything is read, and must lie in the file itself.
module hdf5_source
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_loc, c_null_char, &
      c_null_ptr, c_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5, only: h5aclose_f, h5aget_space_f, h5aget_type_f, h5aread_f, h5d_chunked_f, &
      h5d_virtual_f, h5dclose_f, h5dget_create_plist_f, h5dget_space_f, h5dget_storage_size_f, &
      h5dget_type_f, h5dread_f, h5dvlen_reclaim_f, h5iget_name_f, h5oclose_f, h5p_default_f, &
      h5pclose_f, h5pget_chunk_f, h5pget_external_count_f, h5pget_layout_f, h5rdereference_f, &
      h5sclose_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
      h5sget_simple_extent_npoints_f, h5t_float_f, h5t_integer_f, h5t_string_f, h5tclose_f, &
      h5t_std_ref_obj, h5tequal_f, h5tget_class_f, h5tget_size_f, h5tis_variable_str_f, &
      h5tvlen_create_f, hid_t, hobj_ref_t_f, hsize_t, hvl_t, size_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: hdf5_source_t, look_at, number_class, text_class

   !> Values that are read: integers or reals of at most 16 bytes; a text of fixed length.
   integer, parameter :: number_class = 1, text_class = 2
   !> Largest number and text [bytes].
   integer(size_t), parameter :: largest_number = 16_size_t, largest_text = 16777216_size_t
   !> Longest text of variable length that is read [bytes].
   integer, parameter :: longest_name = 256
   !> Most lists of references: HDF5 has no more dimensions.
   integer(int64), parameter :: max_lists = 32_int64
   !> Largest chunk: the library holds a whole one [bytes].
   integer(int64), parameter :: largest_chunk = 1073741824_int64
   !> Datasets from this size [bytes] on must be stored; largest ratio of compression by deflate.
   integer(int64), parameter :: large_dataset = 67108864_int64
   real(wp), parameter :: max_packed = 1100.0_wp

   !> An open attribute or dataset.
   type :: hdf5_source_t
      !> Its name in messages: path of the dataset, or the attribute.
      character(:), allocatable :: name
      !> Identifiers of HDF5: of the source itself, and of the type of its values.
      integer(hid_t) :: id = -1_hid_t, type_id = -1_hid_t
      logical, private :: is_attribute = .false.
      !> Bytes of one value.
      integer(size_t) :: bytes = 0_size_t
      !> Number of values; -1 where it is unknown.
      integer(int64) :: values = -1_int64
      !> Extents as Fortran sees them, the fastest first; none for a single value.
      integer(hsize_t), allocatable :: extents(:)
      !> Class of the type in HDF5, and whether it is text of variable length.
      integer, private :: class = -1
      logical :: is_variable = .false.
   contains
      procedure :: fault, fault_of_size, fault_of_storage, read_into, read_reference, read_variable
      procedure :: close => close_source
   end type hdf5_source_t

contains

   !> Looks at what the attribute or dataset `id` holds.
   subroutine look_at(source, id, is_attribute)
      type(hdf5_source_t), intent(inout) :: source
      integer(hid_t), intent(in) :: id
      logical, intent(in) :: is_attribute
      integer(hsize_t), allocatable :: limits(:)
      integer(hsize_t) :: points
      integer(hid_t) :: space
      integer :: rank, status

      source%id = id
      source%is_attribute = is_attribute
      if (is_attribute) then
         call h5aget_space_f(id, space, status)
         call h5aget_type_f(id, source%type_id, status)
      else
         call h5dget_space_f(id, space, status)
         call h5dget_type_f(id, source%type_id, status)
      end if
      if (status >= 0) call h5tget_class_f(source%type_id, source%class, status)
      if (status >= 0) call h5tget_size_f(source%type_id, source%bytes, status)
      if (source%class == h5t_string_f) call h5tis_variable_str_f(source%type_id, &
         source%is_variable, status)
      rank = 0
      call h5sget_simple_extent_ndims_f(space, rank, status)
      allocate (source%extents(max(rank, 0)), limits(max(rank, 0)), source=0_hsize_t)
      if (status < 0) return
      if (rank > 0) call h5sget_simple_extent_dims_f(space, source%extents, limits, status)
      call h5sget_simple_extent_npoints_f(space, points, status)
      if (status < 0) points = 0_hsize_t   ! to the library's Fortran side no values are a failure
      source%values = int(points, int64)
      call h5sclose_f(space, status)
   end subroutine look_at

   !> "found ..., expected ..." unless there are `count` values (below 0: any) of the class.
   function fault(self, class, count)
      class(hdf5_source_t), intent(in) :: self
      integer, intent(in) :: class
      integer(int64), intent(in) :: count
      character(:), allocatable :: fault, found
      logical :: is_number, is_text

      is_number = self%class == h5t_integer_f .or. self%class == h5t_float_f
      is_text = self%class == h5t_string_f
      found = 'something else (a compound, an enumeration, references, ...)'
      if (is_number) found = 'numbers'
      if (is_text) found = 'text'
      fault = ''
      if (class == number_class .and. .not. (is_number .and. self%bytes <= largest_number)) then
         fault = 'found '//found//', expected numbers'
      else if (class == text_class .and. .not. (is_text .and. self%bytes <= largest_text &
         .and. .not. self%is_variable)) then
         fault = 'found '//found//', expected a text of fixed length'
      else if (count >= 0 .and. self%values /= count) then
         fault = 'found '//to_text(self%values)//' values, expected '//to_text(count)
      end if
   end function fault

   !> "found ..., expected ..." where values lie in other files or in too large chunks; else empty.
   function fault_of_storage(self) result(fault)
      class(hdf5_source_t), intent(in) :: self
      character(:), allocatable :: fault
      integer(hid_t) :: properties
      integer(hsize_t) :: chunk(size(self%extents))
      real(wp) :: bytes
      integer :: external_files, layout, status

      fault = 'found properties that cannot be read'
      call h5dget_create_plist_f(self%id, properties, status)
      if (status < 0) return
      external_files = 0
      chunk = 1_hsize_t
      call h5pget_layout_f(properties, layout, status)
      if (status >= 0 .and. layout /= h5d_virtual_f) call h5pget_external_count_f(properties, &
         external_files, status)
      if (status >= 0 .and. layout == h5d_chunked_f) call h5pget_chunk_f(properties, size(chunk), &
         chunk, status)
      if (status < 0) return
      call h5pclose_f(properties, status)
      bytes = product(real(chunk, wp))*real(self%bytes, wp)
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

   !> "found ..., expected ..." where a dataset is too large for what is stored of it; else empty.
   function fault_of_size(self) result(fault)
      class(hdf5_source_t), intent(in) :: self
      character(:), allocatable :: fault
      integer(hsize_t) :: stored
      real(wp) :: bytes
      integer :: status

      fault = ''
      bytes = real(self%bytes, wp)*real(self%values, wp)
      call h5dget_storage_size_f(self%id, stored, status)
      if (status < 0) stored = 0_hsize_t   ! to the library's Fortran side a size of 0 is a failure
      if (bytes > real(large_dataset, wp) .and. bytes/max_packed > real(stored, wp)) fault = &
         'found a dataset of '//to_text(nint(bytes, int64))//' bytes of which the file stores ' &
         //to_text(int(stored, int64))//', expected all of them'
   end function fault_of_size

   !> Reads all values as `type_id` to `place`; `fault` must have checked what is there.
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

   !> Reads a text of variable length of an attribute, cut after `longest_name` bytes.
   subroutine read_variable(self, text, status)
      class(hdf5_source_t), intent(in) :: self
      character(:), allocatable, intent(out) :: text
      integer, intent(out) :: status
      type(c_ptr), target :: address
      type(c_ptr) :: place
      character(kind=c_char), pointer :: bytes(:)
      integer(hid_t) :: space
      integer :: i

      text = ''
      address = c_null_ptr
      place = c_loc(address)
      call h5aread_f(self%id, self%type_id, place, status)
      if (status < 0 .or. .not. c_associated(address)) return
      call c_f_pointer(address, bytes, [longest_name])
      bytes_of_text: do i = 1, longest_name
         if (bytes(i) == c_null_char) exit bytes_of_text
         text = text//bytes(i)
      end do bytes_of_text
      call h5aget_space_f(self%id, space, status)
      place = c_loc(address)
      call h5dvlen_reclaim_f(self%type_id, space, h5p_default_f, place, status)
      call h5sclose_f(space, status)
   end subroutine read_variable

   !> Path of the object of the first reference in list `number` of an attribute (1: the last list).
   !> Empty: it is no such attribute, has no such list or an empty one, or the object no path.
   subroutine read_reference(self, number, path)
      class(hdf5_source_t), intent(in) :: self
      integer, intent(in) :: number
      character(:), allocatable, intent(out) :: path
      type(hvl_t), allocatable, target :: lists(:)
      type(hobj_ref_t_f), pointer :: references(:)
      type(c_ptr) :: place
      character(len=longest_name) :: name
      integer(hid_t) :: list_type, object, space
      integer(size_t) :: length
      integer :: status
      logical :: is_list

      path = ''
      call h5tvlen_create_f(h5t_std_ref_obj, list_type, status)
      if (status < 0) return
      call h5tequal_f(self%type_id, list_type, is_list, status)
      if (status >= 0 .and. is_list .and. number <= self%values .and. self%values <= max_lists) then
         allocate (lists(self%values))
         place = c_loc(lists)
         call h5aread_f(self%id, list_type, place, status)
         if (status >= 0) then
            associate (list => lists(size(lists) + 1 - number))
               if (list%len > 0_size_t) then
                  call c_f_pointer(list%p, references, [1])
                  call h5rdereference_f(self%id, references(1), object, status)
                  if (status >= 0) then
                     call h5iget_name_f(object, name, len(name, kind=size_t), length, status)
                     if (status >= 0 .and. length < longest_name) path = name(:length)
                     call h5oclose_f(object, status)
                  end if
               end if
            end associate
            call h5aget_space_f(self%id, space, status)
            call h5dvlen_reclaim_f(list_type, space, h5p_default_f, place, status)
            call h5sclose_f(space, status)
         end if
      end if
      call h5tclose_f(list_type, status)
   end subroutine read_reference

   !> Closes the source and its type.
   subroutine close_source(self)
      class(hdf5_source_t), intent(in) :: self
      integer :: status

      call h5tclose_f(self%type_id, status)
      if (self%is_attribute) then
         call h5aclose_f(self%id, status)
      else
         call h5dclose_f(self%id, status)
      end if
   end subroutine close_source

end module hdf5_source

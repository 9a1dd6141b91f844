!> An HDF5 file being read: numbers, texts and attributes by their paths, and parts of datasets.
!> What is there is compared with what is wanted before it is read, and must lie in the file.
!>
!> Every return code is checked. The first failure stays in `reader%failure` (kind input_error);
!> what follows it reads nothing, so a caller checks once, at the end.
module hdf5_input
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_loc, c_null_char, c_null_ptr, &
      c_ptr
   use disk_file, only: file_fault
   use errors, only: error_t, fail, input_error
   use hdf5, only: h5_real_kind, h5aexists_by_name_f, h5aget_space_f, h5aget_type_f, &
      h5aopen_by_name_f, h5aread_f, h5d_chunked_f, h5d_virtual_f, h5dget_create_plist_f, &
      h5dget_space_f, h5dget_storage_size_f, h5dget_type_f, h5dopen_f, h5dread_f, &
      h5dvlen_reclaim_f, h5f_acc_rdonly_f, h5fclose_f, h5fis_hdf5_f, h5fopen_f, h5idec_ref_f, &
      h5kind_to_type, h5lexists_f, h5p_default_f, h5pclose_f, h5pget_chunk_f, &
      h5pget_external_count_f, h5pget_layout_f, h5r_object_f, h5rget_name_f, h5s_select_set_f, &
      h5sclose_f, h5screate_simple_f, h5sget_simple_extent_dims_f, h5sget_simple_extent_ndims_f, &
      h5sget_simple_extent_npoints_f, h5sselect_hyperslab_f, h5t_float_f, h5t_integer_f, &
      h5t_native_double, h5t_std_ref_obj, h5t_string_f, h5tclose_f, h5tequal_f, h5tget_class_f, &
      h5tget_size_f, h5tis_variable_str_f, h5tvlen_create_f, hid_t, hsize_t, hvl_t, size_t
   use hdf5_library, only: hdf5_handle_t, text_at
   use kinds, only: int64, wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: hdf5_input_t, hdf5_source_t, is_hdf5, open_hdf5_input

   !> Most numbers that are read at once.
   integer, parameter :: max_values = 268435456
   !> Values that are read: integers or reals of at most 16 bytes; a text of fixed length.
   integer, parameter :: number_class = 1, text_class = 2
   integer(int64), parameter :: any_count = -1_int64
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

   !> An open file for reading.
   type, extends(hdf5_handle_t) :: hdf5_input_t
   contains
      procedure :: content_of, has, has_attribute, read_numbers, read_part, real_value, reals, &
         refuse, scale_of, text, text_of
      procedure :: close => close_reader
   end type hdf5_input_t

   !> What an attribute or dataset holds.
   type :: hdf5_source_t
      !> Its name in messages: path of the dataset, or the attribute.
      character(:), allocatable, private :: name
      !> Identifiers of HDF5: of the source itself, and of the type of its values.
      integer(hid_t), private :: id = -1_hid_t, type_id = -1_hid_t
      logical, private :: is_attribute = .false.
      !> Bytes of one value.
      integer(size_t) :: bytes = 0_size_t
      !> Number of values; -1 where it is unknown.
      integer(int64) :: values = -1_int64
      !> Extents as Fortran sees them, the fastest first; none for a single value.
      integer(hsize_t), allocatable :: extents(:)
      !> Class of the type in HDF5, and whether it is text of variable length.
      integer, private :: class = -1
      logical, private :: is_variable = .false.
   end type hdf5_source_t

contains

   !> Opens `path`. Error: there is no such file, it is a pipe or a device, or it is not HDF5.
   subroutine open_hdf5_input(reader, path, error)
      type(hdf5_input_t), intent(out) :: reader
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      reader%path = path
      reader%kind = input_error
      if (file_fault(path) /= '') then
         call fail(reader%failure, input_error, 'cannot read '//path//': '//file_fault(path))
      else
         call reader%start_hdf5()
         call h5fopen_f(path, h5f_acc_rdonly_f, reader%id, status)
         call reader%check(status, 'opening the file')
         reader%is_open = .not. allocated(reader%failure)
      end if
      if (allocated(reader%failure)) error = reader%failure
   end subroutine open_hdf5_input

   !> Whether there is a file at `path` that is HDF5 by its content.
   logical function is_hdf5(path)
      character(*), intent(in) :: path
      type(hdf5_input_t) :: reader
      integer :: status

      is_hdf5 = .false.
      if (file_fault(path) /= '') return
      reader%path = path
      call reader%start_hdf5()
      if (allocated(reader%failure)) return
      call h5fis_hdf5_f(path, is_hdf5, status)
      is_hdf5 = is_hdf5 .and. status >= 0   ! a file that cannot be read is none
   end function is_hdf5

   !> Keeps "found ..., expected ..." about `name`, unless empty, as the first failure.
   subroutine refuse(self, name, fault)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: name, fault

      if (fault == '' .or. allocated(self%failure)) return
      call fail(self%failure, input_error, 'cannot read '//self%path//' ('//name//'): '//fault)
   end subroutine refuse

   !> Whether the whole path exists.
   logical function has(self, path)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer :: status

      has = .false.
      if (allocated(self%failure)) return
      call h5lexists_f(self%id, trim(path), has, status)   ! status < 0: nor what lies before it
      has = has .and. status >= 0
   end function has

   !> Whether the object at `path` has this `attribute`.
   logical function has_attribute(self, path, attribute) result(has)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, attribute
      integer :: status

      has = .false.
      if (allocated(self%failure)) return
      call h5aexists_by_name_f(self%id, path, attribute, has, status)
      call self%check(status, attribute)
      has = has .and. status >= 0
   end function has_attribute

   !> Opens the dataset `path`, or the `attribute` of the object there, and looks at what it holds;
   !> to be closed unless it fails. A failure: there is none, the values of a dataset lie elsewhere
   !> than in the file, or it has not `count` values of the `class`, where that is asked for.
   subroutine open_source(self, source, path, attribute, class, count)
      type(hdf5_input_t), intent(inout) :: self
      type(hdf5_source_t), intent(out) :: source
      character(*), intent(in) :: path
      character(*), intent(in), optional :: attribute
      integer, intent(in), optional :: class
      integer(int64), intent(in), optional :: count
      integer(hsize_t), allocatable :: limits(:)
      integer(hsize_t) :: points
      integer(hid_t) :: space
      integer :: rank, status

      if (allocated(self%failure)) return
      source%name = path
      source%is_attribute = present(attribute)
      if (source%is_attribute) then
         source%name = attribute
         call h5aopen_by_name_f(self%id, path, attribute, source%id, status)
      else
         call h5dopen_f(self%id, path, source%id, status)
      end if
      call self%check(status, source%name)
      if (allocated(self%failure)) return
      if (source%is_attribute) then
         call h5aget_space_f(source%id, space, status)
         call h5aget_type_f(source%id, source%type_id, status)
      else
         call h5dget_space_f(source%id, space, status)
         call h5dget_type_f(source%id, source%type_id, status)
      end if
      if (status >= 0) call h5tget_class_f(source%type_id, source%class, status)
      if (status >= 0) call h5tget_size_f(source%type_id, source%bytes, status)
      if (source%class == h5t_string_f) call h5tis_variable_str_f(source%type_id, &
         source%is_variable, status)
      rank = 0
      call h5sget_simple_extent_ndims_f(space, rank, status)
      allocate (source%extents(max(rank, 0)), limits(max(rank, 0)), source=0_hsize_t)
      if (status >= 0) then
         if (rank > 0) call h5sget_simple_extent_dims_f(space, source%extents, limits, status)
         call h5sget_simple_extent_npoints_f(space, points, status)
         if (status < 0) points = 0_hsize_t   ! to the library's Fortran side none are a failure
         source%values = int(points, int64)
         call h5sclose_f(space, status)
      end if
      if (.not. source%is_attribute) call self%refuse(path, fault_of_storage(source))
      if (present(count)) call self%refuse(source%name, fault(source, class, count))
      if (allocated(self%failure)) call close_source(source)
   end subroutine open_source

   !> What the dataset at `path` holds, closed again; without extents if it cannot be opened. With
   !> `are_numbers` a failure, too: it holds none, or is too large for what is stored of it.
   function content_of(self, path, are_numbers) result(source)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      logical, intent(in) :: are_numbers
      type(hdf5_source_t) :: source
      integer(hsize_t) :: stored
      real(wp) :: bytes
      integer :: status

      call open_source(self, source, path)
      if (.not. allocated(source%extents)) allocate (source%extents(0))
      if (allocated(self%failure)) return
      if (are_numbers) then
         call self%refuse(path, fault(source, number_class, any_count))
         bytes = real(source%bytes, wp)*real(source%values, wp)
         call h5dget_storage_size_f(source%id, stored, status)
         if (status < 0) stored = 0_hsize_t   ! to the library's Fortran side none is a failure
         if (bytes > real(large_dataset, wp) .and. bytes/max_packed > real(stored, wp)) call &
            self%refuse(path, 'found a dataset of '//to_text(nint(bytes, int64))//' bytes of '// &
            'which the file stores '//to_text(int(stored, int64))//', expected all of them')
      end if
      call close_source(source)
   end function content_of

   !> "found ..., expected ..." unless there are `count` values (below 0: any) of the class.
   function fault(source, class, count)
      type(hdf5_source_t), intent(in) :: source
      integer, intent(in) :: class
      integer(int64), intent(in) :: count
      character(:), allocatable :: fault, found
      logical :: is_number, is_text

      is_number = source%class == h5t_integer_f .or. source%class == h5t_float_f
      is_text = source%class == h5t_string_f
      found = 'something else (a compound, an enumeration, references, ...)'
      if (is_number) found = 'numbers'
      if (is_text) found = 'text'
      fault = ''
      if (class == number_class .and. .not. (is_number .and. source%bytes <= largest_number)) then
         fault = 'found '//found//', expected numbers'
      else if (class == text_class .and. .not. (is_text .and. source%bytes <= largest_text &
         .and. .not. source%is_variable)) then
         fault = 'found '//found//', expected a text of fixed length'
      else if (count >= 0 .and. source%values /= count) then
         fault = 'found '//to_text(source%values)//' values, expected '//to_text(count)
      end if
   end function fault

   !> "found ..., expected ..." where values lie in other files or in too large chunks; else empty.
   function fault_of_storage(source) result(fault)
      type(hdf5_source_t), intent(in) :: source
      character(:), allocatable :: fault
      integer(hid_t) :: properties
      integer(hsize_t) :: chunk(size(source%extents))
      real(wp) :: bytes
      integer :: external_files, layout, status

      fault = 'found properties that cannot be read'
      call h5dget_create_plist_f(source%id, properties, status)
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
      bytes = product(real(chunk, wp))*real(source%bytes, wp)
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

   !> Closes the source and its type.
   subroutine close_source(source)
      type(hdf5_source_t), intent(in) :: source
      integer :: count, status

      call h5idec_ref_f(source%type_id, count, status)
      call h5idec_ref_f(source%id, count, status)
   end subroutine close_source

   !> Reads all values of an open source as `type_id` to `place`, and closes it.
   subroutine read_values(self, source, type_id, place)
      type(hdf5_input_t), intent(inout) :: self
      type(hdf5_source_t), intent(in) :: source
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: place
      type(c_ptr) :: address
      integer :: status

      address = place   ! the argument is intent(inout)
      if (source%is_attribute) then
         call h5aread_f(source%id, type_id, address, status)
      else
         call h5dread_f(source%id, type_id, address, status)
      end if
      call self%check(status, source%name)
      call close_source(source)
   end subroutine read_values

   !> All numbers of a dataset, converted to reals.
   function reals(self, path) result(values)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), allocatable, target :: values(:)
      type(hdf5_source_t) :: source
      integer :: status

      allocate (values(0))
      call open_source(self, source, path, class=number_class, count=any_count)
      if (allocated(self%failure)) return
      if (source%values > max_values) then
         call self%refuse(path, 'found more than '//to_text(max_values)//' values')
      else if (source%values > 0_int64) then
         deallocate (values)
         allocate (values(source%values), source=0.0_wp, stat=status)
         if (status == 0) then
            call read_values(self, source, h5kind_to_type(wp, h5_real_kind), c_loc(values))
            return
         end if
         call self%refuse(path, 'found '//to_text(source%values)//' values, for which there '// &
            'is no memory')
         allocate (values(0))
      end if
      call close_source(source)
   end function reals

   !> The number of a dataset or attribute that holds one; `default` if there is no such attribute.
   function real_value(self, path, attribute, default) result(value)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(*), intent(in), optional :: attribute
      real(wp), intent(in), optional :: default
      real(wp), target :: value

      value = 0.0_wp
      if (present(default)) then
         value = default
         if (.not. self%has_attribute(path, attribute)) return
      end if
      call self%read_numbers(path, 1_int64, h5kind_to_type(wp, h5_real_kind), c_loc(value), &
         attribute)
   end function real_value

   !> Reads all numbers of a dataset or attribute, which must be `count`, as `type_id` to `place`.
   subroutine read_numbers(self, path, count, type_id, place, attribute)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(int64), intent(in) :: count
      integer(hid_t), intent(in) :: type_id
      type(c_ptr), intent(in) :: place
      character(*), intent(in), optional :: attribute
      type(hdf5_source_t) :: source

      call open_source(self, source, path, attribute, number_class, count)
      if (.not. allocated(self%failure)) call read_values(self, source, type_id, place)
   end subroutine read_numbers

   !> The text of a dataset or attribute, of fixed length, without null characters behind.
   function text(self, path, attribute)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(*), intent(in), optional :: attribute
      character(:), allocatable :: text
      type(hdf5_source_t) :: source
      character(kind=c_char, len=:), allocatable, target :: buffer

      text = ''
      call open_source(self, source, path, attribute, text_class, 1_int64)
      if (allocated(self%failure)) return
      allocate (character(len=source%bytes) :: buffer)
      call read_values(self, source, source%type_id, c_loc(buffer))
      if (.not. allocated(self%failure)) text = buffer(:verify(buffer, c_null_char, back=.true.))
   end function text

   !> The text of the `attribute` of the object at `path`, of any length; empty if it is not one.
   function text_of(self, path, attribute) result(text)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path, attribute
      character(:), allocatable :: text
      type(hdf5_source_t) :: source
      type(c_ptr), target :: address
      type(c_ptr) :: place
      integer(hid_t) :: space
      integer :: status
      logical :: is_fixed

      text = ''
      if (.not. self%has_attribute(path, attribute)) return
      call open_source(self, source, path, attribute)
      if (allocated(self%failure)) return
      is_fixed = fault(source, text_class, 1_int64) == ''
      if (source%values == 1_int64 .and. source%is_variable) then
         address = c_null_ptr
         place = c_loc(address)
         call h5aread_f(source%id, source%type_id, place, status)
         call self%check(status, attribute)
         if (status >= 0 .and. c_associated(address)) then
            text = text_at(address, longest_name)
            call h5aget_space_f(source%id, space, status)
            call h5dvlen_reclaim_f(source%type_id, space, h5p_default_f, place, status)
            call h5sclose_f(space, status)
         end if
      end if
      call close_source(source)
      if (is_fixed) text = trim(self%text(path, attribute))
   end function text_of

   !> Path of the first scale in the list of a `dimension` (1: the fastest) of a dataset, or empty.
   function scale_of(self, path, dimension) result(scale)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer, intent(in) :: dimension
      character(:), allocatable :: scale
      type(hdf5_source_t) :: source
      type(hvl_t), allocatable, target :: lists(:)
      type(c_ptr) :: place
      character(len=longest_name) :: name
      integer(hid_t) :: list_type, space
      integer(size_t) :: length
      integer :: status
      logical :: are_lists

      scale = ''
      if (.not. self%has_attribute(path, 'DIMENSION_LIST')) return
      call open_source(self, source, path, 'DIMENSION_LIST')
      if (allocated(self%failure)) return
      call h5tvlen_create_f(h5t_std_ref_obj, list_type, status)
      call h5tequal_f(source%type_id, list_type, are_lists, status)
      if (status >= 0 .and. are_lists .and. dimension <= source%values &
         .and. source%values <= max_lists) then
         allocate (lists(source%values))
         place = c_loc(lists)
         call h5aread_f(source%id, list_type, place, status)
         if (status >= 0) then
            associate (list => lists(size(lists) + 1 - dimension))
               if (list%len > 0_size_t) call h5rget_name_f(source%id, h5r_object_f, list%p, name, &
                  status, length)
               if (list%len > 0_size_t .and. status >= 0 .and. length < longest_name) scale = &
                  name(:length)
            end associate
            call h5aget_space_f(source%id, space, status)
            call h5dvlen_reclaim_f(list_type, space, h5p_default_f, place, status)
            call h5sclose_f(space, status)
         end if
      end if
      call h5tclose_f(list_type, status)
      call close_source(source)
   end function scale_of

   !> Closes the file; twice does nothing.
   subroutine close_reader(self, error)
      class(hdf5_input_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer :: status

      if (self%is_open) call h5fclose_f(self%id, status)
      self%is_open = .false.
      if (allocated(self%failure)) error = self%failure
   end subroutine close_reader

   !> Numbers of `dataset` as stored, from `offset` on, `extents` of them along each dimension.
   subroutine read_part(self, dataset, offset, extents, z)
      class(hdf5_input_t), intent(inout) :: self
      character(*), intent(in) :: dataset
      integer(int64), intent(in) :: offset(2)
      integer(hsize_t), intent(in) :: extents(2)
      real(wp), contiguous, target, intent(out) :: z(:)
      type(hdf5_source_t) :: source
      integer(hid_t) :: file_space, memory_space
      type(c_ptr) :: place
      integer :: status

      place = c_loc(z)
      call open_source(self, source, dataset)
      if (allocated(self%failure)) return
      call h5dget_space_f(source%id, file_space, status)
      call self%check(status, dataset)
      call h5sselect_hyperslab_f(file_space, h5s_select_set_f, int(offset, hsize_t), extents, &
         status)
      call self%check(status, dataset//': fewer nodes than before')
      call h5screate_simple_f(1, [size(z, kind=hsize_t)], memory_space, status)
      call self%check(status, dataset)
      if (.not. allocated(self%failure)) then
         call h5dread_f(source%id, h5t_native_double, place, status, memory_space, file_space)
         call self%check(status, dataset//' as real numbers')
      end if
      call h5sclose_f(memory_space, status)
      call h5sclose_f(file_space, status)
      call close_source(source)
   end subroutine read_part

end module hdf5_input

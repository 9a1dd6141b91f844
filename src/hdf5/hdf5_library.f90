!> Start of the HDF5 library, what all files that are written share, made once a process, and the
!> first failure of a series of calls, with its reason from the error stack of the library.
module hdf5_library
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_pointer, c_funloc, c_funptr, &
      c_int, c_int64_t, c_loc, c_null_char, c_ptr
   use c_library, only: c_setenv
   use errors, only: error_t, fail, input_error, output_error
   use hdf5, only: h5d_compact_f, h5dont_atexit_f, h5eset_auto_f, h5f_close_strong_f, &
      h5f_libver_earliest_f, h5f_libver_latest_f, h5open_f, h5p_dataset_create_f, &
      h5p_file_access_f, h5p_link_create_f, h5pcopy_f, h5pcreate_f, h5pset_create_inter_group_f, &
      h5pset_fclose_degree_f, h5pset_layout_f, h5pset_libver_bounds_f, h5pset_obj_track_times_f, &
      h5s_scalar_f, h5screate_f, h5t_c_s1, h5t_cset_utf8_f, h5t_str_nullpad_f, h5tclose_f, &
      h5tcopy_f, h5tset_cset_f, h5tset_size_f, h5tset_strpad_f, hid_t, size_t
   implicit none (type, external)
   private

   public :: text_at

   !> Longest string whose type is kept for the next string of its length.
   integer, parameter :: longest_kept = 256

   !> A file that is written or, with `kind` = input_error, read.
   type, public :: hdf5_handle_t
      !> Its name as given.
      character(:), allocatable :: path
      !> The first thing that went wrong, and the kind of such errors.
      type(error_t), allocatable :: failure
      integer :: kind = output_error
      !> Identifier of HDF5.
      integer(hid_t) :: id = -1_hid_t
      logical :: is_open = .false.
   contains
      procedure :: check, start_hdf5, string_type
   end type hdf5_handle_t

   !> What all files share that are written: properties of files; of links, where groups above are
   !> made as well; of datasets, and of small ones, whose values stand in their header.
   integer(hid_t), protected, public :: file_access = -1_hid_t, link_creation = -1_hid_t, &
      creation = -1_hid_t, small_creation = -1_hid_t
   !> The dataspace of one value.
   integer(hid_t), protected, public :: scalar_space = -1_hid_t

   !> H5L_TYPE_EXTERNAL.
   integer(c_int), parameter :: external_link = 64_c_int

   !> H5E_DEFAULT: the error stack of this thread.
   integer(c_int64_t), parameter :: default_stack = 0_c_int64_t
   !> H5E_WALK_UPWARD: the most specific entry first.
   integer(c_int), parameter :: walk_upward = 0_c_int
   !> Longest description that is read.
   integer, parameter :: max_length = 2000

   !> H5E_error2_t: one entry of the stack.
   type, bind(c) :: stack_entry_t
      integer(c_int64_t) :: class_id, major_id, minor_id
      integer(c_int) :: line
      type(c_ptr) :: function_name, file_name, description
   end type stack_entry_t

   interface
      !> Calls `visit` for every entry of the error stack.
      integer(c_int) function h5ewalk2(stack, direction, visit, client) bind(c, name='H5Ewalk2')
         import :: c_funptr, c_int, c_int64_t, c_ptr
         implicit none (type, external)
         integer(c_int64_t), value :: stack
         integer(c_int), value :: direction
         type(c_funptr), value :: visit
         type(c_ptr), value :: client
      end function h5ewalk2

      !> Removes the class of links, so that they cannot be followed.
      integer(c_int) function h5lunregister(class) bind(c, name='H5Lunregister')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: class
      end function h5lunregister
   end interface

contains

   !> Starts the library, however often it is called: it prints nothing, and it locks no files
   !> (`lock_t` does that, once for a whole run; the library's own locks would be in its way).
   !> Makes what all files share that are written. Only the first call does anything: a second
   !> h5open_f returns a status at random in some versions (1.10.10).
   subroutine start_hdf5(self)
      class(hdf5_handle_t), intent(inout) :: self
      integer :: ignored, status

      if (scalar_space >= 0_hid_t) return
      status = c_setenv('HDF5_USE_FILE_LOCKING'//c_null_char, 'FALSE'//c_null_char, 1_c_int)
      call h5dont_atexit_f(ignored)       ! at its end the library would write a failed file again
      call h5open_f(status)
      if (status >= 0) call h5eset_auto_f(0, status)
      if (status >= 0) status = h5lunregister(external_link)   ! a file does not lead into others
      if (status >= 0) call h5pcreate_f(h5p_file_access_f, file_access, status)
      if (status >= 0) call h5pset_fclose_degree_f(file_access, h5f_close_strong_f, status)
      if (status >= 0) call h5pset_libver_bounds_f(file_access, h5f_libver_earliest_f, &
         h5f_libver_latest_f, status)
      if (status >= 0) call h5pcreate_f(h5p_link_create_f, link_creation, status)
      if (status >= 0) call h5pset_create_inter_group_f(link_creation, 1, status)
      if (status >= 0) call h5pcreate_f(h5p_dataset_create_f, creation, status)
      if (status >= 0) call h5pset_obj_track_times_f(creation, .false., status)
      if (status >= 0) call h5pcopy_f(creation, small_creation, status)
      if (status >= 0) call h5pset_layout_f(small_creation, h5d_compact_f, status)
      if (status >= 0) call h5screate_f(h5s_scalar_f, scalar_space, status)
      call self%check(status, 'starting the HDF5 library')
   end subroutine start_hdf5

   !> The type of UTF-8 strings of `length` > 0 bytes, to be left open; undefined after a failure.
   function string_type(self, length) result(type_id)
      class(hdf5_handle_t), intent(inout) :: self
      integer, intent(in) :: length
      integer(hid_t) :: type_id
      !> Types by their length; at 0 that of the last string that was longer.
      integer(hid_t), save :: types(0:longest_kept) = -1_hid_t
      integer :: slot, status

      slot = merge(length, 0, length <= longest_kept)
      type_id = types(slot)
      status = 0
      if (slot > 0 .and. type_id >= 0_hid_t) return
      if (type_id >= 0_hid_t) call h5tclose_f(type_id, status)
      if (status >= 0) call h5tcopy_f(h5t_c_s1, type_id, status)
      if (status >= 0) call h5tset_size_f(type_id, int(length, size_t), status)
      if (status >= 0) call h5tset_strpad_f(type_id, h5t_str_nullpad_f, status)
      if (status >= 0) call h5tset_cset_f(type_id, h5t_cset_utf8_f, status)
      types(slot) = merge(type_id, -1_hid_t, status >= 0)
      call self%check(status, 'string type')
   end function string_type

   !> Keeps the first failure: `status` < 0 while `doing`.
   subroutine check(self, status, doing)
      class(hdf5_handle_t), intent(inout) :: self
      integer, intent(in) :: status
      character(*), intent(in) :: doing
      character(:), allocatable :: reason
      character(len=*), parameter :: marker = "error message = '"
      character(len=max_length), target :: description
      integer(c_int) :: walked
      integer :: start, length

      if (status >= 0 .or. allocated(self%failure)) return
      ! the system's words ('No space left on device') where passed on, else the library's, or ''
      description = ''
      walked = h5ewalk2(default_stack, walk_upward, c_funloc(keep_first), c_loc(description))
      reason = ''
      if (walked >= 0) reason = trim(description)
      start = index(reason, marker)
      if (start > 0) then
         reason = reason(start + len(marker):)
         length = index(reason, "'") - 1
         if (length > 0) reason = reason(:length)
      end if
      if (len(reason) > 0) reason = ': ' // reason
      call fail(self%failure, self%kind, 'cannot '//trim(merge('read ', 'write', self%kind &
         == input_error))//' '//self%path//' ('//doing//')'//reason)
   end subroutine check

   !> Keeps the description of stack entry 0, the most specific one; returns 0 = go on.
   function keep_first(number, entry, client) bind(c) result(status)
      integer(c_int), value :: number
      type(stack_entry_t), intent(in) :: entry
      type(c_ptr), value :: client
      integer(c_int) :: status
      character(len=max_length), pointer :: kept

      status = 0_c_int
      if (number /= 0_c_int .or. .not. c_associated(entry%description)) return
      call c_f_pointer(client, kept)
      kept = text_at(entry%description, max_length)
   end function keep_first

   !> The C string at `address`, cut after the `longest` bytes that are read.
   function text_at(address, longest) result(text)
      type(c_ptr), intent(in) :: address
      integer, intent(in) :: longest
      character(:), allocatable :: text
      character(kind=c_char), pointer :: bytes(:)
      integer :: i

      call c_f_pointer(address, bytes, [longest])
      text = ''
      do i = 1, longest
         if (bytes(i) == c_null_char) return
         text = text//bytes(i)
      end do
   end function text_at

end module hdf5_library

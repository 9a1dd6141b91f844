!> Start of the HDF5 library, shared by all modules that use it, and what all files that are written
!> have in common: made once in a process.
module hdf5_library
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char
   use c_library, only: c_setenv
   use hdf5, only: h5d_compact_f, h5dont_atexit_f, h5eset_auto_f, h5f_close_strong_f, &
      h5f_libver_earliest_f, h5f_libver_latest_f, h5open_f, h5p_dataset_create_f, &
      h5p_file_access_f, h5p_link_create_f, h5pcreate_f, h5pset_create_inter_group_f, &
      h5pset_fclose_degree_f, h5pset_layout_f, h5pset_libver_bounds_f, h5pset_obj_track_times_f, &
      h5s_scalar_f, h5screate_f, h5t_c_s1, h5t_cset_utf8_f, h5t_str_nullpad_f, h5tclose_f, &
      h5tcopy_f, h5tset_cset_f, h5tset_size_f, h5tset_strpad_f, hid_t, size_t
   implicit none (type, external)
   private

   public :: get_string_type, shared_hdf5, start_hdf5

   !> Longest string whose type is kept for the next string of its length.
   integer, parameter :: longest_kept = 256

   !> HDF5 identifiers that all files share; they are never closed.
   type, public :: hdf5_shared_t
      !> Properties of files that are created.
      integer(hid_t) :: access = -1_hid_t
      !> Properties of new links: groups above are made as well.
      integer(hid_t) :: link_creation = -1_hid_t
      !> Properties of new datasets, and of small ones, whose values stand in their header.
      integer(hid_t) :: creation = -1_hid_t
      integer(hid_t) :: small_creation = -1_hid_t
      !> The dataspace of one value.
      integer(hid_t) :: scalar_space = -1_hid_t
   end type hdf5_shared_t

   !> The library has been started in this process.
   logical :: is_started = .false.
   !> Made when the first file is written.
   type(hdf5_shared_t) :: shared

   !> H5L_TYPE_EXTERNAL.
   integer(c_int), parameter :: external_link = 64_c_int

   interface
      !> Removes the class of links, so that they cannot be followed.
      function h5lunregister(class) bind(c, name='H5Lunregister') result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: class
         integer(c_int) :: status
      end function h5lunregister
   end interface

contains

   !> Starts the library, however often it is called: it prints nothing, and it locks no files
   !> (`lock_t` does that, once for a whole run; the library's own locks would be in its way).
   !> `status` < 0: it cannot be started. Only the first call does anything: a second h5open_f
   !> returns a status at random in some versions (1.10.10).
   subroutine start_hdf5(status)
      integer, intent(out) :: status
      integer :: ignored

      status = 0
      if (is_started) return
      status = c_setenv('HDF5_USE_FILE_LOCKING'//c_null_char, 'FALSE'//c_null_char, 1_c_int)
      call h5dont_atexit_f(ignored)       ! at its end the library would write a failed file again
      call h5open_f(status)
      if (status >= 0) call h5eset_auto_f(0, status)
      if (status >= 0) status = h5lunregister(external_link)   ! a file does not lead into others
      is_started = status >= 0
   end subroutine start_hdf5

   !> What all files share; `status` < 0: it cannot be made.
   subroutine shared_hdf5(given, status)
      type(hdf5_shared_t), intent(out) :: given
      integer, intent(out) :: status

      status = 0
      if (shared%scalar_space < 0_hid_t) then
         call h5pcreate_f(h5p_file_access_f, shared%access, status)
         if (status >= 0) call h5pset_fclose_degree_f(shared%access, h5f_close_strong_f, status)
         if (status >= 0) call h5pset_libver_bounds_f(shared%access, h5f_libver_earliest_f, &
            h5f_libver_latest_f, status)
         if (status >= 0) call h5pcreate_f(h5p_link_create_f, shared%link_creation, status)
         if (status >= 0) call h5pset_create_inter_group_f(shared%link_creation, 1, status)
         if (status >= 0) call new_properties(shared%creation, status)
         if (status >= 0) call new_properties(shared%small_creation, status)
         if (status >= 0) call h5pset_layout_f(shared%small_creation, h5d_compact_f, status)
         if (status >= 0) call h5screate_f(h5s_scalar_f, shared%scalar_space, status)
      end if
      given = shared
   end subroutine shared_hdf5

   !> Properties of a new dataset: without a time stamp; `status` < 0: failed.
   subroutine new_properties(properties, status)
      integer(hid_t), intent(out) :: properties
      integer, intent(out) :: status

      call h5pcreate_f(h5p_dataset_create_f, properties, status)
      if (status >= 0) call h5pset_obj_track_times_f(properties, .false., status)
   end subroutine new_properties

   !> The type of UTF-8 strings of `length` > 0 bytes, to be left open; `status` < 0: failed.
   subroutine get_string_type(length, type_id, status)
      integer, intent(in) :: length
      integer(hid_t), intent(out) :: type_id
      integer, intent(out) :: status
      !> Types by their length; at 0 that of the last string that was longer.
      integer(hid_t), save :: types(0:longest_kept) = -1_hid_t
      integer :: slot

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
   end subroutine get_string_type

end module hdf5_library

!> Start of the HDF5 library, shared by all modules that use it.
module hdf5_library
   use, intrinsic :: iso_c_binding, only: c_int
   use hdf5, only: h5dont_atexit_f, h5eset_auto_f, h5open_f
   use operating_system, only: set_environment
   implicit none (type, external)
   private

   public :: start_hdf5

   !> The library has been started in this process.
   logical :: is_started = .false.

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
      call set_environment('HDF5_USE_FILE_LOCKING', 'FALSE')
      call h5dont_atexit_f(ignored)       ! at its end the library would write a failed file again
      call h5open_f(status)
      if (status >= 0) call h5eset_auto_f(0, status)
      if (status >= 0) status = h5lunregister(external_link)   ! a file does not lead into others
      is_started = status >= 0
   end subroutine start_hdf5

end module hdf5_library

!> What this machine and the limits of this process leave to a case (Linux): memory, stack, processors.
module system_limits
   use, intrinsic :: iso_c_binding, only: c_int, c_long
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: available_memory, check_stack, memory_fault, processors

   !> struct rlimit: what counts, and up to where that may be raised; below 0: unlimited.
   type, bind(c) :: limit_t
      integer(c_long) :: present_value = 0_c_long, largest = 0_c_long
   end type limit_t

   !> RLIMIT_STACK, RLIMIT_AS; _SC_PAGESIZE, _SC_NPROCESSORS_ONLN, _SC_PHYS_PAGES.
   integer(c_int), parameter :: limit_stack = 3_c_int, limit_memory = 9_c_int
   integer(c_int), parameter :: page_size = 30_c_int, online_processors = 84_c_int, pages = 85_c_int
   !> Stack that the program needs [bytes].
   integer(c_long), parameter :: least_stack = 1048576_c_long

   interface
      !> getrlimit(2).
      function c_getrlimit(resource, limit) bind(c, name='getrlimit') result(status)
         import :: c_int, limit_t
         implicit none (type, external)
         integer(c_int), value :: resource
         type(limit_t), intent(inout) :: limit
         integer(c_int) :: status
      end function c_getrlimit

      !> setrlimit(2).
      function c_setrlimit(resource, limit) bind(c, name='setrlimit') result(status)
         import :: c_int, limit_t
         implicit none (type, external)
         integer(c_int), value :: resource
         type(limit_t), intent(in) :: limit
         integer(c_int) :: status
      end function c_setrlimit

      !> sysconf(3).
      function c_sysconf(name) bind(c, name='sysconf') result(value)
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_int), value :: name
         integer(c_long) :: value
      end function c_sysconf
   end interface

contains

   !> Physical memory, or the limit of the address space where that is less [bytes].
   function available_memory() result(bytes)
      real(wp) :: bytes
      type(limit_t) :: limit

      bytes = real(c_sysconf(pages), wp)*real(c_sysconf(page_size), wp)
      if (.not. bytes > 0.0_wp) bytes = huge(bytes)
      if (c_getrlimit(limit_memory, limit) /= 0_c_int) return
      if (limit%present_value >= 0_c_long) bytes = min(bytes, real(limit%present_value, wp))
   end function available_memory

   !> "found ..., expected ..." for a case that needs more `bytes` than there are; empty if there are enough.
   function memory_fault(bytes) result(fault)
      real(wp), intent(in) :: bytes
      character(:), allocatable :: fault

      fault = ''
      if (bytes > available_memory()) fault = 'found a grid that needs at least '//megabytes(bytes)//' of memory, expected at '// &
         'most '//megabytes(available_memory())//', the memory of this machine or its limit (ulimit -v)'
   end function memory_fault

   !> Bytes in words.
   function megabytes(bytes) result(words)
      real(wp), intent(in) :: bytes
      character(:), allocatable :: words

      words = to_text(bytes/1.0e6_wp, 4)//' MB'
   end function megabytes

   !> Processors that work, at least 1.
   function processors() result(number)
      integer :: number

      number = max(int(c_sysconf(online_processors)), 1)
   end function processors

   !> Raises a stack that is too small. Error (input_error): it must not be raised.
   subroutine check_stack(error)
      type(error_t), allocatable, intent(out) :: error
      type(limit_t) :: limit

      if (c_getrlimit(limit_stack, limit) /= 0_c_int) return
      if (limit%present_value < 0_c_long .or. limit%present_value >= least_stack) return
      if (limit%largest < 0_c_long .or. limit%largest >= least_stack) then
         limit%present_value = least_stack
         if (c_setrlimit(limit_stack, limit) == 0_c_int) return
      end if
      call fail(error, input_error, 'found a stack of '//to_text(int(limit%present_value/1024_c_long))//' kB, expected at '// &
         'least '//to_text(int(least_stack/1024_c_long))//' kB (ulimit -s)')
   end subroutine check_stack

end module system_limits

!> What a case may use of this machine, within the limits of this process (Linux): memory, stack,
!> processors.
module system_limits
   use, intrinsic :: iso_c_binding, only: c_int, c_long
   use, intrinsic :: iso_fortran_env, only: int64
   use control_group, only: group_memory
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use number_text, only: read_integer
   use operating_system, only: set_environment, start_again
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_stack, memory_fault, processors, settle_memory, thread_memory

   !> Memory that is written to, and address space that is taken, used or not [bytes].
   type, public :: memory_t
      real(wp) :: used = 0.0_wp, reserved = 0.0_wp
   end type memory_t

   !> What the program itself takes, and its libraries for it, without a grid [bytes].
   real(wp), parameter, public :: of_program = 16.0e6_wp

   !> struct rlimit: what counts, and up to where that may be raised; below 0: unlimited.
   type, bind(c) :: limit_t
      integer(c_long) :: present_value = 0_c_long, largest = 0_c_long
   end type limit_t

   !> RLIMIT_DATA, RLIMIT_STACK, RLIMIT_AS; _SC_PAGESIZE, _SC_NPROCESSORS_ONLN, _SC_PHYS_PAGES.
   integer(c_int), parameter :: limit_data = 2_c_int, limit_stack = 3_c_int, limit_memory = 9_c_int
   integer(c_int), parameter :: page_size = 30_c_int, online_processors = 84_c_int, pages = 85_c_int
   !> M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX of mallopt(3).
   integer(c_int), parameter :: trim_threshold = -1_c_int, mmap_threshold = -3_c_int, &
      max_arenas = -8_c_int
   !> Blocks below this size [bytes] may come from memory that was freed.
   integer(c_int), parameter :: large_block = 1073741824_c_int
   !> Stack of a thread where that of the process is unlimited [bytes].
   real(wp), parameter :: usual_stack = 2097152.0_wp
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

      !> mallopt(3) of the GNU C library.
      function c_mallopt(parameter, value) bind(c, name='mallopt') result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: parameter, value
         integer(c_int) :: status
      end function c_mallopt

      !> sysconf(3).
      function c_sysconf(name) bind(c, name='sysconf') result(value)
         import :: c_int, c_long
         implicit none (type, external)
         integer(c_int), value :: name
         integer(c_long) :: value
      end function c_sysconf
   end interface

contains

   !> "found ..., expected ..." for something, `what`, that needs more memory than there is; empty
   !> if there is enough. Physical memory, that of the control group, address space, data: each has
   !> its limit.
   function memory_fault(what, need) result(fault)
      character(*), intent(in) :: what
      type(memory_t), intent(in) :: need
      character(:), allocatable :: fault

      fault = ''
      call compare(need%used, real(c_sysconf(pages), wp)*real(c_sysconf(page_size), wp), &
         'the memory of this machine')
      call compare(need%used, own_group_memory(), 'the limit of its control group')
      call compare(need%reserved, limit_of(limit_data), 'the limit of data (ulimit -d)')
      if (limit_of(limit_memory) < huge(1.0_wp)) call compare(need%reserved, &
         limit_of(limit_memory) - library_memory(), &
         'what the limit of the address space (ulimit -v) leaves beside the libraries')

   contains

      !> Reports the first limit that is too low.
      subroutine compare(bytes, most, name)
         real(wp), intent(in) :: bytes, most
         character(*), intent(in) :: name

         if (fault == '' .and. bytes > most) fault = 'found '//what//' that needs up to ' &
            //megabytes(bytes)// &
            ' of memory, expected at most '//megabytes(max(most, 0.0_wp))//', '//name
      end subroutine compare

   end function memory_fault

   !> `group_memory` of this process as it was when first asked for: some ten files [bytes].
   function own_group_memory() result(bytes)
      real(wp) :: bytes
      real(wp), save :: kept = -1.0_wp

      if (kept < 0.0_wp) kept = group_memory('')
      bytes = kept
   end function own_group_memory

   !> The value of a limit [bytes]; huge: none.
   function limit_of(resource) result(bytes)
      integer(c_int), intent(in) :: resource
      real(wp) :: bytes
      type(limit_t) :: limit

      bytes = huge(bytes)
      if (c_getrlimit(resource, limit) /= 0_c_int) return
      if (limit%present_value >= 0_c_long) bytes = real(limit%present_value, wp)
   end function limit_of

   !> Address space of the program and its libraries, without what they have allocated [bytes]; 0:
   !> not known.
   function library_memory() result(bytes)
      real(wp) :: bytes
      character(len=200) :: line
      integer :: status, unit
      integer(int64) :: numbers(6)

      bytes = 0.0_wp
      open (newunit=unit, file='/proc/self/statm', action='read', status='old', iostat=status)
      if (status /= 0) return
      ! pages: all, resident, shared, code, 0, data and stack
      read (unit, '(a)', iostat=status) line
      if (status == 0) call split_integers(line, numbers, status)
      if (status == 0) bytes = real(numbers(1) - numbers(6), wp)*real(c_sysconf(page_size), wp)
      close (unit, iostat=status)
   end function library_memory

   !> Reads integers with blanks between them; `status` is not 0 if there are fewer.
   pure subroutine split_integers(line, numbers, status)
      character(*), intent(in) :: line
      integer(int64), intent(out) :: numbers(:)
      integer, intent(out) :: status
      logical :: good
      integer :: blank, i, start

      numbers = 0
      status = 1
      start = 1
      do i = 1, size(numbers)
         blank = start + index(line(start:)//' ', ' ') - 1
         call read_integer(line(start:blank - 1), numbers(i), good)
         if (.not. good) return
         start = min(blank + 1, len(line))
      end do
      status = 0
   end subroutine split_integers

   !> Prepares the libraries. Freed memory is kept for the next block: given back to the system,
   !> each page of it would be cleared again, a fifth of the time of a large area. With a limit of
   !> address space or data it is not kept. There OpenBLAS takes 134 MB a thread when it is loaded
   !> and hangs if it gets none: the program starts again with one thread of it. The C library takes
   !> 64 MB of address space a thread: one pool does for all. Error (input_error): there is no room
   !> even for the program.
   subroutine settle_memory(error)
      type(error_t), allocatable, intent(out) :: error
      character(len=8) :: threads
      character(:), allocatable :: fault
      integer(c_int) :: status

      if (min(limit_of(limit_data), limit_of(limit_memory)) >= huge(1.0_wp)) then
         status = c_mallopt(mmap_threshold, large_block)
         status = c_mallopt(trim_threshold, -1_c_int)   ! never given back
         return
      end if
      call get_environment_variable('OPENBLAS_NUM_THREADS', threads)
      if (threads /= '1') then
         call set_environment('OPENBLAS_NUM_THREADS', '1')
         call start_again()
      end if
      status = c_mallopt(max_arenas, 1_c_int)
      fault = memory_fault('a program', memory_t(0.0_wp, of_program))
      if (fault /= '') call fail(error, input_error, fault)
   end subroutine settle_memory

   !> Address space that `threads` threads of the program take beside that of the first [bytes].
   function thread_memory(threads) result(bytes)
      integer, intent(in) :: threads
      real(wp) :: bytes

      bytes = limit_of(limit_stack)
      if (bytes >= huge(bytes)) bytes = usual_stack
      bytes = (threads - 1)*bytes
   end function thread_memory

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
      call fail(error, input_error, 'found a stack of ' &
         //to_text(int(limit%present_value/1024_c_long))//' kB, expected at '// &
         'least '//to_text(int(least_stack/1024_c_long))//' kB (ulimit -s)')
   end subroutine check_stack

end module system_limits

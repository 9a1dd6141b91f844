!> How much memory this process has had (Linux), and that it keeps what it frees (glibc).
module process_memory
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_procpointer, c_funptr, c_int
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use number_text, only: read_integer
   use program_symbol, only: address_of
   implicit none (type, external)
   private

   public :: keep_freed_memory, peak_memory

   !> M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of mallopt(3).
   integer(c_int), parameter :: trim_threshold = -1_c_int, mmap_threshold = -3_c_int
   !> Blocks below this size [bytes] come from memory that was freed, if there is some.
   integer(c_int), parameter :: large_block = 1073741824_c_int

   abstract interface
      !> mallopt(3); 0: refused.
      function mallopt_interface(parameter, value) bind(c) result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: parameter, value
         integer(c_int) :: status
      end function mallopt_interface
   end interface

contains

   !> Asks the C library to keep freed memory for the next blocks instead of giving it back to the
   !> system, which clears every page again when it is touched: a third of the time of a large
   !> area. Without glibc nothing happens.
   subroutine keep_freed_memory()
      procedure(mallopt_interface), pointer :: mallopt
      type(c_funptr) :: address
      integer(c_int) :: status

      address = address_of('mallopt')
      if (.not. c_associated(address)) return
      call c_f_procpointer(address, mallopt)
      status = mallopt(mmap_threshold, large_block)
      if (status /= 0_c_int) status = mallopt(trim_threshold, -1_c_int)   ! -1: never
   end subroutine keep_freed_memory

   !> Most physical memory of the process at one time so far [bytes], all of its cases together; 0:
   !> not known.
   function peak_memory() result(bytes)
      real(wp) :: bytes
      character(len=*), parameter :: label = 'VmHWM:', unit_name = 'kB', digits = '0123456789'
      character(len=200) :: line
      integer(int64) :: kilobytes
      logical :: is_good
      integer :: status, unit

      bytes = 0.0_wp
      open (newunit=unit, file='/proc/self/status', action='read', status='old', iostat=status)
      if (status /= 0) return
      do while (status == 0)
         read (unit, '(a)', iostat=status) line
         if (status /= 0 .or. index(line, label) /= 1) cycle
         line = line(scan(line, digits):)
         call read_integer(trim(line(:index(line, unit_name) - 1)), kilobytes, is_good)
         if (is_good) bytes = 1024*real(kilobytes, wp)
         exit
      end do
      close (unit)
   end function peak_memory

end module process_memory

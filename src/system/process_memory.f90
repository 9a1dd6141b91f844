!> How much memory this process has had (Linux).
module process_memory
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use number_text, only: read_integer
   implicit none (type, external)
   private

   public :: peak_memory

contains

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

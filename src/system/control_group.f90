!> The memory limit of this process by its control groups (Linux, cgroups(7)), as batch systems and
!> containers set them.
module control_group
   use kinds, only: wp
   use number_text, only: read_real
   implicit none (type, external)
   private

   public :: group_memory

   !> A path or a line of these files at most.
   integer, parameter :: longest_line = 4096

contains

   !> The least limit of the group of this process and of those around it, version 1 and 2 [bytes];
   !> huge: none. `root` stands before /proc and /sys.
   function group_memory(root) result(bytes)
      character(*), intent(in) :: root
      real(wp) :: bytes
      character(len=longest_line) :: line
      integer :: first, second, status, unit

      bytes = huge(bytes)
      open (newunit=unit, file=root//'/proc/self/cgroup', action='read', status='old', &
         iostat=status)
      if (status /= 0) return
      do
         ! number:controllers:path
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         first = index(line, ':')
         second = first + index(line(first + 1:), ':')
         if (first == 0 .or. second == first) cycle
         if (line(:second) == '0::') then
            bytes = min(bytes, least_around(root//'/sys/fs/cgroup', trim(line(second + 1:)), &
               'memory.max'))
            bytes = min(bytes, least_around(root//'/sys/fs/cgroup/unified', &
               trim(line(second + 1:)), 'memory.max'))
         else if (index(','//line(first + 1:second - 1)//',', ',memory,') > 0) then
            bytes = min(bytes, least_around(root//'/sys/fs/cgroup/memory', &
               trim(line(second + 1:)), 'memory.limit_in_bytes'))
         end if
      end do
      close (unit, iostat=status)
   end function group_memory

   !> The least number in the files `name` of the folder `path` below `mount` and of all folders up
   !> to `mount`.
   function least_around(mount, path, name) result(bytes)
      character(*), intent(in) :: mount, path, name
      real(wp) :: bytes
      integer :: length

      length = len(path)
      if (length > 0) then
         if (path(length:) == '/') length = length - 1
      end if
      bytes = huge(bytes)
      do
         bytes = min(bytes, number_in(mount//path(:length)//'/'//name))
         if (length <= 0) exit
         length = index(path(:length), '/', back=.true.) - 1
      end do
   end function least_around

   !> The number that a file holds; huge if there is none ("max").
   function number_in(file) result(number)
      character(*), intent(in) :: file
      real(wp) :: number, value
      character(len=32) :: line
      logical :: exists, is_number
      integer :: status, unit

      number = huge(number)
      ! a failing `open` loads the files of the system with words for it
      inquire (file=file, exist=exists)
      if (.not. exists) return
      open (newunit=unit, file=file, action='read', status='old', iostat=status)
      if (status /= 0) return
      read (unit, '(a)', iostat=status) line
      is_number = .false.
      if (status == 0) call read_real(trim(line), value, is_number)
      if (is_number) number = value
      close (unit, iostat=status)
   end function number_in

end module control_group

!> The memory that a case needs at most, known before any of it is allocated, and what it may use of
!> this machine within the limits of this process (Linux): memory, stack, processors.
module system_limits
   use, intrinsic :: iso_c_binding, only: c_int, c_long
   use c_library, only: c_mallopt, c_prlimit, c_sysconf, limit_t
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use number_text, only: read_real
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_stack, dry_memory, group_memory, lubricated_memory, memory_fault, peak_memory, &
      point_memory, processors, settle_memory, thread_memory

   !> What the program itself takes, and its libraries for it, without a grid [bytes].
   real(wp), parameter :: of_program = 20.0e6_wp
   !> Address space that OpenBLAS reserves for its thread; it uses little of it [bytes].
   real(wp), parameter, public :: of_blas = 136.0e6_wp
   !> Least stack of the program; stack of a thread where that of the process is unlimited [bytes].
   integer(c_long), parameter :: least_stack = 1048576_c_long
   real(wp), parameter :: usual_stack = 2097152.0_wp
   !> RLIMIT_DATA, RLIMIT_STACK, RLIMIT_AS.
   integer(c_int), parameter :: limit_data = 2_c_int, limit_stack = 3_c_int, limit_memory = 9_c_int
   !> _SC_NPROCESSORS_ONLN of sysconf(3).
   integer(c_int), parameter :: online_processors = 84_c_int
   !> M_TRIM_THRESHOLD, M_MMAP_THRESHOLD, M_ARENA_MAX of mallopt(3).
   integer(c_int), parameter :: trim_threshold = -1_c_int, mmap_threshold = -3_c_int, &
      max_arenas = -8_c_int
   character(*), parameter :: process_status = '/proc/self/status'

contains

   !> The memory of a dry case with nodes(1) times nodes(2) nodes, at most [bytes]: above the
   !> highest peaks of processes of every size (docs/decisions.md). `refined`: nodes of the largest
   !> grid beside which one of up to twice as many in each direction is solved; 0: none.
   pure real(wp) function dry_memory(nodes, is_periodic, refined) result(bytes)
      integer, intent(in) :: nodes(2)
      logical, intent(in) :: is_periodic
      real(wp), intent(in) :: refined
      real(wp), parameter :: of_node = 460.0_wp, of_node_periodic = 330.0_wp, &
         of_refined_node = 1300.0_wp

      bytes = product(real(nodes, wp)) &
         *merge(of_node_periodic, of_node, is_periodic .and. nodes(2) > 1)
      bytes = max(bytes, of_refined_node*refined)
   end function dry_memory

   !> The same of a lubricated case with `steps` time steps (0: steady). `is_dense`: with a full
   !> matrix. `layers` (0: none): layers across the film, m of them with 3 m - 1 unknowns an
   !> interval, each with a column of a band matrix that reaches 4 m + 3 to both sides, and pressure
   !> and film of all times.
   pure real(wp) function lubricated_memory(intervals, steps, is_dense, layers) result(bytes)
      integer, intent(in) :: intervals
      real(wp), intent(in) :: steps
      logical, intent(in) :: is_dense
      integer, intent(in) :: layers
      real(wp), parameter :: of_interval = 1400.0_wp, of_step = 1000.0_wp, of_entry = 9.0_wp, &
         of_profile = 16.0_wp
      real(wp) :: m, n

      m = layers
      n = intervals
      bytes = of_interval*n + of_step*steps
      if (is_dense) bytes = bytes + of_entry*n**2
      if (layers > 0) bytes = bytes + (8*m*(36*m + 130) + of_profile*steps)*n
   end function lubricated_memory

   !> The same of a lubricated point contact, with all its coarser grids.
   pure real(wp) function point_memory(nx, ny) result(bytes)
      integer, intent(in) :: nx, ny
      real(wp), parameter :: of_node = 1000.0_wp

      bytes = of_node*(nx + 1)*(ny + 1)
   end function point_memory

   !> "found ..., expected ..." for something, `what`, that takes this many `bytes` beside the
   !> program, and `mapped` ones of address space that it hardly writes to; empty if there is
   !> enough. Physical memory, that of the control group, data and address space each have a limit.
   function memory_fault(what, bytes, mapped) result(fault)
      character(*), intent(in) :: what
      real(wp), intent(in) :: bytes
      real(wp), intent(in), optional :: mapped
      character(:), allocatable :: fault
      real(wp), save :: of_group = -1.0_wp, of_machine   ! some ten files: asked for once
      character(len=75), parameter :: names(4) = [character(len=75) :: &
         'the memory of this machine', 'the limit of its control group', &
         'the limit of data (ulimit -d)', &
         'what the limit of the address space (ulimit -v) leaves beside the libraries']
      real(wp), parameter :: megabyte = 1.0e6_wp
      real(wp) :: most(4), need(4)
      integer :: i

      if (of_group < 0.0_wp) then
         of_machine = number_in('/proc/meminfo', 'MemTotal:')
         of_group = group_memory('')
      end if
      most = [of_machine, of_group, limit_of(limit_data), limit_of(limit_memory)]
      ! the program and its libraries, without what they have allocated
      if (most(4) < huge(most)) most(4) = most(4) - (number_in(process_status, 'VmSize:') &
         - number_in(process_status, 'VmData:'))
      need = of_program + bytes
      if (present(mapped)) need(3:) = need(3:) + mapped
      fault = ''
      i = findloc(need > most, .true., dim=1)
      if (i > 0) fault = 'found '//what//' that needs up to '//to_text(need(i)/megabyte, 4)// &
         ' MB of memory, expected at most '//to_text(max(most(i), 0.0_wp)/megabyte, 4)//' MB, ' &
         //trim(names(i))
   end function memory_fault

   !> The value of a limit [bytes]; huge: none.
   real(wp) function limit_of(resource) result(bytes)
      integer(c_int), intent(in) :: resource
      type(limit_t) :: limit

      bytes = huge(bytes)
      if (c_prlimit(0_c_int, resource, old=limit) /= 0_c_int) return
      if (limit%present_value >= 0_c_long) bytes = real(limit%present_value, wp)
   end function limit_of

   !> The least memory limit of the control groups around this process (cgroups(7), versions 1 and
   !> 2) [bytes]; huge: none. `root` stands before /proc and /sys.
   real(wp) function group_memory(root) result(bytes)
      character(*), intent(in) :: root
      character(*), parameter :: mount = '/sys/fs/cgroup'
      character(len=4096) :: line
      integer :: first, second, status, unit

      bytes = huge(bytes)
      open (newunit=unit, file=root//'/proc/self/cgroup', action='read', status='old', &
         iostat=status)
      if (status /= 0) return   ! without a unit that could be closed
      do
         ! number:controllers:path
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         first = index(line, ':')
         second = first + index(line(first + 1:), ':')
         if (second == first) cycle
         if (line(:second) == '0::') then
            call read_limits(mount, 'memory.max')
            call read_limits(mount//'/unified', 'memory.max')
         else if (index(','//line(first + 1:second - 1)//',', ',memory,') > 0) then
            call read_limits(mount//'/memory', 'memory.limit_in_bytes')
         end if
      end do
      close (unit, iostat=status)

   contains

      !> Looks into the files `name` of the group in `folder` and of all groups around it.
      subroutine read_limits(folder, name)
         character(*), intent(in) :: folder, name
         character(:), allocatable :: path

         path = trim(line(second + 1:))//'/'
         do
            bytes = min(bytes, number_in(root//folder//path//name, ''))
            if (len(path) <= 1) exit
            path = path(:index(path(:len(path) - 1), '/', back=.true.))
         end do
      end subroutine read_limits

   end function group_memory

   !> The number behind `label` in a file of the system, in bytes if its line has kB; huge: none.
   real(wp) function number_in(file, label) result(number)
      character(*), intent(in) :: file, label
      character(*), parameter :: blanks = ' '//achar(9)
      character(len=200) :: line
      real(wp) :: value
      logical :: is_large, is_number
      integer :: status, unit

      number = huge(number)
      ! a failing `open` loads the files of the system with words for it
      inquire (file=file, exist=is_number)
      if (.not. is_number) return
      open (newunit=unit, file=file, action='read', status='old', iostat=status)
      if (status /= 0) return
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (index(line, label) /= 1) cycle
         is_large = index(line, ' kB') > 0
         line = line(len(label) + max(verify(line(len(label) + 1:), blanks), 1):)
         call read_real(line(:scan(line, blanks) - 1), value, is_number)
         if (is_number) number = merge(1024*value, value, is_large)
         exit
      end do
      close (unit, iostat=status)
   end function number_in

   !> Most physical memory of the process so far, all of its cases together [bytes]; 0: not known.
   real(wp) function peak_memory() result(bytes)
      real(wp), save :: most = 0.0_wp   ! of the counters of Linux a later sum may be less

      bytes = number_in(process_status, 'VmHWM:')
      if (bytes < huge(bytes)) most = max(bytes, most)
      bytes = most
   end function peak_memory

   !> Prepares the libraries. Without a limit of address space freed memory is kept, since the
   !> system would clear each page again; with one all threads share one pool, not 64 MB for each.
   !> Errors (input_error): no room for the program; OpenBLAS with threads that hang below 134 MB.
   subroutine settle_memory(error)
      type(error_t), allocatable, intent(out) :: error
      integer(c_int), parameter :: large_block = 1073741824_c_int
      character(:), allocatable :: fault
      real(wp) :: threads
      integer(c_int) :: status

      if (min(limit_of(limit_data), limit_of(limit_memory)) >= huge(1.0_wp)) then
         status = c_mallopt(mmap_threshold, large_block)
         status = c_mallopt(trim_threshold, -1_c_int)
         return
      end if
      status = c_mallopt(max_arenas, 1_c_int)
      fault = memory_fault('a program', 0.0_wp)
      threads = number_in(process_status, 'Threads:')
      if (threads > 1.0_wp .and. threads < huge(threads)) fault = &
         'found a library with threads under a limit of memory (ulimit -v or -d), '// &
         'expected OPENBLAS_NUM_THREADS=1 in the environment'
      if (fault /= '') call fail(error, input_error, fault)
   end subroutine settle_memory

   !> Address space that `threads` threads of the program take beside that of the first [bytes].
   real(wp) function thread_memory(threads) result(bytes)
      integer, intent(in) :: threads

      bytes = limit_of(limit_stack)
      if (bytes >= huge(bytes)) bytes = usual_stack
      bytes = (threads - 1)*bytes
   end function thread_memory

   !> Processors that work, at least 1.
   integer function processors() result(number)

      number = max(int(c_sysconf(online_processors)), 1)
   end function processors

   !> Raises a stack that is too small. Error (input_error): it must not be raised.
   subroutine check_stack(error)
      type(error_t), allocatable, intent(out) :: error
      type(limit_t) :: limit

      if (c_prlimit(0_c_int, limit_stack, old=limit) /= 0_c_int) return
      if (limit%present_value < 0_c_long .or. limit%present_value >= least_stack) return
      if (limit%largest < 0_c_long .or. limit%largest >= least_stack) then
         if (c_prlimit(0_c_int, limit_stack, limit_t(least_stack, limit%largest)) == 0_c_int) return
      end if
      call fail(error, input_error, 'found a stack of ' &
         //to_text(int(limit%present_value/1024_c_long))//' kB, expected at least ' &
         //to_text(int(least_stack/1024_c_long))//' kB (ulimit -s)')
   end subroutine check_stack

end module system_limits

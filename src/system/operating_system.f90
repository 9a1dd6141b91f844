!> The few services of the operating system that Fortran lacks, through the C library (POSIX).
module operating_system
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int64_t, c_loc, c_null_char, &
      c_null_ptr, c_ptr, c_short, c_size_t
   use file_identity, only: is_same_file, look_at_file, look_at_open_file
   use own_file, only: any_mark, mark_of, place_fault
   use signal_calls, only: c_close, c_open, c_unlink
   implicit none (type, external)
   private

   public :: closed, folder_of, is_folder, is_terminal, lock_t, make_folder, opened, remove_file, &
      rename_file, set_environment, start_again, sync_file, sync_folder

   !> LOCK_EX + LOCK_NB, LOCK_SH + LOCK_NB of flock(2).
   integer(c_int), parameter :: lock_exclusive = 6_c_int, lock_shared = 5_c_int
   !> F_OFD_SETLK of fcntl(2), and F_WRLCK and F_UNLCK.
   integer(c_int), parameter :: set_lock = 37_c_int
   integer(c_short), parameter :: lock_to_write = 1_c_short, lock_none = 2_c_short
   !> O_RDONLY and O_RDWR.
   integer(c_int), parameter :: read_only = 0_c_int, read_and_write = 2_c_int

   !> A lock on a file, held until `release` or the end of the process, however that comes. It is
   !> two: that of fcntl(2) keeps other runs out, and that of flock(2) readers, since HDF5 takes it,
   !> too. With flock alone a reader would keep a run from writing its own result.
   type :: lock_t
      integer(c_int), private :: descriptor = -1_c_int
   contains
      !> Takes the lock for writing, making the file if there is none; false if another run has it.
      procedure :: take
      !> Lets others read the file, but not take the lock.
      procedure :: allow_readers
      !> Whether the file is still there under its name.
      procedure :: holds
      procedure :: release
   end type lock_t

   !> struct flock of fcntl(2): a lock on the whole file.
   type, bind(c) :: c_flock_t
      integer(c_short) :: kind = lock_none
      integer(c_short) :: origin = 0_c_short
      integer(c_int64_t) :: start = 0_c_int64_t
      integer(c_int64_t) :: length = 0_c_int64_t
      integer(c_int) :: process = 0_c_int
   end type c_flock_t

   interface
      !> rename(2): replaces `new` in one step.
      function c_rename(old, new) bind(c, name='rename') result(status)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: old(*), new(*)
         integer(c_int) :: status
      end function c_rename

      !> isatty(3).
      function c_isatty(descriptor) bind(c, name='isatty') result(answer)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor
         integer(c_int) :: answer
      end function c_isatty

      !> flock(2), as HDF5 uses it on files that it writes.
      function c_flock(descriptor, operation) bind(c, name='flock') result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor, operation
         integer(c_int) :: status
      end function c_flock

      !> fcntl(2) with a lock, here of the open file: the end of another descriptor does not end it.
      function c_fcntl(descriptor, operation, lock) bind(c, name='fcntl') result(status)
         import :: c_flock_t, c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor, operation
         type(c_flock_t), intent(in) :: lock
         integer(c_int) :: status
      end function c_fcntl

      !> mkdir(2).
      function c_mkdir(path, mode) bind(c, name='mkdir') result(status)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
         integer(c_int) :: status
      end function c_mkdir

      !> fsync(2): everything written to a file reaches the disk.
      function c_fsync(descriptor) bind(c, name='fsync') result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor
         integer(c_int) :: status
      end function c_fsync

      !> setenv(3).
      function c_setenv(name, value, overwrite) bind(c, name='setenv') result(status)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: name(*), value(*)
         integer(c_int), value :: overwrite
         integer(c_int) :: status
      end function c_setenv

      !> readlink(2): what a link points to, without a zero at its end; its length, -1 if there is
      !> none.
      function c_readlink(path, buffer, bytes) bind(c, name='readlink') result(length)
         import :: c_char, c_size_t
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(out) :: buffer(*)
         integer(c_size_t), value :: bytes
         integer(c_size_t) :: length
      end function c_readlink

      !> execv(3): another program in place of this one; returns only if that fails.
      function c_execv(path, arguments) bind(c, name='execv') result(status)
         import :: c_char, c_int, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         type(c_ptr), intent(in) :: arguments(*)
         integer(c_int) :: status
      end function c_execv
   end interface

contains

   !> Renames a file in one step, replacing an older one that this program has written; true if that
   !> worked.
   function rename_file(old, new) result(is_done)
      character(*), intent(in) :: old, new
      logical :: is_done

      is_done = place_fault(new, mark_of(old//c_null_char)) == ''
      if (is_done) is_done = c_rename(old//c_null_char, new//c_null_char) == 0_c_int
   end function rename_file

   !> Removes a file that this program has written; true if that worked.
   function remove_file(path) result(is_done)
      character(*), intent(in) :: path
      logical :: is_done

      is_done = place_fault(path, any_mark) == ''
      if (is_done) is_done = c_unlink(path//c_null_char) == 0_c_int
   end function remove_file

   !> Whether `path` is an existing folder.
   function is_folder(path) result(answer)
      character(*), intent(in) :: path
      logical :: answer

      inquire (file=path//'/.', exist=answer)
   end function is_folder

   !> Takes the lock on `path`. A file system that knows no locks counts as taken. If the file was
   !> renamed or removed between opening and locking, the lock is tried again.
   function take(self, path) result(is_taken)
      class(lock_t), intent(inout) :: self
      character(*), intent(in) :: path
      logical :: is_taken
      integer :: status, unit

      is_taken = .true.
      do
         call self%release()
         open (newunit=unit, file=path, access='stream', form='unformatted', action='readwrite', &
            iostat=status)
         if (status == 0) close (unit, iostat=status)
         if (status /= 0) return
         self%descriptor = opened(path, for_writing=.true.)
         if (self%descriptor < 0_c_int) cycle
         if (c_fcntl(self%descriptor, set_lock, c_flock_t(lock_to_write)) /= 0_c_int) exit
         if (.not. self%holds(path)) cycle
         status = c_flock(self%descriptor, lock_exclusive)   ! not while somebody reads
         return
      end do
      ! releasing what one does not have always works
      is_taken = c_fcntl(self%descriptor, set_lock, c_flock_t(lock_none)) /= 0_c_int
      if (.not. is_taken) call self%release()
   end function take

   !> HDF5 takes a shared lock on a file that it reads, or refuses to.
   subroutine allow_readers(self)
      class(lock_t), intent(inout) :: self
      integer(c_int) :: status

      if (self%descriptor >= 0_c_int) status = c_flock(self%descriptor, lock_shared)
   end subroutine allow_readers

   !> Whether `path` still leads to the locked file.
   function holds(self, path)
      class(lock_t), intent(in) :: self
      character(*), intent(in) :: path
      logical :: holds

      holds = is_same_file(look_at_open_file(self%descriptor), look_at_file(path, follows=.true.))
   end function holds

   !> Gives the lock back; twice does nothing.
   subroutine release(self)
      class(lock_t), intent(inout) :: self
      logical :: is_closed

      if (self%descriptor >= 0_c_int) is_closed = closed(self%descriptor)
      self%descriptor = -1_c_int
   end subroutine release

   !> Descriptor of an existing file or folder, for reading or for both; below 0: it cannot be
   !> opened.
   function opened(path, for_writing) result(descriptor)
      character(*), intent(in) :: path
      logical, intent(in) :: for_writing
      integer(c_int) :: descriptor

      descriptor = c_open(path//c_null_char, merge(read_and_write, read_only, for_writing))
   end function opened

   !> Closes a descriptor; true if everything that was written to it is kept.
   function closed(descriptor) result(is_done)
      integer(c_int), intent(in) :: descriptor
      logical :: is_done

      is_done = c_close(descriptor) == 0_c_int
   end function closed

   !> Waits until everything written to a file or folder is on the disk; true if that worked.
   function sync_file(path) result(is_done)
      character(*), intent(in) :: path
      logical :: is_done
      integer(c_int) :: descriptor, status

      descriptor = opened(path, for_writing=.false.)
      is_done = descriptor >= 0_c_int
      if (.not. is_done) return
      is_done = c_fsync(descriptor) == 0_c_int
      status = c_close(descriptor)
   end function sync_file

   !> Waits until the names in the folder of `path` are on the disk; file systems that cannot do
   !> that are left as they are.
   subroutine sync_folder(path)
      character(*), intent(in) :: path
      logical :: is_done

      is_done = sync_file(folder_of(path))
   end subroutine sync_folder

   !> Makes a folder with those above it, if they are not there; no name: nothing. Whether that was
   !> done shows when a file is put into it.
   recursive subroutine make_folder(path)
      character(*), intent(in) :: path
      integer(c_int), parameter :: all_permissions = 511_c_int   ! 0777, less the user's mask
      integer(c_int) :: status
      integer :: last

      last = verify(path, '/', back=.true.)
      if (last == 0) return
      if (is_folder(path)) return
      call make_folder(folder_of(path(:last)))
      status = c_mkdir(path(:last)//c_null_char, all_permissions)
   end subroutine make_folder

   !> The folder part of a path; '.' if it has none.
   pure function folder_of(path) result(folder)
      character(*), intent(in) :: path
      character(:), allocatable :: folder
      integer :: slash

      slash = index(path, '/', back=.true.)
      folder = '.'
      if (slash == 1) folder = '/'
      if (slash > 1) folder = path(:slash - 1)
   end function folder_of

   !> Sets an environment variable of this process, for libraries that read it.
   subroutine set_environment(name, value)
      character(*), intent(in) :: name, value
      integer(c_int) :: status

      status = c_setenv(name//c_null_char, value//c_null_char, 1_c_int)
   end subroutine set_environment

   !> Replaces this process by the same program with the same arguments and the present environment.
   !> Returns if that fails.
   subroutine start_again()
      character(len=4096, kind=c_char) :: path
      character(len=:, kind=c_char), allocatable, target :: words
      type(c_ptr), allocatable :: arguments(:)
      integer :: count, i, length, longest
      integer(c_int) :: status

      length = int(c_readlink('/proc/self/exe'//c_null_char, path, &
         len(path, kind=c_size_t) - 1_c_size_t))
      if (length <= 0) return
      path(length + 1:length + 1) = c_null_char
      count = command_argument_count()
      longest = 0
      do i = 0, count
         call get_command_argument(i, length=length)
         longest = max(longest, length)
      end do
      allocate (character(len=(longest + 1)*(count + 1), kind=c_char) :: words)
      allocate (arguments(0:count + 1))
      do i = 0, count
         associate (word => words((longest + 1)*i + 1:(longest + 1)*(i + 1)))
            call get_command_argument(i, value=word, length=length)
            word(length + 1:length + 1) = c_null_char
            arguments(i) = c_loc(word)
         end associate
      end do
      arguments(count + 1) = c_null_ptr
      status = c_execv(path, arguments)
   end subroutine start_again

   !> Whether a file descriptor is a terminal.
   function is_terminal(descriptor) result(answer)
      integer, intent(in) :: descriptor
      logical :: answer

      answer = c_isatty(int(descriptor, c_int)) == 1_c_int
   end function is_terminal

end module operating_system

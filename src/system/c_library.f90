!> Calls of the C library (Linux), documented in its manual pages without `c_`.
module c_library
   use, intrinsic :: iso_c_binding, only: c_char, c_funptr, c_int, c_int16_t, &
      c_int32_t, c_int64_t, c_long, c_ptr, c_short, c_size_t
   implicit none (type, external)
   private

   public :: c_close, c_exit, c_fcntl, c_fsync, c_ftruncate, c_isatty, c_lseek, c_mallopt, &
      c_mkdir, c_open, c_poll, c_pread, c_prlimit, c_pwrite, c_rename, c_setenv, c_setitimer, &
      c_signal, c_statx, c_sysconf, c_unlink, c_write

   !> File descriptors of the standard streams.
   integer(c_int), parameter, public :: standard_output = 1_c_int, standard_error = 2_c_int

   !> struct pollfd of poll(2).
   type, bind(c), public :: poll_t
      integer(c_int) :: descriptor
      integer(c_short) :: events, found
   end type poll_t

   !> struct flock of fcntl(2): a lock on the whole file.
   type, bind(c), public :: file_lock_t
      integer(c_short) :: kind, origin = 0_c_short
      integer(c_int64_t) :: start = 0_c_int64_t, length = 0_c_int64_t
      integer(c_int) :: process = 0_c_int
   end type file_lock_t

   !> struct rlimit of prlimit(2): what counts, and up to where it may be raised; < 0: unlimited.
   type, bind(c), public :: limit_t
      integer(c_long) :: present_value = 0_c_long, largest = 0_c_long
   end type limit_t

   !> struct statx of statx(2), the same on every processor.
   type, bind(c), public :: statx_t
      integer(c_int32_t) :: mask, block_size
      integer(c_int64_t) :: attributes
      integer(c_int32_t) :: links, user, group
      integer(c_int16_t) :: mode, spare
      integer(c_int64_t) :: inode, bytes, blocks, attributes_mask, times(8)
      integer(c_int32_t) :: own_device(2), device(2)
      integer(c_int64_t) :: reserved(14)
   end type statx_t

   interface
      !> open(2) without a mode: only for files that exist. The descriptor; below 0: not opened.
      integer(c_int) function c_open(path, flags) bind(c, name='open')
         import
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: flags
      end function c_open
      !> close(2).
      integer(c_int) function c_close(descriptor) bind(c, name='close')
         import
         integer(c_int), value :: descriptor
      end function c_close
      !> pread(2): bytes that were read; below 0: an error.
      integer(c_size_t) function c_pread(descriptor, bytes, count, place) bind(c, name='pread')
         import
         integer(c_int), value :: descriptor
         type(c_ptr), value :: bytes
         integer(c_size_t), value :: count
         integer(c_int64_t), value :: place
      end function c_pread
      !> pwrite(2): bytes that were written; below 0: an error.
      integer(c_size_t) function c_pwrite(descriptor, bytes, count, place) bind(c, name='pwrite')
         import
         integer(c_int), value :: descriptor
         type(c_ptr), value :: bytes
         integer(c_size_t), value :: count
         integer(c_int64_t), value :: place
      end function c_pwrite
      !> write(2): bytes that were written; below 0: an error.
      integer(c_size_t) function c_write(descriptor, text, bytes) bind(c, name='write')
         import
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value :: bytes
      end function c_write
      !> lseek(2): the new place [bytes]; below 0: an error.
      integer(c_int64_t) function c_lseek(descriptor, offset, origin) bind(c, name='lseek')
         import
         integer(c_int), value :: descriptor, origin
         integer(c_int64_t), value :: offset
      end function c_lseek
      !> fsync(2): everything written to a file reaches the disk.
      integer(c_int) function c_fsync(descriptor) bind(c, name='fsync')
         import
         integer(c_int), value :: descriptor
      end function c_fsync
      !> ftruncate(2): a file has this many bytes.
      integer(c_int) function c_ftruncate(descriptor, bytes) bind(c, name='ftruncate')
         import
         integer(c_int), value :: descriptor
         integer(c_int64_t), value :: bytes
      end function c_ftruncate
      !> fcntl(2) with a lock.
      integer(c_int) function c_fcntl(descriptor, operation, lock) bind(c, name='fcntl')
         import
         integer(c_int), value :: descriptor, operation
         type(file_lock_t), intent(in) :: lock
      end function c_fcntl
      !> statx(2).
      integer(c_int) function c_statx(folder, path, flags, mask, answer) bind(c, name='statx')
         import
         integer(c_int), value :: folder, flags, mask
         character(kind=c_char), intent(in) :: path(*)
         type(statx_t), intent(inout) :: answer
      end function c_statx
      !> rename(2): replaces `new` in one step.
      integer(c_int) function c_rename(old, new) bind(c, name='rename')
         import
         character(kind=c_char), intent(in) :: old(*), new(*)
      end function c_rename
      !> unlink(2).
      integer(c_int) function c_unlink(path) bind(c, name='unlink')
         import
         character(kind=c_char), intent(in) :: path(*)
      end function c_unlink
      !> mkdir(2).
      integer(c_int) function c_mkdir(path, mode) bind(c, name='mkdir')
         import
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
      end function c_mkdir
      !> isatty(3): 1 for a terminal.
      integer(c_int) function c_isatty(descriptor) bind(c, name='isatty')
         import
         integer(c_int), value :: descriptor
      end function c_isatty
      !> poll(2): 1 if the descriptor of `place` is ready within `time` [ms]; `count` is 1.
      integer(c_int) function c_poll(place, count, time) bind(c, name='poll')
         import
         type(poll_t), intent(inout) :: place
         integer(c_long), value :: count
         integer(c_int), value :: time
      end function c_poll
      !> signal(2): sets what a signal does; what it did before.
      type(c_funptr) function c_signal(number, action) bind(c, name='signal')
         import
         integer(c_int), value :: number
         type(c_funptr), value :: action
      end function c_signal
      !> setitimer(2): `setting` is interval and time to the first signal, in seconds, microseconds.
      integer(c_int) function c_setitimer(timer, setting, old) bind(c, name='setitimer')
         import
         integer(c_int), value :: timer
         integer(c_long), intent(in) :: setting(4)
         type(c_ptr), value :: old
      end function c_setitimer
      !> _exit(2): ends the process; nothing is flushed.
      subroutine c_exit(status) bind(c, name='_exit')
         import
         integer(c_int), value :: status
      end subroutine c_exit
      !> setenv(3), for libraries that read the environment.
      integer(c_int) function c_setenv(name, value, overwrite) bind(c, name='setenv')
         import
         character(kind=c_char), intent(in) :: name(*), value(*)
         integer(c_int), value :: overwrite
      end function c_setenv
      !> prlimit(2): sets and tells a limit of a process; 0: of this one.
      integer(c_int) function c_prlimit(process, resource, new, old) bind(c, name='prlimit')
         import
         integer(c_int), value :: process, resource
         type(limit_t), intent(in), optional :: new
         type(limit_t), intent(inout), optional :: old
      end function c_prlimit
      !> sysconf(3).
      integer(c_long) function c_sysconf(name) bind(c, name='sysconf')
         import
         integer(c_int), value :: name
      end function c_sysconf
      !> mallopt(3) of the GNU C library.
      integer(c_int) function c_mallopt(parameter, value) bind(c, name='mallopt')
         import
         integer(c_int), value :: parameter, value
      end function c_mallopt
   end interface

end module c_library

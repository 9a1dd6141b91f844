!> The few services of the operating system that Fortran lacks, through the C library (POSIX).
module operating_system
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_funptr, c_int, c_intptr_t, c_null_char, c_ptr
   implicit none (type, external)
   private

   public :: ignore_file_size_signal, is_folder, is_locked, is_terminal, remove_file, rename_file

   !> File descriptor of standard error.
   integer, parameter, public :: standard_error_descriptor = 2

   !> SIGXFSZ on Linux, macOS and the BSDs.
   integer(c_int), parameter :: signal_file_size = 25_c_int
   !> LOCK_EX + LOCK_NB: an exclusive lock or none, without waiting.
   integer(c_int), parameter :: lock_now = 6_c_int
   !> SIG_IGN as an address.
   integer(c_intptr_t), parameter :: ignore_address = 1_c_intptr_t

   interface
      !> rename(2): replaces `new` in one step.
      function c_rename(old, new) bind(c, name='rename') result(status)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: old(*)
         character(kind=c_char), intent(in) :: new(*)
         integer(c_int) :: status
      end function c_rename

      !> unlink(2): removes the name of a file.
      function c_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_unlink

      !> isatty(3).
      function c_isatty(descriptor) bind(c, name='isatty') result(answer)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor
         integer(c_int) :: answer
      end function c_isatty

      !> fopen(3).
      function c_fopen(path, mode) bind(c, name='fopen') result(stream)
         import :: c_char, c_ptr
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(in) :: mode(*)
         type(c_ptr) :: stream
      end function c_fopen

      !> fclose(3); the lock of the stream goes with it.
      function c_fclose(stream) bind(c, name='fclose') result(status)
         import :: c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: stream
         integer(c_int) :: status
      end function c_fclose

      !> fileno(3): the descriptor of a stream.
      function c_fileno(stream) bind(c, name='fileno') result(descriptor)
         import :: c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: stream
         integer(c_int) :: descriptor
      end function c_fileno

      !> flock(2), as HDF5 uses it on files that it writes.
      function c_flock(descriptor, operation) bind(c, name='flock') result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor
         integer(c_int), value :: operation
         integer(c_int) :: status
      end function c_flock

      !> signal(2): sets what a signal does.
      function c_signal(number, action) bind(c, name='signal') result(previous)
         import :: c_funptr, c_int
         implicit none (type, external)
         integer(c_int), value :: number
         type(c_funptr), value :: action
         type(c_funptr) :: previous
      end function c_signal
   end interface

contains

   !> Renames a file in one step, replacing an older one; true if that worked.
   function rename_file(old, new) result(is_done)
      character(*), intent(in) :: old
      character(*), intent(in) :: new
      logical :: is_done

      is_done = c_rename(old//c_null_char, new//c_null_char) == 0_c_int
   end function rename_file

   !> Removes a file; true if that worked.
   function remove_file(path) result(is_done)
      character(*), intent(in) :: path
      logical :: is_done

      is_done = c_unlink(path//c_null_char) == 0_c_int
   end function remove_file

   !> Whether `path` is an existing folder.
   function is_folder(path) result(answer)
      character(*), intent(in) :: path
      logical :: answer

      inquire (file=path//'/.', exist=answer)
   end function is_folder

   !> Whether a file exists and somebody else has it open for writing with a lock, as HDF5 does.
   function is_locked(path) result(answer)
      character(*), intent(in) :: path
      logical :: answer
      type(c_ptr) :: stream
      integer(c_int) :: status

      answer = .false.
      stream = c_fopen(path//c_null_char, 'r+'//c_null_char)
      if (.not. c_associated(stream)) return
      answer = c_flock(c_fileno(stream), lock_now) /= 0_c_int
      status = c_fclose(stream)
   end function is_locked

   !> Whether a file descriptor is a terminal.
   function is_terminal(descriptor) result(answer)
      integer, intent(in) :: descriptor
      logical :: answer

      answer = c_isatty(int(descriptor, c_int)) == 1_c_int
   end function is_terminal

   !> A write beyond the allowed file size (`ulimit -f`) fails from now on instead of ending the program without a word.
   subroutine ignore_file_size_signal()
      type(c_funptr) :: previous

      previous = c_signal(signal_file_size, transfer(ignore_address, previous))
   end subroutine ignore_file_size_signal

end module operating_system

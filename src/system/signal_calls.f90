!> What signal handlers need of the operating system, all of it allowed in a handler (POSIX,
!> async-signal-safe functions). The procedures are recursive: a signal may come while one of them
!> runs.
module signal_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_funptr, c_int, c_int64_t, c_long, c_null_ptr, &
      c_ptr, c_short, c_size_t
   implicit none (type, external)
   private

   public :: c_close, c_exit, c_open, c_pread, c_seek, c_signal, c_time, c_unlink, c_write, &
      one_second, set_timer, tell

   !> File descriptor of standard error.
   integer(c_int), parameter, public :: standard_error = 2_c_int
   !> A second in the unit of timers [us].
   integer(c_long), parameter :: one_second = 1000000_c_long
   !> POLLOUT, and the bytes that a pipe which is ready takes without waiting (PIPE_BUF of Linux).
   integer(c_short), parameter :: is_ready = 4_c_short
   integer(c_size_t), parameter :: ready_bytes = 4096_c_size_t
   !> struct pollfd.
   type, bind(c) :: poll_t
      integer(c_int) :: descriptor
      integer(c_short) :: events, found
   end type poll_t

   interface
      !> signal(2): sets what a signal does.
      function c_signal(number, action) bind(c, name='signal') result(previous)
         import :: c_funptr, c_int
         implicit none (type, external)
         integer(c_int), value :: number
         type(c_funptr), value :: action
         type(c_funptr) :: previous
      end function c_signal

      !> setitimer(2): `setting` is struct itimerval, the interval and the time until the first
      !> signal, seconds and microseconds.
      function c_setitimer(timer, setting, old) bind(c, name='setitimer') result(status)
         import :: c_int, c_long, c_ptr
         implicit none (type, external)
         integer(c_int), value :: timer
         integer(c_long), intent(in) :: setting(4)
         type(c_ptr), value :: old
         integer(c_int) :: status
      end function c_setitimer

      !> write(2).
      function c_write(descriptor, text, bytes) bind(c, name='write') result(written)
         import :: c_char, c_int, c_size_t
         implicit none (type, external)
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value :: bytes
         integer(c_size_t) :: written
      end function c_write

      !> open(2) without a mode: only for files that exist.
      function c_open(path, flags) bind(c, name='open') result(descriptor)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: flags
         integer(c_int) :: descriptor
      end function c_open

      !> close(2).
      function c_close(descriptor) bind(c, name='close') result(status)
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: descriptor
         integer(c_int) :: status
      end function c_close

      !> pread(2): bytes that were read, below 0 for an error.
      function c_pread(descriptor, bytes, count, place) bind(c, name='pread') result(done)
         import :: c_int, c_int64_t, c_ptr, c_size_t
         implicit none (type, external)
         integer(c_int), value :: descriptor
         type(c_ptr), value :: bytes
         integer(c_size_t), value :: count
         integer(c_int64_t), value :: place
         integer(c_size_t) :: done
      end function c_pread

      !> lseek(2): the new place [bytes], below 0 for an error.
      function c_seek(descriptor, offset, origin) bind(c, name='lseek') result(place)
         import :: c_int, c_int64_t
         implicit none (type, external)
         integer(c_int), value :: descriptor, origin
         integer(c_int64_t), value :: offset
         integer(c_int64_t) :: place
      end function c_seek

      !> poll(2): 1 if the descriptor of `place` is ready within `time` [ms]; `count` is 1.
      function c_poll(place, count, time) bind(c, name='poll') result(ready)
         import :: c_int, c_long, poll_t
         implicit none (type, external)
         type(poll_t), intent(inout) :: place
         integer(c_long), value :: count
         integer(c_int), value :: time
         integer(c_int) :: ready
      end function c_poll

      !> unlink(2).
      function c_unlink(path) bind(c, name='unlink') result(status)
         import :: c_char, c_int
         implicit none (type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int) :: status
      end function c_unlink

      !> _exit(2): ends the process, nothing is flushed.
      subroutine c_exit(status) bind(c, name='_exit')
         import :: c_int
         implicit none (type, external)
         integer(c_int), value :: status
      end subroutine c_exit

      !> time(2): seconds since 1970; `place` may be no address.
      function c_time(place) bind(c, name='time') result(seconds)
         import :: c_long, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: place
         integer(c_long) :: seconds
      end function c_time
   end interface

contains

   !> Writes `text` of `length` characters to standard error as far as it is taken within `time`
   !> [ms] for each 4096: a handler must not wait for a reader that no longer reads.
   recursive function tell(text, length, time) result(is_taken)
      character(kind=c_char), intent(in) :: text(*)
      integer, intent(in) :: length, time
      logical :: is_taken
      type(poll_t) :: place
      integer(c_size_t) :: written
      integer :: done

      done = 0
      do while (done < length)
         place = poll_t(standard_error, is_ready, 0_c_short)
         is_taken = c_poll(place, 1_c_long, int(time, c_int)) == 1_c_int
         if (is_taken) is_taken = iand(place%found, is_ready) /= 0_c_short
         if (.not. is_taken) return
         written = c_write(standard_error, text(done + 1:length), min(int(length - done, &
            c_size_t), ready_bytes))
         is_taken = written > 0_c_size_t
         if (.not. is_taken) return
         done = done + int(written)
      end do
      is_taken = .true.
   end function tell

   !> The signal of `timer` (ITIMER_...) after `time` [us].
   recursive subroutine set_timer(timer, time)
      integer(c_int), intent(in) :: timer
      integer(c_long), intent(in) :: time
      integer(c_int) :: status

      status = c_setitimer(timer, [0_c_long, 0_c_long, time/one_second, modulo(time, one_second)], &
         c_null_ptr)
   end subroutine set_timer

end module signal_calls

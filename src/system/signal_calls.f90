!> What signal handlers need of the operating system, all of it allowed in a handler (POSIX,
!> async-signal-safe functions).
module signal_calls
   use, intrinsic :: iso_c_binding, only: c_char, c_funptr, c_int, c_long, c_null_ptr, c_ptr, &
      c_size_t
   implicit none (type, external)
   private

   public :: c_exit, c_signal, c_time, c_unlink, c_write, one_second, set_timer

   !> File descriptor of standard error.
   integer(c_int), parameter, public :: standard_error = 2_c_int
   !> A second in the unit of timers [us].
   integer(c_long), parameter :: one_second = 1000000_c_long

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

   !> The signal of `timer` (ITIMER_...) after `time` [us].
   subroutine set_timer(timer, time)
      integer(c_int), intent(in) :: timer
      integer(c_long), intent(in) :: time
      integer(c_int) :: status

      status = c_setitimer(timer, [0_c_long, 0_c_long, time/one_second, modulo(time, one_second)], &
         c_null_ptr)
   end subroutine set_timer

end module signal_calls

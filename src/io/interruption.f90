!> Signals (POSIX): SIGINT (Ctrl-C) and SIGTERM (batch systems, kill) ask the program to end; others must not end it.
!>
!> The first request is only noted; the program looks at the note between time steps, keeps where it stands and ends. The second
!> one ends the program at once. The note is the one variable of the program that outlives a call: a signal handler has no
!> arguments through which it could reach anything else.
module interruption
   use, intrinsic :: iso_c_binding, only: c_funloc, c_funptr, c_int, c_intptr_t
   implicit none (type, external)
   private

   public :: ignore_file_size_signal, is_interrupted, listen_to_signals

   !> SIGINT, SIGPIPE and SIGTERM on every POSIX system.
   integer(c_int), parameter :: signal_interrupt = 2_c_int, signal_pipe = 13_c_int, signal_terminate = 15_c_int
   !> SIGXFSZ on Linux, macOS and the BSDs.
   integer(c_int), parameter :: signal_file_size = 25_c_int
   !> SIG_DFL and SIG_IGN as addresses.
   integer(c_intptr_t), parameter :: default_address = 0_c_intptr_t, ignore_address = 1_c_intptr_t

   !> Number of the signal that came; 0: none.
   integer(c_int), volatile :: noted = 0_c_int

   interface
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

   !> From now on the first SIGINT or SIGTERM is noted instead of ending the program. One that was ignored (nohup, a job in
   !> the background) stays ignored. That nobody reads standard error any more (SIGPIPE) is no reason to end.
   subroutine listen_to_signals()
      call ignore(signal_pipe)
      call listen_to(signal_interrupt)
      call listen_to(signal_terminate)
   end subroutine listen_to_signals

   !> A write beyond the allowed file size (`ulimit -f`) fails from now on instead of ending the program without a word.
   subroutine ignore_file_size_signal()
      call ignore(signal_file_size)
   end subroutine ignore_file_size_signal

   !> A signal has no effect from now on.
   subroutine ignore(number)
      integer(c_int), intent(in) :: number
      type(c_funptr) :: previous

      previous = c_signal(number, transfer(ignore_address, previous))
   end subroutine ignore

   !> Notes one signal, unless it was ignored before.
   subroutine listen_to(number)
      integer(c_int), intent(in) :: number
      type(c_funptr) :: previous

      previous = c_signal(number, c_funloc(note))
      if (transfer(previous, 0_c_intptr_t) == ignore_address) previous = c_signal(number, previous)
   end subroutine listen_to

   !> Whether the program was asked to end.
   function is_interrupted() result(answer)
      logical :: answer

      answer = noted /= 0_c_int
   end function is_interrupted

   !> The handler: notes the signal and gives a second one its usual effect.
   subroutine note(number) bind(c)
      integer(c_int), value :: number
      type(c_funptr) :: previous

      noted = number
      previous = c_signal(number, transfer(default_address, previous))
   end subroutine note

end module interruption

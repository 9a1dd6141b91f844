!> Signals (POSIX) that ask the program to end: SIGINT (Ctrl-C), SIGTERM, SIGHUP (the terminal was
!> closed), SIGUSR1, SIGUSR2 and SIGXCPU (batch systems). Others must not end it.
!>
!> The first request is recorded; the program checks for it between cycles and time steps, writes a
!> checkpoint and ends. Where it does not check soon (a factorisation, a library, a large file, a
!> dry contact, which has nothing to keep) a timer ends it: it prints the message prepared for that,
!> removes the files named with it, and exits with status 4. A second SIGINT or SIGTERM does the
!> same at once.
!>
!> The request and the message are module variables: a signal handler has no arguments through which
!> it could reach anything else. It only calls what POSIX allows there (poll, write, unlink,
!> open, lseek, pread, close, setitimer, signal, _exit), and allocates nothing. It may interrupt
!> another handler, so what it calls is recursive.
module interruption
   use, intrinsic :: iso_c_binding, only: c_char, c_funloc, c_funptr, c_int, c_intptr_t, c_long, &
      c_null_char
   use own_file, only: mark_of, no_mark
   use signal_calls, only: c_exit, c_signal, c_unlink, set_timer, tell
   implicit none (type, external)
   private

   public :: forget_last_words, is_interrupted, lay_down_last_words, &
      listen_to_signals, set_patience, stop_listening, take_last_words

   !> Signals with the same number on every POSIX system; SIGUSR1, SIGUSR2, SIGXCPU and SIGXFSZ as
   !> on Linux.
   integer(c_int), parameter :: signal_hangup = 1_c_int, signal_interrupt = 2_c_int, &
      signal_pipe = 13_c_int, &
      signal_alarm = 14_c_int, signal_terminate = 15_c_int, signal_user_1 = 10_c_int, &
         signal_user_2 = 12_c_int, &
      signal_processor_time = 24_c_int, signal_file_size = 25_c_int
   !> SIG_IGN as an address.
   integer(c_intptr_t), parameter :: ignore_address = 1_c_intptr_t
   !> ITIMER_REAL; time within which the program checks for a request, time that a time step or the
   !> writing of a result may take [us]; time for a reader to take the message [ms].
   integer(c_int), parameter :: wall_timer = 0_c_int
   integer(c_long), parameter :: soon = 500000_c_long, patience = 20000000_c_long
   integer, parameter :: patience_for_words = 1000
   integer(c_int), parameter :: status_interrupted = 4_c_int
   !> Longest words, longest file name, and files to remove.
   integer, parameter :: longest_words = 9000, longest_name = 4200, max_files = 4
   character(*), parameter :: usual_words = 'asperity: interrupted'
   character(kind=c_char, len=*), parameter :: waiting_words = &
      'asperity: interrupted, ends when this time step or result is complete'//new_line('a')

   !> Number of the signal that came first; 0: none. Which ones came.
   integer(c_int), volatile :: noted = 0_c_int
   logical, volatile :: has_come(64) = .false.
   !> A checkpoint or a result is about to be written; that has been said.
   logical, volatile :: is_patient = .false., is_waiting = .false.
   !> The program prints the message itself: the handlers only end it.
   logical, volatile :: is_taken = .false.
   !> The message and the files that go with it, twice: one set is valid while the other one is
   !> written.
   type :: last_words_t
      integer :: length = 0, files = 0
      character(kind=c_char, len=longest_words) :: words = ''
      character(kind=c_char, len=longest_name) :: names(max_files) = ''
   end type last_words_t
   type(last_words_t) :: sets(2)
   integer, volatile :: current = 0

contains

   !> From now on the first request is recorded instead of ending the program. A signal that was
   !> ignored (nohup, a job in the background) stays ignored. A closed pipe on the output (SIGPIPE)
   !> and a write beyond the allowed file size (SIGXFSZ, `ulimit -f`) fail instead of ending the
   !> program without a message.
   subroutine listen_to_signals()
      integer(c_int), parameter :: requests(*) = [signal_hangup, signal_interrupt, &
         signal_terminate, signal_user_1, signal_user_2, signal_processor_time]
      type(c_funptr) :: previous
      integer :: i

      call ignore(signal_pipe)
      call ignore(signal_file_size)
      call forget_last_words()
      previous = c_signal(signal_alarm, c_funloc(end_at_last))
      do i = 1, size(requests)
         call listen_to(requests(i))
      end do
   end subroutine listen_to_signals

   !> Sets the message and the files to remove if the program has to be ended from now on.
   subroutine lay_down_last_words(words, files)
      character(*), intent(in) :: words, files(:)
      integer :: i, next

      next = merge(2, 1, current == 1)
      associate (set => sets(next))
         set%words = words
         set%length = min(len(words) + 1, longest_words)
         set%words(set%length:set%length) = new_line('a')
         set%files = 0
         do i = 1, min(size(files), max_files)
            if (len_trim(files(i)) >= longest_name) cycle
            set%files = set%files + 1
            set%names(set%files) = trim(files(i))//c_null_char
         end do
      end associate
      current = next
   end subroutine lay_down_last_words

   !> Nothing is removed, and the message is only that the program was interrupted.
   subroutine forget_last_words()
      call set_patience(.false.)
      call lay_down_last_words(usual_words, [character(len=1) ::])
   end subroutine forget_last_words

   !> The program is about to say itself that it was interrupted: the handlers no longer say it, so
   !> that it is said once however long the rest of the end takes.
   subroutine take_last_words()
      call set_timer(wall_timer, merge(patience, soon, is_waiting))   ! first: time to say it
      is_taken = .true.
   end subroutine take_last_words

   !> Stops the timer: all work is done and the message is printed.
   subroutine stop_listening()
      call set_timer(wall_timer, 0_c_long)
      is_taken = .true.
   end subroutine stop_listening

   !> Whether what is going on is worth waiting for: a time step, after which a checkpoint is kept,
   !> or the writing of a result.
   subroutine set_patience(is_worth_it)
      logical, intent(in) :: is_worth_it

      is_patient = is_worth_it
   end subroutine set_patience

   !> Whether the program was asked to end.
   function is_interrupted() result(answer)
      logical :: answer

      answer = noted /= 0_c_int
   end function is_interrupted

   !> A signal has no effect from now on.
   recursive subroutine ignore(number)
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

   !> The handler of requests: notes the first one and sets the timer; ends the program on the
   !> second request of a user or batch system. (Others may come in numbers: SIGXCPU does each
   !> second, SIGHUP from terminal and shell.)
   recursive subroutine note(number) bind(c)
      integer(c_int), value :: number

      if (has_come(number) .and. (number == signal_interrupt &
         .or. number == signal_terminate)) call say_last_words()
      has_come(number) = .true.
      if (noted /= 0_c_int) return
      noted = number
      call set_timer(wall_timer, soon)
   end subroutine note

   !> The handler of the timer.
   recursive subroutine end_at_last(number) bind(c)
      integer(c_int), value :: number
      logical :: is_heard

      associate (unused => number)
      end associate
      if (is_patient .and. .not. is_waiting) then
         is_waiting = .true.
         call set_timer(wall_timer, patience)
         is_heard = tell(waiting_words, len(waiting_words), 0)
         return
      end if
      call say_last_words()
   end subroutine end_at_last

   !> Removes the files, prints the message if a reader takes it, and ends the program.
   recursive subroutine say_last_words()
      integer(c_int) :: status
      integer :: i
      logical :: is_heard

      call ignore(signal_alarm)
      associate (set => sets(current))
         do i = 1, set%files
            if (mark_of(set%names(i)) /= no_mark) status = c_unlink(set%names(i))
         end do
         is_heard = is_taken
         is_taken = .true.
         if (.not. is_heard) is_heard = tell(set%words, set%length, patience_for_words)
      end associate
      call c_exit(status_interrupted)
   end subroutine say_last_words

end module interruption

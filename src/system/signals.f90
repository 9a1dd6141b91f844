!> What signals do.
!>
!> SIGINT (Ctrl-C), SIGTERM, SIGHUP (the terminal was closed), SIGUSR1, SIGUSR2 and SIGXCPU (batch
!> systems) ask the program to end. It checks for the first request between cycles and time steps,
!> writes a checkpoint and ends. Where it does not check soon (a factorisation, a library, a large
!> file, a dry contact, which has nothing to keep) a timer ends it, and at once a second SIGINT or
!> SIGTERM: the message prepared for that is printed, files named with it go, and status 4 is left.
!>
!> Another timer counts the processor time since the last line: where the program would be silent
!> for long, its handler writes what is being done, and for how many seconds.
!>
!> Handlers have no arguments, so requests and words are module variables. They only call what POSIX
!> allows there (poll, write, unlink, open, lseek, pread, close, setitimer, signal, clock_gettime,
!> _exit), and allocate nothing. They may interrupt each other, so what they call is recursive.
module signals
   use, intrinsic :: iso_c_binding, only: c_char, c_funloc, c_funptr, c_int, c_intptr_t, c_long, &
      c_null_char, c_null_ptr, c_short, c_size_t
   use c_library, only: c_exit, c_poll, c_setitimer, c_signal, c_unlink, c_write, poll_t, &
      standard_error
   use disk_file, only: mark_of, no_mark
   use kinds, only: wp
   use text, only: shortened
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: begin_activity, begin_line, begin_subject, end_line, clear_exit_message, &
      is_interrupted, set_exit_message, listen_to_signals, set_patience, disarm_exit_message, &
      watch_silence

   !> Numbers of signals; SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ and SIGPROF as on Linux.
   integer(c_int), parameter :: signal_hangup = 1_c_int, signal_interrupt = 2_c_int, &
      signal_user_1 = 10_c_int, signal_user_2 = 12_c_int, signal_pipe = 13_c_int, &
      signal_alarm = 14_c_int, signal_terminate = 15_c_int, signal_processor_time = 24_c_int, &
      signal_file_size = 25_c_int, signal_silence = 27_c_int
   !> SIG_IGN as an address.
   integer(c_intptr_t), parameter :: ignore_address = 1_c_intptr_t
   !> ITIMER_REAL; ITIMER_PROF, the processor time of all threads.
   integer(c_int), parameter :: wall_timer = 0_c_int, processor_timer = 2_c_int
   !> Time within which the program checks for a request; that a time step or writing may take;
   !> silence that is broken; the shortest time between two such lines, for many threads [us].
   integer(c_long), parameter :: soon = 500000_c_long, patience = 20000000_c_long, &
      longest_silence = 4000000_c_long, one_second = 1000000_c_long
   !> Time for a reader to take the message [ms].
   integer, parameter :: patience_of_reader = 1000
   integer(c_int), parameter :: status_interrupted = 4_c_int
   !> Longest words, longest file name, and files to remove.
   integer, parameter :: longest_message = 9000, longest_name = 4200, max_files = 4
   !> Longest subject and activity, so that the line fits on a terminal.
   integer, parameter :: longest_subject = 20, longest_activity = longest_subject + 50
   character(*), parameter :: usual_message = 'asperity: interrupted'
   character(kind=c_char, len=*), parameter :: waiting_message = &
      'asperity: interrupted, ends when this time step or result is complete'//new_line('a')
   !> POLLOUT, and the bytes that a pipe which is ready takes without waiting (PIPE_BUF of Linux).
   integer(c_short), parameter :: is_ready = 4_c_short
   integer, parameter :: ready_bytes = 4096

   !> Number of the signal that came first; 0: none. Which ones came.
   integer(c_int), volatile :: noted = 0_c_int
   logical, volatile :: has_come(64) = .false.
   !> A checkpoint or a result is about to be written; that has been said.
   logical, volatile :: is_patient = .false., is_waiting = .false.
   !> The program prints the message itself: the handlers only end it.
   logical, volatile :: is_taken = .false.
   !> The message and its files, twice: one set is valid while the other is written.
   type :: exit_message_t
      integer :: length = 0, files = 0
      character(kind=c_char, len=longest_message) :: words = ''
      character(kind=c_char, len=longest_name) :: names(max_files) = ''
   end type exit_message_t
   type(exit_message_t) :: sets(2)
   integer, volatile :: current = 0

   !> Silence is broken; on a terminal, where that is no line of its own.
   logical, volatile :: is_watching = .false., is_updating = .false.
   !> The rest of the program writes a line, or changes the activity: the handler must wait.
   logical, volatile :: is_writing = .false.
   !> What is worked on, what is done with it, since when [s], and the clock at the last line.
   character(len=longest_subject) :: subject = ''
   character(kind=c_char, len=longest_activity), volatile :: activity = ''
   real(wp), volatile :: start = 0.0_wp, last_line = 0.0_wp
   !> Columns of the updating line that the handler has left on a terminal since the last line.
   integer, volatile, protected, public :: columns_of_sign = 0

contains

   !> From now on the first request is recorded instead of ending the program; a signal that was
   !> ignored (nohup, a job in the background) stays ignored. A closed pipe (SIGPIPE) and a write
   !> beyond the allowed size (SIGXFSZ, `ulimit -f`) fail instead of ending the program silently.
   subroutine listen_to_signals()
      integer(c_int), parameter :: requests(*) = [signal_hangup, signal_interrupt, &
         signal_terminate, signal_user_1, signal_user_2, signal_processor_time]
      type(c_funptr) :: previous
      integer :: i

      call ignore(signal_pipe)
      call ignore(signal_file_size)
      call clear_exit_message()
      previous = c_signal(signal_alarm, c_funloc(end_at_last))
      do i = 1, size(requests)
         previous = c_signal(requests(i), c_funloc(note))
         if (transfer(previous, ignore_address) == ignore_address) call ignore(requests(i))
      end do
   end subroutine listen_to_signals

   !> Sets the message and the files to remove if the program has to be ended from now on.
   subroutine set_exit_message(words, files)
      character(*), intent(in) :: words, files(:)
      integer :: i, next

      next = merge(2, 1, current == 1)
      associate (set => sets(next))
         set%words = words
         set%length = min(len(words) + 1, longest_message)
         set%words(set%length:set%length) = new_line('a')
         set%files = 0
         do i = 1, min(size(files), max_files)
            if (len_trim(files(i)) >= longest_name) cycle
            set%files = set%files + 1
            set%names(set%files) = trim(files(i))//c_null_char
         end do
      end associate
      current = next
   end subroutine set_exit_message

   !> Nothing is removed, and the message is only that the program was interrupted.
   subroutine clear_exit_message()
      call set_patience(.false.)
      call set_exit_message(usual_message, [character(len=1) ::])
   end subroutine clear_exit_message

   !> The program is about to say itself that it was interrupted: the handlers no longer say it, so
   !> that it is said once however long the rest of the end takes. `is_over`: all work is done, and
   !> the message is printed.
   subroutine disarm_exit_message(is_over)
      logical, intent(in) :: is_over

      ! first: time to say it, or none
      call set_timer(wall_timer, merge(0_c_long, merge(patience, soon, is_waiting), is_over))
      is_taken = .true.
   end subroutine disarm_exit_message

   !> Whether to wait for a time step with its checkpoint, or for the writing of a result.
   subroutine set_patience(is_worth_it)
      logical, intent(in) :: is_worth_it

      is_patient = is_worth_it
   end subroutine set_patience

   !> Whether the program was asked to end.
   logical function is_interrupted() result(answer)

      answer = noted /= 0_c_int
   end function is_interrupted

   !> A signal has no effect from now on.
   recursive subroutine ignore(number)
      integer(c_int), intent(in) :: number
      type(c_funptr) :: previous

      previous = c_signal(number, transfer(ignore_address, previous))
   end subroutine ignore

   !> The handler of requests: notes the first one and sets the timer; ends the program on a second
   !> SIGINT or SIGTERM. (Others come often: SIGXCPU each second, SIGHUP of terminal and shell.)
   recursive subroutine note(number) bind(c)
      integer(c_int), value :: number

      if (has_come(number) .and. (number == signal_interrupt &
         .or. number == signal_terminate)) call exit_with_message()
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
         is_heard = write_error_text(waiting_message, len(waiting_message), 0)
         return
      end if
      call exit_with_message()
   end subroutine end_at_last

   !> Removes the files, prints the message if a reader takes it, and ends the program.
   recursive subroutine exit_with_message()
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
         if (.not. is_heard) is_heard = write_error_text(set%words, set%length, patience_of_reader)
      end associate
      call c_exit(status_interrupted)
   end subroutine exit_with_message

   !> Begins to break silence. `updates`: on a terminal.
   subroutine watch_silence(updates)
      logical, intent(in) :: updates
      type(c_funptr) :: previous

      is_updating = updates
      is_watching = .true.
      previous = c_signal(signal_silence, c_funloc(give_sign))
      call end_line()
   end subroutine watch_silence

   !> What is being worked on from now on: the file of a case.
   subroutine begin_subject(file)
      character(*), intent(in) :: file

      subject = shortened(file(index(file, '/', back=.true.) + 1:), longest_subject)
   end subroutine begin_subject

   !> What is done from now on, as words behind "case.nml: ".
   subroutine begin_activity(words)
      character(*), intent(in) :: words
      character(len=longest_activity) :: next

      next = words
      if (subject /= '') next = trim(subject)//': '//words
      if (next == activity) return
      is_writing = .true.
      activity = next
      start = wall_seconds()
      is_writing = .false.
   end subroutine begin_activity

   !> A line is about to be written by others.
   subroutine begin_line()
      is_writing = .true.
   end subroutine begin_line

   !> The line is written: the timer starts again.
   subroutine end_line()
      columns_of_sign = 0
      last_line = wall_seconds()
      if (is_watching) call set_timer(processor_timer, longest_silence)
      is_writing = .false.
   end subroutine end_line

   !> The handler of silence: the activity and its seconds, on a terminal in place of the last line,
   !> which it covers. If the output is blocked or closed, it stays silent from then on.
   recursive subroutine give_sign(number) bind(c)
      integer(c_int), value :: number
      !> A carriage return before it, ', 999999 s' and a line feed behind it; columns to cover.
      character(kind=c_char, len=longest_activity + 12) :: line
      integer, parameter :: width = 80
      real(wp) :: now
      integer(c_long) :: power, seconds
      integer :: first, length

      associate (unused => number)
      end associate
      if (.not. is_watching) return
      now = wall_seconds()
      if (is_writing .or. now - last_line < 1.0_wp) then
         call set_timer(processor_timer, one_second)
         return
      end if
      line = achar(13)
      length = len_trim(activity) + 3
      line(2:) = activity
      line(length - 1:length) = ', '
      seconds = int(min(max(now - start, 1.0_wp), 999999.0_wp), c_long)
      power = 100000_c_long
      do while (power > seconds)
         power = power/10_c_long
      end do
      do while (power > 0_c_long)
         length = length + 1
         line(length:length) = achar(iachar('0') + int(modulo(seconds/power, 10_c_long)))
         power = power/10_c_long
      end do
      line(length + 1:length + 2) = ' s'
      length = merge(max(length + 2, width), length + 3, is_updating)
      first = merge(1, 2, is_updating)
      if (.not. is_updating) line(length:length) = new_line('a')
      is_watching = write_error_text(line(first:), length - first + 1, 0)
      last_line = now
      if (is_updating) columns_of_sign = length - 1
      if (is_watching) call set_timer(processor_timer, longest_silence)
   end subroutine give_sign

   !> Writes `text` of `length` characters to standard error as far as it is taken within `time`
   !> [ms] for each 4096: a handler must not wait for a reader that no longer reads.
   recursive logical function write_error_text(text, length, time) result(is_taken)
      character(kind=c_char), intent(in) :: text(*)
      integer, intent(in) :: length, time
      type(poll_t) :: place
      integer :: done, written

      done = 0
      is_taken = .true.
      do while (is_taken .and. done < length)
         place = poll_t(standard_error, is_ready, 0_c_short)
         is_taken = c_poll(place, 1_c_long, int(time, c_int)) == 1_c_int
         if (is_taken) is_taken = iand(place%found, is_ready) /= 0_c_short
         if (.not. is_taken) return
         written = int(c_write(standard_error, text(done + 1:length), int(min(length - done, &
            ready_bytes), c_size_t)))
         is_taken = written > 0
         done = done + written
      end do
   end function write_error_text

   !> The signal of `timer` after `time` [us].
   recursive subroutine set_timer(timer, time)
      integer(c_int), intent(in) :: timer
      integer(c_long), intent(in) :: time
      integer(c_int) :: status

      status = c_setitimer(timer, [0_c_long, 0_c_long, time/one_second, modulo(time, one_second)], &
         c_null_ptr)
   end subroutine set_timer

end module signals

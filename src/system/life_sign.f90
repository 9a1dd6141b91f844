!> A line where the program would be silent for long: what it is doing, and for how many seconds.
!>
!> Solvers report their cycles and steps, but reading, planning of transforms, factorising,
!> compressing and the like are calls of libraries, or loops without progress lines. So a timer
!> counts the processor time since the last line, and its signal handler writes the next one, with
!> the words that were set last.
!>
!> The module variables have the reason given in `interruption`, and the handler does no more than
!> that one: it calls time, poll, write and setitimer, and allocates nothing.
module life_sign
   use, intrinsic :: iso_c_binding, only: c_char, c_funloc, c_funptr, c_int, c_long, c_null_ptr
   use quantity_text, only: shortened
   use signal_calls, only: c_signal, c_time, one_second, set_timer, tell
   implicit none (type, external)
   private

   public :: begin_activity, begin_line, begin_subject, end_line, watch_silence

   !> ITIMER_PROF, processor time of all threads, and its signal, with the number of Linux.
   integer(c_int), parameter :: processor_timer = 2_c_int, signal_timer = 27_c_int
   !> Silence that is broken [us of processor time]. Many threads spend it fast: at most one line a
   !> second.
   integer(c_long), parameter :: longest_silence = 4000000_c_long
   !> Longest subject and words, so that the line fits on a terminal.
   integer, parameter :: longest_subject = 20, longest_words = 48, longest_line = longest_subject &
      + longest_words + 11
   character(kind=c_char), parameter :: carriage_return = achar(13), blank = ' ', &
      line_end = new_line('a')

   logical, volatile :: is_watching = .false., is_updating = .false.
   !> The rest of the program is writing a line: none may come in between.
   logical, volatile :: is_writing = .false.
   !> What is being worked on, and what is done with it; both twice: one is valid while the other
   !> one is written.
   type :: activity_t
      integer :: length = 0
      character(kind=c_char, len=longest_line) :: words = ''
      integer(c_long) :: start = 0_c_long
   end type activity_t
   type(activity_t) :: activities(2)
   integer, volatile :: current = 1
   character(len=longest_subject) :: subject = ''
   !> Clock at the last line [s].
   integer(c_long), volatile :: last_line = 0_c_long
   !> Columns of the updating line that the handler has left on a terminal since the last line.
   integer, volatile, protected, public :: columns_of_sign = 0

contains

   !> Starts the timer. `updates`: on a terminal, where a sign is no line of its own.
   subroutine watch_silence(updates)
      logical, intent(in) :: updates
      type(c_funptr) :: previous

      is_updating = updates
      is_watching = .true.
      previous = c_signal(signal_timer, c_funloc(give_sign))
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
      integer :: next

      next = 3 - current
      associate (activity => activities(next), present => activities(current))
         activity%words = words
         if (len_trim(subject) > 0) activity%words = trim(subject)//': '//words
         activity%length = len_trim(activity%words)
         if (activity%length > longest_line - 9) activity%length = longest_line - 9
         if (activity%words == present%words) return
         activity%start = c_time(c_null_ptr)
      end associate
      current = next
   end subroutine begin_activity

   !> A line is about to be written by others.
   subroutine begin_line()
      is_writing = .true.
   end subroutine begin_line

   !> The line is written: the timer starts again.
   subroutine end_line()
      columns_of_sign = 0
      last_line = c_time(c_null_ptr)
      if (is_watching) call set_timer(processor_timer, longest_silence)
      is_writing = .false.
   end subroutine end_line

   !> The handler of the timer. If the output is blocked or closed, it stays silent from then on.
   subroutine give_sign(number) bind(c)
      integer(c_int), value :: number
      character(kind=c_char) :: line(longest_line + 2)
      integer(c_long) :: now
      integer :: length

      associate (unused => number)
      end associate
      if (.not. is_watching) return
      now = c_time(c_null_ptr)
      if (is_writing .or. now == last_line) then
         call set_timer(processor_timer, one_second)
         return
      end if
      call compose(activities(current), now, line, length)
      is_watching = tell(line, length, 0)
      last_line = now
      if (is_updating) columns_of_sign = length - 1
      if (is_watching) call set_timer(processor_timer, longest_silence)
   end subroutine give_sign

   !> The line of an activity: on a terminal in place of the last one, which it covers.
   subroutine compose(activity, now, line, length)
      type(activity_t), intent(in) :: activity
      integer(c_long), intent(in) :: now
      character(kind=c_char), intent(out) :: line(:)
      integer, intent(out) :: length
      integer(c_long) :: rest
      integer :: digits, i

      length = 0
      if (is_updating) call put(carriage_return)
      do i = 1, activity%length
         call put(activity%words(i:i))
      end do
      call put(',')
      call put(blank)
      rest = min(max(now - activity%start, 1_c_long), 999999_c_long)
      digits = 1
      do while (rest >= 10_c_long**digits)
         digits = digits + 1
      end do
      do i = digits - 1, 0, -1
         call put(achar(iachar('0') + int(modulo(rest/10_c_long**i, 10_c_long))))
      end do
      call put(blank)
      call put('s')
      if (.not. is_updating) call put(line_end)
      do while (is_updating .and. length < longest_line + 1)
         call put(blank)
      end do

   contains

      !> One character more.
      subroutine put(symbol)
         character(kind=c_char), intent(in) :: symbol

         length = length + 1
         line(length) = symbol
      end subroutine put

   end subroutine compose

end module life_sign

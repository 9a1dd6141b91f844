!> What the user sees while a case runs, on standard error, and its summary when it is done, on
!> standard output (Fortran's own output reports no full device and no closed pipe): the only module
!> under src/ that prints.
!>
!> On a terminal one updated line, in a log few lines, with `is_quiet` only what went wrong. A
!> closed standard error is no reason to stop: that write is dropped; a lost summary is reported.
module progress_log
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char, c_size_t
   use, intrinsic :: iso_fortran_env, only: error_unit, int64
   use c_library, only: c_close, c_isatty, c_open, c_write, standard_error, standard_output
   use errors, only: error_t, fail, output_error
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use quantities, only: parabola_minimum
   use text, only: duration_text, number_text, prefixed_text, shortened
   use scaling, only: scaling_t
   use signals, only: begin_line, columns_of_sign, end_line
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: is_terminal, new_progress_log, print_text, progress_log_t, settle_standard_streams, &
      write_text

   character(*), parameter :: lost = 'cannot write to standard output: the disk is full, or '// &
      'nobody reads it'
   !> Columns of a terminal that are used.
   integer, parameter, public :: columns = 80
   !> Longest name of a case in front of a progress line [columns].
   integer, parameter :: name_columns = 20
   !> Time between two updates on a terminal [s].
   real(wp), parameter :: update_seconds = 0.1_wp
   !> Longest silence in a log during cycles and steps [s], less than that which `signals` breaks.
   real(wp), parameter :: log_seconds = 3.0_wp

   !> Progress of one case after another.
   type :: progress_log_t
      !> Unit that is written.
      integer :: unit = error_unit
      !> Only failures are reported.
      logical :: is_quiet = .false.
      !> Closing tables are whole.
      logical :: is_verbose = .false.
      !> One updating line instead of lines.
      logical :: is_updating = .false.
      !> Summaries go to standard output, not to `unit`.
      logical :: has_summary_apart = .false.
      !> Closing tables say times in seconds.
      logical :: in_seconds = .false.
      !> The case: its file, the name of that, and its scales.
      character(:), allocatable :: file, name
      type(scaling_t) :: scaling
      !> Columns of the updating line now on the screen.
      integer, private :: shown = 0
      !> Clock [s] at the last line and at the start of the time steps.
      real(wp), private :: last_line = -huge(1.0_wp)
      real(wp), private :: steps_start = 0.0_wp
      !> Step at which they started; -1: they have not.
      integer, private :: first_step = -1
   contains
      procedure :: on_cycle, on_step, say, say_error, print_summary, prints_errors_apart, write_line
      procedure, private :: is_due, update, replace
   end type progress_log_t

contains

   !> A log on standard error, with its summaries on standard output unless that has other lines.
   function new_progress_log(is_quiet, has_other_lines) result(log)
      logical, intent(in) :: is_quiet
      logical, intent(in), optional :: has_other_lines
      type(progress_log_t) :: log

      log%is_quiet = is_quiet
      log%is_updating = is_terminal(standard_error)
      log%has_summary_apart = .true.
      if (present(has_other_lines)) log%has_summary_apart = .not. has_other_lines
   end function new_progress_log

   !> In a log cycles 1, 2, 4, 8, ... and after a long silence; on a terminal ten a second at most.
   subroutine on_cycle(self, words, cycle, residual, load_error)
      class(progress_log_t), intent(inout) :: self
      character(*), intent(in) :: words
      integer, intent(in) :: cycle
      real(wp), intent(in) :: residual, load_error

      if (self%is_due(merge(cycle == 1, popcnt(cycle) == 1, self%is_updating))) call self%update( &
         words//' '//number_text(real(cycle, wp), 9)//'  residual '//number_text(residual, 3) &
         //'  load error '//number_text(load_error, 3))
   end subroutine on_cycle

   !> Whether a cycle or step is shown: one with a mark, or any after a long silence.
   logical function is_due(self, has_mark)
      class(progress_log_t), intent(in) :: self
      logical, intent(in) :: has_mark

      is_due = .not. self%is_quiet
      if (is_due .and. .not. has_mark) is_due = wall_seconds() - self%last_line &
         >= merge(update_seconds, log_seconds, self%is_updating)
   end function is_due

   !> Step, time, smallest film and remaining time in one line: in a log every tenth of the way and
   !> after a long silence; on a terminal ten a second at most.
   subroutine on_step(self, step, steps, state, report)
      class(progress_log_t), intent(inout) :: self
      integer, intent(in) :: step, steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      character(:), allocatable :: line
      real(wp) :: film
      logical :: is_tenth

      if (self%first_step < 0) then
         self%first_step = step
         self%steps_start = wall_seconds()
         self%last_line = self%steps_start
      end if
      if (step == self%first_step) return
      is_tenth = 10_int64*step/steps > 10_int64*(step - 1)/steps
      if (.not. self%is_due(is_tenth .and. .not. self%is_updating)) return
      film = minval(state%film_thickness)
      if (.not. allocated(state%y)) film = parabola_minimum(state%x, state%film_thickness)
      line = 'step '//number_text(real(step, wp), 9)//'/'//number_text(real(steps, wp), 9)//'  T ' &
         //number_text(state%time, 4)
      if (self%scaling%is_dimensional) then
         line = line//'  h_min '//prefixed_text(film*self%scaling%film, 'm')
      else
         line = line//'  H_min '//number_text(film, 4)
      end if
      if (report%residual > report%tolerance_effective) line = line//'  residual ' &
         //number_text(report%residual, 2)
      call self%update(line//'  '//duration_text((wall_seconds() - self%steps_start) &
         *real(steps - step, wp)/real(step - self%first_step, wp))//' left')
   end subroutine on_step

   !> Whether errors are printed apart from the summary, which may be quiet or have another reader.
   logical function prints_errors_apart(self)
      class(progress_log_t), intent(in) :: self

      prints_errors_apart = self%is_quiet
      if (self%has_summary_apart .and. .not. prints_errors_apart) prints_errors_apart = &
         .not. (is_terminal(standard_output) .and. is_terminal(standard_error))
   end function prints_errors_apart

   !> Prints the lines of a summary, unless quiet.
   subroutine print_summary(self, lines)
      class(progress_log_t), intent(inout) :: self
      character(*), intent(in) :: lines
      type(error_t), allocatable :: error

      if (self%is_quiet) return
      if (self%has_summary_apart) then
         call self%replace('')
         call begin_line()
         call write_text(lines//new_line('a'), error)   ! error: said below
         call end_line()
         if (allocated(error)) call self%say_error(error%message)
      else
         call self%write_line(lines)
      end if
   end subroutine print_summary

   !> One line, unless quiet.
   subroutine say(self, message)
      class(progress_log_t), intent(inout) :: self
      character(*), intent(in) :: message

      if (.not. self%is_quiet) call self%write_line(message)
   end subroutine say

   !> Something went wrong: `message` as it is, in any case.
   subroutine say_error(self, message)
      class(progress_log_t), intent(inout) :: self
      character(*), intent(in) :: message

      call self%write_line('asperity: '//message)
   end subroutine say_error

   !> Shows `line` behind the name of the case: in place on a terminal, as a line in a log.
   subroutine update(self, line)
      class(progress_log_t), intent(inout) :: self
      character(*), intent(in) :: line
      character(:), allocatable :: full

      full = shortened(self%name, name_columns)//': '//line
      self%last_line = wall_seconds()
      if (self%is_updating) then
         call self%replace(full(:min(len(full), columns - 1)))
      else
         call self%write_line(full)
      end if
   end subroutine update

   !> Puts `text` in place of the updating line, if there is any; with '' another may follow there.
   subroutine replace(self, text)
      class(progress_log_t), intent(inout) :: self
      character(*), intent(in) :: text
      integer :: status

      call begin_line()
      self%shown = max(self%shown, columns_of_sign)
      if (self%shown + len(text) > 0) write (self%unit, '(3a)', advance='no', iostat=status) &
         achar(13), text, repeat(' ', max(self%shown - len(text), 0))
      if (self%shown > 0 .and. text == '') write (self%unit, '(a)', advance='no', iostat=status) &
         achar(13)
      flush (self%unit, iostat=status)
      self%shown = len(text)
      call end_line()
   end subroutine replace

   !> Writes one or more whole lines, in place of the updating one.
   subroutine write_line(self, line)
      class(progress_log_t), intent(inout) :: self
      character(*), intent(in) :: line
      integer :: status

      call self%replace('')
      call begin_line()
      write (self%unit, '(a)', iostat=status) line
      flush (self%unit, iostat=status)
      call end_line()
   end subroutine write_line

   !> Prints `text` and closes standard output, unless there is an error. Error: some of it is lost.
   subroutine print_text(text, error)
      character(*), intent(in) :: text
      type(error_t), allocatable, intent(inout) :: error

      call write_text(text, error)
      if (allocated(error)) return
      ! some file systems report a full disk only here
      if (c_close(standard_output) /= 0_c_int) call fail(error, output_error, lost)
   end subroutine print_text

   !> The same, but leaves standard output open.
   subroutine write_text(text, error)
      character(*), intent(in) :: text
      type(error_t), allocatable, intent(inout) :: error
      integer(c_size_t) :: done, written

      done = 0_c_size_t
      do while (done < len(text) .and. .not. allocated(error))
         written = c_write(standard_output, text(done + 1:), len(text) - done)
         if (written <= 0_c_size_t) call fail(error, output_error, lost)
         done = done + written
      end do
   end subroutine write_text

   !> Opens closed standard streams on /dev/null: else messages would go into the next file opened.
   subroutine settle_standard_streams()
      integer(c_int) :: descriptor

      do
         descriptor = c_open('/dev/null'//c_null_char, 0_c_int)   ! O_RDONLY
         if (descriptor < 0_c_int .or. descriptor > standard_error) exit
      end do
      if (descriptor > standard_error) descriptor = c_close(descriptor)
   end subroutine settle_standard_streams

   !> Whether a file descriptor is a terminal.
   logical function is_terminal(descriptor) result(answer)
      integer(c_int), intent(in) :: descriptor

      answer = c_isatty(descriptor) == 1_c_int
   end function is_terminal

end module progress_log

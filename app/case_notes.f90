!> Notes on a case, for the log and the result: unusual values; how long a transient takes; grids
!> and time steps of a lubricated case that are too coarse, a wanted accuracy that is not reached.
module case_notes
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use case_record, only: case_t
   use domain_choice, only: find_finest_moment
   use iteration_report, only: report_t
   use kinds, only: exceeds, wp
   use line_contact, only: rough_contact_t
   use line_summary, only: line_summary_t
   use passage_times, only: passage_note
   use quantities, only: h_min, quantity_count, quantity_rows
   use run_observer, only: run_observer_t
   use text, only: add_sentence, duration_text, prefixed_text, to_text
   use wave_resolution, only: coarse_waves, intervals_at_least, long_steps
   implicit none (type, external)
   private

   public :: note_case, note_missed_error, note_unusual, time_text, unusual_text

   !> Relative excess of an error over the target that counts as rounding.
   real(wp), parameter :: rounding = 1.0e-6_wp
   !> Processor time of one interval in one time step [s]: 0.4e-6 of a smooth wave to 1.2e-6 of
   !> roughness, measured on a server core; and what error bars add to it.
   real(wp), parameter :: step_seconds = 1.0e-6_wp, error_bars_share = 0.5_wp
   !> A grid is told as coarse for a duty if a moment needs more than this many times its intervals.
   real(wp), parameter :: coarse_duty = 2.0_wp
   !> Runs that take longer are announced by --check, and say first what would shorten them [s].
   real(wp), parameter, public :: minute = 60.0_wp, hour = 3600.0_wp

contains

   !> The processor time that a transient of Reynolds' equation is expected to take, from `least`
   !> [s] on, and from an hour on what would make it shorter. Empty: it is less, or not known, as of
   !> steady cases, other equations, and a grid that trial runs choose.
   pure function time_text(case, least) result(words)
      type(case_t), intent(in) :: case
      real(wp), intent(in) :: least
      character(:), allocatable :: words
      real(wp) :: seconds, steps

      words = ''
      if (.not. case%time%is_transient .or. case%layers > 0 .or. case%solver%target > 0) return
      steps = case%time%end_time/case%time%time_step
      seconds = step_seconds*case%contact%domain%intervals*steps
      if (case%solver%wants_coarse_runs) seconds = (1 + error_bars_share)*seconds
      if (seconds < least) return
      words = 'about '//duration_text(seconds)//': '//to_text(case%contact%domain%intervals)// &
         ' intervals, '//to_text(steps, 3)//' time steps'
      if (seconds < hour) return
      words = words//'. Without the finest waves (cutoff_short, harmonics, wavelength_short) '// &
         'or with fewer &domain intervals, half the grid takes a quarter of the time; a shorter'// &
         ' profile or an earlier end in proportion. The smooth contact (no surfaces, '// &
         'transient = .false.) takes a second'
   end function time_text

   !> Behind each other the lines on the unusual values, each with file and line.
   pure function unusual_text(case) result(lines)
      type(case_t), intent(in) :: case
      character(:), allocatable :: lines
      integer :: i

      lines = ''
      do i = 1, size(case%unusual)
         lines = lines//new_line('a')//case%file//':'//to_text(abs(case%unusual(i)%line))//': ' &
            //case%unusual(i)%words//trim(case%unusual(i)%question)
      end do
   end function unusual_text

   !> Begins the note of the result with what is unusual; not allocated: nothing.
   pure subroutine note_unusual(case, note)
      type(case_t), intent(in) :: case
      character(:), allocatable, intent(out) :: note
      integer :: i

      do i = 1, size(case%unusual)
         call add_sentence(note, case%unusual(i)%words)
      end do
   end subroutine note_unusual

   !> Notes what is unusual, where grid or time step of a `contact` are too coarse for its waves or
   !> the thinnest film of a duty (a wanted accuracy chooses both by h_min), and which times count.
   subroutine note_case(case, contact, listener)
      type(case_t), intent(in) :: case
      class(rough_contact_t), intent(in) :: contact
      type(run_observer_t), intent(inout) :: listener
      character(:), allocatable :: words
      real(wp) :: spacing, wanted, when

      call note_unusual(case, listener%note)
      call listener%add_note(case%note)
      if (.not. case%solver%target > 0.0_wp) then
         words = coarse_waves(contact, case%time)
         if (words == '' .and. case%solver%wants_coarse_runs) words = long_steps(contact, case%time)
         call listener%add_note(words)
         if (allocated(case%contact%duty)) then   ! of a point error bars tell
            call find_finest_moment(case%contact, when, spacing)
            associate (domain => case%contact%domain)
               wanted = (domain%x_outlet - domain%x_inlet)/spacing
               if (wanted > coarse_duty*domain%intervals) call listener%add_note('the film at ' &
                  //prefixed_text(when*case%scaling%time, 's')//' needs ' &
                  //to_text(intervals_at_least(wanted))//' intervals for 1 %, the grid has ' &
                  //to_text(domain%intervals))
            end associate
         end if
      end if
      call listener%add_note(passage_note(contact, listener%writer%run%passage%times))
   end subroutine note_case

   !> Notes an error of `summary` that is above the target: of a steady contact that which misses it
   !> by most in the closing table, in time that of h_min, if it was measured; on a given inlet the
   !> target is that of grid and time step alone. Of a point contact that of its films.
   subroutine note_missed_error(case, listener, summary, report)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report
      character(:), allocatable :: found
      real(wp) :: error, worst
      logical :: counts(quantity_count), in_time   ! a line
      integer :: i

      if (.not. report%converged) return
      if (case%time%is_transient .and. .not. case%solver%wants_coarse_runs) return
      in_time = case%time%is_transient .and. .not. allocated(case%point)
      worst = (1.0_wp + rounding)*case%solver%target
      found = ''
      counts = quantity_rows%short /= '' .and. .not. in_time
      if (allocated(case%point)) counts = quantity_rows%short(:2) == 'h_'
      do i = 1, size(summary%of)
         if (.not. all([counts(i), exceeds(summary%of(i)%value, 0.0_wp)])) cycle
         error = summary%of(i)%error_estimate/summary%of(i)%value
         if (error <= worst) cycle
         found = ' of '//trim(quantity_rows(i)%short)//': no error is estimated'
         if (.not. ieee_is_finite(error)) exit
         worst = error
         found = ' of '//trim(quantity_rows(i)%short)//': a relative error of '//to_text(error, 2) &
            //' is estimated'
      end do
      if (in_time) then
         associate (film => summary%of(h_min))
            error = merge(film%error_grid, film%error_estimate, case%domain%has_inlet)/film%value
         end associate
         if (exceeds(error, worst)) found = ': a relative error of h_min of '//to_text(error, 2) &
            //' is estimated'
      end if
      if (found /= '') call listener%add_note('the target accuracy is not shown'//found//', ' &
         //to_text(case%solver%target, 2)//' is the target')
   end subroutine note_missed_error

end module case_notes

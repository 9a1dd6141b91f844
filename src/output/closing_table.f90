!> What is printed of a lubricated case at its end: outcome, quantities; and of a film breakdown.
module closing_table
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use hdf5_dataset, only: label_t
   use iteration_report, only: breakdown_t, report_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use missing_value, only: exceeds
   use passage_times, only: passage_times_t
   use progress_log, only: columns, progress_log_t
   use quantities, only: friction_coefficient, h_central, h_min, p_central, p_max, quantity_rows
   use quantity_text, only: number_text, prefixed_text, wrapped
   use result_labels, only: row_label
   use scaling, only: scaling_t
   use text, only: counted
   use validity, only: limit_t
   use validity_section, only: limit_sentence
   use validity_table, only: starvation
   implicit none (type, external)
   private

   public :: breakdown_sentence, close_case, closing_words_t, spike_lines

   !> Rows of the closing table: the pressure away from a spike before that of the spike.
   integer, parameter :: table_rows(*) = [h_min, h_central, p_central, p_max, friction_coefficient]
   !> A largest pressure with a smaller relative error is shown alone.
   real(wp), parameter :: well_known = 0.01_wp
   !> Columns before the words of a row.
   integer, parameter :: margin = 12

   !> What others say in the closing table; not allocated or empty: nothing.
   type :: closing_words_t
      !> What a spike means for p_max; films by formulas; effects of ingredients; what was left out.
      character(:), allocatable :: spike, formulas, model, decision
   end type closing_words_t

contains

   !> The outcome, and the closing table: quantities in SI and dimensionless with their errors,
   !> residuals, limits of the model that are passed, what others say (`words`), path of the result.
   subroutine close_case(log, summary, report, path, times, limits, words)
      type(progress_log_t), intent(inout) :: log
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report
      character(*), intent(in) :: path
      type(passage_times_t), intent(in) :: times
      type(limit_t), intent(in), optional :: limits(:)
      type(closing_words_t), intent(in), optional :: words
      character(:), allocatable :: outcome
      integer :: i

      call log%clear()
      outcome = wrapped(log%name//': '//outcome_text(report, log%is_quiet), columns)
      if (.not. report%converged .and. log%prints_errors_apart()) call log%write_line(outcome)
      if (log%is_quiet) return
      call log%add_to_summary(outcome)
      ! else no start was found: there is nothing to show
      if (exceeds(summary%of(p_max)%value, 0.0_wp)) then
         call log%add_to_summary('            SI              dimensionless')
         do i = 1, size(table_rows)
            if (is_in_table(summary, table_rows(i))) call log%add_to_summary( &
               row_of_table(table_rows(i), summary, log%scaling, report%steps > 0))
         end do
         if (present(words)) then
            call add_words(log, words%spike)
            call add_words(log, words%formulas)
         end if
         call log%add_to_summary('  residual  '//number_text(report%residual, 2) &
            //'   load error '//number_text(report%load_error, 2)//'   bound ' &
            //number_text(report%tolerance_effective, 2))
      end if
      if (present(limits)) then
         do i = 1, size(limits)
            if (limits(i)%is_passed) call log%add_to_summary('  '//wrapped(merge('inlet     ', &
               'limit     ', i == starvation)//limit_sentence(i, limits(i)), columns - 2))
         end do
      end if
      if (times%counts_from > 0.0_wp) call log%add_to_summary('  times     '//times_text(times))
      if (present(words)) then
         call add_words(log, words%model)
         call add_words(log, words%decision)
      end if
      if (allocated(report%note)) call log%add_to_summary('  '//wrapped('note      ' &
         //report%note, columns - 2))
      call log%add_to_summary('  result    '//path)
      call log%print_summary()
   end subroutine close_case

   !> The row of quantity `i` of a steady contact or of one in time.
   function row_of_table(i, summary, scaling, is_transient) result(line)
      integer, intent(in) :: i
      type(line_summary_t), intent(in) :: summary
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: is_transient
      character(:), allocatable :: line
      character(len=72) :: row
      type(label_t) :: scale

      associate (quantity => summary%of(i))
         scale = row_label(trim(quantity_rows(i)%field), scaling)
         row = '  '//quantity_rows(i)%short
         row(13:) = '-'
         if (scale%si_units /= '1') then
            row(13:) = prefixed_text(quantity%value*scale%si_scale, scale%si_units)
         else if (scaling%is_dimensional) then
            row(13:) = number_text(quantity%value*scale%si_scale, 4)
         end if
         row(29:) = number_text(quantity%value, 6)
         if (row(39:39) /= ' ') row(29:) = number_text(quantity%value, 5)
         if (ieee_is_finite(quantity%error_estimate) .and. abs(quantity%value) > 0.0_wp) then
            row(40:) = '+- '//number_text(100*abs(quantity%error_estimate/quantity%value), 2)//' %'
         else if (ieee_is_finite(summary%of(h_min)%error_estimate)) then
            row(40:) = '+- not known'
         end if
         if (is_transient .and. ieee_is_finite(quantity%time)) row(53:) = 'at T ' &
            //number_text(quantity%time, 4)
      end associate
      line = trim(row)
   end function row_of_table

   !> How a run has ended, and what it took unless it failed and `is_short`.
   function outcome_text(report, is_short) result(outcome)
      type(report_t), intent(in) :: report
      logical, intent(in) :: is_short
      character(:), allocatable :: outcome

      outcome = 'converged'
      if (.not. report%converged) outcome = 'NOT CONVERGED'
      if (.not. report%converged .and. allocated(report%reason)) outcome = outcome//': ' &
         //trim(report%reason)
      if (.not. report%converged .and. is_short) return
      outcome = outcome//', '//counted(report%cycles, 'cycle')
      if (report%steps > 0) outcome = outcome//' in '//counted(report%steps, 'time step')
      if (report%fit%uncut_steps > 0) outcome = outcome//' (' &
         //number_text(real(report%fit%uncut_steps, wp), 9)//' of the start not cut into parts)'
      outcome = outcome//', '//number_text(report%cost%wall_seconds, 3)//' s'
      if (report%cost%peak_memory > 0.0_wp) outcome = outcome//', ' &
         //prefixed_text(report%cost%peak_memory, 'B')
   end function outcome_text

   !> Whether a quantity of the table has its row: not friction where nothing slides, nor the
   !> central pressure where the largest one is well known.
   pure logical function is_in_table(summary, i)
      type(line_summary_t), intent(in) :: summary
      integer, intent(in) :: i

      is_in_table = .true.
      if (i == friction_coefficient) is_in_table = exceeds(summary%of(i)%value, 0.0_wp)
      if (i == p_central) is_in_table = is_central_shown(summary)
   end function is_in_table

   !> Adds what others say: lines that begin with a blank as they are, others wrapped.
   subroutine add_words(log, lines)
      type(progress_log_t), intent(inout) :: log
      character(:), allocatable, intent(in) :: lines

      if (.not. allocated(lines)) return
      if (len_trim(lines) == 0) return
      if (lines(1:1) == ' ') then
         call log%add_to_summary(lines)
      else
         call log%add_to_summary('  '//wrapped(lines, columns - 2, margin))
      end if
   end subroutine add_words

   !> Which times count.
   function times_text(times) result(words)
      type(passage_times_t), intent(in) :: times
      character(:), allocatable :: words

      words = 'T '//number_text(times%counts_from, 4)//' to '//number_text(times%end_time, 4) &
         //' count'
      if (times%period > 0.0_wp) words = words//', periods of '//number_text(times%period, 4)
      if (times%settled_from > 0.0_wp) words = words//'; the start is forgotten by T ' &
         //number_text(times%settled_from, 4)
   end function times_text

   !> Whether p_central is shown: p_max is not known to 1 %, nor half as well as p_central.
   pure logical function is_central_shown(summary) result(is_shown)
      type(line_summary_t), intent(in) :: summary

      associate (central => summary%of(p_central), largest => summary%of(p_max))
         is_shown = ieee_is_finite(central%error_estimate)
         if (is_shown .and. ieee_is_finite(largest%error_estimate)) is_shown = &
            largest%error_estimate > max(well_known*largest%value, 2*central%error_estimate)
      end associate
   end function is_central_shown

   !> Which pressure to take and how to have the other, as lines of the table; empty where no spike
   !> is the reason. `is_asked`: &accuracy target_p_max is given; `is_steady`: else it cannot be;
   !> `has_intervals`: &domain intervals is given, which does not go with it.
   pure function spike_lines(summary, is_asked, is_steady, has_intervals) result(lines)
      type(line_summary_t), intent(in) :: summary
      logical, intent(in) :: is_asked, is_steady, has_intervals
      character(:), allocatable :: lines
      real(wp) :: spike

      lines = ''
      spike = merge(summary%crests%corner, 0.0_wp, summary%crests%corner_top > 0.0_wp)
      if (ieee_is_finite(summary%crests%spike)) spike = summary%crests%spike
      if (.not. is_central_shown(summary) .or. .not. spike > 0.0_wp) return
      if (spike < summary%of(p_max)%value) then
         lines = 'a pressure spike near the outlet is narrower than this grid, and on finer' &
            //' ones may rise above p_max'
      else
         lines = 'p_max is the top of a pressure spike near the outlet that is narrower than' &
            //' this grid, and rises on finer ones'
      end if
      lines = '  spike     '//lines//'; p_central is the pressure beside it, at X = 0'
      if (.not. is_steady) lines = lines//'. More &domain intervals show more of it'
      if (is_steady .and. .not. is_asked) then
         lines = lines//'. For a p_max that is known to 1 %'
         if (has_intervals) lines = lines//', without &domain intervals'
         lines = lines//':'
      end if
      lines = wrapped(lines, columns, margin)
      if (is_steady .and. .not. is_asked) lines = lines//new_line('a')//repeat(' ', margin) &
         //'--set accuracy.target=0.01 --set accuracy.target_p_max=0.01'
   end function spike_lines

   !> The first film below the floor: 'film breakdown at x = -31.2 um (X = -0.2950), t = ...'.
   pure function breakdown_sentence(breakdown, film_floor, scaling) result(sentence)
      type(breakdown_t), intent(in) :: breakdown
      real(wp), intent(in) :: film_floor
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: sentence

      sentence = 'film breakdown at x = '//prefixed_text(breakdown%position*scaling%half_width, &
         'm')//' (X = '//number_text(breakdown%position, 4) &
         //'), t = '//prefixed_text(breakdown%time*scaling%time, 's') &
         //' (T = '//number_text(breakdown%time, 4) &
         //', time step '//number_text(real(breakdown%step, wp), 9)//'): '
      if (breakdown%film > 0.0_wp) then
         sentence = sentence//'film '//prefixed_text(breakdown%film*scaling%film, 'm') &
            //', below film_floor = '//prefixed_text(film_floor*scaling%film, 'm')
      else
         sentence = sentence//'the film would close'
      end if
   end function breakdown_sentence

end module closing_table

!> What is printed of a lubricated case at its end: outcome, quantities; and of a film breakdown.
module closing_table
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use adequacy_section, only: decision_lines, model_line
   use case_record, only: case_t
   use field_sections, only: formula_lines
   use hdf5_dataset, only: label_t
   use iteration_report, only: breakdown_t, ending_text, has_converged, report_t
   use kinds, only: exceeds, not_known, wp
   use line_summary, only: line_summary_t, mean_power
   use passage_times, only: passage_times_t
   use progress_log, only: columns, progress_log_t
   use quantities, only: asperity_share, boundary_friction, film_rise, &
      friction_coefficient, h_central, h_min, oil_friction, p_central, p_max, quantity_rows, &
      rise_1, rise_2
   use result_labels, only: row_label
   use result_writer, only: result_writer_t
   use scaling, only: scaling_t
   use text, only: count_of, counted, number_text, prefixed_text, wrapped
   use validity, only: limit_count, limit_rows, limit_t, mixed_lubrication, shear_heating, &
      starvation
   implicit none (type, external)
   private

   public :: breakdown_sentence, close_case, limit_sentence

   !> Rows of the closing table: the pressure away from a spike before that of the spike.
   integer, parameter :: lambda_ratio = 0, table_rows(*) = [h_min, h_central, lambda_ratio, &
      p_central, p_max, friction_coefficient]
   !> A largest pressure with a smaller relative error is shown alone.
   real(wp), parameter :: well_known = 0.01_wp
   !> Columns before the words of a row.
   integer, parameter :: margin = 12
   !> The largest temperature rise that is printed as it is [K].
   real(wp), parameter :: hottest = 999.0_wp

   !> Lines of the table, unless it is to be whole.
   integer, parameter :: most_lines = 12
   character(*), parameter :: nl = new_line('a')

contains

   !> The outcome, and the closing table: contact, quantities with their errors, limits of the model
   !> that are passed, what its model could do without, path of the result. Of more than
   !> `most_lines` the last are left out, unless the log is verbose.
   subroutine close_case(log, case, writer, report)
      type(progress_log_t), intent(inout) :: log
      type(case_t), intent(in) :: case
      type(result_writer_t), intent(in) :: writer
      type(report_t), intent(in) :: report
      character(:), allocatable :: head, body
      real(wp) :: ratio
      integer :: i

      ratio = not_known()
      if (allocated(writer%limits)) ratio = writer%limits(mixed_lubrication)%value
      head = wrapped(log%name//': '//outcome_text(report, log%is_quiet), columns)
      if (all([report%outcome() /= has_converged, log%prints_errors_apart()])) call &
         log%write_line(head)
      if (log%is_quiet) return
      head = head//nl
      ! else no start was found: there is nothing to show
      if (exceeds(writer%summary%of(p_max)%value, 0.0_wp)) head = head//rows_of(writer%summary, &
         ratio, report, log)
      body = ''
      associate (summary => writer%summary, adequacy => writer%adequacy, &
         times => writer%run%passage%times)
         call add_physics(body, summary, log)
         if (log%is_verbose) then
            call add_words(body, spike_lines(case, summary))
            if (writer%has_formulas) call add_words(body, formula_lines(case%contact, summary, &
               log%scaling))
         end if
         if (allocated(writer%limits)) then
            do i = 1, limit_count
               if (.not. writer%limits(i)%is_passed) cycle
               if (all([report%is_mixed, i == mixed_lubrication])) cycle   ! the outcome names it
               call add_words(body, merge('inlet     ', 'limit     ', i == starvation) &
                  //limit_sentence(i, writer%limits(i)))
            end do
         end if
         if (all([log%is_verbose, times%counts_from > 0.0_wp])) call add_words(body, 'times     ' &
            //times_text(times))
         call add_words(body, decision_lines(writer%choice, adequacy, log%is_verbose))
         if (allocated(report%note)) call add_words(body, 'note      '//report%note)
         call add_words(body, model_line(adequacy, log%is_verbose))
      end associate
      if (all([allocated(writer%limits), log%scaling%is_dimensional, .not. ieee_is_finite(ratio), &
         count_of(nl, head//body) < most_lines - 1])) call add_words(body, &
         'lambda    ratio not known without &bodies roughness_1, roughness_2')
      if (.not. log%is_verbose) call shorten(body, most_lines - 1 - count_of(nl, head))
      call log%print_summary(head//body//'  result    '//writer%path)
   end subroutine close_case

   !> Adds the mean power of a contact that changes, what asperities bear, and how warm it is.
   subroutine add_physics(body, summary, log)
      character(:), allocatable, intent(inout) :: body
      type(line_summary_t), intent(in) :: summary
      type(progress_log_t), intent(in) :: log

      if (log%in_seconds) call add_words(body, 'power     '//prefixed_text(mean_power(summary) &
         *log%scaling%power, trim(merge('W  ', 'W/m', allocated(log%scaling%ellipse))))// &
         ' of sliding and rolling on average')
      if (exceeds(summary%of(asperity_share)%value, 0.0_wp)) call add_words(body, &
         'asperities bear '//number_text(100*summary%of(asperity_share)%value, 3) &
         //' % of the load; friction '// &
         number_text(log%scaling%slope*summary%of(oil_friction)%value, 3)//' by oil, '// &
         number_text(log%scaling%slope*summary%of(boundary_friction)%value, 3)//' by asperities')
      if (exceeds(summary%of(film_rise)%value, 0.0_wp)) call add_words(body, &
         'sliding warms the film by '//number_text(summary%of(film_rise)%value, 3)// &
         ' K, the surfaces by '//number_text(summary%of(rise_1)%value, 3)//' and '// &
         number_text(summary%of(rise_2)%value, 3)//' K')
   end subroutine add_physics

   !> The contact and the quantities; in a verbose log in two units, with the residuals.
   function rows_of(summary, ratio, report, log) result(rows)
      type(line_summary_t), intent(in) :: summary
      real(wp), intent(in) :: ratio
      type(report_t), intent(in) :: report
      type(progress_log_t), intent(in) :: log
      character(:), allocatable :: rows, width
      logical :: is_shown
      integer :: i

      associate (scaling => log%scaling)
         width = 'b '
         if (allocated(scaling%ellipse)) width = 'b/a '//number_text(scaling%ellipse%ratio, 3) &
            //', a '
         if (scaling%is_dimensional) then
            rows = 'p_h '//prefixed_text(scaling%hertz_pressure, 'Pa')//', '//width &
               //prefixed_text(scaling%half_width, 'm')//', U ' &
               //number_text(0.5_wp*scaling%speed_sum, 4)//' m/s, slide-to-roll ' &
               //number_text(scaling%slide_to_roll, 4)
         else
            rows = 'M '//number_text(scaling%moes_m, 4)//', L '//number_text(scaling%moes_l, 4) &
               //' (mean velocity)'
         end if
      end associate
      rows = '  contact   '//rows//nl
      if (log%is_verbose) rows = rows//'            SI              dimensionless'//nl
      do i = 1, size(table_rows)
         is_shown = .true.
         if (table_rows(i) == lambda_ratio) is_shown = ieee_is_finite(ratio)
         if (table_rows(i) == friction_coefficient) is_shown = exceeds( &
            summary%of(friction_coefficient)%value, 0.0_wp)   ! something slides
         if (table_rows(i) == p_central) is_shown = is_central_shown(summary)
         if (is_shown) rows = rows//trim(row_of_table(table_rows(i), summary, ratio, log, &
            report%steps > 0))//nl
      end do
      if (log%is_verbose) rows = rows//'  residual  '//number_text(report%residual, 2) &
         //'   load error '//number_text(report%load_error, 2)//'   bound ' &
         //number_text(report%tolerance_effective, 2)//nl
   end function rows_of

   !> What passing limit `i` means: one line of the closing table.
   pure function limit_sentence(i, limit) result(words)
      integer, intent(in) :: i
      type(limit_t), intent(in) :: limit
      character(:), allocatable :: value, words
      integer :: k

      words = trim(limit_rows(i)%words)
      value = number_text(limit%value, 2)
      if (limit_rows(i)%units == 'Pa') value = prefixed_text(limit%value, 'Pa')
      if (index(words, '# %') > 0) value = number_text(100.0_wp*limit%value, 2)
      ! of an isothermal oil that does not thin it may come out beyond all sense
      if (i == shear_heating .and. limit%value > hottest) value = '>'//number_text(hottest, 3)
      k = index(words, '#')
      words = words(:k - 1)//value//words(k + 1:)
      k = index(words, '@')
      if (k > 0) words = words(:k - 1)//prefixed_text(limit%threshold, 'Pa')
      if (i == shear_heating) words = words//' '//number_text(100*limit%viscosity_loss, 2)// &
         ' % less viscosity, up to '//number_text(100*limit%film_loss, 2)//' % less film'
   end function limit_sentence

   !> Leaves as many lines of `body` as there is `room` for, and says that there are more.
   subroutine shorten(body, room)
      character(:), allocatable, intent(inout) :: body
      integer, intent(in) :: room
      integer :: i, place

      if (count_of(nl, body) <= max(room, 1)) return
      place = 0
      do i = 1, room - 1
         place = place + index(body(place + 1:), nl)
      end do
      body = body(:place)//'  more      '//counted(count_of(nl, body(place + 1:)), 'line') &
         //' with --verbose'//nl
   end subroutine shorten

   !> The row of quantity `i` of a steady contact or of one in time, or of the lambda `ratio`.
   function row_of_table(i, summary, ratio, log, is_transient) result(row)
      integer, intent(in) :: i
      type(line_summary_t), intent(in) :: summary
      real(wp), intent(in) :: ratio
      type(progress_log_t), intent(in) :: log
      logical, intent(in) :: is_transient
      character(len=columns) :: row
      character(len=11) :: number
      type(label_t) :: scale
      integer :: bar

      bar = 24   ! column of the error
      if (log%scaling%is_dimensional) bar = 27
      if (log%is_verbose) bar = 40
      if (i == lambda_ratio) then
         row = '  lambda ratio '//number_text(ratio, 4)
      else
         scale = row_label(trim(quantity_rows(i)%field), log%scaling)
         row = '  '//quantity_rows(i)%short
         row(margin + 1:) = '-'
         number = number_text(summary%of(i)%value, 6)
         if (number(11:) /= ' ') number = number_text(summary%of(i)%value, 5)
         if (scale%si_units /= '1') then
            row(margin + 1:) = prefixed_text(summary%of(i)%value*scale%si_scale, scale%si_units)
         else if (log%scaling%is_dimensional) then
            row(margin + 1:) = number_text(summary%of(i)%value*scale%si_scale, 4)
         else if (.not. log%is_verbose) then
            row(margin + 1:) = number
         end if
         if (log%is_verbose) row(bar - 11:) = number
      end if
      associate (quantity => summary%of(merge(h_min, i, i == lambda_ratio)))
         if (ieee_is_finite(quantity%error_estimate) .and. abs(quantity%value) > 0.0_wp) then
            row(bar:) = '+- '//number_text(100*abs(quantity%error_estimate/quantity%value), 2) &
               //' %'
         else if (ieee_is_finite(summary%of(h_min)%error_estimate)) then
            row(bar:) = '+- not known'
         end if
         if (is_transient .and. ieee_is_finite(quantity%time)) then
            row(bar + 13:) = 'at T '//number_text(quantity%time, 4)
            if (log%in_seconds) row(bar + 13:) = 'at '//prefixed_text(quantity%time &
               *log%scaling%time, 's')
         end if
      end associate
      if (i == p_max .and. .not. log%is_verbose) row(merge(bar + 25, bar + 13, is_transient):) = &
         spike_remark(summary, is_transient)
   end function row_of_table

   !> How a run has ended, and what it took unless it failed and `is_short`.
   function outcome_text(report, is_short) result(outcome)
      type(report_t), intent(in) :: report
      logical, intent(in) :: is_short
      character(:), allocatable :: outcome, word

      outcome = ''
      if (allocated(report%reason)) outcome = trim(report%reason)
      outcome = ending_text(report%outcome(), outcome)
      if (report%outcome() /= has_converged .and. is_short) return
      word = 'cycle'
      if (allocated(report%method)) word = trim(merge('grid ', 'cycle', index(report%method, &
         'graded') > 0))
      outcome = outcome//', '//counted(report%cycles, word)
      if (report%steps > 0) outcome = outcome//' in '//counted(report%steps, 'time step')
      if (report%fit%uncut_steps > 0) outcome = outcome//' (' &
         //number_text(real(report%fit%uncut_steps, wp), 9)//' of the start not cut into parts)'
      outcome = outcome//', '//number_text(report%cost%wall_seconds, 3)//' s'
      if (report%cost%peak_memory > 0.0_wp) outcome = outcome//', ' &
         //prefixed_text(report%cost%peak_memory, 'B')
   end function outcome_text

   !> Adds what others say: lines that begin with a blank as they are, others wrapped.
   subroutine add_words(body, lines)
      character(:), allocatable, intent(inout) :: body
      character(*), intent(in) :: lines

      if (len_trim(lines) == 0) return
      if (lines(1:1) == ' ') then
         body = body//lines//nl
      else
         body = body//'  '//wrapped(lines, columns - 2, margin)//nl
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

   !> The pressure of a spike that the grid does not resolve; 0: none, or p_max is well known.
   pure real(wp) function unresolved_spike(summary) result(spike)
      type(line_summary_t), intent(in) :: summary

      spike = merge(summary%crests%corner, 0.0_wp, summary%crests%corner_top > 0.0_wp)
      if (ieee_is_finite(summary%crests%spike)) spike = summary%crests%spike
      if (.not. is_central_shown(summary)) spike = 0.0_wp
   end function unresolved_spike

   !> What a spike means, behind the largest pressure; empty: there is none.
   pure function spike_remark(summary, is_transient) result(remark)
      type(line_summary_t), intent(in) :: summary
      logical, intent(in) :: is_transient
      character(:), allocatable :: remark

      remark = ''
      if (.not. unresolved_spike(summary) > 0.0_wp) return
      remark = 'spike, not resolved'
      if (.not. is_transient) remark = remark//': rises on finer grids'
      if (unresolved_spike(summary) < summary%of(p_max)%value) remark = &
         'a narrow spike may exceed it'
   end function spike_remark

   !> Which pressure to take, and which grid, as lines of the table; empty where no spike of a line
   !> is the reason.
   pure function spike_lines(case, summary) result(lines)
      type(case_t), intent(in) :: case
      type(line_summary_t), intent(in) :: summary
      character(:), allocatable :: advice, lines

      lines = ''
      if (allocated(case%point) .or. .not. unresolved_spike(summary) > 0.0_wp) return
      advice = ". &domain grid = 'graded', without intervals, follows it"
      if (case%contact%domain%grid == 'graded') advice = ''
      if (case%time%is_transient .or. case%layers > 0) advice = &
         '. More &domain intervals show more of it'
      if (unresolved_spike(summary) < summary%of(p_max)%value) then
         lines = 'a pressure spike near the outlet is narrower than this grid, and on finer' &
            //' ones may rise above p_max'
      else
         lines = 'p_max is the top of a pressure spike near the outlet that is narrower than' &
            //' this grid, and rises on finer ones'
      end if
      lines = '  spike     '//lines//'; p_central is the pressure beside it, at X = 0'//advice
      lines = wrapped(lines, columns, margin)
   end function spike_lines

   !> The first film below the floor: 'film breakdown at x = -31.2 um (X = -0.2950), t = ...'.
   pure function breakdown_sentence(breakdown, film_floor, scaling) result(sentence)
      type(breakdown_t), intent(in) :: breakdown
      real(wp), intent(in) :: film_floor
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: sentence

      sentence = 'film breakdown at x = '//prefixed_text(breakdown%position*scaling%half_width, &
         'm')//' (X = '//number_text(breakdown%position, 4)//')'
      if (allocated(scaling%ellipse)) sentence = sentence//', y = '//prefixed_text( &
         breakdown%across*scaling%half_width, 'm')//' (Y = '//number_text(breakdown%across, 4)//')'
      sentence = sentence//', t = '//prefixed_text(breakdown%time*scaling%time, 's') &
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

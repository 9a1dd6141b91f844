!> The end of a lubricated case: its result is written and its closing table printed, or what an
!> interrupted run needs to go on is kept.
module result_end
   use case_outcome, only: case_outcome_t, give_up, outcome_of, status_interrupted, &
      status_not_written
   use case_record, only: case_t
   use contact_moment, only: at_moment
   use closing_table, only: close_case, closing_words_t, spike_lines
   use errors, only: error_t
   use film_shear, only: velocity_profile
   use formulas_section, only: formula_lines, formulas_of
   use adequacy_section, only: decision_lines, model_line, model_sentence, solved_text
   use inlet_errors, only: film_loss
   use iteration_report, only: is_outside, report_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use kinds, only: exceeds, not_known, wp
   use point_contact, only: film_by_formulas
   use quantities, only: h_central
   use run_observer, only: run_observer_t
   use signals, only: disarm_exit_message
   use text, only: number_text, to_text
   use validity, only: circumstances_t, least_lambda_ratio, limits_of, mixed_lubrication, &
      shear_heating
   implicit none (type, external)
   private

   public :: close_result, end_result, judge_point_limits, suspend_result

contains

   !> Ends the result of a case, whose contact has all of its roughness: as an interrupted run, or
   !> with a last `state`.
   subroutine end_result(case, listener, state, report, outcome)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(case_outcome_t), intent(out) :: outcome

      if (listener%is_stopping .and. .not. report%converged &
         .and. .not. listener%writer%has_failed()) then
         call suspend_result(listener, outcome)
      else
         call judge_limits(case, state, report, listener)
         if (case%output_settings%velocity_layers > 0 .and. allocated(state%shear_stress_mean)) then
            listener%writer%velocity = velocity_profile(case%contact%fluid, case%contact%lambda, &
               case%contact%slide_to_roll, state%x, state%pressure, state%film_thickness, &
               case%output_settings%velocity_layers)
         end if
         call finish_result(case, listener, state, report, outcome)
      end if
   end subroutine end_result

   !> Judges the limits of a converged solution; of a steady one the writer gets what formulas need.
   subroutine judge_limits(case, state, report, listener)
      type(case_t), intent(in) :: case
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(run_observer_t), intent(inout) :: listener
      type(circumstances_t) :: of

      if (.not. report%converged) return
      of%contact = at_moment(case%contact, state%time)
      of%summary = listener%writer%quantities_at_end(state, report)
      ! the rule gives the change over the film that is starved
      of%film_loss = report%fit%inlet_error/(1 + report%fit%inlet_error)
      if (listener%writer%bars%inlet%is_known) of%film_loss = film_loss(listener%writer%bars%inlet)
      of%has_momentum = case%layers > 0
      call judge(of, case, state, report, listener)
      if (case%time%is_transient .or. case%contact%supply < huge(case%contact%supply)) return
      listener%writer%formulas = formulas_of(case%contact)
   end subroutine judge_limits

   !> The same of a point contact, steady or in time, with its `summary`.
   subroutine judge_point_limits(case, state, summary, report, listener)
      type(case_t), intent(in) :: case
      type(line_state_t), intent(in) :: state
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(inout) :: report
      type(run_observer_t), intent(inout) :: listener
      type(circumstances_t) :: of

      if (.not. report%converged) return
      of%contact%rough_contact_t = case%point%rough_contact_t
      of%summary = summary
      of%angle = case%point%angle
      of%film_loss = not_known()
      associate (film => summary%of(h_central))
         if (exceeds(film%error_domain, 0.0_wp)) of%film_loss = film%error_domain/film%value
      end associate
      call judge(of, case, state, report, listener)
      associate (heat => listener%writer%limits(shear_heating))
         heat%film_loss = max(1 - film_by_formulas(case%point, 1 - heat%viscosity_loss) &
            /film_by_formulas(case%point, 1.0_wp), 0.0_wp)
      end associate
   end subroutine judge_point_limits

   !> Hands the limits of a case, of whose contact `of` knows, to the writer of its result; the
   !> report says where asperities carry load.
   subroutine judge(of, case, state, report, listener)
      type(circumstances_t), intent(inout) :: of
      type(case_t), intent(in) :: case
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(run_observer_t), intent(inout) :: listener

      of%scaling = case%scaling
      of%bodies = case%bodies
      of%lubricant = case%lubricant
      of%materials = case%materials
      listener%writer%limits = limits_of(of, state)
      associate (ratio => listener%writer%limits(mixed_lubrication)%value)
         report%is_mixed = exceeds(-ratio, -least_lambda_ratio) .and. .not. &
            allocated(of%contact%asperities)
         if (.not. report%is_mixed) return
         report%reason = is_outside//' lubrication, the smallest film is '// &
            number_text(ratio, 2)//' times the composite roughness'
         if (.not. allocated(of%scaling%ellipse)) report%reason = report%reason// &
            '; &asperities computes the load that asperities carry'
      end associate
   end subroutine judge

   !> Writes the result and prints its closing table.
   subroutine finish_result(case, listener, state, report, outcome)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(case_outcome_t), intent(out) :: outcome
      type(error_t), allocatable :: error
      type(closing_words_t) :: words

      call listener%writer%finish(case, state, report, error)
      if (allocated(error)) then
         if (listener%writer%name%has_checkpoint) error%message = error%message &
            //'; --resume continues after step '// &
            to_text(listener%writer%name%kept_step)
         call give_up(error, listener%log, outcome)
         return
      end if
      associate (writer => listener%writer)
         if (listener%log%is_verbose) then
            words%spike = ". &domain grid = 'graded', without intervals, follows it"
            if (case%contact%domain%grid == 'graded') words%spike = ''
            if (case%time%is_transient .or. case%layers > 0) words%spike = &
               '. More &domain intervals show more of it'
            words%spike = spike_lines(writer%summary, advice=words%spike)
            words%formulas = formula_lines(writer%formulas, writer%summary, listener%log%scaling)
            words%decision = decision_lines(writer%choice, writer%adequacy)
         else if (allocated(writer%choice%rows)) then
            words%decision = 'auto      '//solved_text(writer%choice)
         end if
         call close_result(listener, writer%summary, report, words)
      end associate
      outcome = outcome_of(report)
   end subroutine finish_result

   !> Prints the closing table, with `others` and the effects of the ingredients that were measured.
   subroutine close_result(listener, summary, report, others)
      type(run_observer_t), intent(inout) :: listener
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report
      type(closing_words_t), intent(in), optional :: others
      type(closing_words_t) :: words

      if (present(others)) words = others
      associate (writer => listener%writer, adequacy => listener%writer%adequacy)
         if (allocated(adequacy%rows)) then
            words%model = model_sentence(adequacy%rows%judged_t, adequacy%accuracy)
            if (listener%log%is_verbose) words%model = model_line(adequacy%rows%judged_t, &
               adequacy%accuracy)
         end if
         call close_case(listener%log, summary, report, writer%name%path, &
            writer%run%passage%times, words, writer%limits)
      end associate
   end subroutine close_result

   !> The end of an interrupted run: the files needed to go on are kept and named.
   subroutine suspend_result(listener, outcome)
      type(run_observer_t), intent(inout) :: listener
      type(case_outcome_t), intent(out) :: outcome
      character(:), allocatable :: words

      outcome%status = status_interrupted
      if (allocated(listener%failure)) outcome%status = status_not_written
      words = listener%writer%name%interruption_text()
      outcome%reason = words
      call disarm_exit_message()
      call listener%log%say_error(words)
      if (listener%writer%name%has_checkpoint) then
         call listener%writer%suspend()
      else
         call listener%writer%discard()
      end if
   end subroutine suspend_result

end module result_end

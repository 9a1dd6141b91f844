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

   public :: end_result

contains

   !> Ends the result of a case, whose contact has all of its roughness: as an interrupted run, or
   !> with a last `state`.
   subroutine end_result(case, listener, state, report, outcome)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(case_outcome_t), intent(out) :: outcome
      type(error_t), allocatable :: error

      associate (writer => listener%writer)
         if (listener%is_stopping .and. .not. (report%converged .or. &
            allocated(writer%file%failure))) then
            ! what a run needs to go on is kept
            outcome%status = merge(status_not_written, status_interrupted, &
               allocated(listener%failure))
            outcome%reason = writer%name%interruption_text()
            call disarm_exit_message()
            call listener%log%say_error(outcome%reason)
            if (writer%name%has_checkpoint) then
               call writer%suspend()
            else
               call writer%discard()
            end if
            return
         end if
         if (report%converged) call judge_limits(case, state, report, listener)
         if (.not. allocated(case%point) .and. allocated(state%shear_stress_mean)) then
            if (case%output_settings%velocity_layers > 0) writer%velocity = velocity_profile( &
               case%contact%fluid, case%contact%lambda, case%contact%slide_to_roll, state%x, &
               state%pressure, state%film_thickness, case%output_settings%velocity_layers)
         end if
         call writer%finish(case, state, report, error)
         if (allocated(error)) then
            if (writer%name%has_checkpoint) error%message = error%message &
               //'; --resume continues after step '//to_text(writer%name%kept_step)
            call give_up(error, listener%log, outcome)
            return
         end if
      end associate
      call print_table(case, listener, report)
      outcome = outcome_of(report)
   end subroutine end_result

   !> Hands the limits of a converged solution to the writer of the result, of a steady line also
   !> what formulas need; the report says where asperities carry load.
   subroutine judge_limits(case, state, report, listener)
      type(case_t), intent(in) :: case
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(run_observer_t), intent(inout) :: listener
      type(circumstances_t) :: of

      of%scaling = case%scaling
      of%bodies = case%bodies
      of%lubricant = case%lubricant
      of%materials = case%materials
      associate (writer => listener%writer)
         if (allocated(case%point)) then
            of%contact%rough_contact_t = case%point%rough_contact_t
            of%summary = writer%summary
            of%angle = case%point%angle
            of%film_loss = not_known()
            associate (film => of%summary%of(h_central))
               if (exceeds(film%error_domain, 0.0_wp)) of%film_loss = film%error_domain/film%value
            end associate
         else
            of%contact = at_moment(case%contact, state%time)
            of%summary = writer%quantities_at_end(state, report)
            ! the rule gives the change over the film that is starved
            of%film_loss = report%fit%inlet_error/(1 + report%fit%inlet_error)
            if (writer%bars%inlet%is_known) of%film_loss = film_loss(writer%bars%inlet)
            of%has_momentum = case%layers > 0
         end if
         writer%limits = limits_of(of, state)
         associate (ratio => writer%limits(mixed_lubrication)%value)
            report%is_mixed = exceeds(-ratio, -least_lambda_ratio) .and. .not. &
               allocated(of%contact%asperities)
            if (report%is_mixed) report%reason = is_outside//' lubrication, the smallest film '// &
               'is '//number_text(ratio, 2)//' times the composite roughness'
         end associate
         if (report%is_mixed .and. .not. allocated(case%point)) report%reason = report%reason// &
            '; &asperities computes the load that asperities carry'
         if (allocated(case%point)) then
            associate (heat => writer%limits(shear_heating))
               heat%film_loss = max(1 - film_by_formulas(case%point, 1 - heat%viscosity_loss) &
                  /film_by_formulas(case%point, 1.0_wp), 0.0_wp)
            end associate
         else if (.not. case%time%is_transient .and. case%contact%supply &
            >= huge(case%contact%supply)) then
            writer%formulas = formulas_of(case%contact)
         end if
      end associate
   end subroutine judge_limits

   !> Prints the closing table, with the effects of the ingredients that were measured.
   subroutine print_table(case, listener, report)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(report_t), intent(in) :: report
      type(closing_words_t) :: words

      associate (writer => listener%writer, adequacy => listener%writer%adequacy)
         if (listener%log%is_verbose) then
            words%spike = ". &domain grid = 'graded', without intervals, follows it"
            if (case%contact%domain%grid == 'graded') words%spike = ''
            if (case%time%is_transient .or. case%layers > 0) words%spike = &
               '. More &domain intervals show more of it'
            words%spike = spike_lines(writer%summary, advice=words%spike)
            if (allocated(case%point)) words%spike = ''
            words%formulas = formula_lines(writer%formulas, writer%summary, listener%log%scaling)
            words%decision = decision_lines(writer%choice, adequacy)
         else if (allocated(writer%choice%rows)) then
            words%decision = 'auto      '//solved_text(writer%choice)
         end if
         if (allocated(adequacy%rows)) then
            words%model = model_sentence(adequacy%rows, adequacy%accuracy)
            if (listener%log%is_verbose) words%model = model_line(adequacy%rows, &
               adequacy%accuracy)
         end if
         call close_case(listener%log, writer%summary, report, writer%name%path, &
            writer%run%passage%times, words, writer%limits)
      end associate
   end subroutine print_table

end module result_end

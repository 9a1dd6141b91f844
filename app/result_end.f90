!> How a case ends: exit status and reason, for the program's own status and for `--outcomes`; of a
!> lubricated one its result and closing table, or what an interrupted run needs to go on.
module result_end
   use case_record, only: case_t
   use contact_moment, only: at_moment
   use closing_table, only: breakdown_sentence, close_case
   use error_bars, only: film_loss
   use errors, only: error_t, output_error
   use field_sections, only: has_formulas
   use iteration_report, only: has_converged, is_outside, phase_output, phase_transient, report_t
   use line_state, only: line_state_t
   use kinds, only: exceeds, not_known, wp
   use point_contact, only: film_by_formulas
   use progress_log, only: progress_log_t, write_text
   use quantities, only: h_central
   use run_observer, only: run_observer_t
   use signals, only: disarm_exit_message
   use text, only: number_text, to_text
   use validity, only: circumstances_t, least_lambda_ratio, limits_of, mixed_lubrication, &
      shear_heating
   implicit none (type, external)
   private

   public :: case_outcome_t, count_outcome, end_result, give_up, outcome_of

   !> Exit status of one case: converged and written; failed inside; not converged, or outside the
   !> model, but written; not written; interrupted.
   integer, parameter, public :: status_converged = 0, status_failed = 1, &
      status_not_converged = 2, status_not_written = 3, &
      status_interrupted = 4

   !> How a case ended.
   type :: case_outcome_t
      integer :: status = status_converged
      !> Why the status is not 0.
      character(:), allocatable :: reason
   end type case_outcome_t

contains

   !> Ends a result, whose contact has all of its roughness: interrupted, or with a last `state`.
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
            outcome%reason = writer%interruption_text()
            call disarm_exit_message(is_over=.false.)
            call listener%log%say_error(outcome%reason)
            call writer%discard()
            return
         end if
         if (report%converged) call judge_limits(case, state, report, listener)
         if (allocated(listener%note)) report%note = listener%note
         if (index(report%reason, 'film breakdown') == 1 .and. case%scaling%is_dimensional) then
            report%reason = breakdown_sentence(report%breakdown, case%solver%film_floor, &
               case%scaling)
         end if
         associate (seconds => report%cost%phase_seconds)
            seconds(phase_output) = listener%output_seconds
            seconds(phase_transient) = max(seconds(phase_transient) - seconds(phase_output), 0.0_wp)
         end associate
         call writer%finish(case, state, report, error)
         if (allocated(error)) then
            if (writer%has_checkpoint) error%message = error%message &
               //'; --resume continues after step '//to_text(writer%kept_step)
            call give_up(error, listener%log, outcome)
            return
         end if
         call close_case(listener%log, case, writer, report)
      end associate
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
            writer%has_formulas = has_formulas(case%contact)
         end if
      end associate
   end subroutine judge_limits

   !> Prints an error and turns it into an outcome.
   subroutine give_up(error, log, outcome)
      type(error_t), intent(in) :: error
      type(progress_log_t), intent(inout) :: log
      type(case_outcome_t), intent(out) :: outcome

      call log%say_error(error%message)
      outcome%status = merge(status_not_written, status_failed, error%kind == output_error)
      outcome%reason = error%message
   end subroutine give_up

   !> The outcome of a case whose result is written.
   pure function outcome_of(report) result(outcome)
      type(report_t), intent(in) :: report
      type(case_outcome_t) :: outcome

      if (report%outcome() == has_converged) return
      outcome%status = status_not_converged
      if (allocated(report%reason)) outcome%reason = trim(report%reason)
   end function outcome_of

   !> Takes the outcome of `file` into the `status` of the call, the largest of all, and writes its
   !> line of `--outcomes` if `is_told`: status, `file` and reason, with tabs between. Error:
   !> standard output is lost.
   subroutine count_outcome(file, outcome, is_told, status, error)
      character(*), intent(in) :: file
      type(case_outcome_t), intent(in) :: outcome
      logical, intent(in) :: is_told
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: line
      character(*), parameter :: tab = achar(9)
      integer :: i

      status = max(status, outcome%status)
      if (.not. is_told) return
      line = to_text(outcome%status)//tab//file//tab
      if (allocated(outcome%reason)) line = line//outcome%reason
      do i = 1, len(line)
         if (line(i:i) == new_line('a')) line(i:i) = ' '
      end do
      call write_text(line//new_line('a'), error)   ! error: handed up
   end subroutine count_outcome

end module result_end

!> What a lubricated case could do without: chosen before its run, measured after it.
module line_model
   use adequacy, only: accuracy_for
   use case_record, only: case_t, set_effective
   use decision_section, only: solved_text
   use domain_choice, only: choose_domain, reopen
   use errors, only: error_t
   use iteration_report, only: phase_adequacy, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use line_summary, only: summary_of
   use measured_adequacy, only: measure_adequacy
   use model_choice, only: choose_model
   use model_decision, only: take_model
   use own_passages, only: own_runs_t
   use passage_pairs, only: scene_t
   use run_observer, only: run_observer_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: choose_lean_model, measure_model

contains

   !> Makes `contact` and the times of a case with model = 'auto' those of the leanest model that is
   !> adequate. Resumed runs stay transient, and so do those with film statistics over time.
   subroutine choose_lean_model(case, contact, listener, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(inout) :: contact
      type(run_observer_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error

      if (case%model /= 'auto') return
      associate (choice => listener%writer%choice)
         call choose_model(scene_t(contact, case%solver, case%time), case%accuracy%target, &
            allocated(case%time%resume_from) .or. size(case%output_settings%film_thresholds) > 0, &
            choice, listener, error)
         if (allocated(error) .or. .not. choice%is_steady) return
         call take_model(choice, contact, case%time)
         call reopen(contact%domain)
         call choose_domain(contact, case%accuracy%target)
         call listener%log%say(case%file//': solves '//solved_text(choice))
      end associate
      call set_effective(case, 'time', 'transient', '.false.')
   end subroutine choose_lean_model

   !> Measures what the ingredients of the model change, where that is wanted.
   subroutine measure_model(case, contact, listener, state, report, error)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(in) :: contact
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: start

      if (.not. (case%output_settings%has_adequacy .and. report%converged)) return
      start = wall_seconds()
      associate (writer => listener%writer)
         call measure_adequacy(scene_t(contact, case%solver, case%time), state, &
            own_runs_t(writer%run%passage%extremes(summary_of(state)), real(report%cycles, wp), &
            writer%bars), &
            accuracy_for(case%accuracy%target, writer%quantities_at_end(state, report)), &
            writer%adequacy, listener, error)
      end associate
      if (allocated(error)) return
      report%converged = .not. listener%is_stopping
      report%phase_seconds(phase_adequacy) = wall_seconds() - start
   end subroutine measure_model

end module line_model

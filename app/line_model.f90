!> What a lubricated case could do without: chosen before its run, measured after it.
module line_model
   use adequacy, only: accuracy_for, apply_model
   use adequacy_section, only: solved_text
   use case_record, only: case_t, set_effective
   use domain_choice, only: choose_anew
   use errors, only: error_t
   use experiment, only: experiment_t, new_experiment
   use graded_contact, only: find_tail
   use iteration_report, only: phase_adequacy, report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: summary_of
   use measured_adequacy, only: measure_adequacy, solved_t
   use model_choice, only: choose_model
   use run_observer, only: run_observer_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: choose_lean_model, measure_model

contains

   !> Finds what lies in front of a passage. Makes contact and times of a case with model = 'auto'
   !> those of the leanest model that is adequate. Resumed runs stay transient, and so do those with
   !> film statistics over time.
   subroutine choose_lean_model(case, listener, error)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error

      call find_tail(case%contact, case%solver%target, listener)
      if (case%model /= 'auto') return
      associate (choice => listener%writer%choice)
         call choose_model(experiment_t(case%contact, case%solver, case%time), &
            case%solver%target, allocated(case%time%resume_from) &
            .or. size(case%output_settings%film_thresholds) > 0, choice, listener, error)
         if (allocated(error) .or. .not. (choice%is_steady .or. choice%is_quasi_steady)) return
         call apply_model(choice, case%contact, case%time)
         call listener%log%say(case%file//': solves '//solved_text(choice))
         if (choice%is_quasi_steady) call set_effective(case, 'time', 'scheme', text='quasi_steady')
         if (choice%is_quasi_steady) return
         case%contact%domain%has_tail = .false.
         case%contact%domain%grid = merge('even  ', 'graded', case%domain%grid == 'even')
         call choose_anew(case%contact, case%solver%target)
      end associate
      call set_effective(case, 'time', 'transient', text='.false.')
   end subroutine choose_lean_model

   !> Measures what the ingredients of the model change, where that is wanted.
   subroutine measure_model(case, listener, state, report, error)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: start

      if (case%output_settings%adequacy == '.false.' .or. .not. report%converged &
         .or. case%time%scheme == 'quasi_steady') return
      start = wall_seconds()
      associate (writer => listener%writer)
         writer%adequacy%is_full = case%output_settings%adequacy == 'full'
         writer%adequacy%accuracy = accuracy_for(case%solver%target, &
            writer%quantities_at_end(state, report))
         call measure_adequacy(solved_t(new_experiment(case%contact, case%solver, case%time), &
            writer%run%passage%extremes(summary_of(state)), real(report%cycles, wp), writer%bars), &
            state, writer%adequacy, listener, error)
      end associate
      if (allocated(error)) return
      report%converged = .not. listener%is_stopping
      report%cost%phase_seconds(phase_adequacy) = wall_seconds() - start
   end subroutine measure_model

end module line_model

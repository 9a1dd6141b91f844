!> What a lubricated case could do without: chosen before its run, measured after it; and what it
!> does beside the Reynolds equation: the full momentum equations of the film.
module line_model
   use adequacy, only: accuracy_for, apply_model, solved_texts, solves_all, solves_moments
   use case_record, only: case_t, set_effective
   use domain_choice, only: choose_anew
   use errors, only: error_t
   use experiment, only: experiment_t, new_experiment
   use field_sections, only: difference_sentence
   use graded_contact, only: find_tail
   use iteration_report, only: phase_adequacy, report_t
   use kinds, only: quotient, wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use measured_adequacy, only: measure_adequacy, solved_t
   use model_choice, only: choose_model
   use momentum_march, only: momentum_march_t
   use quantities, only: h_min
   use run_observer, only: run_observer_t
   use system_limits, only: peak_memory
   use text, only: to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: choose_lean_model, follow_momentum, measure_model, prepare_momentum

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
            .or. size(case%output_settings%film_thresholds) > 0, choice, listener)
         call move_alloc(listener%error, error)
         if (allocated(error) .or. choice%solved == solves_all) return
         call apply_model(choice, case%contact, case%time)
         call listener%log%say(case%file//': solves '//trim(solved_texts(choice%solved)))
         if (choice%solved == solves_moments) then
            call set_effective(case, 'time', 'scheme', text='quasi_steady')
            return
         end if
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
      type(line_summary_t) :: summary
      real(wp) :: start

      if (case%output_settings%adequacy == '.false.' .or. .not. report%converged &
         .or. case%time%scheme == 'quasi_steady') return
      start = wall_seconds()
      associate (writer => listener%writer)
         writer%adequacy%is_full = case%output_settings%adequacy == 'full'
         summary = writer%quantities_at_end(state, report)
         writer%adequacy%accuracy = accuracy_for(case%solver%target, quotient( &
            summary%of(h_min)%error_estimate, abs(summary%of(h_min)%value)))
         call measure_adequacy(solved_t(new_experiment(case%contact, case%solver, case%time), &
            writer%run%passage%extremes(summary_of(state)), real(report%cycles, wp), writer%bars), &
            state, writer%adequacy, listener)
      end associate
      call move_alloc(listener%error, error)
      if (allocated(error)) return
      report%converged = .not. listener%is_stopping
      report%cost%phase_seconds(phase_adequacy) = wall_seconds() - start
   end subroutine measure_model

   !> Before the Reynolds equation is solved: time steps will be repeated by the full momentum
   !> equations, where the case asks for both.
   subroutine prepare_momentum(case, listener)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener

      if (case%layers == 0 .or. .not. case%time%is_transient) return
      allocate (listener%follower, source=new_march(case))
   end subroutine prepare_momentum

   !> What the equations need to know of the case.
   function new_march(case) result(march)
      type(case_t), intent(in) :: case
      type(momentum_march_t) :: march

      march%layers = case%layers
      march%walls%delta = case%scaling%slope
      ! rho_0 u_s^2/p_h: inertia of the oil at ambient pressure over the pressure of the contact
      if (case%has_inertia) march%walls%inertia = case%materials%density &
         *case%scaling%speed_sum**2/case%scaling%hertz_pressure
      march%walls%curvature_share = case%bodies%curvature_share
   end function new_march

   !> Where the case asks for it, goes on from `state`, a converged steady solution of the Reynolds
   !> equation, which becomes that of the momentum equations, or closes their march; notes changes.
   subroutine follow_momentum(case, listener, state, report, error)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      type(momentum_march_t) :: steady
      character(:), allocatable :: words

      if (case%layers == 0 .or. .not. report%converged) return
      call listener%on_stage('full momentum equations of the film')
      associate (writer => listener%writer)
         if (allocated(listener%follower)) then
            select type (march => listener%follower)
            type is (momentum_march_t)
               writer%momentum = march%fields()
               call writer%run%film_passage%compare(writer%momentum)
               associate (cost => march%history)
                  words = 'extremes of the passage are compared ('//to_text(cost%solutions) &
                     //' steps, at most '//to_text(cost%most_steps)//' of Newton for one'
                  if (cost%longer > 0) words = words//', more than three for '//to_text(cost%longer)
               end associate
               call listener%add_note(words//'); '//difference_sentence(writer%momentum))
            end select
         else
            writer%reynolds = state
            allocate (writer%momentum)
            steady = new_march(case)
            call steady%solve_steady(case%contact, state, writer%momentum, report, error)
            if (allocated(error)) return
            if (report%converged) then
               call listener%add_note(difference_sentence(writer%momentum))
            else
               deallocate (writer%momentum, writer%reynolds)
            end if
         end if
      end associate
      report%cost%peak_memory = peak_memory()
   end subroutine follow_momentum

end module line_model

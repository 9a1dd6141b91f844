!> The limits of the model for one lubricated case that is solved, and what film formulas need to
!> know of it.
module case_limits
   use case_record, only: case_t
   use formulas_section, only: formulas_of
   use inlet_change, only: film_loss
   use iteration_report, only: report_t
   use line_state, only: line_state_t
   use run_observer, only: run_observer_t
   use validity, only: circumstances_t, limits_of
   implicit none (type, external)
   private

   public :: judge_limits

contains

   !> Hands the limits of a converged solution to the writer of its result, and of a steady one what
   !> formulas need.
   subroutine judge_limits(case, state, report, listener)
      type(case_t), intent(in) :: case
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(run_observer_t), intent(inout) :: listener
      type(circumstances_t) :: of

      if (.not. report%converged) return
      of%scaling = listener%log%scaling
      of%bodies = case%bodies
      of%lubricant = case%lubricant
      of%materials = case%materials
      of%contact = case%contact
      of%summary = listener%writer%quantities_at_end(state, report)
      ! the rule gives the change over the film that is starved
      of%film_loss = report%inlet_error/(1 + report%inlet_error)
      if (listener%writer%bars%inlet%is_known) of%film_loss = film_loss(listener%writer%bars%inlet)
      of%has_momentum = case%equations == 'stokes'
      listener%writer%limits = limits_of(of, state)
      if (.not. case%time%is_transient) listener%writer%formulas = formulas_of(case%contact)
   end subroutine judge_limits

end module case_limits

!> The full momentum equations of the film, after the Reynolds equation of the same case.
module film_momentum
   use case_record, only: case_t
   use errors, only: error_t
   use film_fields, only: compare_passage
   use iteration_report, only: report_t
   use line_state, only: line_state_t
   use momentum_march, only: momentum_march_t, solve_film_momentum
   use field_sections, only: difference_sentence
   use momentum_solver, only: walls_t
   use run_observer, only: run_observer_t
   use signals, only: begin_activity
   use system_limits, only: peak_memory
   use text, only: to_text
   implicit none (type, external)
   private

   public :: follow_momentum, prepare_momentum

contains

   !> Before the Reynolds equation is solved: time steps will be repeated by the full momentum
   !> equations, where the case asks for both.
   subroutine prepare_momentum(case, listener)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(momentum_march_t) :: march

      if (case%layers == 0 .or. .not. case%time%is_transient) return
      march%walls = walls_of(case)
      march%layers = case%layers
      allocate (listener%follower, source=march)
   end subroutine prepare_momentum

   !> What the equations need to know of the bodies.
   function walls_of(case) result(walls)
      type(case_t), intent(in) :: case
      type(walls_t) :: walls

      walls%delta = case%scaling%slope
      ! rho_0 u_s^2/p_h: inertia of the oil at ambient pressure over the pressure of the contact
      if (case%has_inertia) walls%inertia = case%materials%density*case%scaling%speed_sum**2 &
         /case%scaling%hertz_pressure
      walls%curvature_share = case%bodies%curvature_share
   end function walls_of

   !> Where the case asks for it, goes on from `state`, a converged steady solution of the Reynolds
   !> equation, which becomes that of the momentum equations, or closes their march; notes changes.
   subroutine follow_momentum(case, listener, state, report, error)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: words

      if (case%layers == 0 .or. .not. report%converged) return
      call begin_activity('full momentum equations of the film')
      associate (writer => listener%writer)
         if (allocated(listener%follower)) then
            select type (march => listener%follower)
            type is (momentum_march_t)
               writer%momentum = march%fields()
               call compare_passage(writer%run%film_passage, writer%momentum)
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
            call solve_film_momentum(case%contact, walls_of(case), case%layers, state, &
               writer%momentum, report, error)
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

end module film_momentum

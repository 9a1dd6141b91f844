!> Coarse runs of a case, made at the same time on another thread or after it, and what a solved
!> case is compared with: itself on coarser grids; a farther inlet, the thesis's scheme, and a
!> farther outlet where the outlet cuts the film off.
module grid_comparison
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use case_record, only: case_t
   use domain_choice, only: choose_domain, cut_asperities
   use ehl_line_solver, only: solve_ehl_line
   use error_bars, only: error_bars_t, outlet_error
   use errors, only: error_t
   use experiment, only: experiment_t, make_side_runs, new_experiment, new_side_runs, outcome_t, &
      run_experiment, run_farther, run_longer, side_runs_t, useless
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, time_settings_t, without_surfaces
   use line_state, only: line_state_t
   use listener, only: listener_t
   use run_observer, only: run_observer_t
   use signals, only: begin_activity, is_interrupted
   use system_limits, only: lubricated_memory, memory_fault, of_blas, processors, thread_memory
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_ends, solve_with_coarse_runs

   !> Relative change of the quantities by the outlet above which a note is given.
   real(wp), parameter :: largest_change = 1.0e-3_wp

   !> Listener of the coarse runs: they end if interrupted, or useless because of the run itself.
   type, extends(listener_t) :: side_relay_t
      integer, pointer :: begun => null()
   contains
      procedure :: wants_stop
   end type side_relay_t

contains

   !> Both ends of the domain of the solved contact, for its error bars. A note where one cuts off
   !> asperities, or the outlet the film, unless that is known to change the quantities a little.
   subroutine check_ends(case, listener, report)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: listener
      type(report_t), intent(in) :: report
      type(error_bars_t) :: bars
      type(experiment_t) :: at_rest
      type(outcome_t) :: other
      real(wp) :: change
      logical :: is_small

      if (.not. report%converged) return
      call listener%add_note(cut_asperities(case%contact))
      if (.not. (case%solver%wants_coarse_runs .or. report%fit%outlet_pressure > 0.0_wp)) return
      bars = listener%writer%bars
      if (case%solver%wants_coarse_runs) then
         at_rest = new_experiment(case%contact, case%solver, time_settings_t())
         ! roughness passes, the inlet stays
         if (case%time%is_transient) at_rest%contact = without_surfaces(case%contact)
         call run_farther(at_rest, .true., listener, bars%inlet)
         if (bars%is_kappa .and. .not. case%time%is_transient) then
            at_rest%settings%space_scheme = 'upwind2'
            call run_experiment(at_rest, listener, other)
            if (allocated(other%coarser)) then
               if (size(other%coarser) > 0) bars%other_scheme = [other%summary, &
                  other%coarser(:min(2, size(other%coarser)))]
            end if
         end if
      end if
      bars%is_cut = report%fit%outlet_pressure > 0.0_wp
      if (bars%is_cut) then
         if (case%solver%wants_coarse_runs) call run_longer(bars, new_experiment(case%contact, &
            case%solver, case%time), listener)
         change = outlet_error(bars)
         is_small = ieee_is_finite(change)
         if (is_small) is_small = change <= largest_change
         if (.not. is_small) call listener%add_note(outlet_note(case%contact, change))
      end if
      listener%writer%bars = bars
   end subroutine check_ends

   !> What is wrong with the outlet and how to cure it; `change`: of the quantities, NaN if unknown.
   pure function outlet_note(contact, change) result(note)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: change
      character(:), allocatable :: note
      type(line_contact_t) :: chosen

      note = 'the film is still under pressure at the outlet X = ' &
         //to_text(contact%domain%x_outlet, 4)
      if (ieee_is_finite(change)) then
         note = note//', which changes its quantities by up to '//to_text(100*change, 2)//' %'
      else
         note = note//', and what that changes is not known'
      end if
      chosen = contact
      chosen%domain%has_outlet = .false.
      call choose_domain(chosen)
      if (chosen%domain%x_outlet > contact%domain%x_outlet) then
         note = note//': without x_outlet the program takes '//to_text(chosen%domain%x_outlet, 4)
      else
         note = note//': x_outlet farther out cures it'
      end if
   end function outlet_note

   !> Whether wanted coarse runs of a transient get a second thread: allowed, and memory for it.
   logical function has_second_thread(case, listener)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(in) :: listener

      has_second_thread = listener%has_coarse_runs .and. case%time%is_transient &
         .and. min(listener%threads, processors()) > 1
      if (.not. has_second_thread) return
      has_second_thread = memory_fault('two runs', lubricated_memory(2*case%contact%domain &
         %intervals, 2*case%time%end_time/case%time%time_step, is_dense=.false., &
         layers=case%layers), of_blas + thread_memory(2)) == ''
   end function has_second_thread

   !> Solves the case as `solve_ehl_line` does, unless a trial run was that, with two threads at the
   !> same time as its `side_runs`, which are new ones if there are none, or on another domain.
   subroutine solve_with_coarse_runs(case, side_runs, listener, state, report, error)
      type(case_t), intent(inout) :: case
      type(side_runs_t), allocatable, target, intent(inout) :: side_runs
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: x_outlet
      logical :: is_off

      if (.not. allocated(side_runs)) side_runs = new_side_runs(new_experiment(case%contact, &
         case%solver, case%time))
      x_outlet = case%contact%domain%x_outlet
      if (allocated(side_runs%whole)) then
         case%contact = side_runs%whole%contact
         state = side_runs%whole%state
         report = side_runs%whole%report
      else if (has_second_thread(case, listener)) then
         !$omp parallel num_threads(2) private(is_off)
         ! the first thread alone writes and takes signals
         !$omp master
         call solve_ehl_line(case%contact, case%solver, case%time, listener, state, report, error)
         is_off = allocated(error) .or. .not. report%converged
         if (.not. is_off) is_off = abs(case%contact%domain%x_outlet - x_outlet) > 0.0_wp
         call begin_activity('coarse runs')
         if (is_off) then
            !$omp atomic write
            side_runs%begun = useless
         end if
         !$omp end master
         block   ! each thread has its own
            type(side_relay_t) :: relay

            relay%begun => side_runs%begun
            call make_side_runs(side_runs, relay)
         end block
         !$omp end parallel
         listener%is_stopping = listener%is_stopping .or. is_interrupted()
      else
         call solve_ehl_line(case%contact, case%solver, case%time, listener, state, report, &
            error)   ! error: the caller looks
      end if
      is_off = abs(case%contact%domain%x_outlet - x_outlet) > 0.0_wp
      if (is_off .or. .not. case%time%is_transient) side_runs = new_side_runs(new_experiment( &
         case%contact, case%solver, case%time))
   end subroutine solve_with_coarse_runs

   !> Whether the run is of no use.
   function wants_stop(self)
      class(side_relay_t), intent(inout) :: self
      logical :: wants_stop
      integer :: begun

      !$omp atomic read
      begun = self%begun
      wants_stop = self%is_stopping .or. begun >= useless .or. is_interrupted()
      self%is_stopping = wants_stop
   end function wants_stop

end module grid_comparison

!> A transient on one thread, and on another one the coarse runs for its error bars.
module side_by_side
   use case_record, only: case_t
   use coarse_runs, only: side_runs_t, make_side_runs, new_side_runs
   use errors, only: error_t
   use experiment, only: new_experiment
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use listener, only: listener_t
   use run_observer, only: run_observer_t
   use signals, only: begin_activity, is_interrupted
   use steady_target, only: solve_contact
   use system_limits, only: lubricated_memory, memory_fault, of_blas, processors, thread_memory
   implicit none (type, external)
   private

   public :: solve_with_coarse_runs

   !> Listener of the coarse runs: they end when the program is interrupted or when the run itself
   !> has made them useless.
   type, extends(listener_t) :: side_relay_t
      logical, pointer :: are_off => null()
   contains
      procedure :: wants_stop
   end type side_relay_t

contains

   !> Whether the coarse runs that a transient wants get a second thread: two are allowed, and there
   !> are processors and memory for them.
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

   !> Solves the case as `solve_contact` does, with two threads at the same time as its `side_runs`.
   !> They are allocated afterwards if they were made and the solution converged on their domain.
   subroutine solve_with_coarse_runs(case, side_runs, listener, state, report, error)
      type(case_t), intent(inout) :: case
      type(side_runs_t), allocatable, target, intent(out) :: side_runs
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: x_outlet
      logical :: is_off

      if (.not. has_second_thread(case, listener)) then
         call solve_contact(case%contact, case%solver, case%time, listener, state, report, &
            error)   ! error: the caller looks
         return
      end if
      allocate (side_runs)
      side_runs = new_side_runs(new_experiment(case%contact, case%solver, case%time))
      x_outlet = case%contact%domain%x_outlet
      !$omp parallel num_threads(2) private(is_off)
      ! the first thread alone writes and takes signals
      !$omp master
      call solve_contact(case%contact, case%solver, case%time, listener, state, report, error)
      is_off = allocated(error) .or. .not. report%converged
      if (.not. is_off) is_off = abs(case%contact%domain%x_outlet - x_outlet) > 0.0_wp
      call begin_activity('coarse runs')
      if (is_off) then
         !$omp atomic write
         side_runs%are_off = .true.
      end if
      !$omp end master
      call help(side_runs)
      !$omp end parallel
      if (side_runs%are_off) deallocate (side_runs)
      listener%is_stopping = listener%is_stopping .or. is_interrupted()
   end subroutine solve_with_coarse_runs

   !> The part of one thread in the coarse runs.
   subroutine help(side_runs)
      type(side_runs_t), intent(inout), target :: side_runs
      type(side_relay_t) :: relay

      relay%are_off => side_runs%are_off
      call make_side_runs(side_runs, relay)
   end subroutine help

   !> Whether the run is of no use.
   function wants_stop(self)
      class(side_relay_t), intent(inout) :: self
      logical :: wants_stop, are_off

      !$omp atomic read
      are_off = self%are_off
      wants_stop = self%is_stopping .or. are_off .or. is_interrupted()
      self%is_stopping = wants_stop
   end function wants_stop

end module side_by_side

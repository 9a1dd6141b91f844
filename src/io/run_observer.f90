!> Listens to a solver for two: the result file, which stores time steps, and the progress log.
module run_observer
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use observer, only: observer_t
   use progress_log, only: progress_log_t
   use result_writer, only: result_writer_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: run_observer_t

   !> Hands everything on to `writer` and `log`; stops the solver if nothing can be written any more.
   type, extends(observer_t) :: run_observer_t
      type(result_writer_t) :: writer
      type(progress_log_t) :: log
      !> Wall time spent on output [s].
      real(wp) :: output_seconds = 0.0_wp
   contains
      procedure :: on_cycle
      procedure :: on_step
   end type run_observer_t

contains

   !> A cycle: only the log wants to know.
   subroutine on_cycle(self, cycle, residual, load_error)
      class(run_observer_t), intent(inout) :: self
      integer, intent(in) :: cycle
      real(wp), intent(in) :: residual
      real(wp), intent(in) :: load_error

      call self%log%on_cycle(cycle, residual, load_error)
   end subroutine on_cycle

   !> A time step is stored, then told.
   subroutine on_step(self, step, steps, state, report)
      class(run_observer_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      real(wp) :: start

      start = wall_seconds()
      call self%writer%on_step(step, steps, state, report)
      self%wants_stop = self%writer%wants_stop
      call self%log%on_step(step, steps, state, report)
      self%output_seconds = self%output_seconds + wall_seconds() - start
   end subroutine on_step

end module run_observer

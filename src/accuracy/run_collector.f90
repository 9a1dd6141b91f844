!> Listens to a run that serves another one and collects its quantities.
module run_collector
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use listener, only: relay_t
   use march_state, only: march_state_t
   use passage_extremes, only: passage_extremes_t
   use quantities, only: h_min
   implicit none (type, external)
   private

   public :: collector_t

   !> Collects the quantities of a run: of its state, or the extremes over the time steps that
   !> count.
   type, extends(relay_t) :: collector_t
      type(line_summary_t) :: summary
      type(passage_extremes_t) :: passage
      !> Smallest film at each time step of the last transient (0:steps); huge at times that do not
      !> count.
      real(wp), allocatable :: films(:)
   contains
      procedure :: on_step => collect_step
      procedure :: on_stage => forward_coarse_run
   end type collector_t

contains

   !> Says that it is not the run itself.
   recursive subroutine forward_coarse_run(self, words, cycle, residuals)
      class(collector_t), intent(inout) :: self
      character(*), intent(in) :: words
      integer, intent(in), optional :: cycle
      real(wp), intent(in), optional :: residuals(2)

      call self%relay_t%on_stage('coarse run, '//words, cycle, residuals)
   end subroutine forward_coarse_run

   !> Adds the quantities of one time step.
   subroutine collect_step(self, step, steps, state, history, report)
      class(collector_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(march_state_t), intent(in) :: history
      type(report_t), intent(in) :: report
      type(line_summary_t) :: summary

      associate (unused_history => history, unused_report => report)
      end associate
      if (step == 0) then
         if (allocated(self%films)) deallocate (self%films)
         allocate (self%films(0:steps), source=huge(1.0_wp))
      end if
      summary = summary_of(state)
      if (self%passage%times%counts(state%time)) self%films(step) = summary%of(h_min)%value
      call self%passage%add(summary, state%time, step == steps)
   end subroutine collect_step

end module run_collector

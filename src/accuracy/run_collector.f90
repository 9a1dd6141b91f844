!> Listens to a run that serves another one and collects its quantities.
module run_collector
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use observer, only: lookout_t
   use passage_extremes, only: passage_extremes_t
   use quantities, only: h_min
   implicit none (type, external)
   private

   public :: collector_t

   !> Collects the quantities of a run: of its state, or the extremes over the time steps that
   !> count.
   type, extends(lookout_t) :: collector_t
      type(line_summary_t) :: summary
      type(passage_extremes_t) :: passage
      !> Coarser grids that a steady run has passed.
      type(line_summary_t), allocatable :: passed(:)
      !> Smallest film at each time step of the last transient (0:steps); huge at times that do not
      !> count.
      real(wp), allocatable :: films(:)
   contains
      procedure :: on_step => collect_step
      procedure :: keep_coarser => collect_coarser
      procedure :: on_stage => tell_coarse_run
   end type collector_t

contains

   !> Keeps what a steady run has passed.
   subroutine collect_coarser(self, coarser)
      class(collector_t), intent(inout) :: self
      type(line_summary_t), intent(in) :: coarser(:)

      self%passed = coarser
   end subroutine collect_coarser

   !> Not the run itself.
   recursive subroutine tell_coarse_run(self, words)
      class(collector_t), intent(inout) :: self
      character(*), intent(in) :: words

      call self%watcher%on_stage('coarse run, '//words)
   end subroutine tell_coarse_run

   !> Adds the quantities of one time step.
   subroutine collect_step(self, step, steps, state, report)
      class(collector_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(line_summary_t) :: summary

      associate (unused_report => report)
      end associate
      if (step == 0) then
         if (allocated(self%films)) deallocate (self%films)
         allocate (self%films(0:steps), source=huge(1.0_wp))
      end if
      summary = summary_of(state)
      if (self%passage%times%counts(state%time)) self%films(step) = summary%of(h_min)%value
      call self%passage%add(summary, state%time, step == steps)
      call self%look_outside()
   end subroutine collect_step

end module run_collector

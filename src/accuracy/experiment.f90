!> One run of a variant of a lubricated contact: another grid, domain, time step, scheme or model.
!> Error bars, target accuracies and adequacy compare such runs.
module experiment
   use, intrinsic :: iso_fortran_env, only: int64
   use ehl_line_solver, only: solve_ehl_line
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, solver_settings_t, time_settings_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use listener, only: listener_t, relay_t
   use march_state, only: march_state_t
   use passage_extremes, only: passage_extremes_t
   use passage_times, only: new_passage_times
   use text, only: to_text
   implicit none (type, external)
   private

   public :: coarser, collector_t, experiment_t, new_experiment, outcome_t, run_experiment, &
      solution_t

   !> Runs for comparison have at least this many intervals.
   integer, parameter, public :: min_intervals = 32

   !> A contact on a complete domain, solver settings and time step.
   type :: experiment_t
      type(line_contact_t) :: contact
      type(solver_settings_t) :: settings
      type(time_settings_t) :: time
   end type experiment_t

   !> Result of a run.
   type :: outcome_t
      !> Whether there is a solution, and why there is none if memory or a library failed.
      logical :: is_known = .false.
      type(error_t), allocatable :: error
      !> Its quantities (of a transient their extremes), and of a steady contact those on the n/2,
      !> n/4 ... intervals of its nested start.
      type(line_summary_t) :: summary
      type(line_summary_t), allocatable :: coarser(:)
      !> Nodes times Newton steps.
      real(wp) :: work = 0.0_wp
   end type outcome_t

   !> A solution whole, with its contact as the solver leaves it.
   type :: solution_t
      type(line_contact_t) :: contact
      type(line_state_t) :: state
      type(report_t) :: report
   end type solution_t

   !> Collects the extremes over the time steps that count.
   type, extends(relay_t) :: collector_t
      type(passage_extremes_t) :: passage
      !> The time steps go to the parent, too.
      logical :: passes_on = .false.
      !> What it does.
      character(:), allocatable :: stage
   contains
      procedure :: on_step => collect_step
      procedure :: on_part => collect_part
      procedure :: on_stage => forward_coarse_run
   end type collector_t

contains

   !> The case on its complete domain, without options that only its final result needs.
   pure function new_experiment(contact, settings, time) result(self)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      type(experiment_t) :: self

      self = experiment_t(contact, settings, time)
      if (allocated(self%time%resume_from)) deallocate (self%time%resume_from)
      associate (own => self%settings)
         own%levels = 0
         own%explains_failure = .false.
         own%film_floor = 0.0_wp
         own%target = 0.0_wp
         own%wants_coarse_runs = .true.
         ! if Newton fails on a coarser grid, so do the fallbacks: skip them
         if (own%method == 'auto' .and. own%smoother == 'auto') own%method = 'newton_krylov'
         if (.not. time%is_transient) own%method = 'newton_krylov'
      end associate
   end function new_experiment

   !> The same on `factor` times fewer intervals with an equally larger time step; 0 intervals if
   !> there would be fewer than `min_intervals`.
   pure function coarser(self, factor)
      type(experiment_t), intent(in) :: self
      integer, intent(in) :: factor
      type(experiment_t) :: coarser

      coarser = self
      associate (intervals => coarser%contact%domain%intervals, time => coarser%time)
         intervals = intervals/factor
         if (intervals < min_intervals) intervals = 0
         time%time_step = factor*time%time_step
         time%tolerance = factor**3*time%tolerance
      end associate
   end function coarser

   !> Runs the experiment, unless it has no intervals or another one has failed: an error stops the
   !> listener. With `solution` that receives its time steps, too.
   subroutine run_experiment(self, listener, outcome, solution)
      type(experiment_t), intent(in) :: self
      class(listener_t), intent(inout), target :: listener
      type(outcome_t), intent(out) :: outcome
      type(solution_t), intent(out), optional :: solution
      type(collector_t) :: collector
      type(line_contact_t) :: contact
      type(line_state_t) :: last
      type(report_t) :: report

      if (self%contact%domain%intervals == 0 .or. allocated(listener%error)) return
      contact = self%contact
      contact%domain%may_lengthen = .false.
      collector%parent => listener
      collector%passes_on = present(solution)
      if (present(solution)) collector%stress_stride = listener%stress_stride
      collector%passage = passage_extremes_t(new_passage_times(contact, self%time))
      call solve_ehl_line(contact, self%settings, self%time, collector, last, report, outcome%error)
      if (allocated(outcome%error)) then
         listener%error = outcome%error
         listener%is_stopping = .true.
         return
      end if
      outcome%is_known = report%converged
      outcome%work = report%cycles*real(contact%domain%intervals, wp)
      if (.not. outcome%is_known) return
      outcome%summary = collector%passage%extremes(summary_of(last))
      call move_alloc(collector%coarser, outcome%coarser)
      if (present(solution)) solution = solution_t(contact, last, report)
   end subroutine run_experiment

   !> Forwards a stage, marked as one of a coarse run.
   recursive subroutine forward_coarse_run(self, words, cycle, residuals)
      class(collector_t), intent(inout) :: self
      character(*), intent(in) :: words
      integer, intent(in), optional :: cycle
      real(wp), intent(in), optional :: residuals(2)

      if (.not. present(cycle)) self%stage = words
      call self%relay_t%on_stage('coarse run, '//words, cycle, residuals)
   end subroutine forward_coarse_run

   !> Adds the quantities of one time step; each hundredth of the way is a stage.
   subroutine collect_step(self, step, steps, state, history, report)
      class(collector_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(march_state_t), intent(in) :: history
      type(report_t), intent(in) :: report

      call self%passage%add(summary_of(state), state%time, step == steps)
      if (100_int64*step/steps > 100_int64*(step - 1)/steps) call self%parent%on_stage( &
         'coarse run, '//to_text(int(100_int64*step/steps))//' % of '//self%stage)
      if (self%passes_on) call self%parent%on_step(step, steps, state, history, report)
   end subroutine collect_step

   !> Adds the quantities inside a time step.
   subroutine collect_part(self, state)
      class(collector_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state

      call self%passage%add(summary_of(state), state%time, is_last=.false.)
   end subroutine collect_part

end module experiment

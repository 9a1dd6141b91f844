!> Runs of variants of a lubricated contact: another grid, domain, time step, scheme or model. Error
!> bars, target accuracies and adequacy compare such runs; those for error bars, none made twice.
module experiment
   use, intrinsic :: iso_fortran_env, only: int64
   use domain_choice, only: farthest, inlet_error
   use ehl_line_solver, only: solve_ehl_line
   use error_bars, only: domain_change_t, error_bars_t
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, max_chosen, solver_settings_t, time_settings_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use listener, only: listener_t, relay_t
   use march_state, only: march_state_t
   use passage_extremes, only: passage_extremes_t
   use passage_times, only: new_passage_times
   use quantities, only: x_cavitation
   use text, only: to_text
   implicit none (type, external)
   private

   public :: coarser, collector_t, copy_side_runs, experiment_t, make_side_runs, new_experiment, &
      new_side_runs, outcome_t, run_experiment, run_farther, run_longer, side_runs_t, solution_t

   !> Runs for comparison have at least this many intervals.
   integer, parameter, public :: min_intervals = 32
   !> No number of coarse runs.
   integer, parameter, public :: useless = 2**30

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
      !> Its quantities (in time extremes), at rest those on n/2, n/4 ... intervals, too.
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

   !> Up to this loss of film the inlet rule gives the error; beyond, the change is measured.
   real(wp), parameter :: small_loss = 0.05_wp

   !> Coarse runs on n/2 and n/4 intervals, in time with larger steps; with a first-order scheme one
   !> on n by the second-order one before them. They do not depend on the actual run: another thread
   !> may make them at the same time, or trial runs were those. Behind one without a solution all
   !> others are useless.
   type :: side_runs_t
      type(experiment_t) :: experiment
      type(outcome_t), allocatable :: runs(:)
      !> Number begun so far, `useless` and more: they have become useless.
      integer :: begun = 0
      !> The run itself, where a trial run was that; not allocated: it is not known.
      type(solution_t), allocatable :: whole
   end type side_runs_t

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

   !> The same on `factor` times fewer intervals, 0 below `min_intervals`, with larger steps.
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

   !> Prepares the coarse runs of an experiment.
   pure function new_side_runs(experiment) result(side_runs)
      type(experiment_t), intent(in) :: experiment
      type(side_runs_t) :: side_runs

      side_runs%experiment = experiment
      allocate (side_runs%runs(merge(3, 2, experiment%time%scheme == 'backward_euler')))
   end function new_side_runs

   !> Makes the runs that are not known one after the other while they are useful, on any thread,
   !> whose `listener` may stop a run: its quantities are then unknown.
   subroutine make_side_runs(side_runs, listener)
      type(side_runs_t), intent(inout) :: side_runs
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: accurate
      integer :: i, last

      accurate = side_runs%experiment
      last = size(side_runs%runs)
      if (accurate%time%scheme == 'backward_euler') accurate%time%scheme = 'bdf2'
      do
         !$omp atomic capture
         side_runs%begun = side_runs%begun + 1
         i = side_runs%begun
         !$omp end atomic
         if (i > last) return
         associate (run => side_runs%runs(i), runs => side_runs%runs)
            if (run%is_known) cycle
            call run_experiment(coarser(accurate, 2**(i + 2 - last)), listener, run)
            if (i < last .and. allocated(run%coarser)) then
               ! a steady one has passed the next on its way
               if (size(run%coarser) > 0) runs(i + 1) = outcome_t(.true., summary=run%coarser(1))
            end if
            if (run%is_known) cycle
         end associate
         ! those behind it are useless; before it another thread may be at work
         !$omp atomic write
         side_runs%begun = merge(useless, last, i == 1)
      end do
   end subroutine make_side_runs

   !> Copies the results into new `bars`; `error` is the first one that occurred.
   pure subroutine copy_side_runs(side_runs, bars, error)
      type(side_runs_t), intent(in) :: side_runs
      type(error_bars_t), intent(inout) :: bars
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      associate (runs => side_runs%runs)
         do i = 1, size(runs)
            if (allocated(runs(i)%error)) error = runs(i)%error
            if (allocated(error) .or. .not. runs(i)%is_known) return
            if (i == size(runs) - 2) then
               bars%second_order = runs(i)%summary
            else
               bars%grids = bars%grids + 1
               bars%coarser(bars%grids) = runs(i)%summary
            end if
         end do
      end associate
   end subroutine copy_side_runs

   !> Runs the case at the spacing of n/2 intervals on a domain lengthened behind the outlet, to
   !> measure what the outlet cuts off: twice the length; in steady contacts up to eight times,
   !> until nothing is cut off. On a graded grid, with this outlet and with that of the program.
   subroutine run_longer(bars, experiment, listener)
      type(error_bars_t), intent(inout) :: bars
      type(experiment_t), intent(in) :: experiment
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: longer
      type(outcome_t) :: outcome
      integer :: doubling

      longer = experiment
      if (longer%contact%domain%grid == 'graded') then
         call run_farther(experiment, .false., listener, bars%outlet)
         return
      end if
      if (bars%grids == 0) return
      bars%outlet%near = bars%coarser(1)
      associate (domain => longer%contact%domain, is_transient => experiment%time%is_transient, &
         outlet => bars%outlet)
         do doubling = 1, merge(1, 3, is_transient)
            domain%x_outlet = 2*domain%x_outlet - domain%x_inlet
            if (domain%x_outlet > farthest) return
            domain%intervals = 2*domain%intervals
            if (domain%intervals/2 > max_chosen(experiment%settings)) return
            call run_experiment(coarser(longer, 2), listener, outcome)
            outlet%is_known = outcome%is_known
            if (.not. outlet%is_known) return
            outlet%far = outcome%summary
            outlet%is_known = is_transient .or. outlet%far%of(x_cavitation)%value &
               < domain%x_outlet - 3*(domain%x_outlet - domain%x_inlet)/domain%intervals
            if (outlet%is_known) return
         end do
      end associate
   end subroutine run_longer

   !> Measures what one end of a steady contact cuts off, on graded grids with this end and with
   !> that of the program; an inlet only if it takes much film by the inlet rule (`inlet_error`).
   subroutine run_farther(experiment, is_inlet, listener, change)
      type(experiment_t), intent(in) :: experiment
      logical, intent(in) :: is_inlet
      class(listener_t), intent(inout), target :: listener
      type(domain_change_t), intent(inout) :: change
      type(experiment_t) :: graded
      type(outcome_t) :: near, far

      if (is_inlet .and. .not. inlet_error(experiment%contact) > small_loss) return
      graded = experiment
      associate (domain => graded%contact%domain)
         domain%grid = 'graded'
         call run_experiment(graded, listener, near)
         if (.not. near%is_known) return
         if (is_inlet) domain%has_inlet = .false.
         if (.not. is_inlet) domain%has_outlet = .false.
      end associate
      call run_experiment(graded, listener, far)
      change = domain_change_t(far%is_known, near%summary, far%summary)
   end subroutine run_farther

end module experiment

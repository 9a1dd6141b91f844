!> Runs of the same case on coarser grids, with larger time steps or on longer domains, for its
!> error bars; none is made twice.
module coarse_runs
   use domain_choice, only: choose_domain, farthest, inlet_error
   use error_bars, only: copy_coarser, error_bars_t, new_error_bars
   use errors, only: error_t
   use experiment, only: coarser, experiment_t, outcome_t, run_experiment, solution_t
   use inlet_errors, only: domain_change_t
   use kinds, only: wp
   use listener, only: listener_t
   use quantities, only: x_cavitation
   use line_contact, only: max_chosen
   implicit none (type, external)
   private

   public :: copy_side_runs, make_side_runs, new_side_runs, run_farther, run_longer, &
      run_other_scheme, side_runs_t

   !> Up to this loss of film the inlet rule gives the error; beyond, the change is measured.
   real(wp), parameter :: small_loss = 0.05_wp

   !> Coarse runs on n/2 and n/4 intervals, in time with larger steps; with a first-order scheme one
   !> on n by the second-order one before them. They do not depend on the actual run: another thread
   !> may make them at the same time, or trial runs were those. Behind one without a solution all
   !> others are useless.
   type :: side_runs_t
      type(experiment_t) :: experiment
      type(outcome_t), allocatable :: runs(:)
      !> Number begun so far.
      integer :: begun = 0
      !> Whether they have become useless.
      logical :: are_off = .false.
      !> The run itself, where a trial run was that; not allocated: it is not known.
      type(solution_t), allocatable :: whole
   end type side_runs_t

contains

   !> Prepares the coarse runs of an experiment.
   pure function new_side_runs(experiment) result(side_runs)
      type(experiment_t), intent(in) :: experiment
      type(side_runs_t) :: side_runs

      side_runs%experiment = experiment
      allocate (side_runs%runs(merge(3, 2, experiment%time%scheme == 'backward_euler')))
   end function new_side_runs

   !> Makes the runs that are not known one after the other while they are useful. Any number of
   !> threads may call this; `listener` belongs to the thread and may stop a run, whose quantities
   !> are then unknown.
   subroutine make_side_runs(side_runs, listener)
      type(side_runs_t), intent(inout) :: side_runs
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: accurate
      logical :: are_off
      integer :: i, last

      accurate = side_runs%experiment
      last = size(side_runs%runs)
      if (accurate%time%scheme == 'backward_euler') accurate%time%scheme = 'bdf2'
      do
         !$omp atomic capture
         side_runs%begun = side_runs%begun + 1
         i = side_runs%begun
         !$omp end atomic
         !$omp atomic read
         are_off = side_runs%are_off
         if (are_off .or. i > last) return
         associate (run => side_runs%runs(i), runs => side_runs%runs)
            if (run%is_known) cycle
            call run_experiment(coarser(accurate, 2**(i + 2 - last)), listener, run)
            if (i < last .and. allocated(run%coarser)) then
               ! a steady one has passed the next on its way
               if (size(run%coarser) > 0) runs(i + 1) = outcome_t(.true., summary=run%coarser(1))
            end if
            if (run%is_known) cycle
         end associate
         ! those behind it are useless, and before it another thread may be at work
         !$omp atomic write
         side_runs%begun = last
         if (i > 1) return
         !$omp atomic write
         side_runs%are_off = .true.
      end do
   end subroutine make_side_runs

   !> Copies the results into `bars`; `error` is the first one that occurred.
   subroutine copy_side_runs(side_runs, bars, error)
      type(side_runs_t), intent(in) :: side_runs
      type(error_bars_t), intent(out) :: bars
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      associate (experiment => side_runs%experiment, runs => side_runs%runs)
         bars = new_error_bars(experiment%contact, experiment%time, &
            experiment%settings%space_scheme)
         do i = 1, size(runs)
            if (allocated(runs(i)%error)) error = runs(i)%error
            if (allocated(error) .or. .not. runs(i)%is_known) return
            if (i == size(runs) - 2) then
               bars%second_order = runs(i)%summary
            else
               call copy_coarser(bars, [bars%coarser(:bars%grids), runs(i)%summary])
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
         call run_experiment(longer, listener, outcome)
         if (.not. outcome%is_known) return
         bars%outlet%near = outcome%summary
         longer%contact%domain%has_outlet = .false.
         call run_experiment(longer, listener, outcome)
         bars%outlet%is_known = outcome%is_known
         bars%outlet%far = outcome%summary
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

   !> Measures the influence of the inlet of a steady contact that loses much film by the inlet rule
   !> (`inlet_error`): on a graded grid of its domain and on one with a far inlet.
   subroutine run_farther(bars, experiment, listener)
      type(error_bars_t), intent(inout) :: bars
      type(experiment_t), intent(in) :: experiment
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: graded
      type(outcome_t) :: near, far

      if (.not. inlet_error(experiment%contact) > small_loss) return
      graded = experiment
      graded%settings%target = 0.0_wp
      graded%contact%domain%grid = 'graded'
      call run_experiment(graded, listener, near)
      if (.not. near%is_known) return
      graded%contact%domain%has_inlet = .false.
      call choose_domain(graded%contact)
      call run_experiment(graded, listener, far)
      bars%inlet = domain_change_t(far%is_known, near%summary, far%summary)
   end subroutine run_farther

   !> Runs a steady case solved with kappa also with upwind2, on its grid and the coarser ones of
   !> the nested start.
   subroutine run_other_scheme(bars, experiment, listener)
      type(error_bars_t), intent(inout) :: bars
      type(experiment_t), intent(in) :: experiment
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: other
      type(outcome_t) :: outcome

      if (.not. bars%is_kappa) return
      other = experiment
      other%settings%space_scheme = 'upwind2'
      call run_experiment(other, listener, outcome)
      if (.not. outcome%is_known) return
      if (size(outcome%coarser) > 0) bars%other_scheme = [outcome%summary, outcome%coarser]
   end subroutine run_other_scheme

end module coarse_runs

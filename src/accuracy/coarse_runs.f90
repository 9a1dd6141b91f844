!> Runs of the same case on coarser grids, in a transient with larger time steps, where the run
!> itself has not passed them on its way.
module coarse_runs
   use domain_choice, only: choose_inlet, farthest, inlet_error
   use ehl_line_solver, only: solve_ehl_line
   use error_bars, only: error_bars_t, new_error_bars
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use listener, only: listener_t
   use run_collector, only: collector_t
   use passage_extremes, only: passage_extremes_t
   use passage_times, only: new_passage_times
   use quantities, only: x_cavitation
   use solver_settings, only: domain_t, max_chosen, solver_settings_t, time_settings_t
   use split_errors, only: foretold_values, orders_in_time
   implicit none (type, external)
   private

   public :: side_runs_t, make_coarse_runs, make_side_runs, new_side_runs, run_apart, &
      run_farther, run_for_comparison, run_longer, run_other_scheme, copy_side_runs

   !> Coarse runs that error bars come from have at least this many intervals.
   integer, parameter :: min_intervals = 32
   !> Up to this share of the film the rule of the inlet tells what it starves; beyond that the
   !> change is measured, on a domain that is doubled this many times at most.
   real(wp), parameter :: small_loss = 0.05_wp
   integer, parameter :: max_doublings = 5

   !> A coarse run of a transient, which does not depend on the run itself: another thread may make
   !> it while that goes on. On `factor` times fewer intervals with time steps as much larger.
   type :: side_run_t
      integer :: factor
      !> Without its solution the other ones are of no use.
      logical :: is_needed
      logical :: is_known = .false.
      type(line_summary_t) :: summary
      type(error_t), allocatable :: error
   end type side_run_t

   !> All of them, in the order in which they begin.
   type :: side_runs_t
      type(line_contact_t) :: contact
      type(solver_settings_t) :: settings
      type(time_settings_t) :: time
      type(side_run_t), allocatable :: runs(:)
      !> This many have begun.
      integer :: begun = 0
      !> They are of no use any more.
      logical :: are_off = .false.
   end type side_runs_t

contains

   !> Runs a steady case on n/2 and n/4 intervals; in time `make_side_runs` does it. A run that
   !> finds no solution, or that `listener` stops, leaves its quantities unknown.
   subroutine make_coarse_runs(bars, contact, settings, listener, error)
      type(error_bars_t), intent(out) :: bars
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(time_settings_t) :: steady

      bars = new_error_bars(contact, steady, settings%space_scheme)
      collector%parent => listener
      call run_coarser(contact, settings, steady, 2, collector, bars%has_half, error)
      if (allocated(error)) return
      bars%half = collector%summary
      if (size(collector%coarser) > 0) then
         bars%has_quarter = .true.
         bars%quarter = collector%coarser(1)
      else
         call run_coarser(contact, settings, steady, 4, collector, bars%has_quarter, &
            error)   ! error: the caller looks
         bars%quarter = collector%summary
      end if
   end subroutine make_coarse_runs

   !> Of a `contact` on its grid and with its time steps: n/2 and n/4 intervals, with the scheme of
   !> second order; of a transient of first order, first its own grid with that scheme.
   pure function new_side_runs(contact, settings, time) result(side_runs)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      type(side_runs_t) :: side_runs
      type(error_bars_t) :: bars

      side_runs%contact = contact
      side_runs%settings = settings
      side_runs%time = time
      if (allocated(time%resume_from)) deallocate (side_runs%time%resume_from)
      side_runs%runs = [side_run_t(2, is_needed=.false.), side_run_t(4, is_needed=.false.)]
      bars = new_error_bars(contact, time, settings%space_scheme)
      if (bars%is_first_order) side_runs%runs = [side_run_t(1, is_needed=.true.), &
         side_runs%runs]
   end function new_side_runs

   !> Makes the runs that are not begun yet, one after the other, while they are of use. Any number
   !> of threads may call it; `listener` is that of the thread and may stop a run, whose quantities
   !> are then unknown.
   subroutine make_side_runs(side_runs, listener)
      type(side_runs_t), intent(inout) :: side_runs
      class(listener_t), intent(inout), target :: listener
      type(collector_t) :: collector
      type(time_settings_t) :: time
      logical :: are_off
      integer :: i

      collector%parent => listener
      time = side_runs%time
      time%scheme = 'bdf2'
      do
         !$omp atomic capture
         side_runs%begun = side_runs%begun + 1
         i = side_runs%begun
         !$omp end atomic
         !$omp atomic read
         are_off = side_runs%are_off
         if (are_off .or. i > size(side_runs%runs)) return
         associate (run => side_runs%runs(i))
            call run_coarser(side_runs%contact, side_runs%settings, time, run%factor, collector, &
               run%is_known, run%error)
            run%summary = collector%summary
            if (run%is_known .or. .not. (run%is_needed .or. allocated(run%error))) cycle
         end associate
         !$omp atomic write
         side_runs%are_off = .true.
      end do
   end subroutine make_side_runs

   !> What the runs are for; `error` is the first of theirs.
   subroutine copy_side_runs(side_runs, bars, error)
      type(side_runs_t), intent(in) :: side_runs
      type(error_bars_t), intent(out) :: bars
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      bars = new_error_bars(side_runs%contact, side_runs%time, side_runs%settings%space_scheme)
      do i = 1, size(side_runs%runs)
         associate (run => side_runs%runs(i))
            if (allocated(run%error)) error = run%error
            if (allocated(error) .or. (run%is_needed .and. .not. run%is_known)) return
            select case (run%factor)
            case (1)
               bars%second_order = run%summary
            case (2)
               bars%has_half = run%is_known
               bars%half = run%summary
            case default
               bars%has_quarter = run%is_known
               bars%quarter = run%summary
            end select
         end associate
      end do
   end subroutine copy_side_runs

   !> Runs a transient whose resolution was chosen with twice the spacing, and with twice the time
   !> step: errors of both often cancel, and together they would tell too little. Without a solution
   !> of one of them neither is known.
   subroutine run_apart(bars, contact, settings, time, listener, error)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(line_contact_t) :: own
      type(time_settings_t) :: slow
      real(wp) :: orders(3)
      integer :: steps, slow_steps
      logical :: is_known

      steps = nint(time%end_time/time%time_step)
      slow_steps = (steps + 1)/2
      if (steps < 2) return
      collector%parent => listener
      own = contact
      slow = time
      slow%time_step = time%end_time/slow_steps
      associate (apart => bars%apart, n => own%domain%intervals)
         n = n/2
         call run_for_comparison(own, settings, time, collector, is_known, error)
         if (allocated(error) .or. .not. is_known) return
         apart%coarse = foretold_values(collector%summary)
         n = contact%domain%intervals
         call run_for_comparison(own, settings, slow, collector, apart%is_known, error)
         if (allocated(error)) return
         apart%slow = foretold_values(collector%summary)
         apart%step_ratio = real(steps, wp)/slow_steps
         orders = orders_in_time(time%scheme)
         apart%time_order = orders(2)
      end associate
   end subroutine run_apart

   !> The case at the spacing of n/2 intervals on a domain that is longer behind the outlet: what
   !> the outlet cuts off. Twice the length; of a steady contact up to eight times, until nothing is
   !> cut off any more.
   subroutine run_longer(bars, contact, settings, time, listener, error)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(line_contact_t) :: longer
      integer :: doubling

      if (.not. bars%has_half) return
      collector%parent => listener
      longer = contact
      do doubling = 1, merge(1, 3, time%is_transient)
         associate (domain => longer%domain)
            domain%x_outlet = 2*domain%x_outlet - domain%x_inlet
            if (domain%x_outlet > farthest) return
            domain%intervals = 2*domain%intervals
            if (domain%intervals/2 > max_chosen(settings)) return
            call run_coarser(longer, settings, time, 2, collector, bars%has_longer, error)
            if (allocated(error) .or. .not. bars%has_longer) return
            bars%longer = collector%summary
            bars%has_longer = time%is_transient .or. &
               collector%summary%of(x_cavitation)%value < domain%x_outlet &
                  - 3*(domain%x_outlet - domain%x_inlet)/domain%intervals
         end associate
         if (bars%has_longer) return
      end do
   end subroutine run_longer

   !> What the inlet of a steady `contact` changes that has a tail in front of it, or by the rule
   !> starves the film by much (`inlet_error`): the case on a quarter of its intervals (half of
   !> them, where that finds no solution), and at the same spacing on a domain twice as long;
   !> without a tail on one with the inlet that would be chosen, at least, unless that takes more
   !> intervals than a grid that is chosen may have.
   subroutine run_farther(bars, contact, settings, listener, error)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(line_contact_t) :: longer
      type(solver_settings_t) :: exact
      type(time_settings_t) :: steady
      integer :: factor
      logical :: has_tail, is_out

      has_tail = contact%domain%inlet == 'tail'
      if (.not. (has_tail .or. inlet_error(contact) > small_loss)) return
      longer = contact
      if (has_tail) then
         call double_in_front(longer%domain)
      else
         call reach_out(longer, 2*max_chosen(settings), is_out)
         if (.not. is_out) return
      end if
      collector%parent => listener
      exact = settings
      exact%tolerance = 0.0_wp
      associate (inlet => bars%inlet)
         do factor = 4, 2, -2
            call run_coarser(contact, exact, steady, factor, collector, inlet%is_known, error)
            if (allocated(error)) return
            if (.not. inlet%is_known) cycle
            inlet%near = collector%summary
            call run_coarser(longer, exact, steady, factor, collector, inlet%is_known, error)
            if (allocated(error)) return
            inlet%far = collector%summary
            if (inlet%is_known) return
         end do
      end associate
   end subroutine run_farther

   !> Twice the length, by more in front, at the same spacing.
   pure subroutine double_in_front(domain)
      type(domain_t), intent(inout) :: domain

      domain%x_inlet = 2*domain%x_inlet - domain%x_outlet
      domain%intervals = 2*domain%intervals
   end subroutine double_in_front

   !> Doubles the domain of `contact` until its inlet is as far out as a chosen one, and of that
   !> kind; `is_out`: a few times suffice, with at most this many intervals.
   pure subroutine reach_out(contact, max_intervals, is_out)
      type(line_contact_t), intent(inout) :: contact
      integer, intent(in) :: max_intervals
      logical, intent(out) :: is_out
      type(line_contact_t) :: chosen
      integer :: doubling

      chosen = contact
      chosen%domain%has_inlet = .false.
      chosen%domain%inlet = 'auto'
      call choose_inlet(chosen)
      contact%domain%inlet = chosen%domain%inlet
      do doubling = 1, max_doublings
         is_out = contact%domain%x_inlet <= chosen%domain%x_inlet
         if (is_out .or. contact%domain%intervals > max_intervals/2) return
         call double_in_front(contact%domain)
      end do
      is_out = contact%domain%x_inlet <= chosen%domain%x_inlet
   end subroutine reach_out

   !> A steady `contact` that the kappa scheme has solved, by that of the thesis on its own grid and
   !> on those that it passes on the way.
   subroutine run_other_scheme(bars, contact, settings, listener, error)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(solver_settings_t) :: other
      type(time_settings_t) :: steady
      logical :: is_known

      if (.not. bars%is_kappa) return
      collector%parent => listener
      other = settings
      other%space_scheme = 'upwind2'
      call run_coarser(contact, other, steady, 1, collector, is_known, error)
      if (allocated(error) .or. .not. is_known .or. size(collector%coarser) == 0) return
      bars%other_scheme = [collector%summary, collector%coarser]
   end subroutine run_other_scheme

   !> The case on `factor` times fewer intervals with a time step as much larger; its quantities are
   !> those of `collector`.
   subroutine run_coarser(contact, settings, time, factor, collector, is_known, error)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      integer, intent(in) :: factor
      type(collector_t), intent(inout) :: collector
      logical, intent(out) :: is_known
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: coarse
      type(time_settings_t) :: coarse_time

      collector%coarser = [line_summary_t ::]
      coarse = contact
      coarse%domain%intervals = coarse%domain%intervals/factor
      is_known = .false.
      if (coarse%domain%intervals < min_intervals) return
      coarse_time = time
      if (time%time_step > 0.0_wp) coarse_time%time_step = factor*time%time_step
      call run_for_comparison(coarse, settings, coarse_time, collector, is_known, &
         error)   ! error: the caller looks
   end subroutine run_coarser

   !> The case on its own complete domain as a coarse run, without what only an answer needs;
   !> `is_known`: its quantities, those of `collector`, are a solution's.
   subroutine run_for_comparison(contact, settings, time, collector, is_known, error)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      type(collector_t), intent(inout) :: collector
      logical, intent(out) :: is_known
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: own
      type(solver_settings_t) :: own_settings
      type(line_state_t) :: state
      type(report_t) :: report

      own = contact
      own%domain%may_lengthen = .false.
      own_settings = settings
      own_settings%levels = 0
      own_settings%explains_failure = .false.
      own_settings%film_floor = 0.0_wp
      ! if Newton fails on a coarser grid, so do the fallbacks: skip them
      if (settings%method == 'auto' .and. settings%smoother == 'auto') own_settings%method = &
         'newton_krylov'
      if (.not. time%is_transient) own_settings%method = 'newton_krylov'
      own_settings%target = 0.0_wp
      own_settings%wants_coarse_runs = .true.
      is_known = .false.
      collector%passage = passage_extremes_t(new_passage_times(own, time))
      call solve_ehl_line(own, own_settings, time, collector, state, report, error)
      if (allocated(error)) return
      is_known = report%converged
      if (is_known) collector%summary = collector%passage%extremes(summary_of(state))
   end subroutine run_for_comparison

end module coarse_runs

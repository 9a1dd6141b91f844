!> Measures the adequacy of the model of a lubricated result.
!>
!> Its cost is bounded by a share of the cost of the run, or by that of a small run, in nodes times
!> Newton steps rather than seconds, so that a repeated run measures the same. Ingredients of oil
!> and bodies are left out of the smooth steady contact, at little cost. Transients with all
!> ingredients are known already: the result, and the runs on n/2 and n/4 intervals for its error
!> bars. Smooth surfaces take one steady solution on each grid; without the squeeze term, steady
!> solutions follow the waves. With `adequacy%is_full` whatever remains open is run in time on n/2
!> and n/4, at any cost.
!>
!> The error by the time step alone: a run with a target already has a coarse run with a larger
!> step, and a first-order run one by the second-order scheme. Otherwise one more run on n/4
!> intervals, with twice the step of that of the error bars, shows the effect of a larger step.
module measured_adequacy
   use ablation_runs, only: change_between, largest_change, measure_at_rest, widths
   use ablations, only: ingredient_t, ingredients_of, is_of_surfaces, roughness, squeeze
   use adequacy, only: adequacy_t, influence_t, judge_at_rest, new_influence
   use domain_choice, only: choose_domain
   use error_bars, only: error_bars_t
   use errors, only: error_t
   use experiment, only: experiment_t, outcome_t, run_experiment, solution_t
   use graded_contact, only: even_state
   use kinds, only: wp
   use line_contact, only: domain_t, line_contact_t, solver_settings_t, time_settings_t, &
      without_surfaces
   use line_hierarchy, only: coarsest_for_film
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use listener, only: listener_t
   use passage_pair, only: limit_places, max_cycles, measure_change, new_pair, passage_pair_t, &
      run_both, sees_all, steps_to_start
   use quantities, only: quantity_count
   implicit none (type, external)
   private

   public :: full_cost, measure_adequacy, set_step_error, solved_t

   !> A solved case: its settings, quantities, Newton steps and error bars.
   type :: solved_t
      type(experiment_t) :: experiment
      type(line_summary_t) :: full
      real(wp) :: newton_steps = 0.0_wp
      type(error_bars_t) :: bars
   end type solved_t

   !> The budget is this share of the cost of the run, or that of a small run (20 ms, 2700
   !> instructions a node and step, output excluded).
   real(wp), parameter :: share = 0.1_wp, small_run = 5.0e4_wp
   !> Newton steps of a steady run counted on its finest grid, with coarser grids and error bars.
   real(wp), parameter :: steady_steps = 12.0_wp
   !> Cost of a Newton step of a transient over a steady one, with output (valgrind: 3900 and 2700
   !> instructions a node).
   real(wp), parameter :: march_weight = 1.45_wp
   !> Newton steps of a time step on a coarse grid over those on the grid of the run.
   real(wp), parameter :: longer_steps = 1.3_wp
   !> Cost of coarse runs on n/2 and n/4 intervals over that of the transient.
   real(wp), parameter :: coarse_share = 0.3125_wp
   !> Why an ingredient of a transient is not known.
   character(len=54), parameter :: only_full = "measured with &output adequacy = 'full' alone", &
      no_grids = 'coarse grids do not see all waves, or have no solution', &
      no_film_at_rest = 'the contact stops or reverses: no steady film there'
   !> Most intervals of the smooth steady contact.
   integer, parameter :: most_at_rest = 128
   !> The error by the time step: this many times the change from twice the step on n/4, or from the
   !> first-order to the second-order scheme, plus a share of the largest change of a film, since a
   !> single change may vanish by chance.
   real(wp), parameter, public :: by_larger_step(2) = [0.2_wp, 0.2_wp]
   real(wp), parameter :: by_scheme(2) = [2.0_wp, 0.3_wp]

contains

   !> Measures every ingredient of a converged result, whose last state is `state`, at the accuracy
   !> that counts.
   subroutine measure_adequacy(solved, state, adequacy, listener, error)
      type(solved_t), intent(in) :: solved
      type(line_state_t), intent(in) :: state
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: even
      type(line_state_t) :: on_even
      real(wp) :: budget

      call listener%on_stage('measuring what each ingredient changes')
      associate (contact => solved%experiment%contact, n => real(size(state%x) - 1, wp), &
         time => solved%experiment%time)
         if (allocated(contact%duty)) then
            call measure_history(solved, adequacy, listener, error)   ! error: the caller looks
         else if (time%is_transient) then
            budget = march_weight*n*solved%newton_steps
            if (solved%bars%grids > 0) budget = budget*(merge(2, 1, &
               solved%bars%is_first_order) + coarse_share)
            budget = max(share*budget, small_run)
            call measure_passage(solved, ingredients_of(contact, is_transient=.true.), budget, &
               adequacy, listener, error)   ! error: the caller looks
         else
            budget = max(share*steady_steps*n, small_run)
            even = contact
            on_even = state
            if (contact%domain%grid == 'graded') then
               even%domain = domain_t()
               call choose_domain(even)
               on_even = even_state(even, state)
            end if
            call measure_at_rest(even, on_even, budget, adequacy, listener, &
               error)   ! error: the caller looks
         end if
      end associate
   end subroutine measure_adequacy

   !> Measures what squeeze changes in a contact whose load, radius and speeds change: the steady
   !> contact of each moment, on n/2 and n/4 intervals.
   subroutine measure_history(solved, adequacy, listener, error)
      type(solved_t), intent(in) :: solved
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passage_pair_t) :: pair
      logical :: is_known

      pair = pair_of(solved, 2)
      pair%counts_spikes = .false.
      adequacy%rows = [new_influence('squeeze', 'a steady solution at each time')]
      adequacy%rows%unknown = merge(no_grids, no_film_at_rest, &
         solved%experiment%contact%duty%always_moves(0.0_wp))
      if (adequacy%rows(1)%unknown == no_film_at_rest .or. .not. pair%is_known) return
      call measure_change(pair, ingredient_t(squeeze, 'squeeze', ''), adequacy%rows(1), is_known, &
         listener, error)   ! error: the caller looks
   end subroutine measure_history

   !> Largest cost of a full measurement of a transient, over that of the transient.
   pure real(wp) function full_cost(contact) result(cost)
      type(line_contact_t), intent(in) :: contact
      type(ingredient_t), allocatable :: list(:)

      list = ingredients_of(contact, is_transient=.true.)
      cost = coarse_share*count(list%kind /= roughness .and. list%kind /= squeeze)
   end function full_cost

   !> Measures the ingredients of a transient: those of oil and bodies at rest, those known from the
   !> runs of the error bars, and the others in time if asked for.
   subroutine measure_passage(solved, list, budget, adequacy, listener, error)
      type(solved_t), intent(in) :: solved
      type(ingredient_t), intent(in) :: list(:)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passage_pair_t) :: fine, coarse
      type(influence_t) :: rough
      logical :: is_known, is_open(size(list))
      integer :: i

      call measure_smooth(solved%experiment, list, budget, adequacy, listener, error)
      if (any([allocated(error), listener%is_stopping])) return
      if (adequacy%is_full) budget = huge(budget)
      fine = pair_of(solved, 1)
      coarse = pair_of(solved, 2)
      is_open = .true.   ! which ingredients remain unknown
      is_known = .false.
      rough = new_influence('', '')
      i = findloc(list%kind, roughness, 1)
      if (i > 0) then
         if (all([fine%is_known, budget >= steps_to_start*sum(fine%runs%contact%domain &
            %intervals)])) call measure_change(fine, list(i), adequacy%rows(i), is_known, &
            listener, error)
         if (any([allocated(error), listener%is_stopping])) return
         budget = budget - fine%work
         is_open(i) = .not. is_known
         rough = adequacy%rows(i)
      end if
      do i = 1, size(list)
         if (.not. is_of_surfaces(list(i))) call judge_at_rest(adequacy%rows(i), rough, &
            adequacy%accuracy, is_open(i))
      end do
      if (adequacy%is_full) then
         if (.not. coarse%is_known .and. sees_all(coarse%runs(2))) call run_both(coarse%runs, &
            coarse%full, coarse%work, coarse%is_known, listener, error)
         if (allocated(error)) return
         if (coarse%is_known) adequacy%in_time = coarse%runs%contact%domain%intervals
         if (listener%is_stopping) return
      end if
      adequacy%time_step = new_influence('time_step', 'limit of small time steps')
      call measure_time_step(solved, coarse, budget, adequacy%time_step, listener, error)
      if (allocated(error) .or. listener%is_stopping) return
      call measure_open([fine, coarse], pack(list, is_open), budget, adequacy, listener, &
         error)   ! error: the caller looks
   end subroutine measure_passage

   !> Measures the `open` ingredients: the squeeze term on the coarse pair within `budget` (on the
   !> fine pair if there is no other, or for a full measurement), then all others on the coarse
   !> pair.
   subroutine measure_open(pairs, open, budget, adequacy, listener, error)
      type(passage_pair_t), intent(in) :: pairs(2)
      type(ingredient_t), intent(in) :: open(:)
      real(wp), intent(in) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passage_pair_t) :: pair
      logical :: is_measured, is_known
      integer :: i

      do i = 1, size(open)
         pair = pairs(2)
         is_measured = adequacy%is_full
         if (open(i)%kind == squeeze) then
            if (pairs(1)%is_known .and. (adequacy%is_full .or. .not. pair%is_known)) pair = pairs(1)
            if (pair%is_known) call limit_places(pair, budget, is_measured)
         end if
         if (.not. (is_measured .and. pair%is_known)) cycle
         associate (row => adequacy%rows(findloc(adequacy%rows%name == open(i)%name, .true., 1)))
            call measure_change(pair, open(i), row, is_known, listener, error)
         end associate
         if (allocated(error) .or. listener%is_stopping) return
      end do
   end subroutine measure_open

   !> The transient on `factor` and 2 `factor` times fewer intervals by the second-order scheme, as
   !> far as the result and its error bars know it.
   pure function pair_of(solved, factor) result(pair)
      type(solved_t), intent(in) :: solved
      integer, intent(in) :: factor
      type(passage_pair_t) :: pair

      if (factor == 1) then
         pair = new_pair(solved%experiment, [1, 2])
         pair%widths = widths
         pair%full = [solved%full, solved%bars%coarser(1)]
         if (solved%bars%is_first_order) pair%full(1) = solved%bars%second_order
      else
         pair = new_pair(solved%experiment, [2, 4])
         pair%full = solved%bars%coarser(:2)
      end if
      pair%is_known = solved%bars%grids >= factor
      if (allocated(solved%bars%unseen)) pair%is_known = pair%is_known &
         .and. solved%bars%unseen == ''
   end function pair_of

   !> Measures the time step within `budget`.
   subroutine measure_time_step(solved, coarse, budget, row, listener, error)
      type(solved_t), intent(in) :: solved
      type(passage_pair_t), intent(in) :: coarse
      real(wp), intent(inout) :: budget
      type(influence_t), intent(inout) :: row
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(experiment_t) :: larger
      type(outcome_t) :: outcome
      real(wp) :: cost
      logical :: is_first_order

      row%is_numerical = .true.
      is_first_order = solved%experiment%time%scheme == 'backward_euler'
      if (.not. coarse%is_known .or. (is_first_order .and. solved%bars%grids < 2)) then
         row%unknown = 'there is no error estimate, or a coarse grid does not see all waves'
      else if (is_first_order) then
         call set_step_error(solved%bars%second_order, solved%full, by_scheme, row)
      else
         ! a quarter of the nodes, an eighth of the steps
         cost = march_weight*longer_steps*solved%newton_steps*solved%experiment%contact%domain &
            %intervals/32
         if (budget < cost) return
         larger = coarse%runs(2)
         larger%time%time_step = 2*larger%time%time_step
         call run_experiment(larger, listener, outcome, error)
         if (allocated(error)) return
         budget = budget - cost
         row%unknown = 'a coarse grid has no solution with larger steps'
         if (outcome%is_known) call set_step_error(coarse%full(2), outcome%summary, &
            by_larger_step, row)
      end if
   end subroutine measure_time_step

   !> Creates the rows and measures the ingredients of oil and bodies on the smooth steady contact.
   subroutine measure_smooth(experiment, list, budget, adequacy, listener, error)
      type(experiment_t), intent(in) :: experiment
      type(ingredient_t), intent(in) :: list(:)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(outcome_t) :: outcome
      type(solution_t) :: solution
      type(line_contact_t) :: contact

      adequacy%rows = new_influence(list%name, list%text)
      adequacy%rows%unknown = merge(no_grids, only_full, adequacy%is_full)
      contact = without_surfaces(experiment%contact)
      associate (n => contact%domain%intervals)
         do while (modulo(n, 2) == 0 .and. n > most_at_rest &
            .and. n/2 >= 2*coarsest_for_film(experiment%contact))
            n = n/2
         end do
         call run_experiment(experiment_t(contact, solver_settings_t(method='newton_krylov', &
            max_cycles=max_cycles, explains_failure=.false.), time_settings_t()), listener, &
            outcome, error, solution)
         if (allocated(error) .or. .not. outcome%is_known) return
         budget = budget - steps_to_start*n
      end associate
      adequacy%ends_early = .true.
      call measure_at_rest(contact, solution%state, budget, adequacy, listener, &
         error)   ! error: the caller looks
      adequacy%rows%is_at_rest = .not. is_of_surfaces(list)
   end subroutine measure_smooth

   !> Sets the `row` of the time step from the change from an `other` to a `better` run, with these
   !> `factors`.
   pure subroutine set_step_error(better, other, factors, row)
      type(line_summary_t), intent(in) :: better, other
      real(wp), intent(in) :: factors(2)
      type(influence_t), intent(inout) :: row

      row%change = change_between(better, other)
      row%change = factors(1)*abs(row%change) + factors(2)*largest_change(row%change)
      row%error = 0.0_wp*row%change
   end subroutine set_step_error

end module measured_adequacy

!> Measures the adequacy of the model of a lubricated result; changes of a transient on two grids,
!> with all ingredients and without one of them.
!>
!> The cost is bounded in nodes times Newton steps rather than seconds, so that a repeated run
!> measures the same (docs/theory.md, measured adequacy). Transients with all ingredients are known
!> already: the result, and the runs on n/2 and n/4 intervals for its error bars. Smooth surfaces
!> take one steady solution on each grid; without the squeeze term, steady solutions follow the
!> waves. With `adequacy%is_full` whatever remains open is run in time on n/2 and n/4, at any cost.
module measured_adequacy
   use ablation_runs, only: by_larger_step, by_scheme, measure_at_rest, set_change, &
      set_step_error, widths
   use ablations, only: ingredient_t, ingredients, ingredients_of, is_of_surfaces, leave_out, &
      roughness, squeeze
   use adequacy, only: adequacy_t, influence_t, judge_at_rest, new_influence, too_costly
   use domain_choice, only: choose_domain
   use error_bars, only: error_bars_t
   use experiment, only: coarser, experiment_t, min_intervals, outcome_t, run_experiment, solution_t
   use graded_contact, only: even_state
   use kinds, only: wp
   use line_contact, only: domain_t, intervals_for_waves, line_contact_t, solver_settings_t, &
      time_settings_t, without_surfaces
   use line_hierarchy, only: coarsest_for_film
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use listener, only: listener_t
   use passage_times, only: new_passage_times, passage_times_t
   use pressure_errors, only: doubt_spike
   use wave_resolution, only: node_spacing, steps_in_wave
   implicit none (type, external)
   private

   public :: full_cost, measure_adequacy, measure_change, new_pair, passage_pair_t, run_pair, &
      sees_all, solved_t

   !> A solved case: its settings, quantities, Newton steps and error bars.
   type :: solved_t
      type(experiment_t) :: experiment
      type(line_summary_t) :: full
      real(wp) :: newton_steps = 0.0_wp
      type(error_bars_t) :: bars
   end type solved_t

   !> Most cycles of a steady solution, and the Newton steps that lead to it, with coarser grids.
   integer, parameter, public :: max_cycles = 40
   real(wp), parameter :: steps_to_start = 12.0_wp
   !> Bound on the residuals of time steps.
   real(wp), parameter, public :: coarse_tolerance = 1.0e-4_wp
   !> Newton steps from one position of the waves to the next, and the fewest positions while the
   !> finest wave moves by its own length.
   real(wp), parameter :: steps_to_next = 3.0_wp, least_places = 3.0_wp

   !> A transient on the finer and the coarser grid.
   type :: passage_pair_t
      type(experiment_t) :: runs(2)
      !> Extremes with all ingredients.
      type(line_summary_t) :: full(2)
      logical :: is_known = .false.
      !> Factors of the error of a change (`set_change`): a wave may miss the nodes of two coarse
      !> grids alike; whether that includes what spikes may add.
      real(wp) :: widths(4) = [1.5_wp, 0.1_wp, 0.15_wp, 2*coarse_tolerance]
      logical :: counts_spikes = .true.
      !> Nodes times Newton steps spent so far.
      real(wp) :: work = 0.0_wp
   end type passage_pair_t

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
contains

   !> Measures every ingredient of a converged result, whose last state is `state`, at the accuracy
   !> that counts.
   subroutine measure_adequacy(solved, state, adequacy, listener)
      type(solved_t), intent(in) :: solved
      type(line_state_t), intent(in) :: state
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(line_contact_t) :: even
      type(line_state_t) :: on_even
      type(passage_pair_t) :: pair
      logical :: always_moves

      call listener%on_stage('measuring what each ingredient changes')
      associate (contact => solved%experiment%contact, n => real(size(state%x) - 1, wp), &
         budget => adequacy%budget)
         if (allocated(contact%duty)) then   ! the steady contact of each moment
            always_moves = contact%duty%always_moves(0.0_wp)
            adequacy%rows = [new_influence(ingredients(squeeze))]
            adequacy%rows%unknown = merge(no_grids, no_film_at_rest, always_moves)
            pair = pair_of(solved, 2)
            pair%counts_spikes = .false.
            if (pair%is_known .and. always_moves) call measure_change(pair, adequacy%rows(1), &
               listener)
         else if (solved%experiment%time%is_transient) then
            budget = march_weight*n*solved%newton_steps
            if (solved%bars%grids > 0) budget = budget*(merge(2, 1, &
               solved%bars%is_first_order) + coarse_share)
            budget = max(share*budget, small_run)
            call measure_passage(solved, adequacy, listener)
         else
            budget = max(share*steady_steps*n, small_run)
            adequacy%rows = new_influence(ingredients_of(contact, is_transient=.false.))
            even = contact
            on_even = state
            if (contact%domain%grid == 'graded') then
               even%domain = domain_t()
               call choose_domain(even)
               on_even = even_state(even, state)
            end if
            call measure_at_rest(even, on_even, adequacy, listener)
         end if
      end associate
   end subroutine measure_adequacy

   !> Largest cost of a full measurement of a transient, over that of the transient.
   pure real(wp) function full_cost(contact) result(cost)
      type(line_contact_t), intent(in) :: contact
      type(ingredient_t), allocatable :: list(:)

      list = ingredients_of(contact, is_transient=.true.)
      cost = coarse_share*count(list%kind /= roughness .and. list%kind /= squeeze)
   end function full_cost

   !> Measures the ingredients of a transient: those of oil and bodies at rest, those known from the
   !> runs of the error bars, and the others in time if asked for.
   subroutine measure_passage(solved, adequacy, listener)
      type(solved_t), intent(in) :: solved
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(passage_pair_t) :: coarse, fine
      type(influence_t) :: rough
      integer :: i

      call measure_smooth(solved%experiment, adequacy, listener)
      if (listener%is_stopping) return
      if (adequacy%is_full) adequacy%budget = huge(adequacy%budget)
      fine = pair_of(solved, 1)
      coarse = pair_of(solved, 2)
      rough = new_influence(ingredients(roughness))
      i = findloc(adequacy%rows%kind, roughness, 1)
      if (i > 0) then
         if (all([fine%is_known, adequacy%budget >= steps_to_start*sum(fine%runs%contact%domain &
            %intervals)])) call measure_change(fine, adequacy%rows(i), listener)
         adequacy%budget = adequacy%budget - fine%work
         rough = adequacy%rows(i)
      end if
      do i = 1, size(adequacy%rows)
         if (.not. is_of_surfaces(adequacy%rows(i)%kind)) call judge_at_rest(adequacy%rows(i), &
            rough, adequacy%accuracy)
      end do
      if (adequacy%is_full) then
         if (.not. coarse%is_known .and. sees_all(coarse%runs(2))) call run_pair(coarse, listener)
         if (coarse%is_known) adequacy%in_time = coarse%runs%contact%domain%intervals
      end if
      if (listener%is_stopping) return
      adequacy%time_step = new_influence(ingredient_t(0, 'time_step', 'limit of small time steps'))
      call measure_time_step(solved, coarse, adequacy%budget, adequacy%time_step, listener)
      do i = 1, size(adequacy%rows)
         if (listener%is_stopping) return
         if (adequacy%rows(i)%is_open) call measure_open(fine, coarse, adequacy, i, listener)
      end do
   end subroutine measure_passage

   !> Measures row `i`, still open: the squeeze term on the coarse pair within the budget (on the
   !> fine one if there is no other, or for a full measurement), others on the coarse pair for a
   !> full measurement.
   subroutine measure_open(fine, coarse, adequacy, i, listener)
      type(passage_pair_t), intent(in) :: fine, coarse
      type(adequacy_t), intent(inout) :: adequacy
      integer, intent(in) :: i
      class(listener_t), intent(inout), target :: listener
      type(passage_pair_t) :: pair
      logical :: is_enough

      pair = coarse
      is_enough = adequacy%is_full
      if (adequacy%rows(i)%kind == squeeze) then
         if (fine%is_known .and. (adequacy%is_full .or. .not. pair%is_known)) pair = fine
         if (pair%is_known) call limit_places(pair, adequacy%budget, is_enough)
      end if
      if (is_enough .and. pair%is_known) call measure_change(pair, adequacy%rows(i), listener)
   end subroutine measure_open

   !> The transient on `factor` and 2 `factor` times fewer intervals by the second-order scheme, as
   !> far as the result and its error bars know it.
   pure function pair_of(solved, factor) result(pair)
      type(solved_t), intent(in) :: solved
      integer, intent(in) :: factor
      type(passage_pair_t) :: pair

      pair = new_pair(solved%experiment, [factor, 2*factor])
      if (factor == 1) then
         pair%widths = widths
         pair%full = [solved%full, solved%bars%coarser(1)]
         if (solved%bars%is_first_order) pair%full(1) = solved%bars%second_order
      else
         pair%full = solved%bars%coarser(:2)
      end if
      pair%is_known = solved%bars%grids >= factor .and. solved%bars%unseen == ''
   end function pair_of

   !> Measures the time step within `budget`.
   subroutine measure_time_step(solved, coarse, budget, row, listener)
      type(solved_t), intent(in) :: solved
      type(passage_pair_t), intent(in) :: coarse
      real(wp), intent(inout) :: budget
      type(influence_t), intent(inout) :: row
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: larger
      type(outcome_t) :: outcome
      real(wp) :: cost
      logical :: is_first_order

      row%is_numerical = .true.
      row%measured_on = 'runs of the error estimates, or a coarse grid with twice its time step'
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
         call run_experiment(larger, listener, outcome)
         budget = budget - cost
         row%unknown = 'a coarse grid has no solution with larger steps'
         if (outcome%is_known) call set_step_error(coarse%full(2), outcome%summary, &
            by_larger_step, row)
      end if
   end subroutine measure_time_step

   !> Creates the rows and measures the ingredients of oil and bodies on the smooth steady contact.
   subroutine measure_smooth(experiment, adequacy, listener)
      type(experiment_t), intent(in) :: experiment
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(outcome_t) :: outcome
      type(solution_t) :: solution
      type(line_contact_t) :: contact

      adequacy%rows = new_influence(ingredients_of(experiment%contact, is_transient=.true.))
      adequacy%rows%unknown = merge(no_grids, only_full, adequacy%is_full)
      contact = without_surfaces(experiment%contact)
      associate (n => contact%domain%intervals)
         do while (modulo(n, 2) == 0 .and. n > most_at_rest &
            .and. n/2 >= 2*coarsest_for_film(experiment%contact))
            n = n/2
         end do
         call run_experiment(experiment_t(contact, solver_settings_t(method='newton_krylov', &
            max_cycles=max_cycles, explains_failure=.false.), time_settings_t()), listener, &
            outcome, solution)
         if (.not. outcome%is_known) return
         adequacy%budget = adequacy%budget - steps_to_start*n
      end associate
      adequacy%ends_early = .true.
      adequacy%rows%is_open = .not. is_of_surfaces(adequacy%rows%kind)
      where (adequacy%rows%is_open) adequacy%rows%unknown = too_costly
      call measure_at_rest(contact, solution%state, adequacy, listener)
      adequacy%rows%is_at_rest = adequacy%rows%is_open
      adequacy%rows%is_open = .true.
   end subroutine measure_smooth

   !> The transient of `experiment` on `factors` times fewer intervals, not run yet.
   pure function new_pair(experiment, factors) result(pair)
      type(experiment_t), intent(in) :: experiment
      integer, intent(in) :: factors(2)
      type(passage_pair_t) :: pair
      type(passage_times_t) :: times

      pair%runs = [coarser(experiment, factors(1)), coarser(experiment, factors(2))]
      pair%runs%time%scheme = 'bdf2'
      ! a leaner contact might count from another time
      times = new_passage_times(experiment%contact, experiment%time)
      pair%runs%time%statistics_from = times%counts_from
   end function new_pair

   !> Makes both runs of a pair, known if both have a solution; adds their cost to its work.
   subroutine run_pair(pair, listener)
      type(passage_pair_t), intent(inout) :: pair
      class(listener_t), intent(inout), target :: listener
      type(outcome_t) :: outcome
      integer :: g

      do g = 1, 2
         call run_experiment(pair%runs(g), listener, outcome)
         pair%work = pair%work + outcome%work
         pair%full(g) = outcome%summary
         pair%is_known = outcome%is_known
         if (.not. pair%is_known) return
      end do
   end subroutine run_pair

   !> Whether the grid of an experiment carries the film and has four nodes in every wave.
   pure logical function sees_all(experiment)
      type(experiment_t), intent(in) :: experiment

      associate (n => experiment%contact%domain%intervals)
         sees_all = n >= coarsest_for_film(experiment%contact, min_intervals) .and. 4*n &
            >= intervals_for_waves(experiment%contact)
      end associate
   end function sees_all

   !> Measures the change without the ingredient of a `row`, and its error; the row stays open
   !> unless both grids have a solution without it.
   subroutine measure_change(pair, row, listener)
      type(passage_pair_t), intent(inout) :: pair
      type(influence_t), intent(inout) :: row
      class(listener_t), intent(inout), target :: listener
      type(passage_pair_t) :: lean
      type(line_summary_t) :: full(2)
      integer :: g

      lean = pair
      do g = 1, 2
         call leave_out(lean%runs(g)%contact, row%ingredient_t, 0.0_wp)
         associate (intervals => lean%runs(g)%contact%domain%intervals)
            ! too few for the leaner film: no run
            if (intervals < coarsest_for_film(lean%runs(g)%contact, min_intervals)) intervals = 0
         end associate
      end do
      if (row%kind == squeeze) then   ! the steady contact of each moment
         lean%runs%time%scheme = 'quasi_steady'
         lean%runs%time%tolerance = 0.0_wp
      end if
      ! smooth surfaces: the same at all times
      if (row%kind == roughness) lean%runs%time%time_step = lean%runs%time%end_time
      call run_pair(lean, listener)
      pair%work = lean%work
      if (.not. lean%is_known) return
      full = pair%full
      if (pair%counts_spikes) then
         associate (contact => pair%runs(1)%contact)
            call doubt_spike(contact%fluid, contact%lambda, node_spacing(contact), full(1))
            call doubt_spike(contact%fluid, contact%lambda, node_spacing(contact), lean%full(1))
         end associate
      end if
      row%is_open = .false.
      row%is_at_rest = .false.
      row%left_out = 1.0_wp
      call set_change(row, lean%full, full, pair%widths, pair%counts_spikes)
   end subroutine measure_change

   !> Limits the number of positions at which the waves of a pair are solved, equal on both grids,
   !> to `budget` (nodes times Newton steps) and to the number of time steps. `is_enough`: at least
   !> `least_places` positions while the finest wave moves by its own length.
   pure subroutine limit_places(pair, budget, is_enough)
      type(passage_pair_t), intent(inout) :: pair
      real(wp), intent(in) :: budget
      logical, intent(out) :: is_enough
      real(wp) :: cost, start
      integer :: steps

      associate (run => pair%runs(1), grids => pair%runs%contact%domain%intervals)
         start = steps_to_start*grids(1)
         cost = steps_to_next*sum(grids)
         steps = int(max(1.0_wp, min((budget - start)/cost, run%time%end_time/run%time%time_step)))
         pair%runs%time%time_step = run%time%end_time/steps
         is_enough = steps_in_wave(run%contact, pair%runs(1)%time) >= least_places &
            .and. start + cost*steps <= budget
      end associate
   end subroutine limit_places

end module measured_adequacy

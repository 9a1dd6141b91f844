!> A transient on two grids, with all ingredients and without one of them.
module passage_pair
   use ablation_runs, only: change_between, doubt_between, set_change
   use ablations, only: ingredient_t, leave_out, roughness, squeeze
   use adequacy, only: influence_t
   use errors, only: error_t
   use experiment, only: coarser, experiment_t, min_intervals, outcome_t, run_experiment
   use kinds, only: wp
   use line_contact, only: intervals_for_waves
   use line_hierarchy, only: coarsest_for_film
   use line_summary, only: line_summary_t
   use listener, only: listener_t
   use passage_times, only: new_passage_times, passage_times_t
   use pressure_errors, only: doubt_spike
   use quantities, only: quantity_count
   use wave_resolution, only: steps_in_wave
   implicit none (type, external)
   private

   public :: limit_places, measure_change, new_pair, passage_pair_t, run_both, sees_all

   !> Most cycles of a steady solution, and the Newton steps that lead to it, with coarser grids.
   integer, parameter, public :: max_cycles = 40
   real(wp), parameter, public :: steps_to_start = 12.0_wp
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

contains

   !> The transient of `experiment` on `factors` times fewer intervals, not run yet.
   pure function new_pair(experiment, factors) result(pair)
      type(experiment_t), intent(in) :: experiment
      integer, intent(in) :: factors(2)
      type(passage_pair_t) :: pair
      type(passage_times_t) :: times

      pair%runs(1) = coarser(experiment, factors(1))
      pair%runs(2) = coarser(experiment, factors(2))
      pair%runs%time%scheme = 'bdf2'
      ! a leaner contact might count from another time
      times = new_passage_times(experiment%contact, experiment%time)
      pair%runs%time%statistics_from = times%counts_from
   end function new_pair

   !> Makes both runs: their extremes, known if both have a solution; adds their cost to `work`.
   subroutine run_both(runs, extremes, work, is_known, listener, error)
      type(experiment_t), intent(in) :: runs(2)
      type(line_summary_t), intent(out) :: extremes(2)
      real(wp), intent(inout) :: work
      logical, intent(out) :: is_known
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(outcome_t) :: outcome
      integer :: g

      is_known = .false.
      do g = 1, 2
         call run_experiment(runs(g), listener, outcome, error)
         if (allocated(error)) return
         work = work + outcome%work
         extremes(g) = outcome%summary
         is_known = outcome%is_known
         if (.not. is_known) return
      end do
   end subroutine run_both

   !> Whether the grid of an experiment carries the film and has four nodes in every wave.
   pure logical function sees_all(experiment)
      type(experiment_t), intent(in) :: experiment

      associate (n => experiment%contact%domain%intervals)
         sees_all = n >= coarsest_for_film(experiment%contact, min_intervals) .and. 4*n &
            >= intervals_for_waves(experiment%contact)
      end associate
   end function sees_all

   !> Measures the change without an ingredient and its error; `is_known`: both grids have a
   !> solution without it.
   subroutine measure_change(pair, ingredient, row, is_known, listener, error)
      type(passage_pair_t), intent(inout) :: pair
      type(ingredient_t), intent(in) :: ingredient
      type(influence_t), intent(inout) :: row
      logical, intent(out) :: is_known
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(experiment_t) :: runs(2)
      type(line_summary_t) :: lean(2), full
      real(wp) :: changes(quantity_count, 2), doubt(quantity_count, 2), dx
      integer :: g

      runs = pair%runs
      do g = 1, 2
         call leave_out(runs(g)%contact, ingredient, 0.0_wp)
         associate (intervals => runs(g)%contact%domain%intervals)
            ! too few for the leaner film: no run
            if (intervals < coarsest_for_film(runs(g)%contact, min_intervals)) intervals = 0
         end associate
      end do
      if (ingredient%kind == squeeze) then   ! the steady contact of each moment
         runs%time%scheme = 'quasi_steady'
         runs%time%tolerance = 0.0_wp
      end if
      ! smooth surfaces: the same at all times
      if (ingredient%kind == roughness) runs%time%time_step = runs%time%end_time
      call run_both(runs, lean, pair%work, is_known, listener, error)
      if (allocated(error) .or. .not. is_known) return
      do g = 1, 2
         changes(:, g) = change_between(lean(g), pair%full(g))
      end do
      doubt = 0.0_wp
      if (pair%counts_spikes) then
         full = pair%full(1)
         associate (contact => pair%runs(1)%contact, domain => pair%runs(1)%contact%domain)
            dx = (domain%x_outlet - domain%x_inlet)/domain%intervals
            call doubt_spike(contact%fluid, contact%lambda, dx, full)
            call doubt_spike(contact%fluid, contact%lambda, dx, lean(1))
         end associate
         doubt = doubt_between(lean(1), full)
      end if
      row%is_at_rest = .false.
      row%left_out = 1.0_wp
      call set_change(row, changes, doubt, pair%widths)
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

end module passage_pair

!> The passages that a run has made itself, on its own grid and for its error bars, as contacts with
!> everything beside which ingredients are left out.
module own_passages
   use ablations, only: ingredient_t, roughness, squeeze
   use error_bars, only: error_bars_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use passage_pairs, only: known_passages, march_weight, own_steps, passages_t, scene_t, &
      sees_all
   implicit none (type, external)
   private

   public :: cost_of_coarse, cost_on, finest_passages, is_told_by_own, own_runs_t, scheme_of

   !> What a run has made: the extremes of its passage, the Newton steps of it, and its error bars.
   type :: own_runs_t
      type(line_summary_t) :: full
      real(wp) :: newton_steps = 0.0_wp
      type(error_bars_t) :: bars
   end type own_runs_t

   !> A time step on a coarse grid takes this many times the Newton steps of one of the run.
   real(wp), parameter :: longer_steps = 1.3_wp

contains

   !> Whether the passages of a run tell what an ingredient changes.
   pure elemental function is_told_by_own(scene, runs, ingredient) result(is_told)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(ingredient_t), intent(in) :: ingredient
      logical :: is_told

      associate (bars => runs%bars, n => scene%contact%domain%intervals)
         is_told = bars%has_half
         if (allocated(bars%unseen)) is_told = is_told .and. len(bars%unseen) == 0
         if (ingredient%kind == roughness) return
         is_told = is_told .and. bars%has_quarter
         if (ingredient%kind == squeeze) return
         is_told = is_told .and. modulo(n, 8) == 0 .and. sees_all(scene, n/8)
      end associate
   end function is_told_by_own

   !> The passages on n and n/2 intervals, of second order in time.
   pure function finest_passages(scene, runs) result(passages)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(passages_t) :: passages
      type(line_summary_t) :: full

      full = runs%full
      if (runs%bars%is_first_order) full = runs%bars%second_order
      associate (n => scene%contact%domain%intervals)
         passages = known_passages(scene, [n, n/2], scheme_of(runs), [full, runs%bars%half])
      end associate
   end function finest_passages

   !> What passages without one ingredient on n/4 and n/8 intervals cost, about, and if that on n/8
   !> with all of them has not been run, that too.
   pure function cost_of_coarse(scene, runs, is_run) result(cost)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      logical, intent(in) :: is_run
      real(wp) :: cost

      associate (n => scene%contact%domain%intervals)
         cost = cost_on(scene, runs, n/4) + merge(1, 2, is_run)*cost_on(scene, runs, n/8)
      end associate
   end function cost_of_coarse

   !> What one passage on a coarser grid costs, about, in nodes times Newton steps at rest.
   pure function cost_on(scene, runs, intervals) result(cost)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      integer, intent(in) :: intervals
      real(wp) :: cost

      associate (time => scene%time)
         cost = march_weight*longer_steps*runs%newton_steps*time%time_step/time%end_time &
            *real(intervals, wp)*own_steps(scene, intervals)
      end associate
   end function cost_on

   !> The space scheme of a run.
   pure function scheme_of(runs) result(scheme)
      type(own_runs_t), intent(in) :: runs
      character(:), allocatable :: scheme

      scheme = 'upwind2'
      if (runs%bars%is_kappa) scheme = 'kappa'
   end function scheme_of

end module own_passages

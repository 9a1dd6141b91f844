!> Steady contacts with the waves at their places, which tell what squeeze changes: at how many
!> times they are solved, and on which grids.
module wave_places
   use kinds, only: wp
   use own_passages, only: own_runs_t, scheme_of
   use passage_pairs, only: known_passages, passages_t, scene_t, steps_on, steps_to_start
   use passage_times, only: new_passage_times
   use wave_resolution, only: steps_in_wave
   implicit none (type, external)
   private

   public :: find_places, leaves_enough

   !> Newton steps from one place of the waves to the next.
   real(wp), parameter :: steps_to_next = 5.0_wp
   !> Times at which waves are looked at while the finest one passes its own length: for the grids
   !> of roughness, and at least.
   real(wp), parameter :: places_on_finest = 8.0_wp, least_places = 3.0_wp
   !> Share of the budget that something else may take: from places farther apart fewer solutions
   !> are found.
   real(wp), parameter :: largest_share = 0.1_wp

contains

   !> Whether a `budget` from which so much is `spent` on something else is as good for steady
   !> contacts with the waves at their places: on the same grids as with all of it, at nearly as
   !> many times.
   pure function leaves_enough(scene, runs, finest, budget, spent)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(passages_t), intent(in) :: finest
      real(wp), intent(in) :: budget, spent
      logical :: leaves_enough
      type(passages_t) :: with, without
      real(wp) :: cost_with, cost_without

      call find_places(scene, runs, finest, budget, without, cost_without)
      call find_places(scene, runs, finest, budget - spent, with, cost_with)
      leaves_enough = budget < cost_without .or. (budget - spent >= cost_with &
         .and. spent <= largest_share*budget .and. with%scenes(1)%contact%domain%intervals &
         == without%scenes(1)%contact%domain%intervals)
   end function leaves_enough

   !> The passages beside which steady contacts with the waves at their places can be solved, on the
   !> `finest` grids of the run or coarser ones, and what that costs.
   pure subroutine find_places(scene, runs, finest, budget, passages, cost)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(passages_t), intent(in) :: finest
      real(wp), intent(in) :: budget
      type(passages_t), intent(out) :: passages
      real(wp), intent(out) :: cost

      passages = finest
      call look_at_places(scene, places_on_finest, budget, passages, cost)
      if (budget >= cost) return
      associate (n => scene%contact%domain%intervals)
         passages = known_passages(scene, [n/2, n/4], scheme_of(runs), [runs%bars%half, &
            runs%bars%quarter])
      end associate
      passages%smooth(1) = finest%smooth(2)   ! that of n/2
      call look_at_places(scene, least_places, budget, passages, cost)
   end subroutine find_places

   !> Gives passages as many times at which their waves are looked at, the same on both grids, as
   !> the budget allows, and tells what steady solutions there cost; huge: fewer than `least` times
   !> while the finest wave passes its own length. One period is enough where all repeats itself.
   pure subroutine look_at_places(scene, least, budget, passages, cost)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: least, budget
      type(passages_t), intent(inout) :: passages
      real(wp), intent(out) :: cost
      real(wp) :: from, share
      integer :: steps

      associate (times => new_passage_times(scene%contact, scene%time), &
         grids => passages%scenes%contact%domain%intervals, end_time => scene%time%end_time)
         from = times%counts_from
         if (times%period > 0.0_wp) from = max(from, end_time - times%period)
         ! only times that count are solved
         share = max(1 - from/end_time, epsilon(1.0_wp))
         cost = 0.0_wp
         if (.not. allocated(passages%smooth(1)%pressure)) cost = steps_to_start*grids(1)
         steps = int(max(1.0_wp, min((budget - cost)/(steps_to_next*share*sum(grids)), &
            real(steps_on(scene, grids(1)), wp))))
         cost = cost + steps_to_next*share*steps*sum(grids)
         passages%scenes%time%time_step = end_time/steps
         passages%scenes%time%statistics_from = from
         if (steps_in_wave(scene%contact, passages%scenes(1)%time) < least) cost = huge(1.0_wp)
      end associate
   end subroutine look_at_places

end module wave_places

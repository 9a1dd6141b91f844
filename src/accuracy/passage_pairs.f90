!> Passages on two coarse grids: which grids and time steps these have, what they cost, and what
!> belongs to a pair of them.
module passage_pairs
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: finest_wave, line_contact_t
   use line_hierarchy, only: coarsest_for_film
   use line_summary, only: line_summary_t
   use passage_times, only: new_passage_times
   use pressure_errors, only: doubt_spike
   use solver_settings, only: solver_settings_t, time_settings_t
   use wave_resolution, only: choose_time_step
   implicit none (type, external)
   private

   public :: coarser_scene, cost_of, doubt_extremes, known_passages, own_steps, passage_grids, &
      passages_t, scene_t, sees_all, steps_on

   !> No passage has fewer intervals.
   integer, parameter, public :: least_intervals = 32
   !> Bound on the residuals of time steps; cycles of a solution.
   real(wp), parameter, public :: coarse_tolerance = 1.0e-4_wp
   integer, parameter, public :: max_cycles = 40

   !> Newton steps of a time step, about.
   real(wp), parameter, public :: newton_per_step = 2.5_wp
   !> What a Newton step of a passage costs over one at rest, output included (valgrind: 3900 and
   !> 2700 instructions a node); Newton steps that lead to a smooth steady contact, coarser grids
   !> counted.
   real(wp), parameter, public :: march_weight = 1.45_wp, steps_to_start = 12.0_wp
   !> Nodes of the coarser grid in the finest wave, at least.
   real(wp), parameter :: least_nodes = 4.0_wp
   !> Grids have half of these times a power of two of intervals, the coarser ones half of those
   !> below: 0.63 to 0.71 of the finer ones.
   integer, parameter :: families(4) = [14, 12, 10, 8], coarser_families(4) = [10, 8, 7, 5]
   !> The error of a change: this many times its change from the coarser of these grids (an error
   !> that falls with the spacing is twice that), a share of itself, a share of the largest change
   !> of a film, for a wave passes the nodes of two coarse grids alike by chance, and what
   !> iterations leave of both.
   real(wp), parameter, public :: widths(4) = [3.0_wp, 0.1_wp, 0.15_wp, 2*coarse_tolerance]
   !> By which scheme a passage is run, and by which where that finds no solution: what errs least
   !> on coarse grids, and what is solved most often.
   character(len=*), parameter, public :: schemes(2) = [character(len=7) :: 'kappa', 'upwind2']

   !> A contact whose domain is complete, how it is solved, and its time step.
   type :: scene_t
      type(line_contact_t) :: contact
      type(solver_settings_t) :: settings
      type(time_settings_t) :: time
   end type scene_t

   !> A passage on the finer and the coarser grid, and its extremes.
   type :: passages_t
      logical :: is_tried = .false., is_known = .false.
      type(scene_t) :: scenes(2)
      type(line_summary_t) :: full(2)
      !> The smooth steady contact on each grid; pressures are not allocated where it is not solved.
      type(film_state_t) :: smooth(2)
      !> What has been spent on them and on the passages compared with them so far, in nodes times
      !> Newton steps at rest.
      real(wp) :: work = 0.0_wp
   end type passages_t

contains

   !> Passages of `scene` on two grids by a space scheme that its run has made already, with their
   !> extremes `full`, and with the time steps that the run has there.
   pure function known_passages(scene, grids, space_scheme, full) result(passages)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: grids(2)
      character(*), intent(in) :: space_scheme
      type(line_summary_t), intent(in) :: full(2)
      type(passages_t) :: passages
      integer :: g

      passages%is_tried = .true.
      passages%is_known = .true.
      passages%full = full
      do g = 1, 2
         passages%scenes(g) = coarser_scene(scene, grids(g))
         passages%scenes(g)%settings%space_scheme = space_scheme
         passages%scenes(g)%time%time_step = scene%time%end_time/own_steps(scene, grids(g))
         call doubt_extremes(passages%scenes(g)%contact, passages%full(g))
      end do
   end function known_passages

   !> Intervals of the finer and the coarser one of two passages, as fine as this many ingredients
   !> fit into the budget, or if the waves are not seen there as coarse as they are, so that one
   !> does at least; 0: none fits.
   pure function passage_grids(scene, ingredients, budget) result(grids)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: ingredients
      real(wp), intent(in) :: budget
      integer :: grids(2), tried(2), finest, i
      integer, parameter :: count = size(families)

      grids = 0
      finest = count*exponent(real(scene%contact%domain%intervals, wp))
      do i = 0, finest
         tried = [families(1 + modulo(i, count)), coarser_families(1 + modulo(i, count))] &
            *2**((finest - i + count - 1)/count)/2
         if (tried(1) > scene%contact%domain%intervals/2) cycle
         if (.not. sees_all(scene, tried(2))) return
         if (2*cost_of(scene, tried) > budget) cycle
         grids = tried
         if ((ingredients + 1)*cost_of(scene, tried) <= budget) return
      end do
   end function passage_grids

   !> Whether a grid carries the film and has nodes in every wave.
   pure function sees_all(scene, intervals)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: intervals
      logical :: sees_all

      ! divided: without waves the finest one is the largest number
      associate (domain => scene%contact%domain)
         sees_all = intervals >= coarsest_for_film(scene%contact, least_intervals) &
            .and. finest_wave(scene%contact) >= least_nodes*(domain%x_outlet &
            - domain%x_inlet)/max(intervals, 1)
      end associate
   end function sees_all

   !> Nodes times Newton steps of passages on these grids, one each.
   pure function cost_of(scene, grids) result(cost)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: grids(2)
      real(wp) :: cost

      cost = newton_per_step*(real(grids(1), wp)*steps_on(scene, grids(1)) &
         + real(grids(2), wp)*steps_on(scene, grids(2)))
   end function cost_of

   !> Time steps on a coarser grid: as many times fewer as intervals, but none longer than dX unless
   !> those of the scene are.
   pure function steps_on(scene, intervals) result(steps)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: intervals
      integer :: steps
      real(wp) :: own, fewer

      associate (domain => scene%contact%domain)
         own = scene%time%end_time/scene%time%time_step
         fewer = max(own*intervals/domain%intervals, scene%time%end_time*intervals &
            /(domain%x_outlet - domain%x_inlet))
         steps = max(nint(min(own, fewer)), 1)
      end associate
   end function steps_on

   !> Time steps of the passage that a run makes on a coarser grid for its error bars: as many times
   !> fewer as intervals, down to a quarter of them; on coarser grids, which are for comparison
   !> with such passages alone, those of `steps_on`.
   pure function own_steps(scene, intervals) result(steps)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: intervals
      integer :: steps
      type(time_settings_t) :: time

      steps = steps_on(scene, intervals)
      associate (n => scene%contact%domain%intervals)
         if (4*intervals < n) return
         time = scene%time
         time%time_step = scene%time%time_step*n/intervals
      end associate
      call choose_time_step(scene%contact, time)
      steps = nint(time%end_time/time%time_step)
   end function own_steps

   !> The scene with fewer intervals and steps, which are of second order; its extremes count from
   !> when those of the whole one do.
   pure function coarser_scene(scene, intervals) result(coarse)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: intervals
      type(scene_t) :: coarse

      coarse = scene
      coarse%contact%domain%intervals = intervals
      associate (time => coarse%time, times => new_passage_times(scene%contact, scene%time))
         time%time_step = time%end_time/steps_on(scene, intervals)
         time%statistics_from = times%counts_from
         time%scheme = 'bdf2'
         if (allocated(time%resume_from)) deallocate (time%resume_from)
      end associate
      coarse%settings = solver_settings_t(method='newton_krylov', tolerance=coarse_tolerance, &
         max_cycles=max_cycles, explains_failure=.false.)
   end function coarser_scene

   !> What a spike may add to the largest pressure of a passage.
   pure subroutine doubt_extremes(contact, summary)
      type(line_contact_t), intent(in) :: contact
      type(line_summary_t), intent(inout) :: summary

      associate (domain => contact%domain)
         call doubt_spike(contact%fluid, contact%lambda, (domain%x_outlet - domain%x_inlet) &
            /domain%intervals, summary)
      end associate
   end subroutine doubt_extremes

end module passage_pairs

!> A passage on two coarse grids, with all ingredients of its model and without one.
module coarse_passages
   use ablation_runs, only: change_between, doubt_between
   use ablations, only: contact_without, ingredient_t, roughness, squeeze, without_surfaces
   use ehl_line_solver, only: solve_ehl_line
   use errors, only: error_t
   use film_state, only: film_state_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use lean_solution, only: doubt_spike, follow_waves, pressure_on
   use line_contact, only: finest_wave, line_contact_t
   use line_hierarchy, only: coarsest_for_film
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use observer, only: observer_t
   use passage_extremes, only: passage_extremes_t
   use passage_times, only: new_passage_times
   use quantities, only: quantity_count
   use run_collector, only: collector_t
   use solver_settings, only: solver_settings_t, time_settings_t
   implicit none (type, external)
   private

   public :: changes_without, cost_of, known_passages, passage_grids, passages_t, run_grid, &
      run_passages, scene_t, sees_all, solve_steadily, steps_on

   !> No passage has fewer intervals.
   integer, parameter :: least_intervals = 32
   !> Bound on the residuals of time steps; cycles of a solution.
   real(wp), parameter, public :: coarse_tolerance = 1.0e-4_wp
   integer, parameter :: max_cycles = 40

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
   !> The error of a change: so many times its change from the coarser of these grids (an error that
   !> falls with the spacing is twice that), a share of itself, a share of the largest change of a
   !> film, for a wave passes the nodes of two coarse grids alike by chance, and what iterations
   !> leave of both.
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

   !> Runs `scene` on two grids by a space scheme.
   subroutine run_passages(scene, grids, space_scheme, passages, watcher, error)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: grids(2)
      character(*), intent(in) :: space_scheme
      type(passages_t), intent(out) :: passages
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      integer :: g

      passages%is_tried = .true.
      do g = 1, 2
         passages%scenes(g) = coarser_scene(scene, grids(g))
         passages%scenes(g)%settings%space_scheme = space_scheme
         call run_grid(passages, g, watcher, error)
         if (allocated(error) .or. .not. passages%is_known) return
      end do
   end subroutine run_passages

   !> Runs one of the passages with everything.
   subroutine run_grid(passages, g, watcher, error)
      type(passages_t), intent(inout) :: passages
      integer, intent(in) :: g
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error

      call run_scene(passages%scenes(g), watcher, passages%full(g), passages%is_known, &
         passages%work, error)   ! error: the caller looks
   end subroutine run_grid

   !> Passages of `scene` on two grids by a space scheme that have been run already, with their
   !> extremes `full`.
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
         call doubt_extremes(passages%scenes(g)%contact, passages%full(g))
      end do
   end function known_passages

   !> Intervals of the finer and the coarser one of two passages, as fine as so many ingredients fit
   !> into the budget, or if the waves are not seen there as coarse as they are, so that one does at
   !> least; 0: none fits.
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

   !> Relative changes of all quantities without an ingredient, on both grids, and what spikes may
   !> add on the finer one, to the contact without and with it; `is_known` is false where one of
   !> them has no solution without it.
   subroutine changes_without(passages, ingredient, changes, doubt, is_known, watcher, error)
      type(passages_t), intent(inout) :: passages
      type(ingredient_t), intent(in) :: ingredient
      real(wp), dimension(quantity_count, 2), intent(out) :: changes, doubt
      logical, intent(out) :: is_known
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      type(line_summary_t) :: lean
      integer :: g

      do g = 1, 2
         if (g == 2) call start_from_finer(passages%smooth, &
            passages%scenes%contact%domain%intervals)
         call run_without(passages%scenes(g), ingredient, passages%smooth(g), lean, is_known, &
            passages%work, watcher, error)
         if (allocated(error) .or. .not. is_known) return
         changes(:, g) = change_between(lean, passages%full(g))
         if (g == 1) doubt = doubt_between(lean, passages%full(g))
      end do
   end subroutine changes_without

   !> Where only the finer one of two grids has its smooth contact, the other one starts from its
   !> nodes, if they have them in common.
   pure subroutine start_from_finer(smooth, intervals)
      type(film_state_t), intent(inout) :: smooth(2)
      integer, intent(in) :: intervals(2)

      if (.not. allocated(smooth(1)%pressure) .or. allocated(smooth(2)%pressure)) return
      associate (stride => intervals(1)/intervals(2))
         if (stride*intervals(2) /= intervals(1)) return
         smooth(2)%pressure = smooth(1)%pressure(::stride)
         smooth(2)%film = smooth(1)%film(::stride)
      end associate
   end subroutine start_from_finer

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

   !> The extremes of a scene; what it took is added to `work`.
   subroutine run_scene(scene, watcher, summary, is_known, work, error)
      type(scene_t), intent(in) :: scene
      class(observer_t), intent(inout), target :: watcher
      type(line_summary_t), intent(out) :: summary
      logical, intent(out) :: is_known
      real(wp), intent(inout) :: work
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(line_contact_t) :: own
      type(line_state_t) :: state
      type(report_t) :: report

      is_known = .false.
      own = scene%contact
      own%domain%may_lengthen = .false.
      collector%watcher => watcher
      collector%passage = passage_extremes_t(new_passage_times(own, scene%time))
      call solve_ehl_line(own, scene%settings, scene%time, collector, state, report, error)
      if (allocated(error)) return
      work = work + march_weight*report%cycles*real(own%domain%intervals, wp)
      is_known = report%converged
      if (.not. is_known) return
      summary = collector%passage%extremes(summary_of(state))
      call doubt_extremes(scene%contact, summary)
   end subroutine run_scene

   !> What a spike may add to the largest pressure of a passage.
   pure subroutine doubt_extremes(contact, summary)
      type(line_contact_t), intent(in) :: contact
      type(line_summary_t), intent(inout) :: summary

      associate (domain => contact%domain)
         call doubt_spike(contact%fluid, contact%lambda, (domain%x_outlet - domain%x_inlet) &
            /domain%intervals, summary)
      end associate
   end subroutine doubt_extremes

   !> Those without an ingredient: another passage, or steady solutions.
   ! allow(too-many-arguments)  what is run, its outcome and cost, and what every run has
   subroutine run_without(scene, ingredient, smooth, summary, is_known, work, watcher, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: ingredient
      type(film_state_t), intent(inout) :: smooth
      type(line_summary_t), intent(out) :: summary
      logical, intent(out) :: is_known
      real(wp), intent(inout) :: work
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: lean
      type(line_state_t) :: state

      lean = scene
      lean%contact = contact_without(scene%contact, ingredient, 0.0_wp)
      is_known = scene%contact%domain%intervals >= coarsest_for_film(lean%contact, least_intervals)
      if (.not. is_known) return
      select case (ingredient%kind)
      case (roughness, squeeze)
         if (.not. allocated(smooth%pressure)) then
            lean%contact = without_surfaces(scene%contact)
            call solve_steadily(lean, watcher, state, is_known, error)
            if (allocated(error) .or. .not. is_known) return
            work = work + steps_to_start*scene%contact%domain%intervals
            smooth = pressure_on(state, size(state%x) - 1)
         end if
         lean%contact = without_surfaces(scene%contact)
         if (ingredient%kind == squeeze) then
            lean%contact = scene%contact
         else   ! at all times the same
            lean%time%time_step = scene%time%end_time
         end if
         call follow_waves(lean%contact, lean%time, scene%settings%space_scheme == 'kappa', &
            smooth, summary, is_known, work, &
            watcher, error)   ! error: the caller looks
         if (is_known) call doubt_extremes(scene%contact, summary)
      case default
         call run_scene(lean, watcher, summary, is_known, work, error)   ! error: the caller looks
      end select
   end subroutine run_without

   !> The steady contact of a scene on its own grid, with the surfaces at their first places.
   subroutine solve_steadily(scene, watcher, state, is_solved, error)
      type(scene_t), intent(in) :: scene
      class(observer_t), intent(inout), target :: watcher
      type(line_state_t), intent(out) :: state
      logical, intent(out) :: is_solved
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: own
      type(collector_t) :: collector
      type(report_t) :: report

      own = scene%contact
      own%domain%may_lengthen = .false.
      collector%watcher => watcher
      call solve_ehl_line(own, solver_settings_t(method='newton_krylov', max_cycles=max_cycles, &
         explains_failure=.false.), time_settings_t(), collector, state, report, error)
      is_solved = report%converged .and. .not. allocated(error)
   end subroutine solve_steadily

end module coarse_passages

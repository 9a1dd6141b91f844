!> A passage on two coarse grids, with all ingredients of its model and without one.
module coarse_passages
   use ablation_runs, only: change_between, doubt_between
   use ablations, only: contact_without, ingredient_t, one_feature, one_surface, roughness, &
      squeeze, without_surfaces
   use adequacy, only: adequacy_t, verdict_on
   use ehl_line_solver, only: solve_ehl_line
   use errors, only: error_t
   use film_state, only: film_state_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use lean_solution, only: follow_waves, pressure_on
   use line_contact, only: line_contact_t
   use line_hierarchy, only: coarsest_for_film
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use listener, only: listener_t
   use own_passages, only: is_told_by_own, own_runs_t, scheme_of
   use passage_extremes, only: passage_extremes_t
   use passage_pairs, only: coarser_scene, doubt_extremes, known_passages, least_intervals, &
      march_weight, max_cycles, passages_t, scene_t, steps_to_start
   use passage_times, only: new_passage_times
   use quantities, only: quantity_count
   use run_collector, only: collector_t
   use solver_settings, only: solver_settings_t, time_settings_t
   use surface_parts, only: affordable_grid, take_part
   use verdicts, only: verdict_unknown
   implicit none (type, external)
   private

   public :: changes_without, measure_parts, run_coarsest, run_larger_step, run_passages, &
      solve_steadily

contains

   !> Runs `scene` on two grids by a space scheme.
   subroutine run_passages(scene, grids, space_scheme, passages, listener, error)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: grids(2)
      character(*), intent(in) :: space_scheme
      type(passages_t), intent(out) :: passages
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      integer :: g

      passages%is_tried = .true.
      do g = 1, 2
         passages%scenes(g) = coarser_scene(scene, grids(g))
         passages%scenes(g)%settings%space_scheme = space_scheme
         call run_grid(passages, g, listener, error)
         if (allocated(error) .or. .not. passages%is_known) return
      end do
   end subroutine run_passages

   !> Runs one of the passages with everything.
   subroutine run_grid(passages, g, listener, error)
      type(passages_t), intent(inout) :: passages
      integer, intent(in) :: g
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error

      call run_scene(passages%scenes(g), listener, passages%full(g), passages%is_known, &
         passages%work, error)   ! error: the caller looks
   end subroutine run_grid

   !> The passages on n/4 and n/8 intervals, of which the run has made the first; the other one is
   !> run unless it has been, and taken off the `budget`.
   subroutine run_coarsest(scene, runs, coarse, budget, listener, error)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(passages_t), intent(inout) :: coarse
      real(wp), intent(inout) :: budget
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error

      if (coarse%is_tried) return
      associate (n => scene%contact%domain%intervals, quarter => runs%bars%quarter)
         coarse = known_passages(scene, [n/4, n/8], scheme_of(runs), [quarter, quarter])
      end associate
      call run_grid(coarse, 2, listener, error)   ! error: the caller looks
      budget = budget - coarse%work
   end subroutine run_coarsest

   !> The passages on n/8 intervals, with the step that is usual there and (`slow`) with twice that.
   subroutine run_larger_step(scene, runs, coarse, slow, budget, listener, error)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(passages_t), intent(inout) :: coarse
      type(passages_t), intent(out) :: slow
      real(wp), intent(inout) :: budget
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error

      call run_coarsest(scene, runs, coarse, budget, listener, error)
      if (allocated(error)) return
      slow = coarse
      if (listener%is_stopping) slow%is_known = .false.
      if (.not. slow%is_known) return
      slow%work = 0.0_wp
      slow%scenes(2)%time%time_step = 2*coarse%scenes(2)%time%time_step
      call run_grid(slow, 2, listener, error)   ! error: the caller looks
      budget = budget - slow%work
   end subroutine run_larger_step

   !> Measures the parts in the `list` of ingredients of a `scene` whose run has made `runs`, if the
   !> row of all roughness in `adequacy` is known, as far as the `budget` goes (nodes times Newton
   !> steps): all of them or none. `coarse`: the passages on n/4 and n/8 intervals, for others that
   !> take them. `is_open`: which ingredients have no verdict.
   ! allow(too-many-arguments)  what is measured, the bound, and what every run has
   subroutine measure_parts(scene, runs, list, coarse, budget, adequacy, is_open, listener, error)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(ingredient_t), intent(in) :: list(:)
      type(passages_t), intent(inout) :: coarse
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      logical, intent(inout) :: is_open(:)
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passages_t) :: passages
      real(wp), dimension(quantity_count) :: all_there, change
      real(wp) :: doubt(quantity_count, 2)
      logical :: is_part(size(list)), is_known
      integer :: g, i, whole

      is_part = is_open .and. (list%kind == one_surface .or. list%kind == one_feature)
      whole = findloc(list%kind, roughness, 1)
      if (.not. any(is_part) .or. whole == 0) return
      if (is_open(whole) .or. .not. all(is_told_by_own(scene, runs, pack(list, is_part)))) return
      g = affordable_grid(scene, runs, count(is_part), coarse%is_tried, budget)
      if (g == 0) return
      call look_at_all(scene, runs, list(whole), g, coarse, passages, all_there, is_known, &
         budget, listener, error)
      if (allocated(error) .or. .not. is_known) return
      do i = 1, size(list)
         if (.not. is_part(i)) cycle
         call change_on_grid(passages, g, list(i), change, doubt, is_known, listener, error)
         if (allocated(error) .or. listener%is_stopping) return
         if (is_known) call take_part(change, doubt, adequacy%rows(whole)%change, all_there, &
            adequacy%rows(i))
         is_open(i) = verdict_on(adequacy%rows(i), adequacy%accuracy) == verdict_unknown
      end do
      budget = budget - passages%work
   end subroutine measure_parts

   !> What all roughness changes on grid `g` (`all_there`), and the passages there.
   ! allow(too-many-arguments)  what is measured, its outcome, and what every run has
   subroutine look_at_all(scene, runs, all_roughness, g, coarse, passages, all_there, is_known, &
      budget, listener, error)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(ingredient_t), intent(in) :: all_roughness
      integer, intent(in) :: g
      type(passages_t), intent(inout) :: coarse
      type(passages_t), intent(out) :: passages
      real(wp), intent(out) :: all_there(quantity_count)
      logical, intent(out) :: is_known
      real(wp), intent(inout) :: budget
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: doubt(quantity_count, 2)

      is_known = .false.
      if (g == 1) then
         passages = known_passages(scene, scene%contact%domain%intervals/[4, 8], &
            scheme_of(runs), [runs%bars%quarter, runs%bars%quarter])
      else
         call run_coarsest(scene, runs, coarse, budget, listener, error)
         if (allocated(error)) return
         passages = coarse
      end if
      passages%work = 0.0_wp
      if (.not. passages%is_known .or. listener%is_stopping) return
      call change_on_grid(passages, g, all_roughness, all_there, doubt, is_known, listener, &
         error)   ! error: the caller looks
   end subroutine look_at_all

   !> Relative changes of all quantities without an ingredient, on both grids, and what spikes may
   !> add on the finer one, to the contact without and with it; `is_known` is false where one of
   !> them has no solution without it.
   subroutine changes_without(passages, ingredient, changes, doubt, is_known, listener, error)
      type(passages_t), intent(inout) :: passages
      type(ingredient_t), intent(in) :: ingredient
      real(wp), dimension(quantity_count, 2), intent(out) :: changes, doubt
      logical, intent(out) :: is_known
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: coarser_doubt(quantity_count, 2)

      call change_on_grid(passages, 1, ingredient, changes(:, 1), doubt, is_known, listener, error)
      if (allocated(error) .or. .not. is_known) return
      call start_from_finer(passages%smooth, passages%scenes%contact%domain%intervals)
      call change_on_grid(passages, 2, ingredient, changes(:, 2), coarser_doubt, is_known, &
         listener, error)   ! error: the caller looks
   end subroutine changes_without

   !> The same on grid `g` of the two alone.
   ! allow(too-many-arguments)  what is left out where, its outcome, and what every run has
   subroutine change_on_grid(passages, g, ingredient, change, doubt, is_known, listener, error)
      type(passages_t), intent(inout) :: passages
      integer, intent(in) :: g
      type(ingredient_t), intent(in) :: ingredient
      real(wp), intent(out) :: change(quantity_count), doubt(quantity_count, 2)
      logical, intent(out) :: is_known
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(line_summary_t) :: lean

      call run_without(passages%scenes(g), ingredient, passages%smooth(g), lean, is_known, &
         passages%work, listener, error)
      if (allocated(error) .or. .not. is_known) return
      change = change_between(lean, passages%full(g))
      doubt = doubt_between(lean, passages%full(g))
   end subroutine change_on_grid

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

   !> The extremes of a scene; what it took is added to `work`.
   subroutine run_scene(scene, listener, summary, is_known, work, error)
      type(scene_t), intent(in) :: scene
      class(listener_t), intent(inout), target :: listener
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
      collector%parent => listener
      collector%passage = passage_extremes_t(new_passage_times(own, scene%time))
      call solve_ehl_line(own, scene%settings, scene%time, collector, state, report, error)
      if (allocated(error)) return
      work = work + march_weight*report%cycles*real(own%domain%intervals, wp)
      is_known = report%converged
      if (.not. is_known) return
      summary = collector%passage%extremes(summary_of(state))
      call doubt_extremes(scene%contact, summary)
   end subroutine run_scene

   !> Those without an ingredient: another passage, or steady solutions.
   ! allow(too-many-arguments)  what is run, its outcome and cost, and what every run has
   subroutine run_without(scene, ingredient, smooth, summary, is_known, work, listener, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: ingredient
      type(film_state_t), intent(inout) :: smooth
      type(line_summary_t), intent(out) :: summary
      logical, intent(out) :: is_known
      real(wp), intent(inout) :: work
      class(listener_t), intent(inout), target :: listener
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
            call solve_steadily(lean, listener, state, is_known, error)
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
            listener, error)   ! error: the caller looks
         if (is_known) call doubt_extremes(scene%contact, summary)
      case default   ! all others
         call run_scene(lean, listener, summary, is_known, work, error)   ! error: the caller looks
      end select
   end subroutine run_without

   !> The steady contact of a scene on its own grid, with the surfaces at their first places.
   subroutine solve_steadily(scene, listener, state, is_solved, error)
      type(scene_t), intent(in) :: scene
      class(listener_t), intent(inout), target :: listener
      type(line_state_t), intent(out) :: state
      logical, intent(out) :: is_solved
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: own
      type(collector_t) :: collector
      type(report_t) :: report

      own = scene%contact
      own%domain%may_lengthen = .false.
      collector%parent => listener
      call solve_ehl_line(own, solver_settings_t(method='newton_krylov', max_cycles=max_cycles, &
         explains_failure=.false.), time_settings_t(), collector, state, report, error)
      is_solved = report%converged .and. .not. allocated(error)
   end subroutine solve_steadily

end module coarse_passages

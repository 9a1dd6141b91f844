!> The adequacy of the model of a lubricated result, measured within a bounded cost: a share of what
!> the run itself has taken, or what a small run may take. Costs are counted in nodes times Newton
!> steps, not in seconds, so that a repeated run measures the same.
!>
!> Of a passage the ingredients of oil and bodies are first left out of the smooth steady contact,
!> which costs next to nothing. Then its run has made passages with everything itself: on its own
!> grid, and for its error bars on half and a quarter of the intervals. Smooth surfaces take one
!> steady solution a grid, on n and n/2 intervals. Steady solutions with the waves at their places
!> follow each other there or on n/2 and n/4, at as many times as the budget allows. Without
!> anything else that is open the passage is run on n/4 and n/8. Where there are no such runs, the
!> whole passage is run on one and the same coarse grid with and without each, and on a coarser one.
module measured_adequacy
   use ablation_runs, only: measure_at_rest, set_change
   use ablations, only: ingredient_t, ingredients_of, is_of_surfaces, roughness, squeeze, &
      without_surfaces
   use adequacy, only: adequacy_t, influence_t, new_influence, tell_at_rest
   use coarse_passages, only: changes_without, measure_parts, run_coarsest, run_larger_step, &
      run_passages, solve_steadily
   use errors, only: error_t
   use kinds, only: wp
   use line_hierarchy, only: coarsest_for_film
   use line_state, only: line_state_t
   use listener, only: listener_t
   use own_passages, only: cost_of_coarse, finest_passages, is_told_by_own, own_runs_t
   use passage_pairs, only: coarse_tolerance, cost_of, march_weight, passage_grids, passages_t, &
      scene_t, schemes, steps_to_start, widths
   use quantities, only: quantity_count
   use solver_settings, only: time_settings_t
   use time_step_error, only: take_larger_step, tell_time_step, time_step_cost
   use wave_places, only: find_places, leaves_enough
   implicit none (type, external)
   private

   public :: measure_adequacy

   !> Share of the cost of the run, and what a small run may take: 20 ms, 2700 instructions each,
   !> but what writing the rows takes.
   real(wp), parameter :: share = 0.1_wp, small_run = 5.0e4_wp
   !> Newton steps of a steady run on its finest grid, coarser ones and error bars counted.
   real(wp), parameter :: steady_steps = 12.0_wp
   !> Coarse runs of error bars over the cost of a passage: n/2 and n/4; the passage once more by
   !> the scheme of second order, where it is of first.
   real(wp), parameter :: coarse_share = 0.3125_wp

   !> Intervals of the smooth steady contact, at most.
   integer, parameter :: most_at_rest = 128

   !> The error of a change: this many times its own change from the grid with twice the spacing, of
   !> first order 1.5 times the error; a share of itself; on n/8 a share of the largest change of a
   !> film, for a wave passes the nodes of two coarse grids alike by chance; and what iterations
   !> leave.
   real(wp), parameter :: own_widths(4) = [1.5_wp, 0.05_wp, 0.0_wp, 2.0e-5_wp], &
      coarse_widths(4) = [1.5_wp, 0.1_wp, 0.15_wp, 2*coarse_tolerance]

contains

   !> Measures every ingredient of a converged `scene` whose last state is `state`, and which has
   !> made `runs`, for the `accuracy` that counts.
   subroutine measure_adequacy(scene, state, runs, accuracy, adequacy, listener, error)
      type(scene_t), intent(in) :: scene
      type(line_state_t), intent(in) :: state
      type(own_runs_t), intent(in) :: runs
      real(wp), intent(in) :: accuracy
      type(adequacy_t), intent(out) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: budget

      adequacy%accuracy = accuracy
      call listener%on_stage('measuring what each ingredient changes')
      associate (list => ingredients_of(scene%contact, scene%time%is_transient), &
         n => real(size(state%x) - 1, wp))
         if (scene%time%is_transient) then
            budget = march_weight*n*runs%newton_steps
            if (runs%bars%has_half .and. scene%time%scheme == 'backward_euler') then
               budget = budget*(2 + coarse_share)
            else if (runs%bars%has_half) then
               budget = budget*(1 + coarse_share)
            end if
            budget = max(share*budget, small_run)
            call measure_passage(scene, list, runs, budget, adequacy, listener, &
               error)   ! error: the caller looks
         else
            budget = max(share*steady_steps*n, small_run)
            call measure_at_rest(scene%contact, state, list, .false., budget, adequacy, listener, &
               error)   ! error: the caller looks
         end if
      end associate
   end subroutine measure_adequacy

   !> Measures the ingredients of a transient: those of oil and bodies at rest, those that the
   !> `runs` made already tell, and the others over the passage, as far as the `budget` goes (nodes
   !> times Newton steps).
   subroutine measure_passage(scene, list, runs, budget, adequacy, listener, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: list(:)
      type(own_runs_t), intent(in) :: runs
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passages_t) :: kept(2)
      logical, dimension(size(list)) :: is_open, takes_rest

      call measure_smooth(scene, list, budget, adequacy, listener, error)
      if (allocated(error) .or. listener%is_stopping) return
      is_open = .true.
      call ask_own(scene, runs, list, list%kind == roughness, kept, budget, adequacy, is_open, &
         listener, error)
      if (allocated(error) .or. listener%is_stopping) return
      call look_at_rest(list, adequacy, is_open)
      call measure_parts(scene, runs, list, kept(2), budget, adequacy, is_open, listener, error)
      if (allocated(error) .or. listener%is_stopping) return
      takes_rest = list%kind == squeeze .and. is_told_by_own(scene, runs, list)
      call ask_own(scene, runs, list, is_open .and. .not. takes_rest, kept, budget, adequacy, &
         is_open, listener, error)
      if (allocated(error) .or. listener%is_stopping) return
      call compare_passages(scene, list, is_open .and. .not. takes_rest, budget, adequacy, &
         listener, error)
      if (allocated(error) .or. listener%is_stopping) return
      call ask_time_step(scene, runs, any(takes_rest), kept, budget, adequacy, listener, error)
      if (allocated(error) .or. listener%is_stopping) return
      call ask_own(scene, runs, list, takes_rest, kept, budget, adequacy, is_open, listener, &
         error)   ! error: the caller looks
   end subroutine measure_passage

   !> Measures the time step if enough budget for the squeeze term remains.
   ! allow(too-many-arguments)  what is measured, the bound, and what every run has
   subroutine ask_time_step(scene, runs, wants_squeeze, kept, budget, adequacy, listener, error)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      logical, intent(in) :: wants_squeeze
      type(passages_t), intent(inout) :: kept(2)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passages_t) :: larger
      real(wp) :: cost
      logical :: is_open

      adequacy%time_step = new_influence('time_step', 'limit of small time steps')
      adequacy%time_step%is_numerical = .true.
      call tell_time_step(scene, runs, adequacy%time_step, is_open)
      if (.not. is_open) return
      cost = time_step_cost(scene, runs, kept(2)%is_tried)
      if (wants_squeeze) is_open = leaves_enough(scene, runs, kept(1), budget, cost)
      if (budget < cost .or. .not. is_open) return
      call run_larger_step(scene, runs, kept(2), larger, budget, listener, error)
      if (allocated(error)) return
      adequacy%time_step%unknown = 'a coarse grid has no solution with larger steps'
      if (larger%is_known) call take_larger_step(kept(2)%full(2), larger%full(2), &
         adequacy%time_step)
   end subroutine ask_time_step

   !> Those of the chosen ingredients that the passages of the run tell.
   ! allow(too-many-arguments)  what is measured, the bound, and what every run has
   subroutine ask_own(scene, runs, list, is_chosen, kept, budget, adequacy, is_open, listener, &
      error)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(ingredient_t), intent(in) :: list(:)
      logical, intent(in) :: is_chosen(:)
      type(passages_t), intent(inout) :: kept(2)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      logical, intent(inout) :: is_open(:)
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      logical :: is_known
      integer :: i

      do i = 1, size(list)
         if (.not. (is_chosen(i) .and. is_told_by_own(scene, runs, list(i)))) cycle
         call compare_with_own(scene, runs, list(i), kept, budget, adequacy%rows(i), is_known, &
            listener, error)
         if (allocated(error) .or. listener%is_stopping) return
         is_open(i) = .not. is_known
      end do
   end subroutine ask_own

   !> Marks ingredients that the smooth steady contact leaves undecided.
   pure subroutine look_at_rest(list, adequacy, is_open)
      type(ingredient_t), intent(in) :: list(:)
      type(adequacy_t), intent(inout) :: adequacy
      logical, intent(inout) :: is_open(:)
      type(influence_t) :: rough
      integer :: i

      rough = new_influence('', '')
      i = findloc(list%kind, roughness, 1)
      if (i > 0) rough = adequacy%rows(i)
      do i = 1, size(list)
         if (.not. is_of_surfaces(list(i))) call tell_at_rest(adequacy%rows(i), rough, &
            adequacy%accuracy, is_open(i))
      end do
   end subroutine look_at_rest

   !> The rows, with the ingredients of oil and bodies measured on the smooth steady contact.
   subroutine measure_smooth(scene, list, budget, adequacy, listener, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: list(:)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: smooth
      type(adequacy_t) :: own
      type(line_state_t) :: state
      logical :: is_solved
      integer :: i, k

      adequacy%rows = [(new_influence(trim(list(i)%name), trim(list(i)%text)), i=1, size(list))]
      smooth = scene
      smooth%contact = without_surfaces(scene%contact)
      smooth%time = time_settings_t()
      associate (n => smooth%contact%domain%intervals)
         do while (modulo(n, 2) == 0 .and. n > most_at_rest &
            .and. n/2 >= 2*coarsest_for_film(scene%contact))
            n = n/2
         end do
         call solve_steadily(smooth, listener, state, is_solved, error)
         if (allocated(error) .or. .not. is_solved) return
         budget = budget - steps_to_start*n
      end associate
      own%accuracy = adequacy%accuracy
      call measure_at_rest(smooth%contact, state, pack(list, .not. is_of_surfaces(list)), .true., &
         budget, own, listener, error)
      if (allocated(error)) return
      adequacy%at_rest = own%at_rest
      k = 0
      do i = 1, size(list)
         if (is_of_surfaces(list(i))) cycle
         k = k + 1
         adequacy%rows(i) = own%rows(k)
         adequacy%rows(i)%is_at_rest = .true.
      end do
   end subroutine measure_smooth

   !> Runs the passage with every ingredient and, as long as the budget lasts, without each one that
   !> is open.
   subroutine compare_passages(scene, list, is_open, budget, adequacy, listener, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: list(:)
      logical, intent(in) :: is_open(:)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passages_t) :: passages(size(schemes))
      integer :: i

      if (.not. any(is_open)) return
      adequacy%in_time = passage_grids(scene, count(is_open .and. list%kind /= roughness), budget)
      if (any(adequacy%in_time == 0)) return
      do i = 1, size(list)
         if (is_open(i)) call compare_one(scene, list(i), passages, budget, adequacy%in_time, &
            adequacy%rows(i), listener, error)
         if (allocated(error) .or. listener%is_stopping) return
      end do
   end subroutine compare_passages

   !> The change of one ingredient: by the first scheme that finds all solutions within the budget.
   ! allow(too-many-arguments)  what is measured, the bound, and what every run has
   subroutine compare_one(scene, ingredient, passages, budget, grids, row, listener, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: ingredient
      type(passages_t), intent(inout) :: passages(:)
      real(wp), intent(inout) :: budget
      integer, intent(in) :: grids(2)
      type(influence_t), intent(inout) :: row
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: changes(quantity_count, 2), doubt(quantity_count, 2), cost, spent
      logical :: is_known
      integer :: k

      cost = cost_of(scene, grids)
      do k = 1, size(schemes)
         if (.not. passages(k)%is_tried) then
            if (budget < cost) return
            call run_passages(scene, grids, schemes(k), passages(k), listener, error)
            if (allocated(error) .or. listener%is_stopping) return
            budget = budget - passages(k)%work
         end if
         ! smooth surfaces take one steady solution
         if (ingredient%kind == roughness) cost = 0.0_wp
         if (.not. passages(k)%is_known .or. budget < cost) cycle
         spent = passages(k)%work
         call changes_without(passages(k), ingredient, changes, doubt, is_known, listener, &
            error)
         if (allocated(error)) return
         budget = budget - (passages(k)%work - spent)
         if (.not. is_known) cycle
         row%is_at_rest = .false.
         row%left_out = 1.0_wp
         call set_change(row, changes, doubt, widths)
         return
      end do
   end subroutine compare_one

   !> Fills the `row` of an ingredient that they tell, as far as the `budget` goes (nodes times
   !> Newton steps at rest). `kept`: the passages on n and n/2, and on n/4 and n/8, for all
   !> ingredients that take them. `is_known`: there is a solution.
   ! allow(too-many-arguments)  what is measured, the bound, and what every run has
   subroutine compare_with_own(scene, runs, ingredient, kept, budget, row, is_known, listener, &
      error)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(ingredient_t), intent(in) :: ingredient
      type(passages_t), intent(inout) :: kept(2)
      real(wp), intent(inout) :: budget
      type(influence_t), intent(inout) :: row
      logical, intent(out) :: is_known
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passages_t) :: passages
      real(wp) :: changes(quantity_count, 2), doubt(quantity_count, 2), cost, widths(4)

      is_known = .false.
      widths = own_widths
      select case (ingredient%kind)
      case (roughness)
         if (.not. kept(1)%is_tried) kept(1) = finest_passages(scene, runs)
         passages = kept(1)
         cost = steps_to_start*sum(passages%scenes%contact%domain%intervals)
      case (squeeze)
         if (.not. kept(1)%is_tried) kept(1) = finest_passages(scene, runs)
         call find_places(scene, runs, kept(1), budget, passages, cost)
      case default   ! all others
         widths = coarse_widths
         cost = cost_of_coarse(scene, runs, kept(2)%is_tried)
         if (budget < cost) return
         call run_coarsest(scene, runs, kept(2), budget, listener, error)
         if (allocated(error) .or. listener%is_stopping) return
         if (.not. kept(2)%is_known) return
         passages = kept(2)
      end select
      passages%work = 0.0_wp
      if (budget < cost) return
      call changes_without(passages, ingredient, changes, doubt, is_known, listener, error)
      if (allocated(error)) return
      budget = budget - passages%work
      if (ingredient%kind == roughness) kept(1)%smooth = passages%smooth
      if (.not. is_known) return
      row%is_at_rest = .false.
      row%left_out = 1.0_wp
      call set_change(row, changes, doubt, widths)
   end subroutine compare_with_own

end module measured_adequacy

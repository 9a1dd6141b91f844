!> Chooses the even grid of a steady contact for a target accuracy of h_min: exact solutions on one
!> level after the other, each of which starts the next and serves as a coarse run of its error
!> estimate, until the estimate meets the target.
module steady_target
   use domain_choice, only: choose_intervals
   use ehl_line_solver, only: solve_ehl_line
   use ehl_line_steady, only: solve_steady
   use error_bars, only: error_bars_t, new_error_bars
   use errors, only: error_t
   use grid_estimates, only: estimated_error, copy_coarser
   use inlet_errors, only: domain_error
   use iteration_report, only: report_t
   use kinds, only: wp
   use state_output, only: coarser_summaries, level_summary
   use line_contact, only: intervals_for_waves, line_contact_t
   use line_hierarchy, only: add_level, line_hierarchy_t, new_growing_hierarchy, new_hierarchy, &
      pose_steady_problem, relaxation_t
   use line_level, only: line_level_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use nested_start, only: coarse_run_tolerance, first_guess, max_firsts, solve_level
   use listener, only: is_stopped, listener_t
   use solver_choice, only: adopt, steady_attempts
   use solver_settings, only: max_chosen, solver_settings_t, time_settings_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: solve_contact

   !> When the climb may end.
   type :: goal_t
      !> Relative error of h_min by the grid.
      real(wp) :: film = 0.0_wp
      type(solver_settings_t) :: settings
   end type goal_t

contains

   !> Solves one contact as `solve_ehl_line` does. With `settings%target` the even grid of a steady
   !> contact is chosen for that accuracy of h_min, and so is its inlet unless given: then the
   !> accuracy is that on the given domain.
   subroutine solve_contact(contact, settings, time, listener, state, report, error)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error

      if (settings%target > 0.0_wp .and. .not. time%is_transient &
         .and. contact%domain%grid /= 'graded') then
         call solve_ehl_line(contact, settings, time, listener, state, report, error, &
            solve_to_accuracy)   ! error: the caller looks
      else
         call solve_ehl_line(contact, settings, time, listener, state, report, &
            error)   ! error: the caller looks
      end if
   end subroutine solve_contact

   !> Solves the steady contact on the coarsest grid of 2^k intervals that meets `settings%target`
   !> for h_min, of which a chosen inlet takes a part, else on the finest grid allowed; sets
   !> `contact%domain%intervals`.
   subroutine solve_to_accuracy(hierarchy, contact, settings, listener, report, error)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(listener_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      type(error_bars_t) :: bars
      type(relaxation_t), allocatable :: ways(:)
      type(goal_t) :: goal
      logical :: is_sound
      integer :: i

      goal = goal_t(settings%target, settings)
      if (contact%domain%inlet_is_chosen) goal%film = &
         max(settings%target - domain_error(report%fit%inlet_error), 0.0_wp)
      bars = new_error_bars(contact, time_settings_t(), settings%space_scheme)
      allocate (ways, source=steady_attempts(contact, solver_settings_t(method='newton_krylov')))
      do i = 1, size(ways)
         if (ways(i)%first_stress > 1.0_wp) cycle
         call new_growing_hierarchy(hierarchy, contact, max_chosen(settings), error)
         if (allocated(error)) return
         call pose_steady_problem(hierarchy, contact, with_roughness=.true.)
         call adopt(hierarchy, ways(i))
         call climb(hierarchy, contact, goal, listener, bars, is_sound, error)
         if (allocated(error) .or. listener%is_stopping) return
         if (is_sound) exit
      end do
      if (.not. is_sound) then
         call double_grid(hierarchy, contact, goal, listener, bars, report, &
            error)   ! error: the caller looks
         return
      end if
      contact%domain%intervals = hierarchy%levels(hierarchy%finest)%n
      if (settings%levels > 0) then
         call new_hierarchy(hierarchy, contact, settings%levels, error)
         if (allocated(error)) return
         call pose_steady_problem(hierarchy, contact, with_roughness=.true.)
      end if
      hierarchy%levels(hierarchy%finest)%is_kappa = hierarchy%is_kappa
      call solve_steady(hierarchy, contact, settings, listener, report, &
         is_started=settings%levels == 0)
   end subroutine solve_to_accuracy

   !> Finds exact solutions on one level after the other, from the coarsest that carries a film,
   !> until the `goal` is reached or the hierarchy cannot grow. `is_sound` is false if a level and
   !> the next finer ones have no solution.
   subroutine climb(hierarchy, contact, goal, listener, bars, is_sound, error)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(goal_t), intent(in) :: goal
      class(listener_t), intent(inout) :: listener
      type(error_bars_t), intent(inout) :: bars
      logical, intent(out) :: is_sound
      type(error_t), allocatable, intent(out) :: error
      integer :: first, k

      first = 1
      k = 1
      do
         is_sound = .false.
         if (is_stopped(listener)) return
         if (k > hierarchy%top) then
            call add_level(hierarchy, contact, error)
            if (allocated(error)) return
         end if
         call first_guess(hierarchy, contact, k, first)
         call listener%on_stage('steady on '//to_text(hierarchy%levels(k)%n)//' intervals')
         call solve_level(hierarchy, k, min(coarse_run_tolerance, goal%film), is_sound, &
            listener)
         if (is_sound) then
            call copy_coarser(bars, coarser_summaries(hierarchy))
            if (hierarchy%levels(k)%n >= intervals_for_waves(contact) &
               .and. hierarchy%levels(k)%is_coarse_run .and. &
                is_reached(goal, bars, hierarchy%levels(k))) return
            if (k == size(hierarchy%levels)) return
         else
            first = k + 1
            if (first > min(max_firsts, size(hierarchy%levels))) return
         end if
         k = k + 1
      end do
   end subroutine climb

   !> If the climb fails: independent solutions on grids doubled from the default choice, until the
   !> goal is reached.
   subroutine double_grid(hierarchy, contact, goal, listener, bars, report, error)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(goal_t), intent(in) :: goal
      class(listener_t), intent(inout) :: listener
      type(error_bars_t), intent(inout) :: bars
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      type(line_summary_t) :: summary

      call choose_intervals(contact)
      bars%grids = 0
      do
         call new_hierarchy(hierarchy, contact, goal%settings%levels, error)
         if (allocated(error)) return
         call pose_steady_problem(hierarchy, contact, with_roughness=.true.)
         call solve_steady(hierarchy, contact, goal%settings, listener, report)
         if (listener%is_stopping) return
         if (2*contact%domain%intervals > max_chosen(goal%settings)) return
         if (report%converged) then
            associate (level => hierarchy%levels(hierarchy%finest))
               if (contact%domain%intervals >= intervals_for_waves(contact) .and. &
                   is_reached(goal, bars, level)) return
               summary = level_summary(level)
            end associate
            call copy_coarser(bars, [summary, bars%coarser(:bars%grids)])
         end if
         contact%domain%intervals = 2*contact%domain%intervals
      end do
   end subroutine double_grid

   !> Whether the estimated errors on a `level` are small enough.
   logical function is_reached(goal, bars, level)
      type(goal_t), intent(in) :: goal
      type(error_bars_t), intent(in) :: bars
      type(line_level_t), intent(in) :: level

      is_reached = estimated_error(bars, level_summary(level)) <= goal%film
   end function is_reached

end module steady_target

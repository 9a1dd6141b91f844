!> The grid of a steady contact for a wanted accuracy of h_min: exact solutions on level after level, each the start of the next
!> and a companion of its error estimate, until the estimate is small enough. Nothing is solved twice.
module grid_choice
   use domain_choice, only: choose_domain
   use ehl_line_steady, only: solve_steady
   use error_bars, only: error_bars_t, estimated_error
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: intervals_for_waves, line_contact_t
   use line_hierarchy, only: add_level, line_hierarchy_t, most_intervals, new_growing_hierarchy, new_hierarchy, &
      pose_steady_problem, relaxation_t
   use line_level, only: line_level_t
   use line_summary, only: line_summary_t, summary_of_fields
   use nested_start, only: bump_start, companion_tolerance, most_firsts, refine, solve_level
   use observer, only: is_stopped, observer_t
   use solver_choice, only: adopt, steady_attempts
   use solver_settings, only: most_intervals_of, solver_settings_t
   implicit none (type, external)
   private

   public :: gather_companions, solve_to_accuracy

contains

   !> Solves the steady contact on the coarsest grid of 2^k intervals whose estimated relative error of h_min is below
   !> `settings%target`, or on the finest that there is; `contact%domain%intervals` becomes its number.
   !> `bars` are the companions of the answer.
   subroutine solve_to_accuracy(hierarchy, contact, settings, watcher, bars, report, error)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(observer_t), intent(inout) :: watcher
      type(error_bars_t), intent(inout) :: bars
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      type(relaxation_t), allocatable :: ways(:)
      logical :: is_sound
      integer :: i

      allocate (ways, source=steady_attempts(contact, solver_settings_t(method='newton_krylov')))
      hierarchy%is_sharp = settings%space_scheme == 'sharp'
      do i = 1, size(ways)
         if (ways(i)%first_stress > 1.0_wp) cycle
         call new_growing_hierarchy(hierarchy, contact, error)
         if (allocated(error)) return
         call pose_steady_problem(hierarchy, contact, with_roughness=.true.)
         call adopt(hierarchy, ways(i))
         call climb(hierarchy, contact, settings%target, watcher, bars, is_sound, error)
         if (allocated(error) .or. watcher%wants_stop) return
         if (is_sound) exit
      end do
      if (.not. is_sound) then
         call double_grid(hierarchy, contact, settings, watcher, bars, report, error)   ! error: the caller looks
         return
      end if
      contact%domain%intervals = hierarchy%levels(hierarchy%finest)%n
      if (settings%levels > 0) then
         call new_hierarchy(hierarchy, contact, settings%levels, error)
         if (allocated(error)) return
         call pose_steady_problem(hierarchy, contact, with_roughness=.true.)
      end if
      hierarchy%levels(hierarchy%finest)%is_sharp = hierarchy%is_sharp
      call solve_steady(hierarchy, contact, settings, watcher, report, is_started=settings%levels == 0)
   end subroutine solve_to_accuracy

   !> Exact solutions on level after level, from the coarsest that carries a film, until the estimate is below `target`; the
   !> hierarchy grows as far as that needs, or as it can. `is_sound` is false if a level finds no solution and the next finer
   !> ones neither.
   subroutine climb(hierarchy, contact, target, watcher, bars, is_sound, error)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: target
      class(observer_t), intent(inout) :: watcher
      type(error_bars_t), intent(inout) :: bars
      logical, intent(out) :: is_sound
      type(error_t), allocatable, intent(out) :: error
      integer :: first, k

      first = 1
      k = 1
      do
         is_sound = .false.
         if (is_stopped(watcher)) return
         if (k > hierarchy%top) then
            call add_level(hierarchy, contact, .true., error)
            if (allocated(error)) return
         end if
         if (k == first) then
            call bump_start(hierarchy, contact, k)
         else
            call refine(hierarchy, contact, k)
         end if
         call solve_level(hierarchy, contact, k, min(companion_tolerance, target), is_sound, watcher)
         if (is_sound) then
            call gather_companions(hierarchy, bars)
            if (hierarchy%levels(k)%n >= intervals_for_waves(contact) .and. hierarchy%levels(k)%is_companion .and. &
                estimated_error(bars, summary_on(hierarchy%levels(k))) <= target) return
            if (k == size(hierarchy%levels)) return
         else
            first = k + 1
            if (first > min(most_firsts, size(hierarchy%levels))) return
         end if
         k = k + 1
      end do
   end subroutine climb

   !> Where the climb fails: solutions of their own on grids doubled from the program's choice, until the estimate is below the
   !> target.
   subroutine double_grid(hierarchy, contact, settings, watcher, bars, report, error)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(observer_t), intent(inout) :: watcher
      type(error_bars_t), intent(inout) :: bars
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      type(line_summary_t) :: summary

      contact%domain%intervals = 0
      call choose_domain(contact)
      bars%has_half = .false.
      bars%has_quarter = .false.
      bars%has_eighth = .false.
      do
         call new_hierarchy(hierarchy, contact, settings%levels, error)
         if (allocated(error)) return
         call pose_steady_problem(hierarchy, contact, with_roughness=.true.)
         hierarchy%levels(hierarchy%finest)%is_sharp = hierarchy%is_sharp
         call solve_steady(hierarchy, contact, settings, watcher, report)
         if (watcher%wants_stop) return
         if (2*contact%domain%intervals > min(most_intervals, most_intervals_of(settings%method))) return
         if (report%converged) then
            summary = summary_on(hierarchy%levels(hierarchy%finest))
            if (contact%domain%intervals >= intervals_for_waves(contact) .and. &
                estimated_error(bars, summary) <= settings%target) return
            bars%has_eighth = bars%has_quarter
            if (bars%has_quarter) bars%eighth = bars%quarter
            bars%has_quarter = bars%has_half
            if (bars%has_half) bars%quarter = bars%half
            bars%has_half = .true.
            bars%half = summary
         end if
         contact%domain%intervals = 2*contact%domain%intervals
      end do
   end subroutine double_grid

   !> The figures of the three levels below the finest, where these are solved well enough and no cycle has changed them since.
   pure subroutine gather_companions(hierarchy, bars)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(error_bars_t), intent(inout) :: bars

      bars%has_half = hierarchy%coarsest == hierarchy%finest
      call gather(1, bars%has_half, bars%half)
      bars%has_quarter = bars%has_half
      call gather(2, bars%has_quarter, bars%quarter)
      bars%has_eighth = bars%has_quarter
      call gather(3, bars%has_eighth, bars%eighth)

   contains

      !> Those of the level so far `below`, where the ones above it are known.
      pure subroutine gather(below, is_known, summary)
         integer, intent(in) :: below
         logical, intent(inout) :: is_known
         type(line_summary_t), intent(inout) :: summary

         is_known = is_known .and. hierarchy%finest > below
         if (is_known) is_known = hierarchy%levels(hierarchy%finest - below)%is_companion
         if (is_known) summary = summary_on(hierarchy%levels(hierarchy%finest - below))
      end subroutine gather

   end subroutine gather_companions

   !> The figures of the solution on a level.
   pure function summary_on(level) result(summary)
      type(line_level_t), intent(in) :: level
      type(line_summary_t) :: summary

      summary = summary_of_fields(level%x, level%pressure, level%film, 0.0_wp)
   end function summary_on

end module grid_choice

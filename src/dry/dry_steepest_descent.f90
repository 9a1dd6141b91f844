!> Solves the contact of rough surfaces by projected steepest descent, the method of the thesis
!> (chapter 3).
!>
!> After H. M. Stanley and T. Kato, J. Tribol. 119, 1997, 481: a step along the negative gap, then a
!> shift that restores the load within the bounds. The step is the exact minimum along the
!> direction. Slow: a baseline for comparison.
module dry_steepest_descent
   use active_set, only: active_set_t, copy_survey, new_active_set
   use dry_problem, only: dry_problem_t, dry_settings_t, dry_solution_t, end_of_iteration
   use kinds, only: wp
   use load_projection, only: shift_into_bounds
   implicit none (type, external)
   private

   public :: iterate_steepest_descent

contains

   !> Improves the pressure of `solution` (within its bounds and with its load) until the error
   !> measure meets the tolerance or the iterations are used up, and fills the other components.
   subroutine iterate_steepest_descent(problem, settings, solution)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_settings_t), intent(in) :: settings
      type(dry_solution_t), intent(inout) :: solution
      type(active_set_t) :: set
      real(wp), allocatable :: direction(:), response(:), q(:)
      integer :: iteration, n

      n = size(solution%pressure)
      call new_active_set(set, problem%grid)
      allocate (response(n), q(n))
      allocate (direction(n), source=0.0_wp)
      associate (p => solution%pressure, report => solution%report)
         report%method = 'steepest_descent'
         do iteration = 0, settings%max_cycles
            call problem%find_v(p, solution%v)
            call set%survey(problem, p, solution%v)
            call report%add(set%error, set%load_error)
            call copy_survey(set, settings%tolerance, solution)
            if (report%converged .or. set%error >= huge(1.0_wp)) exit
            if (iteration < settings%max_cycles) call descend(problem, set, direction, response, &
               q, p)
         end do
         report%reason = end_of_iteration(report, set%error, settings%max_cycles, &
            is_stalled=.false.)
      end associate
   end subroutine iterate_steepest_descent

   !> Moves p along r less its mean on F, by the length that minimises the energy; then returns it
   !> to bounds and load.
   subroutine descend(problem, set, direction, response, q, p)
      type(dry_problem_t), intent(inout) :: problem
      type(active_set_t), intent(in) :: set
      real(wp), contiguous, intent(inout) :: direction(:), response(:), q(:), p(:)
      real(wp) :: curvature, length, load_held, slope

      associate (n => set%count, node => set%node(:set%count))
         direction = 0.0_wp
         direction(node) = set%residual(:n) - sum(set%residual(:n))/n
         call problem%elastic%apply(direction, response)
         slope = dot_product(direction(node), set%residual(:n))
         curvature = dot_product(direction(node), response(node))
         length = 0.0_wp
         if (curvature > 0.0_wp) length = slope/curvature
         q(:n) = p(node) + length*direction(node)
         load_held = 0.0_wp
         if (set%held > 0) load_held = set%held*problem%hardness
         call shift_into_bounds(q(:n), problem%hardness, max(problem%load - load_held, 0.0_wp))
         p(node) = q(:n)
      end associate
   end subroutine descend

end module dry_steepest_descent

!> The full momentum equations of an elastic film from a first approximation or, where Newton's
!> method fails from there, by continuation.
!>
!> delta^2, the square of the slope scale, grows from 0, where the solution is that of the Reynolds
!> equation, to its value; each solution is the first approximation of the next.
module momentum_continuation
   use film_equation, only: take_film
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_level, only: line_level_t
   use momentum_newton, only: momentum_newton_t, solve_momentum_contact, start_flow
   use momentum_problem, only: film_flow_t, momentum_problem_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: missing_reason, solve_by_continuation

   !> Newton steps at most, of the direct way and of one part of the way by continuation.
   integer, parameter :: direct_steps = 10, part_steps = 12
   !> First and smallest growth of delta^2 in a part, of its value.
   real(wp), parameter :: first_part = 0.25_wp, smallest_part = 1.0e-2_wp

contains

   !> Solves from `flow`, whose mean pressure is that of the level, to a step below `tolerance`;
   !> else from `reynolds`, the solution of the Reynolds equation. `newton%reached`: the largest
   !> share of delta^2 for which there is a solution, 1 with that of the problem. `newton` counts
   !> all steps.
   subroutine solve_by_continuation(newton, problem, level, flow, reynolds, tolerance)
      type(momentum_newton_t), intent(inout) :: newton
      type(momentum_problem_t), intent(inout) :: problem
      type(line_level_t), intent(inout) :: level
      type(film_flow_t), intent(inout) :: flow
      type(film_state_t), intent(in) :: reynolds
      real(wp), intent(in) :: tolerance
      type(film_state_t) :: state
      type(film_flow_t) :: last
      logical, allocatable :: is_held(:)
      real(wp) :: full, part
      integer :: steps

      newton%reached = 0.0_wp
      call solve_momentum_contact(newton, problem, level, flow, tolerance, direct_steps)
      if (newton%is_converged) newton%reached = 1.0_wp
      if (newton%is_converged) return
      steps = newton%steps
      full = problem%delta2
      part = first_part
      level%state = reynolds
      call take_film(level)
      problem%is_held = reynolds%pressure <= 0.0_wp
      problem%is_held([0, problem%n]) = .true.
      call start_flow(problem, level, flow, newton%terms)
      do while (newton%reached < 1.0_wp .and. part >= smallest_part)
         state = level%state
         last = flow
         is_held = problem%is_held
         part = min(part, 1.0_wp - newton%reached)
         problem%delta2 = (newton%reached + part)*full
         call solve_momentum_contact(newton, problem, level, flow, tolerance, part_steps)
         steps = steps + newton%steps
         if (newton%is_converged) then
            newton%reached = newton%reached + part
         else
            part = 0.5_wp*part
            level%state = state
            flow = last
            problem%is_held = is_held
         end if
      end do
      problem%delta2 = full
      newton%steps = steps
   end subroutine solve_by_continuation

   !> Why there is no solution: none is looked for, with `stress_rise`, T_max, at 1 or above, or how
   !> far the continuation came.
   pure function missing_reason(newton, stress_rise) result(reason)
      type(momentum_newton_t), intent(in) :: newton
      real(wp), intent(in) :: stress_rise
      character(:), allocatable :: reason

      if (stress_rise < 1.0_wp) then
         reason = 'no solution of the full momentum equations found in '//to_text(newton%steps) &
            //' Newton steps: with slopes growing from those of a thin film '//'it is lost at ' &
            //to_text(100*sqrt(newton%reached), 2)//' % of b/R (T_max '//to_text(stress_rise, 2) &
            //'); more intervals or layers may keep it'
      else
         reason = 'no solution of the full momentum equations: shear stress rises with '// &
            'pressure by '//to_text(stress_rise, 2)//' (T_max); where that comes to 1 the '// &
            'equations change their type, and none is looked for'
      end if
   end function missing_reason

end module momentum_continuation

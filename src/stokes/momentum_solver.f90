!> From a solution of the Reynolds equation to one of the full momentum equations on the same grid.
module momentum_solver
   use errors, only: error_t
   use film_fields, only: film_fields_t, stress_rise, take_fields
   use film_state, only: film_state_t
   use iteration_report, only: phase_steady, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use momentum_continuation, only: missing_reason, solve_by_continuation
   use momentum_newton, only: momentum_newton_t, start_flow
   use momentum_problem, only: film_flow_t, momentum_problem_t
   use momentum_setup, only: pose_momentum, pose_level, walls_t
   use quantities, only: h_central, h_min, p_max
   use limit_search, only: film_limits
   use state_output, only: fill_properties
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_film_momentum

   !> Bound on the last step.
   real(wp), parameter :: tolerance = 1.0e-9_wp

contains

   !> Solves the momentum equations on `layers` layers from `state`, a converged steady solution of
   !> the Reynolds equation by the kappa scheme. `state` becomes that solution, with the mean
   !> pressure across the film; without one it stays, and the report says that and why. Error: no
   !> memory, or a singular matrix.
   subroutine solve_film_momentum(contact, walls, layers, state, fields, report, error)
      type(line_contact_t), intent(in) :: contact
      type(walls_t), intent(in) :: walls
      integer, intent(in) :: layers
      type(line_state_t), intent(inout) :: state
      type(film_fields_t), intent(out) :: fields
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      type(line_level_t), target :: level
      type(momentum_problem_t), target :: problem
      type(film_flow_t), target :: flow
      type(momentum_newton_t), target :: newton
      type(film_state_t) :: reynolds
      real(wp) :: start

      start = wall_seconds()
      call pose_level(contact, state, level, error)
      if (allocated(error)) return
      call pose_momentum(problem, contact, walls, level, layers)
      call start_flow(problem, level, flow, newton%terms)
      fields%stress_rise = stress_rise(problem, newton%terms)
      fields%reynolds_pressure = state%pressure
      fields%reynolds_film = state%film_thickness
      reynolds = level%state
      if (fields%stress_rise < 1.0_wp) call solve_by_continuation(newton, problem, level, flow, &
         reynolds, tolerance)
      report%converged = newton%is_converged
      fields%steps = newton%steps
      fields%factorisations = newton%factorisations
      fields%linear_iterations = newton%linear_iterations
      if (newton%is_converged) then
         call take_fields(problem, flow, newton%terms, fields)
         call copy_state(contact, level, state, fields)
      else
         report%reason = missing_reason(newton, fields%stress_rise)
      end if
      report%wall_seconds = report%wall_seconds + wall_seconds() - start
      report%phase_seconds(phase_steady) = report%phase_seconds(phase_steady) &
         + wall_seconds() - start
   end subroutine solve_film_momentum

   !> Takes pressure, film and H0 over into `state`, and the differences from what it was.
   pure subroutine copy_state(contact, level, state, fields)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      type(line_state_t), intent(inout) :: state
      type(film_fields_t), intent(inout) :: fields
      type(line_summary_t) :: before, after

      before = summary_of(state)
      state%pressure(:) = level%state%pressure
      state%film_thickness(:) = level%state%film
      state%rigid_displacement = level%state%rigid_displacement
      call fill_properties(contact, state)
      state%limits = film_limits(contact%fluid, contact%lambda, contact%slide_to_roll, level%dx, &
         state%pressure, state%film_thickness)
      after = summary_of(state)
      fields%h_min = relative(h_min)
      fields%h_central = relative(h_central)
      fields%p_max = relative(p_max)
      fields%pressure_change = maxval(abs(state%pressure - fields%reynolds_pressure))

   contains

      !> Relative difference of a quantity.
      pure function relative(quantity)
         integer, intent(in) :: quantity
         real(wp) :: relative

         relative = after%of(quantity)%value/before%of(quantity)%value - 1
      end function relative

   end subroutine copy_state

end module momentum_solver

!> Poses the full momentum equations of the film of a line contact on a level of its solution, and
!> solves them from a first approximation, by Newton's method or, if that fails, by continuation
!> from the solution of the Reynolds equation.
!>
!> delta^2, the square of the slope scale, grows from 0, where the solution is that of the Reynolds
!> equation, to its value; each solution is the first approximation of the next.
module momentum_solver
   use eyring, only: eyring_t
   use features, only: surface_height
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t, set_film
   use film_state, only: film_state_t
   use momentum_newton, only: momentum_newton_t, solve_momentum_contact, start_flow
   use momentum_problem, only: film_flow_t, momentum_problem_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: missing_reason, pose_momentum, set_walls, solve_by_continuation, walls_t

   !> Data missing in a dimensionless contact: delta = b/R, the share R/R1 of surface 1, the lower
   !> one, in the curvature, and rho_0 u_s^2/p_h (0: without inertia).
   type :: walls_t
      real(wp) :: delta = 0.0_wp
      real(wp) :: curvature_share = 0.5_wp
      real(wp) :: inertia = 0.0_wp
   end type walls_t

   !> Most Newton steps, without continuation and in one part of it.
   integer, parameter :: direct_steps = 10, part_steps = 12
   !> First and smallest growth of delta^2 in a part, relative to its value.
   real(wp), parameter :: first_part = 0.25_wp, smallest_part = 1.0e-2_wp

contains

   !> Poses the problem on `layers` layers for the steady contact posed on `level`, whose pressure
   !> is the first approximation: it decides which columns are cavitated.
   !>
   !> Each body has its curvature and roughness, that of T = 0, and half of the deformation: z1 =
   !> -H/2 + (1/2 - R/R1) X^2/2 + (Psi_1 - Psi_2)/2.
   pure subroutine pose_momentum(problem, contact, walls, level, layers)
      type(momentum_problem_t), intent(out) :: problem
      type(line_contact_t), intent(in) :: contact
      type(walls_t), intent(in) :: walls
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: layers

      problem%n = level%n
      problem%layers = layers
      problem%dx = level%dx
      problem%dz = 1.0_wp/layers
      problem%lambda = level%lambda
      problem%kappa = level%lambda/6
      problem%delta2 = walls%delta**2
      problem%inertia = walls%inertia
      problem%speed = 0.5_wp*[contact%surface_1%speed, contact%surface_2%speed]
      problem%fluid = level%fluid
      if (allocated(level%fluid%rheology)) then
         select type (law => level%fluid%rheology)
         type is (eyring_t)   ! its Sigma is the wall stress over tau_0
            problem%shear_scale = law%sigma_scale*level%lambda/3
         class default
            error stop 'momentum equations: a law without its case'
         end select
      end if
      problem%lower_share = -0.5_wp
      allocate (problem%lower_shape(0:level%n), problem%wave_slope(level%n, 2))
      call set_walls(problem, walls, level, reshape([surface_height(contact%surface_1, level%x, &
         0.0_wp), surface_height(contact%surface_2, level%x, 0.0_wp)], [level%n + 1, 2]))
      allocate (problem%held_pressure(0:level%n), problem%old%film(0:level%n), &
         problem%old%lower(0:level%n), problem%old%mass(layers, 0:level%n), source=0.0_wp)
      allocate (problem%is_held(0:level%n), source=level%state%pressure <= 0.0_wp)
      problem%is_held([0, level%n]) = .true.
      problem%held_pressure(0) = level%state%pressure(0)
   end subroutine pose_momentum

   !> Sets the walls from `heights` Psi_1 and Psi_2 at all nodes.
   pure subroutine set_walls(problem, walls, level, heights)
      type(momentum_problem_t), intent(inout) :: problem
      type(walls_t), intent(in) :: walls
      type(line_level_t), intent(in) :: level
      real(wp), intent(in) :: heights(0:level%n, 2)
      integer :: n

      n = level%n
      problem%lower_shape(:) = (0.5_wp - walls%curvature_share)*0.5_wp*level%x**2 &
         + 0.5_wp*(heights(:, 1) - heights(:, 2))
      problem%wave_slope(:, 1) = (heights(1:, 1) - heights(:n - 1, 1))/level%dx
      problem%wave_slope(:, 2) = (heights(:n - 1, 2) - heights(1:, 2))/level%dx
   end subroutine set_walls

   !> Solves from `flow`, whose mean pressure is that of the level, to a step below `tolerance`; if
   !> that fails, by continuation from `reynolds`, the solution of the Reynolds equation.
   !> `newton%reached`: largest share of delta^2 with a solution, 1 for the problem itself. `newton`
   !> counts all steps.
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
      call set_film(level)
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

   !> Reason for no solution: none is searched, as `stress_rise`, T_max, is 1 or above, or how far
   !> the continuation came.
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

end module momentum_solver

!> Poses the momentum equations of the film of a line contact on a level of its solution.
module momentum_setup
   use errors, only: error_t
   use eyring, only: eyring_t
   use features, only: surface_height
   use film_equation, only: carried_load, set_film
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: new_level_of
   use line_level, only: line_level_t, set_plain_problem
   use line_state, only: line_state_t
   use lubricant, only: fluid_t
   use momentum_problem, only: momentum_problem_t
   implicit none (type, external)
   private

   public :: pose_momentum, set_walls, pose_level, walls_t

   !> Data missing in a dimensionless contact: delta = b/R, the share R/R1 of surface 1, the lower
   !> one, in the curvature, and rho_0 u_s^2/p_h (0: without inertia).
   type :: walls_t
      real(wp) :: delta = 0.0_wp
      real(wp) :: curvature_share = 0.5_wp
      real(wp) :: inertia = 0.0_wp
   end type walls_t

contains

   !> Sets up the level of a state: its pressure, film and H0, and the load of its pressure.
   subroutine pose_level(contact, state, level, error)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(line_level_t), intent(inout) :: level
      type(error_t), allocatable, intent(out) :: error

      call new_level_of(contact, size(state%x) - 1, level, error)
      if (allocated(error)) return
      call set_plain_problem(level, state%roughness_1 + state%roughness_2)
      level%is_kappa = .true.
      level%state%pressure(:) = state%pressure
      level%state%rigid_displacement = state%rigid_displacement
      ! a tail in front of the inlet keeps its load
      level%rhs_load = carried_load(level)
      call set_film(level)
   end subroutine pose_level

   !> Poses the problem on `layers` layers for the steady contact posed on `level`, whose pressure
   !> is the first approximation: it decides which columns are cavitated.
   !>
   !> Each body has its curvature and roughness, and half of the deformation: z1 = -H/2 + (1/2 -
   !> R/R1) X^2/2 + (Psi_1 - Psi_2)/2. `heights` are Psi_1 and Psi_2 at the nodes (0:n, 2), by
   !> default those of the contact at T = 0.
   pure subroutine pose_momentum(problem, contact, walls, level, layers, heights)
      type(momentum_problem_t), intent(out) :: problem
      type(line_contact_t), intent(in) :: contact
      type(walls_t), intent(in) :: walls
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: layers
      real(wp), intent(in), optional :: heights(0:, :)

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
      problem%shear_scale = eyring_scale(level%fluid, level%lambda)
      problem%lower_share = -0.5_wp
      allocate (problem%lower_shape(0:level%n), problem%wave_slope(level%n, 2))
      if (present(heights)) then
         call set_walls(problem, walls, level, heights)
      else
         call set_walls(problem, walls, level, reshape([surface_height(contact%surface_1, level%x, &
            0.0_wp), surface_height(contact%surface_2, level%x, 0.0_wp)], [level%n + 1, 2]))
      end if
      allocate (problem%held_pressure(0:level%n), source=0.0_wp)
      allocate (problem%is_held(0:level%n), source=level%state%pressure <= 0.0_wp)
      problem%is_held([0, level%n]) = .true.
      problem%held_pressure(0) = level%state%pressure(0)
   end subroutine pose_momentum

   !> mu_0 u_s/(tau_0 h_ref) of Eyring's law, the only other one of the momentum equations; 0 for a
   !> Newtonian oil.
   pure real(wp) function eyring_scale(fluid, lambda) result(scale)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda

      scale = 0.0_wp
      if (.not. allocated(fluid%rheology)) return
      select type (law => fluid%rheology)
      type is (eyring_t)
         scale = law%sigma_scale*lambda/3   ! Sigma is the wall stress over tau_0
      class default
         error stop 'momentum equations: a law without its case'
      end select
   end function eyring_scale

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

end module momentum_setup

!> The time steps of a line contact by the full momentum equations of the film, beside those of the
!> Reynolds equation: the same steps, grid and surfaces, with its own history of H and rho H.
!>
!> It starts from the smooth steady film of the full equations, which the surfaces then enter as
!> they enter that of the Reynolds equation. Every step begins with its last solution and what the
!> Reynolds equation has changed since; with delta = 0 it is the march of the Reynolds equation.
module momentum_march
   use errors, only: error_t
   use film_equation, only: take_film
   use film_fields, only: film_fields_t, stress_rise, take_fields
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use line_state, only: line_state_t
   use momentum_continuation, only: missing_reason, solve_by_continuation
   use momentum_newton, only: momentum_newton_t, start_flow
   use momentum_problem, only: film_flow_t, mean_pressure, momentum_problem_t
   use momentum_rows, only: evaluate_rows, momentum_rows_t
   use momentum_setup, only: pose_momentum, set_walls, take_level, walls_t
   use time_part, only: follower_t, time_part_t
   implicit none (type, external)
   private

   public :: momentum_march_t

   !> Bounds on the last Newton step, of the start and of a time step.
   real(wp), parameter :: start_tolerance = 1.0e-9_wp, step_tolerance = 1.0e-6_wp

   !> What the equations need of an old time: H, z1 (0:n), rho H of the layers (layers, 0:n).
   type :: past_t
      real(wp), allocatable :: film(:), lower(:), mass(:, :)
   end type past_t

   !> What a film has above that of the Reynolds equation at the same time: P, U above that of the
   !> thin film with its P and H, V and H0.
   type :: excess_t
      real(wp), allocatable :: p(:, :), u(:, :), v(:, :)
      real(wp) :: rigid_displacement = 0.0_wp
   end type excess_t

   !> Where the march stands. The pressure of its `state` is the mean across the film.
   type, extends(follower_t) :: momentum_march_t
      type(walls_t) :: walls
      integer :: layers = 0
      !> Largest T_max so far.
      real(wp) :: stress_rise = 0.0_wp
      !> Time steps, or parts of them, with their Newton steps: all, and most for one.
      integer :: solutions = 0, steps = 0, most_steps = 0
      type(line_level_t), private :: level
      type(momentum_problem_t), private :: problem
      type(film_flow_t), private :: flow
      type(momentum_newton_t), private :: newton
      type(film_state_t), private :: reynolds
      type(past_t), private :: past(2)
      !> Of the last two films, and the length of the step between them.
      type(excess_t), private :: excess(2)
      real(wp), private :: length = 0.0_wp
   contains
      !> The smooth steady film, which the surfaces enter.
      procedure :: begin
      !> One part of a time step.
      procedure :: advance
      !> The fields of the present film.
      procedure :: fields => present_fields
   end type momentum_march_t

contains

   !> From `state`, that of the Reynolds equation at T = 0. Error: no memory, or no solution.
   subroutine begin(self, contact, state, reason)
      class(momentum_march_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      character(:), allocatable, intent(out) :: reason
      type(line_state_t) :: smooth
      type(error_t), allocatable :: error
      real(wp) :: heights(size(state%x), 2)

      smooth = state
      smooth%roughness_1 = 0.0_wp
      smooth%roughness_2 = 0.0_wp
      call take_level(contact, smooth, self%level, error)
      if (allocated(error)) then
         reason = error%message
         return
      end if
      self%reynolds = self%level%state
      call pose_momentum(self%problem, contact, self%walls, self%level, self%layers)
      heights = 0.0_wp
      call set_walls(self%problem, self%walls, self%level, heights)
      call start_flow(self%problem, self%level, self%flow, self%newton%terms)
      call solve(self, start_tolerance, reason)
      if (allocated(reason)) return
      heights(:, 1) = state%roughness_1
      heights(:, 2) = state%roughness_2
      self%flow%u = self%flow%u - self%newton%terms%reynolds%u
      call move_walls(self, heights)
      associate (n => self%level%n, m => self%layers)
         allocate (self%problem%past_film(0:n), self%problem%past_lower(0:n), &
            self%problem%past_mass(m, 0:n), source=0.0_wp)
      end associate
      call remember(self)
   end subroutine begin

   !> Goes on by a part of a time step that the Reynolds equation has done.
   subroutine advance(self, part, reason)
      class(momentum_march_t), intent(inout) :: self
      type(time_part_t), intent(in) :: part
      character(:), allocatable, intent(out) :: reason

      associate (problem => self%problem, level => self%level, older => self%past(2), &
         old => self%past(1))
         level%inverse_time_step = part%weights(1)
         problem%half_rate = 0.5_wp*part%weights(1)
         problem%past_film(:) = -0.5_wp*part%weights(2)*old%film
         problem%past_lower(:) = -0.5_wp*part%weights(2)*old%lower
         problem%past_mass(:, :) = -0.5_wp*part%weights(2)*old%mass
         if (allocated(older%film)) then
            problem%past_film = problem%past_film - 0.5_wp*part%weights(3)*older%film
            problem%past_lower = problem%past_lower - 0.5_wp*part%weights(3)*older%lower
            problem%past_mass = problem%past_mass - 0.5_wp*part%weights(3)*older%mass
         end if
         self%reynolds = part%state
         ! what a tail in front of the inlet carries stays with it
         level%rhs_load = level%dx*sum(part%state%pressure)
         problem%held_pressure(0) = part%state%pressure(0)
      end associate
      call foretell(self, part%length)
      call move_walls(self, part%heights)
      self%newton%most_further_steps = 1
      call solve(self, step_tolerance, reason)
      if (.not. allocated(reason)) call remember(self)
      self%length = part%length
   end subroutine advance

   !> First approximation at the end of a step of this length: the film of the Reynolds equation and
   !> what the line through the last two foretells to be above it. U waits for the new film.
   subroutine foretell(self, length)
      class(momentum_march_t), intent(inout) :: self
      real(wp), intent(in) :: length
      real(wp) :: ahead
      integer :: i

      associate (problem => self%problem, level => self%level, flow => self%flow, &
         last => self%excess(1), older => self%excess(2))
         flow%p(:, :) = last%p + spread(self%reynolds%pressure, 1, self%layers)
         flow%u(:, :) = last%u
         flow%v(:, :) = last%v
         level%state%rigid_displacement = self%reynolds%rigid_displacement &
            + last%rigid_displacement
         if (allocated(older%p)) then
            ahead = length/self%length
            flow%p = flow%p + ahead*(last%p - older%p)
            flow%u = flow%u + ahead*(last%u - older%u)
            flow%v = flow%v + ahead*(last%v - older%v)
            level%state%rigid_displacement = level%state%rigid_displacement &
               + ahead*(last%rigid_displacement - older%rigid_displacement)
         end if
         do i = 0, level%n
            problem%is_held(i) = self%reynolds%pressure(i) <= 0.0_wp .or. i == 0
            if (problem%is_held(i)) flow%p(:, i) = problem%held_pressure(i)
         end do
      end associate
   end subroutine foretell

   !> The walls take these heights, the film follows, and the velocities, of which `flow` holds what
   !> they are above those of the thin film.
   subroutine move_walls(self, heights)
      class(momentum_march_t), intent(inout) :: self
      real(wp), intent(in) :: heights(:, :)
      type(momentum_rows_t) :: rows

      call set_walls(self%problem, self%walls, self%level, heights)
      associate (level => self%level, flow => self%flow, terms => self%newton%terms)
         level%rhs_film(:) = 0.5_wp*level%x**2 - sum(heights, 2)
         level%state%pressure(:) = mean_pressure(flow)
         call take_film(level)
         flow%film(:) = level%state%film
         if (any(flow%film <= 0.0_wp)) return
         call evaluate_rows(self%problem, flow, terms, rows)
         flow%u = flow%u + terms%reynolds%u
      end associate
   end subroutine move_walls

   !> Newton's method; `reason` why it found no solution.
   subroutine solve(self, tolerance, reason)
      class(momentum_march_t), intent(inout) :: self
      real(wp), intent(in) :: tolerance
      character(:), allocatable, intent(out) :: reason
      real(wp) :: rise

      if (any(self%flow%film <= 0.0_wp)) then
         reason = 'full momentum equations: the film is closed where the step begins'
         return
      end if
      rise = stress_rise(self%problem, self%newton%terms)
      self%stress_rise = max(self%stress_rise, rise)
      self%newton%is_converged = .false.
      if (rise < 1.0_wp) call solve_by_continuation(self%newton, self%problem, self%level, &
         self%flow, self%reynolds, tolerance)
      if (.not. self%newton%is_converged) reason = missing_reason(self%newton, rise)
      associate (newton => self%newton)
         self%steps = self%steps + newton%steps
         if (.not. allocated(self%past(1)%film)) return
         self%solutions = self%solutions + 1
         self%most_steps = max(self%most_steps, newton%steps)
      end associate
   end subroutine solve

   !> The present film enters the history.
   subroutine remember(self)
      class(momentum_march_t), intent(inout) :: self

      if (allocated(self%past(1)%film)) then
         self%past(2) = self%past(1)
         ! that of T = 0 foretells nothing: the surfaces have entered it
         if (self%length > 0.0_wp) self%excess(2) = self%excess(1)
      end if
      associate (excess => self%excess(1), flow => self%flow)
         excess%p = flow%p - spread(self%reynolds%pressure, 1, self%layers)
         excess%u = flow%u - self%newton%terms%reynolds%u
         excess%v = flow%v
         excess%rigid_displacement = self%level%state%rigid_displacement &
            - self%reynolds%rigid_displacement
      end associate
      associate (past => self%past(1), film => self%flow%film, p => self%flow%p)
         past%film = film
         past%lower = self%problem%lower_share*film + self%problem%lower_shape
         past%mass = self%newton%terms%stresses%rho*spread(film, 1, self%layers)
         self%pressure_variation = maxval(maxval(p, 1) - minval(p, 1))
      end associate
      self%state = self%level%state
   end subroutine remember

   !> The fields of the present film, and the pressure and film of the Reynolds equation.
   function present_fields(self) result(fields)
      class(momentum_march_t), intent(in) :: self
      type(film_fields_t) :: fields

      call take_fields(self%problem, self%flow, self%newton%terms, fields)
      fields%reynolds_pressure = self%reynolds%pressure
      fields%reynolds_film = self%reynolds%film
      fields%stress_rise = self%stress_rise
      fields%steps = self%steps
      fields%factorisations = self%newton%factorisations
      fields%linear_iterations = self%newton%linear_iterations
   end function present_fields

end module momentum_march

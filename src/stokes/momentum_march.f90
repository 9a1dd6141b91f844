!> The full momentum equations of the film of a line contact, after the Reynolds equation: at rest,
!> or in the same time steps on the same grid and surfaces, with another history of H and rho H.
!>
!> A march starts from the smooth steady film of the full equations, which the surfaces then enter
!> as they enter that of the Reynolds equation. Every step begins with its last solution plus the
!> change of the Reynolds solution since; with delta = 0 it is the march of the Reynolds equation.
module momentum_march
   use errors, only: error_t
   use film_fields, only: film_fields_t, stress_rise, copy_fields
   use film_shear, only: film_limits
   use iteration_report, only: phase_steady, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, without_surfaces
   use line_hierarchy, only: new_level_of, roughness_at
   use line_level, only: carried_load, line_level_t, set_film, set_plain_problem
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use momentum_solver, only: missing_reason, pose_momentum, set_walls, solve_by_continuation, &
      walls_t
   use momentum_newton, only: momentum_newton_t, solve_momentum_contact, start_flow
   use momentum_problem, only: film_flow_t, mean_pressure, momentum_problem_t
   use momentum_rows, only: evaluate_rows, momentum_rows_t
   use listener, only: follower_t
   use march_state, only: excess_t, max_excesses, momentum_history_t, next_count, &
      prediction_weights, time_part_t
   use quantities, only: h_central, h_min, p_max
   use state_output, only: fill_properties
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: momentum_march_t

   !> Bounds on the last Newton step, of a contact at rest and of a time step; the latter also on
   !> the predicted remainder after it.
   real(wp), parameter :: rest_tolerance = 1.0e-9_wp, step_tolerance = 1.0e-6_wp
   !> Most Newton steps from a first approximation by the history.
   integer, parameter :: direct_steps = 5

   !> State of the march. The pressure of its `state` is the mean across the film. Do not copy it
   !> once it has begun: its level owns FFT plans.
   type, extends(follower_t) :: momentum_march_t
      type(walls_t) :: walls
      integer :: layers = 0
      !> Its history and its cost.
      type(momentum_history_t) :: history
      type(line_level_t), private :: level
      type(momentum_problem_t), private :: problem
      type(film_flow_t), private :: flow
      type(momentum_newton_t), private :: newton
   contains
      procedure :: advance, kept, solve_steady, start
      procedure :: fields => present_fields
   end type momentum_march_t

contains

   !> Solves the momentum equations of a contact at rest from `state`, a converged solution of the
   !> Reynolds equation by the kappa scheme. `state` becomes the solution, with the mean pressure
   !> across the film; without one it stays, and the report gives the reason. Error: no memory.
   subroutine solve_steady(self, contact, state, fields, report, error)
      class(momentum_march_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(inout) :: state
      type(film_fields_t), intent(out) :: fields
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: reason
      real(wp) :: start

      start = wall_seconds()
      call pose(self, contact, state, error)
      if (allocated(error)) return
      call solve(self, rest_tolerance, reason)
      self%history%steps = self%newton%steps
      report%converged = .not. allocated(reason)
      if (report%converged) then
         fields = self%fields()
         call copy_state()
      else
         report%reason = reason
      end if
      report%cost%wall_seconds = report%cost%wall_seconds + wall_seconds() - start
      report%cost%phase_seconds(phase_steady) = report%cost%phase_seconds(phase_steady) &
         + wall_seconds() - start

   contains

      !> Copies pressure, film and H0 into `state`, and sets the differences from the old ones.
      subroutine copy_state()
         type(line_summary_t) :: before, after
         integer, parameter :: compared(3) = [h_min, h_central, p_max]

         before = summary_of(state)
         state%pressure(:) = self%level%state%pressure
         state%film_thickness(:) = self%level%state%film
         state%rigid_displacement = self%level%state%rigid_displacement
         call fill_properties(contact, state)
         state%limits = film_limits(contact%fluid, contact%lambda, contact%slide_to_roll, &
            self%level%x, state%pressure, state%film_thickness)
         after = summary_of(state)
         associate (changes => after%of(compared)%value/before%of(compared)%value - 1)
            fields%h_min = changes(1)
            fields%h_central = changes(2)
            fields%p_max = changes(3)
         end associate
         fields%pressure_change = maxval(abs(state%pressure - fields%reynolds_pressure))
      end subroutine copy_state

   end subroutine solve_steady

   !> Begins from `state`, that of the Reynolds equation at T = 0, or resumes from `earlier`, with
   !> `state` that of its time. Error: no memory, or no solution.
   subroutine start(self, contact, state, reason)
      class(momentum_march_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      character(:), allocatable, intent(out) :: reason
      type(error_t), allocatable :: error
      real(wp) :: heights(size(state%x), 2)

      call pose(self, without_surfaces(contact), state, error)
      if (allocated(error)) then
         reason = error%message
         return
      end if
      if (allocated(self%earlier)) then
         call resume(self)
         deallocate (self%earlier)
         return
      end if
      call solve(self, rest_tolerance, reason)
      self%history%steps = self%newton%steps
      if (allocated(reason)) return
      self%newton%largest_rest = step_tolerance
      heights(:, 1) = state%roughness_1
      heights(:, 2) = state%roughness_2
      self%flow%u = self%flow%u - self%newton%terms%reynolds%u
      call move_walls(self, heights)
      call remember(self)
   end subroutine start

   !> Poses the contact at T = 0; first approximation is the pressure of `state`. Error: no memory.
   subroutine pose(self, contact, state, error)
      type(momentum_march_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(error_t), allocatable, intent(out) :: error

      associate (level => self%level)
         call new_level_of(contact, size(state%x) - 1, level, error)
         if (allocated(error)) return
         call set_plain_problem(level, roughness_at(contact, level, 0.0_wp))
         level%is_kappa = .true.
         level%state%pressure(:) = state%pressure
         level%state%rigid_displacement = state%rigid_displacement
         ! a tail in front of the inlet keeps its load
         level%rhs_load = carried_load(level)
         call set_film(level)
         self%history%reynolds = level%state
         call pose_momentum(self%problem, contact, self%walls, level, self%layers)
         call start_flow(self%problem, level, self%flow, self%newton%terms)
      end associate
   end subroutine pose

   !> Returns the state after a step.
   function kept(self) result(history)
      class(momentum_march_t), intent(in) :: self
      type(momentum_history_t) :: history

      history = self%history
      history%layers = self%layers
      history%factorisations = self%newton%factorisations
      history%linear_iterations = self%newton%linear_iterations
      history%flow = self%flow%excess_t
      history%flow%rigid_displacement = self%level%state%rigid_displacement
      history%film = self%flow%film
      history%half_rate = self%problem%half_rate
      history%made_of_old = self%problem%old
   end function kept

   !> Goes on from `earlier`.
   subroutine resume(self)
      class(momentum_march_t), intent(inout) :: self
      type(momentum_rows_t) :: rows

      self%history = self%earlier
      self%newton%largest_rest = step_tolerance
      associate (problem => self%problem, level => self%level, flow => self%flow, &
         history => self%earlier)
         self%newton%factorisations = history%factorisations
         self%newton%linear_iterations = history%linear_iterations
         problem%half_rate = history%half_rate
         problem%old = history%made_of_old
         call set_walls(problem, self%walls, level, history%heights)
         flow%excess_t = history%flow
         flow%film(:) = history%film
         level%state%pressure(:) = mean_pressure(flow)
         level%state%film(:) = history%film
         level%state%rigid_displacement = history%flow%rigid_displacement
         call evaluate_rows(problem, flow, self%newton%terms, rows)
      end associate
      call show(self)
   end subroutine resume

   !> Advances by one part of a step of the Reynolds equation; `reason`: no solution.
   subroutine advance(self, part, reason)
      class(momentum_march_t), intent(inout) :: self
      type(time_part_t), intent(in) :: part
      character(:), allocatable, intent(out) :: reason
      integer :: count, steps

      associate (problem => self%problem, level => self%level, older => self%history%past(2), &
         old => self%history%past(1))
         level%inverse_time_step = part%weights(1)
         problem%half_rate = 0.5_wp*part%weights(1)
         problem%old%film = -0.5_wp*part%weights(2)*old%film
         problem%old%lower = -0.5_wp*part%weights(2)*old%lower
         problem%old%mass = -0.5_wp*part%weights(2)*old%mass
         if (self%history%times > 1) then
            problem%old%film = problem%old%film - 0.5_wp*part%weights(3)*older%film
            problem%old%lower = problem%old%lower - 0.5_wp*part%weights(3)*older%lower
            problem%old%mass = problem%old%mass - 0.5_wp*part%weights(3)*older%mass
         end if
         self%history%reynolds = part%state
         ! a tail in front of the inlet keeps its load
         level%rhs_load = level%dx*sum(part%state%pressure)
         problem%held_pressure(0) = part%state%pressure(0)
      end associate
      self%newton%most_further_steps = 1
      count = min(self%history%best_count, self%history%films)
      steps = 0
      do
         call predict(self, part%length, count)
         call move_walls(self, part%heights)
         if (count == 0) then
            call solve(self, step_tolerance, reason)
         else
            call solve_directly(self)
         end if
         steps = steps + self%newton%steps
         if (count == 0 .or. self%newton%is_converged) exit
         count = 0
      end do
      associate (past => self%history)
         past%steps = past%steps + steps
         past%solutions = past%solutions + 1
         past%most_steps = max(past%most_steps, steps)
         past%longer = past%longer + merge(1, 0, steps > 3)
      end associate
      if (.not. allocated(reason)) call remember(self, part%length)
   end subroutine advance

   !> Sets the first approximation at the end of a step of this length: the film of the Reynolds
   !> equation plus the excess predicted by the last `count` films; of U only that excess.
   subroutine predict(self, length, count)
      class(momentum_march_t), intent(inout) :: self
      real(wp), intent(in) :: length
      integer, intent(in) :: count
      real(wp) :: weights(max_excesses)
      integer :: i, k

      associate (problem => self%problem, level => self%level, flow => self%flow, &
         past => self%history)
         weights = prediction_weights(past%lengths, past%films, length, count)
         flow%p(:, :) = spread(self%history%reynolds%pressure, 1, self%layers)
         flow%u(:, :) = 0.0_wp
         flow%v(:, :) = 0.0_wp
         level%state%rigid_displacement = self%history%reynolds%rigid_displacement
         do k = 1, count
            associate (excess => past%excess(k))
               flow%p = flow%p + weights(k)*excess%p
               flow%u = flow%u + weights(k)*excess%u
               flow%v = flow%v + weights(k)*excess%v
               level%state%rigid_displacement = level%state%rigid_displacement &
                  + weights(k)*excess%rigid_displacement
            end associate
         end do
         do i = 0, level%n
            problem%is_held(i) = self%history%reynolds%pressure(i) <= 0.0_wp .or. i == 0
            if (problem%is_held(i)) flow%p(:, i) = problem%held_pressure(i)
         end do
      end associate
   end subroutine predict

   !> Moves the walls to these heights, then film and velocities; on entry `flow` holds the excess
   !> of U over that of the thin film.
   subroutine move_walls(self, heights)
      class(momentum_march_t), intent(inout) :: self
      real(wp), intent(in) :: heights(:, :)
      type(momentum_rows_t) :: rows

      call set_walls(self%problem, self%walls, self%level, heights)
      self%history%heights = heights
      associate (level => self%level, flow => self%flow, terms => self%newton%terms)
         level%rhs_film(:) = 0.5_wp*level%x**2 - sum(heights, 2)
         level%state%pressure(:) = mean_pressure(flow)
         call set_film(level)
         flow%film(:) = level%state%film
         if (any(flow%film <= 0.0_wp)) return
         call evaluate_rows(self%problem, flow, terms, rows)
         flow%u = flow%u + terms%reynolds%u
      end associate
   end subroutine move_walls

   !> Solves by Newton's method; `reason`: why there is no solution.
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
      self%history%stress_rise = max(self%history%stress_rise, rise)
      self%newton%is_converged = .false.
      if (rise < 1.0_wp) call solve_by_continuation(self%newton, self%problem, self%level, &
         self%flow, self%history%reynolds, tolerance)
      if (.not. self%newton%is_converged) reason = missing_reason(self%newton, rise)
   end subroutine solve

   !> Makes a few steps of Newton's method from a first approximation that may fail.
   subroutine solve_directly(self)
      class(momentum_march_t), intent(inout) :: self

      self%newton%is_converged = .false.
      self%newton%steps = 0
      if (any(self%flow%film <= 0.0_wp)) return
      if (.not. stress_rise(self%problem, self%newton%terms) < 1.0_wp) return
      call solve_momentum_contact(self%newton, self%problem, self%level, self%flow, &
         step_tolerance, direct_steps)
      if (self%newton%is_converged) self%history%stress_rise = max(self%history%stress_rise, &
         stress_rise(self%problem, self%newton%terms))
   end subroutine solve_directly

   !> Adds the present film to the history, at the end of a step of this length; without a length
   !> the march begins with it.
   subroutine remember(self, length)
      class(momentum_march_t), intent(inout) :: self
      real(wp), intent(in), optional :: length
      type(excess_t) :: excess
      integer :: k

      associate (past => self%history, flow => self%flow)
         excess%p = flow%p - spread(self%history%reynolds%pressure, 1, self%layers)
         excess%u = flow%u - self%newton%terms%reynolds%u
         excess%v = flow%v
         excess%rigid_displacement = self%level%state%rigid_displacement &
            - self%history%reynolds%rigid_displacement
         past%best_count = 1
         if (present(length)) past%best_count = next_count(past, excess, length)
         past%past(2) = past%past(1)
         past%times = min(past%times + 1, 2)
         past%past(1)%film = flow%film
         past%past(1)%lower = self%problem%lower_share*flow%film + self%problem%lower_shape
         past%past(1)%mass = self%newton%terms%stresses%rho*spread(flow%film, 1, self%layers)
         ! the film at T = 0 predicts only the first step: the surfaces have entered it
         if (past%films > 0 .and. past%lengths(1) > 0.0_wp) then
            do k = max_excesses, 2, -1
               past%excess(k) = past%excess(k - 1)
            end do
         else
            past%films = 0
         end if
         past%films = min(past%films + 1, max_excesses)
         if (present(length)) past%lengths = [length, past%lengths(:max_excesses - 2)]
         past%excess(1) = excess
      end associate
      call show(self)
   end subroutine remember

   !> Copies state and pressure variation of the present film to the public components.
   subroutine show(self)
      class(momentum_march_t), intent(inout) :: self

      associate (p => self%flow%p)
         self%pressure_variation = maxval(maxval(p, 1) - minval(p, 1))
      end associate
      self%state = self%level%state
   end subroutine show

   !> Fields of the present film, and pressure and film of the Reynolds equation.
   function present_fields(self) result(fields)
      class(momentum_march_t), intent(in) :: self
      type(film_fields_t) :: fields

      call copy_fields(self%problem, self%flow, self%newton%terms, fields)
      fields%reynolds_pressure = self%history%reynolds%pressure
      fields%reynolds_film = self%history%reynolds%film
      fields%stress_rise = self%history%stress_rise
      fields%newton_cost_t = self%newton%newton_cost_t
      fields%steps = self%history%steps
   end function present_fields

end module momentum_march

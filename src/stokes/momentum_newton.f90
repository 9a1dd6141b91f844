!> Newton's method for the elastic film with its full momentum equations.
!>
!> It starts from a solution of the Reynolds equation on the same level, and leaves there the mean
!> pressure across the film, the film and H0. In a step the velocities change as those of the thin
!> film, plus the linear change of their excess over these: their profiles are exponential in
!> pressure. Cavitation: columns whose mean pressure would become negative hold P = 0.
!>
!> The linear system of a step has no changes of U, V and P. With A the matrix of module
!> momentum_matrix, B and C the changes of the rows with the film and, by the Reynolds part, with
!> the mean pressure, E the mean over a column, and the film change h = eta - K p, the changes of
!> the mean pressure p and of H0, eta, solve
!>
!>     p + E A^-1 ( B (eta - K p) + C p ) = -E A^-1 r,   dX sum p = missing load.
!>
!> Preconditioned with the elastic Reynolds equation at the same pressure and film, whose rows are
!> those of E A^-1 once multiplied by its change with the pressure alone.
module momentum_newton
   use errors, only: error_t
   use gmres, only: gmres_t, krylov_system_t, solve_gmres
   use kinds, only: wp
   use line_level, only: line_level_t, load_defect, set_film
   use linear_systems, only: factor_band
   use march_state, only: newton_cost_t
   use momentum_matrix, only: fill_momentum, momentum_matrix_t, solve_momentum
   use momentum_problem, only: film_flow_t, mean_pressure, momentum_problem_t, new_flow
   use momentum_rows, only: column_mass, evaluate_rows, momentum_rows_t, momentum_terms_t, &
      rows_change
   use newton_work, only: evaluate_jacobian, new_jacobian, reynolds_jacobian_t
   use reynolds_part, only: change_of_profile, wedge_change
   use semiseparable_jacobian, only: semiseparable_jacobian_t
   implicit none (type, external)
   private

   public :: momentum_newton_t, solve_momentum_contact, start_flow

   !> Bounds of a step: of the mean pressure as a share of max(1, P), of the excess of U over that
   !> of the thin film, and of the film.
   real(wp), parameter :: largest_step = 0.3_wp, largest_speed_step = 0.5_wp, &
      smallest_film_share = 0.5_wp
   !> Shares of the right side left by GMRES, and by a Reynolds solution in its preconditioner.
   real(wp), parameter :: linear_share = 1.0e-4_wp, inner_share = 1.0e3_wp
   !> A full step below `settled` that is not ten times smaller than the one before has reached
   !> round-off.
   real(wp), parameter :: settled = 1.0e-8_wp, slow_share = 0.1_wp
   !> Share of the step before that a step leaves, with new factors.
   real(wp), parameter :: new_rate = 1.0e-2_wp
   integer, parameter :: max_halvings = 20
   !> The last filled column may fit neither state: filled its pressure would be negative, cavitated
   !> its balance of mass would require pressure. Once cavitated it stays so while that is below
   !> this share of the pressure upstream of it, and in any case after this many changes.
   real(wp), parameter :: smallest_rise = 1.0e-2_wp
   integer, parameter :: most_changes = 3

   !> Outcome of one solution, and what its steps work with.
   type, extends(newton_cost_t) :: momentum_newton_t
      logical :: is_converged = .false.
      !> Share of delta^2 that module momentum_solver has come to.
      real(wp) :: reached = 0.0_wp
      !> The factors are kept while this many more steps with them are expected to suffice.
      !> (Factoring costs as much as six steps.)
      integer :: most_further_steps = 5
      !> A solution also counts as found if the predicted remainder after a full step is below this:
      !> all further steps, if each leaves the same share of the one before as the last did.
      real(wp) :: largest_rest = 0.0_wp
      !> Largest change of P, U and H0 in the last full step.
      real(wp) :: last_step = huge(1.0_wp)
      type(momentum_terms_t) :: terms
      type(momentum_rows_t), private :: rows
      type(momentum_matrix_t), private :: matrix
      !> Cavitated columns of the factors, allocated while there are factors; share of the step
      !> before that a step with them leaves.
      logical, allocatable, private :: factored_set(:)
      real(wp), private :: rate = new_rate
   end type momentum_newton_t

   !> Unknowns p at nodes 1..n-1, then eta. Points to the data of one step; the rows of `reynolds`
   !> are divided by the elastic diagonal.
   type, extends(krylov_system_t) :: momentum_system_t
      type(line_level_t), pointer :: level => null()
      type(momentum_problem_t), pointer :: problem => null()
      type(film_flow_t), pointer :: flow => null()
      type(momentum_newton_t), pointer :: newton => null()
      type(reynolds_jacobian_t) :: reynolds
      type(semiseparable_jacobian_t) :: linear
      !> Storage of one product.
      type(film_flow_t) :: change
      type(momentum_rows_t) :: rows
   contains
      procedure :: multiply => multiply_eliminated
      procedure :: precondition => precondition_by_reynolds
   end type momentum_system_t

contains

   !> Sets the flow from the level's pressure and film by the Reynolds equation.
   pure subroutine start_flow(problem, level, flow, terms)
      type(momentum_problem_t), intent(in) :: problem
      type(line_level_t), intent(in) :: level
      type(film_flow_t), intent(out) :: flow
      type(momentum_terms_t), intent(out) :: terms
      type(momentum_rows_t) :: rows

      call new_flow(flow, problem)
      flow%film(:) = level%state%film
      flow%p(:, :) = spread(level%state%pressure, 1, problem%layers)
      call evaluate_rows(problem, flow, terms, rows)
      flow%u(:, :) = terms%reynolds%u
   end subroutine start_flow

   !> Solves from a first approximation in `flow`, whose mean pressure is that of the level. Ends
   !> when a full step is below `tolerance`, or at round-off, or after `max_steps`, or without
   !> convergence if the matrix is singular.
   subroutine solve_momentum_contact(newton, problem, level, flow, tolerance, max_steps)
      type(momentum_newton_t), intent(inout), target :: newton
      type(momentum_problem_t), intent(inout), target :: problem
      type(line_level_t), intent(inout), target :: level
      type(film_flow_t), intent(inout), target :: flow
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: max_steps
      type(error_t), allocatable :: error
      type(momentum_system_t) :: system
      type(gmres_t) :: krylov
      type(film_flow_t) :: step, plain
      real(wp), allocatable :: x(:)
      real(wp) :: mean(0:problem%n), previous, share
      integer :: changes(0:problem%n)
      logical :: has_new_set, is_new, is_solved

      newton%is_converged = .false.
      newton%steps = 0
      if (allocated(newton%rows%x)) deallocate (newton%rows%x, newton%rows%z, newton%rows%mass)
      previous = huge(1.0_wp)
      changes = 0
      if (allocated(newton%factored_set)) deallocate (newton%factored_set)
      call new_jacobian(system%reynolds, level%n)
      call new_flow(step, problem)
      call new_flow(plain, problem)
      call new_flow(system%change, problem)
      system%linear%tolerance = inner_share
      system%level => level
      system%problem => problem
      system%flow => flow
      system%newton => newton
      allocate (x(level%n))
      do while (newton%steps < max_steps)
         level%state%pressure(:) = mean_pressure(flow)
         call set_film(level)
         flow%film(:) = level%state%film
         call evaluate_jacobian(level, system%reynolds)
         call evaluate_rows(problem, flow, newton%terms, newton%rows)
         call choose_held(problem, level, column_mass(problem, flow, newton%terms), &
            system%reynolds, changes, has_new_set)
         if (has_new_set) call evaluate_rows(problem, flow, newton%terms, newton%rows)
         call renew_factors(newton, problem, flow, is_new, error)
         if (allocated(error)) return
         call solve_momentum(newton%matrix, problem, newton%rows, plain)
         mean = mean_pressure(plain)
         x(:level%n - 1) = -mean(1:level%n - 1)
         x(level%n) = load_defect(level)
         call solve_gmres(krylov, system, linear_share, x, is_solved)
         newton%linear_iterations = newton%linear_iterations + krylov%iterations
         if (.not. is_solved .and. krylov%iterations == 0) return
         call flow_change(system, x, step)
         step%u = -plain%u - step%u
         step%v = -plain%v - step%v
         step%p = -plain%p - step%p
         call apply_step(newton, problem, level, flow, step, x(level%n), share)
         if (share <= 0.0_wp) return
         newton%steps = newton%steps + 1
         if (.not. is_new) newton%rate = newton%last_step/previous
         if (newton%last_step*newton%rate**newton%most_further_steps > tolerance &
            .or. share < 1.0_wp) deallocate (newton%factored_set)
         newton%is_converged = share >= 1.0_wp .and. .not. has_new_set &
            .and. is_small(newton, previous, tolerance)
         if (newton%is_converged) exit
         previous = merge(newton%last_step, huge(1.0_wp), share >= 1.0_wp)
      end do
      level%state%pressure(:) = mean_pressure(flow)
      call set_film(level)
      flow%film(:) = level%state%film
      call evaluate_rows(problem, flow, newton%terms, newton%rows)
   end subroutine solve_momentum_contact

   !> Whether no step is needed after the last full one: it is small, or at round-off, or so is the
   !> remainder if further steps fall as it has fallen from the `previous` full one (huge: none).
   pure logical function is_small(newton, previous, tolerance)
      type(momentum_newton_t), intent(in) :: newton
      real(wp), intent(in) :: previous, tolerance

      associate (step => newton%last_step)
         is_small = step < tolerance .or. (step < settled .and. step > slow_share*previous)
         if (step < 0.5_wp*previous .and. previous < huge(1.0_wp)) is_small = is_small &
            .or. step**2/(previous - step) < newton%largest_rest
      end associate
   end function is_small

   !> Factors the matrix of the flow if there are no factors, or those of other cavitated columns.
   subroutine renew_factors(newton, problem, flow, is_new, error)
      type(momentum_newton_t), intent(inout) :: newton
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      logical, intent(out) :: is_new
      type(error_t), allocatable, intent(out) :: error

      if (allocated(newton%factored_set)) then
         if (any(newton%factored_set .neqv. problem%is_held)) deallocate (newton%factored_set)
      end if
      is_new = .not. allocated(newton%factored_set)
      if (.not. is_new) return
      call fill_momentum(newton%matrix, problem, flow, newton%terms)
      call factor_band(newton%matrix%band, error)
      if (allocated(error)) return
      newton%factorisations = newton%factorisations + 1
      newton%factored_set = problem%is_held
      newton%rate = new_rate
   end subroutine renew_factors

   !> Sets the columns that hold P = 0: where P + r/D <= 0, with r the mass balance of the column as
   !> the residual of the Reynolds equation and D < 0 its elastic diagonal. Divides the rows of
   !> `reynolds` by D. `changes` counts those of the columns (0:n).
   subroutine choose_held(problem, level, mass, reynolds, changes, has_new_set)
      type(momentum_problem_t), intent(inout) :: problem
      type(line_level_t), intent(in) :: level
      real(wp), intent(in) :: mass(0:)
      type(reynolds_jacobian_t), intent(inout) :: reynolds
      integer, intent(inout) :: changes(0:)
      logical, intent(out) :: has_new_set
      logical :: is_held
      real(wp) :: asked
      integer :: i

      has_new_set = .false.
      do i = 1, level%n - 1
         associate (d => reynolds%diagonal(i))
            asked = level%state%pressure(i) + 2*problem%lambda*mass(i)/d
            is_held = asked <= 0.0_wp
            if (problem%is_held(i) .and. changes(i) > 0) is_held = changes(i) >= most_changes .or. &
               asked <= smallest_rise*level%state%pressure(i - 1)
            if (is_held .neqv. problem%is_held(i)) changes(i) = changes(i) + 1
            has_new_set = has_new_set .or. (is_held .neqv. problem%is_held(i))
            problem%is_held(i) = is_held
            reynolds%by_film(:, i) = reynolds%by_film(:, i)/d
            reynolds%by_pressure(:, i) = reynolds%by_pressure(:, i)/d
         end associate
      end do
   end subroutine choose_held

   !> Applies the step, shortened until no pressure, velocity or film changes too much; share = 0 if
   !> that fails. `film_shift`: step of H0.
   subroutine apply_step(newton, problem, level, flow, step, film_shift, share)
      type(momentum_newton_t), intent(inout) :: newton
      type(momentum_problem_t), intent(in) :: problem
      type(line_level_t), intent(inout) :: level
      type(film_flow_t), intent(inout) :: flow, step
      real(wp), intent(in) :: film_shift
      real(wp), intent(out) :: share
      type(film_flow_t) :: old
      real(wp) :: mean(0:problem%n), d_mean(0:problem%n), d_film(0:problem%n), x(problem%n), &
         thin(problem%layers, problem%n), before(0:problem%n), h0
      type(momentum_rows_t) :: rows
      integer :: halving, i

      d_mean = mean_pressure(step)
      mean = mean_pressure(flow)
      x = [d_mean(1:problem%n - 1), film_shift]
      call film_change(level, x, d_film)
      call change_of_profile(newton%terms%reynolds%u_by, d_mean, d_film, thin)
      step%u = step%u - thin
      share = maxval(abs(d_mean)/max(1.0_wp, mean))
      if (.not. share + maxval(abs(step%u)) < huge(1.0_wp)) then
         share = 0.0_wp
         return
      end if
      share = min(1.0_wp, largest_step/max(share, largest_step), &
         largest_speed_step/max(maxval(abs(step%u)), largest_speed_step))
      old = flow
      before = level%state%film
      h0 = level%state%rigid_displacement
      do halving = 1, max_halvings
         flow%p = old%p + share*step%p
         mean = mean_pressure(flow)
         do i = 0, problem%n
            if (mean(i) < 0.0_wp .or. problem%is_held(i)) flow%p(:, i) = problem%held_pressure(i)
         end do
         level%state%pressure(:) = mean_pressure(flow)
         level%state%rigid_displacement = h0 + share*film_shift
         call set_film(level)
         if (all(level%state%film > smallest_film_share*before)) exit
         share = 0.5_wp*share
      end do
      if (halving > max_halvings) then
         share = 0.0_wp
         return
      end if
      flow%film(:) = level%state%film
      flow%v = old%v + share*step%v
      flow%u = old%u - newton%terms%reynolds%u + share*step%u
      call evaluate_rows(problem, flow, newton%terms, rows)
      flow%u = flow%u + newton%terms%reynolds%u
      newton%last_step = max(maxval(abs(flow%p - old%p)), maxval(abs(flow%u - old%u)), &
         abs(share*film_shift))
   end subroutine apply_step

   !> Computes the change of the film (0:n), eta - K p, for unknowns x.
   subroutine film_change(level, x, change)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: change(0:)
      real(wp) :: p(0:level%n)

      p = 0.0_wp
      p(1:level%n - 1) = x(:level%n - 1)
      change = 0.0_wp
      if (level%elastic%elasticity > 0.0_wp) call level%elastic%apply(p, change)
      change = x(level%n) - change
   end subroutine film_change

   !> Computes A^-1 (B h + C p) for unknowns x, in `change`, whose film is h.
   subroutine flow_change(system, x, change)
      type(momentum_system_t), intent(inout) :: system
      real(wp), intent(in) :: x(:)
      type(film_flow_t), intent(inout) :: change
      real(wp) :: p(0:system%level%n)

      p = 0.0_wp
      p(1:system%level%n - 1) = x(:system%level%n - 1)
      change%u = 0.0_wp
      change%v = 0.0_wp
      change%p = 0.0_wp
      call film_change(system%level, x, change%film)
      call rows_change(system%problem, system%flow, system%newton%terms, change, p, system%rows)
      call solve_momentum(system%newton%matrix, system%problem, system%rows, change)
   end subroutine flow_change

   !> Multiplies by the matrix of the system.
   subroutine multiply_eliminated(self, x, y)
      class(momentum_system_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      real(wp) :: mean(0:self%level%n)
      integer :: n

      n = self%level%n
      call flow_change(self, x, self%change)
      mean = mean_pressure(self%change)
      y(:n - 1) = x(:n - 1) + mean(1:n - 1)
      y(n) = self%level%dx*sum(x(:n - 1))
   end subroutine multiply_eliminated

   !> Solves once with the factors of the Reynolds equation.
   subroutine precondition_by_reynolds(self, x)
      class(momentum_system_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)
      real(wp) :: p(-1:self%level%n + 1), no_film(0:self%level%n), wedge(self%level%n)
      logical :: is_held(self%level%n - 1), is_solved
      integer :: i, n

      n = self%level%n
      p = 0.0_wp
      p(1:n - 1) = x(:n - 1)
      no_film = 0.0_wp
      is_held = self%problem%is_held(1:n - 1)
      wedge = wedge_change(self%problem, self%newton%terms%reynolds, mean_pressure(self%flow), &
         self%flow%film, p(0:n), no_film)
      do i = 1, n - 1
         if (.not. is_held(i)) x(i) = dot_product(self%reynolds%by_pressure(:, i), p(i - 2:i + 2)) &
            + self%problem%lambda*(wedge(i + 1) - wedge(i))/(self%level%dx &
            *self%reynolds%diagonal(i))
      end do
      call self%linear%solve(self%level, self%reynolds, is_held, x, is_solved)
   end subroutine precondition_by_reynolds

end module momentum_newton

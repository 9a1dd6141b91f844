!> Linear system of one Newton step of the elastic film, without the changes of U, V and P.
!>
!> With A the matrix of module momentum_matrix, B and C the changes of the rows with the film and,
!> by the Reynolds part, with the mean pressure, E the mean over a column, and the film change
!> h = eta - K p, the changes of the mean pressure p and of H0, eta, solve
!>
!>     p + E A^-1 ( B (eta - K p) + C p ) = -E A^-1 r,   dX sum p = missing load.
!>
!> Preconditioned with the elastic Reynolds equation at the same pressure and film, whose rows are
!> those of E A^-1 once multiplied by its change with the pressure alone.
module momentum_system
   use gmres, only: krylov_system_t
   use kinds, only: wp
   use line_level, only: line_level_t
   use momentum_matrix, only: momentum_matrix_t, solve_momentum
   use momentum_problem, only: film_flow_t, mean_pressure, momentum_problem_t
   use momentum_rows, only: momentum_rows_t, momentum_terms_t, rows_change
   use newton_work, only: linear_solver_t, reynolds_jacobian_t
   use reynolds_part, only: wedge_change
   implicit none (type, external)
   private

   public :: film_change, flow_change, momentum_system_t

   !> Unknowns p at nodes 1..n-1, then eta. Points to the data of one step; the rows of `reynolds`
   !> are divided by the elastic diagonal.
   type, extends(krylov_system_t) :: momentum_system_t
      type(line_level_t), pointer :: level => null()
      type(momentum_problem_t), pointer :: problem => null()
      type(film_flow_t), pointer :: flow => null()
      type(momentum_terms_t), pointer :: terms => null()
      type(momentum_matrix_t), pointer :: matrix => null()
      type(reynolds_jacobian_t), pointer :: reynolds => null()
      class(linear_solver_t), pointer :: linear => null()
      !> Storage of one product.
      type(film_flow_t) :: change
      type(momentum_rows_t) :: rows
   contains
      procedure :: multiply => multiply_eliminated
      procedure :: precondition => precondition_by_reynolds
   end type momentum_system_t

contains

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
      call rows_change(system%problem, system%flow, system%terms, change, p, system%rows)
      call solve_momentum(system%matrix, system%problem, system%rows, change)
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
      wedge = wedge_change(self%problem, self%terms%reynolds, mean_pressure(self%flow), &
         self%flow%film, p(0:n), no_film)
      do i = 1, n - 1
         if (.not. is_held(i)) x(i) = dot_product(self%reynolds%by_pressure(:, i), p(i - 2:i + 2)) &
            + self%problem%lambda*(wedge(i + 1) - wedge(i))/(self%level%dx &
            *self%reynolds%diagonal(i))
      end do
      call self%linear%solve(self%level, self%reynolds, is_held, x, is_solved)
   end subroutine precondition_by_reynolds

end module momentum_system

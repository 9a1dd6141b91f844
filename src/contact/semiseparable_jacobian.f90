!> The Newton system of the line contact in O(n log n): GMRES on the exact product (bands and FFT), preconditioned by the
!> LU of nearly the same matrix, in which the logarithmic kernel is a sum of exponentials.
!>
!> With kappa(j) ~ C - sum_l w_l rho_l^j the elastic Jacobian JP - JH K is pentadiagonal plus semiseparable and factors in
!> one sweep. The constant part of the kernel acts like a change of H0 and moves there.
module semiseparable_jacobian
   use constants, only: pi
   use errors, only: error_t
   use exponential_sum, only: exponential_sum_t, fit_exponentials, terms
   use gmres, only: gmres_t, krylov_system_t, solve_gmres
   use kinds, only: wp
   use line_level, only: line_level_t
   use linear_solver, only: linear_solver_t
   use reynolds_jacobian, only: reynolds_jacobian_t
   use semiseparable, only: factor_semiseparable, new_semiseparable, semiseparable_t, solve_semiseparable
   implicit none (type, external)
   private

   public :: semiseparable_jacobian_t

   !> GMRES ends at this share of the right side: the outer Newton iteration gains nothing from more.
   real(wp), parameter :: default_tolerance = 1.0e-2_wp

   !> The bordered system as GMRES sees it: unknowns P(1..n-1), H0. Points to the level and the bands of one call.
   type, extends(krylov_system_t) :: bordered_system_t
      type(line_level_t), pointer :: level => null()
      type(reynolds_jacobian_t), pointer :: jacobian => null()
      type(semiseparable_t), pointer :: factors => null()
      logical, allocatable :: is_cavitated(:)
      !> Constant part of -K/pi; column of H0 (n-1), its solution (n-1) and dX times the sum of that; work (0:n).
      real(wp) :: constant = 0.0_wp
      real(wp), allocatable :: column(:), column_solution(:), p(:), h(:)
      real(wp) :: column_load = 0.0_wp
   contains
      procedure :: multiply => multiply_bordered
      procedure :: precondition => precondition_bordered
   end type bordered_system_t

   !> Work space, kept from call to call.
   type, extends(linear_solver_t) :: semiseparable_jacobian_t
      real(wp) :: tolerance = default_tolerance
      !> Smallest |pivot| of the last factorisation, of rows scaled to 1.
      real(wp) :: smallest_pivot = 0.0_wp
      integer, private :: n = 0
      type(exponential_sum_t), private :: fit
      type(semiseparable_t), private :: factors
      type(gmres_t), private :: krylov
   contains
      procedure :: solve => solve_semiseparable_system
   end type semiseparable_jacobian_t

contains

   !> Factors, then GMRES.
   subroutine solve_semiseparable_system(self, level, jacobian, is_cavitated, step, is_solved)
      class(semiseparable_jacobian_t), intent(inout), target :: self
      type(line_level_t), intent(inout), target :: level
      type(reynolds_jacobian_t), intent(in), target :: jacobian
      logical, intent(in) :: is_cavitated(:)
      real(wp), intent(inout) :: step(:)
      logical, intent(out) :: is_solved
      type(bordered_system_t) :: system

      call prepare_kernel(self, level, is_solved)
      if (.not. is_solved) return
      system%level => level
      system%jacobian => jacobian
      system%factors => self%factors
      system%is_cavitated = is_cavitated
      system%constant = -level%dx/pi*(self%fit%constant + log(level%dx))
      call fill_factors(self, level, jacobian, is_cavitated, system%constant)
      call factor_semiseparable(self%factors, self%smallest_pivot)
      is_solved = self%smallest_pivot > 0.0_wp
      if (.not. is_solved) return
      call prepare_border(system)
      call solve_gmres(self%krylov, system, self%tolerance, step, is_solved)
      self%iterations = self%krylov%iterations
      is_solved = is_solved .or. self%krylov%iterations > 0
   end subroutine solve_semiseparable_system

   !> Fit of kappa_j = pi K_j/dX - ln dX and storage, once per grid.
   subroutine prepare_kernel(self, level, is_ready)
      class(semiseparable_jacobian_t), intent(inout) :: self
      type(line_level_t), intent(in) :: level
      logical, intent(out) :: is_ready
      type(error_t), allocatable :: error

      is_ready = self%n == level%n
      if (is_ready) return
      call fit_exponentials(pi*level%kernel/level%dx - log(level%dx), self%fit, error)
      is_ready = .not. allocated(error)
      if (.not. is_ready) return
      call new_semiseparable(self%factors, level%n - 1, self%fit%ratio)
      self%n = level%n
   end subroutine prepare_kernel

   !> Rows of the approximate Jacobian: exponentials everywhere, exact entries on the five inner diagonals.
   subroutine fill_factors(self, level, jacobian, is_cavitated, constant)
      class(semiseparable_jacobian_t), intent(inout) :: self
      type(line_level_t), intent(in) :: level
      type(reynolds_jacobian_t), intent(in) :: jacobian
      logical, intent(in) :: is_cavitated(:)
      real(wp), intent(in) :: constant
      integer, parameter :: q = terms
      real(wp), dimension(q, -2:1) :: below, above
      real(wp), dimension(q) :: omega, rho
      real(wp) :: near(-3:3)
      integer :: i, o

      rho = self%fit%ratio
      omega = level%dx/pi*self%fit%weight
      do o = -2, 1
         below(:, o) = omega*rho**o
         above(:, o) = omega*rho**(-o)
      end do
      do o = -3, 3
         near(o) = -level%kernel(abs(o)) - constant
      end do
      associate (lower => self%factors%lower, upper => self%factors%upper, diagonal => self%factors%diagonal)
         do i = 1, level%n - 1
            if (is_cavitated(i)) then
               lower(:, i) = 0.0_wp
               upper(:, i) = 0.0_wp
               diagonal(i) = 1.0_wp
               cycle
            end if
            associate (jh => jacobian%by_film(:, i), jp => jacobian%by_pressure(:, i))
               lower(1:q, i) = jh(1)*below(:, -2) + jh(2)*below(:, -1) + jh(3)*below(:, 0) + jh(4)*below(:, 1)
               upper(1:q, i) = jh(1)*above(:, -2) + jh(2)*above(:, -1) + jh(3)*above(:, 0) + jh(4)*above(:, 1)
               diagonal(i) = jp(3) + jh(1)*near(2) + jh(2)*near(1) + jh(3)*near(0) + jh(4)*near(1)
               lower(q + 1, i) = jp(2) + jh(1)*near(1) + jh(2)*near(0) + jh(3)*near(1) + jh(4)*near(2) &
                  - dot_product(lower(1:q, i), rho)
               lower(q + 2, i) = jp(1) + jh(1)*near(0) + jh(2)*near(1) + jh(3)*near(2) + jh(4)*near(3) &
                  - dot_product(lower(1:q, i), rho**2)
               upper(q + 1, i) = jp(4) + jh(1)*near(3) + jh(2)*near(2) + jh(3)*near(1) + jh(4)*near(0) &
                  - dot_product(upper(1:q, i), rho)
               upper(q + 2, i) = jp(5) + jh(1)*(-level%kernel(4) - constant) + jh(2)*near(3) + jh(3)*near(2) + jh(4)*near(1) &
                  - dot_product(upper(1:q, i), rho**2)
            end associate
         end do
      end associate
   end subroutine fill_factors

   !> The column of H0, its solution, and work space.
   subroutine prepare_border(system)
      type(bordered_system_t), intent(inout) :: system
      integer :: n

      n = system%level%n
      allocate (system%p(0:n), system%h(0:n), source=0.0_wp)
      system%column = merge(0.0_wp, sum(system%jacobian%by_film(:, 1:n - 1), 1), system%is_cavitated)
      system%column_solution = system%column
      call solve_semiseparable(system%factors, system%column_solution)
      system%column_load = system%level%dx*sum(system%column_solution)
   end subroutine prepare_border

   !> y = J x: bands in P and, with H = H0 - K P by FFT, in H; identity where cavitated; load in the last row.
   subroutine multiply_bordered(self, x, y)
      class(bordered_system_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: i, n

      n = self%level%n
      self%p(1:n - 1) = x(1:n - 1)
      call self%level%convolution%apply(self%p, self%h)
      self%level%products = self%level%products + 1
      self%h = x(n) - self%h
      associate (p => self%p, h => self%h, jp => self%jacobian%by_pressure, jh => self%jacobian%by_film)
         y(1) = jp(-1, 1)*p(0) + jp(0, 1)*p(1) + jp(1, 1)*p(2) + jp(2, 1)*p(min(3, n)) &
            + jh(-1, 1)*h(0) + jh(0, 1)*h(1) + jh(1, 1)*h(2)
         do i = 2, n - 2
            y(i) = jp(-2, i)*p(i - 2) + jp(-1, i)*p(i - 1) + jp(0, i)*p(i) + jp(1, i)*p(i + 1) + jp(2, i)*p(i + 2) &
               + jh(-2, i)*h(i - 2) + jh(-1, i)*h(i - 1) + jh(0, i)*h(i) + jh(1, i)*h(i + 1)
         end do
         i = n - 1
         y(i) = jp(-2, i)*p(i - 2) + jp(-1, i)*p(i - 1) + jp(0, i)*p(i) + jp(1, i)*p(i + 1) &
            + jh(-2, i)*h(i - 2) + jh(-1, i)*h(i - 1) + jh(0, i)*h(i) + jh(1, i)*h(i + 1)
      end associate
      where (self%is_cavitated) y(1:n - 1) = x(1:n - 1)
      y(n) = self%level%dx*sum(x(1:n - 1))
   end subroutine multiply_bordered

   !> Bordered solution with the factors; the constant part of the kernel is put back into H0.
   subroutine precondition_bordered(self, x)
      class(bordered_system_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)
      real(wp) :: shift
      integer :: n

      n = self%level%n
      call solve_semiseparable(self%factors, x(1:n - 1))
      shift = (self%level%dx*sum(x(1:n - 1)) - x(n))/self%column_load
      x(1:n - 1) = x(1:n - 1) - shift*self%column_solution
      x(n) = shift - self%constant*sum(x(1:n - 1))
   end subroutine precondition_bordered

end module semiseparable_jacobian

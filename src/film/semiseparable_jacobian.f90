!> Solves the Newton system of the line contact in O(n log n): GMRES on the exact product (bands and
!> FFT), preconditioned by the LU of nearly the same matrix, in which the logarithmic kernel is a
!> sum of exponentials.
!>
!> With kappa(j) ~ C - sum_l w_l rho_l^j the elastic Jacobian JP - JH K is pentadiagonal plus
!> semiseparable and factors in one sweep. The constant part of the kernel acts like a change of H0
!> and is moved there.
module semiseparable_jacobian
   use constants, only: pi
   use errors, only: error_t
   use exponential_sum, only: exponential_sum_t, fit_exponentials, terms
   use gmres, only: gmres_t, krylov_system_t, solve_gmres
   use kinds, only: wp
   use line_level, only: line_level_t
   use newton_work, only: linear_solver_t, reynolds_jacobian_t
   use semiseparable, only: factor_semiseparable, new_semiseparable, semiseparable_t, &
      solve_semiseparable, solve_two
   implicit none (type, external)
   private

   public :: semiseparable_jacobian_t

   !> Contribution of one unit of dL_R(i)/dH(i+o), o = -2..1, to row i: to the exponentials to the
   !> left and to the right, and to the slots of the five inner diagonals (-2:2), which make the
   !> entries there exact.
   type :: kernel_rows_t
      real(wp) :: ratio(terms) = 0.0_wp
      real(wp) :: left(terms, -2:1) = 0.0_wp, right(terms, -2:1) = 0.0_wp
      real(wp) :: slots(-2:1, -2:2) = 0.0_wp
      !> Constant part of -K/pi.
      real(wp) :: constant = 0.0_wp
   end type kernel_rows_t

   !> The bordered system for GMRES: unknowns P(1..n-1), H0. Points to the level and the bands of
   !> one call.
   type, extends(krylov_system_t) :: bordered_system_t
      type(line_level_t), pointer :: level => null()
      type(reynolds_jacobian_t), pointer :: jacobian => null()
      type(semiseparable_t), pointer :: factors => null()
      logical, allocatable :: is_cavitated(:)
      !> Constant part of -K/pi; solution for the column of H0 (n-1) and dX times its sum; work
      !> (0:n).
      real(wp) :: constant = 0.0_wp
      real(wp), allocatable :: column_solution(:), p(:), h(:)
      real(wp) :: column_load = 0.0_wp
   contains
      procedure :: multiply => multiply_bordered
      procedure :: precondition => precondition_bordered
   end type bordered_system_t

   !> Work space, kept from call to call.
   type, extends(linear_solver_t) :: semiseparable_jacobian_t
      !> Smallest |pivot| of the last factorisation, with rows scaled to 1.
      real(wp) :: smallest_pivot = 0.0_wp
      integer, private :: n = 0
      type(kernel_rows_t), private :: rows
      type(semiseparable_t), private :: factors
      type(gmres_t), private :: krylov
   contains
      procedure :: solve => solve_semiseparable_system
   end type semiseparable_jacobian_t

contains

   !> Factors the approximate Jacobian, solves with the factors, and continues with GMRES if the
   !> remainder exceeds the tolerance.
   subroutine solve_semiseparable_system(self, level, jacobian, is_cavitated, step, is_solved)
      class(semiseparable_jacobian_t), intent(inout), target :: self
      type(line_level_t), intent(inout), target :: level
      type(reynolds_jacobian_t), intent(in), target :: jacobian
      logical, intent(in) :: is_cavitated(:)
      real(wp), intent(inout) :: step(:)
      logical, intent(out) :: is_solved
      type(bordered_system_t) :: system
      real(wp), allocatable :: remainder(:), product(:)
      real(wp) :: allowed, left, largest, share

      call prepare_kernel(self, level, is_solved)
      if (.not. is_solved) return
      system%level => level
      system%jacobian => jacobian
      system%factors => self%factors
      system%is_cavitated = is_cavitated
      system%constant = self%rows%constant
      call fill_factors(self%factors, self%rows, jacobian, is_cavitated)
      call factor_semiseparable(self%factors, self%smallest_pivot)
      is_solved = self%smallest_pivot > 0.0_wp
      if (.not. is_solved) return
      allowed = self%tolerance*norm2(step)
      remainder = step
      call solve_first(system, step)
      allocate (product, mold=step)
      call system%multiply(step, product)
      self%iterations = 1
      remainder = remainder - product
      left = norm2(remainder)
      largest = maxval(abs(remainder(:level%n - 1)*jacobian%diagonal(1:level%n - 1)))
      is_solved = left <= allowed .and. largest <= self%goal
      if (is_solved .or. .not. left < huge(1.0_wp)) return
      share = allowed/left
      if (self%goal < largest) share = min(share, self%goal/largest)
      call solve_gmres(self%krylov, system, share, remainder, is_solved)
      step = step + remainder
      self%iterations = 1 + self%krylov%iterations
      is_solved = is_solved .or. self%krylov%iterations > 0
   end subroutine solve_semiseparable_system

   !> Fits kappa_j = pi K_j/dX - ln dX, times the elasticity, and allocates storage, once per grid.
   subroutine prepare_kernel(self, level, is_ready)
      class(semiseparable_jacobian_t), intent(inout) :: self
      type(line_level_t), intent(in) :: level
      logical, intent(out) :: is_ready
      type(exponential_sum_t) :: fit
      type(error_t), allocatable :: error
      integer :: d, o

      is_ready = self%n == level%n
      if (is_ready) return
      call fit_exponentials(pi*level%elastic%kernel/level%dx - level%elastic%elasticity &
         *log(level%dx), fit, error)
      is_ready = .not. allocated(error)
      if (.not. is_ready) return
      call new_semiseparable(self%factors, level%n - 1, fit%ratio)
      self%n = level%n
      associate (rows => self%rows)
         rows%ratio = fit%ratio
         rows%constant = -level%dx/pi*(fit%constant + level%elastic%elasticity*log(level%dx))
         do o = -2, 1
            rows%left(:, o) = level%dx/pi*fit%weight*fit%ratio**o
            rows%right(:, o) = level%dx/pi*fit%weight*fit%ratio**(-o)
            do d = -2, 2
               rows%slots(o, d) = -level%elastic%kernel(abs(d - o)) - rows%constant
               if (d < 0) rows%slots(o, d) = rows%slots(o, d) - dot_product(rows%left(:, o), &
                  fit%ratio**(-d))
               if (d > 0) rows%slots(o, d) = rows%slots(o, d) - dot_product(rows%right(:, o), &
                  fit%ratio**d)
            end do
         end do
      end associate
   end subroutine prepare_kernel

   !> Fills the rows of the approximate Jacobian: exponentials everywhere, exact entries on the five
   !> inner diagonals.
   pure subroutine fill_factors(factors, rows, jacobian, is_cavitated)
      type(semiseparable_t), intent(inout) :: factors
      type(kernel_rows_t), intent(in) :: rows
      type(reynolds_jacobian_t), intent(in) :: jacobian
      logical, intent(in) :: is_cavitated(:)
      integer, parameter :: q = terms
      real(wp) :: slots(-2:2)
      integer :: d, i, l

      associate (lower => factors%lower, upper => factors%upper, left => rows%left, &
         right => rows%right)
         do i = 1, factors%n
            if (is_cavitated(i)) then
               lower(:, i) = 0.0_wp
               upper(:, i) = 0.0_wp
               factors%diagonal(i) = 1.0_wp
               cycle
            end if
            associate (jh => jacobian%by_film(:, i))
               !$omp simd
               do l = 1, q
                  lower(l, i) = jh(1)*left(l, -2) + jh(2)*left(l, -1) + jh(3)*left(l, &
                     0) + jh(4)*left(l, 1)
                  upper(l, i) = jh(1)*right(l, -2) + jh(2)*right(l, -1) + jh(3)*right(l, &
                     0) + jh(4)*right(l, 1)
               end do
               do d = -2, 2
                  slots(d) = jacobian%by_pressure(d, i) + jh(1)*rows%slots(-2, d) &
                     + jh(2)*rows%slots(-1, d) + jh(3)*rows%slots(0, d) + jh(4)*rows%slots(1, d)
               end do
            end associate
            lower(q + 1, i) = slots(-1)
            lower(q + 2, i) = slots(-2)
            factors%diagonal(i) = slots(0)
            upper(q + 1, i) = slots(1)
            upper(q + 2, i) = slots(2)
         end do
      end associate
   end subroutine fill_factors

   !> Computes the column of H0 and its solution, and allocates work space; `x` becomes the first
   !> approximation, the bordered solution with the factors.
   subroutine solve_first(system, x)
      type(bordered_system_t), intent(inout) :: system
      real(wp), intent(inout) :: x(:)
      real(wp), allocatable :: both(:, :)
      integer :: i, n

      n = system%level%n
      allocate (system%p(0:n), system%h(0:n), source=0.0_wp)
      allocate (both(2, n - 1))
      do i = 1, n - 1
         both(:, i) = [merge(0.0_wp, sum(system%jacobian%by_film(:, i)), system%is_cavitated(i)), &
            x(i)]
      end do
      call solve_two(system%factors, both)
      system%column_solution = both(1, :)
      system%column_load = system%level%dx*sum(system%column_solution)
      x(1:n - 1) = both(2, :)
      call close_border(system, x)
   end subroutine solve_first

   !> Computes y = J x: bands in P and, with H = H0 - K P by FFT, in H; identity where cavitated;
   !> load in the last row.
   subroutine multiply_bordered(self, x, y)
      class(bordered_system_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: i, n

      n = self%level%n
      self%p(1:n - 1) = x(1:n - 1)
      call self%level%elastic%apply(self%p, self%h)
      self%h = x(n) - self%h
      associate (p => self%p, h => self%h, jp => self%jacobian%by_pressure, &
         jh => self%jacobian%by_film)
         y(1) = jp(-1, 1)*p(0) + jp(0, 1)*p(1) + jp(1, 1)*p(2) + jp(2, 1)*p(min(3, n)) &
            + jh(-1, 1)*h(0) + jh(0, 1)*h(1) + jh(1, 1)*h(2)
         do i = 2, n - 2
            y(i) = jp(-2, i)*p(i - 2) + jp(-1, i)*p(i - 1) + jp(0, i)*p(i) + jp(1, i)*p(i + 1) &
               + jp(2, i)*p(i + 2) &
               + jh(-2, i)*h(i - 2) + jh(-1, i)*h(i - 1) + jh(0, i)*h(i) + jh(1, i)*h(i + 1)
         end do
         i = n - 1
         y(i) = jp(-2, i)*p(i - 2) + jp(-1, i)*p(i - 1) + jp(0, i)*p(i) + jp(1, i)*p(i + 1) &
            + jh(-2, i)*h(i - 2) + jh(-1, i)*h(i - 1) + jh(0, i)*h(i) + jh(1, i)*h(i + 1)
      end associate
      where (self%is_cavitated) y(1:n - 1) = x(1:n - 1)
      y(n) = self%level%dx*sum(x(1:n - 1))
   end subroutine multiply_bordered

   !> Computes the bordered solution with the factors.
   subroutine precondition_bordered(self, x)
      class(bordered_system_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)

      call solve_semiseparable(self%factors, x(1:self%level%n - 1))
      call close_border(self, x)
   end subroutine precondition_bordered

   !> Turns the solution of the rows of the nodes, without a change of H0, into that with the force
   !> balance; returns the constant part of the kernel to H0.
   pure subroutine close_border(system, x)
      type(bordered_system_t), intent(in) :: system
      real(wp), intent(inout) :: x(:)
      real(wp) :: shift
      integer :: n

      n = system%level%n
      shift = (system%level%dx*sum(x(1:n - 1)) - x(n))/system%column_load
      x(1:n - 1) = x(1:n - 1) - shift*system%column_solution
      x(n) = shift - system%constant*sum(x(1:n - 1))
   end subroutine close_border

end module semiseparable_jacobian

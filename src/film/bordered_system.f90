!> The Newton system of a line contact in O(n): its product, exact, and the LU of nearly the same
!> matrix, in which the logarithmic kernel is a sum of exponentials, for GMRES; transposed, too.
!>
!> Unknowns are P(1..n-1) and H0. With kappa(d) ~ C - sum_l w_l exp(-a_l d) the elastic Jacobian
!> JP - JH K is pentadiagonal plus semiseparable and factors in one sweep. The constant part of the
!> kernel acts like a change of H0 and is moved there.
module bordered_system
   use gmres, only: krylov_system_t
   use kinds, only: wp
   use semiseparable, only: factor_semiseparable, semiseparable_t, solve_semiseparable, &
      solve_transposed, solve_two, terms
   implicit none (type, external)
   private

   public :: bordered_system_t, factor_bordered, kernel_rows_t, solve_first

   !> Contribution of one unit of dL_R(i)/dH(i+o), o = -2..1, to row i: to the exponentials to the
   !> left and to the right, and to the slots of the five inner diagonals (-2:2), which make the
   !> entries there exact.
   type :: kernel_rows_t
      real(wp) :: left(terms, -2:1) = 0.0_wp, right(terms, -2:1) = 0.0_wp
      real(wp) :: slots(-2:1, -2:2) = 0.0_wp
   end type kernel_rows_t

   !> What cavitated rows do besides.
   type, abstract, extends(krylov_system_t) :: cavitated_system_t
      !> Diagonals by which rows are divided, and what cavitated rows pass on to the next (0:n)
      !> (module newton_work); null: nothing. The factors leave it out.
      real(wp), pointer, contiguous :: diagonal(:) => null(), carry(:) => null()
      !> Weights y of H in cavitated rows, P + y H = ... (n-1); not allocated: 0.
      real(wp), allocatable :: yields(:)
   end type cavitated_system_t

   !> A system of n unknowns.
   type, abstract, extends(cavitated_system_t) :: bordered_system_t
      integer :: n = 0
      logical :: is_transposed = .false.
      !> Bands of the rows over their diagonals (-2:2, n-1), (-2:1, n-1): of the caller.
      real(wp), pointer, contiguous :: by_pressure(:, :) => null(), by_film(:, :) => null()
      logical, allocatable :: is_cavitated(:)
      !> Weights of Int P dX (n-1).
      real(wp), allocatable :: weights(:)
      !> Rows of the kernel (n-1), or one where all are alike; constant part of -K over the weights.
      type(kernel_rows_t), allocatable :: rows(:)
      real(wp) :: constant = 0.0_wp
      type(semiseparable_t) :: factors
      !> Smallest |pivot| of the last factors.
      real(wp) :: smallest_pivot = 0.0_wp
      !> Solution for the column of H0 (n-1), its load; work (0:n).
      real(wp), allocatable, private :: column_solution(:), p(:), h(:)
      real(wp), private :: column_load = 0.0_wp
   contains
      procedure :: multiply => multiply_bordered
      procedure :: precondition => precondition_bordered
      procedure(deflect_interface), deferred :: deflect
   end type bordered_system_t

   abstract interface
      !> h = K p, or K^T p of a transposed system, (0:n) both.
      subroutine deflect_interface(self, p, h)
         import :: bordered_system_t, wp
         class(bordered_system_t), intent(inout) :: self
         real(wp), intent(in), contiguous :: p(0:)
         real(wp), intent(out), contiguous :: h(0:)
      end subroutine deflect_interface
   end interface

contains

   !> Factors the approximate matrix of the present bands; `is_sound`: no pivot is 0.
   subroutine factor_bordered(system, is_sound)
      class(bordered_system_t), intent(inout) :: system
      logical, intent(out) :: is_sound
      integer :: i

      call fill_factors(system%rows, system%by_pressure, system%by_film, system%is_cavitated, &
         system%factors%lower, system%factors%upper, system%factors%diagonal)
      if (allocated(system%yields)) then   ! asperities bear the cavitated rows
         do i = 1, system%factors%n
            if (.not. system%is_cavitated(i)) cycle
            associate (factors => system%factors, row => system%rows(min(i, size(system%rows))), &
               y => system%yields(i))
               factors%lower(:, i) = y*[row%left(:, 0), row%slots(0, [-1, -2])]
               factors%upper(:, i) = y*[row%right(:, 0), row%slots(0, [1, 2])]
               factors%diagonal(i) = 1 + y*row%slots(0, 0)
            end associate
         end do
      end if
      call factor_semiseparable(system%factors, system%smallest_pivot)
      is_sound = all([system%smallest_pivot > 0.0_wp, allocated(system%yields) &
         .or. .not. all(system%is_cavitated)])   ! else nothing bears the load
   end subroutine factor_bordered

   !> Fills the rows of the approximate matrix: exponentials everywhere, exact entries on the five
   !> inner diagonals. On plain arrays, which the compiler knows to be apart.
   pure subroutine fill_factors(rows, by_pressure, by_film, is_cavitated, lower, upper, diagonal)
      type(kernel_rows_t), intent(in), contiguous :: rows(:)
      logical, intent(in), contiguous :: is_cavitated(:)
      real(wp), intent(in) :: by_pressure(-2:2, size(is_cavitated)), by_film(4, size(is_cavitated))
      integer, parameter :: q = terms
      real(wp), intent(out) :: lower(q + 2, size(is_cavitated)), upper(q + 2, size(is_cavitated)), &
         diagonal(size(is_cavitated))
      real(wp) :: slots(-2:2)
      integer :: d, i, l

      do i = 1, size(is_cavitated)
         if (is_cavitated(i)) then
            lower(:, i) = 0.0_wp
            upper(:, i) = 0.0_wp
            diagonal(i) = 1.0_wp
            cycle
         end if
         associate (jh => by_film(:, i), row => rows(min(i, size(rows))))
            !$omp simd
            do l = 1, q
               lower(l, i) = jh(1)*row%left(l, -2) + jh(2)*row%left(l, -1) + jh(3)*row%left(l, 0) &
                  + jh(4)*row%left(l, 1)
               upper(l, i) = jh(1)*row%right(l, -2) + jh(2)*row%right(l, -1) + jh(3)*row%right(l, &
                  0) + jh(4)*row%right(l, 1)
            end do
            do d = -2, 2
               slots(d) = by_pressure(d, i) + jh(1)*row%slots(-2, d) + jh(2)*row%slots(-1, d) &
                  + jh(3)*row%slots(0, d) + jh(4)*row%slots(1, d)
            end do
            lower(q + 1, i) = slots(-1)
            lower(q + 2, i) = slots(-2)
            diagonal(i) = slots(0)
            upper(q + 1, i) = slots(1)
            upper(q + 2, i) = slots(2)
         end associate
      end do
   end subroutine fill_factors

   !> Computes the column of H0 and its solution with fresh factors; `x` becomes the first
   !> approximation, the bordered solution with the factors.
   subroutine solve_first(system, x)
      class(bordered_system_t), intent(inout) :: system
      real(wp), intent(inout) :: x(:)
      real(wp), allocatable :: both(:, :)
      integer :: i, n

      n = system%n
      if (allocated(system%p)) then
         if (size(system%p) /= n + 1) deallocate (system%p, system%h)
      end if
      if (.not. allocated(system%p)) allocate (system%p(0:n), system%h(0:n), source=0.0_wp)
      allocate (both(2, n - 1))
      do i = 1, n - 1
         both(:, i) = [merge(0.0_wp, sum(system%by_film(:, i)), system%is_cavitated(i)), x(i)]
         if (allocated(system%yields) .and. system%is_cavitated(i)) both(1, i) = system%yields(i)
      end do
      call solve_two(system%factors, both)
      system%column_solution = both(1, :)
      system%column_load = dot_product(system%weights, system%column_solution)
      x(1:n - 1) = both(2, :)
      call close_border(system, x)
   end subroutine solve_first

   !> Computes y = J x: bands in P and, with H = H0 - K P, in H; identity where cavitated; load in
   !> the last row. Or y = J^T x.
   subroutine multiply_bordered(self, x, y)
      class(bordered_system_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: i, n

      if (self%is_transposed) then
         call multiply_transposed(self, x, y)
         return
      end if
      n = self%n
      self%p(0) = 0.0_wp
      self%p(1:n - 1) = x(1:n - 1)
      self%p(n) = 0.0_wp
      call self%deflect(self%p, self%h)
      self%h = x(n) - self%h
      associate (p => self%p, h => self%h, jp => self%by_pressure, jh => self%by_film)
         ! offsets -2 ... 2 and -2 ... 1 have the places 1 ... 5 and 1 ... 4
         y(1) = jp(2, 1)*p(0) + jp(3, 1)*p(1) + jp(4, 1)*p(2) + jp(5, 1)*p(min(3, n)) &
            + jh(2, 1)*h(0) + jh(3, 1)*h(1) + jh(4, 1)*h(2)
         do i = 2, n - 2
            y(i) = jp(1, i)*p(i - 2) + jp(2, i)*p(i - 1) + jp(3, i)*p(i) + jp(4, i)*p(i + 1) &
               + jp(5, i)*p(i + 2) &
               + jh(1, i)*h(i - 2) + jh(2, i)*h(i - 1) + jh(3, i)*h(i) + jh(4, i)*h(i + 1)
         end do
         i = n - 1
         y(i) = jp(1, i)*p(i - 2) + jp(2, i)*p(i - 1) + jp(3, i)*p(i) + jp(4, i)*p(i + 1) &
            + jh(1, i)*h(i - 2) + jh(2, i)*h(i - 1) + jh(3, i)*h(i) + jh(4, i)*h(i + 1)
      end associate
      if (associated(self%carry)) call pass_on(self%carry, self%diagonal, y)
      where (self%is_cavitated) y(1:n - 1) = x(1:n - 1)
      if (allocated(self%yields)) then
         where (self%is_cavitated) y(1:n - 1) = x(1:n - 1) + self%yields*self%h(1:n - 1)
      end if
      y(n) = dot_product(self%weights, x(1:n - 1))
   end subroutine multiply_bordered

   !> Passes on what arrives at cavitated nodes, to the rows behind them.
   pure subroutine pass_on(carry, diagonal, y)
      real(wp), intent(in) :: carry(0:), diagonal(0:)
      real(wp), intent(inout) :: y(:)
      real(wp) :: passed
      integer :: i

      passed = 0.0_wp
      do i = 1, size(y) - 1
         y(i) = y(i) + passed/diagonal(i)
         passed = carry(i)*y(i)*diagonal(i)
      end do
   end subroutine pass_on

   !> Computes y = J^T x.
   subroutine multiply_transposed(self, x, y)
      class(bordered_system_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: i, n, o

      n = self%n
      self%h = 0.0_wp
      y = 0.0_wp
      do i = 1, n - 1
         if (self%is_cavitated(i)) then
            y(i) = y(i) + x(i)
            cycle
         end if
         do o = max(-2, -i), 1
            self%h(i + o) = self%h(i + o) + self%by_film(o + 3, i)*x(i)
         end do
         do o = max(-2, 1 - i), min(2, n - 1 - i)
            y(i + o) = y(i + o) + self%by_pressure(o + 3, i)*x(i)
         end do
      end do
      call self%deflect(self%h, self%p)
      y(1:n - 1) = y(1:n - 1) - self%p(1:n - 1) + self%weights*x(n)
      y(n) = sum(self%h)
   end subroutine multiply_transposed

   !> Computes the bordered solution with the factors, or with those transposed.
   subroutine precondition_bordered(self, x)
      class(bordered_system_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)
      real(wp) :: load

      associate (n => self%n)
         if (self%is_transposed) then
            x(1:n - 1) = x(1:n - 1) - self%constant*x(n)*self%weights
            load = (dot_product(self%column_solution, x(1:n - 1)) - x(n))/self%column_load
            x(1:n - 1) = x(1:n - 1) - load*self%weights
            call solve_transposed(self%factors, x(1:n - 1))
            x(n) = load
         else
            call solve_semiseparable(self%factors, x(1:n - 1))
            call close_border(self, x)
         end if
      end associate
   end subroutine precondition_bordered

   !> Turns the solution of the rows of the nodes, without a change of H0, into that with the force
   !> balance; returns the constant part of the kernel to H0.
   pure subroutine close_border(system, x)
      class(bordered_system_t), intent(in) :: system
      real(wp), intent(inout) :: x(:)
      real(wp) :: shift

      associate (n => system%n)
         shift = (dot_product(system%weights, x(1:n - 1)) - x(n))/system%column_load
         x(1:n - 1) = x(1:n - 1) - shift*system%column_solution
         x(n) = shift - system%constant*x(n)
      end associate
   end subroutine close_border

end module bordered_system

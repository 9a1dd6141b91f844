!> LU of a semiseparable matrix plus two outer diagonals on each side, in O(n (q + 2)^2) and without
!> pivoting:
!>
!>     A(i,j) = sum_l lower(l,i) decay(l,i-1) ... decay(l,j+1) onward(l,j), j < i;
!>              diagonal(i), j = i;
!>              sum_l upper(l,i) decay(l,i) ... decay(l,j-2) backward(l,j), j > i
!>
!> and slots q+1, q+2 of `lower` and `upper` add to the entries at distance 1 and 2. One sweep
!> eliminates, carrying the (q+2)x(q+2) matrix that rows above pass to those below. Idea: Vandebril,
!> Van Barel & Mastronardi, Matrix Computations and Semiseparable Matrices, 2008, chapter 4.
module semiseparable
   use exponential_sum, only: q => terms
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: semiseparable_t, new_semiseparable, factor_semiseparable, solve_semiseparable, &
      solve_transposed, solve_two

   !> Width of the generators: exponentials and two outer diagonals. A constant, so that the
   !> compiler unrolls all loops over it: a third less time for the factors, nearly half for a
   !> solution.
   integer, parameter :: m = q + 2

   !> The matrix and its factors, for n rows and q exponentials.
   type :: semiseparable_t
      integer :: n = 0
      !> Decay of the exponentials from row i to i+1; what column i adds to them for the rows from
      !> i+1 on; and for those up to i-1: (q, n, 3), or (q, 1, 3) where all rows are alike.
      real(wp), allocatable :: columns(:, :, :)
      !> Rows of the matrix (q+2, n); (q+2, n); (n). `upper` is overwritten by the factors.
      real(wp), allocatable :: lower(:, :), upper(:, :), diagonal(:)
      !> Factors (q+2, n), and the inverse pivots (n).
      real(wp), allocatable, private :: carry(:, :), inverse_pivot(:)
   end type semiseparable_t

contains

   !> Allocates storage for n rows with exponentials of the given generators.
   pure subroutine new_semiseparable(matrix, n, decay, onward, backward)
      type(semiseparable_t), intent(out) :: matrix
      integer, intent(in) :: n
      real(wp), intent(in) :: decay(:, :), onward(:, :), backward(:, :)

      matrix%n = n
      allocate (matrix%columns(q, size(decay, 2), 3))
      matrix%columns(:, :, 1) = decay
      matrix%columns(:, :, 2) = onward
      matrix%columns(:, :, 3) = backward
      allocate (matrix%lower(m, n), matrix%upper(m, n), matrix%diagonal(n), matrix%carry(m, n), &
         matrix%inverse_pivot(n))
   end subroutine new_semiseparable

   !> Factors the matrix in place. `smallest_pivot` is the smallest |pivot|: 0 means singular.
   pure subroutine factor_semiseparable(matrix, smallest_pivot)
      type(semiseparable_t), intent(inout) :: matrix
      real(wp), intent(out) :: smallest_pivot

      call eliminate(matrix%columns, matrix%lower, matrix%upper, matrix%diagonal, matrix%carry, &
         matrix%inverse_pivot, smallest_pivot)
   end subroutine factor_semiseparable

   !> The sweep, on plain arrays, which the compiler knows to be apart; `upper` becomes the rows of
   !> U over their pivots.
   !>
   !> What the rows above leave for row i is W = sum over slots r of lower(r,i) times column r: `z`
   !> its part in the exponentials, as they are at row i-1; `at` and `ahead` in the columns i and
   !> i+1.
   pure subroutine eliminate(columns, lower, upper, diagonal, eta, inverse_pivot, smallest_pivot)
      real(wp), intent(in), contiguous :: columns(:, :, :), diagonal(:)
      real(wp), intent(in) :: lower(m, size(diagonal))
      real(wp), intent(inout) :: upper(m, size(diagonal))
      real(wp), intent(out) :: eta(m, size(diagonal)), inverse_pivot(size(diagonal)), smallest_pivot
      real(wp) :: z(q, m), decay(q, q), rho(q), before(q), passed(q), total, next, pivot
      real(wp), dimension(m) :: at, ahead, sums, row, carry
      integer :: i, k, l, r

      z = 0.0_wp
      at = 0.0_wp
      ahead = 0.0_wp
      smallest_pivot = huge(1.0_wp)
      do i = 1, size(diagonal)
         k = min(i, size(columns, 2))
         if (k > 1 .or. i == 1) then
            before = columns(:, max(k - 1, 1), 1)
            rho = columns(:, k, 1)
            do r = 1, q
               decay(:, r) = before*rho(r)
            end do
         end if
         passed = 0.0_wp
         do r = 1, m
            total = 0.0_wp
            !$omp simd reduction(+:total)
            do l = 1, q
               total = total + columns(l, k, 3)*z(l, r)
               passed(l) = passed(l) + lower(r, i)*z(l, r)
            end do
            sums(r) = total + at(r)
         end do
         total = 0.0_wp
         next = 0.0_wp
         !$omp simd reduction(+:total, next)
         do r = 1, m
            total = total + lower(r, i)*sums(r)
            next = next + lower(r, i)*ahead(r)
         end do
         row = upper(:, i)
         row(1:q) = row(1:q) + before*passed
         row(q + 1) = row(q + 1) + next
         pivot = diagonal(i) + total
         smallest_pivot = min(smallest_pivot, abs(pivot))
         if (.not. smallest_pivot > 0.0_wp) return
         inverse_pivot(i) = 1.0_wp/pivot
         row = row*inverse_pivot(i)
         upper(:, i) = row
         carry = [rho*sums(1:q) + columns(:, k, 2), 1.0_wp, sums(q + 1)]
         eta(:, i) = carry
         z(:, q + 2) = before*z(:, q + 1) - carry(q + 2)*row(1:q)
         z(:, q + 1) = -row(1:q)
         do r = 1, q
            !$omp simd
            do l = 1, q
               z(l, r) = decay(l, r)*z(l, r) - carry(r)*row(l)
            end do
         end do
         at = [rho*ahead(1:q), 0.0_wp, ahead(q + 1)] - carry*row(q + 1)
         ahead = -carry*row(q + 2)
      end do
   end subroutine eliminate

   !> Solves A x = b with the factors; `x` (n) holds b on entry.
   pure subroutine solve_semiseparable(matrix, x)
      type(semiseparable_t), intent(in) :: matrix
      real(wp), intent(inout), contiguous :: x(:)

      call substitute_one(matrix%n, matrix%columns, matrix%lower, matrix%upper, matrix%carry, &
         matrix%inverse_pivot, x)
   end subroutine solve_semiseparable

   !> Solves for two right sides at once: `x` (2, n) holds them on entry. A sweep waits for one
   !> value after the other, so that the second side costs a third of the first.
   pure subroutine solve_two(matrix, x)
      type(semiseparable_t), intent(in) :: matrix
      real(wp), intent(inout), contiguous :: x(:, :)

      call substitute_two(matrix%n, matrix%columns, matrix%lower, matrix%upper, matrix%carry, &
         matrix%inverse_pivot, x)
   end subroutine solve_two

   !> Solves A^T x = b with the factors of A; `x` (n) holds b on entry.
   pure subroutine solve_transposed(matrix, x)
      type(semiseparable_t), intent(in) :: matrix
      real(wp), intent(inout), contiguous :: x(:)
      real(wp) :: state(m)
      integer :: i, k

      associate (lower => matrix%lower, upper => matrix%upper)
         state = 0.0_wp
         do i = 1, matrix%n   ! columns of U, whose rows are over their pivots
            k = min(i, size(matrix%columns, 2))
            x(i) = x(i) - dot_product(matrix%columns(:, k, 3), state(:q)) - state(q + 1)
            if (i > 1) k = min(i - 1, k)
            state(:q) = matrix%columns(:, k, 1)*state(:q) + upper(:q, i)*x(i)
            state(q + 1) = state(q + 2) + upper(q + 1, i)*x(i)
            state(q + 2) = upper(q + 2, i)*x(i)
         end do
         state = 0.0_wp
         do i = matrix%n, 1, -1   ! columns of L
            k = min(i, size(matrix%columns, 2))
            x(i) = (x(i) - dot_product(matrix%carry(:, i), state))*matrix%inverse_pivot(i)
            state(:q) = matrix%columns(:, k, 1)*state(:q) + lower(:q, i)*x(i)
            state(q + 1) = state(q + 2) + lower(q + 1, i)*x(i)
            state(q + 2) = lower(q + 2, i)*x(i)
         end do
      end associate
   end subroutine solve_transposed

   !> Forward and backward substitution on plain arrays. Sums are formed in two independent parts.
   pure subroutine substitute_one(n, columns, lower, upper, eta, inverse_pivot, x)
      integer, parameter :: k = 1
      include 'substitution.inc'
   end subroutine substitute_one

   !> The same for two right sides.
   pure subroutine substitute_two(n, columns, lower, upper, eta, inverse_pivot, x)
      integer, parameter :: k = 2
      include 'substitution.inc'
   end subroutine substitute_two

end module semiseparable

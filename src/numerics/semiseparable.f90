!> LU of a semiseparable matrix plus two outer diagonals on each side, in O(n (q + 2)^2) and without
!> pivoting:
!>
!>     A(i,j) = sum_l lower(l,i) ratio(l)^(i-j), j < i;   diagonal(i), j = i;
!>              sum_l upper(l,i) ratio(l)^(j-i), j > i
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
      solve_two

   !> Width of the generators: exponentials and two outer diagonals. A constant, so that the
   !> compiler unrolls all loops over it: a third less time for the factors, nearly half for a
   !> solution.
   integer, parameter :: m = q + 2

   !> The matrix and its factors, for n rows and q exponentials.
   type :: semiseparable_t
      integer :: n = 0
      !> Ratios of the exponentials.
      real(wp) :: ratio(q) = 0.0_wp
      !> Rows of the matrix (q+2, n); (q+2, n); (n). `upper` is overwritten by the factors.
      real(wp), allocatable :: lower(:, :), upper(:, :), diagonal(:)
      !> Factors (q+2, n), and the inverse pivots (n).
      real(wp), allocatable, private :: carry(:, :), inverse_pivot(:)
   end type semiseparable_t

contains

   !> Allocates storage for n rows with exponentials of the given ratios.
   pure subroutine new_semiseparable(matrix, n, ratio)
      type(semiseparable_t), intent(inout) :: matrix
      integer, intent(in) :: n
      real(wp), intent(in) :: ratio(q)

      matrix%n = n
      matrix%ratio = ratio
      if (allocated(matrix%lower)) then
         deallocate (matrix%lower, matrix%upper, matrix%diagonal, matrix%carry, &
            matrix%inverse_pivot)
      end if
      allocate (matrix%lower(m, n), matrix%upper(m, n), matrix%diagonal(n), matrix%carry(m, n), &
         matrix%inverse_pivot(n))
   end subroutine new_semiseparable

   !> Factors the matrix in place. `smallest_pivot` is the smallest |pivot|: 0 means singular.
   pure subroutine factor_semiseparable(matrix, smallest_pivot)
      type(semiseparable_t), intent(inout) :: matrix
      real(wp), intent(out) :: smallest_pivot

      call eliminate(matrix%n, matrix%ratio, matrix%lower, matrix%upper, matrix%diagonal, &
         matrix%carry, matrix%inverse_pivot, smallest_pivot)
   end subroutine factor_semiseparable

   !> The sweep, on plain arrays, which the compiler knows to be apart; `upper` becomes the rows of
   !> U over their pivots.
   !>
   !> What the rows above leave for row i is W = sum over slots r of lower(r,i) times column r: `z`
   !> its part in the exponentials, `at` and `ahead` in the columns i and i+1.
   ! allow(too-many-arguments)  the parts of one matrix
   pure subroutine eliminate(n, rho, lower, upper, diagonal, eta, inverse_pivot, smallest_pivot)
      integer, intent(in) :: n
      real(wp), intent(in) :: rho(q), lower(m, n), diagonal(n)
      real(wp), intent(inout) :: upper(m, n)
      real(wp), intent(out) :: eta(m, n), inverse_pivot(n), smallest_pivot
      real(wp) :: z(q, m), decay(q, q), at(m), ahead(m), sums(m), row(m), left(q), carry(m), &
         total, next, pivot
      integer :: i, l, r

      do r = 1, q
         decay(:, r) = rho*rho(r)
      end do
      z = 0.0_wp
      at = 0.0_wp
      ahead = 0.0_wp
      smallest_pivot = huge(1.0_wp)
      do i = 1, n
         row = upper(:, i)
         do r = 1, m
            total = 0.0_wp
            !$omp simd reduction(+:total)
            do l = 1, q
               total = total + z(l, r)
               row(l) = row(l) + lower(r, i)*z(l, r)
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
         row(q + 1) = row(q + 1) + next
         pivot = diagonal(i) + total
         smallest_pivot = min(smallest_pivot, abs(pivot))
         if (.not. smallest_pivot > 0.0_wp) return
         inverse_pivot(i) = 1.0_wp/pivot
         row = row*inverse_pivot(i)
         upper(:, i) = row
         carry = [rho*(sums(1:q) + 1.0_wp), 1.0_wp, sums(q + 1)]
         eta(:, i) = carry
         left = rho*row(1:q)
         z(:, q + 2) = rho*z(:, q + 1) - carry(q + 2)*left
         z(:, q + 1) = -left
         do r = 1, q
            !$omp simd
            do l = 1, q
               z(l, r) = decay(l, r)*z(l, r) - carry(r)*left(l)
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

      call substitute_one(matrix%n, matrix%ratio, matrix%lower, matrix%upper, matrix%carry, &
         matrix%inverse_pivot, x)
   end subroutine solve_semiseparable

   !> Solves for two right sides at once: `x` (2, n) holds them on entry. A sweep waits for one
   !> value after the other, so that the second side costs a third of the first.
   pure subroutine solve_two(matrix, x)
      type(semiseparable_t), intent(in) :: matrix
      real(wp), intent(inout), contiguous :: x(:, :)

      call substitute_two(matrix%n, matrix%ratio, matrix%lower, matrix%upper, matrix%carry, &
         matrix%inverse_pivot, x)
   end subroutine solve_two

   !> Forward and backward substitution on plain arrays. Sums are formed in two independent parts.
   pure subroutine substitute_one(n, rho, lower, upper, eta, inverse_pivot, x)
      integer, parameter :: k = 1
      include 'substitution.inc'
   end subroutine substitute_one

   !> The same for two right sides.
   pure subroutine substitute_two(n, rho, lower, upper, eta, inverse_pivot, x)
      integer, parameter :: k = 2
      include 'substitution.inc'
   end subroutine substitute_two

end module semiseparable

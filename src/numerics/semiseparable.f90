!> LU of a semiseparable matrix plus two outer diagonals on each side, in O(n (q + 2)^2) and without pivoting:
!>
!>     A(i,j) = sum_l lower(l,i) ratio(l)^(i-j), j < i;   diagonal(i), j = i;   sum_l upper(l,i) ratio(l)^(j-i), j > i
!>
!> and slots q+1, q+2 of `lower` and `upper` add to the entries at distance 1 and 2. One sweep eliminates, carrying the
!> (q+2)x(q+2) matrix of what the rows above leave for those below.
!> Idea: Vandebril, Van Barel & Mastronardi, Matrix Computations and Semiseparable Matrices, 2008, chapter 4.
module semiseparable
   use exponential_sum, only: q => terms
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: semiseparable_t, new_semiseparable, factor_semiseparable, solve_semiseparable

   !> Width of the generators: exponentials and two outer diagonals. Known to the compiler, which unrolls all loops over it: a
   !> third less time for the factors, nearly half for a solution.
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

   !> Storage for n rows with exponentials of the given ratios.
   pure subroutine new_semiseparable(matrix, n, ratio)
      type(semiseparable_t), intent(inout) :: matrix
      integer, intent(in) :: n
      real(wp), intent(in) :: ratio(q)

      matrix%n = n
      matrix%ratio = ratio
      if (allocated(matrix%lower)) then
         deallocate (matrix%lower, matrix%upper, matrix%diagonal, matrix%carry, matrix%inverse_pivot)
      end if
      allocate (matrix%lower(m, n), matrix%upper(m, n), matrix%diagonal(n), matrix%carry(m, n), matrix%inverse_pivot(n))
   end subroutine new_semiseparable

   !> Factors the matrix in place. `smallest_pivot` is the smallest |pivot|: 0 means singular.
   pure subroutine factor_semiseparable(matrix, smallest_pivot)
      type(semiseparable_t), intent(inout) :: matrix
      real(wp), intent(out) :: smallest_pivot
      real(wp) :: w(m, m), pivot
      integer :: i

      smallest_pivot = huge(1.0_wp)
      w = 0.0_wp
      do i = 1, matrix%n
         pivot = matrix%diagonal(i)
         call eliminate_row(matrix%ratio, matrix%lower(:, i), w, matrix%upper(:, i), matrix%carry(:, i), pivot)
         smallest_pivot = min(smallest_pivot, abs(pivot))
         if (.not. smallest_pivot > 0.0_wp) return
         matrix%inverse_pivot(i) = 1.0_wp/pivot
      end do
   end subroutine factor_semiseparable

   !> One row: `w` is what the rows above leave, and becomes what this one leaves; `row` becomes the row of U over its pivot,
   !> `pivot` (the diagonal on entry) that pivot; a zero one ends it.
   !> Sums are formed in two parts, of which neither waits for the other.
   pure subroutine eliminate_row(rho, lower, w, row, eta, pivot)
      real(wp), intent(in) :: rho(q), lower(m)
      real(wp), intent(inout) :: w(m, m), row(m), pivot
      real(wp), intent(out) :: eta(m)
      real(wp) :: z(m, m), sums(m), odd, even, inverse
      integer :: l, r

      do r = 1, m
         odd = w(q + 1, r)
         even = 0.0_wp
         do l = 1, q, 2
            z(l, r) = w(l, r)*rho(l)
            z(l + 1, r) = w(l + 1, r)*rho(l + 1)
            odd = odd + z(l, r)
            even = even + z(l + 1, r)
            row(l) = row(l) + lower(r)*z(l, r)
            row(l + 1) = row(l + 1) + lower(r)*z(l + 1, r)
         end do
         z(q + 1, r) = w(q + 2, r)
         z(q + 2, r) = 0.0_wp
         row(q + 1) = row(q + 1) + lower(r)*z(q + 1, r)
         sums(r) = odd + even
      end do
      odd = 0.0_wp
      even = 0.0_wp
      do r = 1, m, 2
         odd = odd + lower(r)*sums(r)
         even = even + lower(r + 1)*sums(r + 1)
      end do
      pivot = pivot + (odd + even)
      if (.not. abs(pivot) > 0.0_wp) return
      inverse = 1.0_wp/pivot
      row = row*inverse
      eta(1:q) = rho*(sums(1:q) + 1.0_wp)
      eta(q + 1) = 1.0_wp
      eta(q + 2) = sums(q + 1)
      do r = 1, q
         w(:, r) = rho(r)*z(:, r) - eta(r)*row
      end do
      w(:, q + 1) = -row
      w(:, q + 2) = z(:, q + 1) - eta(q + 2)*row
   end subroutine eliminate_row

   !> Solves A x = b with the factors; `x` (n) holds b on entry.
   pure subroutine solve_semiseparable(matrix, x)
      type(semiseparable_t), intent(in) :: matrix
      real(wp), intent(inout), contiguous :: x(:)

      call substitute(matrix%n, matrix%ratio, matrix%lower, matrix%upper, matrix%carry, matrix%inverse_pivot, x)
   end subroutine solve_semiseparable

   !> Forward and backward substitution on plain arrays, which the compiler knows to be apart; sums as in `eliminate_row`.
   pure subroutine substitute(n, rho, lower, upper, eta, inverse_pivot, x)
      integer, intent(in) :: n
      real(wp), intent(in) :: rho(q), lower(m, n), upper(m, n), eta(m, n), inverse_pivot(n)
      real(wp), intent(inout) :: x(n)
      real(wp) :: state(m), odd, even, value
      integer :: i, l

      state = 0.0_wp
      do i = 1, n
         odd = 0.0_wp
         even = 0.0_wp
         do l = 1, m, 2
            odd = odd + lower(l, i)*state(l)
            even = even + lower(l + 1, i)*state(l + 1)
         end do
         value = (x(i) - (odd + even))*inverse_pivot(i)
         x(i) = value
         do l = 1, q
            state(l) = rho(l)*state(l) + eta(l, i)*value
         end do
         state(q + 2) = state(q + 1) + eta(q + 2, i)*value
         state(q + 1) = value
      end do
      state = 0.0_wp
      do i = n, 1, -1
         odd = 0.0_wp
         even = 0.0_wp
         do l = 1, m, 2
            odd = odd + upper(l, i)*state(l)
            even = even + upper(l + 1, i)*state(l + 1)
         end do
         value = x(i) - (odd + even)
         x(i) = value
         do l = 1, q
            state(l) = rho(l)*(state(l) + value)
         end do
         state(q + 2) = state(q + 1)
         state(q + 1) = value
      end do
   end subroutine substitute

end module semiseparable

!> LU of a semiseparable matrix plus two outer diagonals on each side, in O(n (q + 2)^2) and without pivoting:
!>
!>     A(i,j) = sum_l lower(l,i) ratio(l)^(i-j), j < i;   diagonal(i), j = i;   sum_l upper(l,i) ratio(l)^(j-i), j > i
!>
!> and slots q+1, q+2 of `lower` and `upper` add to the entries at distance 1 and 2. One sweep eliminates, carrying the
!> (q+2)x(q+2) matrix of what the rows above leave for those below.
!> Idea: Vandebril, Van Barel & Mastronardi, Matrix Computations and Semiseparable Matrices, 2008, chapter 4.
module semiseparable
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: semiseparable_t, new_semiseparable, factor_semiseparable, solve_semiseparable

   !> The matrix and its factors, for n rows and q exponentials.
   type :: semiseparable_t
      integer :: n = 0, q = 0
      !> Ratios of the exponentials (q).
      real(wp), allocatable :: ratio(:)
      !> Rows of the matrix (q+2, n); (q+2, n); (n). `upper` is overwritten by the factors.
      real(wp), allocatable :: lower(:, :), upper(:, :), diagonal(:)
      !> Factors (q+2, n), and the inverse pivots (n).
      real(wp), allocatable, private :: carry(:, :), inverse_pivot(:)
   end type semiseparable_t

contains

   !> Storage for n rows with exponentials of the given ratios (q).
   pure subroutine new_semiseparable(matrix, n, ratio)
      type(semiseparable_t), intent(inout) :: matrix
      integer, intent(in) :: n
      real(wp), intent(in) :: ratio(:)
      integer :: m

      m = size(ratio) + 2
      matrix%n = n
      matrix%q = size(ratio)
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
      real(wp), dimension(matrix%q + 2, matrix%q + 2) :: w, z
      real(wp), dimension(matrix%q + 2) :: sums, row, eta
      real(wp) :: rho(matrix%q), pivot, factor, total
      integer :: i, l, m, q, r

      q = matrix%q
      m = q + 2
      rho = matrix%ratio
      smallest_pivot = huge(1.0_wp)
      w = 0.0_wp
      z = 0.0_wp
      do i = 1, matrix%n
         row = matrix%upper(:, i)
         pivot = matrix%diagonal(i)
         do r = 1, m
            factor = matrix%lower(r, i)
            total = w(q + 1, r)
            do l = 1, q
               z(l, r) = w(l, r)*rho(l)
               total = total + z(l, r)
               row(l) = row(l) + factor*z(l, r)
            end do
            sums(r) = total
            z(q + 1, r) = w(q + 2, r)
            row(q + 1) = row(q + 1) + factor*z(q + 1, r)
            pivot = pivot + factor*total
         end do
         smallest_pivot = min(smallest_pivot, abs(pivot))
         if (.not. smallest_pivot > 0.0_wp) return
         row = row/pivot
         eta(1:q) = rho*(sums(1:q) + 1.0_wp)
         eta(q + 1) = 1.0_wp
         eta(q + 2) = sums(q + 1)
         do r = 1, q
            w(:, r) = rho(r)*z(:, r) - eta(r)*row
         end do
         w(:, q + 2) = z(:, q + 1) - eta(q + 2)*row
         w(:, q + 1) = -row
         matrix%inverse_pivot(i) = 1.0_wp/pivot
         matrix%carry(:, i) = eta
         matrix%upper(:, i) = row
      end do
   end subroutine factor_semiseparable

   !> Solves A x = b with the factors; `x` (n) holds b on entry.
   pure subroutine solve_semiseparable(matrix, x)
      type(semiseparable_t), intent(in) :: matrix
      real(wp), intent(inout) :: x(:)
      real(wp) :: state(matrix%q + 2), last
      integer :: i, q

      q = matrix%q
      associate (rho => matrix%ratio, eta => matrix%carry)
         state = 0.0_wp
         do i = 1, matrix%n
            x(i) = (x(i) - dot_product(matrix%lower(:, i), state))*matrix%inverse_pivot(i)
            last = state(q + 1)
            state(1:q) = rho*state(1:q) + eta(1:q, i)*x(i)
            state(q + 1) = x(i)
            state(q + 2) = last + eta(q + 2, i)*x(i)
         end do
         state = 0.0_wp
         do i = matrix%n, 1, -1
            x(i) = x(i) - dot_product(matrix%upper(:, i), state)
            state(q + 2) = state(q + 1)
            state(1:q) = rho*(state(1:q) + x(i))
            state(q + 1) = x(i)
         end do
      end associate
   end subroutine solve_semiseparable

end module semiseparable

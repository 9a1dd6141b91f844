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
!>
!> A slowly varying kernel as a constant minus a sum of exponentials, by linear least squares.
module semiseparable
   use errors, only: error_t, fail, internal_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: exponential_sum_t, factor_semiseparable, fit_exponentials, new_semiseparable, &
      sample_points, semiseparable_t, solve_semiseparable, solve_transposed, solve_two

   !> Number of exponentials, even; decay rates are then a factor of 3.6 apart on 1024 intervals and
   !> 10 on 2^20. Measured on up to 2^17 intervals: with a number that grows as ln n GMRES takes the
   !> same iterations, with six it takes more.
   integer, parameter, public :: terms = 8
   integer, parameter :: q = terms

   !> kappa(d) ~ constant - sum_l weight(l) exp(-rate(l) d), d = 0..n.
   type :: exponential_sum_t
      real(wp) :: constant = 0.0_wp
      !> Any sign, and positive.
      real(wp) :: weight(terms) = 0.0_wp, rate(terms) = 0.0_wp
   end type exponential_sum_t

   !> Decay rates are spread geometrically from `slowest`/(largest distance) to `fastest`.
   real(wp), parameter :: slowest = 0.5_wp, fastest = 4.0_wp
   !> Fitted are all indices below `dense_points`, then about `sparse_points` spread
   !> logarithmically; the first ones weigh more.
   integer, parameter :: dense_points = 30, sparse_points = 50, heavy_points = 3
   real(wp), parameter :: heavy_weight = 5.0_wp
   !> Singular values below this share of the largest are dropped.
   real(wp), parameter :: rank_tolerance = 1.0e-13_wp

   interface
      !> Minimum-norm least squares by complete orthogonal factorisation (LAPACK).
      subroutine dgelsy(m, n, nrhs, a, lda, b, ldb, jpvt, rcond, rank, work, lwork, info)
         import :: wp
         integer, intent(in) :: m, n, nrhs, lda, ldb, lwork
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(inout) :: jpvt(*)
         real(wp), intent(in) :: rcond
         integer, intent(out) :: rank, info
         real(wp), intent(out) :: work(*)
      end subroutine dgelsy
   end interface

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

   !> Indices j in 0..n of the fit: rising, the last one n.
   pure function sample_points(n) result(points)
      integer, intent(in) :: n
      integer, allocatable :: points(:)
      integer :: candidates(dense_points + sparse_points + 1), count, j

      candidates(:dense_points) = [(j, j=0, dense_points - 1)]
      candidates(dense_points + 1:) = [(nint(dense_points*(real(n, wp)/dense_points)**(real(j, wp) &
         /sparse_points)), j=0, sparse_points)]
      count = 1
      do j = 2, size(candidates)
         if (candidates(j) <= candidates(count) .or. candidates(j) > n) cycle
         count = count + 1
         candidates(count) = candidates(j)
      end do
      allocate (points, source=candidates(:count))
   end function sample_points

   !> Fits a kernel, its `values` at rising `points`, which begin with about 0, 1, 2, to about 1 %,
   !> well near the first; exactly if there are fewer points than terms. Fails (internal_error) if
   !> LAPACK does.
   subroutine fit_exponentials(points, values, fit, error)
      real(wp), intent(in) :: points(:), values(:)
      type(exponential_sum_t), intent(out) :: fit
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: matrix(:, :), solution(:), work(:)
      integer, allocatable :: pivots(:)
      real(wp) :: longest
      integer :: l, n, rank, info

      n = size(points)
      longest = points(n)
      allocate (matrix(n, q + 1), work(64*(n + q + 1)))
      allocate (pivots(q + 1), source=0)
      do l = 1, q
         fit%rate(l) = slowest/longest*(fastest*longest/slowest)**(real(l - 1, wp)/(q - 1))
         matrix(:, l + 1) = -exp(-fit%rate(l)*points)
      end do
      matrix(:, 1) = 1.0_wp
      solution = [values, (0.0_wp, l=n, q)]   ! room for all terms
      matrix(:heavy_points, :) = heavy_weight*matrix(:heavy_points, :)
      solution(:heavy_points) = heavy_weight*solution(:heavy_points)
      ! an OpenBLAS built without threads must not be called by two threads at a time
      !$omp critical (lapack)
      call dgelsy(n, q + 1, 1, matrix, n, solution, size(solution), pivots, rank_tolerance, rank, &
         work, size(work), info)
      !$omp end critical (lapack)
      if (info /= 0) then
         call fail(error, internal_error, 'dgelsy: info = '//to_text(info))
         return
      end if
      fit%constant = solution(1)
      fit%weight = solution(2:q + 1)
   end subroutine fit_exponentials

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

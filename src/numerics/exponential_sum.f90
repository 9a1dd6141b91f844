!> A slowly varying kernel as a constant minus a sum of exponentials, by linear least squares.
module exponential_sum
   use errors, only: error_t, fail, internal_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: exponential_sum_t, fit_exponentials, sample_points

   !> Number of exponentials, even; decay rates are then a factor of 3.6 apart on 1024 intervals and
   !> 10 on 2^20. Measured on up to 2^17 intervals: with a number that grows as ln n GMRES takes the
   !> same iterations, with six it takes more.
   integer, parameter, public :: terms = 8

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
      integer, parameter :: q = terms
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

end module exponential_sum

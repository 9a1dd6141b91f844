!> Band matrices: LU factors and solutions by LAPACK.
module band_matrix
   use errors, only: error_t, fail, internal_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: band_matrix_t, clear_band, factor_band, new_band, solve_band

   !> A square matrix of order `n` with `lower` diagonals below and `upper` above the main one.
   type :: band_matrix_t
      integer :: n = 0, lower = 0, upper = 0
      !> Row `lower + upper + 1 + i - j` of column j holds A(i, j); the first `lower` rows are room
      !> for the fill-in of pivoting.
      real(wp), allocatable :: entries(:, :)
      integer, allocatable :: pivots(:)
   end type band_matrix_t

   interface
      !> LU factorisation of a band matrix with partial pivoting (LAPACK).
      subroutine dgbtrf(m, n, kl, ku, ab, ldab, ipiv, info)
         import :: wp
         integer, intent(in) :: m, n, kl, ku, ldab
         real(wp), intent(inout) :: ab(ldab, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgbtrf

      !> Solution with these factors (LAPACK).
      subroutine dgbtrs(trans, n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         import :: wp
         character(len=1), intent(in) :: trans
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb, ipiv(*)
         real(wp), intent(in) :: ab(ldab, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgbtrs
   end interface

contains

   !> Allocates a matrix of zeros.
   pure subroutine new_band(matrix, n, lower, upper)
      type(band_matrix_t), intent(out) :: matrix
      integer, intent(in) :: n, lower, upper

      matrix%n = n
      matrix%lower = lower
      matrix%upper = upper
      allocate (matrix%entries(2*lower + upper + 1, n), source=0.0_wp)
      allocate (matrix%pivots(n), source=0)
   end subroutine new_band

   !> Sets all entries to 0, after which the matrix may be filled and factored again.
   pure subroutine clear_band(matrix)
      type(band_matrix_t), intent(inout) :: matrix

      matrix%entries = 0.0_wp
   end subroutine clear_band

   !> Replaces the matrix by its factors. Error: it is singular.
   subroutine factor_band(matrix, error)
      type(band_matrix_t), intent(inout) :: matrix
      type(error_t), allocatable, intent(out) :: error
      integer :: info

      !$omp critical (lapack)
      call dgbtrf(matrix%n, matrix%n, matrix%lower, matrix%upper, matrix%entries, &
         size(matrix%entries, 1), matrix%pivots, info)
      !$omp end critical (lapack)
      if (info /= 0) call fail(error, internal_error, 'dgbtrf: matrix is singular, info = ' &
         //to_text(info))
   end subroutine factor_band

   !> Solves with the factors; `x` (n) is the right side on entry, the solution on return.
   subroutine solve_band(matrix, x)
      type(band_matrix_t), intent(in) :: matrix
      real(wp), contiguous, intent(inout) :: x(:)
      integer :: info

      !$omp critical (lapack)
      call dgbtrs('N', matrix%n, matrix%lower, matrix%upper, 1, matrix%entries, &
         size(matrix%entries, 1), matrix%pivots, x, matrix%n, info)
      !$omp end critical (lapack)
   end subroutine solve_band

end module band_matrix

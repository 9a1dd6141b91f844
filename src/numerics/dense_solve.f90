!> Dense linear systems by LAPACK.
module dense_solve
   use errors, only: error_t, fail, internal_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: solve_dense

   interface
      !> LAPACK: LU factorisation with partial pivoting and solution.
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         implicit none (type, external)
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv
   end interface

contains

   !> Solves `matrix` x = `right_side` in place: the matrix (n, n) is overwritten by its factors, the right side (n) by x.
   !> `pivots` (n) is work space. Fails (internal_error) if the matrix is singular.
   subroutine solve_dense(matrix, right_side, pivots, error)
      real(wp), contiguous, intent(inout) :: matrix(:, :)
      real(wp), contiguous, intent(inout) :: right_side(:)
      integer, contiguous, intent(inout) :: pivots(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: n, info

      n = size(right_side)
      call dgesv(n, 1, matrix, n, pivots, right_side, n, info)
      if (info /= 0) call fail(error, internal_error, "dgesv: matrix is singular, info = "//to_text(info))
   end subroutine solve_dense

end module dense_solve

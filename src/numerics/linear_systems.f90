!> Linear systems by LAPACK: dense matrices and band matrices.
module linear_systems
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
      c_null_char, c_null_ptr, c_ptr
   use errors, only: error_t, fail, internal_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: band_matrix_t, factor_band, new_band, solve_band, solve_dense, &
      solve_factored, use_one_blas_thread

   interface
      !> LU factorisation with partial pivoting, and solution (LAPACK).
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv

      !> Solution with the factors of `dgesv` (LAPACK).
      subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         character(len=1), intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgetrs
   end interface

   abstract interface
      !> Sets the number of threads of OpenBLAS.
      subroutine set_threads_interface(threads) bind(c)
         import :: c_int
         integer(c_int), value :: threads
      end subroutine set_threads_interface
   end interface

   interface
      !> C library: address of a symbol of the running program, null if there is none.
      function dlsym(handle, symbol) bind(c, name='dlsym') result(address)
         import :: c_char, c_funptr, c_ptr
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: symbol(*)
         type(c_funptr) :: address
      end function dlsym
   end interface

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

   !> Limits OpenBLAS, if that is the BLAS in use, to one thread, so that a run uses the cores it
   !> was given and its results do not depend on their number. Other BLAS libraries are not changed.
   subroutine use_one_blas_thread()
      procedure(set_threads_interface), pointer :: set_threads
      type(c_funptr) :: address

      address = dlsym(c_null_ptr, 'openblas_set_num_threads'//c_null_char)
      if (.not. c_associated(address)) return
      call c_f_procpointer(address, set_threads)
      call set_threads(1_c_int)
   end subroutine use_one_blas_thread

   !> Solves `matrix` x = `right_side` in place: the matrix (n, n) is overwritten by its factors,
   !> the right side (n) by x. `pivots` (n) is work space. Fails (internal_error) if the matrix is
   !> singular.
   subroutine solve_dense(matrix, right_side, pivots, error)
      real(wp), contiguous, intent(inout) :: matrix(:, :), right_side(:)
      integer, contiguous, intent(inout) :: pivots(:)
      type(error_t), allocatable, intent(out) :: error
      integer :: n, info

      n = size(right_side)
      !$omp critical (lapack)
      call dgesv(n, 1, matrix, n, pivots, right_side, n, info)
      !$omp end critical (lapack)
      if (info /= 0) call fail(error, internal_error, 'dgesv: matrix is singular, info = ' &
         //to_text(info))
   end subroutine solve_dense

   !> Solves again with the factors and `pivots` that `solve_dense` has left.
   subroutine solve_factored(factors, right_side, pivots)
      real(wp), contiguous, intent(in) :: factors(:, :)
      real(wp), contiguous, intent(inout) :: right_side(:)
      integer, contiguous, intent(in) :: pivots(:)
      integer :: info

      !$omp critical (lapack)
      call dgetrs('N', size(right_side), 1, factors, size(right_side), pivots, right_side, &
         size(right_side), info)   ! info: no argument is wrong
      !$omp end critical (lapack)
   end subroutine solve_factored

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

end module linear_systems

!> Dense linear systems by LAPACK.
module dense_solve
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_f_procpointer, c_funptr, c_int, &
      c_null_char, c_null_ptr, c_ptr
   use errors, only: error_t, fail, internal_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: solve_dense, solve_factored, use_one_blas_thread

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

end module dense_solve

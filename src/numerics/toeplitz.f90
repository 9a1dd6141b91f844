!> Product of a symmetric Toeplitz matrix with a vector in O(n log n) by FFTW.
!>
!> The matrix is embedded in a circulant, whose eigenvalues are the real, even transform of its
!> first column (Golub & Van Loan, Matrix Computations, 4th ed., section 4.8). Plans are made once,
!> by FFTW_ESTIMATE: its choice does not depend on timing, so that a repeated run gives the same
!> bits.
module toeplitz
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_double_complex, c_f_pointer, &
      c_int, c_loc, c_null_ptr, c_ptr, c_size_t
   use errors, only: error_t, fail, internal_error
   use fftw, only: fftw_alloc_complex, fftw_alloc_real, fftw_destroy_plan, fftw_estimate, &
      fftw_execute_dft_c2r, fftw_execute_dft_r2c, fftw_free, fftw_plan_dft_c2r_1d, &
      fftw_plan_dft_r2c_1d
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: toeplitz_t, new_toeplitz

   !> The matrix T(i,j) = column(|i-j|), i = 0..n, applied to vectors that are zero at both ends,
   !> x(0) = x(n) = 0: a transform of length 2n is then enough. Not to be copied: it owns FFTW
   !> plans.
   type :: toeplitz_t
      private
      integer :: n = 0
      type(c_ptr) :: forward = c_null_ptr
      type(c_ptr) :: backward = c_null_ptr
      real(c_double), pointer, contiguous :: values(:) => null()
      complex(c_double_complex), pointer, contiguous :: spectrum(:) => null()
      real(wp), allocatable :: eigenvalues(:)
   contains
      procedure :: apply
      final :: destroy_toeplitz
   end type toeplitz_t

contains

   !> Plans the product with the matrix whose first column is `column(0:n)`, n >= 2.
   !> Fails (internal_error) if FFTW gives no memory or no plan.
   subroutine new_toeplitz(self, column, error)
      type(toeplitz_t), intent(inout) :: self
      real(wp), intent(in) :: column(0:)
      type(error_t), allocatable, intent(out) :: error
      integer :: n
      integer(c_int) :: m
      logical :: is_planned

      call destroy_toeplitz(self)
      n = ubound(column, 1)
      m = int(2*n, c_int)
      self%n = n
      call c_f_pointer(fftw_alloc_real(int(m, c_size_t)), self%values, [m])
      call c_f_pointer(fftw_alloc_complex(int(n + 1, c_size_t)), self%spectrum, [n + 1])
      is_planned = associated(self%values) .and. associated(self%spectrum)
      if (is_planned) then
         self%forward = fftw_plan_dft_r2c_1d(m, self%values, self%spectrum, fftw_estimate)
         self%backward = fftw_plan_dft_c2r_1d(m, self%spectrum, self%values, fftw_estimate)
         is_planned = c_associated(self%forward) .and. c_associated(self%backward)
      end if
      if (.not. is_planned) then
         call fail(error, internal_error, 'FFTW: no memory or no plan for a transform of length ' &
            //to_text(m))
         return
      end if
      self%values(1:n) = column(0:n - 1)
      self%values(n + 1) = column(n)
      self%values(n + 2:m) = column(n - 1:1:-1)
      call fftw_execute_dft_r2c(self%forward, self%values, self%spectrum)
      allocate (self%eigenvalues(n + 1))
      self%eigenvalues = self%spectrum%re/m
   end subroutine new_toeplitz

   !> y = T x for x(0:n) with x(0) = x(n) = 0; y(0:n) is filled at every node.
   subroutine apply(self, x, y)
      class(toeplitz_t), intent(inout) :: self
      real(wp), intent(in) :: x(0:)
      real(wp), intent(out) :: y(0:)
      integer :: n

      n = self%n
      self%values(1:n) = x(0:n - 1)
      self%values(n + 1:) = 0.0_wp
      call fftw_execute_dft_r2c(self%forward, self%values, self%spectrum)
      self%spectrum = self%spectrum*self%eigenvalues
      call fftw_execute_dft_c2r(self%backward, self%spectrum, self%values)
      y(0:n) = self%values(1:n + 1)
   end subroutine apply

   !> Gives plans and memory back.
   subroutine destroy_toeplitz(self)
      type(toeplitz_t), intent(inout) :: self

      if (c_associated(self%forward)) call fftw_destroy_plan(self%forward)
      if (c_associated(self%backward)) call fftw_destroy_plan(self%backward)
      self%forward = c_null_ptr
      self%backward = c_null_ptr
      if (associated(self%values)) call fftw_free(c_loc(self%values))
      if (associated(self%spectrum)) call fftw_free(c_loc(self%spectrum))
      nullify (self%values, self%spectrum)
      if (allocated(self%eigenvalues)) deallocate (self%eigenvalues)
      self%n = 0
   end subroutine destroy_toeplitz

end module toeplitz

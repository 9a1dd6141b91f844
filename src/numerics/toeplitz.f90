!> Product of a symmetric Toeplitz matrix with a vector in O(n log n) by FFTW.
!>
!> The matrix is embedded in a circulant, whose eigenvalues are the real, even transform of its first column
!> (Golub & Van Loan, Matrix Computations, 4th ed., section 4.8). Plans are made once, by FFTW_ESTIMATE: its choice does
!> not depend on timing, so that a repeated run gives the same bits.
module toeplitz
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_double_complex, c_f_pointer, c_int, c_loc, c_null_ptr, &
      c_ptr, c_size_t
   use errors, only: error_t, fail, internal_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: toeplitz_t, new_toeplitz

   !> The matrix T(i,j) = column(|i-j|), i = 0..n, applied to vectors that are zero at both ends, x(0) = x(n) = 0:
   !> a transform of length 2n is then enough. Not to be copied: it owns FFTW plans.
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

   integer(c_int), parameter :: fftw_estimate = 64_c_int

   interface
      function fftw_alloc_real(n) bind(c, name='fftw_alloc_real') result(memory)
         import :: c_ptr, c_size_t
         implicit none (type, external)
         integer(c_size_t), value :: n
         type(c_ptr) :: memory
      end function fftw_alloc_real

      function fftw_alloc_complex(n) bind(c, name='fftw_alloc_complex') result(memory)
         import :: c_ptr, c_size_t
         implicit none (type, external)
         integer(c_size_t), value :: n
         type(c_ptr) :: memory
      end function fftw_alloc_complex

      subroutine fftw_free(memory) bind(c, name='fftw_free')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: memory
      end subroutine fftw_free

      function fftw_plan_dft_r2c_1d(n, in, out, flags) bind(c, name='fftw_plan_dft_r2c_1d') result(plan)
         import :: c_double, c_double_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         real(c_double), intent(out) :: in(*)
         complex(c_double_complex), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftw_plan_dft_r2c_1d

      function fftw_plan_dft_c2r_1d(n, in, out, flags) bind(c, name='fftw_plan_dft_c2r_1d') result(plan)
         import :: c_double, c_double_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         complex(c_double_complex), intent(out) :: in(*)
         real(c_double), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftw_plan_dft_c2r_1d

      subroutine fftw_execute_dft_r2c(plan, in, out) bind(c, name='fftw_execute_dft_r2c')
         import :: c_double, c_double_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         real(c_double), intent(inout) :: in(*)
         complex(c_double_complex), intent(out) :: out(*)
      end subroutine fftw_execute_dft_r2c

      subroutine fftw_execute_dft_c2r(plan, in, out) bind(c, name='fftw_execute_dft_c2r')
         import :: c_double, c_double_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         complex(c_double_complex), intent(inout) :: in(*)
         real(c_double), intent(out) :: out(*)
      end subroutine fftw_execute_dft_c2r

      subroutine fftw_destroy_plan(plan) bind(c, name='fftw_destroy_plan')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
      end subroutine fftw_destroy_plan
   end interface

contains

   !> Plans the product with the matrix whose first column is `column(0:n)`, n >= 2.
   !> Fails (internal_error) if FFTW gives no memory or no plan.
   subroutine new_toeplitz(self, column, error)
      type(toeplitz_t), intent(inout) :: self
      real(wp), intent(in) :: column(0:)
      type(error_t), allocatable, intent(out) :: error
      type(c_ptr) :: memory
      integer :: n, m

      call destroy_toeplitz(self)
      n = ubound(column, 1)
      m = 2*n
      self%n = n
      memory = fftw_alloc_real(int(m, c_size_t))
      if (c_associated(memory)) call c_f_pointer(memory, self%values, [m])
      memory = fftw_alloc_complex(int(n + 1, c_size_t))
      if (c_associated(memory)) call c_f_pointer(memory, self%spectrum, [n + 1])
      if (.not. (associated(self%values) .and. associated(self%spectrum))) then
         call fail(error, internal_error, 'FFTW: no memory for a transform of length '//to_text(m))
         return
      end if
      self%forward = fftw_plan_dft_r2c_1d(int(m, c_int), self%values, self%spectrum, fftw_estimate)
      self%backward = fftw_plan_dft_c2r_1d(int(m, c_int), self%spectrum, self%values, fftw_estimate)
      if (.not. (c_associated(self%forward) .and. c_associated(self%backward))) then
         call fail(error, internal_error, 'FFTW: no plan for a transform of length '//to_text(m))
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

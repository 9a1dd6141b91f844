!> Product of a symmetric Toeplitz matrix with a vector in O(n log n) by FFTW.
!>
!> The matrix is embedded in a circulant of length 2n, whose eigenvalues lambda(k) are the real,
!> even transform of its first column (Golub & Van Loan, Matrix Computations, 4th ed., section 4.8).
!> The 2n real values are taken as n complex ones, with those of even index as real parts: the
!> product turns their transform Z into
!>
!>   Z'(k) = (a - b sin t) Z(k) + i b cos t conj(Z(n-k)),   t = pi k/n,
!>   a = (lambda(k) + lambda(n-k))/2,   b = (lambda(k) - lambda(n-k))/2,
!>
!> as the transforms of even and odd indices, E and O, make X(k) = E + exp(-it) O and X(k+n) = E -
!> exp(-it) O. FFTW plans complex transforms in a tenth of the time of real ones; the way back is
!> the same transform of values whose real and imaginary parts are exchanged. Plans are made by
!> FFTW_ESTIMATE: its choice does not depend on timing, so that a repeated run gives the same bits.
!> Those of short transforms are made once in a process, for all matrices.
module toeplitz
   use, intrinsic :: iso_c_binding, only: c_associated, c_double_complex, c_f_pointer, &
      c_int, c_loc, c_null_ptr, c_ptr, c_size_t
   use errors, only: error_t, fail, internal_error
   use fftw, only: fftw_alloc_complex, fftw_destroy_plan, fftw_estimate, fftw_execute_dft, &
      fftw_forward, fftw_free, fftw_plan_dft_1d
   use kinds, only: pi, wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: toeplitz_t, new_toeplitz

   !> Longest transform whose plan is kept: it holds some numbers for each of its values.
   integer, parameter :: longest_kept = 4096

   !> The matrix T(i,j) = column(|i-j|), i = 0..n, applied to vectors that are zero at both ends,
   !> x(0) = x(n) = 0: a transform of length 2n then suffices. Do not copy it: it owns memory of
   !> FFTW and long plans.
   type :: toeplitz_t
      private
      integer :: n = 0
      type(c_ptr) :: plan = c_null_ptr
      !> Values by pairs, and their transform (0:n-1).
      complex(c_double_complex), pointer, contiguous :: pairs(:) => null()
      complex(c_double_complex), pointer, contiguous :: spectrum(:) => null()
      !> a - b sin t, a + b sin t and b cos t for k = 0..n/2, all over n.
      real(wp), allocatable :: own(:), mirrored(:), crossed(:)
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
      logical :: is_planned

      call destroy_toeplitz(self)
      n = ubound(column, 1)
      self%n = n
      self%pairs => new_complex(n)
      self%spectrum => new_complex(n)
      is_planned = associated(self%pairs) .and. associated(self%spectrum)
      if (is_planned) then
         !$omp critical (fftw_planner)
         call find_plan(self)
         !$omp end critical (fftw_planner)
         is_planned = c_associated(self%plan)
      end if
      if (is_planned) then
         call find_coefficients(self, column)
      else
         call fail(error, internal_error, 'FFTW: no memory or no plan for a transform of length ' &
            //to_text(n))
      end if
   end subroutine new_toeplitz

   !> Sets the plan for the length of the matrix, the kept one if it is short: FFTW needs 40 000
   !> instructions even for a plan that it has made before. One thread at a time may call this.
   subroutine find_plan(self)
      type(toeplitz_t), intent(inout) :: self
      type(c_ptr), save :: kept(longest_kept) = c_null_ptr

      if (self%n <= longest_kept) self%plan = kept(self%n)
      if (c_associated(self%plan)) return
      self%plan = fftw_plan_dft_1d(int(self%n, c_int), self%pairs, self%spectrum, fftw_forward, &
         fftw_estimate)
      if (self%n <= longest_kept) kept(self%n) = self%plan
   end subroutine find_plan

   !> Allocates (0:n-1) by FFTW, where its transforms are fastest; not associated: no memory.
   function new_complex(n) result(values)
      integer, intent(in) :: n
      complex(c_double_complex), pointer, contiguous :: values(:), from_one(:)

      call c_f_pointer(fftw_alloc_complex(int(n, c_size_t)), from_one, [n])
      nullify (values)
      if (associated(from_one)) values(0:) => from_one
   end function new_complex

   !> Computes the coefficients a -+ b sin t, b cos t of the matrix.
   subroutine find_coefficients(self, column)
      type(toeplitz_t), intent(inout) :: self
      real(wp), intent(in) :: column(0:)
      real(wp) :: circulant(0:2*self%n - 1), lambda(0:self%n)
      real(wp), dimension(0:self%n/2) :: a, b, angle
      complex(wp) :: even, odd
      integer :: k

      associate (n => self%n)
         circulant(:n) = column
         circulant(n + 1:) = column(n - 1:1:-1)
         self%pairs = cmplx(circulant(0::2), circulant(1::2), wp)
         call fftw_execute_dft(self%plan, self%pairs, self%spectrum)
         do k = 0, n
            associate (z => self%spectrum(modulo(k, n)), c => conjg(self%spectrum(modulo(-k, n))))
               even = 0.5_wp*(z + c)
               odd = cmplx(0.0_wp, -0.5_wp, wp)*(z - c)
            end associate
            lambda(k) = even%re + real(exp(cmplx(0.0_wp, -pi*k/n, wp))*odd, wp)
         end do
         a = 0.5_wp*(lambda(:n/2) + lambda(n:n - n/2:-1))/n
         b = 0.5_wp*(lambda(:n/2) - lambda(n:n - n/2:-1))/n
         angle = [(pi*k/n, k=0, n/2)]
      end associate
      self%own = a - b*sin(angle)
      self%mirrored = a + b*sin(angle)
      self%crossed = b*cos(angle)
   end subroutine find_coefficients

   !> Computes y = T x for x(0:n) with x(0) = x(n) = 0; y(0:n) is filled at every node.
   subroutine apply(self, x, y)
      class(toeplitz_t), intent(inout) :: self
      real(wp), intent(in) :: x(0:)
      real(wp), intent(out) :: y(0:)
      integer :: half, n

      n = self%n
      half = (n + 1)/2
      self%pairs(:half - 1) = cmplx(x(0:2*half - 2:2), x(1:2*half - 1:2), wp)
      self%pairs(half:) = (0.0_wp, 0.0_wp)
      call fftw_execute_dft(self%plan, self%pairs, self%spectrum)
      call multiply(self%spectrum, self%own, self%mirrored, self%crossed)
      call fftw_execute_dft(self%plan, self%spectrum, self%pairs)
      y(0:n:2) = self%pairs(:n/2)%im
      y(1:n:2) = self%pairs(:half - 1)%re
   end subroutine apply

   !> Replaces `z` (0:n-1) by Z'(k) and Z'(n-k), real and imaginary parts exchanged. (By parts: a
   !> real times a complex number is compiled as the product of two complex ones.)
   pure subroutine multiply(z, own, mirrored, crossed)
      complex(wp), intent(inout) :: z(0:)
      real(wp), intent(in) :: own(0:), mirrored(0:), crossed(0:)
      complex(wp) :: first, last
      integer :: k, n

      n = size(z)
      ! k = 0 and, if n is even, n/2 pair with themselves; i conj(z) = (im z, re z)
      z(0) = own(0)*cmplx(z(0)%im, z(0)%re, wp) + crossed(0)*z(0)
      if (modulo(n, 2) == 0) z(n/2) = own(n/2)*cmplx(z(n/2)%im, z(n/2)%re, wp)
      do k = 1, (n - 1)/2
         first = z(k)
         last = z(n - k)
         z(k) = cmplx(own(k)*first%im + crossed(k)*last%re, own(k)*first%re &
            + crossed(k)*last%im, wp)
         z(n - k) = cmplx(mirrored(k)*last%im + crossed(k)*first%re, mirrored(k)*last%re &
            + crossed(k)*first%im, wp)
      end do
   end subroutine multiply

   !> Releases plan and memory.
   subroutine destroy_toeplitz(self)
      type(toeplitz_t), intent(inout) :: self

      if (self%n > longest_kept) then
         !$omp critical (fftw_planner)
         if (c_associated(self%plan)) call fftw_destroy_plan(self%plan)
         !$omp end critical (fftw_planner)
      end if
      self%plan = c_null_ptr
      if (associated(self%pairs)) call fftw_free(c_loc(self%pairs))
      if (associated(self%spectrum)) call fftw_free(c_loc(self%spectrum))
      nullify (self%pairs, self%spectrum)
      self%n = 0
   end subroutine destroy_toeplitz

end module toeplitz

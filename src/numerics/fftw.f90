!> The routines of FFTW 3 that the project uses, in double (fftw_) and single precision (fftwf_).
!>
!> A transform of real values keeps the first half of the first (fastest) dimension of the spectrum;
!> dimensions are given in the order of C, the fastest last. Neither direction is normalised. The
!> real input of a transform out of place is kept, the complex one is destroyed. Planning is not
!> safe between threads and overwrites the arrays unless by `fftw_estimate`.
module fftw
   use, intrinsic :: iso_c_binding, only: c_double, c_double_complex, c_float, c_float_complex, &
      c_int, c_ptr, c_size_t
   implicit none (type, external)
   private

   public :: fftw_alloc_real, fftw_alloc_complex, fftw_free, fftw_plan_dft_r2c, fftw_plan_dft_c2r, &
      fftw_execute_dft_r2c, fftw_execute_dft_c2r, fftw_destroy_plan, fftw_plan_dft_r2c_1d, &
      fftw_plan_dft_c2r_1d, fftw_plan_dft_1d, fftw_execute_dft, fftwf_alloc_real, &
      fftwf_alloc_complex, fftwf_free, fftwf_plan_dft_r2c_1d, fftwf_plan_dft_c2r_1d, &
      fftwf_plan_dft_1d, fftwf_execute_dft, fftwf_execute_dft_r2c, fftwf_execute_dft_c2r, &
      fftwf_destroy_plan

   !> Plan by rule, not by timing: a repeated run gives the same bits.
   integer(c_int), parameter, public :: fftw_estimate = 64_c_int
   !> Signs of the exponent of complex transforms.
   integer(c_int), parameter, public :: fftw_forward = -1_c_int, fftw_backward = 1_c_int

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

      function fftw_plan_dft_r2c_1d(n, in, out, flags) bind(c, &
         name='fftw_plan_dft_r2c_1d') result(plan)
         import :: c_double, c_double_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         real(c_double), intent(out) :: in(*)
         complex(c_double_complex), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftw_plan_dft_r2c_1d

      function fftw_plan_dft_c2r_1d(n, in, out, flags) bind(c, &
         name='fftw_plan_dft_c2r_1d') result(plan)
         import :: c_double, c_double_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         complex(c_double_complex), intent(out) :: in(*)
         real(c_double), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftw_plan_dft_c2r_1d

      function fftw_plan_dft_r2c(rank, n, in, out, flags) bind(c, &
         name='fftw_plan_dft_r2c') result(plan)
         import :: c_double, c_double_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: rank
         integer(c_int), intent(in) :: n(*)
         real(c_double), intent(out) :: in(*)
         complex(c_double_complex), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftw_plan_dft_r2c

      function fftw_plan_dft_c2r(rank, n, in, out, flags) bind(c, &
         name='fftw_plan_dft_c2r') result(plan)
         import :: c_double, c_double_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: rank
         integer(c_int), intent(in) :: n(*)
         complex(c_double_complex), intent(out) :: in(*)
         real(c_double), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftw_plan_dft_c2r

      subroutine fftw_execute_dft_r2c(plan, in, out) bind(c, name='fftw_execute_dft_r2c')
         import :: c_double, c_double_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         real(c_double), intent(in) :: in(*)
         complex(c_double_complex), intent(out) :: out(*)
      end subroutine fftw_execute_dft_r2c

      subroutine fftw_execute_dft_c2r(plan, in, out) bind(c, name='fftw_execute_dft_c2r')
         import :: c_double, c_double_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         complex(c_double_complex), intent(inout) :: in(*)
         real(c_double), intent(out) :: out(*)
      end subroutine fftw_execute_dft_c2r

      function fftw_plan_dft_1d(n, in, out, sign, flags) bind(c, &
         name='fftw_plan_dft_1d') result(plan)
         import :: c_double_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n, sign, flags
         complex(c_double_complex), intent(inout) :: in(*), out(*)
         type(c_ptr) :: plan
      end function fftw_plan_dft_1d

      subroutine fftw_execute_dft(plan, in, out) bind(c, name='fftw_execute_dft')
         import :: c_double_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         complex(c_double_complex), intent(inout) :: in(*), out(*)
      end subroutine fftw_execute_dft

      subroutine fftw_destroy_plan(plan) bind(c, name='fftw_destroy_plan')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
      end subroutine fftw_destroy_plan

      function fftwf_alloc_real(n) bind(c, name='fftwf_alloc_real') result(memory)
         import :: c_ptr, c_size_t
         implicit none (type, external)
         integer(c_size_t), value :: n
         type(c_ptr) :: memory
      end function fftwf_alloc_real

      function fftwf_alloc_complex(n) bind(c, name='fftwf_alloc_complex') result(memory)
         import :: c_ptr, c_size_t
         implicit none (type, external)
         integer(c_size_t), value :: n
         type(c_ptr) :: memory
      end function fftwf_alloc_complex

      subroutine fftwf_free(memory) bind(c, name='fftwf_free')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: memory
      end subroutine fftwf_free

      function fftwf_plan_dft_r2c_1d(n, in, out, flags) bind(c, &
         name='fftwf_plan_dft_r2c_1d') result(plan)
         import :: c_float, c_float_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         real(c_float), intent(out) :: in(*)
         complex(c_float_complex), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftwf_plan_dft_r2c_1d

      function fftwf_plan_dft_c2r_1d(n, in, out, flags) bind(c, &
         name='fftwf_plan_dft_c2r_1d') result(plan)
         import :: c_float, c_float_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         complex(c_float_complex), intent(out) :: in(*)
         real(c_float), intent(out) :: out(*)
         integer(c_int), value :: flags
         type(c_ptr) :: plan
      end function fftwf_plan_dft_c2r_1d

      function fftwf_plan_dft_1d(n, in, out, sign, flags) bind(c, &
         name='fftwf_plan_dft_1d') result(plan)
         import :: c_float_complex, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n, sign, flags
         complex(c_float_complex), intent(inout) :: in(*), out(*)
         type(c_ptr) :: plan
      end function fftwf_plan_dft_1d

      subroutine fftwf_execute_dft(plan, in, out) bind(c, name='fftwf_execute_dft')
         import :: c_float_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         complex(c_float_complex), intent(inout) :: in(*), out(*)
      end subroutine fftwf_execute_dft

      subroutine fftwf_execute_dft_r2c(plan, in, out) bind(c, name='fftwf_execute_dft_r2c')
         import :: c_float, c_float_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         real(c_float), intent(in) :: in(*)
         complex(c_float_complex), intent(out) :: out(*)
      end subroutine fftwf_execute_dft_r2c

      subroutine fftwf_execute_dft_c2r(plan, in, out) bind(c, name='fftwf_execute_dft_c2r')
         import :: c_float, c_float_complex, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
         complex(c_float_complex), intent(inout) :: in(*)
         real(c_float), intent(out) :: out(*)
      end subroutine fftwf_execute_dft_c2r

      subroutine fftwf_destroy_plan(plan) bind(c, name='fftwf_destroy_plan')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: plan
      end subroutine fftwf_destroy_plan

   end interface

end module fftw

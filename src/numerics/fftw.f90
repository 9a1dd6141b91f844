!> The routines of FFTW 3 that the project uses, in double (fftw_) and single precision (fftwf_), by
!> FFTW's Fortran interface.
!>
!> A transform of real values keeps the first half of the first (fastest) dimension of the spectrum;
!> dimensions are given in the order of C, the fastest last. Neither direction is normalised. An
!> out-of-place transform keeps a real input and destroys a complex one. Planning is not
!> thread-safe, and overwrites the arrays unless by `fftw_estimate`: by rules, not by timing, so
!> that a repeated run gives the same bits.
module fftw
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_double_complex, c_float, &
      c_float_complex, c_funptr, c_int, c_int32_t, c_intptr_t, c_ptr, c_size_t
   implicit none (type, external)
   private

   public :: fftw_alloc_complex, fftw_alloc_real, fftw_destroy_plan, &
      fftw_estimate, fftw_execute_dft, fftw_execute_dft_c2r, fftw_execute_dft_r2c, fftw_forward, &
      fftw_free, fftw_plan_dft_1d, fftw_plan_dft_c2r, fftw_plan_dft_c2r_1d, fftw_plan_dft_r2c, &
      fftw_plan_dft_r2c_1d, fftwf_alloc_complex, fftwf_alloc_real, fftwf_destroy_plan, &
      fftwf_execute_dft, fftwf_execute_dft_c2r, fftwf_execute_dft_r2c, fftwf_free, &
      fftwf_plan_dft_1d, fftwf_plan_dft_c2r_1d, fftwf_plan_dft_r2c_1d

   include 'fftw3.f03'
end module fftw

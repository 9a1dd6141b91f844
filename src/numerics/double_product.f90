!> Products with a matrix that is diagonal in Fourier space, in double precision: `grid_product.inc`
!> with another kind of reals.
module double_product
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_loc, c_null_ptr, &
      c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64, rk => real64
   use errors, only: error_t, fail, internal_error
   use fftw, only: alloc_complex => fftw_alloc_complex, alloc_real => fftw_alloc_real, &
      destroy_plan => fftw_destroy_plan, execute_dft => fftw_execute_dft, &
      execute_dft_c2r => fftw_execute_dft_c2r, execute_dft_r2c => fftw_execute_dft_r2c, &
      fftw_estimate, fftw_forward, free => fftw_free, &
      plan_dft_1d => fftw_plan_dft_1d, plan_dft_c2r_1d => fftw_plan_dft_c2r_1d, &
      plan_dft_r2c_1d => fftw_plan_dft_r2c_1d
   use kinds, only: pi, wp
   use text, only: to_text
   use work_shares, only: share_end
   implicit none (type, external)
   private

   include 'grid_product.inc'
   include 'grid_kernels.inc'
end module double_product

!> Products with a matrix that is diagonal in Fourier space, in single precision: `grid_product.inc`
!> for this kind of reals.
!>
!> A grid is transformed in parts: rows, two real ones as one complex, then columns in groups that
!> stay in the cache while they are transformed, multiplied and transformed back, then rows. That is
!> faster than transforms of the full grid, and complex transforms are planned with a fifth of the
!> instructions; pairs of rows without a listed node and rows of padding cost nothing.
module single_product
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_loc, c_null_ptr, &
      c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64, rk => real32
   use errors, only: error_t, fail, internal_error
   use fftw, only: alloc_complex => fftwf_alloc_complex, alloc_real => fftwf_alloc_real, &
      destroy_plan => fftwf_destroy_plan, execute_dft => fftwf_execute_dft, &
      execute_dft_c2r => fftwf_execute_dft_c2r, execute_dft_r2c => fftwf_execute_dft_r2c, &
      fftw_estimate, fftw_forward, free => fftwf_free, &
      plan_dft_1d => fftwf_plan_dft_1d, plan_dft_c2r_1d => fftwf_plan_dft_c2r_1d, &
      plan_dft_r2c_1d => fftwf_plan_dft_r2c_1d
   use kinds, only: pi, wp
   use text, only: to_text
   use work_shares, only: share_end
   implicit none (type, external)
   private

   include 'grid_product.inc'
   include 'grid_kernels.inc'
end module single_product

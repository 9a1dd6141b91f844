!> Products with a matrix that is diagonal in Fourier space, on uniform grids of one or two dimensions, by FFTW.
!>
!> Periodic: y = F^-1 (symbol . F x) on the grid itself. Open: x is padded with zeros to at least twice its length, which
!> makes the discrete convolution with a kernel exact (Hockney & Eastwood, Computer Simulation Using Particles, 1988,
!> section 6-5-4). Plans are made once, by FFTW_ESTIMATE unless asked otherwise: a repeated run gives the same bits.
module spectral_product
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_double_complex, c_f_pointer, c_float, c_float_complex, &
      c_int, c_loc, c_null_ptr, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64, real32
   use errors, only: error_t, fail, internal_error
   use fftw, only: fftw_alignment_of, fftw_alloc_complex, fftw_alloc_real, fftw_destroy_plan, fftw_estimate, &
      fftw_execute_dft_c2r, fftw_execute_dft_r2c, fftw_free, fftw_measure, fftw_plan_dft_c2r, fftw_plan_dft_r2c, &
      fftwf_alloc_complex, fftwf_alloc_real, fftwf_destroy_plan, fftwf_execute_dft_c2r, fftwf_execute_dft_r2c, fftwf_free, &
      fftwf_plan_dft_c2r, fftwf_plan_dft_r2c
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: spectral_product_t, new_spectral_product, new_convolution, padded_size

   !> A planned product. Fields are stored flat, x fastest: (nx*ny); a line has ny = 1. Not to be copied: it owns FFTW plans.
   type :: spectral_product_t
      !> Nodes of the grid.
      integer :: nx = 0, ny = 0
      !> Size of the transform: that of the grid, or more where it is padded.
      integer :: mx = 0, my = 0
      !> Pairs of transforms done since the start, in double and in single precision.
      integer(int64) :: pairs = 0_int64, single_pairs = 0_int64
      !> Factors in Fourier space (mx/2 + 1, my), the 1/(mx my) of the pair of transforms included.
      real(wp), allocatable :: symbol(:, :)
      type(c_ptr), private :: forward = c_null_ptr
      type(c_ptr), private :: backward = c_null_ptr
      !> Padded field, or a copy of a field that is not aligned as planned.
      real(c_double), pointer, contiguous, private :: values(:, :) => null()
      complex(c_double_complex), pointer, contiguous, private :: spectrum(:, :) => null()
      !> The same in single precision, made when first needed: field (mx, my), zero between products, and its product.
      type(c_ptr), private :: forward_single = c_null_ptr
      type(c_ptr), private :: backward_single = c_null_ptr
      logical, private :: is_measured = .false.
      real(real32), allocatable, private :: symbol_single(:, :)
      real(c_float), pointer, contiguous, private :: field_single(:, :) => null()
      complex(c_float_complex), pointer, contiguous, private :: spectrum_single(:, :) => null()
      real(c_float), pointer, contiguous :: product_single(:, :) => null()
   contains
      procedure :: apply
      procedure :: apply_symbol
      procedure :: plan_single
      procedure :: apply_single
      procedure :: add_single
      procedure :: dot_single
      procedure :: pair_weight
      final :: destroy_spectral_product
   end type spectral_product_t

contains

   !> Plans a periodic product on a grid of `nx` x `ny` >= 1 nodes (ny = 1: a line) with the real `symbol(0:nx/2, 0:ny-1)`
   !> in the order of the FFT: wavenumbers 0 ... nx/2, and 0 ... , -1 in y. `is_measured` = .true. lets FFTW time its
   !> candidates. Fails (internal_error) if FFTW gives no memory or no plan.
   subroutine new_spectral_product(self, nx, ny, symbol, is_measured, error)
      type(spectral_product_t), intent(inout) :: self
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: symbol(0:, 0:)
      logical, intent(in) :: is_measured
      type(error_t), allocatable, intent(out) :: error

      call plan(self, [nx, ny], [nx, ny], is_measured, error)
      if (allocated(error)) return
      self%symbol = symbol/(real(nx, wp)*real(ny, wp))
   end subroutine new_spectral_product

   !> Plans y(i) = sum over j of kernel(|i - j|) x(j) on an open grid; `kernel(0:nx-1, 0:ny-1)` is even in both directions.
   !> `is_measured` and errors as in `new_spectral_product`.
   subroutine new_convolution(self, kernel, is_measured, error)
      type(spectral_product_t), intent(inout) :: self
      real(wp), intent(in) :: kernel(0:, 0:)
      logical, intent(in) :: is_measured
      type(error_t), allocatable, intent(out) :: error
      integer :: i, j, nx, ny

      nx = size(kernel, 1)
      ny = size(kernel, 2)
      call plan(self, [nx, ny], [padded_size(nx), padded_size(ny)], is_measured, error)
      if (allocated(error)) return
      associate (mx => self%mx, my => self%my)
         self%values = 0.0_wp
         do j = 0, ny - 1
            self%values(:nx, j + 1) = kernel(:, j)
            do i = 1, nx - 1
               self%values(mx - i + 1, j + 1) = kernel(i, j)
            end do
            if (j > 0) self%values(:, my - j + 1) = self%values(:, j + 1)
         end do
         call fftw_execute_dft_r2c(self%forward, self%values, self%spectrum)
         self%symbol = self%spectrum%re/(real(mx, wp)*real(my, wp))
      end associate
   end subroutine new_convolution

   !> Length of the transform of an open line of `n` nodes: the least 2^a 3^b 5^c >= 2n - 1 (1 for a single node).
   pure function padded_size(n) result(m)
      integer, intent(in) :: n
      integer :: m
      integer :: rest

      m = max(2*n - 1, 1)
      do
         rest = m
         do while (mod(rest, 2) == 0)
            rest = rest/2
         end do
         do while (mod(rest, 3) == 0)
            rest = rest/3
         end do
         do while (mod(rest, 5) == 0)
            rest = rest/5
         end do
         if (rest == 1) return
         m = m + 1
      end do
   end function padded_size

   !> y = A x, both (nx*ny).
   subroutine apply(self, x, y)
      class(spectral_product_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: x(:)
      real(wp), contiguous, intent(out) :: y(:)

      call self%apply_symbol(self%symbol, x, y)
   end subroutine apply

   !> y = F^-1 (symbol . F x) with a `symbol(mx/2 + 1, my)` of the caller, 1/(mx my) included, on the same plans.
   subroutine apply_symbol(self, symbol, x, y)
      class(spectral_product_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: symbol(:, :)
      real(wp), contiguous, intent(in) :: x(:)
      real(wp), contiguous, intent(out) :: y(:)
      integer :: j

      if (is_direct(self, x, y)) then
         call fftw_execute_dft_r2c(self%forward, x, self%spectrum)
      else
         do j = 1, self%ny
            self%values(:self%nx, j) = x((j - 1)*self%nx + 1:j*self%nx)
            self%values(self%nx + 1:, j) = 0.0_wp
         end do
         self%values(:, self%ny + 1:) = 0.0_wp
         call fftw_execute_dft_r2c(self%forward, self%values, self%spectrum)
      end if
      do j = 1, self%my
         self%spectrum(:, j) = self%spectrum(:, j)*symbol(:, j)
      end do
      if (is_direct(self, x, y)) then
         call fftw_execute_dft_c2r(self%backward, self%spectrum, y)
      else
         call fftw_execute_dft_c2r(self%backward, self%spectrum, self%values)
         do j = 1, self%ny
            y((j - 1)*self%nx + 1:j*self%nx) = self%values(:self%nx, j)
         end do
      end if
      self%pairs = self%pairs + 1_int64
   end subroutine apply_symbol

   !> A x in single precision for an x that is `values` on the listed nodes `node` (rising) and zero elsewhere; the product,
   !> over the `scale` of x, stays in `product_single` (mx, my). Fails (internal_error) if FFTW does.
   subroutine apply_single(self, node, values, scale, error)
      class(spectral_product_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: values(:)
      real(wp), intent(out) :: scale
      type(error_t), allocatable, intent(out) :: error
      integer :: j

      if (.not. associated(self%product_single)) then
         call self%plan_single(error)
         if (allocated(error)) return
      end if
      scale = maxval(abs(values))
      if (.not. scale > 0.0_wp) scale = 1.0_wp
      call scatter(self, node, values, 1.0_wp/scale)
      call fftwf_execute_dft_r2c(self%forward_single, self%field_single, self%spectrum_single)
      call scatter(self, node, values, 0.0_wp)
      do j = 1, self%my
         self%spectrum_single(:, j) = self%spectrum_single(:, j)*self%symbol_single(:, j)
      end do
      call fftwf_execute_dft_c2r(self%backward_single, self%spectrum_single, self%product_single)
      self%single_pairs = self%single_pairs + 1_int64
   end subroutine apply_single

   !> Puts `factor` times `values` on the listed nodes (rising) of the single-precision field.
   subroutine scatter(self, node, values, factor)
      class(spectral_product_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: values(:)
      real(wp), intent(in) :: factor
      integer :: k, row, row_start

      row = 1
      row_start = 0
      do k = 1, size(node)
         do while (node(k) > row_start + self%nx)
            row = row + 1
            row_start = row_start + self%nx
         end do
         self%field_single(node(k) - row_start, row) = real(values(k)*factor, real32)
      end do
   end subroutine scatter

   !> y = y + factor times the last product in single precision, on the grid (nx*ny).
   subroutine add_single(self, factor, y)
      class(spectral_product_t), intent(in) :: self
      real(wp), intent(in) :: factor
      real(wp), contiguous, intent(inout) :: y(:)
      integer :: i, j

      do j = 1, self%ny
         do i = 1, self%nx
            y(i + (j - 1)*self%nx) = y(i + (j - 1)*self%nx) + factor*self%product_single(i, j)
         end do
      end do
   end subroutine add_single

   !> Sum of `values` times the last product in single precision over the listed nodes (rising).
   function dot_single(self, node, values) result(total)
      class(spectral_product_t), intent(in) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: values(:)
      real(wp) :: total
      integer :: k, row, row_start

      row = 1
      row_start = 0
      total = 0.0_wp
      do k = 1, size(node)
         do while (node(k) > row_start + self%nx)
            row = row + 1
            row_start = row_start + self%nx
         end do
         total = total + values(k)*self%product_single(node(k) - row_start, row)
      end do
   end function dot_single

   !> Pairs of transforms done, one in single precision counted as a half.
   pure function pair_weight(self) result(weight)
      class(spectral_product_t), intent(in) :: self
      real(wp) :: weight

      weight = real(self%pairs, wp) + 0.5_wp*real(self%single_pairs, wp)
   end function pair_weight

   !> Memory and plans in single precision; done by the first product if not before.
   subroutine plan_single(self, error)
      class(spectral_product_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      type(c_ptr) :: memory
      integer(c_int) :: flags, rank, c_sizes(2)
      integer :: half

      half = self%mx/2 + 1
      memory = fftwf_alloc_real(int(self%mx, c_size_t)*int(self%my, c_size_t))
      if (c_associated(memory)) call c_f_pointer(memory, self%field_single, [self%mx, self%my])
      memory = fftwf_alloc_real(int(self%mx, c_size_t)*int(self%my, c_size_t))
      if (c_associated(memory)) call c_f_pointer(memory, self%product_single, [self%mx, self%my])
      memory = fftwf_alloc_complex(int(half, c_size_t)*int(self%my, c_size_t))
      if (c_associated(memory)) call c_f_pointer(memory, self%spectrum_single, [half, self%my])
      if (.not. (associated(self%field_single) .and. associated(self%product_single) .and. associated(self%spectrum_single))) then
         call fail(error, internal_error, 'FFTW: no memory for a transform of ' // to_text(self%mx) // ' x ' // to_text(self%my))
         return
      end if
      flags = merge(fftw_measure, fftw_estimate, self%is_measured)
      rank = merge(1_c_int, 2_c_int, self%my == 1)
      c_sizes = [int(self%my, c_int), int(self%mx, c_int)]
      if (rank == 1) c_sizes(1) = c_sizes(2)
      self%forward_single = fftwf_plan_dft_r2c(rank, c_sizes, self%field_single, self%spectrum_single, flags)
      self%backward_single = fftwf_plan_dft_c2r(rank, c_sizes, self%spectrum_single, self%product_single, flags)
      if (.not. (c_associated(self%forward_single) .and. c_associated(self%backward_single))) then
         call fail(error, internal_error, 'FFTW: no plan for a transform of ' // to_text(self%mx) // ' x ' // to_text(self%my))
         return
      end if
      self%field_single = 0.0_real32
      self%symbol_single = real(self%symbol, real32)
   end subroutine plan_single

   !> True if the transform may work on `x` and `y` themselves: no padding, aligned as planned.
   function is_direct(self, x, y)
      class(spectral_product_t), intent(in) :: self
      real(wp), contiguous, intent(in) :: x(:), y(:)
      logical :: is_direct
      integer(c_int) :: planned

      is_direct = .false.
      if (self%mx /= self%nx .or. self%my /= self%ny) return
      planned = fftw_alignment_of(self%values)
      if (fftw_alignment_of(x) == planned) is_direct = fftw_alignment_of(y) == planned
   end function is_direct

   !> Memory and plans for a grid of nodes (2) and a transform of size (2).
   subroutine plan(self, nodes, sizes, is_measured, error)
      type(spectral_product_t), intent(inout) :: self
      integer, intent(in) :: nodes(2), sizes(2)
      logical, intent(in) :: is_measured
      type(error_t), allocatable, intent(out) :: error
      type(c_ptr) :: memory
      integer(c_int) :: flags, rank, c_sizes(2)
      integer :: half

      call destroy_spectral_product(self)
      self%nx = nodes(1)
      self%ny = nodes(2)
      self%mx = sizes(1)
      self%my = sizes(2)
      self%pairs = 0_int64
      self%single_pairs = 0_int64
      self%is_measured = is_measured
      half = self%mx/2 + 1
      memory = fftw_alloc_real(int(self%mx, c_size_t)*int(self%my, c_size_t))
      if (c_associated(memory)) call c_f_pointer(memory, self%values, [self%mx, self%my])
      memory = fftw_alloc_complex(int(half, c_size_t)*int(self%my, c_size_t))
      if (c_associated(memory)) call c_f_pointer(memory, self%spectrum, [half, self%my])
      if (.not. (associated(self%values) .and. associated(self%spectrum))) then
         call fail(error, internal_error, 'FFTW: no memory for a transform of ' // to_text(self%mx) // ' x ' // to_text(self%my))
         return
      end if
      flags = merge(fftw_measure, fftw_estimate, is_measured)
      rank = merge(1_c_int, 2_c_int, self%my == 1)
      c_sizes = [int(self%my, c_int), int(self%mx, c_int)]
      if (rank == 1) c_sizes(1) = c_sizes(2)
      self%forward = fftw_plan_dft_r2c(rank, c_sizes, self%values, self%spectrum, flags)
      self%backward = fftw_plan_dft_c2r(rank, c_sizes, self%spectrum, self%values, flags)
      if (c_associated(self%forward) .and. c_associated(self%backward)) return
      call fail(error, internal_error, 'FFTW: no plan for a transform of ' // to_text(self%mx) // ' x ' // to_text(self%my))
   end subroutine plan

   !> Gives plans and memory back.
   subroutine destroy_spectral_product(self)
      type(spectral_product_t), intent(inout) :: self

      if (c_associated(self%forward)) call fftw_destroy_plan(self%forward)
      if (c_associated(self%backward)) call fftw_destroy_plan(self%backward)
      self%forward = c_null_ptr
      self%backward = c_null_ptr
      if (associated(self%values)) call fftw_free(c_loc(self%values))
      if (associated(self%spectrum)) call fftw_free(c_loc(self%spectrum))
      nullify (self%values, self%spectrum)
      if (allocated(self%symbol)) deallocate (self%symbol)
      if (c_associated(self%forward_single)) call fftwf_destroy_plan(self%forward_single)
      if (c_associated(self%backward_single)) call fftwf_destroy_plan(self%backward_single)
      self%forward_single = c_null_ptr
      self%backward_single = c_null_ptr
      if (associated(self%field_single)) call fftwf_free(c_loc(self%field_single))
      if (associated(self%product_single)) call fftwf_free(c_loc(self%product_single))
      if (associated(self%spectrum_single)) call fftwf_free(c_loc(self%spectrum_single))
      nullify (self%field_single, self%product_single, self%spectrum_single)
      if (allocated(self%symbol_single)) deallocate (self%symbol_single)
   end subroutine destroy_spectral_product

end module spectral_product

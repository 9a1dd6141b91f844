!> Products with a matrix that is diagonal in Fourier space, on uniform grids of one or two dimensions, by FFTW.
!>
!> Periodic: y = F^-1 (symbol . F x) on the grid itself. Open: x is padded with zeros to at least twice its length, which
!> makes the discrete convolution with a kernel exact (Hockney & Eastwood, Computer Simulation Using Particles, 1988,
!> section 6-5-4). Transforms are done by rows and groups of columns as in `single_product`. Plans are made
!> once, by FFTW_ESTIMATE: a repeated run gives the same bits.
module spectral_product
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_double_complex, c_f_pointer, c_int, c_loc, c_null_ptr, &
      c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, internal_error
   use fftw, only: fftw_alloc_complex, fftw_alloc_real, fftw_backward, fftw_destroy_plan, fftw_estimate, fftw_execute_dft, &
      fftw_execute_dft_c2r, fftw_execute_dft_r2c, fftw_forward, fftw_free, fftw_plan_dft_c2r_1d, fftw_plan_dft_r2c, &
      fftw_plan_dft_r2c_1d, fftw_plan_dft_1d
   use kinds, only: wp
   use single_product, only: column_pitch, lane, new_single_product, row_pitch, single_product_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: spectral_product_t, new_spectral_product, new_convolution, padded_size

   !> A product. Fields are stored flat, x fastest: (nx*ny); a line has ny = 1. Not to be copied: it owns FFTW plans.
   type :: spectral_product_t
      !> Nodes of the grid.
      integer :: nx = 0, ny = 0
      !> Size of the transform: that of the grid, or more where it is padded.
      integer :: mx = 0, my = 0
      !> Threads that share the work.
      integer :: threads = 1
      !> Pairs of transforms done in double precision.
      integer(int64) :: pairs = 0_int64
      !> The same matrix in single precision; `plan_single` prepares it.
      type(single_product_t) :: single
      !> Factors in Fourier space, 1/(mx my) of the pair of transforms included, (my, mx/2 + 1).
      real(wp), allocatable, private :: symbol(:, :)
      type(c_ptr), private :: row_forward = c_null_ptr, row_backward = c_null_ptr
      type(c_ptr), private :: column_forward = c_null_ptr, column_backward = c_null_ptr
      !> Spectrum, rows padded to whole lanes; one row and one group of columns for each thread.
      complex(c_double_complex), pointer, contiguous, private :: spectrum(:, :) => null()
      real(c_double), pointer, contiguous, private :: row(:, :) => null()
      complex(c_double_complex), pointer, contiguous, private :: columns(:, :, :) => null()
   contains
      procedure :: apply
      procedure :: apply_inverse
      procedure :: plan_single
      procedure :: transforms
      final :: destroy_spectral_product
   end type spectral_product_t

contains

   !> Plans a periodic product on a grid of `nx` x `ny` >= 1 nodes (ny = 1: a line) with the real `symbol(0:nx/2, 0:ny-1)`
   !> in the order of the FFT: wavenumbers 0 ... nx/2, and 0 ... , -1 in y. Work is shared by `threads`.
   !> If `is_single`, products in double precision are not planned and must not be asked for.
   !> Fails (internal_error) if FFTW gives no memory or no plan.
   subroutine new_spectral_product(self, nx, ny, symbol, threads, error, is_single)
      type(spectral_product_t), intent(inout) :: self
      integer, intent(in) :: nx, ny, threads
      real(wp), intent(in) :: symbol(0:, 0:)
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: is_single

      call set_up(self, [nx, ny], [nx, ny], symbol, threads)
      call plan_as_wanted(self, error, is_single)
   end subroutine new_spectral_product

   !> Plans the product y(i) = sum over j of kernel(|i - j|) x(j) on an open grid; `kernel(0:nx-1, 0:ny-1)` is even in both
   !> directions. `threads`, `is_single` and errors as in `new_spectral_product`.
   subroutine new_convolution(self, kernel, threads, error, is_single)
      type(spectral_product_t), intent(inout) :: self
      real(wp), intent(in) :: kernel(0:, 0:)
      integer, intent(in) :: threads
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: is_single
      real(c_double), pointer, contiguous :: values(:, :)
      complex(c_double_complex), pointer, contiguous :: spectrum(:, :)
      real(wp), allocatable :: symbol(:, :)
      type(c_ptr) :: forward
      integer(c_int) :: rank, sizes(2)
      integer :: i, j, mx, my, nx, ny

      nx = size(kernel, 1)
      ny = size(kernel, 2)
      mx = padded_size(nx)
      my = padded_size(ny)
      call c_f_pointer(fftw_alloc_real(int(mx, c_size_t)*my), values, [mx, my])
      call c_f_pointer(fftw_alloc_complex((mx/2 + 1_c_size_t)*my), spectrum, [mx/2 + 1, my])
      forward = c_null_ptr
      rank = merge(1_c_int, 2_c_int, my == 1)
      sizes = [int(merge(mx, my, my == 1), c_int), int(mx, c_int)]
      if (associated(values) .and. associated(spectrum)) forward = fftw_plan_dft_r2c(rank, sizes, values, spectrum, fftw_estimate)
      if (c_associated(forward)) then
         values = 0.0_wp
         do j = 0, ny - 1
            values(:nx, j + 1) = kernel(:, j)
            do i = 1, nx - 1
               values(mx - i + 1, j + 1) = kernel(i, j)
            end do
            if (j > 0) values(:, my - j + 1) = values(:, j + 1)
         end do
         call fftw_execute_dft_r2c(forward, values, spectrum)
         call fftw_destroy_plan(forward)
         symbol = spectrum%re
      else
         call fail(error, internal_error, 'FFTW: no plan for a transform of ' // to_text(mx) // ' x ' // to_text(my))
      end if
      if (associated(values)) call fftw_free(c_loc(values))
      if (associated(spectrum)) call fftw_free(c_loc(spectrum))
      if (allocated(error)) return
      call set_up(self, [nx, ny], [mx, my], symbol, threads)
      call plan_as_wanted(self, error, is_single)
   end subroutine new_convolution

   !> Sizes and symbol.
   subroutine set_up(self, nodes, sizes, symbol, threads)
      type(spectral_product_t), intent(inout) :: self
      integer, intent(in) :: nodes(2), sizes(2), threads
      real(wp), intent(in) :: symbol(:, :)

      call destroy_spectral_product(self)
      self%nx = nodes(1)
      self%ny = nodes(2)
      self%mx = sizes(1)
      self%my = sizes(2)
      self%threads = threads
      self%pairs = 0_int64
      self%symbol = transpose(symbol)/(real(self%mx, wp)*real(self%my, wp))
   end subroutine set_up

   !> Plans in double precision, or in single alone.
   subroutine plan_as_wanted(self, error, is_single)
      type(spectral_product_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: is_single
      logical :: wants_single

      wants_single = .false.
      if (present(is_single)) wants_single = is_single
      if (wants_single) then
         call self%plan_single(error)
      else
         call plan(self, error)
      end if
   end subroutine plan_as_wanted

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

      call transform_there(self, x)
      call transform_columns(self)
      call transform_back(self, y)
      self%pairs = self%pairs + 1_int64
   end subroutine apply

   !> y = A^-1 x of a periodic product, both (nx*ny), without the waves for which A is not positive.
   subroutine apply_inverse(self, x, y)
      class(spectral_product_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: x(:)
      real(wp), contiguous, intent(out) :: y(:)
      real(wp), allocatable :: symbol(:, :)
      real(wp) :: weight

      weight = 1.0_wp/(real(self%mx, wp)*real(self%my, wp))
      call move_alloc(self%symbol, symbol)
      allocate (self%symbol, mold=symbol)
      self%symbol = 0.0_wp
      where (symbol > 0.0_wp) self%symbol = weight*weight/symbol
      call self%apply(x, y)
      call move_alloc(symbol, self%symbol)
   end subroutine apply_inverse

   !> The rows of x forward; rows that only pad are left out.
   subroutine transform_there(self, x)
      class(spectral_product_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: x(:)
      integer :: j, t

      self%row = 0.0_wp
      !$omp parallel do num_threads(self%threads) private(j) schedule(static)
      do t = 1, self%threads
         do j = (t - 1)*self%ny/self%threads + 1, t*self%ny/self%threads
            self%row(:self%nx, t) = x((j - 1)*self%nx + 1:j*self%nx)
            call fftw_execute_dft_r2c(self%row_forward, self%row(:, t), self%spectrum(:, j))
         end do
      end do
      !$omp end parallel do
   end subroutine transform_there

   !> Columns forward, times the symbol, and back; a line has none.
   subroutine transform_columns(self)
      class(spectral_product_t), intent(inout) :: self
      integer :: column, first, group, groups, last, t

      if (self%my == 1) then
         call multiply(self%spectrum(:, 1), self%symbol(1, :))
         return
      end if
      groups = (size(self%symbol, 2) + lane - 1)/lane
      !$omp parallel do num_threads(self%threads) private(column, first, group, last) schedule(static)
      do t = 1, self%threads
         do group = (t - 1)*groups/self%threads + 1, t*groups/self%threads
            first = lane*(group - 1)
            last = min(lane, size(self%symbol, 2) - first)
            call transpose_lane(self%spectrum(first + 1:first + lane, :self%ny), self%columns(:, :, t))
            do column = 1, last
               self%columns(self%ny + 1:self%my, column, t) = (0.0_wp, 0.0_wp)
               call fftw_execute_dft(self%column_forward, self%columns(:, column, t), self%columns(:, column, t))
               call multiply(self%columns(:, column, t), self%symbol(:, first + column))
               call fftw_execute_dft(self%column_backward, self%columns(:, column, t), self%columns(:, column, t))
            end do
            call transpose_back(self%columns(:, :, t), self%spectrum(first + 1:first + lane, :self%ny))
         end do
      end do
      !$omp end parallel do
   end subroutine transform_columns

   !> Makes columns of the rows of one group, (lane, n) to (>= n, lane).
   pure subroutine transpose_lane(rows, columns)
      complex(c_double_complex), intent(in) :: rows(:, :)
      complex(c_double_complex), contiguous, intent(inout) :: columns(:, :)
      integer :: i, j

      do j = 1, size(rows, 2)
         do i = 1, lane
            columns(j, i) = rows(i, j)
         end do
      end do
   end subroutine transpose_lane

   !> The way back.
   pure subroutine transpose_back(columns, rows)
      complex(c_double_complex), contiguous, intent(in) :: columns(:, :)
      complex(c_double_complex), intent(inout) :: rows(:, :)
      integer :: i, j

      do j = 1, size(rows, 2)
         do i = 1, lane
            rows(i, j) = columns(j, i)
         end do
      end do
   end subroutine transpose_back

   !> values = values times symbol, as far as the symbol goes.
   pure subroutine multiply(values, symbol)
      complex(c_double_complex), contiguous, intent(inout) :: values(:)
      real(wp), intent(in) :: symbol(:)
      integer :: i

      do i = 1, size(symbol)
         values(i)%re = values(i)%re*symbol(i)
         values(i)%im = values(i)%im*symbol(i)
      end do
   end subroutine multiply

   !> The rows of y.
   subroutine transform_back(self, y)
      class(spectral_product_t), intent(inout) :: self
      real(wp), contiguous, intent(out) :: y(:)
      integer :: j, t

      !$omp parallel do num_threads(self%threads) private(j) schedule(static)
      do t = 1, self%threads
         do j = (t - 1)*self%ny/self%threads + 1, t*self%ny/self%threads
            call fftw_execute_dft_c2r(self%row_backward, self%spectrum(:, j), self%row(:, t))
            y((j - 1)*self%nx + 1:j*self%nx) = self%row(:self%nx, t)
         end do
      end do
      !$omp end parallel do
   end subroutine transform_back

   !> Transforms done: size, pairs in double, pairs in single precision.
   pure function transforms(self)
      class(spectral_product_t), intent(in) :: self
      integer :: transforms(4)

      transforms = [self%mx, self%my, int(self%pairs), int(self%single%pairs)]
   end function transforms

   !> Prepares products in single precision, once.
   subroutine plan_single(self, error)
      class(spectral_product_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (self%single%is_planned()) return
      call new_single_product(self%single, [self%nx, self%ny], [self%mx, self%my], self%symbol, self%threads, error)
   end subroutine plan_single

   !> Memory and plans.
   subroutine plan(self, error)
      class(spectral_product_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: mx, my
      integer :: pitch
      logical :: is_area

      mx = int(self%mx, c_int)
      my = int(self%my, c_int)
      is_area = self%my > 1
      pitch = row_pitch(size(self%symbol, 2))
      call c_f_pointer(fftw_alloc_complex(int(pitch, c_size_t)*my), self%spectrum, [pitch, self%my])
      call c_f_pointer(fftw_alloc_real(int(2*pitch, c_size_t)*self%threads), self%row, [2*pitch, self%threads])
      call c_f_pointer(fftw_alloc_complex(int(column_pitch(self%my), c_size_t)*lane*self%threads), self%columns, &
         [column_pitch(self%my), lane, self%threads])
      if (associated(self%spectrum) .and. associated(self%row) .and. associated(self%columns)) then
         self%row_forward = fftw_plan_dft_r2c_1d(mx, self%row, self%spectrum, fftw_estimate)
         self%row_backward = fftw_plan_dft_c2r_1d(mx, self%spectrum, self%row, fftw_estimate)
         if (is_area) then
            self%column_forward = fftw_plan_dft_1d(my, self%columns, self%columns, fftw_forward, fftw_estimate)
            self%column_backward = fftw_plan_dft_1d(my, self%columns, self%columns, fftw_backward, fftw_estimate)
         end if
      end if
      if (c_associated(self%row_forward) .and. c_associated(self%row_backward) &
          .and. (c_associated(self%column_forward) .and. c_associated(self%column_backward) .or. .not. is_area)) then
         self%spectrum = (0.0_wp, 0.0_wp)
      else
         call fail(error, internal_error, 'FFTW: no plan for a transform of ' // to_text(self%mx) // ' x ' // to_text(self%my))
      end if
   end subroutine plan

   !> Gives plans and memory back.
   subroutine destroy_spectral_product(self)
      type(spectral_product_t), intent(inout) :: self

      if (c_associated(self%row_forward)) call fftw_destroy_plan(self%row_forward)
      if (c_associated(self%row_backward)) call fftw_destroy_plan(self%row_backward)
      if (c_associated(self%column_forward)) call fftw_destroy_plan(self%column_forward)
      if (c_associated(self%column_backward)) call fftw_destroy_plan(self%column_backward)
      self%row_forward = c_null_ptr
      self%row_backward = c_null_ptr
      self%column_forward = c_null_ptr
      self%column_backward = c_null_ptr
      if (associated(self%spectrum)) call fftw_free(c_loc(self%spectrum))
      if (associated(self%row)) call fftw_free(c_loc(self%row))
      if (associated(self%columns)) call fftw_free(c_loc(self%columns))
      nullify (self%spectrum, self%row, self%columns)
      if (allocated(self%symbol)) deallocate (self%symbol)
      call self%single%release()
   end subroutine destroy_spectral_product

end module spectral_product

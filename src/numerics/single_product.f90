!> Products with a matrix that is diagonal in Fourier space, in single precision, for fields that are zero off a list of nodes.
!>
!> A transform of a grid is done by its parts: rows, then columns in groups of `lane` that stay in the cache while they are
!> transformed, multiplied and transformed back, then rows. That is faster than transforms of the whole grid, rows without a
!> listed node cost nothing, and neither do those that only pad.
module single_product
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_float, c_float_complex, c_int, c_loc, c_null_ptr, c_ptr, &
      c_size_t
   use, intrinsic :: iso_fortran_env, only: int64, real32
   use errors, only: error_t, fail, internal_error
   use fftw, only: fftw_backward, fftw_estimate, fftw_forward, fftwf_alloc_complex, fftwf_alloc_real, fftwf_destroy_plan, &
      fftwf_execute_dft, fftwf_execute_dft_c2r, fftwf_execute_dft_r2c, fftwf_free, fftwf_plan_dft_c2r_1d, fftwf_plan_dft_r2c_1d, &
      fftwf_plan_dft_1d
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: column_pitch, lane, row_pitch, single_product_t, new_single_product

   !> Columns that are transformed together: a line of the cache holds so many complex values.
   integer, parameter :: lane = 8

   !> A planned product. Not to be copied: it owns FFTW plans.
   type :: single_product_t
      !> Pairs of transforms done.
      integer(int64) :: pairs = 0_int64
      !> The last product over its scale, in the first nx of each of the ny columns of this array.
      real(c_float), pointer, contiguous :: product(:, :) => null()
      integer, private :: nx = 0, ny = 0, mx = 0, my = 0, threads = 1
      !> Factors (my, mx/2 + 1).
      real(real32), allocatable, private :: symbol(:, :)
      type(c_ptr), private :: row_forward = c_null_ptr, row_backward = c_null_ptr
      type(c_ptr), private :: column_forward = c_null_ptr, column_backward = c_null_ptr
      !> Spectrum, rows padded to whole lanes; the product of an area takes its place.
      complex(c_float_complex), pointer, contiguous, private :: spectrum(:, :) => null()
      !> One row, zero between products, and one group of columns, for each thread.
      real(c_float), pointer, contiguous, private :: row(:, :) => null()
      complex(c_float_complex), pointer, contiguous, private :: columns(:, :, :) => null()
   contains
      procedure :: is_planned
      procedure :: apply
      procedure :: add_to
      procedure :: gather
      procedure :: largest
      procedure, private :: transform_rows
      procedure, private :: transform_columns
      procedure :: release
      final :: destroy_single_product
   end type single_product_t

contains

   !> Plans products on a grid of `nodes` (2) that is padded to `sizes` (2), with the `symbol` (my, mx/2 + 1), for
   !> `threads` threads. Fails (internal_error) if FFTW gives no memory or no plan.
   subroutine new_single_product(self, nodes, sizes, symbol, threads, error)
      type(single_product_t), intent(inout) :: self
      integer, intent(in) :: nodes(2), sizes(2), threads
      real(wp), intent(in) :: symbol(:, :)
      type(error_t), allocatable, intent(out) :: error
      integer(c_int) :: mx, my, pitch
      logical :: is_area

      call destroy_single_product(self)
      self%nx = nodes(1)
      self%ny = nodes(2)
      self%mx = sizes(1)
      self%my = sizes(2)
      self%threads = threads
      self%pairs = 0_int64
      self%symbol = real(symbol, real32)
      mx = int(self%mx, c_int)
      my = int(self%my, c_int)
      pitch = int(row_pitch(size(symbol, 2)), c_int)
      is_area = self%my > 1
      call c_f_pointer(fftwf_alloc_complex(int(pitch, c_size_t)*my), self%spectrum, [int(pitch), self%my])
      call c_f_pointer(fftwf_alloc_real(int(2*pitch, c_size_t)*threads), self%row, [2*int(pitch), threads])
      call c_f_pointer(fftwf_alloc_complex(int(column_pitch(self%my), c_size_t)*lane*threads), self%columns, &
         [column_pitch(self%my), lane, threads])
      if (associated(self%spectrum) .and. associated(self%row) .and. associated(self%columns)) then
         self%row_forward = fftwf_plan_dft_r2c_1d(mx, self%row, self%spectrum, fftw_estimate)
         if (is_area) then
            call c_f_pointer(c_loc(self%spectrum), self%product, [2*int(pitch), self%my])
            self%column_forward = fftwf_plan_dft_1d(my, self%columns, self%columns, fftw_forward, fftw_estimate)
            self%column_backward = fftwf_plan_dft_1d(my, self%columns, self%columns, fftw_backward, fftw_estimate)
         else
            ! A long single row is faster not in place.
            call c_f_pointer(fftwf_alloc_real(int(2*pitch, c_size_t)), self%product, [2*int(pitch), 1])
         end if
         if (associated(self%product)) self%row_backward = fftwf_plan_dft_c2r_1d(mx, self%spectrum, self%row, fftw_estimate)
      end if
      if (.not. (c_associated(self%row_forward) .and. c_associated(self%row_backward) &
                 .and. (c_associated(self%column_forward) .and. c_associated(self%column_backward) .or. .not. is_area))) then
         call fail(error, internal_error, 'FFTW: no plan for a transform of ' // to_text(self%mx) // ' x ' // to_text(self%my))
         return
      end if
      self%row = 0.0_real32
      self%spectrum = (0.0_real32, 0.0_real32)
   end subroutine new_single_product

   !> Complex values from row to row for so many `columns`: powers of two would share few places of the cache.
   pure function row_pitch(columns) result(pitch)
      integer, intent(in) :: columns
      integer :: pitch

      pitch = lane*((columns + lane - 1)/lane)
      if (mod(pitch, 16*lane) == 0) pitch = pitch + lane
   end function row_pitch

   !> The same for columns of `n` values.
   pure function column_pitch(n) result(pitch)
      integer, intent(in) :: n
      integer :: pitch

      pitch = lane*((n + lane - 1)/lane + 1)
   end function column_pitch

   !> True if the product has been planned.
   pure function is_planned(self)
      class(single_product_t), intent(in) :: self
      logical :: is_planned

      is_planned = associated(self%spectrum)
   end function is_planned

   !> A x for an x that is `values` on the listed nodes `node` (rising) and zero elsewhere; the product, over the `scale` of
   !> x, stays in `product`.
   subroutine apply(self, node, values, scale)
      class(single_product_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: values(:)
      real(wp), intent(out) :: scale

      scale = maxval(abs(values))
      if (.not. scale > 0.0_wp) scale = 1.0_wp
      call self%transform_rows(node, values, 1.0_wp/scale)
      call self%transform_columns()
      call transform_rows_back(self)
      self%pairs = self%pairs + 1_int64
   end subroutine apply

   !> The rows of `factor` times `values` on the nodes `node`.
   subroutine transform_rows(self, node, values, factor)
      class(single_product_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: values(:)
      real(wp), intent(in) :: factor
      integer :: first(self%ny + 1), i, j, k, start, t, top

      k = 1
      do j = 1, self%ny
         first(j) = k
         count_row: do while (k <= size(node))
            if (node(k) > j*self%nx) exit count_row
            k = k + 1
         end do count_row
      end do
      first(self%ny + 1) = size(node) + 1
      !$omp parallel do num_threads(self%threads) private(j, k, i, start, top) schedule(static)
      do t = 1, self%threads
         start = (t - 1)*self%ny/self%threads + 1
         top = t*self%ny/self%threads
         rows: do j = start, top
            if (first(j + 1) == first(j)) then
               self%spectrum(:, j) = (0.0_real32, 0.0_real32)
               cycle rows
            end if
            do k = first(j), first(j + 1) - 1
               i = node(k) - (j - 1)*self%nx
               self%row(i, t) = real(values(k)*factor, real32)
            end do
            call fftwf_execute_dft_r2c(self%row_forward, self%row(:, t), self%spectrum(:, j))
            do k = first(j), first(j + 1) - 1
               self%row(node(k) - (j - 1)*self%nx, t) = 0.0_real32
            end do
         end do rows
      end do
      !$omp end parallel do
   end subroutine transform_rows

   !> Columns forward, times the symbol, and back; a line has none.
   subroutine transform_columns(self)
      class(single_product_t), intent(inout) :: self
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
               self%columns(self%ny + 1:self%my, column, t) = (0.0_real32, 0.0_real32)
               call fftwf_execute_dft(self%column_forward, self%columns(:, column, t), self%columns(:, column, t))
               call multiply(self%columns(:, column, t), self%symbol(:, first + column))
               call fftwf_execute_dft(self%column_backward, self%columns(:, column, t), self%columns(:, column, t))
            end do
            call transpose_back(self%columns(:, :, t), self%spectrum(first + 1:first + lane, :self%ny))
         end do
      end do
      !$omp end parallel do
   end subroutine transform_columns

   !> Makes columns of the rows of one group, (lane, n) to (>= n, lane).
   pure subroutine transpose_lane(rows, columns)
      complex(c_float_complex), intent(in) :: rows(:, :)
      complex(c_float_complex), contiguous, intent(inout) :: columns(:, :)
      integer :: i, j

      do j = 1, size(rows, 2)
         do i = 1, lane
            columns(j, i) = rows(i, j)
         end do
      end do
   end subroutine transpose_lane

   !> The way back.
   pure subroutine transpose_back(columns, rows)
      complex(c_float_complex), contiguous, intent(in) :: columns(:, :)
      complex(c_float_complex), intent(inout) :: rows(:, :)
      integer :: i, j

      do j = 1, size(rows, 2)
         do i = 1, lane
            rows(i, j) = columns(j, i)
         end do
      end do
   end subroutine transpose_back

   !> values = values times symbol, as far as the symbol goes.
   pure subroutine multiply(values, symbol)
      complex(c_float_complex), contiguous, intent(inout) :: values(:)
      real(real32), intent(in) :: symbol(:)
      integer :: i

      do i = 1, size(symbol)
         values(i)%re = values(i)%re*symbol(i)
         values(i)%im = values(i)%im*symbol(i)
      end do
   end subroutine multiply

   !> The rows of the product.
   subroutine transform_rows_back(self)
      type(single_product_t), intent(inout) :: self
      integer :: j, t

      if (self%my == 1) then
         call fftwf_execute_dft_c2r(self%row_backward, self%spectrum, self%product)
         return
      end if
      !$omp parallel do num_threads(self%threads) private(j) schedule(static)
      do t = 1, self%threads
         do j = (t - 1)*self%ny/self%threads + 1, t*self%ny/self%threads
            call fftwf_execute_dft_c2r(self%row_backward, self%spectrum(:, j), self%row(:, t))
            self%product(:self%nx, j) = self%row(:self%nx, t)
         end do
      end do
      !$omp end parallel do
      self%row = 0.0_real32
   end subroutine transform_rows_back

   !> y = y + factor times the last product, on the grid (nx*ny).
   subroutine add_to(self, factor, y)
      class(single_product_t), intent(in) :: self
      real(wp), intent(in) :: factor
      real(wp), contiguous, intent(inout) :: y(:)
      integer :: i, j

      !$omp parallel do num_threads(self%threads) private(i) schedule(static)
      do j = 1, self%ny
         do i = 1, self%nx
            y(i + (j - 1)*self%nx) = y(i + (j - 1)*self%nx) + factor*self%product(i, j)
         end do
      end do
      !$omp end parallel do
   end subroutine add_to

   !> The largest absolute value of the last product on the grid.
   pure function largest(self)
      class(single_product_t), intent(in) :: self
      real(wp) :: largest

      largest = maxval(abs(self%product(:self%nx, :self%ny)))
   end function largest

   !> The last product, times `factor`, on the listed nodes (rising).
   subroutine gather(self, node, factor, values)
      class(single_product_t), intent(in) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), intent(in) :: factor
      real(wp), contiguous, intent(out) :: values(:)
      integer :: j, k, start

      k = 1
      do j = 1, self%ny
         start = (j - 1)*self%nx
         row: do while (k <= size(node))
            if (node(k) > start + self%nx) exit row
            values(k) = factor*self%product(node(k) - start, j)
            k = k + 1
         end do row
      end do
   end subroutine gather

   !> Gives plans and memory back: the product is not planned any more.
   subroutine release(self)
      class(single_product_t), intent(inout) :: self

      if (c_associated(self%row_forward)) call fftwf_destroy_plan(self%row_forward)
      if (c_associated(self%row_backward)) call fftwf_destroy_plan(self%row_backward)
      if (c_associated(self%column_forward)) call fftwf_destroy_plan(self%column_forward)
      if (c_associated(self%column_backward)) call fftwf_destroy_plan(self%column_backward)
      self%row_forward = c_null_ptr
      self%row_backward = c_null_ptr
      self%column_forward = c_null_ptr
      self%column_backward = c_null_ptr
      if (self%my == 1 .and. associated(self%product)) call fftwf_free(c_loc(self%product))
      if (associated(self%spectrum)) call fftwf_free(c_loc(self%spectrum))
      if (associated(self%row)) call fftwf_free(c_loc(self%row))
      if (associated(self%columns)) call fftwf_free(c_loc(self%columns))
      nullify (self%product, self%spectrum, self%row, self%columns)
      if (allocated(self%symbol)) deallocate (self%symbol)
   end subroutine release

   !> Gives plans and memory back.
   subroutine destroy_single_product(self)
      type(single_product_t), intent(inout) :: self

      call self%release()
   end subroutine destroy_single_product

end module single_product

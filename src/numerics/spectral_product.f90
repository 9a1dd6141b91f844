!> Products with a matrix that is diagonal in Fourier space, on uniform grids of one or two
!> dimensions, by FFTW.
!>
!> Periodic: y = F^-1 (symbol . F x) on the grid itself. Open: x is padded with zeros to about
!> twice its length, which makes the discrete convolution with a kernel exact (Hockney & Eastwood,
!> Computer Simulation Using Particles, 1988, section 6-5-4). Plans are made once, by FFTW_ESTIMATE:
!> a repeated run gives the same bits.
module spectral_product
   use, intrinsic :: iso_fortran_env, only: real32
   use double_product, only: double_product_t => grid_product_t, &
      new_double_product => new_grid_product
   use errors, only: error_t
   use grid_transform, only: transform_field
   use kinds, only: wp
   use single_product, only: new_single_product => new_grid_product, &
      single_product_t => grid_product_t
   implicit none (type, external)
   private

   public :: spectral_product_t, new_spectral_product, new_convolution, padded_size

   !> A product. Fields are stored flat, x fastest: (nx*ny); a line has ny = 1. Do not copy it: it
   !> owns FFTW plans.
   type :: spectral_product_t
      !> Nodes of the grid in x and y.
      integer, private :: nodes(2) = 0
      !> Size of the transform: that of the grid, or larger if padded.
      integer, private :: sizes(2) = 0
      !> Threads that share the work.
      integer, private :: threads = 1
      !> The same matrix in single precision; `plan_single` prepares it.
      type(single_product_t) :: single
      type(double_product_t), private :: double
   contains
      procedure :: apply, apply_inverse, plan_single, transforms
   end type spectral_product_t

contains

   !> Plans a periodic product on a grid of `nx` x `ny` >= 1 nodes (ny = 1: a line) with the real
   !> `symbol(0:nx/2, 0:ny-1)`, even in y, in the order of the FFT: wavenumbers 0 ... nx/2, and in y
   !> 0 ... -1. Work is shared by `threads`. With `is_single`, products in double precision are not
   !> planned and must not be used. Fails (internal_error) if FFTW gives no memory or no plan.
   subroutine new_spectral_product(self, nx, ny, symbol, threads, error, is_single)
      type(spectral_product_t), intent(inout) :: self
      integer, intent(in) :: nx, ny, threads
      real(wp), intent(in) :: symbol(0:, 0:)
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: is_single

      call plan_as_wanted(self, [nx, ny], [nx, ny], symbol, threads, error, is_single)
   end subroutine new_spectral_product

   !> Plans the product y(i) = sum over j of kernel(|i - j|) x(j) on an open grid; `kernel(0:nx-1,
   !> 0:ny-1)` is even in both directions. `threads`, `is_single` and errors as in
   !> `new_spectral_product`.
   subroutine new_convolution(self, kernel, threads, error, is_single)
      type(spectral_product_t), intent(inout) :: self
      real(wp), intent(in) :: kernel(0:, 0:)
      integer, intent(in) :: threads
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: is_single
      real(wp), allocatable :: values(:)
      complex(wp), allocatable :: spectrum(:, :)
      integer :: i, j, mx, my, nx, ny

      nx = size(kernel, 1)
      ny = size(kernel, 2)
      mx = padded_size(nx)
      my = padded_size(ny)
      allocate (values(mx*my), source=0.0_wp)
      do j = 0, ny - 1
         values(mx*j + 1:mx*j + nx) = kernel(:, j)
         do i = 1, nx - 1
            values(mx*(j + 1) - i + 1) = kernel(i, j)
         end do
         if (j > 0) values(mx*(my - j) + 1:mx*(my - j + 1)) = values(mx*j + 1:mx*(j + 1))
      end do
      call transform_field([mx, my], values, spectrum)
      deallocate (values)
      call plan_as_wanted(self, [nx, ny], [mx, my], spectrum%re, threads, error, is_single)
   end subroutine new_convolution

   !> Sets the sizes and plans in double precision, or in single only.
   subroutine plan_as_wanted(self, nodes, sizes, symbol, threads, error, is_single)
      type(spectral_product_t), intent(inout) :: self
      integer, intent(in) :: nodes(2), sizes(2), threads
      real(wp), intent(in) :: symbol(:, :)
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: is_single
      logical :: wants_single

      call self%double%release()
      call self%single%release()
      self%nodes = nodes
      self%sizes = sizes
      self%threads = threads
      wants_single = .false.
      if (present(is_single)) wants_single = is_single
      if (wants_single) then
         call new_single_product(self%single, nodes, sizes, threads, error)
         if (.not. allocated(error)) call self%single%set_symbol(symbol)
      else
         call new_double_product(self%double, nodes, sizes, threads, error)
         if (.not. allocated(error)) call self%double%set_symbol(symbol)
      end if
   end subroutine plan_as_wanted

   !> Length of the transform of an open line of `n` nodes: the smallest even 2^a 3^b 5^c >= 2n - 2
   !> (1 for a single node): the distances n - 1 and 1 - n, whose kernel is the same, share a place.
   pure function padded_size(n) result(m)
      integer, intent(in) :: n
      integer :: m, rest

      m = max(2*n - 2, 1)
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
         m = m + 2
      end do
   end function padded_size

   !> Computes y = A x, both (nx*ny).
   subroutine apply(self, x, y)
      class(spectral_product_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: x(:)
      real(wp), contiguous, intent(out) :: y(:)

      call self%double%apply(x, y)
   end subroutine apply

   !> Computes y = A^-1 x of a periodic product, both (nx*ny), without the waves for which A is not
   !> positive.
   subroutine apply_inverse(self, x, y)
      class(spectral_product_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: x(:)
      real(wp), contiguous, intent(out) :: y(:)
      real(wp), allocatable :: symbol(:, :, :), scale(:, :)

      call move_alloc(self%double%symbol, symbol)
      associate (a => symbol(:, :, 1), b => symbol(:, :, 2), c => symbol(:, :, 3))
         scale = a*c - b**2
         self%double%symbol = reshape([c, -b, a], shape(symbol))
         ! Of the two waves behind these values at most one counts.
         where (spread(scale, 3, 3) <= 0.0_wp) self%double%symbol = symbol
         where (scale <= 0.0_wp) scale = max((a + c)**2, tiny(1.0_wp))
      end associate
      scale = self%double%weight()**2/scale
      self%double%symbol = self%double%symbol*spread(scale, 3, 3)
      call self%apply(x, y)
      call move_alloc(symbol, self%double%symbol)
   end subroutine apply_inverse

   !> Transforms made: size, pairs in double, pairs in single precision.
   pure function transforms(self)
      class(spectral_product_t), intent(in) :: self
      integer :: transforms(4)

      transforms = [self%sizes, int(self%double%pairs), int(self%single%pairs)]
   end function transforms

   !> Prepares products in single precision, once.
   subroutine plan_single(self, error)
      class(spectral_product_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error

      if (self%single%is_planned()) return
      call new_single_product(self%single, self%nodes, self%sizes, self%threads, error)
      if (allocated(error)) return
      self%single%symbol = real(self%double%symbol, real32)
   end subroutine plan_single

end module spectral_product

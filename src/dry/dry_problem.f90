!> The dry contact of a rough surface as one quadratic programme, dimensionless, for lines and
!> areas:
!>
!>    min 1/2 p.K p - p.z   over  0 <= p <= H  and  sum p = load,
!>
!> whose optimality conditions are those of contact: gap h = v - datum >= 0 where p < H (v = K
!> p - z), p h = 0, and v - datum = -d_p <= 0 where p = H. Lengths in units of the domain, heights
!> in their rms value s (or as given to `new_dry_problem`), pressures in E' s/(4 L): then K has the
!> transfer function 1/q.
module dry_problem
   use errors, only: error_t
   use half_space_response, only: band_limited_response, element_response, open_area_kernel, &
      open_line_kernel
   use kinds, only: wp
   use spectral_product, only: new_convolution, new_spectral_product, spectral_product_t
   implicit none (type, external)
   private

   public :: dry_problem_t, dry_grid_t, new_dry_problem

   !> Kinds of kernel.
   integer, parameter, public :: kernel_band_limited = 1, kernel_element = 2, kernel_open = 3
   !> Hardness of an elastic contact.
   real(wp), parameter, public :: no_hardness = huge(1.0_wp)

   !> Nodes, size and kernel.
   type :: dry_grid_t
      !> Nodes; a line has ny = 1.
      integer :: nx, ny
      !> Ly/Lx (1 for a line).
      real(wp) :: aspect
      !> `kernel_band_limited`, `kernel_element` or `kernel_open`.
      integer :: kernel
      !> Threads that share the work of an area.
      integer :: threads = 1
   end type dry_grid_t

   !> One surface on its grid, with hardness and load, which may change between solves.
   type :: dry_problem_t
      type(dry_grid_t) :: grid
      !> z, positive out of the material, its mean removed (nx*ny), x fastest.
      real(wp), allocatable :: height(:)
      !> Its largest value before any load.
      real(wp) :: top
      !> H.
      real(wp) :: hardness
      !> Sum of p over the nodes.
      real(wp) :: load
      !> Unit of gaps in the error measure: rms of z; of a flat surface p_c dx.
      real(wp) :: height_scale
      !> K; open kernels have padded transforms.
      type(spectral_product_t) :: elastic
   contains
      procedure :: find_v, is_capped
   end type dry_problem_t

contains

   !> Prepares a problem on `grid` with the heights z (nx*ny), without hardness and with load 0.
   !> `is_guess`: only products in single precision are prepared, no `find_v`. Fails
   !> (internal_error) if FFTW does.
   subroutine new_dry_problem(self, grid, height, error, is_guess)
      type(dry_problem_t), intent(inout) :: self
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: height(:)
      type(error_t), allocatable, intent(out) :: error
      logical, intent(in), optional :: is_guess

      self%grid = grid
      self%hardness = no_hardness
      self%load = 0.0_wp
      self%height = height - sum(height)/size(height)
      self%top = maxval(self%height)
      self%height_scale = norm2(self%height)/sqrt(real(size(height), wp))
      if (self%height_scale <= epsilon(1.0_wp)) self%height_scale = 0.0_wp   ! flat but for rounding
      associate (nx => grid%nx, ny => grid%ny, aspect => grid%aspect, threads => grid%threads)
         select case (grid%kernel)
         case (kernel_band_limited)
            call new_spectral_product(self%elastic, nx, ny, band_limited_response(nx, ny, 1.0_wp, &
               aspect), threads, error, &
               is_guess)
         case (kernel_element)
            call new_spectral_product(self%elastic, nx, ny, element_response(nx, ny, 1.0_wp, &
               aspect), threads, error, is_guess)
         case (kernel_open)
            if (ny == 1) then
               call new_convolution(self%elastic, open_line_kernel(nx, 1.0_wp/nx), threads, &
                  error, is_guess)
            else
               call new_convolution(self%elastic, open_area_kernel(nx, ny, 1.0_wp/nx, aspect/ny), &
                  threads, error, is_guess)
            end if
         case default
            error stop 'new_dry_problem: a kernel without its case'
         end select
      end associate
   end subroutine new_dry_problem

   !> Computes v = K p - z of a pressure `p` (nx*ny).
   subroutine find_v(self, p, v)
      class(dry_problem_t), intent(inout) :: self
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), allocatable, intent(inout) :: v(:)

      if (.not. allocated(v)) allocate (v, mold=p)
      call self%elastic%apply(p, v)
      v = v - self%height
   end subroutine find_v

   !> Whether the pressure has an upper bound.
   pure logical function is_capped(self)
      class(dry_problem_t), intent(in) :: self

      is_capped = self%hardness < no_hardness
   end function is_capped

end module dry_problem

!> The dry contact of a rough surface as one quadratic programme, dimensionless, for lines and
!> areas:
!>
!>    min 1/2 p.K p - p.z   over  0 <= p <= H  and  sum p = load,
!>
!> whose optimality conditions are those of contact: gap h = v - datum >= 0 where p < H (v = K
!> p - z), p h = 0, and v - datum = -d_p <= 0 where p = H. Lengths in units of the domain, heights
!> in their rms value s (or as given to `new_dry_problem`), pressures in E' s/(4 L): then K has the
!> transfer function 1/q.
!>
!> Its loads, how to solve it, the solution for one load, and its reference values in SI.
module dry_problem
   use, intrinsic :: iso_fortran_env, only: real32
   use errors, only: error_t
   use half_space, only: band_limited_response, element_response, line_deflection_coefficients, &
      open_area_kernel
   use iteration_report, only: report_t
   use kinds, only: wp
   use spectral_product, only: new_convolution, new_spectral_product, spectral_product_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: dry_grid_t, dry_loads_t, dry_problem_t, dry_scaling_t, dry_settings_t, &
      dry_solution_t, end_of_iteration, new_dry_problem, new_dry_scaling

   !> Lengths x L, heights x s, pressures x E' s/(4 L): then 1/q is the transfer function of the
   !> half-space.
   type :: dry_scaling_t
      !> L, length of the domain in x [m].
      real(wp) :: length
      !> s, rms of the heights; for a flat surface L [m].
      real(wp) :: height
      !> E' s/(4 L) [Pa].
      real(wp) :: pressure
      !> E' [Pa].
      real(wp) :: reduced_modulus
      !> Whether all heights are equal, except for rounding.
      logical :: is_flat = .false.

   end type dry_scaling_t

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

   !> Methods.
   integer, parameter, public :: method_conjugate_gradient = 1, method_steepest_descent = 2

   !> Default bound on the error measure, and default limit of iterations.
   real(wp), parameter, public :: dry_tolerance = 1.0e-8_wp
   integer, parameter, public :: dry_cycles = 10000

   !> Most nodes of a grid whose error bars use finer ones, if its surface has short waves.
   integer, parameter, public :: max_nodes_to_refine = 2**18

   !> How to solve.
   type :: dry_settings_t
      integer :: method = method_conjugate_gradient
      !> Bound on the error measure.
      real(wp) :: tolerance = dry_tolerance
      !> Most iterations.
      integer :: max_cycles = dry_cycles
      !> Whether a guess is enough, which single precision gives.
      logical :: is_rough = .false.
      !> Whether to keep the pressures of all loads.
      logical :: keeps_pressures = .false.
      !> Pressures from which the loads start (nx*ny, loads), dimensionless; not allocated: none.
      real(real32), allocatable :: starts(:, :)
   end type dry_settings_t

   !> Loads and hardness, SI.
   type :: dry_loads_t
      !> Mean pressures, in the order in which they act [Pa].
      real(wp), allocatable :: mean_pressure(:)
      !> Separations as in `dry_row_t` instead [m].
      real(wp), allocatable :: separation(:)
      !> Hardness [Pa]; huge: elastic.
      real(wp) :: hardness
      !> Whether each load finds the surface left by the one before, else the virgin one.
      logical :: has_history = .false.
   end type dry_loads_t

   !> Pressure and gaps for one load, dimensionless, fields (nx*ny).
   type :: dry_solution_t
      real(wp), allocatable :: pressure(:)
      !> v = K p - z: gap = v - datum where p < H, plastic deformation datum - v where p = H.
      real(wp), allocatable :: v(:)
      real(wp) :: datum = 0.0_wp
      !> Nodes with p > 0, with p = H; 0 contacts: no solution yet.
      integer :: contacts = 0, capped = 0
      !> Error measure.
      real(wp) :: kkt = huge(1.0_wp)
      type(report_t) :: report
      !> Transforms made: size mx x my, pairs in double, pairs in single precision (4, any number of
      !> grids).
      integer, allocatable :: transforms(:, :)
   end type dry_solution_t

contains

   !> Reference values for the heights `z` [m] on a domain of `length` [m] and the modulus E' [Pa].
   pure function new_dry_scaling(z, length, reduced_modulus) result(scaling)
      real(wp), intent(in) :: z(:), length, reduced_modulus
      type(dry_scaling_t) :: scaling

      scaling%length = length
      scaling%height = sqrt(sum((z - sum(z)/size(z))**2)/size(z))
      scaling%is_flat = scaling%height <= length*epsilon(1.0_wp)
      if (scaling%is_flat) scaling%height = length
      scaling%reduced_modulus = reduced_modulus
      scaling%pressure = reduced_modulus*scaling%height/(4.0_wp*length)
   end function new_dry_scaling

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
      self%height_scale = sqrt(sum(self%height**2)/size(height))
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
               call new_convolution(self%elastic, reshape(-line_deflection_coefficients(nx - 1, &
                  1.0_wp/nx), [nx, 1]), threads, error, is_guess)
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

   !> Why an iteration of at most `max_cycles` ended at `error`; `is_stalled`: the error had stopped
   !> falling.
   function end_of_iteration(report, error, max_cycles, is_stalled) result(reason)
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: error
      integer, intent(in) :: max_cycles
      logical, intent(in) :: is_stalled
      character(:), allocatable :: reason

      if (report%converged) then
         reason = 'converged'
      else if (error >= huge(1.0_wp)) then
         reason = 'values are not finite'
      else if (is_stalled) then
         reason = 'the error has stopped falling at ' // to_text(error, 3)
      else
         reason = 'the error is ' // to_text(error, 3) // ' after '// &
            '' // to_text(max_cycles) // ' iterations'
      end if
   end function end_of_iteration

end module dry_problem

!> One multigrid cycle that solves J v = f of a point contact approximately: the preconditioner of
!> its Newton method.
!>
!> A V(0,1) cycle: the coarse grid, then line relaxation. The equations of coarse grids are those of
!> the injected pressure, film and cavity; the coarsest one is solved exactly. The film of the
!> coarse correction is carried along, so that a cycle takes no product with the kernel of the
!> finest grid. (Relaxation before the coarse grid too takes 15 to 40 % fewer iterations, but as
!> many products with the kernel as iterations, besides those of GMRES.)
module point_cycle
   use linear_systems, only: solve_dense, solve_factored
   use errors, only: error_t
   use kinds, only: wp
   use point_contact, only: point_contact_t
   use point_equations, only: evaluate
   use point_level, only: bands, deflect, multiply_bands, new_level, point_level_t
   use point_smoother, only: factor_lines, point_smoother_t, sweep_lines
   use transfer, only: full_weighting, prolong_linear
   implicit none (type, external)
   private

   public :: new_hierarchy, prepare_cycle, run_cycle

   !> Fewest intervals in each direction, and nodes, of the coarsest grid.
   integer, parameter, public :: fewest = 12

   !> Fields of one level on which its cycle works.
   type :: cycle_work_t
      real(wp), allocatable, dimension(:, :) :: right_side, residual, v, film
   end type cycle_work_t

   !> The levels, the finest first, and all that a cycle needs.
   type, public :: point_hierarchy_t
      type(point_level_t), allocatable :: levels(:)
      type(point_smoother_t), allocatable :: smoothers(:)
      type(cycle_work_t), allocatable :: work(:)
      !> Factored equations of the flowing nodes of the coarsest level.
      real(wp), allocatable :: coarsest(:, :), unknown(:)
      integer, allocatable :: pivots(:)
   end type point_hierarchy_t

contains

   !> Makes the levels of `nx` times `ny` intervals and below. Fails (internal_error) if FFTW does.
   subroutine new_hierarchy(hierarchy, contact, nx, ny, threads, error)
      type(point_hierarchy_t), intent(inout) :: hierarchy
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx, ny, threads
      type(error_t), allocatable, intent(out) :: error
      integer :: k, levels, n(2)

      n = [nx, ny]
      levels = 1
      do while (all(mod(n, 2) == 0) .and. all(n/2 >= fewest))
         n = n/2
         levels = levels + 1
      end do
      if (allocated(hierarchy%levels)) deallocate (hierarchy%levels, hierarchy%smoothers, &
         hierarchy%work)
      allocate (hierarchy%levels(levels), hierarchy%smoothers(levels), hierarchy%work(levels))
      do k = 1, levels
         n = [nx, ny]/2**(k - 1)
         call new_level(hierarchy%levels(k), contact, n(1), n(2), threads, error)
         if (allocated(error)) return
         associate (work => hierarchy%work(k), level => hierarchy%levels(k))
            allocate (work%right_side, work%residual, work%v, work%film, mold=level%film)
         end associate
      end do
   end subroutine new_hierarchy

   !> Prepares cycles for the bands of the finest level: the coarse ones, lines, factors. Fails
   !> (internal_error) if the coarsest matrix is singular.
   subroutine prepare_cycle(hierarchy, contact, error)
      type(point_hierarchy_t), intent(inout) :: hierarchy
      type(point_contact_t), intent(in) :: contact
      type(error_t), allocatable, intent(out) :: error
      integer :: k

      do k = 1, size(hierarchy%levels)
         associate (level => hierarchy%levels(k))
            if (k > 1) then
               associate (finer => hierarchy%levels(k - 1))
                  level%pressure = finer%pressure(::2, ::2)
                  level%film = finer%film(::2, ::2)
                  level%flowing = finer%flowing(::2, ::2)
                  level%inverse_time_step = finer%inverse_time_step
                  level%entrainment = finer%entrainment
               end associate
               call evaluate(level, contact, .true.)
            end if
            if (k < size(hierarchy%levels)) call factor_lines(hierarchy%smoothers(k), level)
         end associate
      end do
      call factor_coarsest(hierarchy, error)   ! error: handed up
   end subroutine prepare_cycle

   !> Sets and factors the equations of the flowing nodes of the coarsest level.
   subroutine factor_coarsest(hierarchy, error)
      type(point_hierarchy_t), intent(inout) :: hierarchy
      type(error_t), allocatable, intent(out) :: error
      integer, parameter :: di(bands) = [-2, -1, 0, 1, 0, 0], dj(bands) = [0, 0, 0, 0, -1, 1]
      real(wp), allocatable :: column(:, :), kernel(:, :), matrix(:, :)
      integer, allocatable :: nodes(:, :)   ! the flowing ones
      integer :: a, b, c, i, j, k, n

      associate (level => hierarchy%levels(size(hierarchy%levels)), &
         h => hierarchy%levels(size(hierarchy%levels))%by_film)
         n = level%nx - 1
         allocate (kernel(-n - 1:n + 1, 0:level%ny), column(n, level%ny - 1))
         do i = -n - 1, n + 1
            kernel(i, :) = level%kernel(abs(i), :)
         end do
         nodes = reshape([(([i, j], i=1, n), j=1, level%ny - 1)], [2, size(column)])
         nodes = nodes(:, pack([(i, i=1, size(column))], reshape(level%flowing(1:n, 1:level%ny &
            - 1) > 0.0_wp, [size(column)])))
         allocate (matrix(size(nodes, 2), size(nodes, 2)))
         do c = 1, size(nodes, 2)
            a = nodes(1, c)
            b = nodes(2, c)
            do j = 1, level%ny - 1
               do i = 1, n
                  column(i, j) = h(i, 1, j)*kernel(i - 2 - a, abs(j - b)) &
                     + h(i, 2, j)*kernel(i - 1 - a, abs(j - b)) + h(i, 3, j)*kernel(i - a, abs(j &
                     - b)) + h(i, 4, j)*kernel(i + 1 - a, abs(j - b)) + h(i, 5, j)*kernel(i - a, &
                     abs(j - 1 - b)) + h(i, 6, j)*kernel(i - a, abs(j + 1 - b))
               end do
            end do
            do k = 1, bands
               i = a - di(k)
               j = b - dj(k)
               if (min(i, j) >= 1 .and. i <= n .and. j < level%ny) column(i, j) = column(i, j) &
                  + level%by_pressure(i, k, j)
            end do
            do k = 1, size(nodes, 2)
               matrix(k, c) = column(nodes(1, k), nodes(2, k))
            end do
         end do
         hierarchy%unknown = 0*nodes(1, :)
         hierarchy%pivots = nodes(1, :)
         call move_alloc(matrix, hierarchy%coarsest)
         if (size(nodes) > 0) call solve_dense(hierarchy%coarsest, hierarchy%unknown, &
            hierarchy%pivots, error)   ! error: handed up
      end associate
   end subroutine factor_coarsest

   !> Computes v of one cycle for the right side `f`, both on all nodes of the finest level; v is 0
   !> where nothing flows.
   subroutine run_cycle(hierarchy, f, v)
      type(point_hierarchy_t), intent(inout) :: hierarchy
      real(wp), intent(in) :: f(0:hierarchy%levels(1)%nx, 0:hierarchy%levels(1)%ny)
      real(wp), intent(out) :: v(0:hierarchy%levels(1)%nx, 0:hierarchy%levels(1)%ny)

      hierarchy%work(1)%right_side(:, :) = f
      call descend(hierarchy, 1)
      v = hierarchy%work(1)%v
   end subroutine run_cycle

   !> The cycle from level `k` on.
   recursive subroutine descend(hierarchy, k)
      type(point_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k

      associate (level => hierarchy%levels(k), work => hierarchy%work(k))
         if (k == size(hierarchy%levels)) then
            hierarchy%unknown = pack(work%right_side, level%flowing > 0.0_wp)
            if (size(hierarchy%unknown) > 0) call solve_factored(hierarchy%coarsest, &
               hierarchy%unknown, hierarchy%pivots)
            work%v = unpack(hierarchy%unknown, level%flowing > 0.0_wp, 0.0_wp)
         else
            call restrict(hierarchy%levels(k + 1), work%right_side, hierarchy%work(k &
               + 1)%right_side)
            call descend(hierarchy, k + 1)
            call interpolate(level, hierarchy%work(k + 1), work)
            call multiply_bands(level, work%v, work%film, work%residual, work%right_side)
            call sweep_lines(hierarchy%smoothers(k), level, work%residual, work%v)
         end if
         if (k > 1) call deflect(level, work%v, work%film)
      end associate
   end subroutine descend

   !> Full weighting of a `fine` residual along x, then y, where the coarse `level` flows.
   subroutine restrict(level, fine, coarse)
      type(point_level_t), intent(in) :: level
      real(wp), intent(in) :: fine(0:, 0:)
      real(wp), intent(out) :: coarse(0:, 0:)
      integer :: j

      coarse = 0.0_wp
      !$omp parallel do num_threads(level%threads) schedule(static)
      do j = 1, level%ny - 1
         call full_weighting(0.25_wp*(fine(:, 2*j - 1) + 2*fine(:, 2*j) + fine(:, 2*j + 1)), &
            coarse(:, j))
         coarse(:, j) = level%flowing(:, j)*coarse(:, j)
      end do
      !$omp end parallel do
   end subroutine restrict

   !> The bilinear interpolation of a `coarse` v, on flowing nodes, and its film to a fine `level`.
   subroutine interpolate(level, coarse, fine)
      type(point_level_t), intent(in) :: level
      type(cycle_work_t), intent(in) :: coarse
      type(cycle_work_t), intent(inout) :: fine
      integer :: j

      !$omp parallel do num_threads(level%threads) schedule(static)
      do j = 0, level%ny
         associate (lower => j/2, upper => (j + 1)/2)
            call prolong_linear(0.5_wp*(coarse%v(:, lower) + coarse%v(:, upper)), fine%v(:, j))
            call prolong_linear(0.5_wp*(coarse%film(:, lower) + coarse%film(:, upper)), &
               fine%film(:, j))
         end associate
         fine%v(:, j) = level%flowing(:, j)*fine%v(:, j)
      end do
      !$omp end parallel do
   end subroutine interpolate

end module point_cycle

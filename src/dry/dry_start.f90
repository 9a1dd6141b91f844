!> First guesses of the contact pressure from coarser grids.
module dry_start
   use dry_conjugate_gradient, only: iterate_conjugate_gradient
   use dry_problem, only: dry_grid_t, dry_problem_t, dry_settings_t, dry_solution_t, &
      kernel_band_limited, kernel_element, kernel_open, new_dry_problem
   use errors, only: error_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: nested_start

   !> Fewest nodes along a side of a coarser grid.
   integer, parameter :: coarsest = 32
   !> Error to which coarser grids are solved. A smaller one gains nothing on periodic areas, where
   !> finer grids bring new contacts; it helps on lines, and on open areas, which are smoother than
   !> most and have expensive fine grids.
   real(wp), parameter :: area_tolerance = 0.1_wp, usual_tolerance = 1.0e-3_wp
   !> Most iterations on a coarser grid.
   integer, parameter :: max_iterations = 200

contains

   !> Sets a pressure `p` (nx*ny) within its bounds and with its load: solutions to a rough E on
   !> grids of half the nodes each, the coarsest first; each coarse node gives its pressure to 2 or
   !> 4 nodes of the finer grid. `transforms` are those made, as in a solution. Fails
   !> (internal_error) if FFTW does.
   recursive subroutine nested_start(problem, p, transforms, error)
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(out) :: p(:)
      integer, allocatable, intent(out) :: transforms(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(dry_problem_t) :: coarse
      type(dry_settings_t) :: settings
      type(dry_solution_t) :: solution
      integer :: n

      allocate (transforms(4, 0))
      n = size(p)
      p = problem%load/n
      associate (nx => problem%grid%nx, ny => problem%grid%ny)
         if (mod(nx, 2) /= 0 .or. nx < 2*coarsest) return
         if (ny > 1 .and. (mod(ny, 2) /= 0 .or. ny < 2*coarsest)) return
      end associate
      call halve(problem, coarse, error)
      if (allocated(error)) return
      allocate (solution%pressure(size(coarse%height)))
      call nested_start(coarse, solution%pressure, transforms, error)
      if (allocated(error)) return
      settings = dry_settings_t(tolerance=merge(area_tolerance, usual_tolerance, &
         problem%grid%ny > 1 .and. problem%grid%kernel /= kernel_open), &
            max_cycles=max_iterations, is_rough=.true.)
      call iterate_conjugate_gradient(coarse, settings, solution, error)
      if (allocated(error)) return
      transforms = reshape([transforms, coarse%elastic%transforms()], [4, size(transforms, 2) + 1])
      if (.not. solution%kkt < 1.0_wp) return
      call refine(coarse%grid, solution%pressure, problem%grid, p)
   end subroutine nested_start

   !> Sets up the problem on half the nodes: heights averaged over 2 or 4 nodes, with the same mean
   !> pressure and hardness.
   subroutine halve(problem, coarse, error)
      type(dry_problem_t), intent(in) :: problem
      type(dry_problem_t), intent(inout) :: coarse
      type(error_t), allocatable, intent(out) :: error
      type(dry_grid_t) :: grid
      real(wp), allocatable :: height(:)
      integer :: below, i, j, nx, row, share

      grid = problem%grid
      nx = grid%nx
      grid%nx = nx/2
      if (grid%ny > 1) grid%ny = grid%ny/2
      share = size(problem%height)/(grid%nx*grid%ny)
      allocate (height(grid%nx*grid%ny))
      do j = 0, grid%ny - 1
         row = (share/2)*nx*j
         below = row + (share/4)*nx   ! of a line the row itself
         do i = 1, grid%nx
            height(i + grid%nx*j) = 0.25_wp*(problem%height(row + 2*i - 1) &
               + problem%height(row + 2*i) + problem%height(below + 2*i - 1) &
               + problem%height(below + 2*i))
         end do
      end do
      ! A guess needs no exact element kernel, whose sums cost more than the guess.
      if (grid%kernel == kernel_element) grid%kernel = kernel_band_limited
      call new_dry_problem(coarse, grid, height, error, is_guess=.true.)
      if (allocated(error)) return
      coarse%load = problem%load/share
      coarse%hardness = problem%hardness
   end subroutine halve

   !> Gives every node of the fine grid the pressure of its coarse node.
   pure subroutine refine(coarse, p_coarse, fine, p)
      type(dry_grid_t), intent(in) :: coarse, fine
      real(wp), intent(in) :: p_coarse(:)
      real(wp), intent(out) :: p(:)
      integer :: i, j, row

      do j = 0, fine%ny - 1
         row = coarse%nx*(j*coarse%ny/fine%ny)
         do i = 1, coarse%nx
            p(fine%nx*j + 2*i - 1:fine%nx*j + 2*i) = p_coarse(row + i)
         end do
      end do
   end subroutine refine

end module dry_start

!> A solved dry contact and its runs on other grids or with part of the model left out.
module dry_record
   use, intrinsic :: iso_fortran_env, only: real32
   use dry_problem, only: dry_grid_t, dry_loads_t, dry_scaling_t, dry_settings_t, kernel_element, &
      kernel_open, method_conjugate_gradient, new_dry_scaling, no_hardness
   use dry_quantities, only: dry_outcome_t, dry_row_t, mean_pressure
   use dry_sweep, only: solve_dry_sweep
   use errors, only: error_t, input_error
   use kinds, only: wp
   use resampling, only: interpolate_heights, resample_heights
   use synthetic_surface, only: truncate_harmonics
   implicit none (type, external)
   private

   public :: has_few_nodes

   !> What a run leaves out: nothing; plasticity; the finer half of a number of harmonics; the
   !> images of a periodic surface (an open one gets them), to be compared with a periodic run with
   !> pressure elements; the second direction of an area, of which one row remains. The last three
   !> start from zero pressure.
   integer, parameter :: without_nothing = 0
   integer, parameter, public :: without_yield = 1, without_fine_harmonics = 2, &
      without_images = 3, with_elements = 4, without_rows = 5

   !> Arguments of `solve_dry_sweep`.
   type, public :: dry_sweep_t
      type(dry_grid_t) :: grid
      !> Heights (nx*ny) [m].
      real(wp), allocatable :: height(:)
      type(dry_scaling_t) :: scaling
      type(dry_loads_t) :: loads
      type(dry_settings_t) :: settings
   end type dry_sweep_t

   !> One run.
   type, public :: dry_setting_t
      !> Spacing relative to the contact, and the error measure to reach.
      real(wp) :: ratio, tolerance
      integer :: without = without_nothing
      !> Number of harmonics, or the row (0 ... ny - 1) that remains.
      integer :: number = 0
      !> Number of the load; 0: all.
      integer :: load = 0
      !> Whether single precision is enough.
      logical :: is_rough = .false.
   end type dry_setting_t

   !> A contact and its solution; why a run has failed, FFTW: no other is made then.
   type, public :: dry_record_t
      type(dry_sweep_t) :: sweep
      type(dry_outcome_t) :: outcome
      type(error_t), allocatable :: error
   contains
      procedure :: run
   end type dry_record_t

   !> Most nodes of a line and of an area that are compared with finer grids.
   integer, parameter :: max_nodes_for_finer(2) = [2**17, 2**14]
   !> Fewest nodes along a side.
   integer, parameter :: min_nodes = 8
   !> Share of the mean contact pressure below which a resampled pressure is set to zero.
   real(wp), parameter :: least_pressure = 0.05_wp

contains

   !> Returns the `rows` of a run, not converged if nothing touches, if the grid is too coarse, or
   !> if a run has failed.
   subroutine run(self, setting, rows)
      class(dry_record_t), intent(inout) :: self
      type(dry_setting_t), intent(in) :: setting
      type(dry_row_t), allocatable, intent(out) :: rows(:)
      type(error_t), allocatable :: error
      type(dry_outcome_t) :: outcome
      type(dry_sweep_t) :: sweep
      logical :: is_possible

      ! one load of the result that no earlier load has deformed
      if (setting%load > 0 .and. setting%without == without_nothing &
         .and. .not. abs(setting%ratio - 1.0_wp) > 0.0_wp &
         .and. (setting%load == 1 .or. .not. self%sweep%loads%has_history)) then
         rows = self%outcome%rows(setting%load:setting%load)
         return
      end if
      allocate (rows(merge(1, size(self%outcome%rows), setting%load > 0)))
      if (allocated(self%error)) return
      call prepare(self, setting, sweep, is_possible, error)
      if (.not. allocated(error) .and. is_possible) call solve_dry_sweep(sweep%grid, sweep%height, &
         sweep%scaling, sweep%loads, sweep%settings, outcome, error)
      if (allocated(error)) then   ! of bad input: nothing touches at that separation on this grid
         if (error%kind /= input_error) call move_alloc(error, self%error)
      else if (is_possible) then
         call move_alloc(outcome%rows, rows)
      end if
   end subroutine run

   !> Prepares the `sweep` of a run, unless the grid is too coarse. Error (internal_error): FFTW.
   subroutine prepare(self, setting, sweep, is_possible, error)
      class(dry_record_t), intent(in) :: self
      type(dry_setting_t), intent(in) :: setting
      type(dry_sweep_t), intent(out) :: sweep
      logical, intent(out) :: is_possible
      type(error_t), allocatable, intent(out) :: error
      logical :: is_resampled
      integer :: first, last

      sweep = self%sweep
      associate (grid => sweep%grid, old => self%sweep%grid, settings => sweep%settings)
         settings%method = method_conjugate_gradient
         settings%keeps_pressures = .false.
         settings%is_rough = setting%is_rough
         settings%tolerance = max(settings%tolerance, setting%tolerance)
         first = max(setting%load, 1)
         last = merge(first, size(self%outcome%rows), setting%load > 0)
         if (setting%load > 0) then
            if (allocated(sweep%loads%separation)) deallocate (sweep%loads%separation)
            sweep%loads%mean_pressure = [self%outcome%rows(first)%values(mean_pressure)]
         end if
         is_resampled = abs(setting%ratio - 1.0_wp) > epsilon(1.0_wp)
         is_possible = .not. (is_resampled .and. shorter_side(grid) &
            < min_nodes*max(setting%ratio, 1.0_wp))
         if (.not. is_possible) return
         if (is_resampled) then
            grid%nx = other_count(old%nx, setting%ratio)
            grid%ny = other_count(old%ny, setting%ratio)
            call resample_field(old, grid, sweep%height)
         end if
         if (setting%without < without_images) then
            associate (pressures => self%outcome%pressures(:, first:last))
               if (.not. is_resampled) settings%starts = pressures
               if (is_resampled) call resample_pressures(old, grid, pressures, settings%starts)
            end associate
         end if
         select case (setting%without)
         case (without_nothing)
            continue
         case (without_yield)
            sweep%loads%hardness = no_hardness
         case (without_fine_harmonics)
            is_possible = 2*setting%number < shorter_side(grid)   ! both halves must be on the grid
            if (is_possible) call truncate_harmonics(setting%number/2, [grid%nx, grid%ny], &
               sweep%height, error)
         case (with_elements)
            if (old%kernel /= kernel_open) grid%kernel = kernel_element
         case (without_images)
            grid%kernel = merge(kernel_element, kernel_open, old%kernel == kernel_open)
            ! a body that touches at x = y = 0 moves to the middle of an open domain
            if (old%kernel /= kernel_open) sweep%height = reshape(cshift(cshift(reshape( &
               sweep%height, [grid%nx, grid%ny]), -(grid%nx/2), 1), -(grid%ny/2), 2), &
               [grid%nx*grid%ny])
         case (without_rows)
            sweep%height = sweep%height(setting%number*grid%nx + 1:(setting%number + 1)*grid%nx)
            grid = dry_grid_t(grid%nx, 1, 1.0_wp, grid%kernel)
            sweep%scaling = new_dry_scaling(sweep%height, sweep%scaling%length, &
               sweep%scaling%reduced_modulus)
         case default
            error stop 'prepare: a part without its case'
         end select
      end associate
   end subroutine prepare

   !> Whether `grid` is compared with finer ones.
   pure logical function has_few_nodes(grid)
      type(dry_grid_t), intent(in) :: grid

      has_few_nodes = real(grid%nx, wp)*grid%ny <= max_nodes_for_finer(merge(1, 2, &
         grid%ny == 1))
   end function has_few_nodes

   !> Nodes of the shorter side.
   pure integer function shorter_side(grid) result(nodes)
      type(dry_grid_t), intent(in) :: grid

      nodes = merge(grid%nx, min(grid%nx, grid%ny), grid%ny == 1)
   end function shorter_side

   !> Resamples `field` (nx*ny) from the grid `old` to `new`.
   subroutine resample_field(old, new, field)
      type(dry_grid_t), intent(in) :: old, new
      real(wp), allocatable, intent(inout) :: field(:)

      if (old%kernel == kernel_open) then
         call interpolate_heights([old%nx, old%ny], [new%nx, new%ny], field)
      else
         call resample_heights([old%nx, old%ny], [new%nx, new%ny], field)
      end if
   end subroutine resample_field

   !> Resamples the `pressures` (nx*ny, loads) of the grid `old` to `new` as `starts`: zero where
   !> they ripple about 0, with the same loads.
   subroutine resample_pressures(old, new, pressures, starts)
      type(dry_grid_t), intent(in) :: old, new
      real(real32), intent(in) :: pressures(:, :)
      real(real32), allocatable, intent(out) :: starts(:, :)
      real(wp), allocatable :: p(:)
      real(wp) :: least, total
      integer :: i

      allocate (starts(new%nx*new%ny, size(pressures, 2)))
      do i = 1, size(pressures, 2)
         p = pressures(:, i)
         total = sum(p)
         least = least_pressure*total/max(count(p > 0.0_wp), 1)
         call resample_field(old, new, p)
         where (p < least) p = 0.0_wp
         ! a contact lost between nodes starts from the mean
         if (sum(p) <= 0.0_wp) p = 1.0_wp
         starts(:, i) = real(p*(total/sum(p)*size(p)/size(pressures, 1)), real32)
      end do
   end subroutine resample_pressures

   !> About `nodes`/`ratio` (1 for a single node): odd if `nodes` is, which decides whether a node
   !> lies in the middle; else even and 64 to 128 times a power of two, which allows good first
   !> guesses and fast transforms.
   pure integer function other_count(nodes, ratio) result(count)
      integer, intent(in) :: nodes
      real(wp), intent(in) :: ratio
      integer :: unit

      count = 1
      if (nodes == 1) return
      count = 2*nint(0.5_wp*(nodes/ratio - 1.0_wp)) + 1
      if (mod(nodes, 2) == 1) return
      unit = 2
      do while (nodes/ratio >= 128*unit)
         unit = 2*unit
      end do
      count = unit*nint(nodes/(ratio*unit))
   end function other_count

end module dry_record

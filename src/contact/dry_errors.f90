!> How far off the figures of a dry contact may be because of its grid.
!>
!> Areas count nodes: a patch gains a part of a node at each of its edges, so that the error is in proportion to the number of
!> edges, each a node's share of the domain. All other figures are compared with those of the same surface on fewer nodes
!> (resampled, loosely solved): if the error falls like dx^p, a grid r times as coarse differs by (r^p - 1) times the error. Where
!> few patches end somewhere between nodes, one difference may vanish by chance; the root mean square of those of several grids
!> hardly does.
module dry_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use dry_problem, only: dry_grid_t, kernel_open
   use dry_scaling, only: dry_scaling_t
   use dry_solution, only: dry_settings_t, method_conjugate_gradient
   use dry_sweep, only: dry_loads_t, dry_outcome_t, dry_row_t, solve_dry_sweep
   use errors, only: error_t, input_error
   use fourier_resampling, only: resample_heights
   use kinds, only: wp
   use open_resampling, only: interpolate_heights
   implicit none (type, external)
   private

   public :: dry_sweep_t, estimate_dry_errors

   !> What is solved, and how: arguments of `solve_dry_sweep`.
   type :: dry_sweep_t
      type(dry_grid_t) :: grid
      !> Heights (nx*ny) [m].
      real(wp), allocatable :: height(:)
      type(dry_scaling_t) :: scaling
      type(dry_loads_t) :: loads
      type(dry_settings_t) :: settings
   end type dry_sweep_t

   !> Error of the contact and of the plastic area over the share of the nodes at their edges, of a line and of an area.
   real(wp), parameter :: contact_edges(2) = [0.7_wp, 0.25_wp], plastic_edges(2) = [0.5_wp, 0.2_wp]
   !> The part of it that the corrected area has not, (pi - 1 + ln 2)/24.
   real(wp), parameter :: corrected_edges = 0.118_wp
   !> How much coarser the grids are that a line and an area are compared with; a line has few edges: more and nearer grids.
   real(wp), parameter :: line_ratios(4) = [1.25_wp, 1.5_wp, 2.0_wp, 3.0_wp], area_ratios(3) = [2.0_wp, 3.0_wp, 4.0_wp]
   !> Fewest nodes a side, and fewest grids for an estimate.
   integer, parameter :: fewest_nodes = 8, fewest_grids = 2
   !> Error measure to which they are solved, of a line, whose figures are good to 1e-6, and of an area.
   real(wp), parameter :: line_tolerance = 1.0e-7_wp, area_tolerance = 1.0e-5_wp
   !> Figures that are compared: mean separation, separation, datum, p_max, dp_max, dp_mean, elastic and dissipated energy, load.
   integer, parameter :: figures = 9
   !> p, and what the root mean square is multiplied by, of a line and of an area.
   real(wp), parameter :: order = 1.5_wp
   real(wp), parameter :: line_safety(figures) = [1.2_wp, 1.2_wp, 1.2_wp, 1.6_wp, 1.5_wp, 1.2_wp, 1.2_wp, 1.2_wp, 1.5_wp]
   real(wp), parameter :: area_safety(figures) = [1.3_wp, 1.3_wp, 1.3_wp, 1.9_wp, 2.4_wp, 1.8_wp, 1.6_wp, 1.8_wp, 1.5_wp]

contains

   !> Estimated errors of the figures in `rows` of a `sweep`, component by component; what is not known is NaN. Fails
   !> (internal_error) if FFTW does.
   subroutine estimate_dry_errors(sweep, rows, errors, error)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), intent(in) :: rows(:)
      type(dry_row_t), allocatable, intent(out) :: errors(:)
      type(error_t), allocatable, intent(out) :: error
      type(dry_row_t), allocatable :: others(:)
      type(dry_sweep_t) :: coarse
      real(wp), allocatable :: ratios(:)
      real(wp) :: ratio, squares(figures, size(rows))
      integer :: count(size(rows)), i, k

      squares = 0.0_wp
      count = 0
      ratios = area_ratios
      if (sweep%grid%ny == 1) ratios = line_ratios
      coarse = sweep
      coarse%settings%method = method_conjugate_gradient
      coarse%settings%tolerance = max(sweep%settings%tolerance, merge(line_tolerance, area_tolerance, sweep%grid%ny == 1))
      grids: do k = 1, size(ratios)
         call coarsen(coarse, coarser(sweep%grid%nx, ratios(k)), coarser(sweep%grid%ny, ratios(k)), error)
         if (allocated(error)) return
         if (any([coarse%grid%nx, coarse%grid%ny] < fewest_nodes .and. [sweep%grid%nx, sweep%grid%ny] > 1)) exit grids
         call solve_companion(coarse, others, error)
         if (allocated(error)) return
         if (.not. allocated(others)) cycle grids
         ratio = real(sweep%grid%nx, wp)/coarse%grid%nx
         where (others%kkt <= coarse%settings%tolerance) count = count + 1
         do i = 1, size(rows)
            if (others(i)%kkt <= coarse%settings%tolerance) squares(:, i) = squares(:, i) &
               + ((figures_of(others(i)) - figures_of(rows(i)))/(ratio**order - 1.0_wp))**2
         end do
      end do grids
      allocate (errors(size(rows)))
      do i = 1, size(rows)
         squares(:, i) = merge(line_safety, area_safety, sweep%grid%ny == 1)*sqrt(squares(:, i)/max(count(i), 1))
         squares(:, i) = squares(:, i) + rows(i)%kkt*abs(figures_of(rows(i)))
         if (count(i) < fewest_grids .or. .not. rows(i)%is_converged) squares(:, i) = ieee_value(1.0_wp, ieee_quiet_nan)
         call fill_errors(sweep%grid, rows(i), squares(:, i), errors(i))
      end do
   end subroutine estimate_dry_errors

   !> Takes a sweep to `nx` x `ny` nodes. Fails (internal_error) if FFTW does.
   subroutine coarsen(sweep, nx, ny, error)
      type(dry_sweep_t), intent(inout) :: sweep
      integer, intent(in) :: nx, ny
      type(error_t), allocatable, intent(out) :: error

      associate (grid => sweep%grid)
         if (grid%kernel == kernel_open) then
            call interpolate_heights([grid%nx, grid%ny], [nx, ny], sweep%height)
         else
            call resample_heights([grid%nx, grid%ny], [nx, ny], sweep%height, error)
            if (allocated(error)) return
         end if
         grid%nx = nx
         grid%ny = ny
      end associate
   end subroutine coarsen

   !> The figures `others` of a coarser sweep. They stay unallocated where it finds no contact.
   subroutine solve_companion(sweep, others, error)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), allocatable, intent(out) :: others(:)
      type(error_t), allocatable, intent(out) :: error
      type(dry_outcome_t) :: outcome

      call solve_dry_sweep(sweep%grid, sweep%height, sweep%scaling, sweep%loads, sweep%settings, outcome, error)
      if (.not. allocated(error)) then
         call move_alloc(outcome%rows, others)
      else if (error%kind == input_error) then
         deallocate (error)   ! nothing touches at that separation on the coarser grid
      end if
   end subroutine solve_companion

   !> About `nodes`/`ratio` (1 of a line's single one): odd where they are, which decides whether a node lies in the middle; else
   !> even, 64 to 128 times a power of two: such grids have good first guesses and fast transforms.
   pure function coarser(nodes, ratio)
      integer, intent(in) :: nodes
      real(wp), intent(in) :: ratio
      integer :: coarser
      integer :: unit

      if (mod(nodes, 2) == 1) then
         coarser = 2*nint(0.5_wp*(nodes/ratio - 1.0_wp)) + 1
         return
      end if
      unit = 2
      do while (nodes/ratio >= 128*unit)
         unit = 2*unit
      end do
      coarser = unit*nint(nodes/(ratio*unit))
   end function coarser

   !> The figures that are compared, in the order of the safety factors.
   pure function figures_of(row) result(values)
      type(dry_row_t), intent(in) :: row
      real(wp) :: values(figures)

      values = [row%mean_separation, row%separation, row%datum, row%p_max, row%dp_max, row%dp_mean, row%elastic_energy, &
                row%dissipated_energy, row%mean_pressure]
   end function figures_of

   !> Puts the errors of the figures of `row` in place: those that were compared are `compared`, in the order of `figures_of`.
   pure subroutine fill_errors(grid, row, compared, errors)
      type(dry_grid_t), intent(in) :: grid
      type(dry_row_t), intent(in) :: row
      real(wp), intent(in) :: compared(figures)
      type(dry_row_t), intent(inout) :: errors
      real(wp) :: contact, plastic, unknown
      integer :: kind

      errors = row
      kind = merge(1, 2, grid%ny == 1)
      unknown = 0.0_wp
      if (.not. row%is_converged) unknown = ieee_value(1.0_wp, ieee_quiet_nan)
      contact = unknown + row%contact_edges/(real(grid%nx, wp)*real(grid%ny, wp))
      plastic = unknown + row%plastic_edges/(real(grid%nx, wp)*real(grid%ny, wp))
      errors%contact_area_fraction = contact_edges(kind)*contact + row%kkt*row%contact_area_fraction
      errors%contact_area_corrected = errors%contact_area_fraction
      if (kind == 2) errors%contact_area_corrected = errors%contact_area_fraction - corrected_edges*contact
      errors%plastic_area_fraction = plastic_edges(kind)*plastic + row%kkt*row%plastic_area_fraction
      errors%plasticity_index = (errors%plastic_area_fraction + row%plasticity_index*errors%contact_area_fraction) &
                                /row%contact_area_fraction
      errors%mean_separation = compared(1)
      errors%separation = compared(2)
      errors%datum = compared(3)
      errors%p_max = compared(4)
      errors%dp_max = compared(5)
      errors%dp_mean = compared(6)
      errors%elastic_energy = compared(7)
      errors%dissipated_energy = compared(8)
      errors%mean_pressure = compared(9)
      errors%load = errors%mean_pressure/row%mean_pressure*row%load
   end subroutine fill_errors

end module dry_errors

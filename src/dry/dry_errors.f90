!> How far off the figures of a dry contact may be because of its grid.
!>
!> They are compared with those of the same heights on other grids (resampled, loosely solved). On a
!> finer grid most of the error is gone: the difference nearly is the error. Where finer grids would
!> take too long, coarser ones are taken: if the error falls like dx^p, a grid r times as coarse
!> differs by (r^p - 1) times the error. Edges of patches lie anywhere between nodes, so that one
!> difference may vanish by chance; the root mean square of those of several grids hardly does.
!> Areas count nodes: to their error comes a share of the nodes at the edges.
module dry_errors
   use dry_problem, only: dry_grid_t, kernel_open
   use dry_scaling, only: dry_scaling_t
   use dry_settings, only: dry_loads_t, dry_settings_t, method_conjugate_gradient
   use dry_sweep, only: dry_outcome_t, dry_row_t, solve_dry_sweep
   use errors, only: error_t, input_error
   use fourier_resampling, only: resample_heights
   use kinds, only: wp
   use missing_value, only: not_known
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

   !> Most nodes of a line and of an area that are compared with finer grids: these take 0.3 and
   !> 0.05 s.
   integer, parameter :: most_nodes_for_finer(2) = [2**17, 2**14]
   !> How much coarser the grids are that a grid is compared with: finer ones, and coarser ones,
   !> which have 288, 192 and 144 nodes a side for 1024.
   real(wp), parameter :: finer_ratios(2) = [2.0_wp/3.0_wp, 0.5_wp], &
      coarser_ratios(3) = [32.0_wp/9.0_wp, 16.0_wp/3.0_wp, 64.0_wp/9.0_wp]
   !> p.
   real(wp), parameter :: order = 1.5_wp
   !> Fewest nodes a side, and fewest grids for an estimate.
   integer, parameter :: fewest_nodes = 8, fewest_grids = 2
   !> Error measure to which they are solved, of a line, whose figures are good to 1e-6, and of an
   !> area.
   real(wp), parameter :: line_tolerance = 1.0e-7_wp, area_tolerance = 1.0e-5_wp
   !> Figures that are compared: contact, corrected and plastic area, plasticity index, mean
   !> separation, separation, datum, p_max, dp_max, dp_mean, elastic and dissipated energy, load.
   integer, parameter :: figures = 13
   !> What the root mean square is multiplied by, of lines and of areas: with finer grids, figure by
   !> figure, and with coarser ones.
   real(wp), parameter :: line_safety(figures) = [1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 3.5_wp, 3.5_wp, &
      3.5_wp, 5.0_wp, 3.0_wp, 3.5_wp, &
      2.7_wp, 3.5_wp, 3.5_wp]
   real(wp), parameter :: area_safety(figures) = [1.0_wp, 1.6_wp, 1.0_wp, 1.0_wp, 4.5_wp, 4.0_wp, &
      4.0_wp, 3.9_wp, 2.5_wp, 3.5_wp, &
      3.0_wp, 3.5_wp, 3.5_wp]
   real(wp), parameter :: coarser_safety(2) = [4.5_wp, 2.5_wp]
   !> Share of the nodes at the edges of patches that comes to the errors of areas: of a line, of an
   !> area, of the corrected area.
   real(wp), parameter :: edge_share(2) = [0.4_wp, 0.1_wp], corrected_share = 0.03_wp
   !> Error of a pressure [p_c] over the violation of the contact conditions times the nodes along
   !> x: a gap that is wrong by d at single nodes belongs to a pressure up to q d, q the largest
   !> wavenumber, pi times the nodes over the length.
   real(wp), parameter :: pressure_noise = 0.3_wp

contains

   !> Estimated errors of the figures in `rows` of a `sweep`, component by component; what is not
   !> known is NaN. Fails (internal_error) if FFTW does.
   subroutine estimate_dry_errors(sweep, rows, errors, error)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), intent(in) :: rows(:)
      type(dry_row_t), allocatable, intent(out) :: errors(:)
      type(error_t), allocatable, intent(out) :: error
      type(dry_row_t), allocatable :: others(:)
      type(dry_sweep_t) :: companion
      real(wp), allocatable :: ratios(:)
      real(wp) :: distance, safety(figures), squares(figures, size(rows))
      integer :: count(size(rows)), i, k

      squares = 0.0_wp
      count = 0
      ratios = ratios_for(sweep%grid)
      grids: do k = 1, size(ratios)
         if (is_too_coarse(sweep%grid, ratios(k))) cycle grids
         companion = sweep
         companion%settings%method = method_conjugate_gradient
         companion%settings%tolerance = max(sweep%settings%tolerance, &
            merge(line_tolerance, area_tolerance, sweep%grid%ny == 1))
         call resample(companion, ratios(k), error)
         if (allocated(error)) return
         call solve_companion(companion, others, error)
         if (allocated(error)) return
         if (.not. allocated(others)) cycle grids
         distance = 1.0_wp
         if (ratios(k) > 1.0_wp) distance = (real(sweep%grid%nx, wp)/companion%grid%nx)**order &
            - 1.0_wp
         loads: do i = 1, size(rows)
            if (.not. others(i)%kkt <= companion%settings%tolerance) cycle loads
            count(i) = count(i) + 1
            squares(:, i) = squares(:, &
               i) + ((figures_of(others(i)) - figures_of(rows(i)))/distance)**2
         end do loads
      end do grids
      safety = coarser_safety(kind_of(sweep%grid))
      if (ratios(1) < 1.0_wp) safety = merge(line_safety, area_safety, sweep%grid%ny == 1)
      allocate (errors(size(rows)))
      do i = 1, size(rows)
         squares(:, i) = safety*sqrt(squares(:, i)/max(count(i), 1)) &
            + rows(i)%kkt*abs(figures_of(rows(i)))
         if (count(i) < fewest_grids .or. .not. rows(i)%is_converged) squares(:, i) = not_known()
         call fill_errors(rows(i), squares(:, i), errors(i))
         call add_edges(sweep%grid, rows(i), errors(i))
         errors(i)%p_max = errors(i)%p_max + pressure_noise*sweep%grid%nx*rows(i)%kkt &
            *sweep%scaling%pressure
      end do
   end subroutine estimate_dry_errors

   !> 1 of a line, 2 of an area.
   pure function kind_of(grid) result(kind)
      type(dry_grid_t), intent(in) :: grid
      integer :: kind

      kind = merge(1, 2, grid%ny == 1)
   end function kind_of

   !> How much coarser the grids are that `grid` is compared with.
   pure function ratios_for(grid) result(ratios)
      type(dry_grid_t), intent(in) :: grid
      real(wp), allocatable :: ratios(:)

      ratios = coarser_ratios
      if (real(grid%nx, wp)*grid%ny <= most_nodes_for_finer(kind_of(grid))) ratios = finer_ratios
   end function ratios_for

   !> True if a side of `grid` or of one `ratio` times as coarse has too few nodes.
   pure function is_too_coarse(grid, ratio)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: ratio
      logical :: is_too_coarse
      integer :: least

      least = grid%nx
      if (grid%ny > 1) least = min(grid%nx, grid%ny)
      is_too_coarse = least < fewest_nodes*max(ratio, 1.0_wp)
   end function is_too_coarse

   !> Takes a sweep to a grid `ratio` times as coarse. Fails (internal_error) if FFTW does.
   subroutine resample(sweep, ratio, error)
      type(dry_sweep_t), intent(inout) :: sweep
      real(wp), intent(in) :: ratio
      type(error_t), allocatable, intent(out) :: error
      integer :: new(2)

      associate (grid => sweep%grid)
         new = [other_count(grid%nx, ratio), other_count(grid%ny, ratio)]
         if (grid%kernel == kernel_open) then
            call interpolate_heights([grid%nx, grid%ny], new, sweep%height)
         else
            call resample_heights([grid%nx, grid%ny], new, sweep%height, error)
            if (allocated(error)) return
         end if
         grid%nx = new(1)
         grid%ny = new(2)
      end associate
   end subroutine resample

   !> The figures `others` of the sweep on another grid. They stay unallocated where it finds no
   !> contact.
   subroutine solve_companion(sweep, others, error)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), allocatable, intent(out) :: others(:)
      type(error_t), allocatable, intent(out) :: error
      type(dry_outcome_t) :: outcome

      call solve_dry_sweep(sweep%grid, sweep%height, sweep%scaling, sweep%loads, sweep%settings, &
         outcome, error)
      if (.not. allocated(error)) then
         call move_alloc(outcome%rows, others)
      else if (error%kind == input_error) then
         deallocate (error)   ! nothing touches at that separation on this grid
      end if
   end subroutine solve_companion

   !> About `nodes`/`ratio` (1 of a line's single one): odd where they are, which decides whether a
   !> node lies in the middle; else even, 64 to 128 times a power of two: such grids have good first
   !> guesses and fast transforms.
   pure function other_count(nodes, ratio) result(count)
      integer, intent(in) :: nodes
      real(wp), intent(in) :: ratio
      integer :: count
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

   !> The figures that are compared.
   pure function figures_of(row) result(values)
      type(dry_row_t), intent(in) :: row
      real(wp) :: values(figures)

      values = [row%contact_area_fraction, row%contact_area_corrected, row%plastic_area_fraction, &
         row%plasticity_index, &
                row%mean_separation, row%separation, row%datum, row%p_max, row%dp_max, &
                   row%dp_mean, row%elastic_energy, &
                row%dissipated_energy, row%mean_pressure]
   end function figures_of

   !> Puts the errors of the figures of `row` in place: `compared`, in the order of `figures_of`.
   pure subroutine fill_errors(row, compared, errors)
      type(dry_row_t), intent(in) :: row
      real(wp), intent(in) :: compared(figures)
      type(dry_row_t), intent(inout) :: errors

      errors = row
      errors%contact_area_fraction = compared(1)
      errors%contact_area_corrected = compared(2)
      errors%plastic_area_fraction = compared(3)
      errors%plasticity_index = compared(4)
      errors%mean_separation = compared(5)
      errors%separation = compared(6)
      errors%datum = compared(7)
      errors%p_max = compared(8)
      errors%dp_max = compared(9)
      errors%dp_mean = compared(10)
      errors%elastic_energy = compared(11)
      errors%dissipated_energy = compared(12)
      errors%mean_pressure = compared(13)
      errors%load = errors%mean_pressure/row%mean_pressure*row%load
   end subroutine fill_errors

   !> Adds the share of the nodes at the edges of patches to the `errors` of the areas of `row`.
   pure subroutine add_edges(grid, row, errors)
      type(dry_grid_t), intent(in) :: grid
      type(dry_row_t), intent(in) :: row
      type(dry_row_t), intent(inout) :: errors
      real(wp) :: contact, plastic, share

      share = edge_share(kind_of(grid))/(real(grid%nx, wp)*real(grid%ny, wp))
      contact = share*row%contact_edges
      plastic = share*row%plastic_edges
      errors%contact_area_fraction = errors%contact_area_fraction + contact
      errors%contact_area_corrected = errors%contact_area_corrected + contact
      if (grid%ny > 1) errors%contact_area_corrected = errors%contact_area_corrected &
         + (corrected_share/edge_share(2) - 1.0_wp)*contact
      errors%plastic_area_fraction = errors%plastic_area_fraction + plastic
      errors%plasticity_index = errors%plasticity_index + (plastic + row%plasticity_index*contact) &
         /row%contact_area_fraction
   end subroutine add_edges

end module dry_errors

!> How far off the quantities of a dry contact may be because of its grid.
!>
!> They are compared with those of the same heights on other grids (resampled), which start from the
!> pressures found and are solved loosely: after a few iterations the change of grid shows. On a
!> finer grid most of the error is gone: the difference nearly is the error. Where finer grids would
!> take too long, slightly coarser ones are taken, which still see nearly all waves of the surface;
!> much coarser ones would tell how rough it is, not how large the error. Edges of patches lie
!> anywhere between nodes, so that one difference may vanish by chance; the weighted root mean
!> square of those of several grids hardly does. Areas count nodes: to their error comes a share of
!> the nodes at the edges; of lines, whose edges are known between the nodes, what was counted
!> beyond them. Of the largest pressures the crests between the nodes are compared; to their error
!> comes how far the highest node lies below. The error of a separation is a sum over all edges,
!> each of either sign: of a periodic area with many nodes, whose differences to coarser grids tell
!> little of it, its size follows from the pressures at the edges.
module dry_errors
   use dry_problem, only: dry_grid_t, kernel_open
   use dry_resampling, only: dry_sweep_t, is_too_coarse, resample, resample_pressures
   use dry_settings, only: dry_settings_t, max_nodes_to_refine, method_conjugate_gradient
   use dry_sweep, only: dry_outcome_t, dry_row_t, solve_dry_sweep
   use errors, only: error_t, input_error
   use kinds, only: wp
   use missing_value, only: not_known
   implicit none (type, external)
   private

   public :: estimate_dry_errors, goes_finer, has_few_nodes

   !> Most nodes of a line and of an area that are compared with finer grids.
   integer, parameter :: max_nodes_for_finer(2) = [2**17, 2**14]
   !> Measure of waves that are short: 1 on a smooth surface, 1.37 for a wave of 8 nodes, 4 for one
   !> of 4.
   real(wp), parameter :: short_waves = 1.3_wp
   !> How much coarser the grids are that a grid is compared with, and what the squares of their
   !> differences weigh: of one with few nodes, a periodic elastic line with the first two, and of
   !> one with many, a periodic elastic area with the first two. (With the third where one of these
   !> finds no solution.)
   real(wp), parameter :: finer_ratios(3) = [0.5_wp, 2.0_wp/3.0_wp, 4.0_wp/3.0_wp], &
      finer_weights(3) = [1.0_wp, 1.0_wp, 0.1_wp], &
      coarser_ratios(3) = [4.0_wp/3.0_wp, 2.0_wp, 1.5_wp], &
      coarser_weights(3) = [1.0_wp, 0.1_wp, 0.3_wp]
   !> Fewest grids for an estimate.
   integer, parameter :: min_grids = 2
   !> Error measure to which they are solved: of lines, of periodic areas with few nodes and with
   !> many, of open areas, whose heights are those of the body; of lines and areas under a given
   !> separation, whose load is found to about as much.
   real(wp), parameter :: line_tolerance = 1.0e-8_wp, &
      periodic_tolerances(2) = [3.0e-3_wp, 1.0e-3_wp], open_tolerance = 3.0e-5_wp, &
      separation_tolerances(2) = [1.0e-7_wp, 1.0e-5_wp]
   !> Quantities that are compared: contact, corrected and plastic area, plasticity index, mean
   !> separation, separation, datum, p_crest, dp_max, dp_mean, elastic and dissipated energy, load.
   integer, parameter :: quantity_count = 13
   !> What the root mean square is multiplied by: areas, corrected area of areas and of lines,
   !> separations and load, p_max, deformations and energies; of periodic and open lines, periodic
   !> and open areas by finer grids, then by coarser ones.
   real(wp), parameter :: safety(5, 8) = reshape([1.0_wp, 1.5_wp, 2.6_wp, 2.3_wp, 2.3_wp, &
      1.0_wp, 1.5_wp, 2.3_wp, 3.0_wp, 2.3_wp, &
      1.0_wp, 1.6_wp, 2.4_wp, 2.0_wp, 2.0_wp, &
      1.0_wp, 1.6_wp, 2.7_wp, 2.0_wp, 2.0_wp, &
      1.0_wp, 1.5_wp, 2.3_wp, 1.5_wp, 1.6_wp, &
      1.0_wp, 1.5_wp, 1.4_wp, 1.5_wp, 1.6_wp, &
      1.0_wp, 1.6_wp, 2.2_wp, 1.5_wp, 2.0_wp, &
      1.0_wp, 1.6_wp, 2.7_wp, 0.9_wp, 2.0_wp], [5, 8])
   !> Which of these holds for each of them.
   integer, parameter :: safety_of(quantity_count) = [1, 2, 1, 1, 3, 3, 3, 4, 5, 5, 5, 5, 3]
   !> Which of them are separations, and which the mean plastic deformation.
   integer, parameter :: separations(3) = [5, 6, 7], dp_mean = 10
   !> What the chance in separations is multiplied by where it is the error and the differences to
   !> coarser grids only say that there is more, by how much of them and beyond which share of it.
   !> Second: how much more where all contact nodes yield.
   real(wp), parameter :: chance(2) = [0.06_wp, 0.2_wp], differences_beside = 0.3_wp, &
      differences_beyond = 1.4_wp, differences_by_chance(2) = [0.1_wp, 0.33_wp]
   !> What the differences of the mean plastic deformation there, and the chance in a separation
   !> over the plastic area, are multiplied by.
   real(wp), parameter :: yielding = 1.4_wp, chance_of_yielding = 0.14_wp
   !> Share of the nodes at the edges of patches that comes to the errors of areas: of a line, of an
   !> area, of the corrected area of either.
   real(wp), parameter :: edge_share(2) = [0.4_wp, 0.1_wp], &
      corrected_share(2) = [0.06_wp, 0.03_wp]
   !> Relative error of p_max over the violation of the contact conditions times the square root of
   !> the nodes along x, at most. (A gap that is wrong at single nodes could do more; what
   !> iterations leave is smooth.)
   real(wp), parameter :: pressure_noise = 2.0_wp

contains

   !> Estimated errors of the quantities in the rows of the `outcome` of a `sweep` that keeps its
   !> pressures, component by component; what is not known is NaN. Fails (internal_error) if FFTW
   !> does.
   subroutine estimate_dry_errors(sweep, outcome, errors, error)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_outcome_t), intent(in) :: outcome
      type(dry_row_t), allocatable, intent(out) :: errors(:)
      type(error_t), allocatable, intent(out) :: error
      type(dry_row_t), allocatable :: others(:)
      type(dry_sweep_t) :: comparison
      real(wp) :: compared(quantity_count), squares(quantity_count, size(outcome%rows)), &
         sums(size(outcome%rows)), ratios(3), weights(3)
      integer :: count(size(outcome%rows)), i, k
      logical :: is_finer

      squares = 0.0_wp
      sums = 0.0_wp
      count = 0
      is_finer = goes_finer(sweep%grid, sweep%height)
      ratios = merge(finer_ratios, coarser_ratios, is_finer)
      weights = merge(finer_weights, coarser_weights, is_finer)
      grids: do k = 1, size(ratios)
         if (minval(count) >= least_grids(sweep, is_finer)) exit grids
         if (is_too_coarse(sweep%grid, ratios(k))) cycle grids
         comparison = sweep
         comparison%settings = comparison_settings(sweep)
         call resample(comparison, ratios(k), error)
         if (allocated(error)) return
         call resample_pressures(sweep%grid, comparison%grid, outcome%pressures, &
            comparison%settings%starts, error)
         if (allocated(error)) return
         call solve_comparison(comparison, others, error)
         if (allocated(error)) return
         if (.not. allocated(others)) cycle grids
         loads: do i = 1, size(others)
            if (.not. others(i)%kkt <= comparison%settings%tolerance) cycle loads
            count(i) = count(i) + 1
            sums(i) = sums(i) + weights(k)
            squares(:, i) = squares(:, i) + weights(k)*(values_of(others(i)) &
               - values_of(outcome%rows(i)))**2
         end do loads
      end do grids
      allocate (errors(size(outcome%rows)))
      associate (rows => outcome%rows)
         do i = 1, size(rows)
            compared = not_known()
            if (count(i) >= min_grids .and. rows(i)%is_converged) compared = estimates_of(sweep, &
               rows(i), is_finer, sqrt(squares(:, i)/sums(i)))
            call fill_errors(rows(i), compared, errors(i))
            call add_edges(sweep%grid, rows(i), errors(i))
            errors(i)%p_max = errors(i)%p_max + rows(i)%p_crest - rows(i)%p_max &
               + pressure_noise*sqrt(real(sweep%grid%nx, wp))*rows(i)%kkt*rows(i)%p_max
         end do
      end associate
   end subroutine estimate_dry_errors

   !> How many grids a `sweep` is compared with, at least: two where it is elastic and periodic, a
   !> line on finer grids or an area on coarser ones, else three.
   pure function least_grids(sweep, is_finer) result(least)
      type(dry_sweep_t), intent(in) :: sweep
      logical, intent(in) :: is_finer
      integer :: least

      least = 3
      if (sweep%grid%kernel /= kernel_open .and. sweep%loads%hardness >= huge(1.0_wp) &
         .and. (is_finer .eqv. sweep%grid%ny == 1)) least = min_grids
   end function least_grids

   !> True if `grid` is compared with finer ones.
   pure function has_few_nodes(grid)
      type(dry_grid_t), intent(in) :: grid
      logical :: has_few_nodes

      has_few_nodes = real(grid%nx, wp)*grid%ny <= max_nodes_for_finer(kind_of(grid))
   end function has_few_nodes

   !> Whether the surface of these heights (nx*ny) is compared with finer grids: where it has few
   !> nodes, and with more of them where coarser grids would lose its shortest waves.
   pure function goes_finer(grid, heights)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: heights(:)
      logical :: goes_finer

      goes_finer = has_few_nodes(grid)
      if (goes_finer .or. real(grid%nx, wp)*grid%ny > max_nodes_to_refine) return
      goes_finer = 16.0_wp*bending(grid, heights, 1) > short_waves*bending(grid, heights, 2)
   end function goes_finer

   !> Sum of the squares of the second differences of `heights` (nx*ny) over this many spacings.
   !> Twice as many spacings make it 16 times as large where the surface is smooth, less where it
   !> has short waves.
   pure function bending(grid, heights, spacings)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: heights(grid%nx, grid%ny)
      integer, intent(in) :: spacings
      real(wp) :: bending

      associate (nx => grid%nx, ny => grid%ny, s => spacings)
         bending = sum((heights(1 + 2*s:, :) + heights(:nx - 2*s, :) &
            - 2.0_wp*heights(1 + s:nx - s, :))**2)
         if (ny > 2*s) bending = bending + sum((heights(:, 1 + 2*s:) + heights(:, :ny - 2*s) &
            - 2.0_wp*heights(:, 1 + s:ny - s))**2)
      end associate
   end function bending

   !> Estimated errors of the quantities of a `row` of `sweep` with these `differences` (root mean
   !> squares) to other grids.
   pure function estimates_of(sweep, row, is_finer, differences) result(estimates)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), intent(in) :: row
      logical, intent(in) :: is_finer
      real(wp), intent(in) :: differences(quantity_count)
      real(wp) :: estimates(quantity_count), factors(quantity_count)

      factors = safety(safety_of, column_of(sweep%grid, is_finer))
      estimates = factors*differences
      if (errs_by_chance(sweep, is_finer)) then
         estimates(separations) = separation_errors(row, differences(separations))
         if (row%plastic_area_fraction > 0.0_wp) estimates(dp_mean) = &
            hypot(yielding*differences(dp_mean), &
            chance_of_yielding*row%plastic_area_fraction*chance_of(row))
      end if
      estimates = estimates + row%kkt*abs(values_of(row))
   end function estimates_of

   !> Whether the errors of separations are known by chance, hardly by other grids: of periodic
   !> areas under given loads, by coarser ones.
   pure function errs_by_chance(sweep, is_finer)
      type(dry_sweep_t), intent(in) :: sweep
      logical, intent(in) :: is_finer
      logical :: errs_by_chance

      errs_by_chance = .not. is_finer .and. sweep%grid%ny > 1 &
         .and. sweep%grid%kernel /= kernel_open .and. allocated(sweep%loads%mean_pressure)
   end function errs_by_chance

   !> The errors of the separations of a `row` that are known by chance.
   pure function separation_errors(row, differences) result(estimates)
      type(dry_row_t), intent(in) :: row
      real(wp), intent(in) :: differences(:)
      real(wp) :: estimates(size(differences))

      associate (yields => [1.0_wp, row%plasticity_index])
         estimates = hypot(dot_product(chance, yields)*chance_of(row), &
            differences_beside*differences) + differences_beyond*max(differences &
            - dot_product(differences_by_chance, yields)*chance_of(row), 0.0_wp)
      end associate
   end function separation_errors

   !> Chance in the separations of a `row` under a given load. The load of each edge is wrong by
   !> chance; separations rise with the logarithm of the load, so that a share of the load is that
   !> share of work over load.
   pure function chance_of(row) result(size_of_error)
      type(dry_row_t), intent(in) :: row
      real(wp) :: size_of_error

      size_of_error = (row%elastic_energy + row%dissipated_energy)/row%load*row%edge_load
   end function chance_of

   !> Column of `safety`.
   pure function column_of(grid, is_finer) result(column)
      type(dry_grid_t), intent(in) :: grid
      logical, intent(in) :: is_finer
      integer :: column

      column = 2*kind_of(grid) + merge(0, 4, is_finer)
      if (grid%kernel /= kernel_open) column = column - 1
   end function column_of

   !> 1 of a line, 2 of an area.
   pure function kind_of(grid) result(kind)
      type(dry_grid_t), intent(in) :: grid
      integer :: kind

      kind = merge(1, 2, grid%ny == 1)
   end function kind_of

   !> How the comparisons of a `sweep` are solved.
   pure function comparison_settings(sweep) result(settings)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_settings_t) :: settings

      settings = sweep%settings
      settings%method = method_conjugate_gradient
      settings%keeps_pressures = .false.
      if (allocated(sweep%loads%separation)) then
         settings%tolerance = max(settings%tolerance, separation_tolerances(kind_of(sweep%grid)))
      else if (sweep%grid%ny == 1) then
         settings%tolerance = max(settings%tolerance, line_tolerance)
      else if (sweep%grid%kernel == kernel_open) then
         settings%tolerance = max(settings%tolerance, open_tolerance)
      else
         settings%tolerance = max(settings%tolerance, &
            periodic_tolerances(merge(1, 2, has_few_nodes(sweep%grid))))
         settings%is_rough = .true.
      end if
   end function comparison_settings

   !> The quantities `others` of the sweep on another grid. They stay unallocated where it finds no
   !> contact.
   subroutine solve_comparison(sweep, others, error)
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
   end subroutine solve_comparison

   !> The quantities that are compared.
   pure function values_of(row) result(values)
      type(dry_row_t), intent(in) :: row
      real(wp) :: values(quantity_count)

      values = [row%contact_area_fraction, row%contact_area_corrected, row%plastic_area_fraction, &
         row%plasticity_index, &
                row%mean_separation, row%separation, row%datum, row%p_crest, row%dp_max, &
                   row%dp_mean, row%elastic_energy, &
                row%dissipated_energy, row%mean_pressure]
   end function values_of

   !> Puts the errors of the quantities of `row` in place: `compared`, in the order of `values_of`.
   pure subroutine fill_errors(row, compared, errors)
      type(dry_row_t), intent(in) :: row
      real(wp), intent(in) :: compared(quantity_count)
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

   !> Adds the share of the nodes at the edges of patches to the `errors` of the areas of `row`. Of
   !> a line the contact area has the error of the corrected one, and what it differs by.
   pure subroutine add_edges(grid, row, errors)
      type(dry_grid_t), intent(in) :: grid
      type(dry_row_t), intent(in) :: row
      type(dry_row_t), intent(inout) :: errors
      real(wp) :: contact, plastic

      associate (kind => kind_of(grid), nodes => real(grid%nx, wp)*real(grid%ny, wp))
         contact = edge_share(kind)*row%contact_edges/nodes
         plastic = edge_share(kind)*row%plastic_edges/nodes
         errors%contact_area_corrected = errors%contact_area_corrected &
            + corrected_share(kind)*row%contact_edges/nodes
      end associate
      errors%contact_area_fraction = errors%contact_area_fraction + contact
      if (grid%ny == 1) errors%contact_area_fraction = errors%contact_area_corrected &
         + abs(row%contact_area_fraction - row%contact_area_corrected)
      errors%plastic_area_fraction = errors%plastic_area_fraction + plastic
      errors%plasticity_index = errors%plasticity_index + (plastic + row%plasticity_index*contact) &
         /row%contact_area_fraction
   end subroutine add_edges

end module dry_errors

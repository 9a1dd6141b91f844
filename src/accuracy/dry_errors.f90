!> Errors of the quantities of a dry contact by its grid.
!>
!> They are compared with those of the same heights on other grids, solved loosely, since the change
!> of grid shows after a few iterations (docs/theory.md, dry rough contact). The difference to a
!> finer grid is nearly the error. If finer grids cost too much, slightly coarser ones are used,
!> which still resolve nearly all waves of the surface; much coarser ones would measure the
!> roughness. The error of a separation is a sum over all edges, of either sign: for a periodic area
!> with many nodes it follows from the pressures at the edges.
!>
!> For a target accuracy of the contact area: where a grid resolves the waves of the surface the
!> estimated error of the area falls as dx, or with the order observed on the last two grids; the
!> next grid is the one predicted to meet the target.
module dry_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_problem, only: dry_grid_t, kernel_open, max_nodes_to_refine, no_hardness
   use dry_quantities, only: compared_values, contact_area, corrected_area, datum, &
      dissipated_energy, dp_mean, dry_count, dry_outcome_t, dry_row_t, dry_table, elastic_energy, &
      factor_count, load, mean_separation, p_max, plastic_area, plasticity_index, separation, &
      yields
   use dry_record, only: dry_record_t, dry_setting_t, dry_sweep_t, has_few_nodes
   use grid_transform, only: even_nodes
   use kinds, only: not_known, wp
   implicit none (type, external)
   private

   public :: area_doubt, dry_trial_t, estimate_dry_errors, finer_nodes, goes_finer

   !> Threshold for short waves: 1 is a smooth surface, 1.37 a wave of 8 nodes, 4 one of 4.
   real(wp), parameter :: short_waves = 1.3_wp
   !> Spacings of the compared grids over the given one, and the weights of the squared differences,
   !> with few nodes and with many (a periodic elastic line or area uses the first two, and the
   !> third if one of these has no solution).
   real(wp), parameter :: finer_ratios(3) = [0.5_wp, 2.0_wp/3.0_wp, 4.0_wp/3.0_wp], &
      finer_weights(3) = [1.0_wp, 1.0_wp, 0.1_wp], &
      coarser_ratios(3) = [4.0_wp/3.0_wp, 2.0_wp, 1.5_wp], &
      coarser_weights(3) = [1.0_wp, 0.1_wp, 0.3_wp]
   !> Number of compared grids, and the fewest for an estimate.
   integer, parameter :: usual_grids = 3, min_grids = 2
   !> Error measures to reach: of lines; of periodic areas with few and with many nodes; of open
   !> areas, whose heights are those of the body; of lines and areas with given separation, whose
   !> load is found to about the same accuracy.
   real(wp), parameter :: line_tolerance = 1.0e-8_wp, &
      periodic_tolerances(2) = [3.0e-3_wp, 1.0e-3_wp], open_tolerance = 3.0e-5_wp, &
      separation_tolerances(2) = [1.0e-7_wp, 1.0e-5_wp]
   !> Factors on the root mean square, by the column `factor` of the table of quantities: periodic
   !> and open lines, periodic and open areas by finer grids, then by coarser ones.
   real(wp), parameter :: safety(factor_count, 8) = reshape([ &
      1.0_wp, 1.5_wp, 2.6_wp, 2.3_wp, 2.3_wp, &
      1.0_wp, 1.5_wp, 2.3_wp, 3.0_wp, 2.3_wp, &
      1.0_wp, 1.6_wp, 2.4_wp, 2.0_wp, 2.0_wp, &
      1.0_wp, 1.6_wp, 2.7_wp, 2.0_wp, 2.0_wp, &
      1.0_wp, 1.5_wp, 2.3_wp, 1.5_wp, 1.6_wp, &
      1.0_wp, 1.5_wp, 1.4_wp, 1.5_wp, 1.6_wp, &
      1.0_wp, 1.6_wp, 2.2_wp, 1.5_wp, 2.0_wp, &
      1.0_wp, 1.6_wp, 2.7_wp, 0.9_wp, 2.0_wp], [factor_count, 8])
   !> Separations, whose errors by coarser grids are random: factors of the random part and of the
   !> differences, and the share of the random part beyond which these count fully. Second column:
   !> increase if all contact nodes yield.
   integer, parameter :: separations(3) = [mean_separation, separation, datum]
   real(wp), parameter :: chance(2) = [0.06_wp, 0.2_wp], differences_beside = 0.3_wp, &
      differences_beyond = 1.4_wp, differences_by_chance(2) = [0.1_wp, 0.33_wp]
   !> Factors of the differences of the mean plastic deformation, and of the random part of a
   !> separation over the plastic area.
   real(wp), parameter :: yielding = 1.4_wp, chance_of_yielding = 0.14_wp
   !> Share of the edge nodes of patches that is added to the errors of areas: of a line, of an
   !> area; of the corrected area of either.
   real(wp), parameter :: edge_share(2) = [0.4_wp, 0.1_wp], &
      corrected_share(2) = [0.06_wp, 0.03_wp]
   !> Bound on the relative error of p_max over the violation of the contact conditions times the
   !> square root of the nodes along x. (A gap wrong at single nodes could do more, but iteration
   !> errors are smooth.)
   real(wp), parameter :: pressure_noise = 2.0_wp

   !> Estimated error of a grid without a solution or estimate.
   real(wp), parameter, public :: unknown_doubt = huge(1.0_wp)

   !> A grid that was solved.
   type :: dry_trial_t
      !> Nodes in x and y (1 for a line).
      integer :: nodes(2) = 0
      !> Largest estimated relative error of the contact area over all loads.
      real(wp) :: doubt = unknown_doubt
   end type dry_trial_t

   !> Largest refinement to the next grid, of a line and of an area, and without a solution.
   real(wp), parameter :: farthest(2) = [4.0_wp, 2.0_wp], doubling = 2.0_wp
   !> Bounds of the order of the estimate; 1 after the first grid.
   real(wp), parameter :: orders(2) = [0.7_wp, 1.3_wp]
   !> The next grid is predicted to meet this share of the target.
   real(wp), parameter :: margin = 0.97_wp

contains

   !> Estimates the errors of the solution of a `record` that keeps its pressures; NaN: not known.
   subroutine estimate_dry_errors(record)
      type(dry_record_t), intent(inout) :: record
      type(dry_row_t), allocatable :: others(:)
      type(dry_setting_t) :: setting
      real(wp) :: squares(dry_count, size(record%outcome%rows)), &
         sums(size(record%outcome%rows)), ratios(3), weights(3)
      integer :: count(size(record%outcome%rows)), i, k, least
      logical :: is_finer

      squares = 0.0_wp
      sums = 0.0_wp
      count = 0
      associate (sweep => record%sweep, rows => record%outcome%rows)
         is_finer = goes_finer(sweep%grid, sweep%height)
         ratios = merge(finer_ratios, coarser_ratios, is_finer)
         weights = merge(finer_weights, coarser_weights, is_finer)
         setting = dry_setting_t(1.0_wp, line_tolerance)
         if (allocated(sweep%loads%separation)) then
            setting%tolerance = separation_tolerances(merge(1, 2, sweep%grid%ny == 1))
         else if (sweep%grid%ny > 1 .and. sweep%grid%kernel == kernel_open) then
            setting%tolerance = open_tolerance
         else if (sweep%grid%ny > 1) then
            setting%tolerance = periodic_tolerances(merge(1, 2, has_few_nodes(sweep%grid)))
            setting%is_rough = .true.
         end if
         setting%tolerance = max(setting%tolerance, sweep%settings%tolerance)
         ! the periodic elastic line on finer grids, the area on coarser ones
         least = merge(min_grids, usual_grids, sweep%grid%kernel /= kernel_open &
            .and. sweep%loads%hardness >= no_hardness .and. (is_finer .eqv. sweep%grid%ny == 1))
         grids: do k = 1, size(ratios)
            if (minval(count) >= least) exit grids
            setting%ratio = ratios(k)
            call record%run(setting, others)
            loads: do i = 1, size(rows)
               if (.not. others(i)%kkt <= setting%tolerance) cycle loads
               count(i) = count(i) + 1
               sums(i) = sums(i) + weights(k)
               squares(:, i) = squares(:, i) + weights(k)*(compared_values(others(i)) &
                  - compared_values(rows(i)))**2
            end do loads
         end do grids
         allocate (record%outcome%errors(dry_count, size(rows)), source=not_known())
         do i = 1, size(rows)
            if (count(i) >= min_grids .and. rows(i)%is_converged) record%outcome%errors(:, i) = &
               estimates_of(sweep, rows(i), is_finer, sqrt(squares(:, i)/sums(i)))
         end do
      end associate
   end subroutine estimate_dry_errors

   !> Whether a surface with heights `z` (nx, ny) is compared with finer grids: if it has few nodes,
   !> or if coarser grids would lose its shortest waves. Over twice as many spacings, squared second
   !> differences are 16 times as large on a smooth surface and less with short waves.
   pure logical function goes_finer(grid, z)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: z(grid%nx, grid%ny)

      goes_finer = has_few_nodes(grid)
      if (goes_finer .or. real(grid%nx, wp)*grid%ny > max_nodes_to_refine) return
      goes_finer = 16.0_wp*bending(1) > short_waves*bending(2)

   contains

      !> Sum of the squared second differences over this many spacings.
      pure real(wp) function bending(s)
         integer, intent(in) :: s

         associate (nx => grid%nx, ny => grid%ny)
            bending = sum((z(1 + 2*s:, :) + z(:nx - 2*s, :) - 2.0_wp*z(1 + s:nx - s, :))**2)
            if (ny > 2*s) bending = bending &
               + sum((z(:, 1 + 2*s:) + z(:, :ny - 2*s) - 2.0_wp*z(:, 1 + s:ny - s))**2)
         end associate
      end function bending

   end function goes_finer

   !> Estimated errors of the quantities of a `row` of `sweep` with these root mean square
   !> `differences` to other grids.
   pure function estimates_of(sweep, row, is_finer, differences) result(errors)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), intent(in) :: row
      logical, intent(in) :: is_finer
      real(wp), intent(in) :: differences(dry_count)
      real(wp) :: errors(dry_count)
      real(wp) :: by_chance, contact, plastic, share(2)
      integer :: column, kind

      kind = merge(1, 2, sweep%grid%ny == 1)
      column = 2*kind + merge(0, 4, is_finer)
      if (sweep%grid%kernel /= kernel_open) column = column - 1
      errors = safety(dry_table%factor, column)*differences
      associate (values => row%values)
         ! Loads at edges err randomly. Separations rise with the logarithm of the load, so that a
         ! share of the load is that share of work over load.
         if (.not. is_finer .and. kind == 2 .and. sweep%grid%kernel /= kernel_open &
            .and. allocated(sweep%loads%mean_pressure)) then
            by_chance = (values(elastic_energy) + values(dissipated_energy))/values(load) &
               *row%edge_load
            share = [1.0_wp, values(plasticity_index)]
            errors(separations) = hypot(dot_product(chance, share)*by_chance, &
               differences_beside*differences(separations)) + differences_beyond &
               *max(differences(separations) - dot_product(differences_by_chance, share) &
               *by_chance, 0.0_wp)
            if (yields(row)) errors(dp_mean) = hypot(yielding*differences(dp_mean), &
               chance_of_yielding*values(plastic_area)*by_chance)
         end if
         errors = errors + row%kkt*abs(compared_values(row))
         errors(p_max) = errors(p_max) + row%p_crest - values(p_max) &
            + pressure_noise*sqrt(real(sweep%grid%nx, wp))*row%kkt*values(p_max)
         contact = edge_share(kind)*row%edges(1)/row%nodes
         plastic = edge_share(kind)*row%edges(2)/row%nodes
         errors(corrected_area) = errors(corrected_area) &
            + corrected_share(kind)*row%edges(1)/row%nodes
         errors(contact_area) = errors(contact_area) + contact
         if (kind == 1) errors(contact_area) = errors(corrected_area) &
            + abs(values(contact_area) - values(corrected_area))
         errors(plastic_area) = errors(plastic_area) + plastic
         errors(plasticity_index) = errors(plasticity_index) + (plastic &
            + values(plasticity_index)*contact)/values(contact_area)
      end associate
   end function estimates_of

   !> Largest relative error of the contact area over all loads of an `outcome`.
   pure real(wp) function area_doubt(outcome) result(doubt)
      type(dry_outcome_t), intent(in) :: outcome

      doubt = unknown_doubt
      if (.not. allocated(outcome%errors)) return
      if (all(ieee_is_finite(outcome%errors(contact_area, :)))) doubt = &
         maxval(outcome%errors(contact_area, :)/outcome%rows%values(contact_area))
   end function area_doubt

   !> Nodes of the grid after `trials` (at least one), none of which meet `target`; 0 if no grid of
   !> up to `most` nodes is finer, or if the last two have no solution.
   pure function finer_nodes(trials, target, most) result(nodes)
      type(dry_trial_t), intent(in) :: trials(:)
      real(wp), intent(in) :: target
      integer, intent(in) :: most
      integer :: nodes(2)
      real(wp) :: factor, first(2), largest, order
      integer :: directions, n

      nodes = 0
      n = size(trials)
      if (all(trials(max(n - 1, 1):)%doubt >= unknown_doubt) .and. n > 1) return
      associate (last => trials(n), before => trials(max(n - 1, 1)))
         directions = merge(1, 2, last%nodes(2) == 1)
         factor = doubling
         if (last%doubt < unknown_doubt) then
            order = 1.0_wp
            if (n > 1 .and. before%doubt < unknown_doubt) order = log(before%doubt/last%doubt) &
               /log(real(last%nodes(1), wp)/before%nodes(1))
            order = min(max(order, orders(1)), orders(2))
            factor = min((last%doubt/(margin*target))**(1.0_wp/order), farthest(directions))
         end if
         ! Both directions keep the ratio of the first grid.
         first = trials(1)%nodes
         factor = factor*(product(last%nodes/first))**(1.0_wp/directions)
         largest = (most/product(first))**(1.0_wp/directions)
         nodes(:directions) = even_nodes(factor*first(:directions), largest*first(:directions))
         nodes(directions + 1:) = 1
         if (product(real(nodes, wp)) <= product(real(last%nodes, wp))) nodes = 0
      end associate
   end function finer_nodes

end module dry_errors

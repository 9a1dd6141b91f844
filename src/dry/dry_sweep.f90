!> A dry contact under a series of loads, and the quantities of each, in SI.
module dry_sweep
   use, intrinsic :: iso_fortran_env, only: real32
   use constants, only: pi
   use contact_edges, only: edge_load, edges_of, line_excess
   use domain_border, only: border_reason
   use dry_contact_solver, only: dry_solver_t
   use dry_problem, only: dry_grid_t, dry_problem_t, kernel_open, new_dry_problem
   use dry_scaling, only: dry_scaling_t
   use dry_settings, only: dry_loads_t, dry_settings_t
   use dry_solution, only: dry_solution_t
   use errors, only: error_t
   use kinds, only: wp
   use load_search, only: solve_for_datum
   use pressure_shape, only: crest_of
   use roughness, only: roughness_of, roughness_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: dry_fields_t, dry_outcome_t, dry_row_t, solve_dry_sweep

   !> Quantities of one load, SI; loads and energies of a line per metre of its length.
   type :: dry_row_t
      real(wp) :: mean_pressure, load
      real(wp) :: contact_area_fraction, plastic_area_fraction
      !> Plastic over contact area.
      real(wp) :: plasticity_index
      !> Plane to mean of the loaded surface [m].
      real(wp) :: mean_separation
      !> Plane to mean of the undeformed surface of a periodic domain; of an open area the approach
      !> of the bodies since first touch [m]; of an open line 0.
      real(wp) :: separation
      !> Mean of u - z under 0 < p < H [m].
      real(wp) :: datum
      real(wp) :: p_max
      !> Largest pressure between the nodes [Pa].
      real(wp) :: p_crest
      !> Largest and mean plastic deformation [m].
      real(wp) :: dp_max, dp_mean
      real(wp) :: elastic_energy, dissipated_energy
      !> Error measure reached [-].
      real(wp) :: kkt
      integer :: fft_pairs, cycles
      logical :: is_converged
      !> Why the iteration ended.
      character(:), allocatable :: reason
      !> Contact area, as a fraction, less `border_share` of its perimeter (areas), or between edges
      !> that may lie between the nodes (lines).
      real(wp) :: contact_area_corrected
      !> Neighbours one of which is in contact (at the hardness) and the other not, of the periodic
      !> grid.
      integer :: contact_edges, plastic_edges
      !> Share of the load of an area that is chance, if that of the nodes at the edges is.
      real(wp) :: edge_load = 0.0_wp
      type(roughness_t) :: undeformed, loaded, unloaded
   end type dry_row_t

   !> Fields of the last load, SI, each (nx*ny). Without a hardness the last two are not allocated:
   !> the unloaded surface is the undeformed one.
   type :: dry_fields_t
      real(wp), allocatable :: pressure(:), gap(:), height_loaded(:)
      real(wp), allocatable :: height_unloaded(:), plastic_deformation(:)
   end type dry_fields_t

   !> Largest pressure and plastic deformation [Pa, m]; sums of plastic deformation and undeformed
   !> heights [m], of v and of pressure times deflection, dimensionless.
   type :: totals_t
      real(wp) :: p_max, dp_max, dp, z, v, work
   end type totals_t

   !> Quantities of all loads, fields and solution of the last.
   type :: dry_outcome_t
      type(dry_row_t), allocatable :: rows(:)
      type(dry_fields_t) :: fields
      type(dry_solution_t) :: solution
      type(dry_scaling_t) :: scaling
      !> Pressures of all loads (nx*ny, loads), dimensionless, if the settings ask for them.
      real(real32), allocatable :: pressures(:, :)
      !> Processor time of preparing (planning of transforms) and of solving, wall time of solving,
      !> all loads [s].
      real(wp) :: cpu_prepare = 0.0_wp, cpu_solve = 0.0_wp, wall_solve = 0.0_wp
      !> Transforms of all loads, as in a solution.
      integer, allocatable :: transforms(:, :)
   end type dry_outcome_t

   !> Share of a cell by which counted nodes make the contact area too large for each two neighbours
   !> in and out of contact (V. A. Yastrebov, G. Anciaux and J.-F. Molinari, Tribol. Lett. 56, 2014,
   !> 171).
   real(wp), parameter :: border_share = (pi - 1.0_wp + log(2.0_wp))/24.0_wp

contains

   !> Solves all `loads` of the heights `z` (nx*ny) [m] on `grid`. Not converging is told in rows
   !> and report. Errors: a load above hardness times area, a separation at which nothing touches
   !> (input_error); FFTW (internal_error).
   subroutine solve_dry_sweep(grid, z, scaling, loads, settings, outcome, error)
      type(dry_grid_t), intent(in) :: grid
      real(wp), contiguous, intent(in) :: z(:)
      type(dry_scaling_t), intent(in) :: scaling
      type(dry_loads_t), intent(in) :: loads
      type(dry_settings_t), intent(in) :: settings
      type(dry_outcome_t), intent(out) :: outcome
      type(error_t), allocatable, intent(out) :: error
      type(dry_problem_t) :: problem
      type(dry_solver_t) :: solver
      type(roughness_t) :: undeformed
      real(wp), allocatable :: plastic(:), yielded(:)   ! 0 nodes where nothing yields
      real(wp) :: area, cpu_start, cpu_stop, top, wall_start
      integer :: i, n

      call cpu_time(cpu_start)
      solver%settings = settings
      outcome%scaling = scaling
      call new_dry_problem(problem, grid, z/scaling%height, error)
      if (allocated(error)) return
      if (loads%hardness < huge(1.0_wp)) problem%hardness = scaling%scaled_pressure(loads%hardness)
      n = size(z)
      top = maxval(problem%height)
      if (.not. settings%is_rough) undeformed = roughness_of(z, grid%ny == 1)
      area = scaling%domain_area(grid%aspect, grid%ny == 1)
      if (allocated(loads%separation)) then
         allocate (outcome%rows(size(loads%separation)))
      else
         allocate (outcome%rows(size(loads%mean_pressure)))
      end if
      call problem%elastic%plan_single(error)
      if (allocated(error)) return
      call cpu_time(cpu_stop)
      outcome%cpu_prepare = cpu_stop - cpu_start
      allocate (yielded(merge(n, 0, loads%has_history)), source=0.0_wp)
      allocate (outcome%transforms(4, 0))
      if (settings%keeps_pressures) allocate (outcome%pressures(n, size(outcome%rows)))
      associate (rows => outcome%rows, fields => outcome%fields, solution => outcome%solution)
         do i = 1, size(rows)
            wall_start = wall_seconds()
            call cpu_time(cpu_start)
            if (allocated(settings%starts)) call start_from(settings%starts(:, i), problem, &
               solution)
            if (allocated(loads%separation)) then
               call solve_for_datum(solver, problem, datum_of(problem%grid, scaling, top, &
                  loads%separation(i)), solution, error)
            else
               problem%load = scaling%scaled_pressure(loads%mean_pressure(i))*n
               call solver%solve(problem, solution, error)
            end if
            if (allocated(error)) return
            call cpu_time(cpu_stop)
            outcome%cpu_solve = outcome%cpu_solve + cpu_stop - cpu_start
            outcome%wall_solve = outcome%wall_solve + wall_seconds() - wall_start
            outcome%transforms = reshape([outcome%transforms, solution%transforms], &
               [4, size(outcome%transforms, 2) + size(solution%transforms, 2)])
            call find_plastic(problem, solution, plastic)   ! only now: the solver needs the memory
            call fill_fields(problem, scaling, z, solution, plastic, yielded, fields)
            if (problem%is_capped()) then
               where (solution%pressure >= problem%hardness) fields%pressure = loads%hardness
            end if
            call fill_row(problem, scaling, z, solution, plastic, fields, rows(i))
            if (.not. settings%is_rough) call fill_roughness(fields, grid%ny == 1, undeformed, &
               rows(i))
            rows(i)%mean_pressure = scaling%pressure_in_si(problem%load/n)
            if (allocated(loads%mean_pressure)) rows(i)%mean_pressure = loads%mean_pressure(i)
            rows(i)%load = rows(i)%mean_pressure*area
            call check_border(grid, scaling, z, fields, rows(i))
            rows(i)%separation = separation_of(problem%grid, scaling, top, solution%datum)
            rows(i)%dissipated_energy = 0.0_wp
            if (problem%is_capped()) rows(i)%dissipated_energy = loads%hardness*area &
               *rows(i)%dp_mean
            if (settings%keeps_pressures) outcome%pressures(:, i) = real(solution%pressure, real32)
            if (loads%has_history) then
               call carry_on(plastic, problem, solution, yielded)
               call solver%forget_surface()
            end if
            deallocate (plastic)
         end do
      end associate
   end subroutine solve_dry_sweep

   !> The plastic deformation (nx*ny) under the load of `solution`, dimensionless; empty without a
   !> hardness.
   pure subroutine find_plastic(problem, solution, plastic)
      type(dry_problem_t), intent(in) :: problem
      type(dry_solution_t), intent(in) :: solution
      real(wp), allocatable, intent(out) :: plastic(:)

      allocate (plastic(merge(size(solution%pressure), 0, problem%is_capped())), source=0.0_wp)
      if (.not. problem%is_capped()) return
      where (solution%pressure >= problem%hardness) plastic = max(solution%datum - solution%v, &
         0.0_wp)
   end subroutine find_plastic

   !> The next load meets the surface that this one has left.
   pure subroutine carry_on(plastic, problem, solution, yielded)
      real(wp), intent(in) :: plastic(:)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_solution_t), intent(inout) :: solution
      real(wp), intent(inout) :: yielded(:)

      if (size(plastic) == 0) return
      yielded = yielded + plastic
      problem%height = problem%height - plastic
      solution%v = solution%v + plastic
   end subroutine carry_on

   !> Makes the `pressure` (nx*ny) the start of `solution`.
   pure subroutine start_from(pressure, problem, solution)
      real(real32), intent(in) :: pressure(:)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_solution_t), intent(inout) :: solution

      solution%pressure = pressure
      solution%contacts = count(solution%pressure > 0.0_wp)
      problem%load = sum(solution%pressure)
      if (allocated(solution%v)) deallocate (solution%v)
   end subroutine start_from

   !> The datum, dimensionless, of a separation [m]; `top` is the highest point of the virgin
   !> surface above its mean.
   pure function datum_of(grid, scaling, top, separation) result(datum)
      type(dry_grid_t), intent(in) :: grid
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: top, separation
      real(wp) :: datum

      datum = -scaling%scaled_height(separation)
      if (grid%kernel == kernel_open) datum = -datum - top
   end function datum_of

   !> The separation of `dry_row_t` [m] of a datum: the reverse of `datum_of`.
   pure function separation_of(grid, scaling, top, datum) result(separation)
      type(dry_grid_t), intent(in) :: grid
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: top, datum
      real(wp) :: separation

      separation = -scaling%height_in_si(datum)
      if (grid%kernel == kernel_open) separation = merge(0.0_wp, &
         scaling%height_in_si(top + datum), grid%ny == 1)
   end function separation_of

   !> Pressure, gap and profiles in SI. `plastic` is the deformation of this load, `yielded` that of
   !> the loads before which the heights of `problem` already have (history); empty: there is none.
   subroutine fill_fields(problem, scaling, z, solution, plastic, yielded, fields)
      type(dry_problem_t), intent(in) :: problem
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), contiguous, intent(in) :: z(:), plastic(:), yielded(:)
      type(dry_solution_t), intent(in) :: solution
      type(dry_fields_t), intent(inout) :: fields
      real(wp) :: deformation, gap, unloaded
      integer :: i, n

      n = size(z)
      if (.not. allocated(fields%pressure)) then
         allocate (fields%pressure(n), fields%gap(n), fields%height_loaded(n))
         if (problem%is_capped()) allocate (fields%height_unloaded(n), &
            fields%plastic_deformation(n))
      end if
      ! One pass, since these fields do not fit into the cache; the nodes are independent.
      !$omp parallel do num_threads(problem%grid%threads) private(deformation, gap, unloaded) &
      !$omp    schedule(static)
      do i = 1, n
         deformation = 0.0_wp
         if (size(plastic) > 0) deformation = plastic(i)
         gap = solution%v(i) + deformation - solution%datum
         fields%gap(i) = scaling%height*merge(gap, 0.0_wp, gap > 0.0_wp &
            .and. .not. solution%pressure(i) > 0.0_wp)
         fields%pressure(i) = scaling%pressure*solution%pressure(i)
         unloaded = z(i)
         if (size(plastic) > 0) then
            if (size(yielded) > 0) deformation = deformation + yielded(i)
            fields%plastic_deformation(i) = scaling%height*deformation
            unloaded = z(i) - fields%plastic_deformation(i)
            fields%height_unloaded(i) = unloaded
         end if
         fields%height_loaded(i) = unloaded - scaling%height*(solution%v(i) + problem%height(i))
      end do
      !$omp end parallel do
   end subroutine fill_fields

   !> Quantities of one load from its fields, the heights `z` [m] and the `plastic` deformation of
   !> this load alone, dimensionless.
   subroutine fill_row(problem, scaling, z, solution, plastic, fields, row)
      type(dry_problem_t), intent(in) :: problem
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), contiguous, intent(in) :: z(:)
      real(wp), intent(in) :: plastic(:)
      type(dry_solution_t), intent(in) :: solution
      type(dry_fields_t), intent(in) :: fields
      type(dry_row_t), intent(out) :: row
      type(totals_t) :: total
      real(wp) :: area
      integer :: n

      n = size(fields%pressure)
      area = scaling%domain_area(problem%grid%aspect, problem%grid%ny == 1)
      total = totals_of(problem, z, solution, fields)
      row%contact_area_fraction = real(solution%contacts, wp)/n
      row%plastic_area_fraction = real(solution%capped, wp)/n
      row%plasticity_index = real(solution%capped, wp)/solution%contacts
      row%p_max = total%p_max
      row%p_crest = crest_of(problem%grid, fields%pressure)
      if (problem%is_capped()) row%p_crest = min(row%p_crest, &
         scaling%pressure_in_si(problem%hardness))
      row%dp_max = total%dp_max
      row%dp_mean = total%dp/n
      ! The problem's heights have no mean; the datum is that of the heights as given.
      row%datum = scaling%height_in_si(solution%datum) - total%z/n
      row%mean_separation = scaling%height_in_si(total%v/n - solution%datum + sum(plastic)/n)
      row%elastic_energy = scaling%energy_in_si(0.5_wp*area/n, total%work)
      row%kkt = solution%kkt
      row%fft_pairs = int(solution%report%fft_pairs)
      row%cycles = solution%report%cycles
      row%is_converged = solution%report%converged
      row%reason = solution%report%reason
      row%contact_edges = edges_of(problem%grid%nx, problem%grid%ny, solution%pressure, &
         nearest(0.0_wp, 1.0_wp))
      row%plastic_edges = 0
      if (problem%is_capped()) row%plastic_edges = edges_of(problem%grid%nx, &
         problem%grid%ny, solution%pressure, problem%hardness)
      if (problem%grid%ny > 1) then
         row%edge_load = edge_load(problem%grid%nx, problem%grid%ny, solution%pressure)
         row%contact_area_corrected = row%contact_area_fraction &
            - border_share*row%contact_edges/real(n, wp)
      else
         row%contact_area_corrected = row%contact_area_fraction &
            - line_excess(solution%pressure)/n
      end if
   end subroutine fill_row

   !> Adds up a solution, its `fields` and the heights `z` in one pass, each sum in the order of the
   !> nodes.
   pure function totals_of(problem, z, solution, fields) result(total)
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: z(:)
      type(dry_solution_t), intent(in) :: solution
      type(dry_fields_t), intent(in) :: fields
      type(totals_t) :: total
      real(wp) :: p_max, v, work, z_sum
      integer :: i

      p_max = fields%pressure(1)
      z_sum = 0.0_wp
      v = 0.0_wp
      work = 0.0_wp
      do i = 1, size(z)
         if (fields%pressure(i) > p_max) p_max = fields%pressure(i)
         z_sum = z_sum + z(i)
         v = v + solution%v(i)
         work = work + solution%pressure(i)*(solution%v(i) + problem%height(i))
      end do
      total = totals_t(p_max, 0.0_wp, 0.0_wp, z_sum, v, work)
      if (.not. allocated(fields%plastic_deformation)) return
      total%dp_max = maxval(fields%plastic_deformation)
      total%dp = sum(fields%plastic_deformation)
   end function totals_of

   !> Roughness of the surface of one load from its fields and from that of the `undeformed` one,
   !> which is left where nothing has yielded.
   subroutine fill_roughness(fields, is_line, undeformed, row)
      type(dry_fields_t), intent(in) :: fields
      logical, intent(in) :: is_line
      type(roughness_t), intent(in) :: undeformed
      type(dry_row_t), intent(inout) :: row

      row%undeformed = undeformed
      row%loaded = roughness_of(fields%height_loaded, is_line)
      row%unloaded = undeformed
      if (row%dp_max > 0.0_wp) row%unloaded = &
         roughness_of(fields%height_unloaded, is_line)
   end subroutine fill_roughness

   !> A contact that reaches the border of an open domain is no solution.
   subroutine check_border(grid, scaling, z, fields, row)
      type(dry_grid_t), intent(in) :: grid
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: z(:)
      type(dry_fields_t), intent(in) :: fields
      type(dry_row_t), intent(inout) :: row
      character(:), allocatable :: reason

      reason = border_reason(grid, scaling, z, fields%pressure, row%load)
      if (reason == '' .or. .not. row%is_converged) return
      row%is_converged = .false.
      call move_alloc(reason, row%reason)
   end subroutine check_border

end module dry_sweep

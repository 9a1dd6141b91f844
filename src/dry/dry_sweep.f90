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
   use roughness, only: roughness_of, roughness_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: crest_of, dry_fields_t, dry_outcome_t, dry_row_t, solve_dry_sweep

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
      !> Share of the load that is chance, if that of the nodes at the edges is.
      real(wp) :: edge_load
      type(roughness_t) :: undeformed, loaded, unloaded
   end type dry_row_t

   !> Fields of the last load, SI, each (nx*ny).
   type :: dry_fields_t
      real(wp), allocatable :: pressure(:), gap(:), height_undeformed(:), height_loaded(:), &
         height_unloaded(:), &
         plastic_deformation(:)
   end type dry_fields_t

   !> Quantities of all loads, fields and solution of the last.
   type :: dry_outcome_t
      type(dry_row_t), allocatable :: rows(:)
      type(dry_fields_t) :: fields
      type(dry_solution_t) :: solution
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

   !> Nodes with less of the largest pressure have no vertex above it.
   real(wp), parameter :: crest_share = 0.5_wp

contains

   !> Solves all `loads` of the heights `z` (nx*ny) [m] on `grid`. Not converging is told in rows
   !> and report. Errors: a load above hardness times area, a separation at which nothing touches
   !> (input_error); FFTW (internal_error).
   subroutine solve_dry_sweep(grid, z, scaling, loads, settings, outcome, error)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: z(:)
      type(dry_scaling_t), intent(in) :: scaling
      type(dry_loads_t), intent(in) :: loads
      type(dry_settings_t), intent(in) :: settings
      type(dry_outcome_t), intent(out) :: outcome
      type(error_t), allocatable, intent(out) :: error
      type(dry_problem_t) :: problem
      type(dry_solver_t) :: solver
      type(roughness_t) :: undeformed
      real(wp), allocatable :: plastic(:), yielded(:)
      real(wp) :: area, cpu_start, cpu_stop, top, wall_start
      integer :: i, n

      call cpu_time(cpu_start)
      solver%settings = settings
      call new_dry_problem(problem, grid, scaling%scaled_height(z), error)
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
            allocate (plastic(n), source=0.0_wp)   ! only now: the solver needs the memory
            where (solution%pressure >= problem%hardness) plastic = max(solution%datum &
               - solution%v, 0.0_wp)
            call fill_fields(problem, scaling, z, solution, plastic, yielded, fields)
            where (solution%pressure >= problem%hardness) fields%pressure = loads%hardness
            call fill_row(problem, scaling, area, solution, plastic, fields, rows(i))
            if (.not. settings%is_rough) call fill_roughness(fields, grid%ny == 1, undeformed, &
               rows(i))
            rows(i)%mean_pressure = scaling%pressure_in_si(problem%load/n)
            if (allocated(loads%mean_pressure)) rows(i)%mean_pressure = loads%mean_pressure(i)
            rows(i)%load = rows(i)%mean_pressure*area
            call check_border(grid, scaling, fields, rows(i))
            rows(i)%separation = separation_of(problem%grid, scaling, top, solution%datum)
            rows(i)%dissipated_energy = 0.0_wp
            if (problem%is_capped()) rows(i)%dissipated_energy = loads%hardness*area &
               *rows(i)%dp_mean
            if (settings%keeps_pressures) outcome%pressures(:, i) = real(solution%pressure, real32)
            if (loads%has_history) then
               yielded = yielded + plastic
               problem%height = problem%height - plastic
               solution%v = solution%v + plastic
               call solver%forget_surface()
            end if
            deallocate (plastic)
         end do
      end associate
   end subroutine solve_dry_sweep

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
   !> the loads before which the heights of `problem` already have (history; else it is empty).
   pure subroutine fill_fields(problem, scaling, z, solution, plastic, yielded, fields)
      type(dry_problem_t), intent(in) :: problem
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: z(:), plastic(:), yielded(:)
      type(dry_solution_t), intent(in) :: solution
      type(dry_fields_t), intent(inout) :: fields

      fields%pressure = scaling%pressure_in_si(solution%pressure)
      fields%gap = scaling%height_in_si(max(solution%v + plastic - solution%datum, 0.0_wp))
      where (solution%pressure > 0.0_wp) fields%gap = 0.0_wp
      fields%height_undeformed = z(:)
      if (size(yielded) > 0) then
         fields%plastic_deformation = scaling%height_in_si(plastic + yielded)
      else
         fields%plastic_deformation = scaling%height_in_si(plastic)
      end if
      fields%height_unloaded = z - fields%plastic_deformation
      fields%height_loaded = fields%height_unloaded &
         - scaling%height_in_si(solution%v + problem%height)
   end subroutine fill_fields

   !> Quantities of one load from its fields, the `area` of the domain and the `plastic` deformation
   !> of this load alone, dimensionless.
   subroutine fill_row(problem, scaling, area, solution, plastic, fields, row)
      type(dry_problem_t), intent(in) :: problem
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: area, plastic(:)
      type(dry_solution_t), intent(in) :: solution
      type(dry_fields_t), intent(in) :: fields
      type(dry_row_t), intent(out) :: row
      integer :: n

      n = size(fields%pressure)
      row%contact_area_fraction = real(solution%contacts, wp)/n
      row%plastic_area_fraction = real(solution%capped, wp)/n
      row%plasticity_index = real(solution%capped, wp)/solution%contacts
      row%p_max = maxval(fields%pressure)
      row%p_crest = crest_of(problem%grid, fields%pressure)
      if (problem%is_capped()) row%p_crest = min(row%p_crest, &
         scaling%pressure_in_si(problem%hardness))
      row%dp_max = maxval(fields%plastic_deformation)
      row%dp_mean = sum(fields%plastic_deformation)/n
      ! The problem's heights have no mean; the datum is that of the heights as given.
      row%datum = scaling%height_in_si(solution%datum) - sum(fields%height_undeformed)/n
      row%mean_separation = scaling%height_in_si(sum(solution%v)/n - solution%datum &
         + sum(plastic)/n)
      row%elastic_energy = scaling%energy_in_si(0.5_wp*area/n, dot_product(solution%pressure, &
         solution%v + problem%height))
      row%kkt = solution%kkt
      row%fft_pairs = int(solution%report%fft_pairs)
      row%cycles = solution%report%cycles
      row%is_converged = solution%report%converged
      row%reason = solution%report%reason
      row%contact_edges = edges_of(problem%grid, solution%pressure > 0.0_wp)
      row%plastic_edges = 0
      if (problem%is_capped()) row%plastic_edges = edges_of(problem%grid, &
         solution%pressure >= problem%hardness)
      row%edge_load = edge_load(problem%grid, solution%pressure, solution%pressure > 0.0_wp)
      if (problem%grid%ny > 1) then
         row%contact_area_corrected = row%contact_area_fraction &
            - border_share*row%contact_edges/real(n, wp)
      else
         row%contact_area_corrected = row%contact_area_fraction &
            - line_excess(solution%pressure)/n
      end if
   end subroutine fill_row

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
      if (any(fields%plastic_deformation > 0.0_wp)) row%unloaded = &
         roughness_of(fields%height_unloaded, is_line)
   end subroutine fill_roughness

   !> A contact that reaches the border of an open domain is no solution.
   subroutine check_border(grid, scaling, fields, row)
      type(dry_grid_t), intent(in) :: grid
      type(dry_scaling_t), intent(in) :: scaling
      type(dry_fields_t), intent(in) :: fields
      type(dry_row_t), intent(inout) :: row
      character(:), allocatable :: reason

      reason = border_reason(grid, scaling, fields%height_undeformed, fields%pressure, row%load)
      if (reason == '' .or. .not. row%is_converged) return
      row%is_converged = .false.
      call move_alloc(reason, row%reason)
   end subroutine check_border

   !> The highest vertex of the parabolas in x and y through those nodes of the `pressure` (nx*ny)
   !> that are not lower than their neighbours.
   pure function crest_of(grid, pressure) result(crest)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: pressure(:)
      real(wp) :: crest
      real(wp) :: least, x(3), y(3)
      integer :: i, j, row

      crest = maxval(pressure)
      least = crest_share*crest
      do j = 0, grid%ny - 1
         row = j*grid%nx
         nodes: do i = 0, grid%nx - 1
            if (.not. pressure(row + i + 1) > least) cycle nodes
            x = pressure(row + modulo(i + [-1, 0, 1], grid%nx) + 1)
            y = pressure(modulo(j + [-1, 0, 1], grid%ny)*grid%nx + i + 1)
            if (x(2) < max(x(1), x(3), y(1), y(3))) cycle nodes
            crest = max(crest, x(2) + vertex_above(x) + vertex_above(y))
         end do nodes
      end do
   end function crest_of

   !> How far the vertex of the parabola through three values lies above the middle one, which is
   !> the largest.
   pure function vertex_above(values) result(height)
      real(wp), intent(in) :: values(3)
      real(wp) :: height
      real(wp) :: bend

      height = 0.0_wp
      bend = 2.0_wp*values(2) - values(1) - values(3)
      if (bend > 0.0_wp) height = (values(3) - values(1))**2/(8.0_wp*bend)
   end function vertex_above

end module dry_sweep

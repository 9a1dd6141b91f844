!> Solves a dry contact under a series of loads, and computes the quantities of each, in SI.
!>
!> In an open half-space nothing presses outside the domain: a contact that reaches the border is
!> that of a punch with sharp edges, whose pressure grows there without bound.
module dry_sweep
   use, intrinsic :: iso_fortran_env, only: int64, real32
   use features, only: node_positions
   use dry_contact_solver, only: dry_solver_t, solve_for_datum
   use dry_problem, only: dry_grid_t, dry_loads_t, dry_problem_t, dry_scaling_t, dry_settings_t, &
      dry_solution_t, kernel_open, new_dry_problem
   use dry_quantities, only: dp_max, dry_fields_t, dry_outcome_t, dry_row_t, fill_row, load, &
      mean_pressure
   use errors, only: error_t
   use hertz, only: line_half_width, point_radius
   use kinds, only: wp
   use roughness, only: roughness_of, roughness_t
   use text, only: to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: recommended_room, solve_dry_sweep

   !> Length of a domain over the width of its contact that leaves room for the gap.
   real(wp), parameter :: recommended_room = 1.2_wp
   !> A parabola that explains a smaller share of the variance of the heights says nothing about the
   !> surface outside the domain.
   real(wp), parameter :: least_share = 0.5_wp

contains

   !> Solves all `loads` of the heights `z` (nx*ny) [m] on `grid`. Rows and report say which loads
   !> did not converge. Errors: a load above hardness times area, a separation at which nothing
   !> touches (input_error); FFTW (internal_error).
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
      real(wp) :: cpu_start, cpu_stop, pressure, wall_start, wanted
      integer :: i, n

      call cpu_time(cpu_start)
      solver%settings = dry_settings_t(settings%method, settings%tolerance, settings%max_cycles, &
         settings%is_rough)   ! without the pressures to start from
      outcome%scaling = scaling
      call new_dry_problem(problem, grid, z/scaling%height, error)
      if (allocated(error)) return
      if (loads%hardness < huge(1.0_wp)) problem%hardness = loads%hardness/scaling%pressure
      n = size(z)
      if (.not. settings%is_rough) undeformed = roughness_of(z, grid%ny == 1)
      call problem%elastic%plan_single(error)
      if (allocated(error)) return
      call cpu_time(cpu_stop)
      outcome%seconds(1) = cpu_stop - cpu_start
      if (allocated(loads%separation)) then
         allocate (outcome%rows(size(loads%separation)))
      else
         allocate (outcome%rows(size(loads%mean_pressure)))
      end if
      allocate (yielded(merge(n, 0, loads%has_history)), source=0.0_wp)
      allocate (outcome%transforms(4, 0))
      if (settings%keeps_pressures) allocate (outcome%pressures(n, size(outcome%rows)))
      associate (fields => outcome%fields, solution => outcome%solution)
         do i = 1, size(outcome%rows)
            wall_start = wall_seconds()
            call cpu_time(cpu_start)
            if (allocated(settings%starts)) call start_from(settings%starts(:, i), problem, &
               solution)
            if (allocated(loads%separation)) then
               wanted = -(loads%separation(i)/scaling%height)
               if (grid%kernel == kernel_open) wanted = -wanted - problem%top
               call solve_for_datum(solver, problem, wanted, solution, error)
            else
               problem%load = loads%mean_pressure(i)/scaling%pressure*n
               call solver%solve(problem, solution, error)
            end if
            if (allocated(error)) return
            call cpu_time(cpu_stop)
            outcome%seconds(2:) = outcome%seconds(2:) + [cpu_stop - cpu_start, &
               wall_seconds() - wall_start]
            outcome%transforms = reshape([outcome%transforms, solution%transforms], &
               [4, size(outcome%transforms, 2) + size(solution%transforms, 2)])
            call find_plastic(problem, solution, plastic)   ! only now: the solver needs the memory
            call fill_fields(problem, scaling, z, solution, plastic, yielded, fields)
            where (solution%pressure >= problem%hardness) fields%pressure = loads%hardness
            pressure = scaling%pressure*(problem%load/n)
            if (allocated(loads%mean_pressure)) pressure = loads%mean_pressure(i)
            call fill_row(problem, z, plastic, pressure, i, outcome)
            if (.not. settings%is_rough) then
               associate (row => outcome%rows(i), is_line => grid%ny == 1)
                  ! where nothing yields the unloaded surface is the undeformed one
                  row%roughness = [undeformed, roughness_of(fields%height_loaded, is_line), &
                     undeformed]
                  if (row%values(dp_max) > 0.0_wp) row%roughness(3) = &
                     roughness_of(fields%height_unloaded, is_line)
               end associate
            end if
            call check_border(grid, scaling, z, fields%pressure, outcome%rows(i))
            if (settings%keeps_pressures) outcome%pressures(:, i) = real(solution%pressure, real32)
            if (loads%has_history) call yield(plastic, problem, solver, solution, yielded)
            deallocate (plastic)
         end do
      end associate
      call report_all(outcome%rows, outcome%solution)
   end subroutine solve_dry_sweep

   !> Makes one report for all loads: converged if all are; sums transforms and iterations.
   subroutine report_all(rows, solution)
      type(dry_row_t), intent(in) :: rows(:)
      type(dry_solution_t), intent(inout) :: solution
      integer :: i

      solution%report%cost%fft_pairs = sum(int(rows%fft_pairs, int64))
      solution%report%cycles = sum(rows%cycles)
      do i = 1, size(rows)
         if (rows(i)%is_converged) cycle
         solution%report%converged = .false.
         solution%report%reason = rows(i)%reason // ' at a mean pressure of ' &
            // to_text(rows(i)%values(mean_pressure)) // ' Pa'
      end do
   end subroutine report_all

   !> Computes the plastic deformation (nx*ny) under the load of `solution`, dimensionless; empty
   !> without a hardness.
   pure subroutine find_plastic(problem, solution, plastic)
      type(dry_problem_t), intent(in) :: problem
      type(dry_solution_t), intent(in) :: solution
      real(wp), allocatable, intent(out) :: plastic(:)

      allocate (plastic(merge(size(solution%pressure), 0, problem%is_capped())), source=0.0_wp)
      if (.not. problem%is_capped()) return
      where (solution%pressure >= problem%hardness) plastic = max(solution%datum - solution%v, &
         0.0_wp)
   end subroutine find_plastic

   !> Deforms the surface for the next load.
   pure subroutine yield(plastic, problem, solver, solution, yielded)
      real(wp), intent(in) :: plastic(:)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_solver_t), intent(inout) :: solver
      type(dry_solution_t), intent(inout) :: solution
      real(wp), intent(inout) :: yielded(:)

      if (allocated(solver%full_range)) deallocate (solver%full_range)
      if (size(plastic) == 0) return
      yielded = yielded + plastic
      problem%height = problem%height - plastic
      solution%v = solution%v + plastic
   end subroutine yield

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

   !> Sets pressure, gap and profiles in SI. `plastic` is the deformation of this load, `yielded`
   !> that of earlier loads, already in the heights of `problem` (history); empty: none.
   subroutine fill_fields(problem, scaling, z, solution, plastic, yielded, fields)
      type(dry_problem_t), intent(in) :: problem
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), contiguous, intent(in) :: z(:), plastic(:), yielded(:)
      type(dry_solution_t), intent(in) :: solution
      type(dry_fields_t), intent(inout) :: fields
      !> Nodes of which all fields are filled while they are in the cache.
      integer, parameter :: block = 2048
      integer :: first, last, n

      n = size(z)
      if (.not. allocated(fields%pressure)) then
         allocate (fields%pressure(n), fields%gap(n), fields%height_loaded(n))
         if (problem%is_capped()) allocate (fields%height_unloaded(n), &
            fields%plastic_deformation(n))
      end if
      !$omp parallel do num_threads(problem%grid%threads) private(last) schedule(static)
      do first = 1, n, block
         last = min(first + block - 1, n)
         fields%pressure(first:last) = scaling%pressure*solution%pressure(first:last)
         fields%gap(first:last) = scaling%height &
            *max(solution%v(first:last) - solution%datum, 0.0_wp)
         where (solution%pressure(first:last) > 0.0_wp) fields%gap(first:last) = 0.0_wp
         fields%height_loaded(first:last) = z(first:last) &
            - scaling%height*(solution%v(first:last) + problem%height(first:last))
      end do
      !$omp end parallel do
      if (size(plastic) == 0) return
      fields%plastic_deformation = scaling%height*plastic
      if (size(yielded) > 0) fields%plastic_deformation = scaling%height*(plastic + yielded)
      fields%height_unloaded = z - fields%plastic_deformation
      fields%height_loaded = fields%height_unloaded - scaling%height*(solution%v + problem%height)
   end subroutine fill_fields

   !> Marks a contact whose `pressure` (nx*ny) is positive at the border of an open domain as not
   !> converged. `z` (nx*ny) [m] are the heights.
   subroutine check_border(grid, scaling, z, pressure, row)
      type(dry_grid_t), intent(in) :: grid
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: z(:), pressure(:)
      type(dry_row_t), intent(inout) :: row
      real(wp) :: half_width, radius
      logical :: is_pressed

      if (grid%kernel /= kernel_open .or. .not. row%is_converged) return
      associate (nx => grid%nx, last_row => grid%nx*(grid%ny - 1))
         is_pressed = any(pressure(1::nx) > 0.0_wp) .or. any(pressure(nx::nx) > 0.0_wp)
         if (grid%ny > 1) is_pressed = is_pressed .or. any(pressure(:nx) > 0.0_wp) &
            .or. any(pressure(last_row + 1:) > 0.0_wp)
      end associate
      if (.not. is_pressed) return
      row%is_converged = .false.
      radius = fitted_radius(grid, scaling%length, z)
      if (radius <= 0.0_wp) then
         row%reason = 'the contact reaches the border of the open domain, towards which the '// &
            'surface does not fall: no length is enough'
         return
      end if
      if (grid%ny == 1) then
         half_width = line_half_width(row%values(load), radius, scaling%reduced_modulus)
      else
         half_width = point_radius(row%values(load), radius, scaling%reduced_modulus)
      end if
      row%reason = 'the contact reaches the border of the open domain, which should be about ' &
         //to_text(2.0_wp*recommended_room*half_width, 2)//' m long for this load'
   end subroutine check_border

   !> Radius R [m] of the parabola c - r^2/(2 R) that fits the heights best by least squares; 0 if
   !> they do not fall towards the border, or are hardly a parabola.
   pure real(wp) function fitted_radius(grid, length, z) result(radius)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: length, z(:)
      real(wp) :: covariance, spread_of_squares, squares(size(z)), variance, x(grid%nx), y(grid%ny)
      integer :: i, j

      x = node_positions(grid%nx, length, .false.)
      y = node_positions(grid%ny, length*grid%aspect, .false.)
      squares = [((x(i)**2 + y(j)**2, i=1, grid%nx), j=1, grid%ny)]
      squares = squares - sum(squares)/size(z)
      covariance = sum(squares*z)
      variance = sum((z - sum(z)/size(z))**2)
      spread_of_squares = sum(squares**2)
      radius = 0.0_wp
      if (covariance < 0.0_wp .and. covariance**2 > least_share*variance*spread_of_squares) then
         radius = -0.5_wp*spread_of_squares/covariance
      end if
   end function fitted_radius

end module dry_sweep

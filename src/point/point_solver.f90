!> The steady point contact from its data to its fields and quantities: nested grids, from the dry
!> contact on the first one that holds the film.
module point_solver
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use listener, only: listener_t
   use missing_value, only: exceeds
   use point_contact, only: first_intervals, hertz_pressure_at, intervals_for, point_contact_t
   use point_cycle, only: new_hierarchy, point_hierarchy_t
   use point_level, only: deflect, load_on, point_level_t
   use point_newton, only: point_newton_t, solve_point_newton
   use point_quantities, only: estimate_point_errors, summary_of_point
   use quantities, only: central_value, h_central, h_min
   use text, only: to_text
   use transfer, only: prolong_cubic
   implicit none (type, external)
   private

   public :: measure_domain, point_run_t, solve_point_steady

   !> The start lies this many times the expected film above the dry contact.
   real(wp), parameter :: start_film = 1.5_wp
   !> Most Newton steps on a grid.
   integer, parameter, public :: most_steps = 60
   !> The longer domain has an eighth more intervals on both sides together, on a grid with a
   !> quarter of them.
   integer, parameter :: coarsening = 4, extension = 8

   !> How to solve a contact, and its solution with the quantities on all grids.
   type :: point_run_t
      real(wp) :: tolerance = 1.0e-8_wp
      integer :: max_steps = most_steps
      !> Relative error of h_central and h_min for which the grid is chosen, up to that of the
      !> contact; 0: that of the contact.
      real(wp) :: target = 0.0_wp
      !> 2 (u2 - u1)/(u1 + u2); NaN: not known.
      real(wp) :: slide_to_roll = 0.0_wp
      integer :: threads = 1
      type(point_newton_t) :: newton
      !> Quantities on each grid, the first one the coarsest; pressure and H0 of the last but two.
      type(line_summary_t), allocatable :: grids(:)
      real(wp), allocatable :: older(:, :)
      real(wp) :: older_h0 = 0.0_wp
      !> Newton steps and iterations of GMRES (2, grids).
      integer, allocatable :: work(:, :)
   end type point_run_t

contains

   !> Solves the contact on its grid, or on the first one for the target: `contact%domain` has it
   !> then. Not converging is in the report. Error (internal_error): LAPACK or FFTW.
   subroutine solve_point_steady(run, contact, listener, report, error)
      type(point_run_t), intent(inout) :: run
      type(point_contact_t), intent(inout) :: contact
      class(listener_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: coarse(:, :)
      real(wp) :: h0
      integer :: most, nx, ny

      run%grids = [line_summary_t ::]
      run%work = reshape([integer ::], [2, 0])
      most = contact%domain%nx
      nx = first_intervals(contact, most)
      report%method = 'newton_krylov'
      do
         ny = contact%domain%ny/(most/nx)
         call listener%on_stage(to_text(nx)//' x '//to_text(ny)//' intervals')
         call new_hierarchy(run%newton%hierarchy, contact, nx, ny, run%threads, error)
         if (allocated(error)) return
         associate (level => run%newton%hierarchy%levels(1), newton => run%newton)
            if (allocated(coarse)) then
               level%rigid_displacement = h0
               call interpolate(coarse, level%pressure)
            else
               call start_dry(contact, level)
            end if
            call solve_point_newton(newton, contact, run%tolerance, run%max_steps, listener)
            run%work = reshape([run%work, newton%steps, newton%iterations], [2, size(run%work, 2) &
               + 1])
            call fill_report(newton, report)
            if (.not. newton%is_converged) exit
            run%grids = [run%grids, summary_of_point(level, contact, run%slide_to_roll)]
            if (nx == most .or. meets_target(run, contact)) exit
            if (allocated(coarse)) then
               run%older = coarse
               run%older_h0 = h0
            end if
            coarse = level%pressure
            h0 = level%rigid_displacement
            nx = 2*nx
         end associate
      end do
      if (.not. report%converged) call blame(contact, nx, report)
      contact%domain%nx = nx
      contact%domain%ny = ny
   end subroutine solve_point_steady

   !> Whether the errors of the films by the last grid are within the target.
   pure logical function meets_target(run, contact) result(is_met)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t) :: last
      integer :: n

      n = size(run%grids)
      is_met = run%target > 0.0_wp .and. n > 2
      if (.not. is_met) return
      last = run%grids(n)
      call estimate_point_errors(last, contact, run%grids(n - 1:1:-1), 0.0_wp)
      associate (of => last%of([h_min, h_central]))
         is_met = all(exceeds(run%target*of%value - of%error_grid, 0.0_wp))
      end associate
   end function meets_target

   !> Takes over how the last grid went.
   subroutine fill_report(newton, report)
      type(point_newton_t), intent(in) :: newton
      type(report_t), intent(inout) :: report
      integer :: done(4), k

      report%converged = newton%is_converged
      report%reason = newton%reason
      report%cycles = report%cycles + newton%steps
      report%residual = newton%residual
      report%load_error = abs(newton%load_error)
      report%tolerance_effective = newton%bound
      associate (levels => newton%hierarchy%levels)
         report%numbers%levels = size(levels)
         do k = 1, size(levels)
            done = levels(k)%elastic%transforms()
            report%cost%fft_pairs = report%cost%fft_pairs + done(3)
         end do
      end associate
   end subroutine fill_report

   !> Says that the grid is too coarse for the film where the rule for first grids says so.
   subroutine blame(contact, nx, report)
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx
      type(report_t), intent(inout) :: report
      integer :: needed

      needed = first_intervals(contact, 2**20)
      if (nx < needed) report%reason = 'grid too coarse for the film, needs '//to_text(needed) &
         //' intervals in x (has '//to_text(nx)//'); '//report%reason
   end subroutine blame

   !> Quantities on a quarter of the intervals, `near`, and with the same spacing on a domain about
   !> 1.5 times as long, `far`. `is_known`: both have a solution. Error: as above.
   subroutine measure_domain(run, contact, near, far, is_known, error)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t), intent(out) :: near, far
      logical, intent(out) :: is_known
      type(error_t), allocatable, intent(out) :: error
      type(point_newton_t) :: newton
      type(point_contact_t) :: longer
      type(listener_t) :: nobody
      real(wp) :: spacing
      integer :: behind, more, n(2)

      is_known = size(run%grids) > 2
      if (.not. is_known) return
      near = run%grids(size(run%grids) - 2)
      longer = contact
      n = [contact%domain%nx, contact%domain%ny]/coarsening
      associate (domain => longer%domain)
         more = contact%domain%nx/extension
         spacing = (domain%x_outlet - domain%x_inlet)/n(1)
         behind = nint(more*domain%x_outlet/(domain%x_outlet - domain%x_inlet))
         domain%x_inlet = domain%x_inlet - (more - behind)*spacing
         domain%x_outlet = domain%x_outlet + behind*spacing
         domain%y_half_width = domain%y_half_width*(1 + real(coarsening, wp)/extension)
         domain%nx = n(1) + more
         domain%ny = n(2) + contact%domain%ny/extension
         call new_hierarchy(newton%hierarchy, longer, domain%nx, domain%ny, run%threads, error)
         if (allocated(error)) return
         associate (level => newton%hierarchy%levels(1), i => more - behind, &
            j => (domain%ny - n(2))/2)
            level%pressure = 0.0_wp
            level%pressure(i:i + n(1), j:j + n(2)) = run%older
            level%rigid_displacement = run%older_h0
            call solve_point_newton(newton, longer, run%tolerance, run%max_steps, nobody)
            is_known = newton%is_converged
            if (is_known) far = summary_of_point(level, longer, run%slide_to_roll)
         end associate
      end associate
   end subroutine measure_domain

   !> Starts from the pressure of the dry contact, with the load and a film in the middle.
   subroutine start_dry(contact, level)
      type(point_contact_t), intent(in) :: contact
      type(point_level_t), intent(inout) :: level
      integer :: j

      level%pressure = 0.0_wp
      do j = 1, level%ny - 1
         level%pressure(1:level%nx - 1, j) = hertz_pressure_at(contact, level%x(1:level%nx - 1), &
            level%y(j))
      end do
      level%pressure = level%pressure*(contact%load/load_on(level, level%pressure))
      call deflect(level, level%pressure, level%film)
      level%film = level%rigid + level%film
      level%rigid_displacement = start_film*contact%expected_film - central_value(level%x, &
         level%film(:, level%ny/2))
   end subroutine start_dry

   !> Cubic interpolation of the pressure `coarse` to twice as many intervals, along x, then y.
   pure subroutine interpolate(coarse, fine)
      real(wp), intent(in) :: coarse(:, :)
      real(wp), intent(out) :: fine(:, :)
      real(wp), allocatable :: along(:, :), line(:)
      integer :: i, j

      allocate (along(size(fine, 1), size(coarse, 2)), line(size(fine, 2)))
      do j = 1, size(coarse, 2)
         call prolong_cubic(coarse(:, j), along(:, j))
      end do
      do i = 1, size(fine, 1)
         call prolong_cubic(along(i, :), line)
         fine(i, :) = line
      end do
   end subroutine interpolate

end module point_solver

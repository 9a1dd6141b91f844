!> The lubricated point contact from its data to its fields and quantities: the steady contact on
!> nested grids, from the dry contact on the first one that holds the film; and its time steps,
!> those of a line contact (modules time_march and ehl_line_transient): from the smooth steady
!> solution, whose film the surfaces enter at T = 0 without a new solve.
module point_solver
   use errors, only: error_t
   use film_breakdown, only: check_breakdown
   use iteration_report, only: phase_steady, phase_transient, report_t
   use kinds, only: exceeds, wp
   use line_contact, only: solver_settings_t, steady_tolerance, step_tolerance, time_settings_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use listener, only: listener_t, relay_t
   use lubricant, only: eased_fluid, fluid_density, thins
   use march_state, only: extrapolate, keep_solution, predictors, step_error, time_part_t, &
      turn_history
   use point_contact, only: first_intervals, hertz_pressure_at, point_contact_t, &
      set_point_moment, start_of
   use point_cycle, only: new_hierarchy
   use point_level, only: deflect, load_on, point_level_t, set_point_film, set_surfaces, turn_nodes
   use point_newton, only: point_newton_t, solve_point_newton
   use point_quantities, only: estimate_point_errors, fill_point_state, summary_of_point
   use quantities, only: central_value, h_central, h_min
   use text, only: to_text
   use time_march, only: march, marcher_t
   use transfer, only: prolong_cubic
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: interpolate, point_run_t, solve_point, solve_point_steady, tolerance_of

   !> The start lies this many times the expected film above the dry contact, which is at least so
   !> many cells wide to each side.
   real(wp), parameter :: start_film = 1.5_wp, least_cells = 2.0_wp
   !> Most Newton steps on a grid.
   integer, parameter :: most_steps = 120
   !> Stress scales, each twice the next, of a start that fails with that of the fluid.
   integer, parameter :: easings = 5

   !> How to solve a contact, and its solution with the quantities on all grids.
   type :: point_run_t
      !> `max_cycles` are Newton steps on a grid; `target`: relative error of h_central and h_min
      !> for which the grid is chosen, up to that of the contact; 0: that of the contact.
      type(solver_settings_t) :: settings = solver_settings_t(max_cycles=most_steps)
      type(time_settings_t) :: time
      integer :: threads = 1
      type(point_newton_t) :: newton
      !> Quantities on each grid, the first one the coarsest; pressure and H0 of the last but one,
      !> and of that before, if there is one.
      type(line_summary_t), allocatable :: grids(:)
      real(wp), allocatable :: coarse(:, :), older(:, :)
      real(wp) :: coarse_h0 = 0.0_wp, older_h0 = 0.0_wp
      !> Of a passage whose grid was chosen: on half the intervals, a quarter and so on.
      type(line_summary_t), allocatable :: coarser(:)
      !> Newton steps and iterations of GMRES (2, grids).
      integer, allocatable :: work(:, :)
   end type point_run_t

   !> A point contact on the finest level of a run, in time.
   type, extends(marcher_t) :: point_marcher_t
      type(point_run_t), pointer :: run => null()
      type(point_contact_t), pointer :: point => null()
   contains
      procedure :: end_step, fill, solve_part
   end type point_marcher_t

contains

   !> Solves the steady contact, smooth if it is the start of a passage, and the passage; `state` is
   !> that at the end. Not converging is in the report. Error (internal_error): LAPACK or FFTW.
   subroutine solve_point(run, contact, listener, state, report, error)
      type(point_run_t), intent(inout), target :: run
      type(point_contact_t), intent(inout), target :: contact
      class(listener_t), intent(inout), target :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(point_contact_t) :: start
      real(wp) :: before

      before = wall_seconds()
      start = contact
      if (run%time%is_transient) start = start_of(contact)
      call solve_point_steady(run, start, listener, report, error)
      if (allocated(error)) return
      contact%domain = start%domain
      start%surface_1 = contact%surface_1
      start%surface_2 = contact%surface_2
      associate (seconds => report%cost%phase_seconds)
         seconds(phase_steady) = wall_seconds() - before
         call fill_point_state(run%newton%hierarchy%levels(1), start, 0.0_wp, state)
         if (report%converged .and. run%time%is_transient) then
            before = wall_seconds()
            if (allocated(run%time%resume_from)) report = run%time%resume_from%report
            report%numbers%levels = size(run%newton%hierarchy%levels)
            call march_point()
            seconds(phase_transient) = seconds(phase_transient) + wall_seconds() - before
         else if (report%converged) then
            call check_breakdown(state%x, state%film_thickness, run%settings, 0, 0.0_wp, report, &
               state%y)
         end if
      end associate

   contains

      !> Marches from the steady solution of `run`, or from where an earlier run stopped (module
      !> time_march).
      subroutine march_point()
         type(point_marcher_t) :: self
         real(wp) :: begin

         self%run => run
         self%point => contact
         self%contact => contact
         self%settings = run%settings
         self%time = run%time
         associate (level => run%newton%hierarchy%levels(1), history => self%history)
            call listener%on_stage('steps on '//to_text(level%nx)//' x '//to_text(level%ny) &
               //' intervals')
            allocate (level%old_squeeze, mold=level%film)
            if (allocated(run%time%resume_from)) then
               history = run%time%resume_from
               history%smallest_film = minval(history%film)
               level%pressure = reshape(history%pressure(:, 1), shape(level%pressure))
               level%rigid_displacement = history%rigid_displacement(1)
               if (history%direction*level%direction < 0.0_wp) call turn_nodes(level)
            end if
            begin = history%step*run%time%time_step
            call set_point_moment(contact, begin)
            call set_surfaces(level, contact, begin)
            call set_point_film(level)
            if (history%size == 0) then
               call self%end_step(0, .false., report)
               if (.not. report%converged) return
               call remember(self, 0.0_wp)
            end if
            call self%fill(begin, state, has_stresses=.false.)
         end associate
         call march(self, listener, state, report)
      end subroutine march_point

   end subroutine solve_point

   !> Solves the contact on its grid, or on the first one for the target: `contact%domain` has it
   !> then. Not converging is in the report. Error (internal_error): LAPACK or FFTW.
   subroutine solve_point_steady(run, contact, listener, report, error)
      type(point_run_t), intent(inout) :: run
      type(point_contact_t), intent(inout) :: contact
      class(listener_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      integer :: most, nx, ny

      run%grids = [line_summary_t ::]
      run%work = reshape([integer ::], [2, 0])
      most = contact%domain%intervals
      nx = first_intervals(contact, most)
      report%method = 'newton_krylov'
      do
         ny = contact%domain%rows/(most/nx)
         call listener%on_stage(to_text(nx)//' x '//to_text(ny)//' intervals')
         call new_hierarchy(run%newton%hierarchy, contact, nx, ny, run%threads, error)
         if (allocated(error)) return
         associate (level => run%newton%hierarchy%levels(1), newton => run%newton)
            newton%is_near = size(run%grids) > 0
            if (newton%is_near) then
               level%rigid_displacement = run%coarse_h0
               call interpolate(run%coarse, level%pressure)
            else
               call start_dry(contact, level)
            end if
            call solve_point_newton(newton, contact, tolerance_of(run, steady_tolerance), &
               run%settings%max_cycles, listener, report)
            if (thins(contact%fluid) .and. .not. (report%converged .or. newton%is_near)) call &
               ease_in()
            run%work = reshape([run%work, newton%steps, newton%iterations], [2, size(run%work, 2) &
               + 1])
            report%numbers%levels = size(newton%hierarchy%levels)
            report%cost%fft_pairs = report%cost%fft_pairs + pairs_of(newton)
            if (.not. report%converged) exit
            run%grids = [run%grids, summary_of_point(level, contact)]
            if (nx == most .or. meets_target(run, contact)) exit
            if (size(run%grids) == 1) then
               run%coarse = level%pressure
               run%coarse_h0 = level%rigid_displacement
            end if
            run%older = run%coarse
            run%older_h0 = run%coarse_h0
            run%coarse = level%pressure
            run%coarse_h0 = level%rigid_displacement
            nx = 2*nx
         end associate
      end do
      if (.not. report%converged) report%reason = coarseness(contact, nx)//report%reason
      contact%domain%intervals = nx
      contact%domain%rows = ny

   contains

      !> Solves the first grid for higher stress scales that fall to that of the fluid, each from
      !> the one before: heavy contacts of an oil that thins by much.
      subroutine ease_in()
         type(point_contact_t) :: easy
         integer :: power

         easy = contact
         call start_dry(contact, run%newton%hierarchy%levels(1))
         do power = easings, 0, -1
            easy%fluid = eased_fluid(contact%fluid, 2.0_wp**power)
            call solve_point_newton(run%newton, easy, tolerance_of(run, steady_tolerance), &
               run%settings%max_cycles, listener, report)
            if (.not. report%converged) return
         end do
      end subroutine ease_in

   end subroutine solve_point_steady

   !> Beginning of the reason of a failure on `nx` intervals in x, where these are too few.
   pure function coarseness(contact, nx) result(words)
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx
      character(:), allocatable :: words
      integer :: needed

      words = ''
      needed = first_intervals(contact, 2**20)
      if (nx < needed) words = 'grid too coarse for the film, needs '//to_text(needed)// &
         ' intervals in x (has '//to_text(nx)//'); '
   end function coarseness

   !> Whether the errors of the films by the last grid are within the target.
   pure logical function meets_target(run, contact) result(is_met)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t) :: last
      integer :: n

      n = size(run%grids)
      is_met = all([run%settings%target > 0.0_wp, n > 2, .not. run%time%is_transient])
      if (.not. is_met) return
      last = run%grids(n)
      call estimate_point_errors(last, contact, run%grids(n - 1:1:-1), 0.0_wp, .false.)
      associate (of => last%of([h_min, h_central]))
         is_met = all(exceeds(run%settings%target*of%value - of%error_grid, 0.0_wp))
      end associate
   end function meets_target

   !> Bound on residual and load error: the given one, or the `usual`.
   pure real(wp) function tolerance_of(run, usual) result(tolerance)
      type(point_run_t), intent(in) :: run
      real(wp), intent(in) :: usual

      tolerance = merge(run%settings%tolerance, usual, run%settings%tolerance > 0.0_wp)
   end function tolerance_of

   !> Pairs of transforms since the levels were made, those of coarse ones by their share of nodes.
   pure integer function pairs_of(newton) result(pairs)
      type(point_newton_t), intent(in) :: newton
      real(wp) :: sum
      integer :: done(4), k

      sum = 0.0_wp
      associate (levels => newton%hierarchy%levels)
         do k = 1, size(levels)
            done = levels(k)%elastic%transforms()
            sum = sum + done(3)*real(size(levels(k)%film), wp)/size(levels(1)%film)
         end do
      end associate
      pairs = nint(sum)
   end function pairs_of

   !> Starts from the pressure of the dry contact, widened where cells are wider, with the
   !> load and a film in the middle.
   subroutine start_dry(contact, level)
      type(point_contact_t), intent(in) :: contact
      type(point_level_t), intent(inout) :: level
      real(wp) :: narrow
      integer :: j

      level%pressure = 0.0_wp
      narrow = min(1.0_wp, minval(contact%half_widths/[level%hx, level%hy]) &
         *contact%moment%load**(1.0_wp/3)/least_cells)
      do j = 1, level%ny - 1
         level%pressure(1:level%nx - 1, j) = hertz_pressure_at(contact, &
            narrow*level%x(1:level%nx - 1), narrow*level%y(j))
      end do
      level%pressure = level%pressure*(contact%load*contact%moment%load/load_on(level, &
         level%pressure))
      call deflect(level, level%pressure, level%film)
      level%film = level%rigid + level%film
      level%rigid_displacement = start_film*contact%first_film - central_value(level%x, &
         level%film(:, level%ny/2))
   end subroutine start_dry

   !> Records a film below its floor.
   subroutine end_step(self, step, is_last, report)
      class(point_marcher_t), intent(inout) :: self
      integer, intent(in) :: step
      logical, intent(in) :: is_last
      type(report_t), intent(inout) :: report

      associate (level => self%run%newton%hierarchy%levels(1))
         call check_breakdown(level%direction*level%x, reshape(level%film, [size(level%film)]), &
            self%settings, step, step*self%time%time_step, report, level%direction*level%y)
         if (is_last) call set_point_film(level)
      end associate
   end subroutine end_step

   !> Sets `state` to the present film; its stresses are those of `fill_point_state`.
   subroutine fill(self, time, state, has_stresses)
      class(point_marcher_t), intent(in) :: self
      real(wp), intent(in) :: time
      type(line_state_t), intent(inout) :: state
      logical, intent(in) :: has_stresses

      associate (unused => has_stresses)
      end associate
      call fill_point_state(self%run%newton%hierarchy%levels(1), self%point, time, state)
   end subroutine fill

   !> Solves a part of the next step: from the prediction, else from the old pressure, with a film
   !> above 0.
   subroutine solve_part(self, part, listener, error, report)
      class(point_marcher_t), intent(inout) :: self
      type(time_part_t), intent(inout) :: part
      class(listener_t), intent(inout), target :: listener
      real(wp), intent(inout) :: error
      type(report_t), intent(inout) :: report
      type(relay_t) :: relay
      real(wp), allocatable :: pressure(:)
      integer :: attempt, before, count, nodes

      relay%parent => listener
      associate (newton => self%run%newton, contact => self%point, history => self%history, &
         level => self%run%newton%hierarchy%levels(1))
         level%inverse_time_step = part%weights(1)
         call set_point_moment(contact, part%time)
         call set_surfaces(level, contact, part%time)
         if (history%direction*level%direction < 0.0_wp) call turn_history(history)
         level%old_squeeze = reshape(part%weights(2)*history%mass(:, 1) + part%weights(3) &
            *history%mass(:, 2), shape(level%film))
         allocate (pressure(size(level%film)))
         nodes = nint(part%length/level%hx)
         count = predictors(history)
         do attempt = 1, 2
            if (attempt == 2) count = 1
            call extrapolate(history, count, part%length, pressure, level%rigid_displacement)
            level%pressure = reshape(pressure, shape(level%pressure))
            if (attempt == 2) then
               call set_point_film(level)
               level%rigid_displacement = level%rigid_displacement + max(0.5_wp &
                  *history%smallest_film - minval(level%film), 0.0_wp)
            else if (count == 1 .and. min(history%size - 1, nodes) > 0) then
               ! the last change of the pressure, carried with the mean speed: what passes
               associate (change => reshape(history%pressure(:, 1) - history%pressure(:, 2), &
                  shape(level%pressure)))
                  level%pressure(nodes:, :) = max(level%pressure(nodes:, :) &
                     + change(:size(change, 1) - nodes, :), 0.0_wp)
               end associate
            end if
            before = pairs_of(newton)
            newton%is_near = .true.
            call solve_point_newton(newton, contact, tolerance_of(self%run, step_tolerance), &
               self%settings%max_cycles, relay, report)
            report%cost%fft_pairs = report%cost%fft_pairs + pairs_of(newton) - before
            if (report%converged) exit
         end do
         if (.not. report%converged) then
            report%reason = coarseness(contact, level%nx)//report%reason
            return
         end if
         call remember(self, part%length)
         if (self%time%tolerance > 0.0_wp) error = step_error(history, history%pressure(:, 1), &
            0.0_wp)
      end associate
   end subroutine solve_part

   !> Adds the present solution, at the end of a step of `length`, to the history.
   subroutine remember(self, length)
      class(point_marcher_t), intent(inout) :: self
      real(wp), intent(in) :: length
      real(wp), allocatable :: density(:), pressure(:)

      associate (level => self%run%newton%hierarchy%levels(1))
         pressure = [level%pressure]
         allocate (density, mold=pressure)
         call fluid_density(self%point%fluid, pressure, density)
         call keep_solution(self%history, length, pressure, level%rigid_displacement, density &
            *[level%film])
         self%history%direction = level%direction
         self%history%smallest_film = minval(level%film)
      end associate
   end subroutine remember

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

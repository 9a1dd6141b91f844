!> Repeats cycles until the residuals of the original problem meet their bounds, or reports why they
!> do not.
module cycle_control
   use fas_cycle, only: cycle_from, sweep_under_load
   use film_state, only: film_state_t, is_finite
   use film_temperature, only: warm_film
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_hierarchy, only: count_work, is_newton, line_hierarchy_t, method_block_jacobi, &
      method_fas
   use line_level, only: elastic_film, evaluate_deflection, largest_pressure, line_level_t, &
      load_defect
   use listener, only: is_stopped, listener_t
   use newton_line, only: solve_newton
   use reynolds_line, only: evaluate_reynolds
   use text, only: counted, to_text
   implicit none (type, external)
   private

   public :: effective_tolerance, iterate, measure_residual, residual_t

   !> The bound on the Reynolds residual is at least this many times its round-off floor.
   real(wp), parameter :: floor_factor = 5.0_wp
   !> Above this many intervals Newton's method keeps the compensation of a steady pressure: 5
   !> floors of P alone exceed the default tolerance (Case 1).
   integer, parameter :: largest_plain = 2**13
   !> Round-off of dX sum P = pi/2: smallest bound on the load error.
   real(wp), parameter :: load_floor = 1.0e-13_wp
   !> A Newton step smaller than this in every pressure and in H0 changes no residual.
   real(wp), parameter :: still_step = 1.0e-11_wp
   !> The iteration diverges if a residual grows by this factor over the first one, or if the load
   !> error reaches it (docs/decisions.md).
   real(wp), parameter :: divergence_factor = 1.0e6_wp
   !> After this many consecutive cycles beyond that factor, still rising, give up.
   integer, parameter :: lost_cycles = 5

   !> History of the larger of residual and load error.
   type :: course_t
      !> After the first cycle, after the last, the smallest, and the smallest when it last had
      !> fallen by 30 %.
      real(wp) :: first = huge(1.0_wp), last = huge(1.0_wp), best = huge(1.0_wp), &
         checkpoint = huge(1.0_wp)
      !> After the first of the cycles far beyond the start.
      real(wp) :: lost = huge(1.0_wp)
      !> Last cycle in which it fell by 30 %, and last cycle not far beyond the start.
      integer :: progress_cycle = 0, near_cycle = 0
   end type course_t

   !> Residuals of the original problem in the unit of d(rho H)/dX, see `measure_residual`.
   type :: residual_t
      !> max |r|/lambda over P > 0, max(r, 0)/lambda where P = 0; of a warm film at least the change
      !> that its viscosity still asks for.
      real(wp) :: reynolds = huge(1.0_wp)
      !> |dX sum P - pi/2|.
      real(wp) :: load = huge(1.0_wp)
      !> Round-off floor of `reynolds`, see `round_off`.
      real(wp) :: floor = 0.0_wp
      !> False if the film of the pressure closes somewhere, so that there is no residual.
      logical :: film_is_open = .false.
   end type residual_t

contains

   !> max(tolerance, 5 x round-off floor).
   pure real(wp) function effective_tolerance(tolerance, residual) result(bound)
      real(wp), intent(in) :: tolerance
      type(residual_t), intent(in) :: residual

      bound = max(tolerance, floor_factor*residual%floor)
   end function effective_tolerance

   !> Makes cycles on the finest level by the relaxation of the hierarchy; the film must be that of
   !> the pressure and of H0. The report receives every cycle, `converged` and `reason`; `listener`,
   !> if present, receives each cycle.
   subroutine iterate(hierarchy, report, listener)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(report_t), intent(inout) :: report
      class(listener_t), intent(inout), optional :: listener
      type(residual_t) :: residual
      type(film_state_t) :: before
      type(course_t) :: course
      real(wp) :: change
      integer :: cycle

      report%converged = .false.
      associate (level => hierarchy%levels(hierarchy%finest), choice => hierarchy%relaxation)
         if (is_newton(choice) .and. level%n > largest_plain &
            .and. .not. level%inverse_time_step > 0.0_wp) then
            allocate (level%state%compensation(0:level%n), source=0.0_wp)
         end if
         report%reason = ''
         hierarchy%goal = choice%tolerance
         hierarchy%newton%active = count(level%state%pressure > 0.0_wp)
         hierarchy%newton%creeping = 0   ! a resumed run starts so too
         do cycle = 1, choice%max_cycles
            before = level%state
            call advance(hierarchy)
            call warm_film(level, change)
            call measure_residual(level, is_newton(choice), residual)
            residual%reynolds = max(residual%reynolds, change)
            call count_work(hierarchy, hierarchy%finest, 1)
            call report%add(residual%reynolds, residual%load)
            report%tolerance_effective = effective_tolerance(choice%tolerance, residual)
            hierarchy%goal = report%tolerance_effective
            if (present(listener)) call listener%on_stage('cycle', cycle, &
               [residual%reynolds, residual%load])
            call follow(course, cycle, residual)
            report%converged = residual%film_is_open &
               .and. residual%reynolds <= report%tolerance_effective &
               .and. residual%load <= max(choice%tolerance, load_floor)
            if (report%converged) exit
            call find_obstacle(hierarchy, before, residual, course, cycle, report%reason)
            if (is_stopped(listener)) report%reason = 'stopped from outside'
            if (len(report%reason) > 0) exit
         end do
         if (report%converged) then
            report%reason = 'converged'
         else if (len(report%reason) == 0) then
            report%reason = 'cycle limit: '//counted(choice%max_cycles, 'cycle')// &
               ' left the residual at '//to_text(course%last, 2)
         end if
         if (allocated(level%state%compensation)) deallocate (level%state%compensation)
      end associate
   end subroutine iterate

   !> Reason to stop after `cycle`; empty if cycles continue. A state that is not finite is replaced
   !> by the one before. Newton steps at round-off show that no step will help: at nodes near the
   !> exit the linear system and the conditions P >= 0, r <= 0 disagree.
   subroutine find_obstacle(hierarchy, before, residual, course, cycle, reason)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(film_state_t), intent(in) :: before
      type(residual_t), intent(in) :: residual
      type(course_t), intent(in) :: course
      integer, intent(in) :: cycle
      character(:), allocatable, intent(out) :: reason
      logical :: is_still

      reason = ''
      associate (level => hierarchy%levels(hierarchy%finest), choice => hierarchy%relaxation)
         if (.not. is_finite(level%state)) then
            level%state = before
            reason = 'divergence: pressure, film or rigid displacement '// &
               'outgrew all numbers; the state before is kept'
         end if
         if (cycle - course%near_cycle >= lost_cycles .and. course%last >= course%lost) reason = &
            'divergence: the residual has grown to '//to_text(course%last, 2)
         is_still = is_newton(choice) .and. hierarchy%newton%last_step < still_step
         if (len(reason) > 0 .or. cycle - course%progress_cycle < merge(2, choice%patience, &
            is_still)) return
         if (.not. residual%film_is_open) then
            reason = 'film closed: the film of the pressure is negative and stays so for ' &
               //to_text(choice%patience)//' cycles'
         else if (course%last/divergence_factor > course%first) then
            reason = 'divergence: the residual has grown to '//to_text(course%last, 2)
         else if (is_still) then
            reason = 'stagnation: Newton steps at round-off leave the residual at ' &
               //to_text(course%best, 2)
         else
            reason = 'stagnation: '//to_text(choice%patience)//' cycles left the residual at ' &
               //to_text(course%best, 2)
         end if
      end associate
   end subroutine find_obstacle

   !> Makes one cycle of the present method on the finest level: a FAS cycle, a block of
   !> Block-Jacobi sweeps, or a Newton step.
   subroutine advance(hierarchy)
      type(line_hierarchy_t), intent(inout) :: hierarchy

      associate (level => hierarchy%levels(hierarchy%finest), method => hierarchy%relaxation%method)
         if (method == method_fas) then
            call cycle_from(hierarchy, hierarchy%finest)
         else if (maxval(level%state%pressure) < largest_pressure) then
            if (method == method_block_jacobi) then
               call sweep_under_load(hierarchy, hierarchy%finest)
            else
               call solve_newton(hierarchy%newton, level, still_step, max_steps=1, &
                  goal=hierarchy%goal, film_is_exact=.true.)
            end if
         end if
      end associate
   end subroutine advance

   !> Adds the residuals after `cycle` to the history.
   pure subroutine follow(course, cycle, residual)
      type(course_t), intent(inout) :: course
      integer, intent(in) :: cycle
      type(residual_t), intent(in) :: residual
      logical :: is_far

      course%last = max(residual%reynolds, residual%load)
      if (cycle == 1) course%first = course%last
      course%best = min(course%best, course%last)
      if (course%best < 0.7_wp*course%checkpoint) then
         course%checkpoint = course%best
         course%progress_cycle = cycle
      end if
      is_far = course%last/divergence_factor > course%first .or. residual%load > divergence_factor
      if (.not. (is_far .and. residual%film_is_open)) course%near_cycle = cycle
      if (cycle == course%near_cycle + 1) course%lost = course%last
   end subroutine follow

   !> Computes the residuals with the film that belongs exactly to the pressure. The level's film
   !> becomes that film unless it closes; with `film_is_exact` it already is.
   subroutine measure_residual(level, film_is_exact, residual)
      type(line_level_t), intent(inout) :: level
      logical, intent(in) :: film_is_exact
      type(residual_t), intent(out) :: residual

      level%work%nodes = level%state%film
      if (.not. film_is_exact) then
         call evaluate_deflection(level)
         level%work%nodes = elastic_film(level)
      end if
      residual%load = abs(load_defect(level))
      residual%film_is_open = all(level%work%nodes > 0.0_wp)
      if (.not. residual%film_is_open) return
      level%state%film = level%work%nodes
      call evaluate_reynolds(level)
      level%work%nodes = (level%operator - level%rhs_reynolds)/level%lambda
      level%work%nodes(0) = 0.0_wp
      level%work%nodes(level%n) = 0.0_wp
      residual%reynolds = maxval(merge(abs(level%work%nodes), max(level%work%nodes, 0.0_wp), &
         level%state%pressure > 0.0_wp))
      if (allocated(level%rough)) residual%reynolds = max(residual%reynolds, &
         maxval(abs(level%state%asperity_pressure - level%rough%pressure)))
      residual%floor = round_off(level)
   end subroutine measure_residual

   !> Round-off of |r|/lambda: 4e-16 ( max(e P)/(lambda dX^2) + max(H)/dT ), by P and H in their
   !> differences; with the compensation of P, 1e-15 ( max(H) + max|K P|/pi )/dX, by the mass flux:
   !> by e, H and the terms of H.
   pure real(wp) function round_off(level) result(floor)
      type(line_level_t), intent(in) :: level
      real(wp) :: p(0:level%n)

      if (allocated(level%state%compensation)) then
         floor = 1.0e-15_wp*(maxval(level%state%film) + maxval(abs(level%elastic%deflection))) &
            /level%dx
      else
         p = level%state%pressure
         ! where asperities touch the oil has the difference of their law, at a separation of
         ! rounded deflections, from the total
         if (allocated(level%rough)) p = p + level%state%asperity_pressure &
            + abs(level%rough%slope)*maxval(abs(level%elastic%deflection))
         floor = 4.0e-16_wp*(maxval(level%oil%face_mobility*max(p(1:), p(:level%n - 1))) &
            /(level%lambda*level%dx**2) + maxval(level%state%film)*level%inverse_time_step)
      end if
   end function round_off

end module cycle_control

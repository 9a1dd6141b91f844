!> First approximations: nested exact solutions and full multigrid, the Hertz pressure, or the
!> solution on a graded grid; of a contact whose asperities touch, from the speed at which the film
!> clears them, down to its own.
module nested_start
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use contact_moment, only: clearing_film, film_estimate, film_with_viscosity, own_contact, &
      width_of
   use fas_cycle, only: cycle_from
   use film_state, only: film_state_t
   use film_temperature, only: solve_warm
   use graded_nodes, only: monotone_cubic
   use graded_solver, only: graded_solution_t, solve_graded
   use hertz, only: line_pressure
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: coarsest_for_film, count_work, line_hierarchy_t
   use line_level, only: carried_load, contact_load, elastic_film, evaluate_deflection, &
      line_level_t, set_film, share_pressure, thin_oil
   use listener, only: is_stopped, listener_t, relay_t
   use lubricant, only: faster_fluid, thins, wall_stress
   use newton_line, only: solve_newton, step_tolerance
   use newton_work, only: newton_t
   use quantities, only: exit_between_nodes
   use reynolds_line, only: evaluate_coefficients, mass_flux
   use transfer, only: prolong_cubic
   implicit none (type, external)
   private

   public :: bump_start, full_multigrid_start, graded_start

   !> Power of the speed with which films grow, and a factor beside it; the first film over its
   !> estimate; a film that grows by less than the last factor grows no more.
   real(wp), parameter :: growth = 0.7_wp, slack = 1.01_wp, first_share = 2.0_wp, &
      least_gain = 1.1_wp
   !> Most steps for a first solution and for a further one; steps of an easy one. Where less oil
   !> arrives, its front moves by about a node a step, by up to one of so many of the nodes.
   integer, parameter :: first_steps = 60, next_steps = 25, easy_steps = 8, front_share = 4
   !> Speeds to start from, at most; factor from speed to speed: first, and from supply to supply,
   !> largest, smallest.
   integer, parameter :: most_starts = 5
   real(wp), parameter :: first_ratio = 4.0_wp, supply_ratio = 1.25_wp, largest_ratio = 100.0_wp, &
      smallest_ratio = 1.02_wp
   !> Accuracy of the solutions.
   real(wp), parameter :: tolerance = 1.0e-3_wp

   !> Accuracy and most steps of the exact solutions below the coarsest grid of the cycles.
   real(wp), parameter :: nested_tolerance = 1.0e-2_wp
   integer, parameter :: nested_steps = 60, starved_steps = 400
   !> Accuracy of a level that is compared with finer ones (docs/decisions.md).
   real(wp), parameter :: coarse_run_tolerance = 1.0e-3_wp
   !> Accuracy of a graded solution to start from.
   real(wp), parameter :: graded_target = 0.1_wp
   !> Most first grids to try.
   integer, parameter :: max_firsts = 4
   !> Bound on Sigma in the start of a level, and most smoothings to reach it.
   real(wp), parameter :: largest_sigma = 10.0_wp
   integer, parameter :: max_smoothings = 30
   !> Above this film [b^2/R] the pressure is far from Hertzian and the start is a wide bump.
   real(wp), parameter :: thick_film = 0.5_wp

contains

   !> Solves a level: from a bump at the speed that clears the asperities down to its own, flooded,
   !> and then from what flows there down to what arrives.
   subroutine reach_speed(newton, level, contact, is_solved, listener)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(inout) :: level
      type(line_contact_t), intent(in) :: contact
      logical, intent(out) :: is_solved
      class(listener_t), intent(inout), optional :: listener
      type(film_state_t) :: good
      real(wp) :: factor, film, last
      integer :: start

      factor = 1.0_wp
      last = 0.0_wp
      do
         film = film_with_viscosity(contact, factor)
         ! that of a heavily sheared oil hardly grows: asperities touch at any speed
         if (film >= clearing_film(contact) .or. film < least_gain*last) exit
         factor = factor*(clearing_film(contact)/film)**(1/growth)*slack
         last = film
      end do
      level%oil%supply = huge(1.0_wp)
      do start = 1, most_starts
         call bump_start(level, film_with_viscosity(contact, factor), first_share)
         call solve_at(factor, .false., first_steps)
         if (is_solved .or. is_stopped(listener)) exit
         factor = 2*factor
      end do
      if (is_solved) call descend(factor, .false.)
      if (is_solved .and. contact%supply < huge(1.0_wp)) then
         associate (flux => mass_flux(level))
            call descend(maxval(flux)/(level%entrainment*contact%supply), .true.)
         end associate
      end if
      level%oil%supply = contact%supply

   contains

      !> Solves with so many times the speed, or with the supply where it `is_supply`.
      subroutine solve_at(factor, is_supply, steps)
         real(wp), intent(in) :: factor
         logical, intent(in) :: is_supply
         integer, intent(in) :: steps

         if (is_supply) then
            level%oil%supply = factor*contact%supply
         else
            level%lambda = factor*contact%lambda
            level%fluid = faster_fluid(contact%fluid, factor)
         end if
         call solve_newton(newton, level, tolerance, steps, listener)
         is_solved = newton%is_converged
      end subroutine solve_at

      !> Goes from the solution with a factor above 1 to that with 1.
      subroutine descend(first, is_supply)
         real(wp), intent(in) :: first
         logical, intent(in) :: is_supply
         real(wp) :: reached, ratio, next
         integer :: steps

         reached = first
         steps = merge(max(next_steps, level%n/front_share), next_steps, is_supply)
         ratio = merge(supply_ratio, first_ratio, is_supply)
         do while (reached > 1.0_wp)
            good = level%state
            next = max(1.0_wp, reached/ratio)
            call solve_at(next, is_supply, steps)
            if (is_stopped(listener)) exit
            if (is_solved) then
               reached = next
               if (newton%steps < easy_steps) ratio = min(2*ratio, largest_ratio)
            else
               level%state = good
               ratio = sqrt(ratio)
               if (ratio < smallest_ratio) exit
            end if
         end do
      end subroutine descend

   end subroutine reach_speed

   !> Solves exactly from the coarsest grid that carries a film (level 1 unless the user's number of
   !> levels makes that one coarser) up to the coarsest of the cycles, then interpolates cubically
   !> and makes one cycle on each finer level; the finest keeps the interpolated pressure. If the
   !> first grid has no solution, the next finer ones are tried. `is_sound` is false if that fails
   !> too, or `listener` asks to stop.
   subroutine full_multigrid_start(hierarchy, contact, is_sound, listener)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      logical, intent(out) :: is_sound
      class(listener_t), intent(inout), optional :: listener
      integer :: finest, first, k, last

      first = 1
      do while (first < hierarchy%coarsest &
         .and. hierarchy%levels(first)%n < coarsest_for_film(contact))
         first = first + 1
      end do
      last = min(first + max_firsts - 1, hierarchy%coarsest)
      do k = first, last
         call nested_solutions(hierarchy, contact, k, is_sound, listener)
         if (is_sound) exit
         if (is_stopped(listener)) return
      end do
      if (.not. is_sound) return
      finest = hierarchy%finest
      do k = hierarchy%coarsest + 1, finest
         call refine(hierarchy, k)
         if (k == finest) exit
         is_sound = .not. is_stopped(listener)
         if (.not. is_sound) return
         hierarchy%finest = k
         call cycle_from(hierarchy, k)
         hierarchy%finest = finest
      end do
   end subroutine full_multigrid_start

   !> Solves exactly on the levels from `first` to the coarsest of the cycles; if that is the finest
   !> level, it keeps the interpolated pressure.
   subroutine nested_solutions(hierarchy, contact, first, is_sound, listener)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: first
      logical, intent(out) :: is_sound
      class(listener_t), intent(inout), optional :: listener
      real(wp) :: tolerance
      integer :: k

      is_sound = .true.
      do k = first, hierarchy%coarsest
         if (k > first) then
            call refine(hierarchy, k)
         else if (allocated(contact%asperities)) then
            call reach_speed(hierarchy%newton, hierarchy%levels(k), contact, is_sound, listener)
            if (.not. is_sound) return
         else
            call bump_start(hierarchy%levels(k), film_estimate(contact), &
               hierarchy%relaxation%start_film)
         end if
         if (k == size(hierarchy%levels)) return
         tolerance = step_tolerance(hierarchy%levels(k), merge(coarse_run_tolerance, &
            nested_tolerance, hierarchy%wants_coarse_runs .and. k >= size(hierarchy%levels) - 2))
         call solve_level()
         if (.not. is_sound) return
      end do

   contains

      !> Solves level k exactly from its present pressure; a coarse run by the space scheme of the
      !> hierarchy: first upwind2, then kappa from its solution. If kappa fails, the upwind2
      !> solution stays, which is no coarse run.
      subroutine solve_level()
         type(film_state_t) :: thesis
         integer :: steps

         associate (level => hierarchy%levels(k), is_solved => hierarchy%newton%is_converged)
            level%is_kappa = .false.
            steps = merge(starved_steps, nested_steps, allocated(level%oil%saturation))
            call solve_warm(hierarchy%newton, level, tolerance, steps, listener)
            is_sound = is_solved
            level%is_coarse_run = is_sound .and. tolerance <= coarse_run_tolerance
            if (level%is_coarse_run .and. hierarchy%is_kappa) then
               thesis = level%state
               level%is_kappa = .true.
               call solve_warm(hierarchy%newton, level, tolerance, steps, listener)
               level%is_kappa = is_solved
               level%is_coarse_run = is_solved
               if (.not. is_solved) level%state = thesis
            end if
            if (level%is_coarse_run) call evaluate_coefficients(level)
         end associate
      end subroutine solve_level

   end subroutine nested_solutions

   !> Interpolates the solution of a graded grid to the finest level. `is_sound` is false if there
   !> is none, or `listener` asks to stop.
   subroutine graded_start(hierarchy, contact, is_sound, listener)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      logical, intent(out) :: is_sound
      class(listener_t), intent(inout), target :: listener
      type(graded_solution_t) :: solution
      type(line_contact_t) :: posed
      type(relay_t) :: relay
      type(report_t) :: report
      real(wp) :: scale

      relay%parent => listener
      associate (level => hierarchy%levels(hierarchy%finest))
         posed = contact
         if (allocated(contact%duty)) posed = own_contact(contact, 0.0_wp, level%entrainment)
         scale = width_of(level%moment)
         call solve_graded(posed, [level%x(0), level%x(level%n)]/scale, graded_target, relay, &
            solution, report)
         is_sound = allocated(solution%line)
         if (.not. is_sound) return
         level%state%pressure(1:level%n - 1) = monotone_cubic(solution%line%x, &
            solution%line%state%pressure, level%x(1:level%n - 1)/scale)
         level%state%pressure(level%n) = 0.0_wp
         ! from its own to reference units; H0 holds the part of ln|X - X'| that that of X changes
         level%state%pressure = level%state%pressure*sqrt(level%moment%load/level%moment%radius)
         level%state%rigid_displacement = level%moment%load &
            *(solution%line%state%rigid_displacement + 0.5_wp*log(scale))
         call set_smooth_film(level)
      end associate
   end subroutine graded_start

   !> Interpolates the pressure of level k cubically from level k - 1, and computes its film.
   subroutine refine(hierarchy, k)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k

      associate (level => hierarchy%levels(k), coarse => hierarchy%levels(k - 1))
         level%state%rigid_displacement = coarse%state%rigid_displacement
         call prolong_cubic(coarse%state%pressure, level%state%pressure)
         if (allocated(level%heat)) then
            call prolong_cubic(coarse%heat%rise(:, 1), level%heat%rise(:, 1))
            call thin_oil(level)
         end if
         if (allocated(level%rough)) then
            call prolong_cubic(coarse%state%asperity_pressure, level%state%asperity_pressure)
            call set_film(level)
         else
            call place_exit(coarse, level)
            call set_smooth_film(level)
         end if
      end associate
      call count_work(hierarchy, k, 1)
   end subroutine refine

   !> Computes the film of an interpolated pressure.
   !>
   !> A zigzag of the coarse pressure is invisible to its central slopes but not to those of the
   !> fine grid, where the slip factor would start at exp(100): the pressure of a shear-thinning
   !> fluid is smoothed until no wall stress exceeds `largest_sigma`.
   subroutine set_smooth_film(level)
      type(line_level_t), intent(inout) :: level
      integer :: pass

      do pass = 0, max_smoothings
         call set_film(level)
         if (.not. thins(level%fluid)) exit
         if (wall_stress(level%fluid, maxval(abs(level%state%film(1:level%n - 1) &
            *(level%state%pressure(2:) - level%state%pressure(:level%n - 2)))))/(2*level%dx) &
            < largest_sigma) exit
         level%state%pressure(1:level%n - 1) = 0.25_wp*(level%state%pressure(:level%n - 2) &
            + 2*level%state%pressure(1:level%n - 1) + level%state%pressure(2:))
      end do
   end subroutine set_smooth_film

   !> Interpolates the pressure near the exit: its square root is nearly linear there (module
   !> quantities), and Newton's method moves the exit by only one node a step, so that it must start
   !> within one.
   pure subroutine place_exit(coarse, fine)
      type(line_level_t), intent(in) :: coarse
      type(line_level_t), intent(inout) :: fine
      real(wp) :: exit, slope
      integer :: i, last

      exit = exit_between_nodes(coarse%x, coarse%state%pressure)
      last = findloc(coarse%state%pressure > 0.0_wp, .true., 1, back=.true.) - 1
      if (last < 1 .or. .not. ieee_is_finite(exit)) return
      if (exit <= coarse%x(last)) return
      fine%state%pressure(2*last - 1) = 0.25_wp*(sqrt(coarse%state%pressure(last - 1)) &
         + sqrt(coarse%state%pressure(last)))**2
      slope = sqrt(coarse%state%pressure(last))/(exit - coarse%x(last))
      do i = 2*last + 1, min(2*last + 4, fine%n - 1)
         fine%state%pressure(i) = (slope*max(exit - fine%x(i), 0.0_wp))**2
      end do
   end subroutine place_exit

   !> Starts from the Hertz pressure, or for a thick `film` H_c a bump of the width S = sqrt(2 H_c)
   !> of the pressure build-up, scaled to the load, which acts on the node next to X = 0 if no node
   !> lies under the bump; H0 so that H(0) is a `share` of the film.
   subroutine bump_start(level, film, share)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: film, share
      real(wp) :: width
      integer :: centre

      width = sqrt(2*film)
      if (allocated(level%rough)) level%state%asperity_pressure = 0.0_wp
      associate (n => level%n, x => level%x(1:), p => level%state%pressure(1:))
         if (film > thick_film) then
            p = merge(1/(1 + ((x + 0.5_wp*width)/width)**2)**2, 0.0_wp, x < width)
         else
            p = line_pressure(x)
         end if
         p(n) = 0.0_wp
         centre = minloc(abs(x(:n - 1)), 1)
         if (.not. any(p > 0.0_wp)) p(centre) = 1.0_wp
         p = p*contact_load/carried_load(level)
      end associate
      level%state%rigid_displacement = 0.0_wp
      call evaluate_deflection(level)
      associate (h => elastic_film(level))
         level%state%rigid_displacement = share*film - h(centre + 1)   ! h(1) is that of node 0
         level%state%film = h + level%state%rigid_displacement
      end associate
      if (allocated(level%rough)) call share_pressure(level)
   end subroutine bump_start

end module nested_start

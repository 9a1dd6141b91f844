!> The steady line contact on a grid that follows its film: Newton's method on one grid after the
!> other, each with those elements halved whose part in the error of a quantity is too large, until
!> the bounds of all errors (module graded_errors) meet their goals.
!>
!> A Newtonian oil starts from Hertz's pressure, a shear-thinning one at 1024 times its stress,
!> which then falls. A spike of the pressure may have no bound but the model's; then the largest
!> pressure is not known, and elements behind X = 0 are not halved any more.
module graded_solver
   use, intrinsic :: ieee_arithmetic, only: ieee_get_halting_mode, ieee_set_halting_mode, &
      ieee_usual
   use contact_moment, only: newtonian_film
   use graded_errors, only: estimate_errors, find_flank, hidden_spike, share_doubt
   use graded_line, only: graded_line_t, new_graded_line, set_pressure
   use graded_newton, only: solve_graded_newton
   use graded_nodes, only: first_nodes, monotone_cubic, refined_nodes
   use graded_quantities, only: functional_count, rolling_power, sliding, spike, top
   use graded_system, only: graded_factors_t
   use iteration_report, only: report_t
   use kinds, only: not_known, pi, wp
   use line_contact, only: finest_wave, line_contact_t, min_in_wave, without_surfaces
   use listener, only: is_stopped, listener_t
   use lubricant, only: eased_fluid, fluid_t, thins
   use text, only: to_text
   implicit none (type, external)
   private

   public :: graded_solution_t, solve_graded

   !> Accuracy of the grids on the way and of the last; errors with which they are good enough to go
   !> on, or to end.
   real(wp), parameter :: way_tolerance = 1.0e-3_wp, way_bound = 3.0e-2_wp, &
      end_tolerance = 1.0e-9_wp
   real(wp), parameter, public :: end_bound = 1.0e-6_wp
   !> Most Newton steps of the first grid, of one on the way, of the last or with the safe scheme.
   integer, parameter :: first_steps = 30, way_steps = 15, end_steps = 40
   !> Most grids, nodes, and failures before a spike counts as unbounded.
   integer, parameter :: max_rounds = 30, max_nodes = 30000, max_failures = 3
   !> Least spacing over the smallest film; growth of the largest pressure behind which its spike
   !> counts as unbounded.
   real(wp), parameter :: least_spacing = 5.0e-4_wp, unbounded_growth = 3.0_wp
   !> Largest bound of the relative error of a spike that is not resolved any further.
   real(wp), parameter :: widest_bar = 0.1_wp
   !> A spike below the crest needs to be known to this share of its distance from it.
   real(wp), parameter :: spike_share = 0.3_wp
   !> First factor of the stress of a shear-thinning oil, and by what it is divided; a ratio below
   !> the third gives up. A new first grid where the film has fallen to the last.
   real(wp), parameter :: first_ease = 1024.0_wp, ease_ratio = 4.0_wp, least_ratio = 1.05_wp, &
      fallen_film = 0.7_wp
   !> Refinements of the first grid that are tried one after the other.
   real(wp), parameter :: first_factors(4) = [1.0_wp, 0.5_wp, 2.0_wp, 0.25_wp]

   !> Where a grid starts from: an earlier solution.
   type :: start_t
      real(wp), allocatable :: x(:), pressure(:)
      real(wp) :: rigid_displacement = 0.0_wp
   end type start_t

   !> A solution, or how far it got.
   type :: graded_solution_t
      type(graded_line_t), allocatable :: line
      !> Quantities (module graded_quantities) and bounds of their errors.
      real(wp) :: values(functional_count) = 0.0_wp, bounds(functional_count) = 0.0_wp
      !> A spike is not resolved any further; it has no bound, the largest pressure is not known.
      logical :: is_limited = .false., is_lost = .false.
   end type graded_solution_t

   !> What goes from grid to grid.
   type :: rounds_t
      type(graded_factors_t) :: factors
      !> Solutions of the last grids, to go back to.
      type(start_t), allocatable :: earlier(:)
      !> Largest pressure of the first grid; least spacings in front of X = 0 and behind it.
      real(wp) :: first_top = 0.0_wp, least_front = 0.0_wp, least_behind = 0.0_wp
      integer :: failures = 0
      !> Accuracy of the present grid, and most Newton steps.
      real(wp) :: tolerance = way_tolerance
      integer :: max_steps = first_steps
      !> The safe scheme is kept; the present grid is the last.
      logical :: is_safe = .false., is_done = .false.
   end type rounds_t

contains

   !> Solves a contact between the `ends` X until all errors are below `target`, relative to their
   !> quantities. The line is not allocated if there is no solution, and its error above
   !> `end_bound` if it is not solved.
   subroutine solve_graded(contact, ends, target, listener, solution, report)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: ends(2), target
      class(listener_t), intent(inout) :: listener
      type(graded_solution_t), intent(out) :: solution
      type(report_t), intent(inout) :: report
      logical :: halts(size(ieee_usual))

      ! a trial may overflow, and what is not known is NaN: checked builds must go on
      call ieee_get_halting_mode(ieee_usual, halts)
      call ieee_set_halting_mode(ieee_usual, .false.)
      call solve_rounds()
      call ieee_set_halting_mode(ieee_usual, halts)

   contains

      !> The same, grid by grid.
      subroutine solve_rounds()
         type(rounds_t) :: rounds
         real(wp), allocatable :: x(:)
         integer :: grid
         logical :: is_sound, was_done

         report%converged = .false.
         report%reason = 'no first grid has a solution, or the waves need more than '// &
            to_text(max_nodes)//' nodes'
         call solve_first(contact, ends, rounds, solution)
         if (.not. allocated(solution%line)) return
         rounds%first_top = maxval(solution%line%state%pressure)
         rounds%least_front = least_spacing*contact%slope*minval(solution%line%state%film)
         rounds%least_behind = rounds%least_front
         allocate (rounds%earlier(0))
         do grid = 1, max_rounds + max_failures + 1
            was_done = rounds%is_done
            call assess(contact, target, rounds, solution, x)
            call report%add(solution%line%error, abs(solution%line%load_defect))
            report%converged = was_done .and. solution%line%error < end_bound
            report%reason = 'converged'
            if (report%converged .and. (rounds%is_done .or. grid > max_rounds)) return
            report%converged = .false.
            report%reason = 'not solved on '//to_text(max_rounds)//' grids'
            if (listener%is_stopping) report%reason = 'stopped from outside'
            if (grid > max_rounds + max_failures .or. is_stopped(listener)) return
            if (grid >= max_rounds .or. size(x) > max_nodes) then   ! solved well, at least
               x = solution%line%x(:)
               rounds%is_done = .true.
            end if
            call listener%on_stage(to_text(size(x))//' nodes, grid', report%cycles, &
               [report%residual, report%load_error])
            call advance(contact, x, rounds, solution, is_sound)
            if (.not. is_sound) then
               report%reason = "Newton's method fails on "//to_text(size(x))//' nodes'
               deallocate (solution%line)
               return
            end if
         end do
      end subroutine solve_rounds

   end subroutine solve_graded

   !> Evaluates quantities and bounds of their errors, and the nodes `x` of the next grid.
   subroutine assess(contact, target, rounds, solution, x)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: target
      type(rounds_t), intent(inout) :: rounds
      type(graded_solution_t), intent(inout) :: solution
      real(wp), allocatable, intent(out) :: x(:)
      real(wp), allocatable :: shares(:, :)
      real(wp) :: goals(functional_count)
      logical :: counts(functional_count), is_marked(solution%line%n)
      integer :: j

      associate (line => solution%line, values => solution%values, bounds => solution%bounds)
         call estimate_errors(line, contact%slide_to_roll, rounds%factors, values, shares)
         bounds = share_doubt*sum(abs(shares), 1) + 2*abs(sum(shares, 1))
         goals = target*abs(values)
         goals(spike) = max(target*values(top), spike_share*(values(top) - values(spike)))
         if (.not. solution%is_limited) call judge_spike(bounds(top) > goals(top), rounds, solution)
         counts = abs(values) > 0.0_wp   ! known
         counts(rolling_power) = .false.   ! a spike holds most of it
         if (solution%is_lost .or. rounds%failures >= max_failures) counts([top, spike]) = .false.
         if (solution%is_limited .and. .not. thins(line%fluid)) counts(sliding) = .false.
         is_marked = hidden_spike(line) .and. .not. solution%is_limited
         rounds%is_done = all(bounds < goals .or. .not. counts) .and. .not. any(is_marked)
         do j = 1, functional_count
            shares(:, j) = merge(abs(shares(:, j))/sum(abs(shares(:, j)))*bounds(j)/goals(j), &
               0.0_wp, counts(j))
         end do
         if (.not. rounds%is_done) call refined_nodes(line%x, shares, is_marked, &
            merge(rounds%least_behind, rounds%least_front, line%x(1:) > 0.0_wp), x, rounds%is_done)
         if (rounds%is_done) x = line%x(:)
         call bound_top(solution)
      end associate
   end subroutine assess

   !> Ends the resolution of a spike that has grown by far, or whose top is resolved to the least
   !> spacing while the error of the largest pressure `is_large`.
   pure subroutine judge_spike(is_large, rounds, solution)
      logical, intent(in) :: is_large
      type(rounds_t), intent(inout) :: rounds
      type(graded_solution_t), intent(inout) :: solution
      logical :: is_at_end
      integer :: finest

      associate (line => solution%line, least => rounds%least_behind)
         finest = minloc(line%spacing, 1)
         is_at_end = is_large .and. line%spacing(finest) < 2*least .and. abs(line%x(finest) &
            - line%x(maxloc(line%state%pressure, 1) - 1)) < 50*least
         solution%is_lost = maxval(line%state%pressure) > unbounded_growth*rounds%first_top
         if (solution%is_lost .or. is_at_end) call limit(rounds, solution)
      end associate
   end subroutine judge_spike

   !> Bounds that a spike decides: the largest pressure, which it might pass, is not known if it is
   !> lost or bounded badly, nor is friction if its flank is not resolved.
   pure subroutine bound_top(solution)
      type(graded_solution_t), intent(inout) :: solution
      integer :: first, last, summit

      associate (values => solution%values, bounds => solution%bounds)
         if (values(spike) > 0.0_wp) bounds(top) = max(bounds(top), values(spike) + bounds(spike) &
            - values(top))
         if (.not. solution%is_limited) return
         bounds([top, spike]) = merge(bounds([top, spike]), not_known(), bounds(top) &
            < merge(0.0_wp, widest_bar, solution%is_lost)*values(top))
         call find_flank(solution%line, first, summit, last)
         if (first > 0) bounds(sliding) = not_known()
      end associate
   end subroutine bound_top

   !> Ends the halving of elements behind X = 0.
   pure subroutine limit(rounds, solution)
      type(rounds_t), intent(inout) :: rounds
      type(graded_solution_t), intent(inout) :: solution

      solution%is_limited = .true.
      rounds%least_behind = max(rounds%least_behind, 0.9_wp*minval(solution%line%spacing))
   end subroutine limit

   !> Solves on the nodes `x` from the present solution. Where Newton's method fails: on the same
   !> nodes with the safe scheme, which then stays; the third time, or if that fails too, a spike
   !> is not resolved any further, and the grid goes back to an earlier one.
   subroutine advance(contact, x, rounds, solution, is_sound)
      type(line_contact_t), intent(in) :: contact
      real(wp), allocatable, intent(inout) :: x(:)
      type(rounds_t), intent(inout) :: rounds
      type(graded_solution_t), intent(inout) :: solution
      logical, intent(out) :: is_sound
      type(graded_line_t), allocatable :: line
      type(start_t) :: start
      real(wp) :: bound
      integer :: kept

      start = start_of(solution%line)
      if (rounds%is_done .and. size(x) == size(start%x)) then   ! on the same grid
         call solve_graded_newton(solution%line, end_tolerance, end_steps, rounds%factors, kept, &
            is_sound)
         if (is_sound .and. solution%line%error < end_bound) return
      end if
      do
         bound = merge(end_bound, way_bound, rounds%is_done)
         rounds%tolerance = merge(end_tolerance, way_tolerance, rounds%is_done)
         rounds%max_steps = merge(end_steps, way_steps, rounds%is_done)
         call solve_from(contact, contact%fluid, x, start, rounds, line)
         is_sound = line%error < bound
         if (is_sound) exit
         rounds%failures = rounds%failures + 1
         rounds%is_done = .false.
         rounds%is_safe = .true.
         rounds%tolerance = way_tolerance
         rounds%max_steps = end_steps
         call solve_from(contact, contact%fluid, x, start, rounds, line)
         is_sound = line%error < way_bound
         if (is_sound .and. rounds%failures < max_failures) exit
         call limit(rounds, solution)
         if (is_sound) exit
         kept = size(rounds%earlier)
         if (kept == 0) return
         start = rounds%earlier(kept)
         rounds%earlier = rounds%earlier(:kept - 1)
         x = start%x
         rounds%least_behind = max(rounds%least_behind, 0.9_wp*minval(x(2:) - x(:size(x) - 1)))
      end do
      rounds%earlier = [rounds%earlier(max(1, size(rounds%earlier) - max_failures + 1):), start]
      call move_alloc(line, solution%line)
   end subroutine advance

   !> State of a line to start from.
   pure function start_of(line) result(start)
      type(graded_line_t), intent(in) :: line
      type(start_t) :: start

      start%x = line%x(:)   ! from 1, as the nodes of a grid to come
      start%pressure = line%state%pressure(:)
      start%rigid_displacement = line%state%rigid_displacement
   end function start_of

   !> Solves a contact with the oil `fluid` on nodes `x` from a `start`.
   subroutine solve_from(contact, fluid, x, start, rounds, line)
      type(line_contact_t), intent(in) :: contact
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: x(:)
      type(start_t), intent(in) :: start
      type(rounds_t), intent(inout) :: rounds
      type(graded_line_t), allocatable, intent(out) :: line
      real(wp) :: pressure(size(x))
      real(wp), allocatable :: chooses(:)   ! the scheme; not allocated: the safe one
      integer :: steps
      logical :: is_sound

      pressure = monotone_cubic(start%x, start%pressure, x)
      pressure(size(x)) = 0.0_wp   ! of an outlet that is cut it would be rounding
      allocate (line)
      if (.not. rounds%is_safe) chooses = pressure
      call new_graded_line(line, contact, fluid, x, chooses)
      call set_pressure(line, pressure, start%rigid_displacement)
      call solve_graded_newton(line, rounds%tolerance, rounds%max_steps, rounds%factors, steps, &
         is_sound)
      if (.not. is_sound) line%error = huge(1.0_wp)
   end subroutine solve_from

   !> Solves the first grid with the safe scheme, that of rough surfaces from the solution with
   !> smooth ones; the line is not allocated if that fails.
   subroutine solve_first(contact, ends, rounds, solution)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: ends(2)
      type(rounds_t), intent(inout) :: rounds
      type(graded_solution_t), intent(inout) :: solution
      type(graded_line_t), allocatable :: line
      real(wp) :: film, widest

      film = newtonian_film(contact)
      widest = finest_wave(contact)/min_in_wave
      if (size(first_nodes(film, 1.0_wp, ends, widest)) > max_nodes) return
      rounds%is_safe = .true.
      call solve_smooth(without_surfaces(contact), ends, rounds, film, solution)
      if (allocated(solution%line) .and. finest_wave(contact) < huge(1.0_wp)) then
         call solve_from(contact, contact%fluid, first_nodes(film, 1.0_wp, ends, widest), &
            start_of(solution%line), rounds, line)
         deallocate (solution%line)
         if (line%error < way_tolerance) call move_alloc(line, solution%line)
      end if
      rounds%is_safe = .false.
   end subroutine solve_first

   !> Solves a smooth contact on a first grid for a `film`, which follows that of a thinning oil: it
   !> goes by way of higher stresses.
   subroutine solve_smooth(contact, ends, rounds, film, solution)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: ends(2)
      type(rounds_t), intent(inout) :: rounds
      real(wp), intent(inout) :: film
      type(graded_solution_t), intent(inout) :: solution
      type(graded_line_t), allocatable :: line
      real(wp), allocatable :: x(:)
      real(wp) :: ease, ratio
      integer :: i

      do i = 1, merge(1, size(first_factors), thins(contact%fluid))
         x = first_nodes(film, first_factors(i), ends, huge(1.0_wp))
         call solve_from(contact, contact%fluid, x, bump(contact, x, film), rounds, line)
         if (line%error < way_tolerance) exit
      end do
      if (line%error < way_tolerance) call move_alloc(line, solution%line)
      ease = merge(first_ease, 0.5_wp, thins(contact%fluid) .and. .not. allocated(solution%line))
      ratio = ease_ratio
      do while (ease >= 1.0_wp)
         x = first_nodes(film, 1.0_wp, ends, huge(1.0_wp))
         if (allocated(solution%line)) then
            call solve_from(contact, eased_fluid(contact%fluid, ease), x, &
               start_of(solution%line), rounds, line)
         else
            call solve_from(contact, eased_fluid(contact%fluid, ease), x, &
               bump(contact, x, film), rounds, line)
         end if
         if (line%error < way_tolerance) then
            call move_alloc(line, solution%line)
            if (ease <= 1.0_wp) exit
            associate (central => solution%line%state%film(minloc(abs(solution%line%x), 1) - 1))
               if (central < fallen_film*film) film = central
            end associate
         else
            if (.not. allocated(solution%line) .or. ratio < least_ratio) then
               if (allocated(solution%line)) deallocate (solution%line)
               exit
            end if
            ease = ease*ratio
            ratio = sqrt(ratio)
         end if
         ease = max(ease/ratio, 1.0_wp)
      end do
   end subroutine solve_smooth

   !> Hertz's pressure, wider for a thick film, with a film of about twice `film` at X = 0.
   function bump(contact, x, film) result(start)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: x(:), film
      type(start_t) :: start
      type(graded_line_t) :: line
      real(wp) :: width

      call new_graded_line(line, contact, contact%fluid, x)
      width = sqrt(2*film)
      width = merge(1.0_wp, 1 + 0.7_wp*width, width < 0.7_wp)
      start%x = x
      start%pressure = sqrt(max(1 - (x/width)**2, 0.0_wp))
      start%pressure([1, size(x)]) = 0.0_wp
      start%pressure = 0.5_wp*pi/dot_product(line%elastic%weights, start%pressure)*start%pressure
      call set_pressure(line, start%pressure, 0.0_wp)
      associate (h => line%state%film)
         start%rigid_displacement = max(2*film - h(minloc(abs(x), 1) - 1), 0.5_wp*film - minval(h))
      end associate
   end function bump

end module graded_solver

!> Newton's method for the line contact with its exact elastic Jacobian.
!>
!> Unknowns are P(1..n-1) and H0; the film follows exactly from P. Complementarity P >= 0, r <= 0 by
!> an active set: a node is cavitated where P + r/D <= 0 (r the residual of (2.65), D > 0 the
!> elastic diagonal). The `linear_solver_t` solves the linear system: by LAPACK, or in O(n log n).
module newton_line
   use duty, only: is_reference
   use kinds, only: wp
   use line_level, only: line_level_t, load_defect, set_film
   use listener, only: is_stopped, listener_t
   use mobility, only: bent_step, flowing_share
   use newton_work, only: allocate_work, evaluate_jacobian, newton_t, share_rows
   use lubricant, only: thins, wall_stress
   implicit none (type, external)
   private

   public :: rest_of_sum, solve_newton, step_tolerance

   !> A step changes no pressure by more than the first share of max(1, P), a bent one by no more
   !> than the second, the total with that of asperities by no more than the third, and reduces no
   !> film below the fourth, no gap where asperities touch below the fifth. There the pressures that
   !> it leaves at 0 in place of below move no surface by more than the last share of the gap: in
   !> front of a heavy contact the oil of a starved one cavitates over a length whose pressures bend
   !> the surfaces by many times the film.
   real(wp), parameter :: largest_step = 0.3_wp, largest_bent_step = 0.6_wp, &
      largest_shared_step = 1.0_wp, smallest_film_share = 0.5_wp, smallest_gap_share = 0.2_wp, &
      largest_cut_share = 0.1_wp
   !> Largest change of Sigma of the slip factor in a step.
   real(wp), parameter :: largest_slip_step = 10.0_wp
   !> Most halvings of a step before the method gives up.
   integer, parameter :: max_halvings = 20
   !> The ends of the pressure creep if the number of nodes with pressure changes by no more than
   !> the first number in as many steps in a row as the second; most repetitions. Rows are
   !> tridiagonal where the film has less than this share in the diagonal, on fine grids less than
   !> this times dX^2: there its share falls so while the film bends as much under the pressure.
   integer, parameter :: largest_creep = 4, first_creep = 2, most_sweeps = 5000
   real(wp), parameter :: thin_share = 1.0e-2_wp, thin_slope = 500.0_wp
   !> A step within a tolerance of the pressure must change every film, relatively, by less than
   !> this many times that: 0.01 p_h is all of a film of 1e-4 b^2/R.
   real(wp), parameter :: film_share = 10.0_wp
   !> A full step below `settled` that is not ten times smaller than the one before has reached
   !> round-off.
   real(wp), parameter :: settled = 1.0e-7_wp

   !> Tolerance on a step where oil bears hardly any of the load, or a front moves with hardly any
   !> pressure.
   real(wp), parameter :: tight_tolerance = 1.0e-7_wp
   !> Share of the right side that the linear solution may leave where asperities bear nearly all of
   !> the load: the pressure of the oil is its small difference.
   real(wp), parameter :: shared_tolerance = 1.0e-6_wp
   !> The linear solution may leave the first share of the goal of a step that can reach it: one
   !> that must reduce the residual to no less than the second share of it.
   real(wp), parameter :: goal_share = 0.5_wp, max_reduction = 3.0e-6_wp

contains

   !> Solves the level's equations (with its right sides) from its present pressure; updates film
   !> and H0. Ends when a full step is below `tolerance` in P and H0 and below ten times that in
   !> relative H, or at round-off, after `max_steps`, or before a step when `listener` asks to stop.
   !> `goal`: bound on |r|/lambda that the caller needs. `film_is_exact`: the level's film is
   !> already that of its pressure and of H0.
   subroutine solve_newton(newton, level, tolerance, max_steps, listener, goal, film_is_exact)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: max_steps
      class(listener_t), intent(inout), optional :: listener
      real(wp), intent(in), optional :: goal
      logical, intent(in), optional :: film_is_exact
      real(wp) :: previous_step, share
      logical :: is_at_hand, is_solved

      call allocate_work(newton, level%n)
      newton%is_converged = .false.
      newton%stress_scale = wall_stress(level%fluid, 1.0_wp)
      ! bent steps do not converge for shear-thinning oils under heavy load (docs/decisions.md)
      newton%is_bent = .not. (thins(level%fluid) .or. allocated(level%rough))
      previous_step = huge(1.0_wp)
      is_at_hand = .false.
      if (present(film_is_exact)) is_at_hand = film_is_exact
      newton%before = level%state
      if (.not. is_at_hand) call set_film(level)
      if (any(level%state%film <= 0.0_wp)) then
         level%state = newton%before
         return
      end if
      do while (newton%steps < max_steps)
         if (is_stopped(listener)) return
         call evaluate_jacobian(level, newton%jacobian)
         call prepare_system(newton, level, goal)
         call newton%linear%solve(level, newton%jacobian, newton%is_cavitated, newton%step, &
            is_solved)
         if (.not. is_solved) return
         newton%linear_iterations = newton%linear_iterations + newton%linear%iterations
         call bend_step(newton, level)
         call apply_step(newton, level, share)
         if (share <= 0.0_wp) return
         newton%steps = newton%steps + 1
         if (share < 1.0_wp) then
            previous_step = huge(1.0_wp)
            cycle
         end if
         newton%is_converged = ((newton%last_step < tolerance &
            .and. newton%last_film_step < film_share*tolerance) &
            .or. (newton%last_step < settled .and. newton%last_step > 0.1_wp*previous_step))
         ! a cavity that conserves its oil was made or filled: in the inlet a front moves far while
         ! hardly any pressure changes
         if (allocated(level%oil%saturation)) newton%is_converged = newton%is_converged &
            .and. all(newton%is_cavitated .neqv. level%state%pressure(1:level%n - 1) > 0.0_wp)
         if (newton%is_converged) return
         previous_step = newton%last_step
      end do
   end subroutine solve_newton

   !> The `usual` tolerance on a step, or a tighter one that a rough or starved contact needs.
   pure real(wp) function step_tolerance(level, usual) result(tolerance)
      type(line_level_t), intent(in) :: level
      real(wp), intent(in) :: usual

      tolerance = usual
      if (allocated(level%rough) .or. level%oil%supply < level%state%film(0)) tolerance = &
         min(usual, tight_tolerance)
   end function step_tolerance

   !> Sets active set and right side; divides the rows of the bands by the elastic diagonal. Bounds
   !> the |r| left by the linear solution if Newton's method must reach `goal` of |r|/lambda.
   pure subroutine prepare_system(newton, level, goal)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(in) :: level
      real(wp), intent(in), optional :: goal
      real(wp) :: pull, inverse
      integer :: i

      newton%residual = tiny(1.0_wp)
      associate (jacobian => newton%jacobian)
         do i = 1, level%n - 1
            inverse = 1.0_wp/jacobian%diagonal(i)
            pull = (level%rhs_reynolds(i) - level%operator(i))*inverse
            newton%is_cavitated(i) = level%state%pressure(i) + pull <= 0.0_wp
            newton%step(i) = merge(-level%state%pressure(i), pull, newton%is_cavitated(i))
            if (.not. newton%is_cavitated(i)) newton%residual = max(newton%residual, &
               abs(pull*jacobian%diagonal(i)))
            jacobian%by_film(:, i) = jacobian%by_film(:, i)*inverse
            jacobian%by_pressure(:, i) = jacobian%by_pressure(:, i)*inverse
         end do
      end associate
      newton%linear%goal = huge(1.0_wp)
      if (present(goal)) then
         if (goal*level%lambda > max_reduction*newton%residual) newton%linear%goal = &
            goal_share*goal*level%lambda
      end if
      newton%step(level%n) = load_defect(level)
      call settle_thick_film(newton, level)
      if (.not. allocated(level%rough)) return
      newton%linear%tolerance = shared_tolerance
      call share_rows(level, newton%jacobian, newton%is_cavitated, newton%step(:level%n - 1))
   end subroutine prepare_system

   !> Finds which nodes of thick film cavitate, if the ends of the pressure creep: the conditions
   !> above move them by one node a step, but in a squeezed film they run over the gap by hundreds.
   !> Where the film hardly changes with the pressure, the rows are tridiagonal: the conditions are
   !> repeated on these alone, with the other nodes at rest.
   pure subroutine settle_thick_film(newton, level)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(in) :: level
      integer :: active, first, last

      if (is_reference(level%moment) .or. allocated(level%oil%saturation)) return
      active = count(.not. newton%is_cavitated)
      newton%creeping = merge(newton%creeping + 1, 0, active /= newton%active &
         .and. abs(active - newton%active) <= largest_creep)
      newton%active = active
      if (newton%creeping < first_creep) return
      newton%creeping = 0
      associate (thick => abs(newton%jacobian%by_pressure(0, 1:level%n - 1) - 1) &
         < min(thin_share, thin_slope*level%dx**2))
         first = findloc(thick, .true., 1)
         do while (first > 0)
            last = first - 1 + findloc([thick(first:), .false.], .false., 1) - 1
            if (last > first) call settle_run(newton, level, first, last)
            first = last + findloc(thick(last + 1:), .true., 1)
            if (first == last) exit
         end do
      end associate
   end subroutine settle_thick_film

   !> The same on the nodes from `first` to `last`.
   pure subroutine settle_run(newton, level, first, last)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: first, last
      real(wp), dimension(first:last) :: pull, upper
      real(wp) :: change(first - 1:last + 1), pivot
      logical :: is_cavitated(first:last)
      integer :: i, sweep

      pull = (level%rhs_reynolds(first:last) - level%operator(first:last)) &
         /newton%jacobian%diagonal(first:last)
      change([first - 1, last + 1]) = 0.0_wp
      associate (p => level%state%pressure, j => newton%jacobian%by_pressure)
         is_cavitated = newton%is_cavitated(first:last)
         do sweep = 1, most_sweeps
            upper(first) = 0.0_wp
            do i = first, last
               if (is_cavitated(i)) then
                  change(i) = -p(i)
                  upper(i) = 0.0_wp
               else if (i == first) then
                  upper(i) = j(1, i)/j(0, i)
                  change(i) = pull(i)/j(0, i)
               else
                  pivot = j(0, i) - j(-1, i)*upper(i - 1)
                  upper(i) = j(1, i)/pivot
                  change(i) = (pull(i) - j(-1, i)*change(i - 1))/pivot
               end if
            end do
            do i = last - 1, first, -1
               change(i) = change(i) - upper(i)*change(i + 1)
            end do
            is_cavitated = p(first:last) + change(first:last) + pull - j(-1, first:last) &
               *change(first - 1:last - 1) - j(0, first:last)*change(first:last) &
               - j(1, first:last)*change(first + 1:) <= 0.0_wp
            if (all(is_cavitated .eqv. newton%is_cavitated(first:last))) exit
            newton%is_cavitated(first:last) = is_cavitated
         end do
         newton%step(first:last) = merge(-p(first:last), pull, newton%is_cavitated(first:last))
      end associate
   end subroutine settle_run

   !> Bends the step of nodes whose mobility e would change by much, if steps are bent at all.
   pure subroutine bend_step(newton, level)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(in) :: level
      integer :: i

      if (.not. newton%is_bent) return
      associate (e => level%oil%mobility, e_p => newton%jacobian%slopes%e_p, &
         step => newton%step)
         do i = 1, level%n - 1
            if (newton%is_cavitated(i)) cycle
            step(i) = bent_step(step(i), e(i), e_p(i), flowing_share*level%dx**2 &
               *abs(newton%jacobian%diagonal(i)))
         end do
      end associate
   end subroutine bend_step

   !> Applies the step, shortened until no pressure moves too far and no film falls below its least
   !> share; share = 0 if that fails.
   subroutine apply_step(newton, level, share)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(inout) :: level
      real(wp), intent(out) :: share
      real(wp) :: solid(merge(level%n - 1, 0, allocated(level%rough))), least, longest, slip
      real(wp), allocatable :: opening(:)
      logical :: is_fair
      integer :: halving, n

      n = level%n
      if (allocated(level%rough)) then
         call split_step(newton, level, solid, opening)
      else
         ! an iterative solution misses this by its tolerance, and the node would count as one with
         ! pressure
         where (newton%is_cavitated) newton%step(1:n - 1) = -level%state%pressure(1:n - 1)
      end if
      share = maxval(abs(newton%step(1:n - 1))/max(1.0_wp, level%state%pressure(1:n - 1)))
      if (.not. share < huge(1.0_wp)) then
         share = 0.0_wp
         return
      end if
      longest = merge(largest_bent_step, largest_step, newton%is_bent)
      ! the slip factor grows as exp(|Sigma|), and a step must not run ahead of it
      associate (h => level%state%film, step => newton%step)
         if (level%is_kappa) then
            slip = maxval(abs(2*h(2:n - 1)*(step(2:n - 1) - step(:n - 2))))
         else
            slip = maxval(abs(h(2:n - 2)*(step(3:n - 1) - step(:n - 3))))
         end if
      end associate
      slip = 0.5_wp*newton%stress_scale/level%dx*slip
      share = min(1.0_wp, longest/max(share, longest), largest_slip_step/max(slip, &
         largest_slip_step))
      least = smallest_film_share
      newton%before = level%state
      associate (new => level%state, old => newton%before, step => newton%step)
         if (allocated(level%rough)) then
            least = smallest_gap_share
            share = min(share, largest_shared_step/max(maxval(abs(step(1:n - 1) + solid) &
               /max(1.0_wp, old%pressure(1:n - 1) + old%asperity_pressure(1:n - 1))), &
               largest_shared_step))
         end if
         do halving = 1, max_halvings
            new%pressure(1:n - 1) = max(old%pressure(1:n - 1) + share*step(1:n - 1), 0.0_wp)
            if (allocated(level%rough)) new%asperity_pressure(1:n - 1) = &
               max(old%asperity_pressure(1:n - 1) + share*solid, 0.0_wp)
            new%rigid_displacement = old%rigid_displacement + share*step(n)
            call set_film(level)
            is_fair = all(new%film > least*old%film)
            if (is_fair .and. allocated(level%rough)) is_fair = all(abs(new%separation &
               - old%separation - share*opening) <= largest_cut_share*old%film)
            if (is_fair) exit
            share = 0.5_wp*share
         end do
         if (halving > max_halvings) then
            level%state = newton%before
            share = 0.0_wp
            return
         end if
         ! a pressure cut at 0 is exact
         if (allocated(new%compensation)) new%compensation(1:n - 1) = &
            merge(old%compensation(1:n - 1) + rest_of_sum(new%pressure(1:n - 1), &
            old%pressure(1:n - 1), share*step(1:n - 1)), 0.0_wp, new%pressure(1:n - 1) > 0.0_wp)
         newton%last_film_step = maxval(abs(new%film - old%film)/old%film)
         newton%last_step = max(maxval(abs(new%pressure - old%pressure)), abs(share*step(n)))
         if (allocated(level%rough)) newton%last_step = max(newton%last_step, &
            maxval(abs(new%asperity_pressure - old%asperity_pressure)))
      end associate
   end subroutine apply_step

   !> Splits the step of the total pressure, where asperities touch, into that of the oil, which
   !> stays in `newton`, and that of the asperities, `solid` (1:n-1). `opening` (0:n): the change of
   !> the separation.
   subroutine split_step(newton, level, solid, opening)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(inout) :: level
      real(wp), intent(out) :: solid(:)
      real(wp), allocatable, intent(out) :: opening(:)
      real(wp) :: change(0:level%n)

      associate (n => level%n, step => newton%step, rough => level%rough, state => level%state)
         change = [0.0_wp, step(1:n - 1), 0.0_wp]
         allocate (opening(0:n))
         call level%elastic%apply(change, opening)
         opening = step(n) - opening
         step(1:n - 1) = merge(-state%pressure(1:n - 1), change(1:n - 1) - rough%slope(1:n - 1) &
            *opening(1:n - 1) + state%asperity_pressure(1:n - 1) - rough%pressure(1:n - 1), &
            newton%is_cavitated)
         solid = change(1:n - 1) - step(1:n - 1)
      end associate
   end subroutine split_step

   !> a + b - total, exactly, if `total` is a + b rounded to nearest and nothing overflows (Knuth,
   !> The Art of Computer Programming 2, section 4.2.2).
   elemental function rest_of_sum(total, a, b) result(rest)
      real(wp), intent(in) :: total, a, b
      real(wp) :: rest, share

      share = total - a
      rest = (a - (total - share)) + (b - share)
   end function rest_of_sum

end module newton_line

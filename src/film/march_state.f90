!> State of a transient after a time step: everything that later steps depend on, so that an
!> interrupted run resumes without changing a bit of its result.
module march_state
   use film_state, only: film_state_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use time_scheme, only: derivative_weights, error_share, parabola_weights
   implicit none (type, external)
   private

   public :: extrapolate, judge_part, keep_solution, march_state_t, next_end, predictors, &
      step_error, step_weights, time_part_t

   !> The history predicts a step if the line through two solutions missed the next one by at most
   !> this share of its change.
   real(wp), parameter :: largest_miss = 0.5_wp
   !> First part of a march with an error estimate, and shortest part [T]; most growth and fall of
   !> parts from one to the next; share of the bound that the next one aims at.
   real(wp), parameter :: first_part = 1.0e-3_wp, growth = 2.0_wp, fall = 0.2_wp, aim = 0.8_wp
   real(wp), parameter, public :: shortest_part = 1.0e-9_wp
   !> Most parts of a step, repeated ones included. (A start after a long rest took 1100 on 2048
   !> intervals.)
   integer, parameter, public :: most_parts = 10000
   !> A part that is longer than the one before by more than this takes no slope from it.
   real(wp), parameter :: longest_growth = 10.0_wp

   !> The last solutions, from which the next one starts; dimensionless, on the nodes 0:n of the
   !> finest grid.
   type :: march_state_t
      !> Time steps done; 0 = the start. Steps to do; 0: as planned.
      integer :: step = 0, steps = 0
      !> Solutions kept, up to 3, and of rho H up to 4; 1 is the newest.
      integer :: size = 0
      !> P of these solutions (0:n, 3).
      real(wp), allocatable :: pressure(:, :)
      !> H0 of these solutions.
      real(wp) :: rigid_displacement(3) = 0.0_wp
      !> Time from each of these solutions back to the next older one: dT, or a part of it.
      real(wp) :: lengths(3) = 0.0_wp
      !> Length that the error estimate proposes for the next part; 0: none.
      real(wp) :: next_length = 0.0_wp
      !> Direction of the flow in which they are kept (module line_level).
      real(wp) :: direction = 1.0_wp
      !> rho H of the last four times (0:n, 4), for the squeeze term and its error.
      real(wp), allocatable :: mass(:, :)
      !> Temperature rises [K] of the newest solution (0:n, 3); not allocated: it stays cold.
      real(wp), allocatable :: rise(:, :)
      !> Number of the relaxation that found it; the next step begins with it if all are relaxations
      !> of one method.
      integer :: way = 1
      !> H at the end of the last cycle of a duty (nx), and its largest relative change in that.
      real(wp), allocatable :: cycle_film(:)
      real(wp) :: cycle_change = 0.0_wp
      !> H of the newest solution (0:n), and outcome, history and cost up to here; set in a stored
      !> state.
      real(wp), allocatable :: film(:)
      type(report_t) :: report
   end type march_state_t

   !> A step, or one part of it, with its solution on the nodes 0:n of the finest grid.
   type :: time_part_t
      !> dy/dT at its end is weights(1) y + weights(2) y_old + weights(3) y_older.
      real(wp) :: weights(3) = 0.0_wp
      !> Its length dT.
      real(wp) :: length = 0.0_wp
      !> Psi_1 and Psi_2 at its end (0:n, 2).
      real(wp), allocatable :: heights(:, :)
      type(film_state_t) :: state
   end type time_part_t

contains

   !> Weights (new, old, older) of rho H in its change with time at the end of a step of `length` by
   !> a `scheme`.
   pure function step_weights(history, scheme, length) result(weights)
      type(march_state_t), intent(in) :: history
      character(*), intent(in) :: scheme
      real(wp), intent(in) :: length
      real(wp) :: weights(3)
      logical :: has_older

      has_older = scheme == 'bdf2' .and. history%size > 1 &
         .and. length < longest_growth*history%lengths(1)
      weights = derivative_weights(length/merge(history%lengths(1), length, has_older), &
         has_older)/length
      if (scheme == 'quasi_steady') weights = 0.0_wp
   end function step_weights

   !> Adds a solution on all nodes, at the end of a step of `length`, to the history.
   pure subroutine keep_solution(history, length, pressure, rigid_displacement, mass)
      type(march_state_t), intent(inout) :: history
      real(wp), intent(in) :: length, pressure(0:), rigid_displacement, mass(0:)

      if (.not. allocated(history%pressure)) allocate (history%pressure(0:ubound(pressure, 1), 3), &
         history%mass(0:ubound(pressure, 1), 4), source=0.0_wp)
      history%pressure(:, 3) = history%pressure(:, 2)
      history%pressure(:, 2) = history%pressure(:, 1)
      history%pressure(:, 1) = pressure
      history%lengths = [length, history%lengths(1:2)]
      history%rigid_displacement = [rigid_displacement, history%rigid_displacement(1:2)]
      history%mass(:, 2:) = history%mass(:, :3)
      history%mass(:, 1) = mass
      history%size = min(history%size + 1, 4)
   end subroutine keep_solution

   !> Number of last solutions that best predict the next one: all, or only the newest if the line
   !> through the two before missed it (features that move by a spacing or more in a step). In 48
   !> transients with dT = dX this saves 20 % of the cycles on 64 intervals, 10 % on 128, 3 % on
   !> 256.
   pure integer function predictors(history) result(count)
      type(march_state_t), intent(in) :: history
      real(wp) :: weights(3)

      count = min(history%size, 3)
      if (count < 3) return
      weights = parabola_weights(2, history%lengths(1)/history%lengths(2), 1.0_wp)
      associate (p => history%pressure)
         if (maxval(abs(p(:, 1) - weights(1)*p(:, 2) - weights(2)*p(:, 3))) > largest_miss &
            *maxval(abs(p(:, 1) - p(:, 2)))) count = 1
      end associate
   end function predictors

   !> P (cut at 0) and H0 at the end of a step of `length`, by the polynomial of lowest degree
   !> through the last `count` solutions.
   pure subroutine extrapolate(history, count, length, state)
      type(march_state_t), intent(in) :: history
      integer, intent(in) :: count
      real(wp), intent(in) :: length
      type(film_state_t), intent(inout) :: state
      real(wp) :: weights(3), last

      last = merge(history%lengths(1), 1.0_wp, history%size > 1)
      weights = parabola_weights(count, length/last, history%lengths(2)/last)
      associate (p => history%pressure, h0 => history%rigid_displacement)
         state%pressure = max(weights(1)*p(:, 1) + weights(2)*p(:, 2) + weights(3)*p(:, 3), 0.0_wp)
         state%rigid_displacement = dot_product(weights, h0)
      end associate
   end subroutine extrapolate

   !> End of the next part, as a share of a step of `length`, between `first` and the `last` that it
   !> may have: by what the error proposes, without a short rest.
   pure real(wp) function next_end(history, first, last, length) result(end)
      type(march_state_t), intent(in) :: history
      real(wp), intent(in) :: first, last, length
      real(wp) :: proposed

      proposed = history%next_length
      if (.not. proposed > 0.0_wp) proposed = first_part
      end = last
      if ((last - first)*length > proposed) end = first + min(proposed, 0.5_wp*(last - first) &
         *length)/length
   end function next_end

   !> Whether the `error` of a part of `length` is within the `tolerance`; proposes the length of
   !> the next one, or of this once more.
   pure subroutine judge_part(history, error, length, tolerance, is_good)
      type(march_state_t), intent(inout) :: history
      real(wp), intent(in) :: error, length, tolerance
      logical, intent(out) :: is_good
      real(wp) :: share

      share = min(max((aim*tolerance/max(error, tiny(error)))**(1.0_wp/3), fall), growth)
      is_good = error <= tolerance
      history%next_length = max(share*length, merge(history%next_length, 0.0_wp, &
         is_good .and. share >= 1.0_wp))
   end subroutine judge_part

   !> Error of BDF2 in the last part relative to the film, largest where `pressure` (0:n) is above
   !> the share `least` of its largest: from the film that the parabola through the three before has
   !> predicted; without three by the line through two, which overrates it; 0 after the first part.
   pure real(wp) function step_error(history, pressure, least) result(error)
      type(march_state_t), intent(in) :: history
      real(wp), intent(in) :: pressure(0:), least
      real(wp) :: weights(3)

      error = 0.0_wp
      if (history%size < 3) return
      associate (h => history%lengths, mass => history%mass)
         weights = parabola_weights(history%size - 1, h(1)/h(2), h(3)/h(2))
         error = maxval(abs(mass(:, 1) - weights(1)*mass(:, 2) - weights(2)*mass(:, 3) &
            - weights(3)*mass(:, 4))/mass(:, 1), pressure > least*maxval(pressure))
         if (history%size > 3) error = error*error_share(h)
      end associate
   end function step_error

end module march_state

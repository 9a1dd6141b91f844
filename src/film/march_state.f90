!> State of a transient after a time step: everything that later steps depend on, so that an
!> interrupted run resumes without changing a bit of its result; also of the full momentum
!> equations, with the prediction of the next film from the last ones.
!>
!> Weights of the time schemes for steps of unequal length, and the lengths with which BDF2 begins.
!>
!> At T = 0 surfaces stand in a film that has not flowed around them: P(T) - P(0) then grows as a
!> fractional power of T, about T^0.8, and a first step of length dT leaves an error of that order
!> which no later step removes from the largest error over all times. The first steps are therefore
!> divided into parts. With parts of length ~ dT (T/dT)^0.6 every part has about the same error
!> (graded steps: H. Brunner, Math. Comp. 45, 1985, 417).
module march_state
   use film_state, only: film_state_t
   use iteration_report, only: report_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: derivative_weights, excess_t, extrapolate, judge_part, keep_solution, march_state_t, &
      max_excesses, momentum_history_t, newton_cost_t, next_count, next_end, parabola_weights, &
      part_ends, past_t, prediction_weights, predictors, step_error, step_weights, time_part_t, &
      turn_history

   !> Time T from which undivided steps suffice; exponent of the grading; shortest part, T
   !> (round-off).
   real(wp), parameter :: start_layer = 0.02_wp, grading = 0.6_wp, shortest_part = 1.0e-6_wp

   !> The history predicts a step if the line through two solutions missed the next one by at most
   !> this share of its change.
   real(wp), parameter :: largest_miss = 0.5_wp
   !> First part of a march with an error estimate, and shortest part [T]; most growth and fall of
   !> parts from one to the next; share of the bound that the next one aims at.
   real(wp), parameter :: first_part = 1.0e-3_wp, growth = 2.0_wp, fall = 0.2_wp, aim = 0.8_wp
   real(wp), parameter, public :: least_part = 1.0e-9_wp
   !> Most parts of a step, repeated ones included. (A start after a long rest took 1100 on 2048
   !> intervals.)
   integer, parameter, public :: most_parts = 10000
   !> A part that is longer than the one before by more than this takes no slope from it.
   real(wp), parameter :: longest_growth = 10.0_wp

   !> Numbers of a march.
   type :: march_numbers_t
      !> Time steps done; 0 = the start. Steps to do; 0: as planned.
      integer :: step = 0, steps = 0
      !> Solutions kept, up to 3, and of rho H up to 4; 1 is the newest.
      integer :: size = 0
      !> H0 of these solutions.
      real(wp) :: rigid_displacement(3) = 0.0_wp
      !> Time from each of these solutions back to the next older one: dT, or a part of it.
      real(wp) :: lengths(3) = 0.0_wp
      !> Length that the error estimate proposes for the next part; 0: none.
      real(wp) :: next_length = 0.0_wp
      !> Direction of the flow in which they are kept (module line_level).
      real(wp) :: direction = 1.0_wp
      !> Number of the relaxation that found it; the next step begins with it if all are relaxations
      !> of one method.
      integer :: way = 1
      !> Largest relative change of H in the last cycle of a duty.
      real(wp) :: cycle_change = 0.0_wp
   end type march_numbers_t

   !> The last solutions, from which the next one starts; dimensionless, on the nodes 0:n of the
   !> finest grid.
   type, extends(march_numbers_t) :: march_state_t
      !> P of these solutions (0:n, 3).
      real(wp), allocatable :: pressure(:, :)
      !> rho H of the last four times (0:n, 4), for the squeeze term and its error.
      real(wp), allocatable :: mass(:, :)
      !> Temperature rises [K] of the newest solution (0:n, 3); not allocated: it stays cold.
      real(wp), allocatable :: rise(:, :)
      !> H at the end of the last cycle of a duty (nx).
      real(wp), allocatable :: cycle_film(:)
      !> Smallest H of the newest solution.
      real(wp) :: smallest_film = 0.0_wp
      !> H of the newest solution (0:n), and outcome, history and cost up to here; set in a stored
      !> state.
      real(wp), allocatable :: film(:)
      type(report_t) :: report
   end type march_state_t

   !> A step, or one part of it, with its solution on the nodes 0:n of the finest grid.
   type :: time_part_t
      !> dy/dT at its end is weights(1) y + weights(2) y_old + weights(3) y_older.
      real(wp) :: weights(3) = 0.0_wp
      !> Its length dT, and T at its end.
      real(wp) :: length = 0.0_wp, time = 0.0_wp
      !> For a follower: Psi_1 and Psi_2 at its end (0:n, 2).
      real(wp), allocatable :: heights(:, :)
      type(film_state_t) :: state
   end type time_part_t

   !> Most films that predict the next one.
   integer, parameter :: max_excesses = 3

   !> Quantities of an old time that the equations need, or a combination of several: H, z1 (0:n),
   !> rho H of the layers (layers, 0:n).
   type :: past_t
      real(wp), allocatable :: film(:), lower(:), mass(:, :)
   end type past_t

   !> P (layers, 0:n), U (layers, n), V (0:layers, 0:n) and H0 of a film, or their excess over those
   !> of the Reynolds equation at the same time; U over that of the thin film with its P and H.
   type :: excess_t
      real(wp), allocatable :: p(:, :), u(:, :), v(:, :)
      real(wp) :: rigid_displacement = 0.0_wp
   end type excess_t

   !> Newton steps, factorisations of the matrix, steps of GMRES.
   type :: newton_cost_t
      integer :: steps = 0, factorisations = 0, linear_iterations = 0
   end type newton_cost_t

   !> Numbers of a march of the momentum equations, and its cost: time steps, or parts of them, most
   !> Newton steps for one, and the number of those with more than three.
   type, extends(newton_cost_t) :: march_cost_t
      integer :: solutions = 0, most_steps = 0, longer = 0
      integer :: layers = 0
      !> Numbers of old times and of films in use.
      integer :: times = 0, films = 0
      !> Time from each of these films back to the next older one.
      real(wp) :: lengths(max_excesses - 1) = 0.0_wp
      !> Number of films that predict the next one.
      integer :: best_count = 0
      !> Largest T_max so far.
      real(wp) :: stress_rise = 0.0_wp
      !> Set in a stored state: half the weight of the new value in d/dT.
      real(wp) :: half_rate = 0.0_wp
   end type march_cost_t

   !> History of the march, the newest first, and its present film.
   type, extends(march_cost_t) :: momentum_history_t
      !> Film of the Reynolds equation, and heights Psi_1 and Psi_2 of the walls (0:n, 2).
      type(film_state_t) :: reynolds
      real(wp), allocatable :: heights(:, :)
      type(past_t) :: past(2)
      type(excess_t) :: excess(max_excesses)
      !> Set in a stored state: the present film, its H (0:n), and the contribution of the old ones
      !> to d/dT.
      type(excess_t) :: flow
      real(wp), allocatable :: film(:)
      type(past_t) :: made_of_old
   end type momentum_history_t

contains

   !> Weights (new, old, older) of the values of y in h dy/dT at the new time, h the length of the
   !> step and `ratio` h over the length of the step before it; exact for parabolas: BDF2. Without
   !> an older value, backward Euler.
   pure function derivative_weights(ratio, has_older) result(weights)
      real(wp), intent(in) :: ratio
      logical, intent(in) :: has_older
      real(wp) :: weights(3)

      weights = [1.0_wp, -1.0_wp, 0.0_wp]
      if (has_older) weights = [(1.0_wp + 2.0_wp*ratio)/(1.0_wp + ratio), -(1.0_wp + ratio), &
         ratio**2/(1.0_wp + ratio)]
   end function derivative_weights

   !> Weights of the last `count` values (1 to 3, newest first) in the value at the new time by the
   !> polynomial of lowest degree. `ahead`: h over the length h1 of the last step; `back`: length h2
   !> of the step before it over h1.
   pure function parabola_weights(count, ahead, back) result(weights)
      integer, intent(in) :: count
      real(wp), intent(in) :: ahead, back
      real(wp) :: weights(3)

      select case (count)
      case (:1)
         weights = [1.0_wp, 0.0_wp, 0.0_wp]
      case (2)
         weights = [1.0_wp + ahead, -ahead, 0.0_wp]
      case default
         weights = [(1.0_wp + ahead)*(1.0_wp + ahead + back)/(1.0_wp + back), &
            -ahead*(1.0_wp + ahead + back)/back, ahead*(1.0_wp + ahead)/(back*(1.0_wp + back))]
      end select
   end function parabola_weights

   !> Weights of the last `count` of `known` values at the end of a step of `length`; `lengths`:
   !> times between them.
   pure function prediction_weights(lengths, known, length, count) result(weights)
      real(wp), intent(in) :: lengths(:), length
      integer, intent(in) :: known, count
      real(wp) :: weights(3), last

      last = merge(lengths(1), 1.0_wp, known > 1)
      weights = parabola_weights(count, length/last, lengths(2)/last)
   end function prediction_weights

   !> Ends of the parts of a step, as shares of its length `time_step`, the last one 1: one part
   !> with backward Euler and after the start, else parts that follow the grading.
   pure function part_ends(scheme, step, time_step) result(ends)
      character(*), intent(in) :: scheme
      integer, intent(in) :: step
      real(wp), intent(in) :: time_step
      real(wp), allocatable :: ends(:)
      real(wp) :: wanted, exponent
      integer :: i, parts

      parts = 1
      exponent = 1.0_wp
      if (scheme == 'bdf2' .and. step*time_step < start_layer) then
         wanted = (start_layer/(step*time_step))**grading
         if (step == 1) then
            exponent = 1.0_wp/(1.0_wp - grading)
            parts = nint(exponent*wanted)
         else
            parts = nint(wanted)
         end if
         parts = max(1, min(parts, int((time_step/shortest_part)**(1.0_wp/exponent))))
      end if
      ends = [((real(i, wp)/parts)**exponent, i=1, parts)]
   end function part_ends

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

   !> Turns the last solutions to the other direction of the flow.
   pure subroutine turn_history(history)
      type(march_state_t), intent(inout) :: history

      history%pressure(:, :) = history%pressure(ubound(history%pressure, 1):0:-1, :)
      history%mass(:, :) = history%mass(ubound(history%mass, 1):0:-1, :)
      history%direction = -history%direction
   end subroutine turn_history

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
   pure subroutine extrapolate(history, count, length, pressure, rigid_displacement)
      type(march_state_t), intent(in) :: history
      integer, intent(in) :: count
      real(wp), intent(in) :: length
      real(wp), intent(out) :: pressure(:), rigid_displacement
      real(wp) :: weights(3)

      weights = prediction_weights(history%lengths, history%size, length, count)
      associate (p => history%pressure)
         pressure = max(weights(1)*p(:, 1) + weights(2)*p(:, 2) + weights(3)*p(:, 3), 0.0_wp)
      end associate
      rigid_displacement = dot_product(weights, history%rigid_displacement)
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
      real(wp) :: parabola, ratio, scheme, weights(3)

      error = 0.0_wp
      if (history%size < 3) return
      associate (h => history%lengths, mass => history%mass)
         weights = parabola_weights(history%size - 1, h(1)/h(2), h(3)/h(2))
         error = maxval(abs(mass(:, 1) - weights(1)*mass(:, 2) - weights(2)*mass(:, 3) &
            - weights(3)*mass(:, 4))/mass(:, 1), pressure > least*maxval(pressure))
         if (history%size < 4) return
         ! the errors of BDF2 and of the parabola, whose values differ by both, for small steps
         ratio = h(1)/h(2)
         scheme = h(1)**3*(1 + ratio)**2/(ratio*(1 + 2*ratio))
         parabola = h(1)*(h(1) + h(2))*sum(h)
         error = error*(scheme/(scheme + parabola))
      end associate
   end function step_error

   !> Number of films that would best have predicted the present `excess` after a step of this
   !> length: pressures and velocities count alike.
   integer function next_count(past, excess, length) result(best)
      type(momentum_history_t), intent(in) :: past
      type(excess_t), intent(in) :: excess
      real(wp), intent(in) :: length
      real(wp) :: miss, smallest, weights(max_excesses)
      real(wp), allocatable :: p(:, :), u(:, :)
      integer :: count, k

      best = 0
      smallest = huge(1.0_wp)
      do count = 0, past%films
         weights = prediction_weights(past%lengths, past%films, length, count)
         p = excess%p
         u = excess%u
         do k = 1, count
            p = p - weights(k)*past%excess(k)%p
            u = u - weights(k)*past%excess(k)%u
         end do
         miss = max(maxval(abs(p)), maxval(abs(u)))
         if (miss < smallest) best = count
         smallest = min(miss, smallest)
      end do
   end function next_count

end module march_state

!> Newton's method for the steady line contact on a graded grid.
!>
!> Unknowns are P(1..n-1) and H0, complementarity by the active set of `graded_line`. A step is the
!> best of up to three: plain; bent (`bent_step` of module mobility); and 0.4 of the plain one.
module graded_newton
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use film_state, only: film_state_t
   use graded_line, only: evaluate, graded_line_t, point_mobility, set_pressure
   use graded_system, only: factorise, graded_factors_t, solve_system
   use kinds, only: wp
   use mobility, only: bent_step, flowing_share
   use moes, only: moes_m_sum_from_lambda
   use lubricant, only: thins, wall_stress
   implicit none (type, external)
   private

   public :: solve_graded_newton

   !> A step changes no pressure by more than the first share of the largest of P, of the largest P
   !> and of min(1, 4 M); no film falls below the second share; Sigma changes by no more than the
   !> third.
   real(wp), parameter :: largest_step = 0.6_wp, least_film_share = 0.35_wp, &
      largest_slip_step = 10.0_wp
   !> Share of the norm below which the plain step is good enough, or after it the bent one; length
   !> of the short one.
   real(wp), parameter :: good_plain = 0.5_wp, good_bent = 0.9_wp, short = 0.4_wp
   !> Remainder of a linear solution over its right side.
   real(wp), parameter :: linear_tolerance = 1.0e-3_wp
   !> Least length of a step, and size of a full one that has reached round-off.
   real(wp), parameter :: least_length = 1.0e-9_wp, round_off = 1.0e-11_wp

   !> A trial step: where it leads, its length and the norm of what remains.
   type :: trial_t
      type(film_state_t) :: state
      real(wp) :: length = 0.0_wp, merit = huge(1.0_wp)
   end type trial_t

contains

   !> Solves the equations from the line's present pressure until their `error` is below `tolerance`
   !> or a full step is at round-off; at most `max_steps` steps, counted in `steps`. `is_sound`: no
   !> system was singular, and a step was found.
   subroutine solve_graded_newton(line, tolerance, max_steps, factors, steps, is_sound)
      type(graded_line_t), intent(inout) :: line
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: max_steps
      type(graded_factors_t), intent(inout) :: factors
      integer, intent(out) :: steps
      logical, intent(out) :: is_sound
      real(wp) :: step(line%n), before(0:line%n)
      type(trial_t) :: best

      steps = 0
      is_sound = all(line%state%film > 0.0_wp)
      if (.not. is_sound) return
      call evaluate(line)
      do while (line%error >= tolerance .and. steps < max_steps)
         call factorise(line, factors)
         is_sound = factors%is_sound
         if (.not. is_sound) return
         step = [line%pull, line%load_defect]
         call solve_system(factors, linear_tolerance, step, is_transposed=.false.)
         where (line%is_cavitated) step(:line%n - 1) = line%pull   ! to P = 0 exactly
         is_sound = all(ieee_is_finite(step))
         if (.not. is_sound) return
         before = line%state%pressure
         call choose_step(line, step, best)
         is_sound = best%length > 0.0_wp
         if (.not. is_sound) return
         steps = steps + 1
         if (best%length >= 1.0_wp .and. maxval(abs(line%state%pressure - before)) &
            <= round_off*maxval(before)) exit
      end do
   end subroutine solve_graded_newton

   !> The best of the trial steps, at which the line is left; of length 0 if none leaves a positive
   !> film.
   subroutine choose_step(line, step, best)
      type(graded_line_t), intent(inout) :: line
      real(wp), intent(in) :: step(:)
      type(trial_t), intent(out) :: best
      type(film_state_t) :: start
      type(trial_t) :: trial
      real(wp) :: bent(line%n), merit
      logical :: is_last
      integer :: way

      merit = line%merit
      start = line%state
      bent = step
      call bend_step(line, bent)
      do way = 1, 3
         if (way == 2) then
            call try_step(line, start, bent, 1.0_wp, trial)
         else
            call try_step(line, start, step, merge(short, 1.0_wp, way == 3), trial)
         end if
         is_last = trial%merit < best%merit
         if (is_last) best = trial
         if (best%merit < good_plain*merit .or. (way == 2 .and. best%merit < good_bent*merit)) exit
      end do
      if (is_last .or. .not. best%length > 0.0_wp) return
      line%state = best%state
      call evaluate(line)
   end subroutine choose_step

   !> Takes `share` of the longest part of a step from the state `start` that respects the bounds
   !> above, halved until the film does.
   subroutine try_step(line, start, step, share, trial)
      type(graded_line_t), intent(inout) :: line
      type(film_state_t), intent(in) :: start
      real(wp), intent(in), contiguous :: step(:)
      real(wp), intent(in) :: share
      type(trial_t), intent(out) :: trial
      real(wp), dimension(0:line%n) :: change, film_change, pressure, slope
      real(wp) :: scale, length
      integer :: n

      n = line%n
      change = [0.0_wp, step(:n - 1), 0.0_wp]
      call line%elastic%multiply(change, film_change)
      film_change = step(n) - film_change
      scale = max(maxval(start%pressure), min(1.0_wp, 4*moes_m_sum_from_lambda(line%lambda)))
      length = 1/max(1.0_wp, maxval(abs(change)/max(scale, start%pressure))/largest_step, &
         maxval(-film_change/start%film)/largest_step)
      if (thins(line%fluid)) then
         pressure = max(start%pressure + length*change, 0.0_wp)
         slope(1:) = wall_stress(line%fluid, 0.5_wp*((start%film(1:) + start%film(:n - 1) &
            + length*(film_change(1:) + film_change(:n - 1)))*(pressure(1:) - pressure(:n - 1)) &
            - (start%film(1:) + start%film(:n - 1))*(start%pressure(1:) - start%pressure(:n - 1))) &
            /line%spacing)
         length = length*min(1.0_wp, largest_slip_step/max(maxval(abs(slope(1:))), &
            tiny(1.0_wp)))
      end if
      length = share*length
      do while (length > least_length)
         pressure = start%pressure + length*change
         if (any(pressure < 0.0_wp)) then
            call set_pressure(line, max(pressure, 0.0_wp), start%rigid_displacement &
               + length*step(n))
         else   ! the film is linear in the step
            line%state%pressure = pressure
            line%state%film = start%film + length*film_change
            line%state%rigid_displacement = start%rigid_displacement + length*step(n)
         end if
         if (all(line%state%film > least_film_share*start%film)) exit
         length = 0.5_wp*length
      end do
      if (.not. length > least_length) return
      call evaluate(line)
      if (ieee_is_finite(line%merit)) trial = trial_t(line%state, length, line%merit)
   end subroutine try_step

   !> Bends the step of nodes whose mobility e falls with P and would change by much.
   pure subroutine bend_step(line, step)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(inout) :: step(:)
      real(wp), dimension(line%n - 1) :: e, flowing, slope
      real(wp) :: by(line%n - 1, 3)

      associate (p => line%state%pressure, h => line%state%film(1:line%n - 1), n => line%n, &
         x => line%x)
         slope = (p(2:) - p(:n - 2))/(x(2:) - x(:n - 2))
         call point_mobility(line%fluid, p(1:n - 1), h, slope, e, by)
         flowing = line%lambda*min(line%spacing(2:), line%spacing(:n - 1))*flowing_share &
            *line%diagonal
         where (.not. line%is_cavitated .and. by(:, 1) < 0.0_wp) step(:n - 1) = &
            bent_step(step(:n - 1), e, by(:, 1), flowing)
      end associate
   end subroutine bend_step

end module graded_newton

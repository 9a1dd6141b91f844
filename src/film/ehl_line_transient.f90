!> Time steps of the lubricated line contact, with Psi_1, Psi_2 at the new time:
!>
!>     backward Euler  lambda d(rho H)/dT = lambda/dT ( rho H - (rho H)_old )
!>     BDF2            lambda d(rho H)/dT = lambda/(2 dT) (3 rho H - 4 (rho H)_old + (rho H)_older)
!>
!> Both have the form lambda/dT_eff ( rho H - F ). BDF2 begins with a short step of backward Euler
!> and reaches its full step over several parts (module time_scheme).
!>
!> At T = 0 pressure and H0 are those of the smooth steady contact; the surfaces enter the old film
!> without a new solve. Later steps start from a prediction by the last solutions.
module ehl_line_transient
   use cycle_control, only: iterate
   use errors, only: error_t
   use features, only: surface_height
   use film_breakdown, only: check_breakdown
   use film_equation, only: set_film
   use film_state, only: film_state_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: intervals_for_waves, line_contact_t, min_in_wave, move_profiles
   use line_hierarchy, only: line_hierarchy_t, method_fas, relaxation_t, report_cost, roughness_at
   use line_level, only: line_level_t
   use line_state, only: line_state_t
   use listener, only: listener_t
   use lubricant, only: fluid_density
   use march_state, only: march_state_t, time_part_t
   use reynolds_line, only: evaluate_coefficients
   use solver_choice, only: adopt, note_choice, time_step_attempts
   use solver_settings, only: solver_settings_t, time_settings_t, word_length
   use state_output, only: fill_state
   use text, only: to_text
   use time_scheme, only: derivative_weights, parabola_weights, part_ends
   implicit none (type, external)
   private

   public :: extrapolate, march, predictors, remember

   !> A time step and how it is solved.
   type :: step_plan_t
      !> Relaxations to try, in this order.
      type(relaxation_t), allocatable :: attempts(:)
      !> Number of the step, its length, the scheme, and the ends of its parts as shares of the
      !> length.
      integer :: step = 0
      real(wp) :: length = 0.0_wp
      character(len=word_length) :: scheme = ''
      real(wp), allocatable :: ends(:)
      !> Its parts once solved, if a follower needs them.
      logical :: keeps_parts = .false.
      type(time_part_t), allocatable :: parts(:)
   end type step_plan_t

   !> The history predicts a step if the line through two solutions missed the next one by at most
   !> this share of its change.
   real(wp), parameter :: largest_miss = 0.5_wp

contains

   !> Marches from the smooth steady solution on the finest level, whose film the surfaces then
   !> enter without a new solve, or from where an earlier run stopped, to `time%end_time` with the
   !> step of `choose_time_step`; the listener receives every step. Ends early, not converged, if a
   !> step has no solution or the heights of a surface cannot be read; `state` is then the last good
   !> one. The profiles must be loaded for the start.
   subroutine march(hierarchy, contact, settings, time, listener, state, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout) :: listener
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report
      type(march_state_t) :: history
      type(step_plan_t) :: plan
      integer :: step, steps

      allocate (plan%attempts, source=time_step_attempts(contact, settings))
      call note_choice(report, plan%attempts(1))
      plan%length = time%time_step
      plan%scheme = time%scheme
      plan%keeps_parts = allocated(listener%follower)
      steps = nint(time%end_time/time%time_step)
      associate (level => hierarchy%levels(hierarchy%finest))
         call listener%on_stage('time steps on '//to_text(level%n)//' intervals')
         if (allocated(time%resume_from)) then
            history = time%resume_from
            level%state%pressure = history%pressure(:, 1)
            level%state%film = history%film
            level%state%rigid_displacement = history%rigid_displacement(1)
            call evaluate_coefficients(level)
            call fill_state(contact, level, history%step*plan%length, state)
         else
            level%rhs_film = level%gap - roughness_at(contact, level, 0.0_wp)
            call set_film(level)
            call check_breakdown(level%x, level%state%film, settings, 0, 0.0_wp, report)
            if (any(level%state%film <= 0.0_wp)) report%reason = 'film closed at T = 0: the ' &
               //'surfaces at their start are higher than the smooth film; '//report%reason
            if (.not. report%converged) return
            call remember(history, level, 0.0_wp)
            call evaluate_coefficients(level)
            call fill_state(contact, level, 0.0_wp, state)
         end if
         call start_follower(listener, contact, state, report)
         if (.not. report%converged) return
         if (.not. allocated(time%resume_from)) call hand_out(0)
         do step = history%step + 1, steps
            if (listener%wants_stop()) then
               call refuse(report, 'stopped from outside')
               return
            end if
            plan%step = step
            plan%ends = part_ends(plan%scheme, step, plan%length)
            call march_step(hierarchy, contact, plan, history, report)
            if (report%converged) call advance_follower(listener, plan, report)
            if (.not. report%converged) then
               call refuse(report, 'time step '//to_text(step)//' of '//to_text(steps)//' (T = '// &
                  to_text(step*plan%length)//'): '//report%reason//hints(contact, state))
               return
            end if
            call check_breakdown(level%x, level%state%film, settings, step, &
               step*plan%length, report)
            if (.not. report%converged) return
            report%fit%outlet_pressure = max(report%fit%outlet_pressure, &
               level%state%pressure(level%n - 1))
            history%step = step
            report%steps = step
            call hand_out(step)
         end do
      end associate
      report%converged = .true.
      report%reason = 'converged'

   contains

      !> Passes the state after a step and the state of the march to the listener.
      subroutine hand_out(step)
         integer, intent(in) :: step

         associate (level => hierarchy%levels(hierarchy%finest))
            call fill_state(contact, level, step*plan%length, state, listener%wants_stresses(step))
         end associate
         call report_cost(hierarchy, report)
         call listener%on_step(step, steps, state, history, report)
      end subroutine hand_out

   end subroutine march

   !> Starts the additional equations of a follower, if any. If it fails, the report is not
   !> converged.
   subroutine start_follower(listener, contact, state, report)
      class(listener_t), intent(inout) :: listener
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      character(:), allocatable :: reason

      if (.not. allocated(listener%follower)) return
      call listener%follower%start(contact, state, reason)
      if (allocated(reason)) call refuse(report, reason)
   end subroutine start_follower

   !> Advances the follower over the same parts of a step. If it fails, the report is not converged.
   subroutine advance_follower(listener, plan, report)
      class(listener_t), intent(inout) :: listener
      type(step_plan_t), intent(in) :: plan
      type(report_t), intent(inout) :: report
      character(:), allocatable :: reason
      integer :: i

      if (.not. plan%keeps_parts) return
      do i = 1, size(plan%parts)
         call listener%follower%advance(plan%parts(i), reason)
         if (allocated(reason)) call refuse(report, reason)
         if (allocated(reason)) return
      end do
   end subroutine advance_follower

   !> End of a reason: the smallest film of the last good step and its position, and the intervals
   !> in the finest wave of the surfaces, if too few. (A ridge of 1.2 central films and 12 intervals
   !> closes the film of Case 1 at any time step; on 46 it passes.)
   pure function hints(contact, state) result(words)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      character(:), allocatable :: words
      real(wp) :: share
      integer :: node

      node = minloc(state%film_thickness, 1)
      words = '; smallest film before it: H = '//to_text(state%film_thickness(node), 3) &
         //' at X = '//to_text(state%x(node), 4)
      share = real(contact%domain%intervals, wp)/intervals_for_waves(contact)
      if (share < 1.0_wp) words = words//'; the finest wave of the surfaces has ' &
         //to_text(share*min_in_wave, 2)//' intervals'
   end function hints

   !> Marks the report as not converged for a reason.
   pure subroutine refuse(report, reason)
      type(report_t), intent(inout) :: report
      character(*), intent(in) :: reason

      report%converged = .false.
      report%reason = reason
   end subroutine refuse

   !> Makes one step, in its parts; the history then begins with its end. A step of the start whose
   !> parts have no solution (a smoother on a fine grid) is made in one piece, and counted.
   subroutine march_step(hierarchy, contact, plan, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(step_plan_t), intent(inout) :: plan
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(march_state_t) :: start
      type(film_state_t) :: state

      if (size(plan%ends) == 1) then
         ! undivided steps are easier for a smoother than their parts
         if (history%lengths(1) < plan%length) history%way = 1
         call solve_parts(hierarchy, contact, plan, history, report)
         return
      end if
      start = history
      state = hierarchy%levels(hierarchy%finest)%state
      call solve_parts(hierarchy, contact, plan, history, report)
      if (report%converged) return
      history = start
      history%way = 1
      hierarchy%levels(hierarchy%finest)%state = state
      plan%ends = [1.0_wp]
      call solve_parts(hierarchy, contact, plan, history, report)
      report%fit%uncut_steps = report%fit%uncut_steps + 1
   end subroutine march_step

   !> Solves the parts of a step, each with the right sides of its end.
   subroutine solve_parts(hierarchy, contact, plan, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(step_plan_t), intent(inout) :: plan
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(error_t), allocatable :: error
      real(wp) :: length, new_time, weights(3)
      logical :: has_older
      integer :: part

      if (plan%keeps_parts) then
         if (allocated(plan%parts)) deallocate (plan%parts)
         allocate (plan%parts(size(plan%ends)))
      end if
      associate (level => hierarchy%levels(hierarchy%finest))
         do part = 1, size(plan%ends)
            length = plan%ends(part)*plan%length
            if (part > 1) length = length - plan%ends(part - 1)*plan%length
            new_time = (plan%step - 1 + plan%ends(part))*plan%length
            call move_profiles(contact, new_time, error)
            if (allocated(error)) then
               call refuse(report, error%message)
               return
            end if
            has_older = plan%scheme == 'bdf2' .and. history%size > 1
            weights = derivative_weights(length/merge(history%lengths(1), length, has_older), &
               has_older)/length
            level%inverse_time_step = weights(1)
            level%rhs_reynolds = level%lambda*(weights(2)*history%mass(:, 1) &
               + weights(3)*history%mass(:, 2))
            level%rhs_film = level%gap - roughness_at(contact, level, new_time)
            call solve_step(hierarchy, plan%attempts, length, history, report)
            if (.not. report%converged) return
            call remember(history, level, length)
            if (plan%keeps_parts) plan%parts(part) = time_part_t(weights, length, &
               reshape([surface_height(contact%surface_1, level%x, new_time), &
               surface_height(contact%surface_2, level%x, new_time)], [level%n + 1, 2]), &
               level%state)
         end do
      end associate
   end subroutine solve_parts

   !> Solves one part of `length`: from the better prediction by the history, then from all of the
   !> history if that differs, then from the old pressure by each relaxation in turn; FAS begins
   !> with the relaxation that solved the last step. If a fast feature has closed the film under the
   !> old pressure, the film is raised to give the cycles a positive start.
   subroutine solve_step(hierarchy, attempts, length, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(relaxation_t), intent(in) :: attempts(:)
      real(wp), intent(in) :: length
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      real(wp) :: old_minimum, rise
      integer :: attempt, first, count

      associate (state => hierarchy%levels(hierarchy%finest)%state)
         old_minimum = minval(state%film)
         first = min(history%way, size(attempts))
         count = predictors(history)
         do attempt = merge(first - 1, first - 2, count == history%size), size(attempts)
            if (attempt == first - 1) count = history%size
            call adopt(hierarchy, attempts(max(attempt, first)))
            if (attempt < first) then
               call extrapolate(history, count, length, state)
            else
               state%pressure = history%pressure(:, 1)
               state%rigid_displacement = history%rigid_displacement(1)
            end if
            call set_film(hierarchy%levels(hierarchy%finest))
            if (any(state%film <= 0.0_wp)) then
               if (attempt < first) cycle
               rise = 0.5_wp*old_minimum - minval(state%film)
               state%film = state%film + rise
               state%rigid_displacement = state%rigid_displacement + rise
            end if
            if (attempts(max(attempt, first))%thesis_first) then
               hierarchy%levels(hierarchy%finest)%is_kappa = .false.
               call iterate(hierarchy, report)
               hierarchy%levels(hierarchy%finest)%is_kappa = .true.
            end if
            call iterate(hierarchy, report)
            if (.not. report%converged) cycle
            if (attempts(1)%method == method_fas) history%way = max(attempt, first)
            return
         end do
      end associate
   end subroutine solve_step

   !> Number of last solutions that best predict the next one: all, or only the newest if the line
   !> through the two before missed it (features that move by a spacing or more in a step). In 48
   !> transients with dT = dX this saves 20 % of the cycles on 64 intervals, 10 % on 128, 3 % on
   !> 256.
   pure integer function predictors(history) result(count)
      type(march_state_t), intent(in) :: history
      real(wp) :: weights(3)

      count = history%size
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

   !> Adds the present solution, at the end of a step of `length`, to the history.
   pure subroutine remember(history, level, length)
      type(march_state_t), intent(inout) :: history
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: length

      if (.not. allocated(history%pressure)) allocate (history%pressure(0:level%n, 3), &
         history%mass(0:level%n, 2), source=0.0_wp)
      history%pressure(:, 3) = history%pressure(:, 2)
      history%pressure(:, 2) = history%pressure(:, 1)
      history%pressure(:, 1) = level%state%pressure
      history%lengths = [length, history%lengths(1)]
      history%rigid_displacement = [level%state%rigid_displacement, history%rigid_displacement(1:2)]
      call fluid_density(level%fluid, level%state%pressure, level%oil%density)
      history%mass(:, 2) = history%mass(:, 1)
      history%mass(:, 1) = level%oil%density*level%state%film
      history%size = min(history%size + 1, 3)
   end subroutine remember

end module ehl_line_transient

!> Time steps of the lubricated line contact, with Psi_1, Psi_2 at the new time:
!>
!>     backward Euler  lambda d(rho H)/dT = lambda/dT ( rho H - (rho H)_old )
!>     BDF2            lambda d(rho H)/dT = lambda/(2 dT) (3 rho H - 4 (rho H)_old + (rho H)_older)
!>
!> Both have the form lambda/dT_eff ( rho H - F ). BDF2 begins with a short step of backward Euler
!> and reaches its full step over several parts (module march_state).
!>
!> Load, radius and speeds may change in time (module duty): steps are divided where they have a
!> kink, and by an error estimate, and the film is kept in the direction of the flow, so that the
!> wedge is taken from upstream. `quasi_steady` leaves the squeeze term out.
!>
!> At T = 0 pressure and H0 are those of the smooth steady contact; the surfaces enter the old film
!> without a new solve. Later steps start from a prediction by the last solutions.
module ehl_line_transient
   use cycle_control, only: iterate
   use duty, only: duty_t, span_of
   use errors, only: error_t
   use features, only: surface_height
   use film_breakdown, only: check_breakdown
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: intervals_for_waves, line_contact_t, min_in_wave, move_profiles, &
      rough_contact_t, solver_settings_t, time_settings_t, word_length
   use line_hierarchy, only: line_hierarchy_t, method_fas, relaxation_t, report_cost, &
      roughness_at, set_moment
   use line_level, only: line_level_t, set_film, share_pressure, thin_oil, total_pressure, turn
   use line_state, only: line_state_t
   use film_state, only: film_state_t
   use listener, only: listener_t
   use lubricant, only: fluid_density
   use march_state, only: extrapolate, judge_part, keep_solution, least_part, march_state_t, &
      most_parts, next_end, part_ends, predictors, step_error, step_weights, &
      time_part_t, turn_history
   use reynolds_line, only: evaluate_coefficients
   use solver_choice, only: adopt, note_choice, time_step_attempts
   use state_output, only: fill_state
   use text, only: counted, to_text
   implicit none (type, external)
   private

   public :: cut_at_kinks, judge_cycles, look_back, march

   !> A time step and how it is solved.
   type :: step_plan_t
      !> Relaxations to try, in this order.
      type(relaxation_t), allocatable :: attempts(:)
      !> Number of the step, its length, the scheme, the begin of its first part and the ends of its
      !> parts as shares of the length.
      integer :: step = 0
      real(wp) :: length = 0.0_wp, first = 0.0_wp
      character(len=word_length) :: scheme = ''
      real(wp), allocatable :: ends(:)
      !> Bound on the error of a part; 0: parts are given.
      real(wp) :: tolerance = 0.0_wp
      !> How many more parts may have no solution, of all steps.
      integer :: failures_left = huge(1)
      !> Its parts once solved, if a follower needs them.
      logical :: keeps_parts = .false.
      type(time_part_t), allocatable :: parts(:)
   end type step_plan_t

   !> Where oil fills a cavity, at its front, a node fills in a moment of no order: the error counts
   !> above this share of the largest pressure.
   real(wp), parameter :: fronts = 1.0e-3_wp
   !> Where the film is thinner than this share of it at both neighbours, the grid does not hold it.
   real(wp), parameter :: held = 0.5_wp
   !> Parts without a solution after which a coarse run is given up: it would need many more.
   integer, parameter :: coarse_failures = 100
   !> A kink nearer to an end of a step than this share of it does not divide the step: a part of
   !> hardly any length has no slope but that of rounding.
   real(wp), parameter :: nearest_kink = 1.0e-3_wp
   !> The film at the end of a cycle repeats the one before within this share; most cycles.
   real(wp), parameter :: same_film = 1.0e-3_wp, most_cycles = 20.0_wp

contains

   !> Marches from the smooth steady solution on the finest level, whose film the surfaces then
   !> enter without a new solve, or from where an earlier run stopped, to `time%end_time` with the
   !> step of `choose_time_step`, or until a film repeats itself; the listener receives each step.
   !> Ends early, not converged, if a step has no solution or the heights of a surface cannot be
   !> read; `state` is then the last good one. The profiles must be loaded for the start.
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
      integer :: steps

      allocate (plan%attempts, source=time_step_attempts(contact, settings, &
         has_parts=time%tolerance > 0.0_wp))
      call note_choice(report, plan%attempts(1))
      plan%length = time%time_step
      plan%scheme = time%scheme
      plan%tolerance = time%tolerance
      if (.not. settings%explains_failure) plan%failures_left = coarse_failures
      plan%keeps_parts = allocated(listener%follower)
      steps = nint(time%end_time/time%time_step)
      associate (level => hierarchy%levels(hierarchy%finest))
         call listener%on_stage('time steps on '//to_text(level%n)//' intervals')
         if (allocated(time%resume_from)) then
            history = time%resume_from
            steps = max(steps, history%steps)
            if (abs(history%direction - level%direction) > 1.0_wp) call turn(level)
            level%rhs_film = level%gap - roughness_at(contact, level, history%step*plan%length)
            call restore(level, history)
            call fill_state(contact, level, history%step*plan%length, state)
         else
            level%rhs_film = level%gap - roughness_at(contact, level, 0.0_wp)
            call set_film(level)
            call check_breakdown(level%direction*level%x, level%state%film, settings, 0, &
               0.0_wp, report)
            if (.not. report%converged) return
            call remember(history, level, 0.0_wp)
            call evaluate_coefficients(level)
            call fill_state(contact, level, 0.0_wp, state)
         end if
         call start_follower(listener, contact, state, report)
         if (.not. report%converged) return
         if (.not. allocated(time%resume_from)) call hand_out()
         do while (history%step < steps)
            if (listener%wants_stop()) then
               call refuse(report, 'stopped from outside')
               return
            end if
            plan%step = history%step + 1
            call divide_step(contact, plan)
            call march_step(hierarchy, contact, plan, listener, history, report)
            if (report%converged) call advance_follower(listener, plan, report)
            if (.not. report%converged) then
               call refuse(report, 'time step '//to_text(plan%step)//' of '//to_text(steps)// &
                  ' (T = '//to_text(plan%step*plan%length)//'): '//report%reason &
                  //hints(contact, state))
               return
            end if
            call check_breakdown(level%direction*level%x, level%state%film, settings, plan%step, &
               plan%step*plan%length, report)
            if (.not. report%converged) return
            report%fit%outlet_pressure = max(report%fit%outlet_pressure, &
               level%state%pressure(level%n - 1))
            history%step = plan%step
            report%steps = plan%step
            ! the last state as a run that resumes here finds it, to the bit
            if (history%step == steps) call derive(level, history)
            call hand_out()
         end do
      end associate
      call judge_cycles(history, contact, steps*plan%length, report)

   contains

      !> Passes the state after a step and the state of the march to the listener.
      subroutine hand_out()
         call fill_state(contact, hierarchy%levels(hierarchy%finest), history%step*plan%length, &
            state, listener%wants_stresses(history%step))
         if (time%may_lengthen) call look_back(state, nint(span_of(contact%duty)/plan%length), &
            history, steps)
         call report_cost(hierarchy, report)
         call listener%on_step(history%step, steps, state, history, report)
      end subroutine hand_out

   end subroutine march

   !> At the end of a cycle compares its film with that of the last one; adds a cycle to the `steps`
   !> if it would be the last and does not repeat that.
   pure subroutine look_back(state, cycle_steps, history, steps)
      type(line_state_t), intent(in) :: state
      integer, intent(in) :: cycle_steps
      type(march_state_t), intent(inout) :: history
      integer, intent(inout) :: steps

      if (modulo(history%step, cycle_steps) /= 0) return
      if (history%step > 0) history%cycle_change = maxval(abs(state%film_thickness &
         /history%cycle_film - 1), state%pressure > 0.0_wp)
      history%cycle_film = state%film_thickness
      if (history%step == steps .and. history%cycle_change > same_film &
         .and. steps < most_cycles*cycle_steps) steps = steps + cycle_steps
      history%steps = steps
   end subroutine look_back

   !> Reports a march up to `end_time` as converged, unless its last cycle changed the film.
   subroutine judge_cycles(history, contact, end_time, report)
      type(march_state_t), intent(in) :: history
      class(rough_contact_t), intent(in) :: contact
      real(wp), intent(in) :: end_time
      type(report_t), intent(inout) :: report

      report%converged = .true.
      report%reason = 'converged'
      if (history%cycle_change > same_film) call refuse(report, 'the film does not repeat '// &
         'itself: the last of '//to_text(nint(end_time/span_of(contact%duty)))// &
         ' cycles changed it by '//to_text(100*history%cycle_change, 2)//' %')
   end subroutine judge_cycles

   !> Restores the last solution of a history on its level.
   subroutine restore(level, history)
      type(line_level_t), intent(inout) :: level
      type(march_state_t), intent(in) :: history

      level%state%film = history%film
      if (level%direction < 0.0_wp) level%state%film(:) = history%film(level%n:0:-1)
      call derive(level, history)
   end subroutine restore

   !> Sets on a level with the last film of a history all that follows from its last solution.
   subroutine derive(level, history)
      type(line_level_t), intent(inout) :: level
      type(march_state_t), intent(in) :: history
      integer :: products

      level%state%pressure = history%pressure(:, 1)
      level%state%rigid_displacement = history%rigid_displacement(1)
      products = level%elastic%products
      if (allocated(level%rough)) call share_pressure(level)
      level%elastic%products = products   ! counted where it was solved
      if (allocated(level%heat)) then
         level%heat%rise(:, :) = history%rise
         call thin_oil(level)
      end if
      call evaluate_coefficients(level)
      if (allocated(level%oil%saturation)) level%oil%saturation = history%mass(:, 1) &
         /(level%oil%density*level%state%film)
   end subroutine derive

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

   !> End of a reason: the smallest film of the last good step and its position, whether the grid
   !> does not hold it, and the intervals in the finest wave of the surfaces, if too few. (A ridge
   !> of 1.2 central films and 12 intervals closes the film of Case 1 at any time step; on 46 it
   !> passes.)
   pure function hints(contact, state) result(words)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      character(:), allocatable :: words
      real(wp) :: share
      integer :: node

      node = minloc(state%film_thickness, 1)
      words = '; smallest film before it: H = '//to_text(state%film_thickness(node), 3) &
         //' at X = '//to_text(state%x(node), 4)
      associate (h => state%film_thickness, last => size(state%x))
         if (h(node) < held*min(h(max(node - 1, 1)), h(min(node + 1, last)))) words = words// &
            ', where it closes between two nodes: it takes more &domain intervals'
      end associate
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
   subroutine march_step(hierarchy, contact, plan, listener, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(step_plan_t), intent(inout) :: plan
      class(listener_t), intent(inout) :: listener
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(march_state_t) :: start
      type(film_state_t) :: state

      if (plan%tolerance > 0.0_wp) then
         call march_by_error(hierarchy, contact, plan, listener, history, report)
         return
      end if
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

   !> Divides a step: into the parts of its scheme, unless an error estimate will do that, and where
   !> the duty of the contact has kinks.
   pure subroutine divide_step(contact, plan)
      type(line_contact_t), intent(in) :: contact
      type(step_plan_t), intent(inout) :: plan

      plan%ends = [1.0_wp]
      if (.not. plan%tolerance > 0.0_wp) plan%ends = part_ends(plan%scheme, plan%step, plan%length)
      if (allocated(contact%duty)) call cut_at_kinks(contact%duty, (plan%step - 1)*plan%length, &
         plan%length, plan%ends)
   end subroutine divide_step

   !> Cuts the step of a `length` after `begin`, with the `ends` of its parts, shares of it, where
   !> the duty changes its slope.
   pure subroutine cut_at_kinks(duty, begin, length, ends)
      type(duty_t), intent(in) :: duty
      real(wp), intent(in) :: begin, length
      real(wp), allocatable, intent(inout) :: ends(:)
      integer :: i

      associate (cuts => (duty%kinks(begin, begin + length) - begin)/length)
         do i = 1, size(cuts)
            if (min(cuts(i), 1 - cuts(i)) < nearest_kink) cycle
            if (any(abs(ends - cuts(i)) < least_part)) cycle
            ends = [pack(ends, ends < cuts(i)), cuts(i), pack(ends, ends > cuts(i))]
         end do
      end associate
   end subroutine cut_at_kinks

   !> Makes one step, dividing its parts until their error is within the tolerance of the plan. The
   !> listener receives the state between parts: an extreme may last shorter than a step.
   subroutine march_by_error(hierarchy, contact, plan, listener, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(step_plan_t), intent(inout) :: plan
      class(listener_t), intent(inout) :: listener
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(march_state_t) :: start
      type(step_plan_t) :: part
      type(film_state_t) :: state
      type(line_state_t) :: between
      real(wp) :: error, length
      integer :: i, parts_made
      logical :: is_good

      part = plan
      parts_made = 0
      associate (level => hierarchy%levels(hierarchy%finest))
         do i = 1, size(plan%ends)
            parts: do while (part%first < plan%ends(i))
               if (parts_made == most_parts) then
                  call refuse(report, 'its error is too large in '//counted(most_parts, 'part'))
                  return
               end if
               parts_made = parts_made + 1
               start = history
               state = level%state
               part%ends = [next_end(history, part%first, plan%ends(i), plan%length)]
               length = (part%ends(1) - part%first)*plan%length
               call solve_parts(hierarchy, contact, part, history, report)
               error = huge(error)
               if (report%converged) error = step_error(history, level%state%pressure, &
                  merge(fronts, 0.0_wp, allocated(level%oil%saturation)))
               call judge_part(history, error, length, plan%tolerance, is_good)
               if (is_good .or. (report%converged .and. length < least_part)) then
                  part%first = part%ends(1)
                  if (part%first >= 1.0_wp) exit parts
                  call fill_state(contact, level, (plan%step - 1 + part%first)*plan%length, between)
                  call listener%on_part(between)
                  cycle parts
               end if
               if (.not. report%converged) plan%failures_left = plan%failures_left - 1
               if (length < least_part .or. plan%failures_left < 0) return
               start%next_length = history%next_length
               history = start
               level%state = state
            end do parts
         end do
      end associate
   end subroutine march_by_error

   !> Solves the parts of a step, each with the right sides of its end.
   subroutine solve_parts(hierarchy, contact, plan, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(step_plan_t), intent(inout) :: plan
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(error_t), allocatable :: error
      real(wp) :: length, new_time, weights(3)
      integer :: part

      if (plan%keeps_parts) then
         if (allocated(plan%parts)) deallocate (plan%parts)
         allocate (plan%parts(size(plan%ends)))
      end if
      associate (level => hierarchy%levels(hierarchy%finest))
         do part = 1, size(plan%ends)
            length = plan%ends(part)*plan%length
            if (part > 1) length = length - plan%ends(part - 1)*plan%length
            if (part == 1) length = length - plan%first*plan%length
            new_time = (plan%step - 1 + plan%ends(part))*plan%length
            call move_profiles(contact, new_time, error)
            if (allocated(error)) then
               call refuse(report, error%message)
               return
            end if
            call set_moment(hierarchy, contact, new_time)
            if (history%direction*level%direction < 0.0_wp) call turn_history(history)
            weights = step_weights(history, plan%scheme, length)
            level%inverse_time_step = weights(1)
            level%rhs_reynolds = level%lambda*(weights(2)*history%mass(:, 1) &
               + weights(3)*history%mass(:, 2))
            level%rhs_film = level%gap - roughness_at(contact, level, new_time)
            if (allocated(level%heat)) level%heat%share = 0.0_wp   ! as in a resumed run
            if (allocated(level%heat)) level%heat%change = 0.0_wp
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
         do attempt = merge(first - 1, first - 2, count == min(history%size, 3)), size(attempts)
            if (attempt == first - 1) count = min(history%size, 3)
            call adopt(hierarchy, attempts(max(attempt, first)))
            if (attempt < first) then
               call extrapolate(history, count, length, state)
            else
               state%pressure = history%pressure(:, 1)
               state%rigid_displacement = history%rigid_displacement(1)
            end if
            if (allocated(state%separation)) then
               call share_pressure(hierarchy%levels(hierarchy%finest))
            else
               call set_film(hierarchy%levels(hierarchy%finest))
            end if
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

   !> Adds the present solution, at the end of a step of `length`, to the history.
   pure subroutine remember(history, level, length)
      type(march_state_t), intent(inout) :: history
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: length

      call fluid_density(level%fluid, level%state%pressure, level%oil%density)
      call keep_solution(history, length, total_pressure(level), level%state%rigid_displacement, &
         level%oil%density*level%state%film)
      if (allocated(level%oil%saturation)) history%mass(:, 1) = history%mass(:, 1) &
         *level%oil%saturation
      if (allocated(level%heat)) history%rise = level%heat%rise
      history%direction = level%direction
   end subroutine remember

end module ehl_line_transient

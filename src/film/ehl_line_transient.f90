!> Time steps of the lubricated line contact, with Psi_1, Psi_2 at the new time:
!>
!>     backward Euler  lambda d(rho H)/dT = lambda/dT ( rho H - (rho H)_old )
!>     BDF2            lambda d(rho H)/dT = lambda/(2 dT) (3 rho H - 4 (rho H)_old + (rho H)_older)
!>
!> Both have the form lambda/dT_eff ( rho H - F ). BDF2 begins with a short step of backward Euler
!> and goes over to whole steps by parts of them (module time_scheme).
!>
!> At T = 0 pressure and H0 are those of the smooth steady contact; the surfaces enter the old film
!> without a new solve.
module ehl_line_transient
   use cycle_control, only: iterate
   use cycle_limits, only: cycle_limits_t
   use errors, only: error_t
   use film_breakdown, only: look_for_breakdown
   use film_equation, only: take_film
   use film_state, only: film_state_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: min_in_wave, intervals_for_waves, line_contact_t, move_profiles
   use line_hierarchy, only: line_hierarchy_t, method_fas, relaxation_t, roughness_at, &
      total_products
   use line_level, only: line_level_t
   use line_state, only: line_state_t
   use march_history, only: extrapolate, foretelling, remember
   use march_state, only: march_state_t
   use observer, only: observer_t
   use solver_choice, only: adopt, limits_of, note_choice, time_step_attempts
   use solver_settings, only: solver_settings_t, step_tolerance, time_settings_t, word_length
   use state_output, only: fill_state
   use step_choice, only: count_steps
   use text, only: to_text
   use time_scheme, only: derivative_weights, part_ends
   implicit none (type, external)
   private

   public :: march

   !> Default bound on the cycles of a time step.
   integer, parameter :: default_cycles = 40

   !> A time step and how it is solved.
   type :: step_plan_t
      !> The ways that are tried, and when each ends.
      type(relaxation_t), allocatable :: attempts(:)
      type(cycle_limits_t) :: limits
      !> Number of the step, its length, the scheme, and where its parts end, as shares of the
      !> length.
      integer :: step = 0
      real(wp) :: length = 0.0_wp
      character(len=word_length) :: scheme = ''
      real(wp), allocatable :: ends(:)
   end type step_plan_t

contains

   !> Marches from the smooth steady solution on the finest level, or from where an earlier run
   !> stood, to `time%end_time`, with a step from `choose_time_step`; the observer gets every step.
   !> Ends early, not converged, where a step finds no solution, or the heights of a surface cannot
   !> be read any more; `state` is then the last good one. The profiles are at hand where it begins.
   subroutine march(hierarchy, contact, settings, time, watcher, state, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(observer_t), intent(inout) :: watcher
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report
      type(march_state_t) :: history
      type(step_plan_t) :: plan
      real(wp) :: time_step
      integer :: step, steps

      allocate (plan%attempts, source=time_step_attempts(contact, settings))
      plan%limits = limits_of(settings, step_tolerance, plan%attempts(1)%method)
      if (settings%max_cycles == 0) plan%limits%max_cycles = min(plan%limits%max_cycles, &
         default_cycles)
      call note_choice(report, plan%attempts(1), plan%limits)
      associate (level => hierarchy%levels(hierarchy%finest))
         time_step = time%time_step
         plan%length = time_step
         plan%scheme = time%scheme
         steps = count_steps(time)
         call watcher%on_stage('time steps on '//to_text(level%n)//' intervals')
         if (allocated(time%resume_from)) then
            history = time%resume_from
            call take_up(history, level%state)
            call fill_state(contact, level, history%step*time_step, state)
         else
            call begin_march(contact, settings, hierarchy, history, report)
            if (.not. report%converged) return
            call fill_state(contact, level, 0.0_wp, state)
            call watcher%on_step(0, steps, state, report)
            call hand_out(history, hierarchy, report, watcher)
         end if
         do step = history%step + 1, steps
            if (watcher%wants_stop) then
               call refuse(report, 'stopped from outside')
               return
            end if
            plan%step = step
            plan%ends = part_ends(plan%scheme, step, time_step)
            call take_step(hierarchy, contact, plan, history, report)
            if (.not. report%converged) then
               call refuse(report, 'time step '//to_text(step)//' of '//to_text(steps)//' (T = '// &
                  to_text(step*time_step)//'): '//report%reason//smallest_film_text(state) &
                     //coarse_wave_text(contact))
               return
            end if
            call look_for_breakdown(level%x, level%state%film, settings, step, step*time_step, &
               report)
            if (.not. report%converged) return
            report%outlet_pressure = max(report%outlet_pressure, level%state%pressure(level%n - 1))
            history%step = step
            report%steps = step
            call fill_state(contact, level, step*time_step, state)
            call watcher%on_step(step, steps, state, report)
            call hand_out(history, hierarchy, report, watcher)
         end do
      end associate
      report%converged = .true.
      report%reason = 'converged'
   end subroutine march

   !> T = 0: the surfaces enter the film of the smooth contact, without a new solve.
   subroutine begin_march(contact, settings, hierarchy, history, report)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report

      associate (level => hierarchy%levels(hierarchy%finest))
         level%rhs_film = 0.5_wp*level%x**2 - roughness_at(contact, level, 0.0_wp)
         call take_film(level)
         call look_for_breakdown(level%x, level%state%film, settings, 0, 0.0_wp, report)
         if (any(level%state%film <= 0.0_wp)) report%reason = &
            'film closed at T = 0: the surfaces '// &
            'at their start are higher than '// &
            'the smooth film; '//report%reason
         call remember(history, contact, level, 0.0_wp)
      end associate
   end subroutine begin_march

   !> Where the film of the last good step is smallest, as the end of a reason.
   pure function smallest_film_text(state) result(words)
      type(line_state_t), intent(in) :: state
      character(:), allocatable :: words
      integer :: node

      node = minloc(state%film_thickness, 1)
      words = '; smallest film before it: H = '//to_text(state%film_thickness(node), 3) &
         //' at X = '//to_text(state%x(node), 4)
   end function smallest_film_text

   !> How many intervals the finest wave of the surfaces has, as the end of a reason; empty where
   !> these are enough. (A ridge of 1.2 central films and 12 intervals closes the film of Case 1
   !> whatever the time step; on 46 it passes.)
   pure function coarse_wave_text(contact) result(words)
      type(line_contact_t), intent(in) :: contact
      character(:), allocatable :: words
      real(wp) :: share

      words = ''
      share = real(contact%domain%intervals, wp)/intervals_for_waves(contact)
      if (share < 1.0_wp) words = '; the finest wave of the surfaces has ' &
         //to_text(share*min_in_wave, 2)//' intervals'
   end function coarse_wave_text

   !> Gives the observer where the transient stands, if it wants that.
   subroutine hand_out(history, hierarchy, report, watcher)
      type(march_state_t), intent(inout) :: history
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(report_t), intent(in) :: report
      class(observer_t), intent(inout) :: watcher

      if (.not. watcher%wants_state) return
      history%film = hierarchy%levels(hierarchy%finest)%state%film
      history%report = report
      history%report%fft_pairs = report%fft_pairs + total_products(hierarchy)
      history%report%work_units = hierarchy%work_units
      call watcher%keep_state(history)
   end subroutine hand_out

   !> The newest solution of `history` becomes the state.
   pure subroutine take_up(history, state)
      type(march_state_t), intent(in) :: history
      type(film_state_t), intent(inout) :: state

      state%pressure = history%pressure(:, 1)
      state%film = history%film
      state%rigid_displacement = history%rigid_displacement(1)
   end subroutine take_up

   !> Marks the report as not converged for a reason.
   pure subroutine refuse(report, reason)
      type(report_t), intent(inout) :: report
      character(*), intent(in) :: reason

      report%converged = .false.
      report%reason = reason
   end subroutine refuse

   !> One step, in its parts; the history then begins with its end. A step of the start whose parts
   !> find no solution (a smoother on a fine grid) is taken whole, and counted.
   subroutine take_step(hierarchy, contact, plan, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(step_plan_t), intent(in) :: plan
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(step_plan_t) :: whole
      type(march_state_t) :: start
      type(film_state_t) :: state

      if (size(plan%ends) == 1) then
         ! whole steps are easier for a smoother than their parts
         if (history%lengths(1) < plan%length) history%way = 1
         call take_parts(hierarchy, contact, plan, history, report)
         return
      end if
      start = history
      state = hierarchy%levels(hierarchy%finest)%state
      call take_parts(hierarchy, contact, plan, history, report)
      if (report%converged) return
      history = start
      history%way = 1
      hierarchy%levels(hierarchy%finest)%state = state
      whole = plan
      whole%ends = [1.0_wp]
      call take_parts(hierarchy, contact, whole, history, report)
      report%uncut_steps = report%uncut_steps + 1
   end subroutine take_step

   !> The parts of a step.
   subroutine take_parts(hierarchy, contact, plan, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(inout) :: contact
      type(step_plan_t), intent(in) :: plan
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(error_t), allocatable :: error
      real(wp) :: length, new_time
      integer :: part

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
            call begin_step(contact, level, history, new_time, length, plan%scheme)
            call solve_step(hierarchy, contact, plan, length, history, report)
            if (.not. report%converged) return
            call remember(history, contact, level, length)
         end do
      end associate
   end subroutine take_parts

   !> Right sides of the part of `length` to `new_time`.
   subroutine begin_step(contact, level, history, new_time, length, scheme)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(inout) :: level
      type(march_state_t), intent(in) :: history
      real(wp), intent(in) :: new_time, length
      character(*), intent(in) :: scheme
      real(wp) :: weights(3)
      logical :: has_older

      has_older = scheme == 'bdf2' .and. history%size > 1
      weights = derivative_weights(length/merge(history%lengths(1), length, has_older), &
         has_older)/length
      level%inverse_time_step = weights(1)
      level%rhs_reynolds = contact%lambda*(weights(2)*history%mass(:, &
         1) + weights(3)*history%mass(:, 2))
      level%rhs_film = 0.5_wp*level%x**2 - roughness_at(contact, level, new_time)
   end subroutine begin_step

   !> One part of `length`: from the better guess by the past, then by all of it if that was
   !> another, then from the old pressure, each way in turn; relaxations of one method begin with
   !> the one that found the last step.
   subroutine solve_step(hierarchy, contact, plan, length, history, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(step_plan_t), intent(in) :: plan
      real(wp), intent(in) :: length
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      real(wp) :: old_minimum
      integer :: attempt, first, count

      associate (level => hierarchy%levels(hierarchy%finest))
         old_minimum = minval(level%state%film)
         first = min(history%way, size(plan%attempts))
         count = foretelling(history)
         do attempt = merge(first - 1, first - 2, count == history%size), size(plan%attempts)
            if (attempt == first - 1) count = history%size
            call adopt(hierarchy, plan%attempts(max(attempt, first)))
            if (attempt < first) then
               call extrapolate(history, count, length, level%state)
            else
               level%state%pressure = history%pressure(:, 1)
               level%state%rigid_displacement = history%rigid_displacement(1)
            end if
            call take_film(level)
            if (any(level%state%film <= 0.0_wp)) then
               if (attempt < first) cycle
               call lift(level%state, old_minimum)
            end if
            call iterate(hierarchy, contact, plan%limits, report)
            if (report%converged) then
               if (plan%attempts(1)%method == method_fas) history%way = max(attempt, first)
               return
            end if
         end do
      end associate
   end subroutine solve_step

   !> Raises a film that a fast feature has closed under the old pressure, so that the cycles have a
   !> positive start.
   pure subroutine lift(state, film)
      type(film_state_t), intent(inout) :: state
      real(wp), intent(in) :: film
      real(wp) :: rise

      rise = 0.5_wp*film - minval(state%film)
      state%film = state%film + rise
      state%rigid_displacement = state%rigid_displacement + rise
   end subroutine lift

end module ehl_line_transient

!> Time steps of the point contact, those of a line contact (module ehl_line_transient): BDF2 or
!> backward Euler from the smooth steady solution, whose film the surfaces enter at T = 0 without a
!> new solve; later steps start from a prediction by the last solutions.
module point_march
   use duty, only: span_of
   use ehl_line_transient, only: cut_at_kinks, judge_cycles, look_back
   use errors, only: error_t
   use film_breakdown, only: check_breakdown
   use iteration_report, only: phase_steady, phase_transient, report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use film_state, only: film_state_t
   use line_contact, only: step_tolerance
   use listener, only: listener_t, relay_t
   use lubricant, only: fluid_density
   use march_state, only: extrapolate, judge_part, keep_solution, march_state_t, most_parts, &
      least_part, next_end, part_ends, predictors, step_error, step_weights, turn_history
   use point_contact, only: point_contact_t, set_point_moment, start_of
   use point_level, only: point_level_t, set_point_film, set_surfaces, turn_nodes
   use point_newton, only: solve_point_newton
   use point_quantities, only: fill_heights, fill_point_state
   use point_solver, only: coarseness, pairs_of, point_run_t, solve_point_steady, tolerance_of
   use text, only: to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_point

contains

   !> Solves the steady contact, smooth if it is the start of a passage, and the passage; `state` is
   !> that at the end. Not converging is in the report. Error (internal_error): LAPACK or FFTW.
   subroutine solve_point(run, contact, listener, state, report, error)
      type(point_run_t), intent(inout) :: run
      type(point_contact_t), intent(inout) :: contact
      class(listener_t), intent(inout), target :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(point_contact_t) :: start
      real(wp) :: begin

      begin = wall_seconds()
      start = contact
      if (run%time%is_transient) start = start_of(contact)
      call solve_point_steady(run, start, listener, report, error)
      if (allocated(error)) return
      contact%domain = start%domain
      associate (seconds => report%cost%phase_seconds)
         seconds(phase_steady) = wall_seconds() - begin
         call fill_point_state(run%newton%hierarchy%levels(1), start, 0.0_wp, state)
         if (report%converged .and. run%time%is_transient) then
            begin = wall_seconds()
            if (allocated(run%time%resume_from)) report = run%time%resume_from%report
            report%numbers%levels = size(run%newton%hierarchy%levels)
            call march_point(run, contact, listener, state, report)
            seconds(phase_transient) = seconds(phase_transient) + wall_seconds() - begin
         else if (report%converged) then
            call check_breakdown(state%x, state%film_thickness, run%settings, 0, 0.0_wp, report, &
               state%y)
         end if
      end associate
      call fill_heights(contact, state)
   end subroutine solve_point

   !> Marches from the steady solution of `run`, or from where an earlier run stopped, to its end
   !> time; the listener receives each step. Ends early, not converged, if a step has no
   !> solution; `state` is then the last good one.
   subroutine march_point(run, contact, listener, state, report)
      type(point_run_t), intent(inout) :: run
      type(point_contact_t), intent(inout) :: contact
      class(listener_t), intent(inout), target :: listener
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report
      type(march_state_t) :: history
      integer :: steps

      steps = nint(run%time%end_time/run%time%time_step)
      if (allocated(run%time%resume_from)) history = run%time%resume_from
      steps = max(steps, history%steps)
      associate (level => run%newton%hierarchy%levels(1), time => run%time)
         call listener%on_stage('time steps on '//to_text(level%nx)//' x '//to_text(level%ny) &
            //' intervals')
         allocate (level%old_squeeze, mold=level%film)
         if (history%size > 0) then
            level%pressure = reshape(history%pressure(:, 1), shape(level%pressure))
            level%rigid_displacement = history%rigid_displacement(1)
            if (history%direction*level%direction < 0.0_wp) call turn_nodes(level)
         end if
         call set_point_moment(contact, history%step*time%time_step)
         call set_surfaces(level, contact, history%step*time%time_step)
         call set_point_film(level)
         if (history%size == 0) then
            call check_film(0)
            if (.not. report%converged) return
         end if
         call fill_point_state(level, contact, history%step*time%time_step, state)
         if (history%size == 0) then
            call remember(history, contact, level, 0.0_wp)
            call hand_out()
         end if
         do while (history%step < steps)
            if (listener%wants_stop()) then
               report%converged = .false.
               report%reason = 'stopped from outside'
               return
            end if
            call march_step(run, contact, listener, history, report)
            if (.not. report%converged) return
            call check_film(history%step + 1)
            if (.not. report%converged) return
            history%step = history%step + 1
            report%steps = history%step
            ! the last film as a run that resumes here finds it, to the bit
            if (history%step == steps) call set_point_film(level)
            call fill_point_state(level, contact, history%step*time%time_step, state)
            call hand_out()
         end do
      end associate
      call judge_cycles(history, contact, steps*run%time%time_step, report)

   contains

      !> Records a film below its floor at the end of a `step`.
      subroutine check_film(step)
         integer, intent(in) :: step

         associate (level => run%newton%hierarchy%levels(1))
            call check_breakdown(level%direction*level%x, reshape(level%film, &
               [size(level%film)]), run%settings, step, step*run%time%time_step, report, &
               level%direction*level%y)
         end associate
      end subroutine check_film

      !> Passes the state after a step and that of the march to the listener.
      subroutine hand_out()

         call fill_heights(contact, state)
         if (run%time%may_lengthen) call look_back(state, nint(span_of(contact%duty) &
            /run%time%time_step), history, steps)
         call listener%on_step(history%step, steps, state, history, report)
      end subroutine hand_out

   end subroutine march_point

   !> Makes the next step in the parts of its scheme, or divides it until their error is within the
   !> tolerance; the listener receives the state between such parts.
   subroutine march_step(run, contact, listener, history, report)
      type(point_run_t), intent(inout) :: run
      type(point_contact_t), intent(inout) :: contact
      class(listener_t), intent(inout), target :: listener
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(march_state_t) :: start
      type(line_state_t) :: between
      real(wp), allocatable :: ends(:)
      real(wp) :: error, first, last, length
      integer :: i, parts
      logical :: is_good

      associate (time => run%time, level => run%newton%hierarchy%levels(1))
         ends = [1.0_wp]
         if (.not. time%tolerance > 0.0_wp) ends = part_ends(time%scheme, history%step + 1, &
            time%time_step)
         if (allocated(contact%duty)) call cut_at_kinks(contact%duty, history%step &
            *time%time_step, time%time_step, ends)
         first = 0.0_wp
         i = 1
         do parts = 1, most_parts
            last = ends(i)
            if (time%tolerance > 0.0_wp) then   ! it may be made once more
               start = history
               last = next_end(history, first, ends(i), time%time_step)
            end if
            length = (last - first)*time%time_step
            call solve_part(run, contact, listener, [first, last], history, report)
            if (time%tolerance > 0.0_wp) then
               error = huge(error)
               if (report%converged) error = step_error(history, history%pressure(:, 1), 0.0_wp)
               call judge_part(history, error, length, time%tolerance, is_good)
               if (.not. (is_good .or. length < least_part)) then
                  start%next_length = history%next_length
                  history = start
                  cycle
               end if
            end if
            if (.not. report%converged) return
            first = last
            if (.not. first < ends(i)) i = i + 1
            if (i > size(ends)) return
            if (.not. time%tolerance > 0.0_wp) cycle
            call fill_point_state(level, contact, (history%step + first)*time%time_step, between)
            call listener%on_part(between)
         end do
      end associate
      report%converged = .false.
      report%reason = 'time step '//to_text(history%step + 1)//': its error is too large in ' &
         //to_text(most_parts)//' parts'
   end subroutine march_step

   !> Solves the part of the next step between `ends`, shares of it: from the prediction, else from
   !> the old pressure, with a film above 0.
   subroutine solve_part(run, contact, listener, ends, history, report)
      type(point_run_t), intent(inout) :: run
      type(point_contact_t), intent(inout) :: contact
      class(listener_t), intent(inout), target :: listener
      real(wp), intent(in) :: ends(2)
      type(march_state_t), intent(inout) :: history
      type(report_t), intent(inout) :: report
      type(film_state_t) :: start
      type(relay_t) :: relay
      real(wp), allocatable :: density(:)
      real(wp) :: least, length, new_time, weights(3)
      integer :: attempt, before, count

      relay%parent => listener
      associate (level => run%newton%hierarchy%levels(1), time => run%time)
         length = ends(2)*time%time_step - ends(1)*time%time_step
         new_time = (history%step + ends(2))*time%time_step
         weights = step_weights(history, time%scheme, length)
         allocate (density(size(level%film)))
         call fluid_density(contact%fluid, history%pressure(:, 1), density)
         least = minval(history%mass(:, 1)/density)
         level%inverse_time_step = weights(1)
         call set_point_moment(contact, new_time)
         call set_surfaces(level, contact, new_time)
         if (history%direction*level%direction < 0.0_wp) call turn_history(history)
         level%old_squeeze = reshape(weights(2)*history%mass(:, 1) + weights(3) &
            *history%mass(:, 2), shape(level%film))
         count = predictors(history)
         do attempt = 1, 2
            if (attempt == 2) count = 1
            call extrapolate(history, count, length, start)
            level%pressure = reshape(start%pressure, shape(level%pressure))
            level%rigid_displacement = start%rigid_displacement
            if (attempt == 1) then
               if (count == 1 .and. history%size > 1) call add_carried(level, history, &
                  nint(length/level%hx))
            else
               call set_point_film(level)
               level%rigid_displacement = level%rigid_displacement + max(0.5_wp*least &
                  - minval(level%film), 0.0_wp)
            end if
            before = pairs_of(run%newton)
            run%newton%is_near = .true.
            call solve_point_newton(run%newton, contact, tolerance_of(run, step_tolerance), &
               run%settings%max_cycles, relay, report)
            report%cost%fft_pairs = report%cost%fft_pairs + pairs_of(run%newton) - before
            if (report%converged) exit
         end do
         if (report%converged) then
            call remember(history, contact, level, length)
         else
            report%reason = coarseness(contact, level%nx)//'time step '//to_text(history%step &
               + 1)//' of ' &
               //to_text(nint(time%end_time/time%time_step))//' (T = '//to_text(new_time, 4)// &
               '): '//report%reason//'; smallest film before it: H = '//to_text(least, 3)
         end if
      end associate
   end subroutine solve_part

   !> Adds the last change of the pressure, carried with the mean speed by `nodes`: what passes.
   pure subroutine add_carried(level, history, nodes)
      type(point_level_t), intent(inout) :: level
      type(march_state_t), intent(in) :: history
      integer, intent(in) :: nodes
      real(wp), allocatable :: change(:, :)

      if (nodes < 1) return
      change = reshape(history%pressure(:, 1) - history%pressure(:, 2), shape(level%pressure))
      level%pressure(nodes:, :) = max(level%pressure(nodes:, :) + change(:size(change, 1) &
         - nodes, :), 0.0_wp)
   end subroutine add_carried

   !> Adds the present solution, at the end of a step of `length`, to the history.
   pure subroutine remember(history, contact, level, length)
      type(march_state_t), intent(inout) :: history
      type(point_contact_t), intent(in) :: contact
      type(point_level_t), intent(in) :: level
      real(wp), intent(in) :: length
      real(wp), dimension(size(level%film)) :: density, pressure

      pressure = reshape(level%pressure, shape(pressure))
      call fluid_density(contact%fluid, pressure, density)
      call keep_solution(history, length, pressure, level%rigid_displacement, density &
         *reshape(level%film, shape(density)))
      history%direction = level%direction
   end subroutine remember

end module point_march

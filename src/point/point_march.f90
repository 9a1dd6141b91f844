!> Time steps of the point contact, those of a line contact (modules time_march and
!> ehl_line_transient): BDF2 or backward Euler from the smooth steady solution, whose film the
!> surfaces enter at T = 0 without a new solve; later steps start from a prediction by the last
!> solutions.
module point_march
   use errors, only: error_t
   use film_breakdown, only: check_breakdown
   use film_state, only: film_state_t
   use iteration_report, only: phase_steady, phase_transient, report_t
   use kinds, only: wp
   use line_contact, only: step_tolerance
   use line_state, only: line_state_t
   use listener, only: listener_t, relay_t
   use lubricant, only: fluid_density
   use march_state, only: extrapolate, keep_solution, march_state_t, predictors, step_error, &
      step_weights, turn_history
   use point_contact, only: point_contact_t, set_point_moment, start_of
   use point_level, only: point_level_t, set_point_film, set_surfaces, turn_nodes
   use point_newton, only: solve_point_newton
   use point_quantities, only: fill_point_state
   use point_solver, only: coarseness, pairs_of, point_run_t, solve_point_steady, tolerance_of
   use text, only: to_text
   use time_march, only: march, marcher_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_point

   !> A point contact on the finest level of a run, and the prediction of its next solution.
   type, extends(marcher_t) :: point_marcher_t
      type(point_run_t), pointer :: run => null()
      type(point_contact_t), pointer :: point => null()
      type(film_state_t) :: predicted
   contains
      procedure :: end_step, fill, solve_part
   end type point_marcher_t

contains

   !> Solves the steady contact, smooth if it is the start of a passage, and the passage; `state` is
   !> that at the end. Not converging is in the report. Error (internal_error): LAPACK or FFTW.
   subroutine solve_point(run, contact, listener, state, report, error)
      type(point_run_t), intent(inout), target :: run
      type(point_contact_t), intent(inout), target :: contact
      class(listener_t), intent(inout), target :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(point_contact_t) :: start
      real(wp) :: before

      before = wall_seconds()
      start = contact
      if (run%time%is_transient) start = start_of(contact)
      call solve_point_steady(run, start, listener, report, error)
      if (allocated(error)) return
      contact%domain = start%domain
      start%surface_1 = contact%surface_1
      start%surface_2 = contact%surface_2
      associate (seconds => report%cost%phase_seconds)
         seconds(phase_steady) = wall_seconds() - before
         call fill_point_state(run%newton%hierarchy%levels(1), start, 0.0_wp, state)
         if (report%converged .and. run%time%is_transient) then
            before = wall_seconds()
            if (allocated(run%time%resume_from)) report = run%time%resume_from%report
            report%numbers%levels = size(run%newton%hierarchy%levels)
            call march_point()
            seconds(phase_transient) = seconds(phase_transient) + wall_seconds() - before
         else if (report%converged) then
            call check_breakdown(state%x, state%film_thickness, run%settings, 0, 0.0_wp, report, &
               state%y)
         end if
      end associate

   contains

      !> Marches from the steady solution of `run`, or from where an earlier run stopped (module
      !> time_march).
      subroutine march_point()
         type(point_marcher_t), target :: self

         self%run => run
         self%point => contact
         self%contact => contact
         self%film => self%predicted
         self%settings = run%settings
         self%time = run%time
         associate (level => run%newton%hierarchy%levels(1), history => self%history)
            call listener%on_stage('steps on '//to_text(level%nx)//' x '//to_text(level%ny) &
               //' intervals')
            allocate (level%old_squeeze, mold=level%film)
            if (allocated(run%time%resume_from)) then
               history = run%time%resume_from
               level%pressure = reshape(history%pressure(:, 1), shape(level%pressure))
               level%rigid_displacement = history%rigid_displacement(1)
               if (history%direction*level%direction < 0.0_wp) call turn_nodes(level)
            end if
            call set_point_moment(contact, history%step*run%time%time_step)
            call set_surfaces(level, contact, history%step*run%time%time_step)
            call set_point_film(level)
            if (history%size == 0) then
               call self%end_step(0, .false., report)
               if (.not. report%converged) return
               call remember(history, contact, level, 0.0_wp)
            end if
            call self%fill(history%step*run%time%time_step, state, has_stresses=.false.)
         end associate
         call march(self, listener, state, report)
      end subroutine march_point

   end subroutine solve_point

   !> Records a film below its floor.
   subroutine end_step(self, step, is_last, report)
      class(point_marcher_t), intent(inout) :: self
      integer, intent(in) :: step
      logical, intent(in) :: is_last
      type(report_t), intent(inout) :: report

      associate (level => self%run%newton%hierarchy%levels(1))
         call check_breakdown(level%direction*level%x, reshape(level%film, [size(level%film)]), &
            self%settings, step, step*self%time%time_step, report, level%direction*level%y)
         if (is_last) call set_point_film(level)
      end associate
   end subroutine end_step

   !> Sets `state` to the present film; its stresses are those of `fill_point_state`.
   subroutine fill(self, time, state, has_stresses)
      class(point_marcher_t), intent(in) :: self
      real(wp), intent(in) :: time
      type(line_state_t), intent(inout) :: state
      logical, intent(in) :: has_stresses

      associate (unused => has_stresses)
      end associate
      call fill_point_state(self%run%newton%hierarchy%levels(1), self%point, time, state)
   end subroutine fill

   !> Solves a part of the next step: from the prediction, else from the old pressure, with a film
   !> above 0.
   subroutine solve_part(self, ends, listener, error, report)
      class(point_marcher_t), intent(inout) :: self
      real(wp), intent(in) :: ends(2)
      class(listener_t), intent(inout), target :: listener
      real(wp), intent(inout) :: error
      type(report_t), intent(inout) :: report
      type(relay_t) :: relay
      real(wp), allocatable :: density(:)
      real(wp) :: length, new_time, weights(3)
      integer :: attempt, before, count, nodes

      relay%parent => listener
      associate (level => self%run%newton%hierarchy%levels(1), newton => self%run%newton, &
         contact => self%point, history => self%history, time => self%time, start => self%predicted)
         length = ends(2)*time%time_step - ends(1)*time%time_step
         new_time = (history%step + ends(2))*time%time_step
         weights = step_weights(history, time%scheme, length)
         allocate (density(size(level%film)))
         call fluid_density(contact%fluid, history%pressure(:, 1), density)
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
               nodes = nint(length/level%hx)
               if (min(history%size - count, nodes) > 0 .and. count == 1) then
                  ! the last change of the pressure, carried with the mean speed: what passes
                  associate (change => reshape(history%pressure(:, 1) - history%pressure(:, 2), &
                     shape(level%pressure)))
                     level%pressure(nodes:, :) = max(level%pressure(nodes:, :) &
                        + change(:size(change, 1) - nodes, :), 0.0_wp)
                  end associate
               end if
            else
               call set_point_film(level)
               level%rigid_displacement = level%rigid_displacement + max(0.5_wp &
                  *minval(history%mass(:, 1)/density) - minval(level%film), 0.0_wp)
            end if
            before = pairs_of(newton)
            newton%is_near = .true.
            call solve_point_newton(newton, contact, tolerance_of(self%run, step_tolerance), &
               self%settings%max_cycles, relay, report)
            report%cost%fft_pairs = report%cost%fft_pairs + pairs_of(newton) - before
            if (report%converged) exit
         end do
         if (.not. report%converged) then
            report%reason = coarseness(contact, level%nx)//report%reason
            return
         end if
         call remember(history, contact, level, length)
         if (time%tolerance > 0.0_wp) error = step_error(history, history%pressure(:, 1), 0.0_wp)
      end associate
   end subroutine solve_part

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

!> Time steps of the lubricated line contact, with Psi_1, Psi_2 at the new time:
!>
!>     backward Euler  lambda d(rho H)/dT = lambda/dT ( rho H - (rho H)_old )
!>     BDF2            lambda d(rho H)/dT = lambda/(2 dT) (3 rho H - 4 (rho H)_old + (rho H)_older)
!>
!> Both have the form lambda/dT_eff ( rho H - F ). BDF2 begins with a short step of backward Euler
!> and reaches its full step over several parts (module march_state).
!>
!> Load, radius and speeds may change in time (module duty): steps are divided where they have a
!> kink, and by an error estimate (module time_march), and the film is kept in the direction of the
!> flow, so that the wedge is taken from upstream. `quasi_steady` leaves the squeeze term out.
!>
!> At T = 0 pressure and H0 are those of the smooth steady contact; the surfaces enter the old film
!> without a new solve. Later steps start from a prediction by the last solutions.
module ehl_line_transient
   use cycle_control, only: iterate
   use errors, only: error_t
   use features, only: surface_height
   use film_breakdown, only: check_breakdown
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, move_profiles, solver_settings_t, time_settings_t
   use line_hierarchy, only: line_hierarchy_t, method_fas, relaxation_t, report_cost, &
      roughness_at, set_moment
   use line_level, only: line_level_t, set_film, share_pressure, thin_oil, total_pressure, turn
   use line_state, only: line_state_t
   use listener, only: listener_t
   use lubricant, only: fluid_density
   use march_state, only: extrapolate, keep_solution, march_state_t, predictors, step_error, &
      time_part_t, turn_history
   use reynolds_line, only: evaluate_coefficients
   use solver_choice, only: adopt, note_choice, time_step_attempts
   use state_output, only: fill_state
   use text, only: to_text
   use time_march, only: march, marcher_t, refuse
   implicit none (type, external)
   private

   public :: march_line

   !> A line contact on its levels, and the relaxations to try for a part, in this order.
   type, extends(marcher_t) :: line_marcher_t
      type(line_hierarchy_t), pointer :: hierarchy => null()
      type(line_contact_t), pointer :: line => null()
      type(relaxation_t), allocatable :: attempts(:)
   contains
      procedure :: end_step, fill, solve_part
   end type line_marcher_t

   !> Where oil fills a cavity, at its front, a node fills in a moment of no order: the error counts
   !> above this share of the largest pressure.
   real(wp), parameter :: fronts = 1.0e-3_wp

contains

   !> Marches from the smooth steady solution on the finest level, whose film the surfaces then
   !> enter without a new solve, or from where an earlier run stopped (module time_march), with the
   !> step of `choose_time_step`. It fails also if the heights of a surface cannot be read. The
   !> profiles must be loaded for the start.
   subroutine march_line(hierarchy, contact, settings, time, listener, state, report)
      type(line_hierarchy_t), intent(inout), target :: hierarchy
      type(line_contact_t), intent(inout), target :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout), target :: listener
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report
      type(line_marcher_t) :: self
      character(:), allocatable :: reason

      self%hierarchy => hierarchy
      self%line => contact
      self%contact => contact
      self%settings = settings
      self%time = time
      allocate (self%attempts, source=time_step_attempts(contact, settings, &
         has_parts=time%tolerance > 0.0_wp))
      call note_choice(report, self%attempts(1))
      associate (level => hierarchy%levels(hierarchy%finest), history => self%history)
         call listener%on_stage('steps on '//to_text(level%n)//' intervals')
         if (allocated(time%resume_from)) then
            history = time%resume_from
            if (abs(history%direction - level%direction) > 1.0_wp) call turn(level)
         end if
         level%rhs_film = level%gap - roughness_at(contact, level, history%step*time%time_step)
         if (history%size > 0) then
            level%state%film = history%film
            if (level%direction < 0.0_wp) level%state%film(:) = history%film(level%n:0:-1)
            history%smallest_film = minval(history%film)
            call derive(level, history)
         else
            call set_film(level)
            call self%end_step(0, .false., report)
            if (.not. report%converged) return
            call remember(history, level, 0.0_wp)
            call derive(level, history)   ! what asperities bear in the film with the surfaces
         end if
         call self%fill(history%step*time%time_step, state, has_stresses=.false.)
      end associate
      if (allocated(listener%follower)) then
         call listener%follower%start(contact, state, reason)
         if (allocated(reason)) call refuse(report, reason)
         if (allocated(reason)) return
      end if
      call march(self, listener, state, report)
   end subroutine march_line

   !> Records a film below its floor, the pressure at the outlet and the cost.
   subroutine end_step(self, step, is_last, report)
      class(line_marcher_t), intent(inout) :: self
      integer, intent(in) :: step
      logical, intent(in) :: is_last
      type(report_t), intent(inout) :: report

      associate (level => self%hierarchy%levels(self%hierarchy%finest))
         call check_breakdown(level%direction*level%x, level%state%film, self%settings, step, &
            step*self%time%time_step, report)
         if (.not. report%converged) return
         report%fit%outlet_pressure = max(report%fit%outlet_pressure, &
            level%state%pressure(level%n - 1))
         if (is_last) call derive(level, self%history)
         call report_cost(self%hierarchy, report)
      end associate
   end subroutine end_step

   !> Sets `state` to the present film.
   subroutine fill(self, time, state, has_stresses)
      class(line_marcher_t), intent(in) :: self
      real(wp), intent(in) :: time
      type(line_state_t), intent(inout) :: state
      logical, intent(in) :: has_stresses

      call fill_state(self%line, self%hierarchy%levels(self%hierarchy%finest), time, state, &
         has_stresses)
   end subroutine fill

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

   !> Solves a part of the next step, with the right sides of its end.
   subroutine solve_part(self, part, listener, error, report)
      class(line_marcher_t), intent(inout) :: self
      type(time_part_t), intent(inout) :: part
      class(listener_t), intent(inout), target :: listener
      real(wp), intent(inout) :: error
      type(report_t), intent(inout) :: report
      type(error_t), allocatable :: failure

      associate (level => self%hierarchy%levels(self%hierarchy%finest), history => self%history, &
         contact => self%line, weights => part%weights)
         call move_profiles(contact, part%time, failure)
         if (allocated(failure)) then
            call refuse(report, failure%message)
            return
         end if
         call set_moment(self%hierarchy, contact, part%time)
         if (history%direction*level%direction < 0.0_wp) call turn_history(history)
         level%inverse_time_step = weights(1)
         level%rhs_reynolds = level%lambda*(weights(2)*history%mass(:, 1) &
            + weights(3)*history%mass(:, 2))
         level%rhs_film = level%gap - roughness_at(contact, level, part%time)
         if (allocated(level%heat)) level%heat%share = 0.0_wp   ! as in a resumed run
         if (allocated(level%heat)) level%heat%change = 0.0_wp
         call solve_step()
         if (.not. report%converged) return
         call remember(history, level, part%length)
         if (self%time%tolerance > 0.0_wp) error = step_error(history, level%state%pressure, &
            merge(fronts, 0.0_wp, allocated(level%oil%saturation)))
         if (.not. allocated(listener%follower)) return
         part%heights = reshape([surface_height(contact%surface_1, level%x, part%time), &
            surface_height(contact%surface_2, level%x, part%time)], [level%n + 1, 2])
         part%state = level%state
      end associate

   contains

      !> Solves it from the better prediction by the history, then from all of that if it differs,
      !> then from the old pressure by each relaxation in turn; FAS begins with the relaxation that
      !> solved the last step. If a fast feature has closed the film under the old pressure, the
      !> film is raised to give the cycles a positive start.
      subroutine solve_step()
         real(wp) :: rise
         integer :: attempt, first, count

         associate (hierarchy => self%hierarchy, attempts => self%attempts, &
            history => self%history, level => self%hierarchy%levels(self%hierarchy%finest), &
            state => self%hierarchy%levels(self%hierarchy%finest)%state)
            first = min(history%way, size(attempts))
            count = predictors(history)
            do attempt = merge(first - 1, first - 2, count == min(history%size, 3)), size(attempts)
               if (attempt == first - 1) count = min(history%size, 3)
               call adopt(hierarchy, attempts(max(attempt, first)))
               if (attempt < first) then
                  call extrapolate(history, count, part%length, state%pressure, &
                     state%rigid_displacement)
               else
                  state%pressure = history%pressure(:, 1)
                  state%rigid_displacement = history%rigid_displacement(1)
               end if
               if (allocated(level%rough)) then
                  call share_pressure(level)
               else
                  call set_film(level)
               end if
               if (any(state%film <= 0.0_wp)) then
                  if (attempt < first) cycle
                  rise = 0.5_wp*history%smallest_film - minval(state%film)
                  state%film = state%film + rise
                  state%rigid_displacement = state%rigid_displacement + rise
               end if
               if (attempts(max(attempt, first))%thesis_first) then
                  level%is_kappa = .false.
                  call iterate(hierarchy, report)
                  level%is_kappa = .true.
               end if
               call iterate(hierarchy, report)
               if (.not. report%converged) cycle
               if (attempts(1)%method == method_fas) history%way = max(attempt, first)
               return
            end do
         end associate
      end subroutine solve_step

   end subroutine solve_part

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
      history%smallest_film = minval(level%state%film)
      history%direction = level%direction
   end subroutine remember

end module ehl_line_transient

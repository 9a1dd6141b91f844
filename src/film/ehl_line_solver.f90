!> The lubricated line contact, from its data to its fields; read it with chapter 2 of the thesis.
module ehl_line_solver
   use contact_moment, only: at_moment, film_estimate, least_speed
   use domain_choice, only: choose_anew, choose_domain, cut_asperities, farthest, inlet_error, &
      inlet_pressure_error
   use ehl_line_steady, only: blame_grid, solve_steady
   use ehl_line_transient, only: march_line
   use errors, only: error_t
   use film_breakdown, only: check_breakdown
   use graded_contact, only: find_tail, solve_graded_contact
   use iteration_report, only: phase_setup, phase_steady, phase_transient, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, move_profiles, solver_settings_t, time_settings_t, &
      without_surfaces
   use line_hierarchy, only: line_hierarchy_t, new_hierarchy, pose_steady_problem, report_cost, &
      roughness_at, set_moment
   use line_state, only: line_state_t
   use listener, only: listener_t
   use state_output, only: coarser_summaries, fill_properties, fill_state
   use text, only: to_text
   use wall_clock, only: wall_seconds
   use wave_resolution, only: choose_time_step
   implicit none (type, external)
   private

   public :: solve_ehl_line

contains

   !> Solves one contact on its even grid, or a steady one on a graded grid, and on an even one if
   !> that fails. Steady: with the surfaces at rest where they are. Transient: from the smooth
   !> steady contact. `contact%domain` is completed where the user left it open; an outlet of the
   !> program that cuts the steady film off is moved out. The listener is told every cycle of the
   !> steady solution and every time step, and gets the summaries of the coarser grids that a steady
   !> solution has passed, or the errors of a graded one. With `time%resume_from` the transient goes
   !> on there. Not converging is in the report; `error` is for failures of memory, libraries and
   !> files of heights.
   subroutine solve_ehl_line(contact, settings, time, listener, state, report, error)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: graded

      if (contact%domain%grid == 'graded') then
         graded = contact
         call solve_graded_contact(graded, settings, listener, state, report, error)
         if (allocated(error) .or. report%converged .or. listener%is_stopping &
            .or. report%breakdown%count > 0) then
            contact = graded
            return
         end if
         if (allocated(listener%grid_errors)) deallocate (listener%grid_errors)
         contact%domain%grid = 'even'   ! anew, but for what the user gave
         call choose_anew(contact, settings%target)
      end if
      call solve_on_even(contact, settings, time, listener, state, report, &
         error)   ! error: the caller looks
   end subroutine solve_ehl_line

   !> The same on an even grid.
   recursive subroutine solve_on_even(contact, settings, time, listener, state, report, error)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(line_hierarchy_t) :: hierarchy
      type(time_settings_t) :: whole_steps
      real(wp) :: start, begin
      logical :: is_resumed

      start = wall_seconds()
      is_resumed = allocated(time%resume_from)
      if (is_resumed) report = time%resume_from%report
      whole_steps = time
      call choose_domain(contact, settings%target)
      do while (contact%domain%moves < report%fit%outlet_moves)   ! as before the checkpoint
         call choose_anew(contact, settings%target, moves_out=.true.)
      end do
      report%fit%outlet_moves = contact%domain%moves
      call find_tail(contact, settings%target, listener)
      call choose_time_step(contact, whole_steps)
      report%fit%inlet_error = inlet_error(contact)
      report%fit%inlet_pressure_error = inlet_pressure_error(contact)
      begin = 0.0_wp
      if (is_resumed) begin = time%resume_from%step*whole_steps%time_step
      call move_profiles(contact, begin, error)
      if (allocated(error)) return
      hierarchy%is_kappa = settings%space_scheme == 'kappa'
      hierarchy%work_units = report%cost%work_units
      hierarchy%earlier_pairs = report%cost%fft_pairs
      hierarchy%setup_seconds = wall_seconds() - start
      call new_hierarchy(hierarchy, contact, settings%levels, error)
      if (allocated(error)) return
      call set_moment(hierarchy, contact, begin)
      if (.not. is_resumed) call solve_start(hierarchy, contact, settings, time, listener, report)
      associate (seconds => report%cost%phase_seconds, level => hierarchy%levels(hierarchy%finest))
         seconds(phase_setup) = seconds(phase_setup) + hierarchy%setup_seconds
         seconds(phase_steady) = seconds(phase_steady) + wall_seconds() - start &
            - hierarchy%setup_seconds
         if (.not. is_resumed) then
            call fill_state(contact, level, 0.0_wp, state, has_stresses=.false.)
            report%fit%outlet_pressure = level%state%pressure(level%n - 1)
            if (report%converged .and. report%fit%outlet_pressure > 0.0_wp &
               .and. contact%domain%may_lengthen .and. contact%domain%x_outlet < farthest) then
               call choose_anew(contact, settings%target, moves_out=.true.)
               call solve_on_even(contact, settings, time, listener, state, report, error)
               return
            end if
         end if
         if (report%converged .and. time%is_transient) then
            begin = wall_seconds()
            call march_line(hierarchy, contact, settings, whole_steps, listener, state, report)
            seconds(phase_transient) = seconds(phase_transient) + wall_seconds() - begin
         else if (report%converged) then
            listener%coarser = coarser_summaries(hierarchy)
            call check_breakdown(state%x, state%film_thickness, settings, 0, 0.0_wp, report)
         end if
         if (allocated(state%saturation)) then   ! the gap fills behind the first node
            if (state%saturation(2) < 1.0_wp) then
               report%fit%inlet_error = 0.0_wp
               report%fit%inlet_pressure_error = 0.0_wp
            end if
         end if
      end associate
      if (all(state%film_thickness > 0.0_wp)) call fill_properties(at_moment(contact, &
         state%time), state)
      report%numbers%levels = hierarchy%finest - hierarchy%coarsest + 1
      call report_cost(hierarchy, report)
      report%cost%wall_seconds = report%cost%wall_seconds + wall_seconds() - start
   end subroutine solve_on_even

   !> Solves the steady contact on a given grid: the result, or with smooth surfaces the start of a
   !> transient.
   subroutine solve_start(hierarchy, contact, settings, time, listener, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(listener_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      character(:), allocatable :: cut
      type(line_contact_t) :: posed
      type(solver_settings_t) :: plain
      real(wp) :: rise

      posed = contact
      if (time%is_transient) posed = without_surfaces(contact)
      where (.not. hierarchy%levels%entrainment > 0.0_wp) hierarchy%levels%entrainment = &
         least_speed   ! a start at rest will be forgotten
      hierarchy%wants_coarse_runs = settings%wants_coarse_runs .and. .not. time%is_transient
      call pose_steady_problem(hierarchy, contact, with_roughness=.not. time%is_transient)
      call solve_steady(hierarchy, posed, settings, listener, report)
      if (any([report%converged, listener%is_stopping])) return
      if (allocated(contact%duty) .and. hierarchy%is_kappa) then
         ! the first moment by upwind2: later ones come from it
         plain = settings
         plain%space_scheme = 'upwind2'
         hierarchy%levels%is_kappa = .false.
         call solve_steady(hierarchy, posed, plain, listener, report)
         hierarchy%levels%is_kappa = .true.
      end if
      if (any([report%converged, listener%is_stopping, .not. settings%explains_failure])) return
      if (.not. time%is_transient) then
         rise = maxval(roughness_at(contact, hierarchy%levels(hierarchy%finest), 0.0_wp)) &
            /film_estimate(contact)
         if (rise > 1.0_wp) report%reason = 'the surfaces rise to '//to_text(rise, 2)// &
            ' times the estimated film of the smooth contact; '//report%reason
      end if
      call blame_grid(contact, settings, .not. time%is_transient, listener, report)
      cut = cut_asperities(contact)
      if (cut /= '') report%reason = cut//'; '//report%reason
   end subroutine solve_start

end module ehl_line_solver

!> The lubricated line contact from its data to its fields: the page to read beside chapter 2 of the
!> thesis.
module ehl_line_solver
   use coarser_solutions, only: coarser_summaries
   use domain_choice, only: choose_domain, farthest, inlet_error, inlet_pressure_error, &
      lengthen_outlet
   use ehl_line_steady, only: blame_grid, blame_surfaces, solve_steady
   use ehl_line_transient, only: march
   use errors, only: error_t
   use film_breakdown, only: look_for_breakdown
   use iteration_report, only: phase_setup, phase_steady, phase_transient, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, move_profiles
   use line_hierarchy, only: line_hierarchy_t, new_hierarchy, pose_steady_problem, total_products
   use line_state, only: line_state_t
   use observer, only: observer_t
   use solver_settings, only: domain_t, solver_settings_t, time_settings_t
   use state_output, only: fill_properties, fill_state
   use step_choice, only: choose_time_step
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: begin_solution, end_solution, solve_ehl_line, take_steady_state, &
      tell_steady_solution, wants_longer_outlet

contains

   !> Solves one contact on its grid. Steady: with the surfaces at rest where they are. Transient:
   !> from the smooth steady contact. `contact%domain` is completed where the user left it open; an
   !> outlet of the program that cuts the steady film off is moved out. The observer is told every
   !> cycle of the steady solution and every time step, and the summaries of the coarser grids that
   !> a steady solution has passed. With `time%resume_from` the transient goes on there. Not
   !> converging is in the report; `error` is for failures of memory, libraries and files of
   !> heights.
   recursive subroutine solve_ehl_line(contact, settings, time, watcher, state, report, error)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(observer_t), intent(inout) :: watcher
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(line_hierarchy_t) :: hierarchy
      type(time_settings_t) :: whole_steps
      type(domain_t) :: open
      real(wp) :: start, begin

      start = wall_seconds()
      if (allocated(time%resume_from)) report = time%resume_from%report
      open = contact%domain
      whole_steps = time
      call begin_solution(contact, settings, whole_steps, report, error)
      if (allocated(error)) return
      call new_hierarchy(hierarchy, contact, settings%levels, error)
      if (allocated(error)) return
      hierarchy%is_kappa = settings%space_scheme == 'kappa'
      hierarchy%levels(hierarchy%finest)%is_kappa = hierarchy%is_kappa
      hierarchy%work_units = report%work_units
      call add_phase(report, phase_setup, start)
      if (.not. allocated(time%resume_from)) then
         begin = wall_seconds()
         call solve_start(hierarchy, contact, settings, time, watcher, report)
         call take_steady_state(hierarchy, contact, state, report)
         call add_phase(report, phase_steady, begin)
      end if
      if (wants_longer_outlet(contact%domain, report) .and. .not. allocated(time%resume_from)) then
         call lengthen_outlet(contact%domain, open)
         call solve_ehl_line(contact, settings, time, watcher, state, report, error)
         return
      end if
      if (report%converged .and. .not. time%is_transient) call tell_steady_solution(hierarchy, &
         settings, watcher, state, report)
      if (report%converged .and. time%is_transient) then
         begin = wall_seconds()
         call march(hierarchy, contact, settings, whole_steps, watcher, state, report)
         call add_phase(report, phase_transient, begin)
      end if
      call end_solution(hierarchy, contact, state, report)
      report%wall_seconds = report%wall_seconds + wall_seconds() - start
   end subroutine solve_ehl_line

   !> Completes the domain and the time step, and has the profiles at hand where the run begins.
   !> Error: a file cannot be read.
   subroutine begin_solution(contact, settings, time, report, error)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(inout) :: time
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: begin

      call choose_domain(contact, settings%target)
      call choose_time_step(contact, time)
      report%inlet_error = inlet_error(contact)
      report%inlet_pressure_error = inlet_pressure_error(contact)
      begin = 0.0_wp
      if (allocated(time%resume_from)) begin = time%resume_from%step*time%time_step
      call move_profiles(contact, begin, error)   ! error: the caller looks
   end subroutine begin_solution

   !> The steady solution, or what there is of it, becomes the state.
   subroutine take_steady_state(hierarchy, contact, state, report)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report

      call fill_state(contact, hierarchy%levels(hierarchy%finest), 0.0_wp, state)
      report%outlet_pressure = state%pressure(size(state%pressure) - 1)
   end subroutine take_steady_state

   !> What a steady solution tells when it stands: the observer which coarser grids it has passed,
   !> the report whether its film breaks down.
   subroutine tell_steady_solution(hierarchy, settings, watcher, state, report)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(solver_settings_t), intent(in) :: settings
      class(observer_t), intent(inout) :: watcher
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report

      call watcher%keep_coarser(coarser_summaries(hierarchy))
      call look_for_breakdown(state%x, state%film_thickness, settings, 0, 0.0_wp, report)
   end subroutine tell_steady_solution

   !> The properties of the oil become part of the state, the work that it took part of the report.
   subroutine end_solution(hierarchy, contact, state, report)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(inout) :: state
      type(report_t), intent(inout) :: report

      if (all(state%film_thickness > 0.0_wp)) call fill_properties(contact, state)
      report%levels = hierarchy%finest - hierarchy%coarsest + 1
      report%fft_pairs = report%fft_pairs + total_products(hierarchy)
      report%work_units = hierarchy%work_units
   end subroutine end_solution

   !> Whether an outlet of the program cuts the steady film off and can move out.
   pure function wants_longer_outlet(domain, report) result(is_wanted)
      type(domain_t), intent(in) :: domain
      type(report_t), intent(in) :: report
      logical :: is_wanted

      is_wanted = report%converged .and. report%outlet_pressure > 0.0_wp .and. domain%may_lengthen &
         .and. domain%x_outlet < farthest
   end function wants_longer_outlet

   !> The steady solution on a given grid: the answer, or with smooth surfaces the start of a
   !> transient.
   subroutine solve_start(hierarchy, contact, settings, time, watcher, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(observer_t), intent(inout) :: watcher
      type(report_t), intent(inout) :: report

      hierarchy%wants_companions = settings%wants_companions .and. .not. time%is_transient
      call pose_steady_problem(hierarchy, contact, with_roughness=.not. time%is_transient)
      call solve_steady(hierarchy, contact, settings, watcher, report)
      if (settings%explains_failure .and. .not. (report%converged .or. watcher%wants_stop)) then
         if (.not. time%is_transient) call blame_surfaces(hierarchy%levels(hierarchy%finest), &
            contact, report)
         call blame_grid(contact, settings, .not. time%is_transient, watcher, report)
      end if
   end subroutine solve_start

   !> Adds the seconds since `start` to a phase.
   subroutine add_phase(report, phase, start)
      type(report_t), intent(inout) :: report
      integer, intent(in) :: phase
      real(wp), intent(in) :: start

      report%phase_seconds(phase) = report%phase_seconds(phase) + wall_seconds() - start
   end subroutine add_phase

end module ehl_line_solver

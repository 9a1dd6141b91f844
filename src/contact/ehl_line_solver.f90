!> The lubricated line contact from its data to its fields: the page to read beside chapter 2 of the thesis.
module ehl_line_solver
   use domain_choice, only: choose_domain, inlet_error
   use ehl_line_steady, only: coarse_grid, solve_steady
   use ehl_line_transient, only: march
   use errors, only: error_t
   use film_breakdown, only: look_for_breakdown
   use iteration_report, only: phase_setup, phase_steady, phase_transient, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: line_hierarchy_t, new_hierarchy, pose_steady_problem, total_products
   use line_state, only: line_state_t
   use observer, only: observer_t, silent_observer_t
   use solver_settings, only: solver_settings_t, time_settings_t
   use state_output, only: fill_properties, fill_state
   use text, only: to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_ehl_line

   !> Methods whose failure is looked into on finer grids, up to this many intervals.
   character(len=*), parameter :: blaming_methods(2) = [character(len=13) :: 'auto', 'newton_krylov']
   integer, parameter :: largest_blame = 2**14

contains

   !> Solves one contact. Steady: with the surfaces at rest where they are. Transient: from the smooth steady contact.
   !> `contact%domain` is completed where the user left it open. The observer is told every cycle of the steady solution
   !> and every time step. With `time%resume_from` the transient goes on there. Not converging is in the report; `error` is
   !> for failures of memory and libraries.
   subroutine solve_ehl_line(contact, settings, time, watcher, state, report, error)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      class(observer_t), intent(inout) :: watcher
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(line_hierarchy_t) :: hierarchy
      real(wp) :: start, begin

      start = wall_seconds()
      if (allocated(time%resume_from)) report = time%resume_from%report
      call choose_domain(contact)
      call new_hierarchy(hierarchy, contact, settings%levels, error)
      if (allocated(error)) return
      hierarchy%levels(hierarchy%finest)%is_sharp = settings%space_scheme == 'sharp'
      report%inlet_error = inlet_error(contact)
      hierarchy%work_units = report%work_units
      call add_phase(report, phase_setup, start)

      if (.not. allocated(time%resume_from)) then
         begin = wall_seconds()
         call pose_steady_problem(hierarchy, contact, with_roughness=.not. time%is_transient)
         call solve_steady(hierarchy, contact, settings, watcher, report)
         if (settings%explains_failure .and. .not. (report%converged .or. watcher%wants_stop)) then
            call blame_grid(contact, settings, .not. time%is_transient, report)
         end if
         call fill_state(contact, hierarchy%levels(hierarchy%finest), hierarchy%rigid_displacement, 0.0_wp, state)
         call add_phase(report, phase_steady, begin)
      end if
      if (report%converged .and. .not. time%is_transient) then
         call look_for_breakdown(state%x, state%film_thickness, settings, 0, 0.0_wp, report)
      end if
      if (time%is_transient .and. report%converged) then
         begin = wall_seconds()
         call march(hierarchy, contact, settings, time, watcher, state, report)
         call add_phase(report, phase_transient, begin)
      end if
      if (all(state%film_thickness > 0.0_wp)) call fill_properties(contact, state)
      report%levels = hierarchy%finest - hierarchy%coarsest + 1
      report%fft_pairs = report%fft_pairs + total_products(hierarchy)
      report%work_units = hierarchy%work_units
      report%wall_seconds = report%wall_seconds + wall_seconds() - start
   end subroutine solve_ehl_line

   !> Where Newton's method finds no solution, but does so on a finer grid, the grid is to blame: says so in the reason.
   !> Fit of film and grid (solve_steady) only know Newtonian contacts; shear thinning leaves less film.
   subroutine blame_grid(contact, settings, with_roughness, report)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      logical, intent(in) :: with_roughness
      type(report_t), intent(inout) :: report
      type(line_contact_t) :: finer
      logical :: is_solved

      if (index(report%reason, coarse_grid) == 1 .or. .not. any(settings%method == blaming_methods)) return
      finer = contact
      do while (finer%domain%intervals < min(largest_blame, 8*contact%domain%intervals))
         finer%domain%intervals = 2*finer%domain%intervals
         call try_grid(finer, settings%space_scheme, with_roughness, is_solved)
         if (.not. is_solved) cycle
         report%reason = coarse_grid//', needs '//to_text(finer%domain%intervals)//' intervals (has '// &
            to_text(contact%domain%intervals)//'); '//report%reason
         return
      end do
   end subroutine blame_grid

   !> Whether Newton's method solves a steady contact on its grid.
   subroutine try_grid(contact, space_scheme, with_roughness, is_solved)
      type(line_contact_t), intent(in) :: contact
      character(*), intent(in) :: space_scheme
      logical, intent(in) :: with_roughness
      logical, intent(out) :: is_solved
      type(line_hierarchy_t) :: hierarchy
      type(solver_settings_t) :: settings
      type(silent_observer_t) :: nobody
      type(report_t) :: report
      type(error_t), allocatable :: error

      call new_hierarchy(hierarchy, contact, 0, error)
      is_solved = .not. allocated(error)
      if (.not. is_solved) return
      call pose_steady_problem(hierarchy, contact, with_roughness)
      settings%method = 'newton_krylov'
      settings%space_scheme = space_scheme
      hierarchy%levels(hierarchy%finest)%is_sharp = space_scheme == 'sharp'
      call solve_steady(hierarchy, contact, settings, nobody, report)
      is_solved = report%converged
   end subroutine try_grid

   !> Adds the seconds since `start` to a phase.
   subroutine add_phase(report, phase, start)
      type(report_t), intent(inout) :: report
      integer, intent(in) :: phase
      real(wp), intent(in) :: start

      report%phase_seconds(phase) = report%phase_seconds(phase) + wall_seconds() - start
   end subroutine add_phase

end module ehl_line_solver

!> A steady line contact on a graded grid, from its data to its fields and the bounds of the errors
!> of its quantities; and what of it lies in front of a passage (module line_hierarchy).
module graded_contact
   use domain_choice, only: choose_anew, choose_domain, farthest, inlet_error, inlet_pressure_error
   use features, only: surface_height
   use film_breakdown, only: check_breakdown
   use graded_nodes, only: monotone_cubic
   use graded_quantities, only: exit_element, least_film, middle_film, middle_pressure, rolling, &
      rolling_power, sliding, top
   use graded_solver, only: end_bound, graded_solution_t, solve_graded
   use errors, only: error_t
   use iteration_report, only: cycle_numbers_t, phase_steady, report_t
   use kinds, only: exceeds, not_known, wp
   use film_shear, only: film_limits
   use line_contact, only: domain_t, inlet_tail_t, line_contact_t, move_profiles, &
      solver_settings_t, without_surfaces
   use line_state, only: friction_t, line_state_t, stressed_share
   use listener, only: listener_t, relay_t
   use quantities, only: quantity_count, quantity_values
   use state_output, only: fill_properties
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: even_state, find_tail, solve_graded_contact

   !> Accuracy of all quantities if no target is given.
   real(wp), parameter :: default_target = 0.01_wp
   !> Accuracy of the contact in front of a passage.
   real(wp), parameter :: tail_accuracy = 0.1_wp

contains

   !> Solves one contact at rest to `settings%target`, or 1 %, in all quantities. Its domain is
   !> completed; an outlet of the program that cuts the film off is moved out. The listener gets the
   !> bounds of the errors by the grid. Error: a file of heights cannot be read.
   subroutine solve_graded_contact(contact, settings, listener, state, report, error)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(listener_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      type(graded_solution_t) :: solution
      real(wp) :: start, target

      start = wall_seconds()
      target = merge(settings%target, default_target, settings%target > 0.0_wp)
      report%method = 'newton_graded'
      do
         call choose_domain(contact, settings%target)
         call move_profiles(contact, 0.0_wp, error)
         if (allocated(error)) return
         associate (domain => contact%domain)
            call solve_graded(contact, [domain%x_inlet, domain%x_outlet], target, listener, &
               solution, report)
            if (.not. allocated(solution%line)) exit
            domain%intervals = solution%line%n
            report%fit%outlet_pressure = solution%line%state%pressure(solution%line%n - 1)
            if (.not. (report%fit%outlet_pressure > 0.0_wp .and. domain%may_lengthen &
               .and. domain%x_outlet < farthest)) exit
            domain%x_outlet = min(2*domain%x_outlet - 1, farthest)
         end associate
      end do
      report%fit%inlet_error = inlet_error(contact)
      report%fit%inlet_pressure_error = inlet_pressure_error(contact)
      report%numbers = cycle_numbers_t(tolerance=end_bound)
      report%tolerance_effective = end_bound
      if (allocated(solution%line)) then
         call fill_state(contact, solution, state)
         listener%grid_errors = grid_errors(solution, state)
         if (report%converged) call check_breakdown(state%x, state%film_thickness, settings, 0, &
            0.0_wp, report)
      end if
      report%cost%phase_seconds(phase_steady) = wall_seconds() - start
      report%cost%wall_seconds = wall_seconds() - start
   end subroutine solve_graded_contact

   !> Solves the smooth steady contact for the tail that the domain wants, unless it is there. If
   !> there is no solution, the contact goes without, on a domain chosen anew.
   subroutine find_tail(contact, target, listener)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: target
      class(listener_t), intent(inout), target :: listener
      type(line_contact_t) :: smooth
      type(graded_solution_t) :: solution
      type(relay_t) :: relay
      type(report_t) :: report

      if (.not. contact%domain%has_tail .or. allocated(contact%tail)) return
      relay%parent => listener
      smooth = without_surfaces(contact)
      smooth%domain = domain_t(grid='graded')
      call choose_domain(smooth)
      call solve_graded(smooth, [smooth%domain%x_inlet, smooth%domain%x_outlet], tail_accuracy, &
         relay, solution, report)
      contact%domain%has_tail = allocated(solution%line)
      if (allocated(solution%line)) then
         contact%tail = inlet_tail_t(solution%line%x(:), solution%line%state%pressure(:))
      else
         call choose_anew(contact, target)
      end if
   end subroutine find_tail

   !> Fields of a solution.
   pure subroutine fill_state(contact, solution, state)
      type(line_contact_t), intent(in) :: contact
      type(graded_solution_t), intent(in) :: solution
      type(line_state_t), intent(out) :: state

      associate (line => solution%line, values => solution%values)
         state%x = line%x(:)
         state%pressure = line%state%pressure(:)
         state%film_thickness = line%state%film(:)
         state%roughness_1 = surface_height(contact%surface_1, state%x, 0.0_wp)
         state%roughness_2 = surface_height(contact%surface_2, state%x, 0.0_wp)
         state%rigid_displacement = line%state%rigid_displacement
         call fill_properties(contact, state)
         state%friction = friction_t(sign(values(sliding), contact%slide_to_roll), &
            values(rolling), 0.5_wp*contact%slide_to_roll, values(rolling_power), not_known())
         if (.not. exceeds(abs(contact%slide_to_roll), 0.0_wp)) state%friction%sliding = &
            contact%slide_to_roll
         if (allocated(state%shear_stress_mean)) state%friction%stress_share = &
            maxval(abs(state%shear_stress_mean)/max(state%pressure, tiny(1.0_wp)), &
            state%pressure > stressed_share*maxval(state%pressure))
         state%limits = film_limits(contact%fluid, contact%lambda, contact%slide_to_roll, &
            state%x, state%pressure, state%film_thickness)
         state%limits%stress_share = state%friction%stress_share
      end associate
   end subroutine fill_state

   !> Bounds of the errors by the grid in the order of the table of quantities, NaN: not known.
   pure function grid_errors(solution, state) result(errors)
      type(graded_solution_t), intent(in) :: solution
      type(line_state_t), intent(in) :: state
      real(wp) :: errors(quantity_count), values(2, quantity_count), part
      integer :: i, j
      integer, parameter :: functionals(quantity_count) = [least_film, least_film, middle_film, &
         top, middle_pressure, 0, sliding, rolling, sliding, rolling_power, (0, i=11, &
         quantity_count)]

      values = quantity_values(state%x, state%pressure, state%film_thickness, state%pressure, &
         state%friction)
      do i = 1, quantity_count
         j = functionals(i)
         errors(i) = abs(values(1, i) - values(2, i))
         if (j > 0) then   ! no sliding: 0, exactly
            if (exceeds(abs(values(1, i)), 0.0_wp)) errors(i) = errors(i) + solution%bounds(j) &
               /solution%values(j)*abs(values(1, i))
         else   ! the exit: its element, and the error of a film over its slope
            associate (line => solution%line)
               call exit_element(line, j, part)
               errors(i) = errors(i) + line%spacing(j)*(1 + solution%bounds(least_film) &
                  /abs(line%state%film(j) - line%state%film(j - 1)))
            end associate
         end if
      end do
   end function grid_errors

   !> The `state` at rest of a contact on the even nodes of its domain, for runs there.
   pure function even_state(contact, state) result(even)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(line_state_t) :: even
      integer :: i

      associate (domain => contact%domain)
         even%x = [(domain%x_inlet + (domain%x_outlet - domain%x_inlet)*i/domain%intervals, i=0, &
            domain%intervals)]
      end associate
      even%pressure = monotone_cubic(state%x, state%pressure, even%x)
      even%pressure([1, size(even%x)]) = 0.0_wp
      ! only its smallest value counts
      even%film_thickness = 0*even%x + minval(state%film_thickness)
   end function even_state

end module graded_contact

!> From the checked values of a namelist to a lubricated point contact.
module point_input
   use body_input, only: check_curvature, fill_bodies, radius_of
   use case_record, only: case_t, list_effective, set_effective
   use input_values, only: input_values_t
   use film_surface, only: make_surface
   use kinds, only: pi, wp
   use line_case, only: fill_scaling, plan_duty, plan_times
   use line_contact, only: intervals_for_waves
   use measured_heights, only: heights_t
   use point_contact, only: first_intervals, fit_duty, intervals_for, new_point_contact, &
      point_contact_t, rows_for
   use point_cycle, only: fewest
   use scaling, only: scaled_fluid, sum_per_mean
   use system_limits, only: memory_fault, of_blas, point_memory
   use text, only: to_text
   implicit none (type, external)
   private

   public :: fill_point_case

   !> Ratios of the radii that are solved.
   real(wp), parameter :: least_ratio = 0.02_wp, largest_ratio = 50.0_wp
   !> Error of h_central for which the grid is chosen; grids below it that errors need at least.
   real(wp), parameter :: usual_error = 0.01_wp
   integer, parameter :: coarser_grids = 4
   !> Most intervals in x that are chosen, and most nodes of the coarsest grid.
   integer, parameter :: most_intervals = 1024, most_coarsest = 2000
   real(wp), parameter :: degree = pi/180

contains

   !> Fills the rest of `case`. Findings: bodies that do not touch, a contact wider than its bodies,
   !> grids that cannot be coarsened or have no memory; those of module line_case.
   subroutine fill_point_case(values, files, case)
      type(input_values_t), intent(inout) :: values
      type(heights_t), intent(inout) :: files(2)
      type(case_t), intent(inout) :: case
      character(:), allocatable :: key
      real(wp) :: across, ratio
      integer :: before

      before = values%findings%count   ! files that cannot be read
      if (values%has_group('moes')) then
         ratio = values%real_value('moes', 'radius_ratio')
      else
         call fill_bodies(values, case%bodies)
         call check_curvature(values, ['radius_y_1', 'radius_y_2'])
         if (values%findings%count > before) return
         across = radius_of(values, '_y')
         if (.not. abs(across) > 0.0_wp) across = case%bodies%reduced_radius
         ratio = case%bodies%reduced_radius/across
         if (ratio < least_ratio .or. ratio > largest_ratio) call values%refuse('bodies', &
            merge('reduced_radius_x', 'radius_x_1      ', values%is_given('bodies', &
            'reduced_radius_x')), 'found Rx/Ry = '//to_text(ratio, 3)//', expected ' &
            //to_text(least_ratio)//' to '//to_text(largest_ratio)//' (a line contact beyond)')
         if (values%findings%count > before) return
      end if
      call fill_scaling(values, case, key, ratio)
      if (case%scaling%is_dimensional .and. any(case%scaling%half_width*[1.0_wp, &
         case%scaling%ellipse%ratio*ratio] >= case%bodies%reduced_radius)) call values%refuse( &
         'load', key, 'found a contact as wide as its radii, '// &
         to_text(case%scaling%half_width, 3)//' m, expected a smaller one')
      if (values%findings%count > before) return
      associate (scales => case%scaling)
         case%point = new_point_contact(ratio, scales%moes_m*sum_per_mean**(-0.75_wp), &
            scales%moes_l*sum_per_mean**0.25_wp, degree*values%real_value('bodies', &
            'entrainment_angle'), scaled_fluid(scales, case%lubricant, case%bodies))
      end associate
      case%point%slide_to_roll = case%scaling%slide_to_roll
      call list_effective(values, case)
      if (case%scaling%is_dimensional) then
         call set_effective(case, 'bodies', 'reduced_radius_x', [case%bodies%reduced_radius])
         call set_effective(case, 'bodies', 'reduced_radius_y', [case%bodies%reduced_radius/ratio])
         call set_effective(case, 'bodies', 'reduced_modulus', [case%bodies%reduced_modulus])
         call set_effective(case, 'load', 'load', [case%scaling%load_per_length])
         call make_surface(values, 'surface_1', files(1), case, case%point%surface_1)
         call make_surface(values, 'surface_2', files(2), case, case%point%surface_2)
      end if
      if (allocated(case%duty)) then
         call set_effective(case, 'history', 'table_checksum', text=case%duty%digits)
         call plan_duty(values, case%point, case)
         call fit_duty(case%point)
      end if
      call fill_grid(values, case)
      if (values%findings%count > 0) return
      associate (domain => case%point%domain)
         if (has_area(case%point) .and. .not. case%time%time_step > 0.0_wp) case%time%time_step = &
            (domain%x_outlet - domain%x_inlet)/domain%intervals
      end associate
      call plan_times(values, case%point, case)
   end subroutine fill_point_case

   !> Domain and grid, given or chosen: the finest allowed one for a target, the usual one in time,
   !> where passages choose it. Findings: a domain that cuts the dry contact; the grid.
   subroutine fill_grid(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(inout) :: case
      character(len=12), parameter :: keys(3) = [character(len=12) :: 'x_inlet', 'x_outlet', &
         'y_half_width']
      character(:), allocatable :: fault
      real(wp) :: ends(3), reach(3)
      integer :: coarsest(2), i, usual

      associate (contact => case%point, domain => case%point%domain)
         contact%has_far_field = values%logical_value('domain', 'far_field')
         domain%x_inlet = values%real_value('domain', 'x_inlet', domain%x_inlet)
         domain%x_outlet = values%real_value('domain', 'x_outlet', domain%x_outlet)
         domain%y_half_width = values%real_value('domain', 'y_half_width', domain%y_half_width)
         reach = [-contact%half_widths(1), contact%half_widths]
         ends = [domain%x_inlet, domain%x_outlet, domain%y_half_width]
         do i = 1, 3
            if (abs(ends(i)) <= abs(reach(i))) call values%refuse('domain', keys(i), 'found '// &
               to_text(ends(i))//' inside the contact, which reaches '//to_text(reach(i), 4))
         end do
         if (values%findings%count > 0) return
         domain%intervals = values%integer_value('domain', 'intervals_x')
         if (domain%intervals == 0) then
            domain%intervals = min(most_intervals, max(intervals_for(contact, usual_error), &
               coarser_grids*first_intervals(contact, most_intervals)))
            do while (intervals_for_waves(contact) > domain%intervals .and. 2*domain%intervals &
               <= most_intervals .and. .not. has_area(contact))
               domain%intervals = 2*domain%intervals
            end do
         end if
         usual = domain%intervals
         if (case%solver%target > 0.0_wp) domain%intervals = most_intervals
         case%solver%max_intervals = domain%intervals
         domain%rows = values%integer_value('domain', 'intervals_y')
         if (domain%rows == 0) domain%rows = rows_for(contact, domain%intervals)
         coarsest = [domain%intervals, domain%rows]
         do while (all(mod(coarsest, 2) == 0) .and. all(coarsest/2 >= fewest))
            coarsest = coarsest/2
         end do
         if (product(coarsest) > most_coarsest) call values%refuse('domain', 'intervals_y', &
            'found '//to_text(domain%intervals)//' and '//to_text(domain%rows)// &
            ' intervals, expected numbers that can be halved together down to about 16')
         fault = memory_fault('a grid', point_memory(domain%intervals, domain%rows), of_blas)
         if (fault /= '') call values%refuse('domain', 'intervals_x', fault)
         if (case%time%is_transient) domain%rows = domain%rows*usual/domain%intervals
         if (case%time%is_transient) domain%intervals = usual
      end associate
   end subroutine fill_grid

   !> Whether a surface is an area, whose finest waves may be noise and choose no grid and no step.
   pure logical function has_area(contact)
      type(point_contact_t), intent(in) :: contact

      has_area = allocated(contact%surface_1%profile) .or. allocated(contact%surface_2%profile)
   end function has_area

end module point_input

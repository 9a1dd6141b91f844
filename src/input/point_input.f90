!> From the checked values of a namelist to a lubricated point contact.
module point_input
   use hertz, only: reduced_radius
   use body_input, only: check_curvature, has_plane, modulus_of
   use case_record, only: case_t, list_effective, set_effective
   use duty_input, only: complete_duty
   use elliptic_contact, only: ellipse_t, new_ellipse
   use input_values, only: input_values_t
   use kinds, only: pi, wp
   use line_case, only: plan_duty, plan_times
   use line_contact, only: intervals_for_waves
   use line_profiles, only: make_surface, place_surface
   use lubricant_input, only: fill_lubricant
   use point_contact, only: first_intervals, fit_duty, intervals_for, new_point_contact, &
      point_contact_t, rows_for
   use point_cycle, only: fewest
   use passage_times, only: place_features
   use scaling, only: new_point_moes_scaling, new_point_scaling, scaled_fluid, sum_per_mean
   use surface_scaling, only: scaled_duty, scaled_surface
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
   !> grids that cannot be coarsened or have no memory.
   subroutine fill_point_case(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(inout) :: case
      real(wp) :: load, m, l, per_speed, ratio

      call fill_lubricant(values, case%lubricant, case%materials)
      if (values%has_group('moes')) then
         ratio = values%real_value('moes', 'radius_ratio')
         m = values%real_value('moes', 'moes_m')
         l = values%real_value('moes', 'moes_l')
         per_speed = merge(sum_per_mean, 1.0_wp, values%word_value('moes', 'velocity') == 'sum')
         call new_point_moes_scaling(case%scaling, ratio, m*per_speed**0.75_wp, &
            l*per_speed**(-0.25_wp), case%lubricant)
      else
         call fill_radii(values, case, ratio)
         if (values%findings%count > 0) return
         load = load_of(values, case%bodies%reduced_radius, case%bodies%reduced_modulus, &
            new_ellipse(ratio))
         call new_point_scaling(case%scaling, case%bodies, ratio, case%lubricant, load)
         associate (scales => case%scaling)
            if (scales%half_width >= case%bodies%reduced_radius .or. scales%half_width &
               *scales%ellipse%ratio >= case%bodies%reduced_radius/ratio) call values%refuse( &
               'load', trim(merge('load          ', 'hertz_pressure', values%is_given('load', &
               'load'))), 'found a contact as wide as its radii, ' &
               //to_text(scales%half_width, 3)//' m, expected a smaller one')
         end associate
      end if
      if (values%findings%count > 0) return
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
         call make_surface(values, 'surface_1', case)
         call make_surface(values, 'surface_2', case)
         case%point%surface_1 = scaled_surface(case%surface_1, case%scaling)
         case%point%surface_2 = scaled_surface(case%surface_2, case%scaling)
      end if
      if (allocated(case%duty)) call pose_duty(values, case)
      call fill_grid(values, case)
      if (values%findings%count == 0) call plan_passage(values, case)
   end subroutine fill_point_case

   !> The history of load and speeds of the contact. Findings: those of `plan_duty`.
   subroutine pose_duty(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(inout) :: case

      call complete_duty(case%duty, case%scaling%load_per_length, case%bodies%reduced_radius)
      call set_effective(case, 'history', 'table_checksum', text=case%duty%digits)
      associate (contact => case%point)
         contact%duty = scaled_duty(case%duty, case%scaling)
         contact%surface_1%course = contact%duty%speeds(1)
         contact%surface_2%course = contact%duty%speeds(2)
         call plan_duty(values, contact, case)
         call fit_duty(contact)
      end associate
   end subroutine pose_duty

   !> The bodies, and D = Rx/Ry. Findings: bodies that do not touch in y; a ratio not solved.
   subroutine fill_radii(values, case, ratio)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(inout) :: case
      real(wp), intent(out) :: ratio
      real(wp) :: across
      character(len=10) :: key_1, key_2

      case%bodies%reduced_modulus = modulus_of(values)
      case%bodies%speed_1 = values%real_value('bodies', 'speed_1')
      case%bodies%speed_2 = values%real_value('bodies', 'speed_2')
      if (values%is_given('bodies', 'reduced_radius_x')) then
         case%bodies%reduced_radius = values%real_value('bodies', 'reduced_radius_x')
         across = values%real_value('bodies', 'reduced_radius_y', case%bodies%reduced_radius)
      else
         case%bodies%reduced_radius = radius_in(values, 'x')
         key_1 = 'radius_y_1'
         key_2 = 'radius_y_2'
         call check_curvature(values, key_1, key_2)
         if (values%findings%count > 0) return
         across = radius_in(values, 'y')
      end if
      ratio = case%bodies%reduced_radius/across
      if (ratio < least_ratio .or. ratio > largest_ratio) call values%refuse('bodies', &
         trim(merge('reduced_radius_x', 'radius_x_1      ', values%is_given('bodies', &
         'reduced_radius_x'))), 'found Rx/Ry = '//to_text(ratio, 3)//', expected ' &
         //to_text(least_ratio)//' to '//to_text(largest_ratio)//' (a line contact beyond)')
   end subroutine fill_radii

   !> Reduced radius in the plane of an `axis`; radii in y that are not given are those in x.
   pure real(wp) function radius_in(values, axis) result(radius)
      type(input_values_t), intent(in) :: values
      character(len=1), intent(in) :: axis
      real(wp) :: radii(2)

      radii = [values%real_value('bodies', 'radius_x_1'), values%real_value('bodies', 'radius_x_2')]
      if (axis == 'y') radii = [values%real_value('bodies', 'radius_y_1', radii(1)), &
         values%real_value('bodies', 'radius_y_2', radii(2))]
      radius = sum(radii)   ! of a plane it is 0
      if (.not. has_plane(values)) radius = reduced_radius(radii(1), radii(2))
   end function radius_in

   !> The load [N], given or of a Hertzian pressure p_h = (pi/2) C E' a/Rx.
   pure real(wp) function load_of(values, radius, modulus, ellipse) result(load)
      type(input_values_t), intent(in) :: values
      real(wp), intent(in) :: radius, modulus
      type(ellipse_t), intent(in) :: ellipse
      real(wp) :: pressure

      load = values%real_value('load', 'load')
      if (values%is_given('load', 'load')) return
      pressure = values%real_value('load', 'hertz_pressure')
      load = 2*pi*ellipse%ratio/3*pressure*(2*pressure*radius/(pi*ellipse%compliance*modulus))**2
   end function load_of

   !> Domain and grid, given or chosen: the finest allowed one for a target, the usual one in time,
   !> where passages choose it.
   subroutine fill_grid(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(inout) :: case
      character(:), allocatable :: fault
      integer :: coarsest(2), usual

      associate (contact => case%point, domain => case%point%domain)
         contact%has_far_field = values%logical_value('domain', 'far_field')
         domain%x_inlet = values%real_value('domain', 'x_inlet', domain%x_inlet)
         domain%x_outlet = values%real_value('domain', 'x_outlet', domain%x_outlet)
         domain%y_half_width = values%real_value('domain', 'y_half_width', domain%y_half_width)
         call check_border(values, case)
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

   !> Where the surfaces begin, and the times of their passage. Findings: those of module line_case.
   subroutine plan_passage(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(inout) :: case

      associate (contact => case%point, domain => case%point%domain)
         call place_surface(contact%surface_1, domain%x_inlet, domain%x_outlet)
         call place_surface(contact%surface_2, domain%x_inlet, domain%x_outlet)
         if (case%time%is_transient) call place_features(contact)
         if (has_area(contact) .and. .not. case%time%time_step > 0.0_wp) case%time%time_step = &
            (domain%x_outlet - domain%x_inlet)/domain%intervals
         call plan_times(values, contact, case)
      end associate
   end subroutine plan_passage

   !> Whether a surface is an area, whose finest waves may be noise and choose no grid and no step.
   pure logical function has_area(contact)
      type(point_contact_t), intent(in) :: contact

      has_area = allocated(contact%surface_1%profile) .or. allocated(contact%surface_2%profile)
   end function has_area

   !> Finding: a domain that cuts the dry contact.
   subroutine check_border(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(in) :: case
      character(len=12), parameter :: keys(3) = [character(len=12) :: 'x_inlet', 'x_outlet', &
         'y_half_width']
      real(wp) :: ends(3), least(3)
      integer :: i

      associate (domain => case%point%domain, b => case%point%half_widths)
         ends = [domain%x_inlet, domain%x_outlet, domain%y_half_width]
         least = [-b(1), b(1), b(2)]
      end associate
      do i = 1, 3
         if (abs(ends(i)) <= abs(least(i))) call values%refuse('domain', trim(keys(i)), 'found '// &
            to_text(ends(i))//' inside the contact, which reaches '//to_text(least(i), 4))
      end do
   end subroutine check_border

end module point_input

!> Ridges, dents and sinusoids that the grid or the time step cannot hold: fewer than two nodes in a
!> wave, or two steps in its passage. (The finest waves of measured and synthetic profiles may be
!> noise: they get a note only.)
module wave_validation
   use case_record, only: case_t
   use features, only: rough_surface_t
   use input_values, only: input_values_t
   use kinds, only: wp
   use line_case, only: build_line_contact
   use line_contact, only: line_contact_t
   use solver_settings, only: time_settings_t
   use text, only: to_text
   use wave_resolution, only: choose_time_step, intervals_at_least, min_in_a_wave
   implicit none (type, external)
   private

   public :: check_waves

contains

   !> Findings about both surfaces of a `case` whose grid is not chosen for an accuracy.
   subroutine check_waves(values, case)
      type(input_values_t), intent(inout) :: values
      type(case_t), intent(in) :: case
      type(line_contact_t) :: contact
      type(time_settings_t) :: time

      if (case%has_moes .or. case%accuracy%target > 0.0_wp) return
      call build_line_contact(case, contact)
      time = case%time
      call choose_time_step(contact, time)
      call check_surface(values, 'surface_1', contact%surface_1, contact, case%scaling%half_width, &
         time%time_step)
      call check_surface(values, 'surface_2', contact%surface_2, contact, case%scaling%half_width, &
         time%time_step)
   end subroutine check_waves

   !> Finds a wave that falls between the nodes of the grid (lengths over `half_width` [m]), or
   !> passes within two of the given time steps.
   subroutine check_surface(values, group, surface, contact, half_width, time_step)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(rough_surface_t), intent(in) :: surface
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: half_width, time_step
      real(wp) :: wave, dx, nodes, way

      if (size(surface%features) == 0) return
      wave = minval(surface%features%wavelength)
      dx = (contact%domain%x_outlet - contact%domain%x_inlet)/contact%domain%intervals
      nodes = wave/dx
      way = abs(surface%speed)*time_step
      if (nodes < min_in_a_wave .and. values%has_value('domain', 'intervals')) then
         call values%refuse('domain', 'intervals', 'found '//to_text(contact%domain%intervals) &
            //', a grid with '//to_text(nodes, 2)//' nodes in the wavelength '// &
            to_text(wave*half_width, 3)//' m of &'//group//', expected at least '// &
            to_text(intervals_at_least(min_in_a_wave*contact%domain%intervals/nodes)) &
               //', two nodes in a wave')
      else if (nodes < min_in_a_wave) then
         call values%refuse(group, 'wavelength', 'found '//to_text(wave*half_width, 3)// &
            ' m, '//to_text(nodes, 2)//' nodes of the finest grid that the program chooses, '// &
            'expected at least '//to_text(min_in_a_wave*dx*half_width, 3) &
               //' m, or intervals in &domain')
      end if
      if (wave < min_in_a_wave*way .and. values%has_value('time', 'time_step')) call &
         values%refuse('time', 'time_step', 'found '//to_text(time_step, 3)// &
            ', in which &'//group//' moves by '//to_text(way/wave, 2) &
            //' of its wavelength, expected at most '// &
            to_text(wave/(min_in_a_wave*abs(surface%speed)), 3)//' [-], half of it')
   end subroutine check_surface

end module wave_validation

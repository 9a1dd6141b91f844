!> Checks of &surface_1 and &surface_2: arrays that belong together, and motion that needs a
!> transient.
module surface_validation
   use findings, only: findings_t
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_surface

contains

   !> All checks of the surface `group` that moves at the key `speed` of &bodies.
   subroutine check_surface(values, group, speed, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, speed
      type(findings_t), intent(inout) :: findings
      type(value_t) :: shape

      shape = values%slot(group, 'shape')
      if (.not. shape%has_value .or. .not. values%has_group(group)) return
      if (any(shape%words == '?')) return
      if (all(shape%words == 'smooth')) return
      if (any(shape%words == 'file' .or. shape%words == 'synthetic')) then
         call check_profile(values, group, shape, findings)
      else
         if (any(shape%words == 'smooth')) call findings%add(shape%line, group, 'shape', &
            "found 'smooth' among other shapes, expected 'feature' or 'sinusoid' for each element")
         call check_lengths(values, group, findings)
      end if
      call check_motion(values, group, speed, findings)
   end subroutine check_surface

   !> Findings about a surface from a file or a synthesis: several shapes, several positions.
   subroutine check_profile(values, group, shape, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(value_t), intent(in) :: shape
      type(findings_t), intent(inout) :: findings
      type(value_t) :: position

      position = values%slot(group, 'position')
      if (size(shape%words) > 1) then
         call findings%add(shape%line, group, 'shape', "found '"//trim(shape%words(1)) &
            //"' among several shapes, expected 'feature' and 'sinusoid' among several")
      else if (position%is_given .and. size(position%reals) > 1) then
         call findings%add(position%line, group, 'position', 'found length ' &
            //to_text(size(position%reals))//', expected one value: the centre of the profile')
      end if
   end subroutine check_profile

   !> Finds arrays that have not as many values as `amplitude`; `shape` may have one for all.
   subroutine check_lengths(values, group, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(findings_t), intent(inout) :: findings
      character(len=12), parameter :: keys(*) = [character(len=12) :: 'shape', 'wavelength', &
         'position']
      type(value_t) :: amplitude, other
      integer :: i, elements

      amplitude = values%slot(group, 'amplitude')
      if (.not. amplitude%has_value) return
      elements = size(amplitude%reals)
      do i = 1, size(keys)
         other = values%slot(group, trim(keys(i)))
         if (.not. other%is_given .or. .not. other%has_value) cycle
         if (size(other%is_set) == elements .or. (keys(i) == 'shape' &
            .and. size(other%is_set) == 1)) cycle
         call findings%add(other%line, group, trim(keys(i)), &
            'found length ' // to_text(size(other%is_set)) &
            // ', expected ' // to_text(elements) // ', one value for each value of amplitude')
      end do
   end subroutine check_lengths

   !> Finding: a rough surface that moves in a steady case.
   subroutine check_motion(values, group, speed, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, speed
      type(findings_t), intent(inout) :: findings
      type(value_t) :: transient

      transient = values%slot('time', 'transient')
      if (.not. transient%has_value .or. transient%logical) return
      if (abs(values%real_value('bodies', &
         speed)) > 0.0_wp) call findings%add(values%line_of(group, 'shape'), group, 'shape', &
         'found a rough surface that moves (' // speed // ' = ' &
            // to_text(values%real_value('bodies', speed)) &
         // ' m/s) in a steady case, expected transient = .true. in &time, or ' // speed // ' = 0')
   end subroutine check_motion

end module surface_validation

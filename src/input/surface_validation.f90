!> Checks of &surface_1 and &surface_2: arrays that belong together, and motion that needs a
!> transient.
module surface_validation
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_surface

contains

   !> Findings about the surface `group` that moves at the key `speed` of &bodies: shapes that do
   !> not go together, several positions of one profile, motion in a steady case.
   subroutine check_surface(values, group, speed)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group, speed
      type(value_t) :: position, shape
      real(wp) :: metres_a_second

      shape = values%slot(group, 'shape')
      position = values%slot(group, 'position')
      if (.not. shape%has_value .or. .not. values%has_group(group)) return
      if (any(shape%words == '?') .or. all(shape%words == 'smooth')) return
      if (.not. any(shape%words == 'file' .or. shape%words == 'synthetic')) then
         if (any(shape%words == 'smooth')) call values%refuse(group, 'shape', &
            "found 'smooth' among other shapes, expected 'feature' or 'sinusoid' for each element")
         call check_lengths(values, group)
      else if (size(shape%words) > 1) then
         call values%refuse(group, 'shape', "found '"//trim(shape%words(1)) &
            //"' among several shapes, expected 'feature' and 'sinusoid' among several")
      else if (size(position%reals) > 1) then
         call values%refuse(group, 'position', 'found length '//to_text(size(position%reals)) &
            //', expected one value: the centre of the profile')
      end if
      if (.not. values%has_value('time', 'transient') .or. values%logical_value('time', &
         'transient')) return
      metres_a_second = values%real_value('bodies', speed)
      if (abs(metres_a_second) > 0.0_wp) call values%refuse(group, 'shape', &
         'found a rough surface that moves (' // speed // ' = ' // to_text(metres_a_second) &
         // ' m/s) in a steady case, expected transient = .true. in &time, or ' // speed // ' = 0')
   end subroutine check_surface

   !> Finds arrays with another number of values than `amplitude`; `shape` may have one for all.
   subroutine check_lengths(values, group)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
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
         call values%refuse(group, trim(keys(i)), 'found length ' // to_text(size(other%is_set)) &
            // ', expected ' // to_text(elements) // ', one value for each value of amplitude' &
            // amplitude%hint // other%hint)
      end do
   end subroutine check_lengths

end module surface_validation

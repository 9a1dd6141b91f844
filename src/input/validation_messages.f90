!> The messages that all checks of a case share: a key that is missing, keys that are not used.
module validation_messages
   use findings, only: findings_t
   use input_keys, only: find_key, key_rows
   use input_values, only: input_values_t
   use key_row, only: expected_value
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_radii, report_missing, report_unused

   !> Curvature of the gap between two bodies, 1/R [1/m]: the reverse of the range of
   !> reduced_radius.
   real(wp), parameter :: least_curvature = 1.0e-9_wp, largest_curvature = 1.0e9_wp

contains

   !> Adds: the key is not there but needed; `reason`, if not empty, says by what.
   subroutine report_missing(values, group, key, findings, reason)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key
      type(findings_t), intent(inout) :: findings
      character(*), intent(in), optional :: reason
      character(:), allocatable :: message

      message = 'found nothing, expected ' // expected_value(key_rows(find_key(group, key, &
         values%problem)))
      if (present(reason)) message = trim(message // ' ' // reason)
      call findings%add(values%line_of(group, ''), group, key, message)
   end subroutine report_missing

   !> Adds, if the key is given: it is not used; `reason` says why.
   subroutine report_unused(values, group, key, reason, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key, reason
      type(findings_t), intent(inout) :: findings

      if (.not. values%is_given(group, key)) return
      call findings%add(values%line_of(group, key), group, key, &
         'found a key that is not used ' // reason &
         // ', expected it left out')
   end subroutine report_unused

   !> Finding: two radii of bodies that do not touch, or lie in each other.
   subroutine check_radii(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      real(wp) :: curvature

      if (.not. (values%has_value('bodies', 'radius_1') .and. values%has_value('bodies', &
         'radius_2'))) return
      curvature = 1.0_wp/values%real_value('bodies', 'radius_1') &
         + 1.0_wp/values%real_value('bodies', 'radius_2')
      if (curvature < least_curvature &
         .or. curvature > largest_curvature) call findings%add(values%line_of('bodies', &
            'radius_1'), &
         'bodies', 'radius_1', 'found 1/radius_1 + 1/radius_2 = ' // to_text(curvature) // ', '// &
            'expected 1e-9 to 1e9 [1/m]')
   end subroutine check_radii

end module validation_messages

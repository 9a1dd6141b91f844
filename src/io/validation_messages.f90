!> The messages that all checks of a case share: a key that is missing, keys that are not used.
module validation_messages
   use findings, only: findings_t
   use input_keys, only: key_rows, find_key, expected_value
   use input_values, only: input_values_t
   implicit none (type, external)
   private

   public :: report_missing, report_unused, report_unused_by_shape

contains

   !> Adds: the key is not there but needed; `reason` says by what.
   subroutine report_missing(values, group, key, findings, reason)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key
      type(findings_t), intent(inout) :: findings
      character(*), intent(in), optional :: reason
      character(:), allocatable :: message

      message = 'found nothing, expected ' // expected_value(key_rows(find_key(group, key, values%problem)))
      if (present(reason)) message = message // ' ' // reason
      call findings%add(values%line_of(group, ''), group, key, message)
   end subroutine report_missing

   !> Adds, if the key is given: it is not used; `reason` says why.
   subroutine report_unused(values, group, key, reason, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key, reason
      type(findings_t), intent(inout) :: findings

      if (.not. values%is_given(group, key)) return
      call findings%add(values%line_of(group, key), group, key, 'found a key that is not used ' // reason &
         // ', expected it left out')
   end subroutine report_unused

   !> Adds those of `keys` that are given: the shape of the surface does not use them.
   subroutine report_unused_by_shape(values, group, keys, shape, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      character(*), intent(in) :: keys(:)
      character(*), intent(in) :: shape
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = 1, size(keys)
         call report_unused(values, group, trim(keys(i)), "with shape = '" // shape // "'", findings)
      end do
   end subroutine report_unused_by_shape

end module validation_messages

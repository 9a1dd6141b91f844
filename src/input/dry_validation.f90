!> What the values of a dry case must have in common, beyond the rules of their keys.
module dry_validation
   use dry_checks, only: has_shape
   use findings, only: findings_t
   use input_values, only: input_values_t, value_t
   use validation_messages, only: check_radii, report_missing, report_unused
   implicit none (type, external)
   private

   public :: check_dry

contains

   !> All checks of a dry case over more than one key.
   subroutine check_dry(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings

      call check_bodies(values, findings)
      call check_one_load(values, findings)
      call check_shapes(values, 'surface_1', findings)
      call check_shapes(values, 'surface_2', findings)
   end subroutine check_dry

   !> Findings: elasticity given twice or in part; radii without a parabola, or the reverse.
   subroutine check_bodies(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      character(len=16), parameter :: parts(*) = [character(len=16) :: 'youngs_modulus_1', &
         'poisson_ratio_1', &
         'youngs_modulus_2', 'poisson_ratio_2']
      character(len=14), parameter :: radii(*) = [character(len=14) :: 'reduced_radius', &
         'radius_1', 'radius_2']
      logical :: has_parabola
      integer :: i

      if (values%is_given('bodies', 'reduced_modulus')) then
         do i = 1, size(parts)
            call report_unused(values, 'bodies', trim(parts(i)), 'with reduced_modulus', findings)
         end do
      else
         do i = 1, 2
            if (.not. values%is_given('bodies', trim(parts(i)))) then
               call report_missing(values, 'bodies', trim(parts(i)), findings, &
                  '(or reduced_modulus)')
            end if
         end do
         if (values%is_given('bodies', 'youngs_modulus_2') .neqv. values%is_given('bodies', &
            'poisson_ratio_2')) then
            call report_missing(values, 'bodies', &
               trim(parts(merge(4, 3, values%is_given('bodies', 'youngs_modulus_2')))), findings)
         end if
      end if
      has_parabola = has_shape(values, 'surface_1', 'parabola') .or. has_shape(values, &
         'surface_2', 'parabola')
      if (has_parabola) then
         if (.not. (values%is_given('bodies', 'reduced_radius') .or. values%is_given('bodies', &
            'radius_1') &
            .and. values%is_given('bodies', 'radius_2'))) then
            call report_missing(values, 'bodies', 'reduced_radius', findings, &
               "(or radius_1 and radius_2) for shape = 'parabola'")
         else if (.not. values%is_given('bodies', 'reduced_radius')) then
            call check_radii(values, findings)
         end if
      else
         do i = 1, size(radii)
            call report_unused(values, 'bodies', trim(radii(i)), "without shape = 'parabola'", &
               findings)
         end do
      end if
   end subroutine check_bodies

   !> Findings: no load, or more than one.
   subroutine check_one_load(values, findings)
      type(input_values_t), intent(in) :: values
      type(findings_t), intent(inout) :: findings
      character(len=16) :: keys(4)
      integer :: given, i

      keys = [character(len=16) :: 'mean_pressure', 'hertz_pressure', &
              merge('load_per_length', 'load           ', values%problem == 'dry_line'), &
                 'separation']
      if (.not. values%has_group('load')) return
      given = 0
      do i = 1, size(keys)
         if (.not. values%is_given('load', trim(keys(i)))) cycle
         given = given + 1
         if (given > 1) call findings%add(values%line_of('load', trim(keys(i))), 'load', &
            trim(keys(i)), &
            'found more than one load, expected one of mean_pressure, hertz_pressure, ' &
               // trim(keys(3)) // ', separation')
      end do
      if (given == 0) call findings%add(values%line_of('load', ''), 'load', 'mean_pressure', &
         'found nothing, expected mean_pressure [Pa], hertz_pressure [Pa], ' // trim(keys(3)) &
            // ' or separation [m]')
   end subroutine check_one_load

   !> Finding: several shapes of which not all are features.
   subroutine check_shapes(values, group, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(findings_t), intent(inout) :: findings
      type(value_t) :: shape

      shape = values%slot(group, 'shape')
      if (size(shape%words) < 2) return
      if (any(shape%words /= 'feature' .and. shape%words /= 'sinusoid')) call findings%add( &
         shape%line, group, 'shape', &
         "found several shapes, expected 'feature' and 'sinusoid' among several")
   end subroutine check_shapes

end module dry_validation

!> What the values of a dry case must have in common, beyond the rules of their keys.
module dry_validation
   use body_values, only: check_radii, has_plane
   use input_values, only: input_values_t, value_t
   use surface_keys, only: has_shape, surfaces
   implicit none (type, external)
   private

   public :: check_dry

contains

   !> All checks of a dry case over more than one key.
   subroutine check_dry(values)
      type(input_values_t), intent(inout) :: values

      call check_moduli(values)
      call check_radius(values)
      if (values%has_group('load')) call check_load(values)
      call check_shapes(values, 'surface_1')
      call check_shapes(values, 'surface_2')
   end subroutine check_dry

   !> Findings: elasticity given twice or in part.
   subroutine check_moduli(values)
      type(input_values_t), intent(inout) :: values
      character(len=16), parameter :: parts(*) = [character(len=16) :: 'youngs_modulus_1', &
         'poisson_ratio_1', 'youngs_modulus_2', 'poisson_ratio_2']
      logical :: given(size(parts))
      integer :: i

      given = [(values%is_given('bodies', trim(parts(i))), i=1, size(parts))]
      if (values%is_given('bodies', 'reduced_modulus')) then
         do i = 1, size(parts)
            call values%refuse_unused('bodies', trim(parts(i)), 'with reduced_modulus')
         end do
         return
      end if
      do i = 1, 2
         if (.not. given(i)) call values%refuse_missing('bodies', trim(parts(i)), &
            '(or reduced_modulus)')
      end do
      if (given(3) .neqv. given(4)) call values%refuse_missing('bodies', &
         trim(parts(merge(4, 3, given(3)))))
   end subroutine check_moduli

   !> Findings: no radius of a parabola; a radius without one.
   subroutine check_radius(values)
      type(input_values_t), intent(inout) :: values
      character(len=14), parameter :: radii(*) = [character(len=14) :: 'reduced_radius', &
         'radius_1', 'radius_2']
      logical :: given(size(radii))
      integer :: i

      given = [(values%is_given('bodies', trim(radii(i))), i=1, size(radii))]
      if (.not. any(has_shape(values, surfaces, 'parabola'))) then
         do i = 1, size(radii)
            call values%refuse_unused('bodies', trim(radii(i)), "without shape = 'parabola'")
         end do
         call values%refuse_unused('bodies', 'plane', "without shape = 'parabola'")
      else if (.not. (given(1) .or. all(given(2:)) .or. has_plane(values))) then
         call values%refuse_missing('bodies', 'reduced_radius', &
            "(or radius_1 and radius_2) for shape = 'parabola'")
      else if (.not. given(1)) then
         call check_radii(values)
      end if
   end subroutine check_radius

   !> Findings: no load, or more than one.
   subroutine check_load(values)
      type(input_values_t), intent(inout) :: values
      character(len=16) :: keys(4)
      integer :: given, i

      keys = [character(len=16) :: 'mean_pressure', 'hertz_pressure', merge('load_per_length', &
         'load           ', values%problem == 'dry_line'), 'separation']
      given = 0
      do i = 1, size(keys)
         if (.not. values%is_given('load', trim(keys(i)))) cycle
         given = given + 1
         if (given > 1) call values%refuse('load', trim(keys(i)), 'found more than one load, '// &
            'expected one of mean_pressure, hertz_pressure, ' // trim(keys(3)) // ', separation')
      end do
      if (given == 0) call values%refuse('load', 'mean_pressure', 'found nothing, expected '// &
         'mean_pressure [Pa], hertz_pressure [Pa], ' // trim(keys(3)) // ' or separation [m]')
   end subroutine check_load

   !> Finding: several shapes of which not all are features.
   subroutine check_shapes(values, group)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(value_t) :: shape

      shape = values%slot(group, 'shape')
      if (size(shape%words) > 1 .and. any(shape%words /= 'feature' .and. shape%words &
         /= 'sinusoid')) call values%refuse(group, 'shape', &
         "found several shapes, expected 'feature' and 'sinusoid' among several")
   end subroutine check_shapes

end module dry_validation

!> The two bodies as one: radius and elasticity that follow from &bodies.
module body_values
   use bodies, only: reduced_modulus, reduced_radius
   use dry_scaling, only: contact_modulus
   use input_values, only: input_values_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_radii, has_plane, modulus_of, radius_of

   !> Curvature of the gap between two bodies, 1/R [1/m]: the reverse of the range of
   !> reduced_radius.
   real(wp), parameter :: least_curvature = 1.0e-9_wp, largest_curvature = 1.0e9_wp

contains

   !> Whether one body has a radius and the other is a plane.
   pure function has_plane(values)
      type(input_values_t), intent(in) :: values
      logical :: has_plane

      has_plane = values%logical_value('bodies', 'plane') .and. (values%is_given('bodies', &
         'radius_1') .neqv. values%is_given('bodies', 'radius_2'))
   end function has_plane

   !> A finding: two radii of bodies that do not touch, or lie in each other; a plane beside more or
   !> less than one radius, or one that is not convex.
   subroutine check_radii(values)
      type(input_values_t), intent(inout) :: values
      character(len=8) :: key
      real(wp) :: curvature

      if (has_plane(values)) then
         key = merge('radius_1', 'radius_2', values%is_given('bodies', 'radius_1'))
         if (values%real_value('bodies', key) < 0.0_wp) call values%refuse('bodies', key, &
            'found '//to_text(values%real_value('bodies', key))// &
            ' with plane = .true., expected a radius > 0 [m]')
      else if (values%logical_value('bodies', 'plane')) then
         call values%refuse('bodies', 'plane', &
            'found .true., expected one of radius_1 and radius_2 beside it')
      end if
      if (.not. (values%has_value('bodies', 'radius_1') .and. values%has_value('bodies', &
         'radius_2'))) return
      curvature = 1.0_wp/values%real_value('bodies', 'radius_1') &
         + 1.0_wp/values%real_value('bodies', 'radius_2')
      if (curvature < least_curvature .or. curvature > largest_curvature) call values%refuse( &
         'bodies', 'radius_1', 'found 1/radius_1 + 1/radius_2 = ' // to_text(curvature) &
         // ', expected 1e-9 to 1e9 [1/m]')
   end subroutine check_radii

   !> R [m], given or that of both bodies; 0 if there is none.
   function radius_of(values) result(radius)
      type(input_values_t), intent(in) :: values
      real(wp) :: radius

      radius = values%real_value('bodies', 'reduced_radius')
      if (radius > 0.0_wp) return
      if (has_plane(values)) then
         radius = values%real_value('bodies', 'radius_1') + values%real_value('bodies', 'radius_2')
         return
      end if
      if (.not. values%is_given('bodies', 'radius_1')) return
      radius = reduced_radius(values%real_value('bodies', 'radius_1'), &
         values%real_value('bodies', 'radius_2'))
   end function radius_of

   !> E' [Pa]: given, of both bodies, or of the first against a rigid one; 0 if there is none.
   function modulus_of(values) result(modulus)
      type(input_values_t), intent(in) :: values
      real(wp) :: modulus

      modulus = values%real_value('bodies', 'reduced_modulus')
      if (values%is_given('bodies', 'youngs_modulus_2')) then
         modulus = reduced_modulus(values%real_value('bodies', 'youngs_modulus_1'), &
            values%real_value('bodies', 'poisson_ratio_1'), &
            values%real_value('bodies', 'youngs_modulus_2'), &
            values%real_value('bodies', 'poisson_ratio_2'))
      else if (values%is_given('bodies', 'youngs_modulus_1')) then
         modulus = contact_modulus(values%real_value('bodies', 'youngs_modulus_1'), &
            values%real_value('bodies', 'poisson_ratio_1'))
      end if
   end function modulus_of

end module body_values

!> &bodies and &load: what contradicts each other or follows from other keys; two bodies as one.
module body_input
   use hertz, only: bodies_t, line_load_from_pressure, new_ellipse, point_load_from_pressure, &
      reduced_modulus, reduced_radius
   use input_keys, only: find_key, key_rows
   use input_values, only: has_shape, input_values_t, surfaces
   use key_row, only: lubricated, point
   use kinds, only: pi, wp
   use text, only: joined, to_text
   implicit none (type, external)
   private

   public :: check_bodies, check_curvature, check_dry_bodies, check_load, derive_speeds, &
      fill_bodies, find_load, modulus_of, radius_of

   !> Curvature of the gap, 1/R [1/m]: the reverse of the range of reduced_radius.
   real(wp), parameter :: least_curvature = 1.0e-9_wp, largest_curvature = 1.0e9_wp
   !> Keys of the speeds.
   character(len=7), parameter, public :: speeds(2) = ['speed_1', 'speed_2']

contains

   !> Gives both speeds if they follow from the mean speed U [m/s] and S = (u2 - u1)/U [-]: u1 =
   !> U (1 - S/2), u2 = U (1 + S/2). Finding: both ways to give them.
   subroutine derive_speeds(values)
      type(input_values_t), intent(inout) :: values
      character(*), parameter :: way = 'entrainment_speed'
      real(wp) :: mean, slide
      integer :: i

      if (.not. values%is_given('bodies', way)) return
      i = findloc(values%is_given('bodies', speeds), .true., dim=1)
      if (i > 0) call values%refuse('bodies', way, 'found together with '//speeds(i)// &
         ', expected either speed_1 and speed_2 or entrainment_speed and slide_to_roll')
      if (i > 0 .or. .not. all(values%has_value('bodies', [character(len=17) :: way, &
         'slide_to_roll']))) return
      mean = values%real_value('bodies', way)
      slide = values%real_value('bodies', 'slide_to_roll')
      call values%give('bodies', speeds(1), mean*(1 - 0.5_wp*slide), way)
      call values%give('bodies', speeds(2), mean*(1 + 0.5_wp*slide), way)
   end subroutine derive_speeds

   !> All checks of &bodies of a lubricated contact over more than one key. Findings: what
   !> `check_ways` and `check_radii` find; a speed that is missing; speeds that draw no oil in.
   subroutine check_bodies(values)
      type(input_values_t), intent(inout) :: values
      real(wp) :: speed_sum
      integer :: i
      character(len=16) :: radii(3)

      if (.not. values%has_group('bodies')) return
      radii = radius_keys(values)
      if (.not. values%logical_value('bodies', 'plane')) call check_ways(values, trim(radii(1)), &
         radii(2:))
      call check_ways(values, 'reduced_modulus', [character(len=20) :: 'youngs_modulus_1', &
         'youngs_modulus_2', 'poisson_ratio_1', 'poisson_ratio_2'])
      if (.not. values%is_given('bodies', 'entrainment_speed')) then
         do i = 1, size(speeds)
            if (.not. values%is_given('bodies', speeds(i))) call values%refuse_missing('bodies', &
               speeds(i), '(or entrainment_speed for both)')
         end do
      end if
      if (all(values%has_value('bodies', speeds))) then
         speed_sum = sum(values%real_value('bodies', speeds))
         if (speed_sum <= 0.0_wp) call values%refuse('bodies', 'speed_1', &
            'found speed_1 + speed_2 = ' // to_text(speed_sum) // ', expected a sum > 0 [m/s]: '// &
            'no oil is drawn in')
      end if
      call check_radii(values)
   end subroutine check_bodies

   !> A reduced value of &bodies, or all of the values it follows from. Findings: both, none, some.
   subroutine check_ways(values, reduced, parts)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: reduced, parts(:)
      logical :: given(size(parts))
      integer :: i
      character(:), allocatable :: list

      given = values%is_given('bodies', parts)
      list = joined(parts, ', ', last=' and ')
      if (values%is_given('bodies', reduced)) then
         if (any(given)) call values%refuse('bodies', reduced, 'found together with ' &
            // trim(parts(findloc(given, .true., dim=1))) // ', expected either ' // reduced &
            // ' or ' // list)
      else if (.not. any(given)) then
         call values%refuse('bodies', parts(1), 'missing, expected ' // list // ', or ' // &
            reduced // ' [' // trim(key_rows(find_key('bodies', reduced, &
            values%problem))%unit) // ']')
      else
         do i = 1, size(parts)
            if (.not. given(i)) call values%refuse_missing('bodies', parts(i))
         end do
      end if
   end subroutine check_ways

   !> Findings of a dry contact: elasticity twice or in part; a parabola or a radius alone.
   subroutine check_dry_bodies(values)
      type(input_values_t), intent(inout) :: values
      character(len=16), parameter :: parts(*) = [character(len=16) :: 'youngs_modulus_1', &
         'poisson_ratio_1', 'youngs_modulus_2', 'poisson_ratio_2'], radii(*) = &
         [character(len=16) :: 'reduced_radius', 'radius_1', 'radius_2', 'plane']
      logical :: given(size(parts))
      integer :: i

      given = values%is_given('bodies', parts)
      if (values%is_given('bodies', 'reduced_modulus')) then
         do i = 1, size(parts)
            call values%refuse_unused('bodies', parts(i), 'with reduced_modulus')
         end do
      else
         do i = 1, 2
            if (.not. given(i)) call values%refuse_missing('bodies', parts(i), &
               '(or reduced_modulus)')
         end do
         if (given(3) .neqv. given(4)) call values%refuse_missing('bodies', &
            parts(merge(4, 3, given(3))))
      end if
      given = values%is_given('bodies', radii)
      if (.not. any(has_shape(values, surfaces, 'parabola'))) then
         do i = 1, size(radii)
            call values%refuse_unused('bodies', radii(i), "without shape = 'parabola'")
         end do
      else if (.not. (given(1) .or. all(given(2:3)) .or. has_plane(values))) then
         call values%refuse_missing('bodies', 'reduced_radius', &
            "(or radius_1 and radius_2) for shape = 'parabola'")
      else if (.not. given(1)) then
         call check_radii(values)
      end if
   end subroutine check_dry_bodies

   !> Keys of the reduced radius and of the radii of both bodies, in the plane of x.
   pure function radius_keys(values) result(keys)
      type(input_values_t), intent(in) :: values
      character(len=16) :: keys(3)

      keys = [character(len=16) :: 'reduced_radius', 'radius_1', 'radius_2']
      if (values%problem == point) keys = [character(len=16) :: 'reduced_radius_x', 'radius_x_1', &
         'radius_x_2']
   end function radius_keys

   !> Whether one body has a radius and the other is a plane.
   pure logical function has_plane(values)
      type(input_values_t), intent(in) :: values

      associate (keys => radius_keys(values))
         has_plane = values%logical_value('bodies', 'plane') .and. count(values%is_given('bodies', &
            keys(2:))) == 1
      end associate
   end function has_plane

   !> A finding: two radii of bodies that do not touch, or lie in each other; a plane beside more or
   !> less than one radius, or one that is not convex.
   subroutine check_radii(values)
      type(input_values_t), intent(inout) :: values
      character(len=16) :: key, keys(3)

      keys = radius_keys(values)
      if (has_plane(values) .and. values%is_given('bodies', keys(1))) then
         call values%refuse('bodies', keys(1), 'found together with plane, expected one of the two')
      else if (has_plane(values)) then
         key = keys(findloc(values%is_given('bodies', keys), .true., dim=1))
         if (values%real_value('bodies', key) < 0.0_wp) call values%refuse('bodies', key, &
            'found '//to_text(values%real_value('bodies', key))// &
            ' with plane = .true., expected a radius > 0 [m]')
      else if (values%logical_value('bodies', 'plane')) then
         call values%refuse('bodies', 'plane', 'found .true., expected exactly one of '// &
            joined(keys(2:), ' and ')//' with it')
      end if
      call check_curvature(values, keys(2:))
   end subroutine check_radii

   !> A finding: two radii, of which both have a value, of bodies that do not touch.
   subroutine check_curvature(values, keys)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: keys(2)
      real(wp) :: curvature

      if (.not. all(values%has_value('bodies', keys))) return
      curvature = sum(1.0_wp/values%real_value('bodies', keys))
      if (curvature < least_curvature .or. curvature > largest_curvature) call values%refuse( &
         'bodies', keys(1), 'found 1/'//joined(keys, ' + 1/')//' = '//to_text(curvature) &
         //', expected 1e-9 to 1e9 [1/m]')
   end subroutine check_curvature

   !> Findings: no load, or more than one.
   subroutine check_load(values)
      type(input_values_t), intent(inout) :: values
      character(len=16), allocatable :: given(:), keys(:)
      character(:), allocatable :: choice, fault
      integer :: i

      choice = 'load_per_length [N/m], load [N] or hertz_pressure [Pa]'
      if (values%problem == lubricated) then
         keys = [character(len=16) :: 'load_per_length', 'load', 'hertz_pressure']
      else if (values%problem == point) then
         keys = [character(len=16) :: 'load', 'hertz_pressure']
         choice = 'load [N] or hertz_pressure [Pa]'
      else
         keys = [character(len=16) :: 'mean_pressure', 'hertz_pressure', merge('load_per_length', &
            'load           ', values%problem == 'dry_line'), 'separation']
         choice = 'mean_pressure [Pa], hertz_pressure [Pa], '//trim(keys(3))//' or separation [m]'
      end if
      fault = 'found more than one load, expected one of '//joined(keys, ', ')
      given = pack(keys, values%is_given('load', keys))
      do i = 2, size(given)
         call values%refuse('load', given(i), fault)
      end do
      if (size(given) == 0) call values%refuse('load', keys(1), 'missing, expected '//choice)
   end subroutine check_load

   !> The bodies of a lubricated contact, in the plane of x; with &moes they are unknown (zero).
   subroutine fill_bodies(values, bodies)
      type(input_values_t), intent(in) :: values
      type(bodies_t), intent(out) :: bodies

      bodies%reduced_radius = radius_of(values, trim(merge('_x', '  ', values%problem == point)))
      bodies%reduced_modulus = modulus_of(values)
      bodies%speed_1 = values%real_value('bodies', 'speed_1')
      bodies%speed_2 = values%real_value('bodies', 'speed_2')
      if (values%is_given('bodies', 'radius_2') .and. has_plane(values)) then
         bodies%curvature_share = 0.0_wp
      else if (values%is_given('bodies', 'radius_1')) then
         bodies%curvature_share = bodies%reduced_radius/values%real_value('bodies', 'radius_1')
      end if
   end subroutine fill_bodies

   !> The load of a line [N/m], of a lubricated one over its length, of an area, or of an ellipse
   !> with Rx/Ry = `ratio` [N], given by the `key` of &load; 0 if there is none.
   subroutine find_load(values, radius, modulus, key, load, ratio)
      type(input_values_t), intent(in) :: values
      real(wp), intent(in) :: radius, modulus
      character(:), allocatable, intent(out) :: key
      real(wp), intent(out) :: load
      real(wp), intent(in), optional :: ratio

      key = 'load_per_length'
      if (values%is_given('load', 'load')) key = 'load'
      if (values%is_given('load', 'hertz_pressure')) key = 'hertz_pressure'
      load = values%real_value('load', key)
      if (key /= 'hertz_pressure') then
         if (key == 'load' .and. values%problem == lubricated) load = load &
            /values%real_value('bodies', 'contact_length')
      else if (values%problem == 'dry_area') then
         load = point_load_from_pressure(load, radius, modulus)
      else if (present(ratio)) then   ! p_h = (pi/2) C E' a/Rx
         associate (ellipse => new_ellipse(ratio))
            load = 2*pi*ellipse%ratio/3*load*(2*load*radius/(pi*ellipse%compliance*modulus))**2
         end associate
      else
         load = line_load_from_pressure(load, radius, modulus)
      end if
   end subroutine find_load

   !> R [m] in the plane of an `axis`, of points '_x' or '_y', else '': given or that of both
   !> bodies; 0 if there is none. Radii in y that are not given are those in x.
   real(wp) function radius_of(values, axis) result(radius)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: axis
      real(wp) :: radii(2)

      radii = values%real_value('bodies', ['radius_x_1', 'radius_x_2'])
      radii = values%real_value('bodies', ['radius'//axis//'_1', 'radius'//axis//'_2'], radii)
      radius = values%real_value('bodies', 'reduced_radius'//axis)
      if (radius > 0.0_wp .or. .not. any(abs(radii) > 0.0_wp)) return
      radius = sum(radii)   ! of a plane it is 0
      if (.not. has_plane(values)) radius = reduced_radius(radii(1), radii(2))
   end function radius_of

   !> E' [Pa]: given, of both bodies, or against a rigid one, 2/E' = (1 - nu^2)/E; 0: there is none.
   real(wp) function modulus_of(values) result(modulus)
      type(input_values_t), intent(in) :: values

      modulus = values%real_value('bodies', 'reduced_modulus')
      if (values%is_given('bodies', 'youngs_modulus_2')) then
         modulus = reduced_modulus(values%real_value('bodies', 'youngs_modulus_1'), &
            values%real_value('bodies', 'poisson_ratio_1'), &
            values%real_value('bodies', 'youngs_modulus_2'), &
            values%real_value('bodies', 'poisson_ratio_2'))
      else if (values%is_given('bodies', 'youngs_modulus_1')) then
         modulus = 2.0_wp*values%real_value('bodies', 'youngs_modulus_1') &
            /(1.0_wp - values%real_value('bodies', 'poisson_ratio_1')**2)
      end if
   end function modulus_of

end module body_input

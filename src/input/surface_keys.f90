!> &surface_1 and &surface_2: features, synthesis, arrays that belong together, motion in time.
module surface_keys
   use features, only: feature_ridge, feature_sinusoid, feature_t
   use input_values, only: input_values_t, value_t
   use key_row, only: film, has_word
   use kinds, only: wp
   use synthetic_surface, only: synthesis_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_surface, features_of, has_shape, read_synthesis

   !> The groups of both surfaces.
   character(len=9), parameter, public :: surfaces(2) = ['surface_1', 'surface_2']

contains

   !> True if the surface `group` has the shape `word`.
   pure elemental logical function has_shape(values, group, word)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, word
      type(value_t) :: shape

      shape = values%slot(group, 'shape')
      has_shape = any(shape%words == word)
   end function has_shape

   !> Ridges, dents and sinusoids of the surface `group`; where positions are not given, 0.
   pure function features_of(values, group) result(features)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      type(feature_t), allocatable :: features(:)
      type(value_t) :: amplitude, position, shape, wavelength
      integer :: i

      shape = values%slot(group, 'shape')
      amplitude = values%slot(group, 'amplitude')
      wavelength = values%slot(group, 'wavelength')
      position = values%slot(group, 'position')
      allocate (features(size(amplitude%reals)))
      do i = 1, size(features)
         features(i) = feature_t(merge(feature_sinusoid, feature_ridge, &
            shape%words(min(i, size(shape%words))) == 'sinusoid'), amplitude%reals(i), &
            wavelength%reals(i), 0.0_wp, is_placed=position%is_given)
         if (size(position%reals) > 0) features(i)%position = position%reals(min(i, &
            size(position%reals)))
      end do
      features%wavelength_y = reals_of(values, group, 'wavelength_y', size(features))
      features%position_y = reals_of(values, group, 'position_y', size(features))
   end function features_of

   !> The `count` numbers of a key; 0 if it has others, or the problem does not know it.
   pure function reals_of(values, group, key, count) result(reals)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key
      integer, intent(in) :: count
      real(wp) :: reals(count)
      type(value_t) :: slot

      reals = 0.0_wp
      slot = values%slot(group, key)
      if (.not. slot%is_given) return
      if (size(slot%reals) == count) reals = slot%reals
   end function reals_of

   !> The synthesis that the surface `group` wants; `longest` (of the roll-off too) and `shortest`
   !> are its waves [m] where it gives none. Findings: wavelengths out of order.
   subroutine read_synthesis(values, group, longest, shortest, wanted)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      real(wp), intent(in) :: longest, shortest
      type(synthesis_t), intent(out) :: wanted

      wanted%seed = values%integer_value(group, 'seed')
      wanted%hurst = values%real_value(group, 'hurst')
      wanted%rms_height = values%real_value(group, 'rms_height')
      wanted%skewness = values%real_value(group, 'skewness')
      wanted%kurtosis = values%real_value(group, 'kurtosis')
      wanted%wavelength_long = values%real_value(group, 'wavelength_long', longest)
      wanted%wavelength_rolloff = values%real_value(group, 'wavelength_rolloff', &
         wanted%wavelength_long)
      wanted%wavelength_short = values%real_value(group, 'wavelength_short', shortest)
      if (wanted%wavelength_short > wanted%wavelength_rolloff .or. wanted%wavelength_rolloff &
         > wanted%wavelength_long) call values%findings%add(values%line_of(group, 'shape'), &
         group, 'wavelength_rolloff', 'found '//to_text(wanted%wavelength_rolloff) &
         //' m, expected wavelength_short <= wavelength_rolloff <= wavelength_long')
   end subroutine read_synthesis

   !> Findings: shapes that do not go together; a surface with `speed` of &bodies in a steady case.
   subroutine check_surface(values, group, speed)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group, speed
      type(value_t) :: shape
      real(wp) :: metres_a_second

      shape = values%slot(group, 'shape')
      if (.not. has_word(film, trim(values%problem))) then
         if (size(shape%words) > 1 .and. any(shape%words /= 'feature' .and. shape%words &
            /= 'sinusoid')) call values%refuse(group, 'shape', &
            "found several shapes, expected 'feature' and 'sinusoid' among several")
         return
      end if
      if (.not. shape%has_value .or. .not. values%has_group(group)) return
      if (any(shape%words == '?') .or. all(shape%words == 'smooth')) return
      call check_shapes(values, group, shape%words)
      if (.not. values%has_value('time', 'transient') .or. values%logical_value('time', &
         'transient')) return
      metres_a_second = values%real_value('bodies', speed)
      if (abs(metres_a_second) > 0.0_wp) call values%refuse(group, 'shape', &
         'found a rough surface that moves (' // speed // ' = ' // to_text(metres_a_second) &
         // ' m/s) in a steady case, expected transient = .true. in &time, or ' // speed // ' = 0')
   end subroutine check_surface

   !> Findings about the `shapes` of a surface of a lubricated contact, and the arrays with them.
   subroutine check_shapes(values, group, shapes)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group, shapes(:)
      type(value_t) :: position

      position = values%slot(group, 'position')
      if (.not. any(shapes == 'file' .or. shapes == 'synthetic')) then
         if (any(shapes == 'smooth')) call values%refuse(group, 'shape', &
            "found 'smooth' among other shapes, expected 'feature' or 'sinusoid' for each element")
         if (any(shapes == 'sinusoid') .and. any(shapes == 'feature')) call values%refuse_unused( &
            'bodies', 'roughness_'//group(len(group):), &
            "with shape = 'sinusoid', whose heights give it")
         call check_lengths(values, group)
      else if (size(shapes) > 1) then
         call values%refuse(group, 'shape', "found '"//trim(shapes(1)) &
            //"' among several shapes, expected 'feature' and 'sinusoid' among several")
      else if (size(position%reals) > 1) then
         call values%refuse(group, 'position', 'found length '//to_text(size(position%reals)) &
            //', expected one value: the centre of the profile')
      end if
   end subroutine check_shapes

   !> Finds arrays with another number of values than `amplitude`; `shape` may have one for all.
   subroutine check_lengths(values, group)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      character(len=12), parameter :: keys(*) = [character(len=12) :: 'shape', 'wavelength', &
         'position', 'wavelength_y', 'position_y']
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

end module surface_keys

!> The values of one case, one slot for each row of the key table, and the findings about them.
!>
!> &surface_1 and &surface_2: features, synthesis, arrays that belong together, motion in time.
module input_values
   use features, only: feature_ridge, feature_sinusoid, feature_t
   use findings, only: findings_t
   use input_keys, only: find_group, find_key, group_rows, key_rows
   use key_row, only: expected_value, film, has_word, lubricated
   use kinds, only: wp
   use line_contact, only: word_length
   use synthetic_surface, only: synthesis_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_surface, features_of, has_shape, input_values_t, read_synthesis, value_t

   !> The value of one key.
   type :: value_t
      !> True if the user gave it (also when it could not be read).
      logical :: is_given = .false.
      !> True if there is a value, from the user or from the table.
      logical :: has_value = .false.
      !> Line of the key in the file, below 0 of the command line; 0: not given.
      integer :: line = 0
      !> Numbers, integers too.
      real(wp), allocatable :: reals(:)
      !> Words; of a logical '.true.' or '.false.'.
      character(len=word_length), allocatable :: words(:)
      character(:), allocatable :: text
      !> What the text of an array of numbers seems to mean, if not these numbers; else nothing.
      character(:), allocatable :: hint
      !> Elements that the user has set (arrays).
      logical, allocatable :: is_set(:)
   end type value_t

   !> The values of all keys, in the order of `key_rows`, and where the groups are. Slot 0, never
   !> filled, stands for keys that the problem does not have.
   type :: input_values_t
      type(value_t) :: slots(0:size(key_rows))
      !> Line of each group of `group_rows`, below 0 of the command line; 0: not in the file.
      integer :: group_lines(size(group_rows)) = 0
      !> The problem, as far as it could be read; else the lubricated one.
      character(len=word_length) :: problem = lubricated
      !> Last line of the file, where missing groups are reported.
      integer :: last_line = 0
      !> What is wrong with the file.
      type(findings_t) :: findings
   contains
      procedure :: slot, real_value, integer_value, logical_value, word_value, text_value, &
         is_given, has_value, has_group, line_of, give, refuse, refuse_missing, refuse_unused
   end type input_values_t

   !> The groups of both surfaces.
   character(len=9), parameter, public :: surfaces(2) = ['surface_1', 'surface_2']

contains

   !> The slot of a key of the table.
   pure function slot(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      type(value_t) :: slot
      integer :: row

      row = find_key(group, key, self%problem)   ! an index is evaluated for each component
      slot = self%slots(row)
   end function slot

   !> The first real value of a key; `default` or 0 if there is none.
   pure elemental real(wp) function real_value(self, group, key, default) result(value)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      real(wp), intent(in), optional :: default

      value = 0.0_wp
      if (present(default)) value = default
      associate (slot => self%slots(find_key(group, key, self%problem)))
         if (slot%has_value) value = slot%reals(1)
      end associate
   end function real_value

   !> The integer of a key; 0 if there is none.
   pure integer function integer_value(self, group, key) result(value)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      value = nint(self%real_value(group, key))
   end function integer_value

   !> Whether a key is true, or has a word beside it; false if it has no value.
   pure logical function logical_value(self, group, key) result(value)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      value = all(self%word_value(group, key) /= ['.false.', '?      '])
   end function logical_value

   !> The first word of a key; '?' if there is none.
   pure function word_value(self, group, key) result(word)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      character(len=word_length) :: word

      word = '?'
      associate (slot => self%slots(find_key(group, key, self%problem)))
         if (slot%has_value) word = slot%words(1)
      end associate
   end function word_value

   !> The text of a key; empty if there is none.
   pure function text_value(self, group, key) result(text)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      character(:), allocatable :: text

      text = self%slots(find_key(group, key, self%problem))%text
   end function text_value

   !> True if the user gave the key, also with a value that could not be read.
   pure elemental logical function is_given(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      is_given = self%slots(find_key(group, key, self%problem))%is_given
   end function is_given

   !> True if the key has a value, given or default.
   pure elemental logical function has_value(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      has_value = self%slots(find_key(group, key, self%problem))%has_value
   end function has_value

   !> True if the group is in the file.
   pure elemental logical function has_group(self, group)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group

      has_group = self%group_lines(find_group(group)) /= 0
   end function has_group

   !> Line to report for a key: its own, else that of its group, else the last of the file.
   pure integer function line_of(self, group, key) result(line)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key

      line = 0
      if (len_trim(key) > 0) line = self%slots(find_key(group, key, self%problem))%line
      if (line == 0) line = self%group_lines(find_group(group))
      if (line == 0) line = self%last_line
   end function line_of

   !> Gives a key a number, as if it were given at its line, or at that of the key `source`.
   subroutine give(self, group, key, value, source)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key
      real(wp), intent(in) :: value
      character(*), intent(in), optional :: source
      integer :: line

      line = self%line_of(group, key)
      if (present(source)) line = self%line_of(group, source)
      if (find_key(group, key, self%problem) == 0) return
      associate (slot => self%slots(find_key(group, key, self%problem)))
         slot%is_given = .true.
         slot%has_value = .true.
         slot%line = line
         slot%reals = [value]
      end associate
   end subroutine give

   !> Adds a finding at the line of a key; without a key at that of the group.
   subroutine refuse(self, group, key, message)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key, message

      call self%findings%add(self%line_of(group, key), group, key, message)
   end subroutine refuse

   !> Adds: the key is not there but needed; `reason`, if not empty, says by what.
   subroutine refuse_missing(self, group, key, reason)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key
      character(*), intent(in), optional :: reason
      character(:), allocatable :: message

      message = 'missing, expected ' // expected_value(key_rows(find_key(group, key, &
         self%problem)))
      if (present(reason)) message = trim(message // ' ' // reason)
      call self%findings%add(self%line_of(group, ''), group, key, message)
   end subroutine refuse_missing

   !> Adds, if the key is given: it is not used; `reason` says why.
   subroutine refuse_unused(self, group, key, reason)
      class(input_values_t), intent(inout) :: self
      character(*), intent(in) :: group, key, reason

      if (self%is_given(group, key)) call self%refuse(group, key, &
         'not used ' // reason // ': remove it')
   end subroutine refuse_unused

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
      type(value_t) :: amplitude, shape
      integer :: i, n

      amplitude = values%slot(group, 'amplitude')
      shape = values%slot(group, 'shape')
      n = size(amplitude%reals)
      allocate (features(n))
      do i = 1, n
         features(i)%kind = merge(feature_sinusoid, feature_ridge, shape%words(min(i, &
            size(shape%words))) == 'sinusoid')
      end do
      features%amplitude = amplitude%reals
      features%wavelength = reals_of(values, group, 'wavelength', n)
      features%position = reals_of(values, group, 'position', n)
      features%is_placed = values%is_given(group, 'position')
      features%wavelength_y = reals_of(values, group, 'wavelength_y', n)
      features%position_y = reals_of(values, group, 'position_y', n)
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
      if (.not. has_word(film, values%problem)) then
         if (size(shape%words) > 1 .and. any(shape%words /= 'feature' .and. shape%words &
            /= 'sinusoid')) call values%refuse(group, 'shape', &
            "found several shapes, expected 'feature' and 'sinusoid' among several")
         call check_lengths(values, group)
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
         other = values%slot(group, keys(i))
         if (.not. other%is_given .or. .not. other%has_value) cycle
         if (size(other%is_set) == elements .or. (keys(i) == 'shape' &
            .and. size(other%is_set) == 1)) cycle
         call values%refuse(group, keys(i), 'found length ' // to_text(size(other%is_set)) &
            // ', expected ' // to_text(elements) // ', one value for each value of amplitude' &
            // amplitude%hint // other%hint)
      end do
   end subroutine check_lengths

end module input_values

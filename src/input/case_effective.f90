!> The list of all values that a case uses, given, default or derived, for the result file.
module case_effective
   use case_record, only: case_t, set_effective
   use input_keys, only: key_rows
   use input_values, only: input_values_t, value_t
   use key_row, only: has_word, integer_kind, is_chosen, key_row_t, logical_kind, lubricated, &
      real_kind, reals_kind, word_kind, words_kind
   use kinds, only: wp
   use lubricant, only: viscosity_constant, viscosity_roelands, density_constant
   use text, only: to_text
   implicit none (type, external)
   private

   public :: list_dry, list_effective

   !> Significant digits that give back the same real number.
   integer, parameter :: all_digits = 17

contains

   !> Fills `case%effective` in the order of the key table. A value that the program chooses later
   !> is listed as such.
   subroutine list_effective(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      integer :: i

      do i = 1, size(key_rows)
         associate (row => key_rows(i), slot => values%slots(i))
            if (.not. has_word(row%problems, trim(values%problem))) cycle
            if (.not. is_used(values, trim(row%group), trim(row%key))) cycle
            if (slot%has_value) then
               call set_effective(case, trim(row%group), trim(row%key), value_text(row, slot), &
                  trim(row%unit))
            else if (row%default == is_chosen .and. row%key /= 'output') then
               call set_effective(case, trim(row%group), trim(row%key), 'chosen by the program', &
                  trim(row%unit))
            end if
         end associate
      end do
      if (values%problem == lubricated) call list_derived(case)
   end subroutine list_effective

   !> False for groups that &moes replaces (or that are only there with it) and for keys of a
   !> transient or of roughness that is not there.
   function is_used(values, group, key)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key
      logical :: is_used
      type(value_t) :: transient

      is_used = .true.
      if (values%problem /= lubricated) then
         ! What a surface uses depends on its shape: only what is given tells.
         if (group(:min(7, len(group))) == 'surface') is_used = values%is_given(group, key)
         return
      end if
      transient = values%slot('time', 'transient')
      select case (group)
      case ('moes')
         is_used = values%has_group('moes')
      case ('surface_1', 'surface_2')
         is_used = is_used_by_shape(values, group, key)
      case ('output')
         is_used = transient%logical
      case ('time')
         is_used = transient%logical .or. key == 'transient'
      case default
         is_used = .true.
      end select
   end function is_used

   !> Whether a surface of this shape has any use for a key.
   function is_used_by_shape(values, group, key) result(is_used)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key
      logical :: is_used
      character(:), allocatable :: shape

      shape = trim(values%word_value(group, 'shape'))
      select case (key)
      case ('shape')
         is_used = .true.
      case ('position')
         is_used = (shape /= 'smooth' .and. shape /= 'file' .and. shape /= 'synthetic') &
            .or. values%is_given(group, key)
      case ('seed', 'hurst', 'skewness', 'kurtosis')
         is_used = shape == 'synthetic'
      case default
         is_used = values%is_given(group, key)
      end select
   end function is_used_by_shape

   !> What follows from the given values: reduced bodies, load, parameters of the viscosity law.
   subroutine list_derived(case)
      type(case_t), intent(inout) :: case

      if (.not. case%has_moes) then
         call set_effective(case, 'bodies', 'reduced_radius', to_text(case%bodies%reduced_radius, &
            all_digits), 'm')
         call set_effective(case, 'bodies', 'reduced_modulus', &
            to_text(case%bodies%reduced_modulus, all_digits), 'Pa')
         call set_effective(case, 'load', 'load_per_length', to_text(case%load_per_length, &
            all_digits), 'N/m')
      end if
      associate (oil => case%lubricant)
         if (oil%viscosity_law == viscosity_constant) call set_effective(case, 'lubricant', &
            'viscosity_law', 'constant', '')
         if (oil%density_law == density_constant) call set_effective(case, 'lubricant', &
            'density_law', 'constant', '')
         if (oil%pressure_viscosity > 0.0_wp) call set_effective(case, 'lubricant', &
            'pressure_viscosity', &
            to_text(oil%pressure_viscosity, all_digits), '1/Pa')
         if (oil%viscosity_law /= viscosity_roelands) return
         call set_effective(case, 'lubricant', 'roelands_p0', to_text(oil%roelands_p0, &
            all_digits), 'Pa')
         call set_effective(case, 'lubricant', 'roelands_z', to_text(oil%roelands_z, all_digits), &
            '-')
      end associate
   end subroutine list_derived

   !> What follows from the given values of a dry case, or was chosen.
   subroutine list_dry(case)
      type(case_t), intent(inout) :: case

      associate (dry => case%dry)
         call set_effective(case, 'bodies', 'reduced_modulus', to_text(dry%reduced_modulus, &
            all_digits), 'Pa')
         call set_effective(case, 'domain', 'periodic', trim(merge('.true. '// &
            '', '.false.', dry%is_periodic)), '')
         if (.not. dry%is_periodic) call set_effective(case, 'domain', 'kernel', 'element', '')
         if (dry%grid%ny == 1) then
            call set_effective(case, 'domain', 'length', to_text(dry%lengths(1), all_digits), 'm')
            call set_effective(case, 'domain', 'intervals', to_text(dry%grid%nx), '-')
         else
            call set_effective(case, 'domain', 'length_x', to_text(dry%lengths(1), all_digits), 'm')
            call set_effective(case, 'domain', 'length_y', to_text(dry%lengths(2), all_digits), 'm')
            call set_effective(case, 'domain', 'intervals_x', to_text(dry%grid%nx), '-')
            call set_effective(case, 'domain', 'intervals_y', to_text(dry%grid%ny), '-')
         end if
      end associate
   end subroutine list_dry

   !> A value as text, several separated by commas; reals with 17 digits.
   function value_text(row, slot) result(string)
      type(key_row_t), intent(in) :: row
      type(value_t), intent(in) :: slot
      character(:), allocatable :: string
      integer :: i

      string = ''
      select case (row%kind)
      case (real_kind, reals_kind)
         do i = 1, size(slot%reals)
            if (i > 1) string = string // ', '
            string = string // to_text(slot%reals(i), all_digits)
         end do
      case (word_kind, words_kind)
         do i = 1, size(slot%words)
            if (i > 1) string = string // ', '
            string = string // trim(slot%words(i))
         end do
      case (integer_kind)
         string = to_text(slot%integer)
      case (logical_kind)
         string = merge('.true. ', '.false.', slot%logical)
         string = trim(string)
      case default
         string = slot%text
      end select
   end function value_text

end module case_effective

!> Values that follow from others that a user may know instead: the speeds of both surfaces, and
!> P0 of Roelands.
module derived_values
   use input_keys, only: find_key, key_rows
   use input_values, only: input_values_t
   use key_row, only: lubricated
   use kinds, only: wp
   use number_text, only: read_real
   implicit none (type, external)
   private

   public :: alone, derive_values

   !> What is given instead of the two speeds, with `slide_to_roll`.
   character(*), parameter :: way = 'entrainment_speed'

contains

   !> Gives the keys that follow their values, as if they were given at the line of the key that
   !> they follow from. Finding: both ways to give the speeds.
   subroutine derive_values(values)
      type(input_values_t), intent(inout) :: values

      if (values%problem /= lubricated) return
      call derive_speeds(values)
      if (alone(values)) call give('lubricant', 'roelands_p0', 'pressure_viscosity', &
         usual_p0(), values)
   end subroutine derive_values

   !> u1 = U (1 - S/2), u2 = U (1 + S/2) of the mean speed U [m/s] and S = (u2 - u1)/U [-].
   subroutine derive_speeds(values)
      type(input_values_t), intent(inout) :: values
      character(len=7), parameter :: speeds(2) = ['speed_1', 'speed_2']
      real(wp) :: mean, half_slide
      integer :: i

      if (.not. values%is_given('bodies', way)) return
      do i = 1, size(speeds)
         if (.not. values%is_given('bodies', speeds(i))) cycle
         call values%refuse('bodies', way, 'found together with '//speeds(i)// &
            ', expected either speed_1 and speed_2 or entrainment_speed and slide_to_roll')
         return
      end do
      if (.not. (values%has_value('bodies', way) .and. values%has_value('bodies', &
         'slide_to_roll'))) return
      mean = values%real_value('bodies', way)
      half_slide = 0.5_wp*values%real_value('bodies', 'slide_to_roll')
      call give('bodies', speeds(1), way, mean*(1 - half_slide), values)
      call give('bodies', speeds(2), way, mean*(1 + half_slide), values)
   end subroutine derive_speeds

   !> Whether alpha is the only parameter of Roelands' law that is given.
   pure function alone(values)
      type(input_values_t), intent(in) :: values
      logical :: alone

      alone = values%problem == lubricated .and. .not. values%has_group('moes')
      if (.not. alone) return
      alone = values%word_value('lubricant', 'viscosity_law') == 'roelands' .and. &
         values%has_value('lubricant', 'pressure_viscosity') .and. .not. &
         (values%is_given('lubricant', 'roelands_p0') .or. values%is_given('lubricant', &
         'roelands_z'))
   end function alone

   !> P0 [Pa] where none is given, 1.96e8.
   function usual_p0() result(p0)
      real(wp) :: p0
      logical :: good

      call read_real(trim(key_rows(find_key('lubricant', 'roelands_p0'))%moes_default), p0, good)
   end function usual_p0

   !> Gives a key the `value`, at the line of the key `source`.
   subroutine give(group, key, source, value, values)
      character(*), intent(in) :: group, key, source
      real(wp), intent(in) :: value
      type(input_values_t), intent(inout) :: values
      integer :: line

      line = values%line_of(group, source)
      associate (slot => values%slots(find_key(group, key, values%problem)))
         slot%is_given = .true.
         slot%has_value = .true.
         slot%line = line
         slot%reals = [value]
      end associate
   end subroutine give

end module derived_values

!> Which heights, positions and spacings a file of heights may have, and what is wrong with others
!> in words.
!>
!> The limits lie far beyond measured surfaces. Within them squares and quotients of heights and
!> spacings stay finite.
module height_limits
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: first_fault, height_fault, is_height, is_position, position_fault, range_fault, &
      scale_fault, spacing_fault

   !> Largest height and position [m].
   real(wp), parameter :: largest_height = 1.0e3_wp, largest_position = 1.0e9_wp
   !> Highest less lowest point of a surface that is not flat, at least [m].
   real(wp), parameter :: least_range = 1.0e-20_wp
   !> Spacing of the nodes [m].
   real(wp), parameter :: least_spacing = 1.0e-15_wp, largest_spacing = 1.0e6_wp
   !> Metres in the unit of a dataset.
   real(wp), parameter :: least_scale = 1.0e-30_wp, largest_scale = 1.0e30_wp

contains

   !> Whether `z` [m] can be a height: finite, not too large, zero or with all digits of a number.
   pure elemental function is_height(z)
      real(wp), intent(in) :: z
      logical :: is_height

      is_height = lies_within(abs(z), tiny(z), largest_height) .or. lies_within(z, 0.0_wp, 0.0_wp)
   end function is_height

   !> Number of the first of the heights `z` [m] that cannot be one; 0: all can.
   pure function first_fault(z) result(place)
      real(wp), intent(in) :: z(:)
      integer :: place

      do place = 1, size(z)
         if (.not. is_height(z(place))) return
      end do
      place = 0
   end function first_fault

   !> Whether `x` [m] can be a position.
   pure elemental function is_position(x)
      real(wp), intent(in) :: x
      logical :: is_position

      is_position = lies_within(abs(x), 0.0_wp, largest_position)
   end function is_position

   !> Whether a value is finite and in [lowest, highest]; NaN is not compared, since the checked
   !> build traps that.
   pure elemental function lies_within(value, lowest, highest)
      real(wp), intent(in) :: value, lowest, highest
      logical :: lies_within

      lies_within = .false.
      if (ieee_is_finite(value)) lies_within = value >= lowest .and. value <= highest
   end function lies_within

   !> "found ..., expected ..." for a number that cannot be a height [m].
   pure function height_fault(z) result(fault)
      real(wp), intent(in) :: z
      character(:), allocatable :: fault

      if (ieee_is_nan(z)) then
         fault = 'found a height that is no number (a gap), expected heights without gaps'
      else if (abs(z) > largest_height) then
         fault = 'found a height of '//shown(z)//' m, expected at most ' &
            //to_text(nint(largest_height))//' m'
      else
         fault = 'found a height of '//shown(z)//' m, expected 0 or at least '//to_text(tiny(z), &
            3)//' m'
      end if
   end function height_fault

   !> The same for a number that cannot be a position [m].
   pure function position_fault(x) result(fault)
      real(wp), intent(in) :: x
      character(:), allocatable :: fault

      fault = 'found a position of '//shown(x)//' m, expected at most ' &
         //to_text(nint(largest_position))//' m'
   end function position_fault

   !> The same for the distance of neighbouring nodes [m]; empty if it can be one.
   pure function spacing_fault(spacing) result(fault)
      real(wp), intent(in) :: spacing
      character(:), allocatable :: fault

      fault = ''
      if (.not. lies_within(spacing, least_spacing, largest_spacing)) fault = &
         'found a spacing of '//shown(spacing)// &
         ' m, expected '//to_text(least_spacing, 2)//' to '//to_text(nint(largest_spacing))//' m'
   end function spacing_fault

   !> The same for `si_scale`, metres in the unit of a dataset; a negative one turns heights into
   !> depths.
   pure function scale_fault(scale) result(fault)
      real(wp), intent(in) :: scale
      character(:), allocatable :: fault

      fault = ''
      if (.not. lies_within(abs(scale), least_scale, largest_scale)) fault = 'found ' &
         //shown(scale)//', expected '// &
         to_text(least_scale, 2)//' to '//to_text(largest_scale, 2) &
            //', metres in one unit of the dataset'
   end function scale_fault

   !> The same for the lowest and the highest point of a surface [m].
   pure function range_fault(lowest, highest) result(fault)
      real(wp), intent(in) :: lowest, highest
      character(:), allocatable :: fault

      fault = ''
      if (highest > lowest .and. highest - lowest < least_range) fault = &
         'found heights that differ by '// &
         shown(highest - lowest)//' m, expected 0 or at least '//to_text(least_range, 2)//' m'
   end function range_fault

   !> A number, or infinity in the words of the messages.
   pure function shown(value)
      real(wp), intent(in) :: value
      character(:), allocatable :: shown

      shown = to_text(value, 4)
      if (.not. (ieee_is_finite(value) .or. ieee_is_nan(value))) shown = trim(merge('-Infinity', &
         'Infinity ', value < 0.0_wp))
   end function shown

end module height_limits

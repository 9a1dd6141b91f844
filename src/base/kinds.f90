!> The real numbers of the project: their one kind, the circle constant, and the value of a quantity
!> that is not known, a NaN, which cannot be mistaken for a result; and its long integers.
module kinds
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_fortran_env, only: long => int64, real64
   implicit none (type, external)
   private

   public :: are_finite, exceeds, larger, not_known, quotient

   !> Working precision: IEEE 754 double.
   integer, parameter, public :: wp = real64
   !> Long integers, of 64 bits.
   integer, parameter, public :: int64 = long
   !> Circle constant [-].
   real(wp), parameter, public :: pi = 3.14159265358979323846264338327950288_wp

contains

   !> A quiet NaN.
   pure real(wp) function not_known() result(value)

      value = ieee_value(0.0_wp, ieee_quiet_nan)
   end function not_known

   !> The larger one; a value that is not known is ignored.
   pure elemental real(wp) function larger(a, b) result(value)
      real(wp), intent(in) :: a, b

      value = a
      if (ieee_is_finite(b)) value = b
      if (ieee_is_finite(a) .and. ieee_is_finite(b)) value = max(a, b)
   end function larger

   !> Whether all `values` are finite.
   pure logical function are_finite(values)
      real(wp), contiguous, intent(in) :: values(:)

      are_finite = all(ieee_is_finite(values))
   end function are_finite

   !> Whether `a` is known and larger than `b`, which is known.
   pure elemental logical function exceeds(a, b)
      real(wp), intent(in) :: a, b

      exceeds = .false.
      if (ieee_is_finite(a)) exceeds = a > b
   end function exceeds

   !> a/b; not known if either is not, or b is 0.
   pure elemental real(wp) function quotient(a, b)
      real(wp), intent(in) :: a, b

      quotient = not_known()
      if (.not. (ieee_is_finite(a) .and. ieee_is_finite(b))) return
      if (abs(b) > 0.0_wp) quotient = a/b
   end function quotient

end module kinds

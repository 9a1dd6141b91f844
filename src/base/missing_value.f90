!> The value of a quantity that is not known: a NaN, which cannot be mistaken for a result.
module missing_value
   use, intrinsic :: ieee_arithmetic, only: ieee_quiet_nan, ieee_value
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: not_known

contains

   !> A quiet NaN.
   pure function not_known() result(value)
      real(wp) :: value

      value = ieee_value(0.0_wp, ieee_quiet_nan)
   end function not_known

end module missing_value

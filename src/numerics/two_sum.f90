!> Rounding error of a sum of two numbers, itself a number (Knuth, The Art of Computer Programming
!> 2, section 4.2.2).
module two_sum
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: rest_of_sum

contains

   !> a + b - total, exactly, if `total` is a + b rounded to nearest and nothing overflows.
   elemental function rest_of_sum(total, a, b) result(rest)
      real(wp), intent(in) :: total, a, b
      real(wp) :: rest, share

      share = total - a
      rest = (a - (total - share)) + (b - share)
   end function rest_of_sum

end module two_sum

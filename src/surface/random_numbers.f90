!> Random numbers that are the same on every machine: Philox4x32-10, a counter-based generator.
!>
!> J. K. Salmon, M. A. Moraes, R. O. Dror and D. E. Shaw, Parallel random numbers: as easy as 1, 2,
!> 3, Proc. SC11, 2011. Number i of a seed does not depend on those before it. All products are
!> split into halves of 16 bits: nothing overflows.
module random_numbers
   use, intrinsic :: iso_fortran_env, only: int64
   use constants, only: pi
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: philox, normal_numbers

   integer(int64), parameter :: low_32 = int(z'FFFFFFFF', int64), low_16 = int(z'FFFF', int64)
   integer(int64), parameter :: multipliers(2) = [int(z'D2511F53', int64), int(z'CD9E8D57', int64)]
   integer(int64), parameter :: weyl(2) = [int(z'9E3779B9', int64), int(z'BB67AE85', int64)]
   integer, parameter :: rounds = 10

contains

   !> Four words of 32 bits, 0 ... 2^32 - 1, from a `counter` (4) and a `key` (2) of such words.
   pure function philox(counter, key) result(words)
      integer(int64), intent(in) :: counter(4), key(2)
      integer(int64) :: words(4), high(2), low(2), round_key(2)
      integer :: i

      words = counter
      round_key = key
      do i = 1, rounds
         call multiply(multipliers(1), words(1), high(1), low(1))
         call multiply(multipliers(2), words(3), high(2), low(2))
         words = [ieor(ieor(high(2), words(2)), round_key(1)), low(2), &
            ieor(ieor(high(1), words(4)), round_key(2)), low(1)]
         round_key = iand(round_key + weyl, low_32)
      end do
   end function philox

   !> High and low word of the product of two words of 32 bits.
   pure elemental subroutine multiply(a, b, high, low)
      integer(int64), intent(in) :: a, b
      integer(int64), intent(out) :: high, low
      integer(int64) :: a_high, a_low, b_high, b_low, carry, middle

      a_high = shiftr(a, 16)
      a_low = iand(a, low_16)
      b_high = shiftr(b, 16)
      b_low = iand(b, low_16)
      carry = a_low*b_low
      middle = a_high*b_low + shiftr(carry, 16)
      low = iand(middle, low_16) + a_low*b_high
      high = a_high*b_high + shiftr(middle, 16) + shiftr(low, 16)
      low = ior(shiftl(iand(low, low_16), 16), iand(carry, low_16))
   end subroutine multiply

   !> `n` independent normal numbers (mean 0, variance 1) of a `seed` >= 0, by the transform of Box
   !> and Muller. Each `series` (0 ... 2^32 - 1) of a seed gives others.
   pure function normal_numbers(n, seed, series) result(values)
      integer, intent(in) :: n, seed
      integer(int64), intent(in) :: series
      real(wp) :: values(n)
      integer(int64) :: words(4)
      real(wp) :: angle, radius
      integer :: i

      do i = 1, n, 2
         words = philox([int(i/2, int64), 0_int64, series, 0_int64], [int(seed, int64), 0_int64])
         radius = sqrt(-2.0_wp*log(uniform(words(1), words(2))))
         angle = 2.0_wp*pi*uniform(words(3), words(4))
         values(i) = radius*cos(angle)
         if (i < n) values(i + 1) = radius*sin(angle)
      end do
   end function normal_numbers

   !> A number in (0, 1) from the upper 52 bits of two words.
   pure real(wp) function uniform(first, second)
      integer(int64), intent(in) :: first, second

      uniform = (real(ior(shiftl(first, 20), shiftr(second, 12)), wp) + 0.5_wp)*2.0_wp**(-52)
   end function uniform

end module random_numbers

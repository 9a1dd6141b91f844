!> A checksum of real numbers that come piece by piece.
module checksum
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: checksum_t

   !> Fletcher's sums of the bits so far, in 32-bit halves.
   type :: checksum_t
      integer(int64), private :: first = 0_int64, second = 0_int64
   contains
      procedure :: add
      procedure :: digits => digits_of
   end type checksum_t

   !> The largest prime below 2^32: modulo 2^32 - 1 all bits set would count like all bits clear.
   integer(int64), parameter :: modulus = 4294967291_int64
   !> Numbers after which the sums are reduced: below 2^60 by then.
   integer, parameter :: stretch = 4096
   !> The lower half of 64 bits.
   integer(int64), parameter :: half = 4294967295_int64

contains

   !> Adds `values`. Of the n numbers of a stretch, with halves a and b each, the second sum gets
   !> 2 n times the first, and 2 n a_1 + (2 n - 1) b_1 + (2 n - 2) a_2 + ...; sums of the a and of
   !> the b alone, which do not wait for each other, give that.
   pure subroutine add(self, values)
      class(checksum_t), intent(inout) :: self
      real(wp), intent(in) :: values(:)
      integer(int64) :: bits, high, high_sums, low, low_sums
      integer :: begin, end, i

      do begin = 1, size(values), stretch
         end = min(begin + stretch - 1, size(values))
         low = 0_int64
         low_sums = 0_int64
         high = 0_int64
         high_sums = 0_int64
         do i = begin, end
            bits = transfer(values(i), bits)
            low = low + iand(bits, half)
            low_sums = low_sums + low
            high = high + shiftr(bits, 32)
            high_sums = high_sums + high
         end do
         self%second = modulo(self%second + 2*(end - begin + 1)*self%first + 2*low_sums &
            + 2*high_sums - high, modulus)
         self%first = modulo(self%first + low + high, modulus)
      end do
   end subroutine add

   !> The second and the first sum.
   pure function digits_of(self) result(digits)
      class(checksum_t), intent(in) :: self
      character(len=16) :: digits

      write (digits, '(2z8.8)') self%second, self%first
   end function digits_of

end module checksum

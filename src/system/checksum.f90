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
      !> Adds numbers.
      procedure :: add
      !> 16 hexadecimal digits.
      procedure :: digits => digits_of
   end type checksum_t

   !> The largest prime below 2^32: with 2^32 - 1 itself, bits all set would count like bits all
   !> clear.
   integer(int64), parameter :: modulus = 4294967291_int64
   !> Numbers after which the sums are reduced: below 2^60 by then.
   integer, parameter :: stretch = 4096

contains

   !> Adds `values` (n).
   pure subroutine add(self, values)
      class(checksum_t), intent(inout) :: self
      real(wp), intent(in) :: values(:)
      integer(int64) :: bits
      integer :: i

      do i = 1, size(values)
         bits = transfer(values(i), bits)
         self%first = self%first + ibits(bits, 0, 32)
         self%second = self%second + self%first
         self%first = self%first + ibits(bits, 32, 32)
         self%second = self%second + self%first
         if (modulo(i, stretch) /= 0) cycle
         self%first = modulo(self%first, modulus)
         self%second = modulo(self%second, modulus)
      end do
      self%first = modulo(self%first, modulus)
      self%second = modulo(self%second, modulus)
   end subroutine add

   !> The second and the first sum.
   pure function digits_of(self) result(digits)
      class(checksum_t), intent(in) :: self
      character(len=16) :: digits

      write (digits, '(2z8.8)') self%second, self%first
   end function digits_of

end module checksum

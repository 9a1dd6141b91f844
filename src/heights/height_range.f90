!> The heights of a file, one after another: whether they can be those of a surface.
module height_range
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: height_range_t

   !> A value that lies farther from the next one than this many times the range of all others is
   !> likely the mark of a missing point.
   real(wp), parameter :: far = 10.0_wp

   !> The lowest height and the next above it, and the same of the heights with the other sign; and
   !> the marks of the first of them.
   type :: height_range_t
      real(wp), private :: lowest(2) = huge(1.0_wp), next(2) = huge(1.0_wp)
      integer(int64), private :: marks(2) = 0_int64
   contains
      procedure :: add, find_fault
   end type height_range_t

contains

   !> Takes the next heights; `mark` says where the first one stands, and the others count on.
   pure subroutine add(self, z, mark)
      class(height_range_t), intent(inout) :: self
      real(wp), intent(in) :: z(:)
      integer(int64), intent(in) :: mark
      real(wp) :: value
      integer :: i, k

      do i = 1, size(z)
         do k = 1, 2
            value = merge(z(i), -z(i), k == 1)
            if (value < self%lowest(k)) then
               self%next(k) = self%lowest(k)
               self%lowest(k) = value
               self%marks(k) = mark + i - 1
            else if (value > self%lowest(k)) then
               self%next(k) = min(self%next(k), value)
            end if
         end do
      end do
   end subroutine add

   !> "found ..., expected ..." where two or more heights cannot be those of a surface, or do not
   !> differ though they `must_vary`, else empty; and the mark of the height that cannot be one.
   pure subroutine find_fault(self, must_vary, fault, mark)
      class(height_range_t), intent(in) :: self
      logical, intent(in) :: must_vary
      character(:), allocatable, intent(out) :: fault
      integer(int64), intent(inout) :: mark
      real(wp) :: others
      integer :: k

      fault = ''
      if (.not. self%next(1) < huge(1.0_wp)) then
         if (must_vary) fault = 'found heights that are all '//to_text(self%lowest(1))// &
            ', expected those of a surface'
         return
      end if
      do k = 1, 2
         others = -(self%lowest(3 - k) + self%next(k))
         if (others <= 0.0_wp .or. self%next(k) - self%lowest(k) <= far*others) cycle
         mark = self%marks(k)
         fault = 'found '//to_text(merge(self%lowest(k), -self%lowest(k), k == 1))// &
            ', far from all other heights and likely the mark of a missing point, expected '// &
            'heights without gaps'
      end do
   end subroutine find_fault

end module height_range

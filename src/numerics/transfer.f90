!> Transfers between a grid of n intervals and one of n/2 (nodes 0..n): pure, one-dimensional,
!> uniform.
!>
!> Source: Trottenberg, Oosterlee & Schueller, Multigrid, 2001, section 2.3; thesis section 2.4.2.
module transfer
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: full_weighting, prolong_linear, prolong_cubic

   !> Ratio of neighbouring pressures above which there is a spike.
   real(wp), parameter :: steep = 4.0_wp

contains

   !> coarse(i) = (fine(2i-1) + 2 fine(2i) + fine(2i+1))/4 inside, injection at both ends.
   pure subroutine full_weighting(fine, coarse)
      real(wp), intent(in) :: fine(0:)
      real(wp), intent(out) :: coarse(0:)
      integer :: i, n

      n = ubound(coarse, 1)
      coarse(0) = fine(0)
      do concurrent (i=1:n - 1)
         coarse(i) = 0.25_wp*(fine(2*i - 1) + 2*fine(2*i) + fine(2*i + 1))
      end do
      coarse(n) = fine(2*n)
   end subroutine full_weighting

   !> Linear interpolation of `coarse` (0..n/2) to `fine` (0..n).
   pure subroutine prolong_linear(coarse, fine)
      real(wp), intent(in) :: coarse(0:)
      real(wp), intent(out) :: fine(0:)
      integer :: i

      do concurrent (i=0:ubound(coarse, 1) - 1)
         fine(2*i) = coarse(i)
         fine(2*i + 1) = 0.5_wp*(coarse(i) + coarse(i + 1))
      end do
      fine(ubound(fine, 1)) = coarse(ubound(coarse, 1))
   end subroutine prolong_linear

   !> Cubic interpolation of a pressure `coarse` (0..n/2) >= 0 to `fine` (0..n) >= 0; linear at both
   !> ends, in front of the cavitated zone (where the slope jumps), and where the cubic would
   !> undershoot zero. Near a spike, where the four values differ by more than a factor `steep`, the
   !> cubic stays between both neighbours.
   pure subroutine prolong_cubic(coarse, fine)
      real(wp), intent(in) :: coarse(0:)
      real(wp), intent(out) :: fine(0:)
      real(wp) :: cubic
      integer :: i

      call prolong_linear(coarse, fine)
      do i = 1, ubound(coarse, 1) - 2
         if (coarse(i + 2) <= 0.0_wp) cycle
         cubic = (9*(coarse(i) + coarse(i + 1)) - coarse(i - 1) - coarse(i + 2))/16
         associate (around => coarse(i - 1:i + 2), beside => coarse(i:i + 1))
            if (maxval(around) > steep*minval(around)) cubic = min(max(cubic, minval(beside)), &
               maxval(beside))
         end associate
         if (cubic >= 0.0_wp) fine(2*i + 1) = cubic
      end do
   end subroutine prolong_cubic

end module transfer

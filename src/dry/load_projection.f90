!> Finds the pressure nearest to a given one within its bounds and with its load.
module load_projection
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: shift_into_bounds

   !> Most steps of the search for the shift; bisection alone would end in 64.
   integer, parameter :: max_steps = 100

contains

   !> Replaces `x` by clip(x + shift, 0, upper) with the shift for which the sum is `total`
   !> (0 <= total <= n upper).
   !>
   !> This is the Euclidean projection onto bounds and load: the sum rises with the shift, piecewise
   !> linear, so Newton's method, kept inside its bracket, ends after a few steps.
   pure subroutine shift_into_bounds(x, upper, total)
      real(wp), intent(inout) :: x(:)
      real(wp), intent(in) :: upper, total
      real(wp) :: shift, low, high, error, next
      integer :: step, inside

      if (size(x) == 0) return
      low = -maxval(x)
      high = min(upper, total) - minval(x)
      if (size(x) == 1) high = max(high, total - x(1))
      shift = min(max(0.0_wp, low), high)
      do step = 1, max_steps
         call clipped_sum(x, shift, upper, error, inside)
         error = error - total
         if (abs(error) <= epsilon(1.0_wp)*total*max(2.0_wp, sqrt(real(size(x), wp)))) exit
         if (error > 0.0_wp) then
            high = shift
         else
            low = shift
         end if
         next = 0.5_wp*(low + high)
         if (inside > 0) next = shift - error/inside
         if (next <= low .or. next >= high) next = 0.5_wp*(low + high)
         if (next <= low .or. next >= high) exit
         shift = next
      end do
      x = min(max(x + shift, 0.0_wp), upper)
   end subroutine shift_into_bounds

   !> Sum of clip(x + shift, 0, upper) and the number of values strictly inside the bounds.
   pure subroutine clipped_sum(x, shift, upper, total, inside)
      real(wp), intent(in) :: x(:), shift, upper
      real(wp), intent(out) :: total
      integer, intent(out) :: inside
      real(wp) :: y
      integer :: i

      total = 0.0_wp
      inside = 0
      do i = 1, size(x)
         y = x(i) + shift
         if (y >= upper) then
            total = total + upper
         else if (y > 0.0_wp) then
            total = total + y
            inside = inside + 1
         end if
      end do
   end subroutine clipped_sum

end module load_projection

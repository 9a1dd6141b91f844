!> Returns pressures that an iteration has moved out of their bounds and restores the load: the
!> nearest pressure within both, or one by the network of the iteration.
module load_projection
   use kinds, only: wp
   use tree_network, only: tree_network_t
   implicit none (type, external)
   private

   public :: bring_back, settle_load, shift_into_bounds

   !> Most steps of the search for the shift; bisection alone would end in 64.
   integer, parameter :: max_steps = 100

   !> Most corrections by the network in an iteration; values then still beyond a bound are clipped
   !> and shifted.
   integer, parameter :: max_returns = 20
   !> The network is not used again once less than this share of the first excess remains beyond the
   !> bounds.
   real(wp), parameter :: worth_a_return = 1.0e-2_wp

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

   !> Moves values of `q` beyond 0 and `hardness` to these bounds. The network distributes the load
   !> added by this over the other nodes, with its potentials there unchanged: neighbours give most,
   !> so that the energy rises less than by a uniform shift. Nodes that this moves out of the bounds
   !> follow; in the end few or none are outside. `loose`, `back`, `change`: work arrays.
   subroutine bring_back(hardness, network, q, loose, back, change)
      real(wp), intent(in) :: hardness
      type(tree_network_t), intent(inout) :: network
      real(wp), contiguous, intent(inout) :: q(:)
      integer, contiguous, intent(out) :: loose(:)
      real(wp), contiguous, intent(out) :: back(:), change(:)
      real(wp) :: first, outside
      integer :: before, count, k, turn

      count = 0
      first = 0.0_wp
      do turn = 1, max_returns
         before = count
         outside = 0.0_wp
         nodes: do k = 1, size(q)
            if (q(k) >= 0.0_wp .and. q(k) <= hardness) cycle nodes
            count = count + 1
            loose(count) = k
            back(count) = min(max(q(k), 0.0_wp), hardness) - q(k)
            outside = outside + abs(back(count))
         end do nodes
         if (turn == 1) first = outside
         if (.not. outside > worth_a_return*first) exit
         call network%spread(loose(:count), back(:count), change)
         do k = before + 1, count
            q(loose(k)) = min(max(q(loose(k)), 0.0_wp), hardness)
            back(k) = 0.0_wp
         end do
         q = q + change
      end do
   end subroutine bring_back

   !> Makes `q` add up to `load`: nodes between the bounds share the missing rounding error, nodes
   !> on a bound stay there. If values are still beyond a bound, or none is between them, `q`
   !> becomes the nearest one with bounds and load.
   subroutine settle_load(hardness, load, q)
      real(wp), value :: hardness, load
      real(wp), contiguous, intent(inout) :: q(:)
      real(wp) :: highest, inside, lowest, share, total
      integer :: k

      inside = 0.0_wp
      total = 0.0_wp
      !$omp simd reduction(+:inside, total)
      do k = 1, size(q)
         total = total + q(k)
         inside = inside + merge(1.0_wp, 0.0_wp, q(k) > 0.0_wp .and. q(k) < hardness)
      end do
      share = (load - total)/max(inside, 1.0_wp)
      lowest = 0.0_wp
      highest = 0.0_wp
      !$omp simd reduction(min:lowest) reduction(max:highest)
      do k = 1, size(q)
         q(k) = q(k) + merge(share, 0.0_wp, q(k) > 0.0_wp .and. q(k) < hardness)
         lowest = min(lowest, q(k))
         highest = max(highest, q(k))
      end do
      if (inside <= 0.0_wp .or. lowest < 0.0_wp .or. highest > hardness) then
         call shift_into_bounds(q, hardness, load)
      end if
   end subroutine settle_load

end module load_projection

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
   !> follow; in the end few or none are outside. `back`, `change`, `is_back`: work arrays.
   subroutine bring_back(hardness, network, q, back, change, is_back)
      real(wp), intent(in) :: hardness
      type(tree_network_t), intent(inout) :: network
      real(wp), contiguous, intent(inout) :: q(:)
      real(wp), contiguous, intent(out) :: back(:), change(:)
      logical, contiguous, intent(out) :: is_back(:)
      real(wp) :: first, outside
      integer :: k, turn

      is_back = .false.
      first = 0.0_wp
      do turn = 1, max_returns
         outside = 0.0_wp
         nodes: do k = 1, size(q)
            if (turn > 1) q(k) = q(k) + change(k)
            back(k) = 0.0_wp
            if (q(k) >= 0.0_wp .and. q(k) <= hardness) cycle nodes
            back(k) = min(max(q(k), 0.0_wp), hardness) - q(k)
            is_back(k) = .true.
            outside = outside + abs(back(k))
         end do nodes
         if (turn == 1) first = outside
         if (.not. outside > worth_a_return*first) exit
         call network%solve(back, change, is_back)
      end do
      if (turn > max_returns) q = q + change
   end subroutine bring_back

   !> Makes `q` add up to `load`: nodes between the bounds share the missing rounding error, nodes
   !> on a bound stay there. If values are still beyond a bound, or none is between them, `q`
   !> becomes the nearest one with bounds and load.
   subroutine settle_load(hardness, load, q)
      real(wp), intent(in) :: hardness, load
      real(wp), contiguous, intent(inout) :: q(:)
      real(wp) :: share, total
      integer :: inside, k
      logical :: is_outside

      inside = 0
      total = 0.0_wp
      do k = 1, size(q)
         total = total + q(k)
         inside = inside + merge(1, 0, q(k) > 0.0_wp .and. q(k) < hardness)
      end do
      is_outside = inside == 0
      if (inside > 0) then
         share = (load - total)/inside
         do k = 1, size(q)
            if (q(k) > 0.0_wp .and. q(k) < hardness) q(k) = q(k) + share
            is_outside = is_outside .or. q(k) < 0.0_wp .or. q(k) > hardness
         end do
      end if
      if (is_outside) call shift_into_bounds(q, hardness, load)
   end subroutine settle_load

end module load_projection

!> Returns pressures that an iteration has moved out of their bounds, and restores the load.
module bound_return
   use kinds, only: wp
   use load_projection, only: shift_into_bounds
   use tree_network, only: tree_network_t
   implicit none (type, external)
   private

   public :: bring_back, settle_load

   !> Most corrections by the network in an iteration; values then still beyond a bound are clipped
   !> and shifted.
   integer, parameter :: max_returns = 20
   !> The network is not used again once less than this share of the first excess remains beyond the
   !> bounds.
   real(wp), parameter :: worth_a_return = 1.0e-2_wp

contains

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
         do k = 1, size(q)
            if (turn > 1) q(k) = q(k) + change(k)
            back(k) = min(max(q(k), 0.0_wp), hardness) - q(k)
            is_back(k) = is_back(k) .or. abs(back(k)) > 0.0_wp
            outside = outside + abs(back(k))
         end do
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

end module bound_return

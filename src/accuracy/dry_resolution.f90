!> Predicts the next grid of a dry contact with a target accuracy of its contact area from the grids
!> before.
!>
!> Where a grid resolves the waves of the surface the estimated error of the area falls as dx, or
!> with the order observed on the last two grids; the next grid is the one predicted to meet the
!> target.
module dry_resolution
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_quantities, only: contact_area, dry_outcome_t
   use even_grids, only: even_nodes
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: area_doubt, dry_trial_t, finer_nodes

   !> Estimated error of a grid without a solution or estimate.
   real(wp), parameter, public :: unknown_doubt = huge(1.0_wp)

   !> A grid that was solved.
   type :: dry_trial_t
      !> Nodes in x and y (1 for a line).
      integer :: nodes(2) = 0
      !> Largest estimated relative error of the contact area over all loads.
      real(wp) :: doubt = unknown_doubt
   end type dry_trial_t

   !> Largest refinement to the next grid, of a line and of an area, and without a solution.
   real(wp), parameter :: farthest(2) = [4.0_wp, 2.0_wp], doubling = 2.0_wp
   !> Bounds of the order of the estimate; 1 after the first grid.
   real(wp), parameter :: orders(2) = [0.7_wp, 1.3_wp]
   !> The next grid is predicted to meet this share of the target.
   real(wp), parameter :: margin = 0.97_wp

contains

   !> Largest relative error of the contact area over all loads of an `outcome`.
   pure real(wp) function area_doubt(outcome) result(doubt)
      type(dry_outcome_t), intent(in) :: outcome

      doubt = unknown_doubt
      if (.not. allocated(outcome%errors)) return
      if (all(ieee_is_finite(outcome%errors(contact_area, :)))) doubt = &
         maxval(outcome%errors(contact_area, :)/outcome%rows%values(contact_area))
   end function area_doubt

   !> Nodes of the grid after `trials` (at least one), none of which meet `target`; 0 if no grid of
   !> up to `most` nodes is finer, or if the last two have no solution.
   pure function finer_nodes(trials, target, most) result(nodes)
      type(dry_trial_t), intent(in) :: trials(:)
      real(wp), intent(in) :: target
      integer, intent(in) :: most
      integer :: nodes(2)
      real(wp) :: factor, first(2), largest, order
      integer :: directions, n

      nodes = 0
      n = size(trials)
      if (all(trials(max(n - 1, 1):)%doubt >= unknown_doubt) .and. n > 1) return
      associate (last => trials(n), before => trials(max(n - 1, 1)))
         directions = merge(1, 2, last%nodes(2) == 1)
         factor = doubling
         if (last%doubt < unknown_doubt) then
            order = 1.0_wp
            if (n > 1 .and. before%doubt < unknown_doubt) order = log(before%doubt/last%doubt) &
               /log(real(last%nodes(1), wp)/before%nodes(1))
            order = min(max(order, orders(1)), orders(2))
            factor = min((last%doubt/(margin*target))**(1.0_wp/order), farthest(directions))
         end if
         ! Both directions keep the ratio of the first grid.
         first = trials(1)%nodes
         factor = factor*(product(last%nodes/first))**(1.0_wp/directions)
         largest = (most/product(first))**(1.0_wp/directions)
         nodes(:directions) = even_nodes(factor*first(:directions), largest*first(:directions))
         nodes(directions + 1:) = 1
         if (product(real(nodes, wp)) <= product(real(last%nodes, wp))) nodes = 0
      end associate
   end function finer_nodes

end module dry_resolution

!> The grid of a dry contact for a wanted accuracy of its contact area: what the grids before tell
!> about the next one.
!>
!> Where a grid sees the waves of the surface the estimated error of the area falls like dx, or with
!> the order that the last two grids show; the next grid is the one that is foretold to do.
module dry_resolution
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_quantities, only: contact_area, dry_outcome_t
   use even_grids, only: even_nodes
   use kinds, only: wp
   use missing_value, only: not_known
   implicit none (type, external)
   private

   public :: area_doubt, dry_trial_t, finer_nodes, is_met

   !> A grid that was solved.
   type :: dry_trial_t
      !> Nodes in x and y (1 of a line).
      integer :: nodes(2) = 0
      !> Largest estimated relative error of the contact area of all loads; NaN: not known.
      real(wp) :: doubt = 0.0_wp
   end type dry_trial_t

   !> How much finer the next grid is at most, of a line and of an area, and without a solution.
   real(wp), parameter :: farthest(2) = [4.0_wp, 2.0_wp], doubling = 2.0_wp
   !> Bounds of the order with which the estimate falls; of a first grid 1.
   real(wp), parameter :: orders(2) = [0.7_wp, 1.3_wp]
   !> The next grid is foretold to stay below the target by this factor.
   real(wp), parameter :: margin = 0.97_wp

contains

   !> Largest relative error of the contact area of all loads of an `outcome`; NaN where one is not
   !> known, or estimated.
   pure function area_doubt(outcome) result(doubt)
      type(dry_outcome_t), intent(in) :: outcome
      real(wp) :: doubt

      doubt = not_known()
      if (.not. allocated(outcome%errors)) return
      if (all(ieee_is_finite(outcome%errors(contact_area, :)))) doubt = &
         maxval(outcome%errors(contact_area, :)/outcome%rows%values(contact_area))
   end function area_doubt

   !> True if a solution keeps the `target`.
   pure function is_met(trial, target)
      type(dry_trial_t), intent(in) :: trial
      real(wp), intent(in) :: target
      logical :: is_met

      is_met = .false.
      if (ieee_is_finite(trial%doubt)) is_met = trial%doubt <= target
   end function is_met

   !> Nodes of the grid after `trials`, at least one, which do not keep the `target`; 0 if there is
   !> none of up to `most` nodes, or if the last two grids have no solution.
   pure function finer_nodes(trials, target, most) result(nodes)
      type(dry_trial_t), intent(in) :: trials(:)
      real(wp), intent(in) :: target
      integer, intent(in) :: most
      integer :: nodes(2)
      real(wp) :: factor, first(2), largest
      integer :: directions

      nodes = 0
      associate (last => trials(size(trials)))
         directions = merge(1, 2, last%nodes(2) == 1)
         if (without_solution(trials) > 1) return
         factor = doubling
         if (ieee_is_finite(last%doubt)) factor = &
            min((last%doubt/(margin*target))**(1.0_wp/observed_order(trials)), &
            farthest(directions))
         ! Both directions keep the ratio of the first grid.
         first = trials(1)%nodes
         factor = factor*(product(last%nodes/first))**(1.0_wp/directions)
         largest = (most/product(first))**(1.0_wp/directions)
         nodes(:directions) = even_nodes(factor*first(:directions), largest*first(:directions))
         nodes(directions + 1:) = 1
         if (product(real(nodes, wp)) <= product(real(last%nodes, wp))) nodes = 0
      end associate
   end function finer_nodes

   !> Number of grids without a solution at the end of `trials`.
   pure function without_solution(trials) result(number)
      type(dry_trial_t), intent(in) :: trials(:)
      integer :: number

      number = 0
      do while (number < size(trials))
         if (ieee_is_finite(trials(size(trials) - number)%doubt)) return
         number = number + 1
      end do
   end function without_solution

   !> The order with which the estimate fell from the grid before the last to the last one.
   pure function observed_order(trials) result(order)
      type(dry_trial_t), intent(in) :: trials(:)
      real(wp) :: order
      integer :: n

      order = 1.0_wp
      n = size(trials)
      if (n < 2) return
      if (.not. ieee_is_finite(trials(n - 1)%doubt)) return
      order = log(trials(n - 1)%doubt/trials(n)%doubt)/log(real(trials(n)%nodes(1), &
         wp)/trials(n - 1)%nodes(1))
      order = min(max(order, orders(1)), orders(2))
   end function observed_order

end module dry_resolution

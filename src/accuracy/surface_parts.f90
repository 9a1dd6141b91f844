!> What one of several features, or one of two rough surfaces, changes in a passage, from one coarse
!> grid.
!>
!> What all roughness changes is known on the own grid of the run, next to nothing being needed for
!> it, and on the coarse grid too: how far these are apart tells how far off the grid is with its
!> parts, and in which direction.
module surface_parts
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use ablation_runs, only: largest_change, set_change
   use adequacy, only: influence_t
   use kinds, only: wp
   use missing_value, only: quotient
   use own_passages, only: cost_on, own_runs_t
   use passage_pairs, only: coarse_tolerance, scene_t, sees_all, steps_to_start
   use quantities, only: quantity_count
   implicit none (type, external)
   private

   public :: affordable_grid, take_part

   !> The error of a change: this many times that of the change by all roughness on the grid, a
   !> share of itself, and what iterations leave.
   real(wp), parameter :: widths(4) = [1.2_wp, 0.1_wp, 0.0_wp, 2*coarse_tolerance]
   !> And a share of the largest change of a film by all roughness, for which waves pass the nodes
   !> alike by chance.
   real(wp), parameter :: share_of_all = 0.1_wp
   !> The change by a part is scaled as that by all roughness is on the own grid of the run, but by
   !> no more than this or its inverse.
   real(wp), parameter :: largest_factor = 2.0_wp

contains

   !> Fills the `row` of a part whose `change` on a coarse grid, with what spikes may add (`doubt`),
   !> is known, beside what all roughness changes there and on the own grid of the run (here).
   pure subroutine take_part(change, doubt, all_here, all_there, row)
      real(wp), intent(in) :: change(quantity_count), doubt(quantity_count, 2), &
         all_here(quantity_count), all_there(quantity_count)
      type(influence_t), intent(inout) :: row
      real(wp) :: scaled(quantity_count)

      scaled = change*factor_of(all_here, all_there)
      call set_change(row, reshape([scaled, scaled + (all_there - all_here)], [quantity_count, &
         2]), doubt, widths)
      row%error = row%error + share_of_all*largest_change(all_there)
   end subroutine take_part

   !> By how much more all roughness changes a quantity on the own grid of the run, within bounds.
   pure elemental function factor_of(all_here, all_there) result(factor)
      real(wp), intent(in) :: all_here, all_there
      real(wp) :: factor

      factor = quotient(all_here, all_there)
      if (.not. ieee_is_finite(factor)) factor = 1.0_wp
      factor = min(max(factor, 1/largest_factor), largest_factor)
   end function factor_of

   !> The finer one of the grids of n/4 (1) and n/8 intervals (2) that sees all waves and on which
   !> this many parts fit into the budget; 0: none. The run has made that on n/4 with everything;
   !> `has_coarsest`: that on n/8 is there too.
   pure function affordable_grid(scene, runs, parts, has_coarsest, budget) result(g)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      integer, intent(in) :: parts
      logical, intent(in) :: has_coarsest
      real(wp), intent(in) :: budget
      integer :: g
      integer :: intervals, runs_there

      do g = 1, 2
         intervals = scene%contact%domain%intervals/merge(4, 8, g == 1)
         runs_there = parts
         if (g == 2 .and. .not. has_coarsest) runs_there = parts + 1
         if (sees_all(scene, intervals) .and. runs_there*cost_on(scene, runs, intervals) &
            + steps_to_start*intervals <= budget) return
      end do
      g = 0
   end function affordable_grid

end module surface_parts

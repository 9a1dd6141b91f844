!> Quantities of the solutions on the grids of a hierarchy.
module level_summaries
   use film_shear, only: friction_of
   use kinds, only: wp
   use line_hierarchy, only: line_hierarchy_t
   use line_level, only: line_level_t
   use line_summary, only: line_summary_t, summary_of_fields
   implicit none (type, external)
   private

   public :: coarser_summaries, level_summary

   !> Most solutions on coarser grids that an error estimate uses.
   integer, parameter :: max_coarser = 3

contains

   !> Summaries on n/2, n/4 and n/8 intervals, n those of the finest level, as far as these levels
   !> are solved accurately enough and no cycle has changed them since.
   pure function coarser_summaries(hierarchy) result(coarser)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(line_summary_t), allocatable :: coarser(:)
      integer :: below

      allocate (coarser(0))
      if (hierarchy%coarsest < hierarchy%finest) return
      do below = 1, min(max_coarser, hierarchy%finest - 1)
         associate (level => hierarchy%levels(hierarchy%finest - below))
            if (.not. level%is_coarse_run) exit
            coarser = [coarser, level_summary(level)]
         end associate
      end do
   end function coarser_summaries

   !> Summary of the solution on a level, whose coefficients must be those of the solution.
   pure function level_summary(level) result(summary)
      type(line_level_t), intent(in) :: level
      type(line_summary_t) :: summary

      summary = summary_of_fields(level%x, level%state%pressure, level%state%film, 0.0_wp, &
         friction_of(level))
   end function level_summary

end module level_summaries

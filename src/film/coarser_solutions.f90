!> Solutions on coarser grids that a steady solution has passed on its way.
module coarser_solutions
   use kinds, only: wp
   use line_hierarchy, only: line_hierarchy_t
   use line_level, only: line_level_t
   use line_summary, only: line_summary_t, summary_of_fields
   implicit none (type, external)
   private

   public :: coarser_summaries, level_summary

   !> As many as an error estimate can use.
   integer, parameter :: max_coarser = 3

contains

   !> Summaries on n/2, n/4 and n/8 intervals, n those of the finest level: as far as these levels
   !> are solved well enough and no cycle has changed them since.
   pure function coarser_summaries(hierarchy) result(coarser)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(line_summary_t), allocatable :: coarser(:)
      integer :: below, passed

      passed = 0
      if (hierarchy%coarsest == hierarchy%finest) then
         do while (passed < min(max_coarser, hierarchy%finest - 1))
            if (.not. hierarchy%levels(hierarchy%finest - passed - 1)%is_companion) exit
            passed = passed + 1
         end do
      end if
      allocate (coarser(passed))
      do below = 1, passed
         coarser(below) = level_summary(hierarchy%levels(hierarchy%finest - below))
      end do
   end function coarser_summaries

   !> Summary of the solution on a level.
   pure function level_summary(level) result(summary)
      type(line_level_t), intent(in) :: level
      type(line_summary_t) :: summary

      summary = summary_of_fields(level%x, level%state%pressure, level%state%film, 0.0_wp)
   end function level_summary

end module coarser_solutions

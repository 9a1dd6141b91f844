!> What the closing table says of a pressure spike that is narrower than the grid.
module spike_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use quantities, only: p_central, p_max
   use quantity_text, only: wrapped
   implicit none (type, external)
   private

   public :: is_central_shown, spike_lines

   !> A largest pressure with a smaller relative error needs no other beside it.
   real(wp), parameter :: well_known = 0.01_wp
   !> Columns of the closing table, and of the names before its words.
   integer, parameter :: columns = 80, margin = 12

contains

   !> Whether the central pressure is shown beside the largest: that is not known to 1 %, and less
   !> than half as well as the central one.
   pure function is_central_shown(summary) result(is_shown)
      type(line_summary_t), intent(in) :: summary
      logical :: is_shown

      associate (central => summary%of(p_central), largest => summary%of(p_max))
         is_shown = ieee_is_finite(central%error_estimate)
         if (is_shown .and. ieee_is_finite(largest%error_estimate)) is_shown = &
            largest%error_estimate > max(well_known*largest%value, 2*central%error_estimate)
      end associate
   end function is_central_shown

   !> Which pressure to take and how to have the other, as lines of the table; empty where no spike
   !> is the reason. `is_asked`: &accuracy target_p_max is given; `is_steady`: else it cannot be;
   !> `has_intervals`: &domain intervals is given, which does not go with it.
   pure function spike_lines(summary, is_asked, is_steady, has_intervals) result(lines)
      type(line_summary_t), intent(in) :: summary
      logical, intent(in) :: is_asked, is_steady, has_intervals
      character(:), allocatable :: lines
      real(wp) :: spike

      lines = ''
      spike = merge(summary%crests%corner, 0.0_wp, summary%crests%corner_top > 0.0_wp)
      if (ieee_is_finite(summary%crests%spike)) spike = summary%crests%spike
      if (.not. is_central_shown(summary) .or. .not. spike > 0.0_wp) return
      if (spike < summary%of(p_max)%value) then
         lines = 'a pressure spike near the outlet is narrower than this grid, and on finer' &
            //' ones may rise above p_max'
      else
         lines = 'p_max is the top of a pressure spike near the outlet that is narrower than' &
            //' this grid, and rises on finer ones'
      end if
      lines = '  spike     '//lines//'; p_central is the pressure beside it, at X = 0'
      if (.not. is_steady) lines = lines//'. More &domain intervals show more of it'
      if (is_steady .and. .not. is_asked) then
         lines = lines//'. For a p_max that is known to 1 %'
         if (has_intervals) lines = lines//', without &domain intervals'
         lines = lines//':'
      end if
      lines = wrapped(lines, columns, margin)
      if (is_steady .and. .not. is_asked) lines = lines//new_line('a')//repeat(' ', margin) &
         //'--set accuracy.target=0.01 --set accuracy.target_p_max=0.01'
   end function spike_lines

end module spike_text

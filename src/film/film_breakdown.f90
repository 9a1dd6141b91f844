!> Film breakdown: a film below a given floor, where the full-film model no longer holds.
!>
!> The floor is not part of the equations and changes no film or pressure; it is checked after every
!> solution.
module film_breakdown
   use iteration_report, only: breakdown_t, report_t
   use kinds, only: wp
   use quantities, only: parabola_minimum
   use solver_settings, only: solver_settings_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_breakdown

contains

   !> Records a film below the floor (its smallest value by the parabola through three nodes) or
   !> closed at a node: the first one with its position, the smallest of all. The report is no
   !> longer converged if a breakdown ends the run. x, film (n).
   pure subroutine check_breakdown(x, film, settings, step, time, report)
      real(wp), intent(in) :: x(:), film(:)
      type(solver_settings_t), intent(in) :: settings
      integer, intent(in) :: step
      real(wp), intent(in) :: time
      type(report_t), intent(inout) :: report
      real(wp) :: smallest
      integer :: node

      smallest = parabola_minimum(x, film)
      associate (breakdown => report%breakdown)
         breakdown%is_now = smallest < settings%film_floor .or. any(film <= 0.0_wp)
         if (.not. breakdown%is_now) return
         breakdown%count = breakdown%count + 1
         breakdown%smallest_film = min(breakdown%smallest_film, smallest)
         if (breakdown%count == 1) then
            node = minloc(film, 1)
            breakdown%step = step
            breakdown%time = time
            breakdown%position = x(node)
            breakdown%film = merge(film(node), smallest, film(node) <= 0.0_wp)
         end if
         if (settings%on_film_breakdown == 'continue' .and. all(film > 0.0_wp)) return
         report%converged = .false.
         report%reason = breakdown_reason(breakdown, settings%film_floor)
      end associate
   end subroutine check_breakdown

   !> Where and when the film first broke down, dimensionless: 'film breakdown at X = -0.3
   !> (T = 0.5): H = 0.01 ...'.
   pure function breakdown_reason(breakdown, floor) result(reason)
      type(breakdown_t), intent(in) :: breakdown
      real(wp), intent(in) :: floor
      character(:), allocatable :: reason

      reason = 'film breakdown at X = '//to_text(breakdown%position, 2)
      if (breakdown%step > 0) reason = reason//' (T = '//to_text(breakdown%time, 4)//')'
      reason = reason//': '
      if (breakdown%film <= 0.0_wp) then
         reason = reason//'the film would close'
      else
         reason = reason//'the film would be H = '//to_text(breakdown%film, 3) &
            //', below the floor H = '//to_text(floor, 3)
      end if
   end function breakdown_reason

end module film_breakdown

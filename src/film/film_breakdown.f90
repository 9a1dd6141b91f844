!> Film breakdown: a film below a given floor, where the full-film model no longer holds.
!>
!> The floor is not part of the equations and changes no film or pressure; it is checked after every
!> solution.
module film_breakdown
   use iteration_report, only: report_t
   use kinds, only: wp
   use quantities, only: smallest_film
   use line_contact, only: solver_settings_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: check_breakdown

contains

   !> Records a film below the floor (its smallest value between the nodes) or closed at a node: the
   !> first one with its position, the smallest of all. The report is no longer converged if a
   !> breakdown ends the run. x (n), film (n), or y (m), film (n m) of a point contact.
   pure subroutine check_breakdown(x, film, settings, step, time, report, y)
      real(wp), intent(in) :: x(:), film(:)
      type(solver_settings_t), intent(in) :: settings
      integer, intent(in) :: step
      real(wp), intent(in) :: time
      type(report_t), intent(inout) :: report
      real(wp), intent(in), optional :: y(:)
      real(wp) :: smallest
      integer :: node

      smallest = smallest_film(x, film)
      associate (breakdown => report%breakdown)
         breakdown%is_now = smallest < settings%film_floor .or. any(film <= 0.0_wp)
         if (.not. breakdown%is_now) return
         breakdown%count = breakdown%count + 1
         breakdown%smallest_film = min(breakdown%smallest_film, smallest)
         if (breakdown%count == 1) then
            node = minloc(film, 1)
            breakdown%step = step
            breakdown%time = time
            breakdown%position = x(mod(node - 1, size(x)) + 1)
            if (present(y)) breakdown%across = y((node - 1)/size(x) + 1)
            breakdown%film = merge(film(node), smallest, film(node) <= 0.0_wp)
         end if
         if (settings%on_film_breakdown == 'continue' .and. all(film > 0.0_wp)) return
         report%converged = .false.
         report%reason = 'film breakdown at X = '//to_text(breakdown%position, 2)
         if (breakdown%step > 0) report%reason = report%reason//' (T = ' &
            //to_text(breakdown%time, 4)//')'
         if (breakdown%film <= 0.0_wp) then
            report%reason = report%reason//': the film would close'
            if (step == 0) report%reason = 'film closed at T = 0: the surfaces at their start '// &
               'are higher than the smooth film; '//report%reason
         else
            report%reason = report%reason//': the film would be H = '//to_text(breakdown%film, 3) &
               //', below the floor H = '//to_text(settings%film_floor, 3)
         end if
      end associate
   end subroutine check_breakdown

end module film_breakdown

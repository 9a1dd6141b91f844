!> Pseudo-transient continuation: the steady contact as the end of a motion from where it stands, in
!> steps that grow.
!>
!> Newton's method alone cannot move a pressure spike that is narrower than the grid, nor shed a
!> wild Eyring start: the squeeze term -lambda/dT (rho H - rho H_old) holds every step near the last
!> one, and the oil carries the spike where it belongs. Source: Kelley & Keyes, SIAM J. Numer. Anal.
!> 35, 1998, 508-523.
module pseudo_time
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: count_work, line_hierarchy_t
   use line_level, only: line_level_t
   use lubricant, only: fluid_density
   use newton_line, only: solve_newton
   use observer, only: is_stopped, observer_t
   implicit none (type, external)
   private

   public :: follow_time

   !> First step and the smallest one tried, in dX; the last one, at which nothing is left of the
   !> squeeze term (oil passes the contact in a time of 2).
   real(wp), parameter :: first_step = 1.0_wp, smallest_step = 1.0e-3_wp, last_step = 1.0e3_wp
   !> The step grows after a success (twice where that took few Newton steps) and shrinks after a
   !> failure.
   real(wp), parameter :: growth = 1.5_wp, shrinkage = 0.25_wp
   integer, parameter :: few_newton_steps = 3
   !> Steps tried in all; accuracy and Newton steps of each.
   integer, parameter :: max_steps = 120, max_newton_steps = 15
   real(wp), parameter :: step_tolerance = 1.0e-3_wp

contains

   !> Follows the steady problem posed on level k from its present pressure. `is_settled` is false
   !> if the steps shrink to nothing or are too many, or `watcher` wants to stop; the level is then
   !> left where the motion stands.
   subroutine follow_time(hierarchy, contact, k, is_settled, watcher)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: k
      logical, intent(out) :: is_settled
      class(observer_t), intent(inout), optional :: watcher
      type(film_state_t) :: before
      real(wp), allocatable :: right_side(:)
      real(wp) :: time_step
      integer :: step

      associate (level => hierarchy%levels(k))
         allocate (right_side, source=level%rhs_reynolds)
         time_step = first_step*level%dx
         is_settled = .false.
         do step = 1, max_steps
            if (is_stopped(watcher)) exit
            before = level%state
            call pose_step(contact, level, right_side, time_step)
            call solve_newton(hierarchy%newton, contact, level, step_tolerance, &
               max_newton_steps, watcher)
            call count_work(hierarchy, k, hierarchy%newton%steps)
            if (hierarchy%newton%is_converged) then
               is_settled = time_step >= last_step
               time_step = time_step*merge(growth**2, growth, &
                  hierarchy%newton%steps <= few_newton_steps)
            else
               time_step = shrinkage*time_step
               level%state = before
            end if
            if (is_settled .or. time_step < smallest_step*level%dx) exit
         end do
         level%inverse_time_step = 0.0_wp
         level%rhs_reynolds = right_side
      end associate
   end subroutine follow_time

   !> The steady right side with the squeeze term of a step from the present film.
   pure subroutine pose_step(contact, level, right_side, time_step)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: right_side(0:)
      real(wp), intent(in) :: time_step

      call fluid_density(contact%fluid, level%state%pressure, level%density)
      level%inverse_time_step = 1.0_wp/time_step
      level%rhs_reynolds = right_side - contact%lambda/time_step*level%density*level%state%film
   end subroutine pose_step

end module pseudo_time

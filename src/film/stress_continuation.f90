!> The steady contact of an Eyring lubricant from that at a higher stress tau_0, which is lowered in
!> steps.
!>
!> A low stress leaves so thin a film that Newton's method does not find it from any start; where
!> the stress is higher, the film is nearly the Newtonian one, and from there it thins without a
!> jump.
module stress_continuation
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: count_work, line_hierarchy_t
   use newton_line, only: solve_newton
   use observer, only: is_stopped, observer_t
   use rheology, only: eased_fluid
   implicit none (type, external)
   private

   public :: eased_contact, follow_stress

   !> First ratio of two stresses; below the smallest the continuation gives up.
   real(wp), parameter :: first_ratio = 1.5_wp, smallest_ratio = 1.01_wp
   !> Accuracy and Newton steps of each solution.
   real(wp), parameter :: step_tolerance = 1.0e-3_wp
   integer, parameter :: max_newton_steps = 20

contains

   !> The same contact with an Eyring stress higher by `factor` >= 1.
   pure function eased_contact(contact, factor) result(eased)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      type(line_contact_t) :: eased

      eased = contact
      eased%fluid = eased_fluid(contact%fluid, factor)
   end function eased_contact

   !> Solves level k, from its present pressure, at the stress higher by `factor` and on to its own.
   !> The ratio of two stresses shrinks to its root after a failure. `is_sound` is false if that
   !> comes to no end, or `watcher` wants to stop.
   subroutine follow_stress(hierarchy, contact, k, factor, is_sound, watcher)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: k
      real(wp), intent(in) :: factor
      logical, intent(out) :: is_sound
      class(observer_t), intent(inout), optional :: watcher
      type(film_state_t) :: before
      real(wp) :: ratio, reached, wanted

      associate (level => hierarchy%levels(k))
         reached = huge(1.0_wp)
         ratio = first_ratio
         wanted = factor
         do
            before = level%state
            call solve_newton(hierarchy%newton, eased_contact(contact, wanted), level, &
               step_tolerance, max_newton_steps, watcher)
            call count_work(hierarchy, k, hierarchy%newton%steps)
            is_sound = hierarchy%newton%is_converged
            if (is_sound) then
               if (wanted <= 1.0_wp) return
               reached = wanted
            else
               if (is_stopped(watcher) .or. reached > factor) return
               level%state = before
               ratio = sqrt(ratio)
               if (ratio < smallest_ratio) return
            end if
            wanted = max(reached/ratio, 1.0_wp)
         end do
      end associate
   end subroutine follow_stress

end module stress_continuation

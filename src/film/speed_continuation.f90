!> The first solution of a contact whose asperities touch: from the speed at which the film clears
!> them, down to its own.
module speed_continuation
   use expected_film, only: clearing_film, flooded_film
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use listener, only: is_stopped, listener_t
   use newton_line, only: solve_newton
   use newton_work, only: newton_t
   implicit none (type, external)
   private

   public :: reach_speed

   !> Power of the speed with which films grow; the first film over its estimate.
   real(wp), parameter :: growth = 0.7_wp, first_share = 2.0_wp
   !> Most steps for a first solution and for a further one; steps of an easy one.
   integer, parameter :: first_steps = 60, next_steps = 25, easy_steps = 8
   !> Speeds to start from, at most; factor from speed to speed: first, largest, smallest.
   integer, parameter :: most_starts = 5
   real(wp), parameter :: first_ratio = 4.0_wp, largest_ratio = 100.0_wp, smallest_ratio = 1.05_wp
   !> Accuracy of the solutions.
   real(wp), parameter :: tolerance = 1.0e-3_wp

   abstract interface
      !> Sets the first guess of the level for a central film, of which it leaves a share.
      subroutine guess_interface(level, film, share)
         import :: line_level_t, wp
         implicit none (type, external)
         type(line_level_t), intent(inout) :: level
         real(wp), intent(in) :: film, share
      end subroutine guess_interface
   end interface

contains

   !> Solves a level, flooded while the speed is another, from a first `guess`.
   subroutine reach_speed(newton, level, contact, guess, is_solved, listener)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(inout) :: level
      type(line_contact_t), intent(in) :: contact
      procedure(guess_interface) :: guess
      logical, intent(out) :: is_solved
      class(listener_t), intent(inout), optional :: listener
      type(film_state_t) :: good
      real(wp) :: film, factor, good_factor, ratio
      integer :: starts

      film = flooded_film(contact)
      factor = max(1.0_wp, (clearing_film(contact)/film)**(1/growth))
      ratio = first_ratio
      good_factor = 0.0_wp
      starts = 0
      do
         if (.not. good_factor > 0.0_wp) then
            starts = starts + 1
            call guess(level, film*factor**growth, first_share)
         end if
         call set_speed(factor)
         call solve_newton(newton, level, tolerance, merge(next_steps, first_steps, good_factor &
            > 0.0_wp), listener)
         is_solved = newton%is_converged
         if (is_stopped(listener)) exit
         if (is_solved) then
            if (.not. factor > 1.0_wp) exit
            good = level%state
            good_factor = factor
            if (newton%steps < easy_steps) ratio = min(2*ratio, largest_ratio)
         else if (good_factor > 0.0_wp) then
            if (ratio < smallest_ratio) exit
            level%state = good
            ratio = sqrt(ratio)
         else
            if (starts == most_starts) exit
            factor = 2*factor
            cycle
         end if
         factor = max(1.0_wp, good_factor/ratio)
      end do
      call set_speed(1.0_wp)

   contains

      !> Sets the speed over that of the contact.
      subroutine set_speed(factor)
         real(wp), intent(in) :: factor

         level%lambda = factor*contact%lambda
         level%fluid = contact%fluid
         if (allocated(level%fluid%rheology)) level%fluid%rheology%ln_b_scale = &
            contact%fluid%rheology%ln_b_scale + log(factor)
         level%oil%supply = merge(huge(1.0_wp), contact%supply, factor > 1.0_wp)
      end subroutine set_speed

   end subroutine reach_speed

end module speed_continuation

!> The first solution of a contact whose asperities touch: from the speed at which the film clears
!> them, down to its own.
module speed_continuation
   use contact_moment, only: clearing_film, film_with_viscosity
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use listener, only: is_stopped, listener_t
   use newton_line, only: solve_newton
   use newton_work, only: newton_t
   use reynolds_line, only: mass_flux
   use lubricant, only: faster_fluid
   implicit none (type, external)
   private

   public :: reach_speed

   !> Power of the speed with which films grow, and a factor beside it; the first film over its
   !> estimate.
   real(wp), parameter :: growth = 0.7_wp, slack = 1.01_wp, first_share = 2.0_wp
   !> Most steps for a first solution and for a further one; steps of an easy one. Where less oil
   !> arrives, its front moves by about a node a step, by up to one of so many of the nodes.
   integer, parameter :: first_steps = 60, next_steps = 25, easy_steps = 8, front_share = 4
   !> Speeds to start from, at most; factor from speed to speed: first, and from supply to supply,
   !> largest, smallest.
   integer, parameter :: most_starts = 5
   real(wp), parameter :: first_ratio = 4.0_wp, supply_ratio = 1.25_wp, largest_ratio = 100.0_wp, &
      smallest_ratio = 1.02_wp
   !> Accuracy of the solutions.
   real(wp), parameter :: tolerance = 1.0e-3_wp

   abstract interface
      !> Sets the first guess of the level for a central film, of which it leaves a share.
      subroutine guess_interface(level, film, share)
         import :: line_level_t, wp
         type(line_level_t), intent(inout) :: level
         real(wp), intent(in) :: film, share
      end subroutine guess_interface
   end interface

contains

   !> Solves a level: from a first `guess` at the speed that clears the asperities down to its own,
   !> flooded, and then from what flows there down to what arrives.
   subroutine reach_speed(newton, level, contact, guess, is_solved, listener)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(inout) :: level
      type(line_contact_t), intent(in) :: contact
      procedure(guess_interface) :: guess
      logical, intent(out) :: is_solved
      class(listener_t), intent(inout), optional :: listener
      type(film_state_t) :: good
      real(wp) :: factor, film
      integer :: start

      factor = 1.0_wp
      do
         film = film_with_viscosity(contact, factor)
         if (film >= clearing_film(contact)) exit
         factor = factor*(clearing_film(contact)/film)**(1/growth)*slack
      end do
      level%oil%supply = huge(1.0_wp)
      do start = 1, most_starts
         call guess(level, film_with_viscosity(contact, factor), first_share)
         call solve_at(factor, .false., first_steps)
         if (is_solved .or. is_stopped(listener)) exit
         factor = 2*factor
      end do
      if (is_solved) call descend(factor, .false.)
      if (is_solved .and. contact%supply < huge(1.0_wp)) then
         associate (flux => mass_flux(level))
            call descend(maxval(flux)/(level%entrainment*contact%supply), .true.)
         end associate
      end if
      level%oil%supply = contact%supply

   contains

      !> Solves with so many times the speed, or with the supply where it `is_supply`.
      subroutine solve_at(factor, is_supply, steps)
         real(wp), intent(in) :: factor
         logical, intent(in) :: is_supply
         integer, intent(in) :: steps

         if (is_supply) then
            level%oil%supply = factor*contact%supply
         else
            level%lambda = factor*contact%lambda
            level%fluid = faster_fluid(contact%fluid, factor)
         end if
         call solve_newton(newton, level, tolerance, steps, listener)
         is_solved = newton%is_converged
      end subroutine solve_at

      !> Goes from the solution with a factor above 1 to that with 1.
      subroutine descend(first, is_supply)
         real(wp), intent(in) :: first
         logical, intent(in) :: is_supply
         real(wp) :: reached, ratio, next
         integer :: steps

         reached = first
         steps = merge(max(next_steps, level%n/front_share), next_steps, is_supply)
         ratio = merge(supply_ratio, first_ratio, is_supply)
         do while (reached > 1.0_wp)
            good = level%state
            next = max(1.0_wp, reached/ratio)
            call solve_at(next, is_supply, steps)
            if (is_stopped(listener)) exit
            if (is_solved) then
               reached = next
               if (newton%steps < easy_steps) ratio = min(2*ratio, largest_ratio)
            else
               level%state = good
               ratio = sqrt(ratio)
               if (ratio < smallest_ratio) exit
            end if
         end do
      end subroutine descend

   end subroutine reach_speed

end module speed_continuation

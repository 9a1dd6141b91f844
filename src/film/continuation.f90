!> Two continuations to a steady contact that Newton's method reaches from no start: a sequence of
!> nearby contacts that it solves, each the start of the next.
!>
!> By stress: an Eyring oil of low stress tau_0 leaves too thin a film. At a higher stress the film
!> is nearly Newtonian, and from there it thins without a jump.
!>
!> In pseudo-time: Newton's method alone can neither move a pressure spike narrower than the grid
!> nor leave a wild Eyring start. The squeeze term -lambda/dT (rho H - rho H_old) keeps every step
!> near the last one, and the flow carries the spike where it belongs. Source: Kelley & Keyes, SIAM
!> J. Numer. Anal. 35, 1998, 508-523.
module continuation
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_hierarchy, only: count_work, line_hierarchy_t
   use lubricant, only: fluid_density, fluid_t
   use newton_line, only: solve_newton
   use listener, only: is_stopped, listener_t
   use rheology, only: eased_fluid
   implicit none (type, external)
   private

   public :: follow_stress, follow_time

   !> Accuracy of each solution.
   real(wp), parameter :: step_tolerance = 1.0e-3_wp
   !> First ratio of two stresses, the ratio below which the continuation gives up, and most Newton
   !> steps of each solution.
   real(wp), parameter :: first_ratio = 1.5_wp, smallest_ratio = 1.01_wp
   integer, parameter :: max_stress_steps = 20
   !> First and smallest time step, in dX, and the last one, which makes the squeeze term negligible
   !> (oil passes the contact in a time of 2).
   real(wp), parameter :: first_step = 1.0_wp, smallest_step = 1.0e-3_wp, last_step = 1.0e3_wp
   !> Growth of the time step after a success (applied twice after few Newton steps), and shrinkage
   !> after a failure.
   real(wp), parameter :: growth = 1.5_wp, shrinkage = 0.25_wp
   integer, parameter :: few_newton_steps = 3
   !> Most time steps tried in all, and most Newton steps of each.
   integer, parameter :: max_steps = 120, max_time_steps = 15

contains

   !> Solves level k from its present pressure, first at `factor` times its stress, then at lower
   !> ones down to its value. The ratio of two stresses shrinks to its square root after a failure.
   !> `is_sound` is false if the first solution fails, the ratio becomes too small or `listener`
   !> asks to stop.
   subroutine follow_stress(hierarchy, k, factor, is_sound, listener)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k
      real(wp), intent(in) :: factor
      logical, intent(out) :: is_sound
      class(listener_t), intent(inout), optional :: listener
      type(fluid_t) :: fluid
      real(wp) :: ratio, reached, wanted

      fluid = hierarchy%levels(k)%fluid
      reached = huge(1.0_wp)
      ratio = first_ratio
      wanted = factor
      do
         hierarchy%levels(k)%fluid = eased_fluid(fluid, wanted)
         call try_newton(hierarchy, k, max_stress_steps, is_sound, listener)
         hierarchy%levels(k)%fluid = fluid
         if (is_sound) then
            if (wanted <= 1.0_wp) return
            reached = wanted
         else
            if (is_stopped(listener) .or. reached > factor) return
            ratio = sqrt(ratio)
            if (ratio < smallest_ratio) return
         end if
         wanted = max(reached/ratio, 1.0_wp)
      end do
   end subroutine follow_stress

   !> Follows the steady problem posed on level k from its present pressure in pseudo-time.
   !> `is_settled` is false if the steps become too small or too many, or `listener` asks to stop;
   !> the level then keeps the last state.
   subroutine follow_time(hierarchy, k, is_settled, listener)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k
      logical, intent(out) :: is_settled
      class(listener_t), intent(inout), optional :: listener
      real(wp), allocatable :: right_side(:)
      real(wp) :: time_step
      integer :: step
      logical :: is_solved

      associate (level => hierarchy%levels(k))
         allocate (right_side, source=level%rhs_reynolds)
         time_step = first_step*level%dx
         is_settled = .false.
         do step = 1, max_steps
            if (is_stopped(listener)) exit
            call fluid_density(level%fluid, level%state%pressure, level%oil%density)
            level%inverse_time_step = 1.0_wp/time_step
            level%rhs_reynolds = right_side - level%lambda/time_step*level%oil%density &
               *level%state%film
            call try_newton(hierarchy, k, max_time_steps, is_solved, listener)
            if (is_solved) then
               is_settled = time_step >= last_step
               time_step = time_step*merge(growth**2, growth, &
                  hierarchy%newton%steps <= few_newton_steps)
            else
               time_step = shrinkage*time_step
            end if
            if (is_settled .or. time_step < smallest_step*level%dx) exit
         end do
         level%inverse_time_step = 0.0_wp
         level%rhs_reynolds = right_side
      end associate
   end subroutine follow_time

   !> Solves level k once; without a solution the level keeps its state.
   subroutine try_newton(hierarchy, k, max_newton_steps, is_solved, listener)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k, max_newton_steps
      logical, intent(out) :: is_solved
      class(listener_t), intent(inout), optional :: listener
      type(film_state_t) :: before

      associate (level => hierarchy%levels(k))
         before = level%state
         call solve_newton(hierarchy%newton, level, step_tolerance, max_newton_steps, listener)
         call count_work(hierarchy, k, hierarchy%newton%steps)
         is_solved = hierarchy%newton%is_converged
         if (.not. is_solved) level%state = before
      end associate
   end subroutine try_newton

end module continuation

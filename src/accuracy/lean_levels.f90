!> A steady lubricated contact on one coarse grid, with all ingredients or without one, by both
!> space schemes: Newton's method from a solution that is near.
module lean_levels
   use, intrinsic :: ieee_arithmetic, only: ieee_get_halting_mode, ieee_set_halting_mode, ieee_usual
   use ablations, only: ingredient_t, is_of_oil, leave_out
   use film_state, only: film_state_t
   use film_temperature, only: solve_warm
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: coarsest_for_film, new_level_of, roughness_at
   use line_level, only: line_level_t, set_film, set_plain_problem
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use listener, only: listener_t
   use newton_work, only: newton_t
   use pressure_errors, only: doubt_spike
   use reynolds_line, only: evaluate_coefficients
   use semiseparable_jacobian, only: semiseparable_jacobian_t
   use state_output, only: level_summary
   use transfer, only: prolong_cubic
   implicit none (type, external)
   private

   public :: kappa, lean_level_t, pose, pressure_on, refined, solve_by, solve_without, upwind

   !> Tolerance on the last step of P, H0 and (ten times that) H; about its square remains.
   real(wp), parameter :: lean_tolerance = 1.0e-3_wp
   !> Most Newton steps.
   integer, parameter :: max_newton_steps = 18
   !> Fraction of an ingredient that is kept if it cannot be left out.
   real(wp), parameter, public :: largest_rest = 0.75_wp

   !> The space schemes of the two solutions on a grid.
   integer, parameter :: upwind = 1, kappa = 2

   !> A solution by one of them, if there is one.
   type :: solution_t
      type(line_summary_t) :: summary
      type(film_state_t) :: state
      logical :: is_known = .false.
   end type solution_t

   !> One grid and its solutions.
   type :: lean_level_t
      type(line_level_t) :: level
      type(newton_t) :: newton
      type(solution_t) :: by(2)
      logical :: is_solved = .false.
      !> The level is that of the contact with all ingredients but for its oil: it serves again.
      logical :: has_own_oil = .false.
      !> How much of an ingredient is kept; below 0: 0 or, where that has no solution, 3/4.
      real(wp) :: kept = -1.0_wp
      type(ingredient_t) :: ingredient = ingredient_t(0, '', '')
   end type lean_level_t

contains

   !> Solves a posed level by a scheme from the pressures and the smallest film of `start`, in at
   !> most `budget` nodes times Newton steps, of which what is left is returned.
   subroutine solve_by(self, scheme, start, budget, listener)
      type(lean_level_t), intent(inout) :: self
      integer, intent(in) :: scheme
      type(film_state_t), intent(in) :: start
      real(wp), intent(inout) :: budget
      class(listener_t), intent(inout) :: listener
      logical :: halts(size(ieee_usual))

      self%level%is_kappa = scheme == kappa
      associate (state => self%level%state)
         state%pressure = start%pressure
         if (allocated(self%level%rough) .and. allocated(start%separation)) then
            state%asperity_pressure = start%asperity_pressure
            call place_film(self%level, minval(start%separation))
         else   ! oil bears what asperities did
            if (allocated(start%separation)) state%pressure = start%pressure &
               + start%asperity_pressure
            call place_film(self%level, minval(start%film))
         end if
      end associate
      ! A trial may overflow, which is then no solution; checked builds must go on too.
      call ieee_get_halting_mode(ieee_usual, halts)
      call ieee_set_halting_mode(ieee_usual, .false.)
      call solve_warm(self%newton, self%level, lean_tolerance, &
         int(min(real(max_newton_steps, wp), budget/self%level%n)), listener, film_is_exact=.true.)
      call ieee_set_halting_mode(ieee_usual, halts)
      budget = budget - real(self%newton%steps, wp)*self%level%n
      self%is_solved = self%newton%is_converged
      associate (solution => self%by(scheme))
         solution%is_known = self%is_solved
         if (.not. self%is_solved) return
         call evaluate_coefficients(self%level)
         solution%summary = level_summary(self%level)
         solution%summary%crests%corner_top = -1.0_wp   ! contacts on one grid: by their nodes
         call doubt_spike(self%level%fluid, self%level%lambda, self%level%dx, solution%summary)
         solution%state = self%level%state
      end associate
   end subroutine solve_by

   !> Pressures of a solution on a grid of twice as many intervals, beside its films.
   pure function refined(solution) result(start)
      type(film_state_t), intent(in) :: solution
      type(film_state_t) :: start

      start%film = solution%film
      allocate (start%pressure(0:2*(size(solution%film) - 1)))
      call prolong_cubic(solution%pressure, start%pressure)
      if (.not. allocated(solution%separation)) return
      start%separation = solution%separation
      allocate (start%asperity_pressure, mold=start%pressure)
      call prolong_cubic(solution%asperity_pressure, start%asperity_pressure)
   end function refined

   !> The steady problem on one grid with the surfaces at time 0, in place of an earlier one.
   subroutine pose(self, contact, intervals, listener)
      type(lean_level_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: intervals
      class(listener_t), intent(inout) :: listener

      if (self%level%n > 0) self = lean_level_t(kept=self%kept, ingredient=self%ingredient)
      allocate (semiseparable_jacobian_t :: self%newton%linear)
      associate (level => self%level)
         call new_level_of(contact, intervals, level, listener%error)
         listener%is_stopping = listener%is_stopping .or. allocated(listener%error)
         if (listener%is_stopping) return
         call set_plain_problem(level, roughness_at(contact, level, 0.0_wp))
      end associate
   end subroutine pose

   !> Sets H0 so that the film, or the separation of rough surfaces, of the present pressure has the
   !> minimum `smallest`.
   subroutine place_film(level, smallest)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: smallest

      level%state%rigid_displacement = 0.0_wp
      call set_film(level)
      if (allocated(level%rough)) then
         level%state%rigid_displacement = smallest - minval(level%state%separation)
         call set_film(level)
      else
         level%state%rigid_displacement = smallest - minval(level%state%film)
         level%state%film = level%state%film + level%state%rigid_displacement
      end if
   end subroutine place_film

   !> The `contact` without the ingredient of `lean`, but for what is `kept` of it, as `solve_by`.
   subroutine solve_without(lean, contact, scheme, start, budget, listener)
      type(lean_level_t), intent(inout) :: lean
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: scheme
      type(film_state_t), intent(in) :: start
      real(wp), intent(inout) :: budget
      class(listener_t), intent(inout) :: listener
      type(line_contact_t) :: other
      integer :: attempt, attempts, n

      n = size(start%pressure) - 1
      lean%is_solved = .false.
      attempts = merge(2, 1, lean%kept < 0.0_wp .and. lean%ingredient%can_reduce)
      lean%kept = max(lean%kept, 0.0_wp)
      do attempt = 1, attempts
         if (attempt == 2) lean%kept = largest_rest
         other = contact
         call leave_out(other, lean%ingredient, lean%kept)
         if (attempt == 1 .and. n < coarsest_for_film(other)) cycle
         if (.not. (lean%has_own_oil .and. is_of_oil(lean%ingredient))) then
            call pose(lean, other, n, listener)
            if (listener%is_stopping) return
            lean%has_own_oil = is_of_oil(lean%ingredient) .and. .not. (allocated(lean%level%heat) &
               .or. allocated(lean%level%oil%saturation))
         end if
         lean%level%fluid = other%fluid
         call solve_by(lean, scheme, start, budget, listener)
         if (lean%is_solved) exit
      end do
   end subroutine solve_without

   !> Pressures and films of a state at every (n/intervals)-th node; `intervals` divides n.
   pure function pressure_on(state, intervals) result(coarse)
      type(line_state_t), intent(in) :: state
      integer, intent(in) :: intervals
      type(film_state_t) :: coarse
      integer :: stride

      stride = (size(state%pressure) - 1)/intervals
      coarse%pressure = state%pressure(::stride)
      coarse%film = state%film_thickness(::stride)
      if (.not. allocated(state%separation)) return
      coarse%asperity_pressure = state%asperity_pressure(::stride)
      coarse%separation = state%separation(::stride)
   end function pressure_on

end module lean_levels

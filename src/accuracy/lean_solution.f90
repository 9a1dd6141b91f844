!> A steady contact on one coarse grid by Newton's method, started from the pressure of a contact
!> that differs from it by one ingredient.
module lean_solution
   use, intrinsic :: ieee_exceptions, only: ieee_get_halting_mode, ieee_set_halting_mode, &
      ieee_usual
   use ablations, only: contact_without, ingredient_t
   use errors, only: error_t
   use film_equation, only: set_film
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use level_summaries, only: level_summary
   use line_hierarchy, only: coarsest_for_film, roughness_at
   use line_level, only: line_level_t, new_level, set_plain_problem
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use newton_line, only: solve_newton
   use newton_work, only: newton_t
   use listener, only: listener_t
   use pressure_errors, only: doubt_spike
   use reynolds_line, only: evaluate_coefficients
   use semiseparable_jacobian, only: semiseparable_jacobian_t
   implicit none (type, external)
   private

   public :: add_kappa, lean_level_t, place_film, pose, pressure_on, solve_from, solve_level_of, &
      solve_without

   !> Tolerance on the last step of P, H0 and (ten times that) H; the remaining error is about its
   !> square.
   real(wp), parameter :: lean_tolerance = 1.0e-3_wp
   !> Most Newton steps.
   integer, parameter :: max_newton_steps = 18
   !> Fraction of an ingredient that is kept if it cannot be left out.
   real(wp), parameter :: largest_rest = 0.75_wp

   !> One grid, its solution and its cost.
   type :: lean_level_t
      type(line_contact_t) :: contact
      type(line_level_t) :: level
      type(newton_t) :: newton
      !> By upwind2 and, if `has_kappa`, by the kappa scheme.
      type(line_summary_t) :: summary, kappa
      logical :: is_solved = .false., has_kappa = .false.
      !> Nodes times Newton steps so far.
      real(wp) :: work = 0.0_wp
      !> How much of an ingredient is kept; below 0: 0 or, where that has no solution, 3/4.
      real(wp) :: kept = -1.0_wp
   end type lean_level_t

contains

   !> Poses `contact`, on a complete domain, on `intervals` with its surfaces at time 0, and solves
   !> it from `start` (0:intervals) by upwind2, in at most `work` nodes times Newton steps.
   subroutine solve_from(self, contact, intervals, start, work, listener, error)
      type(lean_level_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: intervals
      type(film_state_t), intent(in) :: start
      real(wp), intent(in) :: work
      class(listener_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error

      self%contact = contact
      call pose(self, contact, intervals, 0.0_wp, error)
      if (allocated(error)) return
      self%level%state%pressure = start%pressure
      call place_film(self%level, minval(start%film))
      call solve_level_of(self, work, listener)
      if (self%is_solved) self%summary = summary_with_doubt(self%level)
   end subroutine solve_from

   !> Adds the quantities by the kappa scheme, which errs less, from a solution by upwind2, if there
   !> are any; the state remains.
   subroutine add_kappa(self, work, listener)
      type(lean_level_t), intent(inout) :: self
      real(wp), intent(in) :: work
      class(listener_t), intent(inout) :: listener
      type(film_state_t) :: thesis

      thesis = self%level%state
      self%level%is_kappa = .true.
      call solve_level_of(self, work, listener)
      self%has_kappa = self%is_solved
      if (self%has_kappa) self%kappa = summary_with_doubt(self%level)
      self%is_solved = .true.
      self%level%is_kappa = .false.
      self%level%state = thesis
   end subroutine add_kappa

   !> The steady problem on one grid with the surfaces at `time`.
   subroutine pose(self, contact, intervals, time, error)
      type(lean_level_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: intervals
      real(wp), intent(in) :: time
      type(error_t), allocatable, intent(out) :: error

      allocate (semiseparable_jacobian_t :: self%newton%linear)
      associate (level => self%level)
         call new_level(level, contact%lambda, contact%fluid, [contact%domain%x_inlet, &
            contact%domain%x_outlet], intervals, error, contact%elasticity)
         if (allocated(error)) return
         call set_plain_problem(level, roughness_at(contact, level, time))
         level%has_tail = contact%domain%inlet == 'tail'
         level%slide_to_roll = contact%slide_to_roll
      end associate
   end subroutine pose

   !> Sets H0 so that the film of the present pressure has the minimum `smallest`.
   subroutine place_film(level, smallest)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: smallest

      level%state%rigid_displacement = 0.0_wp
      call set_film(level)
      level%state%rigid_displacement = smallest - minval(level%state%film)
      level%state%film = level%state%film + level%state%rigid_displacement
   end subroutine place_film

   !> Solves the posed problem from its present state, in at most `work` nodes times Newton steps.
   subroutine solve_level_of(self, work, listener)
      type(lean_level_t), intent(inout) :: self
      real(wp), intent(in) :: work
      class(listener_t), intent(inout) :: listener
      logical :: halts(size(ieee_usual))

      ! A trial may overflow, which is then no solution; checked builds must go on too.
      call ieee_get_halting_mode(ieee_usual, halts)
      call ieee_set_halting_mode(ieee_usual, .false.)
      call solve_newton(self%newton, self%level, lean_tolerance, &
         int(min(real(max_newton_steps, wp), work/self%level%n)), listener, film_is_exact=.true.)
      call ieee_set_halting_mode(ieee_usual, halts)
      self%work = self%work + real(self%newton%steps, wp)*self%level%n
      self%is_solved = self%newton%is_converged
      if (self%is_solved) call evaluate_coefficients(self%level)
   end subroutine solve_level_of

   !> Quantities of a solution; the error of the largest pressure is what a spike may add to it.
   pure function summary_with_doubt(level) result(summary)
      type(line_level_t), intent(in) :: level
      type(line_summary_t) :: summary

      summary = level_summary(level)
      summary%crests%corner_top = -1.0_wp   ! contacts on one grid: by their nodes
      call doubt_spike(level%fluid, level%lambda, level%dx, summary)
   end function summary_with_doubt

   !> The contact without an ingredient, but for what is `kept` of it, from the solution of the
   !> `full` one on the same grid. At most `work` nodes times Newton steps.
   subroutine solve_without(lean, ingredient, full, work, listener, error)
      type(lean_level_t), intent(inout) :: lean
      type(ingredient_t), intent(in) :: ingredient
      type(lean_level_t), intent(in) :: full
      real(wp), intent(in) :: work
      class(listener_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: other
      logical :: is_open

      lean%work = 0.0_wp
      call start_anew(lean)
      is_open = lean%kept < 0.0_wp
      if (is_open) lean%kept = 0.0_wp
      other = contact_without(full%contact, ingredient, lean%kept)
      if (full%level%n >= coarsest_for_film(other)) call solve_from(lean, other, full%level%n, &
         full%level%state, work, listener, error)
      if (allocated(error) .or. lean%is_solved) return
      if (.not. (is_open .and. ingredient%can_reduce)) return
      lean%kept = largest_rest
      call start_anew(lean)
      call solve_from(lean, contact_without(full%contact, ingredient, lean%kept), full%level%n, &
         full%level%state, work - lean%work, listener, error)   ! error: the caller looks
   end subroutine solve_without

   !> Resets the solution but keeps the contact and the cost so far.
   subroutine start_anew(lean)
      type(lean_level_t), intent(inout) :: lean
      type(lean_level_t), allocatable :: fresh

      allocate (fresh)
      fresh%work = lean%work
      fresh%kept = lean%kept
      lean = fresh
   end subroutine start_anew

   !> Pressure and film of a state at every (n/intervals)-th node; `intervals` divides n.
   pure function pressure_on(state, intervals) result(coarse)
      type(line_state_t), intent(in) :: state
      integer, intent(in) :: intervals
      type(film_state_t) :: coarse
      integer :: stride

      stride = (size(state%pressure) - 1)/intervals
      coarse%pressure = state%pressure(::stride)
      coarse%film = state%film_thickness(::stride)
   end function pressure_on

end module lean_solution

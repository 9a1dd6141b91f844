!> Changes of a steady lubricated contact without one of its ingredients, on the same coarse grid as
!> with it; the error of a change comes from a grid twice as coarse.
!>
!> The cost is bounded beforehand in nodes times Newton steps, so that a repeated run measures the
!> same. What does not fit is not known. Newton's method on one grid starts from the pressure of the
!> contact with all ingredients.
module ablation_runs
   use, intrinsic :: ieee_arithmetic, only: ieee_get_halting_mode, ieee_is_finite, &
      ieee_set_halting_mode, ieee_usual
   use ablations, only: contact_without, ingredient_t
   use adequacy, only: adequacy_t, influence_t, is_plainly_needed, new_influence, no_solution
   use errors, only: error_t
   use film_temperature, only: solve_warm
   use kinds, only: exceeds, not_known, quotient, wp
   use line_contact, only: finest_wave, line_contact_t
   use line_hierarchy, only: coarsest_for_film, new_level_of, roughness_at
   use line_level, only: line_level_t, set_film, set_plain_problem
   use line_state, only: line_state_t
   use film_state, only: film_state_t
   use line_summary, only: line_summary_t, value_between
   use listener, only: listener_t
   use newton_work, only: newton_t
   use pressure_errors, only: doubt_spike
   use quantities, only: p_max, quantity_count, quantity_rows, sliding_rows
   use reynolds_line, only: evaluate_coefficients
   use semiseparable_jacobian, only: semiseparable_jacobian_t
   use state_output, only: level_summary
   implicit none (type, external)
   private

   public :: change_between, doubt_between, largest_change, lean_level_t, measure_at_rest, pose, &
      set_change, set_change_by_one

   !> Error of a change: this many times its difference from the coarser grid, a share of the
   !> change, a share of the largest change of a film, and at least the error of the iteration.
   real(wp), parameter, public :: widths(4) = [1.5_wp, 0.05_wp, 0.0_wp, 2.0e-5_wp]
   !> If only one grid has the lean film, the error of films is this share of their change; that can
   !> only show what is needed.
   real(wp), parameter :: width_on_one = 0.5_wp
   !> If spikes may add more than this to both pressures, their change is not known.
   real(wp), parameter :: largest_doubt = 0.01_wp
   !> If only the lean contact has a spike, the change of its friction is at least this share of the
   !> smaller one of both grids.
   real(wp), parameter :: least_share = 0.5_wp
   !> Typical Newton steps from a neighbouring solution, with the cost of setting up its grid.
   real(wp), parameter :: usual_steps = 11.0_wp
   !> Most Newton steps of one ingredient on a grid.
   real(wp), parameter :: most_steps = 50.0_wp
   !> Intervals of the finer of the two grids: at most the first where the budget allows, at least
   !> the second.
   integer, parameter :: most_intervals = 256, least_intervals = 64
   !> Fewest nodes of the coarser grid in the finest wave.
   real(wp), parameter, public :: least_nodes = 4.0_wp

   !> Tolerance on the last step of P, H0 and (ten times that) H; the remaining error is about its
   !> square.
   real(wp), parameter :: lean_tolerance = 1.0e-3_wp
   !> Most Newton steps.
   integer, parameter :: max_newton_steps = 18
   !> Fraction of an ingredient that is kept if it cannot be left out.
   real(wp), parameter, public :: largest_rest = 0.75_wp

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

   !> Measures the ingredients of a steady `contact`, whose domain is complete, from the pressure of
   !> `state` on n intervals: a row each. `budget`: nodes times Newton steps that may be spent, of
   !> which what is left is returned.
   subroutine measure_at_rest(contact, state, list, budget, adequacy, listener, error)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(ingredient_t), intent(in) :: list(:)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error
      type(lean_level_t) :: full(2)
      integer :: g, i

      adequacy%rows = [(new_influence(trim(list(i)%name), trim(list(i)%text)), i=1, size(list))]
      adequacy%at_rest = grids_for(contact, size(state%x) - 1, size(list), budget)
      associate (grids => adequacy%at_rest)
         if (any(grids == 0)) return
         do g = 1, 2
            call solve_from(full(g), contact, grids(g), pressure_on(state, grids(g)), &
               budget, listener, error)
            if (allocated(error) .or. listener%is_stopping) return
            if (full(g)%is_solved) call add_kappa(full(g), budget - full(g)%work, listener)
            budget = budget - full(g)%work
         end do
         if (.not. all(full%is_solved)) return
         do i = 1, size(list)
            if (budget < usual_steps*sum(grids)) cycle
            call measure_one(list(i), full, budget, adequacy, i, listener, error)
            if (allocated(error) .or. listener%is_stopping) return
         end do
      end associate
   end subroutine measure_at_rest

   !> One ingredient, row `i`, on the finer grid first, which tells how much of it can be left out:
   !> by the scheme of the thesis and, unless it is plainly needed already and that ends it, by
   !> kappa.
   subroutine measure_one(ingredient, full, budget, adequacy, i, listener, error)
      type(ingredient_t), intent(in) :: ingredient
      type(lean_level_t), intent(in) :: full(2)
      real(wp), intent(inout) :: budget
      type(adequacy_t), intent(inout) :: adequacy
      integer, intent(in) :: i
      class(listener_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error
      type(lean_level_t) :: lean(2)
      type(influence_t) :: told
      real(wp), dimension(quantity_count, 2) :: changes, doubt
      integer :: g

      associate (row => adequacy%rows(i))
         do g = 1, 2
            if (g == 2) lean(2)%kept = lean(1)%kept
            call solve_without(lean(g), ingredient, full(g), min(budget, &
               most_steps*full(g)%level%n), listener, error)
            if (allocated(error) .or. listener%is_stopping) return
            budget = budget - lean(g)%work
            if (.not. lean(g)%is_solved) row%unknown = no_solution
            if (.not. lean(1)%is_solved) return
            changes(:, g) = change_between(lean(g)%summary, full(g)%summary)
         end do
         doubt = doubt_between(lean(1)%summary, full(1)%summary)
         if (.not. lean(2)%is_solved) then
            told = row
            told%left_out = 1 - lean(2)%kept
            call set_change_by_one(changes(:, 1), doubt, told)
            if (is_plainly_needed(told, adequacy%accuracy)) row = told
            return
         end if
         row%left_out = 1 - lean(2)%kept
         call set_change(row, changes, doubt, widths)
         if (adequacy%ends_early .and. is_plainly_needed(row, adequacy%accuracy)) return
         if (.not. all(full%has_kappa)) return
         do g = 1, 2
            budget = budget + lean(g)%work
            call add_kappa(lean(g), min(budget, most_steps*full(g)%level%n) - lean(g)%work, &
               listener)
            budget = budget - lean(g)%work
            if (.not. lean(g)%has_kappa) return
            changes(:, g) = change_between(lean(g)%kappa, full(g)%kappa)
         end do
         doubt = doubt_between(lean(1)%kappa, full(1)%kappa)
         call set_change(row, changes, doubt, widths)
      end associate
   end subroutine measure_one

   !> Sets the changes of a row from those of films on one grid alone.
   pure subroutine set_change_by_one(changes, doubt, row)
      real(wp), intent(in) :: changes(:), doubt(:, :)
      type(influence_t), intent(inout) :: row
      character(len(row%unknown)) :: unknown
      real(wp) :: both(quantity_count, 2)

      both = not_known()
      where (quantity_rows%field == 'film_thickness')
         both(:, 1) = changes
         both(:, 2) = (1 - width_on_one/widths(1))*changes
      end where
      unknown = row%unknown
      call set_change(row, both, doubt, widths)
      row%unknown = unknown
   end subroutine set_change_by_one

   !> Sets the change of a row and its error from the changes on the finer (1) and the coarser grid;
   !> `factors` are `widths`, and `doubt` (lean and full contact) is added. Uncertain changes are
   !> not known, but a spike only adds to friction: without it there is less.
   pure subroutine set_change(row, changes, doubt, factors)
      type(influence_t), intent(inout) :: row
      real(wp), intent(in) :: changes(:, :), doubt(:, :), factors(4)
      logical :: is_sure(2)
      real(wp) :: error
      integer :: i

      row%change = not_known()
      row%error = not_known()
      row%least = 0.0_wp
      row%unknown = 'a pressure spike may hold any part of it, or it is 0'
      do i = 1, quantity_count
         if (.not. all(ieee_is_finite(changes(i, :)))) cycle
         is_sure = ieee_is_finite(doubt(i, :))
         if (i == p_max) is_sure = is_sure .and. .not. exceeds(sum(doubt(i, :)), largest_doubt)
         error = factors(1)*abs(changes(i, 1) - changes(i, 2)) + factors(2)*abs(changes(i, 1)) &
            + factors(3)*largest_change(changes(:, 1)) + factors(4)
         if (all(is_sure)) then
            row%change(i) = changes(i, 1)
            row%error(i) = error + abs(1 + changes(i, 1))*sum(doubt(i, :))
         else if (any(sliding_rows == i)) then
            if (is_sure(1) .and. changes(i, 1) < 0.0_wp) then   ! from that to nothing
               row%change(i) = changes(i, 1)
               row%error(i) = max(error, 1 + changes(i, 1))
            else if (is_sure(2)) then
               row%least(i) = max(0.0_wp, least_share*minval(changes(i, :)))
            end if
         end if
      end do
   end subroutine set_change

   !> The largest known change of a film.
   pure real(wp) function largest_change(change) result(largest)
      real(wp), intent(in) :: change(:)

      largest = max(0.0_wp, maxval(abs(pack(change, ieee_is_finite(change) &
         .and. quantity_rows%field == 'film_thickness'))))
   end function largest_change

   !> Relative amounts that spikes may add to the largest pressure and the sliding friction of the
   !> lean (:, 1) and the full contact; 0 for other quantities, NaN: not known.
   pure function doubt_between(lean, full) result(doubt)
      type(line_summary_t), intent(in) :: lean, full
      real(wp) :: doubt(quantity_count, 2)
      integer, parameter :: rows(*) = [p_max, sliding_rows]

      doubt = 0.0_wp
      doubt(rows, 1) = quotient(lean%of(rows)%error_grid, abs(lean%of(rows)%value))
      doubt(rows, 2) = quotient(full%of(rows)%error_grid, abs(full%of(rows)%value))
   end function doubt_between

   !> Relative change of all quantities from the `full` contact to the lean one; NaN without a value
   !> to compare with.
   pure function change_between(lean, full) result(change)
      type(line_summary_t), intent(in) :: lean, full
      real(wp) :: change(quantity_count)
      real(wp) :: value
      integer :: i

      change = not_known()
      do i = 1, quantity_count
         value = value_between(full, i)
         if (.not. ieee_is_finite(value)) cycle
         if (abs(value) > tiny(1.0_wp)) change(i) = value_between(lean, i)/value - 1
      end do
   end function change_between

   !> The finer and the coarser of two grids of n/2^k intervals on which this many solutions fit
   !> into the budget; 0: none that carry the film and see every wave.
   pure function grids_for(contact, n, solutions, budget) result(grids)
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: n, solutions
      real(wp), intent(in) :: budget
      integer :: grids(2), finer, least

      grids = 0
      least = max(least_intervals, 2*coarsest_for_film(contact), intervals_in_waves(contact))
      finer = n
      do while (modulo(finer, 2) == 0 .and. finer/2 >= least .and. (finer > most_intervals &
         .or. 1.5_wp*finer*usual_steps*(solutions + 1) > budget))
         finer = finer/2
      end do
      if (modulo(finer, 2) == 0 .and. 1.5_wp*finer*usual_steps*2 <= budget) grids = [finer, finer/2]
   end function grids_for

   !> Intervals from which half of them resolve every wave of the surfaces; 1 if they are smooth.
   pure integer function intervals_in_waves(contact) result(intervals)
      type(line_contact_t), intent(in) :: contact

      intervals = ceiling(min(2*least_nodes*(contact%domain%x_outlet - contact%domain%x_inlet) &
         /finest_wave(contact), 1.0e9_wp))
   end function intervals_in_waves

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
      call pose(self, contact, intervals, error)
      if (allocated(error)) return
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

   !> The steady problem on one grid with the surfaces at time 0.
   subroutine pose(self, contact, intervals, error)
      type(lean_level_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: intervals
      type(error_t), allocatable, intent(out) :: error

      allocate (semiseparable_jacobian_t :: self%newton%linear)
      associate (level => self%level)
         call new_level_of(contact, intervals, level, error)
         if (allocated(error)) return
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

   !> Solves the posed problem from its present state, in at most `work` nodes times Newton steps.
   subroutine solve_level_of(self, work, listener)
      type(lean_level_t), intent(inout) :: self
      real(wp), intent(in) :: work
      class(listener_t), intent(inout) :: listener
      logical :: halts(size(ieee_usual))

      ! A trial may overflow, which is then no solution; checked builds must go on too.
      call ieee_get_halting_mode(ieee_usual, halts)
      call ieee_set_halting_mode(ieee_usual, .false.)
      call solve_warm(self%newton, self%level, lean_tolerance, &
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

end module ablation_runs

!> Changes of a steady lubricated contact without one of its ingredients, on the same coarse grid as
!> with it; the error of a change comes from a grid twice as coarse.
!>
!> The cost is bounded beforehand in nodes times Newton steps, so that a repeated run measures the
!> same. What does not fit is not known. Newton's method on one grid starts from the pressure of the
!> contact with all ingredients, or from that without the ingredient on the coarser grid.
module ablation_runs
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use adequacy, only: adequacy_t, influence_t, is_plainly_needed, no_solution
   use kinds, only: exceeds, not_known, quotient, wp
   use line_contact, only: intervals_for_waves, line_contact_t
   use lean_levels, only: kappa, lean_level_t, pose, pressure_on, refined, solve_by, &
      solve_without, upwind
   use line_hierarchy, only: coarsest_for_film
   use line_state, only: line_state_t
   use film_state, only: film_state_t
   use line_summary, only: line_summary_t, value_between
   use listener, only: listener_t
   use quantities, only: p_max, quantity_count, quantity_rows, sliding_rows
   implicit none (type, external)
   private

   public :: measure_at_rest, set_change, set_step_error

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
   !> Intervals of the finer of the two grids: at most the first where the budget allows, at least
   !> the second.
   integer, parameter :: most_intervals = 256, least_intervals = 64

   !> The error by the time step: this many times the change from twice the step on n/4, or from the
   !> first-order to the second-order scheme, plus a share of the largest change of a film, since a
   !> single change may vanish by chance.
   real(wp), parameter, public :: by_larger_step(2) = [0.2_wp, 0.2_wp], &
      by_scheme(2) = [2.0_wp, 0.3_wp]

contains

   !> Measures the open rows, ingredients of a steady `contact` whose domain is complete, from the
   !> pressure of `state` on n intervals, within the budget.
   subroutine measure_at_rest(contact, state, adequacy, listener)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout) :: listener
      type(lean_level_t) :: levels(2, 2)   ! with all ingredients, without one
      integer :: g, i

      adequacy%at_rest = grids_for(contact, size(state%x) - 1, count(adequacy%rows%is_open), &
         adequacy%budget)
      associate (grids => adequacy%at_rest, full => levels(:, 1))
         if (any(grids == 0)) return
         do g = 1, 2
            call pose(full(g), contact, grids(g), listener)
            if (listener%is_stopping) return
            call solve_by(full(g), kappa, pressure_on(state, grids(g)), adequacy%budget, listener)
            if (listener%is_stopping) return
            full(g)%by(upwind)%state = pressure_on(state, grids(g))   ! where it starts from
         end do
         do i = 1, size(adequacy%rows)
            if (.not. adequacy%rows(i)%is_open .or. adequacy%budget < usual_steps*sum(grids)) cycle
            levels(:, 2)%ingredient = adequacy%rows(i)%ingredient_t
            call measure_one(contact, levels, adequacy, i, listener)
            if (listener%is_stopping) return
         end do
      end associate
   end subroutine measure_at_rest

   !> One ingredient, row `i`: by kappa, which errs less, on the coarser grid first, from whose
   !> solution the finer one takes few steps; if that finds none, or what is plainly needed ends
   !> early, by both schemes.
   subroutine measure_one(contact, levels, adequacy, i, listener)
      type(line_contact_t), intent(in) :: contact
      type(lean_level_t), intent(inout) :: levels(2, 2)
      type(adequacy_t), intent(inout) :: adequacy
      integer, intent(in) :: i
      class(listener_t), intent(inout) :: listener
      type(film_state_t) :: start
      logical :: is_known
      integer :: g

      associate (full => levels(:, 1), lean => levels(:, 2), budget => adequacy%budget)
         is_known = all(full%by(kappa)%is_known) .and. .not. adequacy%ends_early
         do g = 2, 1, -1
            if (.not. is_known) exit
            lean(g)%kept = 0.0_wp
            start = full(g)%by(kappa)%state
            if (g == 1) start = refined(lean(2)%by(kappa)%state)
            call solve_without(lean(g), contact, kappa, start, budget, listener)
            if (listener%is_stopping) return
            is_known = lean(g)%is_solved
         end do
         if (is_known) then
            call set_row(levels, kappa, adequacy%rows(i))
            return
         end if
         do g = 1, 2
            start = full(g)%by(upwind)%state
            if (.not. full(g)%by(upwind)%is_known) call solve_by(full(g), upwind, start, budget, &
               listener)
            if (all([full(g)%by(upwind)%is_known, .not. full(g)%by(kappa)%is_known])) call &
               solve_by(full(g), kappa, full(g)%by(upwind)%state, budget, listener)
         end do
         if (all(full%by(upwind)%is_known)) call measure_by_both(contact, levels, adequacy, i, &
            listener)
      end associate
   end subroutine measure_one

   !> The same by the scheme of the thesis on the finer grid first, which tells how much of the
   !> ingredient can be left out, and then, unless it is plainly needed and that ends it, by kappa.
   subroutine measure_by_both(contact, levels, adequacy, i, listener)
      type(line_contact_t), intent(in) :: contact
      type(lean_level_t), intent(inout) :: levels(2, 2)
      type(adequacy_t), intent(inout) :: adequacy
      integer, intent(in) :: i
      class(listener_t), intent(inout) :: listener
      type(influence_t) :: told
      integer :: g

      associate (full => levels(:, 1), lean => levels(:, 2), budget => adequacy%budget, &
         row => adequacy%rows(i))
         lean(1)%kept = -1.0_wp
         do g = 1, 2
            if (g == 2) lean(2)%kept = lean(1)%kept
            call solve_without(lean(g), contact, upwind, full(g)%by(upwind)%state, budget, listener)
            if (listener%is_stopping) return
            if (.not. lean(g)%is_solved) row%unknown = no_solution
            if (.not. lean(1)%is_solved) return
         end do
         if (.not. lean(2)%is_solved) then
            told = row
            told%left_out = 1 - lean(2)%kept
            call set_change(told, levels(:1, 2)%by(upwind)%summary, &
               levels(:1, 1)%by(upwind)%summary, widths)
            if (is_plainly_needed(told, adequacy%accuracy)) row = told
            return
         end if
         call set_row(levels, upwind, row)
         if (adequacy%ends_early .and. is_plainly_needed(row, adequacy%accuracy)) return
         if (.not. all(full%by(kappa)%is_known)) return
         do g = 1, 2
            call solve_by(lean(g), kappa, lean(g)%by(upwind)%state, budget, listener)
            if (.not. lean(g)%is_solved) return
         end do
         call set_row(levels, kappa, row)
      end associate
   end subroutine measure_by_both

   !> Sets a row from the solutions by a scheme.
   pure subroutine set_row(levels, scheme, row)
      type(lean_level_t), intent(in) :: levels(2, 2)
      integer, intent(in) :: scheme
      type(influence_t), intent(inout) :: row

      row%left_out = 1 - levels(2, 2)%kept
      call set_change(row, levels(:, 2)%by(scheme)%summary, levels(:, 1)%by(scheme)%summary, widths)
   end subroutine set_row

   !> Sets the change of a row from the `full` to the `lean` contact, and its error, from both on
   !> the finer (1) and the coarser grid, or on one alone, which tells of films only; `factors` are
   !> `widths`. What spikes may add to either is added (unless `counts_spikes` is false): then
   !> uncertain changes are not known, but a spike only adds to friction: without it there is less.
   pure subroutine set_change(row, lean, full, factors, counts_spikes)
      type(influence_t), intent(inout) :: row
      type(line_summary_t), intent(in) :: lean(:), full(:)
      real(wp), intent(in) :: factors(4)
      logical, intent(in), optional :: counts_spikes
      integer, parameter :: spiked(*) = [p_max, sliding_rows]
      logical :: is_sure(2)
      real(wp) :: changes(quantity_count, 2), doubt(quantity_count, 2), error
      integer :: i

      changes(:, 1) = change_between(lean(1), full(1))
      if (size(lean) > 1) then
         changes(:, 2) = change_between(lean(2), full(2))
         row%unknown = 'a pressure spike may hold any part of it, or it is 0'
      else
         where (quantity_rows%field /= 'film_thickness') changes(:, 1) = not_known()
         changes(:, 2) = (1 - width_on_one/widths(1))*changes(:, 1)
      end if
      doubt = 0.0_wp   ! relative amounts of the lean and the full contact; NaN: not known
      doubt(spiked, 1) = quotient(lean(1)%of(spiked)%error_grid, abs(lean(1)%of(spiked)%value))
      doubt(spiked, 2) = quotient(full(1)%of(spiked)%error_grid, abs(full(1)%of(spiked)%value))
      if (present(counts_spikes)) doubt = merge(doubt, 0.0_wp, counts_spikes)
      row%change = not_known()
      row%error = not_known()
      row%least = 0.0_wp
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

   !> Sets the `row` of the time step from the change from an `other` to a `better` run, with these
   !> `factors`.
   pure subroutine set_step_error(better, other, factors, row)
      type(line_summary_t), intent(in) :: better, other
      real(wp), intent(in) :: factors(2)
      type(influence_t), intent(inout) :: row

      row%change = change_between(better, other)
      row%change = factors(1)*abs(row%change) + factors(2)*largest_change(row%change)
      row%error = 0.0_wp*row%change
   end subroutine set_step_error

   !> The largest known change of a film.
   pure real(wp) function largest_change(change) result(largest)
      real(wp), intent(in) :: change(:)

      largest = max(0.0_wp, maxval(abs(pack(change, ieee_is_finite(change) &
         .and. quantity_rows%field == 'film_thickness'))))
   end function largest_change

   !> Relative change of all quantities from the `full` contact to the lean one; NaN without a value
   !> to compare with.
   pure function change_between(lean, full) result(change)
      type(line_summary_t), intent(in) :: lean, full
      real(wp) :: change(quantity_count)
      integer :: i

      change = [(quotient(value_between(lean, i), value_between(full, i)) - 1, i=1, quantity_count)]
   end function change_between

   !> The finer and the coarser of two grids of n/2^k intervals on which this many solutions fit
   !> into the budget; 0: none that carry the film and see every wave.
   pure function grids_for(contact, n, solutions, budget) result(grids)
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: n, solutions
      real(wp), intent(in) :: budget
      integer :: grids(2), finer, least

      grids = 0
      ! the coarser one has four nodes in every wave
      least = max(least_intervals, 2*coarsest_for_film(contact), (intervals_for_waves(contact) &
         + 1)/2)
      finer = n
      do while (modulo(finer, 2) == 0 .and. finer/2 >= least .and. (finer > most_intervals &
         .or. 1.5_wp*finer*usual_steps*(solutions + 1) > budget))
         finer = finer/2
      end do
      if (modulo(finer, 2) == 0 .and. 1.5_wp*finer*usual_steps*2 <= budget) grids = [finer, finer/2]
   end function grids_for

end module ablation_runs

!> How far off the quantities of a passage may be because of its time step alone.
!>
!> A run for a target has a coarse run with a larger step already; one of first order in time has
!> the scheme of second order beside it. Else one more passage on n/8 intervals, with twice the step
!> of that beside which ingredients are left out, tells what a larger step does there.
module time_step_error
   use ablation_runs, only: change_between, largest_change
   use ablations, only: elasticity, ingredient_t, squeeze
   use adequacy, only: influence_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use missing_value, only: quotient
   use own_passages, only: cost_on, is_told_by_own, own_runs_t
   use passage_pairs, only: scene_t
   use quantities, only: quantity_count
   use split_errors, only: time_errors
   implicit none (type, external)
   private

   public :: take_larger_step, tell_time_step, time_step_cost

   !> The error because of the time step: this many times the change from twice the step on n/8, or
   !> from the scheme of first order to that of second, and a share of the largest change of a film,
   !> for changes vanish by chance.
   real(wp), parameter :: by_larger_step(2) = [0.2_wp, 0.2_wp], by_scheme(2) = [2.0_wp, 0.3_wp]

contains

   !> Fills the `row` of the time step of a `scene` with what its `runs` tell already; `is_open`:
   !> one with a larger step would tell it.
   pure subroutine tell_time_step(scene, runs, row, is_open)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      type(influence_t), intent(inout) :: row
      logical, intent(out) :: is_open

      is_open = .false.
      associate (bars => runs%bars)
         if (bars%forecast%is_known .and. bars%apart%is_known) then
            row%change = quotient(time_errors(bars%apart, runs%full), abs(runs%full%of%value))
         else if (.not. is_told(scene, runs)) then
            row%unknown = 'there is no error estimate, or a coarse grid does not see all waves'
         else if (bars%is_first_order) then
            row%change = error_by(bars%second_order, runs%full, by_scheme)
         else
            is_open = .true.
         end if
      end associate
      row%error = 0.0_wp*row%change
   end subroutine tell_time_step

   !> Fills it from the passage on n/8 intervals with the usual step and the one with twice that.
   pure subroutine take_larger_step(usual, larger, row)
      type(line_summary_t), intent(in) :: usual, larger
      type(influence_t), intent(inout) :: row

      row%change = error_by(usual, larger, by_larger_step)
      row%error = 0.0_wp*row%change
   end subroutine take_larger_step

   !> What that costs, about, in nodes times Newton steps. `has_coarsest`: the passage with the
   !> usual step is there.
   pure function time_step_cost(scene, runs, has_coarsest) result(cost)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      logical, intent(in) :: has_coarsest
      real(wp) :: cost

      cost = merge(0.5_wp, 1.5_wp, has_coarsest)*cost_on(scene, runs, &
         scene%contact%domain%intervals/8)
   end function time_step_cost

   !> Whether the error bars have runs that see all waves, and where it takes the coarsest grid,
   !> that sees them too.
   pure function is_told(scene, runs)
      type(scene_t), intent(in) :: scene
      type(own_runs_t), intent(in) :: runs
      logical :: is_told

      ! as of an ingredient that takes n/4 and n/8, or as one that does not
      is_told = is_told_by_own(scene, runs, ingredient_t(merge(squeeze, elasticity, &
         runs%bars%is_first_order), '', ''))
   end function is_told

   !> Relative errors by the changes from `other` to `better`, with these `factors`.
   pure function error_by(better, other, factors) result(errors)
      type(line_summary_t), intent(in) :: better, other
      real(wp), intent(in) :: factors(2)
      real(wp) :: errors(quantity_count)

      errors = change_between(better, other)
      errors = factors(1)*abs(errors) + factors(2)*largest_change(errors)
   end function error_by

end module time_step_error

!> How far off the quantities of a passage may be because of its time step alone.
!>
!> A run for a target has a coarse run with a larger step already; one of first order in time has
!> the scheme of second order beside it. Else one more passage on n/4 intervals, with twice the step
!> of that of the error bars, tells what a larger step does there.
module time_step_error
   use ablation_runs, only: change_between, largest_change
   use adequacy, only: influence_t
   use error_bars, only: error_bars_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use missing_value, only: quotient
   use quantities, only: quantity_count
   use split_errors, only: time_errors
   implicit none (type, external)
   private

   public :: set_step_error, set_step_error_of_bars

   !> The error because of the time step: this many times the change from twice the step on n/4, or
   !> from the scheme of first order to that of second, and a share of the largest change of a film,
   !> for changes vanish by chance.
   real(wp), parameter :: by_larger_step(2) = [0.2_wp, 0.2_wp], by_scheme(2) = [2.0_wp, 0.3_wp]

contains

   !> Fills the `row` of the time step of a result with these `full` quantities by what its `bars`
   !> tell already; `is_open`: they do not.
   pure subroutine set_step_error_of_bars(bars, full, row, is_open)
      type(error_bars_t), intent(in) :: bars
      type(line_summary_t), intent(in) :: full
      type(influence_t), intent(inout) :: row
      logical, intent(out) :: is_open

      is_open = .false.
      if (bars%forecast%is_known .and. bars%apart%is_known) then
         row%change = quotient(time_errors(bars%apart, full), abs(full%of%value))
      else if (bars%is_first_order .and. bars%grids > 1) then
         row%change = error_by(bars%second_order, full, by_scheme)
      else
         is_open = .true.
      end if
      row%error = 0.0_wp*row%change
   end subroutine set_step_error_of_bars

   !> Fills it from a passage on n/4 intervals with the usual step and with twice that.
   pure subroutine set_step_error(usual, larger, row)
      type(line_summary_t), intent(in) :: usual, larger
      type(influence_t), intent(inout) :: row

      row%change = error_by(usual, larger, by_larger_step)
      row%error = 0.0_wp*row%change
   end subroutine set_step_error

   !> Relative errors by the changes from `other` to `better`, with these `factors`.
   pure function error_by(better, other, factors) result(errors)
      type(line_summary_t), intent(in) :: better, other
      real(wp), intent(in) :: factors(2)
      real(wp) :: errors(quantity_count)

      errors = change_between(better, other)
      errors = factors(1)*abs(errors) + factors(2)*largest_change(errors)
   end function error_by

end module time_step_error

!> Error of the quantities of a transient by its time step alone.
!>
!> A run with a target already has a coarse run with a larger step, and a first-order run one by the
!> second-order scheme. Otherwise one more run on n/4 intervals, with twice the step of that of the
!> error bars, shows the effect of a larger step.
module time_step_error
   use ablation_runs, only: change_between, largest_change
   use adequacy, only: influence_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use missing_value, only: quotient
   use split_errors, only: apart_t, time_errors
   implicit none (type, external)
   private

   public :: set_split_step_error, set_step_error

   !> The error by the time step: this many times the change from twice the step on n/4, or from the
   !> first-order to the second-order scheme, plus a share of the largest change of a film, since a
   !> single change may vanish by chance.
   real(wp), parameter, public :: by_larger_step(2) = [0.2_wp, 0.2_wp], by_scheme(2) = [2.0_wp, &
      0.3_wp]

contains

   !> Sets the `row` of the time step of a result with the quantities `full` from its coarse runs
   !> with twice the spacing and with twice the step.
   pure subroutine set_split_step_error(apart, full, row)
      type(apart_t), intent(in) :: apart
      type(line_summary_t), intent(in) :: full
      type(influence_t), intent(inout) :: row

      row%change = quotient(time_errors(apart, full), abs(full%of%value))
      row%error = 0.0_wp*row%change
   end subroutine set_split_step_error

   !> Sets it from the change from an `other` run to a `better` one, with these `factors`.
   pure subroutine set_step_error(better, other, factors, row)
      type(line_summary_t), intent(in) :: better, other
      real(wp), intent(in) :: factors(2)
      type(influence_t), intent(inout) :: row

      row%change = change_between(better, other)
      row%change = factors(1)*abs(row%change) + factors(2)*largest_change(row%change)
      row%error = 0.0_wp*row%change
   end subroutine set_step_error

end module time_step_error

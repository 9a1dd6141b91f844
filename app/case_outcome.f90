!> How a case ended: exit status and reason, for the program's own status and for `--outcomes`.
module case_outcome
   use errors, only: error_t, output_error
   use iteration_report, only: has_converged, report_t
   use progress_log, only: progress_log_t, write_text
   use text, only: to_text
   implicit none (type, external)
   private

   public :: case_outcome_t, count_outcome, give_up, outcome_of

   !> Exit status of one case: converged and written; failed inside; not converged, or outside the
   !> model, but written; not written; interrupted.
   integer, parameter, public :: status_converged = 0, status_failed = 1, &
      status_not_converged = 2, status_not_written = 3, &
      status_interrupted = 4

   !> How a case ended.
   type :: case_outcome_t
      integer :: status = status_converged
      !> Why the status is not 0.
      character(:), allocatable :: reason
   end type case_outcome_t

contains

   !> Prints an error and turns it into an outcome.
   subroutine give_up(error, log, outcome)
      type(error_t), intent(in) :: error
      type(progress_log_t), intent(inout) :: log
      type(case_outcome_t), intent(out) :: outcome

      call log%say_error(error%message)
      outcome%status = merge(status_not_written, status_failed, error%kind == output_error)
      outcome%reason = error%message
   end subroutine give_up

   !> The outcome of a case whose result is written.
   pure function outcome_of(report) result(outcome)
      type(report_t), intent(in) :: report
      type(case_outcome_t) :: outcome

      if (report%outcome() == has_converged) return
      outcome%status = status_not_converged
      if (allocated(report%reason)) outcome%reason = trim(report%reason)
   end function outcome_of

   !> Takes the outcome of `file` into the `status` of the call, the largest of all, and writes its
   !> line of `--outcomes` if `is_told`: status, `file` and reason, with tabs between. Error:
   !> standard output is lost.
   subroutine count_outcome(file, outcome, is_told, status, error)
      character(*), intent(in) :: file
      type(case_outcome_t), intent(in) :: outcome
      logical, intent(in) :: is_told
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: line
      character(*), parameter :: tab = achar(9)
      integer :: i

      status = max(status, outcome%status)
      if (.not. is_told) return
      line = to_text(outcome%status)//tab//file//tab
      if (allocated(outcome%reason)) line = line//outcome%reason
      do i = 1, len(line)
         if (line(i:i) == new_line('a')) line(i:i) = ' '
      end do
      call write_text(line//new_line('a'), error)   ! error: handed up
   end subroutine count_outcome

end module case_outcome

!> What every kind of case does at its end: error messages and exit status.
module case_outcome
   use errors, only: error_t, output_error
   use progress_log, only: progress_log_t
   implicit none (type, external)
   private

   public :: give_up

   !> Exit status of one case: converged and written; failed inside; not converged, but written; not
   !> written; interrupted.
   integer, parameter, public :: status_converged = 0, status_failed = 1, &
      status_not_converged = 2, status_not_written = 3, &
      status_interrupted = 4

contains

   !> Prints an error and turns it into an exit status.
   subroutine give_up(error, log, status)
      type(error_t), intent(in) :: error
      type(progress_log_t), intent(inout) :: log
      integer, intent(out) :: status

      call log%say_error(error%message)
      status = merge(status_not_written, status_failed, error%kind == output_error)
   end subroutine give_up

end module case_outcome

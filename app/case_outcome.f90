!> What every kind of case does at its end: values used, errors told, exit status.
module case_outcome
   use case_record, only: case_t
   use errors, only: error_t, output_error
   use progress_log, only: progress_log_t
   use result_writer, only: result_writer_t
   implicit none (type, external)
   private

   public :: give_up, store_input

   !> Exit status of one case: converged and written; failed inside; not converged, but written; not written; interrupted.
   integer, parameter, public :: status_converged = 0, status_failed = 1, status_not_converged = 2, status_not_written = 3, &
      status_interrupted = 4

contains

   !> Tells an error and turns it into an exit status.
   subroutine give_up(error, log, status)
      type(error_t), intent(in) :: error
      type(progress_log_t), intent(inout) :: log
      integer, intent(out) :: status

      call log%say_error(error%message)
      status = merge(status_not_written, status_failed, error%kind == output_error)
   end subroutine give_up

   !> /input/effective.
   subroutine store_input(case, writer)
      type(case_t), intent(in) :: case
      type(result_writer_t), intent(inout) :: writer
      integer :: i

      do i = 1, size(case%effective)
         associate (entry => case%effective(i))
            call writer%add_input(entry%group, entry%key, entry%value, entry%unit)
         end associate
      end do
   end subroutine store_input

end module case_outcome

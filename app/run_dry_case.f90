!> One dry case from its record to its result file and its exit status.
module run_dry_case
   use case_effective, only: list_dry
   use case_notes, only: note_unusual
   use case_outcome, only: case_outcome_t, outcome_of
   use case_record, only: case_t
   use dry_adequacy, only: dry_adequacy_t, measure_dry_adequacy
   use dry_record, only: dry_record_t
   use dry_result, only: close_dry_case, write_dry_adequacy, write_dry_result
   use dry_target, only: solve_to_target
   use errors, only: error_t, fail, input_error
   use progress_log, only: progress_log_t
   use result_file, only: open_result, result_file_t
   use signals, only: begin_activity
   use surface_keys, only: has_shape, surfaces
   use system_limits, only: memory_fault, processors, thread_memory
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: solve_and_write

contains

   !> Solves all loads of `case`, writes its result `path`, and prints a line for each load to the
   !> `log`; areas use `threads` threads. Error: the memory, the result, or a load without a
   !> solution; there is no result then.
   subroutine solve_and_write(case, path, log, threads, ending, error)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      type(progress_log_t), intent(inout) :: log
      integer, intent(in) :: threads
      type(case_outcome_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(result_file_t) :: result
      type(dry_record_t) :: record
      type(dry_adequacy_t) :: adequacy
      character(:), allocatable :: words

      if (case%dry%grid%ny > 1) case%dry%grid%threads = min(threads, processors())
      call check_memory(case, error)
      if (.not. allocated(error)) call open_result(result, path, error)
      if (allocated(error)) return
      associate (outcome => record%outcome, report => record%outcome%solution%report)
         call solve_to_target(case%dry, record, error)
         if (.not. allocated(error) .and. case%dry%wants_adequacy) then
            call begin_activity('looking at the model')
            call measure_dry_adequacy(record, case%dry%target, any(has_shape(case%dry%values, &
               surfaces, 'parabola')), adequacy, error)
         end if
         if (.not. allocated(error)) then
            call note_unusual(case, words)
            if (allocated(case%dry%note)) call add_sentence(words, case%dry%note)
            if (allocated(words)) call move_alloc(words, report%note)
            call list_dry(case)
            call result%begin_end(case)
            call write_dry_result(result%file, case%dry, outcome, error)
         end if
         if (allocated(error)) then
            call result%discard()
            return
         end if
         call write_dry_adequacy(result%file, adequacy)
         call result%publish(report, error)
         if (allocated(error)) return
         call close_dry_case(log, case%file(index(case%file, '/', back=.true.) + 1:), case%dry, &
            outcome, adequacy, result%name%path)
         ending = outcome_of(report)
      end associate
   end subroutine solve_and_write

   !> Error (input_error): there is not enough memory for the grid and the threads.
   subroutine check_memory(case, error)
      type(case_t), intent(in) :: case
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault

      associate (grid => case%dry%grid)
         fault = memory_fault('a grid', case%dry%memory_on([grid%nx, grid%ny]), &
            thread_memory(grid%threads))
         if (fault /= '' .and. grid%threads > 1) fault = fault//', with '//to_text(grid%threads) &
            //' threads'
      end associate
      if (fault /= '') call fail(error, input_error, case%file//': '//fault)
   end subroutine check_memory

end module run_dry_case

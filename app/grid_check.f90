!> Whether the grid that the program will choose for a lubricated case fits its method and the
!> memory, and how far it may be refined.
module grid_check
   use case_memory, only: lubricated_memory
   use case_record, only: case_t
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use solver_settings, only: max_intervals_of, max_refined_intervals, time_settings_t
   use system_limits, only: memory_fault, of_blas
   use text, only: to_text
   use wave_resolution, only: choose_time_step
   implicit none (type, external)
   private

   public :: check_grid

contains

   !> Determines for how many intervals there is memory. Error: the grid that the program will
   !> choose is too fine for the method, or for the memory.
   subroutine check_grid(case, contact, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(in) :: contact
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault

      associate (intervals => contact%domain%intervals, method => case%solver%method)
         fault = fault_of(intervals)
         if (intervals > max_intervals_of(method)) fault = 'found '//to_text(intervals) &
            //' intervals, which the program '// &
            'chooses, expected at most '//to_text(max_intervals_of(method))//" with method = '" &
               //trim(method)//"'"
      end associate
      if (fault /= '') call fail(error, input_error, case%file//': &domain intervals: '//fault)
      associate (most => case%solver%max_intervals)
         most = max_refined_intervals
         do while (most > contact%domain%intervals .and. fault_of(most) /= '')
            most = most/2
         end do
      end associate

   contains

      !> What is wrong with the memory that a grid needs.
      function fault_of(intervals) result(fault)
         integer, intent(in) :: intervals
         character(:), allocatable :: fault
         type(line_contact_t) :: trial
         type(time_settings_t) :: time
         real(wp) :: steps

         trial = contact
         trial%domain%intervals = intervals
         time = case%time
         call choose_time_step(trial, time)
         steps = 0.0_wp
         if (time%is_transient) steps = time%end_time/time%time_step
         fault = memory_fault('a grid', lubricated_memory(intervals, steps, &
            case%solver%method == 'newton_dense', case%layers), of_blas)
      end function fault_of

   end subroutine check_grid

end module grid_check

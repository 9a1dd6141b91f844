!> Opens the result of a case: a new one, or that of an interrupted run.
module result_start
   use build_info, only: git_commit, program_version
   use case_record, only: case_identity, case_t
   use checkpoint, only: checkpoint_t, read_checkpoint
   use errors, only: error_t
   use file_bytes, only: seal_fault
   use film_statistics, only: new_statistics
   use hdf5_input, only: hdf5_input_t, open_hdf5_input
   use iteration_report, only: phase_output
   use key_row, only: point
   use kinds, only: exceeds, wp
   use point_contact, only: dry_border
   use result_file, only: hold_name, open_result, reopen_result, result_file_t, stored_fields
   use run_observer, only: run_observer_t
   use scaling, only: new_heating
   use text, only: to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: find_complete_result, start_result, usual_stride

   !> Times whose fields are stored where the program chooses.
   integer, parameter :: stored_times = 50

contains

   !> Opens the result `path` of `case`; with `is_resume` at the last checkpoint, if there is one.
   !> `case%time%resume_from` then says where the run goes on. Errors: the result cannot be written;
   !> the checkpoint is of no use.
   subroutine start_result(case, path, is_resume, listener, error)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      logical, intent(in) :: is_resume
      type(run_observer_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error
      logical :: has_checkpoint

      listener%start = wall_seconds()
      listener%last_checkpoint = listener%start
      listener%film_floor = case%solver%film_floor
      listener%checkpoint_interval = case%output_settings%checkpoint_interval
      listener%writer%profile_stride = case%output_settings%profile_stride
      listener%writer%fields = stored_fields(case)
      inquire (file=path//'.ckpt', exist=has_checkpoint)
      if (case%time%is_transient .or. has_checkpoint) listener%writer%run%case = &
         case_identity(case)
      if (is_resume .and. has_checkpoint) then
         call go_on(case, path, listener, error)
      else
         if (is_resume) call listener%log%say(case%file//': no checkpoint '//path &
            //'.ckpt: starts at the beginning')
         call open_result(listener%writer, case, path, error)
      end if
      if (allocated(error)) return
      associate (statistics => listener%writer%run%statistics, &
         thresholds => case%output_settings%film_thresholds)
         if (.not. allocated(statistics%thresholds) .and. size(thresholds) > 0) then
            statistics = new_statistics(thresholds/case%scaling%film)
         end if
         if (case%problem == point) statistics%border = dry_border(case%point)
      end associate
      listener%writer%heating = new_heating(case%scaling, case%bodies, &
         case%materials%effusivity, case%materials%conductivity)
      if (any(index(listener%writer%fields, 'shear_stress') == 1)) listener%stress_stride = &
         listener%writer%profile_stride
      associate (file => listener%writer%file)
         file%has_si = case%output_settings%has_si .and. case%scaling%is_dimensional
         file%scaling = case%scaling
      end associate
   end subroutine start_result

   !> Goes on at the checkpoint of `path`.
   subroutine go_on(case, path, listener, error)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      type(run_observer_t), intent(inout) :: listener
      type(error_t), allocatable, intent(out) :: error
      type(checkpoint_t) :: checkpoint

      call read_checkpoint(path//'.ckpt', listener%writer%run%case, checkpoint, error)
      if (.not. allocated(error)) then
         associate (stride => listener%writer%profile_stride)   ! 0: chosen with the time step
            if (stride == 0) stride = usual_stride(case%time%end_time, checkpoint%time_step)
         end associate
         call reopen_result(listener%writer, path, size(checkpoint%march%film), &
            checkpoint%march%step + 1, checkpoint%part_digits, error)
      end if
      if (allocated(error)) then
         error%message = 'cannot resume: '//error%message
         return
      end if
      listener%earlier_seconds = checkpoint%march%report%cost%wall_seconds
      listener%output_seconds = checkpoint%march%report%cost%phase_seconds(phase_output)
      call listener%writer%expect_interruption(checkpoint%march%step)
      listener%writer%run = checkpoint
      if (allocated(checkpoint%momentum)) listener%follower%earlier = checkpoint%momentum
      call listener%log%say(case%file//': continues after step '//to_text(checkpoint%march%step) &
         //', checkpoint '//path//'.ckpt')
      case%time%resume_from = checkpoint%march
   end subroutine go_on

   !> Every how many time steps fields are stored where the program chooses.
   pure integer function usual_stride(end_time, time_step) result(stride)
      real(wp), intent(in) :: end_time, time_step

      stride = max(1, nint(end_time/(stored_times*time_step)))
   end function usual_stride

   !> Whether `path` is the complete result of this very case by this very program, its outcome and
   !> the reason; other files of that run are removed. The result is locked meanwhile. Errors:
   !> another run does; it cannot be the name of a result.
   subroutine find_complete_result(path, case, is_complete, outcome, reason, error)
      character(*), intent(in) :: path
      type(case_t), intent(in) :: case
      logical, intent(out) :: is_complete
      character(:), allocatable, intent(out) :: outcome, reason
      type(error_t), allocatable, intent(out) :: error
      type(result_file_t) :: name
      type(hdf5_input_t) :: reader
      type(error_t), allocatable :: failure

      is_complete = .false.
      call hold_name(name, path, error)
      if (allocated(error)) return
      if (seal_fault(path) == '') then
         call open_hdf5_input(reader, path, failure)   ! error: the reader keeps it
         is_complete = all([reader%text('/', 'version') == program_version, &
            reader%text('/', 'git_commit') == git_commit(), &
            reader%text('/input/namelist') == case%namelist, has_same_heights(reader, case)])
         outcome = reader%text('/', 'outcome')
         reason = reader%text('/', 'reason')
         call reader%close(failure)
         is_complete = is_complete .and. .not. allocated(failure)
      end if
      if (is_complete) call name%remove_checkpoint()
      call name%release(removes_part=is_complete .or. .not. name%had_part)
   end subroutine find_complete_result

   !> Whether a result is of the heights of `case`: the namelist only names their files.
   logical function has_same_heights(reader, case) result(is_same)
      type(hdf5_input_t), intent(inout) :: reader
      type(case_t), intent(in) :: case
      character(:), allocatable :: path
      real(wp) :: found
      integer :: i

      is_same = .true.
      do i = 1, size(case%effective)
         associate (entry => case%effective(i))
            if (index(entry%key, 'heights_') /= 1 .and. entry%key /= 'table_checksum') cycle
            path = '/input/effective/'//trim(entry%group)
            is_same = is_same .and. reader%has(path)
            if (.not. is_same) return
            if (allocated(entry%text)) then
               is_same = reader%text_of(path, trim(entry%key)) == entry%text
            else if (size(entry%reals) == 1) then   ! not tilts of an area: known by their checksum
               found = reader%real_value(path, trim(entry%key), huge(1.0_wp))
               is_same = exceeds(-abs(found - entry%reals(1)), -tiny(found))   ! NaN: no
            end if
         end associate
      end do
   end function has_same_heights

end module result_start

!> A result file from its first line to its final name, whatever it holds.
!>
!> While the case runs NAME.part in the same folder holds its place and the time steps, so that
!> memory does not grow with them. At the end the result is put together in NAME.tmp, which is then
!> renamed. An interrupted or failed run leaves an older NAME as it was.
module result_file
   use build_info, only: git_commit, program_name, program_version
   use case_record, only: case_t
   use disk_file, only: remove_file, sync_file
   use errors, only: error_t, fail, input_error
   use hdf5_axes, only: write_users
   use hdf5_dataset, only: new_label, write_attribute, write_dataset
   use hdf5_file, only: create_hdf5_file, hdf5_file_t
   use iteration_report, only: report_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use result_labels, only: field_names
   use result_name, only: hold_name, result_name_t
   use result_sections, only: write_report
   use scaling, only: scaling_t
   use signals, only: begin_activity, set_patience
   use summary_row, only: empty_row
   use transient_store, only: attach_store, begin_store, create_store, sliding_names, &
      transient_store_t
   implicit none (type, external)
   private

   public :: open_result, reopen_result, result_file_t

   !> Layout of result files (CHANGELOG.md): 2 has axes, `units` and /si; no attribute: 1.
   integer, parameter :: layout = 3
   !> Longest name of a field or series.
   integer, parameter, public :: field_name_length = max(len(field_names), len(sliding_names))

   !> The file being written.
   type :: result_file_t
      !> Its final name, and the files of the run.
      type(result_name_t) :: name
      !> Every how many time steps profiles are stored; those at T = 0 always are.
      integer :: profile_stride = 1
      !> Profiles that are stored, names of `field_names`, and series that not every passage has.
      character(len=field_name_length), allocatable :: fields(:)
      !> The open file.
      type(hdf5_file_t) :: file
      !> Reference values of a lubricated contact.
      type(scaling_t) :: scaling
      !> The time steps in NAME.part, and whether there are any.
      type(transient_store_t) :: store
      logical :: is_transient = .false.
   contains
      procedure :: append_step, sync, begin_end, copy_steps, publish, suspend, discard
      procedure, private :: keep_failure
   end type result_file_t

contains

   !> Starts a `new` result `path` of a `case` under its temporary name, without an old checkpoint,
   !> or the row of a table in its place, or `error`.
   subroutine open_result(new, case, path, error)
      class(result_file_t), intent(inout) :: new
      type(case_t), intent(in) :: case
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      if (allocated(case%table)) then
         new%name%path = case%table%path//', the row of '//case%file
         new%file%row = empty_row
         new%file%row%place = case%table
         return
      end if
      call hold_name(new%name, path, error)
      if (allocated(error)) return
      call new%name%expect_interruption(0)
      call new%name%remove_checkpoint()
      new%fields = [character(len=field_name_length) :: 'pressure', 'film_thickness']
      call create_store(new%store, path//'.part')
      if (.not. allocated(new%store%file%failure)) return
      error = new%store%file%failure
      call new%name%give_back(is_complete=.false.)
   end subroutine open_result

   !> Goes on with the result `path` of an interrupted run, behind the first `records` time steps
   !> with profiles of `nx` nodes. Error: NAME.part is not that of the checkpoint, by its `digits`.
   subroutine reopen_result(new, path, fields, nx, records, digits, error)
      class(result_file_t), intent(inout) :: new
      character(*), intent(in) :: path, fields(:), digits
      integer, intent(in) :: nx, records
      type(error_t), allocatable, intent(out) :: error

      call hold_name(new%name, path, error)
      if (allocated(error)) return
      if (.not. new%name%had_part) then
         call fail(error, input_error, path//'.part is missing')
         call new%name%give_back(is_complete=.false.)
         return
      end if
      new%fields = [character(len=field_name_length) :: fields]
      call attach_store(new%store, path//'.part', fields, [nx, new%profile_stride, records], &
         digits, error)
      if (allocated(error)) then
         call new%suspend()
         return
      end if
      new%is_transient = .true.
      new%name%has_checkpoint = .true.
   end subroutine reopen_result

   !> Appends a time step with its `summary` to NAME.part.
   subroutine append_step(self, state, summary, report)
      class(result_file_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report

      if (.not. (self%is_transient .or. allocated(self%file%row))) then
         call self%store%file%close()
         call create_store(self%store, self%name%path//'.part')
         call begin_store(self%store, self%fields, size(state%pressure), self%profile_stride)
      end if
      self%is_transient = .true.
      if (allocated(self%file%row)) return
      call self%store%append(state, summary, report)
      call self%keep_failure()
   end subroutine append_step

   !> A failure of the store counts as one of the file.
   subroutine keep_failure(self)
      class(result_file_t), intent(inout) :: self

      if (allocated(self%file%failure) .or. .not. allocated(self%store%file%failure)) return
      self%file%failure = self%store%file%failure
   end subroutine keep_failure

   !> Waits until NAME.part is on the disk; true if that worked.
   logical function sync(self) result(is_done)
      class(result_file_t), intent(inout) :: self

      call self%keep_failure()
      is_done = .not. allocated(self%file%failure)
      if (is_done) is_done = sync_file(self%name%path//'.part')
   end function sync

   !> Begins NAME.tmp with the input of `case`, a group /input/effective/<group> for each namelist
   !> group, whose attributes are its keys; a failure stays in `self%file%failure`.
   subroutine begin_end(self, case)
      class(result_file_t), intent(inout) :: self
      type(case_t), intent(in) :: case
      type(error_t), allocatable :: error
      character(:), allocatable :: path
      integer :: i

      ! with all time steps in the checkpoint the result can be put together again
      call set_patience(.not. (self%name%has_checkpoint &
         .and. self%name%kept_step == self%store%records - 1))
      call begin_activity('writing the result')
      if (allocated(self%file%failure)) return
      if (.not. allocated(self%file%row)) call create_hdf5_file(self%file, &
         self%name%path//'.tmp', error)   ! error: it stays
      associate (file => self%file)
         call write_attribute(file, '/', 'program', program_name)
         call write_attribute(file, '/', 'version', program_version)
         call write_attribute(file, '/', 'git_commit', git_commit())
         call write_attribute(file, '/', 'layout', layout)
         call write_attribute(file, '/', 'problem', trim(case%problem))
         call write_attribute(file, '/', 'title', case%title)
         call write_dataset(file, '/input/namelist', case%namelist, &
            new_label('the input: as a file it repeats this run', '1'))
         call file%create_group('/input/effective')
         call write_attribute(file, '/input/effective', 'about', 'every value used, in the '// &
            'unit of its key: SI, or half-widths for positions along the film')
      end associate
      do i = 1, size(case%effective)
         associate (file => self%file, entry => case%effective(i))
            path = '/input/effective/'//trim(entry%group)
            if (.not. any(case%effective(:i - 1)%group == entry%group)) call file%create_group(path)
            if (allocated(entry%text)) then
               call write_attribute(file, path, trim(entry%key), entry%text)
            else if (allocated(entry%integer)) then
               call write_attribute(file, path, trim(entry%key), entry%integer)
            else if (size(entry%reals) == 1) then
               call write_attribute(file, path, trim(entry%key), entry%reals(1))
            else
               call write_attribute(file, path, trim(entry%key), entry%reals)
            end if
         end associate
      end do
   end subroutine begin_end

   !> Copies the time steps into /transient, with fields as those of `state`; series in SI too if
   !> they are wanted.
   subroutine copy_steps(self, has_si, state)
      class(result_file_t), intent(inout) :: self
      logical, intent(in) :: has_si
      type(line_state_t), intent(in) :: state
      integer, allocatable :: extents(:)

      if (.not. self%is_transient .or. allocated(self%file%failure) &
         .or. allocated(self%file%row)) return
      extents = shape(state%x)
      if (allocated(state%y)) extents = [extents, size(state%y)]
      call self%store%copy_into(self%file, self%scaling, has_si, extents)
      call self%keep_failure()
   end subroutine copy_steps

   !> Writes report and outcome, closes the file and gives it its final name. Every result of
   !> every problem ends here: one with values that are no answer, or with more left than its bound,
   !> has not converged, whatever the solver says.
   subroutine publish(self, report, error)
      class(result_file_t), intent(inout) :: self
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: reason

      if (report%converged .and. allocated(self%file%nonsense)) then
         report%converged = .false.
         report%reason = self%file%nonsense
      else if (report%converged .and. .not. report%residual <= report%tolerance_effective) then
         report%converged = .false.
         report%reason = 'the residual is above its bound'
      end if
      call write_report(self%file, report)
      reason = ''
      if (allocated(report%reason)) reason = trim(report%reason)
      call write_attribute(self%file, '/', 'converged', merge(1, 0, report%converged))
      call write_attribute(self%file, '/', 'outcome', report%outcome())
      call write_attribute(self%file, '/', 'reason', reason)
      if (allocated(self%file%row)) then
         call self%file%row%append(error)   ! error: handed up
         return
      end if
      call write_users(self%file)
      call self%file%close(error)
      if (.not. allocated(error)) call self%name%give_to(error)   ! error: handed up
      call self%discard()
   end subroutine publish

   !> Closes NAME.part, which stays for a run that resumes, and lets others write it.
   subroutine suspend(self)
      class(result_file_t), intent(inout) :: self

      call self%store%file%close()
      call self%name%release()
   end subroutine suspend

   !> Closes the files whatever their state and removes them, but NAME.part with a checkpoint.
   subroutine discard(self)
      class(result_file_t), intent(inout) :: self
      type(error_t), allocatable :: error
      logical :: is_removed

      if (allocated(self%file%row)) return
      call self%file%close(error)   ! error: the file is given up anyway
      call self%store%file%close()
      is_removed = remove_file(self%name%path//'.tmp')
      if (.not. self%name%has_checkpoint) call self%name%remove_part()
      call self%suspend()
   end subroutine discard

end module result_file

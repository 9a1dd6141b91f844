!> A result file from its first line to its final name, whatever it holds: who may write it, its
!> files, and their end.
!>
!> While the case runs NAME.part in the same folder keeps other runs away and holds the time steps,
!> so that memory does not grow with them; NAME.ckpt is a checkpoint and NAME.ckpt.tmp the next one.
!> At the end the result is put together in NAME.tmp, which is then renamed. An interrupted or
!> failed run leaves an older NAME as it was, and every run what is not its own.
module result_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use build_info, only: git_commit, program_name, program_version
   use case_record, only: case_t
   use disk_file, only: file_at, file_fault, file_identity_t, folder_of, hdf5_mark, is_folder, &
      kind_link, kind_other, lock_t, place_fault, remove_file, rename_file, sync_file
   use errors, only: error_t, fail, input_error, output_error
   use file_bytes, only: seal_file
   use hdf5_axes, only: write_users
   use hdf5_dataset, only: write_attribute
   use hdf5_file, only: create_hdf5_file
   use iteration_report, only: report_t
   use kinds, only: wp
   use quantities, only: asperity_share, boundary_friction, oil_friction, quantity_rows, &
      sliding_rows
   use result_labels, only: momentum_names, section_file_t
   use result_sections, only: write_report
   use signals, only: begin_activity, clear_exit_message, set_exit_message, set_patience
   use summary_row, only: empty_row
   use text, only: to_text
   use transient_store, only: attach_store, breakdown_name, create_store, name_length, &
      transient_store_t
   implicit none (type, external)
   private

   public :: hold_name, open_result, reopen_result, result_file_t, stored_fields

   !> Layout of result files (CHANGELOG.md): 2 has axes, `units` and /si; no attribute: 1.
   integer, parameter :: layout = 3
   !> Endings of the files of a run until its result is complete; the checkpoint comes last.
   character(len=9), parameter, public :: working_endings(4) = [character(len=9) :: '.part', &
      '.tmp', '.ckpt.tmp', '.ckpt']

   !> The file being written.
   type :: result_file_t
      !> Its final name.
      character(:), allocatable :: path
      !> NAME.part holds what a checkpoint needs: it stays when the run fails.
      logical :: has_checkpoint = .false.
      !> Time step of that checkpoint; without one it means nothing.
      integer :: kept_step = -1
      !> There was a NAME.part before the name was taken.
      logical :: had_part = .false.
      !> Lock on NAME.part.
      type(lock_t) :: lock
      !> Every how many time steps profiles are stored; those at T = 0 always are.
      integer :: profile_stride = 1
      !> Profiles that are stored, names of `field_names`, and series that not every passage has.
      character(len=name_length), allocatable :: fields(:)
      !> The open file.
      type(section_file_t) :: file
      !> The time steps in NAME.part, and whether there are any.
      type(transient_store_t) :: store
      logical :: is_transient = .false.
   contains
      procedure :: expect_interruption, interruption_text, begin_end, publish, remove_checkpoint, &
         release, discard
      procedure, private :: give_to
   end type result_file_t

contains

   !> Takes the name `path` until `release`. Error: another run has it; it cannot be a result, or
   !> would be written through a link or pipe.
   subroutine hold_name(name, path, error)
      class(result_file_t), intent(inout) :: name
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      type(file_identity_t) :: file
      integer :: i

      name%path = path
      inquire (file=path//'.part', exist=name%had_part)
      fault = ''
      if (is_folder(path)) then
         fault = 'it is a folder'
      else if (.not. is_folder(folder_of(path))) then
         fault = 'there is no folder '//folder_of(path)
         if (file_fault(folder_of(path)) == '') fault = folder_of(path)//' is a file, not a folder'
      else
         do i = size(working_endings), 1, -1
            associate (working => path//trim(working_endings(i)))
               file = file_at(working, follows=.false.)
               if (file%kind == kind_link) fault = working//' is a link'
               if (file%kind == kind_other) fault = working//' is no regular file'
            end associate
         end do
      end if
      if (fault == '') then
         if (.not. name%lock%acquire(path//'.part')) fault = 'another run is writing '//path &
            //'.part'
      end if
      if (fault /= '') call fail(error, output_error, 'cannot write '//path//': '//fault)
   end subroutine hold_name

   !> Starts a `new` result `path` of a `case` under its temporary name, without an old checkpoint,
   !> or the row of a table in its place, or `error`.
   subroutine open_result(new, case, path, error)
      class(result_file_t), intent(inout) :: new
      type(case_t), intent(in) :: case
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      if (allocated(case%table)) then
         new%path = case%table%path//', the row of '//case%file
         new%file%row = empty_row
         new%file%row%place = case%table
         return
      end if
      call hold_name(new, path, error)
      if (allocated(error)) return
      call new%expect_interruption(0)
      call new%remove_checkpoint()
      call create_store(new%store, path//'.part')
      if (.not. allocated(new%store%file%failure)) return
      error = new%store%file%failure
      call new%release(removes_part=.not. new%had_part)
   end subroutine open_result

   !> Goes on with the result `path` of an interrupted case, behind the first `records` time steps
   !> with profiles of `nx` nodes. Error: NAME.part is not that of the checkpoint, by its `digits`.
   subroutine reopen_result(new, path, nx, records, digits, error)
      class(result_file_t), intent(inout) :: new
      character(*), intent(in) :: path, digits
      integer, intent(in) :: nx, records
      type(error_t), allocatable, intent(out) :: error

      call hold_name(new, path, error)
      if (allocated(error)) return
      if (.not. new%had_part) call fail(error, input_error, path//'.part is missing')
      if (.not. allocated(error)) call attach_store(new%store, path//'.part', new%fields, &
         [nx, new%profile_stride, records], digits, error)
      if (allocated(error)) then
         call new%release(removes_part=.not. new%had_part)
         return
      end if
      new%is_transient = .true.
      new%has_checkpoint = .true.
   end subroutine reopen_result

   !> Names of the profiles that are stored of each time, of the mark of a film below the floor, if
   !> there is a floor, and of what sliding, asperities, the full momentum equations and a duty do.
   pure function stored_fields(case) result(names)
      type(case_t), intent(in) :: case
      character(len=name_length), allocatable :: names(:)
      logical :: is_line

      is_line = .not. allocated(case%point)
      names = [character(len=name_length) :: case%output_settings%fields, &
         pack([breakdown_name], case%solver%film_floor > 0.0_wp), &
         pack(quantity_rows(sliding_rows)%name, ieee_is_finite(case%scaling%slide_to_roll)), &
         pack(quantity_rows([asperity_share, oil_friction, boundary_friction])%name, &
         allocated(case%contact%asperities)), &
         pack(momentum_names, case%layers > 0 .and. case%time%is_transient)]
      if (.not. allocated(case%duty)) return
      names = [character(len=name_length) :: names, 'h_central', merge('load_per_length', &
         'load           ', is_line), pack(['reduced_radius'], is_line), 'speed_1', 'speed_2']
   end function stored_fields

   !> What is said of a run that ends here.
   function interruption_text(self) result(text)
      class(result_file_t), intent(in) :: self
      character(:), allocatable :: text

      if (self%has_checkpoint) then
         text = 'interrupted; --resume continues after step '//to_text(self%kept_step)//' with ' &
            //self%path//'.ckpt'
      else
         text = 'interrupted without a checkpoint, nothing is kept of '//self%path
      end if
   end function interruption_text

   !> Prepares this message, and says which files are removed with it.
   subroutine expect_interruption(self, step)
      class(result_file_t), intent(inout) :: self
      integer, intent(in) :: step
      integer :: first

      self%kept_step = step
      first = merge(2, 1, self%has_checkpoint)   ! a checkpoint needs NAME.part
      call set_exit_message(program_name//': '//self%interruption_text(), &
         self%path//working_endings(first:3))
   end subroutine expect_interruption

   !> Begins NAME.tmp with the input of `case`, a group /input/effective/<group> for each namelist
   !> group, whose attributes are its keys; a failure stays in `self%file%failure`.
   subroutine begin_end(self, case)
      class(result_file_t), intent(inout) :: self
      type(case_t), intent(in) :: case
      type(error_t), allocatable :: error
      character(:), allocatable :: path
      integer :: i

      ! with all time steps in the checkpoint the result can be put together again
      call set_patience(.not. (self%has_checkpoint &
         .and. self%kept_step == self%store%records - 1))
      call begin_activity('writing the result')
      if (allocated(self%file%failure)) return
      if (.not. allocated(self%file%row)) call create_hdf5_file( &
         self%file%hdf5_file_t, self%path//'.tmp', error)   ! error: it stays
      associate (file => self%file)
         call write_attribute(file, '/', 'program', program_name)
         call write_attribute(file, '/', 'version', program_version)
         call write_attribute(file, '/', 'git_commit', git_commit())
         call write_attribute(file, '/', 'layout', layout)
         call write_attribute(file, '/', 'problem', trim(case%problem))
         call write_attribute(file, '/', 'title', case%title)
         call file%begin('/input')
         call file%put('namelist', case%namelist, 'the input: as a file it repeats this run')
         call file%begin('/input/effective', 'every value used, in the unit of its key: SI, or '// &
            'half-widths for positions along the film')
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
      if (.not. allocated(error)) call self%give_to(error)   ! error: handed up
      call self%discard()
   end subroutine publish

   !> NAME.tmp becomes the result. Error: it cannot have the name, because another file has taken
   !> it, or that of NAME.part, during the run; it is NAME.new then.
   subroutine give_to(self, error)
      class(result_file_t), intent(inout) :: self
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      logical :: is_done, is_kept

      call seal_file(self%path//'.tmp', error)
      if (allocated(error)) return
      is_kept = .true.
      if (self%has_checkpoint) is_kept = sync_file(self%path//'.tmp')
      call set_patience(.true.)   ! the checkpoint goes
      fault = place_fault(self%path, hdf5_mark)
      if (.not. self%lock%holds(self%path//'.part')) fault = ': '//self%path &
         //'.part was removed or replaced while the run went on'
      is_done = is_kept .and. fault == ''
      if (is_done) is_done = rename_file(self%path//'.tmp', self%path)
      if (is_done) then
         call self%remove_checkpoint()
         return
      end if
      if (is_kept) is_kept = rename_file(self%path//'.tmp', self%path//'.new')
      if (is_kept) fault = fault//'; the result is '//self%path//'.new'
      call fail(error, output_error, 'cannot rename '//self%path//'.tmp to '//self%path//fault)
   end subroutine give_to

   !> Removes NAME.ckpt, NAME.ckpt.tmp and NAME.tmp.
   subroutine remove_checkpoint(self)
      class(result_file_t), intent(inout) :: self
      integer :: i
      logical :: is_removed

      do i = size(working_endings), 2, -1
         is_removed = remove_file(self%path//trim(working_endings(i)))
      end do
      self%has_checkpoint = .false.
   end subroutine remove_checkpoint

   !> Closes NAME.part, which may go unless it is another file by now, and lets others write the
   !> result; from now on an end by force removes nothing.
   subroutine release(self, removes_part)
      class(result_file_t), intent(inout) :: self
      logical, intent(in) :: removes_part
      logical :: is_removed

      call self%store%file%close()
      if (removes_part .and. self%lock%holds(self%path//'.part')) is_removed = &
         remove_file(self%path//'.part')
      call clear_exit_message()
      call self%lock%release()
   end subroutine release

   !> Closes the files whatever their state and removes them, but NAME.part with a checkpoint.
   subroutine discard(self)
      class(result_file_t), intent(inout) :: self
      type(error_t), allocatable :: error
      logical :: is_removed

      if (allocated(self%file%row)) return
      call self%file%close(error)   ! error: the file is given up anyway
      is_removed = remove_file(self%path//'.tmp')
      call self%release(removes_part=.not. self%has_checkpoint)
   end subroutine discard

end module result_file

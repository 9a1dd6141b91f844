!> The result file of a case, from its first line to its final name.
!>
!> While the case runs everything goes to NAME.part in the same folder. A steady result is completed
!> there and renamed to NAME. The time steps of a transient are streamed into it, so that memory
!> does not grow with their number; at the end the result is put together, compressed, in NAME.tmp,
!> which is then renamed. (NAME.part of a transient comes from NAME.tmp too, with T = 0 in it, so
!> that it never shows anything that is not there.) An interrupted or failed run leaves an older
!> NAME as it was.
module result_writer
   use breakdown_text, only: write_breakdown
   use build_info, only: git_commit, program_name, program_version
   use case_record, only: effective_t
   use error_bars, only: apply_error_bars, error_bars_t, missing_estimate
   use errors, only: error_t, fail, input_error, output_error
   use file_seal, only: seal_file
   use film_statistics, only: add_start, add_time, film_statistics_t
   use hdf5_attribute, only: write_attribute
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: create_hdf5_file, hdf5_file_t
   use input_section, only: write_input
   use interruption, only: forget_last_words, ignore_file_size_signal, lay_down_last_words, &
      set_patience
   use iteration_report, only: report_t
   use kinds, only: wp
   use life_sign, only: begin_activity
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use observer, only: observer_t
   use file_identity, only: file_identity_t, kind_link, kind_other, look_at_file
   use operating_system, only: is_folder, lock_t, remove_file, rename_file, sync_file
   use output_names, only: folder_of, working_endings
   use passage_figures, only: passage_figures_t
   use result_labels, only: field_names
   use result_sections, only: write_report, write_scaling, write_solution, write_summary, &
      write_times
   use scaling, only: scaling_t
   use statistics_section, only: write_statistics
   use text, only: to_text
   use transient_store, only: attach_store, create_store, part_t, transient_store_t
   implicit none (type, external)
   private

   public :: give_back, hold_name, open_result, reopen_result, result_writer_t

   !> Longest name of a field.
   integer, parameter, public :: field_name_length = len(field_names)

   !> The file being written. As an observer it stores time steps; `wants_stop` is set when that
   !> failed.
   type, extends(observer_t) :: result_writer_t
      !> Final name.
      character(:), allocatable :: path
      !> Every how many time steps profiles are stored; those at T = 0 always are.
      integer :: profile_stride = 1
      !> Profiles that are stored, names of `field_names`.
      character(len=field_name_length), allocatable :: fields(:)
      !> Figures of the time steps so far; all of them, or those of a steady solution, when the
      !> result is finished.
      type(passage_figures_t) :: figures
      type(line_summary_t) :: summary
      !> Companions that tell how far off the figures may be.
      type(error_bars_t) :: bars
      !> The film over all time steps, where that is asked for.
      type(film_statistics_t) :: statistics
      !> NAME.part holds what a checkpoint needs: it stays when the run fails.
      logical :: has_checkpoint = .false.
      !> Time step of that checkpoint.
      integer, private :: kept_step = -1
      !> /input/effective, every value as it is used, default or not: stored as numbers if it has a
      !> unit ('-': a pure number) and reads as such, else as text.
      type(effective_t), allocatable :: inputs(:)
      !> The open file.
      type(hdf5_file_t) :: file
      character(:), allocatable, private :: problem, title, namelist
      type(scaling_t), private :: scaling
      type(transient_store_t), private :: store
      !> Locks on the name NAME.part, and on the file that comes from NAME.tmp.
      type(lock_t), private :: lock, store_lock
      logical, private :: is_transient = .false., is_scaled = .false.
      !> There was a NAME.part before the name was taken.
      logical, private :: had_part = .false.
   contains
      procedure :: on_cycle
      procedure :: on_step
      !> Takes down what is known before the run.
      procedure :: describe
      !> What is stored in NAME.part.
      procedure :: part => stored_part
      !> Brings NAME.part to the disk as far as it is written.
      procedure :: sync
      !> Whether something could not be written.
      procedure :: has_failed
      !> Writes solution, summary and report, closes, and gives the file its name.
      procedure :: finish
      !> Writes input and report, closes, and gives the file its name.
      procedure :: publish
      !> Closes NAME.part and leaves it for a later run to go on with.
      procedure :: suspend
      !> Lays down what happens to the files if the program has to be ended by force; `step`: of the
      !> last checkpoint.
      procedure :: expect_interruption
      !> The same in words.
      procedure :: interruption_text
      !> Gives the file up; nothing of it stays, but NAME.part if there is a checkpoint.
      procedure :: discard
      procedure, private :: remove_checkpoint, keep_failure, is_kept
   end type result_writer_t

contains

   !> Starts the result `path` under its temporary name; `error` says why that cannot be. A
   !> checkpoint of an earlier run is removed.
   subroutine open_result(writer, path, error)
      type(result_writer_t), intent(out) :: writer
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      call hold_name(writer, path, error)
      if (allocated(error)) return
      call writer%expect_interruption(0)
      call writer%remove_checkpoint()
      call create_hdf5_file(writer%file, path//'.part', error)
      if (allocated(error)) call give_back(writer, is_complete=.false.)
   end subroutine open_result

   !> Goes on with the result `path` of an interrupted run, with what was stored of it (`part`,
   !> profiles of `nx` nodes) and its `figures`. Error: NAME.part is not what the checkpoint says.
   subroutine reopen_result(writer, path, fields, part, nx, figures, error)
      type(result_writer_t), intent(out) :: writer
      character(*), intent(in) :: path
      character(*), intent(in) :: fields(:)
      type(part_t), intent(in) :: part
      integer, intent(in) :: nx
      type(passage_figures_t), intent(in) :: figures
      type(error_t), allocatable, intent(out) :: error

      call hold_name(writer, path, error)
      if (allocated(error)) return
      if (.not. writer%had_part) then
         call fail(error, input_error, path//'.part is missing')
         call give_back(writer, is_complete=.false.)
         return
      end if
      writer%fields = [character(len=field_name_length) :: fields]
      call attach_store(writer%store, path//'.part', fields, nx, part, error)
      if (allocated(writer%store%file%failure) .and. .not. allocated(error)) error = &
         writer%store%file%failure
      if (allocated(error)) then
         call writer%suspend()
         return
      end if
      call writer%lock%allow_readers()
      writer%figures = figures
      writer%is_transient = .true.
      writer%has_checkpoint = .true.
   end subroutine reopen_result

   !> Takes the name of the result `path`, so that nobody else writes it until `give_back`. Error:
   !> somebody does; it cannot be the name of a result.
   subroutine hold_name(writer, path, error)
      type(result_writer_t), intent(out) :: writer
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      inquire (file=path//'.part', exist=writer%had_part)
      call take_name(writer, path, error)   ! error: handed up
   end subroutine hold_name

   !> Gives a held name back. Where `path` `is_complete` what a run left beside it goes, if it was
   !> killed before it could do so.
   subroutine give_back(writer, is_complete)
      type(result_writer_t), intent(inout) :: writer
      logical, intent(in) :: is_complete
      logical :: is_removed

      if (is_complete) call writer%remove_checkpoint()
      if (is_complete .or. .not. writer%had_part) is_removed = remove_file(writer%path//'.part')
      call forget_last_words()
      call writer%lock%release()
   end subroutine give_back

   !> What is said of a run that ends here; `step`: of the last checkpoint.
   function interruption_text(self, step) result(text)
      class(result_writer_t), intent(in) :: self
      integer, intent(in) :: step
      character(:), allocatable :: text

      if (self%has_checkpoint) then
         text = 'interrupted; --resume goes on after step '//to_text(step)//' with '//self%path &
            //'.ckpt'
      else
         text = 'interrupted without a checkpoint, nothing is kept of '//self%path
      end if
   end function interruption_text

   !> Lays down this text, and which files go with it.
   subroutine expect_interruption(self, step)
      class(result_writer_t), intent(inout) :: self
      integer, intent(in) :: step
      character(len=9), parameter :: endings(3) = [character(len=9) :: '.part', '.tmp', '.ckpt.tmp']
      character(len=len(self%path) + len(endings)) :: names(size(endings))
      integer :: first

      self%kept_step = step
      first = merge(2, 1, self%has_checkpoint)   ! a checkpoint needs NAME.part
      names = self%path//endings
      call lay_down_last_words(program_name//': '//self%interruption_text(step), names(first:))
   end subroutine expect_interruption

   !> Makes sure that `path` can be the name of a result, and that nobody else is writing it.
   subroutine take_name(writer, path, error)
      type(result_writer_t), intent(inout) :: writer
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      writer%path = path
      writer%fields = [character(len=field_name_length) :: 'pressure', 'film_thickness']
      allocate (writer%inputs(0))
      call ignore_file_size_signal()
      if (is_folder(path)) then
         call fail(error, output_error, 'cannot write '//path//': it is a folder')
      else if (.not. is_folder(folder_of(path))) then
         call fail(error, output_error, 'cannot write '//path//': there is no folder ' &
            //folder_of(path))
      else
         call refuse_links(path, error)
         if (allocated(error)) return
         if (.not. writer%lock%take(path//'.part')) call fail(error, output_error, 'cannot write ' &
            //path// &
            ': another run is writing '//path//'.part')
      end if
   end subroutine take_name

   !> Error: what is written beside the result would go through a link, or into a pipe or device.
   subroutine refuse_links(path, error)
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(file_identity_t) :: file
      integer :: i

      do i = 1, size(working_endings)
         associate (name => path//trim(working_endings(i)))
            file = look_at_file(name, follows=.false.)
            if (file%kind == kind_link) call fail(error, output_error, 'cannot write '//path//': ' &
               //name//' is a link')
            if (file%kind == kind_other) call fail(error, output_error, 'cannot write '//path &
               //': '//name//' is no regular file')
            if (allocated(error)) return
         end associate
      end do
   end subroutine refuse_links

   !> Program, problem and title (UTF-8), the text of the input; the reference values of a
   !> lubricated contact.
   subroutine describe(self, problem, title, namelist, scaling)
      class(result_writer_t), intent(inout) :: self
      character(*), intent(in) :: problem
      character(*), intent(in) :: title
      character(*), intent(in) :: namelist
      type(scaling_t), intent(in), optional :: scaling

      self%problem = problem
      self%title = title
      self%namelist = namelist
      self%is_scaled = present(scaling)
      if (present(scaling)) self%scaling = scaling
      if (self%is_transient) return
      call write_description(self)
      call self%file%flush()
   end subroutine describe

   !> Writes what `describe` took down.
   subroutine write_description(writer)
      class(result_writer_t), intent(inout) :: writer

      associate (file => writer%file)
         call write_attribute(file, '/', 'program', program_name)
         call write_attribute(file, '/', 'version', program_version)
         call write_attribute(file, '/', 'git_commit', git_commit())
         call write_attribute(file, '/', 'problem', writer%problem)
         call write_attribute(file, '/', 'title', writer%title)
         call write_dataset(file, '/input/namelist', writer%namelist, &
            new_label('the input: as a file it repeats this run', '1'))
         if (writer%is_scaled) call write_scaling(file, writer%scaling)
      end associate
   end subroutine write_description

   !> Cycles are not stored here: the report has their history.
   subroutine on_cycle(self, cycle, residual, load_error)
      class(result_writer_t), intent(inout) :: self
      integer, intent(in) :: cycle
      real(wp), intent(in) :: residual
      real(wp), intent(in) :: load_error

      associate (unused_cycle => cycle, unused_residual => residual, &
         unused_load_error => load_error)
      end associate
      self%wants_stop = allocated(self%file%failure)
   end subroutine on_cycle

   !> Appends a time step to /transient.
   subroutine on_step(self, step, steps, state, report)
      class(result_writer_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(line_summary_t) :: summary

      if (allocated(self%statistics%thresholds)) then
         if (step == 0) call add_start(self%statistics, state)
         if (step > 0 .and. self%figures%times%counts(state%time)) call add_time(self%statistics, &
            state)
      end if
      summary = summary_of(state)
      call self%figures%add(summary, state%time, step == steps)
      if (.not. self%is_transient) call start_store(self, [steps, steps/self%profile_stride] + 1, &
         size(state%x))
      if (.not. allocated(self%file%failure)) call self%store%append(state, summary, report, &
         mod(step, self%profile_stride) == 0)
      call self%keep_failure()
      if (self%store%records() == 1) call publish_store(self)
      self%wants_stop = allocated(self%file%failure)
   end subroutine on_step

   !> Makes room for `capacity` times and profiles of `nx` nodes in NAME.tmp; after that the HDF5
   !> library leaves that file alone.
   subroutine start_store(writer, capacity, nx)
      class(result_writer_t), intent(inout) :: writer
      integer, intent(in) :: capacity(2), nx
      type(error_t), allocatable :: error

      writer%is_transient = .true.
      call writer%file%close(error)   ! error: it stays in writer%file%failure
      if (allocated(writer%file%failure)) return
      call create_hdf5_file(writer%file, writer%path//'.tmp', error)   ! error: as above
      call write_description(writer)
      call create_store(writer%store, writer%file, writer%fields, capacity, nx, writer%scaling)
      call writer%file%close(error)   ! error: as above
      if (.not. allocated(writer%file%failure)) call writer%store%open(writer%path//'.tmp')
   end subroutine start_store

   !> NAME.tmp, with T = 0 in it, becomes NAME.part.
   subroutine publish_store(writer)
      class(result_writer_t), intent(inout) :: writer
      logical :: is_done

      if (allocated(writer%file%failure)) return
      is_done = writer%store_lock%take(writer%path//'.tmp')
      call writer%store_lock%allow_readers()
      if (is_done) is_done = rename_file(writer%path//'.tmp', writer%path//'.part')
      if (.not. is_done) call fail(writer%file%failure, output_error, 'cannot rename ' &
         //writer%path//'.tmp to '//writer%path &
         //'.part')
      writer%store%file%path = writer%path//'.part'
   end subroutine publish_store

   !> A failure of the store counts as one of the file.
   subroutine keep_failure(self)
      class(result_writer_t), intent(inout) :: self

      if (allocated(self%file%failure) .or. .not. allocated(self%store%file%failure)) return
      self%file%failure = self%store%file%failure
   end subroutine keep_failure

   !> What is stored in NAME.part.
   function stored_part(self) result(part)
      class(result_writer_t), intent(in) :: self
      type(part_t) :: part

      part = self%store%part()
   end function stored_part

   !> Whether something could not be written.
   pure function has_failed(self)
      class(result_writer_t), intent(in) :: self
      logical :: has_failed

      has_failed = allocated(self%file%failure)
   end function has_failed

   !> Whether the checkpoint holds all time steps: the result can then be put together again.
   pure function is_kept(self)
      class(result_writer_t), intent(in) :: self
      logical :: is_kept

      is_kept = self%has_checkpoint .and. self%kept_step == self%store%records() - 1
   end function is_kept

   !> Waits until NAME.part is on the disk; true if that worked.
   function sync(self) result(is_done)
      class(result_writer_t), intent(inout) :: self
      logical :: is_done

      call self%keep_failure()
      is_done = .not. allocated(self%file%failure)
      if (is_done) is_done = sync_file(self%path//'.part')
   end function sync

   !> Writes the solution at the last time, the figures and the report, closes the file and gives it
   !> its final name. On an error nothing is left but an older result (and NAME.part, if there is a
   !> checkpoint).
   subroutine finish(self, state, report, error)
      class(result_writer_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: missing

      call set_patience(.not. self%is_kept())
      call begin_activity('writing the result')
      self%summary = self%figures%extremes(summary_of(state))
      if (self%is_transient .and. .not. allocated(self%file%failure)) then
         call create_hdf5_file(self%file, self%path//'.tmp', error)   ! error: stays in the file
         call write_description(self)
         call self%store%copy_into(self%file, self%scaling)
         call self%keep_failure()
      end if
      if (report%converged) call apply_error_bars(self%bars, report, state%x(2) - state%x(1), &
         self%summary)
      call write_solution(self%file, state, self%scaling)
      missing = missing_estimate(self%bars, report)
      if (report%converged .and. .not. self%figures%times%is_settled()) missing = &
         'the start is in the figures, see /report/note'
      call write_summary(self%file, self%summary, self%scaling, self%is_transient, missing)
      if (self%is_transient) call write_times(self%file, self%figures%times)
      call write_statistics(self%file, self%statistics, self%scaling)
      call self%publish(report, error)
   end subroutine finish

   !> Writes input, report and outcome, closes the file and gives it its final name. Every result of
   !> every problem ends here: one with values that are no answer has not converged, whatever the
   !> solver says.
   subroutine publish(self, report, error)
      class(result_writer_t), intent(inout) :: self
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: reason
      integer :: i

      call set_patience(.not. self%is_kept())
      do i = 1, size(self%inputs)
         call write_input(self%file, self%inputs(i), self%scaling)
      end do
      if (report%converged .and. allocated(self%file%nonsense)) then
         report%converged = .false.
         report%reason = self%file%nonsense
      end if
      call write_report(self%file, report)
      if (self%is_scaled) call write_breakdown(self%file, report%breakdown, self%scaling)
      reason = ''
      if (allocated(report%reason)) reason = trim(report%reason)
      call write_attribute(self%file, '/', 'converged', merge(1, 0, report%converged))
      call write_attribute(self%file, '/', 'reason', reason)
      call self%file%close(error)
      if (.not. allocated(error)) call give_name(self, error)
      if (.not. allocated(error)) call self%remove_checkpoint()
      if (allocated(error) .or. self%is_transient) then
         call self%discard()
      else
         call forget_last_words()
         call self%lock%release()
      end if
   end subroutine publish

   !> Seals the complete file and gives it its name.
   subroutine give_name(writer, error)
      class(result_writer_t), intent(in) :: writer
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: temporary
      logical :: is_done

      temporary = writer%path//'.part'
      if (writer%is_transient) temporary = writer%path//'.tmp'
      call seal_file(temporary, error)
      if (allocated(error)) return
      is_done = .true.
      if (writer%has_checkpoint) is_done = sync_file(temporary)
      call set_patience(.true.)   ! the checkpoint goes
      if (is_done) is_done = rename_file(temporary, writer%path)
      if (.not. is_done) call fail(error, output_error, 'cannot rename '//temporary//' to ' &
         //writer%path)
   end subroutine give_name

   !> Closes NAME.part.
   subroutine suspend(self)
      class(result_writer_t), intent(inout) :: self

      call forget_last_words()
      call self%store%file%close()
      call self%store_lock%release()
      call self%lock%release()
   end subroutine suspend

   !> Closes the files whatever their state and removes them.
   subroutine discard(self)
      class(result_writer_t), intent(inout) :: self
      type(error_t), allocatable :: error
      logical :: is_removed

      call self%file%close(error)   ! error: the file is given up anyway
      call self%store%file%close()
      if (self%is_transient) is_removed = remove_file(self%path//'.tmp')
      if (.not. self%has_checkpoint) is_removed = remove_file(self%path//'.part')
      call forget_last_words()
      call self%store_lock%release()
      call self%lock%release()
   end subroutine discard

   !> Removes the checkpoint and what an interrupted run may have left of the next one, and of the
   !> result.
   subroutine remove_checkpoint(self)
      class(result_writer_t), intent(inout) :: self
      logical :: is_removed

      is_removed = remove_file(self%path//'.ckpt')
      is_removed = remove_file(self%path//'.ckpt.tmp')
      is_removed = remove_file(self%path//'.tmp')
      self%has_checkpoint = .false.
   end subroutine remove_checkpoint

end module result_writer

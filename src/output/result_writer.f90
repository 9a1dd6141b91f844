!> The result file of a case, from its first line to its final name.
!>
!> While the case runs everything goes to NAME.part in the same folder. A steady result is completed
!> there and renamed to NAME. The time steps of a transient are streamed into it, so that memory
!> does not grow with their number; at the end the result is put together in NAME.tmp,
!> which is then renamed. (NAME.part of a transient comes from NAME.tmp too, with T = 0 in it, so
!> that it never shows anything that is not there.) An interrupted or failed run leaves an older
!> NAME as it was.
module result_writer
   use adequacy, only: adequacy_t, judge
   use adequacy_section, only: write_adequacy
   use breakdown_text, only: write_breakdown
   use build_info, only: git_commit, program_name, program_version
   use case_record, only: effective_t
   use error_bars, only: apply_error_bars, error_bars_t, missing_estimate
   use decision_section, only: write_decision
   use errors, only: error_t, fail, input_error, output_error
   use film_fields, only: film_fields_t
   use film_heating, only: heating_t, largest_rise
   use film_passage, only: film_passage_t
   use film_statistics, only: add_start, add_time, film_statistics_t
   use formulas_section, only: formula_contact_t, write_formulas
   use hdf5_attribute, only: write_attribute
   use hdf5_axes, only: write_users
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: create_hdf5_file, hdf5_file_t
   use input_section, only: write_inputs
   use interruption, only: set_patience
   use iteration_report, only: report_t
   use kinds, only: wp
   use life_sign, only: begin_activity
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of, take_values
   use model_decision, only: model_choice_t
   use momentum_section, only: write_film_passage, write_momentum
   use operating_system, only: lock_t, remove_file, rename_file, sync_file
   use passage_extremes, only: passage_extremes_t
   use result_labels, only: field_names
   use result_name, only: hold_name, result_name_t
   use result_sections, only: write_report, write_scaling, write_solution, write_summary, &
      write_times
   use scaling, only: scaling_t
   use statistics_section, only: write_statistics
   use transient_store, only: attach_store, create_store, part_t, sliding_names, transient_store_t
   use validity, only: limit_t
   use validity_section, only: write_validity
   use velocity_section, only: write_velocity
   implicit none (type, external)
   private

   public :: open_result, reopen_result, result_writer_t

   !> Layout of result files: 2 = axes, `units` and the group /si (CHANGELOG.md); without the
   !> attribute: 1.
   integer, parameter :: layout = 3
   !> Longest name of a field or series.
   integer, parameter, public :: field_name_length = max(len(field_names), len(sliding_names))

   !> The file being written.
   type :: result_writer_t
      !> Its final name, and what lies beside it.
      type(result_name_t) :: name
      !> Every how many time steps profiles are stored; those at T = 0 always are.
      integer :: profile_stride = 1
      !> Fields and series are stored in SI too; they can be.
      logical :: has_si = .false.
      !> Profiles that are stored, names of `field_names`, and series that not every passage has.
      character(len=field_name_length), allocatable :: fields(:)
      !> Quantities of the time steps so far, and of all of them, or of a steady solution, when the
      !> result is finished.
      type(passage_extremes_t) :: passage
      type(line_summary_t) :: summary
      !> How warm sliding would make the film of a time step, if that is to be known.
      type(heating_t) :: heating
      !> Coarse runs that tell how far off the quantities may be.
      type(error_bars_t) :: bars
      !> How the solution stands to the limits of its model, if it is known.
      type(limit_t), allocatable :: limits(:)
      !> What film formulas know of the contact.
      type(formula_contact_t) :: formulas
      !> The film by its full momentum equations, and the solution of the Reynolds equation that
      !> they began with, of which the error bars are; not allocated: not asked for, or none.
      type(film_fields_t), allocatable :: momentum
      type(line_state_t), allocatable :: reynolds
      !> Of a transient, what they change over time; its result stays that of the Reynolds equation.
      type(film_passage_t), allocatable :: film_passage
      !> Velocity across the film (layers + 1, nx); not allocated: not asked for, or no film.
      real(wp), allocatable :: velocity(:, :)
      !> What the ingredients of the model change.
      type(adequacy_t) :: adequacy
      !> The model that the program has chosen, if it was to.
      type(model_choice_t) :: choice
      !> The film over all time steps, where that is asked for.
      type(film_statistics_t) :: statistics
      !> /input/effective, every value as it is used, default or not: stored as numbers if it has a
      !> unit ('-': a pure number) and reads as such, else as text.
      type(effective_t), allocatable :: inputs(:)
      !> The open file.
      type(hdf5_file_t) :: file
      character(:), allocatable, private :: problem, title, namelist
      type(scaling_t), private :: scaling
      !> The time steps in NAME.part.
      type(transient_store_t) :: store
      !> Lock on the NAME.part that comes from NAME.tmp.
      type(lock_t), private :: store_lock
      logical, private :: is_transient = .false., is_scaled = .false.
   contains
      !> Appends a time step to /transient.
      procedure :: store_step
      !> Writes what is known before the run.
      procedure :: describe
      !> Brings NAME.part to the disk as far as it is written.
      procedure :: sync
      !> Whether something could not be written.
      procedure :: has_failed
      !> The quantities of the run, with what is known of their errors.
      procedure :: quantities_at_end
      !> Writes solution, summary and report, closes, and gives the file its name.
      procedure :: finish
      !> Writes input and report, closes, and gives the file its name.
      procedure :: publish
      !> Closes NAME.part and leaves it for a later run to go on with.
      procedure :: suspend
      !> Gives the file up; nothing of it stays, but NAME.part if there is a checkpoint.
      procedure :: discard
      procedure, private :: keep_failure
   end type result_writer_t

contains

   !> Starts the result `path` under its temporary name; `error` says why that cannot be. A
   !> checkpoint of an earlier run is removed.
   subroutine open_result(writer, path, error)
      type(result_writer_t), intent(out) :: writer
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error

      call hold_name(writer%name, path, error)
      if (allocated(error)) return
      call writer%name%expect_interruption(0)
      call writer%name%remove_checkpoint()
      writer%fields = [character(len=field_name_length) :: 'pressure', 'film_thickness']
      allocate (writer%inputs(0))
      call create_hdf5_file(writer%file, path//'.part', error)
      if (allocated(error)) call writer%name%give_back(is_complete=.false.)
   end subroutine open_result

   !> Goes on with the result `path` of an interrupted run, with what was stored of it (`part`,
   !> profiles of `nx` nodes) and its extremes so far. Error: NAME.part is not what the checkpoint
   !> says.
   subroutine reopen_result(writer, path, fields, part, nx, passage, error)
      type(result_writer_t), intent(out) :: writer
      character(*), intent(in) :: path, fields(:)
      type(part_t), intent(in) :: part
      integer, intent(in) :: nx
      type(passage_extremes_t), intent(in) :: passage
      type(error_t), allocatable, intent(out) :: error

      call hold_name(writer%name, path, error)
      if (allocated(error)) return
      if (.not. writer%name%had_part) then
         call fail(error, input_error, path//'.part is missing')
         call writer%name%give_back(is_complete=.false.)
         return
      end if
      allocate (writer%inputs(0))
      writer%fields = [character(len=field_name_length) :: fields]
      call attach_store(writer%store, path//'.part', fields, nx, part, error)
      if (allocated(writer%store%file%failure) .and. .not. allocated(error)) error = &
         writer%store%file%failure
      if (allocated(error)) then
         call writer%suspend()
         return
      end if
      call writer%name%lock%allow_readers()
      writer%passage = passage
      writer%is_transient = .true.
      writer%name%has_checkpoint = .true.
   end subroutine reopen_result

   !> Writes program, problem and title (UTF-8), the text of the input; the reference values of a
   !> lubricated contact. The same is written again at the head of NAME.tmp.
   subroutine describe(self, problem, title, namelist, scaling)
      class(result_writer_t), intent(inout) :: self
      character(*), intent(in) :: problem, title, namelist
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

   !> Writes what `describe` was given.
   subroutine write_description(writer)
      class(result_writer_t), intent(inout) :: writer

      associate (file => writer%file)
         call write_attribute(file, '/', 'program', program_name)
         call write_attribute(file, '/', 'version', program_version)
         call write_attribute(file, '/', 'git_commit', git_commit())
         call write_attribute(file, '/', 'layout', layout)
         call write_attribute(file, '/', 'problem', writer%problem)
         call write_attribute(file, '/', 'title', writer%title)
         call write_dataset(file, '/input/namelist', writer%namelist, &
            new_label('the input: as a file it repeats this run', '1'))
         if (writer%is_scaled) call write_scaling(file, writer%scaling)
      end associate
   end subroutine write_description

   !> Appends a time step to /transient.
   subroutine store_step(self, step, steps, state, report)
      class(result_writer_t), intent(inout) :: self
      integer, intent(in) :: step, steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(line_summary_t) :: summary

      if (allocated(self%statistics%thresholds)) then
         if (step == 0) call add_start(self%statistics, state)
         if (step > 0 .and. state%time >= self%passage%times%statistics_from()) call &
            add_time(self%statistics, state)
      end if
      summary = summary_of(state)
      if (self%heating%is_known .and. allocated(state%shear_stress_mean)) then
         summary%limits%film_heating = largest_rise(self%heating, state%x(2) - state%x(1), &
            state%shear_stress_mean, state%film_thickness)
      end if
      call self%passage%add(summary, state%time, step == steps)
      if (.not. self%is_transient) call start_store(self, [steps, steps/self%profile_stride] + 1, &
         size(state%x))
      if (.not. allocated(self%file%failure)) call self%store%append(state, summary, report, &
         mod(step, self%profile_stride) == 0)
      call self%keep_failure()
      if (self%store%records() == 1) call publish_store(self)
   end subroutine store_step

   !> Makes room for `capacity` times and profiles of `nx` nodes in NAME.tmp; after that the HDF5
   !> library leaves that file alone.
   subroutine start_store(writer, capacity, nx)
      class(result_writer_t), intent(inout) :: writer
      integer, intent(in) :: capacity(2), nx
      type(error_t), allocatable :: error

      writer%is_transient = .true.
      call writer%file%close(error)   ! error: it stays in writer%file%failure
      if (allocated(writer%file%failure)) return
      call create_hdf5_file(writer%file, writer%name%path//'.tmp', error)   ! error: as above
      call write_description(writer)
      call create_store(writer%store, writer%file, writer%fields, capacity, nx, writer%scaling)
      call writer%file%close(error)   ! error: as above
      if (.not. allocated(writer%file%failure)) call writer%store%open(writer%name%path//'.tmp')
   end subroutine start_store

   !> NAME.tmp, with T = 0 in it, becomes NAME.part.
   subroutine publish_store(writer)
      class(result_writer_t), intent(inout) :: writer
      logical :: is_done

      if (allocated(writer%file%failure)) return
      is_done = writer%store_lock%take(writer%name%path//'.tmp')
      call writer%store_lock%allow_readers()
      if (is_done) is_done = rename_file(writer%name%path//'.tmp', writer%name%path//'.part')
      if (.not. is_done) call fail(writer%file%failure, output_error, 'cannot rename ' &
         //writer%name%path//'.tmp to '//writer%name%path &
         //'.part')
      writer%store%file%path = writer%name%path//'.part'
   end subroutine publish_store

   !> A failure of the store counts as one of the file.
   subroutine keep_failure(self)
      class(result_writer_t), intent(inout) :: self

      if (allocated(self%file%failure) .or. .not. allocated(self%store%file%failure)) return
      self%file%failure = self%store%file%failure
   end subroutine keep_failure

   !> Whether something could not be written.
   pure function has_failed(self)
      class(result_writer_t), intent(in) :: self
      logical :: has_failed

      has_failed = allocated(self%file%failure)
   end function has_failed

   !> Waits until NAME.part is on the disk; true if that worked.
   function sync(self) result(is_done)
      class(result_writer_t), intent(inout) :: self
      logical :: is_done

      call self%keep_failure()
      is_done = .not. allocated(self%file%failure)
      if (is_done) is_done = sync_file(self%name%path//'.part')
   end function sync

   !> The quantities of a run that has ended with `state`, of a transient extremes; with error bars
   !> if it has converged.
   pure function quantities_at_end(self, state, report) result(summary)
      class(result_writer_t), intent(in) :: self
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(line_summary_t) :: summary

      summary = self%passage%extremes(summary_of(state))
      if (report%converged) call apply_error_bars(self%bars, report, state%x(2) - state%x(1), &
         summary)
   end function quantities_at_end

   !> Writes the solution at the last time, the quantities and the report, closes the file and
   !> gives it its final name. On an error nothing is left but an older result (and NAME.part, if
   !> there is a checkpoint).
   subroutine finish(self, state, report, error)
      class(result_writer_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: missing

      ! with all time steps in the checkpoint the result can be put together again
      call set_patience(.not. (self%name%has_checkpoint &
         .and. self%name%kept_step == self%store%records() - 1))
      call begin_activity('writing the result')
      if (self%is_transient .and. .not. allocated(self%file%failure)) then
         call create_hdf5_file(self%file, self%name%path//'.tmp', &
            error)   ! error: stays in the file
         call write_description(self)
      end if
      call write_solution(self%file, state, self%scaling, self%has_si)
      if (self%is_transient .and. .not. allocated(self%file%failure)) then
         call self%store%copy_into(self%file, self%scaling, self%has_si)
         call self%keep_failure()
      end if
      if (allocated(self%reynolds)) then
         self%summary = self%quantities_at_end(self%reynolds, report)
         call take_values(self%summary, summary_of(state))
      else
         self%summary = self%quantities_at_end(state, report)
      end if
      missing = missing_estimate(self%bars, report, state%x(2) - state%x(1), self%summary)
      if (report%converged .and. .not. self%passage%times%is_settled()) missing = &
         'the start is in the quantities, see /report/note'
      call write_summary(self%file, self%summary, self%scaling, self%is_transient, missing)
      if (self%is_transient) call write_times(self%file, self%passage%times)
      call write_statistics(self%file, self%statistics, self%scaling, &
         self%passage%times%statistics_from())
      if (allocated(self%limits)) call write_validity(self%file, self%limits)
      call write_formulas(self%file, self%formulas, self%summary, self%scaling)
      if (allocated(self%momentum)) then
         call write_momentum(self%file, self%momentum, self%scaling, self%is_transient, &
            self%has_si)
         if (self%is_transient) call write_film_passage(self%file, self%film_passage, &
            self%scaling, self%has_si)
      end if
      if (allocated(self%velocity)) call write_velocity(self%file, self%velocity, self%scaling)
      call judge(self%adequacy, self%summary)
      call write_adequacy(self%file, self%adequacy)
      call write_decision(self%file, self%choice)
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

      call write_inputs(self%file, self%inputs)
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
      call write_users(self%file)
      call self%file%close(error)
      if (.not. allocated(error)) call self%name%give_to(self%name%path &
         //trim(merge('.tmp ', '.part', self%is_transient)), error)
      if (allocated(error) .or. self%is_transient) then
         call self%discard()
      else
         call self%name%release()
      end if
   end subroutine publish

   !> Closes NAME.part and lets others write it.
   subroutine suspend(self)
      class(result_writer_t), intent(inout) :: self

      call self%store%file%close()
      call self%store_lock%release()
      call self%name%release()
   end subroutine suspend

   !> Closes the files whatever their state and removes them.
   subroutine discard(self)
      class(result_writer_t), intent(inout) :: self
      type(error_t), allocatable :: error
      logical :: is_removed

      call self%file%close(error)   ! error: the file is given up anyway
      call self%store%file%close()
      if (self%is_transient) is_removed = remove_file(self%name%path//'.tmp')
      if (.not. self%name%has_checkpoint) is_removed = remove_file(self%name%path//'.part')
      call self%suspend()
   end subroutine discard

end module result_writer

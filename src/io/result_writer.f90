!> The result file of a case, from its first line to its final name.
!>
!> Everything goes to NAME.part in the same folder, which is renamed to NAME when it is complete: an interrupted or failed
!> run leaves an older NAME as it was. Time steps are streamed, so that memory does not grow with their number.
module result_writer
   use, intrinsic :: iso_fortran_env, only: int64
   use build_info, only: git_commit, program_name, program_version
   use errors, only: error_t, fail, output_error
   use hdf5_attribute, only: write_attribute
   use hdf5_dataset, only: label_t, new_label, write_dataset
   use hdf5_file, only: create_hdf5_file, hdf5_file_t
   use hdf5_series, only: create_series, series_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use error_bars, only: apply_error_bars, error_bars_t
   use line_summary, only: keep_extremes, line_summary_t, summary_of
   use observer, only: observer_t
   use operating_system, only: ignore_file_size_signal, is_folder, is_locked, remove_file, rename_file
   use result_labels, only: field_label, field_names, field_values, quantity_label
   use result_sections, only: write_report, write_scaling, write_solution, write_summary
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: open_result, result_writer_t

   !> Longest name of a field.
   integer, parameter, public :: field_name_length = len(field_names)

   !> The file being written. As an observer it stores time steps; `wants_stop` is set when that failed.
   type, extends(observer_t) :: result_writer_t
      !> Final name.
      character(:), allocatable :: path
      !> Every how many time steps one is stored; T = 0 always is.
      integer :: profile_stride = 1
      !> Fields stored of each time step, names of `field_names`.
      character(len=field_name_length), allocatable :: fields(:)
      !> Figures of the stored times, or of the solution if there are none.
      type(line_summary_t) :: summary
      !> Companions that tell how far off the figures may be.
      type(error_bars_t) :: bars
      !> The open file.
      type(hdf5_file_t) :: file
      type(scaling_t), private :: scaling
      type(series_t), allocatable, private :: profiles(:)
      type(series_t), private :: time, rigid_displacement, h_min, p_max, residual
      logical, private :: is_transient = .false.
   contains
      procedure :: on_cycle
      procedure :: on_step
      !> Writes what is known before the run.
      procedure :: describe
      !> Writes one input value as it is used, default or not.
      procedure :: add_input
      !> Writes solution, summary and report, closes, and gives the file its name.
      procedure :: finish
      !> Says whether and why the run ended, closes, and gives the file its name.
      procedure :: publish
      !> Gives the file up; nothing of it stays.
      procedure :: discard
   end type result_writer_t

contains

   !> Starts the result `path` under its temporary name; `error` says why that cannot be.
   subroutine open_result(writer, path, error)
      type(result_writer_t), intent(out) :: writer
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      logical :: has_leftover, is_removed

      writer%path = path
      writer%fields = [character(len=field_name_length) :: 'pressure', 'film_thickness']
      call ignore_file_size_signal()
      if (is_folder(path)) then
         call fail(error, output_error, 'cannot write '//path//': it is a folder')
         return
      end if
      if (.not. is_folder(folder_of(path))) then
         call fail(error, output_error, 'cannot write '//path//': there is no folder '//folder_of(path))
         return
      end if
      if (is_locked(path//'.part')) then
         call fail(error, output_error, 'cannot write '//path//': another run is writing '//path//'.part')
         return
      end if
      inquire (file=path//'.part', exist=has_leftover)
      call create_hdf5_file(writer%file, path//'.part', error)
      if (allocated(error) .and. .not. has_leftover) is_removed = remove_file(path//'.part')
   end subroutine open_result

   !> Program, problem and title (UTF-8), the text of the input; the reference values of a lubricated contact.
   subroutine describe(self, problem, title, namelist, scaling)
      class(result_writer_t), intent(inout) :: self
      character(*), intent(in) :: problem
      character(*), intent(in) :: title
      character(*), intent(in) :: namelist
      type(scaling_t), intent(in), optional :: scaling

      call write_attribute(self%file, '/', 'program', program_name)
      call write_attribute(self%file, '/', 'version', program_version)
      call write_attribute(self%file, '/', 'git_commit', git_commit())
      call write_attribute(self%file, '/', 'problem', problem)
      call write_attribute(self%file, '/', 'title', title)
      call write_dataset(self%file, '/input/namelist', namelist, new_label('the input: as a file it repeats this run', '1'))
      if (.not. present(scaling)) return
      self%scaling = scaling
      call write_scaling(self%file, scaling)
   end subroutine describe

   !> /input/effective/<group>/<key>: `value` as in a namelist, several separated by commas; stored as numbers if it has a
   !> unit ('-': a pure number) and reads as such, else as text.
   subroutine add_input(self, group, key, value, unit)
      class(result_writer_t), intent(inout) :: self
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(*), intent(in) :: value
      character(*), intent(in) :: unit
      character(:), allocatable :: path
      real(wp), allocatable :: numbers(:)
      type(label_t) :: label

      path = '/input/effective/'//group//'/'//key
      label = new_label('&'//group//' '//key, '1')
      if (unit == 'half-widths') then
         label = quantity_label('&'//group//' '//key//', in half-widths', 'm', self%scaling%half_width, self%scaling)
      else if (unit /= '' .and. unit /= '-') then
         label%si_units = unit
      end if
      numbers = numbers_of(value)
      if (unit == '' .or. size(numbers) == 0) then
         call write_dataset(self%file, path, value, label)
      else if (size(numbers) > 1) then
         call write_dataset(self%file, path, numbers, label)
      else if (scan(value, '.eEdD') == 0) then
         call write_dataset(self%file, path, nint(numbers(1), int64), label)
      else
         call write_dataset(self%file, path, numbers(1), label)
      end if
   end subroutine add_input

   !> The numbers in a list separated by commas; none if one of them is not a number.
   pure function numbers_of(list) result(numbers)
      character(*), intent(in) :: list
      real(wp), allocatable :: numbers(:)
      integer :: i, status

      allocate (numbers(1 + count([(list(i:i) == ',', i=1, len(list))])))
      read (list, *, iostat=status) numbers
      if (status /= 0) numbers = [real(wp) ::]
   end function numbers_of

   !> Cycles are not stored here: the report has their history.
   subroutine on_cycle(self, cycle, residual, load_error)
      class(result_writer_t), intent(inout) :: self
      integer, intent(in) :: cycle
      real(wp), intent(in) :: residual
      real(wp), intent(in) :: load_error

      associate (unused_cycle => cycle, unused_residual => residual, unused_load_error => load_error)
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
      integer :: i

      associate (unused_steps => steps)
      end associate
      if (mod(step, self%profile_stride) /= 0) return
      summary = summary_of(state)
      if (.not. self%is_transient) then
         call start_series(self, state)
         self%summary = summary
      else
         call keep_extremes(self%summary, summary)
      end if
      call self%time%append(self%file, state%time)
      call self%rigid_displacement%append(self%file, state%rigid_displacement)
      call self%h_min%append(self%file, summary%h_min%value)
      call self%p_max%append(self%file, summary%p_max%value)
      call self%residual%append(self%file, report%residual)
      do i = 1, size(self%fields)
         call self%profiles(i)%append(self%file, field_values(trim(self%fields(i)), state))
      end do
      self%wants_stop = allocated(self%file%failure)
   end subroutine on_step

   !> Makes the empty series of /transient.
   subroutine start_series(writer, state)
      class(result_writer_t), intent(inout) :: writer
      type(line_state_t), intent(in) :: state
      integer :: i

      writer%is_transient = .true.
      associate (file => writer%file, scaling => writer%scaling)
         call create_series(writer%time, file, '/transient/time', 0, &
                            quantity_label('time, T = t u_s/(2 b)', 's', scaling%time, scaling))
         call create_series(writer%rigid_displacement, file, '/transient/rigid_displacement', 0, &
                            quantity_label('rigid displacement H0 of (2.58)', 'm', scaling%film, scaling))
         call create_series(writer%h_min, file, '/transient/h_min', 0, &
                            quantity_label('smallest film thickness, parabola through three nodes', 'm', scaling%film, scaling))
         call create_series(writer%p_max, file, '/transient/p_max', 0, &
                            quantity_label('largest pressure of a node', 'Pa', scaling%hertz_pressure, scaling))
         call create_series(writer%residual, file, '/transient/residual', 0, new_label('residual reached in the step', '1'))
         allocate (writer%profiles(size(writer%fields)))
         do i = 1, size(writer%fields)
            call create_series(writer%profiles(i), file, '/transient/'//trim(writer%fields(i)), size(state%x), &
                               field_label(trim(writer%fields(i)), scaling))
         end do
      end associate
   end subroutine start_series

   !> Writes the solution at the last time and the report, closes the file and gives it its final name. On an error nothing
   !> is left but an older result.
   subroutine finish(self, state, report, error)
      class(result_writer_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      type(error_t), allocatable, intent(out) :: error

      if (.not. self%is_transient) self%summary = summary_of(state)
      if (report%converged) call apply_error_bars(self%bars, state%x(2) - state%x(1), self%summary)
      call write_solution(self%file, state, self%scaling)
      call write_summary(self%file, self%summary, self%scaling, self%is_transient)
      call self%publish(report, error)
   end subroutine finish

   !> Writes the report and its outcome, closes the file and gives it its final name. On an error nothing is left but an older
   !> result.
   subroutine publish(self, report, error)
      class(result_writer_t), intent(inout) :: self
      type(report_t), intent(in) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: reason

      call write_report(self%file, report)
      reason = ''
      if (allocated(report%reason)) reason = trim(report%reason)
      call write_attribute(self%file, '/', 'converged', merge(1, 0, report%converged))
      call write_attribute(self%file, '/', 'reason', reason)
      call self%file%close(error)
      if (.not. allocated(error)) then
         if (.not. rename_file(self%path//'.part', self%path)) then
            call fail(error, output_error, 'cannot rename '//self%path//'.part to '//self%path)
         end if
      end if
      if (allocated(error)) call self%discard()
   end subroutine publish

   !> Gives the file up: closes it whatever its state and removes it.
   subroutine discard(self)
      class(result_writer_t), intent(inout) :: self
      type(error_t), allocatable :: error
      logical :: is_removed

      call self%file%close(error)   ! error: the file is given up anyway
      is_removed = remove_file(self%path//'.part')
   end subroutine discard

   !> The folder part of a path; '.' if it has none.
   pure function folder_of(path) result(folder)
      character(*), intent(in) :: path
      character(:), allocatable :: folder
      integer :: slash

      slash = index(path, '/', back=.true.)
      folder = '.'
      if (slash == 1) folder = '/'
      if (slash > 1) folder = path(:slash - 1)
   end function folder_of

end module result_writer

!> Checkpoint of a transient, NAME.ckpt beside NAME.part: where the run stood after a time step.
!>
!> It is written under another name, brought to the disk and renamed, so that there is always the
!> last complete one, whenever the run is killed. It ends with a seal over all its bytes (see
!> `file_seal`), and holds the checksums of NAME.part: what is damaged is refused before anything is
!> read.
module checkpoint
   use, intrinsic :: iso_fortran_env, only: int64
   use build_info, only: git_commit, program_name, program_version
   use error_bars, only: error_bars_t
   use errors, only: error_t, fail, input_error, output_error
   use file_seal, only: has_seal, is_whole, seal_file
   use film_statistics, only: film_statistics_t, from_numbers, numbers_of
   use hdf5_attribute, only: write_attribute
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: create_hdf5_file, hdf5_file_t
   use hdf5_input, only: hdf5_input_t, open_hdf5_input
   use iteration_report, only: breakdown_t, phase_count, report_t
   use kinds, only: wp
   use line_summary, only: crests_t, figure_t, line_summary_t
   use march_state, only: march_state_t
   use operating_system, only: remove_file, rename_file, sync_file, sync_folder
   use passage_figures, only: passage_figures_t
   use solver_settings, only: word_length
   use split_errors, only: forecast_figures, forecast_t
   use transient_store, only: part_t
   implicit none (type, external)
   private

   public :: checkpoint_t, read_checkpoint, write_checkpoint

   !> Grows with every change of what a checkpoint holds.
   integer, parameter :: format_number = 10
   !> What to do about a checkpoint that cannot be used.
   character(*), parameter :: way_out = '; delete it, and the run starts at the beginning'

   !> What a checkpoint holds.
   type :: checkpoint_t
      !> The values of the case that decide about its result, a line each.
      character(:), allocatable :: case
      type(march_state_t) :: march
      !> Extremes over the time steps so far.
      type(passage_figures_t) :: figures
      !> Companions on coarser grids, which need not be run again.
      type(error_bars_t) :: bars
      !> The film over all time steps, where that is asked for.
      type(film_statistics_t) :: statistics
      !> What is stored in NAME.part.
      type(part_t) :: part
      !> Intervals, time step and space scheme, given or chosen.
      integer :: intervals = 0
      real(wp) :: time_step = 0.0_wp
      character(len=word_length) :: space_scheme = 'auto'
   end type checkpoint_t

contains

   !> Writes a checkpoint to `path`. Error: it cannot be written; an older one is still there.
   subroutine write_checkpoint(checkpoint, path, error)
      type(checkpoint_t), intent(in) :: checkpoint
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_file_t) :: file
      logical :: is_done

      call create_hdf5_file(file, path//'.tmp', error)
      if (allocated(error)) return
      file%has_checksums = .true.
      call write_attribute(file, '/', 'program', program_name)
      call write_attribute(file, '/', 'version', program_version)
      call write_attribute(file, '/', 'git_commit', git_commit())
      call write_attribute(file, '/', 'checkpoint_format', format_number)
      call write_dataset(file, '/case', checkpoint%case, new_label('the values of the case', '1'))
      call write_part(file, checkpoint%part)
      call write_figures(file, checkpoint%figures)
      call write_dataset(file, '/intervals', int(checkpoint%intervals, int64), &
         new_label('intervals', '1'))
      call write_dataset(file, '/time_step', checkpoint%time_step, new_label('time step; 0: dX', &
         '1'))
      call write_dataset(file, '/space_scheme', trim(checkpoint%space_scheme), &
         new_label('space scheme', '1'))
      call write_bars(file, checkpoint%bars)
      call write_dataset(file, '/statistics', numbers_of(checkpoint%statistics), &
         new_label('sums over time', '1'))
      call write_march(file, checkpoint%march)
      call write_report_so_far(file, checkpoint%march%report)
      call file%close(error)
      if (.not. allocated(error)) call seal_file(path//'.tmp', error)
      if (.not. allocated(error)) then
         is_done = sync_file(path//'.tmp')
         if (is_done) is_done = rename_file(path//'.tmp', path)
         if (.not. is_done) call fail(error, output_error, 'cannot write '//path)
         call sync_folder(path)
      end if
      if (allocated(error)) is_done = remove_file(path//'.tmp')
   end subroutine write_checkpoint

   !> Extremes over the times that count, and over those to compare with.
   subroutine write_figures(file, figures)
      type(hdf5_file_t), intent(inout) :: file
      type(passage_figures_t), intent(in) :: figures
      character(*), parameter :: words = 'h_min, h_min_node, h_central, p_max, x_cavitation: '// &
         'value, time, error, extrapolated'

      call write_dataset(file, '/figures/known', [real(wp) :: merge(1, 0, figures%has_counted), &
         merge(1, 0, figures%has_earlier)], new_label('whether there are figures that count, '// &
            'and earlier ones', '1'))
      if (figures%has_counted) call write_dataset(file, '/figures/counted', &
         summary_numbers(figures%counted), new_label(words, '1'))
      if (figures%has_earlier) call write_dataset(file, '/figures/earlier', &
         summary_numbers(figures%earlier), new_label(words, '1'))
   end subroutine write_figures

   !> The same; the times that count follow from the case.
   subroutine read_figures(reader, figures)
      type(hdf5_input_t), intent(inout) :: reader
      type(passage_figures_t), intent(out) :: figures
      real(wp) :: known(2)

      known = reshape(reader%reals('/figures/known'), [2], pad=[0.0_wp])
      figures%has_counted = known(1) > 0.0_wp
      figures%has_earlier = known(2) > 0.0_wp
      if (figures%has_counted) figures%counted = summary_from(reader%reals('/figures/counted'))
      if (figures%has_earlier) figures%earlier = summary_from(reader%reals('/figures/earlier'))
   end subroutine read_figures

   !> The companions on n/2 and n/4 intervals.
   subroutine write_bars(file, bars)
      type(hdf5_file_t), intent(inout) :: file
      type(error_bars_t), intent(in) :: bars

      call write_dataset(file, '/companions/known', [real(wp) :: merge(1, 0, bars%has_half), &
         merge(1, 0, bars%has_quarter), &
         merge(1, 0, bars%forecast%is_known)], new_label('whether there are figures on n/2, '// &
            'on n/4 intervals, a forecast', '1'))
      call write_dataset(file, '/companions/traits', &
         [real(wp) :: merge(1, 0, bars%is_first_order), bars%starving], &
         new_label('is of first order in time, starving', '1'))
      associate (f => bars%forecast)
         if (f%is_known) call write_dataset(file, '/companions/forecast', &
            [f%pilot, f%pilot_error, f%error, f%shift], &
            new_label('figures of a pilot, their errors; errors of the run, what leads to the '// &
               'limits', '1'))
      end associate
      if (bars%has_half) call write_dataset(file, '/companions/half', summary_numbers(bars%half), &
         new_label('as summary', '1'))
      if (bars%has_quarter) call write_dataset(file, '/companions/quarter', &
         summary_numbers(bars%quarter), &
         new_label('as summary', '1'))
   end subroutine write_bars

   !> The companions on n/2 and n/4 intervals.
   subroutine read_bars(reader, bars)
      type(hdf5_input_t), intent(inout) :: reader
      type(error_bars_t), intent(out) :: bars
      real(wp) :: triple(3), traits(2), forecast(forecast_figures, 4)

      triple = reshape(reader%reals('/companions/known'), [3], pad=[0.0_wp])
      bars%has_half = triple(1) > 0.0_wp
      bars%has_quarter = triple(2) > 0.0_wp
      bars%forecast%is_known = triple(3) > 0.0_wp
      traits = reshape(reader%reals('/companions/traits'), [2], pad=[0.0_wp])
      bars%is_first_order = traits(1) > 0.0_wp
      bars%starving = traits(2)
      if (bars%forecast%is_known) then
         forecast = reshape(reader%reals('/companions/forecast'), shape(forecast), pad=[0.0_wp])
         bars%forecast = forecast_t(.true., forecast(:, 1), forecast(:, 2), forecast(:, 3), &
            forecast(:, 4))
      end if
      if (bars%has_half) bars%half = summary_from(reader%reals('/companions/half'))
      if (bars%has_quarter) bars%quarter = summary_from(reader%reals('/companions/quarter'))
   end subroutine read_bars

   !> The last solutions.
   subroutine write_march(file, march)
      type(hdf5_file_t), intent(inout) :: file
      type(march_state_t), intent(in) :: march

      call write_dataset(file, '/march/step', int(march%step, int64), &
         new_label('time steps done', '1'))
      call write_dataset(file, '/march/size', int(march%size, int64), new_label('solutions kept', &
         '1'))
      call write_dataset(file, '/march/pressure', march%pressure, &
         new_label('P of the last solutions, newest first', '1'))
      call write_dataset(file, '/march/rigid_displacement', march%rigid_displacement, &
         new_label('H0 of the same', '1'))
      call write_dataset(file, '/march/lengths', march%lengths, new_label('time between them', '1'))
      call write_dataset(file, '/march/way', int(march%way, int64), &
         new_label('way of solution of the newest', '1'))
      call write_dataset(file, '/march/mass', march%mass, new_label('rho H of the last two', '1'))
      call write_dataset(file, '/march/film', march%film, new_label('H of the newest', '1'))
   end subroutine write_march

   !> The report up to here.
   subroutine write_report_so_far(file, report)
      type(hdf5_file_t), intent(inout) :: file
      type(report_t), intent(in) :: report

      call write_dataset(file, '/report/method', report%method, new_label('method of solution', &
         '1'))
      call write_dataset(file, '/report/residual_history', report%residual_history(), &
         new_label('after each cycle', '1'))
      call write_dataset(file, '/report/load_error_history', report%load_error_history(), &
         new_label('after each cycle', '1'))
      associate (b => report%breakdown)
         call write_dataset(file, '/report/breakdown', [real(wp) :: b%count, b%step, b%time, &
            b%position, b%film, &
            b%smallest_film], new_label('films below the floor: how often; step, time, place '// &
               'and film of the first; smallest', '1'))
      end associate
      call write_dataset(file, '/report/outlet_pressure', report%outlet_pressure, &
         new_label('largest P before the outlet', '1'))
      call write_dataset(file, '/report/tolerance_effective', report%tolerance_effective, &
         new_label('bound', '1'))
      call write_dataset(file, '/report/uncut_steps', int(report%uncut_steps, int64), &
         new_label('steps taken whole', '1'))
      call write_dataset(file, '/report/work_units', report%work_units, &
         new_label('sweeps of the finest level', '1'))
      call write_dataset(file, '/report/fft_pairs', report%fft_pairs, &
         new_label('pairs of transforms', '1'))
      call write_dataset(file, '/report/wall_seconds', report%wall_seconds, &
         new_label('wall time so far', 's'))
      call write_dataset(file, '/report/phase_seconds', report%phase_seconds, &
         new_label('wall time by phase', 's'))
   end subroutine write_report_so_far

   !> The series in NAME.part.
   subroutine write_part(file, part)
      type(hdf5_file_t), intent(inout) :: file
      type(part_t), intent(in) :: part

      call write_dataset(file, '/part/records', int(part%records, int64), &
         new_label('stored time steps and profiles', '1'))
      call write_dataset(file, '/part/places', [part%places], &
         new_label('places of numbers and of their count, each series', 'B'))
      call write_dataset(file, '/part/checksums', part%digits, &
         new_label('checksums of the series', '1'))
   end subroutine write_part

   !> The series in NAME.part.
   subroutine read_part(reader, part)
      type(hdf5_input_t), intent(inout) :: reader
      type(part_t), intent(out) :: part
      real(wp), allocatable :: places(:)

      part%records = int(reshape(reader%reals('/part/records'), [2], pad=[0.0_wp]))
      places = reader%reals('/part/places')
      part%places = reshape(int(places, int64), [2, size(places)/2])
      part%digits = reader%text('/part/checksums')
   end subroutine read_part

   !> Reads the checkpoint `path` for the case `case`. Error: it is damaged, of another version or
   !> of another case.
   subroutine read_checkpoint(path, case, checkpoint, error)
      character(*), intent(in) :: path
      character(*), intent(in) :: case
      type(checkpoint_t), intent(out) :: checkpoint
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      character(:), allocatable :: difference

      if (.not. is_whole(path)) then
         difference = 'it has no checksum: it is damaged, or of another version'
         if (has_seal(path)) difference = 'it is damaged: its checksum differs'
         call fail(error, input_error, 'cannot read '//path//': '//difference//way_out)
         return
      end if
      call open_hdf5_input(reader, path, error)
      if (allocated(error)) return
      difference = other_version(reader)
      if (difference == '' .and. .not. allocated(reader%failure)) then
         checkpoint%case = reader%text('/case')
         difference = first_difference(checkpoint%case, case)
      end if
      if (difference == '' .and. .not. allocated(reader%failure)) then
         call read_part(reader, checkpoint%part)
         call read_figures(reader, checkpoint%figures)
         checkpoint%intervals = int(reader%integer_value('/intervals'))
         checkpoint%time_step = reader%real_value('/time_step')
         checkpoint%space_scheme = reader%text('/space_scheme')
         call read_bars(reader, checkpoint%bars)
         checkpoint%statistics = from_numbers(reader%reals('/statistics'))
         call read_march(reader, checkpoint%march)
         call read_report_so_far(reader, checkpoint%march%report)
         checkpoint%march%report%steps = checkpoint%march%step
      end if
      call reader%close(error)   ! error: handed up
      if (difference /= '') call fail(error, input_error, path//difference)
   end subroutine read_checkpoint

   !> What is wrong with program or version; empty: nothing.
   function other_version(reader) result(difference)
      type(hdf5_input_t), intent(inout) :: reader
      character(:), allocatable :: difference
      character(:), allocatable :: version, commit

      difference = ''
      version = reader%text_attribute('/', 'version')
      commit = reader%text_attribute('/', 'git_commit')
      if (reader%integer_attribute('/', 'checkpoint_format') /= format_number &
         .or. version /= program_version &
         .or. commit /= git_commit()) difference = ' was written by another version, ' &
            //program_name//' '//version// &
         ' (commit '//commit//'), this is '//program_version//' (commit '//git_commit()//')' &
            //way_out
      if (allocated(reader%failure)) difference = ''
   end function other_version

   !> The first line in which two cases differ; empty: they are the same.
   function first_difference(old, new) result(difference)
      character(*), intent(in) :: old, new
      character(:), allocatable :: difference
      character(:), allocatable :: old_rest, new_rest, old_line, new_line

      difference = ''
      old_rest = old
      new_rest = new
      do while (len(old_rest) > 0 .or. len(new_rest) > 0)
         call split_line(old_rest, old_line)
         call split_line(new_rest, new_line)
         if (old_line == new_line .and. len(old_line) == len(new_line)) cycle
         difference = ' is of another case: it has '//old_line//', the namelist '//new_line
         return
      end do
   end function first_difference

   !> Takes the first line off `rest`; 'nothing' if there is none.
   subroutine split_line(rest, line)
      character(:), allocatable, intent(inout) :: rest
      character(:), allocatable, intent(out) :: line
      integer :: length

      length = index(rest, new_line('a')) - 1
      if (length < 0) length = len(rest)
      line = rest(:length)
      if (len(rest) == 0) line = 'nothing'
      rest = rest(min(length + 2, len(rest) + 1):)
   end subroutine split_line

   !> The last solutions.
   subroutine read_march(reader, march)
      type(hdf5_input_t), intent(inout) :: reader
      type(march_state_t), intent(inout) :: march
      real(wp), allocatable :: pressure(:), mass(:), film(:), rigid_displacement(:), lengths(:)
      integer :: n

      march%step = int(reader%integer_value('/march/step'))
      march%size = int(reader%integer_value('/march/size'))
      march%way = int(reader%integer_value('/march/way'))
      pressure = reader%reals('/march/pressure')
      mass = reader%reals('/march/mass')
      film = reader%reals('/march/film')
      rigid_displacement = reader%reals('/march/rigid_displacement')
      lengths = reader%reals('/march/lengths')
      n = size(film) - 1
      if (size(pressure) /= 3*size(film) .or. size(mass) /= 2*size(film) &
         .or. size(rigid_displacement) /= 3 &
         .or. size(lengths) /= 2) then
         call reader%check(-1, 'solutions of different lengths')
         return
      end if
      allocate (march%pressure(0:n, 3), march%mass(0:n, 2), march%film(0:n))
      march%pressure(:, :) = reshape(pressure, [n + 1, 3])
      march%mass(:, :) = reshape(mass, [n + 1, 2])
      march%film(:) = film
      march%rigid_displacement = rigid_displacement
      march%lengths = lengths
   end subroutine read_march

   !> The report up to here; a checkpoint is only written after a step that has converged.
   subroutine read_report_so_far(reader, report)
      type(hdf5_input_t), intent(inout) :: reader
      type(report_t), intent(inout) :: report
      real(wp), allocatable :: residuals(:), load_errors(:), phases(:)

      residuals = reader%reals('/report/residual_history')
      load_errors = reader%reals('/report/load_error_history')
      phases = reader%reals('/report/phase_seconds')
      if (size(residuals) /= size(load_errors) .or. size(phases) /= phase_count) then
         call reader%check(-1, 'a report of another length')
         return
      end if
      call report%restore(residuals, load_errors)
      report%breakdown = breakdown_from(reader%reals('/report/breakdown'))
      report%method = reader%text('/report/method')
      report%outlet_pressure = reader%real_value('/report/outlet_pressure')
      report%tolerance_effective = reader%real_value('/report/tolerance_effective')
      report%uncut_steps = int(reader%integer_value('/report/uncut_steps'))
      report%work_units = reader%real_value('/report/work_units')
      report%fft_pairs = reader%integer_value('/report/fft_pairs')
      report%wall_seconds = reader%real_value('/report/wall_seconds')
      report%phase_seconds = phases
      report%converged = .true.
   end subroutine read_report_so_far

   !> Films below the floor from their numbers (6).
   pure function breakdown_from(numbers) result(breakdown)
      real(wp), intent(in) :: numbers(:)
      type(breakdown_t) :: breakdown

      if (size(numbers) == 6) breakdown = breakdown_t(nint(numbers(1)), .false., &
         nint(numbers(2)), numbers(3), numbers(4), &
         numbers(5), numbers(6))
   end function breakdown_from

   !> The figures as numbers (4, 7).
   pure function summary_numbers(summary) result(numbers)
      type(line_summary_t), intent(in) :: summary
      real(wp) :: numbers(4, 7)

      numbers(:, 1) = figure_numbers(summary%h_min)
      numbers(:, 2) = figure_numbers(summary%h_min_node)
      numbers(:, 3) = figure_numbers(summary%h_central)
      numbers(:, 4) = figure_numbers(summary%p_max)
      numbers(:, 5) = figure_numbers(summary%x_cavitation)
      numbers(:, 6) = [summary%crests%highest, summary%crests%other, summary%crests%spike, &
         summary%crests%spike_film]
      numbers(:, 7) = summary%h_central_cubic
   end function summary_numbers

   !> Value, time, error estimate and extrapolated value of a figure.
   pure function figure_numbers(figure) result(numbers)
      type(figure_t), intent(in) :: figure
      real(wp) :: numbers(4)

      numbers = [figure%value, figure%time, figure%error_estimate, figure%extrapolated]
   end function figure_numbers

   !> The figures from their numbers (28).
   pure function summary_from(numbers) result(summary)
      real(wp), intent(in) :: numbers(:)
      type(line_summary_t) :: summary
      real(wp) :: table(4, 7)

      table = reshape(numbers, [4, 7], pad=[0.0_wp])
      summary%h_min = figure_from(table(:, 1))
      summary%h_min_node = figure_from(table(:, 2))
      summary%h_central = figure_from(table(:, 3))
      summary%p_max = figure_from(table(:, 4))
      summary%x_cavitation = figure_from(table(:, 5))
      summary%crests = crests_t(table(1, 6), table(2, 6), table(3, 6), table(4, 6))
      summary%h_central_cubic = table(1, 7)
   end function summary_from

   !> A figure from its numbers.
   pure function figure_from(numbers) result(figure)
      real(wp), intent(in) :: numbers(4)
      type(figure_t) :: figure

      figure%value = numbers(1)
      figure%time = numbers(2)
      figure%error_estimate = numbers(3)
      figure%extrapolated = numbers(4)
      figure%error_grid = numbers(3)
   end function figure_from

end module checkpoint

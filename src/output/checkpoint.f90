!> Checkpoint of a transient, NAME.ckpt for NAME.part: where the run stood after a time step, and
!> the one walk over what it holds that writes or reads it.
!>
!> It is written under another name, brought to the disk and renamed: the last complete one is
!> always there. It ends with a seal (module file_bytes) and holds the checksum of NAME.part: what
!> is damaged is refused before anything is read.
module checkpoint
   use build_info, only: git_commit, program_name, program_version
   use checkpoint_file, only: checkpoint_file_t
   use disk_file, only: folder_of, hdf5_mark, place_fault, remove_file, rename_file, sync_file
   use errors, only: error_t, fail, input_error, output_error
   use file_bytes, only: seal_fault, seal_file
   use film_fields, only: film_passage_t, new_passage
   use film_statistics, only: film_statistics_t, new_statistics
   use hdf5_dataset, only: write_attribute
   use hdf5_file, only: create_hdf5_file
   use hdf5_input, only: open_hdf5_input
   use iteration_report, only: report_t
   use kinds, only: wp
   use march_state, only: excess_t, march_state_t, max_excesses, momentum_history_t, past_t
   use passage_extremes, only: passage_extremes_t
   use line_contact, only: word_length
   use text, only: to_text
   implicit none (type, external)
   private

   public :: checkpoint_t, read_checkpoint, run_record_t, write_checkpoint

   !> What to do about a checkpoint that cannot be used.
   character(*), parameter :: way_out = '; delete it, and the run starts at the beginning'

   !> Grows with every change of what a checkpoint holds.
   integer, parameter :: format_number = 25

   !> What a run has gathered and chosen, and goes on with from its checkpoint.
   type :: run_record_t
      !> The values of the case that decide about its result, a line each.
      character(:), allocatable :: case
      !> Extremes over the time steps so far.
      type(passage_extremes_t) :: passage
      !> The film over all time steps, where that is asked for.
      type(film_statistics_t) :: statistics
      !> What the full momentum equations have changed so far, where they are solved too.
      type(film_passage_t), allocatable :: film_passage
      !> Intervals, time step and space scheme, given or chosen.
      integer :: intervals = 0
      real(wp) :: time_step = 0.0_wp
      character(len=word_length) :: space_scheme = 'auto'
   end type run_record_t

   !> What a checkpoint holds.
   type, extends(run_record_t) :: checkpoint_t
      type(march_state_t) :: march
      !> Where the full momentum equations stand, where they are solved too.
      type(momentum_history_t), allocatable :: momentum
      !> The checksum of NAME.part.
      character(:), allocatable :: part_digits
   end type checkpoint_t

contains

   !> Writes a checkpoint to `path`. Error: it cannot be written; an older one is still there.
   subroutine write_checkpoint(checkpoint, path, error)
      type(checkpoint_t), intent(inout) :: checkpoint
      character(*), intent(in) :: path
      type(error_t), allocatable, intent(out) :: error
      type(checkpoint_file_t) :: file
      logical :: is_done

      call create_hdf5_file(file%file, path//'.tmp', error)
      if (allocated(error)) return
      call write_attribute(file%file, '/', 'program', program_name)
      call write_attribute(file%file, '/', 'version', program_version)
      call write_attribute(file%file, '/', 'git_commit', git_commit())
      call write_attribute(file%file, '/', 'checkpoint_format', format_number)
      call visit_checkpoint(file, checkpoint)
      call file%file%close(error)
      if (.not. allocated(error)) call seal_file(path//'.tmp', error)
      if (.not. allocated(error)) then
         is_done = sync_file(path//'.tmp')
         if (is_done) is_done = rename_file(path//'.tmp', path)
         if (.not. is_done) call fail(error, output_error, 'cannot write '//path &
            //place_fault(path, hdf5_mark))
         is_done = sync_file(folder_of(path))   ! not every file system can
      end if
      if (allocated(error)) is_done = remove_file(path//'.tmp')
   end subroutine write_checkpoint

   !> Reads the checkpoint `path`. Error: it is damaged, of another version or not of `case`.
   subroutine read_checkpoint(path, case, checkpoint, error)
      character(*), intent(in) :: path, case
      type(checkpoint_t), intent(out) :: checkpoint
      type(error_t), allocatable, intent(out) :: error
      type(checkpoint_file_t) :: file
      character(:), allocatable :: commit, difference, version

      difference = seal_fault(path)
      if (difference /= '') then
         call fail(error, input_error, 'cannot read '//path//': '//difference//way_out)
         return
      end if
      file%is_read = .true.
      call open_hdf5_input(file%reader, path, error)
      if (allocated(error)) return
      version = file%reader%text('/', 'version')
      commit = file%reader%text('/', 'git_commit')
      if (nint(file%reader%real_value('/', 'checkpoint_format')) /= format_number .or. &
         version /= program_version .or. commit /= git_commit()) then
         difference = ' was written by another version, '//program_name//' '//version// &
            ' (commit '//commit//'), this is '//program_version//' (commit '//git_commit()//')' &
            //way_out
      else
         call visit_checkpoint(file, checkpoint)
         difference = first_difference(checkpoint%case, case)
      end if
      call file%reader%close(error)
      if (allocated(error)) return
      if (difference /= '') call fail(error, input_error, path//difference)
   end subroutine read_checkpoint

   !> The first line in which two cases differ; empty: they are the same.
   pure function first_difference(old, new) result(difference)
      character(*), intent(in) :: old, new
      character(:), allocatable :: a, b, difference
      character(*), parameter :: ending = new_line('a')
      integer :: i, k

      difference = ''
      a = old//ending
      b = new//ending
      do while (len(a) + len(b) > 0)
         i = index(a, ending)
         k = index(b, ending)
         if (i /= k .or. a(:i) /= b(:k)) exit
         a = a(i + 1:)
         b = b(k + 1:)
      end do
      if (len(a) + len(b) == 0) return
      if (a == '') a = 'nothing'//ending
      if (b == '') b = 'nothing'//ending
      difference = ' is of another case: it has '//a(:index(a, ending) - 1)//', the namelist ' &
         //b(:index(b, ending) - 1)
   end function first_difference

   !> Everything that a checkpoint holds: writes it, or reads it.
   subroutine visit_checkpoint(file, checkpoint)
      type(checkpoint_file_t), intent(inout) :: file
      type(checkpoint_t), intent(inout) :: checkpoint
      character(:), allocatable :: scheme

      scheme = trim(checkpoint%space_scheme)
      call file%visit_text('/case', checkpoint%case)
      call file%visit('/intervals', checkpoint%intervals)
      call file%visit('/time_step', checkpoint%time_step)
      call file%visit_text('/space_scheme', scheme)
      checkpoint%space_scheme = scheme
      associate (passage => checkpoint%passage)
         passage%has_counted = file%has('/counted', passage%has_counted)
         if (passage%has_counted) call file%visit_plain('/counted', passage%counted, &
            storage_size(passage%counted))
         passage%has_earlier = file%has('/earlier', passage%has_earlier)
         if (passage%has_earlier) call file%visit_plain('/earlier', passage%earlier, &
            storage_size(passage%earlier))
      end associate
      if (file%has('/statistics', allocated(checkpoint%statistics%thresholds))) call &
         visit_statistics(file, checkpoint%statistics)
      call visit_march(file, checkpoint%march)
      if (file%has('/momentum', allocated(checkpoint%momentum))) then
         if (file%is_read) allocate (checkpoint%momentum, checkpoint%film_passage)
         call visit_momentum(file, checkpoint%momentum, ubound(checkpoint%march%film, 1))
         call visit_passage(file, checkpoint%film_passage, size(checkpoint%march%film))
      end if
      call file%visit_text('/part_digits', checkpoint%part_digits)
   end subroutine visit_checkpoint

   !> Sums over the time steps so far.
   subroutine visit_statistics(file, statistics)
      type(checkpoint_file_t), intent(inout) :: file
      type(film_statistics_t), intent(inout) :: statistics
      real(wp), allocatable :: thresholds(:)

      if (.not. file%is_read) thresholds = statistics%thresholds
      call file%visit_vector('/statistics/thresholds', thresholds)
      if (file%is_read) statistics = new_statistics(thresholds)
      call file%visit('/statistics/times', statistics%times)
      call file%visit('/statistics/times_below', statistics%times_below)
      call file%visit('/statistics/shares_below', statistics%shares_below)
      call file%visit('/statistics/film_bins', statistics%film_bins)
      call file%visit('/statistics/pressure_bins', statistics%pressure_bins)
      call file%visit('/statistics/film_sum', statistics%film_sum)
      call file%visit('/statistics/height_sum', statistics%height_sum)
      call file%visit('/statistics/square_sum', statistics%square_sum)
      call file%visit('/statistics/smooth_film', statistics%smooth_film)
   end subroutine visit_statistics

   !> The last solutions.
   subroutine visit_march(file, march)
      type(checkpoint_file_t), intent(inout) :: file
      type(march_state_t), intent(inout) :: march
      real(wp), allocatable :: film(:)
      integer :: n

      call file%visit('/march/step', march%step)
      call file%visit('/march/steps', march%steps)
      call file%visit('/march/size', march%size)
      call file%visit('/march/way', march%way)
      call file%visit('/march/rigid_displacement', march%rigid_displacement)
      call file%visit('/march/lengths', march%lengths)
      call file%visit('/march/next_length', march%next_length)
      call file%visit('/march/direction', march%direction)
      if (.not. file%is_read) film = march%film
      call file%visit_vector('/march/film', film)
      n = size(film) - 1
      if (file%is_read) then
         allocate (march%film(0:n), march%pressure(0:n, 3), march%mass(0:n, 4))
         march%film(:) = film
      end if
      call file%visit('/march/cycle_change', march%cycle_change)
      if (file%has('/march/cycle_film', allocated(march%cycle_film))) call &
         file%visit_vector('/march/cycle_film', march%cycle_film)
      call file%visit('/march/pressure', march%pressure)
      call file%visit('/march/mass', march%mass)
      if (file%has('/march/rise', allocated(march%rise))) then
         if (file%is_read) allocate (march%rise(0:n, 3))
         call file%visit('/march/rise', march%rise)
      end if
      call visit_report(file, march%report)
      march%report%steps = march%step
   end subroutine visit_march

   !> The march of the full momentum equations on n intervals.
   subroutine visit_momentum(file, history, n)
      type(checkpoint_file_t), intent(inout) :: file
      type(momentum_history_t), intent(inout) :: history
      integer, intent(in) :: n
      integer :: k

      associate (past => history)
         call file%visit_plain('/momentum/cost', past%march_cost_t, storage_size(past%march_cost_t))
         call file%visit('/momentum/layers', past%layers)
         call file%visit('/momentum/times', past%times)
         call file%visit('/momentum/films', past%films)
         call file%visit('/momentum/best_count', past%best_count)
         call file%visit('/momentum/lengths', past%lengths)
         call file%visit('/momentum/stress_rise', past%stress_rise)
         do k = 1, min(past%times, size(past%past))
            call visit_past(file, '/momentum/past_'//to_text(k), past%past(k), past%layers, n)
         end do
         do k = 1, min(past%films, max_excesses)
            call visit_excess(file, '/momentum/excess_'//to_text(k), past%excess(k), past%layers, n)
         end do
         call visit_excess(file, '/momentum/flow', past%flow, past%layers, n)
         call visit_past(file, '/momentum/made_of_old', past%made_of_old, past%layers, n)
         call file%visit('/momentum/half_rate', past%half_rate)
         if (file%is_read) allocate (past%film(0:n), past%heights(0:n, 2), &
            past%reynolds%pressure(0:n), past%reynolds%film(0:n))
         call file%visit('/momentum/film', past%film)
         call file%visit('/momentum/heights', past%heights)
         call file%visit('/momentum/reynolds/pressure', past%reynolds%pressure)
         call file%visit('/momentum/reynolds/film', past%reynolds%film)
         call file%visit('/momentum/reynolds/rigid_displacement', past%reynolds%rigid_displacement)
      end associate
   end subroutine visit_momentum

   !> H, z1 and rho H of an old time on `layers` layers and n intervals.
   subroutine visit_past(file, path, past, layers, n)
      type(checkpoint_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      type(past_t), intent(inout) :: past
      integer, intent(in) :: layers, n

      if (file%is_read) allocate (past%film(0:n), past%lower(0:n), past%mass(layers, 0:n))
      call file%visit(path//'/film', past%film)
      call file%visit(path//'/lower', past%lower)
      call file%visit(path//'/mass', past%mass)
   end subroutine visit_past

   !> P, U, V and H0 on `layers` layers and n intervals.
   subroutine visit_excess(file, path, excess, layers, n)
      type(checkpoint_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      type(excess_t), intent(inout) :: excess
      integer, intent(in) :: layers, n

      if (file%is_read) allocate (excess%p(layers, 0:n), excess%u(layers, n), &
         excess%v(0:layers, 0:n))
      call file%visit(path//'/p', excess%p)
      call file%visit(path//'/u', excess%u)
      call file%visit(path//'/v', excess%v)
      call file%visit(path//'/rigid_displacement', excess%rigid_displacement)
   end subroutine visit_excess

   !> What the full momentum equations have changed so far, on nx nodes.
   subroutine visit_passage(file, passage, nx)
      type(checkpoint_file_t), intent(inout) :: file
      type(film_passage_t), intent(inout) :: passage
      integer, intent(in) :: nx
      integer :: places(2)

      places = [passage%last, passage%stride]
      call file%visit('/momentum/passage/places', places)
      if (file%is_read) passage = new_passage(places(1), places(2), nx)
      passage%last = places(1)
      associate (last => places(1), profiles => places(1)/places(2))
         call file%visit('/momentum/passage/time', passage%time(:last))
         call file%visit('/momentum/passage/series', passage%series(:, :last))
         call file%visit('/momentum/passage/pressure', passage%pressure(:, :profiles))
         call file%visit('/momentum/passage/film', passage%film(:, :profiles))
      end associate
   end subroutine visit_passage

   !> The report up to here; a checkpoint is only written after a step that has converged.
   subroutine visit_report(file, report)
      type(checkpoint_file_t), intent(inout) :: file
      type(report_t), intent(inout) :: report
      real(wp), allocatable :: residuals(:), load_errors(:)

      allocate (residuals, source=report%residual_history())
      allocate (load_errors, source=report%load_error_history())
      call file%visit_vector('/report/residual_history', residuals)
      if (file%is_read) load_errors = residuals
      call file%visit('/report/load_error_history', load_errors)
      if (file%is_read) call report%restore(residuals, load_errors)
      report%converged = .true.
      ! of a step that its start solved they are not in the histories
      call file%visit('/report/residual', report%residual)
      call file%visit('/report/load_error', report%load_error)
      call file%visit_text('/report/method', report%method)
      call file%visit('/report/tolerance_effective', report%tolerance_effective)
      call file%visit_plain('/report/fit', report%fit, storage_size(report%fit))
      call file%visit_plain('/report/cost', report%cost, storage_size(report%cost))
      call file%visit_plain('/report/breakdown', report%breakdown, storage_size(report%breakdown))
   end subroutine visit_report

end module checkpoint

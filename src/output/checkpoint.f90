!> Checkpoint of a transient, NAME.ckpt for NAME.part: where the run stood after a time step.
!>
!> One walk over all values with names writes or reads them: it calls `visit` for each value, with
!> its path in the file. While the file is written the value goes there; while it is read the value
!> comes from there, and must be as large as it was. The first failure is kept, as in `hdf5_file`
!> and `hdf5_input`, and what follows it does nothing.
!>
!> It is written under another name, brought to the disk and renamed: the last complete one is
!> always there. It ends with a seal (module file_bytes) and holds the checksum of NAME.part: what
!> is damaged is refused before anything is read.
module checkpoint
   use, intrinsic :: iso_c_binding, only: c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: int32, int64
   use build_info, only: git_commit, program_name, program_version
   use disk_file, only: folder_of, hdf5_mark, place_fault, remove_file, rename_file, sync_file
   use errors, only: error_t, fail, input_error, output_error
   use file_bytes, only: seal_fault, seal_file
   use film_fields, only: film_passage_t
   use film_statistics, only: film_statistics_t
   use hdf5, only: h5kind_to_type, h5_integer_kind, h5_real_kind, hid_t
   use hdf5_dataset, only: write_attribute, write_string, write_values
   use hdf5_file, only: create_hdf5_file, hdf5_file_t
   use hdf5_input, only: hdf5_input_t, open_hdf5_input
   use iteration_report, only: report_t
   use kinds, only: wp
   use march_state, only: excess_t, march_state_t, max_excesses, momentum_history_t, past_t
   use passage_extremes, only: passage_extremes_t
   use line_contact, only: word_length
   use text, only: to_text
   implicit none (type, external)
   private

   public :: checkpoint_t, read_checkpoint, write_checkpoint

   !> What to do about a checkpoint that cannot be used.
   character(*), parameter :: way_out = '; delete it, and the run starts at the beginning'

   !> Grows with every change of what a checkpoint holds.
   integer, parameter :: format_number = 26

   !> Intervals, time step and space scheme, given or chosen.
   type :: resolution_t
      integer :: intervals = 0
      real(wp) :: time_step = 0.0_wp
      character(len=word_length) :: space_scheme = 'auto'
   end type resolution_t

   !> What a run has gathered and chosen, and goes on with from its checkpoint.
   type, extends(resolution_t) :: checkpoint_t
      !> The values of the case that decide about its result, a line each.
      character(:), allocatable :: case
      !> Extremes over the time steps so far.
      type(passage_extremes_t) :: passage
      !> The film over all time steps, where that is asked for.
      type(film_statistics_t) :: statistics
      !> What the full momentum equations have changed so far, where they are solved too.
      type(film_passage_t) :: film_passage
      !> Where it stands at the checkpoint, and where the full momentum equations do.
      type(march_state_t) :: march
      type(momentum_history_t), allocatable :: momentum
      !> The checksum of NAME.part.
      character(:), allocatable :: part_digits
   end type checkpoint_t

   !> The file: one that is written, or one that is read.
   type :: checkpoint_file_t
      logical :: is_read = .false.
      type(hdf5_file_t) :: file
      type(hdf5_input_t) :: reader
   contains
      procedure :: has, visit, visit_text, visit_vector, visit_plain
   end type checkpoint_file_t

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
      integer :: i

      a = old//ending
      b = new//ending
      do i = 1, min(len(a), len(b))
         if (a(i:i) /= b(i:i)) exit
      end do
      difference = ''
      if (i > max(len(a), len(b))) return
      i = index(a(:i - 1), ending, back=.true.) + 1
      a = a(i:)//'nothing'//ending
      b = b(i:)//'nothing'//ending
      difference = ' is of another case: it has '//a(:index(a, ending) - 1)//', the namelist ' &
         //b(:index(b, ending) - 1)
   end function first_difference

   !> Everything that a checkpoint holds: writes it, or reads it.
   subroutine visit_checkpoint(file, checkpoint)
      type(checkpoint_file_t), intent(inout) :: file
      type(checkpoint_t), intent(inout) :: checkpoint

      call file%visit_text('/case', checkpoint%case)
      call file%visit_plain('/resolution', checkpoint%resolution_t, &
         storage_size(checkpoint%resolution_t))
      associate (passage => checkpoint%passage)
         passage%has_counted = file%has('/counted', passage%has_counted)
         if (passage%has_counted) call file%visit_plain('/counted', passage%counted, &
            storage_size(passage%counted))
         passage%has_earlier = file%has('/earlier', passage%has_earlier)
         if (passage%has_earlier) call file%visit_plain('/earlier', passage%earlier, &
            storage_size(passage%earlier))
      end associate
      associate (statistics => checkpoint%statistics)
         if (file%has('/statistics', allocated(statistics%thresholds))) then
            call file%visit_vector('/statistics/thresholds', statistics%thresholds, 1)
            call file%visit_vector('/statistics/times_below', statistics%times_below, 1)
            call file%visit_vector('/statistics/shares_below', statistics%shares_below, 1)
            call file%visit('/statistics/film_bins', statistics%film_bins)
            call file%visit('/statistics/pressure_bins', statistics%pressure_bins)
            call file%visit_plain('/statistics/sums', statistics%film_sums_t, &
               storage_size(statistics%film_sums_t))
         end if
      end associate
      call visit_march(file, checkpoint%march)
      if (file%has('/momentum', allocated(checkpoint%momentum))) then
         if (file%is_read) allocate (checkpoint%momentum)
         call visit_momentum(file, checkpoint%momentum, ubound(checkpoint%march%film, 1))
         call file%visit('/momentum/extremes', checkpoint%film_passage%extremes)
      end if
      call file%visit_text('/part_digits', checkpoint%part_digits)
   end subroutine visit_checkpoint

   !> The last solutions.
   subroutine visit_march(file, march)
      type(checkpoint_file_t), intent(inout) :: file
      type(march_state_t), intent(inout) :: march
      integer :: n

      call file%visit_plain('/march/numbers', march%march_numbers_t, &
         storage_size(march%march_numbers_t))
      call file%visit_vector('/march/film', march%film, 0)
      n = size(march%film) - 1
      if (file%is_read) allocate (march%pressure(0:n, 3), march%mass(0:n, 4))
      if (file%has('/march/cycle_film', allocated(march%cycle_film))) call &
         file%visit_vector('/march/cycle_film', march%cycle_film, 1)
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
         do k = 1, min(past%times, size(past%past))
            call visit_past(file, '/momentum/past_'//to_text(k), past%past(k), past%layers, n)
         end do
         do k = 1, min(past%films, max_excesses)
            call visit_excess(file, '/momentum/excess_'//to_text(k), past%excess(k), past%layers, n)
         end do
         call visit_excess(file, '/momentum/flow', past%flow, past%layers, n)
         call visit_past(file, '/momentum/made_of_old', past%made_of_old, past%layers, n)
         call file%visit_vector('/momentum/film', past%film, 0)
         if (file%is_read) allocate (past%heights(0:n, 2))
         call file%visit('/momentum/heights', past%heights)
         call file%visit_vector('/momentum/reynolds/pressure', past%reynolds%pressure, 0)
         call file%visit_vector('/momentum/reynolds/film', past%reynolds%film, 0)
         call file%visit('/momentum/reynolds/rigid_displacement', past%reynolds%rigid_displacement)
      end associate
   end subroutine visit_momentum

   !> H, z1 and rho H of an old time on `layers` layers and n intervals.
   subroutine visit_past(file, path, past, layers, n)
      type(checkpoint_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      type(past_t), intent(inout) :: past
      integer, intent(in) :: layers, n

      call file%visit_vector(path//'/film', past%film, 0)
      call file%visit_vector(path//'/lower', past%lower, 0)
      if (file%is_read) allocate (past%mass(layers, 0:n))
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

   !> The report up to here; a checkpoint is only written after a step that has converged.
   subroutine visit_report(file, report)
      type(checkpoint_file_t), intent(inout) :: file
      type(report_t), intent(inout) :: report
      real(wp), allocatable :: residuals(:), load_errors(:)

      residuals = report%residual_history()
      load_errors = report%load_error_history()
      call file%visit_vector('/report/residual_history', residuals, 1)
      call file%visit_vector('/report/load_error_history', load_errors, 1)
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

   !> Reals.
   subroutine visit(self, path, values)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), intent(inout), contiguous, target :: values(..)

      call visit_numbers(self, path, h5kind_to_type(wp, h5_real_kind), shape(values), c_loc(values))
   end subroutine visit

   !> A text.
   subroutine visit_text(self, path, text)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      character(:), allocatable, intent(inout) :: text

      if (self%is_read) then
         text = self%reader%text(path)
      else
         call write_string(self%file, path, text)
      end if
   end subroutine visit_text

   !> Reals; while the file is read there are as many as there were, the `first` with this number.
   subroutine visit_vector(self, path, values, first)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      real(wp), allocatable, intent(inout) :: values(:)
      integer, intent(in) :: first

      if (self%is_read) then
         associate (found => self%reader%reals(path))
            if (allocated(values)) deallocate (values)
            allocate (values(first:first + size(found) - 1), source=found)
         end associate
      else
         call self%visit(path, values)
      end if
   end subroutine visit_vector

   !> A value of so many `bits`, of a type without allocatable components: its bits.
   subroutine visit_plain(self, path, value, bits)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      type(*), intent(inout), target :: value
      integer, intent(in) :: bits

      call visit_numbers(self, path, h5kind_to_type(int32, h5_integer_kind), &
         [bits/storage_size(1_int32)], c_loc(value))
   end subroutine visit_plain

   !> Numbers of `type_id` at an address, with their extents.
   subroutine visit_numbers(self, path, type_id, extents, address)
      type(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      integer(hid_t), intent(in) :: type_id
      integer, intent(in) :: extents(:)
      type(c_ptr), intent(in) :: address

      if (self%is_read) then
         call self%reader%read_numbers(path, product(int(extents, int64)), type_id, address)
      else
         call write_values(self%file, path, type_id, extents, address)
      end if
   end subroutine visit_numbers

   !> Whether there is something at `path`.
   logical function has(self, path, is_kept)
      class(checkpoint_file_t), intent(inout) :: self
      character(*), intent(in) :: path
      logical, intent(in) :: is_kept

      has = is_kept
      if (self%is_read) has = self%reader%has(path)
   end function has

end module checkpoint

!> /transient of a result: in NAME.part while the run goes on (see `running_series`), in the result
!> at its end.
!>
!> Series of one number hold every time step; profiles may be stored of some steps only, and have
!> times of their own.
module transient_store
   use, intrinsic :: iso_fortran_env, only: int64
   use checksum, only: checksum_t
   use errors, only: error_t, fail, input_error, output_error
   use file_bytes, only: open_positional_file, positional_file_t
   use hdf5_axes, only: link_object, make_axis, name_axes
   use hdf5_dataset, only: label_t
   use hdf5_file, only: hdf5_file_t
   use hdf5_series, only: create_series, series_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use quantities, only: quantity_rows, sliding_rows
   use result_labels, only: field_names, field_values, has_scale, row_label, si_label
   use running_series, only: create_running_series, running_series_t
   use scaling, only: scaling_t
   use signals, only: begin_activity
   implicit none (type, external)
   private

   public :: attach_store, create_store, part_t, transient_store_t

   !> Longest name of a series.
   integer, parameter :: name_length = len(quantity_rows%name)
   !> Series of one number for each time step that every passage has, quantities among them. Time is
   !> counted last, and cut back first: there are never more times than values.
   character(len=name_length), parameter :: number_names(*) = [character(len=name_length) :: &
      'time', 'rigid_displacement', 'h_min', 'p_max', 'rolling_friction_coefficient', &
      'rolling_power', 'residual']
   !> Those where the speeds of the surfaces are known, to be named like fields.
   character(len=name_length), parameter, public :: sliding_names(*) = &
      quantity_rows(sliding_rows)%name
   !> Times of the stored profiles, for which the same holds.
   character(*), parameter :: profile_time_name = 'profile_time'
   !> Mark of the time steps with a film below the floor, to be named like a field.
   character(*), parameter, public :: breakdown_name = 'film_breakdown'
   !> What to do about a file that does not fit its checkpoint.
   character(*), parameter :: way_out = '; delete the checkpoint, and the run starts at the '// &
      'beginning'
   !> Numbers that are moved at once into the result.
   integer, parameter :: block_numbers = 131072

   !> Length of the checksum of a series.
   integer, parameter, public :: digits_length = 16

   !> What is kept of NAME.part in a checkpoint: enough to find the series in it again, and to know
   !> that they are the same.
   type :: part_t
      !> Time steps and profiles.
      integer :: records(2) = 0
      !> Places of each series (2, series) [bytes], and its checksum of `digits_length` digits.
      integer(int64), allocatable :: places(:, :)
      character(:), allocatable :: digits
   end type part_t

   !> The series of one run.
   type :: transient_store_t
      character(len=name_length), allocatable :: names(:)
      type(running_series_t), allocatable :: series(:)
      !> From this series on they belong to the profiles.
      integer :: first_profile = 0
      type(positional_file_t) :: file
   contains
      !> Opens the file that the HDF5 library has closed, without records.
      procedure :: open => open_store
      !> Stores one time step.
      procedure :: append
      !> Number of stored time steps, T = 0 among them.
      procedure :: records
      !> What a checkpoint needs to know.
      procedure :: part => part_of
      !> Writes the series into another file.
      procedure :: copy_into
   end type transient_store_t

contains

   !> Makes room in an open HDF5 file for `capacity` times and profiles of `nx` nodes; `fields` are
   !> names of `field_names`, of `sliding_names`, or `breakdown_name`.
   subroutine create_store(store, file, fields, capacity, nx, scaling)
      type(transient_store_t), intent(out) :: store
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: fields(:)
      integer, intent(in) :: capacity(2), nx
      type(scaling_t), intent(in) :: scaling
      integer :: i

      call name_series(store, fields)
      do i = 1, size(store%names)
         call create_running_series(store%series(i), file, '/transient/'//trim(store%names(i)), &
            row_length(store%names(i), nx), capacity(kind_of(store, i)), &
            row_label(trim(store%names(i)), scaling))
      end do
   end subroutine create_store

   !> Goes on in `path` where the series of an earlier run stood: `part`, with profiles of `nx`
   !> nodes. Their bytes are read again, the HDF5 library does not look at the file. Error: they are
   !> not what they were.
   subroutine attach_store(store, path, fields, nx, part, error)
      type(transient_store_t), intent(out) :: store
      character(*), intent(in) :: path, fields(:)
      integer, intent(in) :: nx
      type(part_t), intent(in) :: part
      type(error_t), allocatable, intent(out) :: error
      type(part_t) :: found
      integer :: i

      call name_series(store, fields)
      call open_positional_file(store%file, path, for_writing=.true.)
      if (allocated(store%file%failure)) then
         error = store%file%failure
         return
      end if
      do i = 1, size(store%names)
         call store%series(i)%take_up(store%file, '/transient/'//trim(store%names(i)), &
            row_length(store%names(i), nx), &
            part%places(:, i), part%records(kind_of(store, i)))
      end do
      if (allocated(store%file%failure)) then
         call fail(error, input_error, path//' holds less than the checkpoint says'//way_out)
         return
      end if
      found = store%part()
      if (found%digits /= part%digits) then
         call fail(error, input_error, path//' is damaged: its checksum is not that of the '// &
            'checkpoint'//way_out)
         return
      end if
      call begin_series(store, part%records)
   end subroutine attach_store

   !> Opens `path` for writing.
   subroutine open_store(self, path)
      class(transient_store_t), intent(inout) :: self
      character(*), intent(in) :: path

      call open_positional_file(self%file, path, for_writing=.true.)
      call begin_series(self, [0, 0])
   end subroutine open_store

   !> Keeps the first `records` times and profiles.
   subroutine begin_series(store, records)
      class(transient_store_t), intent(inout) :: store
      integer, intent(in) :: records(2)
      integer :: i

      do i = 1, size(store%series)
         call store%series(i)%begin(store%file, records(kind_of(store, i)))
      end do
   end subroutine begin_series

   !> What is stored, where, and its checksums.
   function part_of(self) result(part)
      class(transient_store_t), intent(in) :: self
      type(part_t) :: part
      integer :: i

      part%records = [self%series(1)%records, self%series(self%first_profile)%records]
      allocate (part%places(2, size(self%series)))
      part%digits = ''
      do i = 1, size(self%series)
         part%places(:, i) = self%series(i)%places()
         part%digits = part%digits//self%series(i)%sums%digits()
      end do
   end function part_of

   !> Stores one time step, with its profiles if `has_profiles`. Whatever happens in between, the
   !> file holds whole records.
   subroutine append(self, state, summary, report, has_profiles)
      class(transient_store_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report
      logical, intent(in) :: has_profiles
      integer :: i, last

      last = merge(size(self%series), self%first_profile - 1, has_profiles)
      do i = 1, last
         associate (series => self%series(i))
            select case (self%names(i))
            case ('time', profile_time_name)
               call series%put(self%file, [state%time])
            case ('rigid_displacement')
               call series%put(self%file, [state%rigid_displacement])
            case ('residual')
               call series%put(self%file, [report%residual])
            case (breakdown_name)
               call series%put(self%file, [merge(1.0_wp, 0.0_wp, report%breakdown%is_now)])
            case default
               if (any(quantity_rows%name == self%names(i))) then
                  call series%put(self%file, pack(summary%of%value, quantity_rows%name &
                     == self%names(i)))
               else
                  call series%put(self%file, field_values(trim(self%names(i)), state))
               end if
            end select
         end associate
      end do
      do i = last, 1, -1
         call self%series(i)%count_record(self%file)
      end do
   end subroutine append

   !> Time steps that are stored.
   pure function records(self)
      class(transient_store_t), intent(in) :: self
      integer :: records

      records = 0
      if (allocated(self%series)) records = self%series(1)%records
   end function records

   !> Writes all series into the open HDF5 file `file` that has /solution, with their axes; with
   !> `has_si` in /si/transient those that are other numbers in SI.
   subroutine copy_into(self, file, scaling, has_si)
      class(transient_store_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: has_si
      type(label_t) :: label
      character(:), allocatable :: name
      integer :: i

      call link_object(file, '/solution/x', '/transient/x')
      if (has_si) call link_object(file, '/si/solution/x', '/si/transient/x')
      do i = 1, size(self%series)
         name = trim(self%names(i))
         call begin_activity('writing the result, '//name)
         label = row_label(name, scaling)
         call copy_series(self, file, i, '/transient/', 1.0_wp, label)
         if (has_si .and. has_scale(label)) call copy_series(self, file, i, '/si/transient/', &
            label%si_scale, si_label(name, scaling))
      end do
   end subroutine copy_into

   !> Series `i` times `factor` into a group, with its axes. A failure: it is not what was stored.
   subroutine copy_series(store, file, i, group, factor, label)
      class(transient_store_t), intent(inout) :: store
      class(hdf5_file_t), intent(inout) :: file
      integer, intent(in) :: i
      character(*), intent(in) :: group
      real(wp), intent(in) :: factor
      type(label_t), intent(in) :: label
      type(series_t) :: copy
      type(checksum_t) :: sums
      real(wp), allocatable :: values(:, :)
      character(:), allocatable :: path
      integer :: first, last, most

      path = group//trim(store%names(i))
      associate (series => store%series(i))
         call create_series(copy, file, path, series%row_length, series%records, label)
         if (store%names(i) == 'time' .or. store%names(i) == profile_time_name) then
            call make_axis(file, path)
         else if (series%row_length > 0) then
            call name_axes(file, path, group//'x', group//profile_time_name)
         else
            call name_axes(file, path, group//'time')
         end if
         most = max(block_numbers/max(series%row_length, 1), 1)
         do first = 1, series%records, most
            last = min(first + most - 1, series%records)
            allocate (values(max(series%row_length, 1), last - first + 1))
            call series%get(store%file, first, values)
            call sums%add(reshape(values, [size(values)]))
            values = factor*values
            call copy%append(file, values)
            deallocate (values)
         end do
         call copy%close(file)
         if (sums%digits() == series%sums%digits() .or. allocated(store%file%failure)) return
      end associate
      call fail(store%file%failure, output_error, store%file%path &
         //' was changed by another program while the run went on')
   end subroutine copy_series

   !> Names of all series.
   subroutine name_series(store, fields)
      type(transient_store_t), intent(inout) :: store
      character(*), intent(in) :: fields(:)

      logical :: is_profile(size(fields))
      integer :: i

      is_profile = [(any(field_names == fields(i)), i=1, size(fields))]
      store%names = [character(len=name_length) :: number_names, pack(fields, .not. is_profile), &
         profile_time_name, pack(fields, is_profile)]
      store%first_profile = size(number_names) + count(.not. is_profile) + 1
      allocate (store%series(size(store%names)))
   end subroutine name_series

   !> What series `i` counts: 1 = time steps, 2 = profiles.
   pure function kind_of(store, i) result(kind)
      type(transient_store_t), intent(in) :: store
      integer, intent(in) :: i
      integer :: kind

      kind = merge(2, 1, i >= store%first_profile)
   end function kind_of

   !> Length of the rows of a series; 0: single numbers.
   pure function row_length(name, nx) result(length)
      character(*), intent(in) :: name
      integer, intent(in) :: nx
      integer :: length

      length = merge(nx, 0, any(field_names == name))
   end function row_length

end module transient_store

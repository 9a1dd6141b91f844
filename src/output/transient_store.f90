!> /transient: records in NAME.part while the run goes on, series in the result at its end.
!>
!> NAME.part is a line of text that says what is in it, with blanks to a multiple of 8 bytes, and
!> behind it a record for each time step: the numbers, the profiles of every `stride`-th step, and
!> the checksum of all bytes before, 16 digits. A record is appended by one write: a kill leaves
!> whole records, and perhaps one whose checksum differs. Readers: python/asperity/running.py.
!>
!> Series of numbers hold every time step; profiles may be of some only, with times of their own.
module transient_store
   use, intrinsic :: iso_c_binding, only: c_null_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use disk_file, only: any_mark, part_words, place_fault
   use errors, only: error_t, fail, input_error, output_error
   use file_bytes, only: checksum_t, open_positional_file, positional_file_t, real_bytes, sums_of
   use hdf5_axes, only: link_object, name_axes
   use hdf5_dataset, only: label_t, new_label, write_records, write_values
   use hdf5_file, only: hdf5_file_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use quantities, only: asperity_share, boundary_friction, oil_friction, quantity_rows, &
      sliding_rows
   use result_labels, only: field_names, field_values, row_label
   use scaling, only: scaling_t
   use signals, only: begin_activity
   use text, only: count_of, to_text
   use text_file, only: open_lines, text_lines_t
   implicit none (type, external)
   private

   public :: attach_store, begin_store, create_store, read_progress, transient_store_t

   !> Longest name of a series.
   integer, parameter :: name_length = len(quantity_rows%name)
   !> Series of one number for each time step that every passage has, quantities among them.
   character(len=name_length), parameter :: number_names(*) = [character(len=name_length) :: &
      'time', 'rigid_displacement', 'h_min', 'p_max', 'rolling_friction_coefficient', &
      'rolling_power', 'residual']
   !> Those where the speeds of the surfaces are known, to be named like fields.
   character(len=name_length), parameter, public :: sliding_names(*) = &
      quantity_rows(sliding_rows)%name
   !> Those of a contact with asperities, to be named like fields.
   character(len=name_length), parameter, public :: mixed_names(*) = &
      quantity_rows([asperity_share, oil_friction, boundary_friction])%name
   !> Coordinates of fields.
   character(len=1), parameter :: coordinates(2) = ['x', 'y']
   !> Times of the stored profiles, which the records do not repeat.
   character(*), parameter :: profile_time_name = 'profile_time'
   !> Those of a contact with a duty, to be named like fields.
   character(len=name_length), parameter, public :: duty_names(*) = [character(len=name_length) :: &
      'h_central', 'load_per_length', 'reduced_radius', 'speed_1', 'speed_2'], &
      point_duty_names(*) = [character(len=name_length) :: 'h_central', 'load', 'speed_1', &
      'speed_2']
   !> Mark of the time steps with a film below the floor, to be named like a field.
   character(*), parameter, public :: breakdown_name = 'film_breakdown'
   !> What to do about a file that does not fit its checkpoint.
   character(*), parameter :: way_out = '; delete the checkpoint, and the run starts at the '// &
      'beginning'
   !> Numbers that are moved at once into the result; as many as the digits of a checksum fill.
   integer, parameter :: block_numbers = 131072, digit_numbers = 2
   !> Longest reason of the operating system.
   integer, parameter :: longest_reason = 200

   !> The series of one run.
   type :: transient_store_t
      !> Time steps that are stored, T = 0 among them.
      integer :: records = 0
      type(positional_file_t) :: file
      !> Series of numbers, of which the time is the first, from `first_profile` on the times of
      !> the profiles, then profiles of so many `nodes` at every `stride`-th step.
      character(len=name_length), allocatable, private :: names(:)
      integer, private :: first_profile = 0, nodes = 0, stride = 1
      !> The first line, and the checksum of all bytes so far.
      character(:), allocatable, private :: line
      type(checksum_t) :: sums
   contains
      procedure :: append, copy_into
   end type transient_store_t

contains

   !> Empties the file `path`, which must be one of this program, and marks it.
   subroutine create_store(store, path)
      type(transient_store_t), intent(out) :: store
      character(*), intent(in) :: path
      character(:), allocatable :: fault
      character(len=longest_reason) :: reason
      integer :: status, unit

      fault = place_fault(path, any_mark)
      if (fault == '') then
         open (newunit=unit, file=path, status='replace', action='write', iostat=status, &
            iomsg=reason)
         if (status == 0) close (unit)
         if (status /= 0) fault = ': '//trim(reason)
      end if
      if (fault /= '') then
         call fail(store%file%failure, output_error, 'cannot write '//path//fault)
         return
      end if
      call open_positional_file(store%file, path, for_writing=.true.)
      call store%file%write_reals(0_int64, transfer(part_words, [0.0_wp]))
   end subroutine create_store

   !> Begins the records, with profiles of `nodes` nodes at every `stride`-th step; `fields` are
   !> names of `field_names`, of `sliding_names`, or `breakdown_name`.
   subroutine begin_store(store, fields, nodes, stride)
      type(transient_store_t), intent(inout) :: store
      character(*), intent(in) :: fields(:)
      integer, intent(in) :: nodes, stride

      call name_series(store, fields, nodes, stride)
      call store%file%write_reals(0_int64, transfer(store%line, [0.0_wp]))
      call store%sums%add(transfer(store%line, [0.0_wp]))
   end subroutine begin_store

   !> Goes on in `path` behind the records of an earlier run; `counts`: nodes, stride, records.
   !> Error: they are not those whose checksum is `digits`.
   subroutine attach_store(store, path, fields, counts, digits, error)
      type(transient_store_t), intent(out) :: store
      character(*), intent(in) :: path, fields(:), digits
      integer, intent(in) :: counts(3)
      type(error_t), allocatable, intent(out) :: error

      call open_positional_file(store%file, path, for_writing=.true.)
      if (allocated(store%file%failure)) then
         error = store%file%failure
         return
      end if
      call name_series(store, fields, counts(1), counts(2))
      store%records = counts(3)
      store%sums = sums_of(store%file, place_of(store, store%records))
      if (allocated(store%file%failure)) then
         call fail(error, input_error, path//' holds less than the checkpoint says'//way_out)
      else if (store%sums%digits() /= digits) then
         call fail(error, input_error, path//' is damaged: its checksum is not that of the '// &
            'checkpoint'//way_out)
      end if
   end subroutine attach_store

   !> Complete time steps in the file `path` and the time of the last one [T]; 0: there are none.
   subroutine read_progress(path, records, time)
      character(*), intent(in) :: path
      integer, intent(out) :: records
      real(wp), intent(out) :: time
      type(transient_store_t) :: store
      type(text_lines_t) :: lines
      type(error_t), allocatable :: error
      character(:), allocatable :: line
      real(wp) :: values(1, 1)
      integer :: length, profiles, status
      logical :: is_there

      records = 0
      time = 0.0_wp
      call open_lines(lines, path, error)
      if (allocated(error)) return
      call lines%next(is_there, error)   ! error: looked at below
      call lines%close()
      if (allocated(error)) return
      line = lines%line(:lines%length)
      profiles = index(line, ' profiles')
      if (index(line, part_words) /= 1 .or. profiles == 0) return
      store%line = line//new_line('a')
      store%nodes = number_after('nodes ')
      store%stride = max(number_after('stride '), 1)
      store%first_profile = count_of(' ', line(index(line, ' numbers ') + 1:profiles - 1)) + 1
      store%names = [character(len=name_length) :: (' ', length=1, &
         count_of(' ', trim(line(profiles + 1:))) + store%first_profile)]
      do while (place_of(store, store%records + 1) <= lines%bytes)
         store%records = store%records + 1
      end do
      if (store%records == 0) return
      call open_positional_file(store%file, path, for_writing=.false.)
      call store%file%read_reals(place_of(store, store%records - 1, 1), values)
      call store%file%close()
      records = store%records
      time = values(1, 1)

   contains

      !> The number behind `words` in the line; 0: there is none.
      function number_after(words) result(number)
         character(*), intent(in) :: words
         integer :: number, start

         number = 0
         start = index(line, words) + len(words)
         read (line(start:start + index(line(start:), ' ') - 2), '(i10)', iostat=status) number
         if (status /= 0) number = 0
      end function number_after

   end subroutine read_progress

   !> Appends one time step, with its profiles if it is one of the `stride`-th, and the checksum.
   subroutine append(self, state, summary, report)
      class(transient_store_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report
      type(checksum_t) :: sums
      real(wp), allocatable :: values(:)
      integer :: i

      allocate (values(0))
      do i = 1, merge(size(self%names), self%first_profile - 1, mod(self%records, self%stride) == 0)
         select case (self%names(i))
         case ('time')
            values = [values, state%time]
         case ('rigid_displacement')
            values = [values, state%rigid_displacement]
         case ('residual')
            values = [values, report%residual]
         case (breakdown_name)
            values = [values, merge(1.0_wp, 0.0_wp, report%breakdown%is_now)]
         case ('load_per_length', 'load')
            values = [values, state%moment%load]
         case ('reduced_radius')
            values = [values, state%moment%radius]
         case ('speed_1')
            values = [values, state%moment%speeds(1)]
         case ('speed_2')
            values = [values, state%moment%speeds(2)]
         case (profile_time_name)
            continue
         case default
            if (any(quantity_rows%name == self%names(i))) then
               values = [values, pack(summary%of%value, quantity_rows%name == self%names(i))]
            else
               values = [values, field_values(trim(self%names(i)), state)]
            end if
         end select
      end do
      sums = self%sums
      call sums%add(values)
      values = [values, transfer(sums%digits(), [0.0_wp])]
      call self%file%write_reals(place_of(self, self%records), values)
      if (allocated(self%file%failure)) return
      call sums%add(values(size(values) - digit_numbers + 1:))
      self%sums = sums
      self%records = self%records + 1
   end subroutine append

   !> Writes all series with their axes into `file`, which has /solution, where fields have this
   !> `shape`; with `has_si` those that differ in SI also below /si. A failure: the records are not
   !> what was stored.
   subroutine copy_into(self, file, scaling, has_si, shape)
      class(transient_store_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: has_si
      integer, intent(in) :: shape(:)
      type(checksum_t) :: sums
      type(label_t) :: label
      character(:), allocatable :: name
      integer :: i

      do i = 1, size(shape)
         associate (axis => coordinates(i))
            call link_object(file, '/solution/'//axis, '/transient/'//axis)
            if (has_si) call link_object(file, '/si/solution/'//axis, '/si/transient/'//axis)
         end associate
      end do
      do i = 1, size(self%names)
         name = trim(self%names(i))
         call begin_activity('writing the result, '//name)
         label = row_label(name, scaling)
         call copy_series(self, file, i, '/transient/', 1.0_wp, label, shape)
         if (has_si .and. label%has_scale()) call copy_series(self, file, i, '/si/transient/', &
            label%si_scale, new_label(label%long_name, label%si_units), shape)
      end do
      sums = sums_of(self%file, place_of(self, self%records))
      if (sums%digits() /= self%sums%digits() .and. .not. allocated(self%file%failure)) call &
         fail(self%file%failure, output_error, self%file%path &
         //' was changed by another program while the run went on')
   end subroutine copy_into

   !> Series `i` times `factor` into a group, with its axes; `shape`: of a field.
   subroutine copy_series(store, file, i, group, factor, label, shape)
      class(transient_store_t), intent(inout) :: store
      class(hdf5_file_t), intent(inout) :: file
      integer, intent(in) :: i
      character(*), intent(in) :: group
      real(wp), intent(in) :: factor
      type(label_t), intent(in) :: label
      integer, intent(in) :: shape(:)
      real(wp), allocatable :: values(:, :)
      integer, allocatable :: extents(:)
      character(:), allocatable :: path
      integer :: every, first, last, row, k

      path = group//trim(store%names(i))
      every = merge(store%stride, 1, i >= store%first_profile)
      row = merge(store%nodes, 1, i > store%first_profile)
      extents = pack(shape, i > store%first_profile)
      associate (count => (store%records + every - 1)/every)
         call write_values(file, path, file%real_type, [extents, count], c_null_ptr, label)
         if (store%names(i) == 'time' .or. store%names(i) == profile_time_name) then
            call name_axes(file, path, '=')
         else if (i > store%first_profile) then
            call name_axes(file, path, trim(merge('x y', 'x  ', size(shape) > 1))//' ' &
               //profile_time_name)
         else
            call name_axes(file, path, 'time')
         end if
         do first = 1, count, max(block_numbers/row, 1)
            last = min(first + max(block_numbers/row, 1) - 1, count)
            allocate (values(row, first:last))
            do k = first, last
               call store%file%read_reals(place_of(store, every*(k - 1), i), values(:, k:k))
            end do
            values = factor*values
            call write_records(file, path, extents, first - 1, values)
            deallocate (values)
         end do
      end associate
   end subroutine copy_series

   !> Where the record begins that has `before` records before it [bytes], or series `i` in it.
   pure function place_of(store, before, i) result(place)
      type(transient_store_t), intent(in) :: store
      integer, intent(in) :: before
      integer, intent(in), optional :: i
      integer(int64) :: place

      associate (numbers => store%first_profile - 1, profiles => size(store%names) &
         - store%first_profile)
         place = int(before, int64)*(numbers + digit_numbers) + int((before + store%stride - 1) &
            /store%stride, int64)*profiles*store%nodes
         if (present(i)) then   ! the times of profiles are those of the records
            if (i <= numbers) place = place + i - 1
            if (i > numbers + 1) place = place + numbers + int(i - numbers - 2, int64)*store%nodes
         end if
      end associate
      place = len(store%line) + real_bytes*place
   end function place_of

   !> Names of all series, and the line that says them.
   subroutine name_series(store, fields, nodes, stride)
      type(transient_store_t), intent(inout) :: store
      character(*), intent(in) :: fields(:)
      integer, intent(in) :: nodes, stride
      logical :: is_profile(size(fields))
      integer :: i

      is_profile = [(any(field_names == fields(i)), i=1, size(fields))]
      store%names = [character(len=name_length) :: number_names, pack(fields, .not. is_profile), &
         profile_time_name, pack(fields, is_profile)]
      store%first_profile = size(number_names) + count(.not. is_profile) + 1
      store%nodes = nodes
      store%stride = stride
      store%line = part_words//'nodes '//to_text(nodes)//' stride '//to_text(stride)//' numbers'
      do i = 1, size(store%names)
         if (i == store%first_profile) then
            store%line = store%line//' profiles'
         else
            store%line = store%line//' '//trim(store%names(i))
         end if
      end do
      store%line = store%line//repeat(' ', modulo(-len(store%line) - 1, real_bytes))//new_line('a')
   end subroutine name_series

end module transient_store

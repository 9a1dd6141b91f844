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
   use film_fields, only: film_passage_t
   use file_bytes, only: checksum_t, open_positional_file, positional_file_t, real_bytes, sums_of
   use hdf5_axes, only: link_object, name_axes
   use hdf5_dataset, only: label_t, new_label, write_records, write_values
   use hdf5_file, only: hdf5_file_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use quantities, only: quantity_rows
   use result_labels, only: field_names, field_values, momentum_names, row_label
   use scaling, only: scaling_t
   use signals, only: begin_activity
   use text, only: count_of, to_text
   use text_file, only: open_lines, text_lines_t
   implicit none (type, external)
   private

   public :: attach_store, create_store, read_progress, transient_store_t

   !> Longest name of a series.
   integer, parameter, public :: name_length = len(quantity_rows%name)
   !> Series of one number for each time step that every passage has, quantities among them.
   character(len=name_length), parameter :: number_names(*) = [character(len=name_length) :: &
      'time', 'rigid_displacement', 'h_min', 'p_max', 'rolling_friction_coefficient', &
      'rolling_power', 'residual']
   !> Groups of series, and how the names begin of those by the full momentum equations.
   character(*), parameter, public :: in_time = '/transient/', in_full = '/momentum/transient/'
   character(*), parameter :: of_momentum = 'momentum_'
   !> Names of all fields.
   character(len=name_length), parameter :: profile_names(*) = [field_names, momentum_names(10:)]
   !> Times of the stored profiles, which the records do not repeat.
   character(*), parameter :: profile_time_name = 'profile_time'
   !> Mark of the time steps with a film below the floor, to be named like a field.
   character(*), parameter, public :: breakdown_name = 'film_breakdown'
   !> All series of numbers, as `append` knows them.
   character(len=name_length), parameter :: known_names(*) = [character(len=name_length) :: &
      'time', 'rigid_displacement', 'residual', breakdown_name, 'load_per_length', 'load', &
      'reduced_radius', 'speed_1', 'speed_2', quantity_rows%name, momentum_names(:9)]
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
      procedure :: begin, append, copy_into
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

   !> Begins the records of the file `path` anew, with profiles of `nodes` nodes at every
   !> `stride`-th step; `fields` are names of profiles, and of series that not every passage has.
   subroutine begin(self, path, fields, nodes, stride)
      class(transient_store_t), intent(inout) :: self
      character(*), intent(in) :: path, fields(:)
      integer, intent(in) :: nodes, stride

      call self%file%close()
      call create_store(self, path)
      call name_series(self, fields, nodes, stride)
      call self%file%write_reals(0_int64, transfer(self%line, [0.0_wp]))
      call self%sums%add(transfer(self%line, [0.0_wp]))
   end subroutine begin

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
      real(wp) :: values(1)
      integer :: numbers, profiles, status
      logical :: is_there

      records = 0
      time = 0.0_wp
      call open_lines(lines, path, error)
      if (allocated(error)) return
      call lines%next(is_there, error)   ! error: looked at below
      call lines%close()
      if (allocated(error)) return
      line = lines%line(:lines%length)
      numbers = index(line, ' numbers ')
      profiles = index(line, ' profiles')
      if (index(line, part_words) /= 1 .or. profiles == 0) return
      store%line = line//new_line('a')
      store%nodes = max(number_after('nodes '), 0)
      store%stride = max(number_after('stride '), 1)
      store%first_profile = count_of(' ', line(numbers + 1:profiles - 1)) + 1
      allocate (store%names(count_of(' ', trim(line(profiles + 1:))) + store%first_profile))
      do while (place_of(store, store%records + 1) <= lines%bytes)
         store%records = store%records + 1
      end do
      if (store%records == 0) return
      call open_positional_file(store%file, path, for_writing=.false.)
      call store%file%read_reals(place_of(store, store%records - 1, 1), values)
      call store%file%close()
      records = store%records
      time = values(1)

   contains

      !> The number behind `words` in the line; 0: there is none.
      integer function number_after(words) result(number)
         character(*), intent(in) :: words
         integer :: start

         start = index(line, words) + len(words)
         read (line(start:start + index(line(start:), ' ') - 2), '(i10)', iostat=status) number
         if (status /= 0) number = 0
      end function number_after

   end subroutine read_progress

   !> Appends one time step, with its profiles if it is one of the `stride`-th, and the checksum.
   subroutine append(self, state, summary, report, passage)
      class(transient_store_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report
      type(film_passage_t), intent(in) :: passage
      type(checksum_t) :: sums
      real(wp), allocatable :: values(:)
      real(wp) :: numbers(size(known_names))
      integer :: i, k

      numbers = [state%time, state%rigid_displacement, report%residual, merge(1.0_wp, 0.0_wp, &
         report%breakdown%is_now), state%moment%load, state%moment%load, state%moment%radius, &
         state%moment%speeds, summary%of%value, passage%series]
      allocate (values(0))
      do i = 1, merge(size(self%names), self%first_profile - 1, mod(self%records, self%stride) == 0)
         k = findloc(known_names == self%names(i), .true., 1)
         if (k > 0) then
            values = [values, numbers(k)]
         else if (self%names(i) == 'momentum_pressure') then
            values = [values, passage%pressure]
         else if (self%names(i) == 'momentum_film_thickness') then
            values = [values, passage%film]
         else if (i /= self%first_profile) then
            values = [values, field_values(trim(self%names(i)), state)]
         end if
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

   !> Writes all series of a `group`, if there are any, with their axes into `file`, which has
   !> /solution with the fields of `state`; with `has_si` those that differ in SI also below /si. A
   !> failure: the records are not what was stored.
   subroutine copy_into(self, file, scaling, state, has_si, group)
      class(transient_store_t), intent(inout) :: self
      class(hdf5_file_t), intent(inout) :: file
      type(scaling_t), intent(in) :: scaling
      type(line_state_t), intent(in) :: state
      logical, intent(in) :: has_si
      character(*), intent(in) :: group
      type(checksum_t) :: sums
      type(label_t) :: label
      character(:), allocatable :: axes, name
      integer, allocatable :: extents(:)
      integer :: i

      if (any([allocated(file%failure), allocated(file%row), .not. allocated(self%names)])) return
      axes = 'x'
      extents = shape(state%x)
      if (allocated(state%y)) then
         axes = 'xy'
         extents = [extents, size(state%y)]
      end if
      do i = 1, len(axes)
         call link_object(file, '/solution/'//axes(i:i), group//axes(i:i))
         if (has_si) call link_object(file, '/si/solution/'//axes(i:i), '/si'//group//axes(i:i))
      end do
      do i = 1, size(self%names)
         name = trim(self%names(i))
         call begin_activity('writing the result, '//name)
         if (group == in_full .and. name == profile_time_name) name = of_momentum//name
         if (name /= 'time' .and. (group == in_full .neqv. index(name, of_momentum) == 1)) cycle
         label = row_label(name, scaling)
         if (index(name, of_momentum) == 1) name = name(len(of_momentum) + 1:)
         call copy_series(self, file, i, group//name, 1.0_wp, label, extents)
         if (has_si .and. label%has_scale()) call copy_series(self, file, i, '/si'//group//name, &
            label%si_scale, new_label(label%long_name, label%si_units), extents)
      end do
      sums = sums_of(self%file, place_of(self, self%records))
      if (all([sums%digits() /= self%sums%digits(), .not. allocated(self%file%failure)])) call &
         fail(self%file%failure, output_error, self%file%path &
         //' was changed by another program while the run went on')
      if (all([allocated(self%file%failure), .not. allocated(file%failure)])) file%failure = &
         self%file%failure
   end subroutine copy_into

   !> Series `i` times `factor` to a `path`, with its axes; `shape`: of a field.
   subroutine copy_series(store, file, i, path, factor, label, shape)
      class(transient_store_t), intent(inout) :: store
      class(hdf5_file_t), intent(inout) :: file
      integer, intent(in) :: i
      character(*), intent(in) :: path
      real(wp), intent(in) :: factor
      type(label_t), intent(in) :: label
      integer, intent(in) :: shape(:)
      character(:), allocatable :: axes
      real(wp), allocatable :: values(:, :)
      integer, allocatable :: extents(:)
      integer :: block, every, first, k

      every = merge(store%stride, 1, i >= store%first_profile)
      extents = pack(shape, i > store%first_profile)
      block = max(block_numbers/product(extents), 1)
      axes = 'time'
      if (any(store%names(i) == [character(len=name_length) :: 'time', profile_time_name])) axes = &
         '='
      if (i > store%first_profile) axes = trim(merge('x y', 'x  ', size(shape) > 1))//' ' &
         //profile_time_name
      associate (count => (store%records + every - 1)/every)
         call write_values(file, path, file%real_type, [extents, count], c_null_ptr, label)
         call name_axes(file, path, axes)
         do first = 1, count, block
            allocate (values(product(extents), first:min(first + block - 1, count)))
            do k = first, ubound(values, 2)
               call store%file%read_reals(place_of(store, every*(k - 1), i), values(:, k))
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

      is_profile = [(any(profile_names == fields(i)), i=1, size(fields))]
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

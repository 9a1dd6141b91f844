!> Heights in an HDF5 file: one or two dimensions, spacing or positions, read a stretch at a time.
module hdf5_heights
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use errors, only: error_t, fail, input_error
   use hdf5, only: hsize_t
   use hdf5_input, only: hdf5_input_t, hdf5_source_t, open_hdf5_input
   use profile, only: height_source_t
   use kinds, only: exceeds, int64, wp
   use length_units, only: same_unit, settle_unit, silence_fault, units_per_metre
   use measured_heights, only: height_request_t, is_position, place_words, position_fault, &
      position_range_t, scale_fault, spacing_fault
   use text, only: quoted, to_text
   implicit none (type, external)
   private

   public :: hdf5_heights_t, open_hdf5_heights

   !> Datasets beside that of the heights that hold the positions of its nodes.
   character(*), parameter :: position_names(2) = ['x', 'y']
   !> A dimension without positions in files of netCDF: its dataset says so in the attribute NAME.
   character(*), parameter :: no_positions = 'This is a netCDF dimension but not a netCDF variable'
   !> Positions that are read together.
   integer(int64), parameter :: block_nodes = 65536_int64
   !> Most nodes.
   real(wp), parameter :: max_nodes = 1.0e18_wp
   !> Relative difference of a mark of missing numbers that was rounded to single precision.
   real(wp), parameter :: same_mark = 1.0e-7_wp

   !> Metres in one unit of a dataset, as si_scale/per_metre, and whether nothing says them.
   type :: scale_t
      real(wp) :: si_scale = 1.0_wp, per_metre = 1.0_wp
      logical :: is_silent = .false.
   end type scale_t

   !> A dataset (nx) or, as h5py sees it, (ny, nx), x fastest; its file is open only while read.
   type, extends(height_source_t) :: hdf5_heights_t
      character(:), allocatable, private :: file, dataset
      !> nx, ny.
      integer(int64) :: grid(2) = 0_int64
      type(scale_t), private :: scale
      !> Whether the positions along x and y fall.
      logical, private :: falls(2) = .false.
   contains
      procedure :: get
   end type hdf5_heights_t

contains

   !> Heights of a dataset, in the unit of its attribute `units` or `unit`, or times its attribute
   !> `si_scale`. `spacing` (2) [m] from its attributes `spacing_x`, `spacing_y` or `spacing`, in
   !> the unit of `spacing_units` or `spacing_unit`, or from positions in its dimension scales or
   !> the datasets x and y beside it, in theirs; 0: there are none. Errors (input_error): no such
   !> dataset, other dimensions; unknown or different units; uneven positions; the key positions.
   subroutine open_hdf5_heights(source, request, spacing, error)
      type(hdf5_heights_t), intent(out) :: source
      type(height_request_t), intent(in) :: request
      real(wp), intent(out) :: spacing(2)
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      type(hdf5_source_t) :: values
      character(:), allocatable :: fault
      logical :: exists

      source%file = request%file
      source%dataset = request%dataset
      spacing = 0.0_wp
      call open_hdf5_input(reader, source%file, error)
      if (allocated(error)) return
      exists = reader%has(source%dataset)
      if (exists) then
         values = reader%content_of(source%dataset, are_numbers=.true.)
         call read_attributes(reader, source, request%units, spacing)
         call find_positions(reader, source, values%extents, request%units, spacing)
      end if
      call reader%close(error)
      if (allocated(error)) return
      fault = ''
      if (request%positions /= '') then
         fault = 'found the key positions, expected it for a table only'
      else if (.not. exists) then
         fault = 'found no dataset '//quoted(source%dataset)
      else if (size(values%extents) < 1 .or. size(values%extents) > 2) then
         fault = 'found '//to_text(size(values%extents))//' dimensions in '//source%dataset// &
            ', expected 1 or 2'
      else
         source%grid = 1
         source%grid(:size(values%extents)) = values%extents
         if (product(real(source%grid, wp)) > max_nodes) then
            fault = 'found too many nodes in '//source%dataset
         else
            source%nodes = product(source%grid)
         end if
      end if
      if (fault /= '') call fail(error, input_error, source%file//': '//fault)
   end subroutine open_hdf5_heights

   !> Spacing and scale of the dataset. Failures: attributes no single numbers, or of no use.
   subroutine read_attributes(reader, source, units, spacing)
      type(hdf5_input_t), intent(inout) :: reader
      type(hdf5_heights_t), intent(inout) :: source
      character(*), intent(in) :: units(2)
      real(wp), intent(inout) :: spacing(2)
      character(len=*), parameter :: names(3) = ['spacing  ', 'spacing_x', 'spacing_y']
      character(:), allocatable :: fault, unit
      real(wp) :: per_metre, stated
      integer :: i

      unit = unit_in(reader, source%dataset, 'spacing_')
      call settle_unit(unit, units(1), 'the attribute of the spacing', 'x_unit', per_metre, fault)
      call reader%refuse(source%dataset, fault)
      do i = 1, size(names)
         if (.not. reader%has_attribute(source%dataset, trim(names(i)))) cycle
         stated = reader%real_value(source%dataset, trim(names(i)))/per_metre
         call reader%refuse(trim(names(i)), spacing_fault(stated))
         if (i == 1) then
            spacing = stated
         else
            spacing(i - 1) = stated
         end if
      end do
      call find_scale(reader, source%dataset, units(2), 'z_unit', source%scale)
   end subroutine read_attributes

   !> The scale of `dataset`: from its attribute si_scale, its units or `wanted`, the unit of the
   !> `key`. Failures: two of them contradict each other.
   subroutine find_scale(reader, dataset, wanted, key, scale)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset, wanted, key
      type(scale_t), intent(out) :: scale
      character(:), allocatable :: fault, unit, word
      real(wp) :: given, stated

      unit = unit_in(reader, dataset, '')
      if (.not. reader%has_attribute(dataset, 'si_scale')) then
         scale%is_silent = unit//wanted == ''
         call settle_unit(unit, wanted, 'the attributes of '//dataset, key, scale%per_metre, fault)
         call reader%refuse(dataset, fault)
         return
      end if
      given = reader%real_value(dataset, 'si_scale')
      call reader%refuse('si_scale', scale_fault(given))
      if (allocated(reader%failure)) return
      scale%si_scale = given
      if (wanted /= '') unit = wanted
      call units_per_metre(unit, stated, word)
      if (word == '') return
      fault = ''
      if (wanted /= '') fault = ' of the key '//key
      if (abs(abs(given)*stated - 1.0_wp) > same_unit) call reader%refuse(dataset, &
         'found si_scale = '//to_text(given, 4)//' [m] beside the unit '//word//fault// &
         ', expected the same of both')
   end subroutine find_scale

   !> Spacings that are not known yet, from dimension scales or the datasets x and y, if they hold a
   !> number for each node. Failures: uneven or no positions; a unit of them or the heights only.
   subroutine find_positions(reader, source, extents, units, spacing)
      type(hdf5_input_t), intent(inout) :: reader
      type(hdf5_heights_t), intent(inout) :: source
      integer(hsize_t), intent(in) :: extents(:)
      character(*), intent(in) :: units(2)
      real(wp), intent(inout) :: spacing(2)
      type(hdf5_source_t) :: values
      type(position_range_t) :: range
      type(scale_t) :: scale
      character(:), allocatable :: path
      integer :: i

      do i = 1, min(size(extents), 2)
         if (.not. ieee_is_finite(spacing(i))) cycle
         if (spacing(i) > 0.0_wp .or. extents(i) < 2) cycle
         path = path_of_positions(reader, source%dataset, i, units)
         if (path == '') cycle
         values = reader%content_of(path, are_numbers=.false.)
         if (allocated(reader%failure)) return
         if (size(values%extents) /= 1 .or. values%values /= extents(i)) cycle
         values = reader%content_of(path, are_numbers=.true.)
         call read_positions(reader, path, extents(i), units(1), scale, range)
         call reader%refuse(path, silence_fault([scale%is_silent, source%scale%is_silent], &
            [scale%per_metre, source%scale%per_metre]/[scale%si_scale, source%scale%si_scale]))
         if (allocated(reader%failure)) return
         spacing(i) = range%distance()
         source%falls(i) = range%falls
      end do
   end subroutine find_positions

   !> Path of the dataset with the positions along dimension `i` of the heights in `dataset`: the
   !> dimension scale attached to it, if its attributes say a unit, since other scales may count
   !> pixels; x or y beside the heights; a scale whose unit the key says. Empty: there is none.
   function path_of_positions(reader, dataset, i, units) result(path)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset
      integer, intent(in) :: i
      character(*), intent(in) :: units(2)
      character(:), allocatable :: path, scale

      scale = reader%scale_of(dataset, i)
      if (scale /= '') then
         if (index(reader%text_of(scale, 'NAME'), no_positions) == 1) scale = ''
      end if
      path = scale
      if (path /= '') then
         if (unit_in(reader, path, '') /= '' .or. reader%has_attribute(path, 'si_scale')) return
      end if
      path = dataset(:index(dataset, '/', back=.true.))//position_names(i)
      if (path /= dataset .and. reader%has(path)) then
         if (index(reader%text_of(path, 'NAME'), no_positions) /= 1) return
      end if
      path = ''
      if (units(1) /= '') path = scale
   end function path_of_positions

   !> Reads `count` positions, of the `scale`, in blocks. Failures: they are uneven or wrong.
   subroutine read_positions(reader, path, count, wanted, scale, range)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: path, wanted
      integer(hsize_t), intent(in) :: count
      type(scale_t), intent(out) :: scale
      type(position_range_t), intent(out) :: range
      real(wp), allocatable :: x(:)
      character(:), allocatable :: fault
      integer(int64) :: first
      integer :: bad, i

      call find_scale(reader, path, wanted, 'x_unit', scale)
      do first = 0, count - 1, block_nodes
         allocate (x(min(block_nodes, count - first)))
         call read_heights(reader, path, [first, 0_int64], [size(x, kind=hsize_t), 1_hsize_t], x)
         if (allocated(reader%failure)) return
         bad = findloc(is_position(x), .false., dim=1)
         if (bad == 0) then
            x = x*scale%si_scale/scale%per_metre
            bad = findloc(is_position(x), .false., dim=1)
         end if
         if (bad > 0) then
            call reader%refuse(path, 'node '//to_text(first + bad)//': '//position_fault(x(bad)))
            return
         end if
         do i = 1, size(x)
            call range%add(x(i), first + i)
         end do
         deallocate (x)
      end do
      call range%find_fault(.false., fault, first)
      if (first > 0) fault = 'node '//to_text(first)//': '//fault
      call reader%refuse(path, fault)
   end subroutine read_positions

   !> The unit that an attribute of a dataset says: `units` or `unit`, behind `front`.
   function unit_in(reader, dataset, front) result(unit)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset, front
      character(:), allocatable :: unit

      unit = reader%text_of(dataset, front//'units')
      if (unit == '') unit = reader%text_of(dataset, front//'unit')
   end function unit_in

   !> Heights by rising positions, from number `first` on; of an area all. Error: reading fails.
   subroutine get(self, first, z, error)
      class(hdf5_heights_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), contiguous, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      integer(int64) :: offset
      integer(hsize_t) :: extents(2)

      call open_hdf5_input(reader, self%file, error)
      if (allocated(error)) return
      offset = first
      if (self%falls(1) .and. self%grid(2) == 1) offset = self%nodes - first - size(z)
      extents = [size(z, kind=hsize_t), 1_hsize_t]
      if (self%grid(2) > 1) extents = self%grid
      call read_heights(reader, self%dataset, [offset, 0_int64], extents, z)
      if (.not. allocated(reader%failure)) then
         associate (scale => [self%scale%si_scale, self%scale%per_metre])
            if (any(abs(scale - 1.0_wp) > 0.0_wp)) z = z*scale(1)/scale(2)
         end associate
         if (any(self%falls)) call turn(int(extents), self%falls, z)
      end if
      call reader%close(error)   ! error: handed up
   end subroutine get

   !> Turns heights `z` on a grid of `extents`, x the fastest, round along the directions that fall.
   pure subroutine turn(extents, falls, z)
      integer, intent(in) :: extents(2)
      logical, intent(in) :: falls(2)
      real(wp), intent(inout) :: z(extents(1), extents(2))

      if (falls(1)) z = z(extents(1):1:-1, :)
      if (falls(2)) z = z(:, extents(2):1:-1)
   end subroutine turn

   !> Numbers of `dataset` from `offset` on, `extents` of them along each dimension, with the
   !> attributes of packing applied. Failures: a number is missing or not valid; bad attributes.
   subroutine read_heights(reader, dataset, offset, extents, z)
      type(hdf5_input_t), intent(inout) :: reader
      character(*), intent(in) :: dataset
      integer(int64), intent(in) :: offset(2)
      integer(hsize_t), intent(in) :: extents(2)
      real(wp), contiguous, intent(out) :: z(:)
      real(wp) :: factor, marks(2), shift, valid(2)
      integer :: i
      logical :: has_marks

      call reader%read_part(dataset, offset, extents, z)
      if (reader%text_of(dataset, '_Unsigned') == 'true') call reader%refuse(dataset, &
         'found _Unsigned = true, expected an unsigned type of HDF5')
      marks = [reader%real_value(dataset, '_FillValue', huge(1.0_wp)), &
         reader%real_value(dataset, 'missing_value', huge(1.0_wp))]
      valid = [reader%real_value(dataset, 'valid_min', -huge(1.0_wp)), &
         reader%real_value(dataset, 'valid_max', huge(1.0_wp))]
      factor = reader%real_value(dataset, 'scale_factor', 1.0_wp)
      shift = reader%real_value(dataset, 'add_offset', 0.0_wp)
      if (.not. all(ieee_is_finite([factor, shift]))) then
         call reader%refuse(dataset, 'found '//to_text(factor, 4)//' and '//to_text(shift, 4)// &
            ' in scale_factor and add_offset, expected numbers')
      else if (abs(factor) <= 0.0_wp) then
         call reader%refuse('scale_factor', 'found 0, expected a number other than 0')
      end if
      if (allocated(reader%failure)) return
      has_marks = any(exceeds(-abs([marks, valid]), -huge(1.0_wp)))   ! NaN is none
      do i = 1, merge(size(z), 0, has_marks)
         if (.not. is_missing(z(i), marks, valid)) cycle
         call reader%refuse(dataset, 'node '//to_text(offset(1) + i)//': found '// &
            to_text(z(i), 4)//', the mark of a missing point (_FillValue, missing_value, '// &
            'valid_min, valid_max), expected numbers without gaps'// &
            place_words(offset(1) + i, int(extents, int64)))
         return
      end do
      if (abs(factor - 1.0_wp) > 0.0_wp .or. abs(shift) > 0.0_wp) z = z*factor + shift
   end subroutine read_heights

   !> Whether a number is one of the marks or not valid; comparing what is not finite would trap.
   pure logical function is_missing(z, marks, valid)
      real(wp), intent(in) :: z, marks(2), valid(2)
      integer :: i

      is_missing = .false.
      if (.not. ieee_is_finite(z)) return
      do i = 1, 2
         if (ieee_is_finite(marks(i))) is_missing = is_missing .or. abs(z - marks(i)) &
            <= same_mark*abs(marks(i))
         if (ieee_is_finite(valid(i))) is_missing = is_missing .or. merge(z < valid(i), &
            z > valid(i), i == 1)
      end do
   end function is_missing

end module hdf5_heights

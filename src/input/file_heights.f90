!> Heights of a file become a surface, in oil and dry: they are read from a table or HDF5, which its
!> content tells, tilt, form and the waves beyond the cut-offs are subtracted, and wrong units are
!> found.
module file_heights
   use errors, only: error_t, fail, input_error
   use file_bytes, only: checksum_t
   use gauss_filter, only: least_nodes, smooth_heights
   use hdf5_heights, only: hdf5_heights_t, open_hdf5_heights
   use hdf5_input, only: is_hdf5
   use height_form, only: closes, curvature_of, extent_of, form_of, form_t, height_sums_t, &
      rms_height, rms_slope, subtract_form, tilt_of, trend_t
   use height_table, only: conversion, height_table_t, open_table
   use profile, only: height_source_t
   use input_values, only: has_shape, input_values_t, surfaces
   use key_row, only: dry_area, has_word, point
   use kinds, only: int64, wp
   use measured_heights, only: are_heights, height_fault, height_range_t, height_request_t, &
      heights_t, is_height, place_words, range_fault
   use signals, only: begin_activity
   use system_limits, only: memory_fault
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: check_files, hold_heights, level_surface, read_surface, units_hint

   !> Keys of the filter.
   character(len=12), parameter, public :: cutoffs(2) = [character(len=12) :: 'cutoff_short', &
      'cutoff_long']
   !> Heights that are read and checked together, and those of a source that can be held together.
   integer(int64), parameter :: block_nodes = 65536_int64
   integer(int64), parameter :: max_held = 4194304_int64
   !> Rms slope [-] above which a note is given, and above which it is refused.
   real(wp), parameter :: steep = 1.0_wp, steepest = 10.0_wp
   !> Length of a profile or area above which a note is given [m].
   real(wp), parameter :: long = 1.0_wp
   !> Height of a tilt or a form over the rms height that is left, above which a note gives it.
   real(wp), parameter :: noted = 0.01_wp
   !> What a message about heights that cannot be says.
   character(*), parameter :: units_hint = ' (are the units right: x_unit, z_unit?)'

contains

   !> Reads the files of the surfaces of a case with findings that were not read before, for what is
   !> wrong with them; paths are relative to `folder` (with its slash).
   subroutine check_files(values, folder)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: folder
      class(height_source_t), allocatable :: source
      type(heights_t) :: heights
      integer :: i

      if (.not. values%has_value('case', 'problem')) return
      do i = 1, size(surfaces)
         if (values%has_read(i) .or. .not. values%has_value(surfaces(i), 'file')) cycle
         if (has_shape(values, surfaces(i), 'file')) call read_surface(values, surfaces(i), &
            folder, heights, source)
      end do
   end subroutine check_files

   !> Reads the heights of the file of the surface `group`, a path relative to `folder` (with its
   !> slash). If their source is `kept` they may be any number, and `heights` holds them only if
   !> they fit into one block. Finding: as in `open_source`; gaps.
   subroutine read_surface(values, group, folder, heights, kept)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group, folder
      type(heights_t), intent(out) :: heights
      class(height_source_t), allocatable, intent(out), optional :: kept
      class(height_source_t), allocatable :: source
      type(height_request_t) :: request
      type(error_t), allocatable :: error
      character(:), allocatable :: fault
      real(wp), parameter :: of_node = 100.0_wp   ! memory [bytes]
      integer(int64) :: block, grid(2)

      where (surfaces == group) values%has_read = .true.
      request%file = trim(values%text_value(group, 'file'))
      if (index(request%file, '/') /= 1) request%file = folder//request%file
      request%positions = trim(values%text_value(group, 'positions'))
      request%dataset = trim(values%text_value(group, 'dataset'))
      request%units(1) = trim(values%word_value(group, 'x_unit'))
      request%units(2) = trim(values%word_value(group, 'z_unit'))
      where (request%units == 'auto' .or. request%units == '?') request%units = ''
      heights%file = request%file
      call open_source(request, has_word(dry_area//' '//point, values%problem), source, grid, &
         heights%spacing, error)
      if (.not. allocated(error)) then
         block = block_nodes
         fault = ''
         if (.not. present(kept)) then
            block = source%nodes
            fault = memory_fault('a surface', of_node*block)
            if (block > huge(heights%grid)) fault = 'found '//to_text(block)//' nodes, '// &
               'expected at most '//to_text(huge(heights%grid))
         end if
         if (fault /= '') call fail(error, input_error, request%file//': '//fault)
      end if
      if (.not. allocated(error)) then
         if (.not. present(kept)) heights%grid = int(grid)
         call check_source(source, block, grid, heights, error)   ! error: below
      end if
      if (allocated(error)) then
         call values%refuse(group, 'file', error%message)
      else if (present(kept)) then
         if (source%nodes > block_nodes) deallocate (heights%z)
         call move_alloc(source, kept)
      end if
   end subroutine read_surface

   !> Subtracts tilt, form and the waves beyond the cut-offs of the surface `group` from its
   !> `heights`, which will be repeated if `is_periodic`; filtered heights are held and have no
   !> `source`. `trend`: what was subtracted, and what of a source will be. Findings: cut-offs, and
   !> heights, that cannot be. A note on a large `trend`, on steep and on long surfaces.
   subroutine level_surface(values, group, is_periodic, heights, trend, note, source)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      logical, intent(in) :: is_periodic
      type(heights_t), intent(inout) :: heights
      type(trend_t), intent(out) :: trend
      character(:), allocatable, intent(inout) :: note
      class(height_source_t), allocatable, intent(inout), optional :: source
      character(len=8), parameter :: words(-1:2) = [character(len=8) :: 'none', 'mean', 'line', &
         'parabola']
      character(:), allocatable :: fault
      integer :: degree

      degree = findloc(words == values%word_value(group, 'detrend'), .true., dim=1) - 2
      if (degree < -1) degree = 1   ! auto
      if (values%word_value(group, 'detrend') == 'auto' .and. is_periodic) then
         if (closes(heights%sums)) degree = -1
      end if
      trend%word = words(degree)
      trend%form = form_of(heights%sums, degree)
      trend%spacing = heights%spacing
      call add_sentence(note, trend_words(group, trend, rms_height(heights%sums, trend%form)))
      if (allocated(heights%z)) call subtract_form(trend%form, 0_int64, heights%z)
      if (any(values%is_given(group, cutoffs))) then
         fault = ''
         if (present(source)) call hold_heights(source, trend%form, heights%z, &
            ' with cutoff_long or cutoff_short: a filter', fault)
         if (fault == '') then
            call filter_heights(values, group, is_periodic, heights)
         else
            call values%refuse(group, 'file', fault)
         end if
      end if
      call check_heights(values, group, heights, note)
   end subroutine level_surface

   !> Reads all heights of a `source` without a `form` into `z`, unless they are held, and drops the
   !> source. `fault`: they are too many for `purpose`, or cannot be read.
   subroutine hold_heights(source, form, z, purpose, fault)
      class(height_source_t), allocatable, intent(inout) :: source
      type(form_t), intent(in) :: form
      real(wp), allocatable, intent(inout) :: z(:)
      character(*), intent(in) :: purpose
      character(:), allocatable, intent(out) :: fault
      type(error_t), allocatable :: error

      fault = ''
      if (.not. allocated(source)) return
      if (source%nodes > max_held) then
         fault = 'found a profile of '//to_text(source%nodes)//' nodes, expected at most ' &
            //to_text(max_held)//purpose//' needs all of them at once'
      else if (.not. allocated(z)) then
         allocate (z(source%nodes))
         call source%get(0_int64, z, error)
         if (allocated(error)) fault = error%message
         if (fault == '') call subtract_form(form, 0_int64, z)
      end if
      if (fault == '') deallocate (source)
   end subroutine hold_heights

   !> Finds heights above the length of the file, or steeper than a half-space can be, if no keys
   !> state their units. A note on heights that are steep or metres long.
   subroutine check_heights(values, group, heights, note)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      type(heights_t), intent(in) :: heights
      character(:), allocatable, intent(inout) :: note
      real(wp) :: length, slope
      logical :: is_stated

      is_stated = values%word_value(group, 'x_unit') /= 'auto' &
         .and. values%word_value(group, 'z_unit') /= 'auto'
      associate (sums => heights%sums)
         length = maxval((sums%grid - 1)*heights%spacing)
         slope = maxval(rms_slope(sums, heights%spacing))
         if (slope > steepest .and. .not. is_stated) then
            call values%refuse(group, 'file', heights%file// &
               ': found heights with an rms slope of '//to_text(slope, 3)//', expected at most ' &
               //to_text(nint(steepest))//units_hint)
         else if (sums%highest - sums%lowest > length .and. .not. is_stated) then
            call values%refuse(group, 'file', heights%file//': found heights that differ by ' &
               //to_text(sums%highest - sums%lowest, 3)//' m over a length of ' &
               //to_text(length, 3)//' m, expected less'//units_hint)
         else if (slope > steep) then
            call add_sentence(note, 'the heights of '//group//' have an rms slope of ' &
               //to_text(slope, 3)//units_hint)
         else if (length > long) then
            call add_sentence(note, 'the heights of '//group//' are '//to_text(length, 3) &
               //' m long'//units_hint)
         end if
      end associate
   end subroutine check_heights

   !> What was subtracted from a surface, if much over the rms height [m] that is left; else empty.
   pure function trend_words(group, trend, rms) result(words)
      character(*), intent(in) :: group
      type(trend_t), intent(in) :: trend
      real(wp), intent(in) :: rms
      character(:), allocatable :: bends, tilts, words
      character(len=5) :: axes(2)
      real(wp) :: curvature(2), extent(2), tilt(2)
      integer :: i

      extent = extent_of(trend)
      tilt = abs(tilt_of(trend))
      curvature = curvature_of(trend)
      axes = merge([' in x', ' in y'], '     ', extent(2) > 0.0_wp)
      tilts = ''
      bends = ''
      do i = 1, merge(2, 1, extent(2) > 0.0_wp)
         tilts = tilts//', '//to_text(tilt(i), 3)//', '//to_text(tilt(i)*extent(i), 3) &
            //' m over '//to_text(extent(i), 3)//' m'//trim(axes(i))
         bends = bends//', '//to_text(curvature(i), 3)//' 1/m, ' &
            //to_text(abs(curvature(i))*extent(i)**2/8.0_wp, 3)//' m high'//trim(axes(i))
      end do
      words = ''
      if (any(tilt*extent > noted*rms)) words = 'tilt '//tilts(3:)
      if (any(abs(curvature)*extent**2/8.0_wp > noted*rms)) then
         if (words /= '') words = words//' and '
         words = words//'curvature '//bends(3:)
      end if
      if (words /= '') words = words//' subtracted from the heights of '//group//" (detrend = '" &
         //trim(trend%word)//"')"
   end function trend_words

   !> Subtracts the waves beyond the cut-offs from heights that are held and without form, and makes
   !> their sums anew; heights that repeat (`is_periodic`) and close are filtered so. Findings:
   !> cut-offs of fewer than `least_nodes` spacings, longer than the file, or out of order.
   subroutine filter_heights(values, group, is_periodic, heights)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      logical, intent(in) :: is_periodic
      type(heights_t), intent(inout) :: heights
      real(wp), allocatable :: whole(:)
      real(wp) :: cutoff(2), least, most
      logical :: is_given(2), repeats
      integer :: before, grid(2), i

      before = values%findings%count
      least = least_nodes*maxval(heights%spacing, mask=heights%sums%grid > 1)
      most = minval(heights%spacing*heights%sums%grid, mask=heights%sums%grid > 1)
      is_given = values%is_given(group, cutoffs)
      cutoff = values%real_value(group, cutoffs, [0.0_wp, huge(1.0_wp)])
      do i = 1, 2
         if (is_given(i) .and. (cutoff(i) < least .or. cutoff(i) > most)) call values%refuse( &
            group, cutoffs(i), 'found '//to_text(cutoff(i))//' m, expected '//to_text(least, 3) &
            //' to '//to_text(most, 3)//' m, '//to_text(nint(least_nodes))// &
            ' spacings to the length of the file')
      end do
      if (values%findings%count == before .and. cutoff(1) >= cutoff(2)) call values%refuse(group, &
         cutoffs(1), 'found '//to_text(cutoff(1))//' m, expected less than cutoff_long, ' &
         //to_text(cutoff(2))//' m')
      if (values%findings%count > before) return
      repeats = is_periodic
      if (repeats) repeats = closes(heights%sums)
      grid = int(heights%sums%grid)
      do i = 1, 2
         if (.not. is_given(i)) cycle
         whole = heights%z
         call smooth_heights(grid, cutoff(i)/max(heights%spacing, tiny(1.0_wp)*cutoff(i)), &
            repeats, heights%z)
         if (i == 2) heights%z = whole - heights%z
      end do
      heights%sums = height_sums_t(int(grid, int64))
      call heights%sums%add(heights%z)
   end subroutine filter_heights

   !> Reads all heights of `source`, `block` of them at a time, for checksum and sums; `heights%z`
   !> are the last ones. Errors (input_error): they are not those of a surface.
   subroutine check_source(source, block, grid, heights, error)
      class(height_source_t), intent(in) :: source
      integer(int64), intent(in) :: block, grid(2)
      type(heights_t), intent(inout) :: heights
      type(error_t), allocatable, intent(out) :: error
      type(checksum_t) :: checksum
      type(height_range_t) :: range
      character(:), allocatable :: fault
      integer(int64) :: bad, first

      heights%sums = height_sums_t(grid)
      allocate (heights%z(min(block, source%nodes)))
      bad = 0
      fault = ''
      do first = 0, source%nodes - 1, block
         associate (piece => heights%z(:min(block, source%nodes - first)))
            call source%get(first, piece, error)
            if (allocated(error)) return
            if (.not. are_heights(piece)) bad = findloc(is_height(piece), .false., 1)
            if (bad > 0) fault = height_fault(piece(bad))
            if (bad > 0) bad = first + bad
            if (bad > 0) exit
            call checksum%add(piece)
            call heights%sums%add(piece)
            call range%add(piece, first + 1)
         end associate
      end do
      heights%digits = checksum%digits()
      if (fault == '') call range%find_fault(.false., fault, bad)
      if (fault == '') fault = range_fault(heights%sums%lowest, heights%sums%highest)
      if (bad > 0) fault = 'node '//to_text(bad)//': '//fault//place_words(bad, grid)
      if (fault /= '') call fail(error, input_error, heights%file//': '//fault)
   end subroutine check_source

   !> Opens a file with an area (`is_area`) or a profile of `grid` nodes (ny = 1), `spacing` [m]
   !> apart (0: it does not say). Errors (input_error): those of tables and of HDF5; fewer than two
   !> nodes; an area for a profile, or the reverse.
   subroutine open_source(request, is_area, source, grid, spacing, error)
      type(height_request_t), intent(in) :: request
      logical, intent(in) :: is_area
      class(height_source_t), allocatable, intent(out) :: source
      integer(int64), intent(out) :: grid(2)
      real(wp), intent(out) :: spacing(2)
      type(error_t), allocatable, intent(out) :: error
      type(height_table_t), allocatable :: table
      type(hdf5_heights_t), allocatable :: set
      character(:), allocatable :: fault

      grid = 1
      spacing = 0.0_wp
      fault = ''
      call begin_activity('reading '//request%file(index(request%file, '/', back=.true.) + 1:))
      if (is_hdf5(request%file)) then
         allocate (set)
         if (request%dataset == '') call fail(error, input_error, request%file//': is an HDF5 '// &
            "file, and dataset is not given, expected the path of the heights in it, as '/z'")
         if (allocated(error)) return
         call open_hdf5_heights(set, request, spacing, error)   ! error: below
         grid = set%grid
         call move_alloc(set, source)
      else
         allocate (table)
         call open_table(table, request, spacing(1), error)   ! error: below
         grid(1) = table%nodes
         call move_alloc(table, source)
         if (is_area) fault = conversion(request%file)
      end if
      if (allocated(error)) return
      if (source%nodes < 2) then
         fault = 'found '//to_text(source%nodes)//' nodes, expected at least 2'
      else if (is_area .and. grid(2) == 1) then
         fault = 'found a profile, expected an area'//fault
      else if (grid(2) > 1 .and. .not. is_area) then
         fault = "found an area, expected a profile: problem = 'dry_area' takes areas"
      else
         fault = ''
      end if
      if (fault /= '') call fail(error, input_error, request%file//': '//fault)
   end subroutine open_source

end module file_heights

!> Heights of a file, a table or HDF5 by its content, become a surface, in oil and dry: tilt, form
!> and the waves beyond the cut-offs are subtracted, and wrong units are found.
module file_heights
   use errors, only: error_t, fail, input_error
   use file_bytes, only: checksum_t
   use gauss_filter, only: least_nodes, smooth_heights
   use hdf5_heights, only: hdf5_heights_t, open_hdf5_heights
   use hdf5_input, only: is_hdf5
   use height_form, only: closes, curvature_of, extent_of, form_of, height_sums_t, rms_height, &
      rms_slope, subtract_form, tilt_of, trend_t
   use height_table, only: conversion, height_table_t, open_table
   use input_values, only: has_shape, input_values_t, surfaces
   use key_row, only: dry_area, has_word, lubricated, point
   use kinds, only: int64, wp
   use measured_heights, only: height_fault, height_range_t, height_request_t, heights_t, &
      is_height, place_words
   use signals, only: begin_activity
   use system_limits, only: memory_fault
   use text, only: add_sentence, to_text
   implicit none (type, external)
   private

   public :: hold_heights, level_surface, read_files, units_hint

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
   !> Highest less lowest point of a surface that is not flat, at least [m].
   real(wp), parameter :: least_range = 1.0e-20_wp
   !> What a message about heights that cannot be says.
   character(*), parameter :: units_hint = ' (are the units right: x_unit, z_unit?)'

contains

   !> Reads the `files` of the surfaces of a case, with findings or not, for what is wrong with them
   !> too: those have no name. `folder` of the namelist (with its slash). Findings: the files.
   subroutine read_files(values, folder, files)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: folder
      type(heights_t), allocatable, intent(out) :: files(:)
      type(error_t), allocatable :: error
      integer :: i

      allocate (files(size(surfaces)))
      if (.not. values%has_value('case', 'problem')) return
      do i = 1, size(surfaces)
         if (.not. (values%has_value(surfaces(i), 'file') .and. has_shape(values, surfaces(i), &
            'file'))) cycle
         call read_surface(values, surfaces(i), folder, files(i), error)
         if (.not. allocated(error)) cycle
         call values%refuse(surfaces(i), 'file', error%message)
         deallocate (files(i)%file)
      end do
   end subroutine read_files

   !> Reads the heights of the file of the surface `group`. A lubricated line keeps their source, so
   !> that they may be any number, and holds them only if they fit into one block.
   subroutine read_surface(values, group, folder, heights, error)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, folder
      type(heights_t), intent(inout) :: heights
      type(error_t), allocatable, intent(out) :: error
      type(height_request_t) :: request
      character(:), allocatable :: fault
      real(wp), parameter :: of_node = 100.0_wp   ! memory [bytes]
      logical :: is_kept

      is_kept = values%problem == lubricated
      request%file = trim(values%text_value(group, 'file'))
      if (index(request%file, '/') /= 1) request%file = folder//request%file
      request%positions = trim(values%text_value(group, 'positions'))
      request%dataset = trim(values%text_value(group, 'dataset'))
      request%units(1) = trim(values%word_value(group, 'x_unit'))
      request%units(2) = trim(values%word_value(group, 'z_unit'))
      where (request%units == 'auto' .or. request%units == '?') request%units = ''
      heights%file = request%file
      call open_source(request, has_word(dry_area//' '//point, values%problem), heights, error)
      if (allocated(error)) return
      associate (nodes => heights%source%nodes)
         fault = ''
         if (.not. is_kept) fault = memory_fault('a surface', of_node*nodes)
         if (.not. is_kept .and. nodes > huge(1)) fault = 'found '//to_text(nodes)// &
            ' nodes, expected at most '//to_text(huge(1))
         if (fault /= '') call fail(error, input_error, request%file//': '//fault)
         if (.not. allocated(error)) call check_source(heights, merge(block_nodes, nodes, &
            is_kept), error)
         if (allocated(error)) return
         if (is_kept .and. nodes > block_nodes) deallocate (heights%z)
      end associate
      if (.not. is_kept) deallocate (heights%source)
   end subroutine read_surface

   !> Subtracts tilt, form and the waves beyond the cut-offs of the surface `group` from its
   !> `heights`, which will be repeated if `is_periodic`; filtered heights are held. Findings:
   !> cut-offs, and heights, that cannot be. A note on a large trend, on steep and long surfaces.
   subroutine level_surface(values, group, is_periodic, heights, note)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: group
      logical, intent(in) :: is_periodic
      type(heights_t), intent(inout) :: heights
      character(:), allocatable, intent(inout) :: note
      character(len=8), parameter :: words(-1:2) = [character(len=8) :: 'none', 'mean', 'line', &
         'parabola']
      character(:), allocatable :: fault
      integer :: degree

      degree = findloc(words == values%word_value(group, 'detrend'), .true., dim=1) - 2
      if (degree < -1) degree = 1   ! auto
      if (values%word_value(group, 'detrend') == 'auto' .and. is_periodic) then
         if (closes(heights%sums)) degree = -1
      end if
      associate (trend => heights%trend)
         trend%word = words(degree)
         trend%form = form_of(heights%sums, degree)
         trend%spacing = heights%spacing
         call add_sentence(note, trend_words(group, trend, rms_height(heights%sums, trend%form)))
         if (allocated(heights%z)) call subtract_form(trend%form, 0_int64, heights%z)
      end associate
      if (any(values%is_given(group, cutoffs))) then
         call hold_heights(heights, ' with cutoff_long or cutoff_short: a filter', fault)
         if (fault == '') then
            call filter_heights(values, group, is_periodic, heights)
         else
            call values%refuse(group, 'file', fault)
         end if
      end if
      call check_heights(values, group, heights, note)
   end subroutine level_surface

   !> Reads all heights, without their form, unless they are held, and drops their source. `fault`:
   !> they are too many for `purpose`, or cannot be read.
   subroutine hold_heights(heights, purpose, fault)
      type(heights_t), intent(inout) :: heights
      character(*), intent(in) :: purpose
      character(:), allocatable, intent(out) :: fault
      type(error_t), allocatable :: error

      fault = ''
      if (.not. allocated(heights%source)) return
      if (heights%source%nodes > max_held) then
         fault = 'found a profile of '//to_text(heights%source%nodes)//' nodes, expected at most ' &
            //to_text(max_held)//purpose//' needs all of them at once'
      else if (.not. allocated(heights%z)) then
         allocate (heights%z(heights%source%nodes))
         call heights%source%get(0_int64, heights%z, error)
         if (allocated(error)) fault = error%message
         if (fault == '') call subtract_form(heights%trend%form, 0_int64, heights%z)
      end if
      if (fault == '') deallocate (heights%source)
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

   !> Reads all heights of the source, `block` of them at a time, for checksum and sums; `heights%z`
   !> are the last ones. Errors (input_error): they are not those of a surface.
   subroutine check_source(heights, block, error)
      type(heights_t), intent(inout) :: heights
      integer(int64), intent(in) :: block
      type(error_t), allocatable, intent(out) :: error
      type(checksum_t) :: checksum
      type(height_range_t) :: range
      character(:), allocatable :: fault
      integer(int64) :: bad, first
      real(wp) :: difference

      associate (nodes => heights%source%nodes)
         allocate (heights%z(min(block, nodes)))
         bad = 0
         fault = ''
         do first = 0, nodes - 1, block
            associate (piece => heights%z(:min(block, nodes - first)))
               call heights%source%get(first, piece, error)
               if (allocated(error)) return
               bad = findloc(is_height(piece), .false., 1)
               if (bad > 0) then
                  fault = height_fault(piece(bad))
                  bad = first + bad
                  exit
               end if
               call checksum%add(piece)
               call heights%sums%add(piece)
               call range%add(piece, first + 1)
            end associate
         end do
      end associate
      heights%digits = checksum%digits()
      if (fault == '') call range%find_fault(.false., fault, bad)
      if (fault == '') then
         difference = heights%sums%highest - heights%sums%lowest
         if (difference > 0.0_wp .and. difference < least_range) fault = 'found heights that '// &
            'differ by '//to_text(difference, 4)//' m, expected 0 or at least ' &
            //to_text(least_range, 2)//' m'
      end if
      if (bad > 0) fault = 'node '//to_text(bad)//': '//fault//place_words(bad, heights%sums%grid)
      if (fault /= '') call fail(error, input_error, heights%file//': '//fault)
   end subroutine check_source

   !> Opens a file with an area (`is_area`) or a profile: source, grid, spacing, if any, of heights.
   !> Errors (input_error): the file; fewer than two nodes; an area for a profile, or the reverse.
   subroutine open_source(request, is_area, heights, error)
      type(height_request_t), intent(in) :: request
      logical, intent(in) :: is_area
      type(heights_t), intent(inout) :: heights
      type(error_t), allocatable, intent(out) :: error
      type(height_table_t), allocatable :: table
      type(hdf5_heights_t), allocatable :: set
      character(:), allocatable :: fault, hint

      hint = ''
      call begin_activity('reading '//request%file(index(request%file, '/', back=.true.) + 1:))
      associate (grid => heights%sums%grid)
         grid = 1
         if (is_hdf5(request%file)) then
            allocate (set)
            if (request%dataset == '') call fail(error, input_error, request%file//': is an '// &
               'HDF5 file, and dataset is not given, expected the path of the heights in it, '// &
               "as '/z'")
            if (allocated(error)) return
            call open_hdf5_heights(set, request, heights%spacing, error)   ! error: below
            grid = set%grid
            call move_alloc(set, heights%source)
         else
            allocate (table)
            call open_table(table, request, heights%spacing(1), error)   ! error: below
            grid(1) = table%nodes
            call move_alloc(table, heights%source)
            hint = conversion(request%file)
         end if
         if (allocated(error)) return
         fault = ''
         if (heights%source%nodes < 2) then
            fault = 'found '//to_text(heights%source%nodes)//' nodes, expected at least 2'
         else if (is_area .and. grid(2) == 1) then
            fault = 'found a profile, expected an area'//hint
         else if (grid(2) > 1 .and. .not. is_area) then
            fault = "found an area, expected a profile: problem = 'dry_area' takes areas"
         end if
      end associate
      if (fault /= '') call fail(error, input_error, request%file//': '//fault)
   end subroutine open_source

end module file_heights

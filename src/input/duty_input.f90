!> &history: from the table of loads, radii and speeds to a reference state and rows in SI.
module duty_input
   use body_input, only: speeds
   use column_table, only: column_table_t, read_columns
   use duty, only: duty_rows_t, of_angle, of_load, of_radius, of_speeds, of_time
   use errors, only: error_t, fail, input_error
   use input_values, only: input_values_t
   use key_row, only: point
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: read_duty

   !> Columns, their keys in the namelist, those of the load of lines and points, and their limits.
   character(len=24), parameter :: columns(*) = [character(len=24) :: 'time [s]', 'angle [deg]', &
      'load_per_length [N/m]', 'reduced_radius [m]', 'speed_1 [m/s]', 'speed_2 [m/s]'], &
      load_of_points = 'load [N]'
   character(len=15), parameter :: groups(*) = [character(len=15) :: '', '', 'load', 'bodies', &
      'bodies', 'bodies'], keys_of_lines(*) = [character(len=15) :: '', '', &
      'load_per_length', 'reduced_radius', 'speed_1', 'speed_2'], key_of_points = 'load'
   real(wp), parameter :: least(*) = [-1.0e9_wp, -1.0e12_wp, 1.0e-6_wp, 1.0e-9_wp, -1.0e4_wp, &
      -1.0e4_wp], largest(*) = [1.0e9_wp, 1.0e12_wp, 1.0e12_wp, 1.0e9_wp, 1.0e4_wp, 1.0e4_wp]
   real(wp), parameter :: usual(*) = [0.0_wp, 0.0_wp, 1.0e5_wp, 0.01_wp, 1.0_wp, 1.0_wp]
   !> Shortest table [s].
   real(wp), parameter :: shortest = 1.0e-12_wp
   real(wp), parameter :: degrees_of_a_turn = 360.0_wp, seconds_of_a_minute = 60.0_wp

contains

   !> Reads the table of &history, if any, a path relative to `folder` (with its slash), and gives
   !> the keys of its columns their values in the reference state: the largest load times radius, of
   !> which the contact is the widest, and the largest u1 + u2. Findings: the table.
   subroutine read_duty(values, folder, rows)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: folder
      type(duty_rows_t), allocatable, intent(out) :: rows
      type(column_table_t) :: table
      type(error_t), allocatable :: error
      character(:), allocatable :: file
      character(len=15) :: keys(size(keys_of_lines))
      integer :: i, widest

      keys = keys_of_lines
      keys(of_load) = merge(key_of_points, keys(of_load), values%problem == point)
      if (.not. values%has_value('history', 'file')) return
      allocate (rows)
      file = trim(values%text_value('history', 'file'))
      if (file == '') then
         call fail(error, input_error, 'found an empty text, expected the name of a file')
      else
         if (index(file, '/') /= 1) file = folder//file
         table = column_table_t([columns(:of_angle), merge(load_of_points, columns(of_load), &
            values%problem == point), columns(of_radius:)], least, largest, heads=2)
         call read_columns(file, table, error)
      end if
      if (.not. allocated(error)) then
         rows%has = table%has
         call move_alloc(table%values, rows%values)
         rows%digits = table%digits
         call check_columns(values, rows, file, error)
      end if
      if (allocated(error)) then
         call values%refuse('history', 'file', error%message)
         deallocate (rows)
         do i = of_load, of_speeds(2)   ! what the table may have had is not missing
            if (.not. values%is_given(groups(i), keys(i)) .and. other_way(values, i) &
               == '') call values%give(groups(i), keys(i), usual(i))
         end do
         return
      end if
      rows%is_linear = values%word_value('history', 'interpolation') == 'linear'
      rows%is_periodic = values%logical_value('history', 'periodic')
      associate (of => rows%values, has => rows%has)
         widest = maxloc(merge(of(:, of_load), 1.0_wp, has(of_load)) &
            *merge(of(:, of_radius), 1.0_wp, has(of_radius)), 1)
         do i = of_load, of_radius
            if (has(i)) call values%give(groups(i), keys(i), of(widest, i))
         end do
         do i = 1, 2
            if (.not. has(of_speeds(i))) of(:, of_speeds(i)) = values%real_value('bodies', &
               speeds(i))
         end do
         widest = maxloc(of(:, of_speeds(1)) + of(:, of_speeds(2)), 1)
         do i = 1, 2
            if (has(of_speeds(i))) call values%give('bodies', speeds(i), of(widest, of_speeds(i)))
         end do
      end associate
      call check_motion(values, rows, file)
   end subroutine read_duty

   !> The key that gives in another way what a column has; empty: there is none.
   function other_way(values, column) result(key)
      type(input_values_t), intent(in) :: values
      integer, intent(in) :: column
      character(:), allocatable :: key
      character(len=14) :: others(2)
      integer :: i

      key = ''
      if (.not. any(column == [of_load, of_radius])) return
      others = [character(len=14) :: 'radius_1', 'radius_2']
      if (column == of_load) others = [character(len=14) :: 'load', 'hertz_pressure']
      do i = merge(2, 1, column == of_load .and. values%problem == point), size(others)
         if (values%is_given(groups(column), others(i))) key = trim(others(i))
      end do
   end function other_way

   !> Finds a contact that never moves forwards, or whose start at rest is not forgotten.
   subroutine check_motion(values, rows, file)
      type(input_values_t), intent(inout) :: values
      type(duty_rows_t), intent(in) :: rows
      character(*), intent(in) :: file
      logical :: never
      integer :: i

      if (.not. all(values%has_value('bodies', speeds))) return
      associate (sum => rows%values(:, of_speeds(1)) + rows%values(:, of_speeds(2)))
         never = any(rows%has(of_speeds)) .and. .not. maxval(sum) > 0.0_wp
         if (never) then
            call values%refuse('history', 'file', file//': found speed_1 + speed_2 <= 0 in '// &
               'every row, expected a sum > 0 in one of them: oil is drawn in at X < 0')
         else if (.not. (abs(sum(1)) > 0.0_wp .or. (rows%is_periodic .and. .not. &
            any(values%is_given('time', ['end_time', 'duration']))))) then
            call values%refuse('history', 'file', file//': found speed_1 + speed_2 = 0 in the '// &
               'first row, expected a history that begins in motion, or a periodic one without '// &
               'an end: at rest no film is known')
         end if
      end associate
      do i = 1, merge(2, 0, never)   ! one finding is enough
         call values%give('bodies', speeds(i), usual(of_speeds(i)))
      end do
   end subroutine check_motion

   !> Turns angles into times, from the first row on. Finds an angle or a speed of rotation alone, a
   !> column beside another way to give the same, and radii of a point that change.
   subroutine check_columns(values, rows, file, error)
      type(input_values_t), intent(in) :: values
      type(duty_rows_t), intent(inout) :: rows
      character(*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      integer :: i

      fault = ''
      do i = of_radius, of_load, -1
         if (rows%has(i) .and. other_way(values, i) /= '') fault = 'found '//trim(columns(i))// &
            ' together with &'//trim(groups(i))//' '//other_way(values, i)// &
            ', expected one of the two'
      end do
      if (values%problem == point .and. rows%has(of_radius)) fault = 'found '// &
         trim(columns(of_radius))//', expected load, speed_1, speed_2: the radii of a point '// &
         'contact stay'
      associate (has_speed => values%has_value('history', 'speed_rpm'), of => rows%values)
         if (rows%has(of_angle)) of(:, of_time) = of(:, of_angle)*seconds_of_a_minute &
            /(degrees_of_a_turn*values%real_value('history', 'speed_rpm', 1.0_wp))
         of(:, of_time) = of(:, of_time) - of(1, of_time)
         if (of(size(of, 1), of_time) < shortest) fault = 'found a table over '// &
            to_text(of(size(of, 1), of_time), 3)//' s, expected at least '//to_text(shortest, 1) &
            //' s'
         if (has_speed .and. .not. rows%has(of_angle)) fault = 'found times with &history '// &
            'speed_rpm, expected the column '//trim(columns(of_angle))
         if (rows%has(of_angle) .and. .not. has_speed) fault = 'found angles, '// &
            'expected &history speed_rpm with them'
      end associate
      if (fault /= '') call fail(error, input_error, file//': '//fault)
   end subroutine check_columns

end module duty_input

!> Heights in a table of text, read a stretch at a time. Such tables have one strict form: any other
!> is refused with the command that converts it.
!>
!> A first pass notes where every 4096th row begins, to find any row without holding the table.
module height_table
   use errors, only: error_t, fail, input_error
   use profile, only: height_source_t
   use kinds, only: int64, wp
   use length_units, only: find_unit, settle_unit, silence_fault, unit_among
   use measured_heights, only: height_fault, height_range_t, height_request_t, is_height, &
      is_position, position_fault, position_range_t
   use number_text, only: read_real
   use text, only: counted, quoted, to_text
   use text_file, only: encoding_fault, open_lines, text_lines_t
   implicit none (type, external)
   private

   public :: conversion, height_table_t, next_row, open_table, shown, split

   character(*), parameter :: tab = achar(9), blanks = ' '//tab
   !> Rows from one noted place to the next; the shortest row [bytes].
   integer(int64), parameter :: block_rows = 4096_int64, least_bytes = 4_int64

   !> The columns of positions and heights. The file is open only while it is read.
   type, extends(height_source_t) :: height_table_t
      character(:), allocatable, private :: file
      !> Separator of fields, a blank for any number of blanks; decimal mark, a blank while unknown.
      character(len=1), private :: separator = ' ', decimal = '.'
      !> Number of columns; those of positions and heights, and their units in a metre.
      integer, private :: columns = 2, used(2) = [1, 2]
      real(wp), private :: per_metre(2) = 1.0_wp
      !> First byte and line number of rows 0, block_rows, 2 block_rows, ... (2, n).
      integer(int64), allocatable, private :: places(:, :)
   contains
      procedure :: get
   end type height_table_t

contains

   !> Opens a table, reads it through and finds the `spacing` [m] of its rows. Errors (input_error),
   !> with the line: another form; units that are unknown or contradict the keys; positions that do
   !> not rise evenly; heights that cannot be those of a surface.
   subroutine open_table(table, request, spacing, error)
      type(height_table_t), intent(out) :: table
      type(height_request_t), intent(in) :: request
      real(wp), intent(out) :: spacing
      type(error_t), allocatable, intent(out) :: error
      type(text_lines_t) :: lines
      character(:), allocatable :: fault, stated, unit
      logical :: is_there
      integer :: place

      table%file = request%file
      spacing = 0.0_wp
      unit = ''
      call open_lines(lines, request%file, error)
      if (allocated(error)) return
      do   ! comments, up to the names or the first row of numbers
         call lines%next(is_there, error)
         if (allocated(error)) exit
         call encoding_fault(lines%line(:lines%length), fault, place)
         if (place > 0) fault = 'found '//fault//', expected a table in UTF-8, or HDF5'
         if (.not. is_there) fault = 'found no rows, expected positions and heights in two columns'
         if (fault /= '' .or. is_row(lines)) exit
         stated = unit_among(lines%line(:lines%length))
         if (unit == '') unit = stated
      end do
      if (.not. allocated(error)) then
         if (fault == '') call find_columns(table, lines, unit, request, fault)
         if (fault /= '') call refuse(lines, lines%number, 1, fault, error)
      end if
      if (.not. allocated(error)) call read_rows(table, lines, spacing, error)   ! error: handed up
      call lines%close()
   end subroutine open_table

   !> Separator, columns and units, from the first line that is no comment: names, or numbers, which
   !> are read again. `unit` is one in a comment. `fault`: where they are not clear.
   subroutine find_columns(table, lines, unit, request, fault)
      type(height_table_t), intent(inout) :: table
      type(text_lines_t), intent(inout) :: lines
      character(*), intent(in) :: unit
      type(height_request_t), intent(in) :: request
      character(:), allocatable, intent(inout) :: fault
      character(:), allocatable :: row
      integer, allocatable :: bounds(:, :)
      integer :: i, numbers

      row = lines%line(:lines%length)
      if (index(row, ',') > 0) table%separator = ','
      if (index(row, ';') > 0) table%separator = ';'
      if (index(row, tab) > 0) table%separator = tab
      if (scan(table%separator, tab//';') > 0) table%decimal = ' '
      do i = merge(len(row) - 1, 0, table%separator == ' '), 1, -1
         if (row(i:i) == ' ' .and. scan(row(i + 1:), '[({') == 1) row = row(:i - 1)//row(i + 1:)
      end do
      allocate (bounds(2, len(row) + 1))
      call split(table%separator, row, bounds, table%columns)
      bounds = bounds(:, :table%columns)
      numbers = count([(scan(row(bounds(1, i):bounds(2, i)), '+-.0123456789') == 1, i=1, &
         table%columns)])
      if (table%columns == 1) then
         fault = 'found one column, expected two, positions and heights'
      else if (index(row, '"') > 0 .or. numbers > 0 .and. numbers < table%columns) then
         fault = 'found '//shown(row)//', expected names or numbers, without quotes'
      else if (table%columns > 2 .and. (numbers > 0 .or. request%dataset == '' .or. &
         request%positions == '')) then
         fault = 'found '//to_text(table%columns)//' columns, expected two, or names and the '// &
            'keys positions and dataset with two of them'
      else if (numbers > 0 .and. request%dataset//request%positions /= '') then
         fault = 'found no names, expected those of the keys positions and dataset'
      else
         call settle_columns(table, row, bounds(:, :merge(0, table%columns, numbers > 0)), unit, &
            request, fault)
      end if
      if (numbers > 0 .and. fault == '') call lines%seek(lines%place, lines%number)
   end subroutine find_columns

   !> The two wanted columns, by their names with units or without, and their units; `bounds` (2, n)
   !> are those of the names in `row`. `fault`: there is none of a name, or more than one; units.
   subroutine settle_columns(table, row, bounds, unit, request, fault)
      type(height_table_t), intent(inout) :: table
      character(*), intent(in) :: row, unit
      integer, intent(in) :: bounds(:, :)
      type(height_request_t), intent(in) :: request
      character(:), allocatable, intent(inout) :: fault
      character(len=6), parameter :: keys(2) = ['x_unit', 'z_unit']
      character(:), allocatable :: in_name, stated, wanted
      integer :: found, i, k, last
      logical :: is_silent(2)

      do k = 1, 2
         wanted = request%positions
         if (k == 2) wanted = request%dataset
         stated = ''
         found = 0
         do i = 1, size(bounds, 2)
            associate (name => row(bounds(1, i):bounds(2, i)))
               call find_unit(name, in_name, last)
               if (merge(i == table%used(k), name == wanted .or. name(:last) == wanted, wanted &
                  == '')) then
                  found = found + 1
                  table%used(k) = i
                  stated = in_name
               end if
            end associate
         end do
         if (found /= min(size(bounds, 2), 1)) then
            fault = 'found '//counted(found, 'column')//' '//quoted(wanted)//' in the names ' &
               //shown(row)//', expected one'
         else
            call settle_unit(stated, request%units(k), 'the names '//shown(row), keys(k), &
               table%per_metre(k), fault)
         end if
         if (fault /= '') return
         is_silent(k) = stated//request%units(k) == ''
      end do
      if (table%used(1) == table%used(2)) then
         fault = 'found positions and heights in the same column, expected two'
      else if (any(is_silent) .and. unit /= '') then
         fault = "found the unit '"//unit//"' in a comment, expected units in the names (as in "// &
            'x_mm,z_um) or the keys x_unit and z_unit'
      else
         fault = silence_fault(is_silent, table%per_metre)
      end if
   end subroutine settle_columns

   !> Reads all rows, notes where they are and checks their positions and heights.
   subroutine read_rows(table, lines, spacing, error)
      type(height_table_t), intent(inout) :: table
      type(text_lines_t), intent(inout) :: lines
      real(wp), intent(out) :: spacing
      type(error_t), allocatable, intent(out) :: error
      type(height_range_t) :: heights
      type(position_range_t) :: positions
      character(:), allocatable :: fault
      real(wp) :: numbers(2)
      integer(int64) :: line
      integer :: mark

      spacing = 0.0_wp
      allocate (table%places(2, lines%bytes/(block_rows*least_bytes) + 1))
      do
         call next_row(lines, line, error)
         if (allocated(error)) return
         if (line == 0) exit
         if (modulo(table%nodes, block_rows) == 0) table%places(:, table%nodes/block_rows + 1) = &
            [lines%place, line]
         mark = 0
         if (table%decimal == ' ') mark = scan(lines%line(:lines%length), '.,')
         if (mark > 0) table%decimal = lines%line(mark:mark)
         call read_row(table, lines, 1, numbers, error)
         if (allocated(error)) return
         call positions%add(numbers(1)/table%per_metre(1), line)
         call heights%add(numbers(2:), line)
         table%nodes = table%nodes + 1
      end do
      call positions%find_fault(.true., fault, line)
      if (fault == '') call heights%find_fault(.true., fault, line)
      if (fault == '') spacing = positions%distance()
      if (fault /= '') call refuse(lines, merge(line, lines%number - 1, line > 0), 1, fault, error)
   end subroutine read_rows

   !> Heights from row number `first` on. Error: fewer rows than before, or others.
   subroutine get(self, first, z, error)
      class(height_table_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), contiguous, intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      type(text_lines_t) :: lines
      real(wp) :: numbers(2)
      integer(int64) :: block, line, row

      z = 0.0_wp
      block = first/block_rows + 1
      call open_lines(lines, self%file, error)
      if (allocated(error)) return
      call lines%seek(self%places(1, block), self%places(2, block))
      do row = (block - 1)*block_rows, first + size(z) - 1
         call next_row(lines, line, error)
         if (allocated(error)) exit
         if (line == 0) call fail(error, input_error, self%file//' has fewer rows than before')
         if (line > 0 .and. row >= first) call read_row(self, lines, 2, numbers, error)
         if (allocated(error)) exit
         if (row >= first) z(row - first + 1) = numbers(2)/self%per_metre(2)
      end do
      call lines%close()
   end subroutine get

   !> Goes to the next row, in line number `line`; 0: there is none. Errors: those of reading.
   subroutine next_row(lines, line, error)
      type(text_lines_t), intent(inout) :: lines
      integer(int64), intent(out) :: line
      type(error_t), allocatable, intent(out) :: error
      logical :: is_there

      do
         call lines%next(is_there, error)
         if (allocated(error) .or. .not. is_there) exit
         line = lines%number
         if (is_row(lines)) return
      end do
      line = 0
   end subroutine next_row

   !> Whether the present line is neither blank nor a comment.
   pure logical function is_row(lines)
      type(text_lines_t), intent(in) :: lines
      integer :: first

      first = verify(lines%line(:lines%length), blanks)
      is_row = first > 0
      if (is_row) is_row = scan(lines%line(first:first), '#%') == 0
   end function is_row

   !> The `numbers` of the present line as they are written: the height, and with `first` = 1 the
   !> position. Errors, with line and byte: no numbers, or none that can be; other fields.
   subroutine read_row(table, lines, first, numbers, error)
      type(height_table_t), intent(in) :: table
      type(text_lines_t), intent(in) :: lines
      integer, intent(in) :: first
      real(wp), intent(out) :: numbers(2)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      character(len=lines%length) :: number
      integer :: bounds(2, table%columns), fields, k, mark
      logical :: good
      real(wp) :: metres

      numbers = 0.0_wp
      associate (row => lines%line(:lines%length))
         call split(table%separator, row, bounds, fields)
         if (fields /= table%columns) call refuse(lines, lines%number, 1, 'found '// &
            counted(fields, 'field')//', expected the '//to_text(table%columns)// &
            ' of the first row', error)
         do k = first, merge(0, 2, allocated(error))
            associate (field => row(bounds(1, table%used(k)):bounds(2, table%used(k))))
               number = field
               mark = index(field, table%decimal)   ! a blank: there is none
               if (table%decimal == ',' .and. mark > 0) number(mark:mark) = '.'
               call read_real(number(:len(field)), numbers(k), good)
               if (table%decimal == ',') good = good .and. index(field, '.') == 0
               metres = numbers(k)/table%per_metre(k)
               if (good .and. merge(is_position(metres), is_height(metres), k == 1)) cycle
               fault = 'found '//shown(field)//', expected a number'
               if (table%decimal == ',') fault = fault//' with a decimal comma, as above'
               if (good .and. k == 1) fault = position_fault(metres)
               if (good .and. k == 2) fault = height_fault(metres)
            end associate
            call refuse(lines, lines%number, bounds(1, table%used(k)), fault, error)
            return
         end do
      end associate
   end subroutine read_row

   !> Where the fields of `row` are without the blanks around them: first and last byte of as many
   !> as `bounds` (2, n) has room for. `fields`: how many there are.
   pure subroutine split(separator, row, bounds, fields)
      character(len=1), intent(in) :: separator
      character(*), intent(in) :: row
      integer, intent(out) :: bounds(:, :), fields
      integer :: length, start

      fields = 0
      start = 1
      do while (start <= len(row) + 1)
         if (separator == ' ') then
            length = verify(row(start:), blanks)
            if (length == 0) exit
            start = start + length - 1
            length = scan(row(start:), blanks) - 1
         else
            length = index(row(start:), separator) - 1
         end if
         if (length < 0) length = len(row) - start + 1
         fields = fields + 1
         associate (field => row(start:start + length - 1))
            if (fields <= size(bounds, 2)) bounds(:, fields) = start - 1 + [max(verify(field, &
               blanks), 1), verify(field, blanks, back=.true.)]
         end associate
         start = start + length + 1
      end do
   end subroutine split

   !> What a file says, in quotes and short.
   pure function shown(string)
      character(*), intent(in) :: string
      character(:), allocatable :: shown

      shown = quoted(string)
      if (string /= '') shown = "'"//shown//"'"
   end function shown

   !> Error with the place, byte `column` of line `number`, and the command.
   subroutine refuse(lines, number, column, fault, error)
      type(text_lines_t), intent(in) :: lines
      integer(int64), intent(in) :: number
      integer, intent(in) :: column
      character(*), intent(in) :: fault
      type(error_t), allocatable, intent(out) :: error

      call fail(error, input_error, lines%file//':'//to_text(number)//':'//to_text(column) &
         //': '//fault//conversion(lines%file))
   end subroutine refuse

   !> The end of a message: the command that converts a file, as a shell takes it.
   pure function conversion(file) result(words)
      character(*), intent(in) :: file
      character(:), allocatable :: words
      integer :: last

      last = index(file, '.', back=.true.) - 1
      if (last <= index(file, '/', back=.true.)) last = len(file)
      words = file(:last)//'.h5'
      if (words == file) words = file(:last)//'_heights.h5'
      if (index(file, ' ') == 0) then
         words = '; to convert it: asperity-heights '//file//' '//words
      else
         words = '; to convert it: asperity-heights "'//file//'" "'//words//'"'
      end if
   end function conversion

end module height_table

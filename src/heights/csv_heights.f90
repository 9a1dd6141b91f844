!> Heights in a CSV table: a header line, then rows with x in the first column; read a stretch at a
!> time.
!>
!> A first pass over the file notes where every 4096th row begins, so that any row is found again
!> without holding the table.
module csv_heights
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use findings, only: quoted
   use height_limits, only: height_fault, is_height, is_position, position_fault, spacing_fault
   use height_source, only: height_source_t
   use kinds, only: wp
   use number_text, only: read_real
   use text, only: count_of, to_text
   use text_lines, only: open_lines, text_lines_t
   implicit none (type, external)
   private

   public :: csv_heights_t, open_csv_heights

   !> Largest error of a position, in spacings, that still counts as uniform.
   real(wp), parameter :: max_uneven = 1.0e-3_wp
   !> Rows from one noted place to the next.
   integer(int64), parameter :: block_rows = 4096_int64
   !> Blank and tab.
   character(*), parameter :: blanks = ' '//achar(9)

   !> One column of a table. The file is open only while it is read.
   type, extends(height_source_t) :: csv_heights_t
      character(:), allocatable, private :: file
      !> Number of the column with the heights, and of all columns.
      integer, private :: column = 2, columns = 2
      !> First byte and line number of rows 0, block_rows, 2 block_rows, ... (2, n); the array may
      !> be longer.
      integer(int64), allocatable, private :: places(:, :)
   contains
      procedure :: get
   end type csv_heights_t

   !> The spacings that positions allow, row by row: within `max_uneven` of uniform.
   type :: spacing_range_t
      real(wp) :: first = 0.0_wp, last = 0.0_wp
      real(wp) :: low = 0.0_wp, high = huge(1.0_wp)
      !> Lines of the file that set the bounds.
      integer(int64) :: low_line = 0_int64, high_line = 0_int64
   end type spacing_range_t

contains

   !> Finds the rows of `file`, their `spacing` [m] and the column named `dataset` (empty: the
   !> second). Errors (input_error), with the line: no such file or column; no header; positions
   !> that are no numbers or uneven; rows that have not as many fields as the header.
   subroutine open_csv_heights(source, file, dataset, spacing, error)
      type(csv_heights_t), intent(out) :: source
      character(*), intent(in) :: file, dataset
      real(wp), intent(out) :: spacing
      type(error_t), allocatable, intent(out) :: error
      type(text_lines_t) :: lines
      logical :: is_there

      source%file = file
      spacing = 0.0_wp
      call open_lines(lines, file, error)
      if (allocated(error)) return
      call lines%next(is_there, error)
      if (.not. allocated(error)) call read_header(source, lines, dataset, error)   ! error: below
      if (.not. allocated(error)) call find_rows(source, lines, spacing, error)   ! error: handed up
      call lines%close()
   end subroutine open_csv_heights

   !> Finds the column named `dataset` in the present line. Errors: there is none; the line is no
   !> header.
   subroutine read_header(source, lines, dataset, error)
      type(csv_heights_t), intent(inout) :: source
      type(text_lines_t), intent(in) :: lines
      character(*), intent(in) :: dataset
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: number
      logical :: is_number
      integer :: first, last

      associate (header => lines%line(:lines%length))
         source%columns = 1 + count_of(',', header)
         source%column = column_of(header, dataset)
         call find_field(header, 1, first, last)
         call read_real(header(first:last), number, is_number)
         if (source%columns < 2 .or. is_number) then
            call refuse(lines, first, 'found '//shown(header) &
               //', expected a header line with the names of the columns, as '// &
               'in x,z', error)
         else if (source%column == 0) then
            call refuse(lines, 1, 'found no column '//quoted(dataset)//' in the header ' &
               //shown(header), error)
         end if
      end associate
   end subroutine read_header

   !> Notes where the rows are and looks at their positions.
   subroutine find_rows(source, lines, spacing, error)
      type(csv_heights_t), intent(inout) :: source
      type(text_lines_t), intent(inout) :: lines
      real(wp), intent(out) :: spacing
      type(error_t), allocatable, intent(out) :: error
      type(spacing_range_t) :: range
      real(wp) :: x
      logical :: is_there

      spacing = 0.0_wp
      allocate (source%places(2, 16))
      do
         call next_row(lines, is_there, error)
         if (allocated(error) .or. .not. is_there) exit
         if (modulo(source%nodes, block_rows) == 0) call note_place(source, &
            [lines%place, lines%number])
         call read_number(source, lines, 1, x, error)
         if (allocated(error)) return
         call narrow(range, source%nodes, lines%number, x)
         source%nodes = source%nodes + 1
      end do
      if (allocated(error) .or. source%nodes < 2) return
      spacing = (range%last - range%first)/(source%nodes - 1)
      if (.not. spacing > 0.0_wp) then
         call fail(error, input_error, source%file//': found positions that do not rise, '// &
            'expected those of a uniform grid')
      else if (spacing < range%low .or. spacing > range%high) then
         call fail(error, input_error, source%file//':'//to_text(merge(range%low_line, &
            range%high_line, spacing < range%low))// &
            ': found uneven positions, expected a uniform grid')
      else if (spacing_fault(spacing) /= '') then
         call fail(error, input_error, source%file//': '//spacing_fault(spacing))
      end if
   end subroutine find_rows

   !> Adds the place of a block of rows.
   subroutine note_place(source, place)
      type(csv_heights_t), intent(inout) :: source
      integer(int64), intent(in) :: place(2)
      integer(int64), allocatable :: longer(:, :)
      integer(int64) :: block

      block = source%nodes/block_rows + 1
      if (block > size(source%places, 2, int64)) then
         allocate (longer(2, 2*size(source%places, 2)))
         longer(:, :size(source%places, 2)) = source%places
         call move_alloc(longer, source%places)
      end if
      source%places(:, block) = place
   end subroutine note_place

   !> The spacings for which `x` of `row` (0 = the first) in `line` is no more than `max_uneven` of
   !> them from its place.
   pure subroutine narrow(range, row, line, x)
      type(spacing_range_t), intent(inout) :: range
      integer(int64), intent(in) :: row, line
      real(wp), intent(in) :: x
      real(wp) :: high, low

      if (row == 0) range%first = x
      range%last = x
      if (row == 0) return
      low = (x - range%first)/(row + max_uneven)
      high = (x - range%first)/(row - max_uneven)
      if (low > range%low) then
         range%low = low
         range%low_line = line
      end if
      if (high < range%high) then
         range%high = high
         range%high_line = line
      end if
   end subroutine narrow

   !> Heights from row `first` on. Errors: a gap, a text that is not a number; fewer rows than
   !> before.
   subroutine get(self, first, z, error)
      class(csv_heights_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error
      type(text_lines_t) :: lines
      integer(int64) :: block, row
      logical :: is_there

      z = 0.0_wp
      block = first/block_rows + 1
      call open_lines(lines, self%file, error)
      if (allocated(error)) return
      call lines%seek(self%places(1, block), self%places(2, block))
      do row = (block - 1)*block_rows, first + size(z) - 1
         call next_row(lines, is_there, error)
         if (.not. (allocated(error) .or. is_there)) call fail(error, input_error, &
            self%file//' has fewer rows than before')
         if (row >= first .and. .not. allocated(error)) call read_number(self, lines, &
            self%column, z(row - first + 1), &
            error)
         if (allocated(error)) exit
      end do
      call lines%close()
   end subroutine get

   !> The next line that is not blank.
   subroutine next_row(lines, is_there, error)
      type(text_lines_t), intent(inout) :: lines
      logical, intent(out) :: is_there
      type(error_t), allocatable, intent(out) :: error

      do
         call lines%next(is_there, error)
         if (allocated(error) .or. .not. is_there) return
         if (verify(lines%line(:lines%length), blanks) > 0) return
      end do
   end subroutine next_row

   !> The number in a column of the present line. Errors, with line and column: there is none; it
   !> cannot be a position or a height; the line has not as many fields as the header.
   subroutine read_number(source, lines, column, number, error)
      type(csv_heights_t), intent(in) :: source
      type(text_lines_t), intent(in) :: lines
      integer, intent(in) :: column
      real(wp), intent(out) :: number
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault
      integer :: columns, first, last
      logical :: good

      number = 0.0_wp
      associate (row => lines%line(:lines%length))
         columns = 1 + count_of(',', row)
         call find_field(row, column, first, last)
         call read_real(row(first:last), number, good)
         if (columns == source%columns .and. good .and. merge(is_position(number), &
            is_height(number), column == 1)) return
         if (columns /= source%columns) then
            fault = 'found '//to_text(columns)//' fields, expected the ' &
               //to_text(source%columns)// &
               ' of the header, separated by commas (numbers have a decimal point)'
         else if (.not. good) then
            fault = 'found '//shown(row(first:last))//', expected a number'
         else if (column == 1) then
            fault = position_fault(number)
         else
            fault = height_fault(number)
         end if
         call refuse(lines, first, fault, error)
      end associate
   end subroutine read_number

   !> Error with the place: byte `column` of the present line.
   subroutine refuse(lines, column, fault, error)
      type(text_lines_t), intent(in) :: lines
      integer, intent(in) :: column
      character(*), intent(in) :: fault
      type(error_t), allocatable, intent(out) :: error

      call fail(error, input_error, lines%file//':'//to_text(lines%number)//':'//to_text(column) &
         //': '//fault)
   end subroutine refuse

   !> What a file says, in quotes and short.
   function shown(string)
      character(*), intent(in) :: string
      character(:), allocatable :: shown

      shown = quoted(string)
      if (len_trim(string) > 0) shown = "'"//shown//"'"
   end function shown

   !> Number of the column named `dataset` in a header (empty: 2); 0 if there is none.
   pure function column_of(header, dataset) result(column)
      character(*), intent(in) :: header, dataset
      integer :: column
      integer :: first, last

      column = 2
      if (dataset == '') return
      do column = 1, 1 + count_of(',', header)
         call find_field(header, column, first, last)
         if (header(first:last) == trim(dataset)) return
      end do
      column = 0
   end function column_of

   !> Where field number `i` of a line of fields separated by commas is, without blanks around it;
   !> empty if there are fewer.
   pure subroutine find_field(line, i, first, last)
      character(*), intent(in) :: line
      integer, intent(in) :: i
      integer, intent(out) :: first, last
      integer :: k, length

      first = 1
      last = len(line)
      do k = 1, i
         length = index(line(first:), ',') - 1
         last = merge(len(line), first + length - 1, length < 0)
         if (k == i) exit
         first = last + 2
         if (length >= 0) cycle
         first = len(line) + 1
         exit
      end do
      k = verify(line(first:last), blanks)
      first = merge(last + 1, first + k - 1, k == 0)
      last = first - 1 + verify(line(first:last), blanks, back=.true.)
   end subroutine find_field

end module csv_heights

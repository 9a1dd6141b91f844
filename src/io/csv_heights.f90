!> Heights in a CSV table: a header line, then rows with x in the first column; read a stretch at a time.
!>
!> A first pass over the file notes where every 4096th row begins, so that any row is found again without holding the table.
module csv_heights
   use, intrinsic :: iso_fortran_env, only: int64
   use errors, only: error_t, fail, input_error
   use height_source, only: height_source_t
   use kinds, only: wp
   use text, only: count_of, to_text
   use text_lines, only: open_lines, text_lines_t
   implicit none (type, external)
   private

   public :: csv_heights_t, open_csv_heights

   !> Largest error of a position, in spacings, that still counts as uniform.
   real(wp), parameter :: most_uneven = 1.0e-3_wp
   !> Rows from one noted place to the next.
   integer(int64), parameter :: block_rows = 4096_int64

   !> One column of a table. The file is open only while it is read.
   type, extends(height_source_t) :: csv_heights_t
      character(:), allocatable, private :: file
      integer, private :: column = 2
      !> First byte and line number of rows 0, block_rows, 2 block_rows, ... (2, n); the array may be longer.
      integer(int64), allocatable, private :: places(:, :)
   contains
      procedure :: get
   end type csv_heights_t

   !> The spacings that positions allow, row by row: within `most_uneven` of uniform.
   type :: spacing_range_t
      real(wp) :: first = 0.0_wp, last = 0.0_wp
      real(wp) :: low = 0.0_wp, high = huge(1.0_wp)
      !> Rows (0 = the first) that set the bounds.
      integer(int64) :: low_row = 0_int64, high_row = 0_int64
   end type spacing_range_t

contains

   !> Finds the rows of `file`, their `spacing` [m] and the column named `dataset` (empty: the second).
   !> Errors (input_error): no such file or column; positions that are no numbers or uneven.
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
      if (.not. allocated(error)) then
         source%column = column_of(lines%line(:lines%length), dataset)
         if (source%column == 0) call fail(error, input_error, 'found no column '//dataset//' in the header of '//file//': '// &
            lines%line(:lines%length))
      end if
      if (.not. allocated(error)) call find_rows(source, lines, spacing, error)   ! error: handed up
      call lines%close()
   end subroutine open_csv_heights

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
         if (modulo(source%nodes, block_rows) == 0) call note_place(source, [lines%place, lines%number])
         call read_number(lines, 1, x, error)
         if (allocated(error)) return
         call narrow(range, source%nodes, x)
         source%nodes = source%nodes + 1
      end do
      if (allocated(error) .or. source%nodes < 2) return
      spacing = (range%last - range%first)/(source%nodes - 1)
      if (.not. spacing > 0.0_wp) then
         call fail(error, input_error, 'found positions that do not rise in '//source%file)
      else if (spacing < range%low .or. spacing > range%high) then
         call fail(error, input_error, 'found uneven positions in '//source%file//' (node '// &
            to_text(merge(range%low_row, range%high_row, spacing < range%low) + 1)//'), expected a uniform grid')
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

   !> The spacings for which `x` of `row` is no more than `most_uneven` of them from its place.
   pure subroutine narrow(range, row, x)
      type(spacing_range_t), intent(inout) :: range
      integer(int64), intent(in) :: row
      real(wp), intent(in) :: x
      real(wp) :: high, low

      if (row == 0) range%first = x
      range%last = x
      if (row == 0) return
      low = (x - range%first)/(row + most_uneven)
      high = (x - range%first)/(row - most_uneven)
      if (low > range%low) then
         range%low = low
         range%low_row = row
      end if
      if (high < range%high) then
         range%high = high
         range%high_row = row
      end if
   end subroutine narrow

   !> Heights from row `first` on. Errors: a gap or what is no number; fewer rows than before.
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
         if (.not. (allocated(error) .or. is_there)) call fail(error, input_error, self%file//' has fewer rows than before')
         if (row >= first .and. .not. allocated(error)) call read_number(lines, self%column, z(row - first + 1), error)
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
         if (len_trim(lines%line(:lines%length)) > 0) return
      end do
   end subroutine next_row

   !> The number in a column of the present line. Error: there is none.
   subroutine read_number(lines, column, number, error)
      type(text_lines_t), intent(in) :: lines
      integer, intent(in) :: column
      real(wp), intent(out) :: number
      type(error_t), allocatable, intent(out) :: error
      integer :: first, last, status

      number = 0.0_wp
      call find_field(lines%line(:lines%length), column, first, last)
      status = 1
      if (last >= first) read (lines%line(first:last), *, iostat=status) number
      if (status /= 0) call fail(error, input_error, lines%file//':'//to_text(lines%number)//": found '"// &
         lines%line(first:last)//"', expected a number")
   end subroutine read_number

   !> Number of the column named `dataset` in a header (empty: 2); 0 if there is none.
   pure function column_of(header, dataset) result(column)
      character(*), intent(in) :: header, dataset
      integer :: column
      integer :: first, last

      column = 2
      if (dataset == '') return
      do column = 1, 1 + count_of(',', header)
         call find_field(header, column, first, last)
         if (trim(adjustl(header(first:last))) == trim(dataset)) return
      end do
      column = 0
   end function column_of

   !> Where field number `i` of a line of fields separated by commas is; empty if there are fewer.
   pure subroutine find_field(line, i, first, last)
      character(*), intent(in) :: line
      integer, intent(in) :: i
      integer, intent(out) :: first, last
      integer :: comma, k

      first = 1
      do k = 1, i
         comma = index(line(first:), ',')
         last = first + comma - 2
         if (comma == 0) last = len(line)
         if (k == i) return
         first = last + 2
         if (comma > 0) cycle
         first = len(line) + 1
         last = len(line)
         return
      end do
   end subroutine find_field

end module csv_heights

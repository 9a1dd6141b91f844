!> Heights in a CSV table of any usual dialect, with x in the first column; read a stretch at a
!> time.
!>
!> A first pass over the file notes where every 4096th row begins, so that any row is found again
!> without holding the table.
module csv_heights
   use, intrinsic :: iso_fortran_env, only: int64
   use csv_dialect, only: dialect_words, find_field, number_of_fields, read_field
   use csv_layout, only: csv_layout_t, find_layout
   use csv_sample, only: next_row, refuse, shown
   use errors, only: error_t, fail, input_error
   use height_limits, only: height_fault, is_height, is_position, position_fault
   use height_source, only: height_source_t
   use kinds, only: wp
   use length_units, only: height_units_t, settle_unit
   use position_range, only: position_range_t
   use text, only: to_text
   use text_lines, only: open_lines, text_lines_t
   implicit none (type, external)
   private

   public :: csv_heights_t, open_csv_heights

   !> Rows from one noted place to the next.
   integer(int64), parameter :: block_rows = 4096_int64

   !> One column of a table. The file is open only while it is read.
   type, extends(height_source_t) :: csv_heights_t
      character(:), allocatable, private :: file
      type(csv_layout_t), private :: layout
      !> Units of positions and of heights in a metre.
      real(wp), private :: per_metre(2) = 1.0_wp
      !> First byte and line number of rows 0, block_rows, 2 block_rows, ... (2, n); the array may
      !> be longer.
      integer(int64), allocatable, private :: places(:, :)
      !> The positions fall from row to row.
      logical, private :: falls = .false.
   contains
      procedure :: get
   end type csv_heights_t

contains

   !> Finds the rows of `file`, their `spacing` [m] and the column named `dataset` (empty: the
   !> second); `units` are those that the keys say. Errors (input_error), with the line: no such
   !> file or column; no rows of numbers; units that are unknown or contradict the keys; positions
   !> that are no numbers or uneven; rows of another number of fields.
   subroutine open_csv_heights(source, file, dataset, units, spacing, error)
      type(csv_heights_t), intent(out) :: source
      character(*), intent(in) :: file, dataset
      type(height_units_t), intent(in) :: units
      real(wp), intent(out) :: spacing
      type(error_t), allocatable, intent(out) :: error
      type(text_lines_t) :: lines

      source%file = file
      spacing = 0.0_wp
      call open_lines(lines, file, error)
      if (allocated(error)) return
      call find_layout(source%layout, lines, dataset, error)
      if (.not. allocated(error)) call settle_units(source, units, error)
      if (.not. allocated(error)) call find_rows(source, lines, spacing, error)   ! error: handed up
      call lines%close()
   end subroutine open_csv_heights

   !> The units of both columns. Errors: they are unknown or contradict the keys; only one of them
   !> is said; one stands in a comment only.
   subroutine settle_units(source, units, error)
      type(csv_heights_t), intent(inout) :: source
      type(height_units_t), intent(in) :: units
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault

      associate (layout => source%layout, per_metre => source%per_metre)
         call settle_unit(layout%x_unit, units%x, layout%place, 'x_unit', per_metre(1), fault)
         if (fault == '') call settle_unit(layout%z_unit, units%z, layout%place, 'z_unit', &
            per_metre(2), fault)
         if (fault == '') fault = fault_of_silence(layout, units, per_metre)
      end associate
      if (fault /= '') call fail(error, input_error, source%file//': '//fault)
   end subroutine settle_units

   !> "found ..., expected ..." where a unit is missing that others let expect; else empty.
   pure function fault_of_silence(layout, units, per_metre) result(fault)
      type(csv_layout_t), intent(in) :: layout
      type(height_units_t), intent(in) :: units
      real(wp), intent(in) :: per_metre(2)
      character(:), allocatable :: fault, missing
      logical :: is_silent(2)

      fault = ''
      is_silent = [layout%x_unit//units%x == '', layout%z_unit//units%z == '']
      if (.not. any(is_silent)) return
      missing = 'x_unit and z_unit'
      if (.not. all(is_silent)) missing = trim(merge('x_unit', 'z_unit', is_silent(1)))
      if (layout%unit_in_comment /= '') then
         fault = "found the unit '"//layout%unit_in_comment//"' in a comment, expected units "// &
            'in the header (as in x_mm,z_um) or the keys '//missing
      else if (layout%x_unit//layout%z_unit /= '' .and. any(per_metre > 1.0_wp)) then
         fault = 'found a unit of '//trim(merge('heights  ', 'positions', is_silent(1)))// &
            ' only in '//layout%place//', expected both, or the key '//missing
      end if
   end function fault_of_silence

   !> Notes where the rows are and looks at their positions.
   subroutine find_rows(source, lines, spacing, error)
      type(csv_heights_t), intent(inout) :: source
      type(text_lines_t), intent(inout) :: lines
      real(wp), intent(out) :: spacing
      type(error_t), allocatable, intent(out) :: error
      type(position_range_t) :: range
      real(wp) :: x
      logical :: is_there

      spacing = 0.0_wp
      allocate (source%places(2, 16))
      call lines%seek(source%layout%first_row(1), source%layout%first_row(2))
      do
         call next_row(lines, is_there, error)
         if (allocated(error) .or. .not. is_there) exit
         if (modulo(source%nodes, block_rows) == 0) call note_place(source, &
            [lines%place, lines%number])
         call read_number(source, lines, 1, x, error)
         if (allocated(error)) return
         call range%add(x, lines%number)
         source%nodes = source%nodes + 1
      end do
      if (allocated(error) .or. source%nodes < 2) return
      spacing = range%distance()
      source%falls = range%falls
      if (range%mark_of_fault() > 0) then
         call fail(error, input_error, source%file//':'//to_text(range%mark_of_fault())//': ' &
            //range%fault())
      else if (range%fault() /= '') then
         call fail(error, input_error, source%file//': '//range%fault())
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

   !> Heights in the order of rising positions, from number `first` on. Errors: a gap, a text that
   !> is not a number; fewer rows than before.
   subroutine get(self, first, z, error)
      class(csv_heights_t), intent(in) :: self
      integer(int64), intent(in) :: first
      real(wp), intent(out) :: z(:)
      type(error_t), allocatable, intent(out) :: error

      if (self%falls) then
         call read_rows(self, self%nodes - first - size(z), z, error)   ! error: handed up
         z = z(size(z):1:-1)
      else
         call read_rows(self, first, z, error)   ! error: handed up
      end if
   end subroutine get

   !> Heights from row `first` of the file on.
   subroutine read_rows(self, first, z, error)
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
            self%layout%column, z(row - first + 1), error)
         if (allocated(error)) exit
      end do
      call lines%close()
   end subroutine read_rows

   !> The number in a column of the present line. Errors, with line and column: there is none; it
   !> cannot be a position or a height; the line has not as many fields as the first row.
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
      associate (row => lines%line(:lines%length), dialect => source%layout%dialect)
         columns = number_of_fields(dialect, row)
         call find_field(dialect, row, column, first, last)
         call read_field(dialect, row(first:last), number, good)
         number = number/source%per_metre(merge(1, 2, column == 1))
         if (columns == source%layout%columns .and. good .and. merge(is_position(number), &
            is_height(number), column == 1)) return
         if (columns /= source%layout%columns) then
            fault = 'found '//to_text(columns)//' fields, expected the ' &
               //to_text(source%layout%columns)//' of the first row, '//dialect_words(dialect)
         else if (.not. good) then
            fault = 'found '//shown(row(first:last))//', expected a number'
            if (dialect%separator /= ',') fault = fault//' ('//dialect_words(dialect)//')'
         else if (column == 1) then
            fault = position_fault(number)
         else
            fault = height_fault(number)
         end if
         call refuse(lines, lines%number, first, fault, error)
      end associate
   end subroutine read_number

end module csv_heights

!> Tables of numbers in named columns: histories, laws of asperities.
module column_table
   use errors, only: error_t, fail, input_error
   use file_bytes, only: checksum_t
   use height_table, only: next_row, shown, split
   use kinds, only: int64, wp
   use number_text, only: read_real
   use text, only: counted, joined, to_text
   use text_file, only: open_lines, text_lines_t
   implicit none (type, external)
   private

   public :: column_table_t, read_columns

   !> Most rows.
   integer, parameter :: most_rows = 1000000

   !> What a table may have, and what it has.
   type :: column_table_t
      !> Names of columns with their units, and their limits.
      character(len=24), allocatable :: names(:)
      real(wp), allocatable :: least(:), largest(:)
      !> A table begins with one of so many first columns, which rises.
      integer :: heads = 1
      !> Columns that are there, their numbers (rows, columns), and the checksum of these.
      logical, allocatable :: has(:)
      real(wp), allocatable :: values(:, :)
      character(:), allocatable :: digits
   end type column_table_t

contains

   !> Reads a table: comments (#), names with units, rows of numbers, by commas. Errors with line
   !> (input_error): any other form; a first column that does not rise; numbers out of range.
   subroutine read_columns(file, table, error)
      character(*), intent(in) :: file
      type(column_table_t), intent(inout) :: table
      type(error_t), allocatable, intent(out) :: error
      type(text_lines_t) :: lines
      type(checksum_t) :: checksum
      character(:), allocatable :: fault
      real(wp), allocatable :: numbers(:, :)
      integer, allocatable :: column(:)
      integer(int64) :: line
      integer :: n

      call open_lines(lines, file, error)
      if (allocated(error)) return
      fault = ''
      n = -1
      do
         call next_row(lines, line, error)
         if (allocated(error) .or. line == 0) exit
         n = n + 1
         if (n == 0) then
            call read_names(lines%line(:lines%length), table, column, fault)
            ! a field has a byte, and one behind it
            allocate (numbers(size(column), min(lines%bytes/(2*size(column)), 1_int64*most_rows) &
               + 1))
         else
            call read_numbers(lines%line(:lines%length), table, column, numbers(:, n), fault)
            if (fault == '' .and. n > 1) then
               if (numbers(1, n) <= numbers(1, n - 1)) fault = 'found '//to_text(numbers(1, n))// &
                  ' behind '//to_text(numbers(1, n - 1))//', expected rising '// &
                  trim(table%names(column(1)))
            end if
            if (n > most_rows) fault = 'found more than '//to_text(most_rows)//' rows'
         end if
         if (fault /= '') exit
      end do
      if (fault == '' .and. n < 2) fault = 'found '//counted(max(n, 0), 'row')//', expected '// &
         'names with units and at least two rows'
      if (fault /= '' .and. .not. allocated(error)) call fail(error, input_error, &
         file//':'//to_text(lines%number)//': '//fault)
      call lines%close()
      if (allocated(error)) return
      allocate (table%values(n, size(table%names)), source=0.0_wp)
      table%values(:, column) = transpose(numbers(:, :n))
      call checksum%add(reshape(numbers(:, :n), [size(column)*n]))
      table%digits = checksum%digits()
   end subroutine read_columns

   !> The column of each field of a row of names.
   pure subroutine read_names(row, table, column, fault)
      character(*), intent(in) :: row
      type(column_table_t), intent(inout) :: table
      integer, allocatable, intent(out) :: column(:)
      character(:), allocatable, intent(inout) :: fault
      integer :: bounds(2, size(table%names) + 1), fields, i

      call split(',', row, bounds, fields)
      fields = min(fields, size(bounds, 2))
      column = [(findloc(table%names == row(bounds(1, i):bounds(2, i)), .true., 1), i=1, fields)]
      table%has = [(any(column == i), i=1, size(table%names))]
      if (count(table%has) == fields .and. fields > 1 .and. column(1) <= table%heads &
         .and. count(table%has(:table%heads)) == 1) return
      i = findloc(column, 0, 1)
      fault = 'found '//shown(row)
      if (i > 0) fault = 'found '//shown(row(bounds(1, i):bounds(2, i)))
      fault = fault//', expected names with units: '//joined(table%names(:table%heads), ' or ') &
         //', then any of '//joined(table%names(table%heads + 1:), ', ')
   end subroutine read_names

   !> The numbers of a row.
   pure subroutine read_numbers(row, table, column, numbers, fault)
      character(*), intent(in) :: row
      type(column_table_t), intent(in) :: table
      integer, intent(in) :: column(:)
      real(wp), intent(out) :: numbers(:)
      character(:), allocatable, intent(inout) :: fault
      integer :: bounds(2, size(table%names) + 1), fields, i
      logical :: good

      numbers = 0.0_wp
      call split(',', row, bounds, fields)
      if (fields /= size(column)) fault = 'found '//counted(fields, 'field')//', expected '// &
         to_text(size(column))
      do i = 1, merge(size(column), 0, fault == '')
         associate (field => row(bounds(1, i):bounds(2, i)), c => column(i))
            call read_real(field, numbers(i), good)
            if (good) good = numbers(i) >= table%least(c) .and. numbers(i) <= table%largest(c)
            if (good) cycle
            fault = 'found '//shown(field)//', expected a number from '//to_text(table%least(c)) &
               //' to '//to_text(table%largest(c))//' in '//trim(table%names(c))
         end associate
         return
      end do
   end subroutine read_numbers

end module column_table

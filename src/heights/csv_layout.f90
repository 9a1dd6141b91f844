!> How a table is laid out: its dialect, its header, its units and where its numbers begin, found
!> from its first lines.
!>
!> Of the separators tab, semicolon, comma and blanks the one that makes most of the first lines
!> rows of numbers is taken. Above the numbers there may be one line of names and one of units; a
!> first line of numbers is a row. The last comment above them is the line of names if it has as
!> many.
module csv_layout
   use, intrinsic :: iso_fortran_env, only: int64
   use csv_dialect, only: blanks, csv_dialect_t, dialect_words, find_field, is_number, &
      number_of_fields
   use csv_header, only: are_units, column_named, csv_name_t, names_of, unit_among, unit_of, &
      without_brackets
   use csv_sample, only: choose_separator, csv_line_t, has_point, next_row, refuse, refuse_sample, &
      separators, shown, take_sample
   use errors, only: error_t
   use findings, only: quoted
   use number_text, only: read_integer
   use text, only: to_text
   use text_lines, only: text_lines_t
   implicit none (type, external)
   private

   public :: csv_layout_t, find_layout

   !> What was found.
   type :: csv_layout_t
      type(csv_dialect_t) :: dialect
      !> Number of the column with the heights, and of all columns.
      integer :: column = 2, columns = 2
      !> Place and number of the first row of numbers.
      integer(int64) :: first_row(2) = 0_int64
      !> Units of positions and heights as they are written, empty if they are not.
      character(:), allocatable :: x_unit, z_unit
      !> Where they are, for messages.
      character(:), allocatable :: place
      !> A unit in a comment, of which nothing says whether it is that of the numbers.
      character(:), allocatable :: unit_in_comment
   end type csv_layout_t

contains

   !> Looks at the first lines; `dataset` is the name of the column of heights or, without names,
   !> its number; empty: the second. `lines` must be open at its beginning, and is anywhere later.
   !> Errors (input_error): no rows of numbers; text above them that is neither names nor units; no
   !> such column; decimal commas between commas.
   subroutine find_layout(layout, lines, dataset, error)
      type(csv_layout_t), intent(out) :: layout
      type(text_lines_t), intent(inout) :: lines
      character(*), intent(in) :: dataset
      type(error_t), allocatable, intent(out) :: error
      type(csv_line_t), allocatable :: comments(:), sample(:)
      type(csv_name_t), allocatable :: names(:)
      integer :: first

      layout%x_unit = ''
      layout%z_unit = ''
      layout%place = ''
      layout%unit_in_comment = ''
      call take_sample(lines, sample, comments, error)
      if (allocated(error)) return
      call choose_separator(sample, layout%dialect, first)
      if (first == 0) then
         call refuse_sample(lines, sample, error)
         return
      end if
      layout%first_row = [sample(first)%place, sample(first)%number]
      layout%columns = number_of_fields(layout%dialect, sample(first)%text)
      if (first > 1) then
         names = names_of(layout%dialect, sample(1)%text)
         layout%place = 'the header '//shown(sample(1)%text)
         call check_header(layout, lines, sample(:first), names, dataset, error)
      else
         call look_at_comments(layout, comments, names)
         if (size(names) == 0 .and. layout%dialect%separator == ',' .and. layout%columns > 2 &
            .and. .not. any(has_point(sample))) call refuse(lines, sample(1)%number, 1, 'found ' &
            //to_text(layout%columns)//' whole numbers between commas, which may be numbers '// &
            'with decimal commas, expected a header line, or semicolons between such numbers', &
            error)
      end if
      if (allocated(error)) return
      call find_column(layout, lines, names, sample(1), dataset, error)
      if (allocated(error)) return
      call take_units(layout, names)
      if (first == 3) call take_units_line(layout, sample(2))
      call look_for_unit(layout, comments)
      if (layout%dialect%separator /= ',') call find_decimal(layout, lines, error)
   end subroutine find_layout

   !> An error if the line of names has numbers, or is not as long as the rows; the second line is
   !> neither numbers nor units.
   subroutine check_header(layout, lines, above, names, dataset, error)
      type(csv_layout_t), intent(in) :: layout
      type(text_lines_t), intent(in) :: lines
      type(csv_line_t), intent(in) :: above(:)
      type(csv_name_t), intent(in) :: names(:)
      character(*), intent(in) :: dataset
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: hint
      integer :: first, last
      logical :: has_number

      associate (dialect => layout%dialect, row => above(size(above)))
         call find_field(dialect, row%text, layout%columns, first, last)
         if (size(names) /= layout%columns .and. .not. (size(names) == layout%columns - 1 &
            .and. last < first)) then
            hint = ''
            if (layout%columns == 2*size(names) .and. dialect%separator == ',') hint = &
               ': it looks like decimal commas between commas'
            call refuse(lines, row%number, 1, 'found '//to_text(layout%columns)// &
               ' fields, expected the '//to_text(size(names))//' of the header, ' &
               //dialect_words(dialect)//hint, error)
            return
         end if
         has_number = is_number(dialect, names(1)%text)
         if (size(names) > 1 .and. dataset == '') has_number = has_number .or. &
            is_number(dialect, names(2)%text)
         if (has_number) then
            call refuse(lines, above(1)%number, 1, 'found '//shown(above(1)%text)// &
               ', expected a header line with the names of the columns, as in x,z, or numbers', &
               error)
         else if (size(above) == 3) then
            call find_field(dialect, above(2)%text, 1, first, last)
            if (.not. are_units(names_of(dialect, above(2)%text))) call refuse(lines, &
               above(2)%number, first, 'found '//shown(above(2)%text(first:last)) &
               //', expected a number', error)
         end if
      end associate
   end subroutine check_header

   !> The `names` in the last comment above the numbers, if it has as many as there are columns,
   !> whatever separates them; else none.
   subroutine look_at_comments(layout, comments, names)
      type(csv_layout_t), intent(inout) :: layout
      type(csv_line_t), intent(in) :: comments(:)
      type(csv_name_t), allocatable, intent(out) :: names(:)
      type(csv_dialect_t) :: dialect
      character(:), allocatable :: text
      integer :: k

      allocate (names(0))
      if (size(comments) == 0) return
      text = comments(size(comments))%text
      k = verify(text, '#%'//blanks)
      if (k == 0) return
      text = trim(text(k:))
      do k = 0, len(separators)
         dialect = layout%dialect
         if (k > 0) dialect%separator = separators(k:k)
         names = names_of(dialect, text)
         if (size(names) == layout%columns) exit
         names = names(:0)
      end do
      if (size(names) > 0) layout%place = 'the header '//shown(comments(size(comments))%text)
   end subroutine look_at_comments

   !> The column of the heights. Error: no column has the name or the number `dataset`.
   subroutine find_column(layout, lines, names, line, dataset, error)
      type(csv_layout_t), intent(inout) :: layout
      type(text_lines_t), intent(in) :: lines
      type(csv_name_t), intent(in) :: names(:)
      type(csv_line_t), intent(in) :: line
      character(*), intent(in) :: dataset
      type(error_t), allocatable, intent(out) :: error
      integer(int64) :: number
      logical :: good

      layout%column = 2
      if (dataset == '') return
      layout%column = column_named(names, dataset)
      if (layout%column == 0 .and. size(names) == 0) then
         call read_integer(dataset, number, good)
         if (good .and. number > 1_int64 .and. number <= layout%columns) layout%column = int(number)
      end if
      if (layout%column > 0) return
      if (size(names) == 0) then
         call refuse(lines, line%number, 1, 'found no header line, expected one with the name ' &
            //quoted(dataset)//', or the number of the column as dataset', error)
      else
         call refuse(lines, line%number, 1, 'found no column '//quoted(dataset)//' in ' &
            //layout%place, error)
      end if
   end subroutine find_column

   !> The units in the names of the two columns.
   pure subroutine take_units(layout, names)
      type(csv_layout_t), intent(inout) :: layout
      type(csv_name_t), intent(in) :: names(:)

      if (size(names) == 0) return
      layout%x_unit = unit_of(names(1))
      if (layout%column <= size(names)) layout%z_unit = unit_of(names(layout%column))
   end subroutine take_units

   !> The units in a line of their own, where the names have none.
   subroutine take_units_line(layout, line)
      type(csv_layout_t), intent(inout) :: layout
      type(csv_line_t), intent(in) :: line
      integer :: first, last

      call find_field(layout%dialect, line%text, 1, first, last)
      if (layout%x_unit == '') layout%x_unit = without_brackets(line%text(first:last))
      call find_field(layout%dialect, line%text, layout%column, first, last)
      if (layout%z_unit == '') layout%z_unit = without_brackets(line%text(first:last))
      layout%place = layout%place//' and the units '//shown(line%text)
   end subroutine take_units_line

   !> A unit in the comments.
   subroutine look_for_unit(layout, comments)
      type(csv_layout_t), intent(inout) :: layout
      type(csv_line_t), intent(in) :: comments(:)
      integer :: i

      do i = 1, size(comments)
         layout%unit_in_comment = unit_among(comments(i)%text)
         if (layout%unit_in_comment /= '') return
      end do
   end subroutine look_for_unit

   !> The decimal mark: that of the first number which has one. Error: the file cannot be read.
   subroutine find_decimal(layout, lines, error)
      type(csv_layout_t), intent(inout) :: layout
      type(text_lines_t), intent(inout) :: lines
      type(error_t), allocatable, intent(out) :: error
      integer :: first, i, last, mark
      logical :: is_there

      call lines%seek(layout%first_row(1), layout%first_row(2))
      do
         call next_row(lines, is_there, error)
         if (allocated(error) .or. .not. is_there) return
         fields: do i = 1, layout%column, max(layout%column - 1, 1)
            associate (row => lines%line(:lines%length))
               call find_field(layout%dialect, row, i, first, last)
               mark = scan(row(first:last), '.,')
               if (mark == 0) cycle fields
               layout%dialect%decimal = row(first + mark - 1:first + mark - 1)
               return
            end associate
         end do fields
      end do
   end subroutine find_decimal

end module csv_layout

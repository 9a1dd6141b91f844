!> The first lines of a table, and the separator that makes most of them rows of numbers.
module csv_sample
   use, intrinsic :: iso_fortran_env, only: int64
   use csv_dialect, only: all_numbers, blanks, csv_dialect_t, find_field, is_comment, is_number, &
      number_of_fields
   use errors, only: error_t, fail, input_error
   use findings, only: quoted
   use text, only: to_text
   use text_lines, only: text_lines_t
   implicit none (type, external)
   private

   public :: choose_separator, csv_line_t, has_point, next_row, refuse, refuse_sample, shown, &
      take_sample

   !> What may separate fields; a blank stands for any number of blanks and tabs.
   character(*), parameter, public :: separators = achar(9)//';, '
   !> Rows that are looked at for the separator.
   integer, parameter :: sample_rows = 40
   !> Comments of which the units are looked at.
   integer, parameter :: kept_comments = 20

   !> A line of the file.
   type :: csv_line_t
      character(:), allocatable :: text
      !> Its first byte in the file and its number.
      integer(int64) :: place = 0_int64, number = 0_int64
   end type csv_line_t

contains

   !> The first lines that are no comments, and the comments above them: the first ones and the
   !> last. Errors: those of reading; bytes that are no text.
   subroutine take_sample(lines, sample, comments, error)
      type(text_lines_t), intent(inout) :: lines
      type(csv_line_t), allocatable, intent(out) :: sample(:), comments(:)
      type(error_t), allocatable, intent(out) :: error
      type(csv_line_t) :: line
      character(:), allocatable :: fault
      logical :: is_there

      allocate (sample(0), comments(0))
      do while (size(sample) < sample_rows)
         call lines%next(is_there, error)
         if (allocated(error) .or. .not. is_there) return
         line = csv_line_t(lines%line(:lines%length), lines%place, lines%number)
         if (line%number == 1_int64) call drop_mark(line)
         if (scan(line%text, achar(0)//achar(13)) > 0 .or. index(line%text, char(255)//char(254)) &
            == 1 .or. index(line%text, char(254)//char(255)) == 1) then
            fault = 'bytes that are no text, as of UTF-16'
            if (index(line%text, achar(13)) > 0) fault = &
               'lines that end with carriage returns alone'
            call refuse(lines, line%number, 1, 'found '//fault//', expected a table in UTF-8, '// &
               'or HDF5 (.h5)', error)
            return
         end if
         if (verify(line%text, blanks) == 0) cycle
         if (.not. is_comment(line%text)) then
            sample = [sample, line]
         else if (size(sample) == 0) then
            comments = [comments(:min(size(comments), kept_comments - 1)), line]
         end if
      end do
   end subroutine take_sample

   !> Drops the byte order mark of UTF-8.
   pure subroutine drop_mark(line)
      type(csv_line_t), intent(inout) :: line

      if (index(line%text, char(239)//char(187)//char(191)) /= 1) return
      line%text = line%text(4:)
      line%place = line%place + 3
   end subroutine drop_mark

   !> The separator that makes most lines rows of numbers; the `first` of these lines, at most the
   !> third; 0: none does.
   pure subroutine choose_separator(sample, dialect, first)
      type(csv_line_t), intent(in) :: sample(:)
      type(csv_dialect_t), intent(out) :: dialect
      integer, intent(out) :: first
      type(csv_dialect_t) :: trial
      integer :: best, i, k, points, start

      first = 0
      best = 0
      do k = 1, len(separators)
         trial = csv_dialect_t(separators(k:k), '.')
         points = 0
         start = 0
         do i = 1, size(sample)
            associate (rank => rank_of(trial, sample(i)%text))
               if (start == 0 .and. rank > 0) start = i
               points = points + rank
            end associate
         end do
         if (points <= best .or. start > 3) cycle
         best = points
         first = start
         dialect = trial
      end do
   end subroutine choose_separator

   !> How much a line looks like a row of numbers, 0 (not at all) to 4.
   pure function rank_of(dialect, line) result(rank)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: line
      integer :: rank
      integer :: first, last

      rank = 0
      call find_field(dialect, line, 1, first, last)
      if (number_of_fields(dialect, line) < 2) return
      if (.not. is_number(dialect, line(first:last))) return
      rank = 1
      call find_field(dialect, line, 2, first, last)
      if (is_number(dialect, line(first:last))) rank = 2
      if (all_numbers(dialect, line)) rank = 4
   end function rank_of

   !> Whether a decimal point is in a line.
   pure elemental function has_point(line)
      type(csv_line_t), intent(in) :: line
      logical :: has_point

      has_point = index(line%text, '.') > 0
   end function has_point

   !> Error where no separator makes rows of numbers.
   subroutine refuse_sample(lines, sample, error)
      type(text_lines_t), intent(in) :: lines
      type(csv_line_t), intent(in) :: sample(:)
      type(error_t), allocatable, intent(out) :: error

      if (size(sample) == 0) then
         call fail(error, input_error, lines%file//': found no rows, expected a header line, '// &
            'as in x,z, and rows of numbers')
      else
         call refuse(lines, sample(1)%number, 1, 'found '//shown(sample(1)%text)// &
            ' and no row of two or more numbers in the two lines below it, expected a header '// &
            'line with the names of the columns, as in x,z, and rows of numbers (# before '// &
            'other lines)', error)
      end if
   end subroutine refuse_sample

   !> The next line that is neither blank nor a comment. Errors: those of reading.
   subroutine next_row(lines, is_there, error)
      type(text_lines_t), intent(inout) :: lines
      logical, intent(out) :: is_there
      type(error_t), allocatable, intent(out) :: error

      do
         call lines%next(is_there, error)
         if (allocated(error) .or. .not. is_there) return
         associate (line => lines%line(:lines%length))
            if (verify(line, blanks) > 0 .and. .not. is_comment(line)) return
         end associate
      end do
   end subroutine next_row

   !> Error with the place: byte `column` of line `number`.
   subroutine refuse(lines, number, column, fault, error)
      type(text_lines_t), intent(in) :: lines
      integer(int64), intent(in) :: number
      integer, intent(in) :: column
      character(*), intent(in) :: fault
      type(error_t), allocatable, intent(out) :: error

      call fail(error, input_error, lines%file//':'//to_text(number)//':'//to_text(column) &
         //': '//fault)
   end subroutine refuse

   !> What a file says, in quotes and short.
   function shown(string)
      character(*), intent(in) :: string
      character(:), allocatable :: shown

      shown = quoted(string)
      if (len_trim(string) > 0) shown = "'"//shown//"'"
   end function shown

end module csv_sample

!> How the rows of a table are written: what separates fields, what marks decimals, which lines are
!> comments.
module csv_dialect
   use kinds, only: wp
   use number_text, only: read_real
   use text, only: count_of
   implicit none (type, external)
   private

   public :: all_numbers, csv_dialect_t, dialect_words, find_field, is_comment, is_number, &
      number_of_fields, read_field

   !> Blank and tab.
   character(*), parameter, public :: blanks = ' '//achar(9)
   character(*), parameter :: tab = achar(9), quote = '"'
   !> Errors that spreadsheets write into cells; they begin like comments.
   character(len=8), parameter :: cell_errors(*) = [character(len=8) :: '#N/A', '#NUM!', &
      '#DIV/0!', '#VALUE!', '#REF!', '#NAME?', '#NULL!']

   !> The separator of the fields, a blank for any number of blanks and tabs, and the decimal mark.
   type :: csv_dialect_t
      character(len=1) :: separator = ',', decimal = '.'
   end type csv_dialect_t

contains

   !> Where field number `i` of a line is, without blanks and quotes around it; empty behind the end
   !> of the line if there are fewer.
   pure subroutine find_field(dialect, line, i, first, last)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: line
      integer, intent(in) :: i
      integer, intent(out) :: first, last
      integer :: k, next

      next = 1
      do k = 1, i
         if (next > len(line) + 1) exit
         call take_field(dialect, line, next, first, last)
      end do
      if (k > i) return
      first = len(line) + 1
      last = len(line)
   end subroutine find_field

   !> The field that begins at `next`, which moves to the one behind it; beyond the end of the line
   !> plus 1: there is none.
   pure subroutine take_field(dialect, line, next, first, last)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: line
      integer, intent(inout) :: next
      integer, intent(out) :: first, last
      integer :: k, length

      length = 0
      k = verify(line(next:), blanks)
      if (dialect%separator == ' ' .and. k > 0) then
         next = next + k - 1
         k = 1
      end if
      if (k > 0) then
         ! A field in quotes ends behind the second one.
         if (line(next + k - 1:next + k - 1) == quote) length = k &
            + max(index(line(next + k:), quote), 0)
      end if
      if (dialect%separator == ' ') then
         k = scan(line(next + length:), blanks)
      else
         k = index(line(next + length:), dialect%separator)
      end if
      first = next
      last = merge(len(line), next + length + k - 2, k == 0)
      next = last + 2
      if (dialect%separator == ' ') then
         if (verify(line(min(next, len(line) + 1):), blanks) == 0) next = len(line) + 2
      end if
      k = verify(line(first:last), blanks)
      first = merge(last + 1, first + k - 1, k == 0)
      last = first - 1 + verify(line(first:last), blanks, back=.true.)
      if (last <= first) return
      if (line(first:first) /= quote .or. line(last:last) /= quote) return
      first = first + 1
      last = last - 1
   end subroutine take_field

   !> Number of fields of a line, at least 1.
   pure function number_of_fields(dialect, line) result(fields)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: line
      integer :: fields
      integer :: first, last, next

      if (dialect%separator /= ' ' .and. index(line, quote) == 0) then
         fields = 1 + count_of(dialect%separator, line)
         return
      end if
      fields = 0
      next = 1
      do while (next <= len(line) + 1)
         call take_field(dialect, line, next, first, last)
         fields = fields + 1
      end do
   end function number_of_fields

   !> Reads a field as a number. Behind a decimal comma a digit is expected.
   pure subroutine read_field(dialect, field, number, good)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: field
      real(wp), intent(out) :: number
      logical, intent(out) :: good
      character(len=len(field)) :: copy
      integer :: comma

      if (dialect%decimal == '.') then
         call read_real(field, number, good)
         return
      end if
      copy = field
      comma = index(field, ',')
      if (comma > 0) copy(comma:comma) = '.'
      call read_real(copy, number, good)
      if (comma > 0 .and. good) good = scan(field(min(comma + 1, len(field)):), &
         '0123456789') == 1
      good = good .and. index(field, '.') == 0
   end subroutine read_field

   !> Whether a field is a number; unless commas separate fields, its decimal mark may be either.
   pure function is_number(dialect, field)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: field
      logical :: is_number
      real(wp) :: number

      call read_field(csv_dialect_t(dialect%separator, '.'), field, number, is_number)
      if (.not. is_number .and. dialect%separator /= ',') call &
         read_field(csv_dialect_t(dialect%separator, ','), field, number, is_number)
   end function is_number

   !> Whether the fields of a line are two or more, and all of them numbers.
   pure function all_numbers(dialect, line)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: line
      logical :: all_numbers
      integer :: first, i, last

      all_numbers = .false.
      do i = 1, number_of_fields(dialect, line)
         call find_field(dialect, line, i, first, last)
         all_numbers = is_number(dialect, line(first:last)) .and. (i == 1 .or. all_numbers)
         if (.not. all_numbers) return
      end do
      all_numbers = i > 2
   end function all_numbers

   !> Whether a line is a comment: it begins with # or %, or is the `sep=` of spreadsheets.
   pure function is_comment(line)
      character(*), intent(in) :: line
      logical :: is_comment
      integer :: i, k

      k = max(verify(line, blanks), 1)
      is_comment = scan(line(k:min(k, len(line))), '#%') > 0
      if (.not. is_comment) then
         is_comment = len(line) < 8 .and. index(line, 'sep=') == 1
         return
      end if
      do i = 1, size(cell_errors)
         if (index(line(k:), trim(cell_errors(i))) == 1) is_comment = .false.
      end do
   end function is_comment

   !> The dialect in words.
   pure function dialect_words(dialect) result(words)
      type(csv_dialect_t), intent(in) :: dialect
      character(:), allocatable :: words

      select case (dialect%separator)
      case (',')
         words = 'fields separated by commas'
      case (';')
         words = 'fields separated by semicolons'
      case (tab)
         words = 'fields separated by tabs'
      case default
         words = 'fields separated by blanks'
      end select
      words = words//', numbers with a decimal '//trim(merge('comma', 'point', &
         dialect%decimal == ','))
   end function dialect_words

end module csv_dialect

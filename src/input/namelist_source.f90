!> A namelist file as its parser sees it: comments taken out, strings marked, lines counted; and the
!> values of one entry, cut into pieces. (Numbers: module number_text.)
module namelist_source
   use, intrinsic :: iso_fortran_env, only: int64
   use findings, only: findings_t
   use number_text, only: read_integer
   use text, only: quoted, to_lower, to_text
   implicit none (type, external)
   private

   public :: key_start, logical_word, name_end, new_source, piece_t, source_t, split_values, &
      without_returns

   !> The characters of the file as the parser sees them.
   type :: source_t
      !> Comments, line ends and tabs outside strings replaced by blanks.
      character(:), allocatable :: text
      !> The same with quotes in place of strings, and one more `&` at its end.
      character(:), allocatable :: code
      !> Line of each character.
      integer, allocatable :: line(:)
   end type source_t

   character(*), parameter, public :: line_feed = achar(10)
   character(*), parameter :: tab = achar(9), form_feed = achar(12), carriage_return = achar(13)
   character(*), parameter :: byte_order_mark = char(239) // char(187) // char(191)
   character(*), parameter :: name_characters = &
      'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'

   !> One value as written; of a string the content without its quotes.
   type :: piece_t
      character(:), allocatable :: text
      logical :: is_string = .false.
   end type piece_t

   !> Most values of one key.
   integer, parameter, public :: max_values = 2000

contains

   !> Removes comments and line ends, marks strings, counts lines. Finding: a string left open.
   subroutine new_source(source, content, findings)
      type(source_t), intent(out) :: source
      character(*), intent(in) :: content
      type(findings_t), intent(inout) :: findings
      integer :: i, opened, line
      character(len=1) :: byte, mark
      logical :: in_comment, in_string

      source%text = without_returns(content) // line_feed
      source%code = source%text // '&'
      allocate (source%line(len(source%text)))
      mark = ' '
      in_comment = .false.
      line = 1
      opened = 1
      if (index(content, byte_order_mark) == 1) source%text(1:3) = ' '
      do i = 1, len(source%text)
         source%line(i) = line
         byte = source%text(i:i)
         in_string = mark /= ' '
         if (byte == line_feed) then
            if (in_string) call findings%add(line, '', '', 'found the string '// &
               quoted(source%text(opened:i - 1))//', expected its closing '//mark// &
               ' on the same line')
            byte = mark
            mark = ' '
            in_comment = .false.
            line = line + 1
         else if (in_string) then
            if (byte == mark) mark = ' '
         else if (in_comment .or. byte == tab .or. byte == form_feed) then
            byte = ' '
         else if (byte == '!') then
            in_comment = .true.
            byte = ' '
         else if (byte == "'" .or. byte == '"') then
            mark = byte
            opened = i
            in_string = .true.
         end if
         source%text(i:i) = byte
         source%code(i:i) = merge('"', byte, in_string)
      end do
   end subroutine new_source

   !> `content` without carriage returns; a line feed follows each.
   pure function without_returns(content) result(text)
      character(*), intent(in) :: content
      character(:), allocatable :: text
      integer :: i, length

      text = content
      length = 0
      do i = 1, len(content)
         if (content(i:i) == carriage_return) cycle
         length = length + 1
         text(length:length) = content(i:i)
      end do
      text = text(:length)
   end function without_returns

   !> First character, from `first` on, of the key (with subscript) before the `=` at `sign`.
   pure function key_start(text, first, sign) result(start)
      character(*), intent(in) :: text
      integer, intent(in) :: first, sign
      integer :: start, bracket, last

      last = first - 1 + len_trim(text(first:sign - 1))
      if (index(text(first:last), ')', back=.true.) == last - first + 1) then
         bracket = index(text(first:last), '(', back=.true.)
         if (bracket > 0) last = first - 1 + len_trim(text(first:first + bracket - 2))
      end if
      start = first + verify(text(first:last), name_characters // '%', back=.true.)
      if (start > last) start = sign
   end function key_start

   !> Last character of the name that starts at `first`; first - 1: no name there.
   pure integer function name_end(text, first) result(last)
      character(*), intent(in) :: text
      integer, intent(in) :: first

      last = first - 2 + verify(text(first:), name_characters)
      if (last < first - 1) last = len(text)
   end function name_end

   !> Cuts `values` at blanks and commas; expands repeat counts as in 3*0.1.
   !>
   !> `problem` is allocated, with the words after "found", if the text is not a list of values.
   subroutine split_values(values, pieces, problem)
      character(*), intent(in) :: values
      type(piece_t), allocatable, intent(out) :: pieces(:)
      character(:), allocatable, intent(out) :: problem
      type(piece_t), allocatable :: list(:)
      type(piece_t) :: piece
      integer(int64) :: number
      integer :: position, blanks, count, digits, repeats
      logical :: comma_before, good

      allocate (list(merge(max_values, len(values)/2 + 1, index(values, '*') > 0)))
      count = 0
      comma_before = .true.
      position = 1
      do
         blanks = verify(values(position:), ' ') - 1
         if (blanks < 0) exit
         position = position + blanks
         if (values(position:position) == ',') then
            if (comma_before) then
               problem = 'an empty value before a comma (a null of the Fortran standard, not '// &
                  'taken here)'
               return
            end if
            comma_before = .true.
            position = position + 1
            cycle
         end if
         comma_before = .false.
         repeats = 1
         digits = verify(values(position:), '0123456789') - 1
         if (digits > 0 .and. index(values(position + max(digits, 0):), '*') == 1) then
            call read_integer(values(position:position + digits - 1), number, good)
            repeats = -1
            if (good .and. number <= max_values) repeats = int(number)
            position = position + digits + 1
         end if
         call read_piece(values, position, piece, problem)
         if (allocated(problem)) return
         if (scan(values(position:min(position, len(values))), ' ,') == 0 &
            .and. position <= len(values)) then
            problem = 'two values without a comma or blank between them'
            return
         end if
         if (repeats < 1 .or. count + repeats > max_values) then
            problem = 'a repeat count or list outside 1 to ' // to_text(max_values) // ' values'
            return
         end if
         list(count + 1:count + repeats) = piece
         count = count + repeats
      end do
      if (count == 0) problem = 'an empty value'
      pieces = list(:count)
   end subroutine split_values

   !> Reads the string, in which a doubled quote stands for one, or the bare value at `position`.
   !> Problem: nothing there (after `n*`).
   subroutine read_piece(values, position, piece, problem)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      type(piece_t), intent(out) :: piece
      character(:), allocatable, intent(out) :: problem
      character(len=1) :: mark
      integer :: length

      mark = ' '
      if (position <= len(values)) mark = values(position:position)
      piece%text = ''
      piece%is_string = mark == "'" .or. mark == '"'
      if (mark == ' ' .or. mark == ',') then
         problem = 'a repeat count without a value (a null of the Fortran standard, not taken here)'
      else if (.not. piece%is_string) then
         length = scan(values(position:)//' ', ' ,''"') - 1
         piece%text = values(position:position + length - 1)
         position = position + length
      end if
      do while (piece%is_string)
         length = index(values(position + 1:)//mark, mark) - 1
         piece%text = piece%text//values(position + 1:position + length)
         position = position + length + 2
         if (position > len(values)) exit
         if (values(position:position) /= mark) exit
         piece%text = piece%text//mark
      end do
   end subroutine read_piece

   !> '.true.' or '.false.', given in any case: true, false, t, f, with a point before it or on both
   !> sides; empty: the value is another one.
   pure function logical_word(piece) result(word)
      type(piece_t), intent(in) :: piece
      character(:), allocatable :: word

      word = ''
      if (piece%is_string) return
      select case (to_lower(piece%text))
      case ('.true.', 'true', '.true', '.t.', '.t', 't')
         word = '.true.'
      case ('.false.', 'false', '.false', '.f.', '.f', 'f')
         word = '.false.'
      case default
         return
      end select
   end function logical_word

end module namelist_source

!> A namelist file as its parser sees it: comments taken out, strings marked, lines counted.
module namelist_source
   use findings, only: findings_t
   use text, only: quoted
   implicit none (type, external)
   private

   public :: source_t, new_source, next_equals, key_start, name_end, without_returns

   !> The characters of the file as the parser sees them.
   type :: source_t
      !> Comments, line ends and tabs outside strings replaced by blanks.
      character(:), allocatable :: text
      !> True inside a string, its quotes included.
      logical, allocatable :: in_string(:)
      !> Line of each character.
      integer, allocatable :: line(:)
   end type source_t

   character(*), parameter, public :: line_feed = achar(10)
   character(*), parameter :: tab = achar(9), form_feed = achar(12), carriage_return = achar(13)
   character(*), parameter :: byte_order_mark = char(239) // char(187) // char(191)
   character(*), parameter :: name_characters = &
      'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'

contains

   !> Removes comments and line ends, marks strings, counts lines. Finding: a string left open.
   subroutine new_source(source, content, findings)
      type(source_t), intent(out) :: source
      character(*), intent(in) :: content
      type(findings_t), intent(inout) :: findings
      integer :: i, opened, line
      character(len=1) :: mark
      logical :: in_comment

      source%text = without_returns(content) // line_feed
      allocate (source%in_string(len(source%text)), source%line(len(source%text)))
      source%in_string = .false.
      mark = ' '
      in_comment = .false.
      line = 1
      opened = 1
      if (index(content, byte_order_mark) == 1) source%text(1:3) = ' '
      do i = 1, len(source%text)
         source%line(i) = line
         associate (byte => source%text(i:i))
            if (byte == line_feed) then
               if (mark /= ' ') then
                  call findings%add(line, '', '', 'found the string '// &
                     '' // quoted(source%text(opened:i - 1)) &
                     // ', expected its closing ' // mark // ' on the same line')
                  source%in_string(i) = .true.
               end if
               byte = mark
               mark = ' '
               in_comment = .false.
               line = line + 1
            else if (mark /= ' ') then
               source%in_string(i) = .true.
               if (byte == mark) mark = ' '
            else if (in_comment .or. byte == tab .or. byte == form_feed) then
               byte = ' '
            else if (byte == '!') then
               in_comment = .true.
               byte = ' '
            else if (byte == "'" .or. byte == '"') then
               mark = byte
               opened = i
               source%in_string(i) = .true.
            end if
         end associate
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

   !> Position of the next `=` outside strings from `first` on; last + 1: none.
   pure integer function next_equals(source, first, last) result(position)
      type(source_t), intent(in) :: source
      integer, intent(in) :: first, last

      do position = first, last
         if (source%text(position:position) == '=' .and. .not. source%in_string(position)) return
      end do
      position = last + 1
   end function next_equals

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

end module namelist_source

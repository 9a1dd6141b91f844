!> Cuts the text of a namelist file into entries, each with its group, key and line.
!>
!> Only the form is checked here: `input_keys` says which keys exist, `case_input` what their values
!> mean. Accepted is standard namelist syntax: groups `&name ... /` (or
!> `&end`), comments after `!`, several entries a line, values over several lines, blanks, tabs, CR
!> LF line ends (`text_file` makes LF of CR alone), a byte order mark. A string closes on its line.
module namelist_text
   use findings, only: findings_t
   use kinds, only: int64
   use number_text, only: read_integer
   use text, only: count_of, quoted, to_lower, to_text
   use text_file, only: encoding_fault
   implicit none (type, external)
   private

   public :: entry_t, namelist_text_t, split_namelist, without_returns

   !> One `key = values` of a group, or its head, without a key.
   type :: entry_t
      !> Lower-case names; `key` without its subscript.
      character(:), allocatable :: group, key
      !> The values as written, comments taken out, line ends turned into blanks.
      character(:), allocatable :: values
      !> Line of the key, or of the head; below 0: it is of the command line.
      integer :: line = 0
      !> Element at which the values start: 1, or the n of `key(n) = ...`, and the m of
      !> `key(n:m) = ...` at which they end; 0: it is not written.
      integer :: first = 1, last = 0
      !> True if a subscript is written.
      logical :: has_subscript = .false.
      !> True if the subscript cannot be read (and is reported).
      logical :: is_broken = .false.
      !> First and last character of the entry in the text, of a head those of the name.
      integer :: span(2) = 0
   end type entry_t

   !> A namelist file in pieces.
   type :: namelist_text_t
      !> Entries, those of a group behind its head; their number, and that of the heads.
      type(entry_t), allocatable :: entries(:)
      integer :: count = 0, group_count = 0
      !> Number of lines of the file.
      integer :: lines = 0
      !> The file without carriage returns, with blanks for comments, line ends and tabs outside
      !> strings.
      character(:), allocatable :: text
      !> The same with quotes in place of strings, and one more `&` at its end; line of each
      !> character.
      character(:), allocatable, private :: code
      integer, allocatable, private :: line(:)
   end type namelist_text_t

   !> Most entries and groups of one file: a broken file must not keep the program busy.
   integer, parameter :: max_entries = 5000, max_groups = 100
   character(*), parameter :: line_feed = achar(10), carriage_return = achar(13), tab = achar(9), &
      form_feed = achar(12), byte_order_mark = char(239)//char(187)//char(191)
   character(*), parameter :: name_characters = &
      'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'

contains

   !> Splits `content` into groups and entries. Findings: bytes that are no text, unclosed strings
   !> and groups, repeated groups and keys, text outside groups, text that is not `key = value`. A
   !> repeated group or key is not an entry.
   subroutine split_namelist(content, pieces, findings)
      character(*), intent(in) :: content
      type(namelist_text_t), intent(out) :: pieces
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: fault
      integer :: bad, position

      allocate (pieces%entries(max_groups + min(count_of('=', content), max_entries)))
      if (index(content, char(137)//'HDF') == 1) then
         call findings%add(1, '', '', 'found an HDF5 file, expected a namelist (results are '// &
            'shown by asperity table)')
         return
      end if
      call encoding_fault(content, fault, bad)
      if (bad > 0) then
         call findings%add(1 + count_of(line_feed, content(:bad - 1)), '', '', &
            'found ' // fault // ', expected a text file in UTF-8')
         return
      end if
      call blank_comments(content, pieces, findings)
      position = 1
      do while (position <= len(pieces%text))
         call read_outside(pieces, position, findings)
         if (position <= len(pieces%text)) call read_group(pieces, position, findings)
         if (pieces%group_count < max_groups .and. pieces%count - pieces%group_count &
            < max_entries) cycle
         call findings%add(pieces%line(min(position, len(pieces%text))), '', '', &
            'found more than ' // to_text(max_groups) // ' groups or ' // to_text(max_entries) // &
            ' entries, expected a namelist of a few dozen')
         exit
      end do
   end subroutine split_namelist

   !> Fills text, code and lines of `pieces`. Finding: a string left open.
   subroutine blank_comments(content, pieces, findings)
      character(*), intent(in) :: content
      type(namelist_text_t), intent(inout) :: pieces
      type(findings_t), intent(inout) :: findings
      integer :: i, opened
      character(len=1) :: byte, mark
      logical :: in_string

      pieces%text = without_returns(content)//line_feed
      pieces%code = pieces%text//'&'
      allocate (pieces%line(len(pieces%text)))
      if (index(content, byte_order_mark) == 1) pieces%text(1:3) = ' '
      mark = ' '   ! that of the string or comment that is open
      opened = 1
      pieces%lines = 1
      do i = 1, len(pieces%text)
         pieces%line(i) = pieces%lines
         byte = pieces%text(i:i)
         in_string = mark == "'" .or. mark == '"'
         if (byte == line_feed) then
            if (in_string) call findings%add(pieces%lines, '', '', 'found the string '// &
               quoted(pieces%text(opened:i - 1))//', expected its closing '//mark// &
               ' on the same line')
            if (i < len(pieces%text)) pieces%lines = pieces%lines + 1
            byte = merge(mark, ' ', in_string)
            mark = ' '
         else if (in_string) then
            if (byte == mark) mark = ' '
         else if (mark == '!' .or. byte == tab .or. byte == form_feed) then
            byte = ' '
         else if (byte == '!') then
            mark = byte
            byte = ' '
         else if (byte == "'" .or. byte == '"') then
            mark = byte
            opened = i
            in_string = .true.
         end if
         pieces%text(i:i) = byte
         pieces%code(i:i) = merge('"', byte, in_string)
      end do
   end subroutine blank_comments

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

   !> Moves `position` to the next `&`. Finding, once a line: text that is in no group; with a hint,
   !> if it is a comment of other languages or follows a group's /.
   subroutine read_outside(pieces, position, findings)
      type(namelist_text_t), intent(in) :: pieces
      integer, intent(inout) :: position
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: hint
      integer :: before, first, last

      associate (text => pieces%text, line => pieces%line)
         first = position
         position = first - 1 + index(pieces%code(first:), '&')
         do while (verify(text(first:position - 1), ' ') > 0)
            first = first - 1 + verify(text(first:position - 1), ' ')
            on_line: do last = first, position - 2
               if (line(last + 1) > line(first)) exit on_line
            end do on_line
            hint = ''
            if (text(first:first) == '#') hint = ' (a comment begins with !)'
            before = max(1, len_trim(text(:first - 1)))
            if (all([line(before) == line(first), text(before:before) == '/', &
               before < first])) hint = ' (a / that is not in quotes ends the group)'
            call findings%add(line(first), '', '', 'found '//quoted(text(first:last)) &
               //' outside a group, expected &group ... /'//hint)
            first = last + 1
         end do
      end associate
   end subroutine read_outside

   !> Reads one group, from its `&` to behind its `/`. Findings: no name, not closed, text that is
   !> no entry.
   subroutine read_group(pieces, position, findings)
      type(namelist_text_t), intent(inout) :: pieces
      integer, intent(inout) :: position
      type(findings_t), intent(inout) :: findings
      type(entry_t) :: head
      logical :: has_end, has_slash
      integer :: before, key, last, next, place

      head%line = pieces%line(position)
      head%span = [position + 1, name_end(pieces%text, position + 1)]
      head%group = to_lower(pieces%text(head%span(1):head%span(2)))
      head%key = ''
      position = head%span(2) + 1
      if (head%group == '') then
         call findings%add(head%line, '', '', 'found & without a name, expected &group')
      else if (head%group == 'end') then
         call findings%add(head%line, '', '', 'found &end outside a group, expected &group')
         return
      end if
      ! before the `/`, `&end`, next `&` or end of the file
      last = position - 2 + scan(pieces%code(position:), '/&')
      has_slash = pieces%code(last + 1:last + 1) == '/'
      has_end = to_lower(pieces%text(last + 1:name_end(pieces%text, last + 2))) == '&end'
      if (head%group /= '') then
         if (.not. (has_slash .or. has_end)) call findings%add(head%line, head%group, '', &
            'not closed, expected a closing /')
         before = pieces%count
         call add(pieces, head, findings)
         if (pieces%count == before) position = last + 1
         key = key_place(pieces, position, last)
         place = verify(pieces%text(position:key - 1), ' ,')
         if (place > 0) call findings%add(pieces%line(position - 1 + place), head%group, '', &
            'found '//quoted(trim(adjustl(pieces%text(position:key - 1))))// &
            ', expected key = value')
         do while (key <= last .and. pieces%count - pieces%group_count < max_entries)
            next = key_place(pieces, key + index(pieces%code(key:last), '='), last)
            call read_entry(pieces, key, next - 1, head%group, findings)
            key = next
         end do
      end if
      position = last + 1
      if (has_slash) position = position + 1
      if (has_end) position = position + 4
   end subroutine read_group

   !> Where the key (with subscript) before the first `=` of the characters `first` to `last`
   !> begins; without one at the `=`; last + 1: there is no `=`.
   pure integer function key_place(pieces, first, last) result(place)
      type(namelist_text_t), intent(in) :: pieces
      integer, intent(in) :: first, last
      integer :: bracket, length, sign

      place = last + 1
      sign = first - 1 + index(pieces%code(first:last), '=')
      if (sign < first) return
      associate (before => pieces%text(first:sign - 1))
         length = len_trim(before)
         if (index(before(:length), ')', back=.true.) == length) then
            bracket = index(before(:length), '(', back=.true.)
            if (bracket > 0) length = len_trim(before(:bracket - 1))
         end if
         place = first + verify(before(:length), name_characters//'%', back=.true.)
         if (place >= first + length) place = sign
      end associate
   end function key_place

   !> Last character of the name that starts at `first`; first - 1: no name there.
   pure integer function name_end(text, first) result(last)
      character(*), intent(in) :: text
      integer, intent(in) :: first

      last = first - 2 + verify(text(first:), name_characters)
      if (last < first - 1) last = len(text)
   end function name_end

   !> Reads the entry of the characters `first` to `last`. Finds no key, and a subscript that is not
   !> n or n:m > 0.
   subroutine read_entry(pieces, first, last, group, findings)
      type(namelist_text_t), intent(inout) :: pieces
      integer, intent(in) :: first, last
      character(*), intent(in) :: group
      type(findings_t), intent(inout) :: findings
      type(entry_t) :: entry
      integer(int64) :: ends(2)
      integer :: bracket, colon, sign
      logical :: good(2)
      character(:), allocatable :: name, subscript

      sign = first - 1 + index(pieces%code(first:last), '=')
      entry%group = group
      entry%span = [first, last]
      entry%line = pieces%line(first)
      entry%values = trim(adjustl(pieces%text(sign + 1:last)))
      name = trim(pieces%text(first:sign - 1))
      bracket = index(name//'(', '(')
      entry%key = to_lower(trim(name(:bracket - 1)))
      entry%has_subscript = bracket < len(name)
      if (entry%has_subscript) then
         subscript = name(bracket + 1:len(name) - 1)
         colon = index(subscript, ':')
         call read_integer(trim(adjustl(subscript(:merge(colon - 1, len(subscript), colon > 0)))), &
            ends(1), good(1))
         call read_integer(trim(adjustl(subscript(colon + 1:))), ends(2), good(2))
         entry%is_broken = .not. all(good .and. ends >= 1)
         ends = min(ends, int(shiftr(huge(1), 1), int64))   ! far too many, but the reader can count
         if (.not. entry%is_broken) entry%first = int(ends(1))
         if (.not. entry%is_broken .and. colon > 0) entry%last = int(ends(2))
         if (entry%is_broken) call findings%add(entry%line, group, entry%key, &
            'found the subscript ('//quoted(subscript)//'), expected one number or a range, '// &
            'as in '//entry%key//'(2) = ... and '//entry%key//'(2:4) = ...')
      end if
      if (entry%key == '') then
         call findings%add(entry%line, group, '', 'found = without a key, expected key = value')
      else
         call add(pieces, entry, findings)
      end if
   end subroutine read_entry

   !> Adds an entry or a head. Finding: it is not new.
   subroutine add(pieces, entry, findings)
      type(namelist_text_t), intent(inout) :: pieces
      type(entry_t), intent(in) :: entry
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = 1, pieces%count
         associate (old => pieces%entries(i))
            if (old%first /= entry%first .or. old%key /= entry%key) cycle
            if (old%group == entry%group) exit
         end associate
      end do
      if (i <= pieces%count) then
         call findings%add(entry%line, entry%group, entry%key, 'found the '//trim(merge('group', &
            'key  ', entry%key == ''))//' a second time, expected it once (line '// &
            to_text(pieces%entries(i)%line)//')')
         return
      end if
      pieces%count = pieces%count + 1
      if (entry%key == '') pieces%group_count = pieces%group_count + 1
      pieces%entries(pieces%count) = entry
   end subroutine add

end module namelist_text

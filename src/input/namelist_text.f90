!> Cuts the text of a namelist file into entries, each with its group, key and line.
!>
!> Only the form is checked here: `input_keys` says which keys exist, `case_input` what their values
!> mean. Accepted is standard namelist syntax: groups `&name ... /` (or
!> `&end`), comments after `!`, several entries a line, values over several lines, blanks, tabs, CR
!> LF line ends (`text_file` makes LF of CR alone), a byte order mark. A string closes on its line.
module namelist_text
   use, intrinsic :: iso_fortran_env, only: int64
   use findings, only: findings_t
   use namelist_source, only: key_start, line_feed, name_end, new_source, source_t
   use number_text, only: read_integer
   use text, only: count_of, quoted, to_lower, to_text
   use text_file, only: encoding_fault
   implicit none (type, external)
   private

   public :: entry_t, namelist_text_t, split_namelist

   !> One `key = values` of a group, or its head, without a key.
   type :: entry_t
      !> Lower-case names; `key` without its subscript.
      character(:), allocatable :: group, key
      !> The values as written, comments taken out, line ends turned into blanks.
      character(:), allocatable :: values
      !> Line of the key, or of the head.
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
   end type namelist_text_t

   !> Most entries and groups of one file: a broken file must not keep the program busy.
   integer, parameter :: max_entries = 5000, max_groups = 100

contains

   !> Splits `content` into groups and entries. Findings: bytes that are no text, unclosed strings
   !> and groups, repeated groups and keys, text outside groups, text that is not `key = value`. A
   !> repeated group or key is not an entry.
   subroutine split_namelist(content, pieces, findings)
      character(*), intent(in) :: content
      type(namelist_text_t), intent(out) :: pieces
      type(findings_t), intent(inout) :: findings
      type(source_t) :: source
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
      call new_source(source, content, findings)
      pieces%lines = 1 + count_of(line_feed, content)
      position = 1
      do while (position <= len(source%text))
         call read_outside(source, position, findings)
         if (position <= len(source%text)) call read_group(source, position, pieces, findings)
         if (pieces%group_count < max_groups .and. pieces%count - pieces%group_count &
            < max_entries) cycle
         call findings%add(source%line(min(position, len(source%text))), '', '', &
            'found more than ' // to_text(max_groups) // ' groups or ' // to_text(max_entries) // &
            ' entries, expected a namelist of a few dozen')
         exit
      end do
   end subroutine split_namelist

   !> Moves `position` to the next `&`. Finding, once a line: text that is in no group; with a hint,
   !> if it is a comment of other languages or follows a group's /.
   subroutine read_outside(source, position, findings)
      type(source_t), intent(in) :: source
      integer, intent(inout) :: position
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: hint
      integer :: before, first, last

      first = position
      position = first - 1 + index(source%code(first:), '&')
      do while (verify(source%text(first:position - 1), ' ') > 0)
         first = first - 1 + verify(source%text(first:position - 1), ' ')
         on_line: do last = first, position - 2
            if (source%line(last + 1) > source%line(first)) exit on_line
         end do on_line
         hint = ''
         if (source%text(first:first) == '#') hint = ' (a comment begins with !)'
         before = max(1, len_trim(source%text(:first - 1)))
         if (all([source%line(before) == source%line(first), source%text(before:before) == '/', &
            before < first])) hint = ' (a / that is not in quotes ends the group)'
         call findings%add(source%line(first), '', '', 'found '//quoted(source%text(first:last)) &
            //' outside a group, expected &group ... /'//hint)
         first = last + 1
      end do
   end subroutine read_outside

   !> Reads one group, from its `&` to behind its `/`. Findings: no name, repeated, not closed.
   subroutine read_group(source, position, pieces, findings)
      type(source_t), intent(in) :: source
      integer, intent(inout) :: position
      type(namelist_text_t), intent(inout) :: pieces
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: name
      logical :: has_end, has_slash, is_closed
      integer :: line, first, last, earlier, i

      line = source%line(position)
      first = position + 1
      last = name_end(source%text, first)
      name = to_lower(source%text(first:last))
      position = last + 1
      if (name == '') then
         call findings%add(line, '', '', 'found & without a name, expected &group')
      else if (name == 'end') then
         call findings%add(line, '', '', 'found &end outside a group, expected &group')
         return
      end if
      ! before the `/`, `&end`, next `&` or end of the file
      last = position - 2 + scan(source%code(position:), '/&')
      has_slash = source%code(last + 1:last + 1) == '/'
      has_end = to_lower(source%text(last + 1:min(last + 4, len(source%text)))) == '&end'
      is_closed = has_slash .or. (has_end .and. name_end(source%text, last + 2) == last + 4)
      if (.not. is_closed .and. name /= '') call findings%add(line, name, '', 'not closed, '// &
         'expected a closing /')
      earlier = 0
      do i = pieces%count, 1, -1
         if (pieces%entries(i)%group == name) earlier = pieces%entries(i)%line
      end do
      if (earlier > 0) then
         call findings%add(line, name, '', 'found the group a second time, expected it once '// &
            '(line ' // to_text(earlier) // ')')
      else if (name /= '') then
         pieces%group_count = pieces%group_count + 1
         pieces%count = pieces%count + 1
         associate (head => pieces%entries(pieces%count))
            head%group = name
            head%key = ''
            head%line = line
            head%span = [first, position - 1]
         end associate
         call split_group(source, position, last, name, pieces, findings)
      end if
      position = last + 1
      if (has_slash) position = position + 1
      if (has_end) position = position + 4
   end subroutine read_group

   !> Cuts source(first:last), the inside of a group, at its `=` signs into entries.
   subroutine split_group(source, first, last, group, pieces, findings)
      type(source_t), intent(in) :: source
      integer, intent(in) :: first, last
      character(*), intent(in) :: group
      type(namelist_text_t), intent(inout) :: pieces
      type(findings_t), intent(inout) :: findings
      integer :: sign, next_sign, key_at, next_key

      sign = first - 1 + index(source%code(first:last), '=')
      if (sign < first) sign = last + 1
      key_at = last + 1
      if (sign <= last) key_at = key_start(source%text, first, sign)
      if (verify(source%text(first:key_at - 1), ' ,') > 0) call findings%add( &
         source%line(first - 1 + verify(source%text(first:key_at - 1), ' ,')), group, '', 'found ' &
         // quoted(trim(adjustl(source%text(first:key_at - 1)))) // ', expected key = value')
      do while (sign <= last .and. pieces%count - pieces%group_count < max_entries)
         next_sign = sign + index(source%code(sign + 1:last), '=')
         if (next_sign == sign) next_sign = last + 1
         next_key = last + 1
         if (next_sign <= last) next_key = key_start(source%text, sign + 1, next_sign)
         call add_entry(source, [key_at, sign, next_key], group, pieces, findings)
         sign = next_sign
         key_at = next_key
      end do
   end subroutine split_group

   !> Adds the entry with its key from place(1), its `=` at place(2) and its values up to
   !> place(3) - 1. Finds no key, a subscript that is not n or n:m > 0, a repeated key.
   subroutine add_entry(source, place, group, pieces, findings)
      type(source_t), intent(in) :: source
      integer, intent(in) :: place(3)
      character(*), intent(in) :: group
      type(namelist_text_t), intent(inout) :: pieces
      type(findings_t), intent(inout) :: findings
      type(entry_t) :: entry
      integer(int64) :: ends(2)
      integer :: bracket, colon, earlier, i
      logical :: good(2)
      character(:), allocatable :: limits, name, subscript

      entry%group = group
      entry%span = [place(1), place(3) - 1]
      name = trim(source%text(place(1):place(2) - 1))
      entry%line = source%line(min(place(1) + verify(source%text(place(1):place(2)), ' ') - 1, &
         place(2)))
      entry%values = trim(adjustl(source%text(place(2) + 1:place(3) - 1)))
      bracket = index(name, '(')
      if (bracket > 0) then
         subscript = name(bracket + 1:len(name) - 1)
         name = trim(name(:bracket - 1))
         limits = subscript
         if (index(subscript, ':') == 0) limits = subscript//':'//subscript
         colon = index(limits, ':')
         call read_integer(trim(adjustl(limits(:colon - 1))), ends(1), good(1))
         call read_integer(trim(adjustl(limits(colon + 1:))), ends(2), good(2))
         entry%has_subscript = .true.
         entry%is_broken = .not. all(good .and. ends >= 1)
         ends = min(ends, int(shiftr(huge(1), 1), int64))   ! far too many, but the reader can count
         if (.not. entry%is_broken) entry%first = int(ends(1))
         if (.not. entry%is_broken .and. limits == subscript) entry%last = int(ends(2))
         if (entry%is_broken) call findings%add(entry%line, group, to_lower(name), &
            'found the subscript ('//quoted(subscript)//'), expected one number or a range, '// &
            'as in '//to_lower(name)//'(2) = ... and '//to_lower(name)//'(2:4) = ...')
      end if
      entry%key = to_lower(name)
      earlier = 0
      do i = pieces%count, 1, -1
         associate (old => pieces%entries(i))
            if (old%group /= group) exit
            if (old%key == entry%key .and. old%first == entry%first) earlier = old%line
         end associate
      end do
      if (entry%key == '') then
         call findings%add(entry%line, group, '', 'found = without a key, expected key = value')
      else if (earlier > 0) then
         call findings%add(entry%line, group, entry%key, 'found the key a second time, '// &
            'expected it once (line '//to_text(earlier)//')')
      else
         pieces%count = pieces%count + 1
         pieces%entries(pieces%count) = entry
      end if
   end subroutine add_entry

end module namelist_text

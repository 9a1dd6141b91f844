!> From the entries of a namelist to the values of a case.
!>
!> One by one, so that each failure has its line, group and key; `case_input` gives them meaning.
module value_reader
   use findings, only: findings_t
   use input_keys, only: find_group, find_key, group_rows, key_rows
   use input_values, only: input_values_t, value_t
   use key_row, only: every, expected_value, has_word, is_in_range, key_t, lubricated, &
      split_words, unit_question
   use kinds, only: int64, wp
   use namelist_text, only: namelist_text_t, entry_t
   use number_text, only: read_integer, read_real
   use line_contact, only: word_length
   use text, only: joined, quoted, to_lower, to_text
   use value_hints, only: answer_to, edit_distance, form_hint, nearest_known
   implicit none (type, external)
   private

   public :: piece_t, read_values, split_values

   !> One value as written; of a string the content without its quotes.
   type :: piece_t
      character(:), allocatable :: text
      logical :: is_string = .false.
   end type piece_t

   !> Most values of one key.
   integer, parameter :: max_values = 2000
   !> What a null of the Fortran standard is called.
   character(*), parameter :: no_null = ' (a null of the Fortran standard, not taken here)'

   !> Logicals in all forms, each first as it is stored.
   character(len=29), parameter :: logicals(2) = [character(len=29) :: &
      '.true. true .true .t. .t t', '.false. false .false .f. .f f']
   !> Values of the keys that have a default, read once a process.
   type(value_t), allocatable :: defaults(:)

contains

   !> Fills `values` with the defaults of the table and the entries of `pieces`.
   !>
   !> Finds unknown or not built groups, keys and words, values of the wrong type or number or out
   !> of range, arrays with elements left out.
   subroutine read_values(pieces, values)
      type(namelist_text_t), intent(in) :: pieces
      type(input_values_t), intent(inout) :: values
      integer :: i, row

      values%last_line = pieces%lines
      values%problem = problem_of(pieces)
      if (.not. allocated(defaults)) call read_defaults(values%findings)
      values%slots(1:) = defaults
      do i = 1, pieces%count
         associate (entry => pieces%entries(i))
            row = find_key(entry%group, entry%key, values%problem)
            if (row > 0) then
               call read_entry(entry, key_rows(row), values%slots(row), values%findings)
            else
               row = find_group(entry%group)
               if (row > 0 .and. entry%key == '') values%group_lines(row) = entry%line
               call check_name(entry, row, values%problem, values%findings)
            end if
         end associate
      end do
      do i = 1, size(key_rows)
         associate (row => key_rows(i), slot => values%slots(i))
            if (.not. slot%is_given) cycle
            if (.not. all(slot%is_set)) call values%findings%add(slot%line, row%group, row%key, &
               'found element ' // to_text(size(slot%is_set)) // ' but not element ' &
               // to_text(findloc(slot%is_set, .false., dim=1)) &
               // ', expected every element from 1 on')
         end associate
      end do
   end subroutine read_values

   !> Reads the defaults of the table, through the reader of the user's entries.
   subroutine read_defaults(findings)
      type(findings_t), intent(inout) :: findings
      type(entry_t) :: entry   ! gfortran loses the texts of a constructor that is an argument
      integer :: i

      allocate (defaults(size(key_rows)))
      do i = 1, size(key_rows)
         associate (row => key_rows(i), slot => defaults(i))
            call clear(slot)
            if (any(row%default == [character(len=8) :: 'required', 'chosen', '-'])) cycle
            entry%group = trim(row%group)
            entry%key = trim(row%key)
            entry%values = trim(row%default)
            call read_entry(entry, row, slot, findings)
            slot%is_given = .false.
            slot%is_set = [logical ::]
         end associate
      end do
   end subroutine read_defaults

   !> The problem that the file names; the lubricated one if that cannot be read.
   function problem_of(pieces) result(problem)
      type(namelist_text_t), intent(in) :: pieces
      character(len=word_length) :: problem
      character(len=2), parameter :: quotes = achar(39) // achar(34)
      character(:), allocatable :: word
      integer :: i

      problem = lubricated
      do i = 1, pieces%count
         associate (entry => pieces%entries(i))
            if (entry%group /= 'case' .or. entry%key /= 'problem') cycle
            word = to_lower(entry%values(scan(entry%values, quotes) + 1:))
            word = word(:scan(word // "'", quotes) - 1)
            if (has_word(every, word)) problem = word
         end associate
      end do
   end function problem_of

   !> Finding about the head of group number `group` (0: unknown) or a key that is no row: it is
   !> unknown, or not used by the problem. Keys of such a group are not told.
   subroutine check_name(entry, group, problem, findings)
      type(entry_t), intent(in) :: entry
      integer, intent(in) :: group
      character(*), intent(in) :: problem
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: message
      logical :: is_head, is_used

      is_head = entry%key == ''
      is_used = .false.
      if (group > 0) is_used = has_word(group_rows(group)%problems, problem)
      if (is_head .eqv. is_used) return
      message = "not used by problem = '"//trim(problem)//"': remove it"
      if (group == 0) then
         message = nearest_known(entry%group, group_rows%group)
         if (message /= '') message = '; did you mean &'//message//'?'
         message = 'found an unknown group, expected one of those that asperity --keys lists' &
            //message
      else if (.not. is_head .and. find_key(entry%group, entry%key, '') == 0) then
         message = on_unknown_key(entry, problem)
      end if
      call findings%add(entry%line, entry%group, entry%key, message)
   end subroutine check_name

   !> What is said of a key that no group of its name has: where it belongs, what to do instead, or
   !> what is near it.
   function on_unknown_key(entry, problem) result(message)
      type(entry_t), intent(in) :: entry
      character(*), intent(in) :: problem
      character(len=len(key_rows%key)) :: names(size(key_rows))
      character(:), allocatable :: hint, near, message
      integer :: i

      hint = ''
      names = ''
      do i = 1, size(key_rows)
         associate (row => key_rows(i))
            if (.not. has_word(row%problems, problem)) cycle
            if (row%group == entry%group) names(i) = row%key
            if (row%key == entry%key .and. hint == '') hint = '; it belongs to &'//trim(row%group)
         end associate
      end do
      near = nearest_known(entry%key, names)
      message = answer_to(entry%key)
      if (hint == '' .and. edit_distance(entry%key, near) > 2 .and. message /= '') then
         message = 'unknown key; '//message
      else
         if (hint == '' .and. near /= '') hint = '; did you mean '//near//'?'
         message = 'found an unknown key, expected one of ' // joined(pack(names, names /= ''), &
            ', ') // hint
      end if
   end function on_unknown_key

   !> A slot without a value.
   subroutine clear(slot)
      type(value_t), intent(inout) :: slot

      slot%text = ''
      slot%hint = ''
      slot%reals = [real(wp) ::]
      slot%words = [character(len=word_length) ::]
      slot%is_set = [logical ::]
   end subroutine clear

   !> Reads one entry into its slot; a default does not count any more. Findings: wrong number of
   !> values, wrong type, unknown word, out of range, an element once more.
   subroutine read_entry(entry, row, slot, findings)
      type(entry_t), intent(in) :: entry
      type(key_t), intent(in) :: row
      type(value_t), intent(inout) :: slot
      type(findings_t), intent(inout) :: findings
      type(piece_t), allocatable :: pieces(:)
      character(:), allocatable :: found, hint
      integer :: i, place

      if (entry%is_broken .or. .not. slot%is_given) call clear(slot)
      slot%is_given = .true.
      slot%has_value = .false.
      slot%line = entry%line
      if (entry%is_broken) return
      hint = ''
      call split_values(entry%values, pieces, found)
      if (found == '') call check_count(entry, row, size(pieces), found, hint)
      if (found /= '') then
         call findings%add(entry%line, entry%group, entry%key, 'found '//found//', expected '// &
            expected_value(row)//hint)
         return
      end if
      slot%has_value = .true.
      if (row%kind == 'reals' .and. index(entry%values, '*') == 0) slot%hint = &
         form_hint(entry%values, is_whole=.false.)
      associate (more => entry%first + size(pieces) - 1 - size(slot%is_set))   ! without room
         slot%reals = [slot%reals, (0.0_wp, i=1, more)]
         slot%words = [character(len=word_length) :: slot%words, (' ', i=1, more)]
         slot%is_set = [slot%is_set, (.false., i=1, more)]
      end associate
      do i = 1, size(pieces)
         place = entry%first + i - 1
         if (slot%is_set(place)) call findings%add(entry%line, entry%group, entry%key, &
            'found element '//to_text(place)//' a second time, expected it once')
         call store(pieces(i), row, place, slot, found)
         if (found /= '') call findings%add(entry%line, entry%group, entry%key, 'found '//found)
      end do
   end subroutine read_entry

   !> `found`: a subscript or a number of values that a key does not have; `hint`: what was meant.
   pure subroutine check_count(entry, row, number, found, hint)
      type(entry_t), intent(in) :: entry
      type(key_t), intent(in) :: row
      integer, intent(in) :: number
      character(:), allocatable, intent(inout) :: found, hint
      logical :: is_array

      is_array = any(row%kind == ['reals', 'words'])
      if (entry%has_subscript .and. .not. is_array) then
         found = 'a subscript'
      else if (number > 1 .and. .not. is_array) then
         found = to_text(number) // ' values, ' // quoted(entry%values)
         hint = form_hint(entry%values, row%kind == 'integer')
         if (all([hint == '', entry%group == 'load'])) hint = '; '//answer_to('load_steps')
      else if (max(entry%first + number - 1, entry%last) > max_values) then
         found = 'more than ' // to_text(max_values) // ' values'
      else if (all(entry%last /= [0, entry%first + number - 1])) then
         found = to_text(number)//' values for the elements '//to_text(entry%first)//' to ' &
            //to_text(entry%last)
      end if
   end subroutine check_count

   !> Stores one value as element `place`, a word in lower case. `found`, empty if it is good: what
   !> it is and what is expected.
   subroutine store(piece, row, place, slot, found)
      type(piece_t), intent(in) :: piece
      type(key_t), intent(in) :: row
      integer, intent(in) :: place
      type(value_t), intent(inout) :: slot
      character(:), allocatable, intent(out) :: found
      character(:), allocatable :: hint, word
      integer(int64) :: number
      integer :: truth
      logical :: good

      found = ''
      slot%is_set(place) = .true.
      hint = slot%hint
      word = to_lower(trim(piece%text))
      select case (row%kind)
      case ('real', 'reals')
         call read_real(piece%text, slot%reals(place), good)
         good = good .and. .not. piece%is_string
         if (good .and. hint == '') hint = unit_question(row, slot%reals(place))
         good = good .and. is_in_range(slot%reals(place), row%allowed)
      case ('integer')
         call read_integer(piece%text, number, good)
         slot%reals(place) = real(number, wp)
         good = all([good, .not. piece%is_string, abs(number) <= huge(1), &
            is_in_range(slot%reals(place), row%allowed)])
      case ('logical')
         truth = findloc(has_word(logicals, word) .and. .not. piece%is_string, .true., dim=1)
         good = truth > 0 .or. has_word(row%allowed, word)
         if (truth > 0) word = logicals(truth)(:index(logicals(truth), ' ') - 1)
         slot%words(place) = word
      case ('text')
         good = piece%is_string
         slot%text = piece%text
      case default   ! words
         good = all([piece%is_string, has_word(row%allowed, word)])
         slot%words(place) = '?'
         if (good) then
            slot%words(place) = word
         else if (piece%is_string) then
            hint = nearest_word(row, word)
         end if
      end select
      if (good) return
      slot%has_value = any(row%kind == ['word ', 'words'])   ! other words still count
      found = quoted(piece%text)
      if (all([slot%has_value, .not. piece%is_string])) found = found // ' without quotes'
      if (piece%is_string) found = "'" // found // "'"
      if (piece%is_string .and. piece%text == '') found = 'an empty string'
      found = found//', expected '//expected_value(row)//hint
   end subroutine store

   !> What to do instead of a `word`; "; did you mean 'word'?" with the nearest one of the row; or
   !> nothing.
   function nearest_word(row, word) result(hint)
      type(key_t), intent(in) :: row
      character(*), intent(in) :: word
      character(:), allocatable :: hint

      hint = nearest_known(word, split_words(row%allowed, ' '))
      if (hint /= '') hint = "; did you mean '" // hint // "'?"
      if (any(row%key == [character(len=12) :: 'problem', 'shape', 'space_scheme']) &
         .and. answer_to(word) /= '') hint = '; '//answer_to(word)
   end function nearest_word

   !> Cuts `values` at blanks and commas; expands repeat counts as in 3*0.1.
   !>
   !> `problem` are the words after "found" if the text is not a list of values; else it is empty.
   subroutine split_values(values, pieces, problem)
      character(*), intent(in) :: values
      type(piece_t), allocatable, intent(out) :: pieces(:)
      character(:), allocatable, intent(out) :: problem
      type(piece_t), allocatable :: list(:)
      type(piece_t) :: piece
      integer(int64) :: number
      integer :: position, count, repeats, star
      logical :: comma_before, good

      allocate (list(merge(max_values, len(values)/2 + 1, index(values, '*') > 0)))
      problem = ''
      count = 0
      comma_before = .true.
      position = 1
      do while (problem == '' .and. verify(values(position:), ' ') > 0)
         position = position - 1 + verify(values(position:), ' ')
         if (values(position:position) == ',') then
            if (comma_before) problem = 'an empty value before a comma'//no_null
            comma_before = .true.
            position = position + 1
            cycle
         end if
         comma_before = .false.
         repeats = 1
         star = position - 1 + verify(values(position:), '0123456789')
         if (star > position) then
            if (values(star:star) == '*') then
               call read_integer(values(position:star - 1), number, good)
               repeats = -1
               if (good .and. number <= max_values) repeats = int(number)
               position = star + 1
            end if
         end if
         call read_piece(values, position, piece)
         if (piece%text == '' .and. .not. piece%is_string) then
            problem = 'a repeat count without a value'//no_null
         else if (verify(values(position:min(position, len(values))), ' ,') > 0) then
            problem = 'two values without a comma or blank between them'
         else if (repeats < 1 .or. count + repeats > max_values) then
            problem = 'a repeat count or list outside 1 to ' // to_text(max_values) // ' values'
         else
            list(count + 1:count + repeats) = piece
            count = count + repeats
         end if
      end do
      if (problem == '' .and. count == 0) problem = 'an empty value'
      pieces = list(:count)
   end subroutine split_values

   !> Reads the string, in which a doubled quote stands for one, or the bare value at `position`;
   !> it is empty where there is none.
   subroutine read_piece(values, position, piece)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      type(piece_t), intent(out) :: piece
      character(len=1) :: mark
      integer :: length

      mark = values(position:min(position, len(values)))
      piece%is_string = mark == "'" .or. mark == '"'
      piece%text = ''
      if (.not. piece%is_string) then
         length = scan(values(position:), ' ,''"') - 1
         if (length < 0) length = len(values) - position + 1
         piece%text = values(position:position + length - 1)
         position = position + length
      end if
      do while (piece%is_string)
         length = index(values(position + 1:), mark) - 1
         piece%text = piece%text//values(position + 1:position + length)
         position = position + length + 2
         if (position > len(values)) exit
         if (values(position:position) /= mark) exit
         piece%text = piece%text//mark
      end do
   end subroutine read_piece

end module value_reader

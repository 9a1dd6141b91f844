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
   use namelist_source, only: logical_word, max_values, piece_t, split_values
   use number_text, only: read_integer, read_real
   use line_contact, only: word_length
   use text, only: joined, quoted, to_lower, to_text
   use value_hints, only: answer_to, edit_distance, form_hint, nearest_known
   implicit none (type, external)
   private

   public :: read_values

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
      character(:), allocatable :: hint
      integer :: group, i, row

      values%last_line = pieces%lines
      values%problem = problem_of(pieces)
      if (.not. allocated(defaults)) call read_defaults(values%findings)
      values%slots(1:) = defaults
      do i = 1, pieces%count
         associate (entry => pieces%entries(i))
            group = find_group(entry%group)
            row = find_key(entry%group, entry%key, values%problem)
            if (row > 0) then
               call read_entry(entry, key_rows(row), values%slots(row), values%findings)
            else if (group > 0 .and. entry%key /= '') then
               call report_unknown_key(entry, values%problem, values%findings)
            else if (group > 0) then
               values%group_lines(group) = entry%line
               if (.not. has_word(group_rows(group)%problems, values%problem)) call &
                  values%findings%add(entry%line, entry%group, '', not_used_by(values%problem))
            else if (entry%key == '') then
               hint = nearest_known(entry%group, group_rows%group)
               if (hint /= '') hint = '; did you mean &' // hint // '?'
               call values%findings%add(entry%line, entry%group, '', 'found an unknown group, '// &
                  'expected one of those that asperity --keys lists'//hint)
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
      character(:), allocatable :: word
      character(len=2), parameter :: quotes = achar(39) // achar(34)
      integer :: i

      problem = lubricated
      do i = 1, pieces%count
         associate (entry => pieces%entries(i))
            if (entry%group /= 'case' .or. entry%key /= 'problem' .or. len(entry%values) < 3) cycle
            word = to_lower(entry%values(scan(entry%values, quotes) + 1:))
            word = word(:scan(word // "'", quotes) - 1)
            if (has_word(every, word)) problem = word
         end associate
      end do
   end function problem_of

   !> Finding: a key that is unknown, belongs to another group, or is not used by the problem.
   subroutine report_unknown_key(entry, problem, findings)
      type(entry_t), intent(in) :: entry
      character(*), intent(in) :: problem
      type(findings_t), intent(inout) :: findings
      character(len=len(key_rows%key)) :: names(size(key_rows))
      character(:), allocatable :: hint, near, message
      logical :: is_known
      integer :: i

      hint = ''
      names = ''
      is_known = .false.
      do i = 1, size(key_rows)
         associate (row => key_rows(i))
            is_known = is_known .or. (row%group == entry%group .and. row%key == entry%key)
            if (.not. has_word(row%problems, problem)) cycle
            if (row%group == entry%group) names(i) = row%key
            if (row%key == entry%key .and. hint == '') hint = '; it belongs to &'//trim(row%group)
         end associate
      end do
      if (.not. has_word(group_rows(find_group(entry%group))%problems, problem)) return
      near = nearest_known(entry%key, names)
      if (is_known) then
         message = not_used_by(problem)
      else if (hint == '' .and. edit_distance(entry%key, near) > 2 .and. answer_to(entry%key) &
         /= '') then
         message = 'unknown key; '//answer_to(entry%key)
      else
         if (hint == '' .and. near /= '') hint = '; did you mean '//near//'?'
         message = 'found an unknown key, expected one of ' // joined(pack(names, names /= ''), &
            ', ') // hint
      end if
      call findings%add(entry%line, entry%group, quoted(entry%key), message)
   end subroutine report_unknown_key

   !> That a key or group belongs to other problems.
   pure function not_used_by(problem) result(message)
      character(*), intent(in) :: problem
      character(:), allocatable :: message

      message = "not used by problem = '"//trim(problem)//"': remove it"
   end function not_used_by

   !> A slot without a value.
   subroutine clear(slot)
      type(value_t), intent(inout) :: slot

      slot%text = ''
      slot%reals = [real(wp) ::]
      slot%words = [character(len=word_length) ::]
      slot%is_set = [logical ::]
   end subroutine clear

   !> Reads one entry into its slot; a default does not count any more. Findings: wrong number of
   !> values, wrong type, unknown word, out of range.
   subroutine read_entry(entry, row, slot, findings)
      type(entry_t), intent(in) :: entry
      type(key_t), intent(in) :: row
      type(value_t), intent(inout) :: slot
      type(findings_t), intent(inout) :: findings
      type(piece_t), allocatable :: pieces(:)
      character(:), allocatable :: hint, problem
      logical :: is_array
      integer :: i, missing

      if (entry%is_broken .or. .not. slot%is_given) then
         call clear(slot)
         slot%hint = ''
      end if
      slot%is_given = .true.
      slot%has_value = .false.
      slot%line = entry%line
      if (entry%is_broken) return
      is_array = any(row%kind == ['reals', 'words'])
      hint = ''
      call split_values(entry%values, pieces, problem)
      if (.not. allocated(problem)) then
         if (entry%has_subscript .and. .not. is_array) then
            problem = 'a subscript'
         else if (size(pieces) > 1 .and. .not. is_array) then
            problem = to_text(size(pieces)) // ' values, ' // quoted(entry%values)
            hint = form_hint(entry%values, row%kind == 'integer')
            if (all([hint == '', entry%group == 'load'])) hint = '; '//answer_to('load_steps')
         else if (max(entry%first + size(pieces) - 1, entry%last) > max_values) then
            problem = 'more than ' // to_text(max_values) // ' values'
         else if (all(entry%last /= [0, entry%first + size(pieces) - 1])) then
            problem = to_text(size(pieces))//' values for the elements '//to_text(entry%first) &
               //' to '//to_text(entry%last)
         end if
      end if
      if (allocated(problem)) then
         call findings%add(entry%line, entry%group, entry%key, 'found ' // problem &
            // ', expected ' // expected_value(row) // hint)
         return
      end if
      slot%has_value = .true.
      if (row%kind == 'reals' .and. index(entry%values, '*') == 0) slot%hint = &
         form_hint(entry%values, is_whole=.false.)
      missing = entry%first + size(pieces) - 1 - size(slot%is_set)   ! elements without room
      slot%reals = [slot%reals, (0.0_wp, i=1, missing)]
      slot%words = [character(len=word_length) :: slot%words, (' ', i=1, missing)]
      slot%is_set = [slot%is_set, (.false., i=1, missing)]
      do i = 1, size(pieces)
         call store(entry, row, pieces(i), entry%first + i - 1, slot, findings)
      end do
   end subroutine read_entry

   !> Stores one value as element `place`, a word in lower case. Findings: wrong type, unknown word,
   !> out of range.
   subroutine store(entry, row, piece, place, slot, findings)
      type(entry_t), intent(in) :: entry
      type(key_t), intent(in) :: row
      type(piece_t), intent(in) :: piece
      integer, intent(in) :: place
      type(value_t), intent(inout) :: slot
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: found, hint, word
      integer(int64) :: number
      logical :: good

      if (slot%is_set(place)) call findings%add(entry%line, entry%group, entry%key, &
         'found element '//to_text(place)//' a second time, expected it once')
      slot%is_set(place) = .true.
      hint = slot%hint
      word = to_lower(trim(piece%text))
      good = .true.
      select case (row%kind)
      case ('real', 'reals')
         call read_real(piece%text, slot%reals(place), good)
         good = good .and. .not. piece%is_string
         if (good .and. slot%hint == '') hint = unit_question(row, slot%reals(place))
         good = good .and. is_in_range(slot%reals(place), row%allowed)
      case ('integer')
         call read_integer(piece%text, number, good)
         good = all([good, .not. piece%is_string, abs(number) <= huge(1), is_in_range(real(number, &
            wp), row%allowed)])
         slot%reals(place) = real(number, wp)
      case ('logical')
         if (.not. has_word(row%allowed, word)) word = logical_word(piece)
         good = word /= ''
         slot%words(place) = word
      case ('word', 'words')
         good = all([piece%is_string, has_word(row%allowed, word)])
         slot%words(place) = '?'
         if (good) then
            slot%words(place) = word
         else if (piece%is_string) then
            hint = nearest_word(row, word)
         end if
      case default   ! text
         good = piece%is_string
         slot%text = piece%text
      end select
      if (good) return
      slot%has_value = any(row%kind == ['word ', 'words'])   ! other words still count
      found = quoted(piece%text)
      if (all([slot%has_value, .not. piece%is_string])) found = found // ' without quotes'
      if (piece%is_string) found = "'" // found // "'"
      if (piece%is_string .and. len_trim(piece%text) == 0) found = 'an empty string'
      call findings%add(entry%line, entry%group, entry%key, 'found ' // found // ', expected ' &
         // expected_value(row) // hint)
   end subroutine store

   !> What to do instead of a `word`; "; did you mean 'word'?" with the nearest one of the row; or
   !> nothing.
   function nearest_word(row, word) result(hint)
      type(key_t), intent(in) :: row
      character(*), intent(in) :: word
      character(:), allocatable :: hint

      hint = ''
      if (any(row%key == [character(len=12) :: 'problem', 'shape', 'space_scheme'])) hint = &
         answer_to(word)
      if (hint /= '') then
         hint = '; '//hint
      else
         hint = nearest_known(word, split_words(row%allowed, ' '))
         if (hint /= '') hint = "; did you mean '" // hint // "'?"
      end if
   end function nearest_word

end module value_reader

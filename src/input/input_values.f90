!> The values of one case, one slot for each row of the key table: defaults first, then what the
!> user gives.
!>
!> Read entry by entry, so that every failure has its line, group and key. What a value means for
!> the case is the business of `case_input`.
module input_values
   use findings, only: findings_t, quoted
   use input_keys, only: find_group, find_key, group_rows, key_rows, later_meaning, &
      renamed_words
   use key_range, only: is_in_range
   use key_row, only: every, expected_value, has_word, integer_kind, is_chosen, is_optional, &
      is_required, key_row_t, logical_kind, lubricated, real_kind, reals_kind, word_kind, words_kind
   use kinds, only: wp
   use namelist_text, only: namelist_text_t, entry_t
   use namelist_values, only: piece_t, split_values, read_real, read_integer, read_logical, &
      most_values
   use nearest_name, only: nearest_known
   use solver_settings, only: word_length
   use text, only: to_text, to_lower
   implicit none (type, external)
   private

   public :: value_t, input_values_t, read_values

   !> The value of one key.
   type :: value_t
      !> True if the user gave it (also when it could not be read).
      logical :: is_given = .false.
      !> True if there is a value, from the user or from the table.
      logical :: has_value = .false.
      !> Line of the key in the file; 0: not given.
      integer :: line = 0
      real(wp), allocatable :: reals(:)
      integer :: integer = 0
      logical :: logical = .false.
      !> Words; of a logical '.true.' or '.false.'.
      character(len=word_length), allocatable :: words(:)
      character(:), allocatable :: text
      !> Elements that the user has set (arrays).
      logical, allocatable :: is_set(:)
   end type value_t

   !> The values of all keys, in the order of `key_rows`, and where the groups are.
   type :: input_values_t
      type(value_t) :: slots(size(key_rows))
      !> Line of each group of `group_rows`; 0: not in the file.
      integer :: group_lines(size(group_rows)) = 0
      !> The problem, as far as it could be read; else the lubricated one.
      character(len=word_length) :: problem = lubricated
      !> Last line of the file, where missing groups are reported.
      integer :: last_line = 0
   contains
      procedure :: slot
      procedure :: real_value
      procedure :: word_value
      procedure :: is_given
      procedure :: has_value
      procedure :: has_group
      procedure :: line_of
   end type input_values_t

contains

   !> Fills `values` with the defaults of the table and the entries of `pieces`.
   !>
   !> Finds unknown or not built groups, keys and words, values of the wrong type or number or out
   !> of range.
   subroutine read_values(pieces, values, findings)
      type(namelist_text_t), intent(in) :: pieces
      type(input_values_t), intent(out) :: values
      type(findings_t), intent(inout) :: findings
      integer :: i, row

      values%last_line = pieces%lines
      values%problem = problem_of(pieces)
      do i = 1, size(key_rows)
         call read_default(key_rows(i), values%slots(i), findings)
      end do
      do i = 1, pieces%group_count
         row = find_group(pieces%groups(i)%name)
         if (row > 0) values%group_lines(row) = pieces%groups(i)%line
         call check_group(pieces%groups(i)%name, pieces%groups(i)%line, row, values%problem, &
            findings)
      end do
      do i = 1, pieces%entry_count
         associate (entry => pieces%entries(i))
            row = find_key(entry%group, entry%key, values%problem)
            if (row > 0) then
               call read_entry(entry, key_rows(row), values%slots(row), findings)
            else if (find_group(entry%group) > 0) then
               call report_unknown_key(entry, values%problem, findings)
            end if
         end associate
      end do
      do i = 1, size(key_rows)
         call check_holes(key_rows(i), values%slots(i), findings)
      end do
   end subroutine read_values

   !> The problem that the file names; the lubricated one if that cannot be read.
   function problem_of(pieces) result(problem)
      type(namelist_text_t), intent(in) :: pieces
      character(len=word_length) :: problem
      character(:), allocatable :: word
      character(len=2), parameter :: quotes = achar(39) // achar(34)
      integer :: i

      problem = lubricated
      do i = 1, pieces%entry_count
         associate (entry => pieces%entries(i))
            if (entry%group /= 'case' .or. entry%key /= 'problem' .or. len(entry%values) < 3) cycle
            word = to_lower(entry%values(scan(entry%values, quotes) + 1:))
            word = word(:scan(word // "'", quotes) - 1)
            if (has_word(every, word)) problem = word
         end associate
      end do
   end function problem_of

   !> Finding: a group that is unknown, or not used by the problem.
   subroutine check_group(name, line, row, problem, findings)
      character(*), intent(in) :: name
      integer, intent(in) :: line, row
      character(*), intent(in) :: problem
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: hint

      if (row > 0) then
         if (.not. has_word(group_rows(row)%problems, trim(problem))) call findings%add(line, &
            name, '', "found a group that problem = '"//trim(problem) &
            //"' does not use, expected it left out")
         return
      end if
      hint = nearest_known(name, group_rows%group)
      if (hint /= '') hint = '; did you mean &' // hint // '?'
      call findings%add(line, name, '', 'found an unknown group, expected one of those that '// &
         'asperity --keys lists' // hint)
   end subroutine check_group

   !> Finding: a key that is unknown, belongs to another group, or is known and not built yet.
   subroutine report_unknown_key(entry, problem, findings)
      type(entry_t), intent(in) :: entry
      character(*), intent(in) :: problem
      type(findings_t), intent(inout) :: findings
      character(len=len(key_rows%key)) :: names(size(key_rows))
      character(:), allocatable :: hint, shown
      integer :: i, row

      shown = quoted(entry%key)
      if (later_meaning(entry%group, entry%key) /= '') then
         call findings%add(entry%line, entry%group, shown, 'found a key that is not built yet (' &
            // later_meaning(entry%group, entry%key) // ')')
         return
      end if
      row = find_group(entry%group)
      if (.not. has_word(group_rows(row)%problems, trim(problem))) return
      do i = 1, size(key_rows)
         if (key_rows(i)%group /= entry%group .or. key_rows(i)%key /= entry%key) cycle
         call findings%add(entry%line, entry%group, shown, 'found a key that problem = '// &
            "'" // trim(problem) &
            // "' does not use, expected it left out")
         return
      end do
      hint = ''
      do i = 1, size(key_rows)
         names(i) = ''
         if (.not. has_word(key_rows(i)%problems, trim(problem))) cycle
         if (key_rows(i)%group == entry%group) names(i) = key_rows(i)%key
         if (key_rows(i)%key == entry%key .and. hint == '') hint = '; it belongs to &' &
            // trim(key_rows(i)%group)
      end do
      if (hint == '') then
         hint = nearest_known(entry%key, names)
         if (hint /= '') hint = '; did you mean ' // hint // '?'
      end if
      call findings%add(entry%line, entry%group, shown, 'found an unknown key, expected one '// &
         'of ' // joined(names) // hint)
   end subroutine report_unknown_key

   !> The names that are not empty, separated by commas.
   pure function joined(names) result(list)
      character(*), intent(in) :: names(:)
      character(:), allocatable :: list
      integer :: i

      list = ''
      do i = 1, size(names)
         if (names(i) == '') cycle
         if (list /= '') list = list // ', '
         list = list // trim(names(i))
      end do
   end function joined

   !> Reads the default of a row through the reader of the user's entries.
   subroutine read_default(row, slot, findings)
      type(key_row_t), intent(in) :: row
      type(value_t), intent(inout) :: slot
      type(findings_t), intent(inout) :: findings
      type(entry_t) :: entry

      allocate (slot%reals(0), slot%words(0), slot%is_set(0))
      slot%text = ''
      if (row%default == is_required .or. row%default == is_chosen &
         .or. row%default == is_optional) return
      entry%group = trim(row%group)
      entry%key = trim(row%key)
      entry%values = trim(row%default)
      call read_entry(entry, row, slot, findings)
      slot%is_given = .false.
      deallocate (slot%is_set)
      allocate (slot%is_set(0))
   end subroutine read_default

   !> Reads one entry into its slot. Findings: wrong number of values, wrong type, unknown word, out
   !> of range.
   subroutine read_entry(entry, row, slot, findings)
      type(entry_t), intent(in) :: entry
      type(key_row_t), intent(in) :: row
      type(value_t), intent(inout) :: slot
      type(findings_t), intent(inout) :: findings
      type(piece_t), allocatable :: pieces(:)
      character(:), allocatable :: problem
      logical :: is_array
      integer :: i

      if (entry%is_broken) then
         call forget_default(slot)
         slot%has_value = .false.
         slot%line = entry%line
         return
      end if
      is_array = row%kind == reals_kind .or. row%kind == words_kind
      call split_values(entry%values, pieces, problem)
      if (.not. allocated(problem)) then
         if (entry%has_subscript .and. .not. is_array) then
            problem = 'a subscript'
         else if (size(pieces) > 1 .and. .not. is_array) then
            problem = to_text(size(pieces)) // ' values, ' // quoted(entry%values)
         else if (entry%first + size(pieces) - 1 > most_values) then
            problem = 'more than ' // to_text(most_values) // ' values'
         end if
      end if
      if (.not. slot%is_given) call forget_default(slot)
      slot%line = entry%line
      if (allocated(problem)) then
         call reject(entry, row, problem, findings)
         slot%has_value = .false.
         return
      end if
      slot%has_value = .true.
      call make_room(slot, entry%first + size(pieces) - 1)
      do i = 1, size(pieces)
         call store(entry, row, pieces(i), entry%first + i - 1, slot, findings)
      end do
   end subroutine read_entry

   !> The user gives the key: the default does not count any more.
   subroutine forget_default(slot)
      type(value_t), intent(inout) :: slot

      slot%is_given = .true.
      slot%text = ''
      slot%reals = [real(wp) ::]
      slot%words = [character(len=word_length) ::]
      slot%is_set = [logical ::]
   end subroutine forget_default

   !> Gives the arrays of a slot at least `length` elements.
   subroutine make_room(slot, length)
      type(value_t), intent(inout) :: slot
      integer, intent(in) :: length
      integer :: missing, i

      missing = length - size(slot%is_set)
      if (missing <= 0) return
      slot%reals = [slot%reals, (0.0_wp, i=1, missing)]
      slot%words = [slot%words, (repeat(' ', word_length), i=1, missing)]
      slot%is_set = [slot%is_set, (.false., i=1, missing)]
   end subroutine make_room

   !> Stores one value as element `place`.
   subroutine store(entry, row, piece, place, slot, findings)
      type(entry_t), intent(in) :: entry
      type(key_row_t), intent(in) :: row
      type(piece_t), intent(in) :: piece
      integer, intent(in) :: place
      type(value_t), intent(inout) :: slot
      type(findings_t), intent(inout) :: findings
      logical :: good

      if (slot%is_set(place)) call findings%add(entry%line, entry%group, entry%key, &
         'found element ' // to_text(place) &
         // ' a second time, expected it once')
      slot%is_set(place) = .true.
      good = .true.
      select case (row%kind)
      case (real_kind, reals_kind)
         call read_real(piece, slot%reals(place), good)
         if (good) good = is_in_range(slot%reals(place), row%range)
      case (integer_kind)
         call read_integer(piece, slot%integer, good)
         if (good) good = is_in_range(real(slot%integer, wp), row%range)
      case (logical_kind)
         call read_logical(piece, slot%logical, good)
         slot%words(place) = merge('.true. ', '.false.', slot%logical)
      case (word_kind, words_kind)
         call store_word(entry, row, piece, slot%words(place), findings)
      case default
         good = piece%is_string
         slot%text = piece%text
      end select
      if (good) return
      call reject(entry, row, shown_piece(piece), findings)
      slot%has_value = .false.
   end subroutine store

   !> Stores a word in lower case. Finding: not a string, unknown, or not built yet.
   subroutine store_word(entry, row, piece, word, findings)
      type(entry_t), intent(in) :: entry
      type(key_row_t), intent(in) :: row
      type(piece_t), intent(in) :: piece
      character(len=word_length), intent(out) :: word
      type(findings_t), intent(inout) :: findings
      character(:), allocatable :: lower

      word = '?'
      lower = to_lower(trim(piece%text))
      if (.not. piece%is_string) then
         call reject(entry, row, shown_piece(piece) // ' without quotes', findings)
      else if (has_word(row%later_words, lower)) then
         call reject(entry, row, shown_piece(piece) // ', which is not built yet', findings)
      else if (.not. has_word(row%words, lower)) then
         call reject(entry, row, shown_piece(piece), findings, nearest_word(row, lower))
      else
         word = lower
      end if
   end subroutine store_word

   !> "; 'word' is the new name" of a renamed `word`, "; did you mean 'word'?" with the word of the
   !> row nearest to it, or nothing.
   function nearest_word(row, word) result(hint)
      type(key_row_t), intent(in) :: row
      character(*), intent(in) :: word
      character(:), allocatable :: hint
      character(len=word_length) :: candidates(10)
      character(:), allocatable :: words
      integer :: i, blank

      do i = 1, size(renamed_words)
         if (renamed_words(i)%key /= row%key .or. renamed_words(i)%old /= word) cycle
         hint = "; '" // trim(renamed_words(i)%new) // "' is its new name"
         return
      end do
      candidates = ''
      words = trim(row%words)
      do i = 1, size(candidates)
         if (len(words) == 0) exit
         blank = index(words // ' ', ' ')
         candidates(i) = words(:blank - 1)
         words = words(min(blank + 1, len(words) + 1):)
      end do
      hint = nearest_known(word, candidates)
      if (hint /= '') hint = "; did you mean '" // hint // "'?"
   end function nearest_word

   !> Adds "found ..., expected ..." for an entry.
   subroutine reject(entry, row, found, findings, hint)
      type(entry_t), intent(in) :: entry
      type(key_row_t), intent(in) :: row
      character(*), intent(in) :: found
      type(findings_t), intent(inout) :: findings
      character(*), intent(in), optional :: hint
      character(:), allocatable :: message

      message = 'found ' // found // ', expected ' // expected_value(row)
      if (present(hint)) message = message // hint
      call findings%add(entry%line, entry%group, entry%key, message)
   end subroutine reject

   !> A value as the user wrote it.
   function shown_piece(piece) result(shown)
      type(piece_t), intent(in) :: piece
      character(:), allocatable :: shown

      shown = quoted(piece%text)
      if (piece%is_string) shown = "'" // shown // "'"
      if (piece%is_string .and. len_trim(piece%text) == 0) shown = 'an empty string'
   end function shown_piece

   !> Finding: an array with elements left out.
   subroutine check_holes(row, slot, findings)
      type(key_row_t), intent(in) :: row
      type(value_t), intent(in) :: slot
      type(findings_t), intent(inout) :: findings

      if (.not. slot%is_given .or. all(slot%is_set)) return
      call findings%add(slot%line, row%group, row%key, 'found element '// &
         '' // to_text(size(slot%is_set)) // ' but not element ' &
         // to_text(findloc(slot%is_set, .false., dim=1)) // ', expected every element from 1 on')
   end subroutine check_holes

   !> The slot of a key of the table.
   pure function slot(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      type(value_t) :: slot

      slot = self%slots(find_key(group, key, self%problem))
   end function slot

   !> The real value of a key; 0 if there is none.
   pure function real_value(self, group, key) result(value)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      real(wp) :: value
      integer :: row

      value = 0.0_wp
      row = find_key(group, key, self%problem)
      if (self%slots(row)%has_value) value = self%slots(row)%reals(1)
   end function real_value

   !> The word of a key; '?' if there is none.
   pure function word_value(self, group, key) result(word)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      character(len=word_length) :: word
      integer :: row

      word = '?'
      row = find_key(group, key, self%problem)
      if (self%slots(row)%has_value) word = self%slots(row)%words(1)
   end function word_value

   !> True if the user gave the key, also with a value that could not be read.
   pure function is_given(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      logical :: is_given

      is_given = self%slots(find_key(group, key, self%problem))%is_given
   end function is_given

   !> True if the key has a value, given or default.
   pure function has_value(self, group, key)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      logical :: has_value

      has_value = self%slots(find_key(group, key, self%problem))%has_value
   end function has_value

   !> True if the group is in the file.
   pure function has_group(self, group)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group
      logical :: has_group

      has_group = self%group_lines(find_group(group)) > 0
   end function has_group

   !> Line to report for a key: its own, else that of its group, else the last of the file.
   pure function line_of(self, group, key) result(line)
      class(input_values_t), intent(in) :: self
      character(*), intent(in) :: group, key
      integer :: line

      line = 0
      if (len_trim(key) > 0) line = self%slots(find_key(group, key, self%problem))%line
      if (line == 0) line = self%group_lines(find_group(group))
      if (line == 0) line = self%last_line
   end function line_of

end module input_values

!> The key table as text for a terminal (`asperity --keys`), as the page docs/input.md, and as a
!> commented, complete namelist (`--template`): every key with its example, of chapter 5, Case 1 of
!> the thesis (Table 5.1), or of a synthetic, elastic-perfectly plastic surface under three loads.
module input_manual
   use input_keys, only: group_rows, key_rows
   use key_rules, only: rules_text
   use key_row, only: dry, every, has_word, key_t, point, split_words, word_list
   use text, only: wrapped
   implicit none (type, external)
   private

   public :: keys_text, template_text

   character(*), parameter :: nl = new_line('a')
   !> Width of the terminal page.
   integer, parameter :: page_width = 100
   !> Column where the explanations begin.
   integer, parameter :: indent = 4
   !> Column of the units.
   integer, parameter :: unit_column = 44
   !> What stands above the keys of methods.
   character(*), parameter :: for_experts = &
      'Keys of methods; the defaults are right for nearly everyone'
   !> The paragraphs before the tables of the page.
   character(*), parameter :: introduction = 'A case is a Fortran namelist file in SI units. '// &
      '`asperity --template ehl_line` writes a complete one with' // nl &
      // 'comments, `asperity --check CASE.nml` checks one without computing, and every '// &
      'finding names file, line, group and' &
      // nl // 'key, what was found and what is expected. All findings of a file are '// &
      'reported together.' // nl // nl &
      // '- A group is `&name ... /`, an entry `key = value`, a comment begins with `!`. '// &
      'Names and words may be written in' &
      // nl // '  capitals. Words and texts stand in quotes and close on their line.' // nl &
      // '- Several values are separated by commas or blanks; `3*0.1` is three times 0.1; '// &
      '`amplitude(2) = 1e-7` sets one' // nl &
      // '  element, `amplitude(2:4) = ...` three.' // nl &
      // '- A key that is unknown, repeated, or not used by the case is an '// &
      'error: nothing is ignored.' // nl &
      // '- A value outside the typical magnitudes of its key is reported in one line: '// &
      'most often its unit is wrong.' // nl &
      // '- The file is UTF-8 text; LF, CR LF or CR ends a line. Paths in it are relative to '// &
      'the file.' // nl &
      // '- "required" must be given, "chosen" is chosen by the program, "-" has no '// &
      'default: the meaning says when it is' // nl &
      // '  needed.' // nl

contains

   !> Every group and key: type, unit, default, range or words, meaning; for a terminal at most 100
   !> columns, or the page docs/input.md.
   pure function keys_text(is_page) result(text)
      logical, intent(in) :: is_page
      character(:), allocatable :: head, lead, meaning, text
      integer, allocatable :: rows(:)
      integer :: group, i, kind

      text = 'Groups and keys of a namelist. Of each key: type [unit], default, range or '// &
         'words, meaning,' // nl &
         // 'and the problems that use it if not all do. "chosen" = chosen by the program; '// &
            '"-" = no default.' // nl
      if (is_page) text = '# Input: the namelist' // nl // nl &
         // '<!-- Made from the key table by `asperity --keys-markdown > docs/input.md`: ' &
         // 'change src/input/input_keys.f90. -->' // nl // nl // introduction
      do group = 1, size(group_rows)
         head = '&' // trim(group_rows(group)%group)
         meaning = trim(group_rows(group)%meaning)
         if (is_page) then
            meaning(1:1) = achar(iachar(meaning(1:1)) - 32)   ! a capital letter
            text = text // nl // '## ' // head // nl // nl // meaning // '.'
            if (head == '&surface_2') text = text // ' The keys are those of &surface_1.'
            text = text // nl
            lead = nl
         else
            lead = '  '
            text = text // nl // wrapped(head // '  ' // meaning, page_width, 0) // nl
            if (head == '&surface_2') text = text // '  The keys are those of &surface_1.' // nl
         end if
         kinds: do kind = 1, 2
            rows = rows_of(group, kind == 2)
            if (size(rows) == 0) cycle kinds
            if (kind == 2) text = text // lead // for_experts // ':' // nl
            if (is_page) text = text // nl // '| key | type | unit | default | range or '// &
               'words | meaning |' // nl // '|---|---|---|---|---|---|' // nl
            do i = 1, size(rows)
               text = text // row_text(key_rows(rows(i)), is_page)
            end do
         end do kinds
      end do
   end function keys_text

   !> One key, with its rules and the problems that use it if not all do: a row of a table of the
   !> page, or two paragraphs.
   pure function row_text(row, is_page) result(text)
      type(key_t), intent(in) :: row
      logical, intent(in) :: is_page
      character(:), allocatable :: text, allowed, kind, meaning

      kind = trim(row%kind)
      if (kind == 'words') kind = 'word'
      meaning = trim(row%meaning)
      if (row%moes_default /= '') meaning = meaning//'; with &moes default '//trim(row%moes_default)
      meaning = meaning // rules_text(row)
      if (row%problems /= every) meaning = meaning // ' (' // trim(row%problems) // ')'
      allowed = trim(row%allowed)
      if (row%typical /= '') allowed = allowed // ', typical ' // trim(row%typical)
      if (row%unit == '' .and. allowed /= '') allowed = word_list(allowed)
      if (is_page) then
         text = '| `' // trim(row%key) // '` | ' // kind // ' | ' // trim(row%unit) // ' | ' &
            // trim(row%default) // ' | ' // allowed // ' | ' // meaning // ' |' // nl
      else
         text = '  ' // row%key // ' ' // kind
         if (all(row%unit /= ['-', ' '])) text = text // ' [' // trim(row%unit) // ']'
         text = text // ', default ' // trim(row%default)
         if (row%unit /= '') text = text // ', ' // allowed
         text = wrapped(text, page_width, 8) // nl
         if (row%unit == '' .and. allowed /= '') text = text // wrapped(repeat(' ', indent) &
            // allowed, page_width, 8) // nl
         text = text // wrapped(repeat(' ', indent) // meaning, page_width, 8) // nl
      end if
   end function row_text

   !> Rows of the keys of `group`: those of methods if `is_expert`, else the others; none of
   !> &surface_2, which refers to &surface_1.
   pure function rows_of(group, is_expert) result(rows)
      integer, intent(in) :: group
      logical, intent(in) :: is_expert
      integer, allocatable :: rows(:)
      integer :: i

      rows = pack([(i, i=1, size(key_rows))], key_rows%group == group_rows(group)%group &
         .and. (key_rows%is_expert .eqv. is_expert) .and. key_rows%group /= 'surface_2')
   end function rows_of

   !> The template of a `problem`.
   pure function template_text(problem) result(template)
      character(*), intent(in) :: problem
      character(:), allocatable :: template
      integer :: i

      template = '! A lubricated line contact (chapter 5, Case 1)'
      if (problem == point) template = '! A ball on a disc with oil'
      if (has_word(dry, problem)) template = '! A dry rough contact'
      template = template // '; asperity --keys shows the ranges too. Lines with ! in' // nl &
         // '! the first column hold keys that are optional here or replace others. The order '// &
            'of all is free.' // nl
      do i = 1, size(group_rows)
         if (.not. has_word(group_rows(i)%problems, problem)) cycle
         template = template // nl // group_text(problem, i)
      end do
   end function template_text

   !> One group; commented out altogether if no key of it is active, as those of methods are.
   pure function group_text(problem, group) result(text)
      character(*), intent(in) :: problem
      integer, intent(in) :: group
      character(:), allocatable :: text, example, lines, mark
      character(:), allocatable :: examples(:)
      integer, allocatable :: rows(:)
      integer :: i, kind

      lines = ''
      mark = '! '
      do kind = 1, 2
         rows = rows_of(group, kind == 2)
         rows = pack(rows, [(has_word(key_rows(rows(i))%problems, problem), i=1, size(rows))])
         if (kind == 2 .and. size(rows) > 0) lines = lines // '   ! ' // for_experts // ':' // nl
         do i = 1, size(rows)
            associate (row => key_rows(rows(i)))
               examples = split_words(row%example//'|', '|')
               example = trim(examples(merge(size(examples), 1, has_word(dry, problem))))
               if (row%key == 'problem') example = "'"//problem//"'"
               if (example == '') example = trim(row%default)
               if (example == '!') example = '! '//trim(row%default)
               if (row%is_expert .and. example(1:1) /= '!') example = '! '//example
               if (example(1:1) /= '!') mark = ''
               lines = lines // key_text(row, example)
            end associate
         end do
      end do
      if (lines == '') lines = '!  the keys of &surface_1' // nl
      text = '! ' // trim(group_rows(group)%meaning) // nl // mark // '&' &
         // trim(group_rows(group)%group) // nl // lines // mark // '/' // nl
   end function group_text

   !> Of a key, whose `example` begins with '! ' if it is a comment, two lines: the meaning; key,
   !> value, unit, default, words. Of methods the second alone.
   pure function key_text(row, example) result(text)
      type(key_t), intent(in) :: row
      character(*), intent(in) :: example
      character(:), allocatable :: text, line, note
      logical :: has_words

      line = '   ' // trim(row%key) // ' = ' // example
      if (example(1:1) == '!') line = '!  ' // trim(row%key) // ' = ' // example(3:)
      note = ''
      has_words = row%unit == '' .and. index(trim(row%allowed), ' ') > 0
      if (row%unit /= '') note = ' [' // trim(row%unit) // ']'
      if (row%default == 'chosen') then
         note = note // ' default: chosen by the program'
      else if (all(row%default /= ['required', '-       '])) then
         note = note // ' default ' // trim(row%default)
         if (has_words) note = note // ','
      end if
      if (has_words) note = note // merge(' any of ', ' one of ', row%kind == 'words') &
         // word_list(row%allowed)
      if (note /= '') line = line // repeat(' ', max(0, unit_column - len(line))) // ' !' // note
      text = line // nl
      if (.not. row%is_expert) text = '   ! ' // trim(row%meaning) // rules_text(row) // nl // text
   end function key_text

end module input_manual

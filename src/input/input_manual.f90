!> The key table as text for a terminal (`asperity --keys`) and as the page docs/input.md.
module input_manual
   use input_keys, only: group_rows, key_rows
   use key_condition, only: rules_text
   use key_row, only: every, key_row_t, kind_names, word_list
   use quantity_text, only: wrapped
   implicit none (type, external)
   private

   public :: keys_text, keys_markdown

   character(*), parameter :: nl = new_line('a')
   !> Width of the terminal page.
   integer, parameter :: page_width = 100
   !> Column where the explanations begin.
   integer, parameter :: indent = 4
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
      // '- A key that is unknown, repeated, not used by the case or not built yet is an '// &
      'error: nothing is ignored.' // nl &
      // '- A value outside the typical magnitudes of its key is told, in one line: most '// &
      'often its unit is another one.' // nl &
      // '- The file is UTF-8 text; LF, CR LF or CR ends a line. Paths in it are relative to '// &
      'the file.' // nl &
      // '- "required" must be given, "chosen" is chosen by the program, "-" has no '// &
      'default: the meaning says when it is' // nl &
      // '  needed.' // nl

contains

   !> Every group and key: type, unit, default, range or words, meaning; at most 100 columns.
   pure function keys_text() result(text)
      character(:), allocatable :: text
      integer :: group, i

      text = 'Groups and keys of a namelist. Of each key: type [unit], default, range or '// &
         'words, meaning,' // nl &
         // 'and the problems that use it if not all do. "chosen" = chosen by the program; '// &
            '"-" = no default.' // nl
      do group = 1, size(group_rows)
         text = text // nl
         text = text // wrapped('&' // trim(group_rows(group)%group) // '  ' &
            // trim(group_rows(group)%meaning), page_width, 0) // nl
         do i = 1, size(key_rows)
            if (key_rows(i)%group == group_rows(group)%group) text = &
               text // terminal_entry(key_rows(i))
         end do
      end do
   end function keys_text

   !> The lines of one key.
   pure function terminal_entry(row) result(text)
      type(key_row_t), intent(in) :: row
      character(:), allocatable :: text
      character(:), allocatable :: head

      head = '  ' // row%key // ' ' // trim(kind_names(row%kind))
      if (row%unit /= '' .and. row%unit /= '-') head = head // ' [' // trim(row%unit) // ']'
      head = head // ', default ' // trim(row%default)
      if (row%range /= '') head = head // ', ' // trim(row%range)
      head = head // typical_text(row)
      text = wrapped(head, page_width, 8) // nl
      if (row%words /= '') text = text // wrapped(repeat(' ', indent) // words_text(row), &
         page_width, 8) // nl
      text = text // wrapped(repeat(' ', indent) // trim(row%meaning) // conditions_text(row), &
         page_width, 8) // nl
   end function terminal_entry

   !> What is typical of a key, ", typical 1e-4 to 5"; empty: nothing in particular.
   pure function typical_text(row) result(text)
      type(key_row_t), intent(in) :: row
      character(:), allocatable :: text

      text = ''
      if (row%typical /= '') text = ', typical ' // trim(row%typical)
   end function typical_text

   !> The rules of a key, and the problems that use it if not all of them do.
   pure function conditions_text(row) result(text)
      type(key_row_t), intent(in) :: row
      character(:), allocatable :: text

      text = ''
      if (row%meaning(:5) /= 'as in') text = rules_text(row)
      if (row%moes_default /= '') text = '; with &moes default '//trim(row%moes_default)//text
      if (row%problems /= every) text = text // ' (' // trim(row%problems) // ')'
   end function conditions_text

   !> Words of a key, and those not built yet.
   pure function words_text(row) result(text)
      type(key_row_t), intent(in) :: row
      character(:), allocatable :: text

      text = word_list(row%words)
      if (row%later_words /= '') text = text // '; not built yet: ' // word_list(row%later_words)
   end function words_text

   !> The page docs/input.md.
   pure function keys_markdown() result(text)
      character(:), allocatable :: text
      integer :: group, i

      text = '# Input: the namelist' // nl // nl &
         // '<!-- Made from the key table by `asperity --keys-markdown > docs/input.md`: ' &
         // 'change src/input/input_keys.f90. -->' // nl &
         // nl // introduction
      do group = 1, size(group_rows)
         text = text // nl // '## &' // trim(group_rows(group)%group) // nl // nl &
            // capital(trim(group_rows(group)%meaning)) &
            // '.' // nl // nl // '| key | type | unit | default | range or words | meaning |' &
               // nl &
            // '|---|---|---|---|---|---|' // nl
         do i = 1, size(key_rows)
            if (key_rows(i)%group == group_rows(group)%group) text = &
               text // markdown_entry(key_rows(i))
         end do
      end do
   end function keys_markdown

   !> One row of a table.
   pure function markdown_entry(row) result(text)
      type(key_row_t), intent(in) :: row
      character(:), allocatable :: text
      character(:), allocatable :: range

      range = trim(row%range) // typical_text(row)
      if (row%words /= '') range = words_text(row)
      text = '| `' // trim(row%key) // '` | ' // trim(kind_names(row%kind)) // ' | ' &
         // trim(row%unit) &
         // ' | ' // trim(row%default) // ' | ' &
         // range // ' | ' // trim(row%meaning) // conditions_text(row) // ' |' // nl
   end function markdown_entry

   !> `string` with a capital first letter.
   pure function capital(string) result(text)
      character(*), intent(in) :: string
      character(:), allocatable :: text

      text = string
      if (text(1:1) >= 'a' .and. text(1:1) <= 'z') text(1:1) = achar(iachar(text(1:1)) - 32)
   end function capital

end module input_manual

!> The commented, complete namelist of `asperity --template`: every key of the table with its
!> example: chapter 5, Case 1 of the thesis (Table 5.1), or a synthetic rough surface,
!> elastic-perfectly plastic, against a rigid plane under three loads.
module input_template
   use input_keys, only: group_rows, key_rows
   use key_condition, only: rules_text
   use key_row, only: has_word, is_chosen, is_optional, is_required, key_row_t, &
      lubricated, word_list, words_kind
   implicit none (type, external)
   private

   public :: template_text

   character(*), parameter :: nl = new_line('a')
   !> Column of the units.
   integer, parameter :: unit_column = 44

contains

   !> The template of a `problem`.
   pure function template_text(problem) result(template)
      character(*), intent(in) :: problem
      character(:), allocatable :: template
      integer :: i

      template = '! A lubricated line contact (chapter 5, Case 1)'
      if (problem /= lubricated) template = '! A dry rough contact'
      template = template // '; asperity --keys shows the ranges too. Lines with ! in' // nl &
         // '! the first column hold keys that are optional here or replace others. The order '// &
            'of all is free.' // nl
      do i = 1, size(group_rows)
         if (.not. has_word(group_rows(i)%problems, problem)) cycle
         template = template // nl // group_text(problem, trim(group_rows(i)%group), &
            trim(group_rows(i)%meaning))
      end do
   end function template_text

   !> One group; commented out altogether if no key of it is active.
   pure function group_text(problem, group, meaning) result(text)
      character(*), intent(in) :: problem, group, meaning
      character(:), allocatable :: text
      character(:), allocatable :: example, lines, mark
      integer :: i

      lines = ''
      mark = '! '
      do i = 1, size(key_rows)
         if (key_rows(i)%group /= group .or. .not. has_word(key_rows(i)%problems, problem)) cycle
         example = example_of(key_rows(i), problem)
         if (example(1:1) /= '!') mark = ''
         lines = lines // key_text(key_rows(i), example)
      end do
      text = '! ' // meaning // nl // mark // '&' // group // nl // lines // mark // '/' // nl
   end function group_text

   !> The value of a key, behind '! ' if it is a comment; of a dry &surface_2 all are.
   pure function example_of(row, problem) result(example)
      type(key_row_t), intent(in) :: row
      character(*), intent(in) :: problem
      character(:), allocatable :: example

      example = trim(row%example)
      if (problem /= lubricated .and. row%dry_example /= '') example = trim(row%dry_example)
      if (row%key == 'problem') example = "'"//problem//"'"
      if (example == '') example = trim(row%default)
      if (example == '!') example = '! '//trim(row%default)
      if (problem == lubricated .or. row%group /= 'surface_2') return
      if (example(1:1) /= '!') example = '! '//example
   end function example_of

   !> Two lines: the meaning; key, value, unit, default, words.
   pure function key_text(row, example) result(text)
      type(key_row_t), intent(in) :: row
      character(*), intent(in) :: example
      character(:), allocatable :: text
      character(:), allocatable :: line, note

      line = '   ' // trim(row%key) // ' = ' // example
      if (example(1:1) == '!') line = '!  ' // trim(row%key) // ' = ' // example(3:)
      note = ''
      if (row%unit /= '') note = ' [' // trim(row%unit) // ']'
      if (row%default == is_chosen) then
         note = note // ' default: chosen by the program'
      else if (row%default /= is_required .and. row%default /= is_optional) then
         note = note // ' default ' // trim(row%default)
         if (index(trim(row%words), ' ') > 0) note = note // ','
      end if
      if (index(trim(row%words), ' ') > 0) note = note // merge(' any of ', ' one of ', row%kind &
         == words_kind) // word_list(row%words)
      if (note /= '') line = line // repeat(' ', max(0, unit_column - len(line))) // ' !' // note
      text = '   ! ' // trim(row%meaning) // rules_text(row) // nl // line // nl
   end function key_text

end module input_template

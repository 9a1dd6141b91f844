!> Entries of the command line, `--set group.key=value`, put into the text of a namelist: the text
!> is then that of a file which gives the same case.
module set_entries
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use input_keys, only: find_key, key_rows
   use namelist_text, only: entry_t, namelist_text_t, split_namelist, without_returns
   use text, only: to_lower
   implicit none (type, external)
   private

   public :: new_set_entry, put_entries, mark_entries

contains

   !> The entry that `word`, "group.key=value", means; words and texts get the quotes that a shell
   !> takes away. Error (input_error): another form, or a value that would end its entry.
   subroutine new_set_entry(entry, word, error)
      type(entry_t), intent(out) :: entry
      character(*), intent(in) :: word
      type(error_t), allocatable, intent(out) :: error
      type(namelist_text_t) :: pieces
      type(findings_t) :: findings
      integer :: point, sign
      logical :: is_good

      sign = index(word, '=')
      point = index(word(:max(sign - 1, 0)), '.')
      if (point < 2 .or. sign < point + 2 .or. sign == len(word)) then
         call fail(error, input_error, 'found --set '//word//', expected --set GROUP.KEY=VALUE')
         return
      end if
      entry%group = to_lower(trim(adjustl(word(:point - 1))))
      entry%key = to_lower(trim(adjustl(word(point + 1:sign - 1))))
      entry%values = with_quotes(entry, trim(adjustl(word(sign + 1:))))
      ! a value with nothing that would end it is found again as the one entry of a group
      call split_namelist('&group key = '//entry%values//' /', pieces, findings)
      is_good = findings%count == 0 .and. pieces%count == 2
      if (is_good) is_good = pieces%entries(2)%values == entry%values
      if (.not. is_good) call fail(error, input_error, 'found --set '//word//', expected '// &
         'numbers, words or a text: one line, closed quotes, outside them none of ! / & =')
   end subroutine new_set_entry

   !> `value` with the quotes that its key needs.
   pure function with_quotes(entry, value) result(quoted)
      type(entry_t), intent(in) :: entry
      character(*), intent(in) :: value
      character(:), allocatable :: quoted
      character(len=len(key_rows%kind)) :: kind
      integer :: i

      quoted = value
      if (scan(value(1:1), '''"') > 0) return
      i = find_key(entry%group, entry%key, '')
      if (i == 0) return
      kind = key_rows(i)%kind
      if (all(kind /= [character(len=5) :: 'text', 'word', 'words'])) return
      quoted = "'"
      do i = 1, len(value)
         if (value(i:i) == ',' .and. kind == 'words') then
            quoted = quoted//"', '"
         else if (value(i:i) /= ' ' .or. kind /= 'words') then
            quoted = quoted//value(i:i)
            if (value(i:i) == "'") quoted = quoted//"'"
         end if
      end do
      quoted = quoted//"'"
   end function with_quotes

   !> `content` with `entries` (n): in the place of the same key, else behind the name of their
   !> group, else in a group at the end. No line gets another number; lines end with LF.
   subroutine put_entries(content, entries)
      character(:), allocatable, intent(inout) :: content
      type(entry_t), intent(in) :: entries(:)
      type(namelist_text_t) :: pieces
      type(findings_t) :: unheard
      character(:), allocatable :: words
      integer :: i, j, k, place

      if (size(entries) > 0) content = without_returns(content)
      do j = 1, size(entries)
         call split_namelist(content, pieces, unheard)
         place = 0
         of_text: do i = pieces%count, 1, -1   ! the head of the group comes last
            associate (old => pieces%entries(i))
               if (old%group /= entries(j)%group) cycle of_text
               if (old%key == '' .and. place == 0) place = old%span(2) + 1
               if (old%key /= entries(j)%key) cycle of_text
               place = old%span(1)
               do k = old%span(1), old%span(2)   ! comments are blanks there, and stay
                  if (pieces%text(k:k) /= ' ') content(k:k) = ' '
               end do
            end associate
         end do of_text
         words = ' '//entries(j)%key//' = '//entries(j)%values//' '
         if (place > 0) then
            content = content(:place - 1)//words//content(place:)
         else
            content = content//new_line('a')//'&'//entries(j)%group//words//'/'//new_line('a')
         end if
      end do
   end subroutine put_entries

   !> Marks by lines below 0, which findings tell as --set, the `entries` (n) in `pieces`, and the
   !> heads of groups without others.
   pure subroutine mark_entries(entries, pieces)
      type(entry_t), intent(in) :: entries(:)
      type(namelist_text_t), intent(inout) :: pieces
      integer :: i, j
      logical :: is_alone, is_set

      is_alone = .true.
      do i = pieces%count, 1, -1   ! the head of a group comes last
         associate (entry => pieces%entries(i))
            is_set = .false.
            do j = 1, size(entries)
               if (entries(j)%group == entry%group) is_set = is_set .or. entry%key == '' &
                  .or. entries(j)%key == entry%key
            end do
            is_alone = is_alone .and. is_set
            if (merge(is_alone, is_set, entry%key == '')) entry%line = -entry%line
            if (entry%key == '') is_alone = .true.
         end associate
      end do
   end subroutine mark_entries

end module set_entries

!> Entries of the command line, `--set group.key=value`, put into the text of a namelist: the text
!> is then that of a file which gives the same case.
module set_entries
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use input_keys, only: key_rows
   use namelist_source, only: source_t, new_source, without_returns
   use namelist_text, only: entry_t, namelist_text_t, split_namelist
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
      i = findloc(key_rows%group == entry%group .and. key_rows%key == entry%key, .true., &
         dim=1, back=.true.)
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
      type(source_t) :: source
      type(findings_t) :: unheard
      character(:), allocatable :: words
      integer :: i, j, k, place

      if (size(entries) > 0) content = without_returns(content)
      do j = 1, size(entries)
         call split_namelist(content, pieces, unheard)
         call new_source(source, content, unheard)
         place = 0
         of_text: do i = pieces%count, 1, -1
            associate (old => pieces%entries(i))
               if (old%group /= entries(j)%group .or. old%key /= entries(j)%key) cycle of_text
               place = old%span(1)
               do k = old%span(1), old%span(2)   ! comments are blanks in the source, and stay
                  if (source%text(k:k) /= ' ') content(k:k) = ' '
               end do
            end associate
         end do of_text
         do i = 1, merge(pieces%count, 0, place == 0)
            associate (head => pieces%entries(i))
               if (head%group == entries(j)%group .and. head%key == '') place = head%span(2) + 1
            end associate
         end do
         words = ' '//entries(j)%key//' = '//entries(j)%values//' '
         if (place > 0) then
            content = content(:place - 1)//words//content(place:)
         else
            content = content//new_line('a')//'&'//entries(j)%group//words//'/'//new_line('a')
         end if
      end do
   end subroutine put_entries

   !> Lets findings name --set: those about `entries` (n) and about groups without others.
   subroutine mark_entries(entries, pieces, findings)
      type(entry_t), intent(in) :: entries(:)
      type(namelist_text_t), intent(in) :: pieces
      type(findings_t), intent(inout) :: findings
      integer :: i, j, k
      logical :: is_alone

      do i = 1, size(entries)
         call findings%set_apart(entries(i)%group, entries(i)%key)
         is_alone = .true.
         do k = 1, pieces%count
            associate (entry => pieces%entries(k))
               if (entry%group == entries(i)%group .and. entry%key /= '') is_alone = is_alone &
                  .and. any([(entries(j)%key == entry%key, j=1, size(entries))])
            end associate
         end do
         if (is_alone) call findings%set_apart(entries(i)%group, '')
      end do
   end subroutine mark_entries

end module set_entries

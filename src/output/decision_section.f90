!> /adequacy/decision of a result: what model = 'auto' left out, and the table that shows it.
module decision_section
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use adequacy, only: adequacy_t, compared, influence_t, new_influence
   use hdf5_dataset, only: write_attribute
   use hdf5_file, only: hdf5_file_t
   use adequacy_section, only: write_changes
   use kinds, only: wp
   use model_decision, only: model_choice_t, reasons
   use quantities, only: quantity_count, quantity_rows
   use quantity_text, only: number_text
   implicit none (type, external)
   private

   public :: decision_lines, solved_text, write_decision

   !> Columns of the table: name, influence, decision.
   integer, parameter :: tabs(3) = [13, 29, 57], width = 80
   !> Behind changes by a part of an ingredient.
   character(*), parameter :: part_mark = '*'

contains

   !> Writes a group for each ingredient, with the changes that were measured before the run, and
   !> one for each number that was chosen; nothing if nothing was to be decided.
   subroutine write_decision(file, choice)
      class(hdf5_file_t), intent(inout) :: file
      type(model_choice_t), intent(in) :: choice
      character(len=*), parameter :: root = '/adequacy/decision'
      character(:), allocatable :: group
      logical :: is_compared(quantity_count)
      integer :: i, k

      if (.not. allocated(choice%rows)) return
      call file%create_group(root)
      call write_attribute(file, root, 'about', "what model = 'auto' decided of each "// &
         'ingredient before the run, and the changes by which it did; grid, domain, time step '// &
         'and method of the run')
      call write_attribute(file, root, 'solved', solved_text(choice))
      if (all(choice%grids > 0)) call write_attribute(file, root, 'intervals', choice%grids(1))
      is_compared = [(compared(k), k=1, quantity_count)]
      do i = 1, size(choice%rows)
         group = root//'/'//trim(choice%rows(i)%name)
         call file%create_group(group)
         call write_attribute(file, group, 'decision', decision_text(choice%is_left_out(i)))
         call write_attribute(file, group, 'reason', trim(reasons(choice%why(i))%text))
         call write_attribute(file, group, 'instead', trim(choice%rows(i)%text))
         associate (row => choice%rows(i))
            call write_changes(file, group, trim(row%text), pack(quantity_rows%name, &
               is_compared), pack(row%change, is_compared), pack(row%error, is_compared))
         end associate
      end do
      if (.not. allocated(choice%numbers)) return
      do i = 1, size(choice%numbers)
         associate (number => choice%numbers(i))
            group = root//'/'//trim(number%name)
            call file%create_group(group)
            call write_attribute(file, group, 'decision', trim(number%decision))
            call write_attribute(file, group, 'value', trim(number%text))
         end associate
      end do
   end subroutine write_decision

   !> What was solved.
   pure function solved_text(choice) result(text)
      type(model_choice_t), intent(in) :: choice
      character(:), allocatable :: text

      text = 'the case with every ingredient'
      if (choice%is_smooth) then
         text = 'the steady contact with smooth surfaces, in place of the passage'
      else if (choice%is_steady) then
         text = 'the steady contact with its roughness, in place of the passage'
      end if
   end function solved_text

   !> A decision in words.
   pure function decision_text(is_left_out) result(text)
      logical, intent(in) :: is_left_out
      character(:), allocatable :: text

      text = trim(merge('left out', 'kept    ', is_left_out))
   end function decision_text

   !> The table, of at most `width` columns: each ingredient with the quantity that it changes most,
   !> measured before the run or else after it (`adequacy`), then the chosen numbers with the
   !> largest error due to them. Empty: nothing was to be decided.
   pure function decision_lines(choice, adequacy) result(lines)
      type(model_choice_t), intent(in) :: choice
      type(adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: lines, words
      integer :: i

      lines = ''
      if (.not. allocated(choice%rows)) return
      lines = '  auto'
      do i = 1, size(choice%rows)
         if (i > 1) lines = lines//new_line('a')
         call place(lines, trim(choice%rows(i)%name), tabs(1))
         call place(lines, influence_text(choice%rows(i), adequacy), tabs(2))
         words = decision_text(choice%is_left_out(i))
         if (reasons(choice%why(i))%short /= '') words = words//': ' &
            //trim(reasons(choice%why(i))%short)
         call place(lines, words, tabs(3))
      end do
      if (allocated(choice%numbers)) then
         do i = 1, size(choice%numbers)
            associate (number => choice%numbers(i))
               lines = lines//new_line('a')
               call place(lines, trim(number%name), tabs(1))
               call place(lines, influence_text(new_influence(trim(number%judged_as), ''), &
                  adequacy), tabs(2))
               call place(lines, trim(number%decision)//': '//trim(number%text), tabs(3))
            end associate
         end do
      end if
      if (index(lines, part_mark) == 0) return
      lines = lines//new_line('a')
      call place(lines, part_mark//' a quarter of it left out: without all of it no solution '// &
         'is found', tabs(1))
   end function decision_lines

   !> Puts `words` into the last of `lines`, from column `tab` on or behind it; else on a new line.
   pure subroutine place(lines, words, tab)
      character(:), allocatable, intent(inout) :: lines
      character(*), intent(in) :: words
      integer, intent(in) :: tab
      integer :: used, start

      used = len(lines) - index(lines, new_line('a'), back=.true.)
      start = max(tab, merge(used + 2, 1, used > 0))
      if (start + len(words) - 1 > width) then
         lines = lines//new_line('a')
         used = 0
         start = max(min(tab, width - len(words) + 1), tabs(1))
      end if
      lines = lines//repeat(' ', start - 1 - used)//words
   end subroutine place

   !> The largest change of a row, or of that of the same name in `adequacy` where nothing is known
   !> of it: 0.02 +- 0.01 % h_min, of a numerical choice 0.02 % h_min; a dash where none is known, a
   !> mark where it is that by a part of the ingredient.
   pure function influence_text(decided, adequacy) result(text)
      type(influence_t), intent(in) :: decided
      type(adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: text
      type(influence_t) :: row
      logical :: is_known(quantity_count)
      integer :: i

      row = decided
      if (.not. any(ieee_is_finite(row%change)) .and. allocated(adequacy%rows)) then
         i = findloc(adequacy%rows%name == row%name, .true., 1)
         if (i > 0) row = adequacy%rows(i)
      end if
      text = '-'
      is_known = ieee_is_finite(row%change) .and. [(compared(i), i=1, quantity_count)]
      i = maxloc(abs(row%change), 1, is_known .and. ieee_is_finite(row%error))
      if (i > 0) then
         text = '<0.001'
         if (100*abs(row%change(i)) >= 0.001_wp) text = number_text(100*row%change(i), 2)
         if (.not. row%is_numerical) text = text//' +- '//number_text(100*row%error(i), 2)
         text = text//' % '//trim(quantity_rows(i)%short)
      end if
      if (row%left_out < 1.0_wp .and. any(is_known)) text = text//' '//part_mark
   end function influence_text

end module decision_section

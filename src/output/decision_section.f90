!> /adequacy/decision of a result: what model = 'auto' left out, and the table that shows it.
module decision_section
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use adequacy, only: adequacy_t, compared, influence_t
   use hdf5_attribute, only: write_attribute
   use hdf5_file, only: hdf5_file_t
   use influence_section, only: write_changes
   use kinds, only: wp
   use model_decision, only: model_choice_t, reasons
   use quantities, only: quantity_count, quantity_rows
   use quantity_text, only: number_text
   implicit none (type, external)
   private

   public :: decision_lines, solved_text, write_decision

   !> Columns of the table: name, influence, decision.
   integer, parameter :: tabs(3) = [13, 29, 57], width = 80

contains

   !> Writes a group for each ingredient, with the changes that were measured before the run;
   !> nothing if nothing was to be decided.
   subroutine write_decision(file, choice)
      class(hdf5_file_t), intent(inout) :: file
      type(model_choice_t), intent(in) :: choice
      character(len=*), parameter :: root = '/adequacy/decision'
      character(:), allocatable :: group
      logical :: is_told(quantity_count)
      integer :: i, k

      if (.not. allocated(choice%rows)) return
      call file%create_group(root)
      call write_attribute(file, root, 'about', "what model = 'auto' decided of each "// &
         'ingredient before the run, and the changes by which it did')
      call write_attribute(file, root, 'solved', solved_text(choice))
      if (all(choice%grids > 0)) call write_attribute(file, root, 'intervals', choice%grids(1))
      do i = 1, size(choice%rows)
         group = root//'/'//trim(choice%rows(i)%name)
         call file%create_group(group)
         call write_attribute(file, group, 'decision', decision_text(choice%is_left_out(i)))
         call write_attribute(file, group, 'reason', trim(reasons(choice%why(i))%text))
         call write_attribute(file, group, 'instead', trim(choice%rows(i)%text))
         associate (row => choice%rows(i))
            is_told = ieee_is_finite(row%change) .and. ieee_is_finite(row%error) &
               .and. [(compared(k), k=1, quantity_count)]
            call write_changes(file, group, trim(row%text), pack(quantity_rows%name, is_told), &
               pack(row%change, is_told), pack(row%error, is_told))
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

   !> The table: an ingredient a line with the quantity that it changes most, by what was measured
   !> before the run or else after it (`adequacy`); empty: nothing was to be decided.
   pure function decision_lines(choice, adequacy) result(lines)
      type(model_choice_t), intent(in) :: choice
      type(adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: lines
      character(len=width) :: line
      integer :: i

      lines = ''
      if (.not. allocated(choice%rows)) return
      do i = 1, size(choice%rows)
         line = ''
         if (i == 1) line = '  auto'
         line(tabs(1):) = choice%rows(i)%name
         line(tabs(2):) = influence_text(known_row(choice%rows(i), adequacy))
         line(tabs(3):) = decision_text(choice%is_left_out(i))
         associate (why => reasons(choice%why(i))%short)
            if (why /= '') line(tabs(3):) = trim(line(tabs(3):))//': '//why
         end associate
         if (i > 1) lines = lines//new_line('a')
         lines = lines//trim(line)
      end do
   end function decision_lines

   !> The row, or that of the same name in `adequacy` where nothing is known of it.
   pure function known_row(row, adequacy) result(known)
      type(influence_t), intent(in) :: row
      type(adequacy_t), intent(in) :: adequacy
      type(influence_t) :: known
      integer :: i

      known = row
      if (any(ieee_is_finite(row%change)) .or. .not. allocated(adequacy%rows)) return
      do i = 1, size(adequacy%rows)
         if (adequacy%rows(i)%name == row%name) known = adequacy%rows(i)
      end do
   end function known_row

   !> The largest change of a row: 0.02 +- 0.01 % h_min; a dash where none is known.
   pure function influence_text(row) result(text)
      type(influence_t), intent(in) :: row
      character(:), allocatable :: text
      character(:), allocatable :: change
      real(wp) :: largest
      integer :: i

      text = '-'
      largest = -1.0_wp
      do i = 1, quantity_count
         if (.not. (compared(i) .and. ieee_is_finite(row%change(i)) &
            .and. ieee_is_finite(row%error(i)))) cycle
         if (abs(row%change(i)) <= largest) cycle
         largest = abs(row%change(i))
         change = '<0.001'
         if (100*largest >= 0.001_wp) change = number_text(100*row%change(i), 2)
         text = change//' +- '//number_text(100*row%error(i), 2)//' % ' &
            //trim(quantity_rows(i)%short)
      end do
   end function influence_text

end module decision_section

!> /adequacy of a result, lubricated or dry: what each ingredient of the model and each numerical
!> choice changes; /adequacy/decision: what model = 'auto' left out; both as lines of the closing
!> table; /adequacy/validity: the limits of the model.
module adequacy_section
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use ablations, only: ingredient_t
   use adequacy, only: adequacy_t, compared, influence_t, model_choice_t, new_influence, &
      reasons, solved_texts, verdict_irrelevant, verdict_needed, verdict_small, &
      verdict_text, verdict_unknown, why_unknown
   use hdf5_dataset, only: new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use quantities, only: quantity_count, quantity_rows
   use text, only: joined, number_text
   use validity, only: limit_count, limit_rows, limit_t, shear_heating
   implicit none (type, external)
   private

   public :: decision_lines, model_line, write_adequacy, write_decision, write_row, &
      write_validity

   !> Whence the film that is lost to heat.
   character(*), parameter :: film_loss_source = 'central film of the smooth contact with the '// &
      'viscosity at that temperature: Nijenbanning, Venner and Moes, Wear 176, 1994, 217'

   !> Columns of the table: name, influence, decision.
   integer, parameter :: tabs(3) = [13, 29, 57], width = 80
   !> Behind changes by a part of an ingredient.
   character(*), parameter :: part_mark = '*'

contains

   !> A group for each row of a lubricated contact, with the quantities of the closing table;
   !> nothing if nothing was measured.
   subroutine write_adequacy(file, adequacy)
      class(hdf5_file_t), intent(inout) :: file
      type(adequacy_t), intent(in) :: adequacy
      integer :: i, k

      if (.not. allocated(adequacy%rows)) return
      do i = 1, size(adequacy%rows)
         associate (row => adequacy%rows(i), group => '/adequacy/'//trim(adequacy%rows(i)%name))
            call write_row(file, row, quantity_rows%name, pack([(k, k=1, quantity_count)], &
               compared))
            call write_attribute(file, group, 'left_out', row%left_out)
            do k = 1, quantity_count
               if (compared(k) .and. row%least(k) > 0.0_wp) call write_attribute(file, group, &
                  trim(quantity_rows(k)%name)//'_at_least', row%least(k))
            end do
         end associate
      end do
      call write_attribute(file, '/adequacy', 'about', 'relative change of each quantity where '// &
         'an ingredient of the model is left out, measured on coarse grids; of grid, '// &
         'time_step, domain and iteration the error estimate; attribute error_estimate: '// &
         'error of the change; no data set: not known, see attribute not_known; attribute '// &
         '..._at_least: but at least so much')
      call write_attribute(file, '/adequacy', 'accuracy', adequacy%accuracy)
      if (all(adequacy%at_rest > 0)) call write_attribute(file, '/adequacy', &
         'intervals_at_rest', adequacy%at_rest(1))
      if (all(adequacy%in_time > 0)) call write_attribute(file, '/adequacy', 'intervals_in_time', &
         adequacy%in_time(1))
   end subroutine write_adequacy

   !> The group of a `row`: the verdict, the changes of the quantities `rows` of a table with these
   !> `names`, where they come from, and why others are not known.
   subroutine write_row(file, row, names, rows)
      class(hdf5_file_t), intent(inout) :: file
      type(influence_t), intent(in) :: row
      character(*), intent(in) :: names(:)
      integer, intent(in) :: rows(:)
      character(:), allocatable :: group, why

      group = '/adequacy/'//trim(row%name)
      call file%create_group(group)
      call write_attribute(file, group, 'verdict', verdict_text(row%verdict, row%is_numerical))
      call write_attribute(file, group, 'instead', trim(row%text))
      call write_attribute(file, group, 'measured_on', trim(row%measured_on))
      why = why_unknown(row, names(rows), ieee_is_finite(row%change(rows)) .and. &
         ieee_is_finite(row%error(rows)))
      if (why /= '') call write_attribute(file, group, 'not_known', why)
      call write_changes(file, group, row, names, rows)
   end subroutine write_row

   !> The known relative changes of a `row` into its group, each with its error.
   subroutine write_changes(file, group, row, names, rows)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: group, names(:)
      type(influence_t), intent(in) :: row
      integer, intent(in) :: rows(:)
      character(:), allocatable :: path
      integer :: i, k

      do k = 1, size(rows)
         i = rows(k)
         if (.not. (ieee_is_finite(row%change(i)) .and. ieee_is_finite(row%error(i)))) cycle
         path = group//'/'//trim(names(i))
         call write_dataset(file, path, row%change(i), new_label('relative change of ' &
            //trim(names(i))//' with: '//trim(row%text), '1'))
         call write_attribute(file, path, 'error_estimate', row%error(i))
      end do
   end subroutine write_changes

   !> One dataset for each limit that could be evaluated; the others are named with the reason.
   subroutine write_validity(file, limits)
      class(hdf5_file_t), intent(inout) :: file
      type(limit_t), intent(in) :: limits(limit_count)
      character(:), allocatable :: missing, path
      integer :: i

      call file%create_group('/adequacy/validity')
      call write_attribute(file, '/adequacy/validity', 'about', 'limits of the model; '// &
         'exceeded = 1: the contact lies beyond threshold, whatever its error bars say')
      missing = ''
      do i = 1, limit_count
         associate (row => limit_rows(i), limit => limits(i))
            if (.not. ieee_is_finite(limit%value)) then
               if (allocated(limit%missing)) missing = missing//trim(row%name)//': ' &
                  //limit%missing//'; '
               cycle
            end if
            path = '/adequacy/validity/'//trim(row%name)
            call write_dataset(file, path, limit%value, new_label(trim(row%meaning), &
               trim(row%units)))
            call write_attribute(file, path, 'threshold', limit%threshold)
            call write_attribute(file, path, 'beyond', trim(merge('below', 'above', row%is_least)))
            call write_attribute(file, path, 'source', trim(row%source))
            call write_attribute(file, path, 'exceeded', merge(1, 0, limit%is_passed))
            if (i /= shear_heating) cycle
            call write_attribute(file, path, 'viscosity_loss', limit%viscosity_loss)
            call write_attribute(file, path, 'film_loss', limit%film_loss)
            call write_attribute(file, path, 'film_loss_source', film_loss_source)
         end associate
      end do
      if (missing /= '') call write_attribute(file, '/adequacy/validity', 'not_evaluated', &
         missing(:len(missing) - 2))
   end subroutine write_validity

   !> What the closing table says of the ingredients: by their verdicts, or, not `is_whole`, what
   !> simpler models would do at that accuracy, and which may; empty: nothing.
   pure function model_line(adequacy, is_whole) result(line)
      type(adequacy_t), intent(in) :: adequacy
      logical, intent(in) :: is_whole
      character(:), allocatable :: line, percent
      integer, parameter :: verdicts(4) = [verdict_needed, verdict_small, verdict_irrelevant, &
         verdict_unknown]
      character(len=16), parameter :: words(4) = [character(len=16) :: '', 'less than that:', &
         'irrelevant:', 'not known:']
      type(influence_t), allocatable :: rows(:)
      integer :: i

      line = ''
      if (.not. allocated(adequacy%rows)) return
      rows = pack(adequacy%rows, .not. adequacy%rows%is_numerical)
      if (size(rows) == 0) return
      percent = number_text(100*adequacy%accuracy, 2)//' %'
      if (is_whole) then
         do i = 1, size(verdicts)
            if (.not. any(rows%verdict == verdicts(i))) cycle
            if (line /= '') line = line//'; '
            if (i == 1) line = 'needed at '//percent//':'
            line = line//trim(words(i))//' '//joined(pack(rows%name, rows%verdict &
               == verdicts(i)), ', ')
         end do
         line = 'model     '//line
         return
      end if
      line = 'model     at '//percent//' nothing simpler will do'
      associate (is_enough => rows%verdict == verdict_small .or. rows%verdict &
         == verdict_irrelevant, is_open => rows%verdict == verdict_unknown)
         if (any(is_enough)) line = 'model     at '//percent//' each of these alone will do: '// &
            joined(pack(rows%text, is_enough), ', ')
         if (any(is_open)) line = line//'; perhaps '//joined(pack(rows%text, is_open), ', ')
      end associate
   end function model_line

   !> Writes a group for each ingredient, with the changes that were measured before the run, and
   !> one for each number that was chosen; nothing if nothing was to be decided.
   subroutine write_decision(file, choice)
      class(hdf5_file_t), intent(inout) :: file
      type(model_choice_t), intent(in) :: choice
      character(len=*), parameter :: root = '/adequacy/decision'
      character(:), allocatable :: group
      integer :: i, k

      if (.not. allocated(choice%rows)) return
      call file%create_group(root)
      call write_attribute(file, root, 'about', "what model = 'auto' decided of each "// &
         'ingredient before the run, and the changes by which it did; grid, domain, time step '// &
         'and method of the run')
      call write_attribute(file, root, 'solved', trim(solved_texts(choice%solved)))
      if (all(choice%grids > 0)) call write_attribute(file, root, 'intervals', choice%grids(1))
      do i = 1, size(choice%rows)
         associate (row => choice%rows(i), reason => reasons(choice%rows(i)%why))
            group = root//'/'//trim(row%name)
            call file%create_group(group)
            call write_attribute(file, group, 'decision', trim(reason%decision))
            call write_attribute(file, group, 'reason', trim(reason%text))
            call write_attribute(file, group, 'instead', trim(row%text))
            call write_changes(file, group, row, quantity_rows%name, pack([(k, k=1, &
               quantity_count)], compared))
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

   !> What was solved; with `is_whole` a table, of at most `width` columns: each ingredient with the
   !> quantity that it changes most, measured before the run or else after it (`adequacy`), then the
   !> chosen numbers with the largest error due to them. Empty: nothing was to be decided.
   pure function decision_lines(choice, adequacy, is_whole) result(lines)
      type(model_choice_t), intent(in) :: choice
      type(adequacy_t), intent(in) :: adequacy
      logical, intent(in) :: is_whole
      character(:), allocatable :: lines, words
      integer :: i

      lines = ''
      if (.not. allocated(choice%rows)) return
      lines = 'auto      '//trim(solved_texts(choice%solved))
      if (.not. is_whole) return
      lines = '  auto'
      do i = 1, size(choice%rows)
         if (i > 1) lines = lines//new_line('a')
         associate (reason => reasons(choice%rows(i)%why))
            words = trim(reason%decision)
            if (reason%short /= '') words = words//': '//trim(reason%short)
         end associate
         call place(lines, trim(choice%rows(i)%name), tabs(1))
         call place(lines, influence_text(choice%rows(i), adequacy), tabs(2))
         call place(lines, words, tabs(3))
      end do
      if (allocated(choice%numbers)) then
         do i = 1, size(choice%numbers)
            associate (number => choice%numbers(i))
               lines = lines//new_line('a')
               call place(lines, trim(number%name), tabs(1))
               call place(lines, influence_text(new_influence(ingredient_t(0, number%judged_as, &
                  '')), adequacy), tabs(2))
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
      is_known = ieee_is_finite(row%change) .and. compared
      i = maxloc(abs(row%change), 1, is_known .and. ieee_is_finite(row%error))
      if (i > 0) then
         text = '<0.001'
         if (100*abs(row%change(i)) >= 0.001_wp) text = number_text(100*row%change(i), 2)
         if (.not. row%is_numerical) text = text//' +- '//number_text(100*row%error(i), 2)
         text = text//' % '//trim(quantity_rows(i)%short)
      end if
      if (row%left_out < 1.0_wp .and. any(is_known)) text = text//' '//part_mark
   end function influence_text

end module adequacy_section

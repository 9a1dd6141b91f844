!> /adequacy of a result, lubricated or dry: what each ingredient of the model and each numerical
!> choice changes; and all of them in one line of the closing table.
module adequacy_section
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use adequacy, only: adequacy_t, compared
   use hdf5_dataset, only: new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use quantities, only: quantity_count, quantity_rows
   use quantity_text, only: number_text
   use text, only: joined
   use verdicts, only: judged_t, verdict_irrelevant, verdict_needed, verdict_small, verdict_text, &
      verdict_unknown, why_unknown
   implicit none (type, external)
   private

   public :: model_line, model_sentence, write_adequacy, write_changes, write_influence

   character(*), parameter, public :: from_estimates = 'error estimates of the result'

contains

   !> A group for each ingredient of a lubricated contact, with a dataset for each quantity of the
   !> closing table whose change is known; nothing if nothing was measured.
   subroutine write_adequacy(file, adequacy)
      class(hdf5_file_t), intent(inout) :: file
      type(adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: group, source
      logical :: is_compared(quantity_count)
      integer :: i, k

      if (.not. allocated(adequacy%rows)) return
      is_compared = [(compared(k), k=1, quantity_count)]
      do i = 1, size(adequacy%rows)
         group = '/adequacy/'//trim(adequacy%rows(i)%name)
         associate (row => adequacy%rows(i))
            source = 'the case on coarser grids'
            if (row%is_at_rest) source = 'the smooth steady contact on coarser grids'
            if (row%has_roughness) source = 'the smooth steady contact on coarser grids, with '// &
               'the error that roughness adds'
            if (row%is_numerical) source = from_estimates
            if (row%name == 'time_step') source = 'runs of the error estimates, or a coarse '// &
               'grid with twice its time step'
            call write_influence(file, row, source, pack(quantity_rows%name, is_compared), &
               pack(row%change, is_compared), pack(row%error, is_compared))
            call write_attribute(file, group, 'left_out', row%left_out)
            do k = 1, quantity_count
               if (is_compared(k) .and. row%least(k) > 0.0_wp) call write_attribute(file, group, &
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

   !> The group of `row`, with a dataset for each of `quantities` whose relative change is known,
   !> with its error, and why others are not. `measured_on`: where these come from.
   subroutine write_influence(file, row, measured_on, quantities, changes, errors)
      class(hdf5_file_t), intent(inout) :: file
      class(judged_t), intent(in) :: row
      character(*), intent(in) :: measured_on, quantities(:)
      real(wp), intent(in) :: changes(:), errors(:)
      character(:), allocatable :: group, why
      logical :: is_known(size(changes))

      is_known = ieee_is_finite(changes) .and. ieee_is_finite(errors)
      group = '/adequacy/'//trim(row%name)
      call file%create_group(group)
      call write_attribute(file, group, 'verdict', verdict_text(row%verdict, row%is_numerical))
      call write_attribute(file, group, 'instead', trim(row%text))
      call write_attribute(file, group, 'measured_on', measured_on)
      why = why_unknown(row, quantities, is_known)
      if (why /= '') call write_attribute(file, group, 'not_known', why)
      call write_changes(file, group, trim(row%text), quantities, changes, errors)
   end subroutine write_influence

   !> The known relative `changes` of `quantities` into a group, each with its error; `instead`:
   !> what replaced the ingredient.
   subroutine write_changes(file, group, instead, quantities, changes, errors)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: group, instead, quantities(:)
      real(wp), intent(in) :: changes(:), errors(:)
      character(:), allocatable :: path
      integer :: i

      do i = 1, size(quantities)
         if (.not. (ieee_is_finite(changes(i)) .and. ieee_is_finite(errors(i)))) cycle
         path = group//'/'//trim(quantities(i))
         call write_dataset(file, path, changes(i), new_label('relative change of ' &
            //trim(quantities(i))//' with: '//instead, '1'))
         call write_attribute(file, path, 'error_estimate', errors(i))
      end do
   end subroutine write_changes

   !> What the closing table says of the ingredients among `rows`; empty: nothing.
   pure function model_line(rows, accuracy) result(line)
      type(judged_t), intent(in) :: rows(:)
      real(wp), intent(in) :: accuracy
      character(:), allocatable :: line

      line = ''
      call add('needed at '//number_text(100*accuracy, 2)//' %: ', verdict_needed)
      call add('less than that: ', verdict_small)
      call add('irrelevant: ', verdict_irrelevant)
      call add('not known: ', verdict_unknown)
      if (len(line) > 0) line = 'model     '//line

   contains

      !> One verdict with the names that have it.
      pure subroutine add(words, verdict)
         character(*), intent(in) :: words
         integer, intent(in) :: verdict
         logical :: is_one(size(rows))

         is_one = rows%verdict == verdict .and. .not. rows%is_numerical
         if (.not. any(is_one)) return
         if (len(line) > 0) line = line//'; '
         line = line//words//joined(pack(rows%name, is_one), ', ')
      end subroutine add

   end function model_line

   !> The same in a sentence: what simpler models would do at that accuracy, and which may.
   pure function model_sentence(rows, accuracy) result(line)
      type(judged_t), intent(in) :: rows(:)
      real(wp), intent(in) :: accuracy
      character(:), allocatable :: line
      logical :: is_enough(size(rows)), is_open(size(rows))

      line = ''
      if (all(rows%is_numerical)) return
      is_enough = (rows%verdict == verdict_small .or. rows%verdict == verdict_irrelevant) .and. &
         .not. rows%is_numerical
      is_open = rows%verdict == verdict_unknown .and. .not. rows%is_numerical
      line = 'nothing simpler will do'
      if (any(is_enough)) line = 'each of these alone will do: '//joined(pack(rows%text, &
         is_enough), ', ')
      if (any(is_open)) line = line//'; perhaps '//joined(pack(rows%text, is_open), ', ')
      line = 'model     at '//number_text(100*accuracy, 2)//' % '//line
   end function model_sentence

end module adequacy_section

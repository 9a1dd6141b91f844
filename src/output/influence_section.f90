!> What the adequacy of a model says of one ingredient or numerical choice, lubricated or dry: its
!> group in the result file, and all of them in one line of the closing table.
module influence_section
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use hdf5_attribute, only: write_attribute
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use quantity_text, only: number_text
   use text, only: joined
   use verdicts, only: judged_t, verdict_irrelevant, verdict_needed, verdict_small, verdict_text, &
      verdict_unknown, why_unknown
   implicit none (type, external)
   private

   public :: model_line, write_changes, write_influence

contains

   !> The group of `row` in /adequacy, with a data set for each of `quantities` whose relative
   !> change is known, with its error, and why others are not. `measured_on`: where these come from.
   subroutine write_influence(file, row, measured_on, quantities, changes, errors)
      class(hdf5_file_t), intent(inout) :: file
      class(judged_t), intent(in) :: row
      character(*), intent(in) :: measured_on, quantities(:)
      real(wp), intent(in) :: changes(:), errors(:)
      character(:), allocatable :: group, why
      logical :: is_told(size(changes))

      is_told = ieee_is_finite(changes) .and. ieee_is_finite(errors)
      group = '/adequacy/'//trim(row%name)
      call file%create_group(group)
      call write_attribute(file, group, 'verdict', verdict_text(row%verdict, row%is_numerical))
      call write_attribute(file, group, 'instead', trim(row%text))
      call write_attribute(file, group, 'measured_on', measured_on)
      why = why_unknown(row, quantities, is_told)
      if (why /= '') call write_attribute(file, group, 'not_known', why)
      call write_changes(file, group, trim(row%text), pack(quantities, is_told), pack(changes, &
         is_told), pack(errors, is_told))
   end subroutine write_influence

   !> The relative `changes` of `quantities` into a group, each with its error; `instead`: what was
   !> in place of the ingredient.
   subroutine write_changes(file, group, instead, quantities, changes, errors)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: group, instead, quantities(:)
      real(wp), intent(in) :: changes(:), errors(:)
      character(:), allocatable :: path
      integer :: i

      do i = 1, size(quantities)
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

end module influence_section

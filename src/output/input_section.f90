!> /input/effective of a result file: every value that was used, given, default or chosen.
module input_section
   use, intrinsic :: iso_fortran_env, only: int64
   use case_record, only: effective_t
   use hdf5_dataset, only: label_t, new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use number_text, only: read_real
   use result_labels, only: quantity_label
   use scaling, only: scaling_t
   use text, only: count_of
   implicit none (type, external)
   private

   public :: write_input

contains

   !> /input/effective/<group>/<key>: numbers if the value has a unit ('-': a pure number) and reads
   !> as such, else text.
   subroutine write_input(file, entry, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(effective_t), intent(in) :: entry
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: path
      real(wp), allocatable :: numbers(:)
      type(label_t) :: label

      path = '/input/effective/'//entry%group//'/'//entry%key
      label = new_label('&'//entry%group//' '//entry%key, '1')
      if (entry%unit == 'half-widths') then
         label = quantity_label(label%long_name//', in half-widths', 'm', scaling%half_width, &
            scaling)
      else if (entry%unit /= '' .and. entry%unit /= '-') then
         label%si_units = entry%unit
      end if
      numbers = numbers_of(entry%value)
      if (entry%unit == '' .or. size(numbers) == 0) then
         call write_dataset(file, path, entry%value, label)
      else if (size(numbers) > 1) then
         call write_dataset(file, path, numbers, label)
      else if (scan(entry%value, '.eEdD') == 0) then
         call write_dataset(file, path, nint(numbers(1), int64), label)
      else
         call write_dataset(file, path, numbers(1), label)
      end if
   end subroutine write_input

   !> The numbers in a list separated by commas; none if one of them is not a number.
   pure function numbers_of(list) result(numbers)
      character(*), intent(in) :: list
      real(wp), allocatable :: numbers(:)
      integer :: comma, i, start
      logical :: good

      allocate (numbers(1 + count_of(',', list)))
      start = 1
      do i = 1, size(numbers)
         comma = index(list(start:) // ',', ',')
         call read_real(trim(adjustl(list(start:start + comma - 2))), numbers(i), good)
         start = start + comma
         if (good) cycle
         numbers = [real(wp) ::]
         return
      end do
   end function numbers_of

end module input_section

!> /input/effective of a result file: every value that was used, given, default or chosen.
module input_section
   use, intrinsic :: iso_fortran_env, only: int64
   use case_record, only: effective_t
   use hdf5_axes, only: make_axis
   use hdf5_dataset, only: label_t, new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use result_labels, only: scaled_label
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: write_input

contains

   !> /input/effective/<group>/<key>: a number, numbers or a text.
   subroutine write_input(file, entry, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(effective_t), intent(in) :: entry
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: path
      type(label_t) :: label

      path = '/input/effective/'//trim(entry%group)//'/'//trim(entry%key)
      label = new_label('&'//trim(entry%group)//' '//trim(entry%key), '1')
      if (entry%unit == 'half-widths') then
         label = scaled_label(label%long_name//', in half-widths', 'half_width', scaling)
      else if (entry%unit /= '' .and. entry%unit /= '-') then
         label%si_units = trim(entry%unit)
      end if
      if (allocated(entry%text)) then
         call write_dataset(file, path, entry%text, label)
      else if (allocated(entry%integer)) then
         call write_dataset(file, path, int(entry%integer, int64), label)
      else if (size(entry%reals) > 1) then
         call write_dataset(file, path, entry%reals, label)
         call make_axis(file, path)   ! one value after the other: no coordinate but itself
      else
         call write_dataset(file, path, entry%reals(1), label)
      end if
   end subroutine write_input

end module input_section

!> /input/effective of a result file: every value that was used, given, default or chosen.
module input_section
   use case_record, only: effective_t
   use hdf5_dataset, only: write_attribute
   use hdf5_file, only: hdf5_file_t
   implicit none (type, external)
   private

   public :: write_inputs

contains

   !> A group /input/effective/<group> for each namelist group, whose attributes are its keys.
   subroutine write_inputs(file, entries)
      class(hdf5_file_t), intent(inout) :: file
      type(effective_t), intent(in) :: entries(:)
      character(:), allocatable :: path
      integer :: i, j

      call file%create_group('/input/effective')
      call write_attribute(file, '/input/effective', 'about', 'every value used, in the unit '// &
         'of its key: SI, or half-widths for positions along the film')
      do i = 1, size(entries)
         if (any(entries(:i - 1)%group == entries(i)%group)) cycle
         path = '/input/effective/'//trim(entries(i)%group)
         call file%create_group(path)
         do j = i, size(entries)
            if (entries(j)%group == entries(i)%group) call write_value(file, path, entries(j))
         end do
      end do
   end subroutine write_inputs

   !> A number, numbers or a text, in the unit of the key in the namelist.
   subroutine write_value(file, path, entry)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path
      type(effective_t), intent(in) :: entry

      if (allocated(entry%text)) then
         call write_attribute(file, path, trim(entry%key), entry%text)
      else if (allocated(entry%integer)) then
         call write_attribute(file, path, trim(entry%key), entry%integer)
      else if (size(entry%reals) == 1) then
         call write_attribute(file, path, trim(entry%key), entry%reals(1))
      else
         call write_attribute(file, path, trim(entry%key), entry%reals)
      end if
   end subroutine write_value

end module input_section

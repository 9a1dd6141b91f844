!> /adequacy of a dry result: what each ingredient changes, and whether the grid is fine enough.
module dry_adequacy_section
   use dry_adequacy, only: coarsening, compared, dry_adequacy_t, dry_influence_t
   use dry_quantities, only: dry_table
   use hdf5_attribute, only: write_attribute
   use hdf5_file, only: hdf5_file_t
   use influence_section, only: write_influence
   use quantity_text, only: number_text
   use text, only: joined
   implicit none (type, external)
   private

   public :: write_dry_adequacy

contains

   !> A group for each row, with a dataset for each quantity whose change is known.
   subroutine write_dry_adequacy(file, adequacy)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_adequacy_t), intent(in) :: adequacy
      integer :: i

      if (.not. allocated(adequacy%rows)) return
      do i = 1, size(adequacy%rows)
         associate (row => adequacy%rows(i))
            call write_influence(file, row, measured_on(adequacy, row), dry_table(compared)%name, &
               row%change, row%error)
         end associate
      end do
      if (size(adequacy%rows) == 0) call file%create_group('/adequacy')
      call write_attribute(file, '/adequacy', 'about', 'relative change under '// &
         'mean_pressure, the largest of the sweep, where an ingredient is left out, measured '// &
         'on coarser grids; of the grid the error estimate; attribute error_estimate: error '// &
         'of the change; no dataset: not known')
      call write_attribute(file, '/adequacy', 'accuracy', adequacy%accuracy)
      call write_attribute(file, '/adequacy', 'mean_pressure', adequacy%mean_pressure)
      call write_attribute(file, '/adequacy', 'judged_by', joined(dry_table(compared)%name, ', '))
   end subroutine write_dry_adequacy

   !> Where the changes of a row come from.
   pure function measured_on(adequacy, row) result(text)
      type(dry_adequacy_t), intent(in) :: adequacy
      type(dry_influence_t), intent(in) :: row
      character(:), allocatable :: text

      if (row%is_numerical) then
         text = 'error estimates of the result'
      else if (row%name == 'area') then
         text = 'the nodes of the result'
      else
         text = 'grids with '//number_text(adequacy%ratio, 3)//' and ' &
            //number_text(coarsening*adequacy%ratio, 3)//' times the spacing'
      end if
   end function measured_on

end module dry_adequacy_section

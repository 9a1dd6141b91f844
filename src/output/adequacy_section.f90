!> /adequacy of a result file: what each ingredient of the model and each numerical choice changes.
module adequacy_section
   use adequacy, only: adequacy_t, compared, influence_t
   use hdf5_attribute, only: write_attribute
   use hdf5_file, only: hdf5_file_t
   use influence_section, only: write_influence
   use kinds, only: wp
   use quantities, only: quantity_count, quantity_rows
   implicit none (type, external)
   private

   public :: write_adequacy

contains

   !> Writes a group for each row, with a data set for each quantity of the closing table whose
   !> change is known; nothing if nothing was measured.
   subroutine write_adequacy(file, adequacy)
      class(hdf5_file_t), intent(inout) :: file
      type(adequacy_t), intent(in) :: adequacy
      integer :: i

      if (.not. allocated(adequacy%rows)) return
      do i = 1, size(adequacy%rows)
         call write_row(file, adequacy%rows(i))
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

   !> One ingredient.
   subroutine write_row(file, row)
      class(hdf5_file_t), intent(inout) :: file
      type(influence_t), intent(in) :: row
      logical :: is_compared(quantity_count)
      integer :: i

      is_compared = [(compared(i), i=1, quantity_count)]
      call write_influence(file, row, measured_on(row), pack(quantity_rows%name, is_compared), &
         pack(row%change, is_compared), pack(row%error, is_compared))
      call write_attribute(file, '/adequacy/'//trim(row%name), 'left_out', row%left_out)
      do i = 1, quantity_count
         if (compared(i) .and. row%least(i) > 0.0_wp) call write_attribute(file, '/adequacy/' &
            //trim(row%name), trim(quantity_rows(i)%name)//'_at_least', row%least(i))
      end do
   end subroutine write_row

   !> Where the changes of a row come from.
   pure function measured_on(row) result(text)
      type(influence_t), intent(in) :: row
      character(:), allocatable :: text

      text = 'the case on coarser grids'
      if (row%is_at_rest) text = 'the smooth steady contact on coarser grids'
      if (row%has_roughness) text = 'the smooth steady contact on coarser grids, with the error ' &
         //'that roughness adds'
      if (row%is_numerical) text = 'error estimates of the result'
      if (row%name == 'time_step') text = 'runs of the error estimates, or a coarse grid with '// &
         'twice its time step'
   end function measured_on

end module adequacy_section

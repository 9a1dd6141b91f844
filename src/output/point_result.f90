!> The sections of the result of a lubricated point contact.
module point_result
   use case_record, only: case_t
   use hdf5_axes, only: make_counter, name_axes, write_field
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use missing_value, only: not_known
   use point_solver, only: point_run_t
   use result_labels, only: row_label, scaled_label
   use result_sections, only: write_scaling, write_summary
   implicit none (type, external)
   private

   public :: write_point_result

contains

   !> Writes /scaling, /solution, /summary and what the grids have taken; `missing`: why a
   !> quantity whose error is NaN has none.
   subroutine write_point_result(file, case, run, summary, missing)
      class(hdf5_file_t), intent(inout) :: file
      type(case_t), intent(in) :: case
      type(point_run_t), intent(in) :: run
      type(line_summary_t), intent(in) :: summary
      character(*), intent(in) :: missing

      call write_scaling(file, case%scaling)
      call write_attribute(file, '/scaling', 'radius_ratio', case%point%radius_ratio, '1')
      call write_fields(file, case, run)
      call write_summary(file, summary, case%scaling, .false., missing, not_known())
      call make_counter(file, '/report/grid', size(run%work, 2), 'number of the grid')
      call make_counter(file, '/report/kind_of_work', 2, &
         'number of: Newton steps, iterations of GMRES')
      call write_dataset(file, '/report/grid_work', real(run%work, wp), new_label( &
         'Newton steps and iterations of GMRES on each grid, the coarsest first', '1'))
      call name_axes(file, '/report/grid_work', 'kind_of_work grid')
   end subroutine write_point_result

   !> /solution, and its copy in SI.
   subroutine write_fields(file, case, run)
      class(hdf5_file_t), intent(inout) :: file
      type(case_t), intent(in) :: case
      type(point_run_t), intent(in) :: run
      logical :: has_si

      has_si = case%output_settings%has_si .and. case%scaling%is_dimensional
      associate (level => run%newton%hierarchy%levels(1))
         call put('x', level%x, '=', ', X = x/a')
         call put('y', level%y, '=', ', Y = y/a')
         call put('pressure', level%pressure, 'x y', ', P = p/p_h')
         call put('film_thickness', level%film, 'x y', ', H = h Rx/a^2')
         call write_dataset(file, '/solution/rigid_displacement', level%rigid_displacement, &
            scaled_label('rigid displacement H0 of the undeformed bodies', 'film', case%scaling))
      end associate

   contains

      !> A coordinate, or a field over both.
      subroutine put(name, values, axes, definition)
         character(*), intent(in) :: name, axes, definition
         real(wp), intent(in), contiguous, target :: values(..)
         type(label_t) :: label

         label = row_label(name, case%scaling)
         label%definition = definition
         call write_field(file, '/solution/'//name, values, label, axes, has_si)
      end subroutine put

   end subroutine write_fields

end module point_result

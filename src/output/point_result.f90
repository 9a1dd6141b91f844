!> The sections of the result of a lubricated point contact.
module point_result
   use adequacy, only: judge
   use adequacy_section, only: write_adequacy, write_validity
   use case_record, only: case_t
   use field_sections, only: write_solution, write_statistics
   use hdf5_axes, only: make_counter, name_axes
   use hdf5_dataset, only: new_label, write_attribute, write_dataset
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use point_solver, only: point_run_t
   use result_sections, only: write_breakdown, write_scaling, write_summary, write_times
   use result_writer, only: result_writer_t
   implicit none (type, external)
   private

   public :: write_point_result

contains

   !> Writes /scaling, /solution, /transient, /summary and what the grids of the steady solution
   !> have taken; `missing`: why a quantity whose error is NaN has none.
   subroutine write_point_result(writer, case, run, state, summary, report, missing)
      type(result_writer_t), intent(inout) :: writer
      type(case_t), intent(in) :: case
      type(point_run_t), intent(in) :: run
      type(line_state_t), intent(in) :: state
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(in) :: report
      character(*), intent(in) :: missing

      associate (file => writer%file)
         call write_scaling(file, case%scaling)
         call write_attribute(file, '/scaling', 'radius_ratio', case%point%radius_ratio, '1')
         call write_solution(file, state, case%scaling, writer%has_si)
         call writer%copy_steps(writer%has_si, [size(state%x), size(state%y)])
         call write_summary(file, summary, case%scaling, writer%is_transient, missing, &
            writer%lambda_ratio())
         if (writer%is_transient) call write_times(file, writer%run%passage%times)
         call write_statistics(file, writer%run%statistics, case%scaling, &
            writer%run%passage%times%statistics_from())
         if (case%solver%film_floor > 0.0_wp) call write_breakdown(file, report%breakdown, &
            case%scaling)
         if (allocated(writer%limits)) call write_validity(file, writer%limits)
         call judge(writer%adequacy, summary)
         call write_adequacy(file, writer%adequacy)
         call make_counter(file, '/report/grid', size(run%work, 2), 'number of the grid')
         call make_counter(file, '/report/kind_of_work', 2, &
            'number of: Newton steps, iterations of GMRES')
         call write_dataset(file, '/report/grid_work', real(run%work, wp), new_label( &
            'Newton steps and iterations of GMRES on each grid, the coarsest first', '1'))
         call name_axes(file, '/report/grid_work', 'kind_of_work grid')
      end associate
   end subroutine write_point_result

end module point_result

!> One lubricated point contact from its record to its result file and its exit status.
module run_point_case
   use case_notes, only: note_unusual
   use case_outcome, only: case_outcome_t, outcome_of
   use case_record, only: case_t, set_effective
   use closing_table, only: close_case, closing_words_t
   use errors, only: error_t
   use iteration_report, only: phase_error_bars, phase_steady, report_t
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use missing_value, only: not_known
   use passage_times, only: passage_times_t
   use point_quantities, only: estimate_point_errors
   use point_result, only: write_point_result
   use point_solver, only: measure_domain, point_run_t, solve_point_steady
   use progress_log, only: progress_log_t
   use quantities, only: h_central, h_min
   use result_file, only: open_result, result_file_t
   use run_observer, only: run_observer_t
   use signals, only: begin_activity
   use system_limits, only: peak_memory, processors
   use text, only: add_sentence, to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_point_case

contains

   !> Solves `case` on `threads` threads, writes its result `path`, and prints its closing table.
   !> Error: the result, or a library; there is no result then.
   subroutine solve_point_case(case, path, log, threads, ending, error)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      type(progress_log_t), intent(inout) :: log
      integer, intent(in) :: threads
      type(case_outcome_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(run_observer_t) :: listener
      type(result_file_t) :: result
      type(point_run_t) :: run
      type(line_summary_t) :: summary
      type(report_t) :: report
      character(:), allocatable :: missing
      real(wp) :: start

      call log%start_case(case%file, case%scaling)
      listener%log = log
      call open_result(result, case, path, error)
      if (allocated(error)) return
      run%tolerance = case%solver%tolerance
      run%max_steps = case%solver%max_cycles
      run%target = case%solver%target
      run%slide_to_roll = case%scaling%slide_to_roll
      run%threads = min(threads, processors())
      start = wall_seconds()
      call solve_point_steady(run, case%point, listener, report, error)
      if (.not. allocated(error)) then
         report%cost%phase_seconds(phase_steady) = wall_seconds() - start
         call find_quantities(case, run, report, summary, missing, error)
      end if
      if (allocated(error)) then
         call result%discard()
         return
      end if
      report%cost%wall_seconds = wall_seconds() - start
      report%cost%peak_memory = peak_memory()
      call note_unusual(case, report%note)
      call note_target(case, summary, report)
      call list_chosen(case)
      call result%begin_end(case)
      call write_point_result(result%file, case, run, summary, missing)
      call result%publish(report, error)
      if (allocated(error)) return
      call close_case(log, summary, report, result%name%path, passage_times_t(), &
         closing_words_t())
      ending = outcome_of(report)
   end subroutine solve_point_case

   !> The quantities of the last grid with their errors, and why one is `missing`; without a
   !> solution they are not known.
   subroutine find_quantities(case, run, report, summary, missing, error)
      type(case_t), intent(in) :: case
      type(point_run_t), intent(in) :: run
      type(report_t), intent(inout) :: report
      type(line_summary_t), intent(out) :: summary
      character(:), allocatable, intent(out) :: missing
      type(error_t), allocatable, intent(out) :: error
      type(line_summary_t) :: far, near
      real(wp) :: start
      integer :: n
      logical :: is_known

      n = size(run%grids)
      missing = 'no solution'
      if (.not. report%converged) then
         summary%of%value = not_known()
         summary%of%error_estimate = not_known()
         return
      end if
      summary = run%grids(n)
      missing = 'no coarser grids are compared'
      if (.not. case%solver%wants_coarse_runs) return
      missing = 'fewer than two coarser grids hold the film'
      if (n < 3) return
      start = wall_seconds()
      call begin_activity('a longer domain')
      call measure_domain(run, case%point, near, far, is_known, error)
      if (allocated(error)) return
      report%cost%phase_seconds(phase_error_bars) = wall_seconds() - start
      if (is_known) then
         call estimate_point_errors(summary, case%point, run%grids(n - 1:1:-1), report%residual, &
            near, far)
         missing = 'a pressure spike that this grid does not resolve'
      else
         missing = 'a longer domain has no solution to compare with'
      end if
   end subroutine find_quantities

   !> Notes a target that is not shown.
   subroutine note_target(case, summary, report)
      type(case_t), intent(in) :: case
      type(line_summary_t), intent(in) :: summary
      type(report_t), intent(inout) :: report

      if (.not. (case%solver%target > 0.0_wp .and. report%converged)) return
      associate (of => summary%of([h_min, h_central]))
         if (all(of%error_estimate <= case%solver%target*of%value)) return
         call add_sentence(report%note, 'the target accuracy is not shown: relative errors of '// &
            'h_min and h_central of '//to_text(of(1)%error_estimate/of(1)%value, 2)//' and ' &
            //to_text(of(2)%error_estimate/of(2)%value, 2)//' are estimated, ' &
            //to_text(case%solver%target, 2)//' is the target')
      end associate
   end subroutine note_target

   !> Lists what the program has chosen among the effective values.
   subroutine list_chosen(case)
      type(case_t), intent(inout) :: case

      associate (domain => case%point%domain)
         call set_effective(case, 'domain', 'x_inlet', [domain%x_inlet])
         call set_effective(case, 'domain', 'x_outlet', [domain%x_outlet])
         call set_effective(case, 'domain', 'y_half_width', [domain%y_half_width])
         call set_effective(case, 'domain', 'intervals_x', integer=domain%nx)
         call set_effective(case, 'domain', 'intervals_y', integer=domain%ny)
      end associate
   end subroutine list_chosen

end module run_point_case

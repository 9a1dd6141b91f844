!> One case from its record to its result file and its exit status.
module run_case
   use case_outcome, only: give_up, status_converged, status_not_converged, store_input
   use case_record, only: case_t, result_path, set_effective
   use ehl_line_solver, only: solve_ehl_line
   use error_bars, only: choose_resolution, run_companions
   use errors, only: error_t
   use input_keys, only: lubricated
   use iteration_report, only: phase_error_bars, phase_output, phase_transient, report_t
   use kinds, only: wp
   use line_case, only: build_line_contact
   use line_contact, only: line_contact_t
   use line_state, only: all_finite, line_state_t
   use progress_log, only: new_progress_log
   use result_writer, only: field_name_length, open_result, result_writer_t
   use run_dry_case, only: solve_and_write
   use run_observer, only: run_observer_t
   use scaling, only: scaling_t
   use text, only: to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: run_one_case

contains

   !> Solves `case`, writes its result to the folder `output_dir` (empty: where the case says), tells progress unless `is_quiet`.
   subroutine run_one_case(case, output_dir, is_quiet, status)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: output_dir
      logical, intent(in) :: is_quiet
      integer, intent(out) :: status
      type(run_observer_t) :: watcher
      type(line_contact_t) :: contact
      type(line_state_t) :: state
      type(report_t) :: report
      type(scaling_t) :: scaling
      type(error_t), allocatable :: error
      real(wp) :: seconds

      if (case%problem /= lubricated) then
         call solve_and_write(case, output_dir, is_quiet, status)
         return
      end if
      watcher%log = new_progress_log(is_quiet)
      call build_line_contact(case, scaling, contact)
      call watcher%log%start_case(case%file, scaling)
      call start_result(case, output_dir, scaling, watcher%writer, error)
      if (allocated(error)) then
         call give_up(error, watcher%log, status)
         return
      end if
      call prepare_error_bars(case, contact, watcher, seconds, error)
      if (.not. allocated(error)) call solve_ehl_line(contact, case%solver, case%time, watcher, state, report, error)
      if (allocated(error)) then
         call watcher%writer%discard()
         call give_up(error, watcher%log, status)
         return
      end if
      call refuse_nonsense(state, report)
      report%phase_seconds(phase_error_bars) = seconds
      report%phase_seconds(phase_output) = watcher%output_seconds
      report%phase_seconds(phase_transient) = max(report%phase_seconds(phase_transient) - watcher%output_seconds, 0.0_wp)
      call fill_chosen(case, contact, report)
      call store_input(case, watcher%writer)
      call watcher%writer%finish(state, report, error)
      if (allocated(error)) then
         call give_up(error, watcher%log, status)
         return
      end if
      call watcher%log%close_case(watcher%writer%summary, report, watcher%writer%path)
      status = merge(status_converged, status_not_converged, report%converged)
   end subroutine run_one_case

   !> Companions on coarser grids; with a target, intervals and time step too.
   subroutine prepare_error_bars(case, contact, watcher, seconds, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(inout) :: contact
      type(run_observer_t), intent(inout) :: watcher
      real(wp), intent(out) :: seconds
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: start

      start = wall_seconds()
      if (case%accuracy%target > 0.0_wp) then
         call choose_resolution(watcher%writer%bars, contact, case%solver, case%time, case%accuracy%target, &
            error)   ! error: the caller looks
      else if (case%accuracy%has_error_bars) then
         call run_companions(watcher%writer%bars, contact, case%solver, case%time, error)   ! error: the caller looks
      end if
      seconds = wall_seconds() - start
   end subroutine prepare_error_bars

   !> Opens the result of `case` and writes what is known before the run. Error: it cannot be written.
   subroutine start_result(case, output_dir, scaling, writer, error)
      type(case_t), intent(in) :: case
      character(*), intent(in) :: output_dir
      type(scaling_t), intent(in) :: scaling
      type(result_writer_t), intent(out) :: writer
      type(error_t), allocatable, intent(out) :: error

      call open_result(writer, result_path(case, output_dir), error)
      if (allocated(error)) return
      writer%profile_stride = case%output_settings%profile_stride
      if (allocated(case%output_settings%fields)) then
         writer%fields = [character(len=field_name_length) :: case%output_settings%fields]
      end if
      call writer%describe(trim(case%problem), case%title, case%namelist, scaling)
   end subroutine start_result

   !> What the program has chosen in place of the user goes into the list of effective values; 0: not used by the method.
   subroutine fill_chosen(case, contact, report)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(in) :: contact
      type(report_t), intent(in) :: report
      integer, parameter :: all_digits = 17

      call set_effective(case, 'domain', 'x_inlet', to_text(contact%domain%x_inlet, all_digits), 'half-widths')
      call set_effective(case, 'domain', 'x_outlet', to_text(contact%domain%x_outlet, all_digits), 'half-widths')
      call set_effective(case, 'domain', 'intervals', to_text(contact%domain%intervals), '-')
      call set_effective(case, 'solver', 'levels', to_text(report%levels), '-')
      call set_effective(case, 'solver', 'tolerance', to_text(report%tolerance, all_digits), '-')
      call set_effective(case, 'solver', 'max_cycles', to_text(report%max_cycles), '-')
      call set_effective(case, 'solver', 'pre_sweeps', to_text(report%pre_sweeps), '-')
      call set_effective(case, 'solver', 'post_sweeps', to_text(report%post_sweeps), '-')
      call set_effective(case, 'solver', 'coarse_sweeps', to_text(report%coarse_sweeps), '-')
      call set_effective(case, 'solver', 'relaxation', to_text(report%relaxation, all_digits), '-')
      call set_effective(case, 'solver', 'load_relaxation', to_text(report%load_relaxation, all_digits), '-')
   end subroutine fill_chosen

   !> A solution that is not made of numbers is not converged, whatever the solver says.
   subroutine refuse_nonsense(state, report)
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report

      if (.not. report%converged .or. all_finite(state)) return
      report%converged = .false.
      report%reason = 'the solution holds values that are not finite'
   end subroutine refuse_nonsense

end module run_case

!> Runs one job: the same contact solved many times in one process, timed by phase.
module bench_measure
   use bench_recorder, only: largest_difference, record_steady, recorder_t, start_recorder
   use case_input, only: read_case
   use case_record, only: case_t
   use error_bars, only: error_bars_t
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use iteration_report, only: phase_setup, phase_steady, phase_transient, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use missing_value, only: not_known
   use resolution_choice, only: choose_resolution
   use solver_settings, only: solver_settings_t, time_settings_t
   use steady_target, only: solve_contact
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: job_t, measurement_t, measure

   !> Phases that are timed: setup, steady, transient, all.
   integer, parameter, public :: timed_phases = 4

   !> A namelist and what is done with it.
   type :: job_t
      character(:), allocatable :: name, text
      !> Runs at most; no further run after `seconds` of runs [s]; a run is stopped, between cycles,
      !> after `limit` [s].
      integer :: runs = 1
      real(wp) :: seconds = 1.0e9_wp, limit = 1.0e9_wp
      !> Its fields become the reference of later jobs; are compared with the last one; passes
      !> the coarser grids of its error bars.
      logical :: is_reference = .false., is_compared = .false., has_bars = .false.
   end type job_t

   !> What came out of a job.
   type :: measurement_t
      type(report_t) :: report
      !> The first run, with its fields if asked for.
      type(recorder_t) :: first
      type(line_contact_t) :: contact
      !> Wall time of each run by phase [s].
      real(wp), allocatable :: times(:, :)
      !> Mean processor time of a run, planning included [s].
      real(wp) :: processor = 0.0_wp
      !> Largest difference in P to the reference; NaN without one.
      real(wp) :: difference = 0.0_wp
   end type measurement_t

contains

   !> Runs `job`. `reference` (nx, 0:steps) is compared with, and replaced, as the job says.
   subroutine measure(job, reference, outcome, error)
      type(job_t), intent(in) :: job
      real(wp), allocatable, intent(inout) :: reference(:, :)
      type(measurement_t), intent(out) :: outcome
      type(error_t), allocatable, intent(out) :: error
      type(case_t) :: case
      type(findings_t) :: findings
      real(wp), allocatable :: times(:, :)
      real(wp) :: start
      real(wp) :: processor_start, processor_end
      integer :: run

      call read_case(job%text, job%name, case, findings)
      if (findings%count > 0) then
         call fail(error, input_error, findings%report(job%name))
         return
      end if
      outcome%contact = case%contact
      allocate (times(timed_phases, job%runs))
      start = wall_seconds()
      call cpu_time(processor_start)
      do run = 1, job%runs
         call run_once(job, case, run == 1, outcome, times(:, run), error)
         if (allocated(error)) return
         if (wall_seconds() - start > job%seconds) exit
      end do
      call cpu_time(processor_end)
      run = min(run, job%runs)
      outcome%processor = (processor_end - processor_start)/run
      outcome%times = times(:, :run)
      outcome%difference = not_known()
      if (.not. allocated(outcome%first%pressure)) return
      if (job%is_compared .and. allocated(reference)) then
         outcome%difference = largest_difference(outcome%first%pressure, reference)
      end if
      if (job%is_reference) reference = outcome%first%pressure
   end subroutine measure

   !> One run; the first one is kept. With a wanted accuracy, the time of the choice of the grid is
   !> in that of all phases.
   subroutine run_once(job, case, is_first, outcome, times, error)
      type(job_t), intent(in) :: job
      type(case_t), intent(in) :: case
      logical, intent(in) :: is_first
      type(measurement_t), intent(inout) :: outcome
      real(wp), intent(out) :: times(:)
      type(error_t), allocatable, intent(out) :: error
      type(recorder_t) :: listener
      type(line_contact_t) :: contact
      type(line_state_t) :: state
      type(report_t) :: report
      type(time_settings_t) :: time
      type(solver_settings_t) :: settings
      type(error_bars_t) :: bars
      real(wp) :: start

      contact = outcome%contact
      time = case%time
      times = 0.0_wp
      call start_recorder(listener, is_first .and. (job%is_reference .or. job%is_compared &
         .or. case%time%is_transient), job%limit)
      start = wall_seconds()
      settings = case%solver
      settings%wants_coarse_runs = job%has_bars
      if (case%solver%target > 0.0_wp .and. case%time%is_transient) then
         call choose_resolution(bars, contact, settings, time, listener, error)
         if (allocated(error)) return
      end if
      call solve_contact(contact, settings, time, listener, state, report, error)
      if (allocated(error)) return
      times = [report%cost%phase_seconds([phase_setup, phase_steady, phase_transient]), &
         wall_seconds() - start]
      if (.not. is_first) return
      if (.not. case%time%is_transient) then
         call record_steady(listener, state)
         listener%residual = report%residual
      end if
      outcome%contact%domain = contact%domain
      outcome%report = report
      outcome%first = listener
   end subroutine run_once

end module bench_measure

!> Runs one job: the same contact solved many times in one process, timed by phase.
module bench_measure
   use case_input, only: read_case
   use case_record, only: case_t
   use coarse_runs, only: side_runs_t
   use errors, only: error_t, fail, input_error
   use experiment, only: solution_t
   use findings, only: findings_t
   use iteration_report, only: phase_setup, phase_steady, phase_transient, report_t
   use kinds, only: not_known, wp
   use line_contact, only: line_contact_t, solver_settings_t, time_settings_t
   use line_state, only: line_state_t
   use line_summary, only: keep_extremes, line_summary_t, summary_of
   use listener, only: listener_t
   use march_state, only: march_state_t
   use resolution_choice, only: choose_resolution
   use ehl_line_solver, only: solve_ehl_line
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

   !> What is kept of one run: pressure of all time steps and the extremes over them, in its time.
   type, extends(listener_t) :: recorder_t
      !> Seconds of processor time after which the run is stopped, counted from `start`.
      real(wp) :: limit = huge(1.0_wp), start = 0.0_wp
      !> True: keep pressure and extremes; false: only watch the clock.
      logical :: is_recording = .false.
      !> Largest residual of all time steps.
      real(wp) :: residual = 0.0_wp
      type(line_summary_t) :: summary
      !> P of all stored times (nx, 0:steps); only the steady solution: (nx, 0:0).
      real(wp), allocatable :: pressure(:, :)
   contains
      procedure :: wants_stop => is_over
      procedure :: on_step => keep_step
   end type recorder_t

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
      type(side_runs_t), allocatable :: side_runs
      type(solution_t), allocatable :: whole
      type(time_settings_t) :: time
      type(solver_settings_t) :: settings
      real(wp) :: start

      contact = outcome%contact
      time = case%time
      times = 0.0_wp
      listener%is_recording = is_first .and. (job%is_reference .or. job%is_compared &
         .or. case%time%is_transient)
      listener%limit = job%limit
      call cpu_time(listener%start)
      start = wall_seconds()
      settings = case%solver
      settings%wants_coarse_runs = job%has_bars
      if (case%solver%target > 0.0_wp .and. case%time%is_transient) then
         call choose_resolution(contact, settings, time, side_runs, listener, error)
         if (allocated(error)) return
         if (allocated(side_runs%whole)) whole = side_runs%whole
      end if
      if (.not. allocated(whole)) then
         allocate (whole)
         whole%contact = contact
         call solve_ehl_line(whole%contact, settings, time, listener, whole%state, whole%report, &
            error)
      end if
      if (allocated(error)) return
      times = [whole%report%cost%phase_seconds([phase_setup, phase_steady, phase_transient]), &
         wall_seconds() - start]
      if (.not. is_first) return
      if (.not. case%time%is_transient) then
         call record_steady(listener, whole%state)
         listener%residual = whole%report%residual
      end if
      outcome%contact%domain = whole%contact%domain
      outcome%report = whole%report
      outcome%first = listener
   end subroutine run_once

   !> Takes the fields of a steady solution.
   subroutine record_steady(self, state)
      type(recorder_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state

      self%summary = summary_of(state)
      if (.not. self%is_recording) return
      if (allocated(self%pressure)) deallocate (self%pressure)
      allocate (self%pressure(size(state%x), 0:0))
      self%pressure(:, 0) = state%pressure
   end subroutine record_steady

   !> Largest difference in P at the nodes and times that both have; NaN where neither grid contains
   !> the other.
   pure function largest_difference(one, other) result(difference)
      real(wp), intent(in) :: one(:, 0:), other(:, 0:)
      real(wp) :: difference
      integer :: stride_1, stride_2, times_1, times_2, n, steps, k

      n = min(size(one, 1), size(other, 1)) - 1
      steps = min(ubound(one, 2), ubound(other, 2))
      stride_1 = (size(one, 1) - 1)/n
      stride_2 = (size(other, 1) - 1)/n
      times_1 = ubound(one, 2)/max(steps, 1)
      times_2 = ubound(other, 2)/max(steps, 1)
      difference = 0.0_wp
      do k = 0, steps
         difference = max(difference, &
            maxval(abs(one(::stride_1, k*times_1) - other(::stride_2, k*times_2))))
      end do
   end function largest_difference

   !> Whether the run has had its time.
   function is_over(self)
      class(recorder_t), intent(inout) :: self
      logical :: is_over
      real(wp) :: now

      call cpu_time(now)
      self%is_stopping = self%is_stopping .or. now - self%start > self%limit
      is_over = self%is_stopping
   end function is_over

   !> Keeps a time step.
   subroutine keep_step(self, step, steps, state, history, report)
      class(recorder_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(march_state_t), intent(in) :: history
      type(report_t), intent(in) :: report

      associate (unused => history)
      end associate
      if (step > 0) self%residual = max(self%residual, report%residual)
      if (.not. self%is_recording) return
      if (step == 0) then
         self%summary = summary_of(state)
         if (allocated(self%pressure)) deallocate (self%pressure)
         allocate (self%pressure(size(state%x), 0:steps), source=0.0_wp)
      else
         call keep_extremes(self%summary, summary_of(state))
      end if
      self%pressure(:, step) = state%pressure
   end subroutine keep_step

end module bench_measure

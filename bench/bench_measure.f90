!> Runs one job: the same contact solved many times in one process, timed by phase.
module bench_measure
   use bench_jobs, only: job_t
   use bench_recorder, only: largest_difference, record_steady, recorder_t, start_recorder
   use case_input, only: read_case
   use case_record, only: case_t
   use coarse_runs, only: run_farther
   use ehl_line_steady, only: solve_steady
   use error_bars, only: apply_error_bars, error_bars_t, new_error_bars
   use errors, only: error_t, fail, input_error
   use findings, only: findings_t
   use grid_estimates, only: take_coarser
   use iteration_report, only: phase_setup, phase_steady, phase_transient, report_t
   use kinds, only: wp
   use line_case, only: build_line_contact
   use line_contact, only: line_contact_t
   use line_hierarchy, only: line_hierarchy_t, new_hierarchy, pose_steady_problem
   use line_state, only: line_state_t
   use missing_value, only: not_known
   use resolution_choice, only: choose_resolution
   use solver_settings, only: solver_settings_t, time_settings_t
   use steady_target, only: solve_contact
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: measurement_t, measure

   !> Phases that are timed: setup, steady, transient, all.
   integer, parameter, public :: timed_phases = 4

   !> What came out of a job.
   type :: measurement_t
      type(report_t) :: report
      !> The first run, with its fields if asked for.
      type(recorder_t) :: first
      type(line_contact_t) :: contact
      !> Runs done.
      integer :: runs = 0
      !> Wall time of the runs by phase [s]: the least, the median, and what nine tenths stay below.
      real(wp), dimension(timed_phases) :: least = 0.0_wp, median = 0.0_wp, high = 0.0_wp
      !> Mean processor time of a run, planning included [s].
      real(wp) :: processor = 0.0_wp
      !> Largest difference in P to the reference; NaN without one.
      real(wp) :: difference = 0.0_wp
      !> Time that the kernel products (FFT pairs) of the steady solution take [s]; NaN if not asked
      !> for.
      real(wp) :: product_seconds = 0.0_wp
   end type measurement_t

   !> Calls in one measurement of a kernel product, and measurements; the least one counts.
   integer, parameter :: product_calls = 20, product_batches = 10

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
      integer :: phase, run

      call read_case(job%text, job%name, case, findings)
      if (findings%count > 0) then
         call fail(error, input_error, findings%report(job%name))
         return
      end if
      call build_line_contact(case, outcome%contact)
      allocate (times(job%runs, timed_phases))
      start = wall_seconds()
      call cpu_time(processor_start)
      do run = 1, job%runs
         call run_once(job, case, run == 1, outcome, times(run, :), error)
         if (allocated(error)) return
         outcome%runs = run
         if (wall_seconds() - start > job%seconds) exit
      end do
      call cpu_time(processor_end)
      outcome%processor = (processor_end - processor_start)/outcome%runs
      outcome%least = minval(times(:outcome%runs, :), 1)
      do phase = 1, timed_phases
         outcome%median(phase) = quantile(times(:outcome%runs, phase), 0.5_wp)
         outcome%high(phase) = quantile(times(:outcome%runs, phase), 0.9_wp)
      end do
      call compare_fields(job, reference, outcome)
      outcome%product_seconds = not_known()
      if (job%shows_products) call measure_products(case, outcome, error)
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
      type(recorder_t) :: watcher
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
      call start_recorder(watcher, is_first .and. (job%is_reference .or. job%is_compared &
         .or. case%time%is_transient), job%limit)
      start = wall_seconds()
      settings = case%solver
      settings%target = case%accuracy%target
      settings%wants_coarse_runs = job%has_bars
      if (case%accuracy%target > 0.0_wp .and. case%time%is_transient) then
         call choose_resolution(bars, contact, settings, time, watcher, error)
         if (allocated(error)) return
      end if
      call solve_contact(contact, settings, time, watcher, state, report, error)
      if (allocated(error)) return
      times = [report%phase_seconds(phase_setup), report%phase_seconds(phase_steady), &
         report%phase_seconds(phase_transient), &
         wall_seconds() - start]
      if (.not. is_first) return
      if (.not. case%time%is_transient) then
         call record_steady(watcher, state)
         watcher%residual = report%residual
         if (report%converged) then
            bars = new_error_bars(contact, time, settings%space_scheme)
            call take_coarser(bars, watcher%coarser)
            if (job%has_bars) call run_farther(bars, contact, settings, watcher, error)
            if (allocated(error)) return
            call apply_error_bars(bars, report, state%x(2) - state%x(1), watcher%summary)
         end if
      end if
      outcome%contact%domain = contact%domain
      outcome%report = report
      outcome%first = watcher
   end subroutine run_once

   !> Difference to the reference, and the new reference.
   subroutine compare_fields(job, reference, outcome)
      type(job_t), intent(in) :: job
      real(wp), allocatable, intent(inout) :: reference(:, :)
      type(measurement_t), intent(inout) :: outcome

      outcome%difference = not_known()
      if (job%is_compared .and. allocated(reference) .and. allocated(outcome%first%pressure)) then
         outcome%difference = largest_difference(outcome%first%pressure, reference)
      end if
      if (job%is_reference .and. allocated(outcome%first%pressure)) reference = &
         outcome%first%pressure
   end subroutine compare_fields

   !> Time of the kernel products of the steady solution: their number on each level times the time
   !> of one, measured here.
   subroutine measure_products(case, outcome, error)
      type(case_t), intent(in) :: case
      type(measurement_t), intent(inout) :: outcome
      type(error_t), allocatable, intent(out) :: error
      type(line_hierarchy_t) :: hierarchy
      type(line_contact_t) :: contact
      type(recorder_t) :: watcher
      type(report_t) :: report
      real(wp) :: start
      real(wp) :: least
      integer :: batch, call, k, products

      contact = outcome%contact
      call new_hierarchy(hierarchy, contact, case%solver%levels, error)
      if (allocated(error)) return
      call pose_steady_problem(hierarchy, contact, with_roughness=.true.)
      call start_recorder(watcher, .false., huge(1.0_wp))
      call solve_steady(hierarchy, contact, case%solver, watcher, report)
      outcome%product_seconds = 0.0_wp
      do k = 1, hierarchy%top
         associate (level => hierarchy%levels(k))
            products = level%products
            least = huge(1.0_wp)
            do batch = 1, product_batches
               start = wall_seconds()
               do call = 1, product_calls
                  call level%convolution%apply(level%state%pressure, level%deflection)
               end do
               least = min(least, (wall_seconds() - start)/product_calls)
            end do
            outcome%product_seconds = outcome%product_seconds + products*least
         end associate
      end do
   end subroutine measure_products

   !> What the share `part` (0 to 1) of the values stays below, linear between two of them.
   pure function quantile(values, part) result(bound)
      real(wp), intent(in) :: values(:), part
      real(wp) :: bound
      real(wp) :: sorted(size(values)), place, value
      integer :: i, j

      sorted = values
      do i = 2, size(values)
         value = sorted(i)
         j = i - 1
         shift: do while (j >= 1)
            if (sorted(j) <= value) exit shift
            sorted(j + 1) = sorted(j)
            j = j - 1
         end do shift
         sorted(j + 1) = value
      end do
      place = 1 + part*(size(values) - 1)
      i = min(int(place), max(size(values) - 1, 1))
      j = min(i + 1, size(values))
      bound = sorted(i) + (place - i)*(sorted(j) - sorted(i))
   end function quantile

end module bench_measure

!> The solution of a lubricated case, with the coarse runs that measure its errors, and what the
!> program has chosen in place of the user, for the list of effective values of its result.
module line_solution
   use case_notes, only: hour, note_case, note_missed_error, time_text
   use case_record, only: case_t, list_passage, set_effective
   use error_bars, only: copy_coarser, new_error_bars
   use errors, only: error_t
   use experiment, only: copy_side_runs, make_side_runs, side_runs_t
   use film_heating, only: friction_doubt
   use grid_comparison, only: check_ends, solve_with_coarse_runs
   use iteration_report, only: phase_error_bars, report_t
   use kinds, only: wp
   use line_state, only: all_finite, line_state_t
   use adequacy, only: model_choice_t, number_choice_t
   use measured_adequacy, only: full_cost
   use passage_times, only: new_passage_times, passage_times_t
   use quantities, only: heated_rows
   use text, only: number_text, to_text
   use resolution_choice, only: choose_resolution, settle_tolerance
   use run_observer, only: run_observer_t
   use wall_clock, only: wall_seconds
   use wave_resolution, only: nodes_in_wave, steps_in_wave
   implicit none (type, external)
   private

   public :: solve_line_case

contains

   !> The case and its coarse runs, after it unless they choose its grid or are made beside it.
   subroutine solve_line_case(case, listener, state, report, error)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: words
      type(side_runs_t), allocatable :: side_runs
      real(wp) :: seconds, start

      if (all([case%time%is_transient, case%output_settings%adequacy == 'full', &
         .not. allocated(case%duty)])) call listener%log%say(case%file// &
         ": adequacy = 'full' takes up to "//to_text(full_cost(case%contact), 2)// &
         ' times what the passage takes')
      seconds = 0.0_wp
      listener%writer%run%passage%times = new_passage_times(case%contact, case%time)
      listener%has_coarse_runs = case%solver%wants_coarse_runs
      if (allocated(case%time%resume_from)) then
         call restore_resolution(case, listener)
      else if (case%solver%target > 0.0_wp .and. case%time%is_transient) then
         start = wall_seconds()
         listener%is_trial = .true.
         call choose_resolution(case%contact, case%solver, case%time, side_runs, listener)
         call move_alloc(listener%error, error)
         if (allocated(error) .or. listener%is_stopping) return
         listener%is_trial = .false.
         seconds = wall_seconds() - start
         if (allocated(side_runs%whole)) then
            seconds = seconds - side_runs%whole%report%cost%wall_seconds
         else
            call listener%writer%forget_steps()
         end if
      end if
      words = time_text(case, hour)
      if (words /= '') call listener%log%say(case%file//': '//words)
      call note_case(case, case%contact, listener)
      listener%writer%run%intervals = case%contact%domain%intervals
      listener%writer%run%time_step = case%time%time_step
      listener%writer%run%space_scheme = case%solver%space_scheme
      call solve_with_coarse_runs(case, side_runs, listener, state, report, error)
      if (allocated(error)) return
      associate (bars => listener%writer%bars)
         bars%spike_law%fluid = case%contact%fluid
         if (listener%has_coarse_runs) bars = new_error_bars(case%contact, case%time, &
            case%solver%space_scheme)
         bars%left_out = listener%writer%choice%influence
         if (allocated(case%contact%heating)) bars%left_out(heated_rows) = max( &
            bars%left_out(heated_rows), friction_doubt(merge(2, 1, case%contact%heating%has_flow)))
      end associate
      report%fit%nodes_per_wave = nodes_in_wave(case%contact)
      report%fit%steps_per_wave = steps_in_wave(case%contact, case%time)
      call look_at_solution(listener, state, report)
      if (allocated(case%time%resume_from)) deallocate (case%time%resume_from)
      if (listener%has_coarse_runs .and. report%converged) then
         start = wall_seconds()
         call make_side_runs(side_runs, listener)
         call copy_side_runs(side_runs, listener%writer%bars, error)
         if (allocated(error)) return
         seconds = seconds + wall_seconds() - start
         report%converged = .not. listener%is_stopping
      end if
      call check_ends(case, listener, report)
      call move_alloc(listener%error, error)
      if (allocated(error)) return
      if (case%solver%target > 0.0_wp) call note_missed_error(case, listener, &
         listener%writer%quantities_at_end(state, report), report)
      call fill_chosen(case, report, listener%writer%run%passage%times)
      call fill_numbers(case, report, listener%writer%choice)
      associate (phases => report%cost%phase_seconds)
         phases(phase_error_bars) = phases(phase_error_bars) + seconds
      end associate
   end subroutine solve_line_case

   !> Grid, time step and scheme of the run that this one goes on with.
   subroutine restore_resolution(case, listener)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: listener

      case%time%time_step = listener%writer%run%time_step
      associate (times => listener%writer%run%passage%times)
         do while (times%end_time < (case%time%resume_from%steps - 0.5_wp)*case%time%time_step)
            times = times%lengthened()
         end do
      end associate
      if (listener%writer%run%intervals > 0) case%contact%domain%intervals = &
         listener%writer%run%intervals
      case%solver%space_scheme = listener%writer%run%space_scheme
      call settle_tolerance(case%solver)
   end subroutine restore_resolution

   !> One that is not finite counts as not converged. Errors of a graded grid are known; coarser
   !> grids that a steady solution has passed need not be run any more.
   subroutine look_at_solution(listener, state, report)
      type(run_observer_t), intent(inout) :: listener
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report

      if (report%converged .and. .not. all_finite(state)) then
         report%converged = .false.
         report%reason = 'the solution holds values that are not finite'
      end if
      if (allocated(listener%grid_errors)) then
         listener%writer%bars%grid_errors = listener%grid_errors
         listener%has_coarse_runs = .false.
      end if
      if (.not. (listener%has_coarse_runs .and. allocated(listener%coarser))) return
      if (size(listener%coarser) < 2) return
      call copy_coarser(listener%writer%bars, listener%coarser)
      listener%has_coarse_runs = .false.
   end subroutine look_at_solution

   !> Lists what the program has chosen in place of the user among the effective values, with the
   !> `times` that count and where the surfaces began; 0: not used by the method.
   subroutine fill_chosen(case, report, times)
      type(case_t), intent(inout) :: case
      type(report_t), intent(in) :: report
      type(passage_times_t), intent(in) :: times

      associate (domain => case%contact%domain)
         call set_effective(case, 'domain', 'grid', text=trim(merge('graded', domain%grid(:6), &
            domain%has_tail)))
         call set_effective(case, 'domain', 'x_inlet', [domain%x_inlet])
         call set_effective(case, 'domain', 'x_outlet', [domain%x_outlet])
         call set_effective(case, 'domain', 'intervals', integer=domain%intervals)
      end associate
      call list_passage(case, case%contact, times)
      call set_effective(case, 'solver', 'space_scheme', text=trim(merge('kappa  ', 'upwind2', &
         case%solver%space_scheme == 'kappa')))
      call set_effective(case, 'solver', 'levels', integer=report%numbers%levels)
      call set_effective(case, 'solver', 'tolerance', [report%numbers%tolerance])
      call set_effective(case, 'solver', 'max_cycles', integer=report%numbers%max_cycles)
      call set_effective(case, 'solver', 'pre_sweeps', integer=report%numbers%pre_sweeps)
      call set_effective(case, 'solver', 'post_sweeps', integer=report%numbers%post_sweeps)
      call set_effective(case, 'solver', 'coarse_sweeps', integer=report%numbers%coarse_sweeps)
      call set_effective(case, 'solver', 'relaxation', [report%numbers%relaxation])
      call set_effective(case, 'solver', 'load_relaxation', [report%numbers%load_relaxation])
   end subroutine fill_chosen

   !> Grid, domain, time step and method of a `case` with model = 'auto': its target chooses grid
   !> and time step, the rest may be given.
   pure subroutine fill_numbers(case, report, choice)
      type(case_t), intent(in) :: case
      type(report_t), intent(in) :: report
      type(model_choice_t), intent(inout) :: choice
      character(:), allocatable :: method
      character(len=12) :: ends

      if (case%model /= 'auto') return
      method = 'none'
      if (allocated(report%method)) method = report%method
      ends = 'chosen'
      if (case%domain%has_inlet) ends = 'inlet given'
      if (case%domain%has_outlet) ends = 'outlet given'
      if (case%domain%has_inlet .and. case%domain%has_outlet) ends = 'given'
      associate (domain => case%contact%domain)
         choice%numbers = [number_choice_t('grid', 'grid', 'chosen', &
            number_text(real(domain%intervals, wp), 9)//trim(merge(' elements ', ' intervals', &
            domain%grid == 'graded'))), &
            number_choice_t('domain', 'domain', ends, number_text(domain%x_inlet, 3) &
            //' to '//number_text(domain%x_outlet, 3)), &
            number_choice_t('method', 'iteration', trim(merge('chosen', 'given ', &
            case%solver%method == 'auto')), method)]
      end associate
      if (case%time%is_transient) choice%numbers = [choice%numbers(:2), &
         number_choice_t('time_step', '', 'chosen', 'dT '//number_text(case%time%time_step, 4)), &
         choice%numbers(3)]
   end subroutine fill_numbers

end module line_solution

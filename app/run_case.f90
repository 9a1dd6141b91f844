!> One case from its record to its result file and its exit status.
module run_case
   use adequacy, only: accuracy_for
   use breakdown_text, only: breakdown_sentence
   use case_limits, only: judge_limits
   use case_notes, only: note_unusual, tell, tell_coarse_waves, tell_missed_target, tell_unusual
   use case_outcome, only: case_outcome_t, give_up, status_converged, status_not_converged
   use case_record, only: case_t, result_path, set_effective
   use chosen_values, only: fill_chosen, fill_numbers, fill_passage
   use coarse_runs, only: companions_t
   use command_line, only: command_t
   use decision_section, only: solved_text
   use domain_choice, only: choose_domain, reopen
   use error_bars, only: error_bars_t, new_error_bars
   use errors, only: error_t
   use film_heating, only: new_heating
   use film_momentum, only: follow_momentum, prepare_momentum
   use film_velocity, only: velocity_profile
   use grid_check, only: check_grid
   use grid_comparison, only: check_forecast, compare_grids
   use iteration_report, only: phase_adequacy, phase_error_bars, phase_output, phase_transient, &
      report_t
   use key_row, only: lubricated
   use kinds, only: wp
   use line_case, only: build_line_contact, scaled_solver
   use line_contact, only: line_contact_t
   use line_state, only: all_finite, line_state_t
   use line_summary, only: summary_of
   use measured_adequacy, only: measure_adequacy
   use model_choice, only: choose_model
   use model_decision, only: take_model
   use outlet_check, only: check_ends
   use own_passages, only: own_runs_t
   use passage_pairs, only: scene_t
   use passage_times, only: new_passage_times, passage_note
   use progress_log, only: new_progress_log, progress_log_t
   use resolution_choice, only: choose_resolution, settle_tolerance
   use result_end, only: finish_result, suspend_result
   use result_start, only: find_complete_result, start_result
   use run_dry_case, only: solve_and_write
   use run_observer, only: run_observer_t
   use side_by_side, only: solve_beside
   use signals, only: begin_activity, begin_subject
   use wall_clock, only: wall_seconds
   use wave_resolution, only: choose_time_step, nodes_in_wave, steps_in_wave
   use xdmf_file, only: write_xdmf
   implicit none (type, external)
   private

   public :: run_one_case

contains

   !> Solves `case` as `command` says: folder of the results, whether to go on from a checkpoint,
   !> whether to tell progress.
   subroutine run_one_case(case, command, outcome)
      type(case_t), intent(inout) :: case
      type(command_t), intent(in) :: command
      type(case_outcome_t), intent(out) :: outcome
      type(progress_log_t) :: log
      type(error_t), allocatable :: error
      character(:), allocatable :: path, reason
      logical :: is_complete, is_converged

      log = new_progress_log(command%is_quiet, command%has_outcomes)
      call begin_subject(case%file)
      call begin_activity('looking at earlier results')
      path = result_path(case, command%output_dir)
      is_complete = .false.
      if (command%is_resume) call find_complete_result(path, case, is_complete, is_converged, &
         reason, error)
      if (allocated(error)) then
         call give_up(error, log, outcome)
         return
      end if
      if (is_complete) then
         if (is_converged) then
            call log%say(case%file//': '//path//' is complete: nothing to do')
         else
            call log%say_error(case%file//': '//path//' is there, NOT CONVERGED: '//reason// &
               '; without --resume it is computed again')
            outcome = case_outcome_t(status_not_converged, reason)
         end if
         return
      end if
      call tell_unusual(case, log)
      if (case%problem == lubricated) then
         call run_lubricated_case(case, path, command%is_resume, command%threads, log, outcome)
      else
         call solve_and_write(case, path, log, command%threads, outcome)
      end if
      if (case%has_xdmf .and. any(outcome%status == [status_converged, status_not_converged])) then
         call write_xdmf(path, error)
         if (allocated(error)) call give_up(error, log, outcome)
      end if
   end subroutine run_one_case

   !> Solves a lubricated case on at most so many `threads` and writes its result `path`.
   subroutine run_lubricated_case(case, path, is_resume, threads, log, outcome)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      logical, intent(in) :: is_resume
      integer, intent(in) :: threads
      type(progress_log_t), intent(in) :: log
      type(case_outcome_t), intent(out) :: outcome
      type(run_observer_t) :: watcher
      type(line_contact_t) :: contact, whole
      type(line_state_t) :: state
      type(report_t) :: report
      type(error_t), allocatable :: error

      watcher%log = log
      watcher%threads = threads
      watcher%scaling = case%scaling
      call build_line_contact(case, contact)
      whole = contact
      case%solver = scaled_solver(case)
      watcher%film_floor = case%solver%film_floor
      call watcher%log%start_case(case%file, watcher%scaling)
      call check_grid(case, contact, error)
      if (.not. allocated(error)) then
         call watcher%start_clock()
         call start_result(case, path, is_resume, watcher, error)
      end if
      if (.not. allocated(error)) then
         watcher%writer%heating = new_heating(watcher%scaling, case%bodies, &
            case%materials%effusivity, case%materials%conductivity)
         call prepare_momentum(case, watcher)
         call take_lean_model(case, contact, watcher, error)
         if (.not. allocated(error)) call solve(case, contact, watcher, state, report, error)
         if (.not. allocated(error)) call look_at_model(case, contact, watcher, state, report, &
            error)
         if (.not. allocated(error)) call follow_momentum(case, contact, watcher, state, report, &
            error)
         if (allocated(error)) call watcher%writer%discard()
      end if
      if (allocated(error)) then
         call give_up(error, watcher%log, outcome)
      else if (watcher%wants_stop .and. .not. report%converged &
         .and. .not. watcher%writer%has_failed()) then
         call suspend_result(watcher, outcome)
      else
         whole%domain = contact%domain
         call judge_limits(case, whole, state, report, watcher)   ! with all of its roughness
         if (case%output_settings%velocity_layers > 0 .and. allocated(state%shear_stress_mean)) then
            watcher%writer%velocity = velocity_profile(contact%fluid, contact%lambda, &
               contact%slide_to_roll, state%x, state%pressure, state%film_thickness, &
               case%output_settings%velocity_layers)
         end if
         call finish_result(case, watcher, state, report, outcome)
      end if
   end subroutine run_lubricated_case

   !> Makes `contact` and the times of a case with model = 'auto' those of the leanest model that is
   !> adequate. A run that goes on from a checkpoint is a passage, and stays one; and so does one
   !> whose film is to be counted over time.
   subroutine take_lean_model(case, contact, watcher, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(inout) :: contact
      type(run_observer_t), intent(inout) :: watcher
      type(error_t), allocatable, intent(out) :: error

      if (case%model /= 'auto') return
      associate (choice => watcher%writer%choice)
         call choose_model(scene_t(contact, case%solver, case%time), case%accuracy%target, &
            allocated(case%time%resume_from) .or. size(case%output_settings%film_thresholds) > 0, &
            choice, watcher, error)
         if (allocated(error) .or. .not. choice%is_steady) return
         call take_model(choice, contact, case%time)
         call reopen(contact%domain)
         call choose_domain(contact, case%accuracy%target)
         call watcher%log%say(case%file//': solves '//solved_text(choice))
      end associate
      call set_effective(case, 'time', 'transient', '.false.')
   end subroutine take_lean_model

   !> The case itself and its coarse runs, which come after it unless they choose its grid, or are
   !> made beside it on another thread.
   subroutine solve(case, contact, watcher, state, report, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(inout) :: contact
      type(run_observer_t), intent(inout) :: watcher
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: note
      type(companions_t), allocatable :: companions
      type(error_bars_t) :: bars
      real(wp) :: seconds
      logical :: is_open

      seconds = 0.0_wp
      watcher%writer%passage%times = new_passage_times(contact, case%time)
      case%solver%target = case%accuracy%target
      case%solver%target_p_max = case%accuracy%target_p_max
      case%solver%wants_coarse_runs = case%accuracy%has_error_bars
      ! the solver chooses the grid
      is_open = case%accuracy%target > 0.0_wp .and. .not. case%time%is_transient
      watcher%has_coarse_runs = case%accuracy%has_error_bars &
         .and. (is_open .or. .not. case%accuracy%target > 0.0_wp)
      if (allocated(case%time%resume_from)) then
         if (case%accuracy%target > 0.0_wp) then   ! as before pilot runs chose the rest
            bars = new_error_bars(contact, case%time, case%solver%space_scheme)
            bars%unseen = ''
            bars%forecast = watcher%writer%bars%forecast
            watcher%writer%bars = bars
         end if
         if (watcher%intervals > 0) contact%domain%intervals = watcher%intervals
         case%time%time_step = watcher%time_step
         case%solver%space_scheme = watcher%space_scheme
         call settle_tolerance(case%solver)
      else if (case%accuracy%target > 0.0_wp .and. case%time%is_transient) then
         call choose_grid(case, contact, watcher, seconds, error)
         if (allocated(error) .or. watcher%wants_stop) return
      end if
      call choose_time_step(contact, case%time)
      if (watcher%has_coarse_runs) watcher%writer%bars = new_error_bars(contact, case%time, &
         case%solver%space_scheme)
      watcher%writer%bars%left_out = watcher%writer%choice%influence
      call note_unusual(case, note)
      call tell(case, watcher, case%note, note)
      call tell_coarse_waves(case, contact, watcher, note)
      call tell_missed_target(case, contact, watcher, note)
      call tell(case, watcher, passage_note(contact, watcher%writer%passage%times), note)
      watcher%intervals = contact%domain%intervals
      watcher%time_step = case%time%time_step
      watcher%space_scheme = case%solver%space_scheme
      call solve_beside(contact, case, companions, watcher, state, report, error)
      if (allocated(error)) return
      report%nodes_per_wave = nodes_in_wave(contact)
      report%steps_per_wave = steps_in_wave(contact, case%time)
      call move_alloc(note, report%note)
      call refuse_nonsense(state, report)
      if (allocated(case%time%resume_from)) deallocate (case%time%resume_from)
      if (watcher%has_coarse_runs .and. report%converged) then
         call compare_grids(case, contact, watcher, companions, seconds, error)
         if (allocated(error)) return
         report%converged = .not. watcher%wants_stop
      end if
      call check_ends(case, contact, watcher, report, error)
      if (allocated(error)) return
      call check_forecast(case, contact, watcher, state, report, seconds, &
         error)   ! error: the caller looks
      call fill_chosen(case, contact, report)
      call fill_numbers(case, contact, report, watcher%writer%choice)
      call fill_passage(case, contact, watcher%writer%passage%times)
      call complete_report(watcher, seconds, report)
   end subroutine solve

   !> Intervals and time step for the accuracy that is wanted of a transient, by pilot runs, and the
   !> `seconds` that they took. Error: memory or a library failed.
   subroutine choose_grid(case, contact, watcher, seconds, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(inout) :: contact
      type(run_observer_t), intent(inout) :: watcher
      real(wp), intent(out) :: seconds
      type(error_t), allocatable, intent(out) :: error
      type(error_bars_t) :: bars
      real(wp) :: start

      start = wall_seconds()
      call choose_resolution(bars, contact, case%solver, case%time, watcher, &
         error)   ! error: the caller looks
      watcher%writer%bars = bars
      seconds = wall_seconds() - start
   end subroutine choose_grid

   !> Measures what the ingredients of the model change, where that is wanted.
   subroutine look_at_model(case, contact, watcher, state, report, error)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(in) :: contact
      type(run_observer_t), intent(inout) :: watcher
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: start

      if (.not. (case%output_settings%has_adequacy .and. report%converged)) return
      start = wall_seconds()
      associate (writer => watcher%writer)
         call measure_adequacy(scene_t(contact, case%solver, case%time), state, &
            own_runs_t(writer%passage%extremes(summary_of(state)), real(report%cycles, wp), &
            writer%bars), &
            accuracy_for(case%accuracy%target, writer%quantities_at_end(state, report)), &
            writer%adequacy, watcher, error)
      end associate
      if (allocated(error)) return
      report%converged = .not. watcher%wants_stop
      report%phase_seconds(phase_adequacy) = wall_seconds() - start
   end subroutine look_at_model

   !> Completes the report by what the solver does not know: a film breakdown in SI, the times of
   !> separate coarse runs and of output.
   subroutine complete_report(watcher, seconds, report)
      type(run_observer_t), intent(in) :: watcher
      real(wp), intent(in) :: seconds
      type(report_t), intent(inout) :: report

      if (index(report%reason, 'film breakdown') == 1 &
         .and. watcher%scaling%is_dimensional) report%reason = &
         breakdown_sentence(report%breakdown, watcher%film_floor, watcher%scaling)
      associate (phases => report%phase_seconds)
         phases(phase_error_bars) = phases(phase_error_bars) + seconds
         phases(phase_output) = watcher%output_seconds
         phases(phase_transient) = max(phases(phase_transient) - watcher%output_seconds, 0.0_wp)
      end associate
   end subroutine complete_report

   !> A solution that is not finite counts as not converged.
   subroutine refuse_nonsense(state, report)
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report

      if (.not. report%converged .or. all_finite(state)) return
      report%converged = .false.
      report%reason = 'the solution holds values that are not finite'
   end subroutine refuse_nonsense

end module run_case

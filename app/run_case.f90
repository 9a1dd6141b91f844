!> One case from its record to its result file and its exit status.
module run_case
   use breakdown_text, only: breakdown_sentence
   use case_memory, only: lubricated_memory
   use case_outcome, only: give_up, status_converged, status_interrupted, status_not_converged, &
      status_not_written
   use case_record, only: case_t, result_path, set_effective
   use command_line, only: command_t
   use companions, only: run_apart, run_companions
   use domain_choice, only: choose_domain, inlet_error
   use error_bars, only: domain_error, error_bars_t, new_error_bars
   use errors, only: error_t, fail, input_error
   use features, only: rough_surface_t
   use interruption, only: take_last_words
   use iteration_report, only: phase_error_bars, phase_output, phase_transient, report_t
   use key_row, only: lubricated
   use kinds, only: wp
   use life_sign, only: begin_activity, begin_subject
   use line_case, only: build_line_contact, scaled_solver
   use line_contact, only: line_contact_t
   use line_state, only: all_finite, line_state_t
   use outlet_check, only: check_ends
   use passage_times, only: new_passage_times, passage_note, passage_times_t
   use profile, only: profile_length
   use progress_log, only: new_progress_log
   use quantities, only: h_min
   use resolution_choice, only: choose_resolution, settle_tolerance
   use result_start, only: find_complete_result, start_result
   use run_dry_case, only: solve_and_write
   use run_observer, only: run_observer_t
   use scaling, only: scaling_t
   use solver_settings, only: most_intervals_of, most_refined_intervals, time_settings_t
   use steady_target, only: solve_contact
   use system_limits, only: memory_fault
   use text, only: to_text
   use wall_clock, only: wall_seconds
   use wave_resolution, only: choose_time_step, coarse_waves, nodes_in_wave, steps_in_wave
   implicit none (type, external)
   private

   public :: run_one_case

   !> Relative excess of a forecast over the target that counts as rounding.
   real(wp), parameter :: rounding = 1.0e-6_wp

contains

   !> Solves `case` as `command` says: folder of the results, whether to go on from a checkpoint,
   !> whether to tell progress.
   subroutine run_one_case(case, command, status)
      type(case_t), intent(inout) :: case
      type(command_t), intent(in) :: command
      integer, intent(out) :: status
      type(run_observer_t) :: watcher
      type(line_contact_t) :: contact
      type(line_state_t) :: state
      type(report_t) :: report
      type(scaling_t) :: scaling
      type(error_t), allocatable :: error
      character(:), allocatable :: path
      logical :: is_complete, is_converged

      watcher%log = new_progress_log(command%is_quiet)
      call begin_subject(case%file)
      call begin_activity('looking at earlier results')
      path = result_path(case, command%output_dir)
      if (command%is_resume) then
         call find_complete_result(path, case, is_complete, is_converged, error)
         if (allocated(error)) then
            call give_up(error, watcher%log, status)
            return
         end if
         if (is_complete) then
            call watcher%log%say(case%file//': '//path//' is complete: nothing to do')
            status = merge(status_converged, status_not_converged, is_converged)
            return
         end if
      end if
      if (case%problem /= lubricated) then
         call solve_and_write(case, command%output_dir, command%is_quiet, command%threads, status)
         return
      end if
      call build_line_contact(case, scaling, contact)
      case%solver = scaled_solver(case, scaling)
      call watcher%log%start_case(case%file, scaling)
      call check_grid(case, contact, error)
      if (allocated(error)) then
         call give_up(error, watcher%log, status)
         return
      end if
      watcher%film_floor = case%solver%film_floor
      watcher%scaling = scaling
      call watcher%start_clock()
      call start_result(case, path, command%is_resume, scaling, watcher, error)
      if (allocated(error)) then
         call give_up(error, watcher%log, status)
         return
      end if
      call solve(case, contact, watcher, state, report, error)
      if (allocated(error)) then
         call watcher%writer%discard()
         call give_up(error, watcher%log, status)
      else if (watcher%wants_stop .and. .not. report%converged &
         .and. .not. watcher%writer%has_failed()) then
         call suspend(watcher, status)
      else
         call store(case, watcher, state, report, status)
      end if
   end subroutine run_one_case

   !> Determines for how many intervals there is memory. Error: the grid that the program will
   !> choose is too fine for the method, or for the memory.
   subroutine check_grid(case, contact, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(in) :: contact
      type(error_t), allocatable, intent(out) :: error
      type(line_contact_t) :: whole
      character(:), allocatable :: fault

      whole = contact
      call choose_domain(whole)
      associate (intervals => whole%domain%intervals, method => case%solver%method)
         fault = fault_of(intervals)
         if (intervals > most_intervals_of(method)) fault = 'found '//to_text(intervals) &
            //' intervals, which the program '// &
            'chooses, expected at most '//to_text(most_intervals_of(method))//" with method = '" &
               //trim(method)//"'"
      end associate
      if (fault /= '') call fail(error, input_error, case%file//': &domain intervals: '//fault)
      associate (most => case%solver%most_intervals)
         most = most_refined_intervals
         do while (most > whole%domain%intervals .and. fault_of(most) /= '')
            most = most/2
         end do
      end associate

   contains

      !> What is wrong with the memory that a grid needs.
      function fault_of(intervals) result(fault)
         integer, intent(in) :: intervals
         character(:), allocatable :: fault
         type(line_contact_t) :: own
         type(time_settings_t) :: time
         real(wp) :: steps

         own = whole
         own%domain%intervals = intervals
         time = case%time
         call choose_time_step(own, time)
         steps = 0.0_wp
         if (time%is_transient) steps = time%end_time/time%time_step
         fault = memory_fault('a grid', lubricated_memory(intervals, steps, &
            case%solver%method == 'newton_dense'))
      end function fault_of

   end subroutine check_grid

   !> The case itself and its companions on coarser grids, which come after it unless they choose
   !> its grid.
   subroutine solve(case, contact, watcher, state, report, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(inout) :: contact
      type(run_observer_t), intent(inout) :: watcher
      type(line_state_t), intent(out) :: state
      type(report_t), intent(out) :: report
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: note
      type(error_bars_t) :: bars
      type(line_contact_t) :: open, whole
      real(wp) :: seconds
      logical :: is_open

      seconds = 0.0_wp
      open = contact
      watcher%writer%figures%times = new_passage_times(contact, case%time)
      case%solver%target = case%accuracy%target
      case%solver%wants_companions = case%accuracy%has_error_bars
      ! the solver chooses the grid
      is_open = case%accuracy%target > 0.0_wp .and. .not. case%time%is_transient
      watcher%has_companions = case%accuracy%has_error_bars &
         .and. (is_open .or. .not. case%accuracy%target > 0.0_wp)
      if (allocated(case%time%resume_from)) then
         if (case%accuracy%target > 0.0_wp) then   ! as before pilot runs chose the rest
            bars = new_error_bars(contact, case%time, case%solver%space_scheme)
            bars%forecast = watcher%writer%bars%forecast
            watcher%writer%bars = bars
         end if
         contact%domain%intervals = watcher%intervals
         case%time%time_step = watcher%time_step
         case%solver%space_scheme = watcher%space_scheme
         call settle_tolerance(case%solver)
      else if (case%accuracy%target > 0.0_wp .and. case%time%is_transient) then
         call compare_grids(case, contact, watcher, seconds, error)
         if (allocated(error) .or. watcher%wants_stop) return
      end if
      whole = contact
      call choose_domain(whole, case%solver%target)
      call choose_time_step(whole, case%time)
      if (watcher%has_companions) watcher%writer%bars = new_error_bars(whole, case%time, &
         case%solver%space_scheme)
      call tell_coarse_waves(case, contact, watcher, note)
      call tell_missed_target(case, contact, watcher, note)
      call tell(case, watcher, passage_note(contact, watcher%writer%figures%times), note)
      watcher%intervals = contact%domain%intervals
      watcher%time_step = case%time%time_step
      watcher%space_scheme = case%solver%space_scheme
      call solve_contact(contact, case%solver, case%time, watcher, state, report, error)
      if (allocated(error)) return
      report%nodes_per_wave = nodes_in_wave(contact)
      report%steps_per_wave = steps_in_wave(contact, case%time)
      call move_alloc(note, report%note)
      call refuse_nonsense(state, report)
      if (allocated(case%time%resume_from)) deallocate (case%time%resume_from)
      if (watcher%has_companions .and. report%converged) then
         call compare_grids(case, contact, watcher, seconds, error)
         if (allocated(error)) return
         report%converged = .not. watcher%wants_stop
      end if
      call check_forecast(case, whole, watcher, report, seconds, error)
      if (allocated(error)) return
      call check_ends(case, open, contact, watcher, report, error)   ! error: the caller looks
      call fill_chosen(case, contact, report)
      call fill_passage(case, contact, watcher%writer%figures%times)
      call complete_report(watcher, seconds, report)
   end subroutine solve

   !> Completes the report by what the solver does not know: a film breakdown in SI, the times of
   !> separate companions and of output.
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

   !> Says where grid or time step are too coarse for the waves of the surfaces; `note` then says it
   !> too, else it stays unallocated. With a wanted accuracy both are chosen by their effect on
   !> h_min.
   subroutine tell_coarse_waves(case, contact, watcher, note)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(in) :: contact
      type(run_observer_t), intent(inout) :: watcher
      character(:), allocatable, intent(inout) :: note
      type(line_contact_t) :: whole
      character(:), allocatable :: words

      if (case%accuracy%target > 0.0_wp) return
      whole = contact
      call choose_domain(whole)
      words = coarse_waves(whole, case%time)
      if (len(words) == 0) return
      call watcher%log%say(case%file//': '//words)
      call move_alloc(words, note)
   end subroutine tell_coarse_waves

   !> Says where pilot runs do not foretell that a transient keeps its wanted accuracy, behind what
   !> `note` says already.
   subroutine tell_missed_target(case, contact, watcher, note)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(in) :: contact
      type(run_observer_t), intent(inout) :: watcher
      character(:), allocatable, intent(inout) :: note
      character(:), allocatable :: words
      real(wp) :: foretold

      if (.not. (case%accuracy%target > 0.0_wp .and. case%time%is_transient)) return
      words = 'no error of h_min is foretold: pilot runs on coarser grids found no solution'
      associate (forecast => watcher%writer%bars%forecast)
         if (forecast%is_known) then
            foretold = forecast%error(h_min)/forecast%pilot(h_min)
            if (.not. case%domain%has_inlet) foretold = foretold &
               + domain_error(inlet_error(contact))
            if (foretold <= (1.0_wp + rounding)*case%accuracy%target) return
            words = 'the wanted accuracy is beyond the finest pilot run: of h_min a relative '// &
               'error of '//to_text(foretold, 2)// &
               ' is foretold, '//to_text(case%accuracy%target, 2)//' was wanted'
         end if
      end associate
      call tell(case, watcher, words, note)
   end subroutine tell_missed_target

   !> Says `words`, if there are any, and puts them behind what `note` says already.
   subroutine tell(case, watcher, words, note)
      type(case_t), intent(in) :: case
      type(run_observer_t), intent(inout) :: watcher
      character(*), intent(in) :: words
      character(:), allocatable, intent(inout) :: note

      if (words == '') return
      call watcher%log%say(case%file//': '//words)
      if (allocated(note)) then
         note = note//'; '//words
      else
         note = words
      end if
   end subroutine tell

   !> Writes the result.
   subroutine store(case, watcher, state, report, status)
      type(case_t), intent(inout) :: case
      type(run_observer_t), intent(inout) :: watcher
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      integer, intent(out) :: status
      type(error_t), allocatable :: error

      watcher%writer%inputs = case%effective
      call watcher%writer%finish(state, report, error)
      if (allocated(error)) then
         if (watcher%writer%name%has_checkpoint) error%message = error%message &
            //'; --resume goes on after step '// &
            to_text(watcher%checkpoint_step)
         call give_up(error, watcher%log, status)
         return
      end if
      call watcher%log%close_case(watcher%writer%summary, report, watcher%writer%name%path, &
         watcher%writer%figures%times)
      status = merge(status_converged, status_not_converged, report%converged)
   end subroutine store

   !> The end of an interrupted run: the files needed to go on are kept and named.
   subroutine suspend(watcher, status)
      type(run_observer_t), intent(inout) :: watcher
      integer, intent(out) :: status
      character(:), allocatable :: words

      status = status_interrupted
      if (allocated(watcher%failure)) status = status_not_written
      words = watcher%writer%name%interruption_text(watcher%checkpoint_step)
      call take_last_words()
      call watcher%log%say_error(words)
      if (watcher%writer%name%has_checkpoint) then
         call watcher%writer%suspend()
      else
         call watcher%writer%discard()
      end if
   end subroutine suspend

   !> Companions on coarser grids; with a target, intervals and time step too.
   subroutine compare_grids(case, contact, watcher, seconds, error)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(inout) :: contact
      type(run_observer_t), intent(inout) :: watcher
      real(wp), intent(out) :: seconds
      type(error_t), allocatable, intent(out) :: error
      type(error_bars_t) :: bars
      real(wp) :: start

      start = wall_seconds()
      if (case%time%is_transient .and. case%accuracy%target > 0.0_wp) then
         call choose_resolution(bars, contact, case%solver, case%time, watcher, &
            error)   ! error: the caller looks
      else
         call run_companions(bars, contact, case%solver, case%time, watcher, &
            error)   ! error: the caller looks
      end if
      watcher%writer%bars = bars
      seconds = wall_seconds() - start
   end subroutine compare_grids

   !> Companions of a solution whose `contact` has a grid, and whose time step is one, that pilots
   !> chose: is it as good as they foretold?
   subroutine check_forecast(case, contact, watcher, report, seconds, error)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(in) :: contact
      type(run_observer_t), intent(inout) :: watcher
      type(report_t), intent(inout) :: report
      real(wp), intent(inout) :: seconds
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: start

      if (.not. (case%accuracy%has_error_bars .and. watcher%writer%bars%forecast%is_known &
         .and. report%converged)) return
      start = wall_seconds()
      call run_apart(watcher%writer%bars, contact, case%solver, case%time, watcher, error)
      if (allocated(error)) return
      seconds = seconds + wall_seconds() - start
      report%converged = .not. watcher%wants_stop
   end subroutine check_forecast

   !> What the program has chosen in place of the user goes into the list of effective values; 0:
   !> not used by the method.
   subroutine fill_chosen(case, contact, report)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(in) :: contact
      type(report_t), intent(in) :: report

      call set_effective(case, 'domain', 'x_inlet', contact%domain%x_inlet)
      call set_effective(case, 'domain', 'inlet', trim(contact%domain%inlet))
      call set_effective(case, 'domain', 'x_outlet', contact%domain%x_outlet)
      call set_effective(case, 'domain', 'intervals', contact%domain%intervals)
      if (case%time%is_transient) call set_effective(case, 'time', 'time_step', case%time%time_step)
      call set_effective(case, 'solver', 'space_scheme', trim(merge('kappa  ', 'upwind2', &
         case%solver%space_scheme == 'kappa')))
      call set_effective(case, 'solver', 'levels', report%levels)
      call set_effective(case, 'solver', 'tolerance', report%tolerance)
      call set_effective(case, 'solver', 'max_cycles', report%max_cycles)
      call set_effective(case, 'solver', 'pre_sweeps', report%pre_sweeps)
      call set_effective(case, 'solver', 'post_sweeps', report%post_sweeps)
      call set_effective(case, 'solver', 'coarse_sweeps', report%coarse_sweeps)
      call set_effective(case, 'solver', 'relaxation', report%relaxation)
      call set_effective(case, 'solver', 'load_relaxation', report%load_relaxation)
   end subroutine fill_chosen

   !> The same of the times that count, and of where the surfaces began.
   subroutine fill_passage(case, contact, times)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(in) :: contact
      type(passage_times_t), intent(in) :: times

      if (case%time%is_transient) call set_effective(case, 'time', 'statistics_from', &
         times%counts_from)
      call fill_positions(case, 'surface_1', contact%surface_1, has_free_profile(case%surface_1))
      call fill_positions(case, 'surface_2', contact%surface_2, has_free_profile(case%surface_2))
   end subroutine fill_passage

   !> The centres of the features of one surface, or of a profile that the program has placed.
   subroutine fill_positions(case, group, surface, has_placed_profile)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(rough_surface_t), intent(in) :: surface
      logical, intent(in) :: has_placed_profile

      if (size(surface%features) > 0) call set_effective(case, group, 'position', &
         surface%features%position)
      if (has_placed_profile) call set_effective(case, group, 'position', &
         surface%profile%start + 0.5_wp*profile_length(surface%profile))
   end subroutine fill_positions

   !> Whether a surface has a profile whose place is left to the program.
   pure function has_free_profile(surface)
      type(rough_surface_t), intent(in) :: surface
      logical :: has_free_profile

      has_free_profile = allocated(surface%profile)
      if (has_free_profile) has_free_profile = .not. surface%profile%is_placed
   end function has_free_profile

   !> A solution that is not finite counts as not converged.
   subroutine refuse_nonsense(state, report)
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report

      if (.not. report%converged .or. all_finite(state)) return
      report%converged = .false.
      report%reason = 'the solution holds values that are not finite'
   end subroutine refuse_nonsense

end module run_case

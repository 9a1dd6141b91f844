!> Chooses grid and time step of a transient for a target accuracy of h_min.
!>
!> Trial runs separate the errors of grid and time step (module grid_errors). The first uses the
!> coarsest grid that carries a film and dT <= dX; each further one halves the spacing or the time
!> step, whichever leaves the larger uncertainty. As soon as a resolution up to four times finer
!> than the last trial run (two times without an observed order) is predicted to meet the target,
!> the cheapest such resolution is chosen, and the actual run is made once. A trial run costs at
!> most `max_work` times the nodes and steps of the first one; if the target is still not met, the
!> last resolution is used and its prediction states the error. Trial runs use the kappa scheme,
!> which errs less, unless the user asks for another one or only upwind2 finds a solution. A
!> prediction of the kappa scheme is trusted only after the last trial run has been repeated with
!> upwind2.
!>
!> Where load, radius or speeds change, an error estimate divides the steps: grid and steps are
!> refined together, and the error bars come from coarser runs of the result.
!>
!> `make accuracy-time` measures how often the target is met and at what cost; docs/decisions.md
!> lists the alternatives tried.
module resolution_choice
   use domain_choice, only: inlet_error
   use error_bars, only: error_bars_t, new_error_bars
   use errors, only: error_t, fail, input_error
   use inlet_errors, only: domain_error
   use experiment, only: coarser, experiment_t, new_experiment, outcome_t, run_experiment
   use grid_errors, only: error_in_time, predicted_values
   use kinds, only: exceeds, not_known, wp
   use line_contact, only: leaves_scheme, line_contact_t, max_chosen, solver_settings_t, &
      time_settings_t
   use listener, only: listener_t
   use trials, only: add_other_scheme, add_trial, begun_anew, cheapest_resolution, forecast_at, &
      has_forecast, new_trials, next_direction, nothing, trials_t, refined, resolution_t
   use quantities, only: h_min, quantity_count
   use text, only: to_text
   implicit none (type, external)
   private

   public :: choose_resolution, settle_tolerance

   !> Bounds on the tolerance of time steps, its share of the target, and the factor for trial runs.
   real(wp), parameter :: tightest = 1.0e-6_wp, loosest = 1.0e-3_wp, &
      tolerance_fraction = 0.1_wp, looser = 10.0_wp
   !> Largest nodes times steps of a trial run, over those of the first.
   real(wp), parameter :: max_work = 2.0_wp**14
   !> An error of grid and steps falls at least by this factor when both are halved.
   real(wp), parameter :: least_fall = 2.0_wp
   !> Most intervals over the usual ones of a contact with a duty.
   integer, parameter :: most_finer = 16

   !> State of the search.
   type :: search_t
      !> The next trial run, apart from its resolution.
      type(experiment_t) :: trial
      !> Whether upwind2 may be tried if it finds no solution.
      logical :: may_change_scheme = .false.
      !> What the next trial run refines.
      integer :: direction = nothing
      !> Results so far, the last one, and the largest nodes times steps of the next.
      type(trials_t) :: trials
      type(outcome_t) :: last
      real(wp) :: work_limit = 0.0_wp
   end type search_t

contains

   !> Sets a missing tolerance of time steps from the target, if there is one.
   pure subroutine settle_tolerance(settings)
      type(solver_settings_t), intent(inout) :: settings

      if (settings%target <= 0.0_wp .or. settings%tolerance > 0.0_wp) return
      settings%tolerance = min(max(tolerance_fraction*settings%target, tightest), loosest)
   end subroutine settle_tolerance

   !> Sets `contact%domain%intervals`, the time step, the tolerance and an unspecified space scheme
   !> of a transient to the cheapest choice predicted to keep the relative error of h_min below
   !> `settings%target`, else to the finest trial run; `bars` receive the predictions. Error
   !> (input_error): the coarsest trial run needs more intervals than allowed.
   subroutine choose_resolution(bars, contact, settings, time, listener, error)
      type(error_bars_t), intent(out) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(inout) :: settings
      type(time_settings_t), intent(inout) :: time
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(search_t) :: search
      type(resolution_t) :: chosen
      real(wp) :: target
      logical :: is_last

      bars = new_error_bars(contact, time, settings%space_scheme)
      bars%unseen = ''   ! of a grid that is not the one
      target = settings%target
      if (contact%domain%inlet_is_chosen) target = target - domain_error(inlet_error(contact))
      search = new_search(contact, settings, time)
      call settle_tolerance(settings)
      if (allocated(contact%duty)) then
         call choose_intervals(new_experiment(contact, settings, time), target &
            - settings%tolerance, max_chosen(settings), contact%domain%intervals, listener, &
            error)   ! error: the caller looks
         return
      end if
      associate (first => search%trials%last%intervals, most => search%trials%max_intervals)
         if (first > most) call fail(error, input_error, '&domain intervals: found a contact '// &
            'whose coarsest trial run has '//to_text(first)//', expected at most '// &
            to_text(most)//" with method = '"//trim(settings%method)//"' and this memory")
      end associate
      if (allocated(error)) return
      do
         call run_trial(search, listener, error)
         if (allocated(error)) return
         settings%space_scheme = search%trial%settings%space_scheme
         if (listener%is_stopping) return
         associate (last => search%trials%last)
            if (.not. search%last%is_known .and. 2*last%intervals &
               > search%trials%max_intervals) exit
            if (search%last%is_known) then
               call add_trial(search%trials, search%direction, &
                  predicted_values(search%last%summary), search%last%films)
            else   ! again, twice as fine
               search%trials = begun_anew(search%trials, resolution_t(2*last%intervals, &
                  2*last%steps))
            end if
            search%direction = next_direction(search%trials)
            ! another refinement is not allowed, or costs too much
            is_last = 2*last%intervals > search%trials%max_intervals &
               .or. 2.0_wp*last%intervals*last%steps > search%work_limit
         end associate
         chosen = cheapest_resolution(search%trials, target)
         if (chosen%intervals > 0 .or. is_last) then
            call run_other_scheme(search, listener, error)
            if (allocated(error)) return
            chosen = cheapest_resolution(search%trials, target)
         end if
         if (chosen%intervals > 0 .or. is_last) exit
      end do
      if (chosen%intervals == 0) chosen = search%trials%last
      contact%domain%intervals = chosen%intervals
      contact%domain%intervals_are_chosen = .false.
      time%time_step = time%end_time/chosen%steps
      bars%waves%time_step = time%time_step
      if (has_forecast(search%trials)) bars%forecast = forecast_at(search%trials, chosen)
   end subroutine choose_resolution

   !> Chooses the `intervals` of a contact with a duty, at most `most`: the first of trial runs on
   !> 1/8, 1/4, 1/2, 1 ... of the usual ones whose error of h_min is below `target`, or that twice
   !> as fine if its error surely is; the usual ones if a trial run has no solution.
   subroutine choose_intervals(usual, target, most, intervals, listener, error)
      type(experiment_t), intent(in) :: usual
      real(wp), intent(in) :: target
      integer, intent(in) :: most
      integer, intent(inout) :: intervals
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(experiment_t) :: next
      type(outcome_t) :: outcome
      real(wp) :: films(3), found
      integer :: factor

      films = not_known()
      next = usual
      factor = 8
      do
         call run_experiment(coarser(next, factor), listener, outcome, error)
         if (allocated(error) .or. .not. outcome%is_known) return
         films = [outcome%summary%of(h_min)%between, films(:2)]
         factor = factor/2
         if (factor > 1) cycle
         factor = 2
         found = error_in_time(films)/films(1)
         if (exceeds(least_fall*target, found) .or. 2*next%contact%domain%intervals > min(most, &
            most_finer*usual%contact%domain%intervals)) exit
         next%contact%domain%intervals = 2*next%contact%domain%intervals
         next%time%time_step = 0.5_wp*next%time%time_step
         next%time%tolerance = next%time%tolerance/8
      end do
      intervals = next%contact%domain%intervals/merge(2, 1, found <= target)
   end subroutine choose_intervals

   !> Prepares the first trial run of a contact on a complete domain: kappa if no scheme is given,
   !> with a looser tolerance than the actual run.
   function new_search(contact, settings, time) result(search)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(time_settings_t), intent(in) :: time
      type(search_t) :: search
      type(solver_settings_t) :: settled

      search%trial = new_experiment(contact, settings, time)
      search%may_change_scheme = leaves_scheme(settings)
      if (search%may_change_scheme) search%trial%settings%space_scheme = 'kappa'
      settled = settings
      call settle_tolerance(settled)
      if (settings%tolerance <= 0.0_wp) search%trial%settings%tolerance = looser*settled%tolerance
      search%trials = new_trials(contact, time, max_chosen(settings))
      associate (first => search%trials%last)
         search%work_limit = max_work*first%intervals*first%steps
      end associate
   end function new_search

   !> Makes the next trial run. Without a solution it is repeated with upwind2, if allowed; if that
   !> succeeds, the search starts again from here with upwind2.
   subroutine run_trial(search, listener, error)
      type(search_t), intent(inout) :: search
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(resolution_t) :: resolution

      resolution = refined(search%trials%last, search%direction)
      associate (trial => search%trial)
         trial%contact%domain%intervals = resolution%intervals
         trial%time%time_step = trial%time%end_time/resolution%steps
         call run_experiment(trial, listener, search%last, error)
         if (allocated(error)) return
         if (search%last%is_known .or. .not. search%may_change_scheme &
            .or. listener%is_stopping) return
         trial%settings%space_scheme = 'upwind2'
         call run_experiment(trial, listener, search%last, error)
         if (allocated(error)) return
         if (search%last%is_known) then
            search%may_change_scheme = .false.
            search%trials = begun_anew(search%trials, resolution)
            search%direction = nothing
         else
            trial%settings%space_scheme = 'kappa'
         end if
      end associate
   end subroutine run_trial

   !> Repeats the last trial run with upwind2, if that is not known on its grid: changes of the
   !> kappa scheme may be small although it still errs.
   subroutine run_other_scheme(search, listener, error)
      type(search_t), intent(inout) :: search
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(experiment_t) :: other
      type(outcome_t) :: outcome
      real(wp) :: values(quantity_count)

      if (search%trial%settings%space_scheme /= 'kappa' .or. listener%is_stopping) return
      if (search%trials%is_difference_known .or. .not. has_forecast(search%trials)) return
      other = search%trial
      other%settings%space_scheme = 'upwind2'
      call run_experiment(other, listener, outcome, error)
      if (allocated(error)) return
      values = not_known()
      if (outcome%is_known) values = predicted_values(outcome%summary)
      call add_other_scheme(search%trials, values)
   end subroutine run_other_scheme

end module resolution_choice

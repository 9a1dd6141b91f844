!> Chooses grid and time step of a transient for a target accuracy of h_min.
!>
!> Trial runs become finer until they predict a resolution that meets the target (docs/theory.md,
!> error estimates). Where a wanted accuracy is beyond the largest trial run, twice its resolution
!> is taken. `bench/targets.py` measures how often the target is met and at what cost.
module resolution_choice
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use domain_choice, only: inlet_error
   use error_bars, only: film_safety
   use errors, only: fail, input_error
   use experiment, only: experiment_t, min_intervals, new_experiment, new_side_runs, outcome_t, &
      run_experiment, side_runs_t, solution_t
   use grid_errors, only: error_in_time, observed_order
   use kinds, only: wp
   use line_contact, only: intervals_for_waves, line_contact_t, max_chosen, &
      solver_settings_t, time_settings_t
   use line_hierarchy, only: coarsest_for_film
   use line_summary, only: value_between
   use listener, only: listener_t
   use quantities, only: h_min
   use text, only: to_text
   use wave_resolution, only: choose_time_step
   implicit none (type, external)
   private

   public :: choose_resolution, settle_tolerance

   !> Bounds on the tolerance of time steps, and its share of the target.
   real(wp), parameter :: tightest = 1.0e-6_wp, loosest = 1.0e-3_wp, tolerance_fraction = 0.1_wp
   !> Largest nodes times steps of a trial run over those of the first.
   real(wp), parameter :: max_work = 2.0_wp**14
   !> Resolutions between two trial runs, over the coarser one, and bounds of the order by which an
   !> error falls from one to the next.
   real(wp), parameter :: finer(*) = [1.0_wp, 1.25_wp, 1.5_wp, 1.75_wp, 2.0_wp], &
      orders(2) = [1.0_wp, 1.5_wp]

contains

   !> Sets a missing tolerance of time steps from the target, if there is one.
   pure subroutine settle_tolerance(settings)
      type(solver_settings_t), intent(inout) :: settings

      if (settings%target <= 0.0_wp .or. settings%tolerance > 0.0_wp) return
      settings%tolerance = min(max(tolerance_fraction*settings%target, tightest), loosest)
   end subroutine settle_tolerance

   !> Sets `contact%domain%intervals`, the time step and the tolerance of a transient to the
   !> coarsest choice predicted to keep the relative error of h_min below `settings%target`, else to
   !> twice the finest trial run. `side_runs`: its coarse runs and the run itself, known if trial
   !> runs were that; the listener receives the steps of those that may be the run, and an error
   !> (input_error) if the coarsest trial run needs more intervals than allowed.
   subroutine choose_resolution(contact, settings, time, side_runs, listener)
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(inout) :: settings
      type(time_settings_t), intent(inout) :: time
      type(side_runs_t), allocatable, intent(out) :: side_runs
      class(listener_t), intent(inout), target :: listener
      type(experiment_t) :: next
      type(outcome_t) :: tried(3)   ! the last one first
      type(solution_t), allocatable :: solution
      real(wp) :: ratio, target, work_limit
      integer :: most

      target = settings%target
      if (contact%domain%inlet_is_chosen) target = target - film_safety &
         *inlet_error(contact)
      call settle_tolerance(settings)
      target = target - settings%tolerance
      most = max_chosen(settings)
      next = first_trial(new_experiment(contact, settings, time))
      if (next%contact%domain%intervals > most) then
         call fail(listener%error, input_error, '&domain intervals: found a contact whose '// &
            'coarsest trial run has '//to_text(next%contact%domain%intervals)//', expected at '// &
            'most '//to_text(most)//" with method = '"//trim(settings%method)//"' and this memory")
         return
      end if
      work_limit = max_work*work_of(next)
      if (.not. (allocated(contact%duty) .or. allocated(listener%follower) &
         .or. settings%film_floor > 0.0_wp .or. settings%levels > 0)) allocate (solution)
      do
         tried(2:) = tried(:2)
         call run_experiment(next, listener, tried(1), solution)
         if (listener%is_stopping) return
         ratio = refinement_for(tried, target)
         associate (n => next%contact%domain%intervals)
            if (ratio <= finer(size(finer)) .or. 2*n > most .or. 4*work_of(next) > work_limit) exit
         end associate
         next = times_finer(next, 2.0_wp)
      end do
      contact%domain%intervals_are_chosen = .false.
      ratio = min(ratio, 2.0_wp)
      if (ratio*next%contact%domain%intervals > most) ratio = 1.0_wp
      next = times_finer(next, ratio)
      contact%domain%intervals = next%contact%domain%intervals
      ! with a duty an error estimate divides the usual steps
      if (allocated(contact%duty)) next%time%time_step = min(time%time_step, next%time%time_step)
      time%time_step = next%time%time_step
      side_runs = new_side_runs(new_experiment(contact, settings, time))
      call take_trials(side_runs, ratio, tried, solution)
   end subroutine choose_resolution

   !> Takes over those of the last three trial runs that are coarse runs of a run `ratio` times as
   !> fine as the last, and the last, with its `solution`, if it is that run.
   subroutine take_trials(side_runs, ratio, tried, solution)
      type(side_runs_t), intent(inout) :: side_runs
      real(wp), intent(in) :: ratio
      type(outcome_t), intent(in) :: tried(3)
      type(solution_t), allocatable, intent(inout) :: solution

      ! with a duty trial runs have other tolerances
      if (modulo(ratio, 1.0_wp) > 0.0_wp .or. allocated(side_runs%experiment%contact%duty)) return
      associate (domain => side_runs%experiment%contact%domain, k => nint(ratio))
         if (side_runs%experiment%time%scheme /= 'backward_euler') side_runs%runs = &
            tried(3 - k:4 - k)
         if (k > 1 .or. .not. (allocated(solution) .and. tried(1)%is_known)) return
         solution%contact%domain = domain
         ! an outlet that cuts the film off moves out
         if (solution%report%fit%outlet_pressure > 0.0_wp .and. domain%may_lengthen) return
      end associate
      call move_alloc(solution, side_runs%whole)
   end subroutine take_trials

   !> The first trial run: the fewest intervals that carry the film and have two nodes in the finest
   !> wave, and dT <= dX; with a duty an eighth of the usual intervals and steps, or as few as carry
   !> the film of its mean.
   pure function first_trial(usual) result(first)
      type(experiment_t), intent(in) :: usual
      type(experiment_t) :: first
      real(wp) :: length
      integer :: n

      first = usual
      associate (contact => usual%contact, domain => usual%contact%domain)
         length = domain%x_outlet - domain%x_inlet
         n = coarsest_for_film(contact, min_intervals)
         do while (8*n < intervals_for_waves(contact))
            n = 2*n
         end do
         if (allocated(contact%duty)) then
            do while (16*n <= domain%intervals)
               n = 2*n
            end do
            first = times_finer(usual, real(n, wp)/domain%intervals)
         else
            first%contact%domain%intervals = n
            first%time%time_step = usual%time%end_time/max(2, ceiling(usual%time%end_time*n/length))
         end if
      end associate
   end function first_trial

   !> The same on `ratio` times the intervals with as many times shorter steps.
   pure function times_finer(self, ratio) result(finer)
      type(experiment_t), intent(in) :: self
      real(wp), intent(in) :: ratio
      type(experiment_t) :: finer

      finer = self
      finer%contact%domain%intervals = nint(ratio*self%contact%domain%intervals)
      finer%time%time_step = self%time%time_step/ratio
      call choose_time_step(finer%contact, finer%time)
      finer%time%tolerance = self%time%tolerance/ratio**3
   end function times_finer

   !> Nodes times steps of a trial run.
   pure real(wp) function work_of(self) result(work)
      type(experiment_t), intent(in) :: self

      work = self%contact%domain%intervals*self%time%end_time/self%time%time_step
   end function work_of

   !> How many times finer than the first of `tried` a run meets `target`, one of `finer`; huge: not
   !> known, or more.
   pure real(wp) function refinement_for(tried, target) result(ratio)
      type(outcome_t), intent(in) :: tried(3)
      real(wp), intent(in) :: target
      real(wp) :: films(3), found, order
      integer :: k

      ratio = huge(ratio)
      if (.not. all(tried%is_known)) return
      films = [(value_between(tried(k)%summary, h_min), k=1, 3)]
      if (.not. all(ieee_is_finite(films))) return
      found = error_in_time(films)/films(1)
      order = observed_order(films(1), films(2), films(3), orders)
      if ((films(1) - films(2))*(films(2) - films(3)) <= 0.0_wp) order = orders(1)
      ratio = minval(finer, found <= target*finer**order)   ! of none huge
   end function refinement_for

end module resolution_choice

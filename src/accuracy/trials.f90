!> Predicts from coarse trial runs of a transient which resolution meets a target.
module trials
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use grid_errors, only: doubts_at, error_at, forecast_t, kappa_share, least_doubt_at, &
      new_split_error, orders_in_time, shift_at, split_error_t
   use kinds, only: not_known, wp
   use line_contact, only: intervals_for_waves, line_contact_t, min_in_wave, shortest_passage, &
      time_settings_t
   use line_hierarchy, only: coarsest_for_film
   use quantities, only: h_min, is_chance, quantity_count, quantity_rows
   implicit none (type, external)
   private

   public :: add_other_scheme, add_trial, begun_anew, cheapest_resolution, forecast_at, &
      has_forecast, new_trials, next_direction, trials_t, refined, resolution_t

   !> What the next trial run refines.
   integer, parameter, public :: nothing = 0, space = 1, time_step = 2

   !> Fewest intervals of the first trial run; its time step is at most the spacing of `first_steps`
   !> intervals.
   integer, parameter :: min_intervals = 16, first_steps = 32
   !> Predictions reach up to this many times finer than the last trial run, without and with an
   !> observed order.
   real(wp), parameter :: reaches(2) = [2.0_wp, 4.0_wp]
   !> Candidates are these numbers of intervals times a power of two, and these powers of two times
   !> the steps of the last trial run.
   integer, parameter :: families(4) = [4, 5, 6, 7], doublings = 2, max_parts = 8
   real(wp), parameter :: part = 0.25_wp
   !> Fewest intervals in the finest wave, of the first trial run and of the choice, and fewest
   !> steps in which that wave moves by its own length.
   integer, parameter :: trial_in_wave = 2, nodes_in_wave = 4, steps_in_wave = 4
   !> A single change by the time step is trusted from this many steps a passage of the wave.
   integer, parameter :: believed_steps = 8
   !> After this many refinements in one direction the other one is refined.
   integer, parameter :: max_in_a_row = 2
   !> Tolerance on whole numbers of steps.
   real(wp), parameter :: rounding = 1.0e-6_wp
   !> Cost grows as n steps^power: shorter steps need fewer cycles.
   real(wp), parameter :: power_of_steps = 0.65_wp
   !> Trial runs are compared at all times at which the smallest film exceeds its minimum by at most
   !> this fraction.
   real(wp), parameter :: nearly_least = 0.2_wp

   !> Intervals and time steps.
   type :: resolution_t
      integer :: intervals = 0, steps = 0
   end type resolution_t

   !> Results of the trial runs so far.
   type :: trials_t
      !> Resolution of the last one; before the first, the resolution of that.
      type(resolution_t) :: last
      !> Quantities of the last one; NaN: not known.
      real(wp) :: values(quantity_count) = 0.0_wp
      !> The last and the previous change, by spacing and by time step; NaN: not known.
      real(wp) :: changes(quantity_count, 2, 2) = 0.0_wp
      !> |upwind2 - kappa| on the grid of the last one, if known.
      real(wp) :: difference(quantity_count) = 0.0_wp
      logical :: is_difference_known = .false.
      !> Size of the changes of h_min over time (last, previous; by spacing, by time step); 0: not
      !> known.
      real(wp) :: sizes(2, 2) = 0.0_wp
      !> Smallest film of the last one at each time step (0:steps); not allocated: none yet.
      real(wp), allocatable :: films(:)
      !> Trial runs since spacing and time step were last refined; negative: never.
      integer :: age(2) = -1
      !> Passages of the finest wave within the end time.
      real(wp) :: passages = 0.0_wp
      !> Intervals that resolve every wave, and most intervals allowed.
      integer :: for_waves = 1, max_intervals = 0
      !> Assumed order in time, and the bounds of an observed one.
      real(wp) :: time_orders(3) = [1.0_wp, 1.5_wp, 2.0_wp]
   end type trials_t

contains

   !> Starts the search for a contact on a complete domain.
   pure function new_trials(contact, time, max_intervals) result(trials)
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      integer, intent(in) :: max_intervals
      type(trials_t) :: trials

      trials%max_intervals = max_intervals
      trials%for_waves = intervals_for_waves(contact)
      trials%passages = time%end_time/shortest_passage(contact)
      trials%time_orders = orders_in_time(time%scheme)
      associate (n => trials%last%intervals, length => contact%domain%x_outlet &
         - contact%domain%x_inlet)
         n = coarsest_for_film(contact, min_intervals)
         do while (min_in_wave*n < trial_in_wave*trials%for_waves)
            n = 2*n
         end do
         trials%last%steps = max(2, ceiling(time%end_time*max(n, first_steps)/length))
      end associate
   end function new_trials

   !> Discards all trial runs and starts again from `first`.
   pure function begun_anew(trials, first) result(anew)
      type(trials_t), intent(in) :: trials
      type(resolution_t), intent(in) :: first
      type(trials_t) :: anew

      anew = trials_t(first, passages=trials%passages, for_waves=trials%for_waves, &
         max_intervals=trials%max_intervals, time_orders=trials%time_orders)
   end function begun_anew

   !> Doubles the intervals or the steps.
   pure function refined(resolution, direction) result(finer)
      type(resolution_t), intent(in) :: resolution
      integer, intent(in) :: direction
      type(resolution_t) :: finer

      finer = resolution
      if (direction == space) finer%intervals = 2*finer%intervals
      if (direction == time_step) finer%steps = 2*finer%steps
   end function refined

   !> Adds a trial run on twice the resolution of the last one in `direction`: its quantities and
   !> the smallest films at its time steps.
   pure subroutine add_trial(trials, direction, values, films)
      type(trials_t), intent(inout) :: trials
      integer, intent(in) :: direction
      real(wp), intent(in) :: values(quantity_count), films(0:)

      if (direction == nothing) then
         trials%changes = not_known()
         trials%sizes = 0.0_wp
      else
         if (direction == space) then
            trials%difference = 0.0_wp
            trials%is_difference_known = .false.
         end if
         trials%changes(:, 2, direction) = trials%changes(:, 1, direction)
         trials%changes(:, 1, direction) = values - trials%values
         trials%sizes(2, direction) = trials%sizes(1, direction)
         trials%sizes(1, direction) = size_of_change(trials%films, &
            films(::merge(2, 1, direction == time_step)))
         where (trials%age >= 0) trials%age = trials%age + 1
         trials%age(direction) = 0
      end if
      trials%last = refined(trials%last, direction)
      trials%values = values
      trials%films = films
   end subroutine add_trial

   !> Adds the quantities of the upwind2 scheme at the resolution of the last trial run, which used
   !> kappa; NaN: no solution.
   pure subroutine add_other_scheme(trials, values)
      type(trials_t), intent(inout) :: trials
      real(wp), intent(in) :: values(quantity_count)

      trials%is_difference_known = .true.
      trials%difference = 0.0_wp
      where (ieee_is_finite(values)) trials%difference = abs(values - trials%values)
   end subroutine add_other_scheme

   !> Root mean square of the relative change between smallest films at the same times, over the
   !> times at which the film is nearly smallest, times that film. The minimum alone may change
   !> little by chance when a wave passes between nodes.
   pure function size_of_change(old, new) result(change)
      real(wp), intent(in) :: old(:), new(:)
      real(wp) :: change, least

      least = minval(new)
      associate (near => new <= (1.0_wp + nearly_least)*least)
         change = least*sqrt(sum(((new - old)/new)**2, near)/count(near))
      end associate
   end function size_of_change

   !> What to refine next: the direction never or long not refined, else the one with the larger
   !> uncertainty at the end of the prediction.
   pure integer function next_direction(trials) result(direction)
      type(trials_t), intent(in) :: trials
      real(wp) :: reach(2), doubts(2)

      if (.not. allocated(trials%films)) then
         direction = nothing
      else if (trials%age(space) < 0) then
         direction = space
      else if (trials%age(time_step) < 0 .or. .not. sees_passages(trials)) then
         direction = time_step
      else if (any(trials%age >= max_in_a_row)) then
         direction = maxloc(trials%age, 1)
      else
         reach = reach_of(trials)
         doubts = doubts_at(error_of(trials, h_min), 1.0_wp/reach(space), 1.0_wp/reach(time_step))
         direction = merge(space, time_step, doubts(space) > doubts(time_step))
      end if
   end function next_direction

   !> Whether the time step is understood: its order is observed, or waves pass in many steps.
   pure logical function sees_passages(trials)
      type(trials_t), intent(in) :: trials

      sees_passages = ieee_is_finite(trials%changes(h_min, 2, time_step)) &
         .or. trials%last%steps >= believed_steps*trials%passages
   end function sees_passages

   !> Errors of one row of the table of quantities.
   pure function error_of(trials, row) result(error)
      type(trials_t), intent(in) :: trials
      integer, intent(in) :: row
      type(split_error_t) :: error
      real(wp) :: sizes(2, 2)

      sizes = 0.0_wp
      if (row == h_min) sizes = trials%sizes
      error = new_split_error(trials%changes(row, :, space), trials%changes(row, :, time_step), &
         trials%time_orders, sizes)
      if (is_chance(quantity_rows(row))) error%least_doubt = kappa_share/(1.0_wp - kappa_share) &
         *trials%difference(row)
   end function error_of

   !> How many times finer than the last trial run predictions reach, in space and in time.
   pure function reach_of(trials) result(reach)
      type(trials_t), intent(in) :: trials
      real(wp) :: reach(2)

      reach = merge(reaches(2), reaches(1), ieee_is_finite(trials%changes(h_min, 2, :)))
   end function reach_of

   !> Whether predictions are possible: both directions have been refined.
   pure logical function has_forecast(trials)
      type(trials_t), intent(in) :: trials

      has_forecast = all(trials%age >= 0)
   end function has_forecast

   !> Predicts all quantities at a resolution.
   pure function forecast_at(trials, resolution) result(forecast)
      type(trials_t), intent(in) :: trials
      type(resolution_t), intent(in) :: resolution
      type(forecast_t) :: forecast
      type(split_error_t) :: error
      real(wp) :: dx_ratio, dt_ratio
      integer :: i

      dx_ratio = real(trials%last%intervals, wp)/resolution%intervals
      dt_ratio = real(trials%last%steps, wp)/resolution%steps
      forecast%is_known = .true.
      forecast%trial = trials%values
      do i = 1, quantity_count
         error = error_of(trials, i)
         forecast%error(i) = error_at(error, dx_ratio, dt_ratio)
         forecast%trial_error(i) = error_at(error, 1.0_wp, 1.0_wp)
         forecast%shift(i) = shift_at(error, dx_ratio, dt_ratio)
         forecast%least_doubt(i) = least_doubt_at(error, dx_ratio)
      end do
   end function forecast_at

   !> The cheapest resolution whose predicted relative error of h_min is at most `target`; 0
   !> intervals if none is within reach or nothing can be predicted yet.
   pure function cheapest_resolution(trials, target) result(cheapest)
      type(trials_t), intent(in) :: trials
      real(wp), intent(in) :: target
      type(resolution_t) :: cheapest, candidate
      type(split_error_t) :: error
      real(wp) :: min_cost, cost, reach(2)
      integer :: i

      if (.not. has_forecast(trials)) return
      if (.not. sees_passages(trials)) return
      error = error_of(trials, h_min)
      reach = reach_of(trials)
      min_cost = huge(1.0_wp)
      do i = 0, size(families)*doublings
         ! one to four times the intervals of the trial run
         candidate%intervals = trials%last%intervals/4*families(1 + modulo(i, size(families))) &
            *2**(i/size(families))
         if (min_in_wave*candidate%intervals < nodes_in_wave*trials%for_waves &
            .or. candidate%intervals > trials%max_intervals .or. real(trials%last%intervals, wp) &
            /candidate%intervals*reach(space) < 1.0_wp) cycle
         candidate%steps = steps_needed(trials, error, candidate%intervals, &
            target*trials%values(h_min))
         if (candidate%steps == 0) cycle
         cost = candidate%intervals/(real(trials%last%steps, wp)/candidate%steps)**power_of_steps
         if (cost >= min_cost) cycle
         min_cost = cost
         cheapest = candidate
      end do
   end function cheapest_resolution

   !> The fewest steps on this grid whose predicted error is at most `bound`; 0: none.
   pure integer function steps_needed(trials, error, intervals, bound) result(steps)
      type(trials_t), intent(in) :: trials
      type(split_error_t), intent(in) :: error
      integer, intent(in) :: intervals
      real(wp), intent(in) :: bound
      real(wp) :: reach(2), dx_ratio, dt_ratio, max_ratio
      integer :: i

      reach = reach_of(trials)
      dx_ratio = real(trials%last%intervals, wp)/intervals
      max_ratio = trials%last%steps/max(steps_in_wave*trials%passages, 1.0_wp)
      do i = 0, max_parts
         ! whole numbers of steps
         steps = ceiling(trials%last%steps*2.0_wp**(part*i) - rounding)
         dt_ratio = real(trials%last%steps, wp)/steps
         if (dt_ratio*reach(time_step) < 1.0_wp) exit
         if (dt_ratio <= max_ratio .and. error_at(error, dx_ratio, dt_ratio) <= bound) return
      end do
      steps = 0
   end function steps_needed

end module trials

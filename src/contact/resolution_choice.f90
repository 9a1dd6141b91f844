!> Grid and time step of a transient for a wanted accuracy of h_min.
!>
!> Pilot runs, each on twice the intervals of the one before and with dT = dX or a little less (all end at the same time), tell the
!> errors of grid and of time step apart (module split_errors). As soon as these foretell a resolution within four times that of
!> the last pilot that is good enough, the cheapest one of these is taken: the run itself costs most, and nothing is run twice.
module resolution_choice
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use companions, only: collector_t, fewest_intervals, run_companion
   use domain_choice, only: choose_domain, inlet_error
   use error_bars, only: domain_error, error_bars_t, new_error_bars
   use errors, only: error_t
   use kinds, only: wp
   use line_contact, only: intervals_for_waves, line_contact_t, shortest_passage
   use line_hierarchy, only: coarsest_for_film, most_intervals
   use line_summary, only: line_summary_t
   use observer, only: observer_t
   use pressure_spike, only: is_calm
   use solver_settings, only: solver_settings_t, time_settings_t
   use split_errors, only: error_at, figure_values, forecast_figures, new_split_error, shift_at, split_error_t
   implicit none (type, external)
   private

   public :: choose_resolution, settle_tolerance

   !> Bounds of the tolerance of time steps, and its share of the wanted accuracy: at 1e-4 h_min was off by 7e-5 at most in 42
   !> passages on 64 to 512 intervals, and the run 12 to 20 % cheaper than at 1e-6.
   real(wp), parameter :: tightest = 1.0e-6_wp, loosest = 1.0e-4_wp, tolerance_share = 1.0e-2_wp
   !> Pilots need so much less.
   real(wp), parameter :: looser = 10.0_wp
   !> A resolution is foretold up to so many times that of a pilot, the first one where no orders have been observed yet.
   real(wp), parameter :: farthest(2) = [2.0_wp, 4.0_wp]
   !> dT over dX of what may be chosen.
   real(wp), parameter :: ratios(6) = [4.0_wp, 2.0_wp, 1.0_wp, 0.5_wp, 0.25_wp, 0.125_wp]
   !> Intervals that may be chosen are these times a power of two.
   integer, parameter :: families(4) = [4, 5, 6, 7], doublings = 3
   !> Steps at least in which the finest wave passes a place; its intervals in a pilot are those of `intervals_for_waves` over this.
   integer, parameter :: steps_in_wave = 4, wave_share = 4
   !> Whole numbers of steps are known to so much.
   real(wp), parameter :: rounding = 1.0e-6_wp
   !> The time of a run grows like n steps^power: shorter steps need fewer cycles.
   real(wp), parameter :: power_of_steps = 0.65_wp

   !> The runs on one pilot resolution.
   type :: pilots_t
      !> On (dX, dT), (2 dX, dT), (2 dX, 2 dT).
      type(line_summary_t) :: runs(3)
      logical :: is_known(3) = .false.
   end type pilots_t

contains

   !> The tolerance of the time steps follows from the wanted accuracy, if there is one, unless it is given.
   pure subroutine settle_tolerance(settings)
      type(solver_settings_t), intent(inout) :: settings

      if (settings%target <= 0.0_wp .or. settings%tolerance > 0.0_wp) return
      settings%tolerance = min(max(tolerance_share*settings%target, tightest), loosest)
   end subroutine settle_tolerance

   !> Sets `contact%domain%intervals`, the time step and the tolerance of a transient to the cheapest choice that is foretold to
   !> keep the relative error of h_min below `settings%target`; `bars` hold what was foretold of its figures.
   subroutine choose_resolution(bars, contact, settings, time, watcher, error)
      type(error_bars_t), intent(out) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(inout) :: settings
      type(time_settings_t), intent(inout) :: time
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(pilots_t) :: pilots, older
      type(line_contact_t) :: pilot
      type(solver_settings_t) :: pilot_settings
      real(wp) :: target
      integer :: n, steps

      bars = new_error_bars(contact, time)
      pilot_settings = settings
      call settle_tolerance(settings)
      if (pilot_settings%tolerance <= 0.0_wp) pilot_settings%tolerance = looser*settings%tolerance
      target = settings%target
      if (.not. contact%domain%has_inlet) then
         call choose_domain(contact, settings%target)
         target = target - domain_error(inlet_error(contact))
      end if
      pilot = contact
      call choose_domain(contact)
      call choose_domain(pilot)
      n = 2*max(coarsest_for_film(contact), fewest_intervals)
      do while (wave_share*n < intervals_for_waves(contact))
         n = 2*n
      end do
      steps = 2*ceiling(0.5_wp*time%end_time*n/(contact%domain%x_outlet - contact%domain%x_inlet))
      collector%watcher => watcher
      do
         older = pilots
         pilots%is_known = .false.
         pilots%is_known(3) = older%is_known(1)
         pilots%runs(3) = older%runs(1)
         if (.not. pilots%is_known(3)) call run_pilot(n/2, steps/2, 3)
         if (pilots%is_known(3)) call run_pilot(n/2, steps, 2)
         if (pilots%is_known(2)) call run_pilot(n, steps, 1)
         if (allocated(error) .or. watcher%wants_stop) return
         contact%domain%intervals = n
         time%time_step = time%end_time/steps
         if (all(pilots%is_known)) then
            call choose(bars, contact, time, pilots, older, target)
            if (contact%domain%intervals > 0) exit
         end if
         if (2*n > most_intervals) exit
         n = 2*n
         steps = 2*steps
      end do
      if (contact%domain%intervals <= 0) contact%domain%intervals = n

   contains

      !> Runs the case on `intervals` with so many time steps.
      subroutine run_pilot(intervals, pilot_steps, place)
         integer, intent(in) :: intervals, pilot_steps, place
         type(time_settings_t) :: pilot_time

         if (allocated(error) .or. watcher%wants_stop) return
         pilot%domain%intervals = intervals
         pilot_time = time
         pilot_time%time_step = time%end_time/pilot_steps
         call run_companion(pilot, pilot_settings, pilot_time, collector, pilots%is_known(place), error)   ! error: the caller looks
         pilots%runs(place) = collector%summary
      end subroutine run_pilot

   end subroutine choose_resolution

   !> Chooses the cheapest intervals and time step that are foretold to be good enough, with the forecast of all figures in
   !> `bars`; intervals 0 if there are none within reach. `contact` and `time` come with those of the finest pilot.
   subroutine choose(bars, contact, time, pilots, older, target)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(time_settings_t), intent(inout) :: time
      type(pilots_t), intent(in) :: pilots, older
      real(wp), intent(in) :: target
      type(split_error_t) :: errors(forecast_figures)
      real(wp) :: values(forecast_figures, 3), before(forecast_figures, 3), dx_ratio, dt_ratio, pilot_step
      integer :: best, i

      do i = 1, 3
         values(:, i) = figure_values(pilots%runs(i), .true.)
         before(:, i) = figure_values(older%runs(i), all(older%is_known))
      end do
      do i = 1, forecast_figures
         errors(i) = new_split_error(values(i, :), before(i, :), time_orders(time%scheme))
      end do
      call find_cheapest(errors(1), target*values(1, 1), merge(farthest(2), farthest(1), all(older%is_known)), contact, time, &
         best, dt_ratio)
      if (best > 0) then
         dx_ratio = real(contact%domain%intervals, wp)/best
         pilot_step = time%time_step
         time%time_step = time%end_time/ceiling(time%end_time/(dt_ratio*pilot_step) - rounding)
         dt_ratio = time%time_step/pilot_step
         associate (forecast => bars%forecast)
            forecast%is_known = .true.
            forecast%pilot = values(:, 1)
            do i = 1, forecast_figures
               forecast%error(i) = error_at(errors(i), dx_ratio, dt_ratio)
               forecast%pilot_error(i) = error_at(errors(i), 1.0_wp, 1.0_wp)
               forecast%shift(i) = shift_at(errors(i), dx_ratio, dt_ratio)
            end do
            ! of a pressure spike nothing is foretold
            if (bars%may_spike .and. ieee_is_finite(forecast%error(4))) then
               if (.not. is_calm(values(4, :))) forecast%error(4) = ieee_value(1.0_wp, ieee_quiet_nan)
            end if
         end associate
      end if
      contact%domain%intervals = best
   end subroutine choose

   !> The intervals `best` and the time step, `dt_ratio` times that of the pilot, that cost least among those whose foretold error
   !> is not above `bound`, not more than `reach` times finer than the pilot; 0 if there are none. `contact` and `time` are those
   !> of the pilot.
   pure subroutine find_cheapest(error, bound, reach, contact, time, best, dt_ratio)
      type(split_error_t), intent(in) :: error
      real(wp), intent(in) :: bound, reach
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      integer, intent(out) :: best
      real(wp), intent(out) :: dt_ratio
      real(wp) :: dx_ratio, longest, ratio, least, cost
      integer :: fewest, i, family, n

      best = 0
      dt_ratio = 1.0_wp
      least = huge(1.0_wp)
      fewest = (intervals_for_waves(contact) + wave_share - 1)/wave_share
      longest = min(shortest_passage(contact)/steps_in_wave, time%end_time)/time%time_step
      families_of_grids: do family = 0, size(families)*doublings
         ! from half the intervals of the pilot to four times as many
         n = contact%domain%intervals/8*families(1 + modulo(family, size(families)))*2**(family/size(families))
         dx_ratio = real(contact%domain%intervals, wp)/n
         if (n < fewest .or. n > most_intervals .or. dx_ratio < 1.0_wp/reach) cycle families_of_grids
         steps: do i = 1, size(ratios)
            ratio = ratios(i)*dx_ratio
            if (ratio < 1.0_wp/reach) exit steps
            if (ratio > longest .or. error_at(error, dx_ratio, ratio) > bound) cycle steps
            cost = n/ratio**power_of_steps
            if (cost >= least) exit steps
            least = cost
            best = n
            dt_ratio = ratio
         end do steps
      end do families_of_grids
   end subroutine find_cheapest

   !> Order of the scheme in time where none is observed, and the bounds of an observed one.
   pure function time_orders(scheme) result(orders)
      character(*), intent(in) :: scheme
      real(wp) :: orders(3)

      orders = [1.0_wp, 1.5_wp, 2.0_wp]
      if (scheme == 'backward_euler') orders = [0.7_wp, 0.7_wp, 1.0_wp]
   end function time_orders

end module resolution_choice

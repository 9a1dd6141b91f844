!> Grid and time step of a transient for a wanted accuracy of h_min.
!>
!> Pilot runs tell the errors of grid and of time step apart (module split_errors): the first on the
!> coarsest grid that carries a film, with dT = dX or less; each further one has either half the
!> spacing or half the time step of the one before, whichever leaves the larger doubt. As soon as
!> they foretell a resolution, from that of the last pilot to four times as fine (twice where no
!> order is observed yet), that is good enough, the cheapest one of these is taken: the run itself
!> is done once. A pilot may not take more than `most_work` times the nodes and steps of the first
!> one; if that does not do, the last resolution is taken, and its forecast says how far it may be
!> off. Unless the user wants another one, all use the kappa space scheme, whose error is the
!> smaller one; where only the thesis's scheme finds a solution, they go on with that.
!>
!> With 160 passages and a target of 1 % it is met in 96 %, at 1.7 times the processor time (median;
!> 90 %: 6.5) of the best fixed choice, the fewest 2^k intervals (64 at least) with dT = dX and the
!> thesis's scheme from which on all meet it. (Before: the thesis's scheme, pilots from 32 intervals
!> on, sizes from the least films alone: 89 % of 80 of these, 2.2 times, 7.8.) Where 64 intervals
!> do, a third of the passages, the pilots cost about as much as the whole best run. Lost in
!> comparisons: pilots of both refinements at once (three per level), to decide on three runs from
!> one corner, a pilot as the answer (its tolerance makes all of them dearer), runs coarser than the
!> last pilot, to run again where the answer surprises, dT = 1.5 or 2 dX at the start, a floor of
!> the errors from load and ridge; least films of parabolas through the time steps are hardly
!> better.
module resolution_choice
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use companions, only: collector_t, run_companion
   use domain_choice, only: choose_domain, inlet_error
   use error_bars, only: domain_error, error_bars_t, new_error_bars
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use line_contact, only: fewest_in_wave, intervals_for_waves, line_contact_t, shortest_passage
   use line_hierarchy, only: coarsest_for_film
   use observer, only: observer_t
   use quantities, only: h_min, quantity_count
   use solver_settings, only: most_chosen, solver_settings_t, time_settings_t
   use split_errors, only: doubts_at, error_at, foretold_values, new_split_error, shift_at, &
      split_error_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: choose_resolution, settle_tolerance

   !> Bounds of the tolerance of time steps, its share of the wanted accuracy, and how much less
   !> pilots need. In 171 runs of passages h_min was off, in 90 and 99 %, by 2e-6 and 9e-5 at 1e-4,
   !> by 1e-5 and 2e-4 at 1e-3, by 9e-5 and 5e-3 at 1e-2, at 88, 79 and 68 % of the cost at 1e-6.
   real(wp), parameter :: tightest = 1.0e-6_wp, loosest = 1.0e-3_wp, tolerance_share = 0.1_wp, &
      looser = 10.0_wp
   !> Intervals of the first pilot at least, and the spacing of its time step at most: that of so
   !> many intervals.
   integer, parameter :: fewest_intervals = 16, first_steps = 32
   !> Spacing and time step are foretold up to so many times finer than in the last pilot, without
   !> and with an observed order.
   real(wp), parameter :: farthest(2) = [2.0_wp, 4.0_wp]
   !> Intervals that may be chosen are these times a power of two, time steps these powers of two
   !> times those of the last pilot.
   integer, parameter :: families(4) = [4, 5, 6, 7], doublings = 2, most_parts = 8
   real(wp), parameter :: part = 0.25_wp
   !> Intervals in the finest wave at least, in the first pilot and in what is chosen, and steps in
   !> which it passes a place there.
   integer, parameter :: pilot_in_wave = 2, nodes_in_wave = 4, steps_in_wave = 4
   !> Steps in its passage from which on a single change by the time step is believed: with less,
   !> one in five choices failed.
   integer, parameter :: believed_steps = 8
   !> After so many refinements of one direction the other one is looked at again.
   integer, parameter :: most_in_a_row = 2
   !> Nodes times steps of a pilot, at most, over those of the first.
   real(wp), parameter :: most_work = 2.0_wp**14
   !> Whole numbers of steps are known to so much.
   real(wp), parameter :: rounding = 1.0e-6_wp
   !> The time of a run grows like n steps^power: shorter steps need fewer cycles.
   real(wp), parameter :: power_of_steps = 0.65_wp
   !> Two pilots are compared at all times at which the smallest film is not above the least by more
   !> than this share.
   real(wp), parameter :: nearly_least = 0.2_wp
   !> What a pilot refines.
   integer, parameter :: nothing = 0, space = 1, time_step = 2

   !> What is known of the pilots.
   type :: pilots_t
      !> Resolution of the last one, or where there is none yet of the first.
      integer :: intervals = 0, steps = 0
      !> Values of the last one; NaN: not known.
      real(wp) :: values(quantity_count) = 0.0_wp
      !> Their last change and the one before, by space and by time step; NaN: not known.
      real(wp) :: changes(quantity_count, 2, 2) = 0.0_wp
      !> Size of the changes of h_min (the last, the one before; by space, by time step), over time;
      !> 0: not known.
      real(wp) :: sizes(2, 2) = 0.0_wp
      !> Smallest film of the last one at each time step (0:steps).
      real(wp), allocatable :: films(:)
      !> Passages of the finest wave, one after the other, that the whole time would hold.
      real(wp) :: passages = 0.0_wp
      !> Most intervals of a pilot and of the run.
      integer :: most = 0
      !> Pilots since the last that has refined space, the time step; below 0: none has yet.
      integer :: age(2) = -1
   end type pilots_t

contains

   !> The tolerance of the time steps follows from the wanted accuracy, if there is one, unless it
   !> is given.
   pure subroutine settle_tolerance(settings)
      type(solver_settings_t), intent(inout) :: settings

      if (settings%target <= 0.0_wp .or. settings%tolerance > 0.0_wp) return
      settings%tolerance = min(max(tolerance_share*settings%target, tightest), loosest)
   end subroutine settle_tolerance

   !> Sets `contact%domain%intervals`, the time step, the tolerance and an open space scheme of a
   !> transient to the cheapest choice that is foretold to keep the relative error of h_min below
   !> `settings%target`, or to the finest pilot if none is; `bars` hold what was foretold of its
   !> quantities.
   subroutine choose_resolution(bars, contact, settings, time, watcher, error)
      type(error_bars_t), intent(out) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(solver_settings_t), intent(inout) :: settings
      type(time_settings_t), intent(inout) :: time
      class(observer_t), intent(inout), target :: watcher
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(pilots_t) :: pilots
      type(line_contact_t) :: pilot
      type(solver_settings_t) :: pilot_settings
      type(time_settings_t) :: pilot_time
      real(wp) :: target, limit
      integer :: direction
      logical :: has_solution, is_chosen, is_open

      bars = new_error_bars(contact, time, settings%space_scheme)
      is_open = settings%space_scheme == 'auto' .and. allows_kappa(settings)
      if (is_open) settings%space_scheme = 'kappa'
      pilot_settings = settings
      call settle_tolerance(settings)
      pilot_settings%tolerance = merge(pilot_settings%tolerance, looser*settings%tolerance, &
         pilot_settings%tolerance > 0.0_wp)
      target = settings%target
      if (.not. contact%domain%has_inlet) then
         call choose_domain(contact, settings%target)
         target = target - domain_error(inlet_error(contact))
      end if
      call choose_domain(contact)
      pilot = contact
      pilot_time = time
      collector%watcher => watcher
      pilots = new_pilots(contact, time)
      pilots%most = most_chosen(settings)
      call check_first(pilots, settings%method, error)
      if (allocated(error)) return
      limit = most_work*pilots%intervals*pilots%steps
      direction = nothing
      is_chosen = .false.
      do
         pilot%domain%intervals = merge(2, 1, direction == space)*pilots%intervals
         pilot_time%time_step = time%end_time/(merge(2, 1, direction == time_step)*pilots%steps)
         call run_companion(pilot, pilot_settings, pilot_time, collector, has_solution, &
            error)   ! error: below
         if (is_open) call try_thesis(pilots, direction)
         if (allocated(error) .or. watcher%wants_stop) return
         if (has_solution) then
            call take_pilot(pilots, direction, foretold_values(collector%summary), collector%films)
         else
            if (2*pilots%intervals > pilots%most) exit
            ! all anew
            pilots = pilots_t(2*pilots%intervals, 2*pilots%steps, passages=pilots%passages, &
               most=pilots%most)
         end if
         direction = next_direction(pilots, has_solution, time%scheme)
         call choose(bars, contact, time, pilots, target, is_chosen)
         if (is_chosen) return
         if (2*pilots%intervals > pilots%most &
            .or. 2.0_wp*pilots%intervals*pilots%steps > limit) exit
      end do
      call take(bars, contact, time, pilots, pilots%intervals, pilots%steps)

   contains

      !> A pilot without a solution again with the thesis's scheme. If that finds a solution all
      !> goes on with it, anew from here.
      subroutine try_thesis(pilots, direction)
         type(pilots_t), intent(inout) :: pilots
         integer, intent(inout) :: direction

         if (has_solution .or. allocated(error) .or. watcher%wants_stop) return
         pilot_settings%space_scheme = 'upwind2'
         call run_companion(pilot, pilot_settings, pilot_time, collector, has_solution, &
            error)   ! error: the caller looks
         if (.not. has_solution) then
            pilot_settings%space_scheme = 'kappa'
            return
         end if
         is_open = .false.
         settings%space_scheme = 'upwind2'
         pilots = pilots_t(pilot%domain%intervals, nint(time%end_time/pilot_time%time_step), &
            passages=pilots%passages, most=pilots%most)
         direction = nothing
      end subroutine try_thesis

   end subroutine choose_resolution

   !> Error (input_error): the coarsest pilot has more intervals than there may be.
   pure subroutine check_first(pilots, method, error)
      type(pilots_t), intent(in) :: pilots
      character(*), intent(in) :: method
      type(error_t), allocatable, intent(out) :: error

      if (pilots%intervals > pilots%most) call fail(error, input_error, &
         '&domain intervals: found a contact whose coarsest '// &
         'pilot run has '//to_text(pilots%intervals)//', expected at most '//to_text(pilots%most) &
            //" with method = '"// &
         trim(method)//"' and this memory")
   end subroutine check_first

   !> Whether the methods of the settings solve the kappa space scheme.
   pure function allows_kappa(settings)
      type(solver_settings_t), intent(in) :: settings
      logical :: allows_kappa

      allows_kappa = settings%smoother == 'auto' .and. index(settings%method, 'block_jacobi') == 0
   end function allows_kappa

   !> Where the pilots of a contact on a complete domain begin.
   pure function new_pilots(contact, time) result(pilots)
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      type(pilots_t) :: pilots
      integer :: n

      n = coarsest_for_film(contact, fewest_intervals)
      do while (fewest_in_wave*n < pilot_in_wave*intervals_for_waves(contact))
         n = 2*n
      end do
      pilots = pilots_t(n, &
         max(2, ceiling(time%end_time*max(n, first_steps)/(contact%domain%x_outlet &
         - contact%domain%x_inlet))), &
         passages=time%end_time/shortest_passage(contact))
   end function new_pilots

   !> Whether the time step is understood: its order has been observed, or the waves pass in many
   !> steps.
   pure function sees_passages(pilots)
      type(pilots_t), intent(in) :: pilots
      logical :: sees_passages

      sees_passages = ieee_is_finite(pilots%changes(h_min, 2, time_step)) &
         .or. pilots%steps >= believed_steps*pilots%passages
   end function sees_passages

   !> A pilot has found `values` and the smallest `films` at its time steps, on twice the resolution
   !> of the last one in `direction`.
   pure subroutine take_pilot(pilots, direction, values, films)
      type(pilots_t), intent(inout) :: pilots
      integer, intent(in) :: direction
      real(wp), intent(in) :: values(quantity_count), films(0:)

      if (direction == nothing) then
         pilots%changes = ieee_value(1.0_wp, ieee_quiet_nan)
         pilots%sizes = 0.0_wp
      else
         pilots%changes(:, 2, direction) = pilots%changes(:, 1, direction)
         pilots%changes(:, 1, direction) = values - pilots%values
         pilots%sizes(2, direction) = pilots%sizes(1, direction)
         pilots%sizes(1, direction) = size_of_change(pilots%films, &
            films(::merge(2, 1, direction == time_step)))
         where (pilots%age >= 0) pilots%age = pilots%age + 1
         pilots%age(direction) = 0
         if (direction == space) pilots%intervals = 2*pilots%intervals
         if (direction == time_step) pilots%steps = 2*pilots%steps
      end if
      pilots%values = values
      pilots%films = films
   end subroutine take_pilot

   !> Root mean square of the relative change from `old` to `new` smallest films of the same times,
   !> where these are nearly the least one, times that: the smallest of all may have changed by
   !> little by chance, while a wave passes between the nodes.
   pure function size_of_change(old, new) result(change)
      real(wp), intent(in) :: old(:), new(:)
      real(wp) :: change, least

      least = minval(new)
      associate (near => new <= (1.0_wp + nearly_least)*least)
         change = least*sqrt(sum(((new - old)/new)**2, near)/count(near))
      end associate
   end function size_of_change

   !> What the next pilot refines: what has not been refined yet or for long, else what leaves the
   !> larger doubt where the forecast ends. `has_solution`: there is a last pilot.
   pure function next_direction(pilots, has_solution, scheme) result(direction)
      type(pilots_t), intent(in) :: pilots
      logical, intent(in) :: has_solution
      character(*), intent(in) :: scheme
      integer :: direction
      type(split_error_t) :: error
      real(wp) :: reach(2), doubts(2)

      if (.not. has_solution) then
         direction = nothing
      else if (pilots%age(space) < 0) then
         direction = space
      else if (pilots%age(time_step) < 0 .or. .not. sees_passages(pilots)) then
         direction = time_step
      else if (any(pilots%age >= most_in_a_row)) then
         direction = maxloc(pilots%age, 1)
      else
         error = error_of(pilots, h_min, scheme)
         reach = reach_of(pilots)
         doubts = doubts_at(error, 1.0_wp/reach(space), 1.0_wp/reach(time_step))
         direction = merge(space, time_step, doubts(space) > doubts(time_step))
      end if
   end function next_direction

   !> What the pilots tell of the errors of a row of the table of quantities.
   pure function error_of(pilots, row, scheme) result(error)
      type(pilots_t), intent(in) :: pilots
      integer, intent(in) :: row
      character(*), intent(in) :: scheme
      type(split_error_t) :: error

      associate (changes => pilots%changes(row, :, :))
         if (row == h_min) then
            error = new_split_error(changes(:, space), changes(:, time_step), &
               time_orders(scheme), pilots%sizes)
         else
            error = new_split_error(changes(:, space), changes(:, time_step), time_orders(scheme))
         end if
      end associate
   end function error_of

   !> How many times finer than the last pilot the forecast goes, in space and in time.
   pure function reach_of(pilots) result(reach)
      type(pilots_t), intent(in) :: pilots
      real(wp) :: reach(2)

      reach = merge(farthest(2), farthest(1), ieee_is_finite(pilots%changes(h_min, 2, :)))
   end function reach_of

   !> Chooses the cheapest intervals and time step that are foretold to be good enough, with the
   !> forecast of all quantities in `bars`; not `is_chosen` if there are none within reach, or
   !> nothing can be foretold yet.
   pure subroutine choose(bars, contact, time, pilots, target, is_chosen)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(time_settings_t), intent(inout) :: time
      type(pilots_t), intent(in) :: pilots
      real(wp), intent(in) :: target
      logical, intent(out) :: is_chosen
      type(split_error_t) :: error
      integer :: intervals, steps

      is_chosen = .false.
      if (any(pilots%age < 0) .or. .not. sees_passages(pilots)) return
      error = error_of(pilots, h_min, time%scheme)
      call find_cheapest(error, target*pilots%values(h_min), pilots, contact, intervals, steps)
      is_chosen = intervals > 0
      if (is_chosen) call take(bars, contact, time, pilots, intervals, steps)
   end subroutine choose

   !> Takes a resolution, with the forecast of its quantities if the pilots allow one.
   pure subroutine take(bars, contact, time, pilots, intervals, steps)
      type(error_bars_t), intent(inout) :: bars
      type(line_contact_t), intent(inout) :: contact
      type(time_settings_t), intent(inout) :: time
      type(pilots_t), intent(in) :: pilots
      integer, intent(in) :: intervals, steps
      type(split_error_t) :: error
      real(wp) :: dx_ratio, dt_ratio
      integer :: i

      contact%domain%intervals = intervals
      time%time_step = time%end_time/steps
      if (any(pilots%age < 0)) return
      dx_ratio = real(pilots%intervals, wp)/intervals
      dt_ratio = real(pilots%steps, wp)/steps
      associate (forecast => bars%forecast, changes => pilots%changes)
         forecast%is_known = .true.
         forecast%pilot = pilots%values
         do i = 1, quantity_count
            error = error_of(pilots, i, time%scheme)
            forecast%error(i) = error_at(error, dx_ratio, dt_ratio)
            forecast%pilot_error(i) = error_at(error, 1.0_wp, 1.0_wp)
            forecast%shift(i) = shift_at(error, dx_ratio, dt_ratio)
         end do
      end associate
   end subroutine take

   !> The intervals and steps that cost least among those whose foretold error is not above `bound`;
   !> 0 if there are none.
   pure subroutine find_cheapest(error, bound, pilots, contact, intervals, steps)
      type(split_error_t), intent(in) :: error
      real(wp), intent(in) :: bound
      type(pilots_t), intent(in) :: pilots
      type(line_contact_t), intent(in) :: contact
      integer, intent(out) :: intervals, steps
      real(wp) :: dx_ratio, dt_ratio, longest, reach(2), least, cost
      integer :: i, family, n, m

      intervals = 0
      steps = 0
      least = huge(1.0_wp)
      longest = pilots%steps/max(steps_in_wave*pilots%passages, 1.0_wp)
      reach = reach_of(pilots)
      families_of_grids: do family = 0, size(families)*doublings
         ! as many intervals as the pilot to four times as many
         n = pilots%intervals/4*families(1 + modulo(family, size(families))) &
            *2**(family/size(families))
         dx_ratio = real(pilots%intervals, wp)/n
         if (fewest_in_wave*n < nodes_in_wave*intervals_for_waves(contact) &
            .or. n > pilots%most .or. &
             dx_ratio*reach(space) < 1.0_wp) cycle families_of_grids
         steps_of_grid: do i = 0, most_parts
            ! whole numbers of steps
            m = ceiling(pilots%steps*2.0_wp**(part*i) - rounding)
            dt_ratio = real(pilots%steps, wp)/m
            if (dt_ratio*reach(time_step) < 1.0_wp) exit steps_of_grid
            if (dt_ratio > longest .or. error_at(error, dx_ratio, &
               dt_ratio) > bound) cycle steps_of_grid
            cost = n/dt_ratio**power_of_steps
            if (cost >= least) exit steps_of_grid
            least = cost
            intervals = n
            steps = m
         end do steps_of_grid
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

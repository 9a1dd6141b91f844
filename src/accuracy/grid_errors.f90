!> Errors of a quantity from its values on n, n/2, n/4 and n/8 intervals, at rest and, with one, two
!> and four time steps, in time.
!>
!> At rest: with Q1, Q2, Q4 on n, n/2, n/4 intervals and the observed order p = log2 |Q2 - Q4|/|Q1 -
!> Q2| the error of Q1 is |Q1 - Q2|/(2^p - 1) (Roache, J. Fluids Eng. 116, 1994, 405). p is bounded:
!> an order above that of the scheme is chance.
!>
!> In time: quantities are extremes over time, and the errors of grid and time step fall at
!> different rates, often with opposite signs: an order from three values is mostly chance. A first-
!> order scheme has two errors of different orders, so that its changes say even less: its result is
!> compared with that of the second-order scheme on the same grid and with the limit of the latter
!> (theory page, section on error estimates).
!>
!> Separate errors of a transient by grid and by time step, from changes when only the spacing or
!> only the time step is halved.
!>
!> Refined together, the two errors often cancel: they have opposite signs and different rates, so
!> that their sum says little about finer resolutions. The last change of each gives its error and
!> sign, the previous change its order. At another resolution (dX', dT' relative to the last run)
!> the error is
!>
!>     | e_X dX'^p + e_T dT'^q |  +  d_X s_X dX'^(3 p/4)  +  d_T s_T dT'^(q/2)
!>
!> where the uncertainties d decay more slowly than the errors e, since orders observed on coarse
!> runs are not yet asymptotic. s is the size of e, at least what the previous change implies: a
!> single change may be small by chance. When a wave passes between nodes both may be; the size for
!> the smallest film therefore uses all times at which the film is nearly smallest.
!>
!> Waves hide the error of the time step on a coarse grid, and large steps that of the grid, so that
!> the actual run errs more than predicted. It therefore gets two coarse runs, one with twice the
!> spacing and one with twice the time step; their changes replace the predicted ones.
!>
!> The smallest film of the kappa scheme hardly changes over one or two halvings where the grid
!> begins to resolve the pressure spike, although it still errs. The upwind2 result at the
!> resolution of a trial run bounds the uncertainty of the grid from below.
module grid_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: not_known, wp
   use line_summary, only: line_summary_t, quantity_t, value_between
   use quantities, only: h_min, h_min_node, quantity_count, quantity_rows, rule_between, rule_node
   implicit none (type, external)
   private

   public :: apart_t, apply_forecast, doubts_at, error_at, error_by_reference, error_from_levels, &
      error_in_time, error_on_grids, forecast_t, least_doubt_at, limit_in_time, new_split_error, &
      observed_order, orders_in_time, predicted_values, shift_at, split_error_t, time_errors

   !> Safety factor: the observed order is uncertain.
   real(wp), parameter, public :: safety = 1.5_wp
   !> The safety factor where a quantity changes monotonically over four grids; the order is then
   !> the lower of the two observed.
   real(wp), parameter :: steady_safety = 1.3_wp
   !> The error of h_min by the kappa scheme is at most this share of that by upwind2 on the same
   !> grid.
   real(wp), parameter, public :: kappa_share = 0.35_wp
   !> Bounds of the observed order in space.
   real(wp), parameter, public :: orders(2) = [1.0_wp, 2.0_wp]

   !> An estimate is this many times a change.
   real(wp), parameter :: safety_in_time = 2.0_wp
   !> Factor on it where changes of one sign decrease.
   real(wp), parameter :: steady_share = 0.5_wp
   !> Factor on estimates of the largest pressure.
   real(wp), parameter, public :: pressure_safety_in_time = 1.5_wp
   !> Share of its own estimate by which the limit of the second-order scheme may err where a
   !> first-order result is compared with it.
   real(wp), parameter :: limit_share = 0.8_wp

   !> Uncertainties of the errors of grid (without and with an observed order) and time step, and
   !> their decay as a power of the error (calibrated together with the constants of
   !> resolution_choice).
   real(wp), parameter :: space_doubts(2) = [0.75_wp, 0.55_wp], time_doubt = 1.4_wp
   real(wp), parameter :: space_fading = 0.75_wp, time_fading = 0.5_wp
   !> The error of the time step is taken to be at least this share of that of the grid.
   real(wp), parameter :: least_time_share = 0.25_wp
   !> Assumed order in space, and the bounds of an observed one.
   real(wp), parameter :: space_orders(3) = [1.5_wp, 1.5_wp, 2.0_wp]
   !> Uncertainties of both errors where the run has coarse runs.
   real(wp), parameter :: own_doubts(2) = [1.1_wp, 0.4_wp]
   !> The error from coarse runs is taken to be at least the first share of the predicted error, and
   !> its uncertainty at least the second share of the predicted one.
   real(wp), parameter :: least_predicted_share = 0.4_wp, own_least_doubt = 0.25_wp
   !> Factor on the estimates of all quantities other than the smallest film, for which the
   !> resolution was chosen.
   real(wp), parameter :: unaimed = 1.3_wp

   !> Errors (limit minus value) of one quantity in the last run, and their orders.
   type :: split_error_t
      !> From the last changes.
      real(wp) :: space, time
      !> Their sizes, at least what the previous changes imply.
      real(wp) :: space_size, time_size
      real(wp) :: space_order, time_order
      !> Relative uncertainties of the sizes.
      real(wp) :: space_doubt, time_doubt
      !> Lower bound of the uncertainty, independent of the changes.
      real(wp) :: least_doubt = 0.0_wp
   end type split_error_t

   !> Predictions from trial runs for the quantities of a run; NaN: none.
   type :: forecast_t
      logical :: is_known = .false.
      !> Quantities of the finest trial run, and estimates of their errors.
      real(wp) :: trial(quantity_count) = 0.0_wp, trial_error(quantity_count) = 0.0_wp
      !> Error estimates for the run, and the corrections from its values to the limits.
      real(wp) :: error(quantity_count) = 0.0_wp, shift(quantity_count) = 0.0_wp
      !> Lower bound of the uncertainty of the grid.
      real(wp) :: least_doubt(quantity_count) = 0.0_wp
   end type forecast_t

   !> Coarse runs of a run with a chosen resolution.
   type :: apart_t
      logical :: is_known = .false.
      !> Values with twice the spacing, and with a time step `step_ratio` times as large.
      real(wp) :: coarse(quantity_count) = 0.0_wp, slow(quantity_count) = 0.0_wp
      !> Quantities with twice the spacing.
      type(line_summary_t) :: half
      real(wp) :: step_ratio = 2.0_wp
      !> Order in time: the lowest that trial runs may show.
      real(wp) :: time_order = 1.5_wp
   end type apart_t

contains

   !> Estimated error and extrapolated value of the first of `values` on n, n/2, n/4, n/8 intervals
   !> (NaN: not known); `bounds` are those of the observed order. An order that does not persist may
   !> fall to the lowest one after one more grid.
   pure function error_on_grids(values, bounds, lasts) result(error_and_limit)
      real(wp), intent(in) :: values(4), bounds(2)
      logical, intent(in) :: lasts
      real(wp) :: error_and_limit(2)
      real(wp) :: changes(3), order

      error_and_limit = not_known()
      if (.not. all(ieee_is_finite(values(:2)))) return
      order = observed_order(values(1), values(2), values(3), orders)
      if (ieee_is_finite(values(3))) error_and_limit(2) = values(1) + (values(1) - values(2)) &
         /(2.0_wp**order - 1.0_wp)
      order = observed_order(values(1), values(2), values(3), bounds)
      changes = 0.0_wp
      if (ieee_is_finite(values(4))) then
         order = min(order, observed_order(values(2), values(3), values(4), bounds))
         changes = values(:3) - values(2:)
      end if
      associate (error => error_and_limit(1))
         error = error_from_levels(values(1), values(2), order)
         ! two terms of different order and opposite sign may make the last difference small by
         ! chance
         if (ieee_is_finite(values(3))) error = max(error, error_from_levels(values(2), values(3), &
            order)/2.0_wp**orders(2))
         ! the next change 1/2^p of the last, each later one half of the one before: 2/2^p together
         if (.not. lasts) error = error*2*(1 - 0.5_wp**order)
         if (all(changes > 0.0_wp) .or. all(changes < 0.0_wp)) error = steady_safety/safety*error
      end associate
   end function error_on_grids

   !> safety |q1 - q2|/(2^order - 1).
   pure elemental real(wp) function error_from_levels(q1, q2, order) result(error)
      real(wp), intent(in) :: q1, q2, order

      error = safety*abs(q1 - q2)/(2.0_wp**order - 1.0_wp)
   end function error_from_levels

   !> log2 of the ratio of the differences, within the bounds (lowest, highest).
   pure real(wp) function observed_order(q1, q2, q4, bounds) result(order)
      real(wp), intent(in) :: q1, q2, q4, bounds(2)

      order = bounds(1)
      if (.not. ieee_is_finite(q4) .or. abs(q2 - q4) <= tiny(1.0_wp)) return
      order = bounds(2)
      if (abs(q1 - q2) > tiny(1.0_wp)*1.0e10_wp) order = log(abs((q2 - q4)/(q1 - q2)))/log(2.0_wp)
      order = min(max(order, bounds(1)), bounds(2))
   end function observed_order

   !> Error of Q1 by the second-order scheme from Q1, Q2, Q4 (`values`; NaN: not known, then none):
   !> twice the larger of |Q1 - Q2| and |Q2 - Q4|/4; half of that if both changes have the same
   !> sign.
   pure real(wp) function error_in_time(values) result(error)
      real(wp), intent(in) :: values(3)
      real(wp) :: change, older

      change = values(1) - values(2)
      error = safety_in_time*abs(change)
      if (.not. all(ieee_is_finite(values))) return
      older = values(2) - values(3)
      error = safety_in_time*max(abs(change), 0.25_wp*abs(older))
      if (change*older > 0.0_wp) error = steady_share*error
   end function error_in_time

   !> Error of a `value` by the first-order scheme: its distance from the `limit` of the
   !> second-order scheme, plus a share of the `error` of that.
   pure real(wp) function error_by_reference(value, limit, error) result(whole)
      real(wp), intent(in) :: value, limit, error

      whole = abs(value - limit) + limit_share*error
   end function error_by_reference

   !> Richardson's second-order limit of Q1, Q2, Q4.
   pure real(wp) function limit_in_time(values) result(limit)
      real(wp), intent(in) :: values(3)

      limit = values(1) + (values(1) - values(2))/3.0_wp
   end function limit_in_time

   !> Assumed order in time of a scheme, and the bounds of an observed one.
   pure function orders_in_time(scheme) result(orders)
      character(*), intent(in) :: scheme
      real(wp) :: orders(3)

      orders = [1.0_wp, 1.5_wp, 2.0_wp]
      if (scheme == 'backward_euler') orders = [0.7_wp, 0.7_wp, 1.0_wp]
   end function orders_in_time

   !> The predicted values of a run: those between nodes, except for quantities of a node.
   pure function predicted_values(summary) result(values)
      type(line_summary_t), intent(in) :: summary
      real(wp) :: values(quantity_count)
      integer :: i

      values = [(value_between(summary, i), i=1, quantity_count)]
      where (quantity_rows%rule == rule_node) values = summary%of%value
   end function predicted_values

   !> Error estimates and extrapolated values of a run from its prediction and its coarse runs.
   !> `node_jitter`: variation of the exit with the position of the nodes.
   pure subroutine apply_forecast(forecast, apart, node_jitter, summary)
      type(forecast_t), intent(in) :: forecast
      type(apart_t), intent(in) :: apart
      real(wp), intent(in) :: node_jitter
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: values(quantity_count), nodal
      integer :: i

      values = predicted_values(summary)
      do i = 1, quantity_count
         nodal = abs(summary%of(i)%value - value_between(summary, i))
         if (quantity_rows(i)%rule == rule_between) nodal = node_jitter + nodal
         call apply_to_row(forecast, apart, i, values(i), nodal, summary%of(i))
         if (all(i /= [h_min, h_min_node])) summary%of(i)%error_grid = unaimed &
            *summary%of(i)%error_grid
      end do
   end subroutine apply_forecast

   !> Row `i`: the estimate, including the distance to the nodal value. Without coarse runs it
   !> widens where `value` differs from that of the trial run by more than both estimates.
   pure subroutine apply_to_row(forecast, apart, i, value, nodal, quantity)
      type(forecast_t), intent(in) :: forecast
      type(apart_t), intent(in) :: apart
      integer, intent(in) :: i
      real(wp), intent(in) :: value, nodal
      type(quantity_t), intent(inout) :: quantity
      type(split_error_t) :: own
      real(wp) :: error, shift, change, allowed

      error = forecast%error(i)
      if (.not. (ieee_is_finite(value) .and. ieee_is_finite(error))) return
      own = own_error(apart, i, value)
      own%least_doubt = own_least_doubt*forecast%least_doubt(i)
      if (apart%is_known .and. ieee_is_finite(own%space) .and. ieee_is_finite(own%time)) then
         error = max(error_at(own, 1.0_wp, 1.0_wp), least_predicted_share*error)
         shift = shift_at(own, 1.0_wp, 1.0_wp)
      else
         change = abs(value - forecast%trial(i))
         allowed = error + forecast%trial_error(i)
         if (change > allowed .and. allowed > 0.0_wp) error = error*change/allowed
         shift = forecast%shift(i)
      end if
      quantity%error_grid = error + nodal
      quantity%extrapolated = value + shift
   end subroutine apply_to_row

   !> Errors of all quantities of a run by its time step alone, from its coarse runs.
   pure function time_errors(apart, summary) result(errors)
      type(apart_t), intent(in) :: apart
      type(line_summary_t), intent(in) :: summary
      real(wp) :: errors(quantity_count)
      real(wp) :: values(quantity_count)
      type(split_error_t) :: own
      integer :: i

      values = predicted_values(summary)
      do i = 1, quantity_count
         own = own_error(apart, i, values(i))
         errors(i) = (1 + own%time_doubt)*own%time_size
      end do
   end function time_errors

   !> Errors of row `i` of a run from the changes to its coarse runs.
   pure function own_error(apart, i, value) result(self)
      type(apart_t), intent(in) :: apart
      integer, intent(in) :: i
      real(wp), intent(in) :: value
      type(split_error_t) :: self

      self%space_order = space_orders(2)
      self%time_order = apart%time_order
      self%space = (value - apart%coarse(i))/(2.0_wp**self%space_order - 1.0_wp)
      self%time = (value - apart%slow(i))/(apart%step_ratio**self%time_order - 1.0_wp)
      self%space_size = abs(self%space)
      self%time_size = abs(self%time)
      self%space_doubt = own_doubts(1)
      self%time_doubt = own_doubts(2)
   end function own_error

   !> Errors of a quantity from the last and the previous change (NaN: not known) when `space`
   !> halves the spacing and `time` the time step. `time_orders`: assumed order in time and the
   !> bounds of an observed one. `sizes`: lower bounds of the changes by spacing, (:, 1), and by
   !> time step.
   pure function new_split_error(space, time, time_orders, sizes) result(self)
      real(wp), intent(in) :: space(2), time(2), time_orders(3)
      real(wp), intent(in), optional :: sizes(2, 2)
      type(split_error_t) :: self
      real(wp) :: least(2, 2)

      least = 0.0_wp
      if (present(sizes)) least = sizes
      call split(space, least(:, 1), space_orders, self%space, self%space_size, self%space_order)
      call split(time, least(:, 2), time_orders, self%time, self%time_size, self%time_order)
      self%space_doubt = space_doubts(merge(2, 1, ieee_is_finite(space(2))))
      self%time_doubt = time_doubt
      if (ieee_is_finite(self%time_size) .and. ieee_is_finite(self%space_size)) then
         self%time_size = max(self%time_size, least_time_share*self%space_size)
      end if
   end function new_split_error

   !> Error in one direction from the last and the previous change, with lower bounds `sizes`.
   pure subroutine split(changes, sizes, orders, error, size, order)
      real(wp), intent(in) :: changes(2), sizes(2), orders(3)
      real(wp), intent(out) :: error, size, order
      real(wp) :: older

      order = orders(1)
      error = changes(1)
      size = changes(1)
      if (.not. ieee_is_finite(changes(1))) return
      size = max(abs(changes(1)), sizes(1))
      if (ieee_is_finite(changes(2))) then
         older = max(abs(changes(2)), sizes(2))
         order = orders(2)
         if (older >= 2.0_wp**orders(3)*size) then
            order = orders(3)
         else if (older > size) then
            order = max(log(older/size)/log(2.0_wp), orders(2))
         end if
         size = max(size, older/2.0_wp**orders(3))
      end if
      error = changes(1)/(2.0_wp**order - 1.0_wp)
      size = size/(2.0_wp**order - 1.0_wp)
   end subroutine split

   !> Error estimate where spacing and time step are `dx_ratio` and `dt_ratio` times those of the
   !> last run.
   pure function error_at(self, dx_ratio, dt_ratio) result(error)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio, dt_ratio
      real(wp) :: error, doubts(2)

      doubts = doubts_at(self, dx_ratio, dt_ratio)
      error = abs(shift_at(self, dx_ratio, dt_ratio)) + doubts(1) + doubts(2)
   end function error_at

   !> The uncertainties in it, by grid and by time step.
   pure function doubts_at(self, dx_ratio, dt_ratio) result(doubts)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio, dt_ratio
      real(wp) :: doubts(2)

      doubts(1) = max(self%space_doubt*self%space_size*dx_ratio**(space_fading &
         *self%space_order), least_doubt_at(self, dx_ratio))
      doubts(2) = self%time_doubt*self%time_size*dt_ratio**(time_fading*self%time_order)
   end function doubts_at

   !> Lower bound of the uncertainty by grid.
   pure real(wp) function least_doubt_at(self, dx_ratio) result(doubt)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio

      doubt = self%least_doubt*dx_ratio**space_orders(2)
   end function least_doubt_at

   !> Correction from the value there to the limit.
   pure real(wp) function shift_at(self, dx_ratio, dt_ratio) result(shift)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio, dt_ratio

      shift = self%space*dx_ratio**self%space_order + self%time*dt_ratio**self%time_order
   end function shift_at

end module grid_errors

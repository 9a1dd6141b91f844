!> Errors of a transient because of the grid and because of the time step, apart: from the changes
!> of its quantities where the spacing alone, and the time step alone, is halved.
!>
!> Refined together the two errors often cancel, with opposite signs and rates of their own, so that
!> their sum tells little of finer resolutions. The last change of each tells its error and the sign
!> of it, the one before the order. Elsewhere (dX', dT' over those of the last run) the error is
!> then
!>
!>     | e_X dX'^p + e_T dT'^q |  +  d_X s_X dX'^(3 p/4)  +  d_T s_T dT'^(q/2)
!>
!> with the doubts d, which fade more slowly than the errors e: orders seen on coarse runs are not
!> yet those of the scheme. s is the size of e, not below what the change before leaves of it: a
!> last change may be small by chance. So may be both where a wave passes between the nodes: of the
!> smallest film the size is that of the changes at all times at which it is nearly as small.
!>
!> On a coarse grid a wave hides what the time step does, and with large steps what the grid does:
!> the run itself has then larger errors than were foretold. So it has coarse runs, one with twice
!> the spacing and one with twice the time step, whose changes take the place of those foretold.
!>
!> The smallest film of the kappa scheme stands still over one or two halvings of the spacing, where
!> the pressure spike comes into sight of the grid, while it still errs. What the thesis's scheme
!> finds at the resolution of a pilot says what the doubt about the grid is at least.
module split_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use line_summary, only: line_summary_t, quantity_t, value_between
   use quantities, only: h_min, h_min_node, quantity_count, quantity_rows, rule_between, rule_node
   implicit none (type, external)
   private

   public :: apart_t, apply_forecast, doubts_at, error_at, forecast_t, foretold_values, &
      least_doubt_at, new_split_error, orders_in_time, shift_at, split_error_t, time_errors

   !> The doubts about the error of the grid, without and with an observed order, and about that of
   !> the time step, and how they fade: as this power of the error (chosen with the numbers of
   !> resolution_choice).
   real(wp), parameter :: space_doubts(2) = [0.75_wp, 0.55_wp], time_doubt = 1.4_wp
   real(wp), parameter :: space_fading = 0.75_wp, time_fading = 0.5_wp
   !> The error of the time step is not believed to be less than this share of that of the grid.
   real(wp), parameter :: least_time_share = 0.25_wp
   !> The order in space where none is observed, and the bounds of an observed one.
   real(wp), parameter :: space_orders(3) = [1.5_wp, 1.5_wp, 2.0_wp]
   !> The doubts about both errors of a run with coarse runs of its own.
   real(wp), parameter :: own_doubts(2) = [1.1_wp, 0.4_wp]
   !> The error that the coarse runs of a run show is not believed to be less than this share of the
   !> one foretold, and what is doubtful at least not less than this share.
   real(wp), parameter :: least_foretold_share = 0.4_wp, own_least_doubt = 0.25_wp
   !> Estimates of all quantities but the smallest film, for which the resolution is chosen, are
   !> wider by this factor.
   real(wp), parameter :: unaimed = 1.3_wp

   !> Errors of one quantity in the last run, limit less value, and the orders with which they fall.
   type :: split_error_t
      !> As the last changes tell.
      real(wp) :: space, time
      !> Their size, not less than the changes before leave of it: a change may be small by chance.
      real(wp) :: space_size, time_size
      real(wp) :: space_order, time_order
      !> Parts of the sizes that are doubtful.
      real(wp) :: space_doubt, time_doubt
      !> What is doubtful of it at least, whatever its changes.
      real(wp) :: least_doubt = 0.0_wp
   end type split_error_t

   !> What pilot runs foretell of the quantities of a run; NaN: nothing.
   type :: forecast_t
      logical :: is_known = .false.
      !> Values of the finest pilot, and the estimates of their errors.
      real(wp) :: pilot(quantity_count) = 0.0_wp, pilot_error(quantity_count) = 0.0_wp
      !> Estimates for the run, and what leads from its values to the limits.
      real(wp) :: error(quantity_count) = 0.0_wp, shift(quantity_count) = 0.0_wp
      !> What is doubtful of the errors of its grid at least.
      real(wp) :: least_doubt(quantity_count) = 0.0_wp
   end type forecast_t

   !> What the coarse runs of a run show; its own changes are those to them.
   type :: apart_t
      logical :: is_known = .false.
      !> Values with twice the spacing, and with a time step that is `step_ratio` times as large.
      real(wp) :: coarse(quantity_count) = 0.0_wp, slow(quantity_count) = 0.0_wp
      !> Quantities with twice the spacing.
      type(line_summary_t) :: half
      real(wp) :: step_ratio = 2.0_wp
      !> Order in time: the least one that pilots may show.
      real(wp) :: time_order = 1.5_wp
   end type apart_t

contains

   !> Order of a scheme in time where none is observed, and the bounds of an observed one.
   pure function orders_in_time(scheme) result(orders)
      character(*), intent(in) :: scheme
      real(wp) :: orders(3)

      orders = [1.0_wp, 1.5_wp, 2.0_wp]
      if (scheme == 'backward_euler') orders = [0.7_wp, 0.7_wp, 1.0_wp]
   end function orders_in_time

   !> The values of a run that are foretold: between the nodes, but of a node its own.
   pure function foretold_values(summary) result(values)
      type(line_summary_t), intent(in) :: summary
      real(wp) :: values(quantity_count)
      integer :: i

      values = [(value_between(summary, i), i=1, quantity_count)]
      where (quantity_rows%rule == rule_node) values = summary%of%value
   end function foretold_values

   !> Estimates and extrapolated values of a run from its forecast and its coarse runs.
   !> `node_jitter`: by how much the exit jitters with the place of the nodes.
   pure subroutine apply_forecast(forecast, apart, node_jitter, summary)
      type(forecast_t), intent(in) :: forecast
      type(apart_t), intent(in) :: apart
      real(wp), intent(in) :: node_jitter
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: values(quantity_count), nodal
      integer :: i

      values = foretold_values(summary)
      do i = 1, quantity_count
         nodal = abs(summary%of(i)%value - value_between(summary, i))
         if (quantity_rows(i)%rule == rule_between) nodal = node_jitter + nodal
         call apply_to_row(forecast, apart, i, values(i), nodal, summary%of(i))
         if (all(i /= [h_min, h_min_node])) summary%of(i)%error_grid = unaimed &
            *summary%of(i)%error_grid
      end do
   end subroutine apply_forecast

   !> Row `i`: the estimate, and what its node is off. Without coarse runs it is wider where `value`
   !> is farther from that of the pilot than both estimates allow.
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
         error = max(error_at(own, 1.0_wp, 1.0_wp), least_foretold_share*error)
         shift = shift_at(own, 1.0_wp, 1.0_wp)
      else
         change = abs(value - forecast%pilot(i))
         allowed = error + forecast%pilot_error(i)
         if (change > allowed .and. allowed > 0.0_wp) error = error*change/allowed
         shift = forecast%shift(i)
      end if
      quantity%error_grid = error + nodal
      quantity%extrapolated = value + shift
   end subroutine apply_to_row

   !> Errors of all quantities of a run because of its time step alone, from its coarse runs.
   pure function time_errors(apart, summary) result(errors)
      type(apart_t), intent(in) :: apart
      type(line_summary_t), intent(in) :: summary
      real(wp) :: errors(quantity_count)
      real(wp) :: values(quantity_count)
      type(split_error_t) :: own
      integer :: i

      values = foretold_values(summary)
      do i = 1, quantity_count
         own = own_error(apart, i, values(i))
         errors(i) = (1 + own%time_doubt)*own%time_size
      end do
   end function time_errors

   !> The errors of row `i` of a run from its changes to the coarse runs.
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

   !> The errors of a quantity from its last change and the one before (NaN where not known) with
   !> half the spacing, `space`, and with half the time step, `time`. `time_orders`: the order in
   !> time where none is observed, and the bounds of an observed one. `sizes`: what the changes by
   !> space, (:, 1), and by time are at least.
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

   !> The error of one direction from its last change and the one before, of which `sizes` says what
   !> they are at least.
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

   !> Estimate of the error where spacing and time step are `dx_ratio` and `dt_ratio` times those of
   !> the last run.
   pure function error_at(self, dx_ratio, dt_ratio) result(error)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio, dt_ratio
      real(wp) :: error, doubts(2)

      doubts = doubts_at(self, dx_ratio, dt_ratio)
      error = abs(shift_at(self, dx_ratio, dt_ratio)) + doubts(1) + doubts(2)
   end function error_at

   !> What of it is doubt, about the error of the grid and about that of the time step.
   pure function doubts_at(self, dx_ratio, dt_ratio) result(doubts)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio, dt_ratio
      real(wp) :: doubts(2)

      doubts(1) = max(self%space_doubt*self%space_size*dx_ratio**(space_fading &
         *self%space_order), least_doubt_at(self, dx_ratio))
      doubts(2) = self%time_doubt*self%time_size*dt_ratio**(time_fading*self%time_order)
   end function doubts_at

   !> What of it is doubt about the error of the grid, whatever the changes.
   pure function least_doubt_at(self, dx_ratio) result(doubt)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio
      real(wp) :: doubt

      doubt = self%least_doubt*dx_ratio**space_orders(2)
   end function least_doubt_at

   !> What leads from the value there to the limit.
   pure function shift_at(self, dx_ratio, dt_ratio) result(shift)
      type(split_error_t), intent(in) :: self
      real(wp), intent(in) :: dx_ratio, dt_ratio
      real(wp) :: shift

      shift = self%space*dx_ratio**self%space_order + self%time*dt_ratio**self%time_order
   end function shift_at

end module split_errors

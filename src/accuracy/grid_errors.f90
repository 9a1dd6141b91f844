!> Errors of a quantity from its values on n, n/2, n/4 and n/8 intervals, at rest by the observed
!> order (Roache, J. Fluids Eng. 116, 1994, 405) and, with one, two and four time steps, in time
!> (docs/theory.md, error estimates). An order above that of the scheme is chance, and so is mostly
!> an order from three extremes over time.
module grid_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: not_known, wp
   implicit none (type, external)
   private

   public :: error_from_levels, error_in_time, error_on_grids, error_with_limit, observed_order

   !> Safety factor: the observed order is uncertain.
   real(wp), parameter, public :: safety = 1.5_wp
   !> The safety factor where a quantity changes monotonically over four grids; the order is then
   !> the lower of the two observed.
   real(wp), parameter :: steady_safety = 1.3_wp
   !> The error of h_min by kappa is at most this share of that by upwind2 on the same grid.
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

contains

   !> Estimated error and extrapolated value of the first of the values `on_grids` of n, n/2, n/4
   !> and n/8 intervals, as far as there are any (NaN: not known); `bounds` are those of the
   !> observed order. An order that does not persist may fall to the lowest one after one more grid.
   pure function error_on_grids(on_grids, bounds, lasts) result(error_and_limit)
      real(wp), intent(in) :: on_grids(:), bounds(2)
      logical, intent(in) :: lasts
      real(wp) :: error_and_limit(2)
      real(wp) :: changes(3), order, values(4)
      integer :: n

      n = min(size(on_grids), size(values))
      values = not_known()
      values(:n) = on_grids(:n)
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
         ! two terms of different order and opposite sign may make the last difference small
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
   !> twice the larger of |Q1 - Q2| and |Q2 - Q4|/4; half of that if both have the same sign.
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

   !> Error of a `value` in time and Richardson's second-order limit, from Q1, Q2, Q4 (`values`) of
   !> the second-order scheme: `factor` times the error of Q1; of a first-order scheme its distance
   !> from the limit, plus a share of that error.
   pure function error_with_limit(value, is_first_order, values, factor) result(error_and_limit)
      real(wp), intent(in) :: value, values(3), factor
      logical, intent(in) :: is_first_order
      real(wp) :: error_and_limit(2)

      associate (error => error_and_limit(1), limit => error_and_limit(2))
         limit = values(1) + (values(1) - values(2))/3.0_wp
         error = factor*error_in_time(values)
         if (is_first_order) error = abs(value - limit) + limit_share*error
      end associate
   end function error_with_limit

end module grid_errors

!> What the quantities of a transient on n, n/2 and n/4 intervals, with one, two and four time
!> steps, tell of its error.
!>
!> Quantities are extremes over the passage, and the errors of grid and time step fall at rates of
!> their own, often with opposite signs: the order that three values show is mostly chance. A scheme
!> of first order has two errors of different orders, so that its changes tell even less: its result
!> is compared with that of the second-order scheme on the same grid, and with the limit of that
!> (theory page, section on error estimates).
module transient_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: error_by_reference, error_in_time, limit_in_time

   !> Estimates are this many times a change.
   real(wp), parameter :: safety = 2.0_wp
   !> Changes of one sign that become smaller leave this share of it.
   real(wp), parameter :: steady_share = 0.5_wp
   !> Estimates for the largest pressure are wider by this factor.
   real(wp), parameter, public :: pressure_safety_in_time = 1.5_wp
   !> The share of its own estimate by which the limit of the second-order scheme may be off, where
   !> a result of first order is compared with it.
   real(wp), parameter :: limit_share = 0.8_wp

contains

   !> Estimate of the error of Q1 with the second-order scheme from Q1, Q2, Q4 (`values`; NaN = not
   !> known, then none): twice the larger one of |Q1 - Q2| and |Q2 - Q4|/4, half of it where both
   !> changes have the same sign.
   pure function error_in_time(values) result(error)
      real(wp), intent(in) :: values(3)
      real(wp) :: error
      real(wp) :: change, older

      change = values(1) - values(2)
      error = safety*abs(change)
      if (.not. all(ieee_is_finite(values))) return
      older = values(2) - values(3)
      error = safety*max(abs(change), 0.25_wp*abs(older))
      if (change*older > 0.0_wp) error = steady_share*error
   end function error_in_time

   !> Estimate of the error of a `value` of the first-order scheme: its distance from the `limit` of
   !> the second-order scheme, and the doubt about that, from the `error` estimated for the value
   !> that belongs to it.
   pure function error_by_reference(value, limit, error) result(whole)
      real(wp), intent(in) :: value, limit, error
      real(wp) :: whole

      whole = abs(value - limit) + limit_share*error
   end function error_by_reference

   !> The limit on ever finer grids and time steps, by Richardson's extrapolation of second order,
   !> from Q1, Q2, Q4.
   pure function limit_in_time(values) result(limit)
      real(wp), intent(in) :: values(3)
      real(wp) :: limit

      limit = values(1) + (values(1) - values(2))/3.0_wp
   end function limit_in_time

end module transient_errors

!> Errors of a transient from its quantities on n, n/2 and n/4 intervals with one, two and four time
!> steps.
!>
!> Quantities are extremes over time, and the errors of grid and time step fall at different rates,
!> often with opposite signs: an order from three values is mostly chance. A first-order scheme has
!> two errors of different orders, so that its changes say even less: its result is compared with
!> that of the second-order scheme on the same grid and with the limit of the latter (theory page,
!> section on error estimates).
module transient_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: error_by_reference, error_in_time, limit_in_time

   !> An estimate is this many times a change.
   real(wp), parameter :: safety = 2.0_wp
   !> Factor on it where changes of one sign decrease.
   real(wp), parameter :: steady_share = 0.5_wp
   !> Factor on estimates of the largest pressure.
   real(wp), parameter, public :: pressure_safety_in_time = 1.5_wp
   !> Share of its own estimate by which the limit of the second-order scheme may err where a
   !> first-order result is compared with it.
   real(wp), parameter :: limit_share = 0.8_wp

contains

   !> Error of Q1 by the second-order scheme from Q1, Q2, Q4 (`values`; NaN: not known, then none):
   !> twice the larger of |Q1 - Q2| and |Q2 - Q4|/4; half of that if both changes have the same
   !> sign.
   pure real(wp) function error_in_time(values) result(error)
      real(wp), intent(in) :: values(3)
      real(wp) :: change, older

      change = values(1) - values(2)
      error = safety*abs(change)
      if (.not. all(ieee_is_finite(values))) return
      older = values(2) - values(3)
      error = safety*max(abs(change), 0.25_wp*abs(older))
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

end module transient_errors

!> What the figures of a transient on n, n/2 and n/4 intervals, with one, two and four time steps, tell of its error.
!>
!> Figures are extremes over the passage, and the errors of grid and time step fall at rates of their own, often with opposite
!> signs: the order that three values show is mostly chance, and estimates by it were two to three times wider than needed, with
!> backward Euler ten times. What is here holds over 240 passages (theory page, section on error estimates).
module transient_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: error_in_time, limit_in_time

   !> Estimates of the second-order scheme are this many times a change, those of the first-order one this many times.
   real(wp), parameter :: safety = 2.0_wp, first_order_safety = 2.3_wp
   !> Changes of one sign that become smaller leave this share of it.
   real(wp), parameter :: steady_share = 0.5_wp
   !> Estimates for the largest pressure are wider by this factor.
   real(wp), parameter, public :: pressure_safety_in_time = 1.5_wp

contains

   !> Estimate of the error of Q1 from Q1, Q2, Q4 (`values`; NaN = not known, then none).
   !>
   !> Second order: twice the larger one of |Q1 - Q2| and |Q2 - Q4|/4, half of it where both changes have the same sign. First
   !> order: the larger one of |Q1 - Q2| and the linear part of the parabola in the step through the three values.
   pure function error_in_time(values, is_first_order) result(error)
      real(wp), intent(in) :: values(3)
      logical, intent(in) :: is_first_order
      real(wp) :: error
      real(wp) :: change, older

      change = values(1) - values(2)
      error = merge(first_order_safety, safety, is_first_order)*abs(change)
      if (.not. all(ieee_is_finite(values))) return
      older = values(2) - values(3)
      if (is_first_order) then
         error = first_order_safety*max(abs(change), abs(2.0_wp*change - 0.5_wp*older))
      else
         error = safety*max(abs(change), 0.25_wp*abs(older))
         if (change*older > 0.0_wp) error = steady_share*error
      end if
   end function error_in_time

   !> The limit on ever finer grids and time steps, by Richardson's extrapolation of second order, from Q1, Q2, Q4. (Over 480
   !> passages with BDF2 its error was a quarter to two fifths of that of Q1 in the median, 83 % of the smallest films got better,
   !> with the observed order 70 %.)
   pure function limit_in_time(values) result(limit)
      real(wp), intent(in) :: values(3)
      real(wp) :: limit

      limit = values(1) + (values(1) - values(2))/3.0_wp
   end function limit_in_time

end module transient_errors

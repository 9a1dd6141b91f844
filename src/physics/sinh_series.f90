!> Power series of sinh(x)/x, for arguments at which the closed form loses digits.
module sinh_series
   use kinds, only: wp
   implicit none (type, external)
   private

   !> Up to this |x| the series is used [-]: nine terms are cut off below 1e-17 there, and the
   !> closed form above it loses no digit by cancellation (at 0.5 it would lose one).
   real(wp), parameter, public :: series_limit = 1.0_wp

   !> Taylor coefficients: sinh(x)/x = sum s_m x^(2m), s_m = 1/(2m + 1)!, m = 0 ... 8.
   real(wp), parameter, public :: s(0:8) = [ &
                          1.0_wp, 1.0_wp/6.0_wp, 1.0_wp/120.0_wp, 1.0_wp/5040.0_wp, &
                             1.0_wp/362880.0_wp, &
                          1.0_wp/39916800.0_wp, 1.0_wp/6227020800.0_wp, 1.0_wp/1307674368000.0_wp, &
                          1.0_wp/355687428096000.0_wp]

   !> Coefficients of the derivative by x, divided by x: 2 m s_m, m = 1 ... 8, and a zero.
   real(wp), parameter, public :: ds(0:8) = 2.0_wp*[s(1), 2.0_wp*s(2), 3.0_wp*s(3), 4.0_wp*s(4), &
      5.0_wp*s(5), 6.0_wp*s(6), &
                                            7.0_wp*s(7), 8.0_wp*s(8), 0.0_wp]

end module sinh_series

!> What three grids tell of a pressure spike, which grows with the grid for long.
module pressure_spike
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use line_summary, only: crests_t
   implicit none (type, external)
   private

   public :: growth_of, is_calm, largest_change

   !> A pressure spike grows with the grid for long: in a compressible lubricant in all by no more than the first many times the
   !> larger one of its last two changes; where the grid resolves it, its sharpness being below the third number, by no more than
   !> the second many times (12 contacts on 256 to 32768 intervals: by 0.3 to 1.3 times from there on).
   real(wp), parameter :: spike_growth = 6.0_wp, resolved_growth = 2.0_wp, largest_sharpness = 0.08_wp
   !> A largest pressure does not grow like a spike if it changes by less than the first share and half of the change before, or
   !> in two doublings by less than the second share.
   real(wp), parameter :: calm_share = 5.0e-3_wp, still_share = 1.5e-3_wp

contains

   !> How many times its last change a spike may grow.
   pure function growth_of(crests) result(growth)
      type(crests_t), intent(in) :: crests
      real(wp) :: growth

      growth = merge(resolved_growth, spike_growth, crests%sharpness <= largest_sharpness)
   end function growth_of

   !> Whether a largest pressure does not grow like a spike.
   pure function is_calm(values)
      real(wp), intent(in) :: values(3)
      logical :: is_calm

      is_calm = largest_change(values) < still_share*values(1)
      is_calm = is_calm .or. abs(values(1) - values(2)) < min(calm_share*values(1), 0.5_wp*abs(values(2) - values(3)))
   end function is_calm

   !> The larger one of the changes over two doublings of the grid, of those that are known.
   pure function largest_change(values) result(change)
      real(wp), intent(in) :: values(3)
      real(wp) :: change

      change = abs(values(1) - values(2))
      if (ieee_is_finite(values(3))) change = max(change, abs(values(2) - values(3)))
   end function largest_change

end module pressure_spike

!> The error of the largest pressure: from crests on coarser grids, and what a spike may grow.
module pressure_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use grid_errors, only: error_from_levels, observed_order, orders, safety
   use kinds, only: wp
   use line_summary, only: crests_t, line_summary_t, quantity_t
   use lubricant, only: fluid_t, fluid_viscosity, viscosity_constant
   use missing_value, only: not_known
   use pressure_spike, only: ceiling_of_spike, spike_law_t
   use quantities, only: h_central, p_max, sliding_rows
   use rheology, only: thins
   use transient_errors, only: error_by_reference, error_in_time, limit_in_time, &
      pressure_safety_in_time
   implicit none (type, external)
   private

   public :: allow_for_spike, doubt_shear, estimate_crest, estimate_crest_in_time, top_of

   !> An estimate is widened by this factor in place of `safety`.
   real(wp), parameter, public :: pressure_safety = 2.0_wp
   !> What shears a Newtonian oil is not known where the largest pressure may be so far off that ln
   !> mu is by more than this.
   real(wp), parameter :: doubtful_ln_mu = 0.5_wp

contains

   !> The maximum of P that is followed from grid to grid: the largest beside a spike that is below
   !> it, else the largest.
   pure function top_of(crests) result(top)
      type(crests_t), intent(in) :: crests
      real(wp) :: top

      top = crests%highest
      if (.not. (ieee_is_finite(crests%spike) .and. ieee_is_finite(crests%other))) return
      if (crests%spike < crests%other) top = crests%other
   end function top_of

   !> Error of a nodal maximum: that of the parabola's, and what the node is below it.
   pure subroutine estimate_crest(values, quantity)
      real(wp), intent(in) :: values(3)
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: order

      order = observed_order(values(1), values(2), values(3), orders)
      quantity%error_grid = max(error_from_levels(values(1), values(2), order), &
         error_from_levels(values(2), values(3), order)/2.0_wp**orders(2))
      quantity%error_grid = pressure_safety/safety*quantity%error_grid + abs(values(1) &
         - quantity%value)
      quantity%extrapolated = values(1) + (values(1) - values(2))/(2.0_wp**order - 1.0_wp)
   end subroutine estimate_crest

   !> Error of a nodal maximum of a transient: that of the parabola's, `top`, from those of the
   !> second-order scheme on n, n/2, n/4 intervals, and what the node is off.
   pure subroutine estimate_crest_in_time(is_first_order, highest, top, quantity)
      logical, intent(in) :: is_first_order
      real(wp), intent(in) :: highest(3), top
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: error, limit

      if (.not. all(ieee_is_finite(highest))) return
      error = pressure_safety_in_time*error_in_time(highest)
      limit = limit_in_time(highest)
      if (is_first_order) error = error_by_reference(top, limit, error)
      quantity%error_grid = error + abs(top - quantity%value)
      quantity%extrapolated = limit
   end subroutine estimate_crest_in_time

   !> Where the grid has a pressure spike the largest pressure may be off by what the spike may grow
   !> above it; not known where that is not.
   pure subroutine allow_for_spike(law, dx, summary)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: ceiling

      if (.not. ieee_is_finite(summary%crests%highest) &
         .or. .not. ieee_is_finite(summary%of(p_max)%error_grid)) return
      ceiling = ceiling_of_spike(law, summary%crests, summary%of(h_central)%value, dx)
      associate (pressure => summary%of(p_max))
         if (.not. ieee_is_finite(ceiling)) then
            pressure%error_grid = ceiling
            pressure%extrapolated = ceiling
         else if (ceiling > pressure%value + pressure%error_grid) then
            pressure%error_grid = ceiling - pressure%value
            pressure%extrapolated = not_known()
         end if
      end associate
   end subroutine allow_for_spike

   !> Sliding friction of a Newtonian oil where the largest pressure may be off, whose error is that
   !> of `summary`: a spike may carry most of the stress, which rises like the viscosity.
   pure subroutine doubt_shear(fluid, summary)
      type(fluid_t), intent(in) :: fluid
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: ln_mu(2)
      integer :: i

      if (thins(fluid) .or. fluid%viscosity_law == viscosity_constant) return
      associate (pressure => summary%of(p_max))
         if (ieee_is_finite(pressure%error_grid) .and. ieee_is_finite(pressure%value)) then
            call fluid_viscosity(fluid, pressure%value + [0.0_wp, pressure%error_grid], ln_mu)
            if (ln_mu(2) - ln_mu(1) <= doubtful_ln_mu) return
         end if
      end associate
      do i = 1, size(sliding_rows)
         summary%of(sliding_rows(i))%error_grid = not_known()
         summary%of(sliding_rows(i))%extrapolated = not_known()
      end do
   end subroutine doubt_shear

end module pressure_errors

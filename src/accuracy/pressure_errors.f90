!> Errors of the largest pressure and of sliding friction, from crests on coarser grids and from the
!> growth of spikes.
module pressure_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use grid_errors, only: error_by_reference, error_from_levels, error_in_time, limit_in_time, &
      observed_order, orders, pressure_safety_in_time, safety
   use kinds, only: pi, wp
   use line_summary, only: crests_t, line_summary_t, quantity_t
   use lubricant, only: fluid_t, viscosity_constant
   use missing_value, only: exceeds, not_known
   use pressure_spike, only: ceiling_of_spike, shear_of_spike, spike_law_t
   use quantities, only: friction_coefficient, h_central, oil_friction, p_max, sheared_rows, &
      sliding_power, sliding_rows
   use rheology, only: thins
   implicit none (type, external)
   private

   public :: allow_for_spike, doubt_shear, doubt_spike, estimate_crest, estimate_crest_in_time, &
      shear_doubt, top_of

   !> Factor on an estimate, in place of `safety`.
   real(wp), parameter :: pressure_safety = 2.0_wp
   !> Sliding friction errs by up to this many times what a spike may add to it; not known if that
   !> exceeds the second share of it.
   real(wp), parameter :: shear_safety = 12.0_wp, largest_shear_growth = 0.02_wp

contains

   !> The maximum of P that is compared between grids: the largest one next to a spike that is
   !> lower, else the largest.
   pure real(wp) function top_of(crests) result(top)
      type(crests_t), intent(in) :: crests

      top = crests%highest
      if (.not. (ieee_is_finite(crests%spike) .and. ieee_is_finite(crests%other))) return
      if (crests%spike < crests%other) top = crests%other
   end function top_of

   !> Error of a nodal maximum: that of the parabola (`values` on n, n/2, n/4 intervals) plus the
   !> distance of the node below it. If the nodal maxima `nodes` themselves rise from grid to grid,
   !> their error is a lower bound: a parabola through the nodes of a narrow spike overshoots, less
   !> on finer grids, so that its vertex rises too little.
   pure subroutine estimate_crest(values, nodes, quantity)
      real(wp), intent(in) :: values(3), nodes(3)
      type(quantity_t), intent(inout) :: quantity
      real(wp) :: order

      order = observed_order(values(1), values(2), values(3), orders)
      quantity%error_grid = max(error_from_levels(values(1), values(2), order), &
         error_from_levels(values(2), values(3), order)/2.0_wp**orders(2))
      quantity%error_grid = pressure_safety/safety*quantity%error_grid + abs(values(1) &
         - quantity%value)
      quantity%extrapolated = values(1) + (values(1) - values(2))/(2.0_wp**order - 1.0_wp)
      if (.not. (nodes(1) > nodes(2) .and. nodes(2) > nodes(3))) return
      order = observed_order(nodes(1), nodes(2), nodes(3), orders)
      quantity%error_grid = max(quantity%error_grid, error_from_levels(nodes(1), nodes(2), order))
   end subroutine estimate_crest

   !> Error of a nodal maximum of a transient: that of the parabola, `top`, from those of the
   !> second-order scheme on n, n/2, n/4 intervals, plus the distance of the node.
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

   !> With a pressure spike, adds to the error of the largest pressure what the spike may grow above
   !> it; not known if that is not.
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

   !> Relative error of the sliding friction in `row` of `summary` by a spike that grows on grids
   !> finer than `dx`: it may carry most of the stress. 0: none slides or thickens; NaN: not known.
   pure function shear_doubt(law, dx, summary, row) result(doubt)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(in) :: summary
      integer, intent(in) :: row
      real(wp) :: doubt, force, growth

      doubt = 0.0_wp
      if (thins(law%fluid) .or. law%fluid%viscosity_law == viscosity_constant &
         .or. law%lambda <= 0.0_wp) return
      associate (of => summary%of, film => summary%of(h_central)%value)
         force = 0.5_wp*pi*of(friction_coefficient)%value
         if (ieee_is_finite(force)) then
            if (abs(force) <= tiny(1.0_wp)) return
         end if
         doubt = not_known()
         if (.not. all(ieee_is_finite([force, of(sliding_power)%value, film, &
            summary%crests%highest]))) return
         growth = shear_of_spike(law, summary%crests, film, dx)
         ! in units of the force, by lambda (u2 - u1)/(6 (u1 + u2))
         growth = law%lambda/6*abs(of(sliding_power)%value)/force*growth/force
         growth = growth*of(friction_coefficient)%value/of(row)%value
         if (growth <= largest_shear_growth) doubt = shear_safety*growth
      end associate
   end function shear_doubt

   !> Raises the error of the sliding friction of `summary` to what a spike may add to it.
   pure subroutine doubt_shear(law, dx, summary)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: doubt
      integer :: i

      doubt = shear_doubt(law, dx, summary, friction_coefficient)
      each_row: do i = 1, size(sheared_rows)
         if (sheared_rows(i) == oil_friction .and. summary%of(oil_friction)%value > 0.0_wp) doubt &
            = shear_doubt(law, dx, summary, oil_friction)   ! also of the rows behind it
         associate (quantity => summary%of(sheared_rows(i)))
            if (.not. ieee_is_finite(doubt)) then
               quantity%error_grid = not_known()
               quantity%extrapolated = not_known()
            else if (ieee_is_finite(quantity%error_grid)) then
               if (.not. exceeds(doubt*abs(quantity%value), quantity%error_grid)) cycle each_row
               quantity%error_grid = doubt*abs(quantity%value)
               quantity%extrapolated = not_known()
            end if
         end associate
      end do each_row
   end subroutine doubt_shear

   !> Sets the errors of largest pressure and sliding friction of a `summary` to what a spike may
   !> add on grids finer than `dx`; NaN: not known.
   pure subroutine doubt_spike(fluid, lambda, dx, summary)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, dx
      type(line_summary_t), intent(inout) :: summary

      summary%of(p_max)%error_grid = 0.0_wp
      call allow_for_spike(spike_law_t(fluid, lambda), dx, summary)
      summary%of(sliding_rows)%error_grid = shear_doubt(spike_law_t(fluid, lambda), dx, summary, &
         friction_coefficient)*abs(summary%of(sliding_rows)%value)
   end subroutine doubt_spike

end module pressure_errors

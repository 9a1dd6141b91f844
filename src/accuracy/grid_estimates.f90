!> Errors of every quantity by grid and time step, from runs of the same case on n/2 and n/4
!> intervals (transients: with twice and four times the time step; first-order schemes: these and
!> one on n by the second-order scheme). Rules: modules grid_errors, pressure_errors.
module grid_estimates
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use grid_errors, only: error_by_reference, error_from_levels, error_in_time, error_on_grids, &
      kappa_share, limit_in_time, orders, safety
   use kinds, only: wp
   use line_summary, only: line_summary_t, new_quantity, quantity_t
   use missing_value, only: larger, not_known
   use pressure_errors, only: estimate_crest, estimate_crest_in_time, top_of
   use quantities, only: asperity_share, boundary_friction, h_central, is_chance, p_max, &
      quantity_count, quantity_rows, rule_between, rule_crest, rule_first, rule_node
   implicit none (type, external)
   private

   public :: coarse_values_t, estimate_grid_errors, copy_coarser

   !> Error of the exit between two nodes, in spacings.
   real(wp), parameter, public :: exit_jitter = 0.2_wp

   !> Coarse runs of a result, and what is known of the order of the scheme.
   type :: coarse_values_t
      !> Quantities on n/2, n/4 and, of a steady contact on a chosen grid, n/8 intervals; `grids` of
      !> them are known.
      integer :: grids = 0
      type(line_summary_t) :: coarser(3)
      !> Transients by a first-order scheme: quantities by the second-order scheme on the same grid,
      !> known if those on n/2 are.
      type(line_summary_t) :: second_order
      logical :: is_first_order = .false.
      !> Whether the space scheme is kappa, whose orders have other bounds.
      logical :: is_kappa = .false.
      !> Steady contacts by the kappa scheme: quantities by upwind2 on n, n/2 and n/4 intervals; not
      !> allocated: not known.
      type(line_summary_t), allocatable :: other_scheme(:)
   end type coarse_values_t

contains

   !> Copies the solutions on n/2, n/4 and n/8 intervals, as far as known.
   pure subroutine copy_coarser(values, coarser)
      class(coarse_values_t), intent(inout) :: values
      type(line_summary_t), intent(in) :: coarser(:)

      values%grids = min(size(coarser), size(values%coarser))
      values%coarser(:values%grids) = coarser(:values%grids)
   end subroutine copy_coarser

   !> Sets the errors of all quantities by grid and time step.
   pure subroutine estimate_grid_errors(values, is_transient, dx, summary)
      type(coarse_values_t), intent(in) :: values
      logical, intent(in) :: is_transient
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      integer :: i

      do i = 1, quantity_count
         if (quantity_rows(i)%rule == rule_crest) then
            call estimate_pressure(values, is_transient, summary)
         else if (is_transient) then
            call estimate_in_time(values, i, dx, summary%of(i))
         else
            call estimate_at_rest(values, i, dx, ieee_is_finite(summary%crests%spike), &
               summary%of(i))
         end if
      end do
   end subroutine estimate_grid_errors

   !> Row `i` on n, n/2, n/4 and n/8 intervals, as far as known.
   pure function on_levels(values, i, full) result(levels)
      type(coarse_values_t), intent(in) :: values
      integer, intent(in) :: i
      type(quantity_t), intent(in) :: full
      type(quantity_t) :: levels(4)

      levels = new_quantity(i, [not_known(), not_known()], 0.0_wp)
      levels(1) = full
      levels(2:1 + values%grids) = values%coarser(:values%grids)%of(i)
   end function on_levels

   !> Error of row `i` of a transient by grid and time step, from values between nodes.
   pure subroutine estimate_in_time(values, i, dx, quantity)
      type(coarse_values_t), intent(in) :: values
      integer, intent(in) :: i
      real(wp), intent(in) :: dx
      type(quantity_t), intent(inout) :: quantity
      type(quantity_t) :: levels(4)
      real(wp) :: limit, error

      levels = on_levels(values, i, quantity)
      if (values%is_first_order) levels(1) = values%second_order%of(i)
      limit = limit_in_time(levels(:3)%between)
      error = error_in_time(levels(:3)%between)
      if (values%is_first_order) error = error_by_reference(quantity%between, limit, error)
      quantity%error_grid = error + abs(quantity%value - quantity%between)
      if (quantity_rows(i)%rule == rule_between) then
         quantity%error_grid = quantity%error_grid + exit_jitter*dx
      else
         quantity%extrapolated = limit
      end if
   end subroutine estimate_in_time

   !> Error of the largest nodal pressure, from maxima of parabolas.
   pure subroutine estimate_pressure(values, is_transient, summary)
      type(coarse_values_t), intent(in) :: values
      logical, intent(in) :: is_transient
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: tops(3), nodes(3)
      integer :: k

      tops = not_known()
      tops(1) = top_of(summary%crests)
      if (is_transient .and. values%is_first_order) tops(1) = top_of(values%second_order%crests)
      do k = 1, min(values%grids, 2)
         tops(1 + k) = top_of(values%coarser(k)%crests)
      end do
      if (is_transient) then
         call estimate_crest_in_time(values%is_first_order, tops, summary%crests%highest, &
            summary%of(p_max))
      else if (all(ieee_is_finite(tops))) then
         nodes = [summary%of(p_max)%value, values%coarser(:2)%of(p_max)%value]
         call estimate_crest(tops, nodes, summary%of(p_max))
      end if
   end subroutine estimate_pressure

   !> Error of row `i` of a steady contact by the grid. With a pressure spike, whose position is
   !> known to one spacing, an observed order of the smallest film does not persist.
   pure subroutine estimate_at_rest(values, i, dx, is_spiked, quantity)
      type(coarse_values_t), intent(in) :: values
      integer, intent(in) :: i
      real(wp), intent(in) :: dx
      logical, intent(in) :: is_spiked
      type(quantity_t), intent(inout) :: quantity
      type(quantity_t) :: levels(4)
      real(wp) :: bounds(2), between(2), own(2)
      logical :: lasts

      bounds = merge(quantity_rows(i)%kappa_orders, orders, values%is_kappa)
      lasts = .not. (is_spiked .and. is_chance(quantity_rows(i)) &
         .or. quantity_rows(i)%field == 'temperature_rise')   ! a maximum that moves with the nodes
      levels = on_levels(values, i, quantity)
      own = error_on_grids(levels%value, bounds, lasts)
      between = error_on_grids(levels%between, bounds, lasts)
      if (i == h_central) then   ! on a line between two nodes, whose error has a sign
         own = [between(1) + abs(quantity%value - quantity%between), between(2)]
         if (ieee_is_finite(between(2))) own(1) = max(between(1)/(2*safety), between(1) &
            + abs(quantity%value - between(2)) - abs(quantity%between - between(2)))
      end if
      between(1) = between(1) + abs(quantity%value - quantity%between)
      select case (quantity_rows(i)%rule)
      case (rule_node)
         own(1) = larger(own(1), between(1))
      case (rule_between)
         own = [between(1) + exit_jitter*dx, quantity%between]
      case (rule_first)
         own = [dx + error_from_levels(max(abs(levels(1)%value - levels(2)%value) - dx, 0.0_wp), &
            0.0_wp, orders(2)), not_known()]
      case default   ! its own values are enough, or what is known of them
      end select
      if (allocated(values%other_scheme) .and. is_chance(quantity_rows(i))) own(1) = &
         error_by_other_scheme(values, i) + abs(quantity%value - quantity%between)
      ! loads that fall from grid to grid do not fall below 0
      if (any(i == [asperity_share, boundary_friction]) .and. own(1) > quantity%value &
         .and. levels(2)%value > quantity%value) own = [quantity%value, not_known()]
      quantity%error_grid = own(1)
      quantity%extrapolated = own(2)
   end subroutine estimate_at_rest

   !> Error of row `i` by the kappa scheme between nodes: a share of the error by upwind2, which
   !> falls regularly.
   pure function error_by_other_scheme(values, i) result(error)
      type(coarse_values_t), intent(in) :: values
      integer, intent(in) :: i
      real(wp) :: error, films(4), error_and_limit(2)
      integer :: known

      films = not_known()
      known = min(size(values%other_scheme), 3)
      films(:known) = values%other_scheme(:known)%of(i)%between
      error_and_limit = error_on_grids(films, orders, lasts=.true.)
      error = kappa_share/safety*error_and_limit(1)
   end function error_by_other_scheme

end module grid_estimates

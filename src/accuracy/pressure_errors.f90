!> Errors of the largest pressure and of sliding friction, from crests on coarser grids and from the
!> growth of spikes: where the oil leaves high pressure half-spaces let it rise as A/sqrt(distance),
!> down to the longer one of two lengths l_flow and l_density, which fall as the pressure rises
!> (docs/theory.md, error estimates). l_flow has the S of the top or of the flank, of the slope
!> P/l_flow: without sliding an Eyring oil thins only there.
!>
!> The numbers come from 90 contacts (M_sum 0.1 to 2000, L_sum 0.5 to 35, all laws) on 64 to 262144
!> intervals. If an oil thins, its flanks meet in a corner: the top is up to half a spacing from the
!> node, hence c_flow = 1/2, half of it by the safety factor. If such a corner is less steep than a
!> spike, the grid shows how high it may be (`corner_top` of line_summary).
module pressure_errors
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use flow_law, only: largest_exponent
   use grid_errors, only: error_from_levels, error_on_grids, observed_order, orders, safety
   use kinds, only: exceeds, larger, not_known, pi, wp
   use line_summary, only: crests_t, line_summary_t, quantity_t
   use lubricant, only: fluid_density, fluid_t, fluid_viscosity, ln_slip, thins, &
      viscosity_constant, wall_stress
   use quantities, only: friction_coefficient, h_central, oil_friction, p_max, sheared_rows, &
      sliding_power, sliding_rows
   implicit none (type, external)
   private

   public :: allow_for_spike, ceiling_of_spike, doubt_shear, doubt_spike, estimate_crest, &
      final_height, shear_doubt, shear_of_spike, smoothing_lengths, &
      spike_law_t, top_of

   !> c_flow, that of an oil that thins, c_density and its power.
   real(wp), parameter :: flow_growth = 0.15_wp, corner_growth = 0.5_wp, density_growth = 1.1_wp, &
      density_power = 2.0_wp/3.0_wp
   !> c_flow and c_density of the part that grows: of 19 point contacts on 64 to 1024 intervals.
   real(wp), parameter :: part_growth(2) = [0.7_wp, 2.2_wp]
   !> A spike below the crest of the contact counts as passing it if this share of its growth would.
   real(wp), parameter :: sure_share = 1.0_wp/3.0_wp
   !> A in units of H_c^(2/3): height of the top node of a spike that a grid does not show.
   real(wp), parameter :: edge_strength = 0.5_wp
   !> Largest final height over that of the node that is searched for, steps of that search, and the
   !> largest one that is claimed (`max_claimed`).
   real(wp), parameter :: highest_growth = 20.0_wp, max_claimed = 3.0_wp
   integer, parameter :: max_steps = 200
   !> Halvings of the bracket of ln l_flow.
   integer, parameter :: bisections = 40
   !> Intervals of the integral over a spike.
   integer, parameter :: parts = 40
   !> A height without bound.
   real(wp), parameter, public :: endless = huge(1.0_wp)
   !> Relative accuracy of a height.
   real(wp), parameter :: accuracy = 1.0e-6_wp

   !> What the height of a spike depends on: the lubricant and lambda of (2.55).
   type :: spike_law_t
      type(fluid_t) :: fluid
      real(wp) :: lambda = 0.0_wp
   end type spike_law_t

   !> Factor on an estimate, in place of `safety`.
   real(wp), parameter, public :: pressure_safety = 2.0_wp
   !> Sliding friction errs by up to this many times what a spike may add to it; not known if that
   !> exceeds the second share of it.
   real(wp), parameter :: shear_safety = 12.0_wp, largest_shear_growth = 0.02_wp
   !> This share of them where the part of the spike that grows is known.
   real(wp), parameter :: share_of_part = 0.25_wp
   !> The largest share that friction may err by, and be known.
   real(wp), parameter, public :: largest_doubt = shear_safety*largest_shear_growth

contains

   !> The largest pressure that a spike may reach on grids finer than `dx`; 0 if it stays below the
   !> other crests, or if the grid shows none but a smooth crest, and would resolve it; NaN: not
   !> known. `film`: H at X = 0.
   pure function ceiling_of_spike(law, crests, film, dx) result(ceiling)
      type(spike_law_t), intent(in) :: law
      type(crests_t), intent(in) :: crests
      real(wp), intent(in) :: film, dx
      real(wp) :: ceiling, start, height, crest, lengths(2)
      logical :: is_corner

      ! at one of several times the corner lies at a node
      is_corner = thins(law%fluid) .and. crests%corner_top >= 0.0_wp
      ceiling = 0.0_wp
      if (law%lambda <= 0.0_wp) return
      if (ieee_is_finite(crests%spike)) then
         height = final_height(law, crests%spike, crests%spike_film, dx, is_corner, crests%growing)
         crest = larger(0.0_wp, crests%other)
         ceiling = height
         if (height < endless) ceiling = crests%spike + pressure_safety*(height - crests%spike)
         if (ceiling <= crest) then
            ceiling = 0.0_wp
         else if (any([height > max_claimed*crests%spike, crests%spike + sure_share &
            *(height - crests%spike) <= crest])) then
            ceiling = not_known()
         end if
         if (exceeds(ceiling, crests%limit)) ceiling = crests%limit
      end if
      if (.not. ieee_is_finite(crests%spike) .or. crests%limit < endless) then
         start = edge_strength*film**(2.0_wp/3.0_wp)/sqrt(dx)
         lengths = smoothing_lengths(law, min(start, crests%highest), film)
         if (lengths(1) < dx) then
            height = final_height(law, start, film, dx, is_corner)
            if (height > crests%highest) ceiling = not_known()
         end if
      end if
      if (.not. all([ieee_is_finite(ceiling), is_corner, crests%limit >= endless])) return
      if (crests%corner_top <= max(ceiling, crests%highest)) return
      ceiling = crests%corner_top
      height = crests%corner + sure_share*(ceiling - crests%corner)
      if (height <= crests%highest) ceiling = not_known()
   end function ceiling_of_spike

   !> Largest increase by a spike of Int (mu/mu_0)/H dX, the shear of a Newtonian oil, on grids
   !> finer than `dx`; `endless` without a bound, 0 if the grid would resolve it. `film`: H at X =
   !> 0.
   !>
   !> P = B + A sqrt(dX/distance), B = 0 of a line, from the distance dX, that of the top node, to
   !> that of the final height, and constant closer to the edge:
   !>
   !>     dX/H ( q^2 mu(B + A/q) + 2 Int_q^1 mu(B + A/r) r dr - mu(P_node) ) ,  q = A/(P_end - B)
   pure function shear_of_spike(law, crests, film, dx) result(growth)
      type(spike_law_t), intent(in) :: law
      type(crests_t), intent(in) :: crests
      real(wp), intent(in) :: film, dx
      real(wp) :: growth, top, gap, height, lengths(2), part, share
      real(wp), dimension(0:parts) :: place, mu, weights
      integer :: i

      growth = 0.0_wp
      top = edge_strength*film**(2.0_wp/3.0_wp)/sqrt(dx)
      gap = film
      part = crests%growing
      if (ieee_is_finite(crests%spike)) then
         top = crests%spike
         gap = crests%spike_film
      else
         lengths = smoothing_lengths(law, min(top, crests%highest), film)
         if (lengths(1) >= dx) return
      end if
      height = final_height(law, top, gap, dx, growing=part)
      growth = endless
      if (height >= endless) return
      if (part <= 0.0_wp) part = top
      share = part/(part + pressure_safety*(height - top))
      ! Simpson's rule
      place = [(share + (1 - share)*i/parts, i=0, parts)]
      weights = [1, (merge(4, 2, modulo(i, 2) == 1), i=1, parts - 1), 1]
      call fluid_viscosity(law%fluid, top - part + part/place, mu)
      if (mu(0) > largest_exponent) return
      mu = exp(mu)
      growth = dx/gap*(share**2*mu(0) - mu(parts) + 2*(1 - share)/(3*parts)*sum(weights*mu*place))
   end function shear_of_spike

   !> Final height of a spike whose top node on a grid of spacing `dx` has this `pressure` and
   !> `film`; `endless` if none is found. `is_corner`: its flanks may meet in a corner; `growing`:
   !> the part that grows, if not 0.
   pure function final_height(law, pressure, film, dx, is_corner, growing) result(height)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: pressure, film, dx
      logical, intent(in), optional :: is_corner
      real(wp), intent(in), optional :: growing
      real(wp) :: height, next, growth, part
      real(wp), dimension(2) :: lengths, tops
      integer :: i

      growth = flow_growth
      if (present(is_corner)) growth = merge(corner_growth, flow_growth, is_corner)
      part = 0.0_wp
      if (present(growing)) part = growing
      height = pressure
      do i = 1, max_steps
         lengths = max(smoothing_lengths(law, height, film)/dx, tiny(1.0_wp))
         tops = sqrt(1.0_wp + min([growth, part_growth(1)]/lengths(1), [density_growth, &
            part_growth(2)]/lengths(2)**density_power))
         next = pressure*tops(1)
         if (part > 0.0_wp) next = min(next, pressure + part*(tops(2) - 1.0_wp))
         if (next > highest_growth*pressure) exit
         if (next - height <= accuracy*height) then
            height = next
            return
         end if
         height = next
      end do
      height = endless
   end function final_height

   !> [l_flow, l_density] at a pressure and a film, [b].
   pure function smoothing_lengths(law, pressure, film) result(lengths)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: pressure, film
      real(wp) :: lengths(2)
      real(wp), dimension(1) :: ln_mu, rho, drho

      call fluid_viscosity(law%fluid, [pressure], ln_mu)
      call fluid_density(law%fluid, [pressure], rho, drho)
      lengths(1) = exp(0.5_wp*(3*log(film) - ln_mu(1) - log(law%lambda)))
      if (thins(law%fluid)) lengths(1) = thinned_length(law%fluid, pressure, film, ln_mu(1), &
         lengths(1))
      lengths(2) = film*drho(1)/rho(1)
   end function smoothing_lengths

   !> l_flow of an oil that thins from that by its viscosity alone, `thick`: with S of the top or,
   !> if larger, of the slope P/l_flow of the flank, by bisection.
   pure function thinned_length(fluid, pressure, film, ln_mu, thick) result(length)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: pressure, film, ln_mu, thick
      real(wp) :: length, lower, upper, middle, fall
      real(wp) :: ln_s(2)
      integer :: i

      fall = film*pressure
      ln_s(1) = ln_slip(fluid, 0.0_wp, film, ln_mu)
      lower = log(thick) + 0.5_wp*ln_s(1)
      upper = max(lower + 1.0_wp, log(wall_stress(fluid, fall)))
      do i = 1, bisections
         middle = 0.5_wp*(lower + upper)
         ln_s(2) = ln_slip(fluid, fall*exp(-middle), film, ln_mu)
         if (middle < log(thick) + 0.5_wp*maxval(ln_s)) then
            lower = middle
         else
            upper = middle
         end if
      end do
      length = exp(lower)
   end function thinned_length

   !> The maximum of P that is compared between grids: the largest but for a spike that is lower.
   pure elemental real(wp) function top_of(crests) result(top)
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
      real(wp) :: found(2), order

      found = error_on_grids(values, orders, lasts=.true.)
      quantity%error_grid = pressure_safety/safety*found(1) + abs(values(1) - quantity%value)
      quantity%extrapolated = found(2)
      if (.not. (nodes(1) > nodes(2) .and. nodes(2) > nodes(3))) return
      order = observed_order(nodes(1), nodes(2), nodes(3), orders)
      quantity%error_grid = max(quantity%error_grid, error_from_levels(nodes(1), nodes(2), order))
   end subroutine estimate_crest

   !> Adds to the error of the largest pressure what a spike may grow above it, or is not known.
   pure subroutine allow_for_spike(law, dx, summary)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: ceiling

      if (.not. ieee_is_finite(summary%crests%highest) &
         .or. .not. ieee_is_finite(summary%of(p_max)%error_grid)) return
      ceiling = ceiling_of_spike(law, summary%crests, summary%of(h_central)%value, dx)
      associate (pressure => summary%of(p_max))
         if (ieee_is_finite(ceiling)) then
            if (ceiling <= pressure%value + pressure%error_grid) return
         end if
         pressure%error_grid = ceiling - pressure%value   ! or not known
         pressure%extrapolated = not_known()
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
         if (summary%crests%growing > 0.0_wp) doubt = share_of_part*doubt
      end associate
   end function shear_doubt

   !> Raises the error of the sliding friction of `summary` to what a spike may add to it.
   pure subroutine doubt_shear(law, dx, summary)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      real(wp) :: doubt, least
      integer :: i

      doubt = shear_doubt(law, dx, summary, friction_coefficient)
      do i = 1, size(sheared_rows)
         if (sheared_rows(i) == oil_friction .and. summary%of(oil_friction)%value > 0.0_wp) doubt &
            = shear_doubt(law, dx, summary, oil_friction)   ! also of the rows behind it
         associate (quantity => summary%of(sheared_rows(i)))
            least = not_known()
            if (ieee_is_finite(doubt)) then
               least = doubt*abs(quantity%value)
               if (.not. exceeds(least - quantity%error_grid, 0.0_wp)) cycle
            end if
            quantity%error_grid = least
            quantity%extrapolated = not_known()
         end associate
      end do
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

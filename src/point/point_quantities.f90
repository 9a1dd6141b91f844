!> Main quantities of a point contact in the table of line contacts (module quantities), those of a
!> line on y = 0, and their errors from the grids of its nested start and a longer domain.
module point_quantities
   use constants, only: pi
   use friction_sums, only: friction_t
   use grid_errors, only: error_on_grids, orders, safety
   use kinds, only: wp
   use line_summary, only: line_summary_t, new_quantity, summary_of_fields
   use lubricant, only: fluid_viscosity
   use missing_value, only: exceeds, not_known
   use point_contact, only: point_contact_t
   use point_level, only: load_on, point_level_t
   use pressure_errors, only: allow_for_spike, shear_doubt
   use pressure_spike, only: spike_law_t
   use quantities, only: central_by_cubic, central_value, exit_between_nodes, exit_position, &
      friction_coefficient, h_central, h_min, h_min_node, p_central, p_max, quantity_count, &
      quantity_rows, rolling_coefficient, rolling_power, rule_between, sliding_power, &
      sliding_rows, x_cavitation
   use reynolds_limits, only: unknown_limits
   use rheology, only: evaluate_stress, limited_stress
   implicit none (type, external)
   private

   public :: estimate_point_errors, paraboloid_minimum, summary_of_point

contains

   !> Quantities of the level; `slide_to_roll` = 2 (u2 - u1)/(u1 + u2), NaN: not known. Forces over
   !> the load in a/Rx, powers in p_h a^3/Rx u_s.
   pure function summary_of_point(level, contact, slide_to_roll) result(summary)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: slide_to_roll
      type(line_summary_t) :: summary
      type(friction_t) :: forces
      real(wp) :: load, values(2, quantity_count)
      integer :: i

      associate (x => level%x, p => level%pressure(:, level%ny/2), h => level%film(:, level%ny/2))
         summary = summary_of_fields(x, p, h, 0.0_wp)
      end associate
      values = 0.0_wp
      forces = forces_of(level, contact, slide_to_roll, 1, level%ny - 1)
      load = load_on(level, level%pressure)
      associate (x => level%x, p => level%pressure(:, level%ny/2), h => level%film(:, level%ny/2))
         values(:, h_min) = paraboloid_minimum(level%film)
         values(:, h_min_node) = [minval(level%film), values(1, h_min)]
         values(:, h_central) = central_value(x, h)
         values(:, p_max) = maxval(level%pressure)
         values(:, p_central) = central_by_cubic(x, p)
         values(:, x_cavitation) = [exit_position(x, p), exit_between_nodes(x, p)]
      end associate
      values(:, friction_coefficient) = abs(forces%sliding)/load
      values(:, rolling_coefficient) = forces%rolling/load
      values(:, sliding_power) = forces%sliding*0.5_wp*slide_to_roll
      values(:, rolling_power) = forces%rolling_power
      do i = 1, quantity_count
         summary%of(i) = new_quantity(i, values(:, i), 0.0_wp)
      end do
      summary%limits = unknown_limits()
      summary%of(sliding_rows)%error_grid = summary%of(sliding_rows)%value*shear_on_middle(level, &
         contact, slide_to_roll, summary)
   end function summary_of_point

   !> Share of the friction on y = 0 that a spike there may add on finer grids; NaN: not known.
   pure real(wp) function shear_on_middle(level, contact, slide_to_roll, summary) result(share)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: slide_to_roll
      type(line_summary_t), intent(in) :: summary
      type(line_summary_t) :: line
      type(friction_t) :: forces

      forces = forces_of(level, contact, slide_to_roll, level%ny/2, level%ny/2)
      line = summary
      line%of(friction_coefficient)%value = abs(forces%sliding)/level%hy*2/pi
      line%of(sliding_power)%value = forces%sliding/level%hy*0.5_wp*slide_to_roll
      share = shear_doubt(spike_law_t(contact%fluid, contact%lambda), level%hx, line, &
         friction_coefficient)
   end function shear_on_middle

   !> Forces and the power of flow by the pressure, over the nodes with pressure of the rows `first`
   !> to `last`.
   pure function forces_of(level, contact, slide_to_roll, first, last) result(forces)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: slide_to_roll
      integer, intent(in) :: first, last
      type(friction_t) :: forces
      real(wp), dimension(0:level%nx) :: ln_mu, stress
      real(wp) :: flow, slope(2)
      integer :: i, j

      associate (p => level%pressure, h => level%film, dx => level%hx, dy => level%hy)
         each_row: do j = first, last
            call fluid_viscosity(contact%fluid, p(:, j), ln_mu)
            call evaluate_stress(contact%fluid, contact%lambda/12*slide_to_roll, 0*ln_mu, &
               1/h(:, j), ln_mu, stress)
            stress = limited_stress(contact%fluid, p(:, j), stress)
            each_node: do i = 1, level%nx - 1
               if (.not. p(i, j) > 0.0_wp) cycle each_node
               slope = [0.5_wp*(p(i + 1, j) - p(i - 1, j))/dx, 0.5_wp*(p(i, j + 1) - p(i, j &
                  - 1))/dy]
               flow = 0.5_wp*h(i, j)**3*exp(-ln_mu(i))/contact%lambda
               forces%sliding = forces%sliding + dx*dy*stress(i)
               forces%rolling = forces%rolling + dx*dy*0.5_wp*h(i, j)*slope(1)
               forces%rolling_power = forces%rolling_power + dx*dy*flow*sum(slope**2)
            end do each_node
         end do each_row
      end associate
   end function forces_of

   !> Smallest value inside: of the paraboloid by least squares through the nine nodes around the
   !> smallest one, or that node if the vertex lies outside of its neighbours.
   pure real(wp) function paraboloid_minimum(h) result(smallest)
      real(wp), intent(in) :: h(:, :)
      real(wp) :: bend(2), c, cross, slope(2), vertex(2), z(-1:1, -1:1)
      integer :: place(2)

      place = minloc(h(2:size(h, 1) - 1, 2:size(h, 2) - 1)) + 1
      z = h(place(1) - 1:place(1) + 1, place(2) - 1:place(2) + 1)
      smallest = z(0, 0)
      slope = [sum(z(1, :) - z(-1, :)), sum(z(:, 1) - z(:, -1))]/6
      bend = [sum(z(1, :) + z(-1, :)), sum(z(:, 1) + z(:, -1))]/2 - sum(z)/3
      cross = (z(1, 1) + z(-1, -1) - z(1, -1) - z(-1, 1))/4
      c = 4*bend(1)*bend(2) - cross**2
      if (.not. c > 0.0_wp) return
      vertex = [cross*slope(2) - 2*bend(2)*slope(1), cross*slope(1) - 2*bend(1)*slope(2)]/c
      if (all(abs(vertex) < 1.0_wp)) smallest = sum(z)/9 - 2*sum(bend)/3 + 0.5_wp &
         *dot_product(slope, vertex)
   end function paraboloid_minimum

   !> Sets the errors of `summary` from those on half and a quarter of the intervals and so on,
   !> `coarser`, from the residual, and from `near` and `far`, the domain and a longer one on the
   !> same coarse grid; without coarser grids they are not known. A spike may add to pressure and
   !> friction what it does to those of a line contact on y = 0.
   pure subroutine estimate_point_errors(summary, contact, coarser, residual, near, far)
      type(line_summary_t), intent(inout) :: summary
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: coarser(:)
      real(wp), intent(in) :: residual
      type(line_summary_t), intent(in), optional :: near, far
      real(wp) :: both(2), spike, values(4)
      integer :: i, k

      do i = 1, quantity_count
         associate (of => summary%of(i))
            values = not_known()
            values(1) = of%between
            do k = 1, min(size(coarser), 3)
               values(1 + k) = coarser(k)%of(i)%between
            end do
            both = error_on_grids(values, orders, lasts=.true.)
            spike = 0.0_wp
            if (any(i == sliding_rows)) spike = of%error_grid
            of%error_grid = quantity_rows(i)%widening*both(1) + abs(of%value - of%between)
            if (i == h_min) of%error_grid = of%error_grid + abs(of%value &
               - summary%of(h_min_node)%value)
            if (.not. exceeds(of%error_grid - abs(spike), 0.0_wp)) of%error_grid = abs(spike)
            if (quantity_rows(i)%rule /= rule_between) of%extrapolated = both(2)
         end associate
      end do
      call allow_for_spike(spike_law_t(contact%fluid, contact%lambda), (contact%domain%x_outlet &
         - contact%domain%x_inlet)/contact%domain%nx, summary)
      do i = 1, quantity_count
         associate (of => summary%of(i))
            if (present(near) .and. present(far)) of%error_domain = safety*abs(near%of(i)%between &
               - far%of(i)%between)
            of%error_iteration = residual*abs(of%value)
            of%error_estimate = of%error_grid + of%error_domain + of%error_iteration
         end associate
      end do
   end subroutine estimate_point_errors

end module point_quantities

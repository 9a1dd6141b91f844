!> The main quantities of a lubricated line contact: smallest and central film, largest and central
!> pressure, exit, friction. One table defines them; the summary of a state, extremes over time,
!> error estimates, predictions, checkpoints, results and the closing table use it.
!>
!> Dimensionless (H, P, X; forces and powers as in module film_shear). A quantity that cannot be
!> known is NaN, never a number that looks like an answer.
module quantities
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use line_state, only: friction_t
   use kinds, only: not_known, pi, wp
   implicit none (type, external)
   private

   public :: bend_of, central_by_cubic, central_value, exit_between_nodes, exit_position, &
      is_chance, node_minimum, node_spacings, parabola_extreme, parabola_minimum, &
      paraboloid_minimum, quantity_values, smallest_film

   !> Rows of the table.
   integer, parameter, public :: h_min = 1, h_min_node = 2, h_central = 3, p_max = 4, &
      p_central = 5, x_cavitation = 6, friction_coefficient = 7, rolling_coefficient = 8, &
      sliding_power = 9, rolling_power = 10, asperity_share = 11, oil_friction = 12, &
      boundary_friction = 13, meniscus = 14, film_rise = 15, rise_1 = 16, rise_2 = 17

   !> How the error of a quantity is estimated from other grids. `rule_value`: by its values, in a
   !> transient by those between the nodes. `rule_node`: by both, plus their distance.
   !> `rule_between`: by those between the nodes, plus their distance; the value between the nodes
   !> counts as extrapolated. `rule_crest`: by the crests of the pressure, and the possible growth
   !> of a spike. `rule_first`: a node that is known to a spacing.
   integer, parameter :: rule_value = 1
   integer, parameter, public :: rule_node = 2, rule_between = 3, rule_crest = 4, rule_first = 5

   !> One quantity.
   type, public :: quantity_row_t
      !> Name in the result.
      character(len=29) :: name
      !> Name in the closing table; empty: not there.
      character(len=9) :: short
      !> The field of /solution whose unit it has; the effect of an inlet too near follows from it,
      !> too.
      character(len=20) :: field
      !> Text of its data set.
      character(len=80) :: text
      !> Extreme that counts over several times: 'smallest' or 'largest'.
      character(len=8) :: extreme = 'largest'
      integer :: rule = rule_value
      !> Bounds of its observed order in space in the kappa scheme: at a spike that of h_min is
      !> random, and h_central converges faster than with the second order.
      real(wp) :: kappa_orders(2) = [1.0_wp, 2.0_wp]
      !> Factor that widens its estimate.
      real(wp) :: widening = 1.0_wp
   end type quantity_row_t

   real(wp), parameter :: random(2) = 1.0_wp
   type(quantity_row_t), parameter, public :: quantity_rows(*) = [ &
      quantity_row_t('h_min', 'h_min', 'film_thickness', &
         'smallest film thickness, of a parabola between nodes', 'smallest', rule_value, random), &
      quantity_row_t('h_min_node', '', 'film_thickness', 'smallest film thickness of a node', &
         'smallest', rule_node, random), &
      quantity_row_t('h_central', 'h_central', 'film_thickness', &
         'film thickness at X = 0, linear between nodes', 'smallest', rule_value, &
         [1.0_wp, 2.5_wp]), &
      quantity_row_t('p_max', 'p_max', 'pressure', 'largest pressure of a node', &
         rule=rule_crest), &
      quantity_row_t('p_central', 'p_central', 'pressure', &
         'pressure at X = 0, away from a spike; cubic between nodes', widening=2.0_wp), &
      quantity_row_t('x_cavitation', '', 'x', &
         'last node with P > 0 (extrapolated: exit between nodes)', rule=rule_between), &
      quantity_row_t('friction_coefficient', 'friction', 'friction_coefficient', &
         'force of sliding over the load (dimensionless: times R/b)'), &
      quantity_row_t('rolling_friction_coefficient', '', 'friction_coefficient', &
         'force of rolling on each surface over the load (dimensionless: times R/b)'), &
      quantity_row_t('sliding_power', '', 'power', 'power that sliding turns into heat'), &
      quantity_row_t('rolling_power', '', 'power', &
         'power that flow by the pressure turns into heat', widening=1.5_wp), &
      quantity_row_t('asperity_load_share', '', '1', 'share of the load that asperities bear'), &
      quantity_row_t('friction_coefficient_oil', '', 'friction_coefficient', &
         'part of friction_coefficient, of the oil'), &
      quantity_row_t('friction_coefficient_boundary', '', 'friction_coefficient', &
         'part of friction_coefficient, of asperities'), &
      quantity_row_t('x_meniscus', '', 'x', 'first node where oil fills the gap', &
         rule=rule_first), &
      quantity_row_t('temperature_rise_film', '', 'temperature_rise', &
         'largest mean temperature rise across the film'), &
      quantity_row_t('temperature_rise_1', '', 'temperature_rise', &
         'largest temperature rise of surface 1'), &
      quantity_row_t('temperature_rise_2', '', 'temperature_rise', &
         'largest temperature rise of surface 2')]

   integer, parameter, public :: quantity_count = size(quantity_rows)

   !> Rows that are not known if the speeds of the surfaces are not.
   integer, parameter, public :: sliding_rows(*) = [friction_coefficient, sliding_power]
   !> These and the oil's part of them, which a model of temperatures moves most; with the
   !> temperatures all rows that the stress of the oil moves.
   integer, parameter, public :: heated_rows(*) = [sliding_rows, oil_friction], &
      sheared_rows(*) = [heated_rows, film_rise, rise_1, rise_2]
   !> Rows of contacts with asperities, that starve or are warm, alone; 0 for others, not reported.
   integer, parameter, public :: mixed_rows(*) = [asperity_share, oil_friction, &
      boundary_friction, meniscus, film_rise, rise_1, rise_2]

contains

   !> Whether the order of a quantity in the kappa scheme is random: its change on a finer grid then
   !> says little.
   pure logical function is_chance(row)
      type(quantity_row_t), intent(in) :: row

      is_chance = row%kappa_orders(2) <= row%kappa_orders(1)
   end function is_chance

   !> All quantities of pressure `p` and film `h` on the nodes `x` of a rising grid, each (nx), of
   !> `total`, which asperities bear too, and of the `friction`: values and those between the nodes,
   !> which do not depend on their position (2, quantity). The same number twice if there is no
   !> other; for the pressure the crests replace it.
   pure function quantity_values(x, p, h, total, friction) result(values)
      real(wp), intent(in) :: x(:), p(:), h(:), total(:)
      type(friction_t), intent(in) :: friction
      real(wp) :: values(2, quantity_count)

      values(:, h_min) = parabola_minimum(x, h)
      values(:, h_min_node) = [node_minimum(h), values(1, h_min)]
      values(:, h_central) = [central_value(x, h), central_by_cubic(x, h)]
      values(:, p_max) = -node_minimum(-total)
      values(:, p_central) = central_by_cubic(x, total)
      values(:, x_cavitation) = [exit_position(x, p), exit_between_nodes(x, p)]
      associate (force => friction%sliding + friction%boundary, load => friction%load)
         values(:, friction_coefficient) = abs(force)*2/pi/load
         values(:, rolling_coefficient) = friction%rolling*2/pi/load
         values(:, sliding_power) = friction%sliding_speed*force
         values(:, oil_friction) = merge(abs(friction%sliding)*2/pi/load, 0.0_wp, &
            friction%asperity_share > 0.0_wp)
         values(:, boundary_friction) = abs(friction%boundary)*2/pi/load
      end associate
      values(:, rolling_power) = friction%rolling_power
      values(:, asperity_share) = friction%asperity_share
      values(:, meniscus) = friction%meniscus
      values(:, film_rise:rise_2) = spread(friction%rise, 1, 2)
   end function quantity_values

   !> Smallest value of a positive curve on the nodes of a rising grid: vertex of the parabola
   !> through the smallest node and its neighbours; the node itself at an end, or where the vertex
   !> of a film that nearly closes would be negative; NaN if a value is not finite. x, h (nx).
   pure function parabola_minimum(x, h) result(smallest)
      real(wp), intent(in) :: x(:), h(:)
      real(wp) :: smallest, vertex
      integer :: i

      smallest = node_minimum(h)
      if (.not. ieee_is_finite(smallest)) return
      i = minloc(h, dim=1)
      if (i == 1 .or. i == size(h)) return
      vertex = parabola_extreme(x(i - 1:i + 1), h(i - 1:i + 1))
      if (vertex > 0.0_wp .or. smallest <= 0.0_wp) smallest = vertex
   end function parabola_minimum

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

   !> Smallest film between the nodes, of a line on nodes x (nx) or of an area on (nx, ny), x
   !> fastest.
   pure real(wp) function smallest_film(x, h) result(smallest)
      real(wp), intent(in) :: x(:), h(:)

      if (size(h) == size(x)) then
         smallest = parabola_minimum(x, h)
      else
         smallest = paraboloid_minimum(reshape(h, [size(x), size(h)/size(x)]))
      end if
   end function smallest_film

   !> Vertex of the parabola through three values on rising nodes, the middle one the smallest or
   !> the largest; on a line the middle value.
   pure function parabola_extreme(x, values) result(vertex)
      real(wp), intent(in) :: x(3), values(3)
      real(wp) :: vertex, gap(2), q, slope, bend

      gap = node_spacings(x)
      q = gap(1)/gap(2)
      slope = (q*values(3) - values(1)/q)/(1 + q) + values(2)*(1 - q)/q
      bend = bend_of(x, values)
      vertex = values(2)
      if (abs(bend) > 0.0_wp) vertex = vertex - 0.5_wp*slope**2/bend
   end function parabola_extreme

   !> Spacings of rising nodes x (nx), (nx - 1): the same number each if they differ by round-off.
   pure function node_spacings(x) result(gap)
      real(wp), intent(in) :: x(:)
      real(wp), parameter :: round_off = 1.0e-9_wp
      real(wp) :: gap(size(x) - 1), mean

      mean = (x(size(x)) - x(1))/size(gap)
      gap = x(2:) - x(:size(gap))
      gap = merge(mean, gap, abs(gap - mean) < round_off*mean)
   end function node_spacings

   !> Second derivative of the parabola through three values on rising nodes; unit: right spacing.
   pure function bend_of(x, values) result(bend)
      real(wp), intent(in) :: x(3), values(3)
      real(wp) :: bend, gap(2), q

      gap = node_spacings(x)
      q = gap(1)/gap(2)
      bend = 2*(values(3)/(1 + q) - values(2)/q + values(1)/(q*(1 + q)))
   end function bend_of

   !> Smallest nodal value; NaN if a value is not finite. h (nx).
   pure real(wp) function node_minimum(h) result(smallest)
      real(wp), intent(in) :: h(:)

      smallest = not_known()
      if (size(h) > 0 .and. all(ieee_is_finite(h))) smallest = minval(h)
   end function node_minimum

   !> Value at X = 0, linear between the nodes of a rising grid; NaN if the grid does not reach it.
   !> x, h (nx).
   pure real(wp) function central_value(x, h) result(film)
      real(wp), intent(in) :: x(:), h(:)
      integer :: i

      film = not_known()
      i = count(x <= 0.0_wp)
      if (i == 0) return
      if (x(i) >= 0.0_wp) then
         film = h(i)
      else if (i < size(x)) then
         film = h(i) - x(i)*(h(i + 1) - h(i))/(x(i + 1) - x(i))
      end if
      if (.not. ieee_is_finite(film)) film = not_known()
   end function central_value

   !> Value at X = 0 by the cubic through the two nodes of a rising grid on either side, linear if
   !> there are not four; NaN if the grid does not reach it. x, h (nx).
   pure function central_by_cubic(x, h) result(film)
      real(wp), intent(in) :: x(:), h(:)
      real(wp) :: film, t, a, b, gap(3), weights(4)
      integer :: i

      film = central_value(x, h)
      i = count(x <= 0.0_wp)
      if (i < 2 .or. i + 2 > size(x) .or. .not. ieee_is_finite(film)) return
      ! in the unit of the middle spacing the nodes are at -a, 0, 1 and b
      gap = node_spacings(x(i - 1:i + 2))
      t = -x(i)/(x(i + 1) - x(i))
      a = gap(1)/gap(2)
      b = 1 + gap(3)/gap(2)
      weights = [-t*(t - 1)*(t - b)/(a*(1 + a)*(a + b)), (t + a)*(t - 1)*(t - b)/(a*b), &
         -(t + a)*t*(t - b)/((1 + a)*(b - 1)), (t + a)*t*(t - 1)/((a + b)*b*(b - 1))]
      film = dot_product(weights, h(i - 1:i + 2))
   end function central_by_cubic

   !> X of the last node with P > 0; NaN if there is none or a value is not finite. x, p (nx).
   pure real(wp) function exit_position(x, p) result(position)
      real(wp), intent(in) :: x(:), p(:)
      integer :: i

      position = not_known()
      if (.not. all(ieee_is_finite(p))) return
      i = findloc(p > 0.0_wp, .true., 1, back=.true.)
      if (i > 0) position = x(i)
   end function exit_position

   !> X of the exit between two nodes. There P and dP/dX are zero, so that the root of P is nearly
   !> linear: the zero of the parabola through the roots of P at the last three nodes with P > 0, or
   !> of the line through the last two if that has no zero ahead, at most twice the last spacing
   !> behind the last node. NaN without three such nodes in a row. x, p (nx).
   pure function exit_between_nodes(x, p) result(position)
      real(wp), intent(in) :: x(:), p(:)
      real(wp) :: position, root(3), gap(2), q, slope, bend, discriminant, ahead
      integer :: i

      position = not_known()
      if (.not. all(ieee_is_finite(p))) return
      i = findloc(p > 0.0_wp, .true., 1, back=.true.)
      if (i < 3 .or. i == size(p)) return
      if (.not. all(p(i - 2:i) > 0.0_wp)) return
      root = sqrt(p(i - 2:i))
      gap = node_spacings(x(i - 2:i))
      q = gap(1)/gap(2)
      slope = root(3)*(2 + q)/(1 + q) - root(2)*(1 + q)/q + root(1)/(q*(1 + q))
      bend = bend_of(x(i - 2:i), root)
      discriminant = slope**2 - 2*bend*root(3)
      ahead = 2.0_wp
      if (slope < 0.0_wp .and. discriminant >= 0.0_wp) then
         ahead = 2*root(3)/(sqrt(discriminant) - slope)
      else if (root(3) < root(2)) then
         ahead = root(3)/(root(2) - root(3))
      end if
      position = x(i) + min(ahead, 2.0_wp)*(x(i) - x(i - 1))
   end function exit_between_nodes

end module quantities

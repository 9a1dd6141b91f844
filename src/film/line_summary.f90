!> The figures of a lubricated line contact that everybody asks for first: smallest and central
!> film, largest pressure, exit.
!>
!> Dimensionless (H, P, X, T). Where a figure cannot be known it is NaN, never a number that looks
!> like an answer.
module line_summary
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use kinds, only: wp
   use line_state, only: line_state_t
   implicit none (type, external)
   private

   public :: crests_t, figure_t, keep_extremes, line_summary_t, summary_of, summary_of_fields
   public :: central_by_cubic, central_value, exit_between_nodes, exit_position, node_minimum, &
      parabola_minimum, peak_value

   !> One figure, when it was reached and how far off it may be.
   type :: figure_t
      real(wp) :: value
      !> T at which it was reached; 0 in steady state.
      real(wp) :: time
      !> Estimated error of `value`: the sum of the four below; NaN = not estimated.
      real(wp) :: error_estimate
      !> Richardson's extrapolation of `value`, of x_cavitation the exit between the nodes;
      !> NaN = not known.
      real(wp) :: extrapolated
      !> Because of grid and time step; NaN = not estimated.
      real(wp) :: error_grid
      !> Because the domain ends, and because the iteration does; 0 = not estimated.
      real(wp) :: error_domain = 0.0_wp, error_iteration = 0.0_wp
      !> Because a transient has begun: NaN = the start is in the figure.
      real(wp) :: error_start = 0.0_wp
   end type figure_t

   !> Maxima of P; NaN: there is none.
   type :: crests_t
      !> The largest, and the largest beside the spike, each by the parabola through three nodes.
      real(wp) :: highest, other
      !> The spike, the last maximum before the exit if P falls behind it by the share `spike_drop`
      !> within two spacings: P and H of its top node.
      real(wp) :: spike, spike_film
   end type crests_t

   !> (Of 90 contacts on 64 to 32768 intervals spikes that are not resolved fell by 0.3 and more,
   !> other maxima by 0.02 and less.)
   real(wp), parameter :: spike_drop = 0.25_wp

   !> Figures of one time, or the extremes over several.
   type :: line_summary_t
      !> Smallest H, by the parabola through three nodes.
      type(figure_t) :: h_min
      !> Smallest H of a node.
      type(figure_t) :: h_min_node
      !> H at X = 0; over several times the smallest.
      type(figure_t) :: h_central
      !> The same by the cubic through four nodes, from which the error is estimated: what a line
      !> between two nodes is off depends on where X = 0 lies between them, on every grid another.
      real(wp) :: h_central_cubic
      !> Largest P of a node.
      type(figure_t) :: p_max
      !> X of the last node with P > 0; over several times the largest.
      type(figure_t) :: x_cavitation
      !> What the error of p_max is estimated from; over several times the largest.
      type(crests_t) :: crests
   end type line_summary_t

contains

   !> The figures of one state.
   pure function summary_of(state) result(summary)
      type(line_state_t), intent(in) :: state
      type(line_summary_t) :: summary

      summary = summary_of_fields(state%x, state%pressure, state%film_thickness, state%time)
   end function summary_of

   !> The figures of pressure `p` and film `h` on the nodes `x` of a rising grid at a time, each
   !> (nx).
   pure function summary_of_fields(x, p, h, time) result(summary)
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: p(:)
      real(wp), intent(in) :: h(:)
      real(wp), intent(in) :: time
      type(line_summary_t) :: summary

      summary%h_min = new_figure(parabola_minimum(h), time)
      summary%h_min_node = new_figure(node_minimum(h), time)
      summary%h_central = new_figure(central_value(x, h), time)
      summary%h_central_cubic = central_by_cubic(x, h)
      summary%p_max = new_figure(peak_value(p), time)
      summary%x_cavitation = new_figure(exit_position(x, p), time)
      summary%x_cavitation%extrapolated = exit_between_nodes(x, p)
      summary%crests = crests_of(p, h)
   end function summary_of_fields

   !> Widens `summary` by the figures of another time: smallest films, largest pressure and exit.
   pure subroutine keep_extremes(summary, other)
      type(line_summary_t), intent(inout) :: summary
      type(line_summary_t), intent(in) :: other

      call keep_smaller(summary%h_min, other%h_min)
      call keep_smaller(summary%h_min_node, other%h_min_node)
      call keep_smaller(summary%h_central, other%h_central)
      if (ieee_is_finite(other%h_central_cubic)) summary%h_central_cubic = &
         min(summary%h_central_cubic, other%h_central_cubic)
      call keep_larger(summary%p_max, other%p_max)
      call keep_larger(summary%x_cavitation, other%x_cavitation)
      summary%crests%highest = larger(summary%crests%highest, other%crests%highest)
      summary%crests%other = larger(summary%crests%other, other%crests%other)
      if (.not. ieee_is_finite(other%crests%spike)) return
      if (ieee_is_finite(summary%crests%spike) &
         .and. other%crests%spike <= summary%crests%spike) return
      summary%crests%spike = other%crests%spike
      summary%crests%spike_film = other%crests%spike_film
   end subroutine keep_extremes

   !> Smallest value of a positive curve on a uniform grid: vertex of the parabola through the
   !> smallest node and its neighbours; the node itself at an end, or where the vertex of a film
   !> that nearly closes would be negative; NaN if a value is not finite. h (nx).
   pure function parabola_minimum(h) result(h_min)
      real(wp), intent(in) :: h(:)
      real(wp) :: h_min
      real(wp) :: slope, curvature, vertex
      integer :: i

      h_min = node_minimum(h)
      if (.not. ieee_is_finite(h_min)) return
      i = minloc(h, dim=1)
      if (i == 1 .or. i == size(h)) return
      slope = 0.5_wp*(h(i + 1) - h(i - 1))
      curvature = h(i + 1) - 2.0_wp*h(i) + h(i - 1)
      if (curvature <= 0.0_wp) return
      vertex = h(i) - 0.5_wp*slope**2/curvature
      if (vertex > 0.0_wp .or. h_min <= 0.0_wp) h_min = vertex
   end function parabola_minimum

   !> Smallest nodal value; NaN if a value is not finite. h (nx).
   pure function node_minimum(h) result(h_min)
      real(wp), intent(in) :: h(:)
      real(wp) :: h_min

      h_min = not_known()
      if (size(h) > 0 .and. all(ieee_is_finite(h))) h_min = minval(h)
   end function node_minimum

   !> Largest nodal value; NaN if a value is not finite. p (nx).
   pure function peak_value(p) result(p_max)
      real(wp), intent(in) :: p(:)
      real(wp) :: p_max

      p_max = not_known()
      if (size(p) > 0 .and. all(ieee_is_finite(p))) p_max = maxval(p)
   end function peak_value

   !> Value at X = 0, linear between the nodes of a rising grid; NaN if the grid does not reach it.
   !> x, h (nx).
   pure function central_value(x, h) result(h_central)
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: h(:)
      real(wp) :: h_central
      integer :: i

      h_central = not_known()
      i = count(x <= 0.0_wp)
      if (i == 0) return
      if (x(i) >= 0.0_wp) then
         h_central = h(i)
      else if (i < size(x)) then
         h_central = h(i) - x(i)*(h(i + 1) - h(i))/(x(i + 1) - x(i))
      end if
      if (.not. ieee_is_finite(h_central)) h_central = not_known()
   end function central_value

   !> Value at X = 0 by the cubic through the two nodes of a uniform grid on either side, linear
   !> where there are not four; NaN if the grid does not reach it. x, h (nx).
   pure function central_by_cubic(x, h) result(h_central)
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: h(:)
      real(wp) :: h_central
      real(wp) :: t, weights(4)
      integer :: i

      h_central = central_value(x, h)
      i = count(x <= 0.0_wp)
      if (i < 2 .or. i + 2 > size(x) .or. .not. ieee_is_finite(h_central)) return
      t = -x(i)/(x(i + 1) - x(i))
      weights = [-t*(t - 1)*(t - 2)/6, (t + 1)*(t - 1)*(t - 2)/2, -(t + 1)*t*(t - 2)/2, &
         (t + 1)*t*(t - 1)/6]
      h_central = dot_product(weights, h(i - 1:i + 2))
   end function central_by_cubic

   !> X of the last node with P > 0; NaN if there is none or a value is not finite. x, p (nx).
   pure function exit_position(x, p) result(position)
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: p(:)
      real(wp) :: position
      integer :: i

      position = not_known()
      if (.not. all(ieee_is_finite(p))) return
      do i = size(p), 1, -1
         if (p(i) > 0.0_wp) then
            position = x(i)
            return
         end if
      end do
   end function exit_position

   !> Maxima of a pressure p with the film h (nx). A plateau counts once.
   pure function crests_of(p, h) result(crests)
      real(wp), intent(in) :: p(:), h(:)
      type(crests_t) :: crests
      integer :: i
      logical :: is_last

      crests = crests_t(not_known(), not_known(), not_known(), not_known())
      is_last = .true.
      do i = size(p) - 1, 2, -1
         if (.not. (p(i) > p(i - 1) .and. p(i) >= p(i + 1))) cycle
         if (is_last .and. p(min(i + 2, size(p))) < (1.0_wp - spike_drop)*p(i)) then
            crests%spike = p(i)
            crests%spike_film = h(i)
         else
            crests%other = larger(crests%other, vertex(p(i - 1:i + 1)))
         end if
         crests%highest = larger(crests%highest, vertex(p(i - 1:i + 1)))
         is_last = .false.
      end do
   end function crests_of

   !> Top of the parabola through three values at equal distances, the middle one the largest.
   pure function vertex(values) result(top)
      real(wp), intent(in) :: values(3)
      real(wp) :: top, curvature

      top = values(2)
      curvature = values(3) - 2*values(2) + values(1)
      if (curvature < 0.0_wp) top = values(2) - 0.125_wp*(values(3) - values(1))**2/curvature
   end function vertex

   !> The larger one; a value that is not known gives way.
   pure function larger(a, b) result(value)
      real(wp), intent(in) :: a, b
      real(wp) :: value

      value = a
      if (.not. ieee_is_finite(b)) return
      if (ieee_is_finite(a)) then
         value = max(a, b)
      else
         value = b
      end if
   end function larger

   !> X of the exit between two nodes. There P and dP/dX are zero, so that the root of P is nearly
   !> linear: the zero of the parabola through the roots of P at the last three nodes with P > 0, of
   !> the line through the last two where that has no zero ahead, at most two spacings behind the
   !> last node. NaN if there are not three such nodes in a row. x, p (nx).
   pure function exit_between_nodes(x, p) result(position)
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: p(:)
      real(wp) :: position
      real(wp) :: root(3), slope, curvature, discriminant, ahead
      integer :: i

      position = not_known()
      if (.not. all(ieee_is_finite(p))) return
      i = findloc(p > 0.0_wp, .true., 1, back=.true.)
      if (i < 3 .or. i == size(p)) return
      if (.not. all(p(i - 2:i) > 0.0_wp)) return
      root = sqrt(p(i - 2:i))
      slope = 0.5_wp*(3*root(3) - 4*root(2) + root(1))
      curvature = root(3) - 2*root(2) + root(1)
      discriminant = slope**2 - 2*curvature*root(3)
      ahead = 2.0_wp
      if (slope < 0.0_wp .and. discriminant >= 0.0_wp) then
         ahead = 2*root(3)/(sqrt(discriminant) - slope)
      else if (root(3) < root(2)) then
         ahead = root(3)/(root(2) - root(3))
      end if
      position = x(i) + min(ahead, 2.0_wp)*(x(i) - x(i - 1))
   end function exit_between_nodes

   !> A figure without an estimate of its error.
   pure function new_figure(value, time) result(figure)
      real(wp), intent(in) :: value
      real(wp), intent(in) :: time
      type(figure_t) :: figure

      figure%value = value
      figure%time = time
      figure%error_estimate = not_known()
      figure%extrapolated = not_known()
      figure%error_grid = not_known()
   end function new_figure

   !> Takes `other` if it is smaller, or not known.
   pure subroutine keep_smaller(figure, other)
      type(figure_t), intent(inout) :: figure
      type(figure_t), intent(in) :: other

      if (.not. ieee_is_finite(figure%value)) return
      if (.not. ieee_is_finite(other%value)) then
         figure = other
      else if (other%value < figure%value) then
         figure = other
      end if
   end subroutine keep_smaller

   !> Takes `other` if it is larger, or not known; of the extrapolated values the larger one.
   pure subroutine keep_larger(figure, other)
      type(figure_t), intent(inout) :: figure
      type(figure_t), intent(in) :: other
      real(wp) :: extrapolated

      if (.not. ieee_is_finite(figure%value)) return
      extrapolated = larger(figure%extrapolated, other%extrapolated)
      if (.not. ieee_is_finite(other%value)) then
         figure = other
      else if (other%value > figure%value) then
         figure = other
      end if
      figure%extrapolated = extrapolated
   end subroutine keep_larger

   !> A quiet NaN.
   pure function not_known() result(value)
      real(wp) :: value

      value = ieee_value(0.0_wp, ieee_quiet_nan)
   end function not_known

end module line_summary

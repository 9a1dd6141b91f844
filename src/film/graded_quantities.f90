!> Quantities of a line contact on a graded grid, with their derivatives by P and H of the nodes and
!> what the sums over elements miss.
module graded_quantities
   use line_state, only: friction_t
   use graded_line, only: graded_line_t
   use inlet_friction, only: oil_in_front
   use kinds, only: exceeds, wp
   use lubricant, only: evaluate_stress, fluid_viscosity
   implicit none (type, external)
   private

   public :: evaluate_quantities, exit_element, functional_t, second_differences

   !> Places in the list: smallest and central film, largest and central pressure, integrals of
   !> `friction_t` (module line_state), and the pressure of a spike: the last maximum in front of
   !> the exit, or the sharpest shoulder, where the largest pressure is elsewhere.
   integer, parameter, public :: least_film = 1, middle_film = 2, top = 3, middle_pressure = 4, &
      sliding = 5, rolling = 6, rolling_power = 7, spike = 8, functional_count = 8

   !> Part of X behind which a shoulder of the pressure can be a spike.
   real(wp), parameter :: shoulder_from = 0.3_wp
   !> Relative steps of the differences that give derivatives of the shear stress.
   real(wp), parameter :: difference = 1.0e-6_wp

   !> A quantity; 0: there is none.
   type :: functional_t
      real(wp) :: value = 0.0_wp
      !> Its derivatives (0:n), and the addition of each element to its error by its sum (n).
      real(wp), allocatable :: by_pressure(:), by_film(:), quadrature(:)
   end type functional_t

contains

   !> Evaluates all quantities of a solved line. `slide_to_roll`: of the contact, NaN: not known.
   pure subroutine evaluate_quantities(line, slide_to_roll, list)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(in) :: slide_to_roll
      type(functional_t), intent(out) :: list(functional_count)
      type(friction_t) :: ahead
      real(wp) :: vertex
      integer :: i, middle

      do i = 1, functional_count
         allocate (list(i)%by_pressure(0:line%n), list(i)%by_film(0:line%n), &
            list(i)%quadrature(line%n), source=0.0_wp)
      end do
      associate (x => line%x, p => line%state%pressure, h => line%state%film)
         middle = minloc(abs(x), 1) - 1   ! X = 0 is a node
         call find_vertex(x, h, minloc(h(1:line%n - 1), 1), list(least_film)%value, &
            list(least_film)%by_film)
         list(middle_film)%value = h(middle)
         list(middle_film)%by_film(middle) = 1.0_wp
         i = maxloc(p(1:line%n - 1), 1)   ! the largest node, that lies below the vertex
         call find_vertex(x, p, i, vertex, list(top)%by_pressure)
         list(top)%value = p(i)
         list(top)%by_pressure(i - 1:i + 1) = [0.0_wp, 1.0_wp, 0.0_wp]
         list(top)%quadrature(i:i + 1) = 0.5_wp*(vertex - p(i))
         list(middle_pressure)%value = p(middle)
         list(middle_pressure)%by_pressure(middle) = 1.0_wp
      end associate
      call find_spike(line, list(spike))
      call add_rolling(line, list(rolling), list(rolling_power))
      ahead = oil_in_front(line%fluid, line%lambda, line%lambda*abs(slide_to_roll)/12, &
         line%elasticity, [line%x(0), line%state%film(0), 1.0_wp], line%flux(1))
      list([rolling, rolling_power])%value = list([rolling, rolling_power])%value &
         + [ahead%rolling, ahead%rolling_power]
      if (.not. exceeds(abs(slide_to_roll), 0.0_wp)) return
      call add_sliding(line, line%lambda*abs(slide_to_roll)/12, list(sliding))
      list(sliding)%value = list(sliding)%value + ahead%sliding
   end subroutine evaluate_quantities

   !> Vertex of the parabola through node `i` and its neighbours, no farther than they are, and its
   !> derivatives by the values `f` (0:n).
   pure subroutine find_vertex(x, f, i, value, by_value)
      real(wp), intent(in) :: x(0:), f(0:)
      integer, intent(in) :: i
      real(wp), intent(out) :: value
      real(wp), intent(inout) :: by_value(0:)
      real(wp) :: before, behind, bend, slope, t

      before = x(i) - x(i - 1)
      behind = x(i + 1) - x(i)
      slope = (f(i) - f(i - 1))/before
      bend = ((f(i + 1) - f(i))/behind - slope)/(before + behind)
      slope = slope + bend*before
      t = 0.0_wp
      if (abs(bend) > 0.0_wp) t = min(max(-0.5_wp*slope/bend, -before), behind)
      by_value(i - 1:i + 1) = [t*(t - behind)/(before*(before + behind)), &
         -(t + before)*(t - behind)/(before*behind), (t + before)*t/(behind*(before + behind))]
      value = dot_product(by_value(i - 1:i + 1), f(i - 1:i + 1))
   end subroutine find_vertex

   !> The pressure of a spike apart from the largest, if there is one.
   pure subroutine find_spike(line, quantity)
      type(graded_line_t), intent(in) :: line
      type(functional_t), intent(inout) :: quantity
      real(wp) :: bend(line%n - 1)
      integer :: crest, i

      associate (p => line%state%pressure, n => line%n, h => line%spacing)
         crest = maxloc(p, 1) - 1
         if (crest >= n - 2) return
         do i = n - 2, crest + 2, -1
            if (p(i) > p(i - 1) .and. p(i) >= p(i + 1) .and. p(i + 1) > 0.0_wp) exit
         end do
         if (i >= crest + 2) then
            call find_vertex(line%x, p, i, quantity%value, quantity%by_pressure)
         else if (line%x(crest) < shoulder_from) then
            bend = (p(1:n - 1) - p(:n - 2))/h(:n - 1) - (p(2:) - p(1:n - 1))/h(2:)
            i = maxloc(bend, 1, line%x(1:n - 1) > shoulder_from .and. p(2:) > 0.0_wp)
            if (i == 0) return
            quantity%value = p(i)
            quantity%by_pressure(i) = 1.0_wp
         end if
      end associate
   end subroutine find_spike

   !> Force and power of rolling.
   pure subroutine add_rolling(line, force, power)
      type(graded_line_t), intent(in) :: line
      type(functional_t), intent(inout) :: force, power
      real(wp), dimension(line%n) :: c, rise
      real(wp), dimension(0:line%n) :: bend_p, bend_h

      associate (p => line%state%pressure, h => line%state%film, e => line%oil%face_mobility, &
         rho => line%oil%density, slopes => line%slopes, n => line%n)
         rise = p(1:) - p(:n - 1)
         force%value = 0.25_wp*sum((h(1:) + h(:n - 1))*rise)
         force%by_film(1:) = 0.25_wp*rise
         force%by_film(:n - 1) = force%by_film(:n - 1) + 0.25_wp*rise
         force%by_pressure(1:) = 0.25_wp*(h(1:) + h(:n - 1))
         force%by_pressure(:n - 1) = force%by_pressure(:n - 1) - 0.25_wp*(h(1:) + h(:n - 1))
         bend_p = second_differences(line, p)
         bend_h = second_differences(line, h)
         force%quadrature = line%spacing**2/48*((bend_p(1:) + bend_p(:n - 1))*(h(1:) - h(:n - 1)) &
            - rise*(bend_h(1:) + bend_h(:n - 1)))
         ! rho changes little: left out of the derivatives
         c = rise/(line%lambda*line%spacing*(rho(1:) + rho(:n - 1)))
         power%value = sum(c*rise*e)
         power%by_pressure(1:) = c*(2*e + rise*slopes%by_p_right)
         power%by_pressure(:n - 1) = power%by_pressure(:n - 1) - c*(2*e - rise*slopes%by_p_left)
         power%by_film(1:) = c*rise*slopes%by_h_right
         power%by_film(:n - 1) = power%by_film(:n - 1) + c*rise*slopes%by_h_left
      end associate
   end subroutine add_rolling

   !> Force of sliding without its sign, `couette` = lambda/6 |u2 - u1|/(u1 + u2): in every element
   !> the logarithmic mean of the stress at both ends with the element's slope of P, up to the exit.
   pure subroutine add_sliding(line, couette, force)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(in) :: couette
      type(functional_t), intent(inout) :: force
      real(wp), dimension(line%n) :: slope, lengths, step, by_slope
      real(wp) :: by_part, part, ln_stress(0:line%n), bend(0:line%n), ln_mu(0:line%n)
      integer :: j, last

      associate (p => line%state%pressure, h => line%state%film, n => line%n, x => line%x)
         slope = (p(1:) - p(:n - 1))/line%spacing
         call exit_element(line, j, part)
         lengths = line%spacing
         lengths(j) = part*line%spacing(j)
         lengths(j + 1:) = 0.0_wp
         force%value = sum(lengths*mean_stress(p(:n - 1), p(1:), h(:n - 1), h(1:), slope))
         step = difference*max(abs(slope), 1.0_wp)
         by_slope = lengths*(mean_stress(p(:n - 1), p(1:), h(:n - 1), h(1:), slope + step) &
            - mean_stress(p(:n - 1), p(1:), h(:n - 1), h(1:), slope - step))/(2*step*line%spacing)
         force%by_pressure(1:) = by_slope
         force%by_pressure(:n - 1) = force%by_pressure(:n - 1) - by_slope
         force%by_pressure(:n - 1) = force%by_pressure(:n - 1) + change(1, 0)
         force%by_pressure(1:) = force%by_pressure(1:) + change(1, 1)
         force%by_film(:n - 1) = change(2, 0)
         force%by_film(1:) = force%by_film(1:) + change(2, 1)
         ! the exit moves with the films beside it and with the flux
         step = mean_stress(p(:n - 1), p(1:), h(:n - 1), h(1:), slope)
         by_part = merge(line%spacing(j)*step(j)/(h(j) - h(j - 1)), 0.0_wp, part*(1 - part) &
            > 0.0_wp)
         last = findloc(p > 0.0_wp, .true., 1, back=.true.) - 1
         force%by_film(j - 1) = force%by_film(j - 1) - (1 - part)*by_part
         force%by_film(j) = force%by_film(j) - part*by_part
         force%by_pressure(last - 1:last + 1) = force%by_pressure(last - 1:last + 1) &
            + by_part*line%flux_by_p(:, last + 1)
         force%by_film(last - 1:last + 1) = force%by_film(last - 1:last + 1) &
            + by_part*line%flux_by_h(:, last + 1)
         ! what the logarithmic means miss, and the exit between two nodes
         call fluid_viscosity(line%fluid, p, ln_mu)
         call evaluate_stress(line%fluid, couette, h*[slope(1), (p(2:) - p(:n - 2))/(x(2:) &
            - x(:n - 2)), 0.0_wp], 1/h, ln_mu, ln_stress)
         ln_stress = log(max(ln_stress, tiny(1.0_wp)))
         bend = second_differences(line, ln_stress)
         bend(last:) = 0.0_wp
         where (p(:n - 1) > 0.0_wp) force%quadrature = -line%spacing**3/24*(bend(1:) + bend(:n &
            - 1))*exp(0.5_wp*(ln_stress(1:) + ln_stress(:n - 1)))
         bend = second_differences(line, h)
         force%quadrature(j) = force%quadrature(j) + abs(bend(j - 1) + bend(j)) &
            *line%spacing(j)**3/(16*abs(h(j) - h(j - 1)))*exp(ln_stress(j - 1))
      end associate

   contains

      !> Logarithmic mean of the stress at both ends of the elements.
      pure function mean_stress(p_left, p_right, h_left, h_right, slope) result(mean)
         real(wp), intent(in), dimension(:) :: p_left, p_right, h_left, h_right, slope
         real(wp), dimension(size(slope)) :: mean, left, right, ratio

         call fluid_viscosity(line%fluid, p_left, ratio)
         call evaluate_stress(line%fluid, couette, h_left*slope, 1/h_left, ratio, left)
         call fluid_viscosity(line%fluid, p_right, ratio)
         call evaluate_stress(line%fluid, couette, h_right*slope, 1/h_right, ratio, right)
         ratio = log(max(left, tiny(1.0_wp))/max(right, tiny(1.0_wp)))
         mean = 0.5_wp*(left + right)*(1 - ratio**2/12)
         where (abs(ratio) > 1.0e-3_wp) mean = (left - right)/ratio
      end function mean_stress

      !> Derivative of the elements' parts by P (1) or H (2) of the left (0) or right node.
      pure function change(variable, side) result(slope_of)
         integer, intent(in) :: variable, side
         real(wp), dimension(line%n) :: slope_of, step
         real(wp), dimension(line%n, 4) :: up, down
         integer :: k

         associate (p => line%state%pressure, h => line%state%film, n => line%n)
            up(:, 1) = p(:n - 1)
            up(:, 2) = p(1:)
            up(:, 3) = h(:n - 1)
            up(:, 4) = h(1:)
         end associate
         down = up
         k = 2*variable - 1 + side
         step = difference*max(up(:, k), merge(1.0e-2_wp, 0.0_wp, variable == 1))
         up(:, k) = up(:, k) + step
         down(:, k) = down(:, k) - step
         slope_of = lengths*(mean_stress(up(:, 1), up(:, 2), up(:, 3), up(:, 4), slope) &
            - mean_stress(down(:, 1), down(:, 2), down(:, 3), down(:, 4), slope))/(2*step)
      end function change

   end subroutine add_sliding

   !> The element in which rho H reaches the mass flux, where the film ends, and the part of it that
   !> lies in front of that.
   pure subroutine exit_element(line, element, part)
      type(graded_line_t), intent(in) :: line
      integer, intent(out) :: element
      real(wp), intent(out) :: part
      real(wp) :: flow
      integer :: last

      associate (p => line%state%pressure, h => line%state%film)
         last = findloc(p > 0.0_wp, .true., 1, back=.true.) - 1
         flow = line%flux(last + 1)
         element = min(last + 2, line%n)
         do while (element > 2 .and. h(element - 1) > flow)
            element = element - 1
         end do
         do while (element < line%n .and. h(element) < flow)
            element = element + 1
         end do
         part = min(max((flow - h(element - 1))/(h(element) - h(element - 1)), 0.0_wp), 1.0_wp)
      end associate
   end subroutine exit_element

   !> Second differences of `f` (0:n): that of node 1 at node 0, and 0 at node n.
   pure function second_differences(line, f) result(bend)
      type(graded_line_t), intent(in) :: line
      real(wp), intent(in) :: f(0:)
      real(wp) :: bend(0:line%n)

      associate (n => line%n, h => line%spacing)
         bend(1:n - 1) = 2*((f(2:) - f(1:n - 1))/h(2:) - (f(1:n - 1) - f(:n - 2))/h(:n - 1)) &
            /(h(2:) + h(:n - 1))
         bend(0) = bend(1)
         bend(n) = 0.0_wp
      end associate
   end function second_differences

end module graded_quantities

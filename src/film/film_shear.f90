!> Shear stress in the film of a line contact, on both walls and between them, the velocity of the
!> oil across it, friction and power, and T_max and the largest slope of module line_state.
!>
!> Across the film the stress is linear, tau = tau_m + (z - h/2) dp/dx with z from surface 1 to
!> surface 2, (2.6): tau_m is the mean, given by the flow law and u2 - u1, and the walls have tau_m
!> -+ (h/2) dp/dx. The film pulls surface 1 with tau in +x and surface 2 with -tau. The flow turns
!> into heat at every place
!>
!>     Int tau du/dz dz = tau_m (u2 - u1) + S h^3/(12 mu) (dp/dx)^2 ,
!>
!> the sliding and the rolling power. Stresses are in units of p_h b/R, forces per length in p_h
!> b^2/R, powers per length in that times u1 + u2. Cavitated film (P = 0) does not count in friction
!> and power: how much of the width oil fills there is not known.
module film_shear
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use flow_law, only: block_size => slip_block, largest_exponent
   use inlet_friction, only: oil_in_front
   use kinds, only: not_known, wp
   use line_level, only: line_level_t, total_pressure
   use line_state, only: friction_t, reynolds_limits_t, stressed_share
   use lubricant, only: evaluate_stress, evaluate_stress_rise, flow_shapes, fluid_t, &
      fluid_viscosity, limited_stress, ln_slip
   use quantities, only: bend_of, exit_between_nodes, node_spacings
   use reynolds_line, only: mass_flux
   implicit none (type, external)
   private

   public :: evaluate_drive, evaluate_friction, film_limits, film_stresses, friction_of, &
      velocity_profile

   !> Slopes count where the pressure exceeds this share of its largest value.
   real(wp), parameter :: loaded_share = 0.01_wp
   !> Nodes in a block of the search for limits.
   integer, parameter :: search_block = 16

contains

   !> Limits of the pressure `p` >= 0 and the film `h` > 0 on nodes `x` (nx), which
   !> rise, with `slide_to_roll` = (u2 - u1)/((u1 + u2)/2) (NaN: not known); `top`: largest pressure
   !> of the contact, of which this is a part.
   pure function film_limits(fluid, lambda, slide_to_roll, x, p, h, top) result(limits)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      real(wp), intent(in), optional :: top
      type(reynolds_limits_t) :: limits
      real(wp) :: loaded
      integer :: i

      loaded = loaded_share*maxval(p)
      if (present(top)) loaded = loaded_share*top
      do i = 2, size(p)
         if (min(p(i - 1), p(i)) > loaded) limits%surface_slope = max(limits%surface_slope, &
            abs(h(i) - h(i - 1))/(x(i) - x(i - 1)))
      end do
      limits%stokes_number = not_known()
      if (ieee_is_finite(slide_to_roll)) limits%stokes_number = largest_rise(fluid, &
         lambda*slide_to_roll/12, p, h)
   end function film_limits

   !> Largest d tau/dp of the nodes. It grows with viscosity, its slope and 1/H, so that the
   !> extremes of p and H in a block of nodes bound it there, and few blocks need evaluation. (This
   !> is done in every time step.)
   pure real(wp) function largest_rise(fluid, couette, p, h) result(largest)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: p(:), h(:)
      real(wp), dimension((size(p) - 1)/search_block + 1) :: lowest, highest, thinnest, ln_mu, &
         slope, other_slope, bound
      integer :: b, first, last

      do b = 1, size(bound)
         first = (b - 1)*search_block + 1
         last = min(b*search_block, size(p))
         lowest(b) = minval(p(first:last))
         highest(b) = maxval(p(first:last))
         thinnest(b) = minval(h(first:last))
      end do
      call fluid_viscosity(fluid, lowest, ln_mu, other_slope)
      call fluid_viscosity(fluid, highest, ln_mu, slope)
      call evaluate_stress_rise(fluid, couette, thinnest, ln_mu, max(slope, other_slope), bound)
      largest = 0.0_wp
      do while (maxval(bound) > largest)
         b = maxloc(bound, 1)
         first = (b - 1)*search_block + 1
         last = min(b*search_block, size(p))
         largest = max(largest, rise_of(fluid, couette, p(first:last), h(first:last)))
         bound(b) = 0.0_wp
      end do
   end function largest_rise

   !> The same in one block.
   pure real(wp) function rise_of(fluid, couette, p, h) result(largest)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: p(:), h(:)
      real(wp), dimension(size(p)) :: ln_mu, slope, rise

      call fluid_viscosity(fluid, p, ln_mu, slope)
      call evaluate_stress_rise(fluid, couette, h, ln_mu, slope, rise)
      largest = maxval(rise)
   end function rise_of

   !> Stress at the wall of surface 1, mean stress, and stress at the wall of surface 2, (nx, 3), on
   !> the nodes `x` of a rising grid, from pressure `p`, film `h` and ln(mu/mu_0) of a warm oil,
   !> each (nx); 0 where the film cavitates, as the width that oil fills is not known there; the oil
   !> begins at the first node.
   pure function film_stresses(fluid, lambda, slide_to_roll, x, p, h, warm_ln_mu) result(stresses)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      real(wp), intent(in), contiguous, optional :: warm_ln_mu(:)
      real(wp) :: stresses(size(x), 3)
      real(wp), dimension(size(x)) :: drive, inverse_film, ln_mu
      integer :: first, last

      call fluid_viscosity(fluid, p, ln_mu)
      if (present(warm_ln_mu)) ln_mu = warm_ln_mu
      call evaluate_drive(node_spacings(x), p, h, drive)
      inverse_film = 1/h
      do first = 1, size(x), block_size
         last = min(first + block_size - 1, size(x))
         call evaluate_stress(fluid, lambda*slide_to_roll/12, drive(first:last), &
            inverse_film(first:last), ln_mu(first:last), stresses(first:last, 2))
      end do
      stresses(:, 2) = limited_stress(fluid, p, stresses(:, 2))
      stresses(:, 1) = stresses(:, 2) - 0.5_wp*drive
      stresses(:, 3) = stresses(:, 2) + 0.5_wp*drive
      do last = 2, size(x)
         if (p(last) <= 0.0_wp) stresses(last, :) = 0.0_wp
      end do
   end function film_stresses

   !> H dP/dX of the pressure p and the film h, each (nx), on nodes at the distances `gap` (nx - 1).
   !> The slope of P is that of the parabola through three nodes (on an even grid the central
   !> difference), at the first node that of the first interval, and 0 at the last.
   pure subroutine evaluate_drive(gap, p, h, drive)
      real(wp), intent(in), contiguous :: gap(:), p(:), h(:)
      real(wp), intent(out), contiguous :: drive(:)
      real(wp) :: ratio, factor
      integer :: i

      drive(1) = 1/gap(1)*h(1)*(p(2) - p(1))
      do i = 2, size(p) - 1
         ratio = gap(i - 1)/gap(i)
         factor = 1/(gap(i - 1) + gap(i))
         drive(i) = factor*h(i)*(ratio*p(i + 1) - p(i - 1)/ratio + (1/ratio - ratio)*p(i))
      end do
      drive(size(p)) = 0.0_wp
   end subroutine evaluate_drive

   !> u/(u1 + u2) at zeta = z/h = 0, 1/layers ... 1 from surface 1 to surface 2, (layers + 1, nx),
   !> on the nodes `x` of a rising grid, from pressure `p` >= 0 and film `h` > 0, each (nx).
   !>
   !> Closed form of module eyring. Its mean across the film is the flow of the Reynolds equation at
   !> the node, by evaluate_drive. Where the film cavitates it is the straight line of shear alone.
   pure function velocity_profile(fluid, lambda, slide_to_roll, x, p, h, layers) result(u)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      integer, intent(in) :: layers
      real(wp) :: u(layers + 1, size(x))
      real(wp), dimension(layers + 1) :: y, sliding, driven
      real(wp) :: drive(size(x)), ln_mu(size(x)), flow
      integer :: i

      call evaluate_drive(node_spacings(x), p, h, drive)
      where (p(2:) <= 0.0_wp) drive(2:) = 0.0_wp
      call fluid_viscosity(fluid, p, ln_mu)
      y = [(real(2*i - layers, wp)/layers, i=0, layers)]
      do i = 1, size(x)
         call flow_shapes(fluid, drive(i), y, sliding, driven)
         flow = h(i)*drive(i)/(2*lambda)*exp(min(ln_slip(fluid, drive(i), h(i), ln_mu(i)) &
            - ln_mu(i), largest_exponent))
         u(:, i) = 0.5_wp + 0.25_wp*slide_to_roll*sliding - flow*driven
      end do
   end function velocity_profile

   !> Computes friction and power, with the oil in front of the domain; mobility, density and
   !> viscosity of the level must be those of its pressure and film. Integrals over nodes end at the
   !> exit between them, so that they do not depend on the position of the nodes. In the rolling
   !> power S H^3/mu dP/dX is the difference of H and the mass flux of the discrete equations: that
   !> keeps the balance of energy where viscosity changes by orders of magnitude between two nodes.
   !> `stress` and `drive` (nx): mean stress and H dP/dX at every node, 0 where the film cavitates;
   !> the oil begins at the first node.
   pure subroutine evaluate_friction(level, friction, stress, drive)
      type(line_level_t), intent(in) :: level
      type(friction_t), intent(out) :: friction
      real(wp), intent(out), contiguous :: stress(0:), drive(0:)
      type(friction_t) :: ahead
      real(wp) :: rise, flux(level%n), gap(0:level%n + 1), speed, stressed
      real(wp), dimension(0:level%n) :: weights, inverse_film
      integer :: i, first, last, exit_node
      logical :: has_speeds, is_full

      associate (p => level%state%pressure, h => level%state%film, rho => level%oil%density)
         flux = mass_flux(level)
         speed = level%entrainment
         friction%load = level%moment%load
         is_full = .true.
         if (allocated(level%oil%saturation)) is_full = level%oil%saturation(1) >= 1.0_wp
         if (speed > 0.0_wp .and. is_full) then   ! else the gap in front is at rest, or starved
            ahead = oil_in_front(level%fluid, level%lambda*speed, level%lambda*level%slide_to_roll &
               /12, level%elastic%elasticity*friction%load, [level%x(0), h(0), &
               1/level%moment%radius], max(flux(1), 0.0_wp)/speed)
            friction%sliding = ahead%sliding
            friction%rolling = ahead%rolling
            friction%rolling_power = speed*ahead%rolling_power
         end if
         gap(1:level%n) = node_spacings(level%x)
         gap([0, level%n + 1]) = 0.0_wp
         exit_node = findloc(p > 0.0_wp, .true., 1, back=.true.) - 1
         stressed = stressed_share*maxval(p)
         has_speeds = ieee_is_finite(level%slide_to_roll)
         call evaluate_drive(gap(1:level%n), p, h, drive)
         inverse_film = 1/h
         weights = merge(0.5_wp*(gap(:level%n) + gap(1:)), 0.0_wp, p > 0.0_wp)
         weights(0) = merge(0.5_wp*gap(1), 0.0_wp, is_full)
         drive = merge(drive, 0.0_wp, weights > 0.0_wp)
         stress = 0.0_wp
         do first = 0, exit_node, block_size
            last = min(first + block_size - 1, exit_node)
            call evaluate_stress(level%fluid, level%lambda*level%slide_to_roll/12, &
               drive(first:last), inverse_film(first:last), level%oil%ln_mu(first:last), &
               stress(first:last))
            stress(first:last) = merge(limited_stress(level%fluid, p(first:last), &
               stress(first:last)), 0.0_wp, weights(first:last) > 0.0_wp)
            if (last == exit_node) weights(last) = 0.5_wp*gap(max(last, 1)) &
               + weight_behind(level, last, flux(max(last, 1))/max(speed, tiny(speed)))
            friction%sliding = friction%sliding + sum(weights(first:last)*stress(first:last))
            do i = first, merge(last, -1, has_speeds)
               if (p(i) > stressed) friction%stress_share = max(friction%stress_share, &
                  abs(stress(i))/p(i))
            end do
         end do
         do i = 1, min(exit_node + 1, level%n)
            rise = p(i) - p(i - 1)
            friction%rolling = friction%rolling + 0.25_wp*(h(i - 1) + h(i))*rise
            friction%rolling_power = friction%rolling_power + 0.5_wp*rise*(0.5_wp*speed &
               *(h(i - 1) + h(i)) - 2*flux(i)/(rho(i - 1) + rho(i)))
         end do
      end associate
      friction%sliding_speed = 0.5_wp*level%slide_to_roll
      if (allocated(level%rough)) then
         friction%asperity_share = sum(level%state%asperity_pressure)/sum(total_pressure(level))
         friction%asperity_response = sum(level%rough%slope*level%state%film &
            /level%rough%gap_slope)/max(sum(level%rough%pressure), tiny(1.0_wp))
         if (abs(friction%sliding_speed) > 0.0_wp) friction%boundary = sign(level%rough%friction &
            *level%dx*sum(level%state%asperity_pressure), friction%sliding_speed)
      end if
      if (allocated(level%oil%saturation)) then
         first = findloc(level%state%pressure > 0.0_wp, .true., 1) - 1
         if (first > 1) friction%meniscus = level%x(first)
      end if
      if (allocated(level%heat)) friction%rise = maxval(level%heat%rise, 1)
      if (.not. has_speeds) friction%stress_share = not_known()
   end subroutine evaluate_friction

   !> The same without the stress at the nodes.
   pure function friction_of(level) result(friction)
      type(line_level_t), intent(in) :: level
      type(friction_t) :: friction
      real(wp) :: stress(level%n + 1), drive(level%n + 1)

      call evaluate_friction(level, friction, stress, drive)
   end function friction_of

   !> Weight of the last node with P > 0 for the distance to the exit behind it, over which the
   !> stress falls as the film grows. `flux`: mass flux in front of it over
   !> (u1 + u2)/u_ref.
   pure function weight_behind(level, node, flux) result(weight)
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: node
      real(wp), intent(in) :: flux
      real(wp) :: weight, rest, film

      weight = 0.0_wp
      associate (x => level%x, h => level%state%film, first => max(node - 2, 0), &
         last => min(node + 2, level%n))
         film = flux
         rest = exit_by_flux(x(first:last), level%oil%density(first:last)*h(first:last), node &
            - first, flux) - x(node)
         if (.not. ieee_is_finite(rest)) then
            film = h(node)
            rest = exit_between_nodes(x, level%state%pressure) - x(node)
         end if
         if (ieee_is_finite(rest)) weight = 0.5_wp*rest*(1 + h(node)/film)
      end associate
   end function weight_behind

   !> X at which a `film` (times its density) carries its `flux` without a pressure gradient, which
   !> is the exit: from the interval in front of the last `node` with P > 0 to the second one behind
   !> it, by the parabola through it; NaN if it is not there. The film errs there by dX^2, smoothly;
   !> the pressures of the last nodes err by as much as their values.
   pure function exit_by_flux(x, film, node, flux) result(position)
      real(wp), intent(in) :: x(0:), film(0:), flux
      integer, intent(in) :: node
      real(wp) :: position, bend, part, rise
      integer :: i

      position = not_known()
      do i = max(node - 1, 1), min(node + 1, ubound(x, 1) - 1)
         if (film(i) > flux .or. film(i + 1) <= flux) cycle
         rise = film(i + 1) - film(i)
         bend = 0.5_wp*bend_of(x(i - 1:i + 1), film(i - 1:i + 1))
         part = (flux - film(i))/rise
         ! one Newton step from the line to the parabola
         part = part - bend*part*(part - 1)/max(rise + bend*(2*part - 1), 0.5_wp*rise)
         position = x(i) + (x(i + 1) - x(i))*part
      end do
   end function exit_by_flux

end module film_shear

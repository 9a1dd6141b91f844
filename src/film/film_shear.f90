!> Integrates the shear stress in the film of a line contact to friction and power.
!>
!> With the stress tau of module shear_stresses, the flow turns into heat at every place
!>
!>     Int tau du/dz dz = tau_m (u2 - u1) + S h^3/(12 mu) (dp/dx)^2 ,
!>
!> the sliding and the rolling power. Stresses are in units of p_h b/R, forces per length in p_h
!> b^2/R, powers per length in that times u1 + u2. Cavitated film (P = 0) does not count: how much
!> of the width oil fills there is not known.
module film_shear
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use flow_law, only: block_size => slip_block
   use line_state, only: friction_t, stressed_share
   use inlet_friction, only: oil_in_front
   use kinds, only: wp
   use line_level, only: line_level_t, total_pressure
   use missing_value, only: not_known
   use quantities, only: bend_of, exit_between_nodes, node_spacings
   use reynolds_line, only: mass_flux
   use lubricant, only: evaluate_stress, limited_stress
   use shear_stresses, only: evaluate_drive
   implicit none (type, external)
   private

   public :: evaluate_friction, friction_of

contains

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

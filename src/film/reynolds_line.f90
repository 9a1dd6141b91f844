!> Reynolds-Eyring equation of the line contact, discretised as in (2.65)-(2.67) of the thesis.
!>
!>     L_R(P,H)_i = 1/dX^2 [ e(i-1/2) P(i-1) - (e(i-1/2)+e(i+1/2)) P(i) + e(i+1/2) P(i+1) ]
!>                - lambda/(2 dX) [ 3 rH(i) - 4 rH(i-1) + rH(i-2) ] - lambda/dT rH(i)
!>
!> with e = rho H^3 S/mu, e(i+-1/2) the arithmetic mean, rH = rho H, and the first-order wedge at
!> node 1. The old film of a time step is in the right side: L_R = -lambda rH_old/dT. Where speeds
!> change in time the wedge is times (u1 + u2)/u_ref.
!>
!> The kappa scheme (`level%is_kappa`) takes e(i+-1/2) from module mobility, and includes one
!> node downstream in the mass flux rH at a face,
!>
!>     rH(i+1/2) = ( 3 rH(i) - rH(i-1) )/2 + theta(i)/3 ( rH(i+1) - 2 rH(i) + rH(i-1) )
!>
!> which with theta = 1 is (2 rH(i+1) + 5 rH(i) - rH(i-1))/6, of third order, and with theta = 0 the
!> flux of upwind2. The share theta falls where the pressure curves more than the grid resolves
!> (`third_order_share`). At the first face both schemes have (rH(0) + rH(1))/2.
!>
!> Oil is lost where a film cavitates, L_R < 0, unless it is conserved (`oil%saturation`; Jakobsson
!> and Floberg, Trans. Chalmers Univ. 190, 1957; Elrod, J. Lubr. Technol. 103, 1981, 350): it then
!> fills the share of the film there that leaves L_R = 0, 0 <= theta <= 1, and the mass flux at the
!> face behind is theta times that of a full film, by upwind2. At the first face it is `supply` if
!> that is less.
module reynolds_line
   use kinds, only: wp
   use line_level, only: has_close_exit, line_level_t
   use mobility, only: fluid_face_mobility, fluid_mobility, mobility_slopes_t
   implicit none (type, external)
   private

   public :: apply_reynolds, evaluate_coefficients, evaluate_reynolds, is_third_order, mass_flux, &
      reynolds_diagonals, third_order_share, third_order_slope, wedge_weights

   !> Curvature c that halves the third order in the flux of the kappa scheme.
   real(wp), parameter :: strong_curvature = 1.0_wp

contains

   !> Computes density rho and ln(mu/mu_0) of the nodes and mobility e(i-1/2) of the faces at the
   !> present pressure and film; with upwind2 the mobility of the nodes too; of all their `slopes`.
   pure subroutine evaluate_coefficients(level, slopes)
      type(line_level_t), intent(inout) :: level
      type(mobility_slopes_t), intent(inout), optional :: slopes

      if (level%is_kappa) then
         call fluid_face_mobility(level%fluid, [level%dx], level%state, level%oil, slopes)
         if (allocated(level%rough)) call apply_flow_factor(level, slopes)
      else
         call fluid_mobility(level%fluid, level%dx, level%state, level%oil, slopes)
         if (allocated(level%rough)) call apply_flow_factor(level, slopes)
         level%oil%face_mobility = 0.5_wp*(level%oil%mobility(:level%n - 1) &
            + level%oil%mobility(1:))
      end if
   end subroutine evaluate_coefficients

   !> Multiplies mobilities by the flow factor of rough surfaces, and their `slopes`, which stay
   !> those by the mean gap.
   pure subroutine apply_flow_factor(level, slopes)
      type(line_level_t), intent(inout) :: level
      type(mobility_slopes_t), intent(inout), optional :: slopes
      real(wp) :: bend(0:level%n), mean(level%n)

      if (.not. level%rough%law%has_flow_factor) return
      associate (rough => level%rough, oil => level%oil, n => level%n)
         bend = rough%ln_slope/rough%gap_slope
         if (level%is_kappa) then
            mean = sqrt(rough%factor(:n - 1)*rough%factor(1:))
            oil%face_mobility = mean*oil%face_mobility
            if (.not. present(slopes)) return
            slopes%by_p_left = mean*slopes%by_p_left
            slopes%by_p_right = mean*slopes%by_p_right
            slopes%by_h_left = mean*slopes%by_h_left + 0.5_wp*oil%face_mobility*bend(:n - 1)
            slopes%by_h_right = mean*slopes%by_h_right + 0.5_wp*oil%face_mobility*bend(1:)
         else
            oil%mobility = rough%factor*oil%mobility
            if (.not. present(slopes)) return
            slopes%e_p = rough%factor*slopes%e_p
            slopes%e_slope = rough%factor*slopes%e_slope
            slopes%e_h = rough%factor*slopes%e_h + oil%mobility*bend
         end if
      end associate
   end subroutine apply_flow_factor

   !> Weights of rH(i-2) ... rH(i) in dX d(rho H)/dX of row i by upwind2.
   pure function wedge_weights(i) result(weights)
      integer, intent(in) :: i
      real(wp) :: weights(-2:0)

      weights = [0.5_wp, -2.0_wp, 1.5_wp]
      if (i == 1) weights = [0.0_wp, -1.0_wp, 1.0_wp]
   end function wedge_weights

   !> Share theta of the third order in the mass flux rH at a face, 1/(1 + (c/c_0)^2), by the
   !> curvature c = alpha_bar (P(i-1) - 2 P(i) + P(i+1)) at the node upstream, the change of the
   !> slope of ln mu from interval to interval.
   !>
   !> Where oil is nearly solid, rH is the same at all faces. The third order would allow that with
   !> a part of H that changes its sign from node to node and falls upstream by 2.7 a node, of any
   !> size: a zigzag of the pressure in front of the spike, and several solutions. (The remainder of
   !> the flux from upstream alone falls downstream, by 3 a node.) 1 - theta is of fourth order in
   !> dX.
   pure elemental real(wp) function third_order_share(curvature) result(share)
      real(wp), intent(in) :: curvature

      share = 1/(1 + (curvature/strong_curvature)**2)
   end function third_order_share

   !> d theta/dc.
   pure elemental real(wp) function third_order_slope(curvature) result(slope)
      real(wp), intent(in) :: curvature

      slope = -2*curvature/strong_curvature**2*third_order_share(curvature)**2
   end function third_order_slope

   !> Computes the coefficients, then the operator L_R at nodes 1..n-1 (0 at both ends).
   pure subroutine evaluate_reynolds(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_coefficients(level)
      call apply_reynolds(level)
   end subroutine evaluate_reynolds

   !> Computes L_R with the present coefficients.
   pure subroutine apply_reynolds(level)
      type(line_level_t), intent(inout) :: level
      real(wp) :: diffusion, squeeze, w(-2:0), wedge
      integer :: i, n

      n = level%n
      diffusion = 1.0_wp/level%dx**2
      squeeze = level%lambda*level%inverse_time_step
      associate (p => level%state%pressure, h => level%state%film, e => level%oil%face_mobility, &
         rho => level%oil%density, flow => level%operator)
         flow(0) = 0.0_wp
         flow(n) = 0.0_wp
         wedge = level%lambda*level%entrainment/level%dx
         w = wedge*wedge_weights(1)
         flow(1) = diffusion*(e(2)*(p(2) - p(1)) - e(1)*(p(1) - p(0))) &
            - (w(0)*rho(1)*h(1) + w(-1)*rho(0)*h(0)) - squeeze*rho(1)*h(1)
         w = wedge*wedge_weights(2)
         do concurrent (i=2:n - 1)
            flow(i) = diffusion*(e(i + 1)*(p(i + 1) - p(i)) - e(i)*(p(i) - p(i - 1))) &
               - (w(0)*rho(i)*h(i) + w(-1)*rho(i - 1)*h(i - 1) + w(-2)*rho(i - 2)*h(i - 2)) &
                  - squeeze*rho(i)*h(i)
         end do
         if (has_close_exit(level)) then
            i = level%posed%exit_node
            flow(i) = flow(i) - level%posed%exit_conductance*(p(i) - level%posed%start_pressure(i))
         end if
      end associate
      if (level%is_kappa) call add_third_order(level)
      if (allocated(level%state%compensation)) call add_flow_of_compensation(level)
      if (allocated(level%oil%saturation)) call evaluate_saturation(level)
   end subroutine apply_reynolds

   !> Computes the saturation from the first node to the last, and takes from L_R the oil that does
   !> not arrive. L_R is that of a full film at the node itself, so that L_R > 0 says of a cavitated
   !> node that it fills.
   pure subroutine evaluate_saturation(level)
      type(line_level_t), intent(inout) :: level
      real(wp) :: missing, flux, outflow
      integer :: i

      associate (p => level%state%pressure, h => level%state%film, rho => level%oil%density, &
         flow => level%operator, theta => level%oil%saturation, lambda => level%lambda)
         theta = 1.0_wp
         missing = level%entrainment*max(0.5_wp*(rho(0)*h(0) + rho(1)*h(1)) - level%oil%supply, &
            0.0_wp)
         do i = 1, level%n - 1
            flow(i) = flow(i) - lambda/level%dx*missing
            missing = 0.0_wp
            if (p(i) > 0.0_wp) cycle
            flux = level%entrainment*(1.5_wp*rho(i)*h(i) - 0.5_wp*rho(i - 1)*h(i - 1))
            outflow = flux/level%dx + level%inverse_time_step*rho(i)*h(i)
            theta(i) = min(max(1 + (flow(i) - level%rhs_reynolds(i))/(lambda*outflow), 0.0_wp), &
               1.0_wp)
            missing = (1 - theta(i))*flux
         end do
         theta(level%n) = theta(level%n - 1)
      end associate
   end subroutine evaluate_saturation

   !> Whether the kappa scheme adds to the mass flux behind node i: not behind a cavity that
   !> conserves its oil.
   pure logical function is_third_order(level, i)
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: i

      is_third_order = level%state%pressure(i) > 0.0_wp .or. .not. allocated(level%oil%saturation)
   end function is_third_order

   !> Adds the kappa scheme's addition to the mass flux rH at the faces (in the work space of the
   !> level, by the node upstream).
   pure subroutine add_third_order(level)
      type(line_level_t), intent(inout) :: level
      integer :: i, n

      n = level%n
      associate (more => level%work%nodes)
         more(0) = 0.0_wp
         do concurrent (i=1:n - 1)
            more(i) = 0.0_wp
            if (is_third_order(level, i)) more(i) = third_order_flux(level, i)
         end do
         level%operator(1:n - 1) = level%operator(1:n - 1) &
            - level%lambda*level%entrainment/level%dx*(more(1:n - 1) - more(:n - 2))
      end associate
   end subroutine add_third_order

   !> The kappa scheme's addition to the mass flux rH at the face behind node i, 1 <= i < n.
   pure elemental real(wp) function third_order_flux(level, i) result(flux)
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: i

      associate (p => level%state%pressure, h => level%state%film, rho => level%oil%density)
         flux = third_order_share(level%fluid%alpha_bar*(p(i - 1) - 2*p(i) + p(i + 1)))/3 &
            *(rho(i + 1)*h(i + 1) - 2*rho(i)*h(i) + rho(i - 1)*h(i - 1))
      end associate
   end function third_order_flux

   !> Mass flux U rho H - e/lambda dP/dX at the faces (1:n), face i left of node i, by the space
   !> scheme with the present coefficients; U = (u1 + u2)/u_ref.
   pure function mass_flux(level) result(flux)
      type(line_level_t), intent(in) :: level
      real(wp) :: flux(level%n), conductance
      integer :: i

      conductance = 1/(level%lambda*level%dx)
      associate (p => level%state%pressure, h => level%state%film, rho => level%oil%density, &
         e => level%oil%face_mobility, speed => level%entrainment)
         flux(1) = speed*min(0.5_wp*(rho(0)*h(0) + rho(1)*h(1)), level%oil%supply)
         do concurrent (i=2:level%n)
            flux(i) = speed*(1.5_wp*rho(i - 1)*h(i - 1) - 0.5_wp*rho(i - 2)*h(i - 2))
         end do
         if (level%is_kappa) then
            do concurrent (i=2:level%n, is_third_order(level, i - 1))
               flux(i) = flux(i) + speed*third_order_flux(level, i - 1)
            end do
         end if
         if (allocated(level%oil%saturation)) flux(2:) = flux(2:) &
            *level%oil%saturation(1:level%n - 1)
         flux = flux - conductance*e*(p(1:) - p(:level%n - 1))
      end associate
   end function mass_flux

   !> Adds the slopes of the compensation of P to L_R. (P(i) - P(i-1) is exact, being the difference
   !> of neighbours.)
   pure subroutine add_flow_of_compensation(level)
      type(line_level_t), intent(inout) :: level
      real(wp) :: diffusion
      integer :: i

      diffusion = 1.0_wp/level%dx**2
      associate (c => level%state%compensation, e => level%oil%face_mobility, &
         flow => level%operator)
         do concurrent (i=1:level%n - 1)
            flow(i) = flow(i) + diffusion*(e(i + 1)*(c(i + 1) - c(i)) - e(i)*(c(i) - c(i - 1)))
         end do
      end associate
   end subroutine add_flow_of_compensation

   !> For the smoothers, upwind2 only: diagonals at nodes 1..n-1 with frozen coefficients, b =
   !> dL_R/dH of (2.71), and the elastic diagonal a - b K_0/pi, the change of L_R with P(i) alone
   !> when H(i) follows. `kernel_diagonal` is K_0/pi or a bound of it.
   pure subroutine reynolds_diagonals(level, kernel_diagonal)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: kernel_diagonal
      real(wp) :: diffusion, convection
      integer :: i

      diffusion = 0.5_wp/level%dx**2
      convection = level%lambda*(1.5_wp*level%entrainment/level%dx + level%inverse_time_step)
      associate (e => level%oil%mobility, b => level%work%film_diagonal, &
         diagonal => level%work%diagonal)
         do concurrent (i=1:level%n - 1)
            b(i) = -convection*level%oil%density(i)
            diagonal(i) = -diffusion*(e(i - 1) + 2*e(i) + e(i + 1)) - b(i)*kernel_diagonal
         end do
         b(1) = -level%lambda*level%oil%density(1)*(level%entrainment/level%dx &
            + level%inverse_time_step)
         diagonal(1) = -diffusion*(e(0) + 2*e(1) + e(2)) - b(1)*kernel_diagonal
         if (has_close_exit(level)) diagonal(level%posed%exit_node) = &
            diagonal(level%posed%exit_node) - level%posed%exit_conductance
      end associate
   end subroutine reynolds_diagonals

end module reynolds_line

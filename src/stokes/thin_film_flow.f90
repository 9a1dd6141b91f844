!> Flow of a thin film between two faces: velocity and shear by the equations behind the Reynolds
!> equation, H dP/dX = kappa d tau/d zeta, with Eyring's or Newton's law.
!>
!>     tau = t + G (zeta - 1/2), G = H dP/dX/kappa;  H gamma = dU/dzeta = H sinh(c tau)/(c mu)
!>
!> where t gives the walls their speeds: sinh(c t) = c mu (U2 - U1)/H S/sinh S, S = c G/2. A
!> parabola added to the velocities of the layers gives them the flow of the discrete Reynolds
!> equation, whose mobility at a face is another mean: at delta = 0 they solve it.
module thin_film_flow
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: face_flow_t, layer_flow, shear_differences, shear_viscosity

   !> Directions in which a profile is differentiated: ln mu, dP/dX, ln H.
   integer, parameter :: by_ln_mu = 1, by_slope = 2, by_ln_film = 3, directions = 3

   !> Data of a profile: walls U1, U2, kappa, scale c of Eyring's law (0: Newton's), and at the face
   !> ln(mu/mu_0), dP/dX and H.
   type :: face_flow_t
      real(wp) :: speed(2) = 0.0_wp, kappa = 0.0_wp, shear_scale = 0.0_wp
      real(wp) :: ln_mu = 0.0_wp, slope = 0.0_wp, film = 0.0_wp
   end type face_flow_t

   !> Larger |S| are reduced to this to keep sinh S finite; no solution comes near it.
   real(wp), parameter :: largest_drive = 300.0_wp
   !> Below this |S|, S/sinh S is computed from its series.
   real(wp), parameter :: series_limit = 1.0e-2_wp
   !> Below this B^2, asinh(B)/B is computed from its series, exact to 1e-16 there.
   real(wp), parameter :: smallest_square = 1.0e-3_wp
   !> Weights of a wall and two layers in dU/dzeta at the wall: (7 U_1 - U_2 - 6 U_wall)/(2 dzeta),
   !> exact for means over layers of a parabola.
   real(wp), parameter :: wall_share(3) = [-3.0_wp, 3.5_wp, -0.5_wp]

contains

   !> Computes the means of U over the layers (m) and H gamma at their edges (0:m), with their
   !> derivatives in the three directions (second index).
   pure subroutine layer_flow(face, m, u, u_by, shear, shear_by)
      type(face_flow_t), intent(in) :: face
      integer, intent(in) :: m
      real(wp), intent(out) :: u(m), u_by(m, directions), shear(0:m), shear_by(0:m, directions)
      real(wp), parameter :: offset = 0.5_wp/sqrt(3.0_wp)
      real(wp) :: tau, tau_by(directions), below, below_by(directions)
      real(wp), dimension(2) :: rate
      real(wp), dimension(2, directions) :: rate_by
      integer :: j, k

      call mean_stress(face, tau, tau_by)
      do k = 0, m
         call shear_at(face, tau, tau_by, real(k, wp)/m, shear(k), shear_by(k, :))
      end do
      below = face%speed(1)
      below_by = 0.0_wp
      do j = 1, m
         ! Gauss: two points in the layer
         call shear_at(face, tau, tau_by, (j - 0.5_wp - offset)/m, rate(1), rate_by(1, :))
         call shear_at(face, tau, tau_by, (j - 0.5_wp + offset)/m, rate(2), rate_by(2, :))
         u(j) = below + (0.25_wp*sum(rate) + 0.5_wp*offset*(rate(1) - rate(2)))/m
         u_by(j, :) = below_by + (0.25_wp*sum(rate_by, 1) &
            + 0.5_wp*offset*(rate_by(1, :) - rate_by(2, :)))/m
         below = below + 0.5_wp*sum(rate)/m
         below_by = below_by + 0.5_wp*sum(rate_by, 1)/m
      end do
   end subroutine layer_flow

   !> Computes t with its derivatives.
   pure subroutine mean_stress(face, tau, by)
      type(face_flow_t), intent(in) :: face
      real(wp), intent(out) :: tau, by(directions)
      real(wp) :: drive, drive_by(directions), plain, s, ratio, ratio_slope

      plain = exp(face%ln_mu)*(face%speed(2) - face%speed(1))/face%film
      drive = face%film*face%slope/face%kappa
      drive_by = [0.0_wp, face%film/face%kappa, drive]
      associate (c => face%shear_scale)
         if (c > 0.0_wp) then
            s = min(max(0.5_wp*c*drive, -largest_drive), largest_drive)
            if (abs(s) < series_limit) then
               ratio = 1 - s**2/6*(1 - 7*s**2/60*(1 - 31*s**2/294))
               ratio_slope = -s/3*(1 - 7*s**2/30*(1 - 31*s**2/196))
            else
               ratio = s/sinh(s)
               ratio_slope = (1 - s/tanh(s))/sinh(s)
            end if
            tau = asinh(c*plain*ratio)/c
            by = (plain*ratio*[1.0_wp, 0.0_wp, -1.0_wp] + plain*ratio_slope*0.5_wp*c*drive_by) &
               /sqrt(1 + (c*plain*ratio)**2)
         else
            tau = plain
            by = plain*[1.0_wp, 0.0_wp, -1.0_wp]
         end if
      end associate
   end subroutine mean_stress

   !> Computes H gamma at zeta, with its derivatives.
   pure subroutine shear_at(face, mean, mean_by, zeta, shear, by)
      type(face_flow_t), intent(in) :: face
      real(wp), intent(in) :: mean, mean_by(directions), zeta
      real(wp), intent(out) :: shear, by(directions)
      real(wp) :: fluidity, growth, tau, tau_by(directions)

      fluidity = face%film*exp(-face%ln_mu)
      tau = mean + face%film*face%slope/face%kappa*(zeta - 0.5_wp)
      tau_by = mean_by + [0.0_wp, face%film/face%kappa, face%film*face%slope/face%kappa] &
         *(zeta - 0.5_wp)
      associate (c => face%shear_scale)
         if (c > 0.0_wp) then
            tau = min(max(c*tau, -largest_drive), largest_drive)
            shear = fluidity*sinh(tau)/c
            growth = fluidity*cosh(tau)
         else
            shear = fluidity*tau
            growth = fluidity
         end if
      end associate
      by = shear*[-1.0_wp, 0.0_wp, 1.0_wp] + growth*tau_by
   end subroutine shear_at

   !> dU/dzeta at the edges (0:m) by differences of the means over the layers and of the walls.
   pure function shear_differences(u, walls) result(shear)
      real(wp), intent(in) :: u(:), walls(2)
      real(wp) :: shear(0:size(u))
      integer :: m

      m = size(u)
      shear(0) = m*dot_product(wall_share, [walls(1), u(1), u(2)])
      shear(1:m - 1) = m*(u(2:) - u(:m - 1))
      shear(m) = -m*dot_product(wall_share, [walls(2), u(m), u(m - 1)])
   end function shear_differences

   !> Computes eta/mu_0 from ln(mu/mu_0) and g^2, with its derivatives by both. asinh(sqrt w)/sqrt w
   !> is smooth in w = B^2, also at rest.
   pure elemental subroutine shear_viscosity(scale, ln_mu, shear2, eta, by_ln_mu, by_shear2)
      real(wp), intent(in) :: scale, ln_mu, shear2
      real(wp), intent(out) :: eta, by_ln_mu, by_shear2
      real(wp) :: mu, w, ratio, slope, root

      mu = exp(ln_mu)
      w = (scale*mu)**2*shear2
      if (w < smallest_square) then
         ratio = 1 - w*(1.0_wp/6 - w*(3.0_wp/40 - w*(5.0_wp/112 - w*35.0_wp/1152)))
         slope = -1.0_wp/6 + w*(3.0_wp/20 - w*(15.0_wp/112 - w*35.0_wp/288))
      else
         root = sqrt(w)
         ratio = asinh(root)/root
         slope = 0.5_wp*(1/sqrt(1 + w) - ratio)/w
      end if
      eta = mu*ratio
      by_ln_mu = mu*(ratio + 2*w*slope)
      by_shear2 = mu*slope*(scale*mu)**2
   end subroutine shear_viscosity

end module thin_film_flow

!> Viscosity under shear as the momentum equations need it: eta = mu asinh(B)/B, B = c mu g, with
!> g the shear rate and c = mu_0 u_s/(tau_0 h_ref); a Newtonian oil has c = 0.
module shear_law
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: shear_viscosity

   !> Below this B^2 the series is used, exact to 1e-16 there.
   real(wp), parameter :: series_limit = 1.0e-3_wp

contains

   !> eta/mu_0 from ln(mu/mu_0) and g^2, with its derivatives by both. asinh(sqrt w)/sqrt w is
   !> smooth in w = B^2, also at rest.
   pure elemental subroutine shear_viscosity(scale, ln_mu, shear2, eta, by_ln_mu, by_shear2)
      real(wp), intent(in) :: scale, ln_mu, shear2
      real(wp), intent(out) :: eta, by_ln_mu, by_shear2
      real(wp) :: mu, w, ratio, slope, root

      mu = exp(ln_mu)
      w = (scale*mu)**2*shear2
      if (w < series_limit) then
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

end module shear_law

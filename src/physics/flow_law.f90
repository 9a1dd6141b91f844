!> What every shear-thinning flow law of an oil must provide: a law without one of these procedures
!> does not compile.
module flow_law
   use kinds, only: wp
   implicit none (type, external)
   private

   !> Most points evaluated at a time.
   integer, parameter, public :: slip_block = 128

   !> Bound of ln(S/mu): a wild iterate (|Sigma| beyond 500 at low pressure) must not overflow. No
   !> solution comes near it.
   real(wp), parameter, public :: largest_exponent = 500.0_wp

   !> S = exp(growth) factor at up to `slip_block` points, and the derivatives of ln S by the drive
   !> H dP/dX, by ln(mu/mu_0), and by ln H at constant dP/dX.
   type, public :: slip_t
      real(wp), dimension(slip_block) :: growth = 0.0_wp, factor = 1.0_wp, by_drive = 0.0_wp, &
         by_ln_mu = 0.0_wp, by_ln_film = 0.0_wp
   end type slip_t

   !> A law with one stress scale tau_0. The flow driven by H dP/dX is S >= 1 times that of the
   !> viscosity mu alone. Arrays have m <= `slip_block` points.
   type, abstract, public :: flow_law_t
      !> Sigma = sigma_scale H dP/dX: b p_h/(2 R tau_0) [-], from (2.12) and (2.51).
      real(wp) :: sigma_scale = 0.0_wp
      !> ln B = ln_b_scale + ln(mu/mu_0) - ln H: ln( mu_0 |u2 - u1| R/(tau_0 b^2) ) [-], from (2.14)
      !> and (2.51).
      real(wp) :: ln_b_scale = 0.0_wp
   contains
      !> Computes S from the `drive` H dP/dX, 1/H and ln(mu/mu_0); derivatives only `has_slopes`.
      procedure(slip_interface), deferred :: evaluate_slip
      !> Computes ln S at one point, with the `film` H, and its derivative by the drive.
      procedure(ln_slip_interface), deferred :: ln_slip
      !> Computes the mean shear stress across the film [p_h b/R] with the sign of `couette` =
      !> lambda/6 (u2 - u1)/(u1 + u2).
      procedure(stress_interface), deferred :: evaluate_stress
      !> d tau/dp [b/R] of sliding at a given shear rate, from the stress of a Newtonian oil and the
      !> `slope` of ln mu by P.
      procedure(stress_rise_interface), deferred :: stress_rise
      !> Shares of sliding and pressure in the velocity at y = 2 z/h - 1 (module eyring).
      procedure(shapes_interface), deferred :: flow_shapes
   end type flow_law_t

   abstract interface
      pure subroutine slip_interface(self, drive, inverse_film, ln_mu, has_slopes, slip)
         import :: flow_law_t, slip_t, wp
         class(flow_law_t), intent(in) :: self
         real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
         logical, intent(in) :: has_slopes
         type(slip_t), intent(inout) :: slip
      end subroutine slip_interface

      pure elemental subroutine ln_slip_interface(self, drive, film, ln_mu, ln_s, by_drive)
         import :: flow_law_t, wp
         class(flow_law_t), intent(in) :: self
         real(wp), intent(in) :: drive, film, ln_mu
         real(wp), intent(out) :: ln_s, by_drive
      end subroutine ln_slip_interface

      pure subroutine stress_interface(self, couette, drive, inverse_film, ln_mu, stress)
         import :: flow_law_t, wp
         class(flow_law_t), intent(in) :: self
         real(wp), intent(in) :: couette
         real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
         real(wp), intent(out), contiguous :: stress(:)
      end subroutine stress_interface

      pure elemental real(wp) function stress_rise_interface(self, newtonian, slope) result(rise)
         import :: flow_law_t, wp
         class(flow_law_t), intent(in) :: self
         real(wp), intent(in) :: newtonian, slope
      end function stress_rise_interface

      pure elemental subroutine shapes_interface(self, drive, y, sliding, driven)
         import :: flow_law_t, wp
         class(flow_law_t), intent(in) :: self
         real(wp), intent(in) :: drive, y
         real(wp), intent(out) :: sliding, driven
      end subroutine shapes_interface
   end interface

end module flow_law

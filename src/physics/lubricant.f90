!> The lubricant in SI, and the same in dimensionless form with its laws evaluated on arrays of
!> nodes.
module lubricant
   use density, only: dowson_higginson_densities
   use kinds, only: wp
   use viscosity, only: barus_viscosities, roelands_viscosities
   implicit none (type, external)
   private

   public :: fluid_viscosity, fluid_density

   !> Viscosity laws: mu = mu_0; Barus; Roelands (module viscosity).
   integer, parameter, public :: viscosity_constant = 0, viscosity_barus = 1, viscosity_roelands = 2
   !> Density laws: rho = rho_0; Dowson and Higginson (module density).
   integer, parameter, public :: density_constant = 0, density_dowson_higginson = 1
   !> Rheology laws: mu whatever the shear; Eyring (module eyring).
   integer, parameter, public :: rheology_newtonian = 0, rheology_eyring = 1

   !> Their names in the input, by number.
   character(len=16), parameter, public :: viscosity_laws(0:2) = [character(len=16) :: 'constant', &
      'barus', 'roelands'], density_laws(0:1) = [character(len=16) :: 'constant', &
      'dowson_higginson'], rheologies(0:1) = [character(len=16) :: 'newtonian', 'eyring']

   !> The lubricant as the user describes it.
   type, public :: lubricant_t
      !> Ambient viscosity mu_0 [Pa s] > 0.
      real(wp) :: viscosity
      !> One of `viscosity_constant`, `viscosity_barus`, `viscosity_roelands`.
      integer :: viscosity_law
      !> alpha [1/Pa] >= 0; Barus and Roelands.
      real(wp) :: pressure_viscosity
      !> P0 [Pa] > 0; Roelands, agrees with alpha and z by (2.27).
      real(wp) :: roelands_p0
      !> z [-] > 0; Roelands.
      real(wp) :: roelands_z
      !> One of `density_constant`, `density_dowson_higginson`.
      integer :: density_law
      !> One of `rheology_newtonian`, `rheology_eyring`.
      integer :: rheology
      !> tau_0 [Pa] > 0; Eyring.
      real(wp) :: eyring_stress
   end type lubricant_t

   !> The lubricant as the dimensionless equations see it; made by `scaled_fluid` of module scaling.
   type, public :: fluid_t
      !> As in `lubricant_t`.
      integer :: viscosity_law, density_law
      !> alpha p_h [-] >= 0, (2.56).
      real(wp) :: alpha_bar
      !> P0/p_h [-] > 0; Roelands.
      real(wp) :: p0
      !> z [-] > 0; Roelands.
      real(wp) :: z
      !> C1/p_h [-] > 0; Dowson and Higginson.
      real(wp) :: c1
      !> As in `lubricant_t`; what follows from it is in module rheology.
      integer :: rheology
      !> Sigma = sigma_scale H dP/dX: b p_h/(2 R tau_0) [-], from (2.12) and (2.51).
      real(wp) :: sigma_scale
      !> ln B = ln_b_scale + ln(mu/mu_0) - ln H: ln( mu_0 |u2 - u1| R/(tau_0 b^2) ) [-], from (2.14)
      !> and (2.51).
      real(wp) :: ln_b_scale
   end type fluid_t

contains

   !> ln(mu/mu_0) and, where it is asked for, its derivative by P at the pressures `p` (n) >= 0 [-].
   pure subroutine fluid_viscosity(fluid, p, ln_mu, dln_mu)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(out), contiguous :: ln_mu(:)
      real(wp), intent(out), contiguous, optional :: dln_mu(:)

      select case (fluid%viscosity_law)
      case (viscosity_roelands)
         call roelands_viscosities(p, fluid%alpha_bar, fluid%p0, fluid%z, ln_mu, dln_mu)
      case (viscosity_barus)
         call barus_viscosities(p, fluid%alpha_bar, ln_mu, dln_mu)
      case (viscosity_constant)
         ln_mu = 0.0_wp
         if (present(dln_mu)) dln_mu = 0.0_wp
      case default
         error stop 'fluid_viscosity: a law without its case'
      end select
   end subroutine fluid_viscosity

   !> rho/rho_0 and, where it is asked for, its derivative by P at the pressures `p` (n) >= 0 [-].
   pure subroutine fluid_density(fluid, p, rho, drho)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(out), contiguous :: rho(:)
      real(wp), intent(out), contiguous, optional :: drho(:)

      select case (fluid%density_law)
      case (density_dowson_higginson)
         call dowson_higginson_densities(p, fluid%c1, rho, drho)
      case (density_constant)
         rho = 1.0_wp
         if (present(drho)) drho = 0.0_wp
      case default
         error stop 'fluid_density: a law without its case'
      end select
   end subroutine fluid_density

end module lubricant

!> The lubricant in SI and in dimensionless form, with its laws of viscosity and density on arrays
!> of nodes.
!>
!> Viscosities are ln(mu/mu_0), because mu itself exceeds 1e300 within the valid range of alpha p.
!> Laws take pressure, 1/alpha, P0 and C1 in the same unit: SI, or all divided by the Hertz
!> pressure.
module lubricant
   use flow_law, only: flow_law_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: barus_viscosities, dowson_higginson_densities, fluid_density, fluid_viscosity, &
      roelands_viscosities

   !> Viscosity laws: mu = mu_0; Barus; Roelands.
   integer, parameter, public :: viscosity_constant = 0, viscosity_barus = 1, viscosity_roelands = 2
   !> Density laws: rho = rho_0; Dowson and Higginson.
   integer, parameter, public :: density_constant = 0, density_dowson_higginson = 1

   !> Pressure constant C1 [Pa] of (2.28), (2.63); D. Dowson and G. R. Higginson,
   !> Elasto-hydrodynamic lubrication, 1966.
   real(wp), parameter, public :: dowson_higginson_c1 = 5.9e8_wp
   !> Density ratio C2 [-] of (2.28), (2.63) to which the law tends at infinite pressure; same
   !> source.
   real(wp), parameter :: dowson_higginson_c2 = 1.34_wp

   !> Their names in the input, by number.
   character(len=16), parameter, public :: viscosity_laws(0:2) = [character(len=16) :: &
      'constant', 'barus', 'roelands'], density_laws(0:1) = [character(len=16) :: &
      'constant', 'dowson_higginson']

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
      !> One of the constants of module scaling.
      integer :: rheology
      !> tau_0 [Pa] > 0 of a shear-thinning law.
      real(wp) :: stress_scale
      !> Limiting shear stress over the pressure [-]; 0: none. Whether it cuts the stress off.
      real(wp) :: limit_ratio = 0.0_wp
      logical :: is_cut = .false.
   end type lubricant_t

   !> The lubricant in the dimensionless equations; made by `scaled_fluid` of module scaling.
   type, public :: fluid_t
      !> As in `lubricant_t`.
      integer :: viscosity_law = viscosity_constant, density_law = density_constant
      !> alpha p_h [-] >= 0, (2.56).
      real(wp) :: alpha_bar = 0.0_wp
      !> P0/p_h [-] > 0; Roelands.
      real(wp) :: p0 = 1.0_wp
      !> z [-] > 0; Roelands.
      real(wp) :: z = 1.0_wp
      !> C1/p_h [-] > 0; Dowson and Higginson.
      real(wp) :: c1 = 1.0_wp
      !> Limiting shear stress over the pressure, Lambda R/b; 0: none. Whether it cuts the stress.
      real(wp) :: stress_limit = 0.0_wp
      logical :: is_cut = .false.
      !> Its shear thinning (module rheology); not allocated: Newtonian.
      class(flow_law_t), allocatable :: rheology
   end type fluid_t

contains

   !> Computes ln(mu/mu_0) and, if present, its derivative by P at the pressures `p` (n) >= 0 [-].
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

   !> Computes rho/rho_0 and, if present, its derivative by P at the pressures `p` (n) >= 0 [-].
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

   !> Barus' law on arrays (n):  ln(mu/mu_0) = alpha p; C. Barus, Am. J. Sci. 45, 1893, 87; the
   !> limit z = 1 of (2.26).
   !>
   !> `p` >= 0; `alpha` >= 0; realistic below about 0.3 GPa. Results as in `roelands_viscosities`.
   pure subroutine barus_viscosities(p, alpha, ln_mu, dln_mu)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: alpha
      real(wp), intent(out), contiguous :: ln_mu(:)
      real(wp), intent(out), contiguous, optional :: dln_mu(:)

      ln_mu = alpha*p
      if (present(dln_mu)) dln_mu = alpha
   end subroutine barus_viscosities

   !> Roelands' law (2.26), (2.61) on arrays (n), in one loop that the compiler vectorises:
   !> ln(mu/mu_0) = (alpha P0/z) [ (1 + p/P0)^z - 1 ].
   !>
   !> `p` >= 0; `alpha` >= 0; `p0` > 0; `z` > 0 (0.4 ... 0.8 for oils; z = 1 is Barus). `ln_mu` =
   !> ln(mu/mu_0) [-]; `dln_mu`, if present, its derivative by p [1/unit of p].
   pure subroutine roelands_viscosities(p, alpha, p0, z, ln_mu, dln_mu)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: alpha, p0, z
      real(wp), intent(out), contiguous :: ln_mu(:)
      real(wp), intent(out), contiguous, optional :: dln_mu(:)
      real(wp) :: unused
      integer :: i

      if (present(dln_mu)) then
         do i = 1, size(p)
            call roelands(p(i), alpha, p0, z, ln_mu(i), dln_mu(i))
         end do
      else
         do i = 1, size(p)
            call roelands(p(i), alpha, p0, z, ln_mu(i), unused)
         end do
      end if
   end subroutine roelands_viscosities

   !> The law at one pressure; private, so that position-independent code also inlines it in the
   !> loops.
   pure elemental subroutine roelands(p, alpha, p0, z, ln_mu, dln_mu)
      real(wp), intent(in) :: p, alpha, p0, z
      real(wp), intent(out) :: ln_mu, dln_mu
      real(wp) :: ratio, power

      ratio = 1.0_wp + p/p0
      power = exp(z*log(ratio))
      ln_mu = (alpha*p0/z)*(power - 1.0_wp)
      dln_mu = alpha*power/ratio
   end subroutine roelands

   !> Dowson and Higginson's law (2.28), (2.63) on arrays (n), in one loop that the compiler
   !> vectorises: rho/rho_0 = (C1 + C2 p)/(C1 + p).
   !>
   !> `p` >= 0 and `c1` > 0 in the same unit (SI, or both divided by the Hertz pressure). `rho` =
   !> rho/rho_0 [-], between 1 and C2; `drho`, if present, its derivative by p [1/unit of p].
   pure subroutine dowson_higginson_densities(p, c1, rho, drho)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: c1
      real(wp), intent(out), contiguous :: rho(:)
      real(wp), intent(out), contiguous, optional :: drho(:)
      real(wp) :: unused
      integer :: i

      if (present(drho)) then
         do i = 1, size(p)
            call dowson_higginson(p(i), c1, rho(i), drho(i))
         end do
      else
         do i = 1, size(p)
            call dowson_higginson(p(i), c1, rho(i), unused)
         end do
      end if
   end subroutine dowson_higginson_densities

   !> The law at one pressure; private, so that position-independent code also inlines it in the
   !> loops.
   pure elemental subroutine dowson_higginson(p, c1, rho, drho)
      real(wp), intent(in) :: p, c1
      real(wp), intent(out) :: rho, drho
      real(wp) :: fraction

      fraction = 1.0_wp/(c1 + p)
      rho = (c1 + dowson_higginson_c2*p)*fraction
      drho = (dowson_higginson_c2 - 1.0_wp)*(c1*fraction)*fraction
   end subroutine dowson_higginson

end module lubricant

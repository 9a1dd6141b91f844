!> The lubricant in SI and in dimensionless form, with its laws of viscosity and density on arrays
!> of nodes.
!>
!> Viscosities are ln(mu/mu_0), because mu itself exceeds 1e300 within the valid range of alpha p.
!> Laws take pressure, 1/alpha, P0 and C1 in the same unit: SI, or all divided by the Hertz
!> pressure.
!>
!> Shear thinning of the lubricant of a contact: values of its flow law, or of a Newtonian
!> lubricant, whose slip factor S is 1.
module lubricant
   use flow_law, only: flow_law_t, largest_exponent
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: dowson_higginson_densities, eased_fluid, evaluate_stress, &
      evaluate_stress_rise, faster_fluid, flow_shapes, fluid_density, fluid_viscosity, &
      limited_stress, ln_slip, roelands_viscosities, slide_to_roll, sliding_number, thins, &
      wall_stress

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
      !> Its shear thinning; not allocated: Newtonian.
      class(flow_law_t), allocatable :: rheology
   end type fluid_t

contains

   !> Computes ln(mu/mu_0) and, if present, its derivative by P at the pressures `p` (n) >= 0 [-].
   !> C. Barus' law, alpha p (Am. J. Sci. 45, 1893, 87), the limit z = 1 of (2.26), is realistic
   !> below about 0.3 GPa.
   pure subroutine fluid_viscosity(fluid, p, ln_mu, dln_mu)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(out), contiguous :: ln_mu(:)
      real(wp), intent(out), contiguous, optional :: dln_mu(:)

      select case (fluid%viscosity_law)
      case (viscosity_roelands)
         call roelands_viscosities(p, fluid%alpha_bar, fluid%p0, fluid%z, ln_mu, dln_mu)
      case (viscosity_barus)
         ln_mu = fluid%alpha_bar*p
         if (present(dln_mu)) dln_mu = fluid%alpha_bar
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

   !> Whether the fluid is shear-thinning: else S = 1 and the drive does not matter.
   pure elemental logical function thins(fluid)
      type(fluid_t), intent(in) :: fluid

      thins = allocated(fluid%rheology)
   end function thins

   !> Shear stress at the walls, h/2 |dp/dx|, over the stress scale of the fluid [-], with the sign
   !> of the `drive` H dP/dX: Sigma of module eyring; 0 for a Newtonian fluid.
   pure elemental real(wp) function wall_stress(fluid, drive) result(stress)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: drive

      stress = 0.0_wp
      if (allocated(fluid%rheology)) stress = fluid%rheology%sigma_scale*drive
   end function wall_stress

   !> Computes the mean shear stress across the film at m points, in units of p_h b/R, positive for
   !> u2 > u1, from the `drive` H dP/dX, 1/H and ln(mu/mu_0). `couette` = lambda/6 (u2 - u1)/(u1 +
   !> u2): the stress of a Newtonian fluid is that times (mu/mu_0)/H.
   pure subroutine evaluate_stress(fluid, couette, drive, inverse_film, ln_mu, stress)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
      real(wp), intent(out), contiguous :: stress(:)

      if (allocated(fluid%rheology)) then
         call fluid%rheology%evaluate_stress(couette, drive, inverse_film, ln_mu, stress)
      else
         stress = couette*exp(min(ln_mu, largest_exponent))*inverse_film
      end if
   end subroutine evaluate_stress

   !> A mean stress within the limit tau_L = Lambda p of the oil: at most that, or by tau_L (1 -
   !> exp(-tau/tau_L)) (S. Bair and W. O. Winer, J. Lubr. Technol. 101, 1979, 251; with a thinning
   !> oil a composite law). The limit changes friction alone, not the film.
   pure elemental real(wp) function limited_stress(fluid, pressure, stress) result(limited)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: pressure, stress
      real(wp) :: most

      limited = stress
      if (.not. fluid%stress_limit > 0.0_wp) return
      most = max(fluid%stress_limit*pressure, tiny(1.0_wp))
      if (fluid%is_cut) then
         limited = sign(min(abs(stress), most), stress)
      else
         limited = sign(most*(1 - exp(-abs(stress)/most)), stress)
      end if
   end function limited_stress

   !> Computes d tau/dp of sliding alone at a given shear rate at m points, in the unit b/R, >= 0,
   !> from the film H, ln(mu/mu_0) and its `slope` by P; `couette` as in `evaluate_stress`.
   pure subroutine evaluate_stress_rise(fluid, couette, film, ln_mu, slope, rise)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: film(:), ln_mu(:), slope(:)
      real(wp), intent(out), contiguous :: rise(:)

      rise = abs(couette)*exp(min(ln_mu, largest_exponent))/film
      if (allocated(fluid%rheology)) then
         rise = fluid%rheology%stress_rise(rise, slope)
      else
         rise = rise*slope
      end if
   end subroutine evaluate_stress_rise

   !> ln S at one point, with the `drive` H dP/dX, the `film` H and ln(mu/mu_0).
   pure elemental function ln_slip(fluid, drive, film, ln_mu) result(ln_s)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: drive, film, ln_mu
      real(wp) :: ln_s, by_drive

      ln_s = 0.0_wp
      if (allocated(fluid%rheology)) call fluid%rheology%ln_slip(drive, film, ln_mu, ln_s, by_drive)
   end function ln_slip

   !> Shares of sliding and pressure in the velocity at y = 2 z/h - 1, as in module eyring.
   pure elemental subroutine flow_shapes(fluid, drive, y, sliding, driven)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: drive, y
      real(wp), intent(out) :: sliding, driven

      if (allocated(fluid%rheology)) then
         call fluid%rheology%flow_shapes(drive, y, sliding, driven)
      else
         sliding = y
         driven = 1.5_wp*(1 - y)*(1 + y)
      end if
   end subroutine flow_shapes

   !> The same fluid with a stress scale higher by `factor` >= 1: it thins less.
   pure function eased_fluid(fluid, factor) result(eased)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: factor
      type(fluid_t) :: eased

      eased = fluid
      if (.not. allocated(eased%rheology)) return
      eased%rheology%sigma_scale = fluid%rheology%sigma_scale/factor
      eased%rheology%ln_b_scale = fluid%rheology%ln_b_scale - log(factor)
   end function eased_fluid

   !> The fluid with `factor` > 0 times its ambient viscosity, or between walls that slide so many
   !> times as fast.
   pure function faster_fluid(fluid, factor) result(faster)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: factor
      type(fluid_t) :: faster

      faster = fluid
      if (allocated(faster%rheology)) faster%rheology%ln_b_scale = fluid%rheology%ln_b_scale &
         + log(factor)
   end function faster_fluid

   !> B H/(mu/mu_0) of sliding [-]; 0 for a Newtonian fluid.
   pure real(wp) function sliding_number(fluid) result(number)
      type(fluid_t), intent(in) :: fluid

      number = 0.0_wp
      if (allocated(fluid%rheology)) number = exp(fluid%rheology%ln_b_scale)
   end function sliding_number

   !> Slide-to-roll ratio |u2 - u1|/((u1 + u2)/2) of a contact with the speed parameter `lambda` and
   !> a shear-thinning fluid: 6 B H/(lambda mu Sigma/(H dP/dX)).
   pure real(wp) function slide_to_roll(fluid, lambda) result(ratio)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda

      ratio = 6*sliding_number(fluid)/(lambda*fluid%rheology%sigma_scale)
   end function slide_to_roll

end module lubricant

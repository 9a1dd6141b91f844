!> How the lubricant thins under shear: the slip factor S of the flow between the surfaces, by the
!> rheology of the fluid.
!>
!> A law that a procedure has no case for stops the program: none passes for another.
!>
!> The flow that H dP/dX drives is S >= 1 times that of the viscosity mu alone; S = 1 for a
!> Newtonian lubricant. A solver asks whether the fluid thins (`thins`), for S, and how large the
!> stress is beside the stress scale of the fluid (`wall_stress`).
module rheology
   use eyring, only: ln_slip_factor, mean_stresses, slip_factor, slip_factors, slip_values
   use kinds, only: wp
   use lubricant, only: fluid_t, rheology_eyring, rheology_newtonian
   use model_limits, only: pressure_derivative_of_stress
   implicit none (type, external)
   private

   public :: eased_fluid, evaluate_slip, evaluate_slip_slopes, evaluate_stress, &
      evaluate_stress_rise, ln_slip, ln_slip_with_slope, slide_to_roll, slip_t, thins, wall_stress

   !> Places evaluated at a time, at most.
   integer, parameter, public :: slip_block = 128
   !> Bound of ln(S/mu): a wild iterate (|Sigma| beyond 500 at low pressure) must not overflow. No
   !> solution comes near it.
   real(wp), parameter, public :: largest_exponent = 500.0_wp

   !> Why the program stops where it would take one law for another.
   character(*), parameter :: no_case = 'module rheology: a law without its case'

   !> S = exp(growth) factor at up to `slip_block` places, and the derivatives of ln S by the drive
   !> H dP/dX, by ln(mu/mu_0), and by ln H where dP/dX stays.
   type :: slip_t
      real(wp), dimension(slip_block) :: growth = 0.0_wp, factor = 1.0_wp, by_drive = 0.0_wp, &
         by_ln_mu = 0.0_wp, by_ln_film = 0.0_wp
   end type slip_t

contains

   !> Whether shear thins the fluid: else S = 1 and the drive does not matter.
   pure elemental function thins(fluid)
      type(fluid_t), intent(in) :: fluid
      logical :: thins

      select case (fluid%rheology)
      case (rheology_newtonian)
         thins = .false.
      case (rheology_eyring)
         thins = .true.
      case default
         error stop no_case
      end select
   end function thins

   !> Shear stress at the walls, h/2 |dp/dx|, over the stress scale of the fluid [-], with the sign
   !> of the `drive` H dP/dX: Sigma of module eyring; 0 where nothing thins.
   pure elemental function wall_stress(fluid, drive) result(stress)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: drive
      real(wp) :: stress

      stress = 0.0_wp
      if (thins(fluid)) stress = fluid%sigma_scale*drive
   end function wall_stress

   !> S at m <= `slip_block` places with the `drive` H dP/dX, 1/H and ln(mu/mu_0); derivatives are
   !> left as they are.
   pure subroutine evaluate_slip(fluid, drive, inverse_film, ln_mu, slip)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
      type(slip_t), intent(inout) :: slip
      real(wp), dimension(slip_block) :: sigma, ln_b
      integer :: m

      if (.not. thins(fluid)) return
      if (fluid%rheology /= rheology_eyring) error stop no_case
      m = size(drive)
      sigma(:m) = fluid%sigma_scale*drive
      ln_b(:m) = fluid%ln_b_scale + ln_mu
      call slip_values(sigma(:m), ln_b(:m), inverse_film, slip%growth(:m), slip%factor(:m))
   end subroutine evaluate_slip

   !> `evaluate_slip` with the derivatives.
   pure subroutine evaluate_slip_slopes(fluid, drive, inverse_film, ln_mu, slip)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
      type(slip_t), intent(inout) :: slip
      real(wp), dimension(slip_block) :: sigma, ln_b, by_sigma
      integer :: m

      if (.not. thins(fluid)) return
      if (fluid%rheology /= rheology_eyring) error stop no_case
      m = size(drive)
      sigma(:m) = fluid%sigma_scale*drive
      ln_b(:m) = fluid%ln_b_scale + ln_mu
      call slip_factors(sigma(:m), ln_b(:m), inverse_film, slip%growth(:m), slip%factor(:m), &
         by_sigma(:m), slip%by_ln_mu(:m))
      slip%by_drive(:m) = by_sigma(:m)*fluid%sigma_scale
      slip%by_ln_film(:m) = by_sigma(:m)*sigma(:m) - slip%by_ln_mu(:m)
   end subroutine evaluate_slip_slopes

   !> Mean shear stress across the film at m places, in units of p_h b/R, positive where u2 > u1;
   !> drive, 1/H and ln(mu/mu_0) as in `evaluate_slip`. `couette` = lambda/6 (u2 - u1)/(u1 + u2):
   !> the stress of a Newtonian fluid is that times (mu/mu_0)/H.
   pure subroutine evaluate_stress(fluid, couette, drive, inverse_film, ln_mu, stress)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: drive(:), inverse_film(:), ln_mu(:)
      real(wp), intent(out), contiguous :: stress(:)

      select case (fluid%rheology)
      case (rheology_eyring)
         call mean_stresses(fluid%sigma_scale*drive, fluid%ln_b_scale + ln_mu, inverse_film, stress)
         stress = stress_unit(fluid, couette)*stress
      case (rheology_newtonian)
         stress = couette*exp(min(ln_mu, largest_exponent))*inverse_film
      case default
         error stop no_case
      end select
   end subroutine evaluate_stress

   !> d tau/dp of the sliding alone at a given shear rate at m places, in the unit b/R, >= 0, from
   !> the film H, ln(mu/mu_0) and its `slope` by P; `couette` as in `evaluate_stress`.
   pure subroutine evaluate_stress_rise(fluid, couette, film, ln_mu, slope, rise)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: film(:), ln_mu(:), slope(:)
      real(wp), intent(out), contiguous :: rise(:)
      real(wp) :: eyring

      eyring = 0.0_wp
      if (all(fluid%rheology /= [rheology_newtonian, rheology_eyring])) error stop no_case
      if (fluid%rheology == rheology_eyring) eyring = 0.5_wp/fluid%sigma_scale
      rise = pressure_derivative_of_stress(abs(couette)*exp(min(ln_mu, largest_exponent))/film, &
         eyring, slope)
   end subroutine evaluate_stress_rise

   !> The Eyring stress tau_0 in units of p_h b/R, with the sign of `couette`; 0 where that is 0,
   !> NaN where it is not known.
   pure function stress_unit(fluid, couette) result(unit)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp) :: unit

      unit = couette
      if (abs(couette) > 0.0_wp) unit = sign(0.5_wp/fluid%sigma_scale, couette)
   end function stress_unit

   !> ln S at one place, with the `drive` H dP/dX, the `film` H and ln(mu/mu_0).
   pure elemental function ln_slip(fluid, drive, film, ln_mu) result(ln_s)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: drive, film, ln_mu
      real(wp) :: ln_s

      ln_s = 0.0_wp
      if (.not. thins(fluid)) return
      if (fluid%rheology /= rheology_eyring) error stop no_case
      ln_s = ln_slip_factor(fluid%sigma_scale*drive, fluid%ln_b_scale + ln_mu - log(film))
   end function ln_slip

   !> `ln_slip` with its derivative by the drive.
   pure elemental subroutine ln_slip_with_slope(fluid, drive, film, ln_mu, ln_s, by_drive)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: drive, film, ln_mu
      real(wp), intent(out) :: ln_s, by_drive
      real(wp) :: by_ln_b

      ln_s = 0.0_wp
      by_drive = 0.0_wp
      if (.not. thins(fluid)) return
      if (fluid%rheology /= rheology_eyring) error stop no_case
      call slip_factor(fluid%sigma_scale*drive, fluid%ln_b_scale + ln_mu - log(film), ln_s, &
         by_drive, by_ln_b)
      by_drive = by_drive*fluid%sigma_scale
   end subroutine ln_slip_with_slope

   !> The same fluid with a stress scale higher by `factor` >= 1: it thins less.
   pure function eased_fluid(fluid, factor) result(eased)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: factor
      type(fluid_t) :: eased

      eased = fluid
      eased%sigma_scale = fluid%sigma_scale/factor
      eased%ln_b_scale = fluid%ln_b_scale - log(factor)
   end function eased_fluid

   !> Slide-to-roll ratio |u2 - u1|/((u1 + u2)/2) of a contact with the speed parameter `lambda`
   !> whose fluid thins: 6 B H/(lambda mu Sigma/(H dP/dX)).
   pure function slide_to_roll(fluid, lambda) result(ratio)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda
      real(wp) :: ratio

      ratio = 6*exp(fluid%ln_b_scale)/(lambda*fluid%sigma_scale)
   end function slide_to_roll

end module rheology

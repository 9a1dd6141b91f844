!> Shear thinning of the lubricant of a contact: values of its flow law, or of a Newtonian
!> lubricant, whose slip factor S is 1.
module rheology
   use flow_law, only: largest_exponent
   use kinds, only: wp
   use lubricant, only: fluid_t
   implicit none (type, external)
   private

   public :: eased_fluid, evaluate_stress, evaluate_stress_rise, faster_fluid, flow_shapes, &
      limited_stress, ln_slip, sliding_number, slide_to_roll, thins, wall_stress

contains

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

end module rheology

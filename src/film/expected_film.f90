!> Film of a contact by formulas, before it is solved: to choose domains, grids and starts, and to
!> estimate the effect of another oil.
!>
!> With a shear-thinning oil the film builds up in front of the contact over a length s, where the
!> gap has opened by about the film itself: s ~ H^(2/3) in front of a Hertzian contact (gap ~
!> s^(3/2)), s ~ H^(1/2) between rigid cylinders (gap ~ s^2), which is the longer one for a thick
!> film. Over it the pressure rises to P ~ s^(1/2) with P' ~ s^(-1/2) along Hertz's profile, or to P
!> ~ 1/s with P' ~ 1/s^2 where the load rests on s. The flow must then carry about the film away:
!>
!>     H^3 S(Sigma, B) P'/mu = 0.7 lambda H ,     P = 0.75 min(H^(1/3), H^(-1/2)) ,
!>     P' = min(H^(-1/3), 1/H)
!>
!> with Sigma and B of this H, P and P' (module eyring). Where S = B, mu drops out: H = 0.6 (lambda
!> H/B)^(3/2), B H being constant, for any L. With H_e the solution for this S, H_1 that for S = 1,
!> and H_N the Newtonian film of Moes:
!>
!>     H = [ H_N^(-0.7) + H_e^(-0.7) - H_1^(-0.7) ]^(-1/0.7)
!>
!> The numbers are fitted; ln H is off by 0.2 in the mean square (docs/decisions.md, film of a
!> shear-thinning lubricant).
module expected_film
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use lubricant, only: fluid_t, fluid_viscosity
   use moes, only: central_film
   use rheology, only: faster_fluid
   implicit none (type, external)
   private

   public :: clearing_film, film_estimate, film_with_viscosity, flooded_film, newtonian_film, &
      thinned_central_film

   !> Fitted values of pressure, flow over P' lambda, and the power that joins the limits.
   real(wp), parameter :: pressure_share = 0.75_wp, flow_share = 0.7_wp, power = 0.7_wp
   !> Film over rms height that clears the asperities.
   real(wp), parameter :: clearance = 3.0_wp
   !> Bounds of ln H, and number of bisections (to 3e-5).
   real(wp), parameter :: thinnest = -21.0_wp, thickest = 9.0_wp
   integer, parameter :: halvings = 20

contains

   !> Central film H_c [b^2/R] by the Moes fit, reduced by shear thinning, or that which clears the
   !> asperities if it is larger.
   pure real(wp) function film_estimate(contact) result(film)
      type(line_contact_t), intent(in) :: contact

      film = max(flooded_film(contact), clearing_film(contact))
   end function film_estimate

   !> That of the smooth contact.
   pure real(wp) function flooded_film(contact) result(film)
      type(line_contact_t), intent(in) :: contact

      film = thinned_central_film(contact%fluid, contact%lambda, newtonian_film(contact))
   end function flooded_film

   !> Film that clears the asperities; 0 where none touch.
   pure real(wp) function clearing_film(contact) result(film)
      type(line_contact_t), intent(in) :: contact

      film = 0.0_wp
      if (allocated(contact%asperities)) film = clearance*contact%asperities%roughness
   end function clearing_film

   !> The same for a Newtonian lubricant.
   pure real(wp) function newtonian_film(contact) result(film)
      type(line_contact_t), intent(in) :: contact

      film = central_film(contact%moes_m_sum, contact%moes_l_sum, contact%elasticity)
   end function newtonian_film

   !> Central film of a contact with `factor` > 0 times its viscosity, or speeds: M ~ mu_0^(-1/2), L
   !> ~ mu_0^(1/4) at the same alpha; lambda and Eyring's B ~ mu_0.
   pure real(wp) function film_with_viscosity(contact, factor) result(film)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      type(line_contact_t) :: other

      other%elasticity = contact%elasticity
      other%fluid = faster_fluid(contact%fluid, factor)
      other%lambda = factor*contact%lambda
      other%moes_m_sum = contact%moes_m_sum/sqrt(factor)
      other%moes_l_sum = contact%moes_l_sum*sqrt(sqrt(factor))
      film = flooded_film(other)
   end function film_with_viscosity

   !> Central film [b^2/R] of a contact with the speed parameter `lambda` > 0, whose Newtonian film
   !> is `newtonian` > 0 [b^2/R]: never more than that.
   pure function thinned_central_film(fluid, lambda, newtonian) result(film)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, newtonian
      real(wp) :: film, resistance

      film = newtonian
      if (.not. allocated(fluid%rheology)) return
      resistance = inlet_film(fluid, lambda, .true.)**(-power) - inlet_film(fluid, lambda, &
         .false.)**(-power)
      film = (newtonian**(-power) + max(resistance, 0.0_wp))**(-1/power)
   end function thinned_central_film

   !> H_e (`is_thinning`) or H_1, by bisection; the thickest film if the equation has no solution.
   pure function inlet_film(fluid, lambda, is_thinning) result(film)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda
      logical, intent(in) :: is_thinning
      real(wp) :: film, lower, upper, middle
      integer :: i

      lower = thinnest
      upper = thickest
      do i = 1, halvings
         middle = 0.5_wp*(lower + upper)
         if (excess_flow(fluid, lambda, is_thinning, middle) > 0.0_wp) then
            upper = middle
         else
            lower = middle
         end if
      end do
      film = exp(0.5_wp*(lower + upper))
   end function inlet_film

   !> ln of the flow over the required one, at ln H = `ln_film`.
   pure function excess_flow(fluid, lambda, is_thinning, ln_film) result(excess)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, ln_film
      logical, intent(in) :: is_thinning
      real(wp) :: excess, by_drive, ln_slope, ln_s, pressure, ln_mu(1)

      ln_slope = min(-ln_film/3, -ln_film)
      pressure = pressure_share*exp(min(ln_film/3, -ln_film/2))
      call fluid_viscosity(fluid, [pressure], ln_mu)
      excess = 2*ln_film + ln_slope - ln_mu(1) - log(flow_share*lambda)
      if (.not. is_thinning) return
      call fluid%rheology%ln_slip(exp(ln_film + ln_slope), exp(ln_film), ln_mu(1), ln_s, by_drive)
      excess = excess + ln_s
   end function excess_flow

end module expected_film

!> A contact whose load, radius and speeds change in time, at one of its moments: as a steady smooth
!> contact in units of its own, b sqrt(W r), p_h sqrt(W/r) and b^2/R W, with W = w/w_ref and r =
!> R/R_ref.
!>
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
module contact_moment
   use duty, only: moment_t
   use eyring, only: ln_b_of_no_sliding
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, smoothen_both
   use lubricant, only: faster_fluid, fluid_t, fluid_viscosity
   use moes, only: central_film, l_sum_per_mean, m_mean_per_sum, moes_l_from_alpha_bar, &
      moes_m_sum_from_lambda
   implicit none (type, external)
   private

   public :: at_moment, clearing_film, film_estimate, film_with_viscosity, flooded_film, &
      moments_of, newtonian_film, own_contact, set_sliding, thinned_central_film, width_of

   !> Moments of a table that choose domain and grid, at most.
   integer, parameter, public :: sample_count = 200
   !> Contacts draw in oil with at least this share of the reference speed when domain, grid and a
   !> start at rest are chosen: at standstill a film lasts that a faster contact has made.
   real(wp), parameter, public :: least_speed = 0.1_wp

   !> Fitted values of pressure, flow over P' lambda, and the power that joins the limits.
   real(wp), parameter :: pressure_share = 0.75_wp, flow_share = 0.7_wp, power = 0.7_wp
   !> Film over rms height that clears the asperities.
   real(wp), parameter :: clearance = 3.0_wp
   !> Bounds of ln H, and number of bisections (to 3e-5).
   real(wp), parameter :: thinnest = -21.0_wp, thickest = 9.0_wp
   integer, parameter :: halvings = 20

contains

   !> Half-width over that of the reference state.
   pure real(wp) function width_of(moment) result(width)
      type(moment_t), intent(in) :: moment

      width = sqrt(moment%load*moment%radius)
   end function width_of

   !> The contact at some moments of its duty, as if it moved at each.
   pure function moments_of(contact) result(moments)
      type(line_contact_t), intent(in) :: contact
      type(line_contact_t), allocatable :: moments(:)
      integer :: i

      associate (times => contact%duty%samples(sample_count))
         allocate (moments(size(times)))
         do i = 1, size(times)
            moments(i) = own_contact(contact, times(i), least_speed)
         end do
      end associate
   end function moments_of

   !> The smooth steady contact at `time` in its own units, with X in the direction of the flow;
   !> as if it moved at `least` so fast [u_ref].
   pure function own_contact(contact, time, least) result(own)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time, least
      type(line_contact_t) :: own
      type(moment_t) :: moment
      real(wp) :: pressure, speed

      moment = contact%duty%at(time)
      call smoothen_both(own)   ! without a copy of the duty
      own%surface_1%speed = 1.0_wp
      own%surface_2%speed = 1.0_wp
      own%fluid = contact%fluid
      own%elasticity = contact%elasticity
      pressure = sqrt(moment%load/moment%radius)
      speed = max(abs(sum(moment%speeds)), least)
      own%lambda = contact%lambda*speed*moment%radius/moment%load**2
      own%slide_to_roll = sign(2/speed, sum(moment%speeds))*(moment%speeds(2) &
         - moment%speeds(1))
      own%slope = contact%slope*pressure
      associate (fluid => own%fluid)
         fluid%alpha_bar = fluid%alpha_bar*pressure
         fluid%p0 = fluid%p0/pressure
         fluid%c1 = fluid%c1/pressure
         call set_sliding(fluid, contact%lambda, moment)
         if (allocated(fluid%rheology)) then
            fluid%rheology%sigma_scale = fluid%rheology%sigma_scale*moment%load/moment%radius
            fluid%rheology%ln_b_scale = fluid%rheology%ln_b_scale - log(moment%load)
         end if
         own%moes_m_sum = moes_m_sum_from_lambda(own%lambda)
         own%moes_l_sum = moes_l_from_alpha_bar(fluid%alpha_bar, own%moes_m_sum*m_mean_per_sum) &
            *l_sum_per_mean
      end associate
      own%domain = contact%domain
      associate (domain => own%domain, ends => [contact%domain%x_inlet, contact%domain%x_outlet] &
         /width_of(moment))
         domain%x_inlet = ends(1)
         domain%x_outlet = ends(2)
         if (sum(moment%speeds) < 0.0_wp) then
            domain%x_inlet = -ends(2)
            domain%x_outlet = -ends(1)
         end if
      end associate
   end function own_contact

   !> Sets what the sliding of a moment does to the slip factor of a fluid in reference units: B H
   !> over mu/mu_0 is lambda |u2 - u1|/u_ref (Sigma over H dP/dX)/3.
   pure subroutine set_sliding(fluid, lambda, moment)
      type(fluid_t), intent(inout) :: fluid
      real(wp), intent(in) :: lambda
      type(moment_t), intent(in) :: moment
      real(wp) :: sliding

      if (.not. allocated(fluid%rheology)) return
      sliding = abs(moment%speeds(2) - moment%speeds(1))*lambda*fluid%rheology%sigma_scale/3
      fluid%rheology%ln_b_scale = ln_b_of_no_sliding
      if (sliding > 0.0_wp) fluid%rheology%ln_b_scale = log(sliding)
   end subroutine set_sliding

   !> The contact with the sliding at `time`, in reference units.
   pure function at_moment(contact, time) result(now)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time
      type(line_contact_t) :: now
      type(moment_t) :: moment

      now = contact
      if (.not. allocated(contact%duty)) return
      moment = contact%duty%at(time)
      now%slide_to_roll = 2*(moment%speeds(2) - moment%speeds(1))
      call set_sliding(now%fluid, contact%lambda, moment)
   end function at_moment

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
         if (excess_flow(middle) > 0.0_wp) then
            upper = middle
         else
            lower = middle
         end if
      end do
      film = exp(0.5_wp*(lower + upper))
   contains

      !> ln of the flow over the required one, at ln H = `ln_film`.
      pure real(wp) function excess_flow(ln_film) result(excess)
         real(wp), intent(in) :: ln_film
         real(wp) :: by_drive, ln_slope, ln_s, pressure, ln_mu(1)

         ln_slope = min(-ln_film/3, -ln_film)
         pressure = pressure_share*exp(min(ln_film/3, -ln_film/2))
         call fluid_viscosity(fluid, [pressure], ln_mu)
         excess = 2*ln_film + ln_slope - ln_mu(1) - log(flow_share*lambda)
         if (.not. is_thinning) return
         call fluid%rheology%ln_slip(exp(ln_film + ln_slope), exp(ln_film), ln_mu(1), ln_s, &
            by_drive)
         excess = excess + ln_s
      end function excess_flow

   end function inlet_film

end module contact_moment

!> Predicts how high a pressure spike may become on finer grids.
!>
!> Where the oil leaves high pressure the half-spaces let the pressure rise as A/sqrt(distance), as
!> at the edge of a punch, and the top node of a grid has the height A/sqrt(dX) times a number: each
!> doubling of the grid raises it by up to sqrt(2). For a small wave of wavenumber k about a state
!> P, H the terms of Reynolds' equation are as
!>
!>     flow by pressure e k  :  change of film by deformation lambda rho/k
!>        :  change of density lambda rho' H .
!>
!> The deformation makes the spike; it ends at the longer of two lengths, below which another term
!> dominates:
!>
!>     l_flow = sqrt( e/(lambda rho) ) = sqrt( H^3 S/(mu lambda) ) ,    l_density = H rho'/rho .
!>
!> S is that of the top or of the flank, of the slope P/l_flow: without sliding an Eyring oil thins
!> only there.
!>
!> Both fall as the pressure of the spike rises, l_flow as exp(-ln mu/2). Its final height therefore
!> solves
!>
!>     P^2 = P_node^2 ( 1 + min( c_flow dX/l_flow(P) , c_density (dX/l_density(P))^(2/3) ) ) ,
!>
!> or does not exist. The numbers come from 90 contacts (M_sum 0.1 to 2000, L_sum 0.5 to 35, all
!> laws) on 64 to 262144 intervals. If an oil thins, P/l_flow is the slope of the flanks, which meet
!> in a corner: the top is up to half a spacing from the node, hence c_flow = 1/2, half of it by the
!> safety factor. If such a corner is less steep than a spike, the grid shows how high it may be
!> (`corner_top` of line_summary).
module pressure_spike
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use flow_law, only: largest_exponent
   use kinds, only: wp
   use line_summary, only: crests_t
   use lubricant, only: fluid_density, fluid_t, fluid_viscosity
   use missing_value, only: not_known
   use rheology, only: ln_slip, thins, wall_stress
   implicit none (type, external)
   private

   public :: ceiling_of_spike, final_height, shear_of_spike, smoothing_lengths, spike_law_t

   !> c_flow, that of an oil that thins, c_density and its power.
   real(wp), parameter :: flow_growth = 0.15_wp, corner_growth = 0.5_wp, density_growth = 1.1_wp, &
      density_power = 2.0_wp/3.0_wp
   !> Safety factor on the growth of a spike.
   real(wp), parameter :: safety = 2.0_wp
   !> A spike below the crest of the contact counts as passing it if this share of its growth would.
   real(wp), parameter :: sure_share = 1.0_wp/3.0_wp
   !> A in units of H_c^(2/3): height of the top node of a spike that a grid does not show.
   real(wp), parameter :: edge_strength = 0.5_wp
   !> Largest final height over that of the node that is searched for, steps of that search, and the
   !> largest one that is claimed (`max_claimed`).
   real(wp), parameter :: highest_growth = 20.0_wp, max_claimed = 3.0_wp
   integer, parameter :: max_steps = 200
   !> Halvings of the bracket of ln l_flow.
   integer, parameter :: bisections = 40
   !> Intervals of the integral over a spike.
   integer, parameter :: parts = 40
   !> A height without bound.
   real(wp), parameter, public :: endless = huge(1.0_wp)
   !> Relative accuracy of a height.
   real(wp), parameter :: accuracy = 1.0e-6_wp

   !> What the height of a spike depends on: the lubricant and lambda of (2.55).
   type :: spike_law_t
      type(fluid_t) :: fluid
      real(wp) :: lambda = 0.0_wp
   end type spike_law_t

contains

   !> The largest pressure that a spike may reach on grids finer than `dx`; 0 if it stays below the
   !> other crests, or if the grid shows none and would resolve it; NaN: not known. `film`: H at X =
   !> 0.
   pure function ceiling_of_spike(law, crests, film, dx) result(ceiling)
      type(spike_law_t), intent(in) :: law
      type(crests_t), intent(in) :: crests
      real(wp), intent(in) :: film, dx
      real(wp) :: ceiling, start, height, crest
      logical :: is_corner

      ! at one of several times the corner lies at a node
      is_corner = thins(law%fluid) .and. crests%corner_top >= 0.0_wp
      ceiling = 0.0_wp
      if (law%lambda <= 0.0_wp) return
      if (ieee_is_finite(crests%spike)) then
         height = final_height(law, crests%spike, crests%spike_film, dx, is_corner)
         crest = 0.0_wp
         if (ieee_is_finite(crests%other)) crest = crests%other
         ceiling = height
         if (height < endless) ceiling = crests%spike + safety*(height - crests%spike)
         if (ceiling <= crest) then
            ceiling = 0.0_wp
         else if (height > max_claimed*crests%spike) then
            ceiling = not_known()
         else if (crests%spike < crest .and. crests%spike &
            + sure_share*(height - crests%spike) <= crest) then
            ceiling = not_known()
         end if
      else
         start = edge_strength*film**(2.0_wp/3.0_wp)/sqrt(dx)
         if (flow_length(min(start, crests%highest), film) < dx) then
            height = final_height(law, start, film, dx, is_corner)
            if (height > crests%highest) ceiling = not_known()
         end if
      end if
      if (.not. (ieee_is_finite(ceiling) .and. is_corner)) return
      if (crests%corner_top <= max(ceiling, crests%highest)) return
      ceiling = crests%corner_top
      height = crests%corner + sure_share*(ceiling - crests%corner)
      if (height <= crests%highest) ceiling = not_known()

   contains

      !> l_flow.
      pure function flow_length(pressure, film) result(length)
         real(wp), intent(in) :: pressure, film
         real(wp) :: length, lengths(2)

         lengths = smoothing_lengths(law, pressure, film)
         length = lengths(1)
      end function flow_length

   end function ceiling_of_spike

   !> Largest increase by a spike of Int (mu/mu_0)/H dX, the shear of a Newtonian oil, on grids
   !> finer than `dx`; `endless` without a bound, 0 if the grid would resolve it. `film`: H at X =
   !> 0.
   !>
   !> P = P_node sqrt(dX/distance) from the distance dX, that of the top node, to that of the final
   !> height, and constant closer to the edge:
   !>
   !>     dX/H ( q^2 mu(P_node/q) + 2 Int_q^1 mu(P_node/r) r dr - mu(P_node) ) ,  q = P_node/P_end
   pure function shear_of_spike(law, crests, film, dx) result(growth)
      type(spike_law_t), intent(in) :: law
      type(crests_t), intent(in) :: crests
      real(wp), intent(in) :: film, dx
      real(wp) :: growth, top, gap, height, lengths(2), share
      real(wp), dimension(0:parts) :: place, mu, weights
      integer :: i

      growth = 0.0_wp
      top = edge_strength*film**(2.0_wp/3.0_wp)/sqrt(dx)
      gap = film
      if (ieee_is_finite(crests%spike)) then
         top = crests%spike
         gap = crests%spike_film
      else
         lengths = smoothing_lengths(law, min(top, crests%highest), film)
         if (lengths(1) >= dx) return
      end if
      height = final_height(law, top, gap, dx)
      growth = endless
      if (height >= endless) return
      share = top/(top + safety*(height - top))
      ! Simpson's rule
      place = [(share + (1 - share)*i/parts, i=0, parts)]
      weights = [1, (merge(4, 2, modulo(i, 2) == 1), i=1, parts - 1), 1]
      call fluid_viscosity(law%fluid, top/place, mu)
      if (mu(0) > largest_exponent) return
      mu = exp(mu)
      growth = dx/gap*(share**2*mu(0) - mu(parts) + 2*(1 - share)/(3*parts)*sum(weights*mu*place))
   end function shear_of_spike

   !> Final height of a spike whose top node on a grid of spacing `dx` has this `pressure` and
   !> `film`; `endless` if none is found. `is_corner`: its flanks may meet in a corner.
   pure function final_height(law, pressure, film, dx, is_corner) result(height)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: pressure, film, dx
      logical, intent(in), optional :: is_corner
      real(wp) :: height, next, lengths(2), growth
      integer :: i

      growth = flow_growth
      if (present(is_corner)) growth = merge(corner_growth, flow_growth, is_corner)
      height = pressure
      do i = 1, max_steps
         lengths = smoothing_lengths(law, height, film)/dx
         next = huge(1.0_wp)
         if (lengths(1) > tiny(1.0_wp)) next = growth/lengths(1)
         if (lengths(2) > tiny(1.0_wp)) next = min(next, density_growth/lengths(2)**density_power)
         next = pressure*sqrt(1.0_wp + next)
         if (next > highest_growth*pressure) exit
         if (next - height <= accuracy*height) then
            height = next
            return
         end if
         height = next
      end do
      height = endless
   end function final_height

   !> [l_flow, l_density] at a pressure and a film, [b].
   pure function smoothing_lengths(law, pressure, film) result(lengths)
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: pressure, film
      real(wp) :: lengths(2)
      real(wp), dimension(1) :: ln_mu, rho, drho

      call fluid_viscosity(law%fluid, [pressure], ln_mu)
      call fluid_density(law%fluid, [pressure], rho, drho)
      lengths(1) = exp(0.5_wp*(3*log(film) - ln_mu(1) - log(law%lambda)))
      if (thins(law%fluid)) lengths(1) = thinned_length(law%fluid, pressure, film, ln_mu(1), &
         lengths(1))
      lengths(2) = film*drho(1)/rho(1)
   end function smoothing_lengths

   !> l_flow of an oil that thins from that by its viscosity alone, `thick`: with S of the top or,
   !> if larger, of the slope P/l_flow of the flank, by bisection.
   pure function thinned_length(fluid, pressure, film, ln_mu, thick) result(length)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: pressure, film, ln_mu, thick
      real(wp) :: length, lower, upper, middle, fall
      real(wp) :: ln_s(2)
      integer :: i

      fall = film*pressure
      ln_s(1) = ln_slip(fluid, 0.0_wp, film, ln_mu)
      lower = log(thick) + 0.5_wp*ln_s(1)
      upper = max(lower + 1.0_wp, log(wall_stress(fluid, fall)))
      do i = 1, bisections
         middle = 0.5_wp*(lower + upper)
         ln_s(2) = ln_slip(fluid, fall*exp(-middle), film, ln_mu)
         if (middle < log(thick) + 0.5_wp*maxval(ln_s)) then
            lower = middle
         else
            upper = middle
         end if
      end do
      length = exp(lower)
   end function thinned_length

end module pressure_spike

!> Temperature of film and surfaces by the heat of sliding, and what it does to the viscosity.
!>
!> Both bodies are half spaces under a heat source that moves faster than heat spreads (H. S.
!> Carslaw and J. C. Jaeger, Conduction of heat in solids, 1959), surface j with the flux q_j:
!>
!>     T_j(x) = Int_{x' < x} q_j(x')/sqrt(pi u_j (x - x')) dx'/e
!>
!> The heat Q = q_1 + q_2 of the oil arises evenly across the film, so that q_1 = Q/2 + (k/h)(T_2 -
!> T_1), and the mean film is (T_1 + T_2)/2 + tau |u2 - u1| h/(12 k) warm. Not in it: heat that the
!> oil carries along, viscosity that varies across the film.
!>
!> If asked for, the flow that the pressure drives warms the film too, mostly in the inlet, by F =
!> h^3 (dp/dx)^2/(12 mu), which arises as z^2 from the middle: the oil is warm by F h/(16 k) (1 - (2
!> z/h)^4). It flows by Int z^2/mu dz, so that the mean weighted by z^2 counts, F h/(28 k).
!>
!> Estimates of these temperatures tell whether a model without heat suffices.
module film_heating
   use kinds, only: pi, wp
   use lubricant, only: fluid_t, viscosity_roelands
   implicit none (type, external)
   private

   public :: film_warmth, flash_temperatures, heating_t, inlet_heating_loss, largest_rise, &
      thermal_fall, thinning

   !> 1/sqrt(s) is the sum of spacing*2/sqrt(pi) exp(y - s exp(2 y)) over y at this spacing, from
   !> `fastest` down to where the rest is `rest` of it: to 1e-7.
   real(wp), parameter :: spacing = 0.3_wp, fastest = 1.9_wp, rest = 1.0e-8_wp

   !> Most cells over which the heat of a contact is averaged: enough for 1 % of its largest
   !> temperature.
   integer, parameter :: max_cells = 256

   !> Steps to the stress at its own temperature: to round-off.
   integer, parameter :: newton_steps = 6

   !> Friction with these temperatures over that of the full energy equation across the film, less
   !> 1, where both were compared: rollers at 0.85 GPa, 5 m/s and a slide-to-roll ratio of 0.4,
   !> without and with the heat of the flow.
   real(wp), parameter, public :: friction_doubt(2) = [0.11_wp, 0.13_wp]

   !> Data of a contact.
   type :: heating_t
      !> Whether there are SI scales.
      logical :: is_known = .false.
      !> Units of X [m], H [m] and of the shear stress [Pa].
      real(wp) :: half_width = 0.0_wp, film = 0.0_wp, shear_stress = 0.0_wp
      !> Of the surfaces [m/s].
      real(wp) :: speeds(2) = 0.0_wp
      !> sqrt(k rho c) of both bodies [W s^0.5/(m^2 K)], conductivity of the oil [W/(m K)].
      real(wp) :: effusivity = 0.0_wp, conductivity = 0.0_wp
      !> -d ln mu/dT of the oil that arrives [1/K], and its temperature above 138 K [K].
      real(wp) :: thermal_viscosity = 0.0_wp, excess = 0.0_wp
      !> Whether the flow that the pressure drives warms the film.
      logical :: has_flow = .false.
   end type heating_t

contains

   !> Temperature rises [K] of the mean film and of surfaces 1 and 2 (0:n, 3) on nodes at the
   !> distance `dx` [b], the flow to the right, by the `heat` [W/m^2] of sliding oil, of asperities
   !> and of the flow by pressure, (0:n, 3), in the `film` [b^2/R] (0:n); both speeds positive. The
   !> heat of the oil is given for the rise `at` of the film and falls with the rise as exp(-`fall`
   !> rise), both (0:n). Heat is even from the middle of an interval to the next. O(n): the sums
   !> over the heat upstream are those of exponentials.
   pure function film_warmth(heating, dx, heat, film, at, fall) result(rise)
      type(heating_t), intent(in) :: heating
      real(wp), intent(in) :: dx, heat(0:, :)
      real(wp), intent(in), contiguous, dimension(0:) :: film, at, fall
      real(wp) :: rise(0:size(film) - 1, 3)
      real(wp), allocatable :: decay(:), weight(:), memory(:, :)
      real(wp) :: scale(2), own(2), before(2), flux(2), all_heat, across, part, by_heat, cold, &
         warmer
      integer :: i, j

      associate (slowest => log(rest/sqrt(real(size(film), wp))))
         allocate (weight(ceiling((fastest - slowest)/spacing)))
      end associate
      decay = [(exp(2*(fastest - j*spacing)), j=1, size(weight))]
      weight = spacing*2/sqrt(pi)*sqrt(decay)*2*sinh(0.5_wp*decay)/decay
      decay = exp(-decay)
      allocate (memory(size(weight), 2), source=0.0_wp)
      scale = sqrt(dx*heating%half_width/(pi*heating%speeds))/heating%effusivity
      own = 2*sqrt(0.5_wp)*scale
      flux = 0.0_wp
      do i = 0, ubound(rise, 1)
         do j = 1, 2
            memory(:, j) = decay*(memory(:, j) + weight*flux(j))
            before(j) = scale(j)*sum(memory(:, j))
         end do
         across = heating%conductivity/(heating%film*film(i))
         part = (0.5_wp + across*own(2))/(1 + across*sum(own))   ! of the heat, to surface 1
         flux(1) = across*(before(2) - before(1))/(1 + across*sum(own))
         by_heat = 0.5_wp*(own(1)*part + own(2)*(1 - part))
         cold = 0.5_wp*(sum(before) + (own(1) - own(2))*flux(1)) + by_heat*heat(i, 2)
         warmer = heat(i, 1)*(by_heat + 1/(12*across)) + heat(i, 3)*(by_heat + 1/(28*across))
         associate (share => stress_share(warmer, fall(i), at(i) - cold))
            rise(i, 1) = cold + share*warmer
            all_heat = share*(heat(i, 1) + heat(i, 3)) + heat(i, 2)
         end associate
         flux = [flux(1) + part*all_heat, (1 - part)*all_heat - flux(1)]
         rise(i, 2:) = before + own*flux
      end do
   end function film_warmth

   !> Share s of a stress that warms the oil by `rise` s, where it falls as exp(-`fall`(`rise` s -
   !> `at`)): W(A)/(fall rise), A = fall rise exp(fall at), by Newton's method on y + ln y = ln A.
   pure real(wp) function stress_share(rise, fall, at) result(share)
      real(wp), intent(in) :: rise, fall, at
      real(wp) :: ln_a, y
      integer :: i

      share = 1.0_wp
      if (.not. fall*rise > tiny(1.0_wp)) return
      ln_a = log(fall*rise) + fall*at
      y = exp(max(min(ln_a, 0.0_wp), -600.0_wp))
      if (ln_a > 1.0_wp) y = ln_a
      do i = 1, merge(newton_steps, 0, ln_a > -36.0_wp)
         y = y*(1 + ln_a - log(y))/(1 + y)
      end do
      share = y/(fall*rise)
   end function stress_share

   !> ln(mu/mu_0) of an oil that is warmer by `rise` [K] is `factor` times that at the temperature
   !> of the inlet, plus `shift`; Roelands' law with the factor of temperature of L. Houpert, J.
   !> Tribol. 107, 1985, 241, and -beta `rise` for other laws.
   pure elemental subroutine thinning(heating, fluid, rise, factor, shift)
      type(heating_t), intent(in) :: heating
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: rise
      real(wp), intent(out) :: factor, shift
      real(wp) :: c

      factor = 1.0_wp
      shift = -heating%thermal_viscosity*rise
      if (fluid%viscosity_law /= viscosity_roelands) return
      c = fluid%alpha_bar*fluid%p0/fluid%z
      factor = (1 + rise/heating%excess)**(-heating%thermal_viscosity*heating%excess/c)
      shift = c*(factor - 1)
   end subroutine thinning

   !> -d ln mu/dT [1/K] by the same law at the rise [K] and ln(mu/mu_0).
   pure elemental real(wp) function thermal_fall(heating, fluid, rise, ln_mu) result(fall)
      type(heating_t), intent(in) :: heating
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: rise, ln_mu

      fall = heating%thermal_viscosity
      if (fluid%viscosity_law == viscosity_roelands) fall = fall/(1 + rise/heating%excess) &
         *(1 + ln_mu*fluid%z/(fluid%alpha_bar*fluid%p0))
   end function thermal_fall

   !> Temperature rise [K] of both surfaces from the `heat` [W/m^2] at rising nodes `x` [m], each
   !> (n), the flow to the right. The heat is averaged over as many even cells as there are nodes,
   !> at most `max_cells`; nodes get the temperature at the end of their cell.
   !>
   !> Both bodies pass a band source faster than heat spreads (J. C. Jaeger, J. Proc. R. Soc. New
   !> South Wales 76, 1942, 203; J. F. Archard, Wear 2, 1959, 438) and share the heat so that their
   !> surfaces are equally warm:
   !>
   !>     T(x) = Int_{x' < x} q(x')/sqrt(x - x') dx' / ( sqrt(pi) e (sqrt|u1| + sqrt|u2|) )
   !>
   !> `effusivity` e = sqrt(k rho c) [W s^0.5/(m^2 K)] of both, `speeds` [m/s] of the surfaces, not
   !> both zero. A body at rest takes no heat, so a contact of simple sliding comes out too warm.
   pure function flash_temperatures(heat, x, effusivity, speeds) result(rise)
      real(wp), intent(in), contiguous :: heat(:), x(:)
      real(wp), intent(in) :: effusivity, speeds(2)
      real(wp) :: rise(size(heat)), width, means(max_cells), warm(max_cells)
      real(wp), allocatable :: weights(:)
      integer :: cell(size(heat)), i, n, nodes

      nodes = (size(heat) - 1)/max_cells + 1
      n = size(heat)
      width = nodes*(x(n) - x(1))/(n - 1)
      cell = 1 + int((x - x(1))/width + 1.0e-6_wp)   ! a node on a border is behind it
      means = 0.0_wp
      do i = 1, n
         means(cell(i)) = means(cell(i)) + heat(i)*(x(min(i + 1, n)) - x(max(i - 1, 1))) &
            /((min(i + 1, n) - max(i - 1, 1))*width)
      end do
      weights = [(sqrt(real(i, wp)) - sqrt(real(i - 1, wp)), i=1, cell(n))]
      do i = 1, cell(n)
         warm(i) = dot_product(weights(:i), means(i:1:-1))
      end do
      rise = warm(cell)*2.0_wp*sqrt(width/pi)/(effusivity*sum(sqrt(abs(speeds))))
   end function flash_temperatures

   !> Share by which the heat of the flow in the inlet thins the film of an EHL contact [-].
   !>
   !> P. K. Gupta, H. S. Cheng, D. Zhu, N. H. Forster and J. B. Schrand, Tribol. Trans. 35, 1992,
   !> 269:
   !>
   !>     1 - (1 - 13.2 (p_h/E') L^0.42)/(1 + 0.213 (1 + 2.23 S^0.83) L^0.64) ,  L = beta mu_0 u^2/k
   !>
   !> `loading` L >= 0, u the mean speed, beta = -d ln mu/dT; `slide_to_roll` S = |u2 - u1|/u >= 0;
   !> `strain` p_h/E' >= 0. At most 1.
   pure elemental real(wp) function inlet_heating_loss(loading, slide_to_roll, strain) result(loss)
      real(wp), intent(in) :: loading, slide_to_roll, strain

      loss = 1.0_wp - max(1.0_wp - 13.2_wp*strain*loading**0.42_wp, 0.0_wp) &
         /(1.0_wp + 0.213_wp*(1.0_wp + 2.23_wp*slide_to_roll**0.83_wp)*loading**0.64_wp)
   end function inlet_heating_loss

   !> Largest temperature rise [K] at mid-film: of the surfaces, and of the film above them by the
   !> heat q that is released evenly across it, q h/(8 k). `stress`: mean shear stress [p_h b/R] in
   !> the `film` [b^2/R], at rising nodes `x` [b], each (nx), or of a point contact (nx ny), where
   !> heat spreads into the depth alone: each row is a band. Speeds of a negative sum take the heat
   !> to the left.
   pure real(wp) function largest_rise(heating, x, stress, film) result(rise)
      type(heating_t), intent(in) :: heating
      real(wp), intent(in), contiguous :: x(:), stress(:), film(:)
      real(wp) :: along(size(x)), heat(size(x))
      integer :: first, i, order(size(x))

      rise = 0.0_wp
      associate (speeds => heating%speeds)
         if (.not. abs(speeds(2) - speeds(1)) > 0.0_wp) return
         order = [(i, i=1, size(x))]
         if (sum(speeds) < 0.0_wp) order = order(size(x):1:-1)
         along = sign(heating%half_width, sum(speeds))*x(order)
         do first = 0, size(stress) - 1, size(x)
            heat = abs(stress(first + order))*(heating%shear_stress*abs(speeds(2) - speeds(1)))
            rise = max(rise, maxval(flash_temperatures(heat, along, heating%effusivity, speeds) &
               + heat*(film(first + order)*heating%film)/(8.0_wp*heating%conductivity)))
         end do
      end associate
   end function largest_rise

end module film_heating

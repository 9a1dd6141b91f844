!> Estimates of effects outside the model of an isothermal, infinitely long, thin film of laminar
!> flow: temperature, side flow, terms that Reynolds' equation neglects. In SI; nothing here enters
!> a solution.
module model_limits
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: film_reynolds_number, film_temperatures, flash_temperatures, inlet_heating_loss, &
      shortest_length, side_flow_loss

   !> Most cells over which the heat of a contact is averaged: enough for 1 % of its largest
   !> temperature.
   integer, parameter :: max_cells = 256
   !> Decay of the loss to the sides with length over width.
   real(wp), parameter :: end_decay = 0.68_wp

contains

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

   !> Temperature rise [K] of the middle of a film above its walls, if the `heat` [W/m^2] is
   !> released evenly across the `film` [m]: q h/(8 k), `conductivity` k [W/(m K)] of the oil.
   pure elemental real(wp) function film_temperatures(heat, film, conductivity) result(rise)
      real(wp), intent(in) :: heat, film, conductivity

      rise = heat*film/(8.0_wp*conductivity)
   end function film_temperatures

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

   !> Share of the smallest film that a contact of finite length loses to its sides [-].
   !>
   !> exp(-0.68 k) of elliptical contacts with the axes' ratio k (B. J. Hamrock and D. Dowson, J.
   !> Lubr. Technol. 99, 1977, 264), taken for `length`/`width`, both [m] > 0.
   pure elemental real(wp) function side_flow_loss(length, width) result(loss)
      real(wp), intent(in) :: length, width

      loss = exp(-end_decay*length/width)
   end function side_flow_loss

   !> Length [m] at which a contact loses the share `loss` > 0 to its sides.
   pure elemental real(wp) function shortest_length(loss, width) result(length)
      real(wp), intent(in) :: loss, width

      length = -log(loss)*width/end_decay
   end function shortest_length

   !> Reynolds number rho u h/mu_0 [-] of the flow through a contact, u = `speed` the mean of the
   !> surfaces [m/s], h = `film` [m] at its centre, all at ambient `density` [kg/m^3] and
   !> `viscosity` [Pa s]. By conservation of mass it is about the same all along the inlet.
   pure elemental function film_reynolds_number(density, speed, film, viscosity) result(number)
      real(wp), intent(in) :: density, speed, film, viscosity
      real(wp) :: number

      number = density*abs(speed)*film/viscosity
   end function film_reynolds_number

end module model_limits

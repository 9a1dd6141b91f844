!> Velocity of the oil across the film of a line contact.
module film_velocity
   use kinds, only: wp
   use lubricant, only: fluid_t, fluid_viscosity
   use rheology, only: flow_shapes, largest_exponent, ln_slip
   implicit none (type, external)
   private

   public :: velocity_profile

contains

   !> u/(u1 + u2) at zeta = z/h = 0, 1/layers ... 1 from surface 1 to surface 2, (layers + 1, nx),
   !> on the nodes `x` of a uniform grid, from pressure `p` >= 0 and film `h` > 0, each (nx).
   !>
   !> Closed form of module eyring. Its mean across the film is the flow of the Reynolds equation at
   !> the node, with the slope of P by the central difference, of the first interval at the first
   !> node, and 0 at the last. Where the film cavitates there is the straight line of shear alone.
   pure function velocity_profile(fluid, lambda, slide_to_roll, x, p, h, layers) result(u)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      integer, intent(in) :: layers
      real(wp) :: u(layers + 1, size(x))
      real(wp), dimension(layers + 1) :: y, sliding, driven
      real(wp) :: drive(size(x)), ln_mu(size(x)), flow
      integer :: i, n

      n = size(x)
      drive(1) = h(1)*(p(2) - p(1))/(x(2) - x(1))
      drive(2:n - 1) = h(2:n - 1)*(p(3:) - p(:n - 2))/(x(3:) - x(:n - 2))
      drive(n) = 0.0_wp
      where (p(2:) <= 0.0_wp) drive(2:) = 0.0_wp
      call fluid_viscosity(fluid, p, ln_mu)
      y = [(real(2*i - layers, wp)/layers, i=0, layers)]
      do i = 1, n
         call flow_shapes(fluid, drive(i), y, sliding, driven)
         flow = h(i)*drive(i)/(2*lambda)*exp(min(ln_slip(fluid, drive(i), h(i), ln_mu(i)) &
            - ln_mu(i), largest_exponent))
         u(:, i) = 0.5_wp + 0.25_wp*slide_to_roll*sliding - flow*driven
      end do
   end function velocity_profile

end module film_velocity

!> The inlet in front of the domain: the pressure and the load that it leaves to the grid.
!>
!> In front of the first node X_a the bodies keep their shape there, but for the far field of the load (its centre at X_c), and the
!> pressure is low. With the flow rho H - e/lambda dP/dX = m, which is the same everywhere,
!>
!>     H(X) = H(X_a) + (X^2 - X_a^2)/2 - 1/2 ln( (X_c - X)/(X_c - X_a) )
!>     Q(X_a) = lambda Int_{-inf}^{X_a} (H - m)/(H^3 S) dX ,   P = -ln(1 - alpha_bar Q)/alpha_bar
!>
!> Q is the reduced pressure (Barus' law, which all laws are at low pressure), S = sqrt(1 + B^2) the slip factor without
!> slope. Roughness in front of the domain and the compression there are left out, and what the tail deforms.
module inlet_tail
   use constants, only: pi
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use lubricant, only: viscosity_constant
   implicit none (type, external)
   private

   public :: close_inlet, tail_load, tail_of

   !> Points of the midpoint rule in X_a/X: the integral is exact to 1e-4 (a test compares).
   integer, parameter :: points = 64
   !> Bound of alpha_bar Q: no tail of a solution comes near it, a wild iterate may.
   real(wp), parameter :: largest_reduced = 0.9_wp

contains

   !> Where the level has a tail, takes its pressure and load over: P(0), the film that follows, the load left for the grid.
   !> Coefficients are those of the last evaluation.
   pure subroutine close_inlet(contact, level)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(inout) :: level
      real(wp) :: pressure, load

      if (.not. level%has_tail) return
      call tail_of(contact, level, pressure, load)
      level%film = level%film - (pressure - level%pressure(0))*level%kernel
      level%pressure(0) = pressure
      level%rhs_load = 0.5_wp*pi - load
   end subroutine close_inlet

   !> The load in front of the grid, for the force balance.
   pure function tail_load(contact, level) result(load)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      real(wp) :: load
      real(wp) :: pressure

      call tail_of(contact, level, pressure, load)
   end function tail_load

   !> Pressure P(X_a) and load of the tail of the present state, that in front of the cell of node 0, which is the grid's.
   pure subroutine tail_of(contact, level, pressure, load)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      real(wp), intent(out) :: pressure, load
      real(wp) :: flow, first_film, centre, share, slip, x, h, gain, reduced
      integer :: i

      flow = flow_at_peak(contact, level)
      pressure = 0.0_wp
      load = 0.0_wp
      associate (x_a => level%x(0), p => level%pressure)
         share = sum(p)
         centre = sum(p*level%x)/share
         share = level%dx*share/pi
         ! of the smooth surfaces
         first_film = level%film(0) - level%rhs_film(0) + 0.5_wp*x_a**2
         slip = 0.0_wp
         if (contact%fluid%is_eyring) slip = exp(contact%fluid%ln_b_scale)
         do i = 1, points
            x = x_a*points/(i - 0.5_wp)
            h = first_film + 0.5_wp*(x**2 - x_a**2) - share*log((centre - x)/(centre - x_a))
            gain = -x**2/(points*x_a)*contact%lambda*max(h - flow, 0.0_wp)/(h**2*sqrt(h**2 + slip**2))
            pressure = pressure + gain
            load = load + gain*(x_a - x)
         end do
         reduced = min(contact%fluid%alpha_bar*pressure, largest_reduced)
         if (contact%fluid%viscosity_law /= viscosity_constant .and. reduced > 0.0_wp) then
            load = -log(1 - reduced)/reduced*load
            pressure = -log(1 - reduced)/reduced*pressure
         end if
         load = load - 0.5_wp*level%dx*pressure
      end associate
   end subroutine tail_of

   !> The flow rho H - e/lambda dP/dX at the face behind the largest pressure, as the space scheme has it: there it is known best
   !> while the solution is on its way.
   pure function flow_at_peak(contact, level) result(flow)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      real(wp) :: flow, mass(3)
      integer :: i

      i = min(max(maxloc(level%pressure, 1) - 1, 1), level%n - 1)
      associate (p => level%pressure)
         mass = level%density(i - 1:i + 1)*level%film(i - 1:i + 1)
         if (level%is_sharp) then
            flow = (2*mass(3) + 5*mass(2) - mass(1))/6
         else
            flow = 0.5_wp*(3*mass(2) - mass(1))
         end if
         flow = flow - level%face_mobility(i + 1)*(p(i + 1) - p(i))/(contact%lambda*level%dx)
      end associate
   end function flow_at_peak

end module inlet_tail

!> The inlet in front of the domain: the pressure and the load that it leaves to the grid.
!>
!> In front of the first node X_a the bodies keep their shape there, except for the far field of the
!> load (centre at X_c), and the pressure is low. With the constant mass flux rho H - e/lambda dP/dX
!> = m,
!>
!>     H(X) = H(X_a) + (X^2 - X_a^2)/2 - 1/2 ln( (X_c - X)/(X_c - X_a) )
!>     Q(X_a) = lambda Int_{-inf}^{X_a} (H - m)/(H^3 S) dX ,   P = -ln(1 - alpha_bar Q)/alpha_bar
!>
!> Q is the reduced pressure (Barus' law, to which all laws reduce at low pressure, mu = 1/(1 -
!> alpha_bar Q)), and S(Sigma, B) the slip factor at the slope that carries the mass flux there,
!> found from it point by point (`divide_by_slip`). Roughness and compression in front of the domain
!> and the deformation by the tail are neglected.
module inlet_tail
   use constants, only: pi
   use kinds, only: wp
   use line_level, only: contact_load, line_level_t
   use lubricant, only: fluid_t, viscosity_constant
   use rheology, only: thins
   implicit none (type, external)
   private

   public :: close_inlet, tail_of

   !> Points of the midpoint rule in X_a/X: the integral is exact to 1e-4 (a test compares).
   integer, parameter :: points = 64
   !> Bound of alpha_bar Q: no tail of a solution comes near it, a wild iterate may.
   real(wp), parameter :: largest_reduced = 0.9_wp
   !> Root search for S: largest ln S, most steps, and the error of ln S before the last step.
   real(wp), parameter :: largest_ln_slip = 100.0_wp, slip_tolerance = 1.0e-4_wp
   integer, parameter :: max_steps = 60

contains

   !> On a level with a tail, sets its pressure P(0), the film that follows and the load left for
   !> the grid, from the coefficients of the last evaluation.
   pure subroutine close_inlet(level)
      type(line_level_t), intent(inout) :: level
      real(wp) :: pressure, load

      if (.not. level%has_tail) return
      call tail_of(level, pressure, load)
      level%state%film = level%state%film - (pressure - level%state%pressure(0)) &
         *level%elastic%kernel
      level%state%pressure(0) = pressure
      level%rhs_load = contact_load - load
   end subroutine close_inlet

   !> Pressure P(X_a) and load of the tail of the present state, in front of the cell of node 0,
   !> which belongs to the grid.
   pure subroutine tail_of(level, pressure, load)
      type(line_level_t), intent(in) :: level
      real(wp), intent(out) :: pressure, load
      real(wp) :: flow, first_film, centre, share, x, h, gain, reduced, drive
      integer :: i

      flow = flow_at_peak(level)
      pressure = 0.0_wp
      load = 0.0_wp
      associate (x_a => level%x(0), p => level%state%pressure)
         share = sum(p)
         centre = sum(p*level%x)/share
         share = level%dx*share/pi
         ! of the smooth surfaces
         first_film = level%state%film(0) - level%rhs_film(0) + 0.5_wp*x_a**2
         drive = 0.0_wp
         gain = 0.0_wp
         do i = 1, points
            x = x_a*points/(i - 0.5_wp)
            h = first_film + 0.5_wp*(x**2 - x_a**2) &
               - level%elastic%elasticity*share*log((centre - x)/(centre - x_a))
            reduced = pressure + 0.5_wp*gain
            gain = level%lambda*max(h - flow, 0.0_wp)/h**3
            if (thins(level%fluid)) call divide_by_slip(level%fluid, h, reduced, gain, drive)
            gain = -x**2/(points*x_a)*gain
            pressure = pressure + gain
            load = load + gain*(x_a - x)
         end do
         reduced = min(level%fluid%alpha_bar*pressure, largest_reduced)
         if (level%fluid%viscosity_law /= viscosity_constant .and. reduced > 0.0_wp) then
            load = -log(1 - reduced)/reduced*load
            pressure = -log(1 - reduced)/reduced*pressure
         end if
         load = load - 0.5_wp*level%dx*pressure
      end associate
   end subroutine tail_of

   !> Divides the slope `gain` = S dQ/dX > 0 of the reduced pressure, where the film is `h` and that
   !> pressure `reduced`, by S:
   !>
   !>     D S(D, h, mu) = mu h gain ,     mu = 1/(1 - alpha_bar Q)
   !>
   !> by Newton's method in the logarithm of the drive D = h dP/dX, within shrinking bounds: the
   !> left side rises from 0, S >= 1. `drive`: root of the previous point (0: none), on return that
   !> of this one.
   pure subroutine divide_by_slip(fluid, h, reduced, gain, drive)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: h, reduced
      real(wp), intent(inout) :: gain, drive
      real(wp) :: ln_mu, ln_gain, y, bounds(2), excess, ln_s, by_drive
      integer :: i

      if (gain <= 0.0_wp) return
      ln_mu = 0.0_wp
      if (fluid%viscosity_law /= viscosity_constant) ln_mu = -log(1 &
         - min(fluid%alpha_bar*reduced, largest_reduced))
      ln_gain = ln_mu + log(h*gain)
      bounds = [ln_gain - largest_ln_slip, ln_gain]
      y = ln_gain
      if (drive > 0.0_wp) y = log(drive)
      do i = 1, max_steps
         if (y <= bounds(1) .or. y >= bounds(2)) y = 0.5_wp*(bounds(1) + bounds(2))
         drive = exp(y)
         call fluid%rheology%ln_slip(drive, h, ln_mu, ln_s, by_drive)
         excess = y + ln_s - ln_gain
         bounds(merge(2, 1, excess > 0.0_wp)) = y
         y = y - excess/(1 + drive*by_drive)
         if (abs(excess) < slip_tolerance) exit
      end do
      gain = gain*exp(y - ln_gain)
      drive = exp(y)
   end subroutine divide_by_slip

   !> Mass flux rho H - e/lambda dP/dX at the face behind the largest pressure, by the space scheme:
   !> before convergence it is known best there.
   pure function flow_at_peak(level) result(flow)
      type(line_level_t), intent(in) :: level
      real(wp) :: flow, mass(3)
      integer :: i

      i = min(max(maxloc(level%state%pressure, 1) - 1, 1), level%n - 1)
      associate (p => level%state%pressure)
         mass = level%oil%density(i - 1:i + 1)*level%state%film(i - 1:i + 1)
         if (level%is_kappa) then
            flow = (2*mass(3) + 5*mass(2) - mass(1))/6
         else
            flow = 0.5_wp*(3*mass(2) - mass(1))
         end if
         flow = flow - level%oil%face_mobility(i + 1)*(p(i + 1) - p(i))/(level%lambda*level%dx)
      end associate
   end function flow_at_peak

end module inlet_tail

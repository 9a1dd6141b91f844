!> Friction and rolling power of the oil in front of the first node.
module inlet_friction
   use flow_law, only: largest_exponent, slip_t
   use line_state, only: friction_t
   use kinds, only: wp
   use lubricant, only: evaluate_stress, fluid_t, thins
   implicit none (type, external)
   private

   public :: oil_in_front

   !> Points of the midpoint rule in X_a/X for the oil in front of the domain, where the integrands
   !> change little (a test compares with a longer domain).
   integer, parameter :: points = 8
   !> X_a/X of these points, and functions of it.
   real(wp), parameter :: share(points) = [1, 3, 5, 7, 9, 11, 13, 15]/16.0_wp, &
      inverse_square(points) = 1/share**2, ln_share(points) = log(share)
   !> Bound of alpha_bar Q in front of the domain: no solution comes near it.
   real(wp), parameter :: largest_reduced = 0.9_wp

contains

   !> Contribution of the oil in front of the first node, `place` = [X, H, R_ref/R]; `flow` is the
   !> mass flux, `couette` = lambda/6 (u2 - u1)/(u1 + u2), `elasticity` that of the bodies times the
   !> load over that of reference. Flow, lambda and rolling power by the present u1 + u2.
   !>
   !> The gap is that of the bodies with the far field of the load, the
   !> pressure low: H S dP/dX = lambda mu (H - flow)/H^2, mu = 1/(1 - alpha_bar Q) with the reduced
   !> pressure Q. It falls only as 1/X_a: forces need a longer inlet than films (N. Biboulet and L.
   !> Houpert, Proc. IMechE J 224, 2010, 765).
   pure function oil_in_front(fluid, lambda, couette, elasticity, place, flow) result(friction)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, couette, elasticity, place(3), flow
      type(friction_t) :: friction
      real(wp), dimension(points) :: weights, h, flow_drive, drive, stress, fluidity, ln_mu
      type(slip_t) :: slip
      real(wp) :: reduced
      integer :: i, pass

      weights = abs(place(1))/points*inverse_square
      h = place(2) + 0.5_wp*place(3)*place(1)**2*(inverse_square - 1) &
         + 0.5_wp*elasticity*ln_share
      flow_drive = lambda*max(h - flow, 0.0_wp)/h**2
      reduced = 0.0_wp
      do i = 1, points
         reduced = reduced + fluid%alpha_bar*weights(i)*flow_drive(i)/h(i)
         fluidity(i) = 1 - min(reduced, largest_reduced)
      end do
      ln_mu = -log(fluidity)
      flow_drive = flow_drive/fluidity
      drive = flow_drive
      if (thins(fluid)) then
         do pass = 1, 2   ! S of a drive that S has not made less is too large
            call fluid%rheology%evaluate_slip(drive, 1/h, ln_mu, .false., slip)
            drive = flow_drive/(slip%factor(:points)*exp(min(slip%growth(:points), &
               largest_exponent)))
         end do
      end if
      call evaluate_stress(fluid, couette, drive, 1/h, ln_mu, stress)
      friction%sliding = sum(weights*stress)
      friction%rolling = 0.5_wp*sum(weights*drive)
      friction%rolling_power = 0.5_wp/lambda*sum(weights*h*drive*flow_drive*fluidity)
   end function oil_in_front

end module inlet_friction

!> Exact Jacobian of the discrete Reynolds-Eyring operator L_R(P, H) of `reynolds_line`: bands in P
!> and in H.
!>
!> With the film equation H = ... + H0 - K P it gives the elastic Jacobian J = JP - JH K of the
!> Newton methods.
module reynolds_jacobian
   use face_mobility, only: fluid_face_mobility
   use kinds, only: wp
   use line_level, only: has_close_exit, line_level_t
   use mobility, only: fluid_mobility
   use newton_work, only: reynolds_jacobian_t
   use reynolds_line, only: apply_reynolds, third_order_share, third_order_slope, wedge_weights
   use rheology, only: thins
   implicit none (type, external)
   private

   public :: evaluate_jacobian

contains

   !> Computes the bands at the present pressure and film of the level; rows 0 and n stay zero. The
   !> laws are evaluated once: the level receives its coefficients and the operator L_R from the
   !> same values (as from `evaluate_reynolds`).
   pure subroutine evaluate_jacobian(level, jacobian)
      type(line_level_t), intent(inout) :: level
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      real(wp) :: left_p(-2:1), left_h(-2:0), right_p(-2:1), right_h(-2:0), weights(-2:0)
      integer :: i, n, o

      n = level%n
      call evaluate_slopes(level, jacobian)
      call apply_reynolds(level)
      call differentiate_flux(level, jacobian, 1, right_p, right_h)
      associate (jp => jacobian%by_pressure, jh => jacobian%by_film, kernel => level%elastic%kernel)
         do i = 1, n - 1
            left_p = right_p
            left_h = right_h
            call differentiate_flux(level, jacobian, i + 1, right_p, right_h)
            jp(:, i) = [-left_p(-2), right_p(-2) - left_p(-1), right_p(-1) - left_p(0), &
               right_p(0) - left_p(1), right_p(1)]
            jh(:, i) = [-left_h(-2), right_h(-2) - left_h(-1), right_h(-1) - left_h(0), right_h(0)]
            ! rH(i-2) ... rH(i) in the wedge and the squeeze term, the same from the second row on
            if (i <= 2) weights = wedge_weights(i)*level%lambda*level%entrainment/level%dx &
               + [0.0_wp, 0.0_wp, level%lambda*level%inverse_time_step]
            do o = max(-2, -i), 0
               jp(o, i) = jp(o, i) - weights(o)*jacobian%slopes%rho_p(i + o)*level%state%film(i + o)
               jh(o, i) = jh(o, i) - weights(o)*level%oil%density(i + o)
            end do
            jacobian%diagonal(i) = jp(0, i) - jh(-2, i)*kernel(2) - jh(-1, i)*kernel(1) - jh(0, &
               i)*kernel(0) - jh(1, i)*kernel(1)
         end do
         if (has_close_exit(level)) then
            i = level%posed%exit_node
            jp(0, i) = jp(0, i) - level%posed%exit_conductance
            jacobian%diagonal(i) = jacobian%diagonal(i) - level%posed%exit_conductance
         end if
      end associate
   end subroutine evaluate_jacobian

   !> Computes mobility and density with their derivatives, and the coefficients of the level.
   pure subroutine evaluate_slopes(level, jacobian)
      type(line_level_t), intent(inout) :: level
      type(reynolds_jacobian_t), intent(inout) :: jacobian

      associate (slopes => jacobian%slopes, n => level%n)
         if (level%is_kappa) then
            if (.not. allocated(slopes%by_p_left)) allocate (slopes%by_p_left(n), &
               slopes%by_p_right(n), slopes%by_h_left(n), slopes%by_h_right(n))
            call fluid_face_mobility(level%fluid, [level%dx], level%state, level%oil, slopes)
         end if
         ! in the kappa scheme Newton's method bends steps by the mobility of the nodes
         if (level%is_kappa .and. thins(level%fluid)) return
         call fluid_mobility(level%fluid, level%dx, level%state, level%oil, slopes)
         if (.not. level%is_kappa) level%oil%face_mobility = 0.5_wp*(level%oil%mobility(:n - 1) &
            + level%oil%mobility(1:))
      end associate
   end subroutine evaluate_slopes

   !> Derivatives of the flux e(i-1/2) (P(i) - P(i-1))/dX^2 through the face left of node i, with
   !> the kappa scheme's addition to the mass flux rH there, by P(i-2..i+1) and H(i-2..i).
   pure subroutine differentiate_flux(level, jacobian, i, flux_p, flux_h)
      type(line_level_t), intent(in) :: level
      type(reynolds_jacobian_t), intent(in) :: jacobian
      integer, intent(in) :: i
      real(wp), intent(out) :: flux_p(-2:1), flux_h(-2:0)
      real(wp) :: slope, conductance, left, right

      slope = (level%state%pressure(i) - level%state%pressure(i - 1))/level%dx**2
      conductance = level%oil%face_mobility(i)/level%dx**2
      if (level%is_kappa) then
         associate (s => jacobian%slopes)
            flux_p = [0.0_wp, s%by_p_left(i)*slope - conductance, &
               s%by_p_right(i)*slope + conductance, 0.0_wp]
            flux_h = [0.0_wp, s%by_h_left(i)*slope, s%by_h_right(i)*slope]
         end associate
         if (i > 1) call add_third_order_slopes(level, jacobian%slopes%rho_p(i - 2:i), &
            i, flux_p(:0), flux_h)
      else
         associate (s => jacobian%slopes)
            left = 0.25_wp*s%e_slope(i - 1)*slope/level%dx
            right = 0.25_wp*s%e_slope(i)*slope/level%dx
            flux_p = [-left, 0.5_wp*s%e_p(i - 1)*slope - conductance - right, &
               0.5_wp*s%e_p(i)*slope + conductance + left, right]
            flux_h = [0.0_wp, 0.5_wp*s%e_h(i - 1)*slope, 0.5_wp*s%e_h(i)*slope]
         end associate
      end if
   end subroutine differentiate_flux

   !> Adds the part of -lambda/dX theta/3 ( rH(i) - 2 rH(i-1) + rH(i-2) ) to these derivatives.
   pure subroutine add_third_order_slopes(level, rho_p, i, flux_p, flux_h)
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: i
      real(wp), intent(in) :: rho_p(-2:0)
      real(wp), intent(inout) :: flux_p(-2:0), flux_h(-2:0)
      real(wp), parameter :: second(-2:0) = [1.0_wp, -2.0_wp, 1.0_wp]
      real(wp) :: factor, curvature, share

      associate (p => level%state%pressure(i - 2:i), h => level%state%film(i - 2:i), &
         rho => level%oil%density(i - 2:i), alpha => level%fluid%alpha_bar)
         factor = level%lambda*level%entrainment/(3*level%dx)
         curvature = alpha*dot_product(second, p)
         share = third_order_share(curvature)
         flux_p = flux_p - factor*second*(share*rho_p*h + alpha*third_order_slope(curvature) &
            *dot_product(second, rho*h))
         flux_h = flux_h - factor*second*share*rho
      end associate
   end subroutine add_third_order_slopes

end module reynolds_jacobian

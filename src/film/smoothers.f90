!> Smoothers of the line contact: Block-Jacobi as in the thesis, and two that need fewer sweeps.
!>
!> Each does ONE sweep from the operator, coefficients and deflection evaluated just before it, and
!> keeps P >= 0. A smoother knows one level only; the film equation, the force balance and the cycle
!> are elsewhere.
module smoothers
   use kinds, only: wp
   use line_level, only: has_close_exit, largest_pressure, line_level_t, thinnest_film
   implicit none (type, external)
   private

   public :: block_jacobi_sweep, gauss_seidel_sweep, line_sweep

   !> The exit moves by the smoother, and holds the largest residual of a time step: Gauss-Seidel
   !> passes over the nodes round it after each sweep, upstream and downstream of the last node with
   !> P > 0.
   integer, parameter :: exit_passes = 4, exit_upstream = 16, exit_downstream = 4

   !> A line sweep changes a pressure by at most this share of max(1, P).
   real(wp), parameter :: largest_step = 0.3_wp

contains

   !> Block-Jacobi (2.70)-(2.73): at every node the 2x2 system for the changes of P and H, from old
   !> values. `kernel_diagonal` is c = K_0/pi; both changes are under-relaxed. A node that reaches
   !> P = 0 takes its change of H from the change of P that was really made.
   pure subroutine block_jacobi_sweep(level, kernel_diagonal, relaxation)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: kernel_diagonal, relaxation
      real(wp) :: film_residual, change, full_change
      integer :: i, n

      n = level%n
      associate (p => level%state%pressure, h => level%state%film, &
         h0 => level%state%rigid_displacement)
         do i = 0, n, n
            film_residual = level%rhs_film(i) - (h(i) - h0 + level%deflection(i))
            h(i) = max(h(i) + relaxation*film_residual, 0.5_wp*h(i), thinnest_film)
         end do
         do i = 1, n - 1
            film_residual = level%rhs_film(i) - (h(i) - h0 + level%deflection(i))
            full_change = relaxation*(level%rhs_reynolds(i) - level%operator(i) &
               - level%film_diagonal(i)*film_residual)/level%diagonal(i)
            change = min(max(full_change, -p(i)), largest_pressure)
            p(i) = min(p(i) + change, largest_pressure)
            h(i) = max(h(i) + relaxation*film_residual - kernel_diagonal*change, 0.5_wp*h(i), &
               thinnest_film)
         end do
      end associate
   end subroutine block_jacobi_sweep

   !> Gauss-Seidel downstream: the same 2x2 system with the new P and H upstream; the integral is
   !> frozen, only the own share K_0/pi of a change enters H at once. The nodes round the exit are
   !> passed a few times more.
   pure subroutine gauss_seidel_sweep(level, kernel_diagonal, relaxation)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: kernel_diagonal, relaxation
      integer :: exit_node, pass

      call downstream_pass(level, kernel_diagonal, relaxation, [1, level%n - 1])
      exit_node = findloc(level%state%pressure > 0.0_wp, .true., 1, back=.true.) - 1
      do pass = 1, exit_passes
         call downstream_pass(level, kernel_diagonal, relaxation, &
            [max(1, exit_node - exit_upstream), min(level%n - 1, exit_node + exit_downstream)])
      end do
   end subroutine gauss_seidel_sweep

   !> One pass over the nodes range(1) to range(2).
   pure subroutine downstream_pass(level, kernel_diagonal, relaxation, range)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: kernel_diagonal, relaxation
      integer, intent(in) :: range(2)
      real(wp) :: diffusion, wedge, squeeze, upstream, downstream, flow, change
      integer :: i, exit_node

      exit_node = merge(level%exit_node, 0, has_close_exit(level))
      diffusion = 0.5_wp/level%dx**2
      wedge = 0.5_wp*level%lambda/level%dx
      squeeze = level%lambda*level%inverse_time_step
      associate (p => level%state%pressure, h => level%state%film, e => level%mobility, &
         rho => level%density)
         do i = range(1), range(2)
            upstream = diffusion*(e(i - 1) + e(i))
            downstream = diffusion*(e(i) + e(i + 1))
            if (i > 1) then
               flow = wedge*(3*rho(i)*h(i) - 4*rho(i - 1)*h(i - 1) + rho(i - 2)*h(i - 2))
            else
               flow = 2*wedge*(rho(1)*h(1) - rho(0)*h(0))
            end if
            flow = downstream*(p(i + 1) - p(i)) - upstream*(p(i) - p(i - 1)) - flow &
               - squeeze*rho(i)*h(i)
            if (i == exit_node) flow = flow - level%exit_conductance*(p(i) &
               - level%start_pressure(i))
            change = min(max(relaxation*(level%rhs_reynolds(i) - flow)/level%diagonal(i), -p(i)), &
               largest_pressure)
            p(i) = min(p(i) + change, largest_pressure)
            h(i) = max(h(i) - kernel_diagonal*change, 0.5_wp*h(i), thinnest_film)
         end do
      end associate
   end subroutine downstream_pass

   !> Projected tridiagonal line: the frozen diffusion with the elastic diagonal, solved over all
   !> nodes; eliminated left to right and projected on P >= 0 in the back substitution from the
   !> outlet (Brennan & Schwartz 1977), so that the cavitation point is solved with the line. Nodes
   !> that reach zero are set to zero, the others are under-relaxed.
   pure subroutine line_sweep(level, relaxation)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: relaxation
      real(wp) :: diffusion, upstream, pivot, bound
      integer :: i, n

      n = level%n
      diffusion = 0.5_wp/level%dx**2
      associate (p => level%state%pressure, e => level%mobility, upper => level%work, &
         x => level%correction)
         upper(0) = 0.0_wp
         x(0) = 0.0_wp
         x(n) = 0.0_wp
         do i = 1, n - 1
            upstream = diffusion*(e(i - 1) + e(i))
            pivot = 1.0_wp/(level%diagonal(i) - upstream*upper(i - 1))
            upper(i) = diffusion*(e(i) + e(i + 1))*pivot
            x(i) = (level%rhs_reynolds(i) - level%operator(i) - upstream*x(i - 1))*pivot
         end do
         do i = n - 1, 1, -1
            x(i) = max(x(i) - upper(i)*x(i + 1), -p(i))
         end do
         do i = 1, n - 1
            bound = largest_step*max(1.0_wp, p(i))
            if (x(i) <= -p(i)) then
               p(i) = 0.0_wp
            else
               p(i) = max(p(i) + min(max(relaxation*x(i), -bound), bound), 0.0_wp)
            end if
         end do
      end associate
   end subroutine line_sweep

end module smoothers

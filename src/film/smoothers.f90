!> Smoothers of the line contact: Block-Jacobi as in the thesis, and two that need fewer sweeps.
!>
!> Each makes ONE sweep on one level from the operator, coefficients and deflection evaluated just
!> before it, and keeps P >= 0.
module smoothers
   use film_equation, only: evaluate_deflection, load_defect, update_film
   use kinds, only: wp
   use line_hierarchy, only: count_work, line_hierarchy_t, smoother_block_jacobi, &
      smoother_gauss_seidel, smoother_hybrid, smoother_line
   use line_level, only: has_close_exit, largest_pressure, line_level_t, thinnest_film
   use reynolds_line, only: evaluate_reynolds, reynolds_diagonals
   implicit none (type, external)
   private

   public :: block_jacobi_sweep, gauss_seidel_sweep, line_sweep, smooth, sweep_under_load

   !> The smoother moves the exit, which has the largest residual of a time step: Gauss-Seidel
   !> passes over the nodes around it after each sweep, upstream and downstream of the last node
   !> with P > 0.
   integer, parameter :: exit_passes = 4, exit_upstream = 16, exit_downstream = 4

   !> A line sweep changes a pressure by at most this share of max(1, P).
   real(wp), parameter :: largest_step = 0.3_wp

contains

   !> Makes `coarse_sweeps` sweeps on level k and relaxes the force balance after each (thesis,
   !> section 2.7).
   subroutine sweep_under_load(hierarchy, k)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k
      integer :: i

      do i = 1, hierarchy%relaxation%coarse_sweeps
         call smooth(hierarchy, k, 1, is_last_leg=.true.)
         ! surfaces that carry too little come closer
         associate (h0 => hierarchy%levels(k)%state%rigid_displacement)
            h0 = h0 - hierarchy%relaxation%load_relaxation*load_defect(hierarchy%levels(k))
         end associate
      end do
   end subroutine sweep_under_load

   !> Makes `sweeps` of the chosen smoother on level k. The hybrid sweeps by line before the
   !> correction and by Gauss-Seidel after it.
   subroutine smooth(hierarchy, k, sweeps, is_last_leg)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k, sweeps
      logical, intent(in) :: is_last_leg
      integer :: i, smoother

      smoother = hierarchy%relaxation%smoother
      if (smoother == smoother_hybrid) smoother = merge(smoother_gauss_seidel, smoother_line, &
         is_last_leg)
      do i = 1, sweeps
         call sweep(hierarchy, k, smoother)
      end do
      if (smoother == smoother_line) call update_film(hierarchy%levels(k))
      call count_work(hierarchy, k, sweeps)
   end subroutine smooth

   !> Makes one sweep of one smoother, with coefficients at the present state.
   subroutine sweep(hierarchy, k, smoother)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k, smoother
      real(wp) :: kernel_diagonal

      associate (level => hierarchy%levels(k), choice => hierarchy%relaxation)
         if (maxval(level%state%pressure) >= largest_pressure) return
         kernel_diagonal = min(level%elastic%kernel(0), -choice%kernel_bound*level%dx)
         if (choice%film_is_recomputed) then
            call update_film(level)
         else
            call evaluate_deflection(level)
         end if
         call evaluate_reynolds(level)
         call reynolds_diagonals(level, kernel_diagonal)
         select case (smoother)
         case (smoother_block_jacobi)
            call block_jacobi_sweep(level, kernel_diagonal, choice%relaxation)
         case (smoother_gauss_seidel)
            call gauss_seidel_sweep(level, kernel_diagonal, choice%relaxation)
         case (smoother_line)
            call line_sweep(level, choice%relaxation)
         case default
            error stop 'sweep: a smoother without its case'
         end select
      end associate
   end subroutine sweep

   !> Block-Jacobi (2.70)-(2.73): at every node the 2x2 system for the changes of P and H, from old
   !> values. `kernel_diagonal` is c = K_0/pi; both changes are under-relaxed. A node that reaches P
   !> = 0 takes its change of H from the actual change of P.
   pure subroutine block_jacobi_sweep(level, kernel_diagonal, relaxation)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: kernel_diagonal, relaxation
      real(wp) :: film_residual, change, full_change
      integer :: i, n

      n = level%n
      associate (p => level%state%pressure, h => level%state%film, &
         h0 => level%state%rigid_displacement)
         do i = 0, n, n
            film_residual = level%rhs_film(i) - (h(i) - h0 + level%elastic%deflection(i))
            h(i) = max(h(i) + relaxation*film_residual, 0.5_wp*h(i), thinnest_film)
         end do
         do i = 1, n - 1
            film_residual = level%rhs_film(i) - (h(i) - h0 + level%elastic%deflection(i))
            full_change = relaxation*(level%rhs_reynolds(i) - level%operator(i) &
               - level%work%film_diagonal(i)*film_residual)/level%work%diagonal(i)
            change = min(max(full_change, -p(i)), largest_pressure)
            p(i) = min(p(i) + change, largest_pressure)
            h(i) = max(h(i) + relaxation*film_residual - kernel_diagonal*change, 0.5_wp*h(i), &
               thinnest_film)
         end do
      end associate
   end subroutine block_jacobi_sweep

   !> Gauss-Seidel downstream: the same 2x2 system with the new P and H upstream; the integral is
   !> frozen, only the diagonal K_0/pi of a change enters H at once. The nodes around the exit are
   !> passed a few more times.
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

      exit_node = merge(level%posed%exit_node, 0, has_close_exit(level))
      diffusion = 0.5_wp/level%dx**2
      wedge = 0.5_wp*level%lambda/level%dx
      squeeze = level%lambda*level%inverse_time_step
      associate (p => level%state%pressure, h => level%state%film, e => level%oil%mobility, &
         rho => level%oil%density)
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
            if (i == exit_node) flow = flow - level%posed%exit_conductance*(p(i) &
               - level%posed%start_pressure(i))
            change = min(max(relaxation*(level%rhs_reynolds(i) - flow)/level%work%diagonal(i), &
               -p(i)), largest_pressure)
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
      associate (p => level%state%pressure, e => level%oil%mobility, upper => level%work%nodes, &
         x => level%work%correction)
         upper(0) = 0.0_wp
         x(0) = 0.0_wp
         x(n) = 0.0_wp
         do i = 1, n - 1
            upstream = diffusion*(e(i - 1) + e(i))
            pivot = 1.0_wp/(level%work%diagonal(i) - upstream*upper(i - 1))
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

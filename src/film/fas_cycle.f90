!> Full approximation scheme for the line contact: smoothing, restriction, exact coarsest level,
!> prolongation; and its smoothers.
!>
!> Source: Brandt 1977; thesis section 2.4.4 and 2.7; Venner & Lubrecht, Multilevel Methods in
!> Lubrication, 2000. The cycle converges at the cavitation point (measured, see the theory page)
!> because a coarse node with P = 0 receives the TRUE residual by injection, a fine node with P = 0
!> contributes nothing to the weighting of others; corrections apply at all nodes and are then cut
!> by P >= 0; a coarse correction falls to zero where the finest grid has P = 0, which need not be a
!> coarse node.
!>
!> Smoothers: Block-Jacobi as in the thesis, and two that need fewer sweeps. Each makes ONE sweep on
!> one level from the operator, coefficients and deflection evaluated just before it, and keeps P >=
!> 0.
module fas_cycle
   use kinds, only: wp
   use line_hierarchy, only: count_work, line_hierarchy_t, smoother_block_jacobi, &
      smoother_gauss_seidel, smoother_hybrid, smoother_line
   use line_level, only: carried_load, elastic_film, evaluate_deflection, has_close_exit, &
      largest_pressure, line_level_t, load_defect, thinnest_film, update_film
   use newton_line, only: solve_newton
   use reynolds_line, only: evaluate_reynolds, reynolds_diagonals
   use transfer, only: full_weighting, prolong_linear
   implicit none (type, external)
   private

   public :: block_jacobi_sweep, cycle_from, gauss_seidel_sweep, line_sweep, smooth, &
      sweep_under_load

   !> The coarsest level is solved until a Newton step changes nothing by more than this, in at most
   !> this many steps.
   real(wp), parameter :: coarse_tolerance = 1.0e-12_wp
   integer, parameter :: coarse_steps = 40
   !> A correction may reduce a film to this share, and change a pressure by this share of max(1,
   !> P); a line sweep too.
   real(wp), parameter :: smallest_film_share = 0.5_wp, largest_step = 0.3_wp
   !> The correction is halved no further below this share.
   real(wp), parameter :: smallest_share = 1.0e-3_wp

   !> The smoother moves the exit, which has the largest residual of a time step: Gauss-Seidel
   !> passes over the nodes around it after each sweep, upstream and downstream of the last node
   !> with P > 0.
   integer, parameter :: exit_passes = 4, exit_upstream = 16, exit_downstream = 4

contains

   !> One cycle on level k: V if `relaxation%visits` is 1, W if 2. The coarsest level is solved
   !> exactly or by sweeps.
   recursive subroutine cycle_from(hierarchy, k)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k
      integer :: visit

      if (k == hierarchy%coarsest) then
         if (maxval(hierarchy%levels(k)%state%pressure) >= largest_pressure) return
         if (hierarchy%relaxation%coarse_sweeps > 0) then
            call sweep_under_load(hierarchy, k)
         else
            call solve_newton(hierarchy%newton, hierarchy%levels(k), coarse_tolerance, &
               coarse_steps, goal=hierarchy%goal)
         end if
         return
      end if
      call smooth(hierarchy, k, hierarchy%relaxation%pre_sweeps, is_last_leg=.false.)
      call restrict(hierarchy, k)
      do visit = 1, merge(hierarchy%relaxation%visits, 1, k - 1 > hierarchy%coarsest)
         call cycle_from(hierarchy, k - 1)
      end do
      call prolong(hierarchy%levels(k), hierarchy%levels(k - 1))
      call smooth(hierarchy, k, hierarchy%relaxation%post_sweeps, is_last_leg=.true.)
   end subroutine cycle_from

   !> Poses the coarse problem of level k - 1: unknowns by injection, right sides = coarse
   !> operator + restricted residual.
   subroutine restrict(hierarchy, k)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      integer, intent(in) :: k

      associate (fine => hierarchy%levels(k), coarse => hierarchy%levels(k - 1))
         coarse%state%pressure = fine%state%pressure(::2)
         coarse%state%film = fine%state%film(::2)
         coarse%state%rigid_displacement = fine%state%rigid_displacement
         coarse%posed%start_pressure(:) = coarse%state%pressure
         coarse%posed%start_film(:) = coarse%state%film
         coarse%inverse_time_step = fine%inverse_time_step
         coarse%rhs_load = carried_load(coarse) + load_defect(fine)
         call evaluate_deflection(fine)
         fine%work%nodes = elastic_film(fine) - fine%state%film
         call full_weighting(fine%work%nodes, coarse%rhs_film)
         call evaluate_reynolds(fine)
         call evaluate_reynolds(coarse)
         call restrict_exit(fine, coarse)
         call restrict_reynolds(fine, coarse)
         call evaluate_deflection(coarse)
         coarse%rhs_film = coarse%rhs_film + coarse%state%film - coarse%state%rigid_displacement &
            + coarse%elastic%deflection
      end associate
      call count_work(hierarchy, k, 1)
      call count_work(hierarchy, k - 1, 1)
   end subroutine restrict

   !> The distance from the last coarse node with P > 0 to the point where the finest grid has P = 0
   !> is not dX but theta dX, 0 < theta <= 1 (a multiple of 2^-k with 2^k finest intervals in a
   !> coarse one). The correction falls to zero over it: its conductance is e/(theta dX^2). The
   !> pressure already there keeps its flow (FAS).
   pure subroutine restrict_exit(fine, coarse)
      type(line_level_t), intent(in) :: fine
      type(line_level_t), intent(inout) :: coarse
      real(wp) :: exit
      integer :: last

      last = findloc(fine%state%pressure > 0.0_wp, .true., 1, back=.true.) - 1
      exit = 0.5_wp*(last + merge(fine%posed%exit_distance, 1.0_wp, last == fine%posed%exit_node))
      coarse%posed%exit_node = ceiling(exit) - 1
      coarse%posed%exit_distance = exit - coarse%posed%exit_node
      coarse%posed%exit_conductance = 0.0_wp
      if (coarse%posed%exit_node < 1) return
      coarse%posed%exit_conductance = (1/coarse%posed%exit_distance - 1) &
         *coarse%oil%face_mobility(coarse%posed%exit_node + 1)/coarse%dx**2
   end subroutine restrict_exit

   !> Restricts the Reynolds residual strictly, see the head of the module.
   pure subroutine restrict_reynolds(fine, coarse)
      type(line_level_t), intent(inout) :: fine, coarse
      integer :: i, n

      n = coarse%n
      fine%work%nodes = fine%rhs_reynolds - fine%operator
      fine%work%nodes(0) = 0.0_wp
      fine%work%nodes(fine%n) = 0.0_wp
      fine%work%correction = merge(fine%work%nodes, 0.0_wp, fine%state%pressure > 0.0_wp)
      call full_weighting(fine%work%correction, coarse%rhs_reynolds)
      do concurrent (i=1:n - 1)
         if (coarse%state%pressure(i) <= 0.0_wp) coarse%rhs_reynolds(i) = fine%work%nodes(2*i)
      end do
      coarse%rhs_reynolds = coarse%rhs_reynolds + coarse%operator
   end subroutine restrict_reynolds

   !> Adds the coarse-grid corrections of P and H at ALL nodes, halved until films and pressures
   !> change within the bounds above.
   pure subroutine prolong(fine, coarse)
      type(line_level_t), intent(inout) :: fine, coarse
      real(wp) :: share

      coarse%work%nodes = coarse%state%pressure - coarse%posed%start_pressure
      coarse%work%correction = coarse%state%film - coarse%posed%start_film
      call prolong_linear(coarse%work%nodes, fine%work%nodes)
      call prolong_linear(coarse%work%correction, fine%work%correction)
      share = 1.0_wp
      do while (share > smallest_share)
         if (all(fine%state%film + share*fine%work%correction >= smallest_film_share &
            *fine%state%film) .and. all(abs(share*fine%work%nodes) &
            <= largest_step*max(1.0_wp, fine%state%pressure))) exit
         share = 0.5_wp*share
      end do
      fine%state%rigid_displacement = coarse%state%rigid_displacement
      fine%state%pressure = max(fine%state%pressure + share*fine%work%nodes, 0.0_wp)
      fine%state%film = max(fine%state%film + share*fine%work%correction, &
         smallest_film_share*fine%state%film, thinnest_film)
   end subroutine prolong

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

end module fas_cycle

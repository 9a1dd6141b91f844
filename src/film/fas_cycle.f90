!> Full approximation scheme for the line contact: smoothing, restriction, exact coarsest level,
!> prolongation.
!>
!> Source: Brandt 1977; thesis section 2.4.4 and 2.7; Venner & Lubrecht, Multilevel Methods in
!> Lubrication, 2000. What makes the cycle converge at the cavitation point (measured, see the
!> theory page): a coarse node with P = 0 keeps the TRUE residual by injection, a fine node with
!> P = 0 contributes nothing to the weighting of others; corrections are taken at all nodes and then
!> cut by P >= 0; a coarse correction falls to zero where the finest grid has P = 0, which need not
!> be a coarse node.
module fas_cycle
   use film_equation, only: evaluate_deflection, film_of, update_film
   use force_balance, only: carried_load, load_defect, relax_load
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: count_work, line_hierarchy_t, smoother_block_jacobi, &
      smoother_gauss_seidel, smoother_hybrid, smoother_line
   use line_level, only: largest_pressure, line_level_t, thinnest_film
   use newton_line, only: solve_newton
   use reynolds_line, only: evaluate_reynolds, reynolds_diagonals
   use smoothers, only: block_jacobi_sweep, gauss_seidel_sweep, line_sweep
   use transfer, only: full_weighting, inject, prolong_linear
   implicit none (type, external)
   private

   public :: cycle_from, is_newton_alone, solve_coarsest

   !> The coarsest level is solved until a Newton step changes nothing above this.
   real(wp), parameter :: coarse_tolerance = 1.0e-12_wp
   !> A correction may lower a film to this share, and change a pressure by this share of max(1, P).
   real(wp), parameter :: smallest_film_share = 0.5_wp, largest_step = 0.3_wp
   !> The correction is dropped when it has been halved to less than this.
   real(wp), parameter :: smallest_share = 1.0e-3_wp

contains

   !> One cycle on level k: V if `relaxation%visits` is 1, W if 2.
   recursive subroutine cycle_from(hierarchy, contact, k)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: k
      integer :: visit

      if (k == hierarchy%coarsest) then
         call solve_coarsest(hierarchy, contact)
         return
      end if
      call smooth(hierarchy, contact, k, hierarchy%relaxation%pre_sweeps, is_last_leg=.false.)
      call restrict(hierarchy, contact, k)
      do visit = 1, merge(hierarchy%relaxation%visits, 1, k - 1 > hierarchy%coarsest)
         call cycle_from(hierarchy, contact, k - 1)
      end do
      call prolong(hierarchy%levels(k), hierarchy%levels(k - 1))
      call smooth(hierarchy, contact, k, hierarchy%relaxation%post_sweeps, is_last_leg=.true.)
   end subroutine cycle_from

   !> `sweeps` of the chosen smoother on level k. The hybrid sweeps by line before and downstream
   !> after the correction.
   subroutine smooth(hierarchy, contact, k, sweeps, is_last_leg)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: k, sweeps
      logical, intent(in) :: is_last_leg
      integer :: i, smoother

      smoother = hierarchy%relaxation%smoother
      if (smoother == smoother_hybrid) smoother = merge(smoother_gauss_seidel, smoother_line, &
         is_last_leg)
      do i = 1, sweeps
         call sweep(hierarchy, contact, k, smoother)
      end do
      if (smoother == smoother_line) call update_film(hierarchy%levels(k))
      call count_work(hierarchy, k, sweeps)
   end subroutine smooth

   !> One sweep of one smoother, from coefficients evaluated at the present state.
   subroutine sweep(hierarchy, contact, k, smoother)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: k, smoother
      real(wp) :: kernel_diagonal

      associate (level => hierarchy%levels(k), choice => hierarchy%relaxation)
         if (maxval(level%state%pressure) >= largest_pressure) return
         kernel_diagonal = min(level%kernel(0), -choice%kernel_bound*level%dx)
         if (choice%film_is_recomputed) then
            call update_film(level)
         else
            call evaluate_deflection(level)
         end if
         call evaluate_reynolds(contact, level)
         call reynolds_diagonals(contact%lambda, level, kernel_diagonal)
         select case (smoother)
         case (smoother_block_jacobi)
            call block_jacobi_sweep(level, kernel_diagonal, choice%relaxation)
         case (smoother_gauss_seidel)
            call gauss_seidel_sweep(level, contact%lambda, kernel_diagonal, choice%relaxation)
         case default
            call line_sweep(level, choice%relaxation)
         end select
      end associate
   end subroutine sweep

   !> The coarsest level: exactly, or by sweeps with the force balance relaxed after each (thesis,
   !> section 2.7).
   subroutine solve_coarsest(hierarchy, contact)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer :: i, k

      k = hierarchy%coarsest
      if (maxval(hierarchy%levels(k)%state%pressure) >= largest_pressure) return
      if (hierarchy%relaxation%coarse_sweeps <= 0) then
         call solve_newton(hierarchy%newton, contact, hierarchy%levels(k), &
            coarse_tolerance, hierarchy%relaxation%coarse_steps, goal=hierarchy%goal, &
            film_is_exact=is_newton_alone(hierarchy))
         return
      end if
      do i = 1, hierarchy%relaxation%coarse_sweeps
         call smooth(hierarchy, contact, k, 1, is_last_leg=.true.)
         call relax_load(hierarchy%levels(k), hierarchy%relaxation%load_relaxation)
      end do
   end subroutine solve_coarsest

   !> Whether the cycle is nothing but Newton's method on the finest level, which leaves the film
   !> that of pressure and H0.
   pure function is_newton_alone(hierarchy) result(is_alone)
      type(line_hierarchy_t), intent(in) :: hierarchy
      logical :: is_alone

      is_alone = hierarchy%coarsest == hierarchy%finest &
         .and. hierarchy%relaxation%coarse_sweeps <= 0
   end function is_newton_alone

   !> Poses the coarse problem of level k - 1: unknowns by injection, right sides = coarse
   !> operator + restricted residual.
   subroutine restrict(hierarchy, contact, k)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: k

      associate (fine => hierarchy%levels(k), coarse => hierarchy%levels(k - 1))
         call inject(fine%state%pressure, coarse%state%pressure)
         call inject(fine%state%film, coarse%state%film)
         coarse%state%rigid_displacement = fine%state%rigid_displacement
         coarse%start = coarse%state
         coarse%inverse_time_step = fine%inverse_time_step
         coarse%has_tail = .false.
         coarse%rhs_load = carried_load(coarse) + load_defect(fine)
         call film_of(fine, fine%work)
         fine%work = fine%work - fine%state%film
         call full_weighting(fine%work, coarse%rhs_film)
         call evaluate_reynolds(contact, fine)
         call evaluate_reynolds(contact, coarse)
         call restrict_exit(fine, coarse)
         call restrict_reynolds(fine, coarse)
         call evaluate_deflection(coarse)
         coarse%rhs_film = coarse%rhs_film + coarse%state%film - coarse%state%rigid_displacement &
            + coarse%deflection
      end associate
      call count_work(hierarchy, k, 1)
      call count_work(hierarchy, k - 1, 1)
   end subroutine restrict

   !> The way from the last coarse node with P > 0 to where the finest grid has P = 0 again is theta
   !> dX long, 0 < theta <= 1 (with 2^k finest intervals in a coarse one it is a multiple of 2^-k),
   !> not dX, and the correction falls to zero on it: its conductance is e/(theta dX^2). The
   !> pressure that is there already keeps its flow (FAS).
   pure subroutine restrict_exit(fine, coarse)
      type(line_level_t), intent(in) :: fine
      type(line_level_t), intent(inout) :: coarse
      real(wp) :: exit
      integer :: last

      last = findloc(fine%state%pressure > 0.0_wp, .true., 1, back=.true.) - 1
      exit = 0.5_wp*(last + merge(fine%exit_distance, 1.0_wp, last == fine%exit_node))
      coarse%exit_node = ceiling(exit) - 1
      coarse%exit_distance = exit - coarse%exit_node
      coarse%exit_conductance = 0.0_wp
      if (coarse%exit_node < 1) return
      coarse%exit_conductance = (1/coarse%exit_distance - 1)*coarse%face_mobility(coarse%exit_node &
         + 1)/coarse%dx**2
   end subroutine restrict_exit

   !> Strict restriction of the Reynolds residual, see the head of the module.
   pure subroutine restrict_reynolds(fine, coarse)
      type(line_level_t), intent(inout) :: fine
      type(line_level_t), intent(inout) :: coarse
      integer :: i, n

      n = coarse%n
      fine%work = fine%rhs_reynolds - fine%operator
      fine%work(0) = 0.0_wp
      fine%work(fine%n) = 0.0_wp
      fine%correction = merge(fine%work, 0.0_wp, fine%state%pressure > 0.0_wp)
      call full_weighting(fine%correction, coarse%rhs_reynolds)
      do concurrent (i=1:n - 1)
         if (coarse%state%pressure(i) <= 0.0_wp) coarse%rhs_reynolds(i) = fine%work(2*i)
      end do
      coarse%rhs_reynolds = coarse%rhs_reynolds + coarse%operator
   end subroutine restrict_reynolds

   !> Adds the coarse-grid corrections of P and H at ALL nodes, halved until every film keeps half
   !> of itself.
   pure subroutine prolong(fine, coarse)
      type(line_level_t), intent(inout) :: fine
      type(line_level_t), intent(inout) :: coarse
      real(wp) :: share

      coarse%work = coarse%state%pressure - coarse%start%pressure
      coarse%correction = coarse%state%film - coarse%start%film
      call prolong_linear(coarse%work, fine%work)
      call prolong_linear(coarse%correction, fine%correction)
      share = 1.0_wp
      do while (share > smallest_share)
         if (all(fine%state%film + share*fine%correction >= smallest_film_share &
            *fine%state%film) .and. &
            all(abs(share*fine%work) <= largest_step*max(1.0_wp, fine%state%pressure))) exit
         share = 0.5_wp*share
      end do
      fine%state%rigid_displacement = coarse%state%rigid_displacement
      fine%state%pressure = max(fine%state%pressure + share*fine%work, 0.0_wp)
      fine%state%film = max(fine%state%film + share*fine%correction, &
         smallest_film_share*fine%state%film, &
         thinnest_film)
   end subroutine prolong

end module fas_cycle

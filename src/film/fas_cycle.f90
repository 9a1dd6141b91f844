!> Full approximation scheme for the line contact: smoothing, restriction, exact coarsest level,
!> prolongation.
!>
!> Source: Brandt 1977; thesis section 2.4.4 and 2.7; Venner & Lubrecht, Multilevel Methods in
!> Lubrication, 2000. The cycle converges at the cavitation point (measured, see the theory page)
!> because a coarse node with P = 0 receives the TRUE residual by injection, a fine node with P = 0
!> contributes nothing to the weighting of others; corrections apply at all nodes and are then cut
!> by P >= 0; a coarse correction falls to zero where the finest grid has P = 0, which need not be a
!> coarse node.
module fas_cycle
   use film_equation, only: carried_load, elastic_film, evaluate_deflection, load_defect
   use kinds, only: wp
   use line_hierarchy, only: count_work, line_hierarchy_t
   use line_level, only: largest_pressure, line_level_t, thinnest_film
   use newton_line, only: solve_newton
   use smoothers, only: smooth, sweep_under_load
   use reynolds_line, only: evaluate_reynolds
   use transfer, only: full_weighting, inject, prolong_linear
   implicit none (type, external)
   private

   public :: cycle_from

   !> The coarsest level is solved until a Newton step changes nothing by more than this, in at most
   !> this many steps.
   real(wp), parameter :: coarse_tolerance = 1.0e-12_wp
   integer, parameter :: coarse_steps = 40
   !> A correction may reduce a film to this share, and change a pressure by this share of max(1,
   !> P).
   real(wp), parameter :: smallest_film_share = 0.5_wp, largest_step = 0.3_wp
   !> The correction is halved no further below this share.
   real(wp), parameter :: smallest_share = 1.0e-3_wp

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
         call inject(fine%state%pressure, coarse%state%pressure)
         call inject(fine%state%film, coarse%state%film)
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

end module fas_cycle

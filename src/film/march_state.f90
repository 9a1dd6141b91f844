!> State of a transient after a time step: everything that later steps depend on, so that an
!> interrupted run resumes without changing a bit of its result.
module march_state
   use film_state, only: film_state_t
   use iteration_report, only: report_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: march_state_t, time_part_t

   !> The last solutions, from which the next one starts; dimensionless, on the nodes 0:n of the
   !> finest grid.
   type :: march_state_t
      !> Time steps done; 0 = the start. Steps to do; 0: as planned.
      integer :: step = 0, steps = 0
      !> Solutions kept, up to 3, and of rho H up to 4; 1 is the newest.
      integer :: size = 0
      !> P of these solutions (0:n, 3).
      real(wp), allocatable :: pressure(:, :)
      !> H0 of these solutions.
      real(wp) :: rigid_displacement(3) = 0.0_wp
      !> Time from each of these solutions back to the next older one: dT, or a part of it.
      real(wp) :: lengths(3) = 0.0_wp
      !> Length that the error estimate proposes for the next part; 0: none.
      real(wp) :: next_length = 0.0_wp
      !> Direction of the flow in which they are kept (module line_level).
      real(wp) :: direction = 1.0_wp
      !> rho H of the last four times (0:n, 4), for the squeeze term and its error.
      real(wp), allocatable :: mass(:, :)
      !> Number of the relaxation that found it; the next step begins with it if all are relaxations
      !> of one method.
      integer :: way = 1
      !> H at the end of the last cycle of a duty (nx), and its largest relative change in that.
      real(wp), allocatable :: cycle_film(:)
      real(wp) :: cycle_change = 0.0_wp
      !> H of the newest solution (0:n), and outcome, history and cost up to here; set in a stored
      !> state.
      real(wp), allocatable :: film(:)
      type(report_t) :: report
   end type march_state_t

   !> A step, or one part of it, with its solution on the nodes 0:n of the finest grid.
   type :: time_part_t
      !> dy/dT at its end is weights(1) y + weights(2) y_old + weights(3) y_older.
      real(wp) :: weights(3) = 0.0_wp
      !> Its length dT.
      real(wp) :: length = 0.0_wp
      !> Psi_1 and Psi_2 at its end (0:n, 2).
      real(wp), allocatable :: heights(:, :)
      type(film_state_t) :: state
   end type time_part_t

end module march_state

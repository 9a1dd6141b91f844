!> A time step as it was solved, whole or in parts, for somebody who repeats it with other
!> equations.
module time_part
   use film_state, only: film_state_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: time_part_t

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

end module time_part

!> State of a film: everything that an iteration changes, restored if one fails.
!>
!> Assignment saves and restores a state (`saved = level%state`, `level%state = saved`).
module film_state
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: film_state_t, is_finite

   !> Dimensionless, on the nodes (0:n) of one grid.
   type :: film_state_t
      !> Pressure P >= 0 of the oil and film thickness H > 0, the mean gap that it fills.
      real(wp), allocatable :: pressure(:), film(:)
      !> Pressure of asperities, and separation of the mean planes: allocated where they touch.
      real(wp), allocatable :: asperity_pressure(:), separation(:)
      !> Rigid displacement H0.
      real(wp) :: rigid_displacement = 0.0_wp
      !> Part of P that rounding cuts off in Newton's steps; the slopes of L_R are those of P plus
      !> this. Allocated only while an iteration needs it (module cycle_control).
      real(wp), allocatable :: compensation(:)
   end type film_state_t

contains

   !> Whether pressure, film and rigid displacement are finite.
   pure logical function is_finite(state)
      type(film_state_t), intent(in) :: state

      is_finite = all(ieee_is_finite(state%pressure)) .and. all(ieee_is_finite(state%film)) &
         .and. ieee_is_finite(state%rigid_displacement)
   end function is_finite

end module film_state

!> When the cycles of one solution end.
module cycle_limits
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: cycle_limits_t

   !> When the cycles end.
   type :: cycle_limits_t
      !> Bound on the residuals (theory page, residuals and convergence).
      real(wp) :: tolerance = 1.0e-8_wp
      !> Cycles at most.
      integer :: max_cycles = 60
      !> Stagnation: the smallest residual has not fallen by a third within this many cycles.
      integer :: patience = 12
   end type cycle_limits_t

end module cycle_limits

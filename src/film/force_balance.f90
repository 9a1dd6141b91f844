!> Force balance (2.60) by the trapezoidal rule, P = 0 at both ends: dX sum P = pi/2, less what a
!> tail in front of the inlet carries (module inlet_tail); on a coarse grid what the coarse problem
!> asks for. That load is `rhs_load`.
module force_balance
   use kinds, only: wp
   use line_level, only: line_level_t
   implicit none (type, external)
   private

   public :: carried_load, load_defect, relax_load

contains

   !> The load that the pressure carries, dX sum P.
   pure function carried_load(level) result(load)
      type(line_level_t), intent(in) :: level
      real(wp) :: load

      load = level%dx*sum(level%state%pressure)
   end function carried_load

   !> What is missing of it, rhs_load - dX sum P.
   pure function load_defect(level) result(defect)
      type(line_level_t), intent(in) :: level
      real(wp) :: defect

      defect = level%rhs_load - carried_load(level)
   end function load_defect

   !> Moves H0 by `relaxation` times what is missing: surfaces that carry too little come closer.
   pure subroutine relax_load(level, relaxation)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: relaxation

      level%state%rigid_displacement = level%state%rigid_displacement &
         - relaxation*load_defect(level)
   end subroutine relax_load

end module force_balance

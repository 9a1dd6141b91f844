!> What lies in front of the first node of a passage: the pressure of the smooth steady contact,
!> from a graded grid with a far inlet. It presses on the bodies and carries its load; the first
!> node has its pressure.
!>
!> So far out the pressure follows from the gap alone, dP/dX = lambda mu (H - H*)/(S H^3) with H
!> much larger than the film H* of the contact: what passes the contact hardly changes it.
module inlet_tail
   use graded_nodes, only: monotone_cubic
   use half_space, only: deflection_by_elements
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   implicit none (type, external)
   private

   public :: set_tail

contains

   !> Sets gap, load and first pressure of a level with the tail of its contact, if any. The cell of
   !> the first node begins half a spacing in front of it: there the tail ends.
   pure subroutine set_tail(level, contact)
      type(line_level_t), intent(inout) :: level
      type(line_contact_t), intent(in) :: contact
      real(wp), allocatable :: x(:), pressure(:)
      integer :: m

      if (.not. (contact%domain%has_tail .and. allocated(contact%tail))) return
      associate (tail => contact%tail)
         m = count(tail%x < level%x(0) - 0.5_wp*level%dx)
         x = [tail%x(:m), level%x(0) - 0.5_wp*level%dx, level%x(0)]
         pressure = monotone_cubic(tail%x, tail%pressure, x)
      end associate
      level%state%pressure(0) = pressure(m + 2)
      level%gap = level%gap - level%elastic%elasticity*deflection_by_elements(x(:m + 1), &
         pressure(:m + 1), level%x)
      level%load = level%load - dot_product(0.5_wp*(x(2:m + 1) - x(:m)), pressure(2:m + 1) &
         + pressure(:m))
      level%rhs_load = level%load   ! for a passage that resumes
   end subroutine set_tail

end module inlet_tail

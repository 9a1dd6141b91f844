!> What lies in front of the first node of a passage: the pressure of the smooth steady contact, from
!> a graded grid with a far inlet. It presses on the bodies and carries its load; the first node has
!> its pressure.
!>
!> So far out the pressure follows from the gap alone, dP/dX = lambda mu (H - H*)/(S H^3) with H much
!> larger than the film H* of the contact: what passes the contact hardly changes it.
module inlet_tail
   use domain_choice, only: choose_anew, choose_domain
   use graded_nodes, only: monotone_cubic
   use graded_solver, only: graded_solution_t, solve_graded
   use half_space, only: deflection_by_elements
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: inlet_tail_t, line_contact_t, without_surfaces
   use line_level, only: line_level_t
   use listener, only: listener_t, relay_t
   use solver_settings, only: domain_t
   implicit none (type, external)
   private

   public :: find_tail, set_tail

   !> Accuracy of the smooth steady contact.
   real(wp), parameter :: accuracy = 0.1_wp

contains

   !> Solves the smooth steady contact for the tail that the domain wants, unless it is there. If
   !> there is no solution, the contact goes without, on a domain chosen anew.
   subroutine find_tail(contact, target, listener)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: target
      class(listener_t), intent(inout), target :: listener
      type(line_contact_t) :: smooth
      type(graded_solution_t) :: solution
      type(relay_t) :: relay
      type(report_t) :: report

      if (.not. contact%domain%has_tail .or. allocated(contact%tail)) return
      relay%parent => listener
      smooth = without_surfaces(contact)
      smooth%domain = domain_t(grid='graded')
      call choose_domain(smooth)
      call solve_graded(smooth, [smooth%domain%x_inlet, smooth%domain%x_outlet], accuracy, &
         relay, solution, report)
      contact%domain%has_tail = allocated(solution%line)
      if (allocated(solution%line)) then
         contact%tail = inlet_tail_t(solution%line%x(:), solution%line%state%pressure(:))
      else
         call choose_anew(contact, target)
      end if
   end subroutine find_tail

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
   end subroutine set_tail

end module inlet_tail

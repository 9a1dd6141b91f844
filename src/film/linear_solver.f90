!> The linear system of one Newton step of the line contact, and what it takes to solve it.
!>
!> Unknowns are the changes of P(1..n-1) and of H0. Row i < n is the Reynolds equation of node i
!> divided by the elastic diagonal (the identity where the node is cavitated), row n the force
!> balance.
module linear_solver
   use jacobian_bands, only: reynolds_jacobian_t
   use kinds, only: wp
   use line_level, only: line_level_t
   implicit none (type, external)
   private

   public :: linear_solver_t

   !> A way to solve the system.
   type, abstract :: linear_solver_t
      !> Share of the right side that an iterative solution may leave.
      real(wp) :: tolerance = 1.0e-2_wp
      !> Bound on what it may leave of a Reynolds residual |r|.
      real(wp) :: goal = huge(1.0_wp)
      !> Iterations of the last call (0 for a direct solution).
      integer :: iterations = 0
   contains
      procedure(solve_interface), deferred :: solve
   end type linear_solver_t

   abstract interface
      !> `jacobian` holds bands that are already divided by the elastic diagonal; `step` (n) is the
      !> right side on entry and the solution on return. `is_solved` is false if the system is
      !> singular.
      subroutine solve_interface(self, level, jacobian, is_cavitated, step, is_solved)
         import :: line_level_t, linear_solver_t, reynolds_jacobian_t, wp
         implicit none (type, external)
         class(linear_solver_t), intent(inout), target :: self
         type(line_level_t), intent(inout), target :: level
         type(reynolds_jacobian_t), intent(in), target :: jacobian
         logical, intent(in) :: is_cavitated(:)
         real(wp), intent(inout) :: step(:)
         logical, intent(out) :: is_solved
      end subroutine solve_interface
   end interface

end module linear_solver

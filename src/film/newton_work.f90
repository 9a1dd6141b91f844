!> Work space and outcome of Newton's method, and the linear system of one of its steps.
!>
!> Its unknowns are the changes of P(1..n-1) and H0. Row i < n is the Reynolds equation of node i
!> divided by the elastic diagonal (the identity where the node is cavitated), row n the force
!> balance.
module newton_work
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_level, only: line_level_t
   use mobility, only: mobility_slopes_t
   implicit none (type, external)
   private

   public :: allocate_work, linear_solver_t, new_jacobian, newton_t, reynolds_jacobian_t

   !> Bands by offset and row: by_pressure(o, i) = dL_R(i)/dP(i+o), by_film(o, i) = dL_R(i)/dH(i+o).
   type :: reynolds_jacobian_t
      !> (-2:2, 0:n)
      real(wp), allocatable :: by_pressure(:, :)
      !> (-2:1, 0:n)
      real(wp), allocatable :: by_film(:, :)
      !> Diagonal of the elastic Jacobian JP - JH K (0:n), negative in a sound state.
      real(wp), allocatable :: diagonal(:)
      !> Share of a change of what arrives at a node that leaves it (0:n), 0 unless it cavitates and
      !> conserves its oil; allocated if that is so.
      real(wp), allocatable :: carry(:)
      type(mobility_slopes_t) :: slopes
   end type reynolds_jacobian_t

   !> A solver of the system.
   type, abstract :: linear_solver_t
      !> Share of the right side that an iterative solution may leave.
      real(wp) :: tolerance = 1.0e-2_wp
      !> Bound on the Reynolds residual |r| that it may leave.
      real(wp) :: goal = huge(1.0_wp)
      !> Iterations of the last call (0 for a direct solution).
      integer :: iterations = 0
   contains
      procedure(solve_interface), deferred :: solve
   end type linear_solver_t

   !> Linear solver, Jacobian, step and outcome.
   type :: newton_t
      class(linear_solver_t), allocatable :: linear
      type(reynolds_jacobian_t) :: jacobian
      real(wp), allocatable :: step(:)
      !> State before the last step.
      type(film_state_t) :: before
      logical, allocatable :: is_cavitated(:)
      !> Wall stress per H dP/dX of the lubricant; 0 for a Newtonian one.
      real(wp) :: stress_scale = 0.0_wp
      !> Whether steps are bent (`bend_step`): Newtonian lubricants.
      logical :: is_bent = .false.
      !> Largest |r| of the nodes not cavitated, at the last linearisation.
      real(wp) :: residual = 0.0_wp
      !> Newton steps of the last call, and steps of the linear solver in all calls.
      integer :: steps = 0, linear_iterations = 0
      !> Nodes with pressure at the last step, and steps in a row in which few have come or gone.
      integer :: active = 0, creeping = 0
      !> Size of the last step in P and H0; below `tolerance` when converged.
      real(wp) :: last_step = huge(1.0_wp)
      !> Largest relative change of a film in the last step.
      real(wp) :: last_film_step = huge(1.0_wp)
      !> True if the last call ended by its tolerance or at round-off.
      logical :: is_converged = .false.
   end type newton_t

   abstract interface
      !> Solves with `jacobian`, whose bands are already divided by the elastic diagonal; `step` (n)
      !> is the right side on entry and the solution on return. `is_solved` is false if the system
      !> is singular.
      subroutine solve_interface(self, level, jacobian, is_cavitated, step, is_solved)
         import :: line_level_t, linear_solver_t, reynolds_jacobian_t, wp
         class(linear_solver_t), intent(inout), target :: self
         type(line_level_t), intent(inout), target :: level
         type(reynolds_jacobian_t), intent(in), target :: jacobian
         logical, intent(in) :: is_cavitated(:)
         real(wp), intent(inout) :: step(:)
         logical, intent(out) :: is_solved
      end subroutine solve_interface
   end interface

contains

   !> Allocates the bands for `n` intervals.
   pure subroutine new_jacobian(jacobian, n)
      type(reynolds_jacobian_t), intent(out) :: jacobian
      integer, intent(in) :: n

      allocate (jacobian%by_pressure(-2:2, 0:n), jacobian%by_film(-2:1, 0:n), &
         jacobian%diagonal(0:n), source=0.0_wp)
      associate (slopes => jacobian%slopes)
         allocate (slopes%rho_p(0:n), slopes%e_p(0:n), slopes%e_h(0:n), slopes%e_slope(0:n))
      end associate
   end subroutine new_jacobian

   !> Allocates work space for n intervals and resets the count of steps.
   subroutine allocate_work(newton, n)
      type(newton_t), intent(inout) :: newton
      integer, intent(in) :: n

      newton%steps = 0
      newton%last_step = huge(1.0_wp)
      if (allocated(newton%step)) then
         if (size(newton%step) == n) return
         deallocate (newton%step, newton%is_cavitated)
      end if
      allocate (newton%step(n), newton%is_cavitated(n - 1))
      call new_jacobian(newton%jacobian, n)
   end subroutine allocate_work

end module newton_work

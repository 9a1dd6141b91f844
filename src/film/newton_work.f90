!> What Newton's method keeps from call to call, and what the last call did.
module newton_work
   use film_state, only: film_state_t
   use jacobian_bands, only: new_jacobian, reynolds_jacobian_t
   use kinds, only: wp
   use linear_solver, only: linear_solver_t
   implicit none (type, external)
   private

   public :: allocate_work, newton_t

   !> Linear solver, Jacobian, step and outcome.
   type :: newton_t
      class(linear_solver_t), allocatable :: linear
      type(reynolds_jacobian_t) :: jacobian
      real(wp), allocatable :: step(:)
      !> Where the last step began.
      type(film_state_t) :: before
      logical, allocatable :: is_cavitated(:)
      !> Wall stress per H dP/dX of the lubricant; 0 for a Newtonian one.
      real(wp) :: stress_scale = 0.0_wp
      !> Whether steps are bent (`bend_step`): Newtonian lubricants.
      logical :: is_bent = .false.
      !> Largest |r| of the nodes that are not cavitated, at the last linearisation.
      real(wp) :: residual = 0.0_wp
      !> Newton steps of the last call, and steps of the linear solver in all calls.
      integer :: steps = 0, linear_iterations = 0
      !> Size of the last full step in P and H0; below `tolerance` when converged.
      real(wp) :: last_step = huge(1.0_wp)
      !> Largest relative change of a film in the last step.
      real(wp) :: last_film_step = huge(1.0_wp)
      !> True if the last call ended by its tolerance or at round-off.
      logical :: is_converged = .false.
   end type newton_t

contains

   !> Work space for n intervals.
   subroutine allocate_work(newton, n)
      type(newton_t), intent(inout) :: newton
      integer, intent(in) :: n

      newton%steps = 0
      newton%last_step = huge(1.0_wp)
      call new_jacobian(newton%jacobian, n)
      if (allocated(newton%step)) then
         if (size(newton%step) == n) return
         deallocate (newton%step, newton%is_cavitated)
      end if
      allocate (newton%step(n), newton%is_cavitated(n - 1))
   end subroutine allocate_work

end module newton_work

!> Contact of rough surfaces by a projected, preconditioned conjugate gradient with both bounds as active sets.
!>
!> After I. A. Polonsky and L. M. Keer, Wear 231, 1999, 206, with three changes: the direction is never restarted when nodes
!> enter or leave, |q| preconditions it, and the load is kept by shifts, not by scaling, so that an upper bound (hardness)
!> is held exactly. Nodes at a bound leave it as soon as their gap has the wrong sign.
module dry_conjugate_gradient
   use active_set, only: active_set_t, new_active_set
   use dry_preconditioner, only: dry_preconditioner_t
   use dry_problem, only: dry_problem_t
   use dry_solution, only: dry_settings_t, dry_solution_t, take_survey
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use load_projection, only: shift_into_bounds
   use text, only: to_text
   implicit none (type, external)
   private

   public :: iterate_conjugate_gradient

   !> v = K p - z is computed anew after so many iterations: its updates collect rounding errors.
   integer, parameter :: refresh_interval = 15
   !> Iterations without a halved error after which nothing more is to be gained.
   integer, parameter :: patience = 1000

   !> What an iteration works on; fields (nx*ny), lists as long as the active set.
   type :: work_t
      type(active_set_t) :: set
      !> v = K p - z.
      real(wp), allocatable :: v(:)
      !> Direction t and residual r of the last iteration, zero off its active set.
      real(wp), allocatable :: t(:), r(:)
      !> s = M r on the list; direction, then change of p on the list.
      real(wp), allocatable :: s(:), q(:)
      !> r.s of the last iteration; 0: there is no direction yet.
      real(wp) :: descent
      !> Nodes on which t and r are not zero.
      integer, allocatable :: old_node(:)
      integer :: old_count
   end type work_t

contains

   !> Improves the pressure of `solution` (within its bounds and with its load) until the error measure is the tolerance or
   !> less; the rest of the solution follows. Its report gets one entry an iteration.
   !> Fails (internal_error) if FFTW does.
   subroutine iterate_conjugate_gradient(problem, preconditioner, settings, solution, error)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_preconditioner_t), intent(inout) :: preconditioner
      type(dry_settings_t), intent(in) :: settings
      type(dry_solution_t), intent(inout) :: solution
      type(error_t), allocatable, intent(out) :: error
      type(work_t) :: work
      real(wp) :: best
      integer :: age, iteration, stalled

      call new_work(work, size(solution%pressure))
      call refresh(problem, solution%pressure, work%v)
      age = 0
      best = huge(1.0_wp)
      stalled = 0
      associate (p => solution%pressure, report => solution%report)
         do iteration = 0, settings%max_cycles
            call work%set%survey(problem, p, work%v)
            if (age > 0 .and. (work%set%error <= settings%tolerance .or. age >= refresh_interval)) then
               call refresh(problem, p, work%v)
               age = 0
               call work%set%survey(problem, p, work%v)
            end if
            call report%add(work%set%error, work%set%load_error)
            report%converged = work%set%error <= settings%tolerance
            stalled = stalled + 1
            if (work%set%error < 0.5_wp*best) then
               best = work%set%error
               stalled = 0
            end if
            if (report%converged .or. stalled > patience .or. work%set%error >= huge(1.0_wp) &
               .or. iteration == settings%max_cycles) exit
            call step(problem, preconditioner, p, work, error)
            if (allocated(error)) return
            age = age + 1
         end do
      end associate
      solution%report%method = 'conjugate_gradient'
      solution%report%reason = reason_of(solution%report, work%set%error, stalled, settings%max_cycles)
      call move_alloc(work%v, solution%v)
      call take_survey(work%set, solution)
   end subroutine iterate_conjugate_gradient

   !> Storage for `n` nodes.
   subroutine new_work(work, n)
      type(work_t), intent(out) :: work
      integer, intent(in) :: n

      call new_active_set(work%set, n)
      allocate (work%v(n), work%s(n), work%q(n), work%old_node(n))
      allocate (work%t(n), work%r(n), source=0.0_wp)
      work%descent = 0.0_wp
      work%old_count = 0
   end subroutine new_work

   !> v = K p - z.
   subroutine refresh(problem, p, v)
      type(dry_problem_t), intent(inout) :: problem
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), contiguous, intent(out) :: v(:)

      call problem%deflect(p, v)
      v = v - problem%height
   end subroutine refresh

   !> One iteration: direction, step, back into the bounds. Products are in single precision: they only change v, which is
   !> computed anew now and then.
   subroutine step(problem, preconditioner, p, work, error)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_preconditioner_t), intent(inout) :: preconditioner
      real(wp), contiguous, intent(inout) :: p(:)
      type(work_t), intent(inout) :: work
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: curvature, scale, slope, length
      logical :: is_clipped

      associate (n => work%set%count, elastic => problem%elastic)
         call preconditioner%precondition(problem%grid, work%set%node(:n), work%set%residual(:n), work%s(:n), error)
         if (allocated(error)) return
         call find_direction(work, slope)
         call elastic%apply_single(work%set%node(:n), work%q(:n), scale, error)
         if (allocated(error)) return
         curvature = scale*elastic%dot_single(work%set%node(:n), work%q(:n))
         length = 0.0_wp
         if (curvature > 0.0_wp .and. slope > 0.0_wp) length = slope/curvature
         if (.not. length > 0.0_wp) work%descent = 0.0_wp
         call move(problem, p, length, work, is_clipped)
         if (is_clipped) then
            call elastic%apply_single(work%set%node(:n), work%q(:n), length, error)
            if (allocated(error)) return
            call elastic%add_single(length, work%v)
         else
            call elastic%add_single(length*scale, work%v)
         end if
      end associate
   end subroutine step

   !> t = s - mean s + beta (old t on F, its mean removed), beta = max(0, s.(r - r_old)/(r.s)_old), on the list q; `slope` = r.t.
   subroutine find_direction(work, slope)
      type(work_t), intent(inout) :: work
      real(wp), intent(out) :: slope
      real(wp) :: beta, descent, mean_s, mean_t, numerator
      integer :: i, k, n

      n = work%set%count
      mean_s = sum(work%s(:n))/n
      mean_t = 0.0_wp
      descent = 0.0_wp
      numerator = 0.0_wp
      do k = 1, n
         i = work%set%node(k)
         work%s(k) = work%s(k) - mean_s
         mean_t = mean_t + work%t(i)
         descent = descent + work%s(k)*work%set%residual(k)
         numerator = numerator + work%s(k)*(work%set%residual(k) - work%r(i))
         work%q(k) = work%t(i)
      end do
      mean_t = mean_t/n
      beta = 0.0_wp
      if (work%descent > 0.0_wp) beta = max(0.0_wp, numerator/work%descent)
      slope = 0.0_wp
      do k = 1, n
         work%q(k) = work%s(k) + beta*(work%q(k) - mean_t)
         slope = slope + work%q(k)*work%set%residual(k)
      end do
      if (slope <= 0.0_wp) then
         work%q(:n) = work%s(:n)
         slope = descent
      end if
      work%descent = descent
      do k = 1, work%old_count
         work%t(work%old_node(k)) = 0.0_wp
         work%r(work%old_node(k)) = 0.0_wp
      end do
      do k = 1, n
         i = work%set%node(k)
         work%t(i) = work%q(k)
         work%r(i) = work%set%residual(k)
      end do
      work%old_node(:n) = work%set%node(:n)
      work%old_count = n
   end subroutine find_direction

   !> p = p + length t on F; what leaves the bounds is clipped and the load restored by a shift of F. If so, `is_clipped` and
   !> the list q holds the change of p.
   subroutine move(problem, p, length, work, is_clipped)
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(inout) :: p(:)
      real(wp), intent(in) :: length
      type(work_t), intent(inout) :: work
      logical, intent(out) :: is_clipped
      real(wp) :: held_load, p_new
      integer :: i, k, n

      n = work%set%count
      is_clipped = length <= 0.0_wp
      do k = 1, n
         i = work%set%node(k)
         work%q(k) = p(i) + length*work%t(i)
         is_clipped = is_clipped .or. work%q(k) < 0.0_wp .or. work%q(k) > problem%hardness
      end do
      if (is_clipped) then
         held_load = 0.0_wp
         if (work%set%held > 0) held_load = work%set%held*problem%hardness
         call shift_into_bounds(work%q(:n), problem%hardness, max(problem%load - held_load, 0.0_wp))
      end if
      do k = 1, n
         i = work%set%node(k)
         p_new = work%q(k)
         work%q(k) = p_new - p(i)
         p(i) = p_new
      end do
   end subroutine move

   !> Why the iteration ended.
   function reason_of(report, error, stalled, max_cycles) result(reason)
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: error
      integer, intent(in) :: stalled, max_cycles
      character(:), allocatable :: reason

      if (report%converged) then
         reason = 'converged'
      else if (error >= huge(1.0_wp)) then
         reason = 'values are not finite'
      else if (stalled > patience) then
         reason = 'the error has stopped falling at ' // to_text(error, 3)
      else
         reason = 'the error is ' // to_text(error, 3) // ' after ' // to_text(max_cycles) // ' iterations'
      end if
   end function reason_of

end module dry_conjugate_gradient

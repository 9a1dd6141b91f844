!> Solves the contact of rough surfaces by a projected, preconditioned conjugate gradient with both
!> bounds as active sets.
!>
!> After I. A. Polonsky and L. M. Keer, Wear 231, 1999, 206, with four changes: the direction is
!> never restarted when nodes enter or leave; a tree network (`tree_network`) preconditions it; the
!> same network returns what leaves the bounds, giving the difference to its neighbours, so that
!> load and upper bound (hardness) hold exactly; and an iteration needs one product with K: the step
!> along the direction is predicted from the iteration before and returned to the bounds, then K is
!> applied to the change of p, whose length is corrected. Nodes at a bound leave it as soon as their
!> gap has the wrong sign.
module dry_conjugate_gradient
   use active_set, only: active_set_t, copy_survey, new_active_set
   use load_projection, only: bring_back, settle_load
   use dry_problem, only: dry_grid_t, dry_problem_t, dry_settings_t, dry_solution_t, &
      end_of_iteration, kernel_open
   use errors, only: error_t
   use kinds, only: wp
   use tree_network, only: new_tree_network, tree_network_t
   implicit none (type, external)
   private

   public :: iterate_conjugate_gradient

   !> Rounding error of a product in single precision, over its largest value.
   real(wp), parameter :: single_noise = 2.0e-7_wp
   !> v = K p - z is recomputed when the rounding errors of its updates reach this share of the
   !> error measure.
   real(wp), parameter :: noise_share = 0.3_wp
   !> The iteration ends after this many steps in which the error has not halved.
   integer, parameter :: patience = 1000
   !> Lengths of the first and the second step, over s; later ones are predicted from those before.
   real(wp), parameter :: first_lengths(2) = [0.7_wp, 0.5_wp]
   !> A clipped change beyond twice its best length raises the energy: below this best length it is
   !> cut to the best.
   real(wp), parameter :: least_length = 0.5_wp

   !> Work space of an iteration; lists are as long as the active set.
   type :: work_t
      type(active_set_t) :: set
      type(tree_network_t) :: network
      !> v = K p - z (nx*ny).
      real(wp), allocatable :: v(:)
      !> Currents of the network; direction, then change of p; K times the last change; on the list.
      real(wp), allocatable :: s(:), q(:), kd(:)
      !> Which nodes have been beyond a bound, and what they give back.
      integer, allocatable :: loose(:)
      real(wp), allocatable :: back(:)
      !> The last change d of p (nx*ny), and the list that it is zero off.
      real(wp), allocatable :: d(:)
      integer :: old_count = 0
      integer, allocatable :: old_node(:)
      !> d.K d (0: there is no d), and K d over the last product.
      real(wp) :: curvature = 0.0_wp, scale = 0.0_wp
      !> Length of the next step along its direction, from the last one: without a last change (1)
      !> and with it.
      real(wp) :: lengths(2) = first_lengths
      !> Sum of the largest |K d| since v was recomputed.
      real(wp) :: path = 0.0_wp
   end type work_t

contains

   !> Improves the pressure of `solution` (within its bounds and with its load) until the error
   !> measure meets the tolerance, and fills the other components. Its report gets one entry per
   !> iteration. Fails (internal_error) if FFTW does.
   subroutine iterate_conjugate_gradient(problem, settings, solution, error)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_settings_t), intent(in) :: settings
      type(dry_solution_t), intent(inout) :: solution
      type(error_t), allocatable, intent(out) :: error
      type(work_t) :: work
      real(wp) :: best, noise
      integer :: iteration, stalled

      call problem%elastic%plan_single(error)
      if (allocated(error)) return
      call new_work(work, problem%grid)
      best = huge(1.0_wp)
      stalled = 0
      associate (p => solution%pressure, report => solution%report)
         call begin(problem, settings, p, work)
         do iteration = 0, settings%max_cycles
            ! the solution seems found, or the updates of v have collected too many rounding errors
            noise = single_noise*work%path/max(problem%height_scale, tiny(1.0_wp))
            if (work%path > 0.0_wp .and. .not. settings%is_rough .and. (work%set%error &
               <= settings%tolerance .or. noise > noise_share*work%set%error)) then
               call problem%find_v(p, work%v)
               work%path = 0.0_wp
               call work%set%survey(problem, p, work%v)
            end if
            call report%add(work%set%error, work%set%load_error)
            call copy_survey(work%set, settings%tolerance, solution)
            stalled = stalled + 1
            if (work%set%error < 0.5_wp*best) then
               best = work%set%error
               stalled = 0
            end if
            if (report%converged .or. stalled > patience .or. work%set%error >= huge(1.0_wp) &
               .or. iteration == settings%max_cycles) exit
            call step(problem, p, work)
         end do
      end associate
      solution%report%method = 'conjugate_gradient'
      solution%report%reason = end_of_iteration(solution%report, work%set%error, &
         settings%max_cycles, is_stalled=stalled > patience)
      call move_alloc(work%v, solution%v)
   end subroutine iterate_conjugate_gradient

   !> Allocates storage for a `grid`.
   subroutine new_work(work, grid)
      type(work_t), intent(out) :: work
      type(dry_grid_t), intent(in) :: grid
      integer :: n

      n = grid%nx*grid%ny
      call new_active_set(work%set, grid)
      call new_tree_network(work%network, [grid%nx, grid%ny], &
         [1.0_wp/grid%nx, grid%aspect/grid%ny], grid%kernel /= kernel_open)
      work%network%threads = grid%threads
      allocate (work%v(n), work%s(n), work%q(n), work%kd(n), work%old_node(n), work%loose(n), &
         work%back(n))
      allocate (work%d(n), source=0.0_wp)
   end subroutine new_work

   !> Computes v = K p - z and surveys. Single precision is enough for a guess, and for a tolerance
   !> so small that rounding errors of the updates will have v recomputed.
   subroutine begin(problem, settings, p, work)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_settings_t), intent(in) :: settings
      real(wp), contiguous, intent(in) :: p(:)
      type(work_t), intent(inout) :: work
      real(wp) :: scale

      if (settings%is_rough .or. settings%tolerance < single_noise) then
         scale = maxval(p)
         call problem%elastic%single%apply(p/scale, work%v)
         work%path = scale*maxval(abs(work%v))
         work%v = scale*work%v - problem%height
      else
         call problem%find_v(p, work%v)
      end if
      call work%set%survey(problem, p, work%v)
   end subroutine begin

   !> Makes one iteration: direction, step, return to the bounds, K times the change, and its
   !> length. The product is in single precision: it only changes v, which is recomputed from time
   !> to time.
   subroutine step(problem, p, work)
      type(dry_problem_t), intent(inout) :: problem
      real(wp), contiguous, intent(inout) :: p(:)
      type(work_t), intent(inout) :: work
      real(wp) :: change, largest, length, scale, share, total
      logical :: is_clipped
      integer :: free, k, n

      n = work%set%count
      associate (elastic => problem%elastic, node => work%set%node(:n))
         ! On the same list, trees and K d are known already.
         if (.not. is_old_list(work)) then
            if (work%curvature > 0.0_wp) call elastic%single%gather(node, work%set%begin, &
               work%scale, work%kd(:n))
            call work%network%settle(node, work%set%begin)
         end if
         call work%network%solve(work%set%residual(:n), work%s(:n))
         call find_direction(work, length)
         call find_change(problem, p, length, work, is_clipped, share)
         call elastic%single%apply_listed(node, work%set%begin, work%q(:n), scale)
         call elastic%single%gather(node, work%set%begin, scale, work%kd(:n))
         call find_length(problem, p, is_clipped, work, length)
         do k = 1, work%old_count
            work%d(work%old_node(k)) = 0.0_wp
         end do
         largest = 0.0_wp
         total = 0.0_wp
         free = 0
         do k = 1, n
            change = length*work%q(k) + (1 - length)*share   ! all of the shift
            work%d(node(k)) = change
            work%old_node(k) = node(k)
            work%kd(k) = length*work%kd(k)
            largest = max(largest, abs(work%kd(k)))
            ! within except for rounding
            p(node(k)) = min(max(p(node(k)) + change, 0.0_wp), problem%hardness)
            if (p(node(k)) > 0.0_wp .and. p(node(k)) < problem%hardness) then
               total = total + (work%kd(k) - work%set%residual(k))
               free = free + 1
            end if
         end do
      end associate
      work%old_count = n
      work%scale = length*scale
      work%path = work%path + largest
      if (free > 0) then
         call work%set%follow(problem, work%scale, total/free, p, work%v)
      else
         call problem%elastic%single%add_to(work%scale, work%v)
         call work%set%survey(problem, p, work%v)
      end if
   end subroutine step

   !> Whether F is the list of the last change.
   pure logical function is_old_list(work)
      type(work_t), intent(in) :: work

      associate (n => work%set%count)
         is_old_list = n == work%old_count
         if (is_old_list) is_old_list = all(work%old_node(:n) == work%set%node(:n))
      end associate
   end function is_old_list

   !> Computes t = s + beta (old d on F, without its mean), with t conjugate to the old d, on the
   !> list q; `length`: expected step along t.
   subroutine find_direction(work, length)
      type(work_t), intent(inout) :: work
      real(wp), intent(out) :: length
      real(wp) :: beta, descent, mean_d, overlap
      integer :: k, n

      n = work%set%count
      associate (s => work%s, q => work%q, r => work%set%residual, node => work%set%node)
         length = work%lengths(1)
         if (work%curvature > 0.0_wp) then
            length = work%lengths(2)
            mean_d = 0.0_wp
            overlap = 0.0_wp
            do k = 1, n
               q(k) = work%d(node(k))
               mean_d = mean_d + q(k)
               overlap = overlap + s(k)*work%kd(k)
            end do
            mean_d = mean_d/n
            beta = max(0.0_wp, -overlap/work%curvature)
            descent = 0.0_wp
            do k = 1, n
               q(k) = s(k) + beta*(q(k) - mean_d)
               descent = descent + q(k)*r(k)
            end do
            if (descent > 0.0_wp) return
         end if
         q(:n) = s(:n)
      end associate
   end subroutine find_direction

   !> Computes the change of p on F by `length` times t, on the list q; values that leave the bounds
   !> are returned (`is_clipped`). The shift `share` of F removes rounding errors of the load.
   subroutine find_change(problem, p, length, work, is_clipped, share)
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), intent(in) :: length
      type(work_t), intent(inout) :: work
      logical, intent(out) :: is_clipped
      real(wp), intent(out) :: share
      real(wp) :: load, total
      integer :: k, n

      n = work%set%count
      associate (q => work%q(:n), node => work%set%node(:n))
         is_clipped = .false.
         share = 0.0_wp
         total = 0.0_wp
         do k = 1, n
            q(k) = p(node(k)) + length*q(k)
            total = total + q(k)
            is_clipped = is_clipped .or. q(k) < 0.0_wp .or. q(k) > problem%hardness
         end do
         load = problem%load
         if (work%set%held > 0) load = max(load - work%set%held*problem%hardness, 0.0_wp)
         if (is_clipped) then
            call bring_back(problem%hardness, work%network, q, work%loose(:n), work%back(:n), &
               work%s(:n))
            call settle_load(problem%hardness, load, q)
            q = q - p(node)
         else
            share = (load - total)/n
            do k = 1, n
               q(k) = (q(k) + share) - p(node(k))
            end do
         end if
      end associate
   end subroutine find_change

   !> Computes the share of the change q to make: the minimum of the energy along it, within the
   !> bounds.
   subroutine find_length(problem, p, is_clipped, work, length)
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: p(:)
      logical, intent(in) :: is_clipped
      type(work_t), intent(inout) :: work
      real(wp), intent(out) :: length
      real(wp) :: best, curvature, slope
      integer :: k

      associate (n => work%set%count)
         slope = 0.0_wp
         curvature = 0.0_wp
         do k = 1, n
            slope = slope + work%set%residual(k)*work%q(k)
            curvature = curvature + work%q(k)*work%kd(k)
         end do
         best = 1.0_wp
         if (curvature > 0.0_wp) best = slope/curvature
         length = 1.0_wp
         if (.not. is_clipped) then
            associate (node => work%set%node(:n), q => work%q(:n))
               if (best > 0.0_wp .and. all(p(node) + best*q >= 0.0_wp &
                  .and. p(node) + best*q <= problem%hardness)) length = best
            end associate
         else if (best < least_length) then
            length = max(best, 0.0_wp)
         end if
         best = min(max(best, 0.25_wp), 2.0_wp)
         if (work%curvature > 0.0_wp) then
            work%lengths(2) = work%lengths(2)*best
         else
            work%lengths(1) = min(work%lengths(1)*best, first_lengths(1))
         end if
         work%curvature = length**2*curvature
      end associate
   end subroutine find_length

end module dry_conjugate_gradient

!> Newton's method for a point contact, its linear systems solved by GMRES with one multigrid cycle
!> as preconditioner.
!>
!> Unknowns are P on all nodes and H0. A node cavitates where P + r/D <= 0. The step taken is the
!> plain one, one bent where it changes the mobility by much, or a part of it: that which leaves the
!> least of the residual, as pressures r/D. (Bending always, or never, does not end for some
!> contacts.)
module point_newton
   use errors, only: error_t
   use gmres, only: gmres_t, krylov_system_t, solve_gmres
   use iteration_report, only: report_t
   use kinds, only: wp
   use listener, only: listener_t
   use mobility, only: bent_step, flowing_share
   use point_contact, only: far_pressure, point_contact_t
   use point_cycle, only: point_hierarchy_t, prepare_cycle, run_cycle
   use point_equations, only: evaluate
   use point_level, only: deflect, load_on, multiply_bands, point_level_t, set_point_film
   use text, only: to_text
   implicit none (type, external)
   private

   public :: solve_point_newton

   !> GMRES leaves this share of the residual, the first far from the solution where steps do well,
   !> after at most so many iterations.
   real(wp), parameter :: rough_tolerance = 0.03_wp, linear_tolerance = 5.0e-3_wp, &
      far_residual = 1.0e-2_wp
   integer, parameter :: most_iterations = 40
   !> A step changes no pressure by more than the first share of max(1, P), no film below the second
   !> of itself; it is halved at most so many times for that.
   real(wp), parameter :: largest_step = 0.6_wp, least_film = 0.4_wp
   integer, parameter :: max_halvings = 14
   !> The bent step is tried where the plain one leaves more than the first share of the residual,
   !> the second share of the plain one where both leave more than the third; near the solution also
   !> its square where what is left grows. (Far from it that ends beside the solution.)
   real(wp), parameter :: good_share = 0.5_wp, part_step = 0.4_wp, poor_share = 0.9_wp
   !> A residual below this, as pressures, over the load is round-off: the plain step is taken.
   real(wp), parameter :: least_measure = 1.0e-13_wp
   !> The residual may stay above the tolerance by this many times its round-off.
   real(wp), parameter :: floors = 5.0_wp
   !> The last step is solved to the first share of the tolerance on the residual, at most to the
   !> second one of the residual; pressure on the border changes by more than the third.
   real(wp), parameter :: last_share = 0.5_wp, loosest = 0.3_wp, least_change = 0.01_wp

   !> The system of one step, and how the method went.
   type, extends(krylov_system_t), public :: point_newton_t
      type(point_hierarchy_t) :: hierarchy
      type(gmres_t) :: gmres
      !> Column of H0, a cycle for it and its load; 1/D; weight of the load row.
      real(wp), allocatable, private :: column(:), answer(:), inverse(:)
      real(wp), private :: load_of_answer = 1.0_wp, weight = 1.0_wp
      real(wp), allocatable, private :: change(:), product(:)
      !> Deflection of each vector that was multiplied (n, most), and their number.
      real(wp), allocatable, private :: deflections(:, :)
      integer, private :: products = 0
      !> Whether the start is a solution: of a coarser grid, or of the time before.
      logical :: is_near = .false.
      !> Newton steps and iterations of GMRES; load error.
      integer :: steps = 0, iterations = 0
      real(wp), private :: load_error = huge(1.0_wp)
   contains
      procedure :: multiply
      procedure :: precondition
   end type point_newton_t

contains

   !> Solves the finest level from its present pressure and H0 to `tolerance` of residual and load,
   !> unless `listener` asks to stop; `report` says whether it has, and gains the steps.
   subroutine solve_point_newton(newton, contact, tolerance, max_steps, listener, report)
      type(point_newton_t), intent(inout) :: newton
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: max_steps
      class(listener_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      type(error_t), allocatable :: error
      real(wp), allocatable :: border(:, :), step(:, :)
      real(wp) :: load, residual, step_h0
      logical :: is_evaluated, is_taken

      report%converged = .false.
      report%reason = 'the start has no film'
      newton%steps = 0
      newton%iterations = 0
      newton%gmres%max_iterations = most_iterations
      associate (level => newton%hierarchy%levels(1))
         allocate (border, step, mold=level%film)
         call set_point_film(level)
         if (.not. all(level%film > 0.0_wp)) return
         is_evaluated = .false.
         do
            if (.not. is_evaluated) call evaluate(level, contact, .true.)
            call set_border(contact, level, least_change*tolerance, border)
            load = contact%load*contact%moment%load - load_beyond(contact, level)
            ! where oil flows under pressure: P + r/D > 0 inside
            level%flowing = 0.0_wp
            associate (m => level%nx - 1, n => level%ny - 1)
               level%flowing(1:m, 1:n) = merge(1.0_wp, 0.0_wp, level%pressure(1:m, 1:n) &
                  + level%residual(1:m, 1:n)/level%diagonal(1:m, 1:n) > 0.0_wp)
            end associate
            newton%load_error = load_on(level, level%pressure) - load
            residual = max(maxval(abs(level%flowing*level%residual)), maxval(abs((1 &
               - level%flowing)*(level%pressure - border))))
            if (.not. residual < huge(1.0_wp)) return
            if (newton%steps > 0) call report%add(residual, abs(newton%load_error))
            report%residual = residual
            report%load_error = abs(newton%load_error)
            call listener%on_stage(to_text(level%nx)//' x '//to_text(level%ny)//' step', &
               newton%steps + 1, [residual, newton%load_error])
            report%tolerance_effective = max(tolerance, floors*level%floor)
            report%converged = max(residual, abs(newton%load_error)/contact%ellipse%ratio) &
               < report%tolerance_effective
            report%reason = 'converged'
            if (report%converged) return
            report%reason = 'stopped from outside'
            if (listener%wants_stop()) return
            report%reason = to_text(max_steps)//' Newton steps were not enough'
            if (newton%steps >= max_steps) return
            call prepare_cycle(newton%hierarchy, contact, error)
            if (allocated(error)) then   ! an iterate that is lost
               report%reason = error%message
               return
            end if
            call find_step(newton, border, max(merge(rough_tolerance, linear_tolerance, &
               residual > far_residual .and. is_evaluated), min(loosest, last_share &
               *report%tolerance_effective/residual)), step, step_h0)
            call take_step(newton, contact, load, step, step_h0, is_taken, is_evaluated)
            report%reason = 'the film closes'
            if (.not. is_taken) return
            newton%steps = newton%steps + 1
         end do
      end associate
   end subroutine solve_point_newton

   !> The pressure that stands on the border, 0 inside; the present one if as close as `least`.
   pure subroutine set_border(contact, level, least, border)
      type(point_contact_t), intent(in) :: contact
      type(point_level_t), intent(in) :: level
      real(wp), intent(in) :: least
      real(wp), intent(out) :: border(0:, 0:)

      border = 0.0_wp
      associate (nx => level%nx, ny => level%ny, h => level%film)
         border(0, :) = far_pressure(contact, level%x(0), level%y, h(0, :))
         border(nx, :) = far_pressure(contact, level%x(nx), level%y, h(nx, :))
         border(:, 0) = far_pressure(contact, level%x, level%y(0), h(:, 0))
         border(:, ny) = far_pressure(contact, level%x, level%y(ny), h(:, ny))
      end associate
      where (border > 0.0_wp .and. abs(border - level%pressure) < least) border = level%pressure
   end subroutine set_border

   !> Load of the pressure beyond the cells of the level. Along each ray the film exceeds the rigid
   !> gap by as much as on the border; Simpson's rule over 1/distance.
   pure real(wp) function load_beyond(contact, level) result(load)
      type(point_contact_t), intent(in) :: contact
      type(point_level_t), intent(in) :: level
      real(wp) :: p(3), share(2)
      integer :: i, j

      load = 0.0_wp
      associate (nx => level%nx, ny => level%ny, cell => [level%hx, level%hy])
         do j = 0, ny
            do i = 0, nx, merge(1, nx, modulo(j, ny) == 0)
               ! a corner is half of a node of each of its sides
               share = merge(1.0_wp, 0.0_wp, modulo([i, j], [nx, ny]) == 0)
               share = share/sum(share)*cell([2, 1])
               p = far_pressure(contact, level%x(i), level%y(j), level%rigid(i, j) + [0.0_wp, &
                  0.25_wp, 1.0_wp]*(level%film(i, j) - level%rigid(i, j)))
               load = load + sum(share*abs([level%x(i), level%y(j)]))*(p(1) + 4*p(2) + p(3))/6 &
                  - 0.5_wp*sum(share*cell)*p(3)
            end do
         end do
      end associate
   end function load_beyond

   !> Computes the plain step of the pressure and of H0, to a `tolerance` of its right side; its
   !> deflection is in `newton%change`.
   subroutine find_step(newton, border, tolerance, step, step_h0)
      type(point_newton_t), intent(inout) :: newton
      real(wp), intent(in) :: border(:, :), tolerance
      real(wp), intent(out) :: step(:, :), step_h0
      real(wp), allocatable :: fixed(:), right(:), x(:)
      integer :: k, n
      logical :: is_solved

      n = size(border)
      allocate (x(n + 1), right(n))
      associate (level => newton%hierarchy%levels(1))
         newton%inverse = reshape(merge(1/level%diagonal, 1.0_wp, level%flowing > 0.0_wp), [n])
         newton%weight = 1/(level%hx*level%hy*sqrt(real(n, wp)))
         fixed = reshape((1 - level%flowing)*(border - level%pressure), [n])
         newton%product = 0*fixed
         newton%change = newton%product + 1
         newton%column = fixed   ! of this size
         call multiply_bands(level, newton%product, newton%change, newton%column)
         ! in a time step the cycles hardly change
         if (newton%steps == 0 .or. .not. level%inverse_time_step > 0.0_wp) then
            newton%answer = newton%column
            call run_cycle(newton%hierarchy, newton%column, newton%answer)
            newton%load_of_answer = load_on(level, newton%answer)
         end if
         right = 0.0_wp
         newton%change = 0.0_wp
         if (any(abs(fixed) > 0.0_wp)) then
            call deflect(level, fixed, newton%change)
            call multiply_bands(level, fixed, newton%change, right)
         end if
         right = right + reshape(level%flowing*level%residual, [n])
         x(:n) = -newton%inverse*right
         x(n + 1) = -newton%weight*(newton%load_error + load_on(level, fixed))
         if (allocated(newton%deflections)) then
            if (size(newton%deflections, 1) /= n) deallocate (newton%deflections)
         end if
         if (.not. allocated(newton%deflections)) allocate (newton%deflections(n, most_iterations))
         newton%products = 0
         right = newton%change   ! now what is fixed deflects
         call solve_gmres(newton%gmres, newton, tolerance, x, is_solved)
         newton%change = right
         do k = 1, size(newton%gmres%weights)
            newton%change = newton%change + newton%gmres%weights(k)*newton%deflections(:, k)
         end do
         newton%iterations = newton%iterations + newton%gmres%iterations
         step = reshape(x(:n) + fixed, shape(step))
         step_h0 = x(n + 1)
      end associate
   end subroutine find_step

   !> y = A x of the bordered system, rows over D.
   subroutine multiply(self, x, y)
      class(point_newton_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: y(:)
      integer :: n

      n = size(x) - 1
      associate (level => self%hierarchy%levels(1))
         self%products = self%products + 1
         associate (change => self%deflections(:, self%products))
            call deflect(level, x(:n), change)
            call multiply_bands(level, x(:n), change, self%product)
         end associate
         y(:n) = self%inverse*(self%product + x(n + 1)*self%column)
         y(n + 1) = self%weight*load_on(level, x(:n))
      end associate
   end subroutine multiply

   !> x = M x: a cycle, and the H0 that carries the load.
   subroutine precondition(self, x)
      class(point_newton_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)
      real(wp) :: displacement
      integer :: n

      n = size(x) - 1
      self%product = x(:n)/self%inverse
      call run_cycle(self%hierarchy, self%product, self%change)
      displacement = (load_on(self%hierarchy%levels(1), self%change) - x(n + 1)/self%weight) &
         /self%load_of_answer
      x(:n) = self%change - displacement*self%answer
      x(n + 1) = displacement
   end subroutine precondition

   !> Takes the best of the steps; `is_evaluated`: residual and Jacobian are there already.
   subroutine take_step(newton, contact, load, step, step_h0, is_taken, is_evaluated)
      type(point_newton_t), intent(inout) :: newton
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: load, step(0:, 0:), step_h0
      logical, intent(out) :: is_taken, is_evaluated
      real(wp), allocatable :: bent(:, :), best(:, :), best_film(:, :), film(:, :), old(:, :)
      real(wp) :: best_h0, best_measure, before, measure, old_h0

      associate (level => newton%hierarchy%levels(1))
         before = measure_of(level, load)
         old = level%pressure
         film = level%film
         old_h0 = level%rigid_displacement
         bent = step
         where (level%flowing > 0.0_wp) bent = bent_step(step, level%flow, -level%rise*level%flow, &
            flowing_share*(level%diagonal - level%flow))
         best_measure = huge(1.0_wp)
         call try_step(step, 1.0_wp, .true.)
         before = max(before, least_measure*load/good_share)
         is_evaluated = best_measure <= good_share*before
         if (is_evaluated) then
            is_taken = .true.
            return
         end if
         if (any(abs(bent - step) > 0.0_wp)) call try_step(bent, 1.0_wp, .false.)
         if (best_measure > poor_share*before) call try_step(step, part_step, .true.)
         if (newton%is_near .and. best_measure > before) call try_step(step, part_step**2, .true.)
         is_taken = best_measure < huge(1.0_wp)
         if (.not. is_taken) return
         level%pressure = best
         level%film = best_film
         level%rigid_displacement = best_h0
      end associate

   contains

      !> Measures what a step leaves, and keeps the best; `is_plain`: its deflection is known.
      subroutine try_step(change, longest, is_plain)
         real(wp), intent(in) :: change(0:, 0:), longest
         logical, intent(in) :: is_plain
         real(wp) :: share
         integer :: halving

         associate (level => newton%hierarchy%levels(1))
            share = longest*min(1.0_wp, largest_step/max(maxval(abs(change)/max(1.0_wp, old)), &
               tiny(1.0_wp)))
            do halving = 1, max_halvings
               level%pressure = old + share*change
               level%rigid_displacement = old_h0 + share*step_h0
               if (is_plain .and. all(level%pressure >= 0.0_wp)) then
                  level%film = film + share*(step_h0 + reshape(newton%change, shape(film)))
               else
                  level%pressure = max(level%pressure, 0.0_wp)
                  call set_point_film(level)
               end if
               if (all(level%film > least_film*film)) exit
               share = 0.5_wp*share
            end do
            if (halving > max_halvings) return
            call evaluate(level, contact, best_measure >= huge(1.0_wp))
            measure = measure_of(level, load)
            if (.not. measure < best_measure) return
            best_measure = measure
            best = level%pressure
            best_film = level%film
            best_h0 = level%rigid_displacement
         end associate
      end subroutine try_step

   end subroutine take_step

   !> Residual as pressures, and load error: sqrt(hx hy sum z^2) + |load error|, z = r/D, or P where
   !> P + r/D <= 0.
   pure real(wp) function measure_of(level, load) result(measure)
      type(point_level_t), intent(in) :: level
      real(wp), intent(in) :: load
      real(wp) :: z
      integer :: i, j

      measure = 0.0_wp
      do j = 1, level%ny - 1
         do i = 1, level%nx - 1
            z = level%residual(i, j)/level%diagonal(i, j)
            if (level%pressure(i, j) + z <= 0.0_wp) z = level%pressure(i, j)
            measure = measure + z**2
         end do
      end do
      measure = sqrt(measure*level%hx*level%hy) + abs(load_on(level, level%pressure) - load)
   end function measure_of

end module point_newton

!> Solves a dry contact: by closed forms where they hold, else by an iteration from a good start;
!> for a given load, or for a given datum, that is a given separation.
!>
!> Solves the contact of rough surfaces by projected steepest descent, the method of the thesis
!> (chapter 3).
!>
!> After H. M. Stanley and T. Kato, J. Tribol. 119, 1997, 481: a step along the negative gap, then a
!> shift that restores the load within the bounds. The step is the exact minimum along the
!> direction. Slow: a baseline for comparison.
module dry_contact_solver
   use active_set, only: active_set_t, copy_survey, new_active_set, survey_solution
   use dry_conjugate_gradient, only: iterate_conjugate_gradient
   use dry_problem, only: dry_problem_t, dry_settings_t, dry_solution_t, end_of_iteration, &
      kernel_open, method_conjugate_gradient, method_steepest_descent
   use dry_start, only: nested_start
   use errors, only: error_t, fail, input_error
   use iteration_report, only: report_t
   use kinds, only: int64, pi, wp
   use load_projection, only: shift_into_bounds
   use text, only: to_text
   implicit none (type, external)
   private

   public :: dry_solver_t, solve_for_datum

   !> A load that differs from hardness times area by less than this share is fully plastic.
   real(wp), parameter :: plastic_margin = 1.0e-12_wp
   !> Step from the solution for another load against its gaps, as a share of the largest wavenumber
   !> of the grid.
   real(wp), parameter :: neighbour_step = 0.3_wp

   !> A solver for one surface and any number of loads: each starts from the solution before it.
   type :: dry_solver_t
      type(dry_settings_t) :: settings
      !> Least and largest pressure of full contact without load, for the present surface; not
      !> allocated: not known yet.
      real(wp), allocatable :: full_range(:)
   contains
      procedure :: solve
   end type dry_solver_t

   !> Most solutions of one search.
   integer, parameter :: max_solves = 100
   !> The bracket is halved every this many solutions, regardless of the secant.
   integer, parameter :: halving_interval = 6
   !> Longest step in the logarithm of the load without a bracket.
   real(wp), parameter :: longest_step = log(8.0_wp)

   !> State of the search: the logarithm x of the last two loads with their misses, and the bracket.
   type :: search_t
      real(wp) :: x, x_old, miss, miss_old
      real(wp) :: low = -huge(1.0_wp), high = huge(1.0_wp)
      integer :: solves = 0
   end type search_t

contains

   !> Improves the pressure of `solution` (within its bounds and with its load) until the error
   !> measure meets the tolerance or the iterations are used up, and fills the other components.
   subroutine iterate_steepest_descent(problem, settings, solution)
      type(dry_problem_t), intent(inout) :: problem
      type(dry_settings_t), intent(in) :: settings
      type(dry_solution_t), intent(inout) :: solution
      type(active_set_t) :: set
      real(wp), allocatable :: direction(:), response(:), q(:)
      integer :: iteration, n

      n = size(solution%pressure)
      call new_active_set(set, problem%grid)
      allocate (response(n), q(n))
      allocate (direction(n), source=0.0_wp)
      associate (p => solution%pressure, report => solution%report)
         report%method = 'steepest_descent'
         do iteration = 0, settings%max_cycles
            call problem%find_v(p, solution%v)
            call set%survey(problem, p, solution%v)
            call report%add(set%error, set%load_error)
            call copy_survey(set, settings%tolerance, solution)
            if (report%converged .or. set%error >= huge(1.0_wp)) exit
            if (iteration < settings%max_cycles) call descend(problem, set, direction, response, &
               q, p)
         end do
         report%reason = end_of_iteration(report, set%error, settings%max_cycles, &
            is_stalled=.false.)
      end associate
   end subroutine iterate_steepest_descent

   !> Moves p along r less its mean on F, by the length that minimises the energy; then returns it
   !> to bounds and load.
   subroutine descend(problem, set, direction, response, q, p)
      type(dry_problem_t), intent(inout) :: problem
      type(active_set_t), intent(in) :: set
      real(wp), contiguous, intent(inout) :: direction(:), response(:), q(:), p(:)
      real(wp) :: curvature, length, load_held, slope

      associate (n => set%count, node => set%node(:set%count))
         direction = 0.0_wp
         direction(node) = set%residual(:n) - sum(set%residual(:n))/n
         call problem%elastic%apply(direction, response)
         slope = dot_product(direction(node), set%residual(:n))
         curvature = dot_product(direction(node), response(node))
         length = 0.0_wp
         if (curvature > 0.0_wp) length = slope/curvature
         q(:n) = p(node) + length*direction(node)
         load_held = 0.0_wp
         if (set%held > 0) load_held = set%held*problem%hardness
         call shift_into_bounds(q(:n), problem%hardness, max(problem%load - load_held, 0.0_wp))
         p(node) = q(:n)
      end associate
   end subroutine descend

   !> Solves `problem` (its load > 0). The start is `solution` if it holds that of another load of
   !> the same surface, or only a pressure of about this load. Its report says whether it converged.
   !> Fails (input_error) if the load is above hardness times area, (internal_error) if FFTW does.
   subroutine solve(self, problem, solution, error)
      class(dry_solver_t), intent(inout) :: self
      type(dry_problem_t), intent(inout) :: problem
      type(dry_solution_t), intent(inout) :: solution
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: largest_load
      integer :: before(4)
      logical :: is_done

      solution%report = report_t()
      solution%transforms = reshape([integer ::], [4, 0])
      if (problem%is_capped()) then
         largest_load = problem%hardness*size(problem%height)
         if (problem%load > largest_load*(1.0_wp + plastic_margin)) then
            call fail(error, input_error, 'found a mean pressure of '//to_text(problem%load &
               /largest_load)//' times the hardness, expected at most 1')
            return
         end if
         if (problem%load >= largest_load*(1.0_wp - plastic_margin)) then
            ! p = H everywhere; of the possible data that with the least plastic deformation
            solution%pressure = [spread(problem%hardness, 1, size(problem%height))]
            call problem%find_v(solution%pressure, solution%v)
            call judge(self, problem, 'all_plastic', solution, maxval(solution%v))
            return
         end if
      end if
      before = problem%elastic%transforms()
      call start(problem, solution, error)
      if (allocated(error)) return
      is_done = .false.
      if (2*count(solution%pressure > 0.0_wp) &
         > size(problem%height)) call solve_full_contact(self, problem, solution, is_done)
      if (.not. is_done) then
         select case (self%settings%method)
         case (method_conjugate_gradient)
            call iterate_conjugate_gradient(problem, self%settings, solution, error)
         case (method_steepest_descent)
            call iterate_steepest_descent(problem, self%settings, solution)
         case default
            error stop 'solve: a method without its case'
         end select
         if (allocated(error)) return
      end if
      call count_transforms(problem, before, solution)
   end subroutine solve

   !> Adds the transforms that the problem has made since `before` to those of `solution`, and sums
   !> them in pairs of its grid, those in single precision as a half.
   pure subroutine count_transforms(problem, before, solution)
      type(dry_problem_t), intent(in) :: problem
      integer, intent(in) :: before(4)
      type(dry_solution_t), intent(inout) :: solution
      real(wp) :: largest, weight
      integer :: done(4), k

      done = problem%elastic%transforms()
      largest = real(done(1), wp)*done(2)
      done(3:) = done(3:) - before(3:)
      solution%transforms = reshape([solution%transforms, done], &
         [4, size(solution%transforms, 2) + 1])
      weight = 0.0_wp
      associate (t => solution%transforms)
         do k = 1, size(t, 2)
            weight = weight + (t(3, k) + 0.5_wp*t(4, k))*(real(t(1, k), wp)*t(2, k)/largest)
         end do
      end associate
      solution%report%cost%fft_pairs = nint(weight, int64)
   end subroutine count_transforms

   !> Sets the starting pressure.
   subroutine start(problem, solution, error)
      type(dry_problem_t), intent(in) :: problem
      type(dry_solution_t), intent(inout) :: solution
      type(error_t), allocatable, intent(out) :: error

      if (solution%contacts > 0 .and. .not. allocated(solution%v)) then
         call settle_start(problem, solution%pressure)
      else if (solution%contacts > 0) then
         ! from another load: a step against the gaps
         solution%pressure = solution%pressure - neighbour_step*pi*problem%grid%nx*(solution%v &
            - solution%datum)
         call shift_into_bounds(solution%pressure, problem%hardness, problem%load)
      else
         if (.not. allocated(solution%pressure)) allocate (solution%pressure(size(problem%height)))
         call nested_start(problem, solution%pressure, solution%transforms, error)
      end if
   end subroutine start

   !> Moves the positive pressures of a guess into their bounds and to the load; all pressures, if
   !> those cannot carry it.
   subroutine settle_start(problem, p)
      type(dry_problem_t), intent(in) :: problem
      real(wp), intent(inout) :: p(:)
      real(wp), allocatable :: inside(:)
      logical, allocatable :: is_inside(:)

      is_inside = p > 0.0_wp
      inside = pack(p, is_inside)
      if (problem%load/size(inside) < problem%hardness) then
         call shift_into_bounds(inside, problem%hardness, problem%load)
         p = unpack(inside, is_inside, p)
      else
         call shift_into_bounds(p, problem%hardness, problem%load)
      end if
   end subroutine settle_start

   !> Solves full contact of a periodic surface, p = mean + K^-1 z; `is_done`: it keeps the bounds
   !> and its error the tolerance.
   subroutine solve_full_contact(self, problem, solution, is_done)
      class(dry_solver_t), intent(inout) :: self
      type(dry_problem_t), intent(inout) :: problem
      type(dry_solution_t), intent(inout) :: solution
      logical, intent(out) :: is_done
      real(wp), allocatable :: p(:)
      real(wp) :: mean_pressure

      is_done = .false.
      if (problem%grid%kernel == kernel_open) return
      mean_pressure = problem%load/size(problem%height)
      if (allocated(self%full_range)) then
         if (mean_pressure + self%full_range(1) < 0.0_wp .or. mean_pressure &
            + self%full_range(2) > problem%hardness) return
      end if
      ! K^-1 z, of mean 0, makes the surface flat.
      allocate (p(size(problem%height)))
      call problem%elastic%apply_inverse(problem%height, p)
      self%full_range = [minval(p), maxval(p)]
      if (mean_pressure + self%full_range(1) < 0.0_wp .or. mean_pressure + self%full_range(2) &
         > problem%hardness) return
      ! K of the mean is 0 except for rounding, which a large mean would bring into v
      call problem%find_v(p, solution%v)
      solution%pressure = mean_pressure + p
      call judge(self, problem, 'full_contact', solution)
      is_done = solution%report%converged
   end subroutine solve_full_contact

   !> Checks whether a closed form of that `name`, with its v and `datum` (else the mean of v), is a
   !> solution, and reports it.
   subroutine judge(self, problem, name, solution, datum)
      class(dry_solver_t), intent(in) :: self
      type(dry_problem_t), intent(in) :: problem
      character(*), intent(in) :: name
      type(dry_solution_t), intent(inout) :: solution
      real(wp), intent(in), optional :: datum

      call survey_solution(problem, self%settings%tolerance, solution, datum)
      solution%report%method = name
      solution%report%reason = 'closed form'
      if (.not. solution%report%converged) solution%report%reason = &
         end_of_iteration(solution%report, solution%kkt, 0, is_stalled=.false.)
   end subroutine judge

   !> Solves `problem` and finds its load so that the `datum` is reached within the solver's
   !> tolerance times the height scale (of a flat surface: times the depth below first touch).
   !> Elastic periodic surfaces need a `datum` < 0.
   !>
   !> The datum rises with the load, nearly linearly with its logarithm (exactly so for B. N. J.
   !> Persson's theory at light load, Phys. Rev. Lett. 99, 2007, 125502): secant steps inside a
   !> bracket, each solution started from the one before. The report sums transforms and iterations
   !> and says whether the search converged. Fails (input_error) if nothing touches, `datum` <=
   !> -max(height); (internal_error) if FFTW does.
   subroutine solve_for_datum(solver, problem, datum, solution, error)
      type(dry_solver_t), intent(inout) :: solver
      type(dry_problem_t), intent(inout) :: problem
      real(wp), intent(in) :: datum
      type(dry_solution_t), intent(inout) :: solution
      type(error_t), allocatable, intent(out) :: error
      type(search_t) :: search
      integer(int64) :: pairs
      integer :: cycles
      real(wp) :: bound

      if (datum <= -maxval(problem%height)) then
         call fail(error, input_error, 'found a separation at which nothing touches, expected '// &
            'a smaller one')
         return
      end if
      bound = solver%settings%tolerance*problem%height_scale
      if (bound <= 0.0_wp) bound = solver%settings%tolerance*(datum + maxval(problem%height))
      pairs = 0
      cycles = 0
      ! without a neighbouring solution the load of a bed of springs as stiff as the longest wave
      if (solution%contacts == 0) problem%load = 2.0_wp*pi*sum(max(problem%height + datum, 0.0_wp))
      problem%load = max(problem%load, tiny(1.0_wp))
      if (problem%is_capped()) problem%load = min(problem%load, &
         problem%hardness*size(problem%height))
      search%x = log(problem%load)
      do
         problem%load = exp(search%x)
         if (problem%is_capped()) problem%load = min(problem%load, &
            problem%hardness*size(problem%height))
         call solver%solve(problem, solution, error)
         if (allocated(error)) return
         pairs = pairs + solution%report%cost%fft_pairs
         cycles = cycles + solution%report%cycles
         search%solves = search%solves + 1
         if (.not. solution%report%converged) exit
         search%miss = solution%datum - datum
         if (problem%is_capped()) call place_between(problem, solver%settings%tolerance, datum, &
            solution, search%miss)
         if (abs(search%miss) <= bound .or. search%solves == max_solves) exit
         call find_next_load(problem, search)
         if (search%x <= search%low .or. search%x >= search%high) exit
      end do
      solution%report%cost%fft_pairs = pairs
      solution%report%cycles = cycles
      if (.not. solution%report%converged .or. abs(search%miss) <= bound) return
      solution%report%converged = .false.
      solution%report%reason = 'the separation is off by '//to_text(abs(search%miss)/bound &
         *solver%settings%tolerance, 3)//' times the rms height'
   end subroutine solve_for_datum

   !> Narrows the bracket and chooses the next load: that of an integer number of nodes at the
   !> hardness if only that is left in between, else by the secant, else the middle.
   subroutine find_next_load(problem, search)
      type(dry_problem_t), intent(in) :: problem
      type(search_t), intent(inout) :: search
      real(wp) :: step, full_nodes

      if (search%miss > 0.0_wp) then
         search%high = search%x
      else
         search%low = search%x
      end if
      step = sign(longest_step, -search%miss)
      if (search%solves > 1) then
         if (abs(search%miss - search%miss_old) > 0.0_wp) then
            step = -search%miss*(search%x - search%x_old)/(search%miss - search%miss_old)
         end if
         if (.not. step*search%miss < 0.0_wp) step = sign(longest_step, -search%miss)
         step = sign(min(abs(step), longest_step), step)
      end if
      search%x_old = search%x
      search%miss_old = search%miss
      search%x = search%x + step
      if (search%low > -huge(1.0_wp) .and. search%high < huge(1.0_wp)) then
         if (search%x <= search%low .or. search%x >= search%high .or. mod(search%solves, &
            halving_interval) == 0) then
            search%x = 0.5_wp*(search%low + search%high)
         end if
         if (.not. problem%is_capped()) return
         full_nodes = log(problem%hardness*max(1.0_wp, anint(exp(search%x)/problem%hardness)))
         if (exp(search%high) - exp(search%low) > problem%hardness) return
         if (full_nodes > search%low .and. full_nodes < search%high) search%x = full_nodes
      end if
   end subroutine find_next_load

   !> Without a node between 0 and the hardness the datum may lie anywhere between two values: sets
   !> it to the target, or to the nearer end, and `miss` to the remainder. Nodes within the
   !> `tolerance` of a bound move onto it, if that is a solution too.
   subroutine place_between(problem, tolerance, datum, solution, miss)
      type(dry_problem_t), intent(inout) :: problem
      real(wp), intent(in) :: tolerance, datum
      type(dry_solution_t), intent(inout) :: solution
      real(wp), intent(inout) :: miss
      type(dry_solution_t) :: placed
      real(wp) :: place, slack

      slack = tolerance*problem%load/solution%contacts
      if (any(solution%pressure > slack .and. solution%pressure < problem%hardness - slack)) return
      placed = solution
      associate (p => placed%pressure)
         p = merge(problem%hardness, 0.0_wp, solution%pressure > 0.5_wp*problem%hardness)
         if (abs(sum(p) - problem%load)/problem%load > tolerance) return
         call problem%find_v(p, placed%v)
         place = max(datum, maxval(placed%v, mask=p > 0.0_wp))
         if (any(p <= 0.0_wp)) place = min(place, minval(placed%v, mask=p <= 0.0_wp))
      end associate
      call survey_solution(problem, tolerance, placed, place)
      if (.not. placed%report%converged) return
      solution = placed
      miss = place - datum
   end subroutine place_between

end module dry_contact_solver

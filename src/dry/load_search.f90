!> Searches the load under which a dry contact has a given datum, that is a given separation.
module load_search
   use, intrinsic :: iso_fortran_env, only: int64
   use active_set, only: survey_solution
   use constants, only: pi
   use dry_contact_solver, only: dry_solver_t
   use dry_problem, only: dry_problem_t
   use dry_solution, only: dry_solution_t
   use errors, only: error_t, fail, input_error
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: solve_for_datum

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
      search%x = log(first_load(problem, datum, solution))
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

   !> Load of the neighbouring solution; without one that of a bed of springs as stiff as the
   !> longest wave.
   pure real(wp) function first_load(problem, datum, solution) result(load)
      type(dry_problem_t), intent(in) :: problem
      real(wp), intent(in) :: datum
      type(dry_solution_t), intent(in) :: solution

      load = problem%load
      if (solution%contacts == 0) load = 2.0_wp*pi*sum(max(problem%height + datum, 0.0_wp))
      load = max(load, tiny(1.0_wp))
      if (problem%is_capped()) load = min(load, problem%hardness*size(problem%height))
   end function first_load

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

end module load_search

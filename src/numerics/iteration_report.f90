!> What an iterative solver says about its run: whether and why it ended, its history and its cost.
!>
!> Not converging is a result with a reason, not an error: the report says it, the file keeps it.
module iteration_report
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: breakdown_t, cycle_numbers_t, ending_text, report_t

   !> Number of phases whose wall time is kept apart.
   integer, parameter, public :: phase_count = 6
   !> Index of a phase in `cost_t%phase_seconds`: kernels, levels, plans and storage.
   integer, parameter, public :: phase_setup = 1
   !> The steady solution (also the one that a transient starts from).
   integer, parameter, public :: phase_steady = 2
   !> The time steps without what the output takes.
   integer, parameter, public :: phase_transient = 3
   !> Storing time steps.
   integer, parameter, public :: phase_output = 4
   !> The coarse runs from which errors are estimated.
   integer, parameter, public :: phase_error_bars = 5
   !> The coarse runs that leave out ingredients of the model.
   integer, parameter, public :: phase_adequacy = 6
   !> Names of the phases, in the order of their index.
   character(len=*), parameter, public :: phase_names(phase_count) = &
      [character(len=10) :: 'setup', 'steady', 'transient', 'output', 'error_bars', &
      'adequacy']

   !> Films below the floor of the film: how often, where the first one was, the smallest of all.
   !> Dimensionless.
   type :: breakdown_t
      !> Solutions (time steps) with a film below the floor.
      integer :: count = 0
      !> Whether the present one is.
      logical :: is_now = .false.
      !> The first of them: time step, T, X of its smallest film, of a point contact Y, that film.
      integer :: step = 0
      real(wp) :: time = 0.0_wp, position = 0.0_wp, across = 0.0_wp, film = 0.0_wp
      !> Smallest film of all of them.
      real(wp) :: smallest_film = huge(1.0_wp)
   end type breakdown_t

   !> Numbers of a method. Zero: chosen by the program; in a report: not used.
   type :: cycle_numbers_t
      !> Bound on the residuals and the load error [-].
      real(wp) :: tolerance = 0.0_wp
      !> Largest number of cycles for one solution (of each time step).
      integer :: max_cycles = 0
      !> Grid levels, the finest counted.
      integer :: levels = 0
      !> Smoothing sweeps before and after the coarse-grid correction, and on the coarsest level
      !> where it is not solved exactly.
      integer :: pre_sweeps = 0, post_sweeps = 0, coarse_sweeps = 0
      !> Under-relaxation of the smoother, 0 < relaxation <= 1, and of the force balance [-].
      real(wp) :: relaxation = 0.0_wp, load_relaxation = 0.0_wp
   end type cycle_numbers_t

   !> What a solve has cost.
   type :: cost_t
      !> Pairs of forward and backward transforms.
      integer(int64) :: fft_pairs = 0_int64
      !> Sweeps, each weighted by its share of the nodes of the finest level [-].
      real(wp) :: work_units = 0.0_wp
      !> Wall time of the whole solve, and by phase, see `phase_names` [s].
      real(wp) :: wall_seconds = 0.0_wp, phase_seconds(phase_count) = 0.0_wp
      !> Most memory of the process [bytes]; 0: not told.
      real(wp) :: peak_memory = 0.0_wp
   end type cost_t

   !> How well domain, grid and time step fit the contact.
   type :: fit_t
      !> Relative errors of the film thickness and of the largest pressure because the domain ends
      !> at its inlet [-].
      real(wp) :: inlet_error = 0.0_wp, inlet_pressure_error = 0.0_wp
      !> Largest P of the last node before the outlet over all solutions; above 0 the outlet cuts
      !> the film off [-].
      real(wp) :: outlet_pressure = 0.0_wp
      !> How often the program has moved the outlet out before a passage.
      integer :: outlet_moves = 0
      !> Nodes of the grid in the finest wave of the surfaces, steps in which the finest moving one
      !> passes a place; huge: there is none.
      real(wp) :: nodes_per_wave = huge(1.0_wp), steps_per_wave = huge(1.0_wp)
      !> Steps of the start that were not cut, because their parts had no solution: less accurate
      !> there.
      integer :: uncut_steps = 0
   end type fit_t

   !> Outcomes of a run.
   character(*), parameter, public :: has_converged = 'converged', &
      has_not_converged = 'not converged', is_outside = 'outside the model: mixed'

   !> Residual and load error of the cycles (or iterations) on the finest level, those of time steps
   !> included.
   type :: cycle_history_t
      !> How many there were.
      integer :: cycles = 0
      !> Last residual: max |r|/lambda over P > 0 and of max(r, 0)/lambda where P = 0 [-].
      real(wp) :: residual = huge(1.0_wp)
      !> Last |dX sum P - pi/2| [-].
      real(wp) :: load_error = huge(1.0_wp)
      !> Both after each cycle (2, history_size or more).
      real(wp), allocatable, private :: history(:, :)
      integer, private :: history_size = 0
   contains
      procedure :: add, load_error_history, residual_history, restore
   end type cycle_history_t

   !> Outcome, history and cost of one solve.
   type, extends(cycle_history_t) :: report_t
      !> Residual and load error are below `tolerance_effective` (of the last solve, and of every
      !> time step).
      logical :: converged = .false.
      !> The equations are solved, but asperities carry load that they do not contain.
      logical :: is_mixed = .false.
      !> Why the solver ended; 'converged', what stood in the way, or why the model does not hold.
      character(:), allocatable :: reason
      !> Method that was used, 'auto' resolved, and its numbers, in a transient those of the time
      !> steps.
      character(:), allocatable :: method
      type(cycle_numbers_t) :: numbers
      type(cost_t) :: cost
      type(fit_t) :: fit
      !> Films below the floor.
      type(breakdown_t) :: breakdown
      !> What the reader of the result should know about it; not allocated: nothing.
      character(:), allocatable :: note
      !> Time steps done.
      integer :: steps = 0
      !> max(tolerance, 5 x round-off floor of the residual) [-].
      real(wp) :: tolerance_effective = 0.0_wp
   contains
      procedure :: outcome
   end type report_t

contains

   !> The outcome of a run.
   pure function outcome(self)
      class(report_t), intent(in) :: self
      character(:), allocatable :: outcome

      outcome = has_not_converged
      if (self%converged) outcome = has_converged
      if (self%converged .and. self%is_mixed) outcome = is_outside
   end function outcome

   !> An `outcome` with its `reason`, which names it where a run is outside the model.
   pure function ending_text(outcome, reason) result(words)
      character(*), intent(in) :: outcome, reason
      character(:), allocatable :: words

      words = outcome
      if (outcome == is_outside) words = reason
      if (outcome == has_not_converged) words = 'NOT CONVERGED: '//reason
   end function ending_text

   !> Appends one cycle: `residual` and `load_error` [-] become the last ones, `cycles` grows by
   !> one. Storage doubles when full.
   pure subroutine add(self, residual, load_error)
      class(cycle_history_t), intent(inout) :: self
      real(wp), intent(in) :: residual, load_error

      if (.not. allocated(self%history)) allocate (self%history(2, 32))
      if (self%history_size == size(self%history, 2)) self%history = reshape([self%history, &
         self%history], [2, 2*self%history_size])
      self%history_size = self%history_size + 1
      self%history(:, self%history_size) = [residual, load_error]
      self%residual = residual
      self%load_error = load_error
      self%cycles = self%cycles + 1
   end subroutine add

   !> The residual after each cycle (history_size) [-].
   pure function residual_history(self) result(history)
      class(cycle_history_t), intent(in) :: self
      real(wp), allocatable :: history(:)

      allocate (history(self%history_size))
      if (self%history_size > 0) history = self%history(1, :self%history_size)
   end function residual_history

   !> The load error after each cycle (history_size) [-].
   pure function load_error_history(self) result(history)
      class(cycle_history_t), intent(in) :: self
      real(wp), allocatable :: history(:)

      allocate (history(self%history_size))
      if (self%history_size > 0) history = self%history(2, :self%history_size)
   end function load_error_history

   !> Takes over `residuals` and `load_errors` [-], one each a cycle; `cycles` becomes their number.
   pure subroutine restore(self, residuals, load_errors)
      class(cycle_history_t), intent(inout) :: self
      real(wp), intent(in) :: residuals(:), load_errors(:)
      integer :: i

      self%history_size = 0
      self%cycles = 0
      do i = 1, size(residuals)
         call self%add(residuals(i), load_errors(i))
      end do
   end subroutine restore

end module iteration_report

!> What an iterative solver says about its run: whether and why it ended, its history and its cost.
!>
!> Not converging is a result with a reason, not an error: the report says it, the file keeps it.
module iteration_report
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: breakdown_t, report_t

   !> Number of phases whose wall time is kept apart.
   integer, parameter, public :: phase_count = 6
   !> Index of a phase in `report_t%phase_seconds`: kernels, levels, plans and storage.
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
      !> The first of them: time step, T, X of its smallest film, that film.
      integer :: step = 0
      real(wp) :: time = 0.0_wp, position = 0.0_wp, film = 0.0_wp
      !> Smallest film of all of them.
      real(wp) :: smallest_film = huge(1.0_wp)
   end type breakdown_t

   !> Outcome, history and cost of one solve.
   type :: report_t
      !> Residual and load error are below `tolerance_effective` (of the last solve, and of every
      !> time step).
      logical :: converged = .false.
      !> Why the solver ended; 'converged', or what stood in the way.
      character(:), allocatable :: reason
      !> Method that was used, 'auto' resolved.
      character(:), allocatable :: method
      !> What the method used, in a transient that of the time steps: bounds, sweeps,
      !> under-relaxation; 0: not used by it.
      real(wp) :: tolerance = 0.0_wp, relaxation = 0.0_wp, load_relaxation = 0.0_wp
      integer :: max_cycles = 0, pre_sweeps = 0, post_sweeps = 0, coarse_sweeps = 0
      !> Films below the floor.
      type(breakdown_t) :: breakdown
      !> Nodes of the grid in the finest wave of the surfaces, steps in which the finest moving one
      !> passes a place; huge: there is none.
      real(wp) :: nodes_per_wave = huge(1.0_wp), steps_per_wave = huge(1.0_wp)
      !> What the reader of the result should know about it; not allocated: nothing.
      character(:), allocatable :: note
      !> Cycles (or iterations) on the finest level, time steps included.
      integer :: cycles = 0
      !> Grid levels, the finest counted.
      integer :: levels = 0
      !> Time steps done.
      integer :: steps = 0
      !> Steps of the start that were taken whole, because their parts had no solution: less
      !> accurate there.
      integer :: uncut_steps = 0
      !> Last residual: max |r|/lambda over P > 0 and of max(r, 0)/lambda where P = 0 [-].
      real(wp) :: residual = huge(1.0_wp)
      !> Last |dX sum P - pi/2| [-].
      real(wp) :: load_error = huge(1.0_wp)
      !> max(tolerance, 5 x round-off floor of the residual) [-].
      real(wp) :: tolerance_effective = 0.0_wp
      !> Relative error of the film thickness because the domain ends at its inlet [-].
      real(wp) :: inlet_error = 0.0_wp
      !> The same of the largest pressure.
      real(wp) :: inlet_pressure_error = 0.0_wp
      !> Largest P of the last node before the outlet over all solutions; above 0 the outlet cuts
      !> the film off [-].
      real(wp) :: outlet_pressure = 0.0_wp
      !> Pairs of forward and backward transforms.
      integer(int64) :: fft_pairs = 0_int64
      !> Sweeps, each weighted by its share of the nodes of the finest level [-].
      real(wp) :: work_units = 0.0_wp
      !> Wall time of the whole solve [s].
      real(wp) :: wall_seconds = 0.0_wp
      !> Most memory of the process [bytes]; 0: not told.
      real(wp) :: peak_memory = 0.0_wp
      !> Wall time by phase [s], see `phase_names`.
      real(wp) :: phase_seconds(phase_count) = 0.0_wp
      !> Entries of the history in use; the two arrays below may be longer.
      integer :: history_size = 0
      real(wp), allocatable, private :: residuals(:)
      real(wp), allocatable, private :: load_errors(:)
   contains
      !> Appends one cycle to the history and counts it.
      procedure :: add
      !> Residual after each cycle (history_size) [-].
      procedure :: residual_history
      !> Load error after each cycle (history_size) [-].
      procedure :: load_error_history
      !> Takes over a history that was kept, in place of the present one.
      procedure :: restore
   end type report_t

contains

   !> Appends one cycle: `residual` and `load_error` [-] become the last ones, `cycles` grows by
   !> one. Storage doubles when full.
   pure subroutine add(self, residual, load_error)
      class(report_t), intent(inout) :: self
      real(wp), intent(in) :: residual, load_error

      if (.not. allocated(self%residuals)) allocate (self%residuals(32), self%load_errors(32))
      if (self%history_size == size(self%residuals)) then
         self%residuals = [self%residuals, self%residuals]
         self%load_errors = [self%load_errors, self%load_errors]
      end if
      self%history_size = self%history_size + 1
      self%residuals(self%history_size) = residual
      self%load_errors(self%history_size) = load_error
      self%residual = residual
      self%load_error = load_error
      self%cycles = self%cycles + 1
   end subroutine add

   !> The residual after each cycle (history_size) [-].
   pure function residual_history(self) result(history)
      class(report_t), intent(in) :: self
      real(wp), allocatable :: history(:)

      allocate (history(self%history_size))
      if (self%history_size > 0) history = self%residuals(:self%history_size)
   end function residual_history

   !> The load error after each cycle (history_size) [-].
   pure function load_error_history(self) result(history)
      class(report_t), intent(in) :: self
      real(wp), allocatable :: history(:)

      allocate (history(self%history_size))
      if (self%history_size > 0) history = self%load_errors(:self%history_size)
   end function load_error_history

   !> Takes over `residuals` and `load_errors` [-], one each a cycle; `cycles` becomes their number.
   pure subroutine restore(self, residuals, load_errors)
      class(report_t), intent(inout) :: self
      real(wp), intent(in) :: residuals(:), load_errors(:)
      integer :: i

      self%history_size = 0
      self%cycles = 0
      do i = 1, size(residuals)
         call self%add(residuals(i), load_errors(i))
      end do
   end subroutine restore

end module iteration_report

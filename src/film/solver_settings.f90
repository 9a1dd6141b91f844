!> Choices of the caller for the numerical solution: domain, time steps, method.
!>
!> Plain records without behaviour. A value of zero (or below) means "chosen by the program"; words
!> are lower case.
module solver_settings
   use iteration_report, only: cycle_numbers_t
   use kinds, only: wp
   use march_state, only: march_state_t
   implicit none (type, external)
   private

   public :: domain_t, leaves_scheme, max_chosen, max_intervals_of, solver_settings_t, &
      time_settings_t

   !> Most intervals with method = 'newton_dense', a matrix of 0.5 GB and about a minute a step, and
   !> with 'block_jacobi', which converges on no more than some hundred and reports failure only
   !> after 40 blocks of 200 sweeps or more.
   integer, parameter, public :: max_small_intervals = 8192
   !> Default bound on the residuals and the load error: of a steady solution, and of a time step.
   real(wp), parameter, public :: steady_tolerance = 1.0e-8_wp, step_tolerance = 1.0e-6_wp
   !> Most intervals of a grid that the program refines until it is good enough.
   integer, parameter, public :: max_refined_intervals = 2**20

   !> Length of the words below.
   integer, parameter, public :: word_length = 24

   !> The computational domain, x_inlet <= X <= x_outlet, in half-widths.
   type :: domain_t
      !> Inlet [half-widths], below -1; used only with `has_inlet`.
      real(wp) :: x_inlet = 0.0_wp
      !> Outlet [half-widths], above the end of the contact; used only with `has_outlet`.
      real(wp) :: x_outlet = 0.0_wp
      !> Whether the inlet is given; else the program chooses it from the regime.
      logical :: has_inlet = .false.
      !> Whether the outlet is given; else the program chooses it from the regime.
      logical :: has_outlet = .false.
      !> Grid intervals on the finest grid, 2^k or 3, 5, 7 times that; 0: chosen by the program.
      integer :: intervals = 0
      !> Kind of its nodes, 'even', 'graded' (module graded_solver; steady only) or, until
      !> `choose_domain`, 'auto'. The intervals of a graded grid are known when it is solved.
      character(len=word_length) :: grid = 'even'
      !> Whether the smooth steady pressure lies in front of the inlet (module inlet_tail); in time.
      logical :: has_tail = .false.
      !> Whether the outlet is the program's, which moves it out if it cuts off the film.
      logical :: may_lengthen = .false.
      !> Whether the program chose the inlet and the number of intervals.
      logical :: inlet_is_chosen = .false., intervals_are_chosen = .false.
      !> Of a point contact: half of its width [half-widths], intervals across.
      real(wp) :: y_half_width = 0.0_wp
      integer :: rows = 0
   end type domain_t

   !> Steady or in time, and the steps. Time is dimensionless, T = t u_s/(2 b).
   type :: time_settings_t
      !> Whether to solve a transient from the smooth steady solution at T = 0.
      logical :: is_transient = .false.
      !> End of the transient [-].
      real(wp) :: end_time = 0.0_wp
      !> Time step [-]; zero: dX of the grid.
      real(wp) :: time_step = 0.0_wp
      !> 'bdf2' (second order), 'backward_euler' (first order, as in the thesis) or 'quasi_steady'
      !> (no squeeze term: the steady contact of each moment).
      character(len=word_length) :: scheme = 'bdf2'
      !> T from which the quantities and the statistics of the film count; below 0: chosen by the
      !> program.
      real(wp) :: statistics_from = -1.0_wp
      !> Largest error of a part of a step, relative to the film; zero: parts are given.
      real(wp) :: tolerance = 0.0_wp
      !> Beyond the end the duty is repeated until the film of a cycle repeats that of the last.
      logical :: may_lengthen = .false.
      !> State from which an interrupted transient resumes; not allocated: it begins at T = 0.
      type(march_state_t), allocatable :: resume_from
   end type time_settings_t

   !> The method of solution and its parameters; tolerance zero: `steady_tolerance`, in time steps
   !> `step_tolerance`.
   type, extends(cycle_numbers_t) :: solver_settings_t
      !> 'auto', 'newton_krylov', 'newton_dense', 'fas_block_jacobi' or 'block_jacobi' (one level).
      character(len=word_length) :: method = 'auto'
      !> 'auto', 'block_jacobi', 'gauss_seidel', 'line' or 'hybrid'.
      character(len=word_length) :: smoother = 'auto'
      !> Space discretisation (module reynolds_line): 'upwind2', that of the thesis, or 'kappa',
      !> which needs a Newton method; 'auto': upwind2, but kappa if coarse runs choose the
      !> resolution of a transient, or where surfaces come to rest.
      character(len=word_length) :: space_scheme = 'auto'
      !> Relative error of h_min, on a graded grid of all quantities, for which the grid of a steady
      !> contact is chosen; zero: the domain's grid.
      real(wp) :: target = 0.0_wp
      !> The nested start solves n/2 and n/4 intervals of a steady contact well enough for error
      !> bars.
      logical :: wants_coarse_runs = .false.
      !> Most intervals that fit into memory.
      integer :: max_intervals = huge(1)
      !> After a failure, try finer grids to find out whether the grid is the reason.
      logical :: explains_failure = .true.
      !> First guess: 'fmg' (full multigrid) or 'hertz' (Hertz pressure on the finest grid).
      character(len=word_length) :: start = 'fmg'
      !> Film H below which there is a breakdown; zero: only if the film closes.
      real(wp) :: film_floor = 0.0_wp
      !> At a breakdown: 'stop', not converged, or 'continue', with a mark. A film that closes
      !> always stops.
      character(len=word_length) :: on_film_breakdown = 'stop'
   end type solver_settings_t

contains

   !> Whether the program chooses the space scheme, and the method solves both.
   pure logical function leaves_scheme(settings)
      type(solver_settings_t), intent(in) :: settings

      leaves_scheme = settings%space_scheme == 'auto' .and. settings%smoother == 'auto' &
         .and. index(settings%method, 'block_jacobi') == 0
   end function leaves_scheme

   !> Most intervals of a method, whether the user or the program chooses them; huge: no limit.
   pure integer function max_intervals_of(method) result(most)
      character(*), intent(in) :: method

      most = huge(most)
      if (method == 'newton_dense' .or. method == 'block_jacobi') most = max_small_intervals
   end function max_intervals_of

   !> Most intervals that the program chooses, refines to, or tries.
   pure integer function max_chosen(settings) result(most)
      type(solver_settings_t), intent(in) :: settings

      most = min(max_refined_intervals, max_intervals_of(settings%method), settings%max_intervals)
   end function max_chosen

end module solver_settings

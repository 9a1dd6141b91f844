!> What a caller may choose about the numerical solution: domain, time steps, method.
!>
!> Plain records without behaviour. A value of zero (or below) means "chosen by the program"; words
!> are lower case.
module solver_settings
   use iteration_report, only: cycle_numbers_t
   use kinds, only: wp
   use march_state, only: march_state_t
   implicit none (type, external)
   private

   public :: domain_t, max_chosen, max_intervals_of, solver_settings_t, time_settings_t

   !> Most intervals with method = 'newton_dense', a matrix of 0.5 GB and about a minute a step, and
   !> with 'block_jacobi', which converges on no more than some hundred and notices that it does not
   !> after 40 blocks of 200 sweeps at least.
   integer, parameter, public :: max_small_intervals = 8192
   !> Bound on the residuals and the load error where none is given: of a steady solution, and of a
   !> time step.
   real(wp), parameter, public :: steady_tolerance = 1.0e-8_wp, step_tolerance = 1.0e-6_wp
   !> No grid that the program refines until it is good enough has more intervals.
   integer, parameter, public :: max_refined_intervals = 2**20

   !> Length of the words below.
   integer, parameter, public :: word_length = 24

   !> The computational domain, x_inlet <= X <= x_outlet, in half-widths.
   type :: domain_t
      !> Inlet [half-widths], below -1; used only with `has_inlet`.
      real(wp) :: x_inlet = 0.0_wp
      !> Outlet [half-widths], above the end of the contact; used only with `has_outlet`.
      real(wp) :: x_outlet = 0.0_wp
      !> False: the program chooses the inlet from the regime.
      logical :: has_inlet = .false.
      !> False: the program chooses the outlet from the regime.
      logical :: has_outlet = .false.
      !> Grid intervals on the finest grid, 2^k or 3, 5, 7 times that; 0: chosen by the program.
      integer :: intervals = 0
      !> In front of the inlet: 'zero', no pressure, or 'tail', what module inlet_tail finds (steady
      !> only); 'auto': chosen.
      character(len=word_length) :: inlet = 'zero'
      !> True: the outlet is the program's, which moves it out where it cuts the film off.
      logical :: may_lengthen = .false.
      !> True: so is the inlet; what is in front of it; the number of intervals.
      logical :: inlet_is_chosen = .false., front_is_chosen = .false., &
         intervals_are_chosen = .false.
   end type domain_t

   !> Steady or in time, and the steps. Time is dimensionless, T = t u_s/(2 b).
   type :: time_settings_t
      !> True: a transient from the smooth steady solution at T = 0.
      logical :: is_transient = .false.
      !> End of the transient [-].
      real(wp) :: end_time = 0.0_wp
      !> Time step [-]; zero: dX of the grid.
      real(wp) :: time_step = 0.0_wp
      !> 'bdf2' (second order) or 'backward_euler' (first order, the thesis's).
      character(len=word_length) :: scheme = 'bdf2'
      !> T from which the quantities and the statistics of the film count; below 0: chosen by
      !> the program.
      real(wp) :: statistics_from = -1.0_wp
      !> Where an interrupted transient goes on; not allocated: it begins at T = 0.
      type(march_state_t), allocatable :: resume_from
   end type time_settings_t

   !> The method of solution and its numbers; tolerance zero: `steady_tolerance`, in time steps
   !> `step_tolerance`.
   type, extends(cycle_numbers_t) :: solver_settings_t
      !> 'auto', 'newton_krylov', 'newton_dense', 'fas_block_jacobi' or 'block_jacobi' (one level).
      character(len=word_length) :: method = 'auto'
      !> 'auto', 'block_jacobi', 'gauss_seidel', 'line' or 'hybrid'.
      character(len=word_length) :: smoother = 'auto'
      !> Space discretisation (module reynolds_line): 'upwind2', that of the thesis, or 'kappa',
      !> which needs a Newton method; 'auto': upwind2, but kappa where coarse runs choose the
      !> resolution of a transient.
      character(len=word_length) :: space_scheme = 'auto'
      !> Relative error of h_min for which the grid of a steady contact is chosen; zero: the grid is
      !> that of the domain.
      real(wp) :: target = 0.0_wp
      !> The same of p_max; zero: its error does not count.
      real(wp) :: target_p_max = 0.0_wp
      !> The grids of n/2 and n/4 intervals on the way to a steady solution are solved well enough
      !> for error bars.
      logical :: wants_coarse_runs = .false.
      !> Most intervals that there is memory for.
      integer :: max_intervals = huge(1)
      !> After a failure: finer grids are tried, to learn whether the grid is the reason.
      logical :: explains_failure = .true.
      !> First guess: 'fmg' (full multigrid) or 'hertz' (Hertz pressure on the finest grid).
      character(len=word_length) :: start = 'fmg'
      !> A film below this is a breakdown, H; zero: only a film that closes.
      real(wp) :: film_floor = 0.0_wp
      !> At a breakdown: 'stop', as not converged, or 'continue', with a mark. A film that closes
      !> always stops.
      character(len=word_length) :: on_film_breakdown = 'stop'
   end type solver_settings_t

contains

   !> Most intervals that a method is given, by the user or by the program; huge: as many as there
   !> can be.
   pure function max_intervals_of(method) result(most)
      character(*), intent(in) :: method
      integer :: most

      most = huge(most)
      if (method == 'newton_dense' .or. method == 'block_jacobi') most = max_small_intervals
   end function max_intervals_of

   !> Most intervals that the program chooses by itself, refines to, or tries.
   pure function max_chosen(settings) result(most)
      type(solver_settings_t), intent(in) :: settings
      integer :: most

      most = min(max_refined_intervals, max_intervals_of(settings%method), settings%max_intervals)
   end function max_chosen

end module solver_settings

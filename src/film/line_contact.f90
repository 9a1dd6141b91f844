!> The lubricated line contact in dimensionless form, all data of (2.57)-(2.64) of the thesis, and
!> the choices of the caller for its numerical solution: domain, time steps, method.
!>
!> Choices are plain records. A value of zero (or below) means "chosen by the program"; words are
!> lower case.
module line_contact
   use asperities, only: asperities_t
   use duty, only: duty_t
   use errors, only: error_t
   use features, only: displacement, rough_surface_t
   use film_heating, only: heating_t
   use iteration_report, only: cycle_numbers_t
   use kinds, only: pi, wp
   use lubricant, only: fluid_t
   use march_state, only: march_state_t
   use profile, only: load_window
   implicit none (type, external)
   private

   public :: closing_slope, domain_t, finest_wave, inlet_tail_t, intervals_for_waves, &
      leaves_scheme, line_contact_t, max_chosen, max_intervals_of, move_profiles, rough_contact_t, &
      shortest_passage, smoothen, smoothen_both, solver_settings_t, time_settings_t, &
      without_surfaces

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
      !> The smooth steady pressure lies in front of the inlet (module line_hierarchy); in time.
      logical :: has_tail = .false.
      !> Whether the outlet is the program's, which moves it out if it cuts off the film, and how
      !> often it has.
      logical :: may_lengthen = .false.
      integer :: moves = 0
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

   !> Fewest intervals in the finest wave (feature, sinusoid, profile): with fewer, coarse runs on
   !> n/4 may miss it.
   integer, parameter, public :: min_in_wave = 16
   !> A surface with |dX/dT| below this is at rest; one without waves has this wavelength [b].
   real(wp), parameter :: slow = 1.0e-6_wp, longest = 1.0e9_wp

   !> Pressure in front of the domain, at rising nodes that end in it (module line_hierarchy).
   type :: inlet_tail_t
      real(wp), allocatable :: x(:), pressure(:)
   end type inlet_tail_t

   !> What line and point contacts have: the oil, where they are solved, the surfaces that pass.
   type :: rough_contact_t
      !> Speed parameter lambda [-], > 0: of a line contact (2.55), corrected:
      !> 6 u_s R^2 mu_0/(p_h b^3).
      real(wp) :: lambda = 0.0_wp
      !> Moes lubricant parameter L, SUM velocity [-].
      real(wp) :: moes_l_sum = 0.0_wp
      !> Scaled lubricant laws.
      type(fluid_t) :: fluid
      !> Scaled surfaces: heights in b^2/R, lengths in b, speeds dX/dT.
      type(rough_surface_t) :: surface_1, surface_2
      !> Domain in half-widths; complete after `choose_domain`.
      type(domain_t) :: domain
      !> Slide-to-roll ratio 2 (u2 - u1)/(u1 + u2) [-], positive if surface 2 is faster; NaN: speeds
      !> not known. Shear stresses need it, the solver does not.
      real(wp) :: slide_to_roll = 0.0_wp
      !> Half-width of the dry contact along X [b]; central film to be expected of a point contact.
      real(wp) :: half_length = 1.0_wp, expected_film = 0.0_wp
      !> Load, radius and speeds over time; lambda, the fluid, M and L are then those of the
      !> reference state. Not allocated: constant.
      type(duty_t), allocatable :: duty
   end type rough_contact_t

   !> Data of one dimensionless contact.
   type, extends(rough_contact_t) :: line_contact_t
      !> Moes load parameter M, SUM velocity [-].
      real(wp) :: moes_m_sum = 0.0_wp
      !> Oil is conserved in cavities, and what arrives per u1 + u2 at most (module reynolds_line).
      logical :: conserves_oil = .false.
      real(wp) :: supply = huge(1.0_wp)
      !> Rough surfaces whose asperities touch; not allocated: none do.
      type(asperities_t), allocatable :: asperities
      !> The heat of sliding warms film and surfaces; not allocated: they stay as cold as the inlet.
      type(heating_t), allocatable :: heating
      !> What lies in front of it, if the domain has a tail and it is known.
      type(inlet_tail_t), allocatable :: tail
      !> Fraction of the deformation of the bodies: 1, all of it; 0, rigid bodies; between, bodies
      !> stiffer by its inverse.
      real(wp) :: elasticity = 1.0_wp
      !> b/R; where it is not known that of steel at 1 GPa.
      real(wp) :: slope = 0.02_wp
   end type line_contact_t

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

   !> Intervals from which the three grids n, n/2 and n/4 resolve every wave of the surfaces; 1 if
   !> they are smooth. The domain must be complete.
   pure integer function intervals_for_waves(contact) result(intervals)
      class(rough_contact_t), intent(in) :: contact

      intervals = ceiling(min(min_in_wave*(contact%domain%x_outlet - contact%domain%x_inlet) &
         /max(finest_wave(contact), 1.0e-9_wp), 1.0e9_wp))
   end function intervals_for_waves

   !> Shortest wavelength of both surfaces [b]; huge if they are smooth.
   pure real(wp) function finest_wave(contact) result(wave)
      class(rough_contact_t), intent(in) :: contact

      wave = min(wave_of(contact%surface_1), wave_of(contact%surface_2))
   end function finest_wave

   !> Slope by which the features of both surfaces close the film as they pass: for each surface the
   !> steepest one, 2 pi A/wavelength, times its speed relative to the flow, |1 - dX/dT|; profiles,
   !> whose slopes differ, are left out.
   pure real(wp) function closing_slope(contact) result(slope)
      class(rough_contact_t), intent(in) :: contact

      slope = slope_of(contact%surface_1) + slope_of(contact%surface_2)

   contains

      !> The same of one surface.
      pure real(wp) function slope_of(surface) result(slope)
         type(rough_surface_t), intent(in) :: surface

         slope = 0.0_wp
         if (.not. allocated(surface%features)) return
         if (size(surface%features) == 0) return
         slope = 2*pi*abs(1 - surface%speed)*maxval(abs(surface%features%amplitude) &
            /surface%features%wavelength)
      end function slope_of

   end function closing_slope

   !> Time T in which the finest wave of a moving surface passes a point; above 1e9: none.
   pure real(wp) function shortest_passage(contact) result(time)
      class(rough_contact_t), intent(in) :: contact

      time = minval(min([wave_of(contact%surface_1), wave_of(contact%surface_2)], longest) &
         /max(abs([contact%surface_1%speed, contact%surface_2%speed]), slow))
   end function shortest_passage

   !> Shortest wavelength of a surface [b]; huge if it is smooth.
   pure real(wp) function wave_of(surface) result(wave)
      type(rough_surface_t), intent(in) :: surface

      wave = huge(1.0_wp)
      if (allocated(surface%features)) wave = minval([wave, surface%features%wavelength, &
         pack(surface%features%wavelength_y, surface%features%wavelength_y > 0.0_wp)])
      if (allocated(surface%profile)) wave = min(wave, surface%profile%finest_wave)
   end function wave_of

   !> The contact with smooth surfaces.
   pure function without_surfaces(contact) result(smooth)
      type(line_contact_t), intent(in) :: contact
      type(line_contact_t) :: smooth

      smooth = contact
      call smoothen_both(smooth)
   end function without_surfaces

   !> Removes features and profiles from both surfaces.
   pure subroutine smoothen_both(contact)
      class(rough_contact_t), intent(inout) :: contact

      call smoothen(contact%surface_1)
      call smoothen(contact%surface_2)
   end subroutine smoothen_both

   !> Removes features and profile from a surface.
   pure subroutine smoothen(surface)
      type(rough_surface_t), intent(inout) :: surface

      if (allocated(surface%profile)) deallocate (surface%profile)
      if (allocated(surface%features)) deallocate (surface%features)
      allocate (surface%features(0))
   end subroutine smoothen

   !> Loads the part of both profiles that covers a complete domain at `time`. Error: a file cannot
   !> be read.
   subroutine move_profiles(contact, time, error)
      class(rough_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: time
      type(error_t), allocatable, intent(out) :: error

      associate (ends => [contact%domain%x_inlet, contact%domain%x_outlet], &
         one => contact%surface_1, two => contact%surface_2)
         if (allocated(one%profile)) call load_window(one%profile, ends(1) - displacement(one, &
            time), ends(2) - displacement(one, time), error)
         if (allocated(error)) return
         if (allocated(two%profile)) call load_window(two%profile, ends(1) - displacement(two, &
            time), ends(2) - displacement(two, time), error)   ! error: the caller looks
      end associate
   end subroutine move_profiles

end module line_contact

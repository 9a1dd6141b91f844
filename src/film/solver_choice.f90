!> From the words of the settings to the way the cycle relaxes, and what is tried next when it does
!> not converge.
module solver_choice
   use cycle_limits, only: cycle_limits_t
   use dense_jacobian, only: dense_jacobian_t
   use domain_choice, only: intervals_for_film
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: line_hierarchy_t, method_block_jacobi, method_fas, &
      method_newton_dense, method_newton_krylov, relaxation_t, smoother_block_jacobi, &
      smoother_gauss_seidel, smoother_hybrid, smoother_line
   use semiseparable_jacobian, only: semiseparable_jacobian_t
   use solver_settings, only: solver_settings_t
   use text, only: to_text
   use rheology, only: slide_to_roll, thins
   implicit none (type, external)
   private

   public :: steady_attempts, time_step_attempts, adopt, limits_of, method_name, note_choice

   !> A contact that sliding does not thin is heavy above one of these (sum velocity): full steps of
   !> any smoother then overshoot at the spike or in the inlet.
   real(wp), parameter :: heavy_m = 4.0_wp, heavy_l = 12.0_wp
   !> Factor from which the Eyring stress is lowered where nothing else works.
   real(wp), parameter :: high_stress = 16.0_wp
   !> Slide-to-roll ratio from which an Eyring contact is not heavy.
   real(wp), parameter :: thinning_slide = 0.25_wp
   !> An Eyring contact with L (sum velocity) above this is started from a thin film.
   real(wp), parameter :: thinning_l = 2.0_wp
   !> Up to this many intervals the dense Newton method solves the coarsest level of a cycle, and is
   !> the last resort of 'auto' in a time step.
   integer, parameter :: largest_dense = 512

contains

   !> The ways to try in turn for a steady contact (measured: theory page, section on the methods).
   !> A stated smoother whose relaxation is left to the program goes on with gentler sweeps.
   pure function steady_attempts(contact, settings) result(attempts)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), allocatable :: attempts(:)
      real(wp) :: films(2)
      logical :: is_heavy

      films = start_films(contact)
      is_heavy = (contact%moes_m_sum >= heavy_m .or. contact%moes_l_sum >= heavy_l) &
         .and. .not. is_thinned(contact)
      if (is_automatic(settings)) then
         attempts = newton_starts(contact, films)
         if (contact%domain%intervals >= intervals_for_film(contact) &
            .and. settings%space_scheme /= 'kappa') then
            attempts = [attempts, last_resort(is_heavy, films(1))]
         end if
      else if (settings%method == 'newton_krylov') then
         attempts = newton_starts(contact, films)
      else
         attempts = [stated_way(settings, is_heavy)]
         if (attempts(1)%method == method_fas .and. settings%relaxation <= 0.0_wp &
            .and. settings%max_cycles <= 0) attempts = &
            [attempts, gentler(stated_way(settings, is_heavy=.true.), 0.2_wp, 10)]
         attempts%start_film = films(1)
      end if
      if (settings%space_scheme == 'kappa') then
         attempts = [attempts(1), attempts]
         attempts(2:)%thesis_first = .true.
      end if
      ! with a given limit of cycles there is no time stepping to a start, which takes many
      if (settings%max_cycles > 0) attempts = pack(attempts, .not. attempts%follows_time)
      call override(settings, attempts)
   end function steady_attempts

   !> Whether sliding thins the oil: an Eyring oil without sliding is as stiff as a Newtonian one.
   !> (Case 1, Gauss-Seidel and line: full steps fail on 1024 intervals up to a slide-to-roll ratio
   !> of 0.1, steps relaxed as for Newtonian contacts do not; from 0.3 on both do it.)
   pure function is_thinned(contact)
      type(line_contact_t), intent(in) :: contact
      logical :: is_thinned

      is_thinned = thins(contact%fluid)
      if (is_thinned) is_thinned = slide_to_roll(contact%fluid, contact%lambda) >= thinning_slide
   end function is_thinned

   !> A way that shares nothing with Newton's method above the coarsest level: the cycle with its
   !> better smoother.
   pure function last_resort(is_heavy, start_film) result(choice)
      logical, intent(in) :: is_heavy
      real(wp), intent(in) :: start_film
      type(relaxation_t) :: choice

      if (is_heavy) then
         choice = gauss_seidel(.true.)
      else
         choice = line(.false.)
      end if
      choice%start_film = start_film
   end function last_resort

   !> The ways of Newton-Krylov to a first solution: from both films, from a higher Eyring stress,
   !> in pseudo-time.
   pure function newton_starts(contact, films) result(attempts)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: films(2)
      type(relaxation_t), allocatable :: attempts(:)
      type(relaxation_t) :: in_time

      in_time = newton_krylov(films(1))
      in_time%follows_time = .true.
      attempts = [newton_krylov(films(1)), newton_krylov(films(2))]
      if (thins(contact%fluid)) attempts = [attempts, newton_krylov(films(1), high_stress)]
      attempts = [attempts, in_time]
   end function newton_starts

   !> Films of the first start over the Moes film, the better one first: a thin film of constant
   !> viscosity starts from twice the fit, shear thinning with a steep rise of viscosity from the
   !> fit (docs/decisions.md).
   pure function start_films(contact) result(films)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: films(2)

      films = [2.0_wp, 1.0_wp]
      if (thins(contact%fluid) .and. contact%moes_l_sum > thinning_l) films = [1.0_wp, 2.0_wp]
   end function start_films

   !> Newton-Krylov from a start film, and from a higher Eyring stress.
   pure function newton_krylov(start_film, first_stress) result(choice)
      real(wp), intent(in) :: start_film
      real(wp), intent(in), optional :: first_stress
      type(relaxation_t) :: choice

      choice = one_level(method_newton_krylov)
      choice%start_film = start_film
      if (present(first_stress)) choice%first_stress = first_stress
   end function newton_krylov

   !> The ways to try in turn for a time step; no line smoother, it diverges with the squeeze term.
   !>
   !> Where the viscosity is high enough for squeeze and wedge to outweigh the diffusion, the
   !> equation of a step is H(P) = given: a sweep with the own share K_0 of the kernel only changes
   !> long waves of P by up to n/10 times too much, and the cycle diverges unless the coarse grids
   !> get the better of that. So stated smoothers go on with a larger own share, less relaxation and
   !> more sweeps.
   pure function time_step_attempts(contact, settings) result(attempts)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), allocatable :: attempts(:)

      if (is_automatic(settings)) then
         attempts = [one_level(method_newton_krylov), gauss_seidel_in_time(0.6_wp, 3), &
            w_cycle(gauss_seidel_in_time(0.5_wp, 5))]
         if (settings%space_scheme == 'kappa') attempts = attempts(:1)
         if (contact%domain%intervals <= largest_dense) attempts = [attempts, &
            one_level(method_newton_dense)]
      else if (settings%smoother == 'gauss_seidel') then
         attempts = [gauss_seidel_in_time(0.8_wp, 2)]
      else
         attempts = [stated_way(settings, is_heavy=.true.)]
      end if
      if (size(attempts) == 1 .and. attempts(1)%method == method_fas &
         .and. settings%relaxation <= 0.0_wp) attempts = &
         [attempts, gentler(attempts(1), 0.4_wp, 3), gentler(attempts(1), 0.2_wp, 5), &
            gentler(attempts(1), 0.1_wp, 8), &
         gentler(attempts(1), 0.05_wp, 12)]
      call override(settings, attempts)
   end function time_step_attempts

   !> The same with the own share of the kernel taken as at least 3 dX/pi, less relaxation and more
   !> sweeps.
   pure function gentler(base, relaxation, sweeps) result(choice)
      type(relaxation_t), intent(in) :: base
      real(wp), intent(in) :: relaxation
      integer, intent(in) :: sweeps
      type(relaxation_t) :: choice

      choice = base
      choice%relaxation = relaxation
      choice%pre_sweeps = sweeps
      choice%post_sweeps = sweeps
      choice%kernel_bound = 3.0_wp
   end function gentler

   !> True where neither method nor smoother is stated.
   pure function is_automatic(settings) result(automatic)
      type(solver_settings_t), intent(in) :: settings
      logical :: automatic

      automatic = settings%method == 'auto' .and. settings%smoother == 'auto'
   end function is_automatic

   !> The way that method and smoother of the settings name; 'auto' with a smoother is the cycle
   !> with it.
   pure function stated_way(settings, is_heavy) result(choice)
      type(solver_settings_t), intent(in) :: settings
      logical, intent(in) :: is_heavy
      type(relaxation_t) :: choice

      select case (settings%method)
      case ('block_jacobi')
         choice = one_level(method_block_jacobi)
      case ('newton_dense')
         choice = one_level(method_newton_dense)
      case ('newton_krylov')
         choice = one_level(method_newton_krylov)
      case default
         select case (settings%smoother)
         case ('gauss_seidel')
            choice = gauss_seidel(is_heavy)
         case ('line')
            choice = line(is_heavy)
         case ('hybrid')
            choice = hybrid(is_heavy)
         case default
            choice = block_jacobi(is_heavy)
         end select
      end select
   end function stated_way

   !> Makes the hierarchy follow a way: coarsest level of its cycles, and how its Newton steps are
   !> solved.
   subroutine adopt(hierarchy, choice)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(relaxation_t), intent(in) :: choice
      logical :: is_large

      if (allocated(hierarchy%newton%linear) &
         .and. hierarchy%relaxation%method == choice%method) then
         hierarchy%relaxation = choice
         return
      end if
      hierarchy%relaxation = choice
      hierarchy%coarsest = merge(hierarchy%fas_coarsest, hierarchy%finest, &
         choice%method == method_fas)
      if (allocated(hierarchy%newton%linear)) deallocate (hierarchy%newton%linear)
      is_large = hierarchy%levels(hierarchy%coarsest)%n > largest_dense
      if (choice%method == method_newton_krylov .or. (choice%method == method_fas &
         .and. is_large)) then
         allocate (semiseparable_jacobian_t :: hierarchy%newton%linear)
      else
         allocate (dense_jacobian_t :: hierarchy%newton%linear)
      end if
   end subroutine adopt

   !> The cycle with Block-Jacobi sweeps. H is relaxed with P (thesis) where that converges, and
   !> recomputed before each sweep where the contact is heavy.
   pure function block_jacobi(is_heavy) result(choice)
      logical, intent(in) :: is_heavy
      type(relaxation_t) :: choice

      choice%smoother = smoother_block_jacobi
      choice%pre_sweeps = merge(5, 3, is_heavy)
      choice%post_sweeps = choice%pre_sweeps
      choice%relaxation = merge(0.5_wp, 0.8_wp, is_heavy)
      choice%kernel_bound = merge(3.0_wp, 0.0_wp, is_heavy)
      choice%film_is_recomputed = is_heavy
   end function block_jacobi

   !> Gauss-Seidel downstream, film recomputed before each sweep.
   pure function gauss_seidel(is_heavy) result(choice)
      logical, intent(in) :: is_heavy
      type(relaxation_t) :: choice

      choice%smoother = smoother_gauss_seidel
      choice%pre_sweeps = merge(5, 2, is_heavy)
      choice%post_sweeps = choice%pre_sweeps
      choice%relaxation = merge(0.6_wp, 1.0_wp, is_heavy)
   end function gauss_seidel

   !> Gauss-Seidel for time steps.
   pure function gauss_seidel_in_time(relaxation, sweeps) result(choice)
      real(wp), intent(in) :: relaxation
      integer, intent(in) :: sweeps
      type(relaxation_t) :: choice

      choice%smoother = smoother_gauss_seidel
      choice%pre_sweeps = sweeps
      choice%post_sweeps = sweeps
      choice%relaxation = relaxation
      choice%kernel_bound = 0.0_wp
   end function gauss_seidel_in_time

   !> Projected tridiagonal line.
   pure function line(is_heavy) result(choice)
      logical, intent(in) :: is_heavy
      type(relaxation_t) :: choice

      choice%smoother = smoother_line
      choice%pre_sweeps = merge(5, 1, is_heavy)
      choice%post_sweeps = choice%pre_sweeps
      choice%relaxation = merge(0.6_wp, 1.0_wp, is_heavy)
   end function line

   !> Line before, Gauss-Seidel after the coarse-grid correction.
   pure function hybrid(is_heavy) result(choice)
      logical, intent(in) :: is_heavy
      type(relaxation_t) :: choice

      choice = line(is_heavy)
      choice%smoother = smoother_hybrid
      if (.not. is_heavy) choice%relaxation = 0.9_wp
   end function hybrid

   !> The same with two visits to each coarser level.
   pure function w_cycle(base) result(choice)
      type(relaxation_t), intent(in) :: base
      type(relaxation_t) :: choice

      choice = base
      choice%visits = 2
   end function w_cycle

   !> One level: blocks of Block-Jacobi sweeps with the force balance relaxed after each, or single
   !> Newton steps.
   pure function one_level(method) result(choice)
      integer, intent(in) :: method
      type(relaxation_t) :: choice

      choice = block_jacobi(.false.)
      choice%method = method
      choice%relaxation = 0.7_wp
      choice%coarse_sweeps = merge(200, 0, method == method_block_jacobi)
   end function one_level

   !> What the user gave wins.
   pure elemental subroutine override(settings, choice)
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), intent(inout) :: choice

      if (settings%pre_sweeps > 0) choice%pre_sweeps = settings%pre_sweeps
      if (settings%post_sweeps > 0) choice%post_sweeps = settings%post_sweeps
      if (settings%relaxation > 0.0_wp) choice%relaxation = settings%relaxation
      if (settings%load_relaxation > 0.0_wp) choice%load_relaxation = settings%load_relaxation
      if (settings%coarse_sweeps > 0 .and. (choice%method == method_fas &
         .or. choice%method == method_block_jacobi)) then
         choice%coarse_sweeps = settings%coarse_sweeps
      end if
   end subroutine override

   !> Cycle limits: what the settings say, else by method. Plain Block-Jacobi counts blocks of
   !> sweeps and needs many; the residual of a Newton iteration may rise for long while a spike
   !> grows.
   pure function limits_of(settings, tolerance, method) result(limits)
      type(solver_settings_t), intent(in) :: settings
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: method
      type(cycle_limits_t) :: limits

      limits%tolerance = tolerance
      if (settings%tolerance > 0.0_wp) limits%tolerance = settings%tolerance
      select case (method)
      case (method_block_jacobi)
         limits%max_cycles = 2000
         limits%patience = 40
      case (method_newton_krylov, method_newton_dense)
         limits%max_cycles = 120
         limits%patience = 40
      case default
         continue
      end select
      if (settings%max_cycles > 0) limits%max_cycles = settings%max_cycles
   end function limits_of

   !> Writes into the report what a way uses.
   pure subroutine note_choice(report, choice, limits)
      type(report_t), intent(inout) :: report
      type(relaxation_t), intent(in) :: choice
      type(cycle_limits_t), intent(in) :: limits

      report%method = method_name(choice)
      report%tolerance = limits%tolerance
      report%max_cycles = limits%max_cycles
      report%pre_sweeps = merge(choice%pre_sweeps, 0, choice%method == method_fas)
      report%post_sweeps = merge(choice%post_sweeps, 0, choice%method == method_fas)
      report%coarse_sweeps = choice%coarse_sweeps
      report%relaxation = merge(choice%relaxation, 0.0_wp, choice%method == method_fas &
         .or. choice%method == method_block_jacobi)
      report%load_relaxation = merge(choice%load_relaxation, 0.0_wp, choice%coarse_sweeps > 0)
   end subroutine note_choice

   !> Short name of a way, e.g. `fas gauss_seidel V(2,2)`.
   pure function method_name(choice) result(name)
      type(relaxation_t), intent(in) :: choice
      character(:), allocatable :: name
      character(len=12), parameter :: smoothers(4) = &
         [character(len=12) :: 'block_jacobi', 'gauss_seidel', 'line', 'hybrid']
      character(len=13), parameter :: methods(4) = &
         [character(len=13) :: 'fas', 'block_jacobi', 'newton_dense', 'newton_krylov']

      name = trim(methods(choice%method))
      if (choice%method == method_fas) name = name//' '//trim(smoothers(choice%smoother))//' '// &
         merge('W', 'V', choice%visits > 1)//'('//to_text(choice%pre_sweeps)//',' &
            //to_text(choice%post_sweeps)//')'
   end function method_name

end module solver_choice

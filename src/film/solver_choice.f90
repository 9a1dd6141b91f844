!> Translates the settings into the relaxation of the cycles, and lists what to try next if they do
!> not converge.
module solver_choice
   use dense_jacobian, only: dense_jacobian_t
   use domain_choice, only: intervals_for_film
   use iteration_report, only: cycle_numbers_t, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, solver_settings_t, steady_tolerance, step_tolerance
   use line_hierarchy, only: is_newton, line_hierarchy_t, method_block_jacobi, method_fas, &
      method_newton_dense, method_newton_krylov, relaxation_t, smoother_block_jacobi, &
      smoother_gauss_seidel, smoother_line
   use semiseparable_jacobian, only: semiseparable_jacobian_t
   use text, only: to_text
   use lubricant, only: slide_to_roll, thins
   implicit none (type, external)
   private

   public :: steady_attempts, time_step_attempts, adopt, method_name, note_choice

   !> A contact without shear thinning is heavy above one of these (sum velocity): full steps of any
   !> smoother then overshoot at the spike or in the inlet.
   real(wp), parameter :: heavy_m = 4.0_wp, heavy_l = 12.0_wp
   !> Slide-to-roll ratio from which an Eyring contact is not heavy. (Case 1, Gauss-Seidel and line
   !> on 1024 intervals: full steps fail up to 0.1; from 0.3 on full and relaxed steps both
   !> converge.)
   real(wp), parameter :: thinning_slide = 0.25_wp
   !> Above this L (sum velocity) an Eyring contact starts from a thin film.
   real(wp), parameter :: thinning_l = 2.0_wp
   !> Most intervals with which the dense Newton method solves the coarsest level of a cycle, and is
   !> the last resort of 'auto' in a time step.
   integer, parameter :: largest_dense = 512
   !> Default limit of cycles of a time step.
   integer, parameter :: default_step_cycles = 40

   !> Names of the methods and smoothers, by their constants; as in the settings, except for FAS.
   character(len=13), parameter :: methods(4) = &
      [character(len=13) :: 'fas', 'block_jacobi', 'newton_dense', 'newton_krylov']
   character(len=12), parameter :: smoothers(4) = &
      [character(len=12) :: 'block_jacobi', 'gauss_seidel', 'line', 'hybrid']

contains

   !> Relaxations to try in turn for a steady contact (measured: theory page, section on the
   !> methods). A given smoother without a given relaxation continues with gentler sweeps.
   pure function steady_attempts(contact, settings) result(attempts)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), allocatable :: attempts(:)
      real(wp) :: film
      logical :: is_heavy

      ! film of the first start over the Moes film: a thin film of constant viscosity starts from
      ! twice the fit, shear thinning with a steep rise of viscosity from the fit
      ! (docs/decisions.md)
      film = merge(1.0_wp, 2.0_wp, thins(contact%fluid) .and. contact%moes_l_sum > thinning_l)
      ! an Eyring oil without sliding is as stiff as a Newtonian one
      is_heavy = contact%moes_m_sum >= heavy_m .or. contact%moes_l_sum >= heavy_l
      if (is_heavy .and. thins(contact%fluid)) is_heavy = &
         slide_to_roll(contact%fluid, contact%lambda) < thinning_slide
      if (is_automatic(settings) .or. settings%method == 'newton_krylov') then
         attempts = spread(one_level(method_newton_krylov), 1, 2)
         attempts(2)%starts_graded = .true.
         ! the cycle is independent of Newton's method above the coarsest level
         if (all([is_automatic(settings), contact%domain%intervals >= intervals_for_film(contact), &
            settings%space_scheme /= 'kappa'])) attempts = [attempts, &
            cycle_with(merge(smoother_gauss_seidel, smoother_line, is_heavy), is_heavy)]
      else
         attempts = [stated_way(settings, is_heavy)]
         if (attempts(1)%method == method_fas .and. settings%relaxation <= 0.0_wp &
            .and. settings%max_cycles <= 0) attempts = [attempts, &
            with_sweeps(stated_way(settings, is_heavy=.true.), 0.2_wp, 10, 3.0_wp)]
      end if
      attempts%start_film = film
      if (contact%conserves_oil) attempts = pack(attempts, attempts%method &
         == method_newton_krylov)
      if (allocated(contact%asperities)) attempts = attempts(:1)
      if (settings%space_scheme == 'kappa') then
         attempts = [attempts(1), attempts]
         attempts(2:)%thesis_first = .true.
      end if
      call override(settings, steady_tolerance, attempts)
   end function steady_attempts

   !> Relaxations to try in turn for a time step; no line smoother, which diverges with the squeeze
   !> term. All have the limits of the first. `has_parts`: a step that Newton's method does not
   !> solve is shortened, not relaxed for seconds.
   !>
   !> If the viscosity is high enough for squeeze and wedge to outweigh the diffusion, the equation
   !> of a step is H(P) = given: a sweep with only the diagonal K_0 of the kernel changes long waves
   !> of P by up to n/10 times too much, and the cycle diverges unless the coarse grids correct
   !> that. So given smoothers continue with a larger diagonal, at least 3 dX/pi, less relaxation
   !> and more sweeps.
   pure function time_step_attempts(contact, settings, has_parts) result(attempts)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      logical, intent(in) :: has_parts
      type(relaxation_t), allocatable :: attempts(:)
      type(relaxation_t) :: base

      base = cycle_with(smoother_gauss_seidel, is_heavy=.true.)
      if (is_automatic(settings)) then
         attempts = [one_level(method_newton_krylov), with_sweeps(base, 0.6_wp, 3, 0.0_wp), &
            with_sweeps(base, 0.5_wp, 5, 0.0_wp)]
         attempts(3)%visits = 2
         if (settings%space_scheme == 'kappa') then
            attempts = attempts([1, 1])
            attempts(2)%thesis_first = .true.
         end if
         if (contact%domain%intervals <= largest_dense) attempts = [attempts, &
            one_level(method_newton_dense)]
         if (contact%conserves_oil .or. has_parts) attempts = pack(attempts, attempts%method &
            == method_newton_krylov)
      else if (settings%smoother == 'gauss_seidel') then
         attempts = [with_sweeps(base, 0.8_wp, 2, 0.0_wp)]
      else
         attempts = [stated_way(settings, is_heavy=.true.)]
      end if
      if (size(attempts) == 1 .and. attempts(1)%method == method_fas &
         .and. settings%relaxation <= 0.0_wp) then
         base = attempts(1)
         attempts = [base, with_sweeps(base, 0.4_wp, 3, 3.0_wp), with_sweeps(base, 0.2_wp, 5, &
            3.0_wp), with_sweeps(base, 0.1_wp, 8, 3.0_wp), with_sweeps(base, 0.05_wp, 12, 3.0_wp)]
      end if
      attempts%max_cycles = min(attempts(1)%max_cycles, default_step_cycles)
      attempts%patience = attempts(1)%patience
      call override(settings, step_tolerance, attempts)
   end function time_step_attempts

   !> Whether neither method nor smoother is given.
   pure logical function is_automatic(settings) result(automatic)
      type(solver_settings_t), intent(in) :: settings

      automatic = settings%method == 'auto' .and. settings%smoother == 'auto'
   end function is_automatic

   !> Relaxation given by method and smoother of the settings; 'auto' with a smoother is the cycle
   !> with it.
   pure function stated_way(settings, is_heavy) result(choice)
      type(solver_settings_t), intent(in) :: settings
      logical, intent(in) :: is_heavy
      type(relaxation_t) :: choice
      integer :: method

      method = findloc(methods == settings%method, .true., 1)
      if (method > method_fas) then
         choice = one_level(method)
      else
         choice = cycle_with(max(findloc(smoothers == settings%smoother, .true., 1), &
            smoother_block_jacobi), is_heavy)
      end if
   end function stated_way

   !> Applies a relaxation to the hierarchy: coarsest level of its cycles, and solver of its Newton
   !> steps.
   subroutine adopt(hierarchy, choice)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(relaxation_t), intent(in) :: choice
      logical :: is_present

      is_present = allocated(hierarchy%newton%linear) &
         .and. hierarchy%relaxation%method == choice%method
      hierarchy%relaxation = choice
      if (is_present) return
      hierarchy%coarsest = merge(hierarchy%fas_coarsest, hierarchy%finest, &
         choice%method == method_fas)
      if (allocated(hierarchy%newton%linear)) deallocate (hierarchy%newton%linear)
      if (choice%method == method_newton_krylov .or. (choice%method == method_fas &
         .and. hierarchy%levels(hierarchy%coarsest)%n > largest_dense)) then
         allocate (semiseparable_jacobian_t :: hierarchy%newton%linear)
      else
         allocate (dense_jacobian_t :: hierarchy%newton%linear)
      end if
   end subroutine adopt

   !> Cycle with a smoother, with less relaxation and more sweeps for a heavy contact. Block-Jacobi
   !> relaxes H with P (thesis) where that converges; for a heavy contact H is recomputed before
   !> each sweep, as with the others.
   pure function cycle_with(smoother, is_heavy) result(choice)
      integer, intent(in) :: smoother
      logical, intent(in) :: is_heavy
      type(relaxation_t) :: choice
      integer, parameter :: light_sweeps(4) = [3, 2, 1, 1], heavy_sweeps = 5
      real(wp), parameter :: light_relaxation(4) = [0.8_wp, 1.0_wp, 1.0_wp, 0.9_wp], &
         heavy_relaxation(4) = [0.5_wp, 0.6_wp, 0.6_wp, 0.6_wp]

      choice%smoother = smoother
      choice%max_cycles = 60
      choice%load_relaxation = 0.05_wp
      choice%pre_sweeps = merge(heavy_sweeps, light_sweeps(smoother), is_heavy)
      choice%post_sweeps = choice%pre_sweeps
      choice%relaxation = merge(heavy_relaxation(smoother), light_relaxation(smoother), is_heavy)
      choice%film_is_recomputed = is_heavy .or. smoother /= smoother_block_jacobi
      if (.not. choice%film_is_recomputed) choice%kernel_bound = 0.0_wp
   end function cycle_with

   !> The same with another relaxation, other numbers of sweeps and another bound of the kernel.
   pure function with_sweeps(base, relaxation, sweeps, kernel_bound) result(choice)
      type(relaxation_t), intent(in) :: base
      real(wp), intent(in) :: relaxation
      integer, intent(in) :: sweeps
      real(wp), intent(in) :: kernel_bound
      type(relaxation_t) :: choice

      choice = base
      choice%relaxation = relaxation
      choice%pre_sweeps = sweeps
      choice%post_sweeps = sweeps
      choice%kernel_bound = kernel_bound
   end function with_sweeps

   !> One level: blocks of Block-Jacobi sweeps with the force balance relaxed after each, many of
   !> which are needed, or single Newton steps, whose residual may rise for long while a spike
   !> grows.
   pure function one_level(method) result(choice)
      integer, intent(in) :: method
      type(relaxation_t) :: choice

      choice = cycle_with(smoother_block_jacobi, is_heavy=.false.)
      choice%method = method
      choice%relaxation = 0.7_wp
      choice%coarse_sweeps = merge(200, 0, method == method_block_jacobi)
      choice%max_cycles = merge(2000, 120, method == method_block_jacobi)
      choice%patience = 40
   end function one_level

   !> Applies the user's values; `tolerance` is the default.
   pure elemental subroutine override(settings, tolerance, choice)
      type(solver_settings_t), intent(in) :: settings
      real(wp), intent(in) :: tolerance
      type(relaxation_t), intent(inout) :: choice

      choice%tolerance = merge(settings%tolerance, tolerance, settings%tolerance > 0.0_wp)
      if (settings%max_cycles > 0) choice%max_cycles = settings%max_cycles
      if (settings%pre_sweeps > 0) choice%pre_sweeps = settings%pre_sweeps
      if (settings%post_sweeps > 0) choice%post_sweeps = settings%post_sweeps
      if (settings%relaxation > 0.0_wp) choice%relaxation = settings%relaxation
      if (settings%load_relaxation > 0.0_wp) choice%load_relaxation = settings%load_relaxation
      if (settings%coarse_sweeps > 0 .and. .not. is_newton(choice)) choice%coarse_sweeps = &
         settings%coarse_sweeps
   end subroutine override

   !> Writes the parameters of a relaxation into the report.
   pure subroutine note_choice(report, choice)
      type(report_t), intent(inout) :: report
      type(relaxation_t), intent(in) :: choice

      report%method = method_name(choice)
      associate (numbers => report%numbers, is_fas => choice%method == method_fas)
         numbers = cycle_numbers_t(choice%tolerance, choice%max_cycles, numbers%levels, &
            merge(choice%pre_sweeps, 0, is_fas), merge(choice%post_sweeps, 0, is_fas), &
            choice%coarse_sweeps, merge(0.0_wp, choice%relaxation, is_newton(choice)), &
            merge(choice%load_relaxation, 0.0_wp, choice%coarse_sweeps > 0))
      end associate
   end subroutine note_choice

   !> Short name of a relaxation, e.g. `fas gauss_seidel V(2,2)`.
   pure function method_name(choice) result(name)
      type(relaxation_t), intent(in) :: choice
      character(:), allocatable :: name

      name = trim(methods(choice%method))
      if (choice%method == method_fas) name = name//' '//trim(smoothers(choice%smoother))//' '// &
         merge('W', 'V', choice%visits > 1)//'('//to_text(choice%pre_sweeps)//',' &
            //to_text(choice%post_sweeps)//')'
   end function method_name

end module solver_choice

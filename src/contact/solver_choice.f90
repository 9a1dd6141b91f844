!> From the words of the settings to the way the cycle relaxes, and what is tried next when it does not converge.
module solver_choice
   use dense_jacobian, only: dense_jacobian_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: relaxation_t, smoother_block_jacobi, smoother_gauss_seidel, smoother_hybrid, smoother_line
   use linear_solver, only: linear_solver_t
   use semiseparable_jacobian, only: semiseparable_jacobian_t
   use solver_settings, only: solver_settings_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: steady_attempts, time_step_attempts, is_one_level, is_newton, choose_linear_solver, method_name

   !> A Newtonian contact is heavy above one of these (sum velocity): full steps of any smoother then overshoot at the
   !> spike or in the inlet.
   real(wp), parameter :: heavy_m = 4.0_wp, heavy_l = 12.0_wp

contains

   !> The ways to try in turn for a steady contact (measured: theory page, section on the cycle).
   pure function steady_attempts(contact, settings) result(attempts)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), allocatable :: attempts(:)
      logical :: is_heavy
      integer :: i

      is_heavy = (contact%moes_m_sum >= heavy_m .or. contact%moes_l_sum >= heavy_l) .and. .not. contact%fluid%is_eyring
      if (is_one_level(settings)) then
         attempts = [one_level(settings)]
      else
         select case (settings%smoother)
         case ("block_jacobi")
            attempts = [block_jacobi(is_heavy)]
         case ("gauss_seidel")
            attempts = [gauss_seidel(is_heavy)]
         case ("line")
            attempts = [line(is_heavy)]
         case ("hybrid")
            attempts = [hybrid(is_heavy)]
         case default
            if (settings%method == "fas_block_jacobi") then
               attempts = [block_jacobi(is_heavy)]
            else if (is_heavy) then
               attempts = [gauss_seidel(.true.), line(.true.), w_cycle(gauss_seidel(.true.)), w_cycle(line(.true.))]
            else
               attempts = [line(.false.), gauss_seidel(.true.), line(.true.), w_cycle(gauss_seidel(.true.))]
            end if
         end select
      end if
      do i = 1, size(attempts)
         call override(settings, attempts(i))
      end do
   end function steady_attempts

   !> The ways to try in turn for a time step: Gauss-Seidel, as the line smoother diverges with the squeeze term.
   pure function time_step_attempts(contact, settings) result(attempts)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), allocatable :: attempts(:)
      integer :: i

      if (settings%method == "auto" .and. settings%smoother == "auto") then
         attempts = [gauss_seidel_in_time(0.8_wp, 2), gauss_seidel_in_time(0.6_wp, 3), w_cycle(gauss_seidel_in_time(0.5_wp, 5))]
         do i = 1, size(attempts)
            call override(settings, attempts(i))
         end do
      else if (settings%smoother == "gauss_seidel") then
         attempts = [gauss_seidel_in_time(0.8_wp, 2)]
         call override(settings, attempts(1))
      else
         attempts = steady_attempts(contact, settings)
      end if
   end function time_step_attempts

   !> True for the methods that use no coarse grid but in the start: plain Block-Jacobi and the Newton methods.
   pure function is_one_level(settings) result(one)
      type(solver_settings_t), intent(in) :: settings
      logical :: one

      one = settings%method == "block_jacobi" .or. is_newton(settings)
   end function is_one_level

   !> True for the Newton methods.
   pure function is_newton(settings) result(newton)
      type(solver_settings_t), intent(in) :: settings
      logical :: newton

      newton = settings%method == "newton_dense" .or. settings%method == "newton_krylov"
   end function is_newton

   !> How Newton steps are solved: by LAPACK, on the coarsest grid of the cycles too, or in O(n log n).
   subroutine choose_linear_solver(settings, linear)
      type(solver_settings_t), intent(in) :: settings
      class(linear_solver_t), allocatable, intent(out) :: linear

      if (settings%method == "newton_krylov") then
         allocate (semiseparable_jacobian_t :: linear)
      else
         allocate (dense_jacobian_t :: linear)
      end if
   end subroutine choose_linear_solver

   !> Block-Jacobi: H relaxed with P (thesis) where that converges, recomputed before each sweep where the contact is heavy.
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

   !> One level: blocks of Block-Jacobi sweeps with the force balance relaxed after each, or single Newton steps.
   pure function one_level(settings) result(choice)
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t) :: choice

      choice = block_jacobi(.false.)
      choice%relaxation = 0.7_wp
      choice%coarse_sweeps = 200
      if (is_newton(settings)) then
         choice%coarse_sweeps = 0
         choice%coarse_steps = 1
      end if
   end function one_level

   !> What the user gave wins.
   pure subroutine override(settings, choice)
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), intent(inout) :: choice

      if (settings%pre_sweeps > 0) choice%pre_sweeps = settings%pre_sweeps
      if (settings%post_sweeps > 0) choice%post_sweeps = settings%post_sweeps
      if (settings%relaxation > 0.0_wp) choice%relaxation = settings%relaxation
      if (settings%load_relaxation > 0.0_wp) choice%load_relaxation = settings%load_relaxation
      if (settings%coarse_sweeps > 0 .and. .not. is_newton(settings)) choice%coarse_sweeps = settings%coarse_sweeps
   end subroutine override

   !> Short name of a way, e.g. `fas gauss_seidel V(2,2)`.
   pure function method_name(settings, choice) result(name)
      type(solver_settings_t), intent(in) :: settings
      type(relaxation_t), intent(in) :: choice
      character(:), allocatable :: name
      character(len=12), parameter :: words(4) = &
         [character(len=12) :: "block_jacobi", "gauss_seidel", "line", "hybrid"]

      if (is_one_level(settings)) then
         name = trim(settings%method)
      else
         name = "fas "//trim(words(choice%smoother))//" "//merge("W", "V", choice%visits > 1)//"("// &
            to_text(choice%pre_sweeps)//","//to_text(choice%post_sweeps)//")"
      end if
   end function method_name

end module solver_choice

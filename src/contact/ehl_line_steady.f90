!> The steady lubricated line contact: start, cycles, and the next way when one does not converge.
module ehl_line_steady
   use cycle_control, only: cycle_limits_t, iterate
   use domain_choice, only: intervals_for_film
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: line_hierarchy_t, method_block_jacobi, method_newton_dense, method_newton_krylov, relaxation_t
   use nested_start, only: full_multigrid_start, hertz_start
   use observer, only: observer_t
   use solver_choice, only: adopt, note_choice, steady_attempts
   use solver_settings, only: solver_settings_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: solve_steady, limits_of

   !> Words with which the reason begins where the grid carries no discrete film.
   character(len=*), parameter, public :: coarse_grid = 'grid too coarse for the film'
   !> Default bound on the residuals of a steady solution.
   real(wp), parameter :: default_tolerance = 1.0e-8_wp
   !> Lowering the Eyring stress: ratio of two steps, accuracy and cycles of each.
   real(wp), parameter :: stress_step = 1.4_wp, rough_tolerance = 1.0e-3_wp
   integer, parameter :: stress_cycles = 40

contains

   !> Solves the steady problem posed on the hierarchy; tolerance is that of the settings, else 1e-8.
   subroutine solve_steady(hierarchy, contact, settings, watcher, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(observer_t), intent(inout) :: watcher
      type(report_t), intent(inout) :: report
      type(relaxation_t), allocatable :: attempts(:)
      type(cycle_limits_t) :: limits
      character(:), allocatable :: failures
      logical :: is_sound
      integer :: i

      allocate (attempts, source=steady_attempts(contact, settings))
      failures = ''
      do i = 1, size(attempts)
         call adopt(hierarchy, attempts(i))
         limits = limits_of(settings, default_tolerance, attempts(i)%method)
         call note_choice(report, attempts(i), limits)
         if (settings%start == 'hertz') then
            call hertz_start(hierarchy, contact)
            is_sound = .true.
         else if (attempts(i)%first_stress > 1.0_wp) then
            call start_from_stress(hierarchy, contact, attempts(i)%first_stress, is_sound)
         else
            call full_multigrid_start(hierarchy, contact, is_sound)
         end if
         if (is_sound) then
            if (attempts(i)%thesis_first) call start_from_thesis(hierarchy, contact)
            call iterate(hierarchy, contact, limits, report, watcher)
            if (report%converged .or. watcher%wants_stop) return
         else
            report%converged = .false.
            report%reason = 'the exact solution of the coarse start grid failed'
         end if
         failures = failures//merge('  ', '; ', i == 1)//report%method//': '//report%reason
      end do
      report%reason = too_coarse(contact)//adjustl(failures)
   end subroutine solve_steady

   !> Start of an Eyring contact from the solution at a higher stress, `factor` times its own, which is lowered in steps.
   subroutine start_from_stress(hierarchy, contact, factor, is_sound)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      logical, intent(out) :: is_sound
      type(line_contact_t) :: eased
      type(report_t) :: report
      real(wp) :: share

      eased = contact
      share = factor
      do while (share > 1.0_wp)
         eased%fluid%sigma_scale = contact%fluid%sigma_scale/share
         eased%fluid%ln_b_scale = contact%fluid%ln_b_scale - log(share)
         is_sound = .true.
         if (share >= factor) call full_multigrid_start(hierarchy, eased, is_sound)
         if (.not. is_sound) return
         call iterate(hierarchy, eased, cycle_limits_t(rough_tolerance, stress_cycles, stress_cycles), report)
         share = share/stress_step
      end do
   end subroutine start_from_stress

   !> Start of the sharp scheme from the solution of the thesis's scheme on the same level.
   subroutine start_from_thesis(hierarchy, contact)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(report_t) :: report

      associate (level => hierarchy%levels(hierarchy%finest))
         level%is_sharp = .false.
         call iterate(hierarchy, contact, cycle_limits_t(rough_tolerance, stress_cycles, stress_cycles), report)
         level%is_sharp = .true.
      end associate
   end subroutine start_from_thesis

   !> Cycle limits: what the settings say, else by method. Plain Block-Jacobi counts blocks of sweeps and needs many; the
   !> residual of a Newton iteration may rise for long while a spike grows.
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

   !> The likely cause of a failure: a grid on which no positive film exists.
   function too_coarse(contact) result(cause)
      type(line_contact_t), intent(in) :: contact
      character(:), allocatable :: cause
      integer :: needed

      cause = ''
      needed = intervals_for_film(contact)
      if (contact%domain%intervals < needed) cause = coarse_grid//', needs '//to_text(needed)//' intervals ('
      if (len(cause) > 0) cause = cause//'has '//to_text(contact%domain%intervals)//'); '
   end function too_coarse

end module ehl_line_steady

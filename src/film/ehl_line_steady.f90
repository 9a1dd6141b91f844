!> The steady lubricated line contact: start, cycles, and the next method if one does not converge.
module ehl_line_steady
   use contact_moment, only: film_estimate
   use cycle_control, only: iterate
   use domain_choice, only: intervals_for_film
   use duty, only: is_reference
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, solver_settings_t
   use line_hierarchy, only: line_hierarchy_t, method_fas, new_hierarchy, &
      pose_coarser_levels, pose_steady_problem, relaxation_t
   use nested_start, only: bump_start, full_multigrid_start, graded_start
   use listener, only: relay_t, listener_t
   use solver_choice, only: adopt, note_choice, steady_attempts
   use text, only: to_text
   use lubricant, only: thins
   implicit none (type, external)
   private

   public :: blame_grid, solve_steady

   !> Methods whose failure is always checked on finer grids, even if the fit says that the grid
   !> carries the film: other methods fail for other reasons.
   character(len=*), parameter :: blaming_methods(2) = [character(len=13) :: 'auto', &
      'newton_krylov']
   !> Grids tried to find one that carries the film: largest refinement over the failed grid or the
   !> fit, most intervals, and cycles on each.
   integer, parameter :: max_refinement = 8, largest_blame = 2**16, blame_cycles = 40
   !> Accuracy and cycles of the upwind2 solution from which the kappa scheme starts.
   real(wp), parameter :: rough_tolerance = 1.0e-3_wp
   integer, parameter :: rough_cycles = 40

contains

   !> Solves the steady problem posed on the hierarchy, to the tolerance of the settings or else
   !> `steady_tolerance`.
   subroutine solve_steady(hierarchy, contact, settings, listener, report)
      type(line_hierarchy_t), intent(inout) :: hierarchy
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      class(listener_t), intent(inout), target :: listener
      type(report_t), intent(inout) :: report
      type(relaxation_t), allocatable :: attempts(:)
      character(:), allocatable :: failure, failures
      logical :: is_sound
      integer :: i

      allocate (attempts, source=steady_attempts(contact, settings))
      ! fits do not know the first moment of a duty
      if (.not. is_reference(hierarchy%levels(hierarchy%finest)%moment)) attempts%starts_graded = &
         .true.
      do i = 1, size(attempts)
         call adopt(hierarchy, attempts(i))
         call note_choice(report, attempts(i))
         call listener%on_stage('steady on '//to_text(contact%domain%intervals)//' intervals by ' &
            //report%method)
         if (settings%start == 'hertz' .and. .not. attempts(i)%starts_graded) then
            call bump_start(hierarchy%levels(hierarchy%finest), film_estimate(contact), &
               attempts(i)%start_film)
            is_sound = .true.
         else if (attempts(i)%starts_graded) then
            call graded_start(hierarchy, contact, is_sound, listener)
         else
            call full_multigrid_start(hierarchy, contact, is_sound, listener)
         end if
         if (is_sound) then
            if (attempts(i)%thesis_first) call start_from_thesis()
            call iterate(hierarchy, report, listener)
            if (report%converged .or. listener%is_stopping) return
         else
            report%converged = .false.
            report%reason = 'the exact solution of the coarse start grid failed'
            if (attempts(i)%starts_graded) report%reason = 'a graded grid has no solution'
            if (listener%is_stopping) report%reason = 'stopped from outside'
            if (listener%is_stopping) return
         end if
         failure = report%method//': '//report%reason
         if (i == 1) failures = failure
         if (index(failures//'; ', failure//'; ') == 0) failures = failures//'; '//failure
         if (attempts(i)%method == method_fas) call pose_coarser_levels(hierarchy)
      end do
      report%reason = failures

   contains

      !> Starts the kappa scheme from the upwind2 solution on the same level.
      subroutine start_from_thesis()
         type(relay_t) :: relay
         type(report_t) :: rough

         relay%parent => listener
         hierarchy%relaxation%tolerance = rough_tolerance
         hierarchy%relaxation%max_cycles = rough_cycles
         hierarchy%relaxation%patience = rough_cycles
         hierarchy%levels(hierarchy%finest)%is_kappa = .false.
         call iterate(hierarchy, rough, relay)
         hierarchy%levels(hierarchy%finest)%is_kappa = .true.
         hierarchy%relaxation = attempts(i)
      end subroutine start_from_thesis

   end subroutine solve_steady

   !> After a failure, checks whether Newton's method finds a solution on a finer grid; if so, the
   !> reason names the grid and the first number of intervals that works. With shear thinning the
   !> fit of film and grid is too rough to skip any.
   subroutine blame_grid(contact, settings, with_roughness, listener, report)
      type(line_contact_t), intent(in) :: contact
      type(solver_settings_t), intent(in) :: settings
      logical, intent(in) :: with_roughness
      class(listener_t), intent(inout), target :: listener
      type(report_t), intent(inout) :: report
      type(relay_t) :: relay
      type(line_contact_t) :: finer
      integer :: fitted, given, last
      logical :: is_solved

      given = contact%domain%intervals
      fitted = intervals_for_film(contact)
      if (given >= fitted .and. .not. any(settings%method == blaming_methods)) return
      relay%parent => listener
      finer = contact
      finer%domain%intervals = max(fitted, 2*given)
      if (thins(contact%fluid)) finer%domain%intervals = 2*given
      last = min(largest_blame, settings%max_intervals, max_refinement*max(fitted, given))
      is_solved = .false.
      do while (finer%domain%intervals <= last)
         call try_grid()
         if (listener%is_stopping) return
         if (is_solved) exit
         finer%domain%intervals = 2*finer%domain%intervals
      end do
      if (is_solved) then
         report%reason = 'grid too coarse for the film, needs '//to_text(finer%domain%intervals) &
            //' intervals (has '//to_text(given)//'); '//report%reason
      else if (given < fitted) then
         report%reason = 'grid too coarse for the film, needs at least '//to_text(fitted) &
            //' intervals (has '// &
            to_text(given)//'; none found up to '//to_text(last)//'); '//report%reason
      end if
   contains

      !> Sets whether Newton's method solves the contact on the finer grid.
      subroutine try_grid()
         type(line_hierarchy_t) :: hierarchy
         type(solver_settings_t) :: plain
         type(report_t) :: own
         type(error_t), allocatable :: error

         hierarchy%is_kappa = settings%space_scheme == 'kappa'
         call new_hierarchy(hierarchy, finer, 0, error)
         is_solved = .not. allocated(error)
         if (.not. is_solved) return
         call pose_steady_problem(hierarchy, finer, with_roughness)
         plain%method = 'newton_krylov'
         plain%space_scheme = settings%space_scheme
         plain%max_cycles = blame_cycles
         call solve_steady(hierarchy, finer, plain, relay, own)
         is_solved = own%converged
      end subroutine try_grid

   end subroutine blame_grid

end module ehl_line_steady

!> Errors of the quantities of a point contact: from the grids of its nested start, or passages on
!> fewer intervals with longer steps, and a longer domain.
module point_errors
   use errors, only: error_t
   use experiment, only: collector_t
   use iteration_report, only: phase_error_bars, report_t
   use kinds, only: not_known, wp
   use line_contact, only: steady_tolerance
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use listener, only: listener_t
   use passage_extremes, only: passage_extremes_t
   use passage_times, only: new_passage_times
   use point_contact, only: first_intervals, point_contact_t, start_of
   use point_cycle, only: new_hierarchy
   use point_march, only: solve_point
   use point_newton, only: point_newton_t, solve_point_newton
   use point_quantities, only: estimate_point_errors, summary_of_point
   use point_solver, only: point_run_t, tolerance_of
   use quantities, only: sliding_rows
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: find_quantities, measure_domain

   !> The longer domain has half as many intervals more, on both sides together.
   integer, parameter :: extension = 2

contains

   !> The quantities of the last grid, or the extremes of a passage that `summary` has before, with
   !> their errors, and why one is `missing`; without a solution they are not known. Error
   !> (internal_error): LAPACK or FFTW.
   subroutine find_quantities(run, contact, listener, report, summary, missing, error)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      class(listener_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      type(line_summary_t), intent(inout) :: summary
      character(:), allocatable, intent(out) :: missing
      type(error_t), allocatable, intent(out) :: error
      type(line_summary_t) :: far, near
      type(line_summary_t), allocatable :: coarser(:)
      real(wp) :: by_spike(size(sliding_rows)), start
      logical :: is_known

      missing = 'no solution'
      if (.not. report%converged) then
         summary%of%value = not_known()
         summary%of%error_estimate = not_known()
         return
      end if
      if (run%time%is_transient) then
         ! what a spike may add to friction, as a share that of the smooth steady contact
         associate (smooth => run%grids(size(run%grids))%of(sliding_rows), &
            of => summary%of(sliding_rows))
            summary%of(sliding_rows)%error_grid = smooth%error_grid*abs(of%value) &
               /max(abs(smooth%value), tiny(1.0_wp))
         end associate
      else
         summary = run%grids(size(run%grids))
      end if
      by_spike = summary%of(sliding_rows)%error_grid
      summary%of(sliding_rows)%error_grid = not_known()
      missing = 'no coarser grids are compared'
      if (.not. run%settings%wants_coarse_runs) return
      missing = 'no coarser grid holds the film'
      if (size(run%grids) < 2) return
      start = wall_seconds()
      call listener%on_stage('a longer domain')
      call measure_domain(run, contact, near, far, is_known, error)
      if (allocated(error)) return
      if (run%time%is_transient) then
         call measure_passages(run, contact, listener, coarser, error)
         if (allocated(error)) return
      else
         coarser = run%grids(size(run%grids) - 1:1:-1)
      end if
      report%cost%phase_seconds(phase_error_bars) = wall_seconds() - start
      missing = 'a longer domain has no solution to compare with'
      if (.not. is_known) return
      summary%of(sliding_rows)%error_grid = by_spike
      call estimate_point_errors(summary, contact, coarser, report%residual, near, far)
      missing = 'a pressure spike that this grid does not resolve'
      if (size(coarser) == 0) missing = 'the passage has no solution on half the intervals'
   end subroutine find_quantities

   !> Extremes of the passage on half and a quarter of the intervals, with as many times longer
   !> steps, as far as these grids hold the film and there are solutions. Error: as above.
   subroutine measure_passages(run, contact, listener, coarser, error)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      class(listener_t), intent(inout), target :: listener
      type(line_summary_t), allocatable, intent(out) :: coarser(:)
      type(error_t), allocatable, intent(out) :: error
      type(collector_t) :: collector
      type(line_state_t) :: state
      type(point_contact_t) :: coarse
      type(point_run_t) :: other
      type(report_t) :: report
      integer :: factor

      allocate (coarser(0))
      coarse = contact
      other%settings = run%settings
      other%settings%film_floor = 0.0_wp
      other%time = run%time
      if (allocated(other%time%resume_from)) deallocate (other%time%resume_from)
      other%threads = run%threads
      collector%parent => listener
      do factor = 2, 4, 2
         coarse%domain%intervals = contact%domain%intervals/factor
         coarse%domain%rows = contact%domain%rows/factor
         if (coarse%domain%intervals < first_intervals(contact, contact%domain%intervals)) return
         other%time%time_step = run%time%end_time/nint(run%time%end_time/(factor &
            *run%time%time_step))
         other%time%tolerance = factor**3*run%time%tolerance
         collector%passage = passage_extremes_t(new_passage_times(coarse, other%time))
         call solve_point(other, coarse, collector, state, report, error)
         if (allocated(error) .or. .not. report%converged) return
         coarser = [coarser, collector%passage%extremes(summary_of(state))]
      end do
   end subroutine measure_passages

   !> Quantities on a quarter of the intervals, or on half of them where that is the first grid,
   !> `near`, which `run` must have, and with the same spacing on a domain 1.5 times as long, `far`.
   !> `is_known`: it has a solution. Error: as above.
   subroutine measure_domain(run, contact, near, far, is_known, error)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t), intent(out) :: near, far
      logical, intent(out) :: is_known
      type(error_t), allocatable, intent(out) :: error
      type(point_newton_t) :: newton
      type(point_contact_t) :: longer
      type(listener_t) :: nobody
      type(report_t) :: report
      real(wp) :: spacing
      integer :: behind, coarsening, more, n(2)

      is_known = .false.
      near = run%grids(max(size(run%grids) - 2, 1))
      coarsening = 2**min(size(run%grids) - 1, 2)
      longer = contact
      if (run%time%is_transient) longer = start_of(contact)
      n = [contact%domain%intervals, contact%domain%rows]/coarsening
      associate (domain => longer%domain)
         more = n(1)/extension
         spacing = (domain%x_outlet - domain%x_inlet)/n(1)
         behind = nint(more*domain%x_outlet/(domain%x_outlet - domain%x_inlet))
         domain%x_inlet = domain%x_inlet - (more - behind)*spacing
         domain%x_outlet = domain%x_outlet + behind*spacing
         domain%y_half_width = domain%y_half_width*(1 + 1.0_wp/extension)
         domain%intervals = n(1) + more
         domain%rows = n(2) + n(2)/extension
         call new_hierarchy(newton%hierarchy, longer, domain%intervals, domain%rows, &
            run%threads, error)
         if (allocated(error)) return
         associate (level => newton%hierarchy%levels(1), i => merge(more - behind, behind, &
            newton%hierarchy%levels(1)%direction > 0.0_wp), &
            j => (domain%rows - n(2))/2)
            level%pressure = 0.0_wp
            level%pressure(i:i + n(1), j:j + n(2)) = run%older
            level%rigid_displacement = run%older_h0
            call solve_point_newton(newton, longer, tolerance_of(run, steady_tolerance), &
               run%settings%max_cycles, nobody, report)
            is_known = report%converged
            if (is_known) far = summary_of_point(level, longer)
         end associate
      end associate
   end subroutine measure_domain

end module point_errors

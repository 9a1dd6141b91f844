!> Errors of the quantities of a point contact: from the grids of its nested start, or passages on
!> fewer intervals with longer steps, and a longer domain.
module point_errors
   use error_bars, only: domain_change_t
   use experiment, only: collector_t, outcome_t
   use iteration_report, only: phase_error_bars, report_t
   use kinds, only: exceeds, larger, not_known, wp
   use line_contact, only: intervals_for_waves, steady_tolerance, time_settings_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, summary_of
   use listener, only: listener_t
   use lubricant, only: thins
   use passage_extremes, only: passage_extremes_t
   use passage_times, only: new_passage_times
   use point_contact, only: first_intervals, point_contact_t, start_of
   use point_cycle, only: new_hierarchy
   use point_newton, only: point_newton_t, solve_point_newton
   use point_quantities, only: estimate_point_errors, next_fall, summary_of_point
   use point_solver, only: point_run_t, solve_point, tolerance_of
   use pressure_errors, only: largest_doubt, shear_of_spike, spike_law_t
   use quantities, only: h_central, h_min, quantity_count, sliding_rows
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: choose_passage, find_quantities, measure_domain

   !> The longer domain has half as many intervals more, on both sides together.
   integer, parameter :: extension = 2

contains

   !> The quantities of the last grid, or the extremes of a passage that `summary` has before, with
   !> their errors, and why one is `missing`; without a solution they are not known.
   subroutine find_quantities(run, contact, listener, report, summary, missing)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      class(listener_t), intent(inout), target :: listener
      type(report_t), intent(inout) :: report
      type(line_summary_t), intent(inout) :: summary
      character(:), allocatable, intent(out) :: missing
      type(domain_change_t) :: longer
      type(line_summary_t), allocatable :: coarser(:)
      real(wp) :: dx, growths(2), least(quantity_count), shares(size(sliding_rows)), start
      type(spike_law_t) :: law

      missing = 'no solution'
      if (.not. report%converged) then
         summary%of%value = not_known()
         summary%of%error_estimate = not_known()
         return
      end if
      if (run%time%is_transient) then
         ! what a spike may add to friction, as a share that of the smooth steady contact times how
         ! much more the spike of the passage grows
         law = spike_law_t(contact%fluid, contact%lambda)
         dx = (contact%domain%x_outlet - contact%domain%x_inlet)/contact%domain%intervals
         associate (smooth => run%grids(size(run%grids)), of => summary%of)
            shares = smooth%of(sliding_rows)%error_grid/max(abs(smooth%of(sliding_rows)%value), &
               tiny(1.0_wp))
            growths = [shear_of_spike(law, summary%crests, of(h_central)%value, dx), &
               shear_of_spike(law, smooth%crests, smooth%of(h_central)%value, dx)]
            if (growths(1) > growths(2) .and. .not. thins(contact%fluid)) shares = (shares &
               + tiny(1.0_wp))/max(growths(2)/growths(1), tiny(1.0_wp))
            where (exceeds(shares, largest_doubt)) shares = not_known()
            least = smooth_errors(run%grids)
            least(sliding_rows) = merge(least(sliding_rows), shares, exceeds(least(sliding_rows) &
               - shares, 0.0_wp))
            of%error_grid = least*abs(of%value)
         end associate
      else
         summary = run%grids(size(run%grids))
      end if
      least = summary%of%error_grid
      summary%of%error_grid = not_known()
      missing = 'no coarser grids are compared'
      if (.not. run%settings%wants_coarse_runs) return
      missing = 'no coarser grid holds the film'
      if (size(run%grids) < 2) return
      start = wall_seconds()
      call listener%on_stage('a longer domain')
      call measure_domain(run, contact, listener, longer)
      coarser = run%grids(size(run%grids) - 1:1:-1)
      if (run%time%is_transient) coarser = passages_of(run, contact, listener)
      listener%is_stopping = listener%is_stopping .or. allocated(listener%error)
      report%cost%phase_seconds(phase_error_bars) = wall_seconds() - start
      missing = 'a longer domain has no solution to compare with'
      if (.not. longer%is_known) return
      summary%of%error_grid = least
      call estimate_point_errors(summary, contact, coarser, report%residual, &
         run%time%is_transient, longer)
      missing = 'a pressure spike that this grid does not resolve'
      if (size(coarser) == 0) missing = 'the passage has no solution on half the intervals'
   end subroutine find_quantities

   !> Chooses intervals and time step of `run` and `contact` for its target, by passages from the
   !> first grid on, each twice as fine as the one before: the first that meets it, or twice as fine
   !> as one that nearly does; at most `max_intervals`.
   subroutine choose_passage(run, contact, listener)
      type(point_run_t), intent(inout) :: run
      type(point_contact_t), intent(inout) :: contact
      class(listener_t), intent(inout), target :: listener
      type(outcome_t) :: last
      real(wp) :: ratio
      integer :: n, usual

      usual = contact%domain%intervals
      n = first_intervals(contact, usual)
      do while (min(intervals_for_waves(contact), usual) > 2*n)
         n = 2*n
      end do
      run%coarser = [line_summary_t ::]
      do
         call run_passage(run, contact, real(usual, wp)/n, listener, last)
         if (allocated(listener%error) .or. listener%wants_stop()) return
         run%coarser = pack([last%summary, run%coarser], last%is_known)
         ratio = huge(ratio)
         if (size(run%coarser) > 1) then
            call estimate_point_errors(last%summary, contact, run%coarser(2:), 0.0_wp, .true.)
            associate (of => last%summary%of([h_min, h_central]))
               ratio = maxval(of%error_grid/of%value)/run%settings%target
            end associate
         end if
         if (ratio <= 1.0_wp) exit
         n = 2*n
         if (ratio <= next_fall .or. 2*n > run%settings%max_intervals) exit
      end do
      if (ratio <= 1.0_wp) run%coarser = run%coarser(2:)   ! the last one is made again
      contact%domain%rows = contact%domain%rows*n/usual
      contact%domain%intervals = n
      run%time = times_over(run%time, real(usual, wp)/n)
   end subroutine choose_passage

   !> Extremes of the passage on half and a quarter of the intervals, with as many times longer
   !> steps, as far as these grids hold the film and there are solutions.
   function passages_of(run, contact, listener) result(coarser)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      class(listener_t), intent(inout), target :: listener
      type(line_summary_t), allocatable :: coarser(:)
      type(outcome_t) :: last
      integer :: factor

      coarser = [line_summary_t ::]
      if (allocated(run%coarser)) coarser = run%coarser
      if (allocated(run%coarser)) return
      do factor = 2, 4, 2
         if (contact%domain%intervals/factor < first_intervals(start_of(contact), &
            contact%domain%intervals)) return
         call run_passage(run, contact, real(factor, wp), listener, last)
         if (.not. last%is_known) return
         coarser = [coarser, last%summary]
      end do
   end function passages_of

   !> Extremes of the passage with the intervals over `factor`, and as many times longer steps,
   !> unless something has failed.
   subroutine run_passage(run, contact, factor, listener, outcome)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      class(listener_t), intent(inout), target :: listener
      type(outcome_t), intent(out) :: outcome
      type(collector_t) :: collector
      type(line_state_t) :: state
      type(point_contact_t) :: coarse
      type(point_run_t) :: other
      type(report_t) :: report

      if (allocated(listener%error)) return
      coarse = contact
      other%settings = run%settings
      other%settings%film_floor = 0.0_wp
      other%time = times_over(run%time, factor)
      if (allocated(other%time%resume_from)) deallocate (other%time%resume_from)
      other%threads = run%threads
      collector%parent => listener
      coarse%domain%intervals = nint(contact%domain%intervals/factor)
      coarse%domain%rows = nint(contact%domain%rows/factor)
      collector%passage = passage_extremes_t(new_passage_times(coarse, other%time))
      call solve_point(other, coarse, collector, state, report, listener%error)
      outcome%is_known = .not. allocated(listener%error) .and. report%converged
      if (.not. outcome%is_known) return
      outcome%summary = collector%passage%extremes(summary_of(state))
      associate (of => outcome%summary%of)
         of%error_grid = smooth_errors(other%grids)*abs(of%value)
      end associate
   end subroutine run_passage

   !> Relative errors, of second order, of the smooth steady contact of a passage on the last of its
   !> `grids`; in a change of the passage those of grid and step may cancel. NaN or 0: not known.
   pure function smooth_errors(grids) result(errors)
      type(line_summary_t), intent(in) :: grids(:)
      real(wp) :: errors(quantity_count)

      associate (last => grids(size(grids))%of, before => grids(max(size(grids) - 1, 1))%of)
         errors = abs(last%between - before%between)/3/larger(abs(last%between), tiny(1.0_wp))
      end associate
   end function smooth_errors

   !> The times of a passage with `factor` times longer steps, whole ones.
   pure function times_over(time, factor) result(longer)
      type(time_settings_t), intent(in) :: time
      real(wp), intent(in) :: factor
      type(time_settings_t) :: longer

      longer = time
      longer%time_step = time%end_time/nint(time%end_time/(factor*time%time_step))
      longer%tolerance = factor**3*time%tolerance
   end function times_over

   !> What a longer domain changes: quantities on a quarter of the intervals, or on half of them
   !> where that is the first grid, which `run` must have, and with the same spacing on a domain 1.5
   !> times as long.
   subroutine measure_domain(run, contact, listener, change)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      class(listener_t), intent(inout) :: listener
      type(domain_change_t), intent(out) :: change
      type(point_newton_t) :: newton
      type(point_contact_t) :: longer
      type(listener_t) :: nobody
      type(report_t) :: report
      real(wp) :: spacing
      integer :: behind, coarsening, more, n(2)

      change%near = run%grids(max(size(run%grids) - 2, 1))
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
            run%threads, listener%error)
         if (allocated(listener%error)) return
         associate (level => newton%hierarchy%levels(1), i => merge(more - behind, behind, &
            newton%hierarchy%levels(1)%direction > 0.0_wp), &
            j => (domain%rows - n(2))/2)
            level%pressure = 0.0_wp
            level%pressure(i:i + n(1), j:j + n(2)) = run%older
            level%rigid_displacement = run%older_h0
            call solve_point_newton(newton, longer, tolerance_of(run, steady_tolerance), &
               run%settings%max_cycles, nobody, report)
            change%is_known = report%converged
            if (change%is_known) change%far = summary_of_point(level, longer)
         end associate
      end associate
   end subroutine measure_domain

end module point_errors

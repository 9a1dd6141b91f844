!> Changes of a lubricated point contact without one of its ingredients, on two grids of its nested
!> start, where it is known with all of them; rules and errors are those of line contacts (module
!> ablation_runs). In time the ingredients of the oil are left out of the smooth steady start.
module point_adequacy
   use ablation_runs, only: set_change, widths
   use ablations, only: ingredients_of, is_of_surfaces, leave_out
   use adequacy, only: accuracy_for, adequacy_t, influence_t, new_influence, no_solution, &
      verdict_needed, verdict_on
   use iteration_report, only: phase_adequacy, report_t
   use kinds, only: not_known, quotient, wp
   use lean_levels, only: largest_rest
   use line_contact, only: smoothen_both
   use line_summary, only: line_summary_t
   use listener, only: listener_t
   use point_contact, only: film_by_formulas, first_intervals, point_contact_t
   use point_cycle, only: new_hierarchy
   use point_level, only: set_point_film, set_surfaces
   use point_newton, only: point_newton_t, solve_point_newton
   use point_quantities, only: summary_of_point
   use point_solver, only: interpolate, point_run_t
   use quantities, only: h_min, h_min_node
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: measure_point_adequacy

   !> Share of the work of the run that may be spent, of that of its steady start in time.
   real(wp), parameter :: share = 0.2_wp, share_in_time = 1.0_wp
   !> Work of a Newton step over that of an iteration of GMRES in it; usual one of a solution per
   !> node.
   real(wp), parameter :: work_of_step = 3.0_wp, usual_work = 25.0_wp
   !> Residual and load error of a lean contact; most Newton steps for it.
   real(wp), parameter :: lean_tolerance = 1.0e-5_wp
   integer, parameter :: most_steps = 18
   character(*), parameter :: no_passage = 'not measured of a point contact in time', &
      no_grids = 'no two coarser grids hold the film'

   !> The finer (1) and the coarser of two grids, the contact on them with all ingredients, its
   !> pressures, H0 of the finer less that of the coarser one, and the work that may still be spent,
   !> in nodes times iterations.
   type :: grid_pair_t
      type(point_newton_t) :: newtons(2)
      type(line_summary_t) :: full(2)
      real(wp), allocatable :: coarse(:, :), fine(:, :)
      real(wp) :: rise = 0.0_wp, budget = 0.0_wp
   end type grid_pair_t

contains

   !> Measures the ingredients of a `contact` that `run` has solved, if it has converged, to the
   !> quantities of `summary`: a row each.
   subroutine measure_point_adequacy(run, contact, summary, adequacy, listener, report)
      type(point_run_t), intent(in) :: run
      type(point_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: summary
      type(adequacy_t), intent(inout) :: adequacy
      class(listener_t), intent(inout) :: listener
      type(report_t), intent(inout) :: report
      type(point_contact_t) :: steady
      type(grid_pair_t) :: pair
      real(wp) :: start
      integer :: i

      if (.not. report%converged) return
      start = wall_seconds()
      adequacy%accuracy = accuracy_for(run%settings%target, quotient( &
         summary%of(h_min)%error_estimate, abs(summary%of(h_min)%value)))
      call listener%on_stage('measuring what each ingredient changes')
      adequacy%rows = new_influence(ingredients_of(contact, run%time%is_transient))
      steady = contact
      if (run%time%is_transient) then
         adequacy%rows%unknown = no_passage
         if (allocated(contact%duty)) return
         call smoothen_both(steady)
      end if
      if (size(run%grids) < 3) then
         adequacy%rows%unknown = no_grids
         return
      end if
      call choose_pair(size(adequacy%rows))
      do i = 1, size(adequacy%rows)
         if (listener%is_stopping) exit
         associate (row => adequacy%rows(i))
            if (run%time%is_transient .and. is_of_surfaces(row%kind)) cycle
            row%is_at_rest = run%time%is_transient
            call measure_one(steady, size(adequacy%rows) - i, pair, adequacy%accuracy, row, &
               listener)
         end associate
      end do
      report%converged = .not. listener%is_stopping
      report%cost%phase_seconds(phase_adequacy) = wall_seconds() - start
   contains

      !> The last pair of grids, up to half of the intervals, on which this many `solutions` fit
      !> into the budget.
      subroutine choose_pair(solutions)
         integer, intent(in) :: solutions
         integer :: g, intervals(2), k, last
         real(wp) :: nodes(size(run%grids))

         last = size(run%grids)
         nodes = [(real(contact%domain%intervals, wp)*contact%domain%rows/4**(last - k), k=1, last)]
         pair%budget = merge(share_in_time, share, run%time%is_transient)*dot_product(nodes, &
            run%work(2, :last) + work_of_step*run%work(1, :last))
         if (adequacy%is_full) pair%budget = huge(1.0_wp)
         k = last - 2
         do while (k > 1 .and. solutions*usual_work*sum(nodes(k:k + 1)) > pair%budget)
            k = k - 1
         end do
         do g = 1, 2
            intervals = [contact%domain%intervals, contact%domain%rows]/2**(last - k + g - 2)
            call new_hierarchy(pair%newtons(g)%hierarchy, steady, intervals(1), intervals(2), &
               run%threads, listener%error)
            listener%is_stopping = listener%is_stopping .or. allocated(listener%error)
            if (listener%is_stopping) return
            pair%full(g) = run%grids(k - g + 2)
            adequacy%at_rest(g) = intervals(1)
         end do
         g = 2**(last - 2 - k)
         pair%coarse = run%older(::g, ::g)
         pair%fine = run%coarse(::g, ::g)
         if (g == 1) pair%rise = run%coarse_h0 - run%older_h0
      end subroutine choose_pair

   end subroutine measure_point_adequacy

   !> Measures the ingredient of a `row`, behind which `others` follow: on the coarser grid first,
   !> which may show that it is needed.
   subroutine measure_one(contact, others, pair, accuracy, row, listener)
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: others
      type(grid_pair_t), intent(inout) :: pair
      real(wp), intent(in) :: accuracy
      type(influence_t), intent(inout) :: row
      class(listener_t), intent(inout) :: listener
      type(influence_t) :: by_one
      type(point_contact_t) :: lean
      type(line_summary_t) :: summaries(2)
      real(wp) :: rest
      integer :: after
      logical :: is_known

      associate (fine => pair%newtons(1)%hierarchy%levels(1), &
         coarse => pair%newtons(2)%hierarchy%levels(1))
         rest = 0.0_wp
         do
            if (pair%budget < usual_work*size(coarse%film)) return
            lean = contact
            call leave_out(lean, row%ingredient_t, rest)
            lean%expected_film = film_by_formulas(lean, 1.0_wp)
            call set_surfaces(coarse, lean, 0.0_wp)
            coarse%pressure = pair%coarse
            ! the smallest film of the same pressure is that by the change of the expected one
            coarse%rigid_displacement = 0.0_wp
            call set_point_film(coarse)
            coarse%rigid_displacement = pair%full(2)%of(h_min_node)%value*lean%expected_film &
               /contact%expected_film - minval(coarse%film)
            is_known = first_intervals(lean, 2*coarse%nx) <= coarse%nx .or. rest > 0.0_wp
            if (is_known) call solve_lean(pair, 2, lean, summaries(2), is_known, listener)
            if (is_known) exit
            row%unknown = no_solution
            if (listener%is_stopping .or. rest > 0.0_wp .or. .not. row%can_reduce) return
            rest = largest_rest
         end do
         row%left_out = 1 - rest
         by_one = row
         call set_change(by_one, summaries(2:), pair%full(2:), widths)
         by_one%change([h_min, h_min_node]) = not_known()   ! it hops from node to node
         by_one%error([h_min, h_min_node]) = not_known()
         after = others*size(coarse%film)
         if (verdict_on(by_one, accuracy) == verdict_needed) then
            row = by_one
            after = others*(size(coarse%film) + size(fine%film))
         end if
         if (pair%budget < usual_work*(size(fine%film) + after)) return
         call set_surfaces(fine, lean, 0.0_wp)
         call interpolate(coarse%pressure - pair%coarse, fine%pressure)
         fine%pressure = max(pair%fine + fine%pressure, 0.0_wp)
         fine%rigid_displacement = coarse%rigid_displacement + pair%rise
         call solve_lean(pair, 1, lean, summaries(1), is_known, listener)
         if (.not. is_known) row%unknown = no_solution
         if (is_known) call set_change(row, summaries, pair%full, widths)
      end associate
   end subroutine measure_one

   !> Solves grid `g` of the pair for a `lean` contact from its present pressure.
   subroutine solve_lean(pair, g, lean, summary, is_known, listener)
      type(grid_pair_t), intent(inout) :: pair
      integer, intent(in) :: g
      type(point_contact_t), intent(in) :: lean
      type(line_summary_t), intent(out) :: summary
      logical, intent(out) :: is_known
      class(listener_t), intent(inout) :: listener
      type(report_t) :: report

      associate (newton => pair%newtons(g), level => pair%newtons(g)%hierarchy%levels(1))
         call solve_point_newton(newton, lean, lean_tolerance, most_steps, listener, report)
         pair%budget = pair%budget - real(size(level%film), wp)*(newton%iterations &
            + work_of_step*newton%steps)
         is_known = report%converged
         if (is_known) summary = summary_of_point(level, lean)
      end associate
   end subroutine solve_lean

end module point_adequacy

!> Which ingredients of a dry contact matter (plasticity, periodic images, fine harmonics, the
!> second direction of an area), and whether its grid is fine enough.
!>
!> The contact is solved with and without an ingredient under its largest load on the same grid, so
!> that most of the error of the grid cancels; a grid of twice the spacing shows how much remains.
module dry_adequacy
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_problem, only: kernel_open, no_hardness
   use dry_quantities, only: contact_area, dry_row_t, mean_pressure, mean_separation, p_max, yields
   use dry_record, only: dry_record_t, dry_setting_t, has_few_nodes, &
      with_elements, without_fine_harmonics, without_images, without_rows, without_yield
   use kinds, only: exceeds, larger, not_known, quotient, wp
   use roughness, only: power_spectrum
   use text, only: number_text, to_text
   use ablations, only: ingredient_t
   use adequacy, only: accuracy_for, adequacy_t, from_estimates, influence_t, new_influence, &
      verdict_of
   implicit none (type, external)
   private

   public :: measure_dry_adequacy

   !> Quantities that are compared.
   integer, parameter, public :: compared(*) = [contact_area, mean_separation, p_max]
   !> Spacing of the second grid over that of the first.
   real(wp), parameter :: coarsening = 2.0_wp

   !> Error measure to which contacts are solved.
   real(wp), parameter :: tolerance = 1.0e-6_wp
   !> Error of a change: this many times its difference between both grids (at first order, the
   !> error itself), plus a share of the change, since two grids may agree by chance; for the
   !> contact area at least this many standard deviations due to its edges, which lie anywhere
   !> between nodes; and at least a share of the error of the grid.
   real(wp), parameter :: safety = 1.5_wp, change_share = 0.05_wp, deviations = 2.0_wp, &
      grid_share = 0.05_wp
   !> Variance of a position between two nodes, in spacings.
   real(wp), parameter :: uniform_variance = 1.0_wp/12.0_wp
   !> Profiles of an area that are solved as lines, and Student's t for this number: in 95 of 100
   !> areas the mean of all profiles is within that many standard errors.
   integer, parameter :: profiles = 16
   real(wp), parameter :: students_t = 2.131_wp
   !> The budget is this share of the work of the result, and at least this work for a line and an
   !> area, in pairs of transforms times nodes: a tenth of the run with its error bars, and 20 ms
   !> (190 instructions each for lines whose transforms are planned, 650 for areas).
   real(wp), parameter :: work_share = 0.06_wp, free_work(2) = [3.5e5_wp, 8.0e4_wp]
   !> Why a change is not known.
   character(*), parameter :: no_solution = 'the grids that it may take have no solution without it'
   !> Size of the transforms of an open kernel in each direction, relative to the grid.
   real(wp), parameter :: padding = 2.0_wp
   !> Share of the mean square height in harmonics beyond the last one counted; most rows of an area
   !> in which they are counted; fewest harmonics that are halved.
   real(wp), parameter :: negligible_power = 1.0e-6_wp
   integer, parameter :: max_rows = 8, min_harmonics = 4

contains

   !> Measures the adequacy of the solution of a `record` under its largest load, for an accuracy
   !> `target` (0: none). With given separations the load is the one found. `has_parabola`: a body
   !> touches in the middle of the domain.
   subroutine measure_dry_adequacy(record, target, has_parabola, adequacy)
      type(dry_record_t), intent(inout) :: record
      real(wp), intent(in) :: target
      logical, intent(in) :: has_parabola
      type(adequacy_t), intent(out) :: adequacy
      type(dry_row_t) :: full(2)
      type(dry_setting_t) :: setting
      type(influence_t) :: grid
      integer :: harmonics, heaviest, i
      logical :: can_yield, is_open

      if (.not. all(record%outcome%rows%is_converged)) return
      heaviest = maxloc(record%outcome%rows%values(mean_pressure), 1)
      adequacy%mean_pressure = record%outcome%rows(heaviest)%values(mean_pressure)
      allocate (adequacy%rows(0))
      harmonics = 0
      can_yield = record%sweep%loads%hardness < no_hardness
      is_open = record%sweep%grid%kernel == kernel_open
      if (.not. (has_parabola .or. is_open)) harmonics = harmonics_of(record)
      ! images need another kernel, with them and without
      setting = dry_setting_t(affordable_ratio(record, heaviest, count([can_yield .and. &
         yields(record%outcome%rows(heaviest)), harmonics > 0, has_parabola, has_parabola])), &
         tolerance, number=harmonics, load=heaviest)
      grid = new_influence(ingredient_t(0, 'grid', 'the limit of fine grids'))
      grid%is_numerical = .true.
      grid%measured_on = from_estimates
      grid%unknown = 'there is no error estimate'
      grid%error = 0.0_wp
      if (allocated(record%outcome%errors)) grid%change(compared) = quotient( &
         record%outcome%errors(compared, heaviest), compared_of(record%outcome%rows(heaviest)))
      if (can_yield) call add(without_yield, 'plasticity', 'elastic bodies', &
         'nothing yields on the grids that it may take, or they have no solution')
      if (harmonics > 0) call add(without_fine_harmonics, 'harmonics', 'the harmonics 1 to ' &
         //to_text(harmonics/2)//' of '//to_text(harmonics), &
         'the grids that it may take do not carry these harmonics')
      if (has_parabola) call add(without_images, 'periodicity', merge('a periodic one    ', &
         'an open half-space', is_open), no_solution)
      if (record%sweep%grid%ny > 1 .and. .not. record%sweep%loads%has_history) call add( &
         without_rows, 'area', 'the mean of '//to_text(profiles)//' profiles along x', no_solution)
      if (allocated(record%outcome%errors)) adequacy%rows = [adequacy%rows, grid]
      adequacy%accuracy = accuracy_for(target, grid%change(contact_area))
      ! nodes in contact are counted: a change of 0 may be anything within its error
      associate (rows => adequacy%rows)
         do i = 1, size(rows)
            rows(i)%verdict = verdict_of(rows(i)%change(compared), rows(i)%error(compared), &
               adequacy%accuracy, unseen=rows(i)%error(compared))
         end do
      end associate

   contains

      !> Measures one part.
      subroutine add(part, name, instead, unknown)
         integer, intent(in) :: part
         character(*), intent(in) :: name, instead, unknown
         type(influence_t) :: row

         row = new_influence(ingredient_t(part, name, instead))
         row%unknown = unknown
         if (part == without_rows) then
            row%measured_on = 'the nodes of the result'
            call compare_profiles(record, heaviest, row)
         else
            row%measured_on = 'grids with '//number_text(setting%ratio, 3)//' and '// &
               number_text(coarsening*setting%ratio, 3)//' times the spacing'
            call ablate(record, setting, full, grid%change(compared), row)
         end if
         adequacy%rows = [adequacy%rows, row]
      end subroutine add

   end subroutine measure_dry_adequacy

   !> Fills the `row` of leaving out a part on the grid of `setting` and a coarser one; `full`: with
   !> all parts on both, 0 nodes until it is known; `doubt`: relative errors of the result by its
   !> grid. If nothing yields, the changes without hardness are 0, and their error is the share by
   !> which the largest pressure may exceed the hardness within its error bar.
   subroutine ablate(record, setting, full, doubt, row)
      type(dry_record_t), intent(inout) :: record
      type(dry_setting_t), intent(in) :: setting
      type(dry_row_t), intent(inout) :: full(2)
      real(wp), intent(in) :: doubt(:)
      type(influence_t), intent(inout) :: row
      type(dry_setting_t) :: one
      type(dry_row_t), allocatable :: found(:)
      type(dry_row_t) :: with, without
      real(wp) :: changes(size(compared), 2), edges, error_of_change(size(compared))
      integer :: g

      associate (outcome => record%outcome, load => setting%load)
         if (row%kind == without_yield .and. .not. yields(outcome%rows(load))) then
            row%change(compared) = 0.0_wp
            row%error(compared) = 0.0_wp
            if (.not. allocated(outcome%errors)) return
            row%error(compared) = not_known()
            if (ieee_is_finite(outcome%errors(p_max, load))) row%error(compared) = max(0.0_wp, &
               (outcome%rows(load)%values(p_max) + outcome%errors(p_max, load)) &
               /record%sweep%loads%hardness - 1.0_wp)
            return
         end if
      end associate
      do g = 2, 1, -1
         one = setting
         one%ratio = setting%ratio*coarsening**(g - 1)
         if (row%kind == without_images) one%without = with_elements
         with = full(g)
         if (row%kind == without_images .or. with%nodes == 0) then
            call record%run(one, found)
            with = found(1)
         end if
         if (row%kind /= without_images) full(g) = with
         one%without = row%kind
         without = with
         if (with%is_converged) then
            call record%run(one, found)
            without = found(1)
         end if
         changes(:, g) = quotient(compared_of(without), compared_of(with)) - 1.0_wp
      end do
      error_of_change = safety*abs(changes(:, 1) - changes(:, 2)) + change_share*abs(changes(:, 1))
      if (ieee_is_finite(error_of_change(1))) then
         edges = deviations*edge_deviation(with%edges(1) + without%edges(1), with)
         ! yielding changes the area by less than the largest pressure (by a third in 70 contacts)
         if (row%kind == without_yield .and. all(ieee_is_finite([edges, changes(:, 1), &
            error_of_change]))) edges = min(edges, abs(changes(3, 1)) + error_of_change(3))
         error_of_change(1) = larger(error_of_change(1), edges)
      end if
      ! a grid on which nothing yields has another contact than the result
      if (row%kind == without_yield .and. .not. yields(with)) changes(:, 1) = not_known()
      ! changes that follow as 0 from the contact are exact
      where (exceeds(error_of_change, 0.0_wp)) error_of_change = larger(error_of_change, &
         grid_share*doubt)
      row%change(compared) = changes(:, 1)
      row%error(compared) = error_of_change
   end subroutine ablate

   !> Fills the `row` of replacing an area by profiles along x, each under the same mean pressure:
   !> the change is that of their mean, the error its standard error, or not known for a quantity
   !> equal in all profiles that differ in others, since that says nothing about the profiles in
   !> between.
   subroutine compare_profiles(record, heaviest, row)
      type(dry_record_t), intent(inout) :: record
      integer, intent(in) :: heaviest
      type(influence_t), intent(inout) :: row
      type(dry_row_t), allocatable :: line(:)
      real(wp) :: edges, found(size(compared), profiles), mean(size(compared)), &
         spread_of_mean(size(compared))
      integer :: i

      edges = 0.0_wp
      associate (area => record%outcome%rows(heaviest), ny => record%sweep%grid%ny)
         do i = 1, profiles
            call record%run(dry_setting_t(1.0_wp, tolerance, without_rows, &
               ((2*i - 1)*ny)/(2*profiles), heaviest), line)
            found(:, i) = quotient(compared_of(line(1)), compared_of(area)) - 1.0_wp
            edges = edges + edge_deviation(line(1)%edges(1), area)*ny/profiles
         end do
      end associate
      mean = sum(found, dim=2)/profiles
      spread_of_mean = students_t*sqrt(sum((found - spread(mean, 2, profiles))**2, &
         dim=2)/(profiles*(profiles - 1.0_wp)))
      if (any(exceeds(spread_of_mean, spacing(1.0_wp)))) then
         where (.not. exceeds(spread_of_mean, spacing(1.0_wp))) spread_of_mean = not_known()
      end if
      ! where the whole contact yields, edges of all profiles may err alike and make up the change
      if (ieee_is_finite(spread_of_mean(1))) spread_of_mean(1) = larger(spread_of_mean(1), &
         min(deviations*edges, abs(mean(1))))
      if (any(ieee_is_finite(spread_of_mean))) row%unknown = &
         'all profiles have the same, which shows nothing about the others'
      row%change(compared) = mean
      row%error(compared) = spread_of_mean
   end subroutine compare_profiles

   !> The compared quantities of a load; NaN if it did not converge.
   pure function compared_of(row) result(values)
      type(dry_row_t), intent(in) :: row
      real(wp) :: values(size(compared))

      values = row%values(compared)
      if (.not. row%is_converged) values = not_known()
   end function compared_of

   !> Relative standard deviation of the contact area of a `row` with this many edges.
   pure real(wp) function edge_deviation(edges, row) result(deviation)
      integer, intent(in) :: edges
      type(dry_row_t), intent(in) :: row

      deviation = quotient(sqrt(edges*uniform_variance), row%values(contact_area)*row%nodes)
   end function edge_deviation

   !> The last significant harmonic along x in some rows of an area; 0: too few to halve.
   integer function harmonics_of(record) result(harmonics)
      type(dry_record_t), intent(in) :: record
      real(wp), allocatable :: power(:), rows(:, :)
      real(wp) :: beyond, most

      harmonics = 0
      associate (sweep => record%sweep)
         rows = reshape(sweep%height, [sweep%grid%nx, sweep%grid%ny])
         rows = rows(:, ::(sweep%grid%ny - 1)/max_rows + 1)
      end associate
      call power_spectrum(rows, power)
      beyond = 0.0_wp
      most = negligible_power*sum(power)
      do harmonics = size(power), min_harmonics, -1
         beyond = beyond + power(harmonics)
         if (beyond > most) return
      end do
      harmonics = 0
   end function harmonics_of

   !> Spacing, relative to the result, of the finer of two grids on which this many `parts` can be
   !> left out under the `heaviest` load within the budget; the other grid has twice the spacing.
   !> The result has been solved with all of them. A grid finer than the result only if error bars
   !> use one.
   pure real(wp) function affordable_ratio(record, heaviest, parts) result(ratio)
      type(dry_record_t), intent(in) :: record
      integer, intent(in) :: heaviest, parts
      real(wp) :: allowed, nodes, one, share
      integer :: directions

      associate (grid => record%sweep%grid, rows => record%outcome%rows)
         directions = merge(1, 2, grid%ny == 1)
         nodes = rows(heaviest)%nodes
         if (grid%kernel == kernel_open) nodes = padding**directions*nodes
         allowed = max(work_share*sum(rows%fft_pairs)*nodes, free_work(directions))
         one = rows(heaviest)%fft_pairs*nodes
      end associate
      share = coarsening**(-directions)
      if ((parts + (parts + 1)/share)*one <= allowed .and. has_few_nodes(record%sweep%grid)) then
         ratio = 1.0_wp/coarsening
      else if ((parts + (parts + 1)*share)*one <= allowed) then
         ratio = 1.0_wp
      else
         ratio = max(((parts + 1)*(1.0_wp + share)*one/allowed)**(1.0_wp/directions), 1.0_wp)
      end if
   end function affordable_ratio

end module dry_adequacy

!> Which ingredients of a dry contact matter: yielding, images, fine harmonics, the second direction
!> of an area; and whether its grid is fine enough.
module dry_adequacy
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_ablations, only: compared_values, known_t, measure_changes, measure_profiles, &
      profiles, without_fine_harmonics, without_images, without_yield, yields
   use dry_errors, only: has_few_nodes
   use dry_influences, only: coarsening, compared_count, dry_adequacy_t, dry_influence_t
   use dry_problem, only: kernel_open
   use dry_resampling, only: dry_sweep_t
   use dry_sweep, only: dry_outcome_t, dry_row_t
   use errors, only: error_t
   use kinds, only: wp
   use missing_value, only: exceeds, larger, not_known, quotient
   use roughness, only: power_spectrum
   use text, only: to_text
   use verdicts, only: begin_row, usual_accuracy, verdict_of
   implicit none (type, external)
   private

   public :: measure_dry_adequacy

   !> Share of the work of the result that may be spent, and work that always may, of a line and of
   !> an area, in pairs of transforms times nodes: a tenth of the run, which has error bars too, and
   !> 20 ms (lines take 190 instructions each, on grids for which transforms are planned already;
   !> areas 650).
   real(wp), parameter :: work_share = 0.06_wp, free_work(2) = [3.5e5_wp, 8.0e4_wp]
   !> How much larger the transforms of an open kernel are in each direction.
   real(wp), parameter :: padding = 2.0_wp
   !> Share of the mean square height that harmonics beyond the last one hold.
   real(wp), parameter :: negligible_power = 1.0e-6_wp
   !> Rows of an area that are looked at for it.
   integer, parameter :: max_rows = 8
   !> Fewest harmonics that are halved.
   integer, parameter :: min_harmonics = 4
   !> Of the error of the grid at least such a share stays in a change, measured on grids like it.
   real(wp), parameter :: grid_share = 0.05_wp

contains

   !> Measures the adequacy of the `outcome` of a `sweep` under its largest load, with the estimated
   !> `errors` (none: not wanted) and the wanted accuracy `target` (0: none). Under given
   !> separations the load is the one that was found. `has_parabola`: the contact is that of a body
   !> in the middle of the domain. Fails (internal_error) if FFTW does.
   subroutine measure_dry_adequacy(sweep, outcome, errors, target, has_parabola, adequacy, &
      error)
      type(dry_sweep_t), intent(in) :: sweep
      real(wp), intent(in) :: target
      type(dry_outcome_t), intent(in) :: outcome
      type(dry_row_t), intent(in) :: errors(:)
      logical, intent(in) :: has_parabola
      type(dry_adequacy_t), intent(out) :: adequacy
      type(error_t), allocatable, intent(out) :: error
      type(dry_sweep_t) :: one
      type(dry_influence_t) :: grid
      integer :: harmonics, heaviest, i
      integer, allocatable :: parts(:)

      if (.not. all(outcome%rows%is_converged)) return
      heaviest = maxloc(outcome%rows%mean_pressure, 1)
      adequacy%mean_pressure = outcome%rows(heaviest)%mean_pressure
      one = sweep
      if (allocated(one%loads%separation)) deallocate (one%loads%separation)
      one%loads%mean_pressure = [adequacy%mean_pressure]
      call count_harmonics(one, harmonics, error)
      if (allocated(error)) return
      parts = pack([without_yield, without_fine_harmonics, without_images], &
         [one%loads%hardness < huge(1.0_wp), harmonics >= min_harmonics .and. &
         .not. has_parabola .and. one%grid%kernel /= kernel_open, has_parabola])
      ! images take another kernel, with them and without
      adequacy%ratio = affordable_ratio(one, outcome%rows, heaviest, count(parts /= without_yield &
         .or. yields(outcome%rows(heaviest))) + count(parts == without_images))
      adequacy%rows = [(new_row(parts(i), harmonics, one%grid%kernel), i=1, size(parts))]
      call measure_parts(one, outcome, heaviest, harmonics, parts, adequacy, error)
      if (allocated(error)) return
      if (size(errors) > 0) then
         grid = grid_row(outcome%rows(heaviest), errors(heaviest))
         call allow_for_grid(grid, adequacy%rows)
         call allow_for_yielding(outcome%rows(heaviest), errors(heaviest), one%loads%hardness, &
            parts, adequacy%rows)
      end if
      if (one%grid%ny > 1 .and. .not. one%loads%has_history) then
         adequacy%rows = [adequacy%rows, empty_row('area', 'the mean of '//to_text(profiles) &
            //' profiles along x')]
         associate (row => adequacy%rows(size(adequacy%rows)))
            call measure_profiles(one, compared_values(outcome%rows(heaviest)), &
               row%change, row%error, error)
            if (allocated(error)) return
            if (any(ieee_is_finite(row%error))) row%unknown = &
               'all profiles have the same, which tells nothing of the others'
         end associate
      end if
      if (size(errors) > 0) adequacy%rows = [adequacy%rows, grid]
      call judge(adequacy, target)
   end subroutine measure_dry_adequacy

   !> Fills the changes by leaving out `parts`, the rows of `adequacy` so far. Where nothing yields
   !> the result is elastic already.
   subroutine measure_parts(one, outcome, heaviest, harmonics, parts, adequacy, error)
      type(dry_sweep_t), intent(in) :: one
      type(dry_outcome_t), intent(in) :: outcome
      integer, intent(in) :: heaviest, harmonics, parts(:)
      type(dry_adequacy_t), intent(inout) :: adequacy
      type(error_t), allocatable, intent(out) :: error
      real(wp), dimension(compared_count, size(parts)) :: changes, errors
      type(known_t) :: known
      logical :: is_open(size(parts))
      integer, allocatable :: open_parts(:)
      integer :: i, k

      is_open = parts /= without_yield .or. yields(outcome%rows(heaviest))
      open_parts = pack(parts, is_open)
      known%ratio = adequacy%ratio
      if (allocated(outcome%pressures)) known%pressures = outcome%pressures(:, [heaviest])
      ! loads before it have left another surface
      if (heaviest == 1 .or. .not. one%loads%has_history) known%with = outcome%rows(heaviest)
      call measure_changes(one, open_parts, harmonics, known, changes(:, :size(open_parts)), &
         errors(:, :size(open_parts)), error)
      if (allocated(error)) return
      k = 0
      do i = 1, size(parts)
         associate (row => adequacy%rows(i))
            row%change = 0.0_wp
            row%error = 0.0_wp
            if (.not. is_open(i)) cycle
            k = k + 1
            row%change = changes(:, k)
            row%error = errors(:, k)
         end associate
      end do
   end subroutine measure_parts

   !> No change of `rows` is better known than by a share of the error of the `grid`; but changes of
   !> 0 that follow from the contact itself.
   pure subroutine allow_for_grid(grid, rows)
      type(dry_influence_t), intent(in) :: grid
      type(dry_influence_t), intent(inout) :: rows(:)
      integer :: i, k

      do i = 1, size(rows)
         do k = 1, compared_count
            if (exceeds(rows(i)%error(k), 0.0_wp)) then
               rows(i)%error(k) = larger(rows(i)%error(k), grid_share*grid%change(k))
            end if
         end do
      end do
   end subroutine allow_for_grid

   !> Where nothing yields, a largest pressure that may be above the `hardness` within its error
   !> bar, by a share of that, leaves all changes open by as much: what yields is less than that.
   pure subroutine allow_for_yielding(row, errors, hardness, parts, rows)
      type(dry_row_t), intent(in) :: row, errors
      real(wp), intent(in) :: hardness
      integer, intent(in) :: parts(:)
      type(dry_influence_t), intent(inout) :: rows(:)
      integer :: i

      if (yields(row)) return
      i = findloc(parts, without_yield, 1)
      if (i == 0) return
      rows(i)%error = not_known()
      if (ieee_is_finite(errors%p_max)) rows(i)%error = max(0.0_wp, (row%p_max &
         + errors%p_max)/hardness - 1.0_wp)
   end subroutine allow_for_yielding

   !> The accuracy that counts, and all verdicts.
   pure subroutine judge(adequacy, target)
      type(dry_adequacy_t), intent(inout) :: adequacy
      real(wp), intent(in) :: target
      integer :: i

      associate (rows => adequacy%rows)
         if (size(rows) > 0) then
            if (rows(size(rows))%is_numerical) adequacy%accuracy = larger(usual_accuracy, &
               rows(size(rows))%change(1))
         end if
         if (target > 0.0_wp) adequacy%accuracy = target
         do i = 1, size(rows)
            ! nodes in contact are counted: a change of 0 may be anything within its error
            rows(i)%verdict = verdict_of(rows(i)%change, rows(i)%error, adequacy%accuracy, &
               unseen=rows(i)%error)
         end do
      end associate
   end subroutine judge

   !> The grid: what the `errors` of a load say.
   pure function grid_row(row, errors) result(grid)
      type(dry_row_t), intent(in) :: row, errors
      type(dry_influence_t) :: grid

      grid = empty_row('grid', 'the limit of fine grids')
      grid%is_numerical = .true.
      grid%unknown = 'there is no error estimate'
      grid%change = quotient([errors%contact_area_fraction, errors%mean_separation, errors%p_max], &
         compared_values(row))
      grid%error = 0.0_wp
   end function grid_row

   !> The row of an ingredient.
   pure function new_row(part, harmonics, kernel) result(row)
      integer, intent(in) :: part, harmonics, kernel
      type(dry_influence_t) :: row

      select case (part)
      case (without_yield)
         row = empty_row('plasticity', 'elastic bodies')
         row%unknown = 'nothing yields on the grids that it may take, or they have no solution'
      case (without_fine_harmonics)
         row = empty_row('harmonics', 'the harmonics 1 to '//to_text(harmonics/2)//' of ' &
            //to_text(harmonics))
         row%unknown = 'the grids that it may take do not carry these harmonics'
      case default   ! without_images
         row = empty_row('periodicity', 'an open half-space')
         if (kernel == kernel_open) row = empty_row('periodicity', 'a periodic one')
      end select
   end function new_row

   !> A row of which nothing is known yet.
   pure function empty_row(name, text) result(row)
      character(*), intent(in) :: name, text
      type(dry_influence_t) :: row

      call begin_row(name, text, row%judged_t, row%change, row%error)
      row%unknown = 'the grids that it may take have no solution without it'
   end function empty_row

   !> The last harmonic along x that counts, in some rows of an area. Fails (internal_error) if FFTW
   !> does.
   subroutine count_harmonics(sweep, harmonics, error)
      type(dry_sweep_t), intent(in) :: sweep
      integer, intent(out) :: harmonics
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: power(:), rows(:, :)
      real(wp) :: beyond, most

      harmonics = 0
      rows = reshape(sweep%height, [sweep%grid%nx, sweep%grid%ny])
      rows = rows(:, ::(sweep%grid%ny - 1)/max_rows + 1)
      call power_spectrum(rows, power, error)
      if (allocated(error)) return
      beyond = 0.0_wp
      most = negligible_power*sum(power)
      do harmonics = size(power), 1, -1
         beyond = beyond + power(harmonics)
         if (beyond > most) exit
      end do
   end subroutine count_harmonics

   !> How many times coarser the finer one of two grids is on which this many `parts` can be left
   !> out under the `heaviest` load at the allowed cost; the other one has twice its spacing. On its
   !> own grid the sweep has been solved with all of them. A finer grid than that only where error
   !> bars take one.
   pure function affordable_ratio(sweep, rows, heaviest, parts) result(ratio)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), intent(in) :: rows(:)
      integer, intent(in) :: heaviest, parts
      real(wp) :: ratio
      real(wp) :: allowed, nodes, one, share
      integer :: directions

      directions = merge(1, 2, sweep%grid%ny == 1)
      nodes = real(sweep%grid%nx, wp)*sweep%grid%ny
      if (sweep%grid%kernel == kernel_open) nodes = padding**directions*nodes
      allowed = max(work_share*sum(rows%fft_pairs)*nodes, free_work(directions))
      one = rows(heaviest)%fft_pairs*nodes
      share = coarsening**(-directions)
      if ((parts + (parts + 1)/share)*one <= allowed .and. has_few_nodes(sweep%grid)) then
         ratio = 1.0_wp/coarsening
      else if ((parts + (parts + 1)*share)*one <= allowed) then
         ratio = 1.0_wp
      else
         ratio = max(((parts + 1)*(1.0_wp + share)*one/allowed)**(1.0_wp/directions), 1.0_wp)
      end if
   end function affordable_ratio

end module dry_adequacy

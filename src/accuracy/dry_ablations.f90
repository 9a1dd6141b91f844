!> A dry contact with something left out of its model, on coarser grids: the relative changes of
!> contact area, mean separation and largest pressure under one load.
!>
!> Both contacts, with and without, are solved on the same grid, so that most of its error drops
!> out: on that of the result, where only the one without is left to solve, or a coarser one. The
!> same on a still coarser one tells how much of the error does not drop out. All start from the
!> pressures of the result.
module dry_ablations
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: real32
   use dry_influences, only: coarsening, compared_count
   use dry_problem, only: dry_grid_t, kernel_element, kernel_open, no_hardness
   use dry_resampling, only: dry_sweep_t, is_too_coarse, resample, resample_pressures
   use dry_scaling, only: new_dry_scaling
   use dry_settings, only: method_conjugate_gradient
   use dry_sweep, only: dry_outcome_t, dry_row_t, solve_dry_sweep
   use errors, only: error_t, input_error
   use kinds, only: wp
   use missing_value, only: exceeds, larger, not_known, quotient
   use synthetic_surface, only: truncate_harmonics
   implicit none (type, external)
   private

   public :: compared_values, known_t, measure_changes, measure_profiles, yields

   !> What can be left out: yielding; the finer half of the harmonics; the images of a periodic
   !> surface (of an open one: there are none).
   integer, parameter, public :: without_yield = 1, without_fine_harmonics = 2, without_images = 3

   !> Error measure to which they are solved.
   real(wp), parameter :: tolerance = 1.0e-6_wp
   !> The error of a change is this many times its difference on both grids, which of first order is
   !> the error, and a share of itself, for two grids may agree by chance; of the contact area no
   !> less than this many standard deviations of what its edges do, which lie anywhere between
   !> nodes.
   real(wp), parameter :: safety = 1.5_wp, own_share = 0.05_wp, deviations = 2.0_wp
   !> Variance of a place between two nodes, in spacings.
   real(wp), parameter :: uniform_variance = 1.0_wp/12.0_wp
   !> Profiles of an area that are solved as lines, and Student's t for this many: the mean of all
   !> is within that many standard errors of theirs in 95 of 100 areas.
   integer, parameter, public :: profiles = 16
   real(wp), parameter :: students_t = 2.131_wp

   !> What is known before anything is left out, and where it is.
   type :: known_t
      !> Spacing of the finer one of two grids over that of the sweep.
      real(wp) :: ratio = 1.0_wp
      !> What the sweep gives on its own grid; not allocated: nothing.
      type(dry_row_t), allocatable :: with
      !> Pressures from which solutions start (nx*ny, 1); not allocated: there are none.
      real(real32), allocatable :: pressures(:, :)
   end type known_t

   !> What was found on one grid.
   type :: grid_changes_t
      !> How many times as coarse as that of the result it is.
      real(wp) :: ratio = 1.0_wp
      logical :: is_own = .true.
      !> What it gives with everything; not allocated: not solved yet.
      type(dry_row_t), allocatable :: with
      !> Changes of its quantities without each part.
      real(wp), allocatable :: changes(:, :)
      !> Standard deviation of the changes of the contact area because of its edges.
      real(wp), allocatable :: edges(:)
   end type grid_changes_t

contains

   !> The compared quantities of a load; NaN if it did not converge.
   pure function compared_values(row) result(values)
      type(dry_row_t), intent(in) :: row
      real(wp) :: values(compared_count)

      values = [row%contact_area_fraction, row%mean_separation, row%p_max]
      if (.not. row%is_converged) values = not_known()
   end function compared_values

   !> Relative `changes` of the quantities of a `sweep` of one load by leaving out each of `parts`,
   !> and their errors (compared_count, parts); NaN where they are not known. The finer half of
   !> `harmonics` is left out. Fails (internal_error) if FFTW does.
   subroutine measure_changes(sweep, parts, harmonics, known, changes, errors, error)
      type(dry_sweep_t), intent(in) :: sweep
      integer, intent(in) :: parts(:), harmonics
      type(known_t), intent(in) :: known
      real(wp), dimension(compared_count, size(parts)), intent(out) :: changes, errors
      type(error_t), allocatable, intent(out) :: error
      type(grid_changes_t) :: grids(2)
      logical :: has_yielded
      integer :: g, i

      do g = 1, 2
         grids(g)%ratio = known%ratio*coarsening**(g - 1)
         grids(g)%is_own = abs(grids(g)%ratio - 1.0_wp) < epsilon(1.0_wp)
         if (allocated(known%with) .and. grids(g)%is_own) grids(g)%with = known%with
         call change_on(sweep, parts, harmonics, known%pressures, grids(g), error)
         if (allocated(error)) return
      end do
      changes = grids(1)%changes
      errors = safety*abs(changes - grids(2)%changes) + own_share*abs(changes)
      has_yielded = .false.
      if (allocated(grids(1)%with)) has_yielded = yields(grids(1)%with)
      do i = 1, size(parts)
         if (ieee_is_finite(errors(1, i))) errors(1, i) = larger(errors(1, i), &
            edge_doubt(parts(i), grids(1)%edges(i), changes(:, i), errors(:, i)))
         ! a grid on which nothing yields has another contact than the result
         if (parts(i) == without_yield .and. .not. has_yielded) changes(:, i) = not_known()
      end do
   end subroutine measure_changes

   !> What edges may do to the change of a contact area, with their standard deviation `edges`:
   !> where it is by yielding, no more than the largest pressure changes (three times as much as the
   !> area in all of 70 contacts).
   pure function edge_doubt(part, edges, change, error) result(doubt)
      integer, intent(in) :: part
      real(wp), intent(in) :: edges, change(compared_count), error(compared_count)
      real(wp) :: doubt

      doubt = deviations*edges
      if (part /= without_yield .or. .not. all(ieee_is_finite([doubt, change, error]))) return
      doubt = min(doubt, abs(change(compared_count)) + error(compared_count))
   end function edge_doubt

   !> Whether anything yields under a load.
   pure function yields(row)
      type(dry_row_t), intent(in) :: row
      logical :: yields

      yields = row%plastic_area_fraction > 0.0_wp
   end function yields

   !> The changes on one grid.
   subroutine change_on(sweep, parts, harmonics, pressures, here, error)
      type(dry_sweep_t), intent(in) :: sweep
      integer, intent(in) :: parts(:), harmonics
      real(real32), allocatable, intent(in) :: pressures(:, :)
      type(grid_changes_t), intent(inout) :: here
      type(error_t), allocatable, intent(out) :: error
      type(dry_sweep_t) :: base, lean
      type(dry_row_t) :: without
      integer :: i

      allocate (here%changes(compared_count, size(parts)), source=not_known())
      allocate (here%edges(size(parts)), source=not_known())
      base = sweep
      base%settings%method = method_conjugate_gradient
      base%settings%tolerance = max(base%settings%tolerance, tolerance)
      base%settings%keeps_pressures = .false.
      if (allocated(pressures)) base%settings%starts = pressures
      if (.not. here%is_own) then
         if (is_too_coarse(sweep%grid, here%ratio)) return
         call resample(base, here%ratio, error)
         if (allocated(error)) return
         if (allocated(pressures)) call resample_pressures(sweep%grid, base%grid, pressures, &
            base%settings%starts, error)
         if (allocated(error)) return
      end if
      if (.not. allocated(here%with)) then
         allocate (here%with)
         call solve_one(base, here%with, error)
         if (allocated(error)) return
      end if
      if (.not. here%with%is_converged) return
      do i = 1, size(parts)
         lean = base
         select case (parts(i))
         case (without_yield)
            lean%loads%hardness = no_hardness
         case (without_fine_harmonics)
            ! both halves must be on the grid
            if (2*harmonics >= shorter_side(base%grid)) cycle
            call truncate_harmonics(harmonics/2, [base%grid%nx, base%grid%ny], lean%height, error)
            if (allocated(error)) return
         case default   ! without_images
            call change_of_images(base, here%changes(:, i), here%edges(i), error)
            if (allocated(error)) return
            cycle
         end select
         call solve_one(lean, without, error)
         if (allocated(error)) return
         call compare(base%grid, here%with, without, here%changes(:, i), here%edges(i))
      end do
   end subroutine change_on

   !> The change without the images of a periodic surface (of an open one: there are none), with the
   !> same elements of pressure, and what edges do to it.
   subroutine change_of_images(base, change, edges, error)
      type(dry_sweep_t), intent(in) :: base
      real(wp), intent(out) :: change(compared_count), edges
      type(error_t), allocatable, intent(out) :: error
      type(dry_sweep_t) :: here, other
      type(dry_row_t) :: with, without

      here = base
      if (allocated(here%settings%starts)) deallocate (here%settings%starts)
      other = here
      if (base%grid%kernel /= kernel_open) then
         here%grid%kernel = kernel_element
         call open_up(other)
      else
         other%grid%kernel = kernel_element
      end if
      call solve_one(here, with, error)
      if (allocated(error)) return
      call solve_one(other, without, error)
      if (allocated(error)) return
      call compare(base%grid, with, without, change, edges)
   end subroutine change_of_images

   !> The relative change of the quantities from `with` to `without`, and the standard deviation of
   !> that of the contact area because of its edges.
   pure subroutine compare(grid, with, without, change, edges)
      type(dry_grid_t), intent(in) :: grid
      type(dry_row_t), intent(in) :: with, without
      real(wp), intent(out) :: change(compared_count), edges
      real(wp) :: nodes

      change = quotient(compared_values(without), compared_values(with)) - 1.0_wp
      nodes = real(grid%nx, wp)*grid%ny
      edges = quotient(sqrt((with%contact_edges + without%contact_edges)*uniform_variance), &
         with%contact_area_fraction*nodes)
   end subroutine compare

   !> Makes a periodic domain an open one, with the body that touches at x = y = 0 in its middle.
   subroutine open_up(sweep)
      type(dry_sweep_t), intent(inout) :: sweep

      associate (grid => sweep%grid)
         grid%kernel = kernel_open
         sweep%height = reshape(cshift(cshift(reshape(sweep%height, [grid%nx, grid%ny]), &
            -(grid%nx/2), 1), -(grid%ny/2), 2), [grid%nx*grid%ny])
      end associate
   end subroutine open_up

   !> What a sweep gives under its load; not converged where nothing touches.
   subroutine solve_one(sweep, row, error)
      type(dry_sweep_t), intent(in) :: sweep
      type(dry_row_t), intent(out) :: row
      type(error_t), allocatable, intent(out) :: error
      type(dry_outcome_t) :: outcome

      call solve_dry_sweep(sweep%grid, sweep%height, sweep%scaling, sweep%loads, sweep%settings, &
         outcome, error)
      if (.not. allocated(error)) then
         row = outcome%rows(1)
      else if (error%kind == input_error) then
         row%is_converged = .false.   ! nothing touches on this grid
         deallocate (error)
      end if
   end subroutine solve_one

   !> Relative `change` of the quantities of an area, `values`, where profiles along x take its
   !> place, the mean of several, each under the same mean pressure; `error_of` is that of the mean,
   !> not known where all have the same value though they differ in others, which tells nothing of
   !> the profiles between them. Fails (internal_error) if FFTW does.
   subroutine measure_profiles(sweep, values, change, error_of, error)
      type(dry_sweep_t), intent(in) :: sweep
      real(wp), intent(in) :: values(compared_count)
      real(wp), intent(out) :: change(compared_count), error_of(compared_count)
      type(error_t), allocatable, intent(out) :: error
      type(dry_sweep_t) :: line
      real(wp) :: found(compared_count, profiles), edges(profiles)
      type(dry_row_t) :: row
      integer :: i, y

      line = sweep
      line%settings%method = method_conjugate_gradient
      line%settings%tolerance = max(line%settings%tolerance, tolerance)
      line%settings%keeps_pressures = .false.
      line%grid = dry_grid_t(sweep%grid%nx, 1, 1.0_wp, sweep%grid%kernel)
      do i = 1, profiles
         y = ((2*i - 1)*sweep%grid%ny)/(2*profiles)
         line%height = sweep%height(y*sweep%grid%nx + 1:(y + 1)*sweep%grid%nx)
         line%scaling = new_dry_scaling(line%height, sweep%scaling%length, &
            sweep%scaling%reduced_modulus)
         call solve_one(line, row, error)
         if (allocated(error)) return
         found(:, i) = quotient(compared_values(row), values) - 1.0_wp
         edges(i) = quotient(sqrt(row%contact_edges*uniform_variance), values(1)*sweep%grid%nx)
      end do
      change = sum(found, dim=2)/profiles
      error_of = students_t*sqrt(sum((found - spread(change, 2, profiles))**2, &
         dim=2)/(profiles*(profiles - 1.0_wp)))
      if (any(exceeds(error_of, spacing(1.0_wp)))) then
         where (.not. exceeds(error_of, spacing(1.0_wp))) error_of = not_known()
      end if
      ! where all that touches yields, edges of all profiles may err alike, and make all of a change
      if (ieee_is_finite(error_of(1))) error_of(1) = larger(error_of(1), &
         min(deviations*sum(edges)/profiles, abs(change(1))))
   end subroutine measure_profiles

   !> Nodes of the shorter side.
   pure function shorter_side(grid) result(nodes)
      type(dry_grid_t), intent(in) :: grid
      integer :: nodes

      nodes = grid%nx
      if (grid%ny > 1) nodes = min(grid%nx, grid%ny)
   end function shorter_side

end module dry_ablations

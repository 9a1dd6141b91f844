!> A dry contact as it is solved, and the same on other grids.
module dry_resampling
   use, intrinsic :: iso_fortran_env, only: real32
   use dry_problem, only: dry_grid_t, kernel_open
   use dry_scaling, only: dry_scaling_t
   use dry_settings, only: dry_loads_t, dry_settings_t
   use errors, only: error_t
   use fourier_resampling, only: resample_heights
   use kinds, only: wp
   use open_resampling, only: interpolate_heights
   implicit none (type, external)
   private

   public :: dry_sweep_t, is_too_coarse, resample, resample_pressures

   !> What is solved, and how: arguments of `solve_dry_sweep`.
   type :: dry_sweep_t
      type(dry_grid_t) :: grid
      !> Heights (nx*ny) [m].
      real(wp), allocatable :: height(:)
      type(dry_scaling_t) :: scaling
      type(dry_loads_t) :: loads
      type(dry_settings_t) :: settings
   end type dry_sweep_t

   !> Fewest nodes a side.
   integer, parameter :: min_nodes = 8
   !> Share of the mean contact pressure below which a resampled pressure is none.
   real(wp), parameter :: least_pressure = 0.05_wp

contains

   !> True if a side of `grid` or of one `ratio` times as coarse has too few nodes.
   pure function is_too_coarse(grid, ratio)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: ratio
      logical :: is_too_coarse
      integer :: least

      least = grid%nx
      if (grid%ny > 1) least = min(grid%nx, grid%ny)
      is_too_coarse = least < min_nodes*max(ratio, 1.0_wp)
   end function is_too_coarse

   !> Takes a sweep to a grid `ratio` times as coarse. Fails (internal_error) if FFTW does.
   subroutine resample(sweep, ratio, error)
      type(dry_sweep_t), intent(inout) :: sweep
      real(wp), intent(in) :: ratio
      type(error_t), allocatable, intent(out) :: error
      type(dry_grid_t) :: old

      old = sweep%grid
      sweep%grid%nx = other_count(old%nx, ratio)
      sweep%grid%ny = other_count(old%ny, ratio)
      call resample_field(old, sweep%grid, sweep%height, error)
   end subroutine resample

   !> Takes `field` (nx*ny) from the grid `old` to `new`. Fails (internal_error) if FFTW does.
   subroutine resample_field(old, new, field, error)
      type(dry_grid_t), intent(in) :: old, new
      real(wp), allocatable, intent(inout) :: field(:)
      type(error_t), allocatable, intent(out) :: error

      if (old%kernel == kernel_open) then
         call interpolate_heights([old%nx, old%ny], [new%nx, new%ny], field)
      else
         call resample_heights([old%nx, old%ny], [new%nx, new%ny], field, error)
      end if
   end subroutine resample_field

   !> The `pressures` (nx*ny, loads) of the grid `old` on `new`, `starts`: none where they ripple
   !> about 0, and with the same loads. Fails (internal_error) if FFTW does.
   subroutine resample_pressures(old, new, pressures, starts, error)
      type(dry_grid_t), intent(in) :: old, new
      real(real32), intent(in) :: pressures(:, :)
      real(real32), allocatable, intent(out) :: starts(:, :)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: p(:)
      real(wp) :: total
      integer :: i

      allocate (starts(new%nx*new%ny, size(pressures, 2)))
      do i = 1, size(pressures, 2)
         p = pressures(:, i)
         total = sum(p)
         associate (least => least_pressure*total/max(count(p > 0.0_wp), 1))
            call resample_field(old, new, p, error)
            if (allocated(error)) return
            where (p < least) p = 0.0_wp
         end associate
         ! a contact that is lost between the nodes starts from the mean
         if (sum(p) <= 0.0_wp) p = 1.0_wp
         starts(:, i) = real(p*(total/sum(p)*size(p)/size(pressures, 1)), real32)
      end do
   end subroutine resample_pressures

   !> About `nodes`/`ratio` (1 of a line's single one): odd where they are, which decides whether a
   !> node lies in the middle; else even, 64 to 128 times a power of two: such grids have good first
   !> guesses and fast transforms.
   pure function other_count(nodes, ratio) result(count)
      integer, intent(in) :: nodes
      real(wp), intent(in) :: ratio
      integer :: count
      integer :: unit

      count = 1
      if (nodes == 1) return
      count = 2*nint(0.5_wp*(nodes/ratio - 1.0_wp)) + 1
      if (mod(nodes, 2) == 1) return
      unit = 2
      do while (nodes/ratio >= 128*unit)
         unit = 2*unit
      end do
      count = unit*nint(nodes/(ratio*unit))
   end function other_count

end module dry_resampling

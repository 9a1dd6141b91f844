!> /surface of a dry result: shape of the undeformed, loaded and unloaded surface, in SI.
module dry_surface_section
   use dry_case, only: dry_case_t
   use dry_quantities, only: dry_fields_t
   use errors, only: error_t
   use hdf5_axes, only: make_counter, write_field
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use roughness, only: bearing_ratio, height_density, power_spectrum, rms_curvature, rms_slope
   implicit none (type, external)
   private

   public :: write_surface

   !> Levels of the bearing curves, and steps of the height densities.
   integer, parameter :: bearing_levels = 201, density_steps = 50

   !> What is stored of the surface before, under and after loading.
   type :: surface_state_t
      real(wp), allocatable :: bearing_ratio(:), height_density(:)
      !> Of periodic surfaces only.
      real(wp) :: rms_slope = 0.0_wp, rms_curvature = 0.0_wp
      real(wp), allocatable :: power(:)
   end type surface_state_t

contains

   !> /surface: slope, curvature, bearing curves, height density, spectrum, in all three states.
   subroutine write_surface(file, dry, fields, error)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_fields_t), intent(in) :: fields
      type(error_t), allocatable, intent(out) :: error
      type(surface_state_t) :: before, loaded, unloaded
      type(error_t), allocatable :: failure
      real(wp) :: edges(density_steps + 1), highest, levels(bearing_levels), lowest
      integer :: i, k

      associate (z => dry%height)
         lowest = minval(z)
         highest = maxval(z)
      end associate
      levels = [(lowest + (highest - lowest)*real(i, wp)/(bearing_levels - 1), i=0, &
         bearing_levels - 1)]
      edges = [(lowest + (highest - lowest)*real(i, wp)/density_steps, i=0, density_steps)]
      call write_field(file, '/surface/level', levels, new_label('height of the bearing curves', &
         'm'), '=')
      call write_field(file, '/surface/density_edge', edges, &
         new_label('ends of the steps of the height densities', 'm'), '=')
      call write_field(file, '/surface/density_height', 0.5_wp*(edges(2:) + &
         edges(:density_steps)), new_label('middle of the steps of the height densities', 'm'), '=')
      ! Two surfaces at a time: they share nothing.
      !$omp parallel do num_threads(min(dry%grid%threads, 2)) schedule(static) private(failure)
      do k = 1, 2
         if (k == 1) then
            call find_state(dry, dry%height, levels, edges, before, failure)
         else
            call find_state(dry, fields%height_loaded, levels, edges, loaded, failure)
         end if
         !$omp critical (surface_failure)
         if (allocated(failure)) error = failure
         !$omp end critical (surface_failure)
      end do
      !$omp end parallel do
      if (allocated(error)) return
      unloaded = before
      if (allocated(fields%height_unloaded)) call find_state(dry, fields%height_unloaded, levels, &
         edges, unloaded, error)
      if (allocated(error)) return
      call write_state(file, 'undeformed', before)
      call write_state(file, 'unloaded', unloaded)
      call write_state(file, 'loaded', loaded)
   end subroutine write_surface

   !> What is stored of the heights `z` (nx*ny) of a state.
   subroutine find_state(dry, z, levels, edges, state, error)
      type(dry_case_t), intent(in) :: dry
      real(wp), contiguous, intent(in) :: z(:)
      real(wp), intent(in) :: levels(:), edges(:)
      type(surface_state_t), intent(out) :: state
      type(error_t), allocatable, intent(out) :: error

      state%bearing_ratio = bearing_ratio(z, levels)
      state%height_density = height_density(z, edges)
      if (dry%is_periodic) call find_slopes(dry, z, state, error)   ! error: the caller returns
   end subroutine find_state

   !> Slope, curvature and spectrum of the heights `z` (nx, ny) of a state, which are periodic.
   subroutine find_slopes(dry, z, state, error)
      type(dry_case_t), intent(in) :: dry
      real(wp), intent(in) :: z(dry%grid%nx, dry%grid%ny)
      type(surface_state_t), intent(inout) :: state
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: dx, dy

      dx = dry%lengths(1)/dry%grid%nx
      dy = dx
      if (dry%grid%ny > 1) dy = dry%lengths(2)/dry%grid%ny
      state%rms_slope = rms_slope(z, dx, dy)
      state%rms_curvature = rms_curvature(z, dx, dy)
      call power_spectrum(z, state%power, error)   ! error: the caller returns
   end subroutine find_slopes

   !> One state of the surface: '/surface/<quantity>_<name>'.
   subroutine write_state(file, name, state)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: name
      type(surface_state_t), intent(in) :: state

      call write_field(file, '/surface/bearing_ratio_'//name, state%bearing_ratio, &
         new_label('share of the surface at or above each level', '1'), 'level')
      call write_field(file, '/surface/height_density_'//name, state%height_density, &
         new_label('share of the surface at a height, over the height', '1/m'), 'density_height')
      if (.not. allocated(state%power)) return
      call write_dataset(file, '/surface/rms_slope_'//name, state%rms_slope, &
         new_label('rms slope from differences of neighbouring nodes', '1'))
      call write_dataset(file, '/surface/rms_curvature_'//name, state%rms_curvature, &
         new_label('rms curvature from second differences of neighbouring nodes', '1/m'))
      if (name == 'undeformed') call make_counter(file, '/surface/harmonic', size(state%power), &
         'number of the harmonic along x')
      call write_field(file, '/surface/power_'//name, state%power, &
         new_label('mean square height in harmonics 1, 2, ... along x', 'm^2'), 'harmonic')
   end subroutine write_state

end module dry_surface_section

!> The sections of a dry result: /scaling, /solution, /sweep and /summary, all in SI.
module dry_result
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use analytic_heights, only: node_positions
   use dry_case, only: dry_case_t
   use dry_problem, only: no_hardness
   use dry_scaling, only: dry_scaling_t, load_number
   use dry_sweep, only: dry_fields_t, dry_outcome_t, dry_row_t
   use errors, only: error_t
   use hdf5_attribute, only: write_attribute
   use hdf5_axes, only: link_object, make_axis, make_counter, name_axes
   use hdf5_dataset, only: label_t, new_label, write_dataset, write_zeros
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use missing_value, only: not_known
   use roughness, only: bearing_ratio, height_density, power_spectrum, rms_curvature, rms_slope, &
      roughness_t
   implicit none (type, external)
   private

   public :: write_dry_result

   !> Levels of the bearing curves, and steps of the height densities.
   integer, parameter :: bearing_levels = 201, density_steps = 50
   !> Quantities of /sweep that /summary repeats for the last load.
   character(len=21), parameter :: summary_names(*) = [character(len=21) :: 'p_max', &
      'contact_area_fraction', &
      'plastic_area_fraction', 'mean_separation']

   !> What is stored of the surface before, under and after loading.
   type :: surface_state_t
      real(wp), allocatable :: bearing_ratio(:), height_density(:)
      !> Of periodic surfaces only.
      real(wp) :: rms_slope = 0.0_wp, rms_curvature = 0.0_wp
      real(wp), allocatable :: power(:)
   end type surface_state_t

contains

   !> Writes the quantities of every load of an `outcome` with their estimated `errors` (none: not
   !> estimated) and the fields of the last. Fails (internal_error) if FFTW does.
   subroutine write_dry_result(file, dry, outcome, errors, error)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      type(dry_row_t), intent(in) :: errors(:)
      type(error_t), allocatable, intent(out) :: error

      associate (rows => outcome%rows, is_line => dry%grid%ny == 1)
         call write_scaling(file, dry, outcome%scaling, rows(size(rows))%mean_pressure)
         call write_fields(file, dry, outcome%fields)
         call write_sweep(file, dry, rows, errors)
         call write_roughness(file, 'undeformed', 'before loading', rows%undeformed, is_line)
         call write_roughness(file, 'loaded', 'under load', rows%loaded, is_line)
         call write_roughness(file, 'unloaded', 'after unloading', rows%unloaded, is_line)
      end associate
      call write_surface(file, dry, outcome%fields, error)
   end subroutine write_dry_result

   !> /scaling: E', and of a periodic rough surface the numbers of the last load on which a contact
   !> of its shape depends, by (3.19) of the thesis E' s/(4 w), with a hardness H_s L/w too; w is
   !> the mean pressure times L. Without load there are none.
   subroutine write_scaling(file, dry, scaling, mean_pressure)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: mean_pressure

      call file%create_group('/scaling')
      call write_attribute(file, '/scaling', 'reduced_modulus', dry%reduced_modulus)
      call write_attribute(file, '/scaling', 'reduced_modulus_units', 'Pa')
      if (.not. dry%is_periodic .or. scaling%is_flat .or. .not. mean_pressure > 0.0_wp) return
      call write_number('similarity_number', load_number(scaling%pressure, mean_pressure))
      if (dry%loads%hardness < no_hardness) call write_number('hardness_number', &
         load_number(dry%loads%hardness, mean_pressure))

   contains

      !> A number without unit.
      subroutine write_number(name, value)
         character(*), intent(in) :: name
         real(wp), intent(in) :: value

         call write_attribute(file, '/scaling', name, value)
         call write_attribute(file, '/scaling', name//'_units', '1')
      end subroutine write_number

   end subroutine write_scaling

   !> /solution.
   subroutine write_fields(file, dry, fields)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_fields_t), intent(in) :: fields

      call write_dataset(file, '/solution/x', node_positions(dry%grid%nx, dry%lengths(1), &
         dry%is_periodic), &
         new_label('position', 'm'))
      call make_axis(file, '/solution/x')
      if (dry%grid%ny > 1) then
         call write_dataset(file, '/solution/y', node_positions(dry%grid%ny, dry%lengths(2), &
            dry%is_periodic), new_label('position across', 'm'))
         call make_axis(file, '/solution/y')
      end if
      call write_field('pressure', fields%pressure, 'contact pressure', 'Pa')
      call write_field('gap', fields%gap, 'gap between the surfaces', 'm')
      call write_field('height_undeformed', dry%height, 'composite height before loading', 'm')
      call write_field('height_loaded', fields%height_loaded, 'composite height under load', 'm')
      if (allocated(fields%plastic_deformation)) then
         call write_field('height_unloaded', fields%height_unloaded, &
            'composite height after unloading', 'm')
         call write_field('plastic_deformation', fields%plastic_deformation, &
            'plastic deformation', 'm')
      else
         call write_field('height_unloaded', dry%height, 'composite height after unloading', 'm')
         call write_no_field('plastic_deformation', 'plastic deformation', 'm')
      end if
      call file%create_group('/si')
      call link_object(file, '/solution', '/si/solution')

   contains

      !> One field (nx, ny), if it is to be stored.
      subroutine write_field(name, values, long_name, units)
         character(*), intent(in) :: name, long_name, units
         real(wp), intent(in) :: values(dry%grid%nx, dry%grid%ny)

         if (.not. is_stored(dry, name)) return
         if (dry%grid%ny == 1) then
            call write_dataset(file, '/solution/'//name, values(:, 1), &
               new_label(long_name, units), dry%is_single)
         else
            call write_dataset(file, '/solution/'//name, values, new_label(long_name, units), &
               dry%is_single)
         end if
         call name_field_axes(file, dry, name)
      end subroutine write_field

      !> A field that is zero everywhere.
      subroutine write_no_field(name, long_name, units)
         character(*), intent(in) :: name, long_name, units
         integer, allocatable :: extents(:)

         if (.not. is_stored(dry, name)) return
         extents = [dry%grid%nx, dry%grid%ny]
         if (dry%grid%ny == 1) extents = [dry%grid%nx]
         call write_zeros(file, '/solution/'//name, extents, new_label(long_name, units), &
            dry%is_single)
         call name_field_axes(file, dry, name)
      end subroutine write_no_field

   end subroutine write_fields

   !> Whether the field `name` is to be stored.
   pure function is_stored(dry, name)
      type(dry_case_t), intent(in) :: dry
      character(*), intent(in) :: name
      logical :: is_stored

      is_stored = size(dry%stored_fields) == 0 .or. any(dry%stored_fields == name)
   end function is_stored

   !> Names the axes of the field `name`.
   subroutine name_field_axes(file, dry, name)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      character(*), intent(in) :: name

      if (dry%grid%ny == 1) then
         call name_axes(file, '/solution/'//name, '/solution/x')
      else
         call name_axes(file, '/solution/'//name, '/solution/x', '/solution/y')
      end if
   end subroutine name_field_axes

   !> /sweep without roughness: one value for each load, and /summary of the last one.
   subroutine write_sweep(file, dry, rows, errors)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_row_t), intent(in) :: rows(:), errors(:)
      character(:), allocatable :: energy_unit, load_unit
      logical :: is_line

      call make_counter(file, '/sweep/step', size(rows), 'number of the load')
      is_line = dry%grid%ny == 1
      load_unit = trim(merge('N/m', 'N  ', is_line))
      energy_unit = trim(merge('J/m', 'J  ', is_line))
      if (allocated(dry%loads%separation)) then
         call write_estimated('mean_pressure', rows%mean_pressure, errors%mean_pressure, &
            'load over nominal area', 'Pa')
         call write_estimated('load', rows%load, errors%load, 'load', load_unit)
      else
         call write_column(file, 'mean_pressure', rows%mean_pressure, &
            new_label('load over nominal area', 'Pa'))
         call write_column(file, 'load', rows%load, new_label('load', load_unit))
      end if
      call write_estimated('contact_area_fraction', rows%contact_area_fraction, &
         errors%contact_area_fraction, &
         'nodes with p > 0 over all', '1')
      if (.not. is_line) call write_estimated('contact_area_fraction_corrected', &
         rows%contact_area_corrected, &
         errors%contact_area_corrected, 'contact area less (pi - 1 + ln 2)/24 of its perimeter', &
            '1')
      call write_estimated('plastic_area_fraction', rows%plastic_area_fraction, &
         errors%plastic_area_fraction, &
         'nodes with p = hardness over all', '1')
      call write_estimated('plasticity_index', rows%plasticity_index, errors%plasticity_index, &
         'plastic over contact area', '1')
      call write_estimated('mean_separation', rows%mean_separation, errors%mean_separation, &
         'plane to mean of the loaded surface', 'm')
      if (dry%is_periodic) then
         call write_estimated('separation', rows%separation, errors%separation, &
            'plane to mean of the undeformed surface', 'm')
      else if (.not. is_line) then
         call write_estimated('separation', rows%separation, errors%separation, &
            'approach of the bodies since first touch', 'm')
      end if
      call write_estimated('datum', rows%datum, errors%datum, &
         'mean of deflection less height where 0 < p < hardness', 'm')
      call write_estimated('p_max', rows%p_max, errors%p_max, 'largest pressure', 'Pa')
      call write_estimated('dp_max', rows%dp_max, errors%dp_max, 'largest plastic deformation', 'm')
      call write_estimated('dp_mean', rows%dp_mean, errors%dp_mean, 'mean plastic deformation', 'm')
      call write_estimated('elastic_energy', rows%elastic_energy, errors%elastic_energy, &
         'stored elastic energy', energy_unit)
      call write_estimated('dissipated_energy', rows%dissipated_energy, errors%dissipated_energy, &
         'energy dissipated by plastic deformation', energy_unit)
      call write_column(file, 'kkt', rows%kkt, &
         new_label('violation of the contact conditions', '1'))
      call write_dataset(file, '/sweep/fft_pairs', int(rows%fft_pairs, int64), &
         new_label('pairs of transforms, in pairs of the full grid', '1'))
      call name_axes(file, '/sweep/fft_pairs', '/sweep/step')

   contains

      !> One column with its estimated errors, and its last value in /summary if that has it.
      subroutine write_estimated(name, values, estimates, long_name, units)
         character(*), intent(in) :: name, long_name, units
         real(wp), intent(in) :: values(:), estimates(:)
         real(wp) :: known(size(values))
         character(:), allocatable :: missing

         known = not_known()
         missing = 'no other grids are compared'
         if (size(estimates) > 0) then
            known = estimates
            missing = 'no solution, or too few other grids with one'
         end if
         call write_column(file, name, values, new_label(long_name, units))
         call write_attribute(file, '/sweep/' // name, 'error_estimate', known)
         if (.not. all(ieee_is_finite(known))) call write_attribute(file, '/sweep/' // name, &
            'no_estimate', missing)
         if (.not. any(summary_names == name)) return
         associate (last => size(values))
            call write_dataset(file, '/summary/' // name, values(last), new_label(long_name, units))
            if (units == '1') call write_attribute(file, '/summary/' // name, 'units', units)
            call write_attribute(file, '/summary/' // name, 'error_estimate', known(last))
            if (.not. ieee_is_finite(known(last))) call write_attribute(file, &
               '/summary/' // name, 'no_estimate', missing)
         end associate
      end subroutine write_estimated

   end subroutine write_sweep

   !> One column of /sweep.
   subroutine write_column(file, name, values, label)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      type(label_t), intent(in) :: label
      real(wp) :: copy(size(values))

      copy = values
      call write_dataset(file, '/sweep/'//name, copy, label)
      call name_axes(file, '/sweep/'//name, '/sweep/step')
   end subroutine write_column

   !> /sweep/<name>_undeformed, _loaded or _unloaded: the roughness parameters of a state for each
   !> load.
   subroutine write_roughness(file, state, when, roughness, is_line)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: state, when
      type(roughness_t), intent(in) :: roughness(:)
      logical, intent(in) :: is_line
      character(:), allocatable :: height

      height = 'highest less lowest'
      if (is_line) height = height//', mean of five parts'
      call write_column(file, 'ra_'//state, roughness%ra, &
         new_label('arithmetic mean height '//when, 'm'))
      call write_column(file, 'rq_'//state, roughness%rq, &
         new_label('rms height '//when, 'm'))
      call write_column(file, 'rz_'//state, roughness%rz, &
         new_label(height//' '//when, 'm'))
      call write_column(file, 'rsk_'//state, roughness%rsk, &
         new_label('skewness '//when, '1'))
      call write_column(file, 'rku_'//state, roughness%rku, &
         new_label('kurtosis '//when, '1'))
   end subroutine write_roughness

   !> /surface: slope, curvature, bearing curves, height density and spectrum of the undeformed,
   !> loaded and unloaded surface.
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
      call write_dataset(file, '/surface/level', levels, new_label('height of the bearing '// &
         'curves', 'm'))
      call make_axis(file, '/surface/level')
      call write_dataset(file, '/surface/density_edge', edges, &
         new_label('ends of the steps of the height densities', 'm'))
      call make_axis(file, '/surface/density_edge')
      call write_dataset(file, '/surface/density_height', 0.5_wp*(edges(2:) &
         + edges(:density_steps)), new_label('middle of the steps of the height densities', 'm'))
      call make_axis(file, '/surface/density_height')
      ! Two surfaces are looked at side by side; nothing of theirs is shared.
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
      if (dry%is_periodic) call find_slopes(dry, z, state, error)   ! error: the caller looks
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
      call power_spectrum(z, state%power, error)   ! error: the caller looks
   end subroutine find_slopes

   !> One state of the surface: '/surface/<quantity>_<name>'.
   subroutine write_state(file, name, state)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: name
      type(surface_state_t), intent(in) :: state

      call write_dataset(file, '/surface/bearing_ratio_'//name, state%bearing_ratio, &
         new_label('share of the surface at or above each level', '1'))
      call write_dataset(file, '/surface/height_density_'//name, state%height_density, &
         new_label('share of the surface at a height, over the height', '1/m'))
      call name_axes(file, '/surface/bearing_ratio_'//name, '/surface/level')
      call name_axes(file, '/surface/height_density_'//name, '/surface/density_height')
      if (.not. allocated(state%power)) return
      call write_dataset(file, '/surface/rms_slope_'//name, state%rms_slope, &
         new_label('rms slope', '1'))
      call write_dataset(file, '/surface/rms_curvature_'//name, state%rms_curvature, &
         new_label('rms curvature', '1/m'))
      call write_dataset(file, '/surface/power_'//name, state%power, &
         new_label('mean square height in harmonics 1, 2, ... along x', 'm^2'))
      if (name == 'undeformed') call make_counter(file, '/surface/harmonic', size(state%power), &
         'number of the harmonic along x')
      call name_axes(file, '/surface/power_'//name, '/surface/harmonic')
   end subroutine write_state

end module dry_result

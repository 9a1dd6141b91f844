!> The sections of a dry result, all in SI: /scaling, /solution, /sweep and /summary; /surface by
!> module dry_surface_section.
module dry_result
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use analytic_heights, only: node_positions
   use dry_case, only: dry_case_t
   use dry_problem, only: no_hardness
   use dry_scaling, only: dry_scaling_t, load_number
   use dry_surface_section, only: write_surface
   use dry_sweep, only: dry_fields_t, dry_outcome_t, dry_row_t
   use errors, only: error_t
   use hdf5_attribute, only: write_attribute
   use hdf5_axes, only: link_object, make_counter, name_axes, write_field
   use hdf5_dataset, only: label_t, new_label, write_dataset, write_zeros
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use missing_value, only: not_known
   use roughness, only: roughness_t
   implicit none (type, external)
   private

   public :: write_dry_result

   !> Quantities of /sweep that /summary repeats for the last load.
   character(len=21), parameter :: summary_names(*) = [character(len=21) :: 'p_max', &
      'contact_area_fraction', &
      'plastic_area_fraction', 'mean_separation']

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
      call write_costs(file, outcome)
      call write_surface(file, dry, outcome%fields, error)
   end subroutine write_dry_result

   !> What the solution took: /report/cpu_..., /report/transforms.
   subroutine write_costs(file, outcome)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_outcome_t), intent(in) :: outcome

      call write_dataset(file, '/report/cpu_seconds', outcome%cpu_prepare + outcome%cpu_solve, &
         new_label('processor time of the solution, planning of the transforms included', 's'))
      call write_dataset(file, '/report/cpu_prepare_seconds', outcome%cpu_prepare, &
         new_label('the part for planning', 's'))
      call write_dataset(file, '/report/wall_solve_seconds', outcome%wall_solve, &
         new_label('wall time of the solution without planning', 's'))
      call write_dataset(file, '/report/transforms', real(outcome%transforms, wp), &
         new_label('transforms: size in x, in y, pairs in double, pairs in single precision', '1'))
      call make_counter(file, '/report/grid', size(outcome%transforms, 2), &
         'number of the grid of the transforms')
      call make_counter(file, '/report/transform_column', size(outcome%transforms, 1), &
         'number of: size in x, in y, pairs in double, pairs in single precision')
      call name_axes(file, '/report/transforms', 'transform_column grid')
   end subroutine write_costs

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
      character(:), allocatable :: axes

      axes = trim(merge('x  ', 'x y', dry%grid%ny == 1))
      call write_field(file, '/solution/x', node_positions(dry%grid%nx, dry%lengths(1), &
         dry%is_periodic), new_label('position', 'm'), '=')
      if (dry%grid%ny > 1) call write_field(file, '/solution/y', node_positions(dry%grid%ny, &
         dry%lengths(2), dry%is_periodic), new_label('position across', 'm'), '=')
      call put('pressure', fields%pressure, 'contact pressure', 'Pa')
      call put('gap', fields%gap, 'gap between the surfaces', 'm')
      call put('height_undeformed', dry%height, 'composite height before loading', 'm')
      call put('height_loaded', fields%height_loaded, 'composite height under load', 'm')
      if (allocated(fields%plastic_deformation)) then
         call put('height_unloaded', fields%height_unloaded, &
            'composite height after unloading', 'm')
         call put('plastic_deformation', fields%plastic_deformation, &
            'plastic deformation', 'm')
      else
         call put('height_unloaded', dry%height, 'composite height after unloading', 'm')
         call write_no_field('plastic_deformation', 'plastic deformation', 'm')
      end if
      call file%create_group('/si')
      call link_object(file, '/solution', '/si/solution')

   contains

      !> One field (nx, ny), if it is to be stored.
      subroutine put(name, values, long_name, units)
         character(*), intent(in) :: name, long_name, units
         real(wp), intent(in) :: values(dry%grid%nx, dry%grid%ny)

         if (.not. is_stored(name)) return
         if (dry%grid%ny == 1) then
            call write_dataset(file, '/solution/'//name, values(:, 1), &
               new_label(long_name, units), dry%is_single)
         else
            call write_dataset(file, '/solution/'//name, values, new_label(long_name, units), &
               dry%is_single)
         end if
         call name_axes(file, '/solution/'//name, axes)
      end subroutine put

      !> A field that is zero everywhere.
      subroutine write_no_field(name, long_name, units)
         character(*), intent(in) :: name, long_name, units

         if (.not. is_stored(name)) return
         call write_zeros(file, '/solution/'//name, pack([dry%grid%nx, dry%grid%ny], &
            [.true., dry%grid%ny > 1]), new_label(long_name, units), dry%is_single)
         call name_axes(file, '/solution/'//name, axes)
      end subroutine write_no_field

      !> Whether the field `name` is to be stored.
      pure function is_stored(name)
         character(*), intent(in) :: name
         logical :: is_stored

         is_stored = size(dry%stored_fields) == 0 .or. any(dry%stored_fields == name)
      end function is_stored

   end subroutine write_fields

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
      call name_axes(file, '/sweep/fft_pairs', 'step')

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
      call write_field(file, '/sweep/'//name, copy, label, 'step')
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

end module dry_result

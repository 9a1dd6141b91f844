!> What is written and printed of a dry case, all in SI: the sections /scaling, /solution, /sweep,
!> /summary, /surface and /adequacy of its result, and its closing table.
module dry_result
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_null_ptr
   use, intrinsic :: iso_fortran_env, only: int64
   use adequacy, only: adequacy_t
   use adequacy_section, only: model_line, write_row
   use features, only: node_positions
   use dry_adequacy, only: compared
   use dry_case, only: dry_case_t
   use dry_problem, only: kernel_open, no_hardness
   use dry_quantities, only: contact_area, dry_count, dry_fields_t, dry_outcome_t, dry_table, &
      load, mean_pressure, mean_separation, p_max, plastic_area, separation
   use hdf5_axes, only: link_object, make_counter, name_axes
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset, write_values
   use kinds, only: not_known, wp
   use progress_log, only: columns, progress_log_t
   use result_labels, only: section_file_t
   use roughness, only: bearing_ratio, height_density, power_spectrum, rms_curvature, rms_slope, &
      roughness_t
   use text, only: counted, joined, number_text, to_text, wrapped
   implicit none (type, external)
   private

   public :: close_dry_case, write_dry_adequacy, write_dry_result

   !> States of the surface with a roughness.
   character(len=10), parameter :: states(3) = [character(len=10) :: 'undeformed', 'loaded', &
      'unloaded']
   character(len=15), parameter :: times(3) = [character(len=15) :: 'before loading', &
      'under load', 'after unloading']

   !> Levels of the bearing curves, and those in a step of the height densities.
   integer, parameter :: bearing_levels = 201, density_levels = 4

   !> What is stored of the surface before, under and after loading.
   type :: surface_state_t
      real(wp), allocatable :: bearing_ratio(:), height_density(:)
      !> Of periodic surfaces only.
      real(wp) :: rms_slope = 0.0_wp, rms_curvature = 0.0_wp
      real(wp), allocatable :: power(:)
   end type surface_state_t

   !> A relative error below this is printed as none.
   real(wp), parameter :: rounding = 1.0e-7_wp
   !> Quantities with an error in the table.
   integer, parameter :: columns_with_error(*) = [contact_area, plastic_area, &
      mean_separation, p_max]

contains

   !> Writes the quantities of every load of an `outcome` with their estimated errors and the
   !> fields of the last.
   subroutine write_dry_result(file, dry, outcome)
      type(section_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      character(*), parameter :: sizes = 'size in x, in y, pairs in double, pairs in single '// &
         'precision'
      integer :: k

      associate (rows => outcome%rows)
         call file%create_group('/scaling')
         call write_attribute(file, '/scaling', 'reduced_modulus', dry%reduced_modulus, 'Pa')
         ! the numbers of the last load on which the contact of a periodic rough surface of its
         ! shape depends, by (3.19) of the thesis E' s/(4 w), with a hardness H_s L/w too; w is the
         ! mean pressure times L
         associate (p => rows(size(rows))%values(mean_pressure))
            if (dry%is_periodic .and. p > 0.0_wp .and. .not. outcome%scaling%is_flat) then
               call write_attribute(file, '/scaling', 'similarity_number', &
                  outcome%scaling%pressure/p, '1')
               if (dry%loads%hardness < no_hardness) call write_attribute(file, '/scaling', &
                  'hardness_number', dry%loads%hardness/p, '1')
            end if
         end associate
         call write_fields(file, dry, outcome%fields)
         call make_counter(file, '/sweep/step', size(rows), 'number of the load')
         do k = 1, dry_count
            call write_quantity(file, dry, outcome, k)
         end do
         call file%begin('/sweep')
         call file%put('kkt', [rows%kkt], 'violation of the contact conditions', axes='step')
         call write_dataset(file, '/sweep/fft_pairs', int(rows%fft_pairs, int64), &
            new_label('pairs of transforms, in pairs of the full grid', '1'))
         call name_axes(file, '/sweep/fft_pairs', 'step')
         do k = 1, size(states)
            call write_roughness(file, k, rows%roughness(k), dry%grid%ny == 1)
         end do
      end associate
      call file%begin('/report')
      call file%put('cpu_seconds', sum(outcome%seconds(:2)), &
         'processor time of the solution, planning of the transforms included', 's')
      call file%put('cpu_prepare_seconds', outcome%seconds(1), 'the part for planning', 's')
      call file%put('wall_solve_seconds', outcome%seconds(3), &
         'wall time of the solution without planning', 's')
      call file%put('transforms', real(outcome%transforms, wp), 'transforms: '//sizes)
      call make_counter(file, '/report/grid', size(outcome%transforms, 2), &
         'number of the grid of the transforms')
      call make_counter(file, '/report/transform_column', size(outcome%transforms, 1), &
         'number of: '//sizes)
      call name_axes(file, '/report/transforms', 'transform_column grid')
      if (.not. allocated(file%row)) call write_surface(file, dry, outcome%fields)
   end subroutine write_dry_result

   !> /solution.
   subroutine write_fields(file, dry, fields)
      type(section_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_fields_t), intent(in) :: fields
      character(*), parameter :: unloaded = 'composite height after unloading'

      call file%begin('/solution')
      call file%put('x', node_positions(dry%grid%nx, dry%lengths(1), dry%is_periodic), 'position', &
         'm', '=')
      if (dry%grid%ny > 1) call file%put('y', node_positions(dry%grid%ny, dry%lengths(2), &
         dry%is_periodic), 'position across', 'm', '=')
      call put('pressure', 'contact pressure', 'Pa', fields%pressure)
      call put('gap', 'gap between the surfaces', 'm', fields%gap)
      call put('height_undeformed', 'composite height before loading', 'm', dry%height)
      call put('height_loaded', 'composite height under load', 'm', fields%height_loaded)
      if (allocated(fields%height_unloaded)) then
         call put('height_unloaded', unloaded, 'm', fields%height_unloaded)
      else
         call put('height_unloaded', unloaded, 'm', dry%height)
      end if
      call put('plastic_deformation', 'plastic deformation', 'm', fields%plastic_deformation)
      call file%create_group('/si')
      call link_object(file, '/solution', '/si/solution')

   contains

      !> One field (nx, ny), if it is to be stored; without values it is zero everywhere.
      subroutine put(name, long_name, units, values)
         character(*), intent(in) :: name, long_name, units
         real(wp), intent(in), optional :: values(dry%grid%nx, dry%grid%ny)
         character(:), allocatable :: path
         type(label_t) :: label

         if (size(dry%stored_fields) > 0 .and. .not. any(dry%stored_fields == name)) return
         path = '/solution/'//name
         label = new_label(long_name, units)
         associate (nx => dry%grid%nx, ny => dry%grid%ny)
            if (.not. present(values)) then
               call write_values(file, path, file%real_type, pack([nx, ny], [.true., ny > 1]), &
                  c_null_ptr, label, dry%is_single)
            else if (ny == 1) then
               call write_dataset(file, path, values(:, 1), label, dry%is_single)
            else
               call write_dataset(file, path, values, label, dry%is_single)
            end if
            call name_axes(file, path, trim(merge('x  ', 'x y', ny == 1)))
         end associate
      end subroutine put

   end subroutine write_fields

   !> Quantity `k` of the table, one value for each load, with its estimated errors unless it is
   !> given; that of the last load in /summary. Without a unit it is not stored.
   subroutine write_quantity(file, dry, outcome, k)
      type(section_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      integer, intent(in) :: k
      real(wp) :: errors(size(outcome%rows))
      character(:), allocatable :: missing, name, text, unit

      text = trim(dry_table(k)%text)
      unit = trim(dry_table(k)%units(merge(1, 2, dry%grid%ny == 1)))
      if (k == separation .and. dry%grid%kernel == kernel_open) then
         text = 'approach of the bodies since first touch'
         if (dry%grid%ny == 1) unit = ''
      end if
      if (unit == '') return
      name = trim(dry_table(k)%name)
      call file%begin('/sweep')
      call file%put(name, [outcome%rows%values(k)], text, unit, 'step')
      if (any(k == [load, mean_pressure]) .and. allocated(dry%loads%mean_pressure)) return
      errors = not_known()
      missing = 'no other grids are compared'
      if (allocated(outcome%errors)) then
         errors = outcome%errors(k, :)
         missing = 'no solution, or too few other grids with one'
      end if
      call write_attribute(file, '/sweep/'//name, 'error_estimate', errors)
      if (.not. all(ieee_is_finite(errors))) call write_attribute(file, '/sweep/'//name, &
         'no_estimate', missing)
      if (.not. dry_table(k)%is_summary) return
      call file%begin('/summary')
      associate (last => size(errors), path => '/summary/'//name)
         call file%put(name, outcome%rows(last)%values(k), text, unit)
         if (unit == '1') call write_attribute(file, path, 'units', unit)
         call write_attribute(file, path, 'error_estimate', errors(last))
         if (.not. ieee_is_finite(errors(last))) call write_attribute(file, path, 'no_estimate', &
            missing)
      end associate
   end subroutine write_quantity

   !> /sweep/<name>_<state>: the roughness parameters of state `k` for each load.
   subroutine write_roughness(file, k, roughness, is_line)
      type(section_file_t), intent(inout) :: file
      integer, intent(in) :: k
      type(roughness_t), intent(in) :: roughness(:)
      logical, intent(in) :: is_line
      character(*), parameter :: names(*) = [character(len=3) :: 'ra', 'rq', 'rz', 'rsk', 'rku']
      character(len=44) :: texts(size(names))
      real(wp) :: values(size(roughness), size(names))
      integer :: i

      texts = [character(len=44) :: 'arithmetic mean height', 'rms height', &
         'highest less lowest'//merge(', mean of five parts', repeat(' ', 20), is_line), &
         'skewness', 'kurtosis']
      values = reshape([roughness%ra, roughness%rq, roughness%rz, roughness%rsk, roughness%rku], &
         shape(values))
      do i = 1, size(names)
         call file%put(trim(names(i))//'_'//trim(states(k)), values(:, i), trim(texts(i))//' ' &
            //trim(times(k)), merge('m', '1', i <= 3), 'step')
      end do
   end subroutine write_roughness

   !> /adequacy: a group for each ingredient, with a dataset for each known change.
   subroutine write_dry_adequacy(file, adequacy)
      type(section_file_t), intent(inout) :: file
      type(adequacy_t), intent(in) :: adequacy
      integer :: i

      if (.not. allocated(adequacy%rows)) return
      do i = 1, size(adequacy%rows)
         call write_row(file, adequacy%rows(i), dry_table%name, compared)
      end do
      if (size(adequacy%rows) == 0) call file%create_group('/adequacy')
      call write_attribute(file, '/adequacy', 'about', 'relative change under '// &
         'mean_pressure, the largest of the sweep, where an ingredient is left out, measured '// &
         'on coarser grids; of the grid the error estimate; attribute error_estimate: error '// &
         'of the change; no dataset: not known')
      call write_attribute(file, '/adequacy', 'accuracy', adequacy%accuracy)
      call write_attribute(file, '/adequacy', 'mean_pressure', adequacy%mean_pressure)
      call write_attribute(file, '/adequacy', 'judged_by', joined(dry_table(compared)%name, ', '))
   end subroutine write_dry_adequacy

   !> /surface: slope, curvature, bearing curves, height density, spectrum, in all three states.
   subroutine write_surface(file, dry, fields)
      type(section_file_t), intent(inout) :: file
      type(dry_case_t), intent(in) :: dry
      type(dry_fields_t), intent(in) :: fields
      type(surface_state_t) :: of(size(states))
      real(wp) :: highest, levels(bearing_levels), lowest
      real(wp), allocatable :: edges(:)
      integer :: i, k

      lowest = minval(dry%height)
      highest = maxval(dry%height)
      levels = [(lowest + (highest - lowest)*real(i, wp)/(bearing_levels - 1), i=0, &
         bearing_levels - 1)]
      edges = levels(::density_levels)
      call file%begin('/surface')
      call file%put('level', levels, 'height of the bearing curves', 'm', '=')
      call file%put('density_edge', edges, 'ends of the steps of the height densities', 'm', '=')
      call file%put('density_height', 0.5_wp*(edges(2:) + edges(:size(edges) - 1)), &
         'middle of the steps of the height densities', 'm', '=')
      ! Two surfaces at a time: they share nothing.
      !$omp parallel do num_threads(min(dry%grid%threads, 2)) schedule(static, 1)
      do k = 1, size(states)
         if (k == 1) then
            call find_state(dry, dry%height, levels, of(1))
         else if (k == 2) then
            call find_state(dry, fields%height_loaded, levels, of(2))
         else if (allocated(fields%height_unloaded)) then
            call find_state(dry, fields%height_unloaded, levels, of(3))
         end if
      end do
      !$omp end parallel do
      if (.not. allocated(fields%height_unloaded)) of(3) = of(1)
      call write_state(file, 'undeformed', of(1))
      call write_state(file, 'unloaded', of(3))
      call write_state(file, 'loaded', of(2))
   end subroutine write_surface

   !> What is stored of the heights `z` (nx*ny) of a state.
   subroutine find_state(dry, z, levels, state)
      type(dry_case_t), intent(in) :: dry
      real(wp), contiguous, target, intent(in) :: z(:)
      real(wp), intent(in) :: levels(:)
      type(surface_state_t), intent(out) :: state
      real(wp), contiguous, pointer :: area(:, :)
      real(wp) :: dx, dy

      state%bearing_ratio = bearing_ratio(z, levels)
      state%height_density = height_density(z, levels(::density_levels), &
         state%bearing_ratio(::density_levels))
      if (.not. dry%is_periodic) return
      dx = dry%lengths(1)/dry%grid%nx
      dy = dx
      if (dry%grid%ny > 1) dy = dry%lengths(2)/dry%grid%ny
      area(1:dry%grid%nx, 1:dry%grid%ny) => z
      state%rms_slope = rms_slope(area, dx, dy)
      state%rms_curvature = rms_curvature(area, dx, dy)
      call power_spectrum(area, state%power)
   end subroutine find_state

   !> One state of the surface: '/surface/<quantity>_<name>'.
   subroutine write_state(file, name, state)
      type(section_file_t), intent(inout) :: file
      character(*), intent(in) :: name
      type(surface_state_t), intent(in) :: state

      call file%put('bearing_ratio_'//name, state%bearing_ratio, &
         'share of the surface at or above each level', '1', 'level')
      call file%put('height_density_'//name, state%height_density, &
         'share of the surface at a height, over the height', '1/m', 'density_height')
      if (.not. allocated(state%power)) return
      call file%put('rms_slope_'//name, state%rms_slope, &
         'rms slope from differences of neighbouring nodes')
      call file%put('rms_curvature_'//name, state%rms_curvature, &
         'rms curvature from second differences of neighbouring nodes', '1/m')
      if (name == 'undeformed') call make_counter(file, '/surface/harmonic', size(state%power), &
         'number of the harmonic along x')
      call file%put('power_'//name, state%power, &
         'mean square height in harmonics 1, 2, ... along x', 'm^2', 'harmonic')
   end subroutine write_state

   !> A table with a line for each load of the case, under it the estimated errors; what there is to
   !> say of the model; `path` of the result.
   subroutine close_dry_case(log, dry, outcome, adequacy, path)
      type(progress_log_t), intent(inout) :: log
      character(*), intent(in) :: path
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      type(adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: table, words
      character(*), parameter :: nl = new_line('a')
      character(len=columns) :: line
      integer :: i

      words = to_text(dry%grid%nx)
      if (dry%grid%ny > 1) words = words // ' x ' // to_text(dry%grid%ny)
      if (dry%target > 0.0_wp) call log%say(log%name // ': solved on ' // words // ' nodes for '// &
         'an error of ' // number_text(100.0_wp*dry%target, 2) // ' % of the contact area')
      associate (rows => outcome%rows, solution => outcome%solution)
         if (solution%report%converged) then
            table = log%name // ': converged, ' // counted(solution%report%cycles, 'iteration') &
               // ', ' // to_text(solution%report%cost%wall_seconds, 3) // ' s'
         else
            table = log%name // ': NOT CONVERGED: ' // solution%report%reason
            if (log%prints_errors_apart()) call log%say_error(table)
         end if
         table = table // nl // &
            '  mean pressure   contact   plastic   separation   largest p      error' // nl
         do i = 1, size(rows)
            associate (values => rows(i)%values)
               write (line, '(ss,2x,es10.3,a,2(f8.3,a),es11.3,a,es10.3,a,es9.1)') &
                  values(mean_pressure), ' Pa', 100.0_wp*values(contact_area), ' %', &
                  100.0_wp*values(plastic_area), ' %', values(mean_separation), ' m', &
                  values(p_max), ' Pa', rows(i)%kkt
               table = table // trim(line) // nl
               if (.not. allocated(outcome%errors)) cycle
               write (line, '(a15,2a10,2a13)') '+-', percent(outcome%errors(:, i), values)
               table = table // trim(line) // nl
            end associate
         end do
         words = model_line(adequacy, is_whole=.true.)
         if (words /= '') table = table // '  ' // wrapped(words, columns - 2, 12) // nl
         if (allocated(solution%report%note)) table = table // '  ' // wrapped('note      ' &
            // solution%report%note, columns - 2) // nl
         call log%print_summary(table // '  result    ' // path)
      end associate
   end subroutine close_dry_case

   !> Errors in percent of the values of a load, as cells of the closing table; '-' if not known.
   pure function percent(errors, values) result(cells)
      real(wp), intent(in) :: errors(:), values(:)
      character(len=10) :: cells(size(columns_with_error))
      integer :: i

      do i = 1, size(cells)
         associate (error => errors(columns_with_error(i)), &
            value => abs(values(columns_with_error(i))))
            cells(i) = '-'
            if (.not. (ieee_is_finite(error) .and. value > 0.0_wp)) cycle
            cells(i) = '0 %'
            if (error > rounding*value) cells(i) = number_text(100.0_wp*error/value, 2)//' %'
         end associate
      end do
      cells = adjustr(cells)
   end function percent

end module dry_result

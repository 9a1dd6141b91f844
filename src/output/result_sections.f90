!> The sections /scaling, /summary and /report of a result.
module result_sections
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use hdf5_axes, only: make_counter, write_field
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use iteration_report, only: breakdown_t, phase_names, report_t
   use kinds, only: exceeds, not_known, wp
   use line_summary, only: line_summary_t, mean_power, quantity_t
   use quantities, only: h_min, mixed_rows, quantity_count, quantity_rows, sliding_rows, &
      x_cavitation
   use result_labels, only: row_label, scaled_label
   use scaling, only: scaling_t, sum_per_mean
   use text, only: joined
   use validity, only: limit_rows, stokes_number, surface_slope
   implicit none (type, external)
   private

   public :: write_breakdown, write_mean_power, write_report, write_scaling, write_summary

contains

   !> /scaling: reference values as attributes, with units; what is unknown is left out.
   subroutine write_scaling(file, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(scaling_t), intent(in) :: scaling
      character(*), parameter :: group = '/scaling'

      call file%create_group(group)
      call write_attribute(file, group, 'about', 'reference values; Moes numbers with '// &
         'the mean velocity u_s/2 (the names in _sum: with u_s = u1 + u2)')
      call write_attribute(file, group, 'lambda', scaling%lambda, '1')
      call write_attribute(file, group, 'alpha_bar', scaling%alpha_bar, '1')
      if (ieee_is_finite(scaling%slide_to_roll)) call write_attribute(file, group, &
         'slide_to_roll', scaling%slide_to_roll, '1')
      call write_attribute(file, group, 'moes_m', scaling%moes_m, '1')
      call write_attribute(file, group, 'moes_l', scaling%moes_l, '1')
      call write_attribute(file, group, 'moes_m_sum', scaling%moes_m*sum_per_mean**merge(-0.75_wp, &
         -0.5_wp, allocated(scaling%ellipse)), '1')
      call write_attribute(file, group, 'moes_l_sum', scaling%moes_l*sum_per_mean**0.25_wp, '1')
      if (allocated(scaling%ellipse)) call write_attribute(file, group, 'ellipticity', &
         scaling%ellipse%ratio, '1')
      if (scaling%hertz_pressure > 0.0_wp) call write_attribute(file, group, 'hertz_pressure', &
         scaling%hertz_pressure, 'Pa')
      if (.not. scaling%is_dimensional) return
      call write_attribute(file, group, 'reduced_modulus', scaling%reduced_modulus, 'Pa')
      if (allocated(scaling%ellipse)) then
         call write_attribute(file, group, 'half_width_x', scaling%half_width, 'm')
         call write_attribute(file, group, 'half_width_y', scaling%half_width &
            *scaling%ellipse%ratio, 'm')
         call write_attribute(file, group, 'reduced_radius_x', scaling%reduced_radius, 'm')
         call write_attribute(file, group, 'load', scaling%load_per_length, 'N')
      else
         call write_attribute(file, group, 'half_width', scaling%half_width, 'm')
         call write_attribute(file, group, 'reduced_radius', scaling%reduced_radius, 'm')
         call write_attribute(file, group, 'load_per_length', scaling%load_per_length, 'N/m')
      end if
      call write_attribute(file, group, 'film_thickness', scaling%film, 'm')
      call write_attribute(file, group, 'shear_stress', scaling%shear_stress, 'Pa')
      call write_attribute(file, group, 'power', scaling%power, trim(merge('W  ', 'W/m', &
         allocated(scaling%ellipse))))
      call write_attribute(file, group, 'time', scaling%time, 's')
      call write_attribute(file, group, 'viscosity', scaling%viscosity, 'Pa s')
      call write_attribute(file, group, 'speed_sum', scaling%speed_sum, 'm/s')
   end subroutine write_scaling

   !> /summary: quantities in SI; `is_transient`: extremes over the times that count, each with its
   !> time in `<name>_time`; `missing`: why a quantity whose estimate is NaN has none. Beside them
   !> how far the film is from the limit of Reynolds' equation, and `lambda_ratio` if it is known.
   subroutine write_summary(file, summary, scaling, is_transient, missing, lambda_ratio)
      class(hdf5_file_t), intent(inout) :: file
      type(line_summary_t), intent(in) :: summary
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: is_transient
      character(*), intent(in) :: missing
      real(wp), intent(in) :: lambda_ratio
      character(:), allocatable :: extreme
      real(wp) :: limits(2)
      integer :: i

      call file%create_group('/summary')
      call write_attribute(file, '/summary', 'about', 'values in their units; attribute '// &
         'dimensionless: the same as H, P, X or T; error_estimate: estimated error, the sum of '// &
         'error_grid (grid and time step), error_domain (its length), error_iteration, '// &
         'error_start (of a transient) and error_model (of what was left out); NaN = not '// &
         'estimated, no_estimate says why')
      do i = 1, quantity_count
         if (any(i == sliding_rows) .and. .not. ieee_is_finite(scaling%slide_to_roll)) cycle
         associate (row => quantity_rows(i), quantity => summary%of(i))
            if (any(i == [mixed_rows, x_cavitation]) .and. .not. exceeds(abs(quantity%value), &
               0.0_wp)) cycle   ! there is none, or no film that ends
            extreme = ''   ! where there are several times and the text does not say which it is
            if (is_transient .and. index(row%text, trim(row%extreme)) == 0) extreme = ', ' &
               //trim(row%extreme)//' over time'
            call write_quantity(trim(row%name), trim(row%text)//extreme, quantity, 1.0_wp, &
               row_label(trim(row%field), scaling))
            if (row%field == 'film_thickness' .and. len_trim(row%short) > 0) call &
               write_quantity(trim(row%name)//'_moes', trim(row%name)// &
               " in units of Moes, (h/R) sqrt(E' R/(mu_0 u)), mean velocity u = u_s/2", &
               quantity, scaling%film_moes, new_label('', '1'))
         end associate
      end do
      if (ieee_is_finite(lambda_ratio)) call write_value(file, '/summary/lambda_ratio', &
         'smallest film over composite rms height of both surfaces', lambda_ratio, &
         new_label('', '1'), lambda_ratio*abs(summary%of(h_min)%error_estimate &
         /summary%of(h_min)%value), missing)
      limits = [summary%limits%stokes_number, summary%limits%surface_slope]
      do i = 1, size(limits)
         if (.not. ieee_is_finite(limits(i))) cycle
         associate (row => limit_rows(merge(stokes_number, surface_slope, i == 1)))
            extreme = trim(row%meaning)//' (dimensionless: times R/b)'//trim(merge( &
               ', largest over time', '                   ', is_transient))
            call write_value(file, '/summary/'//trim(row%name), extreme, limits(i), &
               scaled_label('', 'slope', scaling), not_known(), &
               'it says how far the model holds: /adequacy/validity has its threshold')
         end associate
      end do

   contains

      !> One quantity times `factor`, its limit and its time; `scale` gives its unit.
      subroutine write_quantity(name, long_name, quantity, factor, scale)
         character(*), intent(in) :: name, long_name
         type(quantity_t), intent(in) :: quantity
         real(wp), intent(in) :: factor
         type(label_t), intent(in) :: scale
         character(:), allocatable :: path

         path = '/summary/'//name
         associate (error => quantity%error_estimate*factor, unit => scale%si_scale)
            call write_value(file, path, long_name, quantity%value*factor, scale, error, missing)
            call write_attribute(file, path, 'error_grid', quantity%error_grid*factor*unit)
            call write_attribute(file, path, 'error_domain', quantity%error_domain*factor*unit)
            call write_attribute(file, path, 'error_iteration', &
               quantity%error_iteration*factor*unit)
            call write_attribute(file, path, 'error_start', quantity%error_start*factor*unit)
            call write_attribute(file, path, 'error_model', quantity%error_model*factor*unit)
            if (ieee_is_finite(quantity%extrapolated)) call write_value(file, &
               path//'_extrapolated', name//' by Richardson extrapolation from n and n/2 '// &
               'intervals', quantity%extrapolated*factor, scale, error, missing)
         end associate
         if (.not. is_transient .or. index(name, '_moes') > 0) return
         call write_value(file, path//'_time', 'time at which '//name//' was reached', &
            quantity%time, scaled_label('', 'time', scaling), not_known(), &
            'one of the time steps; from one to another of nearly equal extremes it jumps, '// &
            'which no grids predict')
      end subroutine write_quantity

   end subroutine write_summary

   !> A value in the unit of `scale`, with its estimated error, or why there is none.
   subroutine write_value(file, path, long_name, value, scale, error, missing)
      class(hdf5_file_t), intent(inout) :: file
      character(*), intent(in) :: path, long_name, missing
      real(wp), intent(in) :: value, error
      type(label_t), intent(in) :: scale

      call write_dataset(file, path, value*scale%si_scale, new_label(long_name, scale%si_units))
      if (scale%si_units == '1') call write_attribute(file, path, 'units', '1')
      call write_attribute(file, path, 'dimensionless', value)
      call write_attribute(file, path, 'error_estimate', error*scale%si_scale)
      if (.not. ieee_is_finite(error)) call write_attribute(file, path, 'no_estimate', missing)
   end subroutine write_value

   !> The mean power of a contact whose load, radius and speeds change, over the times that count;
   !> its error is the change from n/2 intervals and twice the steps, `coarser(1)`, and from there
   !> to `coarser(2)`, since a single change may vanish by chance; not known with fewer than two.
   subroutine write_mean_power(file, summary, coarser, scaling, missing)
      class(hdf5_file_t), intent(inout) :: file
      type(line_summary_t), intent(in) :: summary, coarser(:)
      type(scaling_t), intent(in) :: scaling
      character(*), intent(in) :: missing
      real(wp) :: error

      error = not_known()
      if (size(coarser) > 1) error = abs(mean_power(summary) - mean_power(coarser(1))) &
         + abs(mean_power(coarser(1)) - mean_power(coarser(2)))
      call write_value(file, '/summary/mean_power', 'mean power over time that sliding and '// &
         'rolling turn into heat, per length', mean_power(summary), scaled_label('', 'power', &
         scaling), error, missing)
   end subroutine write_mean_power

   !> /report: how the solver went; the only place with wall times.
   subroutine write_report(file, report)
      class(hdf5_file_t), intent(inout) :: file
      type(report_t), intent(in) :: report
      character(*), parameter :: group = '/report/'
      character(:), allocatable :: method, phases

      method = ''
      if (allocated(report%method)) method = report%method
      phases = joined(phase_names, ', ')
      call write_dataset(file, group//'method', method, new_label('method of solution', '1'))
      call put_count('cycles', report%cycles, 'cycles on the finest level, time steps included')
      call put_count('steps', report%steps, 'time steps')
      call put_count('uncut_steps', report%fit%uncut_steps, &
         'steps of the start taken whole: parts without a solution')
      call put_count('levels', report%numbers%levels, 'grid levels, the finest counted')
      call write_dataset(file, group//'fft_pairs', report%cost%fft_pairs, &
         new_label('pairs of forward and backward transforms', '1'))
      call put('work_units', report%cost%work_units, &
         'sweeps, each weighted by its share of the nodes of the finest level')
      call put('residual', report%residual, &
         'last residual, unit of d(rho H)/dX; dry: violation of the contact conditions')
      call put('load_error', report%load_error, &
         'last |dX sum P - pi/2|; dry: relative error of the load')
      call put('inlet_error', report%fit%inlet_error, 'relative error of the film thickness '// &
         'because the domain ends at its inlet (estimate)')
      call put('tolerance_effective', report%tolerance_effective, &
         'bound on residual and load error: max(tolerance, 5 x round-off floor)')
      if (report%fit%nodes_per_wave < huge(1.0_wp)) call put('nodes_per_wave', &
         report%fit%nodes_per_wave, 'nodes of the grid in the finest wave of the surfaces')
      if (report%fit%steps_per_wave < huge(1.0_wp)) call put('steps_per_wave', &
         report%fit%steps_per_wave, 'time steps in which the finest moving wave passes a place')
      if (allocated(report%note)) call write_dataset(file, group//'note', report%note, &
         new_label('what should be known about this result', '1'))
      call make_counter(file, group//'cycle', size(report%residual_history()), &
         'number of the cycle')
      call write_field(file, group//'residual_history', report%residual_history(), &
         new_label('residual after each cycle', '1'), 'cycle')
      call write_field(file, group//'load_error_history', report%load_error_history(), &
         new_label('load error after each cycle', '1'), 'cycle')
      call put('wall_seconds', report%cost%wall_seconds, 'wall time of the solution', 's')
      call make_counter(file, group//'phase', size(phase_names), 'number of: '//phases)
      call write_field(file, group//'phase_seconds', report%cost%phase_seconds, &
         new_label('wall time of: '//phases, 's'), 'phase')
      call write_attribute(file, group//'phase_seconds', 'phases', phases)
      if (report%cost%peak_memory > 0.0_wp) call put('peak_memory', report%cost%peak_memory, &
         'most memory of the process', 'B')

   contains

      !> A number; without `units` a pure one.
      subroutine put(name, value, text, units)
         character(*), intent(in) :: name, text
         real(wp), intent(in) :: value
         character(*), intent(in), optional :: units
         type(label_t) :: label

         label = new_label(text, '1')
         if (present(units)) label = new_label(text, units)
         call write_dataset(file, group//name, value, label)
      end subroutine put

      !> A number of something.
      subroutine put_count(name, value, text)
         character(*), intent(in) :: name, text
         integer, intent(in) :: value

         call write_dataset(file, group//name, int(value, int64), new_label(text, '1'))
      end subroutine put_count

   end subroutine write_report

   !> Root attribute `film_breakdown` (0 or 1) and, if there was one, /report/film_breakdown_*.
   subroutine write_breakdown(file, breakdown, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(breakdown_t), intent(in) :: breakdown
      type(scaling_t), intent(in) :: scaling
      character(*), parameter :: path = '/report/film_breakdown_'

      call write_attribute(file, '/', 'film_breakdown', merge(1, 0, breakdown%count > 0))
      if (breakdown%count == 0) return
      call write_dataset(file, path//'count', int(breakdown%count, int64), &
         new_label('solutions with a film below film_floor, or that would close', '1'))
      call write_dataset(file, path//'step', int(breakdown%step, int64), &
         new_label('time step of the first of them', '1'))
      call write_dataset(file, path//'time', breakdown%time, &
         scaled_label('time of the first of them', 'time', scaling))
      call write_dataset(file, path//'position', breakdown%position, &
         scaled_label('place of the smallest film of the first of them', 'half_width', scaling))
      if (allocated(scaling%ellipse)) call write_dataset(file, path//'position_y', &
         breakdown%across, scaled_label('the same across', 'half_width', scaling))
      call write_dataset(file, path//'film', breakdown%film, &
         scaled_label('smallest film of the first of them', 'film', scaling))
      call write_dataset(file, path//'smallest_film', breakdown%smallest_film, &
         scaled_label('smallest film of all of them', 'film', scaling))
   end subroutine write_breakdown

end module result_sections

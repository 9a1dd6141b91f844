!> The sections /scaling, /summary and /report of a result.
module result_sections
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use hdf5_axes, only: make_counter
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset
   use iteration_report, only: breakdown_t, phase_names, report_t
   use kinds, only: exceeds, not_known, wp
   use line_summary, only: line_summary_t, mean_power, quantity_t
   use quantities, only: h_min, mixed_rows, quantity_count, quantity_rows, sliding_rows, &
      x_cavitation
   use result_labels, only: row_label, scaled_label, section_file_t
   use scaling, only: sum_per_mean
   use text, only: joined
   use validity, only: limit_rows, stokes_number, surface_slope
   implicit none (type, external)
   private

   public :: write_breakdown, write_mean_power, write_report, write_scaling, write_summary

contains

   !> /scaling: reference values as attributes, with units; what is unknown is left out.
   subroutine write_scaling(file)
      type(section_file_t), intent(inout) :: file
      !> Groups of numbers, and scales of a line and of a point contact.
      character(len=*), parameter :: groups(*) = [character(len=13) :: 'lambda', 'alpha_bar', &
         'slide_to_roll', 'moes_m', 'moes_l', 'moes_m_sum', 'moes_l_sum', 'ellipticity'], &
         units(*) = [character(len=12) :: 'half_width', 'radius', 'load', 'film', 'shear_stress', &
         'power', 'time', 'viscosity', 'speed_sum'], &
         of_line(*) = [character(len=16) :: 'half_width', 'reduced_radius', 'load_per_length', &
         'film_thickness', units(5:)], &
         of_point(*) = [character(len=16) :: 'half_width_x', 'reduced_radius_x', 'load', &
         of_line(4:)]
      type(label_t) :: label
      real(wp) :: ratio, values(size(groups))
      logical :: is_point
      integer :: i

      call file%begin('/scaling', 'reference values; Moes numbers with the mean velocity u_s/2 '// &
         '(the names in _sum: with u_s = u1 + u2)')
      associate (scaling => file%scaling)
         is_point = allocated(scaling%ellipse)
         ratio = not_known()
         if (is_point) ratio = scaling%ellipse%ratio
         values = [scaling%lambda, scaling%alpha_bar, scaling%slide_to_roll, scaling%moes_m, &
            scaling%moes_l, scaling%moes_m*sum_per_mean**merge(-0.75_wp, -0.5_wp, is_point), &
            scaling%moes_l*sum_per_mean**0.25_wp, ratio]
         do i = 1, size(values)
            if (ieee_is_finite(values(i))) call write_attribute(file, '/scaling', &
               trim(groups(i)), values(i), '1')
         end do
         if (scaling%hertz_pressure > 0.0_wp) call write_attribute(file, '/scaling', &
            'hertz_pressure', scaling%hertz_pressure, 'Pa')
         if (.not. scaling%is_dimensional) return
         call write_attribute(file, '/scaling', 'reduced_modulus', scaling%reduced_modulus, 'Pa')
         do i = 1, size(units)
            label = scaled_label('', trim(units(i)), scaling)
            call write_attribute(file, '/scaling', trim(merge(of_point(i), of_line(i), is_point)), &
               label%si_scale, label%si_units)
            if (is_point .and. i == 1) call write_attribute(file, '/scaling', 'half_width_y', &
               ratio*label%si_scale, 'm')
         end do
      end associate
   end subroutine write_scaling

   !> /summary: quantities in SI; `is_transient`: extremes over the times that count, each with its
   !> time in `<name>_time`; `missing`: why a quantity whose estimate is NaN has none. Beside them
   !> how far the film is from the limit of Reynolds' equation, and `lambda_ratio` if it is known.
   subroutine write_summary(file, summary, is_transient, missing, lambda_ratio)
      type(section_file_t), intent(inout) :: file
      type(line_summary_t), intent(in) :: summary
      logical, intent(in) :: is_transient
      character(*), intent(in) :: missing
      real(wp), intent(in) :: lambda_ratio
      character(:), allocatable :: extreme
      real(wp) :: limits(2)
      integer :: i

      call file%begin('/summary', 'values in their units; attribute dimensionless: the same as '// &
         'H, P, X or T; error_estimate: estimated error, the sum of error_grid (grid and time '// &
         'step), error_domain (its length), error_iteration, error_start (of a transient) and '// &
         'error_model (of what was left out); NaN = not estimated, no_estimate says why')
      do i = 1, quantity_count
         if (any(i == sliding_rows) .and. .not. ieee_is_finite(file%scaling%slide_to_roll)) cycle
         associate (row => quantity_rows(i), quantity => summary%of(i))
            if (any(i == [mixed_rows, x_cavitation]) .and. .not. exceeds(abs(quantity%value), &
               0.0_wp)) cycle   ! there is none, or no film that ends
            extreme = ''   ! where there are several times and the text does not say which it is
            if (is_transient .and. index(row%text, trim(row%extreme)) == 0) extreme = ', ' &
               //trim(row%extreme)//' over time'
            call write_quantity(trim(row%name), trim(row%text)//extreme, quantity, 1.0_wp, &
               row_label(trim(row%field), file%scaling))
            if (row%field == 'film_thickness' .and. len_trim(row%short) > 0) call &
               write_quantity(trim(row%name)//'_moes', trim(row%name)// &
               " in units of Moes, (h/R) sqrt(E' R/(mu_0 u)), mean velocity u = u_s/2", &
               quantity, file%scaling%film_moes, new_label('', '1'))
         end associate
      end do
      if (ieee_is_finite(lambda_ratio)) call write_value(file, 'lambda_ratio', &
         'smallest film over composite rms height of both surfaces', lambda_ratio, &
         new_label('', '1'), lambda_ratio*abs(summary%of(h_min)%error_estimate &
         /summary%of(h_min)%value), missing)
      limits = [summary%limits%stokes_number, summary%limits%surface_slope]
      do i = 1, size(limits)
         if (.not. ieee_is_finite(limits(i))) cycle
         associate (row => limit_rows(merge(stokes_number, surface_slope, i == 1)))
            extreme = trim(row%meaning)//' (dimensionless: times R/b)'//trim(merge( &
               ', largest over time', '                   ', is_transient))
            call write_value(file, trim(row%name), extreme, limits(i), scaled_label('', 'slope', &
               file%scaling), not_known(), 'it says how far the model holds: '// &
               '/adequacy/validity has its threshold')
         end associate
      end do

   contains

      !> One quantity times `factor`, its limit and its time; `scale` gives its unit.
      subroutine write_quantity(name, long_name, quantity, factor, scale)
         character(*), intent(in) :: name, long_name
         type(quantity_t), intent(in) :: quantity
         real(wp), intent(in) :: factor
         type(label_t), intent(in) :: scale
         real(wp) :: error

         error = quantity%error_estimate*factor
         call write_value(file, name, long_name, quantity%value*factor, scale, error, missing)
         associate (path => '/summary/'//name, unit => scale%si_scale)
            call write_attribute(file, path, 'error_grid', quantity%error_grid*factor*unit)
            call write_attribute(file, path, 'error_domain', quantity%error_domain*factor*unit)
            call write_attribute(file, path, 'error_iteration', &
               quantity%error_iteration*factor*unit)
            call write_attribute(file, path, 'error_start', quantity%error_start*factor*unit)
            call write_attribute(file, path, 'error_model', quantity%error_model*factor*unit)
         end associate
         if (ieee_is_finite(quantity%extrapolated)) call write_value(file, name//'_extrapolated', &
            name//' by Richardson extrapolation from n and n/2 intervals', &
            quantity%extrapolated*factor, scale, error, missing)
         if (.not. is_transient .or. index(name, '_moes') > 0) return
         call write_value(file, name//'_time', 'time at which '//name//' was reached', &
            quantity%time, scaled_label('', 'time', file%scaling), not_known(), &
            'one of the time steps; from one to another of nearly equal extremes it jumps, '// &
            'which no grids predict')
      end subroutine write_quantity

   end subroutine write_summary

   !> A value of /summary in the unit of `scale`, with its estimated error, or why there is none.
   subroutine write_value(file, name, text, value, scale, error, missing)
      type(section_file_t), intent(inout) :: file
      character(*), intent(in) :: name, text, missing
      real(wp), intent(in) :: value, error
      type(label_t), intent(in) :: scale

      call file%put(name, value*scale%si_scale, text, scale%si_units)
      associate (path => '/summary/'//name)
         if (scale%si_units == '1') call write_attribute(file, path, 'units', '1')
         call write_attribute(file, path, 'dimensionless', value)
         call write_attribute(file, path, 'error_estimate', error*scale%si_scale)
         if (.not. ieee_is_finite(error)) call write_attribute(file, path, 'no_estimate', missing)
      end associate
   end subroutine write_value

   !> The mean power of a contact whose load, radius and speeds change, over the times that count;
   !> its error is the change from n/2 intervals and twice the steps, `coarser(1)`, and from there
   !> to `coarser(2)`, since a single change may vanish by chance; not known with fewer than two.
   subroutine write_mean_power(file, summary, coarser, missing)
      type(section_file_t), intent(inout) :: file
      type(line_summary_t), intent(in) :: summary, coarser(:)
      character(*), intent(in) :: missing
      real(wp) :: error

      error = not_known()
      if (size(coarser) > 1) error = abs(mean_power(summary) - mean_power(coarser(1))) &
         + abs(mean_power(coarser(1)) - mean_power(coarser(2)))
      call file%begin('/summary')
      call write_value(file, 'mean_power', 'mean power over time that sliding and rolling turn '// &
         'into heat, per length', mean_power(summary), scaled_label('', 'power', file%scaling), &
         error, missing)
   end subroutine write_mean_power

   !> /report: how the solver went; the only place with wall times.
   subroutine write_report(file, report)
      type(section_file_t), intent(inout) :: file
      type(report_t), intent(in) :: report
      character(:), allocatable :: method, phases

      method = ''
      if (allocated(report%method)) method = report%method
      phases = joined(phase_names, ', ')
      call file%begin('/report')
      call file%put('method', method, 'method of solution')
      call file%put('cycles', report%cycles, 'cycles on the finest level, time steps included')
      call file%put('steps', report%steps, 'time steps')
      call file%put('uncut_steps', report%fit%uncut_steps, &
         'steps of the start taken whole: parts without a solution')
      call file%put('levels', report%numbers%levels, 'grid levels, the finest counted')
      call write_dataset(file, '/report/fft_pairs', report%cost%fft_pairs, &
         new_label('pairs of forward and backward transforms', '1'))
      call file%put('work_units', report%cost%work_units, &
         'sweeps, each weighted by its share of the nodes of the finest level')
      call file%put('residual', report%residual, &
         'last residual, unit of d(rho H)/dX; dry: violation of the contact conditions')
      call file%put('load_error', report%load_error, &
         'last |dX sum P - pi/2|; dry: relative error of the load')
      call file%put('inlet_error', report%fit%inlet_error, 'relative error of the film '// &
         'thickness because the domain ends at its inlet (estimate)')
      call file%put('tolerance_effective', report%tolerance_effective, &
         'bound on residual and load error: max(tolerance, 5 x round-off floor)')
      if (report%fit%nodes_per_wave < huge(1.0_wp)) call file%put('nodes_per_wave', &
         report%fit%nodes_per_wave, 'nodes of the grid in the finest wave of the surfaces')
      if (report%fit%steps_per_wave < huge(1.0_wp)) call file%put('steps_per_wave', &
         report%fit%steps_per_wave, 'time steps in which the finest moving wave passes a place')
      if (allocated(report%note)) call file%put('note', report%note, &
         'what should be known about this result')
      call make_counter(file, '/report/cycle', size(report%residual_history()), &
         'number of the cycle')
      call file%put('residual_history', report%residual_history(), 'residual after each cycle', &
         axes='cycle')
      call file%put('load_error_history', report%load_error_history(), &
         'load error after each cycle', axes='cycle')
      call file%put('wall_seconds', report%cost%wall_seconds, 'wall time of the solution', 's')
      call make_counter(file, '/report/phase', size(phase_names), 'number of: '//phases)
      call file%put('phase_seconds', report%cost%phase_seconds, 'wall time of: '//phases, 's', &
         'phase')
      call write_attribute(file, '/report/phase_seconds', 'phases', phases)
      if (report%cost%peak_memory > 0.0_wp) call file%put('peak_memory', &
         report%cost%peak_memory, 'most memory of the process', 'B')
   end subroutine write_report

   !> Root attribute `film_breakdown` (0 or 1) and, if there was one, /report/film_breakdown_*.
   subroutine write_breakdown(file, breakdown)
      type(section_file_t), intent(inout) :: file
      type(breakdown_t), intent(in) :: breakdown

      call write_attribute(file, '/', 'film_breakdown', merge(1, 0, breakdown%count > 0))
      if (breakdown%count == 0) return
      call file%begin('/report')
      call file%put('film_breakdown_count', breakdown%count, &
         'solutions with a film below film_floor, or that would close')
      call file%put('film_breakdown_step', breakdown%step, 'time step of the first of them')
      call file%put('film_breakdown_time', breakdown%time, 'time of the first of them', 'time')
      call file%put('film_breakdown_position', breakdown%position, &
         'place of the smallest film of the first of them', 'half_width')
      if (allocated(file%scaling%ellipse)) call file%put('film_breakdown_position_y', &
         breakdown%across, 'the same across', 'half_width')
      call file%put('film_breakdown_film', breakdown%film, 'smallest film of the first of them', &
         'film')
      call file%put('film_breakdown_smallest_film', breakdown%smallest_film, &
         'smallest film of all of them', 'film')
   end subroutine write_breakdown

end module result_sections

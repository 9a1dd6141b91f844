!> The closing sections of a result file: /scaling, /solution, /summary and /report.
module result_sections
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use constants, only: pi
   use hdf5_attribute, only: write_attribute
   use hdf5_axes, only: make_axis, make_counter, name_axes
   use hdf5_dataset, only: label_t, new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use iteration_report, only: phase_names, report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t, quantity_t
   use missing_value, only: not_known
   use moes, only: moes_m_sum_from_mean
   use passage_times, only: passage_times_t
   use quantities, only: quantity_count, quantity_row_t, quantity_rows, sliding_rows
   use result_labels, only: field_names, field_values, has_scale, row_label, &
      scaled_label, si_label
   use scaling, only: scaling_t
   use validity_table, only: limit_rows, stokes_number, surface_slope
   implicit none (type, external)
   private

   public :: write_report, write_scaling, write_solution, write_summary, write_times

contains

   !> /scaling: reference values as attributes, each with its unit in `<name>_units`; what is
   !> unknown is left out.
   subroutine write_scaling(file, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(scaling_t), intent(in) :: scaling

      call file%create_group('/scaling')
      call write_attribute(file, '/scaling', 'about', 'reference values; Moes numbers with '// &
         'the mean velocity u_s/2 '// &
                           '(the names in _sum: with u_s = u1 + u2)')
      call write_reference('lambda', scaling%lambda, '1')
      call write_reference('alpha_bar', scaling%alpha_bar, '1')
      if (ieee_is_finite(scaling%slide_to_roll)) call write_reference('slide_to_roll', &
         scaling%slide_to_roll, '1')
      call write_reference('moes_m', scaling%moes_m, '1')
      call write_reference('moes_l', scaling%moes_l, '1')
      call write_reference('moes_m_sum', moes_m_sum_from_mean(scaling%moes_m), '1')
      call write_reference('moes_l_sum', scaling%moes_l*2.0_wp**0.25_wp, '1')
      if (scaling%hertz_pressure > 0.0_wp) call write_reference('hertz_pressure', &
         scaling%hertz_pressure, 'Pa')
      if (.not. scaling%is_dimensional) return
      call write_reference('half_width', scaling%half_width, 'm')
      call write_reference('reduced_radius', scaling%reduced_radius, 'm')
      call write_reference('reduced_modulus', scaling%reduced_modulus, 'Pa')
      call write_reference('load_per_length', scaling%load_per_length, 'N/m')
      call write_reference('film_thickness', scaling%film, 'm')
      call write_reference('shear_stress', scaling%shear_stress, 'Pa')
      call write_reference('power', scaling%power, 'W/m')
      call write_reference('time', scaling%time, 's')
      call write_reference('viscosity', scaling%viscosity, 'Pa s')
      call write_reference('speed_sum', scaling%speed_sum, 'm/s')

   contains

      !> One value with its unit.
      subroutine write_reference(name, value, units)
         character(*), intent(in) :: name
         real(wp), intent(in) :: value
         character(*), intent(in) :: units

         call write_attribute(file, '/scaling', name, value)
         call write_attribute(file, '/scaling', name//'_units', units)
      end subroutine write_reference

   end subroutine write_scaling

   !> /solution: the fields of the last time over x; with `has_si` in /si/solution those that are
   !> other numbers in SI.
   subroutine write_solution(file, state, scaling, has_si)
      class(hdf5_file_t), intent(inout) :: file
      type(line_state_t), intent(in) :: state
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: has_si
      type(label_t) :: label
      character(:), allocatable :: name
      real(wp), allocatable :: values(:)
      integer :: i

      do i = 1, size(field_names)
         name = trim(field_names(i))
         values = field_values(name, state)
         if (size(values) == 0) cycle
         label = row_label(name, scaling)
         call write_field('/solution/', name, values, label)
         if (has_si .and. has_scale(label)) call write_field('/si/solution/', name, &
            values*label%si_scale, si_label(name, scaling))
      end do
      call write_dataset(file, '/solution/rigid_displacement', state%rigid_displacement, &
         scaled_label('rigid displacement H0 of (2.58); h0 of (2.24) = '// &
         '(b^2/R)(H0 + ln(b)/2), b in m', 'film', scaling))
      call write_dataset(file, '/solution/time', state%time, &
         scaled_label('time of these fields, T = t u_s/(2 b)', 'time', scaling))

   contains

      !> One field, over the x of its group, which is the first.
      subroutine write_field(group, name, values, label)
         character(*), intent(in) :: group, name
         real(wp), intent(in) :: values(:)
         type(label_t), intent(in) :: label
         real(wp) :: copy(size(values))

         copy = values
         call write_dataset(file, group//name, copy, label)
         if (name == 'x') then
            call make_axis(file, group//'x')
         else
            call name_axes(file, group//name, group//'x')
         end if
      end subroutine write_field

   end subroutine write_solution

   !> /summary: quantities in SI; `is_transient`: extremes over the times that count, each with its
   !> time in `<name>_time`; `missing`: why a quantity whose estimate is NaN has none. Beside them
   !> how far the film is from the limit of Reynolds' equation.
   subroutine write_summary(file, summary, scaling, is_transient, missing)
      class(hdf5_file_t), intent(inout) :: file
      type(line_summary_t), intent(in) :: summary
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: is_transient
      character(*), intent(in) :: missing
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
            call write_quantity(trim(row%name), trim(row%text)//over_time(row), quantity, 1.0_wp, &
               row_label(trim(row%field), scaling))
            if (row%field == 'film_thickness' .and. len_trim(row%short) > 0) call &
               write_quantity(trim(row%name)//'_moes', trim(row%name)// &
               " in units of Moes, (h/R) sqrt(E' R/(mu_0 u)), mean velocity u = u_s/2", &
               quantity, 8.0_wp*scaling%moes_m/pi, new_label('', '1'))
         end associate
      end do
      call write_limit(stokes_number, summary%limits%stokes_number)
      call write_limit(surface_slope, summary%limits%surface_slope)

   contains

      !> Row `i` of the limits of the model, where it is known.
      subroutine write_limit(i, value)
         integer, intent(in) :: i
         real(wp), intent(in) :: value
         character(:), allocatable :: words

         if (.not. ieee_is_finite(value)) return
         words = trim(limit_rows(i)%meaning)//' (dimensionless: times R/b)'
         if (is_transient) words = words//', largest over time'
         call write_value('/summary/'//trim(limit_rows(i)%name), words, value, &
            scaled_label('', 'slope', scaling), not_known(), &
            'it says how far the model holds: /adequacy/validity has its threshold')
      end subroutine write_limit

      !> Which extreme a quantity is, if there are several times and its text does not say so.
      pure function over_time(row) result(words)
         type(quantity_row_t), intent(in) :: row
         character(:), allocatable :: words

         words = ''
         if (is_transient .and. index(row%text, trim(row%extreme)) == 0) words = ', ' &
            //trim(row%extreme)//' over time'
      end function over_time

      !> One quantity times `factor`, what it tends to and when it was reached; `scale` gives its
      !> unit.
      subroutine write_quantity(name, long_name, quantity, factor, scale)
         character(*), intent(in) :: name, long_name
         type(quantity_t), intent(in) :: quantity
         real(wp), intent(in) :: factor
         type(label_t), intent(in) :: scale
         character(:), allocatable :: path

         path = '/summary/'//name
         associate (error => quantity%error_estimate*factor, unit => scale%si_scale)
            call write_value(path, long_name, quantity%value*factor, scale, error, missing)
            call write_attribute(file, path, 'error_grid', quantity%error_grid*factor*unit)
            call write_attribute(file, path, 'error_domain', quantity%error_domain*factor*unit)
            call write_attribute(file, path, 'error_iteration', &
               quantity%error_iteration*factor*unit)
            call write_attribute(file, path, 'error_start', quantity%error_start*factor*unit)
            call write_attribute(file, path, 'error_model', quantity%error_model*factor*unit)
            if (ieee_is_finite(quantity%extrapolated)) call write_value(path//'_extrapolated', &
               name//' by Richardson extrapolation from n and n/2 intervals', &
               quantity%extrapolated*factor, scale, error, missing)
         end associate
         if (.not. is_transient .or. index(name, '_moes') > 0) return
         call write_value(path//'_time', 'time at which '//name//' was reached', quantity%time, &
            scaled_label('', 'time', scaling), not_known(), &
            'one of the time steps; from one to another of nearly equal extremes it jumps, '// &
            'which no grids foretell')
      end subroutine write_quantity

      !> A value in the unit of `scale`, with its estimated error, or why there is none.
      subroutine write_value(path, long_name, value, scale, error, missing)
         character(*), intent(in) :: path, long_name, missing
         real(wp), intent(in) :: value, error
         type(label_t), intent(in) :: scale

         call write_dataset(file, path, value*scale%si_scale, new_label(long_name, scale%si_units))
         if (scale%si_units == '1') call write_attribute(file, path, 'units', '1')
         call write_attribute(file, path, 'dimensionless', value)
         call write_attribute(file, path, 'error_estimate', error*scale%si_scale)
         if (.not. ieee_is_finite(error)) call write_attribute(file, path, 'no_estimate', missing)
      end subroutine write_value

   end subroutine write_summary

   !> Attributes of /summary: which times of a transient count [T].
   subroutine write_times(file, times)
      class(hdf5_file_t), intent(inout) :: file
      type(passage_times_t), intent(in) :: times

      call write_attribute(file, '/summary', 'statistics_from', times%counts_from)
      call write_attribute(file, '/summary', 'settled_from', times%settled_from)
      if (times%period > 0.0_wp) call write_attribute(file, '/summary', 'period', times%period)
   end subroutine write_times

   !> /report: how the solver went; the only place with wall times.
   subroutine write_report(file, report)
      class(hdf5_file_t), intent(inout) :: file
      type(report_t), intent(in) :: report
      character(:), allocatable :: method, phases
      integer :: i

      method = ''
      if (allocated(report%method)) method = report%method
      phases = trim(phase_names(1))
      do i = 2, size(phase_names)
         phases = phases//', '//trim(phase_names(i))
      end do
      call write_dataset(file, '/report/method', method, new_label('method of solution', '1'))
      call write_dataset(file, '/report/cycles', int(report%cycles, int64), &
         new_label('cycles on the finest level, time steps included', '1'))
      call write_dataset(file, '/report/steps', int(report%steps, int64), &
         new_label('time steps', '1'))
      call write_dataset(file, '/report/uncut_steps', int(report%uncut_steps, int64), &
         new_label('steps of the start taken whole: parts without a solution', '1'))
      call write_dataset(file, '/report/levels', int(report%levels, int64), &
         new_label('grid levels, the finest counted', '1'))
      call write_dataset(file, '/report/fft_pairs', report%fft_pairs, &
         new_label('pairs of forward and backward transforms', '1'))
      call write_dataset(file, '/report/work_units', report%work_units, &
         new_label('sweeps, each weighted by its share of the nodes of the finest level', '1'))
      call write_dataset(file, '/report/residual', report%residual, new_label( &
         'last residual, unit of d(rho H)/dX; dry: violation of the contact conditions', '1'))
      call write_dataset(file, '/report/load_error', report%load_error, &
         new_label('last |dX sum P - pi/2|; dry: relative error of the load', '1'))
      call write_dataset(file, '/report/inlet_error', report%inlet_error, &
         new_label('relative error of the film thickness because the domain ends at its inlet '// &
         '(estimate)', '1'))
      call write_dataset(file, '/report/tolerance_effective', report%tolerance_effective, &
         new_label('bound on residual and load error: max(tolerance, 5 x round-off floor)', '1'))
      if (report%nodes_per_wave < huge(1.0_wp)) call write_dataset(file, &
         '/report/nodes_per_wave', report%nodes_per_wave, &
         new_label('nodes of the grid in the finest wave of the surfaces', '1'))
      if (report%steps_per_wave < huge(1.0_wp)) call write_dataset(file, &
         '/report/steps_per_wave', report%steps_per_wave, &
         new_label('time steps in which the finest moving wave passes a place', '1'))
      if (allocated(report%note)) call write_dataset(file, '/report/note', report%note, &
         new_label('what should be known about this result', '1'))
      call make_counter(file, '/report/cycle', size(report%residual_history()), &
         'number of the cycle')
      call write_dataset(file, '/report/residual_history', report%residual_history(), &
         new_label('residual after each cycle', '1'))
      call name_axes(file, '/report/residual_history', '/report/cycle')
      call write_dataset(file, '/report/load_error_history', report%load_error_history(), &
         new_label('load error after each cycle', '1'))
      call name_axes(file, '/report/load_error_history', '/report/cycle')
      call write_dataset(file, '/report/wall_seconds', report%wall_seconds, &
         new_label('wall time of the solution', 's'))
      call make_counter(file, '/report/phase', size(phase_names), 'number of: '//phases)
      call write_dataset(file, '/report/phase_seconds', report%phase_seconds, &
         new_label('wall time of: '//phases, 's'))
      call write_attribute(file, '/report/phase_seconds', 'phases', phases)
      call name_axes(file, '/report/phase_seconds', '/report/phase')
      if (report%peak_memory > 0.0_wp) call write_dataset(file, '/report/peak_memory', &
         report%peak_memory, new_label('most memory of the process', 'B'))
   end subroutine write_report

end module result_sections

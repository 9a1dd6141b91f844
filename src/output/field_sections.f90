!> The fields of a lubricated result: /solution, /velocity, /momentum by the full momentum equations
!> of the film, over X and zeta, and /statistics of the film over time. Beside the computed films
!> those of handbooks, /formulas, also as lines of the closing table.
module field_sections
   use case_record, only: case_t
   use film_fields, only: film_fields_t
   use film_shear, only: velocity_profile
   use film_statistics, only: bins_per_decade, film_first, film_statistics_t, pressure_first
   use hdf5_axes, only: link_object, write_field
   use hdf5_dataset, only: label_t, write_attribute
   use kinds, only: wp
   use line_contact, only: finest_wave, line_contact_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use lubricant, only: thins
   use moes, only: film_by_formula, formula_rows, formulas_hold, known_bias
   use quantities, only: quantity_rows
   use result_labels, only: field_names, field_values, less, scaled_label, section_file_t
   use scaling, only: scaling_t
   use text, only: number_text, prefixed_text, to_text
   implicit none (type, external)
   private

   public :: difference_sentence, formula_lines, has_formulas, write_formulas, write_momentum, &
      write_solution, write_statistics, write_velocity

   !> What a dimensionless pressure and film are.
   character(*), parameter :: of_pressure = ', P = p/p_h', of_film = ', H = h R/b^2'

contains

   !> /solution: the fields of the last time, of a point contact over x and y; those that differ in
   !> SI in /si/solution, if they are wanted.
   subroutine write_solution(file, state)
      type(section_file_t), intent(inout) :: file
      type(line_state_t), intent(in) :: state
      character(:), allocatable :: name
      real(wp), allocatable :: values(:)
      integer :: i

      call file%begin('/solution')
      do i = 1, size(field_names)
         name = trim(field_names(i))
         values = field_values(name, state)
         if (size(values) == 0) cycle
         if (i == 1) then
            call file%put(name, values, axes='=')
            if (allocated(state%y)) call file%put('y', state%y, axes='=')
         else if (allocated(state%y)) then
            call file%put(name, reshape(values, [size(state%x), size(state%y)]), axes='x y')
         else
            call file%put(name, values, axes='x')
         end if
      end do
      name = 'rigid displacement H0 of the undeformed bodies'
      if (.not. allocated(state%y)) name = 'rigid displacement H0 of (2.58); h0 of (2.24) = '// &
         '(b^2/R)(H0 + ln(b)/2), b in m'
      call file%put('rigid_displacement', state%rigid_displacement, name, 'film')
      call file%put('time', state%time, 'time of these fields, T = t u_s/(2 b)', 'time')
   end subroutine write_solution

   !> /velocity of the last `state` of a line, if it is wanted and there is a film: u (layers + 1,
   !> nx).
   subroutine write_velocity(file, case, state)
      type(section_file_t), intent(inout) :: file
      type(case_t), intent(in) :: case
      type(line_state_t), intent(in) :: state
      integer :: i

      if (allocated(case%point) .or. .not. allocated(state%shear_stress_mean)) return
      associate (layers => case%output_settings%velocity_layers, contact => case%contact)
         if (layers == 0) return
         call file%begin('/velocity', 'velocity of the oil at the nodes /solution/x, of the '// &
            'same time, by the Reynolds equation; a straight line where P = 0')
         call link_object(file, '/solution/x', '/velocity/x')
         call file%put('zeta', [(real(i, wp)/layers, i=0, layers)], &
            'place across the film, z/h: 0 at surface 1, 1 at surface 2', axes='=')
         call write_field(file, '/velocity/u', velocity_profile(contact%fluid, contact%lambda, &
            contact%slide_to_roll, state%x, state%pressure, state%film_thickness, layers), &
            scaled_label('velocity along the film, u/u_s', 'speed_sum', file%scaling), 'zeta x')
      end associate
   end subroutine write_velocity

   !> /momentum, of a transient that of its last time; the fields in SI too, if they are wanted.
   subroutine write_momentum(file, fields, is_transient)
      type(section_file_t), intent(inout) :: file
      type(film_fields_t), intent(in) :: fields
      logical, intent(in) :: is_transient
      character(:), allocatable :: about

      about = '/solution has its mean pressure and its film; beside it the Reynolds equation '// &
         'on the same nodes'
      if (is_transient) about = 'fields of the last time, differences of the extremes of the '// &
         'passage; /solution, /summary and /transient are those of the Reynolds equation'
      call file%begin('/momentum', 'the film by its full momentum equations, at the nodes '// &
         '/solution/x in layers at zeta = (z - z1)/h; '//about)
      call file%put('zeta', fields%zeta, 'place across the film, 0 at surface 1, 1 at surface 2', &
         axes='=')
      call link_object(file, '/solution/x', '/momentum/x')
      if (file%has_si) then
         call link_object(file, '/momentum/zeta', '/si/momentum/zeta')
         call link_object(file, '/si/solution/x', '/si/momentum/x')
      end if
      call file%put('u', fields%u, 'velocity along the film', 'speed_sum', 'zeta x', ', u/u_s')
      call file%put('w', fields%w, 'velocity across the film, from surface 1 to surface 2', &
         'speed_sum', 'zeta x', ', w/u_s')
      call file%put('layer_pressure', fields%pressure, 'pressure of the layers; cavitation is '// &
         'decided by its mean', 'hertz_pressure', 'zeta x', of_pressure)
      call file%put('shear_stress', fields%shear_stress, 'shear stress tau_xz', 'hertz_pressure', &
         'zeta x', '/p_h')
      call file%put('viscosity', fields%viscosity, 'viscosity under shear', 'viscosity', &
         'zeta x', ' over ambient viscosity')
      call file%put('reynolds_pressure', fields%reynolds_pressure, &
         'pressure by the Reynolds equation', 'hertz_pressure', 'x', of_pressure)
      call file%put('reynolds_film_thickness', fields%reynolds_film, &
         'film thickness by the Reynolds equation', 'film', 'x', of_film)
      call file%put('difference_h_min', fields%h_min, 'h_min'//less)
      call file%put('difference_h_central', fields%h_central, 'h_central'//less)
      call file%put('difference_p_max', fields%p_max, 'p_max'//less)
      call file%put('difference_pressure', fields%pressure_change, &
         'largest difference of the mean pressure from the Reynolds equation, over p_h')
      call file%put('pressure_variation', fields%pressure_variation, &
         'largest difference of pressures across the film, over p_h')
      call file%put('stress_rise', fields%stress_rise, &
         'T_max of the thin film, largest d tau/dp at a given shear rate: less than 1')
      call write_attribute(file, '/momentum', 'newton_steps', fields%steps)
      call write_attribute(file, '/momentum', 'factorisations', fields%factorisations)
      call write_attribute(file, '/momentum', 'linear_iterations', fields%linear_iterations)
   end subroutine write_momentum

   !> Writes /statistics, in SI; nothing if nothing was gathered. `from`: first time that counts, T.
   subroutine write_statistics(file, statistics, from)
      type(section_file_t), intent(inout) :: file
      type(film_statistics_t), intent(in) :: statistics
      real(wp), intent(in) :: from

      if (.not. allocated(statistics%thresholds)) return
      if (.not. statistics%times > 0.0_wp) return
      associate (s => statistics, scaling => file%scaling, film => file%scaling%film)
         call file%begin('/statistics', 'over the times that count, from T = statistics_from '// &
            'on; the contact is '//trim(merge('the dry one at the reference load     ', &
            'one half-width to either side of X = 0', allocated(scaling%ellipse))))
         call write_attribute(file, '/statistics', 'statistics_from', max(from, 0.0_wp))
         call file%put('film_threshold', s%thresholds*film, 'stated films', 'm', '=')
         call file%put('time_below', s%times_below/s%times, 'share of the time in which the '// &
            'smallest film is below each threshold', '1', 'film_threshold')
         call file%put('area_below', s%shares_below/s%times, 'share of the contact below each '// &
            'threshold, mean over time', '1', 'film_threshold')
         call file%put('mean_film', s%film_sum/s%times*film, &
            'film, mean over the contact and time', 'm')
         call file%put('smooth_film', s%smooth_film*film, 'film of the smooth contact at X = 0', &
            'm')
         call file%put('rms_height', s%rms_height()*film, &
            'rms of the sum of both heights in the contact, over time', 'm')
         call file%put('lambda_ratio', s%lambda_ratio(), &
            'lambda ratio, smooth_film over rms_height; 0: smooth surfaces')
         call put_distribution('h_min', 'smallest film, parabola through three nodes', &
            s%film_bins, film_first, film, 'm')
         call put_distribution('p_max', 'largest pressure of a node', s%pressure_bins, &
            pressure_first, scaling%hertz_pressure, 'Pa')
      end associate

   contains

      !> The occupied classes of a distribution: edges (n+1), shares of the time between them (n).
      subroutine put_distribution(name, what, bins, first, scale, units)
         character(*), intent(in) :: name, what, units
         real(wp), intent(in) :: bins(:), scale
         integer, intent(in) :: first
         integer :: i, from, to

         from = findloc(bins > 0.0_wp, .true., 1)
         to = findloc(bins > 0.0_wp, .true., 1, back=.true.)
         call file%put(name//'_edges', [(scale*10.0_wp**(first + real(i - 1, wp) &
            /bins_per_decade), i=from, to + 1)], 'edges of the classes of '//name//', '//what, &
            units, '=')
         call file%put(name//'_class', [(scale*10.0_wp**(first + (real(i, wp) - 0.5_wp) &
            /bins_per_decade), i=from, to)], 'middle of each class of '//name, units, '=')
         call file%put(name//'_share', bins(from:to)/statistics%times, &
            'share of the time steps in each class of '//name, '1', name//'_class')
      end subroutine put_distribution

   end subroutine write_statistics

   !> How far the Reynolds equation is off, for the user.
   pure function difference_sentence(fields) result(words)
      type(film_fields_t), intent(in) :: fields
      character(:), allocatable :: words

      words = 'full momentum equations on '//to_text(size(fields%zeta))//' layers; beside '// &
         "Reynolds' equation on the same grid h_min "//percent(fields%h_min, .false.)// &
         ', h_central '//percent(fields%h_central, .false.)//', p_max ' &
         //percent(fields%p_max, .false.)//', pressures up to ' &
         //percent(fields%pressure_change, .false.)//' of p_h'
   end function difference_sentence

   !> Whether formulas hold for a steady `contact`: a smooth one in certain ranges.
   pure logical function has_formulas(contact)
      type(line_contact_t), intent(in) :: contact

      has_formulas = .not. finest_wave(contact) < huge(1.0_wp) .and. formulas_hold( &
         contact%moes_m_sum, contact%moes_l_sum)
   end function has_formulas

   !> Writes /formulas: films, and how far above the computed one.
   subroutine write_formulas(file, contact, summary)
      type(section_file_t), intent(inout) :: file
      type(line_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: summary
      type(label_t) :: label
      real(wp) :: film
      integer :: i

      call file%begin('/formulas', 'films by formulas of handbooks; difference: by how much a '// &
         'film lies above the computed quantity, relative to that; known_bias: the differences '// &
         'between which nine of ten such contacts lie')
      label = scaled_label('', 'film', file%scaling)
      do i = 1, size(formula_rows)
         associate (row => formula_rows(i), path => '/formulas/'//trim(formula_rows(i)%name))
            film = film_by_formula(i, contact%moes_m_sum, contact%moes_l_sum)
            call file%put(trim(row%name), film*label%si_scale, trim(row%text), label%si_units)
            if (label%si_units == '1') call write_attribute(file, path, 'units', '1')
            call write_attribute(file, path, 'dimensionless', film)
            call write_attribute(file, path, 'quantity', trim(row%quantity))
            call write_attribute(file, path, 'difference', difference(film, row%quantity, summary))
            if (.not. thins(contact%fluid)) call write_attribute(file, path, 'known_bias', &
               known_bias(i, contact%fluid))
            call write_attribute(file, path, 'source', trim(row%source))
         end associate
      end do
   end subroutine write_formulas

   !> The lines of the closing table.
   function formula_lines(contact, summary, scaling) result(lines)
      type(line_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: summary
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: lines, value, words
      real(wp) :: bias(2), film
      integer :: i

      lines = ''
      do i = 1, size(formula_rows)
         associate (row => formula_rows(i))
            film = film_by_formula(i, contact%moes_m_sum, contact%moes_l_sum)
            value = number_text(film, 4)
            if (scaling%is_dimensional) value = prefixed_text(film*scaling%film, 'm')
            if (i > 1) lines = lines//new_line('a')
            lines = lines//merge('  formulas  ', '            ', i == 1)//trim(row%quantity)//' ' &
               //value//', '//percent(difference(film, row%quantity, summary), .true.)//': ' &
               //trim(row%authors)
            bias = known_bias(i, contact%fluid)
            if (thins(contact%fluid)) then
               lines = lines//', of oil that does not thin'
            else
               words = percent(bias(1), .true.)
               lines = lines//', known bias '//words(:len(words) - 2)//' to ' &
                  //percent(bias(2), .true.)
            end if
         end associate
      end do
   end function formula_lines

   !> By how much `film` lies above a computed quantity, relative to that.
   pure real(wp) function difference(film, quantity, summary) result(share)
      real(wp), intent(in) :: film
      character(*), intent(in) :: quantity
      type(line_summary_t), intent(in) :: summary

      share = film/summary%of(findloc(quantity_rows%name == quantity, .true., 1))%value - 1
   end function difference

   !> A share in per cent with its sign; `is_whole`: to one of them.
   pure function percent(share, is_whole)
      real(wp), intent(in) :: share
      logical, intent(in) :: is_whole
      character(:), allocatable :: percent
      real(wp) :: number

      number = 100*share
      if (is_whole) number = nint(number)
      percent = number_text(number, 3)
      if (number > 0.0_wp) percent = '+'//percent
      percent = percent//' %'
   end function percent

end module field_sections

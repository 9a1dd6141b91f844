!> The fields of a lubricated result: /solution, /velocity, /momentum by the full momentum equations
!> of the film, over X and zeta, and /statistics of the film over time. Beside the computed films
!> those of handbooks, /formulas, also as lines of the closing table.
module field_sections
   use film_fields, only: film_fields_t
   use film_statistics, only: bins_per_decade, film_first, film_statistics_t, pressure_first
   use hdf5_axes, only: link_object, write_field
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use line_contact, only: finest_wave, line_contact_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use lubricant, only: thins
   use moes, only: film_by_formula, formula_rows, formulas_hold, known_bias
   use quantities, only: quantity_rows
   use result_labels, only: field_names, field_values, row_label, scaled_label
   use scaling, only: scaling_t
   use text, only: number_text, prefixed_text, to_text
   implicit none (type, external)
   private

   public :: difference_sentence, formula_lines, has_formulas, write_formulas, write_momentum, &
      write_solution, write_statistics, write_velocity

   !> What a dimensionless pressure and film are.
   character(*), parameter :: of_pressure = ', P = p/p_h', of_film = ', H = h R/b^2'

contains

   !> /solution: the fields of the last time, of a point contact over x and y; with `has_si` in
   !> /si/solution those that differ in SI.
   subroutine write_solution(file, state, scaling, has_si)
      class(hdf5_file_t), intent(inout) :: file
      type(line_state_t), intent(in) :: state
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: has_si
      character(:), allocatable :: name
      real(wp), allocatable :: values(:)
      integer :: i

      do i = 1, size(field_names)
         name = trim(field_names(i))
         values = field_values(name, state)
         if (size(values) == 0) cycle
         if (i == 1) then
            call put(name, values, '=')
            if (allocated(state%y)) call put('y', state%y, '=')
         else if (allocated(state%y)) then
            call put(name, reshape(values, [size(state%x), size(state%y)]), 'x y')
         else
            call put(name, values, 'x')
         end if
      end do
      name = 'rigid displacement H0 of the undeformed bodies'
      if (.not. allocated(state%y)) name = 'rigid displacement H0 of (2.58); h0 of (2.24) = '// &
         '(b^2/R)(H0 + ln(b)/2), b in m'
      call write_dataset(file, '/solution/rigid_displacement', state%rigid_displacement, &
         scaled_label(name, 'film', scaling))
      call write_dataset(file, '/solution/time', state%time, &
         scaled_label('time of these fields, T = t u_s/(2 b)', 'time', scaling))

   contains

      !> A field with its axes.
      subroutine put(name, values, axes)
         character(*), intent(in) :: name, axes
         real(wp), intent(in), contiguous :: values(..)
         type(label_t) :: label

         label = row_label(name, scaling)
         call write_field(file, '/solution/'//name, values, label, axes, has_si &
            .and. label%has_scale())
      end subroutine put

   end subroutine write_solution

   !> /velocity: `u` (layers + 1, nx) as module film_velocity makes it.
   subroutine write_velocity(file, u, scaling)
      class(hdf5_file_t), intent(inout) :: file
      real(wp), intent(in), contiguous :: u(:, :)
      type(scaling_t), intent(in) :: scaling
      integer :: i

      call file%create_group('/velocity')
      call write_attribute(file, '/velocity', 'about', 'velocity of the oil at the nodes '// &
         '/solution/x, of the same time, by the Reynolds equation; a straight line where P = 0')
      call link_object(file, '/solution/x', '/velocity/x')
      call write_field(file, '/velocity/zeta', [(real(i, wp)/(size(u, 1) - 1), i=0, size(u, 1) &
         - 1)], new_label('place across the film, z/h: 0 at surface 1, 1 at surface 2', '1'), '=')
      call write_field(file, '/velocity/u', u, new_label('velocity along the film, u/u_s', 'm/s', &
         scaling%speed_sum), 'zeta x')
   end subroutine write_velocity

   !> /momentum, of a transient that of its last time; with `has_si` the fields in SI too.
   subroutine write_momentum(file, fields, scaling, is_transient, has_si)
      class(hdf5_file_t), intent(inout) :: file
      type(film_fields_t), intent(in) :: fields
      type(scaling_t), intent(in) :: scaling
      logical, intent(in) :: is_transient, has_si
      character(:), allocatable :: about

      about = '/solution has its mean pressure and its film; beside it the Reynolds equation '// &
         'on the same nodes'
      if (is_transient) about = 'fields of the last time, differences of the extremes of the '// &
         'passage; /solution, /summary and /transient are those of the Reynolds equation'
      call file%create_group('/momentum')
      call write_attribute(file, '/momentum', 'about', 'the film by its full momentum '// &
         'equations, at the nodes /solution/x in layers at zeta = (z - z1)/h; '//about)
      call put('zeta', fields%zeta, new_label('place across the film, 0 at surface 1, 1 at '// &
         'surface 2', '1'), '=')
      call link_object(file, '/solution/x', '/momentum/x')
      if (has_si) then
         call link_object(file, '/momentum/zeta', '/si/momentum/zeta')
         call link_object(file, '/si/solution/x', '/si/momentum/x')
      end if
      associate (u_s => scaling%speed_sum, p_h => scaling%hertz_pressure)
         call put('u', fields%u, new_label('velocity along the film', 'm/s', u_s, ', u/u_s'), &
            'zeta x')
         call put('w', fields%w, new_label('velocity across the film, from surface 1 to '// &
            'surface 2', 'm/s', u_s, ', w/u_s'), 'zeta x')
         call put('layer_pressure', fields%pressure, new_label('pressure of the layers; '// &
            'cavitation is decided by its mean', 'Pa', p_h, of_pressure), 'zeta x')
         call put('shear_stress', fields%shear_stress, new_label('shear stress tau_xz', 'Pa', p_h, &
            '/p_h'), 'zeta x')
         call put('viscosity', fields%viscosity, new_label('viscosity under shear', 'Pa s', &
            scaling%viscosity, ' over ambient viscosity'), 'zeta x')
         call put('reynolds_pressure', fields%reynolds_pressure, new_label('pressure by the '// &
            'Reynolds equation', 'Pa', p_h, of_pressure), 'x')
         call put('reynolds_film_thickness', fields%reynolds_film, new_label('film thickness '// &
            'by the Reynolds equation', 'm', scaling%film, of_film), 'x')
      end associate
      call put('difference_h_min', fields%h_min, row_label('momentum_difference_h_min', scaling))
      call put('difference_h_central', fields%h_central, &
         row_label('momentum_difference_h_central', scaling))
      call put('difference_p_max', fields%p_max, row_label('momentum_difference_p_max', scaling))
      call put('difference_pressure', fields%pressure_change, new_label('largest difference of '// &
         'the mean pressure from the Reynolds equation, over p_h', '1'))
      call put('pressure_variation', fields%pressure_variation, new_label('largest difference '// &
         'of pressures across the film, over p_h', '1'))
      call put('stress_rise', fields%stress_rise, new_label('T_max of the thin film, largest '// &
         'd tau/dp at a given shear rate: less than 1', '1'))
      call write_attribute(file, '/momentum', 'newton_steps', fields%steps)
      call write_attribute(file, '/momentum', 'factorisations', fields%factorisations)
      call write_attribute(file, '/momentum', 'linear_iterations', fields%linear_iterations)

   contains

      !> A field with its axes, or a number.
      subroutine put(name, values, label, axes)
         character(*), intent(in) :: name
         real(wp), intent(in), contiguous :: values(..)
         type(label_t), intent(in) :: label
         character(*), intent(in), optional :: axes

         if (present(axes)) then
            call write_field(file, '/momentum/'//name, values, label, axes, has_si)
         else
            call write_dataset(file, '/momentum/'//name, values, label)
         end if
      end subroutine put

   end subroutine write_momentum

   !> Writes /statistics, in SI; nothing if nothing was gathered. `from`: first time that counts, T.
   subroutine write_statistics(file, statistics, scaling, from)
      class(hdf5_file_t), intent(inout) :: file
      type(film_statistics_t), intent(in) :: statistics
      type(scaling_t), intent(in) :: scaling
      real(wp), intent(in) :: from

      if (.not. allocated(statistics%thresholds)) return
      if (.not. statistics%times > 0.0_wp) return
      associate (s => statistics, film => scaling%film)
         call file%create_group('/statistics')
         call write_attribute(file, '/statistics', 'about', &
            'over the times that count, from T = statistics_from on; the contact is '// &
            trim(merge('the dry one at the reference load     ', &
            'one half-width to either side of X = 0', allocated(scaling%ellipse))))
         call write_attribute(file, '/statistics', 'statistics_from', max(from, 0.0_wp))
         call write_field(file, '/statistics/film_threshold', s%thresholds*film, &
            new_label('stated films', 'm'), '=')
         call write_field(file, '/statistics/time_below', s%times_below/s%times, new_label( &
            'share of the time in which the smallest film is below each threshold', '1'), &
            'film_threshold')
         call write_field(file, '/statistics/area_below', s%shares_below/s%times, new_label( &
            'share of the contact below each threshold, mean over time', '1'), 'film_threshold')
         call write_dataset(file, '/statistics/mean_film', s%film_sum/s%times*film, &
            new_label('film, mean over the contact and time', 'm'))
         call write_dataset(file, '/statistics/smooth_film', s%smooth_film*film, &
            new_label('film of the smooth contact at X = 0', 'm'))
         call write_dataset(file, '/statistics/rms_height', s%rms_height()*film, &
            new_label('rms of the sum of both heights in the contact, over time', 'm'))
         call write_dataset(file, '/statistics/lambda_ratio', s%lambda_ratio(), &
            new_label('lambda ratio, smooth_film over rms_height; 0: smooth surfaces', '1'))
         call write_distribution('h_min', 'smallest film, parabola through three nodes', &
            s%film_bins, film_first, film, 'm')
         call write_distribution('p_max', 'largest pressure of a node', s%pressure_bins, &
            pressure_first, scaling%hertz_pressure, 'Pa')
      end associate

   contains

      !> The occupied classes of a distribution: edges (n+1), shares of the time between them (n).
      subroutine write_distribution(name, what, bins, first, scale, units)
         character(*), intent(in) :: name, what, units
         real(wp), intent(in) :: bins(:), scale
         integer, intent(in) :: first
         integer :: i, from, to

         from = findloc(bins > 0.0_wp, .true., 1)
         to = findloc(bins > 0.0_wp, .true., 1, back=.true.)
         call write_field(file, '/statistics/'//name//'_edges', &
            [(scale*10.0_wp**(first + real(i - 1, wp)/bins_per_decade), i=from, to + 1)], &
            new_label('edges of the classes of '//name//', '//what, units), '=')
         call write_field(file, '/statistics/'//name//'_class', &
            [(scale*10.0_wp**(first + (real(i, wp) - 0.5_wp)/bins_per_decade), i=from, to)], &
            new_label('middle of each class of '//name, units), '=')
         call write_field(file, '/statistics/'//name//'_share', bins(from:to)/statistics%times, &
            new_label('share of the time steps in each class of '//name, '1'), name//'_class')
      end subroutine write_distribution

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
   subroutine write_formulas(file, contact, summary, scaling)
      class(hdf5_file_t), intent(inout) :: file
      type(line_contact_t), intent(in) :: contact
      type(line_summary_t), intent(in) :: summary
      type(scaling_t), intent(in) :: scaling
      character(:), allocatable :: path
      type(label_t) :: label
      real(wp) :: film
      integer :: i

      call file%create_group('/formulas')
      call write_attribute(file, '/formulas', 'about', 'films by formulas of handbooks; '// &
         'difference: by how much a film lies above the computed quantity, relative to that; '// &
         'known_bias: the differences between which nine of ten such contacts lie')
      do i = 1, size(formula_rows)
         associate (row => formula_rows(i))
            path = '/formulas/'//trim(row%name)
            film = film_by_formula(i, contact%moes_m_sum, contact%moes_l_sum)
            label = scaled_label('', 'film', scaling)
            call write_dataset(file, path, film*label%si_scale, new_label(trim(row%text), &
               label%si_units))
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

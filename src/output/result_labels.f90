!> Stored fields and series of a lubricated line contact: name, meaning and scale, once; and a
!> result being written section by section, each value with its name, text and unit.
module result_labels
   use hdf5_axes, only: write_field
   use hdf5_dataset, only: label_t, new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: int64, wp
   use line_state, only: line_state_t
   use quantities, only: quantity_rows
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: field_values, row_label, scaled_label, section_file_t

   !> A result being written.
   type, extends(hdf5_file_t) :: section_file_t
      !> Path of the section.
      character(:), allocatable :: section
      !> Reference values of a lubricated contact, and whether its fields are stored in SI too.
      type(scaling_t) :: scaling
      logical :: has_si = .false.
   contains
      procedure :: begin
      generic :: put => put_reals, put_count, put_words
      procedure, private :: put_reals, put_count, put_words
   end type section_file_t

   !> A field or series.
   type :: row_t
      character(len=29) :: name
      !> The quantity of `scaling_t` that is its unit; '1': none.
      character(len=14) :: unit
      !> What it is, and what the stored number without unit is.
      character(len=80) :: text
      character(len=48) :: definition = ''
   end type row_t

   character(*), parameter :: by = ' by the full momentum equations', from = &
      ' from the Reynolds equation'
   !> What a relative difference is, behind the name of a quantity.
   character(*), parameter, public :: less = ' over that of the Reynolds equation, less 1'
   !> Fields of `line_state_t`, as in /solution, then series of /transient, units of quantities,
   !> series and fields of /momentum/transient.
   type(row_t), parameter :: rows(*) = [ &
      row_t('x', 'half_width', 'position along the contact', ', X = x/b'), &
      row_t('pressure', 'hertz_pressure', 'pressure', ', P = p/p_h'), &
      row_t('film_thickness', 'film', 'film thickness', ', H = h R/b^2'), &
      row_t('asperity_pressure', 'hertz_pressure', 'pressure of asperities, part of the pressure', &
      ', over p_h'), &
      row_t('separation', 'film', 'separation of the mean planes; the film is the mean gap', &
      ', H of (2.58)'), &
      row_t('saturation', '1', 'share of the film that oil fills'), &
      row_t('temperature_rise', 'kelvin', 'temperature rise by sliding, mean across the film'), &
      row_t('temperature_rise_1', 'kelvin', 'temperature rise of surface 1'), &
      row_t('temperature_rise_2', 'kelvin', 'temperature rise of surface 2'), &
      row_t('viscosity', 'viscosity', 'viscosity', ' over ambient viscosity, mu/mu_0'), &
      row_t('density', '1', 'density', ' over ambient density, rho/rho_0'), &
      row_t('slip_factor', '1', 'Eyring slip factor S', '; 1 for a Newtonian fluid'), &
      row_t('roughness_1', 'film', 'height of surface 1, positive out of its material', &
      ', psi_1 R/b^2'), &
      row_t('roughness_2', 'film', 'height of surface 2, positive out of its material', &
      ', psi_2 R/b^2'), &
      row_t('shear_stress_1', 'shear_stress', 'shear stress at the wall of surface 1', &
      ', tau R/(p_h b); 0 where P = 0'), &
      row_t('shear_stress_mean', 'shear_stress', 'mean shear stress across the film', &
      ', tau_m R/(p_h b); 0 where P = 0'), &
      row_t('shear_stress_2', 'shear_stress', 'shear stress at the wall of surface 2', &
      ', tau R/(p_h b); 0 where P = 0'), &
      row_t('y', 'half_width', 'position across', ', Y = y/a'), &
      row_t('time', 'time', 'time of every step', ', T = t u_s/(2 b)'), &
      row_t('rigid_displacement', 'film', 'rigid displacement', ' H0 of (2.58)'), &
      row_t('friction_coefficient', 'slope', 'force over the load'), &
      row_t('power', 'power', 'power per length'), &
      row_t('1', '1', 'pure number'), &
      row_t('load_per_length', 'load', 'load per length', ', w/w_ref'), &
      row_t('load', 'load', 'load', ', w/w_ref'), &
      row_t('reduced_radius', 'radius', 'reduced radius', ', R/R_ref'), &
      row_t('speed_1', 'speed_sum', 'speed of surface 1', ', u_1/u_ref'), &
      row_t('speed_2', 'speed_sum', 'speed of surface 2', ', u_2/u_ref'), &
      row_t('residual', '1', 'residual reached in the step'), &
      row_t('film_breakdown', '1', '1 where the film is below film_floor, else 0'), &
      row_t('profile_time', 'time', 'time of the stored profiles', ', T = t u_s/(2 b)'), &
      row_t('momentum_h_min', 'film', 'smallest film'//by, ', H = h R/b^2'), &
      row_t('momentum_h_central', 'film', 'film at X = 0'//by, ', H = h R/b^2'), &
      row_t('momentum_p_max', 'hertz_pressure', 'largest mean pressure'//by, ', P = p/p_h'), &
      row_t('momentum_difference_h_min', '1', 'h_min'//less), &
      row_t('momentum_difference_h_central', '1', 'h_central'//less), &
      row_t('momentum_difference_p_max', '1', 'p_max'//less), &
      row_t('momentum_difference_pressure', 'hertz_pressure', &
      'largest difference of the mean pressure'//from, ', over p_h'), &
      row_t('momentum_difference_film', 'film', 'largest difference of the film'//from, &
      ', over b^2/R'), &
      row_t('momentum_pressure_variation', 'hertz_pressure', &
      'largest difference of pressures across the film', ', over p_h'), &
      row_t('momentum_pressure', 'hertz_pressure', 'mean pressure', ', P = p/p_h'), &
      row_t('momentum_film_thickness', 'film', 'film thickness', ', H = h R/b^2'), &
      row_t('momentum_profile_time', 'time', 'time of the profiles', ', T = t u_s/(2 b)')]

   !> Names of the fields, and what a transient by the full momentum equations stores too: nine
   !> series of numbers, then fields.
   character(len=29), parameter, public :: field_names(17) = rows(:17)%name, &
      momentum_names(11) = rows(32:42)%name

contains

   !> Begins a section; with words `about` it as a group of its own.
   subroutine begin(self, section, about)
      class(section_file_t), intent(inout) :: self
      character(*), intent(in) :: section
      character(*), intent(in), optional :: about

      self%section = section
      if (.not. present(about)) return
      call self%create_group(section)
      call write_attribute(self, section, 'about', about)
   end subroutine begin

   !> Puts numbers of any rank into the section, with a `unit` as `scaled_label` has it (default: a
   !> pure number); without a `text` what the table says of the name. With `axes`, as `write_field`
   !> has them, they are a field, which may be stored in SI too.
   subroutine put_reals(self, name, values, text, unit, axes, definition)
      class(section_file_t), intent(inout) :: self
      character(*), intent(in) :: name
      real(wp), intent(in), contiguous :: values(..)
      character(*), intent(in), optional :: text, unit, axes, definition
      type(label_t) :: label

      if (.not. present(text)) then
         label = row_label(name, self%scaling)
      else if (present(unit)) then
         label = scaled_label(text, unit, self%scaling)
      else
         label = new_label(text, '1')
      end if
      if (present(definition)) label%definition = definition
      if (present(axes)) then
         call write_field(self, self%section//'/'//name, values, label, axes, &
            self%has_si .and. label%has_scale())
      else
         call write_dataset(self, self%section//'/'//name, values, label)
      end if
   end subroutine put_reals

   !> Puts the number of something.
   subroutine put_count(self, name, value, text)
      class(section_file_t), intent(inout) :: self
      character(*), intent(in) :: name, text
      integer, intent(in) :: value

      call write_dataset(self, self%section//'/'//name, int(value, int64), new_label(text, '1'))
   end subroutine put_count

   !> Puts words.
   subroutine put_words(self, name, words, text)
      class(section_file_t), intent(inout) :: self
      character(*), intent(in) :: name, words, text

      call write_dataset(self, self%section//'/'//name, words, new_label(text, '1'))
   end subroutine put_words

   !> Label of a field, series or quantity.
   pure function row_label(name, scaling) result(label)
      character(*), intent(in) :: name
      type(scaling_t), intent(in) :: scaling
      type(label_t) :: label
      type(row_t) :: row
      integer :: i

      i = findloc(quantity_rows%name == name, .true., 1)
      row%name = name
      if (i > 0) row%name = quantity_rows(i)%field
      row = rows(findloc(rows%name == row%name, .true., 1))
      label = scaled_label(trim(row%text), trim(row%unit), scaling)
      label%definition = trim(row%definition)
      if (allocated(scaling%ellipse)) label%definition = of_point(label%definition)
      if (i > 0) label = new_label(trim(quantity_rows(i)%text), label%si_units, label%si_scale)
   end function row_label

   !> A definition in the scales of a point contact: a for b, Rx for R.
   pure function of_point(definition) result(words)
      character(*), intent(in) :: definition
      character(:), allocatable :: words
      integer :: i

      words = ''
      do i = 1, len(definition)
         if (index(definition(i:), 'b)') == 1 .or. index(definition(max(i - 1, 1):), '/b') == 1) &
            then
            words = words//'a'
         else
            words = words//definition(i:i)
            if (index(definition(i:), 'R/') == 1) words = words//'x'
         end if
      end do
   end function of_point

   !> Label of a value whose unit is the quantity `unit` of `scaling` (a pure number if its scales
   !> in SI are unknown: input by Moes' numbers), or else is named as it is.
   pure function scaled_label(long_name, unit, scaling) result(label)
      character(*), intent(in) :: long_name, unit
      type(scaling_t), intent(in) :: scaling
      type(label_t) :: label
      character(len=*), parameter :: names(*) = [character(len=14) :: 'half_width', 'film', &
         'hertz_pressure', 'time', 'viscosity', 'shear_stress', 'slope', 'power', 'load', &
         'radius', 'speed_sum', 'kelvin'], &
         si_units(*) = [character(len=4) :: 'm', 'm', 'Pa', 's', 'Pa s', 'Pa', '1', 'W/m', &
         'N/m', 'm', 'm/s', 'K']
      real(wp) :: scales(size(names))
      integer :: i

      label = new_label(long_name, unit)
      i = findloc(names == unit, .true., 1)
      if (i == 0) return
      label%si_units = '1'
      if (.not. scaling%is_dimensional) return
      scales = [scaling%half_width, scaling%film, scaling%hertz_pressure, scaling%time, &
         scaling%viscosity, scaling%shear_stress, scaling%slope, scaling%power, &
         scaling%load_per_length, scaling%reduced_radius, scaling%speed_sum, 1.0_wp]
      label = new_label(long_name, trim(si_units(i)), scales(i))
      if (.not. allocated(scaling%ellipse)) return
      if (unit == 'power') label = new_label(long_name, 'W', scales(i))
      if (unit == 'load') label = new_label(long_name, 'N', scales(i))
   end function scaled_label

   !> Values (nx) of a field of `field_names`; none for one that the state does not hold.
   function field_values(name, state) result(values)
      character(*), intent(in) :: name
      type(line_state_t), intent(in) :: state
      real(wp), allocatable :: values(:)

      allocate (values(0))
      call take('x', state%x)
      call take('pressure', state%pressure)
      call take('film_thickness', state%film_thickness)
      call take('asperity_pressure', state%asperity_pressure)
      if (name == 'pressure' .and. allocated(state%asperity_pressure)) values = values &
         + state%asperity_pressure
      call take('separation', state%separation)
      call take('saturation', state%saturation)
      if (allocated(state%temperature_rise)) then
         call take('temperature_rise', state%temperature_rise(:, 1))
         call take('temperature_rise_1', state%temperature_rise(:, 2))
         call take('temperature_rise_2', state%temperature_rise(:, 3))
      end if
      call take('viscosity', state%viscosity)
      call take('density', state%density)
      call take('slip_factor', state%slip_factor)
      call take('roughness_1', state%roughness_1)
      call take('roughness_2', state%roughness_2)
      call take('shear_stress_1', state%shear_stress_1)
      call take('shear_stress_mean', state%shear_stress_mean)
      call take('shear_stress_2', state%shear_stress_2)

   contains

      !> Takes the values of a field, which are absent if they are not allocated.
      subroutine take(field, found)
         character(*), intent(in) :: field
         real(wp), intent(in), optional :: found(:)

         if (.not. present(found) .or. len(field) /= len(name)) return
         if (field == name) values = found
      end subroutine take

   end function field_values

end module result_labels

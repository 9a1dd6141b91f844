!> From the text of a namelist to a case: reading, checking, filling the record.
module case_input
   use bodies, only: reduced_radius, reduced_modulus
   use case_effective, only: list_dry, list_effective
   use case_record, only: case_t
   use case_validation, only: validate
   use dry_input, only: fill_dry_case
   use errors, only: error_t
   use features, only: rough_surface_t, feature_ridge, feature_sinusoid
   use findings, only: findings_t
   use hertz, only: line_load_from_pressure
   use input_keys, only: find_key, key_rows
   use input_values, only: input_values_t, value_t, read_values
   use key_row, only: lubricated
   use key_range, only: is_in_range
   use kinds, only: wp
   use line_profiles, only: add_profile
   use lubricant, only: density_constant, density_dowson_higginson, rheology_eyring, &
      rheology_newtonian, viscosity_barus, viscosity_constant, viscosity_roelands
   use moes, only: moes_m_mean_from_sum, moes_l_mean_from_sum
   use number_text, only: read_real
   use namelist_text, only: namelist_text_t, split_namelist
   use scaling, only: scaling_t, new_scaling
   use text, only: to_text
   use roelands_relation, only: complete_roelands
   use wave_validation, only: check_waves
   implicit none (type, external)
   private

   public :: read_case

contains

   !> Reads the namelist `content` of the file `file` (a name for paths and messages only).
   !>
   !> `case` is filled if `findings` stays empty. Findings: everything that is wrong, see modules
   !> namelist_text, input_values and case_validation.
   subroutine read_case(content, file, case, findings)
      character(*), intent(in) :: content, file
      type(case_t), intent(out) :: case
      type(findings_t), intent(inout) :: findings
      type(namelist_text_t) :: pieces
      type(input_values_t) :: values
      type(rough_surface_t) :: surface_1, surface_2

      call split_namelist(content, pieces, findings)
      if (pieces%group_count == 0) then
         if (findings%count == 0) call findings%add(1, '', '', &
            'found no group, expected &case ... / and others; see ' &
            // 'asperity --template ehl_line')
         return
      end if
      call read_values(pieces, values, findings)
      case%file = file
      case%namelist = content
      call validate(values, findings)
      if (values%problem /= lubricated) then
         call read_dry_case(values, case, findings)
         return
      end if
      if (findings%count > 0) return
      case%has_moes = values%has_group('moes')
      call fill_case(values, case)
      call fill_bodies(values, case)
      call fill_lubricant(values, case)
      call fill_surface(values, 'surface_1', case%bodies%speed_1, case%surface_1)
      call fill_surface(values, 'surface_2', case%bodies%speed_2, case%surface_2)
      call fill_numerics(values, case)
      call check_regime(values, case, findings)
      if (findings%count > 0) return
      call list_effective(values, case)
      surface_1 = case%surface_1
      surface_2 = case%surface_2
      call add_profile(values, 'surface_1', case, surface_1, findings)
      call add_profile(values, 'surface_2', case, surface_2, findings)
      case%surface_1 = surface_1
      case%surface_2 = surface_2
      if (findings%count == 0) call check_waves(values, case, findings)
   end subroutine read_case

   !> The rest of a dry case. Findings: see module dry_input.
   subroutine read_dry_case(values, case, findings)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      type(findings_t), intent(inout) :: findings

      if (findings%count > 0) return
      call fill_dry_case(values, case%file(:index(case%file, '/', back=.true.)), case%dry, findings)
      if (findings%count > 0) return
      call fill_case(values, case)
      case%has_moes = .false.
      call list_effective(values, case)
      call list_dry(case)
   end subroutine read_dry_case

   !> &case, &output and &accuracy.
   subroutine fill_case(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      type(value_t) :: slot

      slot = values%slot('case', 'title')
      case%title = slot%text
      slot = values%slot('case', 'output')
      case%output = trim(slot%text)
      case%problem = values%word_value('case', 'problem')
      case%model = values%word_value('case', 'model')
      if (case%problem /= lubricated) return
      slot = values%slot('output', 'profile_stride')
      case%output_settings%profile_stride = slot%integer
      slot = values%slot('output', 'fields')
      case%output_settings%fields = slot%words
      case%output_settings%checkpoint_interval = values%real_value('output', 'checkpoint_interval')
      slot = values%slot('output', 'film_thresholds')
      case%output_settings%film_thresholds = slot%reals
      case%accuracy%target = values%real_value('accuracy', 'target')
      slot = values%slot('accuracy', 'error_bars')
      case%accuracy%has_error_bars = slot%logical
   end subroutine fill_case

   !> &bodies and &load, or &moes.
   subroutine fill_bodies(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case

      case%moes_m = values%real_value('moes', 'moes_m')
      case%moes_l = values%real_value('moes', 'moes_l')
      if (values%word_value('moes', 'velocity') == 'sum') then
         case%moes_m = moes_m_mean_from_sum(case%moes_m)
         case%moes_l = moes_l_mean_from_sum(case%moes_l)
      end if
      case%bodies%reduced_radius = values%real_value('bodies', 'reduced_radius')
      case%bodies%reduced_modulus = values%real_value('bodies', 'reduced_modulus')
      case%bodies%speed_1 = values%real_value('bodies', 'speed_1')
      case%bodies%speed_2 = values%real_value('bodies', 'speed_2')
      case%load_per_length = values%real_value('load', 'load_per_length')
      if (case%has_moes) return
      if (.not. values%is_given('bodies', 'reduced_radius')) case%bodies%reduced_radius = &
         reduced_radius(values%real_value('bodies', 'radius_1'), values%real_value('bodies', &
            'radius_2'))
      if (.not. values%is_given('bodies', 'reduced_modulus')) case%bodies%reduced_modulus = &
         reduced_modulus( &
         values%real_value('bodies', 'youngs_modulus_1'), values%real_value('bodies', &
            'poisson_ratio_1'), &
         values%real_value('bodies', 'youngs_modulus_2'), values%real_value('bodies', &
            'poisson_ratio_2'))
      if (values%is_given('load', 'hertz_pressure')) case%load_per_length = &
         line_load_from_pressure( &
         values%real_value('load', 'hertz_pressure'), case%bodies%reduced_radius, &
            case%bodies%reduced_modulus)
   end subroutine fill_bodies

   !> &lubricant; parameters that a law does not use are 0.
   subroutine fill_lubricant(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      type(error_t), allocatable :: error

      associate (oil => case%lubricant)
         oil%viscosity = values%real_value('lubricant', 'viscosity')
         oil%pressure_viscosity = values%real_value('lubricant', 'pressure_viscosity')
         oil%roelands_p0 = values%real_value('lubricant', 'roelands_p0')
         oil%roelands_z = values%real_value('lubricant', 'roelands_z')
         oil%eyring_stress = values%real_value('lubricant', 'eyring_stress')
         oil%rheology = merge(rheology_eyring, rheology_newtonian, values%word_value('lubricant', &
            'rheology') == 'eyring')
         oil%density_law = density_constant
         if (values%word_value('lubricant', &
            'density_law') == 'dowson_higginson') oil%density_law = density_dowson_higginson
         select case (values%word_value('lubricant', 'viscosity_law'))
         case ('roelands')
            oil%viscosity_law = viscosity_roelands
         case ('barus')
            oil%viscosity_law = viscosity_barus
         case default
            oil%viscosity_law = viscosity_constant
         end select
      end associate
      if (case%has_moes) then
         call fill_moes_lubricant(case)
      else if (case%lubricant%viscosity_law == viscosity_roelands) then
         call complete_roelands(case%lubricant%viscosity, case%lubricant%pressure_viscosity, &
            case%lubricant%roelands_p0, &
            case%lubricant%roelands_z, error)
      end if
   end subroutine fill_lubricant

   !> With &moes: L = 0 is constant viscosity and density; else what the laws need and is not given
   !> gets a usual value.
   subroutine fill_moes_lubricant(case)
      type(case_t), intent(inout) :: case

      associate (oil => case%lubricant)
         if (case%moes_l <= 0.0_wp) then
            oil%viscosity_law = viscosity_constant
            oil%density_law = density_constant
            return
         end if
         if (oil%viscosity_law /= viscosity_roelands &
            .and. oil%density_law == density_constant) return
         if (oil%pressure_viscosity <= 0.0_wp) oil%pressure_viscosity = &
            moes_default('pressure_viscosity')
         if (oil%viscosity_law /= viscosity_roelands) return
         if (oil%roelands_p0 <= 0.0_wp) oil%roelands_p0 = moes_default('roelands_p0')
         if (oil%roelands_z <= 0.0_wp) oil%roelands_z = moes_default('roelands_z')
      end associate
   end subroutine fill_moes_lubricant

   !> The value of a key of &lubricant with &moes where none is given.
   function moes_default(key) result(value)
      character(*), intent(in) :: key
      real(wp) :: value
      logical :: good

      call read_real(trim(key_rows(find_key('lubricant', key))%moes_default), value, good)
   end function moes_default

   !> A surface of ridges and sinusoids; no features if smooth. `speed` [m/s].
   subroutine fill_surface(values, group, speed, surface)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      real(wp), intent(in) :: speed
      type(rough_surface_t), intent(out) :: surface
      type(value_t) :: shape, amplitude, wavelength, position
      integer :: i

      surface%speed = speed
      shape = values%slot(group, 'shape')
      if (all(shape%words == 'smooth' .or. shape%words == 'file' &
         .or. shape%words == 'synthetic')) then
         allocate (surface%features(0))
         return
      end if
      amplitude = values%slot(group, 'amplitude')
      wavelength = values%slot(group, 'wavelength')
      position = values%slot(group, 'position')
      allocate (surface%features(size(amplitude%reals)))
      do i = 1, size(surface%features)
         associate (feature => surface%features(i))
            feature%kind = feature_ridge
            if (shape%words(min(i, size(shape%words))) == 'sinusoid') feature%kind = &
               feature_sinusoid
            feature%amplitude = amplitude%reals(i)
            feature%wavelength = wavelength%reals(i)
            feature%position = 0.0_wp
            if (position%is_given) feature%position = position%reals(i)
            feature%is_placed = position%is_given
         end associate
      end do
   end subroutine fill_surface

   !> &domain, &time and &solver; 0 where the program chooses.
   subroutine fill_numerics(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      type(value_t) :: slot

      case%domain%has_inlet = values%has_value('domain', 'x_inlet')
      case%domain%has_outlet = values%has_value('domain', 'x_outlet')
      case%domain%x_inlet = values%real_value('domain', 'x_inlet')
      case%domain%x_outlet = values%real_value('domain', 'x_outlet')
      case%domain%intervals = integer_of(values, 'domain', 'intervals')
      case%domain%inlet = values%word_value('domain', 'inlet')
      slot = values%slot('time', 'transient')
      case%time%is_transient = slot%logical
      if (case%time%is_transient .and. case%domain%inlet == 'auto') case%domain%inlet = 'zero'
      case%time%end_time = values%real_value('time', 'end_time')
      case%time%time_step = values%real_value('time', 'time_step')
      case%time%scheme = values%word_value('time', 'scheme')
      if (values%is_given('time', 'statistics_from')) case%time%statistics_from = &
         values%real_value('time', 'statistics_from')
      associate (solver => case%solver)
         solver%method = values%word_value('solver', 'method')
         solver%smoother = values%word_value('solver', 'smoother')
         solver%space_scheme = values%word_value('solver', 'space_scheme')
         solver%start = values%word_value('solver', 'start')
         solver%tolerance = values%real_value('solver', 'tolerance')
         solver%max_cycles = integer_of(values, 'solver', 'max_cycles')
         solver%levels = integer_of(values, 'solver', 'levels')
         solver%pre_sweeps = integer_of(values, 'solver', 'pre_sweeps')
         solver%post_sweeps = integer_of(values, 'solver', 'post_sweeps')
         solver%coarse_sweeps = integer_of(values, 'solver', 'coarse_sweeps')
         solver%relaxation = values%real_value('solver', 'relaxation')
         solver%load_relaxation = values%real_value('solver', 'load_relaxation')
         solver%on_film_breakdown = values%word_value('solver', 'on_film_breakdown')
      end associate
      case%film_floor = values%real_value('solver', 'film_floor')
   end subroutine fill_numerics

   !> The integer of a key; 0 if there is none.
   function integer_of(values, group, key) result(number)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group, key
      integer :: number
      type(value_t) :: slot

      slot = values%slot(group, key)
      number = 0
      if (slot%has_value) number = slot%integer
   end function integer_of

   !> A finding is a load for which the contact is wider than the radius, where neither Hertz nor
   !> the half-space holds; a contact outside the range of &moes is one too.
   subroutine check_regime(values, case, findings)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(in) :: case
      type(findings_t), intent(inout) :: findings
      type(scaling_t) :: scales
      character(:), allocatable :: key

      if (case%has_moes) return
      key = 'load_per_length'
      if (values%is_given('load', 'hertz_pressure')) key = 'hertz_pressure'
      call new_scaling(scales, case%bodies, case%lubricant, case%load_per_length)
      if (scales%half_width >= case%bodies%reduced_radius) then
         call findings%add(values%line_of('load', key), 'load', key, &
            'found a contact of half-width ' &
            // to_text(scales%half_width, 3) // ' m, expected less than the reduced radius, ' &
            // to_text(case%bodies%reduced_radius, 3) // ' m')
      else if (.not. is_in_range(scales%moes_m, key_rows(find_key('moes', 'moes_m'))%range) .or. &
         .not. is_in_range(scales%moes_l, key_rows(find_key('moes', 'moes_l'))%range)) then
         call findings%add(values%line_of('load', key), 'load', key, &
            'found a contact with Moes numbers M = ' &
            // to_text(scales%moes_m, 3) // ', L = ' // to_text(scales%moes_l, &
               3) // ' (mean velocity), expected M ' &
            // trim(key_rows(find_key('moes', 'moes_m'))%range) // ' and L ' &
               // trim(key_rows(find_key('moes', 'moes_l'))%range))
      end if
   end subroutine check_regime

end module case_input

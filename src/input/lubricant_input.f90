!> &lubricant: parameters and laws that contradict each other, and the oil that its keys describe;
!> &asperities: the law of rough surfaces in contact, from its keys or a table.
module lubricant_input
   use asperities, only: asperities_t, greenwood_tripp, new_law
   use column_table, only: column_table_t, read_columns
   use errors, only: error_t, fail, input_error
   use hdf5_input, only: hdf5_input_t, is_hdf5, open_hdf5_input
   use input_keys, only: find_key, key_rows
   use input_values, only: input_values_t, value_t
   use key_row, only: lubricated
   use kinds, only: wp
   use lubricant, only: density_constant, density_laws, lubricant_t, &
      viscosity_constant, viscosity_laws, viscosity_roelands
   use number_text, only: read_real
   use oil_viscosity, only: complete_roelands, largest_viscosity, least_viscosity, new_walther, &
      roelands_alpha, roelands_log_shift, viscosity_at_100, viscosity_of_class, walther_t
   use scaling, only: rheologies, rheology_newtonian
   use text, only: joined, number_text, to_text
   use validity, only: materials_t
   implicit none (type, external)
   private

   public :: check_moes_laws, check_roelands, complete_alpha, derive_viscosity, fill_lubricant, &
      read_asperities

   !> The ways to give the viscosity.
   character(len=19), parameter :: ways(3) = [character(len=19) :: 'viscosity', &
      'viscosity_grade', 'kinematic_viscosity']
   !> Columns of a table of asperities, and their names in the result of a dry sweep.
   character(len=24), parameter :: columns(2) = [character(len=24) :: 'gap [m]', 'pressure [Pa]']
   character(len=22), parameter :: datasets(2) = [character(len=22) :: '/sweep/mean_separation', &
      '/sweep/mean_pressure']
   !> Decay length of Persson's law over rms height, where it is not given.
   real(wp), parameter :: usual_decay = 0.45_wp

contains

   !> Gives mu_0 [Pa s], and -d ln(mu_0)/dT [1/K] where it is not given, from what the data sheet
   !> of the oil states. `words`: what was derived; empty: nothing. Findings: mu_0 is given in two
   !> ways; a temperature is missing or not used; what `read_sheet` finds.
   subroutine derive_viscosity(values, words)
      type(input_values_t), intent(inout) :: values
      character(:), allocatable, intent(out) :: words
      type(value_t) :: sheet
      character(:), allocatable :: key
      logical :: given(size(ways))

      words = ''
      given = values%is_given('lubricant', ways)
      if (values%has_group('moes') .or. .not. any(given)) return
      key = trim(ways(findloc(given, .true., dim=1, back=.true.)))
      sheet = values%slot('lubricant', ways(3))
      if (.not. (given(2) .or. size(sheet%reals) > 1)) then
         call values%refuse_unused('lubricant', 'temperature', &
            'without viscosity_grade or two values of kinematic_viscosity')
      else if (count(given) == 1 .and. .not. values%is_given('lubricant', 'temperature')) then
         call values%refuse_missing('lubricant', 'temperature', 'with '//key)
      end if
      if (count(given) > 1) then
         call values%refuse('lubricant', key, 'found together with '//trim(ways(findloc(given, &
            .true., dim=1)))//', expected one of '//joined(ways, ', ', last=' and '))
      else if (.not. given(1)) then
         call read_sheet(values, key, words)
      end if
      associate (slot => values%slots(find_key('lubricant', ways(1), values%problem)))
         if (.not. slot%is_given) slot%line = values%line_of('lubricant', key)
         slot%is_given = .true.
      end associate
   end subroutine derive_viscosity

   !> Gives mu_0 and its slope by the values of `key`: a class of viscosity, or one or two kinematic
   !> viscosities. `words` as above. Findings: values of no oil; values outside the standards.
   subroutine read_sheet(values, key, words)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: key
      character(:), allocatable, intent(inout) :: words
      real(wp), parameter :: at(2) = [40.0_wp, 100.0_wp], mm2 = 1.0e-6_wp
      type(value_t) :: sheet
      character(:), allocatable :: fault, oil
      real(wp) :: index, nu(2), viscosity
      integer :: class

      sheet = values%slot('lubricant', key)
      if (.not. (sheet%has_value .and. values%has_value('lubricant', 'density') &
         .and. values%has_value('lubricant', 'viscosity_index'))) return
      fault = ''
      if (key == 'viscosity_grade') then
         index = values%real_value('lubricant', 'viscosity_index')
         class = nint(sheet%reals(1))
         nu(1) = viscosity_of_class(class)
         nu(2) = viscosity_at_100(nu(1), index)
         oil = 'oil ISO VG '//to_text(class)//', viscosity index '//number_text(index, 3)
         if (.not. values%is_given('lubricant', 'viscosity_index')) oil = 'mineral '//oil
         if (nu(2) < least_viscosity) fault = 'found '//to_text(class)//', expected an '// &
            'oil of at least 2 mm2/s at 100 degC, where the viscosity index begins, or '// &
            'kinematic_viscosity'
      else
         nu = [sheet%reals(1), sheet%reals(size(sheet%reals))]
         oil = 'oil of '//number_text(nu(1), 3)//' mm2/s'
         if (size(sheet%reals) > 1) oil = oil//' at 40 degC, '//number_text(nu(2), 3)// &
            ' at 100 degC'
         if (size(sheet%reals) > 2) then
            fault = 'found '//to_text(size(sheet%reals))//' values, expected one, at the '// &
               'temperature of the inlet, or two, at 40 and 100 degC'
         else if (size(sheet%reals) == 2 .and. .not. (nu(1) > nu(2) &
            .and. nu(2) >= least_viscosity)) then
            fault = 'found an '//oil//', expected less at 100 than at 40 degC, and at least 2 mm2/s'
         end if
      end if
      if (fault /= '') then
         call values%refuse('lubricant', key, fault)
      else
         viscosity = nu(1)
         if (nu(1) > nu(2)) call follow_line(values, key, new_walther(nu, at), viscosity, oil)
         if (viscosity <= 0.0_wp) return
         viscosity = mm2*viscosity*values%real_value('lubricant', 'density')
         call values%give('lubricant', 'viscosity', viscosity, key)
         words = oil//', '//to_text(viscosity, 3)//' Pa s'
      end if
   end subroutine read_sheet

   !> Computes the kinematic `viscosity` [mm2/s] at the inlet temperature by a `line`, adds both to
   !> the words about the `oil`, gives the slope. Finding, and 0: the line does not reach so far.
   subroutine follow_line(values, key, line, viscosity, oil)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: key
      type(walther_t), intent(in) :: line
      real(wp), intent(out) :: viscosity
      character(:), allocatable, intent(inout) :: oil
      character(:), allocatable :: found
      real(wp) :: t

      viscosity = 0.0_wp
      if (.not. values%has_value('lubricant', 'temperature')) return
      t = values%real_value('lubricant', 'temperature')
      viscosity = line%viscosity(t)
      found = number_text(t, 3)//' degC: '//number_text(viscosity, 3)//' mm2/s'
      oil = oil//', at '//found
      if (viscosity < least_viscosity .or. viscosity > largest_viscosity) then
         viscosity = 0.0_wp
         call values%refuse('lubricant', 'temperature', 'found '//found//', expected a '// &
            'temperature [degC] with 2 to 2e7 mm2/s, the range of ASTM D341')
      else if (.not. values%is_given('lubricant', 'thermal_viscosity')) then
         call values%give('lubricant', 'thermal_viscosity', line%thermal_slope(t), key)
      end if
   end subroutine follow_line

   !> Gives P0 of Roelands its usual value if alpha is the only parameter given: `is_alone`.
   subroutine complete_alpha(values, is_alone)
      type(input_values_t), intent(inout) :: values
      logical, intent(out) :: is_alone

      is_alone = values%word_value('lubricant', 'viscosity_law') == 'roelands' .and. .not. &
         values%has_group('moes') .and. values%has_value('lubricant', 'pressure_viscosity') .and. &
         .not. (values%is_given('lubricant', 'roelands_p0') .or. values%is_given('lubricant', &
         'roelands_z'))
      if (is_alone) call values%give('lubricant', 'roelands_p0', usual('roelands_p0'), &
         'pressure_viscosity')
   end subroutine complete_alpha

   !> Finds too few of alpha (alone with the usual P0), P0, z, or three that contradict (2.27).
   subroutine check_roelands(values)
      type(input_values_t), intent(inout) :: values
      character(len=20), parameter :: keys(*) = [character(len=20) :: 'viscosity', &
         'pressure_viscosity', 'roelands_p0', 'roelands_z']
      character(len=20) :: last
      real(wp) :: number(size(keys))
      integer :: given
      logical :: is_sound

      if (.not. values%has_group('lubricant') .or. values%has_group('moes') &
         .or. values%word_value('lubricant', 'viscosity_law') /= 'roelands') return
      if (any(values%is_given('lubricant', keys) .neqv. values%has_value('lubricant', keys))) return
      number = values%real_value('lubricant', keys)
      given = count(number(2:) > 0.0_wp)
      last = keys(max(2, findloc(number > 0.0_wp, .true., dim=1, back=.true.)))
      if (number(1) <= 0.0_wp) return
      call complete_roelands(number(1), number(2), number(3), number(4), is_sound)
      if (is_sound) return
      if (given < 2) then
         call values%refuse('lubricant', last, 'found ' // to_text(given) &
            // ' of pressure_viscosity, roelands_p0 and roelands_z, expected '// &
               "pressure_viscosity or two of them with viscosity_law = 'roelands'")
      else if (number(1) <= exp(-roelands_log_shift)) then
         call values%refuse('lubricant', 'viscosity', 'found ' // to_text(number(1)) &
            // ', expected more than ' // to_text(exp(-roelands_log_shift), 3) &
            // " [Pa s] with viscosity_law = 'roelands'")
      else
         call values%refuse('lubricant', 'pressure_viscosity', 'found '// to_text(number(2), 5) // &
            ' with roelands_p0 and roelands_z, expected ' // to_text(roelands_alpha(number(1), &
            number(3), number(4)), 5) // ' [1/Pa] by (2.27), or only two of the three')
      end if
   end subroutine check_roelands

   !> With &moes the pressure scale is p_h = alpha_bar/alpha. Findings: an Eyring law; laws that
   !> contradict moes_l; alpha where nothing depends on it.
   subroutine check_moes_laws(values)
      type(input_values_t), intent(inout) :: values
      character(:), allocatable :: law
      logical :: is_compressible, has_l

      if (.not. all(values%has_group([character(len=9) :: 'lubricant', 'moes']))) return
      if (values%word_value('lubricant', 'rheology') == 'eyring') call values%refuse('lubricant', &
         'rheology', &
         "found 'eyring' with &moes, expected 'newtonian': the Eyring law needs SI units")
      if (.not. values%has_value('moes', 'moes_l')) return
      law = trim(values%word_value('lubricant', 'viscosity_law'))
      is_compressible = values%word_value('lubricant', 'density_law') == 'dowson_higginson'
      has_l = values%real_value('moes', 'moes_l') > 0.0_wp
      if (has_l .and. law == 'constant') call values%refuse('lubricant', 'viscosity_law', &
         "found 'constant' with moes_l > 0, expected 'roelands' or 'barus', or moes_l = 0")
      if (.not. has_l .and. is_compressible .and. values%is_given('lubricant', &
         'density_law')) call values%refuse('lubricant', 'density_law', &
         "found 'dowson_higginson' with moes_l = 0, expected 'constant': the pressure scale is "// &
         'unknown')
      if (has_l .and. law == 'barus' .and. .not. is_compressible) call values%refuse_unused( &
         'lubricant', 'pressure_viscosity', 'with &moes, Barus and constant density')
   end subroutine check_moes_laws

   !> The oil; parameters that a law does not use are 0. With &moes L = 0 is constant viscosity and
   !> density; else what the laws need and is not given gets its usual value. `materials`: what only
   !> the limits of the model need, of &bodies and &lubricant.
   subroutine fill_lubricant(values, oil, materials)
      type(input_values_t), intent(in) :: values
      type(lubricant_t), intent(out) :: oil
      type(materials_t), intent(out) :: materials
      logical :: is_sound   ! `check_roelands` tells

      oil%viscosity = values%real_value('lubricant', 'viscosity')
      oil%limit_ratio = values%real_value('lubricant', 'limit_ratio')
      oil%is_cut = values%word_value('lubricant', 'shear_limit') == 'cut'
      oil%pressure_viscosity = values%real_value('lubricant', 'pressure_viscosity')
      oil%roelands_p0 = values%real_value('lubricant', 'roelands_p0')
      oil%roelands_z = values%real_value('lubricant', 'roelands_z')
      oil%rheology = findloc(rheologies == values%word_value('lubricant', 'rheology'), &
         .true., 1) - 1   ! -1: a word without a law, which stops where the law is needed
      oil%stress_scale = 0.0_wp
      if (oil%rheology /= rheology_newtonian) oil%stress_scale = values%real_value('lubricant', &
         trim(values%word_value('lubricant', 'rheology'))//'_stress')
      oil%density_law = findloc(density_laws == values%word_value('lubricant', 'density_law'), &
         .true., 1) - 1
      oil%viscosity_law = findloc(viscosity_laws == values%word_value('lubricant', &
         'viscosity_law'), .true., 1) - 1
      materials%hardness = values%real_value('bodies', 'hardness')
      materials%length = values%real_value('bodies', 'contact_length')
      materials%roughness = values%real_value('bodies', ['roughness_1', 'roughness_2'])
      materials%effusivity = values%real_value('bodies', 'thermal_effusivity')
      materials%density = values%real_value('lubricant', 'density')
      materials%conductivity = values%real_value('lubricant', 'thermal_conductivity')
      materials%thermal_viscosity = values%real_value('lubricant', 'thermal_viscosity')
      if (.not. values%has_group('moes')) then
         if (oil%viscosity_law == viscosity_roelands) call complete_roelands(oil%viscosity, &
            oil%pressure_viscosity, oil%roelands_p0, oil%roelands_z, is_sound)
      else if (values%real_value('moes', 'moes_l') <= 0.0_wp) then
         oil%viscosity_law = viscosity_constant
         oil%density_law = density_constant
      else
         if (oil%viscosity_law /= viscosity_roelands .and. oil%density_law &
            == density_constant) return
         if (oil%pressure_viscosity <= 0.0_wp) oil%pressure_viscosity = usual('pressure_viscosity')
         if (oil%viscosity_law /= viscosity_roelands) return
         if (oil%roelands_p0 <= 0.0_wp) oil%roelands_p0 = usual('roelands_p0')
         if (oil%roelands_z <= 0.0_wp) oil%roelands_z = usual('roelands_z')
      end if
   end subroutine fill_lubricant

   !> The usual value of a parameter, that with &moes where none is given.
   real(wp) function usual(key) result(value)
      character(*), intent(in) :: key
      logical :: good

      call read_real(trim(key_rows(find_key('lubricant', key, lubricated))%moes_default), value, &
         good)
   end function usual

   !> Reads &asperities, if any, with the table `file`; `modulus` [Pa]. Findings: the table.
   subroutine read_asperities(values, file, modulus, law)
      type(input_values_t), intent(inout) :: values
      character(*), intent(in) :: file
      real(wp), intent(in) :: modulus
      type(asperities_t), allocatable, intent(out) :: law
      type(error_t), allocatable :: error
      real(wp), allocatable :: rows(:, :)
      real(wp) :: roughness, decay

      if (.not. values%has_group('asperities')) return
      allocate (law)
      roughness = values%real_value('asperities', 'rms_height')
      select case (values%word_value('asperities', 'law'))
      case ('exponential')
         decay = values%real_value('asperities', 'decay_length', usual_decay*roughness)
         law = new_law(roughness, [0.0_wp, decay], values%real_value('asperities', &
            'contact_pressure')*[1.0_wp, exp(-1.0_wp)])
      case ('greenwood_tripp')
         law = greenwood_tripp(roughness, values%real_value('asperities', &
            'density_radius_height'), values%real_value('asperities', 'height_over_radius'), &
            modulus)
      case default
         call read_law(file, rows, error)
         if (allocated(error)) then
            call values%refuse('asperities', 'file', error%message)
            deallocate (law)
            return
         end if
         law = new_law(roughness, rows(:, 1), rows(:, 2))
      end select
      law%has_flow_factor = values%word_value('asperities', 'flow') == 'patir_cheng'
      law%boundary_friction = values%real_value('asperities', 'boundary_friction')
   end subroutine read_asperities

   !> Reads rising gaps [m], falling pressures [Pa] (rows, 2). Errors: the file; others in it.
   subroutine read_law(file, rows, error)
      character(*), intent(in) :: file
      real(wp), allocatable, intent(out) :: rows(:, :)
      type(error_t), allocatable, intent(out) :: error
      type(column_table_t) :: table
      type(hdf5_input_t) :: reader
      integer :: i, n

      if (is_hdf5(file)) then   ! of a dry sweep from the heaviest load to the lightest with a gap
         call open_hdf5_input(reader, file, error)
         if (allocated(error)) return
         associate (gaps => reader%reals(trim(datasets(1))), &
            pressures => reader%reals(trim(datasets(2))))
            n = size(gaps)
            call reader%close(error)
            if (allocated(error)) return
            rows = reshape([gaps(n:1:-1), pressures(n:1:-1)], [n, 2])
         end associate
         if (n < 2) call fail(error, input_error, file//': found '//to_text(n)//' load, '// &
            'expected a dry sweep with two or more')
      else
         table = column_table_t(columns, [-1.0e-3_wp, 1.0e-3_wp], [1.0e-3_wp, 1.0e13_wp])
         call read_columns(file, table, error)
         if (.not. allocated(error)) call move_alloc(table%values, rows)
      end if
      if (allocated(error)) return
      n = size(rows, 1)
      i = findloc(rows(2:, 1) > rows(:n - 1, 1) .and. rows(2:, 2) < rows(:n - 1, 2), .false., dim=1)
      if (i > 0) call fail(error, input_error, file//': found '//to_text(rows(i + 1, 2), 4)// &
         ' Pa at '//to_text(rows(i + 1, 1), 4)//' m behind '//to_text(rows(i, 2), 4)//' Pa at '// &
         to_text(rows(i, 1), 4)//' m, expected a pressure that falls as the gap grows')
   end subroutine read_law

end module lubricant_input

!> &lubricant: parameters and laws that contradict each other, and the oil that its keys describe.
module lubricant_input
   use errors, only: error_t
   use input_keys, only: find_key, key_rows
   use input_values, only: input_values_t
   use kinds, only: wp
   use lubricant, only: density_constant, density_laws, lubricant_t, &
      viscosity_constant, viscosity_laws, viscosity_roelands
   use number_text, only: read_real
   use roelands_relation, only: complete_roelands, roelands_alpha, roelands_log_shift
   use scaling, only: rheologies, rheology_newtonian
   use text, only: to_text
   use validity, only: materials_t
   implicit none (type, external)
   private

   public :: check_lubricant, complete_alpha, fill_lubricant

contains

   !> Gives P0 of Roelands its usual value if alpha is the only parameter given: `is_alone`.
   subroutine complete_alpha(values, is_alone)
      type(input_values_t), intent(inout) :: values
      logical, intent(out) :: is_alone

      is_alone = values%word_value('lubricant', 'viscosity_law') == 'roelands' .and. .not. &
         values%has_group('moes') .and. values%has_value('lubricant', 'pressure_viscosity') .and. &
         .not. (values%is_given('lubricant', 'roelands_p0') .or. values%is_given('lubricant', &
         'roelands_z'))
      if (is_alone) call values%give('lubricant', 'roelands_p0', 'pressure_viscosity', &
         usual('roelands_p0'))
   end subroutine complete_alpha

   !> Findings: too few or contradictory parameters of Roelands' law; laws that &moes excludes.
   subroutine check_lubricant(values)
      type(input_values_t), intent(inout) :: values

      if (.not. values%has_group('lubricant')) return
      if (values%has_group('moes')) then
         call check_moes_laws(values)
      else if (values%word_value('lubricant', 'viscosity_law') == 'roelands') then
         call check_roelands(values)
      end if
   end subroutine check_lubricant

   !> Finds too few of alpha (alone with the usual P0), P0, z, or three that contradict (2.27).
   subroutine check_roelands(values)
      type(input_values_t), intent(inout) :: values
      type(error_t), allocatable :: error
      character(len=20), parameter :: keys(*) = [character(len=20) :: 'viscosity', &
         'pressure_viscosity', 'roelands_p0', 'roelands_z']
      character(len=20) :: last
      real(wp) :: number(size(keys))
      integer :: i, given

      given = 0
      last = keys(2)
      do i = 1, size(keys)
         if (values%is_given('lubricant', trim(keys(i))) .neqv. values%has_value('lubricant', &
            trim(keys(i)))) return
         number(i) = values%real_value('lubricant', trim(keys(i)))
         if (i == 1 .or. number(i) <= 0.0_wp) cycle
         given = given + 1
         last = keys(i)
      end do
      if (number(1) <= 0.0_wp) return
      call complete_roelands(number(1), number(2), number(3), number(4), error)
      if (.not. allocated(error)) return
      if (given < 2) then
         call values%refuse('lubricant', trim(last), 'found ' // to_text(given) &
            // ' of pressure_viscosity, roelands_p0 and roelands_z, expected '// &
               "pressure_viscosity or two of them with viscosity_law = 'roelands'")
      else if (number(1) <= exp(-roelands_log_shift)) then
         call values%refuse('lubricant', 'viscosity', 'found ' // to_text(number(1)) &
            // ', expected more than ' // to_text(exp(-roelands_log_shift), 3) &
            // " [Pa s] with viscosity_law = 'roelands'")
      else
         call values%refuse('lubricant', 'pressure_viscosity', 'found '// to_text(number(2), 5) // &
            ' beside roelands_p0 and roelands_z, expected ' // to_text(roelands_alpha(number(1), &
            number(3), number(4)), 5) // ' [1/Pa] by (2.27), or only two of the three')
      end if
   end subroutine check_roelands

   !> With &moes the pressure scale is p_h = alpha_bar/alpha. Findings: an Eyring law; laws that
   !> contradict moes_l; alpha where nothing depends on it.
   subroutine check_moes_laws(values)
      type(input_values_t), intent(inout) :: values
      character(:), allocatable :: law
      logical :: is_compressible, has_l

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
      type(error_t), allocatable :: error

      oil%viscosity = values%real_value('lubricant', 'viscosity')
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
      materials%roughness = [values%real_value('bodies', 'roughness_1'), &
         values%real_value('bodies', 'roughness_2')]
      materials%effusivity = values%real_value('bodies', 'thermal_effusivity')
      materials%density = values%real_value('lubricant', 'density')
      materials%conductivity = values%real_value('lubricant', 'thermal_conductivity')
      materials%thermal_viscosity = values%real_value('lubricant', 'thermal_viscosity')
      if (.not. values%has_group('moes')) then
         if (oil%viscosity_law == viscosity_roelands) call complete_roelands(oil%viscosity, &
            oil%pressure_viscosity, oil%roelands_p0, oil%roelands_z, error)
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

      call read_real(trim(key_rows(find_key('lubricant', key))%moes_default), value, good)
   end function usual

end module lubricant_input

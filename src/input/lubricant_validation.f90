!> Checks of &lubricant beyond the rules of its keys: parameters and laws that contradict each
!> other.
module lubricant_validation
   use errors, only: error_t
   use input_values, only: input_values_t
   use kinds, only: wp
   use text, only: to_text
   use roelands_relation, only: complete_roelands, roelands_alpha, roelands_log_shift
   implicit none (type, external)
   private

   public :: check_lubricant

contains

   !> All checks of &lubricant.
   subroutine check_lubricant(values)
      type(input_values_t), intent(inout) :: values

      if (.not. values%has_group('lubricant')) return
      if (values%has_group('moes')) then
         call check_moes_laws(values)
      else if (values%word_value('lubricant', 'viscosity_law') == 'roelands') then
         call check_roelands(values)
      end if
   end subroutine check_lubricant

   !> Finds fewer than two of alpha (which gets the usual P0), P0, z, or three that contradict each
   !> other by (2.27).
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
         call values%refuse('lubricant', 'pressure_viscosity', 'found ' &
            // to_text(number(2), 5) // ' beside roelands_p0 and roelands_z, expected ' &
            // to_text(roelands_alpha(number(1), number(3), number(4)), 5) &
            // ' [1/Pa] by (2.27), or only two of the three')
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

end module lubricant_validation

!> Keys of a surface of shape 'synthetic': what is wanted of its heights.
module synthesis_keys
   use findings, only: findings_t
   use input_values, only: input_values_t, value_t
   use kinds, only: wp
   use synthetic_surface, only: synthesis_t
   use text, only: to_text
   implicit none (type, external)
   private

   public :: read_synthesis

contains

   !> What surface `group` wants; `longest` and `shortest` are its longest and shortest wave [m]
   !> where it does not give them, and the roll-off is at the longest then. Findings: wavelengths
   !> out of order.
   subroutine read_synthesis(values, group, longest, shortest, wanted, findings)
      type(input_values_t), intent(in) :: values
      character(*), intent(in) :: group
      real(wp), intent(in) :: longest, shortest
      type(synthesis_t), intent(out) :: wanted
      type(findings_t), intent(inout) :: findings
      type(value_t) :: seed

      seed = values%slot(group, 'seed')
      wanted%seed = seed%integer
      wanted%hurst = values%real_value(group, 'hurst')
      wanted%rms_height = values%real_value(group, 'rms_height')
      wanted%skewness = values%real_value(group, 'skewness')
      wanted%kurtosis = values%real_value(group, 'kurtosis')
      wanted%wavelength_long = given_or('wavelength_long', longest)
      wanted%wavelength_rolloff = given_or('wavelength_rolloff', wanted%wavelength_long)
      wanted%wavelength_short = given_or('wavelength_short', shortest)
      if (wanted%wavelength_short > wanted%wavelength_rolloff &
         .or. wanted%wavelength_rolloff > wanted%wavelength_long) then
         call findings%add(values%line_of(group, 'shape'), group, 'wavelength_rolloff', 'found '// &
            to_text(wanted%wavelength_rolloff)//' m, expected wavelength_short <= '// &
               'wavelength_rolloff <= wavelength_long')
      end if

   contains

      !> The value of a key, or `default` [m].
      function given_or(key, default) result(length)
         character(*), intent(in) :: key
         real(wp), intent(in) :: default
         real(wp) :: length

         length = default
         if (values%is_given(group, key)) length = values%real_value(group, key)
      end function given_or

   end subroutine read_synthesis

end module synthesis_keys

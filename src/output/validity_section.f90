!> /adequacy/validity of a result, and the sentence on a limit that is passed.
module validity_section
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use hdf5_dataset, only: new_label, write_attribute, write_dataset
   use hdf5_file, only: hdf5_file_t
   use kinds, only: wp
   use quantity_text, only: number_text, prefixed_text
   use validity, only: limit_t
   use validity_table, only: film_over_wave, hardness, inlet_heating, limit_count, limit_rows, &
      limiting_stress, mixed_lubrication, shakedown, shear_heating, side_flow, starvation, &
      stokes_number, surface_slope, turbulence, viscosity_data
   implicit none (type, external)
   private

   public :: limit_sentence, write_validity

   !> The largest temperature rise that is printed as it is [K].
   real(wp), parameter :: hottest = 999.0_wp
   !> Whence the film that is lost to heat.
   character(*), parameter :: film_loss_source = 'central film of the smooth contact with the '// &
      'viscosity at that temperature: Nijenbanning, Venner and Moes, Wear 176, 1994, 217'

contains

   !> One dataset for each limit that could be evaluated; the others are named with the reason.
   subroutine write_validity(file, limits)
      class(hdf5_file_t), intent(inout) :: file
      type(limit_t), intent(in) :: limits(limit_count)
      character(:), allocatable :: missing, path
      integer :: i

      call file%create_group('/adequacy/validity')
      call write_attribute(file, '/adequacy/validity', 'about', 'limits of the model; '// &
         'exceeded = 1: the contact lies beyond threshold, whatever its error bars say')
      missing = ''
      do i = 1, limit_count
         associate (row => limit_rows(i), limit => limits(i))
            if (.not. ieee_is_finite(limit%value)) then
               if (allocated(limit%missing)) missing = missing//trim(row%name)//': ' &
                  //limit%missing//'; '
               cycle
            end if
            path = '/adequacy/validity/'//trim(row%name)
            call write_dataset(file, path, limit%value, new_label(trim(row%meaning), &
               trim(row%units)))
            call write_attribute(file, path, 'threshold', limit%threshold)
            call write_attribute(file, path, 'beyond', trim(merge('below', 'above', row%is_least)))
            call write_attribute(file, path, 'source', trim(row%source))
            call write_attribute(file, path, 'exceeded', merge(1, 0, limit%is_passed))
            if (i /= shear_heating) cycle
            call write_attribute(file, path, 'viscosity_loss', limit%viscosity_loss)
            call write_attribute(file, path, 'film_loss', limit%film_loss)
            call write_attribute(file, path, 'film_loss_source', film_loss_source)
         end associate
      end do
      if (missing /= '') call write_attribute(file, '/adequacy/validity', 'not_evaluated', &
         missing(:len(missing) - 2))
   end subroutine write_validity

   !> What passing limit `i` means: one line of the closing table.
   pure function limit_sentence(i, limit) result(words)
      integer, intent(in) :: i
      type(limit_t), intent(in) :: limit
      character(:), allocatable :: bound, number, percent, pressure, words

      number = number_text(limit%value, 2)
      percent = number_text(100.0_wp*limit%value, 2)//' %'
      pressure = prefixed_text(limit%value, 'Pa')
      bound = prefixed_text(limit%threshold, 'Pa')
      select case (i)
      case (mixed_lubrication)
         words = 'the film is '//number//' times the composite roughness: mixed lubrication'
      case (viscosity_data)
         words = 'pressures to '//pressure//', viscosities are measured to '//bound
      case (limiting_stress)
         words = 'the shear stress is '//number//' of the pressure: oils give way near 0.1'
      case (hardness)
         words = 'pressures to '//pressure//' pass the hardness, '//bound
      case (shakedown)
         words = 'Hertzian pressure '//pressure//' passes the shakedown limit, '//bound
      case (shear_heating)
         ! of an isothermal oil that does not thin it may come out beyond all sense
         if (limit%value > hottest) number = '>'//number_text(hottest, 3)
         words = 'sliding heats by '//number//' K: '//number_text(100*limit%viscosity_loss, 2) &
            //' % less viscosity, up to '//number_text(100*limit%film_loss, 2)//' % less film'
      case (inlet_heating)
         words = 'heat of the inlet, not in the model, would thin the film by '//percent
      case (starvation)
         words = 'starves the film by '//percent//' (x_inlet further out cures it)'
      case (side_flow)
         words = 'flow to the sides takes '//percent//' of the film: the contact is short'
      case (stokes_number)
         words = 'stress rises by '//number//" with p (T_max): Reynolds' equation in doubt"
      case (surface_slope)
         words = 'surfaces are as steep as '//number//": too much for Reynolds' equation"
      case (film_over_wave)
         words = 'the film is '//number//" of the finest wave: thick for Reynolds' equation"
      case (turbulence)
         words = 'the Reynolds number of the film is '//number//': not laminar'
      case default
         error stop 'limit_sentence: a limit without its case'
      end select
   end function limit_sentence

end module validity_section

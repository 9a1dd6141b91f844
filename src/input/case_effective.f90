!> The list of all values that a case uses, given, default or derived, for the result file.
module case_effective
   use case_record, only: case_t, set_effective
   use features, only: rough_surface_t
   use height_form, only: curvature_of, tilt_of, trend_t
   use input_keys, only: key_rows
   use input_values, only: input_values_t, value_t
   use key_row, only: has_word, integer_kind, is_chosen, key_row_t, lubricated, real_kind, &
      reals_kind, text_kind
   use key_rules, only: is_used
   use kinds, only: wp
   use line_contact, only: rough_contact_t
   use lubricant, only: density_constant, viscosity_constant, viscosity_roelands
   use passage_times, only: passage_times_t
   use profile, only: profile_length
   use surface_keys, only: has_shape, read_synthesis, surfaces
   use synthetic_surface, only: synthesis_t
   use text, only: joined
   implicit none (type, external)
   private

   public :: list_dry, list_effective, list_passage, list_trend

contains

   !> Fills `case%effective` in the order of the key table; what the program chooses later says so.
   subroutine list_effective(values, case)
      type(input_values_t), intent(in) :: values
      type(case_t), intent(inout) :: case
      integer :: i

      do i = 1, size(key_rows)
         associate (row => key_rows(i), slot => values%slots(i))
            if (.not. slot%has_value) then
               if (row%default /= is_chosen .or. row%key == 'output') cycle
            end if
            if (.not. has_word(row%problems, trim(values%problem))) cycle
            if (.not. is_used(values, row)) cycle
            if (slot%has_value) then
               call list_value(case, row, slot)
            else
               call set_effective(case, row%group, row%key, text='chosen by the program')
            end if
         end associate
      end do
      if (values%problem == lubricated) call list_derived(case)
   end subroutine list_effective

   !> One value of the namelist.
   subroutine list_value(case, row, slot)
      type(case_t), intent(inout) :: case
      type(key_row_t), intent(in) :: row
      type(value_t), intent(in) :: slot

      select case (row%kind)
      case (real_kind, reals_kind)
         call set_effective(case, row%group, row%key, slot%reals)
      case (integer_kind)
         call set_effective(case, row%group, row%key, integer=slot%integer)
      case (text_kind)
         call set_effective(case, row%group, row%key, text=slot%text)
      case default   ! words and logicals
         call set_effective(case, row%group, row%key, text=joined(slot%words, ', '))
      end select
   end subroutine list_value

   !> What follows from the given values: reduced bodies, load, parameters of Roelands' law.
   subroutine list_derived(case)
      type(case_t), intent(inout) :: case

      if (case%scaling%is_dimensional) then
         call set_effective(case, 'bodies', 'reduced_radius', [case%bodies%reduced_radius])
         call set_effective(case, 'bodies', 'reduced_modulus', [case%bodies%reduced_modulus])
         call set_effective(case, 'load', 'load_per_length', [case%load_per_length])
      end if
      associate (oil => case%lubricant)
         if (oil%viscosity_law == viscosity_constant) call set_effective(case, 'lubricant', &
            'viscosity_law', text='constant')
         if (oil%density_law == density_constant) call set_effective(case, 'lubricant', &
            'density_law', text='constant')
         if (oil%pressure_viscosity > 0.0_wp) call set_effective(case, 'lubricant', &
            'pressure_viscosity', [oil%pressure_viscosity])
         if (oil%viscosity_law /= viscosity_roelands) return
         call set_effective(case, 'lubricant', 'roelands_p0', [oil%roelands_p0])
         call set_effective(case, 'lubricant', 'roelands_z', [oil%roelands_z])
      end associate
   end subroutine list_derived

   !> The times of a passage through a `contact`, line or point, and where its surfaces began.
   subroutine list_passage(case, contact, times)
      type(case_t), intent(inout) :: case
      class(rough_contact_t), intent(in) :: contact
      type(passage_times_t), intent(in) :: times

      if (case%time%is_transient) then
         call set_effective(case, 'time', 'end_time', [times%end_time])
         call set_effective(case, 'time', 'time_step', [case%time%time_step])
         call set_effective(case, 'time', 'statistics_from', [times%counts_from])
      end if
      call fill_positions(case, 'surface_1', case%surface_1, contact%surface_1)
      call fill_positions(case, 'surface_2', case%surface_2, contact%surface_2)
   end subroutine list_passage

   !> The centres of the features of a `surface`, or of a profile `given` without its place.
   subroutine fill_positions(case, group, given, surface)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(rough_surface_t), intent(in) :: given, surface

      if (size(surface%features) > 0) call set_effective(case, group, 'position', &
         surface%features%position)
      if (.not. (allocated(given%profile) .and. allocated(surface%profile))) return
      if (.not. given%profile%is_placed) call set_effective(case, group, 'position', &
         [surface%profile%start + 0.5_wp*profile_length(surface%profile)])
   end subroutine fill_positions

   !> What follows from the given values of a dry case, or was chosen.
   subroutine list_dry(case)
      type(case_t), intent(inout) :: case
      integer :: i

      associate (dry => case%dry)
         call set_effective(case, 'bodies', 'reduced_modulus', [dry%reduced_modulus])
         call set_effective(case, 'domain', 'periodic', text=trim(merge('.true. ', &
            '.false.', dry%is_periodic)))
         if (.not. dry%is_periodic) call set_effective(case, 'domain', 'kernel', text='element')
         if (dry%grid%ny == 1) then
            call set_effective(case, 'domain', 'length', [dry%lengths(1)])
            call set_effective(case, 'domain', 'intervals', integer=dry%grid%nx)
         else
            call set_effective(case, 'domain', 'length_x', [dry%lengths(1)])
            call set_effective(case, 'domain', 'length_y', [dry%lengths(2)])
            call set_effective(case, 'domain', 'intervals_x', integer=dry%grid%nx)
            call set_effective(case, 'domain', 'intervals_y', integer=dry%grid%ny)
         end if
      end associate
      do i = 1, size(surfaces)
         call list_trend(case, surfaces(i), case%dry%trends(i))
         call list_waves(case, surfaces(i))
      end do
   end subroutine list_dry

   !> What was taken off the heights of the file of a surface, if it has one.
   subroutine list_trend(case, group, trend)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(trend_t), intent(in) :: trend
      integer :: directions

      if (trend%word == '') return
      directions = merge(2, 1, trend%form%grid(2) > 1)
      call set_effective(case, group, 'detrend', text=trim(trend%word))
      if (trend%word == 'none') return
      call set_effective(case, group, 'heights_mean', trend%form%terms(:1))
      if (trend%word == 'mean') return
      associate (curvatures => curvature_of(trend), tilts => tilt_of(trend))
         call set_effective(case, group, 'heights_tilt', tilts(:directions))
         if (trend%word == 'line') return
         call set_effective(case, group, 'heights_curvature', curvatures(:directions))
      end associate
   end subroutine list_trend

   !> The wavelengths of a synthetic surface of a dry case.
   subroutine list_waves(case, group)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(synthesis_t) :: wanted

      associate (dry => case%dry)
         if (.not. has_shape(dry%values, group, 'synthetic')) return
         call read_synthesis(dry%values, group, maxval(dry%lengths), &
            2.0_wp*dry%lengths(1)/dry%first_nodes(1), wanted)
      end associate
      call set_effective(case, group, 'wavelength_long', [wanted%wavelength_long])
      call set_effective(case, group, 'wavelength_rolloff', [wanted%wavelength_rolloff])
      call set_effective(case, group, 'wavelength_short', [wanted%wavelength_short])
   end subroutine list_waves

end module case_effective

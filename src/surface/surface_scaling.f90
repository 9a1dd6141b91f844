!> Converts surfaces from SI to the dimensionless form of the lubricated contact.
module surface_scaling
   use duty, only: duty_rows_t, duty_t, of_load, of_radius, of_speeds, of_time
   use features, only: rough_surface_t
   use kinds, only: wp
   use scaling, only: scaling_t
   use time_table, only: new_time_table, time_table_t
   implicit none (type, external)
   private

   public :: scaled_duty, scaled_surface

contains

   !> Converts `surface`: amplitude [m] over b^2/R, wavelength [m] over b, speed u_i [m/s] to 2
   !> u_i/u_s per unit of T = t u_s/(2 b), (2.51); heights and spacing of a profile likewise.
   !> Positions, lengths of entry and ends are in half-widths already; `scaling` is dimensional.
   function scaled_surface(surface, scaling) result(scaled)
      type(rough_surface_t), intent(in) :: surface
      type(scaling_t), intent(in) :: scaling
      type(rough_surface_t) :: scaled

      scaled = surface
      if (.not. allocated(scaled%features)) allocate (scaled%features(0))
      scaled%features%amplitude = scaled%features%amplitude/scaling%film
      scaled%features%wavelength = scaled%features%wavelength/scaling%half_width
      scaled%features%wavelength_y = scaled%features%wavelength_y/scaling%half_width
      scaled%speed = 2.0_wp*surface%speed/scaling%speed_sum
      if (.not. allocated(surface%profile)) return
      associate (profile => scaled%profile)
         if (allocated(profile%heights)) profile%heights = profile%heights/scaling%film
         if (allocated(profile%rows)) profile%rows = profile%rows/scaling%film
         profile%row_spacing = profile%row_spacing/scaling%half_width
         profile%first_row = profile%first_row/scaling%half_width
         profile%unit = scaling%film
         profile%spacing = profile%spacing/scaling%half_width
         profile%finest_wave = profile%finest_wave/scaling%half_width
      end associate
   end function scaled_surface

   !> Converts a table in SI to the values relative to the scaling, over T.
   pure function scaled_duty(rows, scaling) result(duty)
      type(duty_rows_t), intent(in) :: rows
      type(scaling_t), intent(in) :: scaling
      type(duty_t) :: duty

      duty%load = over_time(of_load, scaling%load_per_length)
      duty%radius = over_time(of_radius, scaling%reduced_radius)
      duty%speeds = [over_time(of_speeds(1), scaling%speed_sum), over_time(of_speeds(2), &
         scaling%speed_sum)]

   contains

      !> A column in a `unit`; a load or radius that is not there is that of the reference state.
      pure type(time_table_t) function over_time(column, unit) result(table)
         integer, intent(in) :: column
         real(wp), intent(in) :: unit
         real(wp) :: values(size(rows%values, 1))

         values = rows%values(:, column)/unit
         if (any(column == [of_load, of_radius]) .and. .not. rows%has(column)) values = 1.0_wp
         table = new_time_table(rows%values(:, of_time)/scaling%time, values, rows%is_linear, &
            rows%is_periodic)
      end function over_time

   end function scaled_duty

end module surface_scaling

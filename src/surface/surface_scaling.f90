!> Converts surfaces from SI to the dimensionless form of the lubricated contact.
module surface_scaling
   use features, only: rough_surface_t
   use kinds, only: wp
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: scaled_surface

contains

   !> Converts `surface`: amplitude [m] over b^2/R, wavelength [m] over b, speed u_i [m/s] to 2
   !> u_i/u_s per unit of T = t u_s/(2 b), (2.51); heights and spacing of a profile likewise.
   !> Positions and the lengths of entry and ends are in half-widths already. `scaling` must be
   !> dimensional.
   function scaled_surface(surface, scaling) result(scaled)
      type(rough_surface_t), intent(in) :: surface
      type(scaling_t), intent(in) :: scaling
      type(rough_surface_t) :: scaled

      allocate (scaled%features(0))
      if (allocated(surface%features)) scaled%features = surface%features
      scaled%features%amplitude = scaled%features%amplitude/scaling%film
      scaled%features%wavelength = scaled%features%wavelength/scaling%half_width
      scaled%speed = 2.0_wp*surface%speed/scaling%speed_sum
      scaled%entry_length = surface%entry_length
      scaled%entry_position = surface%entry_position
      if (.not. allocated(surface%profile)) return
      scaled%profile = surface%profile
      if (allocated(surface%profile%heights)) scaled%profile%heights = surface%profile%heights &
         /scaling%film
      scaled%profile%unit = scaling%film
      scaled%profile%spacing = surface%profile%spacing/scaling%half_width
      scaled%profile%finest_wave = surface%profile%finest_wave/scaling%half_width
   end function scaled_surface

end module surface_scaling

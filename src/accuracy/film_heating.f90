!> Estimate of the temperature rise of a film by sliding, from its shear stress; it does not change
!> the solution.
module film_heating
   use bodies, only: bodies_t
   use kinds, only: wp
   use model_limits, only: film_temperatures, flash_temperatures
   use scaling, only: scaling_t
   implicit none (type, external)
   private

   public :: heating_t, largest_rise, new_heating

   !> Data of the estimate.
   type :: heating_t
      !> Whether there are SI scales.
      logical :: is_known = .false.
      !> Units of X [m], H [m] and of the shear stress [Pa].
      real(wp) :: half_width = 0.0_wp, film = 0.0_wp, shear_stress = 0.0_wp
      !> Of the surfaces [m/s].
      real(wp) :: speeds(2) = 0.0_wp
      !> sqrt(k rho c) of both bodies [W s^0.5/(m^2 K)], conductivity of the oil [W/(m K)].
      real(wp) :: effusivity = 0.0_wp, conductivity = 0.0_wp
   end type heating_t

contains

   !> Data of a contact with these scales, bodies and thermal constants.
   pure function new_heating(scaling, bodies, effusivity, conductivity) result(heating)
      type(scaling_t), intent(in) :: scaling
      type(bodies_t), intent(in) :: bodies
      real(wp), intent(in) :: effusivity, conductivity
      type(heating_t) :: heating

      if (.not. scaling%is_dimensional) return
      heating = heating_t(.true., scaling%half_width, scaling%film, &
         scaling%hertz_pressure*scaling%film/scaling%half_width, [bodies%speed_1, &
         bodies%speed_2], effusivity, conductivity)
   end function new_heating

   !> Largest temperature rise [K] at mid-film, of the surfaces and of the film above them, by the
   !> mean shear `stress` [p_h b/R] in the `film` [b^2/R], at rising nodes `x` [b], each (nx).
   pure real(wp) function largest_rise(heating, x, stress, film) result(rise)
      type(heating_t), intent(in) :: heating
      real(wp), intent(in), contiguous :: x(:), stress(:), film(:)
      real(wp) :: heat(size(stress))

      rise = 0.0_wp
      associate (speeds => heating%speeds)
         if (.not. abs(speeds(2) - speeds(1)) > 0.0_wp) return
         heat = abs(stress)*(heating%shear_stress*abs(speeds(2) - speeds(1)))
         rise = maxval(flash_temperatures(heat, x*heating%half_width, heating%effusivity, speeds) &
            + film_temperatures(heat, film*heating%film, heating%conductivity))
      end associate
   end function largest_rise

end module film_heating

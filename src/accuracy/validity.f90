!> The limits of the model of the lubricated contact, in one table: what is compared with which
!> threshold, and who says so (`estimate` in a source marks a threshold that is ours; docs/theory.md
!> says where it comes from); and whether a solution lies within them.
!>
!> Limits concern the model; the numerical errors are estimated elsewhere. Transients use extremes
!> over the times that count where available (films, pressure, stress, temperature, T_max and
!> slope), else the last time.
module validity
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use contact_moment, only: film_with_viscosity, flooded_film
   use features, only: feature_sinusoid, rough_surface_t
   use film_heating, only: inlet_heating_loss, largest_rise
   use hertz, only: bodies_t, track_shear
   use kinds, only: larger, not_known, wp
   use line_contact, only: finest_wave, line_contact_t
   use line_state, only: line_state_t, stressed_share
   use line_summary, only: line_summary_t
   use lubricant, only: lubricant_t, viscosity_barus, viscosity_constant
   use quantities, only: h_central, h_min, p_max
   use scaling, only: new_heating, scaling_t
   use text, only: number_text, prefixed_text
   implicit none (type, external)
   private

   public :: limits_of

   !> Rows of the table.
   integer, parameter, public :: starvation = 1, mixed_lubrication = 2, viscosity_data = 3, &
      limiting_stress = 4, hardness = 5, shakedown = 6, shear_heating = 7, inlet_heating = 8, &
      side_flow = 9, stokes_number = 10, surface_slope = 11, film_over_wave = 12, turbulence = 13

   !> Film over composite rms height below which asperities carry load.
   real(wp), parameter, public :: least_lambda_ratio = 1.0_wp

   !> One limit.
   type, public :: limit_row_t
      !> Name in /adequacy/validity.
      character(len=17) :: name
      !> Unit of value and threshold.
      character(len=2) :: units
      !> The model is left beyond it: below where `is_least`, else above.
      real(wp) :: threshold
      logical :: is_least
      !> What passing it means, with its value for #, in percent where % follows, its threshold for
      !> @; what the value is.
      character(len=66) :: words
      character(len=110) :: meaning
      !> Where the threshold comes from.
      character(len=130) :: source
   end type limit_row_t

   type(limit_row_t), parameter, public :: limit_rows(*) = [ &
      limit_row_t('starvation', '1', 5.0e-3_wp, .false., &
         'starves the film by # % (the default &domain does not)', &
         'share by which the given inlet starves the film', &
         'rule of the inlet, 71 contacts against twice the domain; points and above 5 % '// &
            'measured; threshold: estimate'), &
      limit_row_t('mixed_lubrication', '1', 3.0_wp, .true., &
         'the film is # times the composite roughness: mixed lubrication', &
         'smallest film over composite rms height of both surfaces', &
         'full film above 3: Hamrock, Schmid and Jacobson, Fundamentals of Fluid Film '// &
            'Lubrication, 2004'), &
      limit_row_t('viscosity_data', 'Pa', 1.03e9_wp, .false., &
         'pressures to #, viscosities are measured to @', &
         'largest pressure; threshold: the pressures to which viscosities are measured', &
         'Roelands: data of the ASME Pressure-Viscosity Report, 1953; Barus, 0.3e9: estimate'), &
      limit_row_t('limiting_stress', '1', 0.1_wp, .false., &
         'the shear stress is # of the pressure: oils give way near 0.1', &
         'largest mean shear stress over pressure, where p is above a tenth of its largest', &
         'stress at which oils give way: Bair and Winer, J. Lubr. Technol. 101, 1979, 251; '// &
            '0.1: estimate'), &
      limit_row_t('hardness', 'Pa', 0.0_wp, .false., &
         'pressures to # pass the hardness, @', &
         'largest pressure; threshold: the given hardness', 'definition of the hardness'), &
      limit_row_t('shakedown', 'Pa', 0.0_wp, .false., &
         'Hertzian pressure # passes the shakedown limit, @', &
         'Hertzian pressure; threshold: 4 k, a circle 4.7 k, with k = hardness/6 the yield '// &
            'stress in shear', 'Johnson, Contact Mechanics, 1985, sections 9.2 (no '// &
            'friction) and 6.3 (hardness 3 Y = 6 k); ellipses: upper bound'), &
      limit_row_t('shear_heating', 'K', 0.0_wp, .false., 'sliding heats by # K:', &
         'temperature rise of the film by sliding; threshold: a tenth of the viscosity', &
         'Jaeger 1942, Archard, Wear 2, 1959, 438, and conduction across the film; threshold: '// &
            'estimate'), &
      limit_row_t('inlet_heating', '1', 0.05_wp, .false., &
         'heat of the inlet, not in the model, would thin the film by # %', &
         'share by which heat of the flow in the inlet thins the film', &
         'formula: Gupta et al., Tribol. Trans. 35, 1992, 269; threshold: estimate'), &
      limit_row_t('side_flow', '1', 0.01_wp, .false., &
         'flow to the sides takes # % of the film: the contact is short', &
         'share of the smallest film that is lost to the sides', &
         'formula: Hamrock and Dowson, J. Lubr. Technol. 99, 1977, 264; threshold: estimate'), &
      limit_row_t('stokes_number', '1', 0.25_wp, .false., &
         "stress rises by # with p (T_max): Reynolds' equation in doubt", &
         'T_max, largest d tau/dp at a given shear rate, tau of the sliding', &
         'Bair, Khonsari and Winer, Tribol. Int. 31, 1998, 573 (below 1); 0.25, 1 % of the '// &
            'film: estimate'), &
      limit_row_t('surface_slope', '1', 0.2_wp, .false., &
         "surfaces are as steep as #: too much for Reynolds' equation", &
         'largest slope dh/dx of the film where p is above a hundredth of its largest', &
         'Stokes flow in a rigid wavy channel, 1 % of the flow; threshold: estimate'), &
      limit_row_t('film_over_wave', '1', 0.1_wp, .false., &
         "the film is # of the finest wave: thick for Reynolds' equation", &
         'central film over the finest wave of the surfaces', &
         'Stokes flow past a rigid wave, (2 pi h/Lambda)^2/30 of its pressure; threshold: '// &
            'estimate'), &
      limit_row_t('turbulence', '1', 1000.0_wp, .false., &
         'the Reynolds number of the film is #: not laminar', &
         'Reynolds number of the flow, ambient density and viscosity, central film', &
         'Harnoy, Bearing Design in Machinery, 2003, section 5.5 (1000 to 1600)')]

   integer, parameter, public :: limit_count = size(limit_rows)

   !> Data of bodies and oil that only the limits need; 0: not given.
   type, public :: materials_t
      !> H [Pa], `length` of the contact across the flow [m].
      real(wp) :: hardness = 0.0_wp, length = 0.0_wp
      !> Rms heights of surfaces 1 and 2 that are smooth in the film [m]; 0: not given.
      real(wp) :: roughness(2) = 0.0_wp
      !> sqrt(k rho c) of both bodies [W s^0.5/(m^2 K)].
      real(wp) :: effusivity = 0.0_wp
      !> Of the oil: ambient density [kg/m^3], conductivity [W/(m K)], -d ln mu/dT [1/K].
      real(wp) :: density = 0.0_wp, conductivity = 0.0_wp, thermal_viscosity = 0.0_wp
   end type materials_t

   !> A limit for one solution.
   type, public :: limit_t
      !> NaN: not known, and `missing` says why (else not allocated).
      real(wp) :: value
      real(wp) :: threshold
      logical :: is_passed = .false.
      !> For the heat of sliding: share of viscosity and share of film lost if the oil were so warm
      !> where the film builds up; 0 for other limits.
      real(wp) :: viscosity_loss = 0.0_wp, film_loss = 0.0_wp
      character(:), allocatable :: missing
   end type limit_t

   !> Data of all rows.
   type, public :: circumstances_t
      type(scaling_t) :: scaling
      type(bodies_t) :: bodies
      type(lubricant_t) :: lubricant
      type(materials_t) :: materials
      type(line_contact_t) :: contact
      !> Extremes over the times that count.
      type(line_summary_t) :: summary
      !> Share of the film lost by starvation; of a point contact that by which a longer domain
      !> changes it, NaN: not known.
      real(wp) :: film_loss = 0.0_wp
      !> From the x axis of an ellipse to the entrainment [rad].
      real(wp) :: angle = 0.0_wp
      !> Whether the full momentum equations of the film are solved too.
      logical :: has_momentum = .false.
   end type circumstances_t

   !> Largest pressure at which Barus' law is realistic [Pa], see module lubricant.
   real(wp), parameter :: barus_data = 0.3e9_wp
   !> Yield stress in shear of a perfectly plastic body over its hardness.
   real(wp), parameter :: shear_strength = 1.0_wp/6.0_wp
   !> Decay of the loss to the sides with length over width: of elliptical contacts with the ratio
   !> of their axes.
   real(wp), parameter :: end_decay = 0.68_wp
   !> Tolerable loss of viscosity by heat.
   real(wp), parameter :: tolerable_thinning = 0.1_wp
   !> Beyond this exponent the viscosity counts as lost.
   real(wp), parameter :: largest_exponent = 20.0_wp

contains

   !> The limits in the order of the table, for the solution `state` with its mean shear stress.
   pure function limits_of(of, state) result(limits)
      type(circumstances_t), intent(in) :: of
      type(line_state_t), intent(in) :: state
      type(limit_t) :: limits(limit_count)
      integer :: i

      do i = 1, limit_count
         associate (limit => limits(i))
            limit = limit_t(not_known(), limit_rows(i)%threshold)
            if (of%has_momentum .and. any(i == [stokes_number, surface_slope, film_over_wave])) then
               limit%missing = 'the full momentum equations are solved'
            else if (of%scaling%is_dimensional .or. any(i == [starvation, viscosity_data])) then
               call evaluate(i, of, state, limit)
            else
               limit%missing = 'no SI units'
            end if
            if (.not. ieee_is_finite(limit%value)) cycle
            limit%is_passed = merge(limit%value < limit%threshold, limit%value &
               > limit%threshold, limit_rows(i)%is_least)
         end associate
      end do
   end function limits_of

   !> Evaluates row `i`, or states why it is missing, and its threshold if that depends on the case.
   pure subroutine evaluate(i, of, state, limit)
      integer, intent(in) :: i
      type(circumstances_t), intent(in) :: of
      type(line_state_t), intent(in) :: state
      type(limit_t), intent(inout) :: limit
      real(wp) :: length, mean_speed

      mean_speed = 0.5_wp*of%scaling%speed_sum
      associate (scaling => of%scaling, summary => of%summary, oil => of%lubricant, &
         given => of%materials)
         select case (i)
         case (starvation)
            limit%value = of%film_loss
            if (.not. ieee_is_finite(of%film_loss)) limit%missing = 'no longer domain was compared'
         case (mixed_lubrication)
            length = hypot(composite_rms(of%contact), norm2(given%roughness)/scaling%film)
            if (allocated(of%contact%asperities)) then   ! the model has it
               length = of%contact%asperities%roughness
               limit%threshold = 0.0_wp
            end if
            if (length > 0.0_wp) limit%value = summary%of(h_min)%value/length
            if (.not. length > 0.0_wp) limit%missing = &
               'no roughness: neither sinusoid nor profile, nor &bodies roughness_1, roughness_2'
         case (viscosity_data, hardness, shakedown)
            call compare_pressure(i, of, limit)
         case (limiting_stress)
            limit%value = scaling%slope*larger(summary%limits%stress_share, &
               maxval(abs(state%shear_stress_mean)/state%pressure, &
               state%pressure > stressed_share*maxval(state%pressure)))
         case (shear_heating)
            if (allocated(of%contact%heating)) then
               limit%missing = 'the model has it: temperature_rise_film'
            else if (given%thermal_viscosity > 0.0_wp) then
               limit%value = summary%limits%film_heating
               if (.not. allocated(of%contact%duty)) limit%value = larger(limit%value, &
                  largest_rise(new_heating(scaling, of%bodies, given%effusivity, &
                  given%conductivity), state%x, state%shear_stress_mean, state%film_thickness))
               limit%threshold = -log(1.0_wp - tolerable_thinning)/given%thermal_viscosity
               call set_losses(of, limit)
            else
               limit%missing = 'thermal_viscosity = 0'
            end if
         case (inlet_heating)
            limit%value = inlet_heating_loss(given%thermal_viscosity*oil%viscosity &
               *mean_speed**2/given%conductivity, abs(of%bodies%speed_2 - of%bodies%speed_1) &
               /mean_speed, scaling%hertz_pressure/scaling%reduced_modulus)
            if (allocated(of%contact%heating)) then
               if (of%contact%heating%has_flow) then
                  limit%missing = 'the model has it, the formula leaves '// &
                     number_text(1 - limit%value, 3)//' of the film'
                  limit%value = not_known()
               end if
            end if
         case (side_flow)
            ! where pressure builds up: the Hertzian contact, or the wedge of rigid bodies
            length = 2.0_wp*max(scaling%half_width, sqrt(2.0_wp*scaling%reduced_radius &
               *scaling%film*summary%of(h_central)%value))
            if (allocated(scaling%ellipse)) then
               limit%missing = 'the flow to the sides is solved'
            else if (given%length > 0.0_wp) then
               limit%value = exp(-end_decay*given%length/length)
            else
               limit%missing = '&bodies contact_length is not given, a contact shorter than '// &
                  prefixed_text(-log(limit%threshold)*length/end_decay, 'm')//' would lose '// &
                  number_text(100.0_wp*limit%threshold, 2)//' % of its film to the sides'
            end if
         case (stokes_number)
            limit%value = summary%limits%stokes_number*scaling%slope
         case (surface_slope)
            limit%value = summary%limits%surface_slope*scaling%slope
         case (film_over_wave)
            if (finest_wave(of%contact) < huge(1.0_wp)) then
               limit%value = summary%of(h_central)%value/finest_wave(of%contact)*scaling%film &
                  /scaling%half_width
            else
               limit%missing = 'no waves on the surfaces'
            end if
         case (turbulence)
            ! by conservation of mass about the same all along the inlet
            limit%value = given%density*abs(mean_speed)*(summary%of(h_central)%value*scaling%film) &
               /oil%viscosity
         case default
            error stop 'evaluate: a limit without its case'
         end select
      end associate
   end subroutine evaluate

   !> Sets the losses of viscosity, which falls as exp(-beta times the temperature rise), and, of a
   !> line contact, of film at the temperature rise of a limit.
   pure subroutine set_losses(of, limit)
      type(circumstances_t), intent(in) :: of
      type(limit_t), intent(inout) :: limit
      real(wp) :: rest

      if (.not. ieee_is_finite(limit%value)) return
      rest = exp(-min(of%materials%thermal_viscosity*limit%value, largest_exponent))
      limit%viscosity_loss = 1 - rest
      if (.not. allocated(of%scaling%ellipse)) limit%film_loss = max(1 - film_with_viscosity( &
         of%contact, rest)/flooded_film(of%contact), 0.0_wp)
   end subroutine set_losses

   !> Compares pressures with the data of the oil, or with the strength of the bodies: beyond the
   !> stress k on planes along the surface, of both signs in each pass (a fourth of p_h under
   !> lines), no residual stress prevents plastic flow.
   pure subroutine compare_pressure(i, of, limit)
      integer, intent(in) :: i
      type(circumstances_t), intent(in) :: of
      type(limit_t), intent(inout) :: limit
      real(wp) :: shear

      if (i == viscosity_data) then
         if (of%lubricant%viscosity_law == viscosity_barus) limit%threshold = barus_data
         if (of%lubricant%viscosity_law == viscosity_constant) then
            limit%missing = 'constant viscosity'
         else if (.not. of%scaling%hertz_pressure > 0.0_wp) then
            limit%missing = 'no SI units'
         else
            limit%value = of%summary%of(p_max)%value*of%scaling%hertz_pressure
         end if
      else if (.not. of%materials%hardness > 0.0_wp) then
         limit%missing = '&bodies hardness is not given'
         limit%threshold = not_known()
      else if (i == hardness) then
         limit%value = of%summary%of(p_max)%value*of%scaling%hertz_pressure
         limit%threshold = of%materials%hardness
      else
         limit%value = of%scaling%hertz_pressure
         shear = 0.25_wp
         if (allocated(of%scaling%ellipse)) shear = track_shear(of%scaling%ellipse, of%angle)
         limit%threshold = shear_strength*of%materials%hardness/shear
         if (shear < shear_strength) then
            limit%value = not_known()
            limit%missing = 'no bound below the hardness is known of an ellipse along its track'
         end if
      end if
   end subroutine compare_pressure

   !> Composite rms height [b^2/R] of roughness over the full length of both surfaces: sinusoids and
   !> profiles (the part that is loaded), or areas; 0: none.
   pure real(wp) function composite_rms(contact) result(rms)
      type(line_contact_t), intent(in) :: contact

      rms = sqrt(mean_square(contact%surface_1) + mean_square(contact%surface_2))

   contains

      !> Of one surface.
      pure real(wp) function mean_square(surface)
         type(rough_surface_t), intent(in) :: surface
         real(wp), allocatable :: z(:)

         mean_square = 0.0_wp
         if (allocated(surface%features)) mean_square = 0.5_wp*sum(surface%features%amplitude**2 &
            *merge(0.5_wp, 1.0_wp, surface%features%wavelength_y > 0.0_wp), &
            surface%features%kind == feature_sinusoid)
         if (.not. allocated(surface%profile)) return
         if (allocated(surface%profile%heights)) z = surface%profile%heights
         if (allocated(surface%profile%rows)) z = [surface%profile%rows]
         if (allocated(z)) mean_square = mean_square + sum((z - sum(z)/size(z))**2)/size(z)
      end function mean_square

   end function composite_rms

end module validity

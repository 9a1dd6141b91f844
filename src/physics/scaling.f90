!> Reference values of the lubricated contact: the only place that converts between SI and
!> dimensionless values.
module scaling
   use eyring, only: eyring_t, ln_b_of_no_sliding
   use film_heating, only: heating_t
   use hertz, only: bodies_t, ellipse_t, line_half_width, line_peak_pressure, new_ellipse
   use kinds, only: not_known, pi, wp
   use lubricant, only: density_constant, density_dowson_higginson, dowson_higginson_c1, fluid_t, &
      lubricant_t, viscosity_constant, viscosity_roelands
   use moes, only: alpha_bar_from_moes, lambda_from_moes_sum, m_mean_per_sum, &
      moes_l_from_alpha_bar, moes_m_sum_from_lambda, point_alpha_bar, point_film_unit, point_lambda
   implicit none (type, external)
   private

   public :: new_heating, new_moes_scaling, new_scaling, scaled_fluid

   !> u1 + u2 over the mean speed: M falls with its power 3/4, L rises with its power 1/4.
   real(wp), parameter, public :: sum_per_mean = 2.0_wp
   !> Rheologies, mu at any shear and Eyring (module eyring), and their names in the input.
   integer, parameter, public :: rheology_newtonian = 0, rheology_eyring = 1
   character(len=16), parameter, public :: rheologies(0:1) = [character(len=16) :: 'newtonian', &
      'eyring']

   !> Scales of (2.51, 2.52).
   type :: scales_t
      !> b [m], unit of x.
      real(wp) :: half_width = 0.0_wp
      !> p_h [Pa], unit of pressure.
      real(wp) :: hertz_pressure = 0.0_wp
      !> R [m] and E' [Pa] as in `bodies_t`.
      real(wp) :: reduced_radius = 0.0_wp, reduced_modulus = 0.0_wp
      !> w [N/m].
      real(wp) :: load_per_length = 0.0_wp
      !> b^2/R [m], unit of film thickness and of surface heights.
      real(wp) :: film = 0.0_wp
      !> 2 b/u_s [s], unit of time.
      real(wp) :: time = 0.0_wp
      !> mu_0 [Pa s], unit of viscosity.
      real(wp) :: viscosity = 0.0_wp
      !> u_s = u1 + u2 [m/s].
      real(wp) :: speed_sum = 0.0_wp
      !> b/R [-], unit of friction coefficients and of slopes of the film.
      real(wp) :: slope = 0.0_wp
      !> p_h b/R [Pa], unit of shear stress.
      real(wp) :: shear_stress = 0.0_wp
      !> p_h b^2/R u_s [W/m], unit of power per length; of a point contact p_h a^3/Rx u_s [W].
      real(wp) :: power = 0.0_wp
   end type scales_t

   !> Scales and dimensionless groups of (2.53 - 2.56). Where `is_dimensional` is false (input by
   !> Moes' numbers) only the groups mean anything, and hertz_pressure if alpha is known.
   type, public, extends(scales_t) :: scaling_t
      !> Speed parameter [-] of (2.57).
      real(wp) :: lambda = 0.0_wp
      !> alpha p_h [-], (2.56); 0 for constant viscosity.
      real(wp) :: alpha_bar = 0.0_wp
      !> Moes' M and L [-] of (2.53, 2.54), mean speed.
      real(wp) :: moes_m = 0.0_wp, moes_l = 0.0_wp
      !> Slide-to-roll ratio 2 (u2 - u1)/(u1 + u2) [-], positive if surface 2 is faster, as in
      !> chapter 6; NaN: speeds not known.
      real(wp) :: slide_to_roll = 0.0_wp
      !> Unit of the film in units of Moes, mean speed.
      real(wp) :: film_moes = 0.0_wp
      !> Whether the SI scales are known.
      logical :: is_dimensional = .false.
      !> Shape of a point contact, whose a, Rx and load [N] stand in the scales for b, R and w; not
      !> allocated: of a line contact.
      type(ellipse_t), allocatable :: ellipse
   end type scaling_t

contains

   !> Sets the scaling of a line contact given in SI, or of a point contact with D = Rx/Ry =
   !> `radius_ratio`, whose Rx the `bodies` have.
   !>
   !> lambda = 6 u_s R^2 mu_0/(p_h b^3), the left form of (2.55); the right one lacks a factor 1/8
   !> in print (3 pi^2 mu_0 u_s R E'/(8 w^2)). Of a point contact a = Rx (3 W/(pi^2 C kappa))^(1/3),
   !> W = w/(E' Rx^2), p_h = (pi/2) C E' a/Rx. `load` w > 0 [N/m], [N] of a point contact; ranges of
   !> `bodies` and `lubricant` as in their types.
   pure subroutine new_scaling(scaling, bodies, lubricant, load, radius_ratio)
      type(scaling_t), intent(out) :: scaling
      type(bodies_t), intent(in) :: bodies
      type(lubricant_t), intent(in) :: lubricant
      real(wp), intent(in) :: load
      real(wp), intent(in), optional :: radius_ratio
      real(wp) :: speed

      scaling%is_dimensional = .true.
      scaling%reduced_radius = bodies%reduced_radius
      scaling%reduced_modulus = bodies%reduced_modulus
      scaling%load_per_length = load
      scaling%speed_sum = bodies%speed_1 + bodies%speed_2
      scaling%slide_to_roll = 2.0_wp*(bodies%speed_2 - bodies%speed_1)/scaling%speed_sum
      scaling%viscosity = lubricant%viscosity
      if (present(radius_ratio)) then
         scaling%ellipse = new_ellipse(radius_ratio)
         scaling%half_width = (3*load*bodies%reduced_radius/(pi**2*scaling%ellipse%compliance &
            *scaling%ellipse%ratio*bodies%reduced_modulus))**(1.0_wp/3.0_wp)
         scaling%slope = scaling%half_width/bodies%reduced_radius
         scaling%hertz_pressure = 0.5_wp*pi*scaling%ellipse%compliance*bodies%reduced_modulus &
            *scaling%slope
         scaling%film = scaling%half_width*scaling%slope
         scaling%lambda = 6.0_wp*scaling%speed_sum*lubricant%viscosity &
            /(scaling%hertz_pressure*scaling%half_width*scaling%slope**2)
      else
         scaling%half_width = line_half_width(load, bodies%reduced_radius, bodies%reduced_modulus)
         scaling%slope = scaling%half_width/bodies%reduced_radius
         scaling%hertz_pressure = line_peak_pressure(load, bodies%reduced_radius, &
            bodies%reduced_modulus)
         scaling%film = scaling%half_width**2/bodies%reduced_radius
         scaling%lambda = 6.0_wp*scaling%speed_sum*bodies%reduced_radius**2*lubricant%viscosity &
            /(scaling%hertz_pressure*scaling%half_width**3)
      end if
      scaling%time = 2.0_wp*scaling%half_width/scaling%speed_sum
      scaling%shear_stress = scaling%hertz_pressure*scaling%slope
      scaling%power = scaling%shear_stress*scaling%half_width**merge(2, 1, present(radius_ratio)) &
         *scaling%speed_sum
      if (lubricant%viscosity_law /= viscosity_constant) scaling%alpha_bar = &
         lubricant%pressure_viscosity*scaling%hertz_pressure
      if (present(radius_ratio)) then   ! U of the mean speed
         speed = 0.5_wp*lubricant%viscosity*scaling%speed_sum/(bodies%reduced_modulus &
            *bodies%reduced_radius)
         scaling%moes_m = load/(bodies%reduced_modulus*bodies%reduced_radius**2)*speed**(-0.75_wp)
         scaling%moes_l = scaling%alpha_bar/scaling%hertz_pressure*bodies%reduced_modulus &
            *speed**0.25_wp
         scaling%film_moes = scaling%slope**2/sqrt(speed)
      else
         scaling%moes_m = moes_m_sum_from_lambda(scaling%lambda)*m_mean_per_sum
         scaling%moes_l = moes_l_from_alpha_bar(scaling%alpha_bar, scaling%moes_m)
         scaling%film_moes = 8.0_wp*scaling%moes_m/pi
      end if
   end subroutine new_scaling

   !> Sets the scaling of a smooth Newtonian line contact given by Moes' numbers of (2.53, 2.54),
   !> mean speed, or of a point contact with D = `radius_ratio`; the only known SI scale is p_h =
   !> alpha_bar/alpha, for laws that need it.
   !>
   !> `moes_m_mean` > 0; `moes_l_mean` >= 0, 0 = constant viscosity. Only the laws, alpha, P0 and z
   !> of `lubricant` are used.
   pure subroutine new_moes_scaling(scaling, moes_m_mean, moes_l_mean, lubricant, radius_ratio)
      type(scaling_t), intent(out) :: scaling
      real(wp), intent(in) :: moes_m_mean, moes_l_mean
      type(lubricant_t), intent(in) :: lubricant
      real(wp), intent(in), optional :: radius_ratio
      real(wp) :: m

      scaling%moes_m = moes_m_mean
      scaling%moes_l = moes_l_mean
      scaling%slide_to_roll = not_known()
      if (present(radius_ratio)) then
         m = moes_m_mean*sum_per_mean**(-0.75_wp)
         scaling%ellipse = new_ellipse(radius_ratio)
         scaling%lambda = point_lambda(scaling%ellipse, m)
         scaling%alpha_bar = point_alpha_bar(scaling%ellipse, m, moes_l_mean*sum_per_mean**0.25_wp)
         scaling%film_moes = point_film_unit(scaling%ellipse, m)*sqrt(sum_per_mean)
      else
         scaling%lambda = lambda_from_moes_sum(moes_m_mean/m_mean_per_sum)
         scaling%alpha_bar = alpha_bar_from_moes(moes_m_mean, moes_l_mean)
         scaling%film_moes = 8.0_wp*scaling%moes_m/pi
      end if
      if (lubricant%pressure_viscosity > 0.0_wp) scaling%hertz_pressure = scaling%alpha_bar &
         /lubricant%pressure_viscosity
   end subroutine new_moes_scaling

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

   !> The lubricant in dimensionless form.
   !>
   !> An unknown or vanishing Hertz pressure (Moes input with L = 0) makes viscosity and density
   !> constant: the limit of their laws. Eyring needs a scaling from SI; otherwise the fluid is
   !> Newtonian. Parameters that a law does not use are 1, to avoid NaN.
   pure function scaled_fluid(scaling, lubricant, bodies) result(fluid)
      type(scaling_t), intent(in) :: scaling
      type(lubricant_t), intent(in) :: lubricant
      type(bodies_t), intent(in) :: bodies
      type(fluid_t) :: fluid
      real(wp) :: sliding

      fluid%viscosity_law = lubricant%viscosity_law
      if (scaling%alpha_bar <= 0.0_wp) fluid%viscosity_law = viscosity_constant
      fluid%density_law = lubricant%density_law
      if (scaling%hertz_pressure <= 0.0_wp) fluid%density_law = density_constant
      fluid%alpha_bar = scaling%alpha_bar
      fluid%p0 = 1.0_wp
      fluid%z = 1.0_wp
      if (fluid%viscosity_law == viscosity_roelands) then
         fluid%p0 = lubricant%roelands_p0/scaling%hertz_pressure
         fluid%z = lubricant%roelands_z
      end if
      fluid%c1 = 1.0_wp
      if (fluid%density_law == density_dowson_higginson) fluid%c1 = dowson_higginson_c1 &
         /scaling%hertz_pressure
      if (.not. scaling%is_dimensional) return
      fluid%stress_limit = lubricant%limit_ratio/scaling%slope
      fluid%is_cut = lubricant%is_cut
      if (lubricant%rheology == rheology_newtonian) return
      select case (lubricant%rheology)
      case (rheology_eyring)
         allocate (eyring_t :: fluid%rheology)
      case default
         error stop 'scaled_fluid: a law without its case'
      end select
      fluid%rheology%sigma_scale = scaling%half_width*scaling%hertz_pressure &
         /(2.0_wp*scaling%reduced_radius*lubricant%stress_scale)
      fluid%rheology%ln_b_scale = ln_b_of_no_sliding
      sliding = scaling%viscosity*abs(bodies%speed_2 - bodies%speed_1)/(lubricant%stress_scale &
         *scaling%film)
      if (sliding > 0.0_wp) fluid%rheology%ln_b_scale = log(sliding)
   end function scaled_fluid

end module scaling

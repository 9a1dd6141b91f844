!> Fields of a lubricated line contact at one time, as the solver returns them; integrals of the
!> shear stresses, computed by module film_shear; and the distance of a film from the limits of its
!> model, in the unit b/R: the two of Reynolds' equation, the stress over the pressure, at which
!> oils yield, and the temperature rise by sliding.
!>
!> T_max is the largest d tau/dp of sliding at a given shear rate, which the derivation sets to 0
!> (S. Bair, M. Khonsari and W. O. Winer, Tribol. Int. 31, 1998, 573); the slope dh/dx is assumed
!> small. Modules film_shear and film_heating compute them, thresholds are in module validity.
module line_state
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use duty, only: moment_t
   use kinds, only: larger, not_known, wp
   implicit none (type, external)
   private

   public :: all_finite, line_state_t, reynolds_limits_t, turned, unknown_limits, widen_limits

   !> Limits of one film, or the largest over several.
   type :: reynolds_limits_t
      !> T_max R/b; NaN: speeds not known.
      real(wp) :: stokes_number = 0.0_wp
      !> Largest |dH/dX| between neighbouring nodes under pressure.
      real(wp) :: surface_slope = 0.0_wp
      !> Largest |T_m|/P of the nodes whose pressure counts; NaN: speeds not known.
      real(wp) :: stress_share = 0.0_wp
      !> Temperature rise [K] by sliding; 0: not computed.
      real(wp) :: film_heating = 0.0_wp
   end type reynolds_limits_t

   !> Stress over pressure counts where the pressure exceeds this share of its largest value.
   real(wp), parameter, public :: stressed_share = 0.1_wp

   !> Integrals over the film under pressure and the oil in front of the domain.
   type, public :: friction_t
      !> Int T_m dX, positive for u2 > u1; NaN: speeds not known.
      real(wp) :: sliding = 0.0_wp
      !> Int (H/2) dP/dX dX: force by which rolling holds back each surface.
      real(wp) :: rolling = 0.0_wp
      !> (u2 - u1)/(u1 + u2): times the sliding force it is the sliding power.
      real(wp) :: sliding_speed = 0.0_wp
      !> Int S H^3/(mu/mu_0) (dP/dX)^2 dX/(2 lambda).
      real(wp) :: rolling_power = 0.0_wp
      !> Largest |T_m|/P of the nodes whose pressure is above `stressed_share` of the largest.
      real(wp) :: stress_share = 0.0_wp
      !> w/w_ref.
      real(wp) :: load = 1.0_wp
      !> Force of the asperities, as `sliding`, and share of the load that they bear; 0: none touch.
      real(wp) :: boundary = 0.0_wp, asperity_share = 0.0_wp
      !> Relative growth of their load by that of the film, negative.
      real(wp) :: asperity_response = 0.0_wp
      !> X of the first node where oil fills the gap, if that is not the first one; 0: it is.
      real(wp) :: meniscus = 0.0_wp
      !> Largest temperature rise of the mean film and of surfaces 1 and 2 [K].
      real(wp) :: rise(3) = 0.0_wp
   end type friction_t

   !> Fields of rough surfaces and of mixed lubrication, each (nx).
   type :: mixed_fields_t
      !> Psi_1 = psi_1 R/b^2: height of surface 1, positive out of the material (towards the gap).
      real(wp), allocatable :: roughness_1(:)
      !> Psi_2 likewise for surface 2.
      real(wp), allocatable :: roughness_2(:)
      !> Pressure of asperities, and separation of the mean planes, over p_h and b^2/R; the film is
      !> then the mean gap. Not allocated where none touch.
      real(wp), allocatable :: asperity_pressure(:), separation(:)
      !> Share of the film that oil fills, where it is conserved; else not allocated.
      real(wp), allocatable :: saturation(:)
      !> Temperature rises [K] of the mean film and of surfaces 1 and 2 (nx, 3); not allocated: not
      !> computed.
      real(wp), allocatable :: temperature_rise(:, :)
   end type mixed_fields_t

   !> Dimensionless fields on the nodes of the finest grid, each (nx).
   type, extends(mixed_fields_t) :: line_state_t
      !> X = x/b, rising; of a point contact also Y (ny), and all fields are (nx ny), x fastest.
      real(wp), allocatable :: x(:), y(:)
      !> P = p/p_h, never negative; of the oil where asperities touch.
      real(wp), allocatable :: pressure(:)
      !> H = h R/b^2.
      real(wp), allocatable :: film_thickness(:)
      !> mu/mu_0.
      real(wp), allocatable :: viscosity(:)
      !> rho/rho_0.
      real(wp), allocatable :: density(:)
      !> Eyring slip factor S; 1 for a Newtonian fluid.
      real(wp), allocatable :: slip_factor(:)
      !> Shear stress at the wall of surface 1, mean across the film, and at the wall of surface 2,
      !> over p_h b/R; 0 where the film cavitates. Not allocated if the speeds are not known.
      real(wp), allocatable :: shear_stress_1(:), shear_stress_mean(:), shear_stress_2(:)
      !> Integrals of the stresses; not allocated without a film.
      type(friction_t), allocatable :: friction
      !> Distance from the limit of Reynolds' equation; not allocated without a film.
      type(reynolds_limits_t), allocatable :: limits
      !> H0 of (2.58).
      real(wp) :: rigid_displacement = 0.0_wp
      !> T = t u_s/(2 b).
      real(wp) :: time = 0.0_wp
      !> Load, radius and speeds then.
      type(moment_t) :: moment
   end type line_state_t

contains

   !> Limits that are not known.
   pure function unknown_limits() result(limits)
      type(reynolds_limits_t) :: limits

      limits = reynolds_limits_t(not_known(), not_known(), not_known(), not_known())
   end function unknown_limits

   !> Widens `limits` by those of another time.
   pure subroutine widen_limits(limits, other)
      type(reynolds_limits_t), intent(inout) :: limits
      type(reynolds_limits_t), intent(in) :: other

      limits%stokes_number = larger(limits%stokes_number, other%stokes_number)
      limits%surface_slope = larger(limits%surface_slope, other%surface_slope)
      limits%stress_share = larger(limits%stress_share, other%stress_share)
      limits%film_heating = larger(limits%film_heating, other%film_heating)
   end subroutine widen_limits

   !> A state seen from the other side: fields in reverse order, stresses with the other sign.
   pure function turned(state)
      type(line_state_t), intent(in) :: state
      type(line_state_t) :: turned

      turned = state
      turned%moment%speeds = -state%moment%speeds
      associate (last => size(state%pressure))
         turned%x(:) = -state%x(size(state%x):1:-1)
         if (allocated(state%y)) turned%y(:) = -state%y(size(state%y):1:-1)
         turned%pressure(:) = state%pressure(last:1:-1)
         turned%film_thickness(:) = state%film_thickness(last:1:-1)
         if (allocated(state%roughness_1)) then
            turned%roughness_1(:) = state%roughness_1(last:1:-1)
            turned%roughness_2(:) = state%roughness_2(last:1:-1)
         end if
         if (allocated(state%saturation)) turned%saturation(:) = state%saturation(last:1:-1)
         if (allocated(state%separation)) turned%separation(:) = state%separation(last:1:-1)
         if (allocated(state%separation)) turned%asperity_pressure(:) = &
            state%asperity_pressure(last:1:-1)
         if (allocated(state%shear_stress_mean)) turned%shear_stress_mean(:) = &
            -state%shear_stress_mean(last:1:-1)
         if (allocated(state%shear_stress_1)) then
            turned%shear_stress_1(:) = -state%shear_stress_1(last:1:-1)
            turned%shear_stress_2(:) = -state%shear_stress_2(last:1:-1)
         end if
      end associate
      if (.not. allocated(state%friction)) return
      turned%friction%sliding = -state%friction%sliding
      turned%friction%sliding_speed = -state%friction%sliding_speed
   end function turned

   !> Whether pressure, film and rigid displacement are present and finite.
   pure logical function all_finite(state)
      type(line_state_t), intent(in) :: state

      all_finite = allocated(state%pressure) .and. allocated(state%film_thickness)
      if (.not. all_finite) return
      all_finite = all(ieee_is_finite(state%pressure)) &
         .and. all(ieee_is_finite(state%film_thickness)) .and. &
         ieee_is_finite(state%rigid_displacement)
   end function all_finite

end module line_state

!> Copies a level of the solver to the output fields.
module state_output
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use features, only: surface_height
   use film_shear, only: evaluate_friction
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use line_state, only: line_state_t
   use lubricant, only: fluid_density, fluid_viscosity
   use limit_search, only: film_limits
   use rheology, only: ln_slip
   use shear_stresses, only: film_stresses
   implicit none (type, external)
   private

   public :: fill_properties, fill_state

   !> Largest exponent: exp of more overflows, and larger ratios are reported as exp of this.
   real(wp), parameter :: largest_exponent = 700.0_wp

contains

   !> Sets pressure, film, roughness, H0 and time; if mobility and density of the level have been
   !> evaluated (a stop may come before that), which must be those of its pressure and film, also
   !> limits of Reynolds' equation, friction and mean shear stress; with `has_stresses` those at the
   !> walls too, and none of another time. `fill_properties` sets the other fields of the lubricant.
   pure subroutine fill_state(contact, level, time, state, has_stresses)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      real(wp), intent(in) :: time
      type(line_state_t), intent(inout) :: state
      logical, intent(in), optional :: has_stresses
      real(wp), allocatable :: drive(:)

      state%x = level%x(:)
      state%pressure = level%state%pressure(:)
      state%film_thickness = level%state%film(:)
      state%roughness_1 = surface_height(contact%surface_1, level%x, time)
      state%roughness_2 = surface_height(contact%surface_2, level%x, time)
      state%rigid_displacement = level%state%rigid_displacement
      state%time = time
      if (allocated(state%friction)) deallocate (state%friction)
      if (allocated(state%limits)) deallocate (state%limits)
      if (allocated(state%shear_stress_mean)) deallocate (state%shear_stress_mean)
      if (allocated(state%shear_stress_1)) deallocate (state%shear_stress_1, state%shear_stress_2)
      if (all(state%film_thickness > 0.0_wp) .and. level%oil%density(0) > 0.0_wp) then
         allocate (state%friction, state%shear_stress_mean(size(state%x)))
         if (present(has_stresses)) then
            if (has_stresses) allocate (drive(size(state%x)))
         end if
         ! a drive that is not allocated is absent
         call evaluate_friction(level, state%friction, state%shear_stress_mean, drive)
         state%limits = film_limits(level%fluid, level%lambda, level%slide_to_roll, level%dx, &
            level%state%pressure, level%state%film)
         state%limits%stress_share = state%friction%stress_share
         if (allocated(drive)) then
            state%shear_stress_1 = state%shear_stress_mean - 0.5_wp*drive
            state%shear_stress_2 = state%shear_stress_mean + 0.5_wp*drive
         end if
         if (.not. ieee_is_finite(level%slide_to_roll)) deallocate (state%shear_stress_mean)
      end if
   end subroutine fill_state

   !> Sets viscosity mu/mu_0, density rho/rho_0, slip factor S and shear stresses from the state's
   !> pressure and film.
   pure subroutine fill_properties(contact, state)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(inout) :: state
      real(wp), allocatable :: drive(:), ln_mu(:), stresses(:, :)
      integer :: n

      n = size(state%x)
      allocate (drive(n), ln_mu(n), source=0.0_wp)
      call fluid_viscosity(contact%fluid, state%pressure, ln_mu)
      state%density = ln_mu
      call fluid_density(contact%fluid, state%pressure, state%density)
      state%viscosity = exp(min(ln_mu, largest_exponent))
      drive(2:n - 1) = state%film_thickness(2:n - 1)*(state%pressure(3:) - state%pressure(:n - 2)) &
         /(state%x(3:) - state%x(:n - 2))
      state%slip_factor = exp(min(ln_slip(contact%fluid, drive, state%film_thickness, ln_mu), &
         largest_exponent))
      if (.not. ieee_is_finite(contact%slide_to_roll)) return
      stresses = film_stresses(contact%fluid, contact%lambda, contact%slide_to_roll, state%x, &
         state%pressure, state%film_thickness, ln_mu)
      state%shear_stress_1 = stresses(:, 1)
      state%shear_stress_mean = stresses(:, 2)
      state%shear_stress_2 = stresses(:, 3)
   end subroutine fill_properties

end module state_output

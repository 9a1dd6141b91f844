!> Copies a level of the solver to the output fields, and its quantities to a summary.
module state_output
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use features, only: surface_height
   use film_heating, only: thinning
   use film_shear, only: evaluate_drive, evaluate_friction, film_limits, film_stresses, friction_of
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_hierarchy, only: line_hierarchy_t
   use line_level, only: line_level_t
   use line_state, only: line_state_t, turned
   use line_summary, only: line_summary_t, summary_of_fields
   use lubricant, only: fluid_density, fluid_viscosity, ln_slip
   use quantities, only: node_spacings
   implicit none (type, external)
   private

   public :: coarser_summaries, fill_properties, fill_state, level_summary

   !> Largest exponent: exp of more overflows, and larger ratios are reported as exp of this.
   real(wp), parameter :: largest_exponent = 700.0_wp

   !> Most solutions on coarser grids that an error estimate uses.
   integer, parameter :: max_coarser = 3

contains

   !> Sets pressure, film, roughness, H0 and time; if mobility and density of the level have been
   !> evaluated (a stop may come before that), which must be those of its pressure and film, also
   !> limits of Reynolds' equation, friction and mean shear stress; with `has_stresses` those at the
   !> walls too. `fill_properties` sets the other fields of the lubricant.
   pure subroutine fill_state(contact, level, time, state, has_stresses)
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(in) :: level
      real(wp), intent(in) :: time
      type(line_state_t), intent(out) :: state
      logical, intent(in) :: has_stresses
      real(wp) :: drive(size(level%x))

      state%x = level%x(:)
      state%pressure = level%state%pressure(:)
      state%film_thickness = level%state%film(:)
      if (allocated(level%oil%saturation)) state%saturation = level%oil%saturation(:)
      if (allocated(level%rough)) then
         state%asperity_pressure = level%state%asperity_pressure(:)
         state%separation = level%state%separation(:)
      end if
      if (allocated(level%heat)) state%temperature_rise = level%heat%rise(:, :)
      state%roughness_1 = surface_height(contact%surface_1, level%direction*level%x, time)
      state%roughness_2 = surface_height(contact%surface_2, level%direction*level%x, time)
      state%moment = level%moment
      state%moment%speeds = level%direction*state%moment%speeds
      state%rigid_displacement = level%state%rigid_displacement
      state%time = time
      if (all(state%film_thickness > 0.0_wp) .and. level%oil%density(0) > 0.0_wp) then
         allocate (state%friction, state%shear_stress_mean(size(state%x)))
         call evaluate_friction(level, state%friction, state%shear_stress_mean, drive)
         state%limits = film_limits(level%fluid, level%lambda, level%slide_to_roll, level%x, &
            level%state%pressure, level%state%film)
         state%limits%stress_share = state%friction%stress_share
         if (has_stresses) then
            state%shear_stress_1 = state%shear_stress_mean - 0.5_wp*drive
            state%shear_stress_2 = state%shear_stress_mean + 0.5_wp*drive
         end if
         if (.not. ieee_is_finite(level%slide_to_roll)) deallocate (state%shear_stress_mean)
      end if
      if (level%direction < 0.0_wp) state = turned(state)
   end subroutine fill_state

   !> Sets viscosity mu/mu_0, density rho/rho_0, slip factor S and shear stresses from the state's
   !> pressure and film.
   pure subroutine fill_properties(contact, state)
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(inout) :: state
      real(wp), allocatable :: drive(:), ln_mu(:), stresses(:, :), factor(:), shift(:)

      allocate (drive, ln_mu, factor, shift, mold=state%x)
      call fluid_viscosity(contact%fluid, state%pressure, ln_mu)
      if (allocated(state%temperature_rise)) then
         call thinning(contact%heating, contact%fluid, state%temperature_rise(:, 1), factor, shift)
         ln_mu = factor*ln_mu + shift
      end if
      state%density = ln_mu
      call fluid_density(contact%fluid, state%pressure, state%density)
      state%viscosity = exp(min(ln_mu, largest_exponent))
      call evaluate_drive(node_spacings(state%x), state%pressure, state%film_thickness, drive)
      drive(1) = 0.0_wp
      state%slip_factor = exp(min(ln_slip(contact%fluid, drive, state%film_thickness, ln_mu), &
         largest_exponent))
      if (.not. ieee_is_finite(contact%slide_to_roll)) return
      stresses = film_stresses(contact%fluid, contact%lambda, contact%slide_to_roll, state%x, &
         state%pressure, state%film_thickness, ln_mu)
      state%shear_stress_1 = stresses(:, 1)
      state%shear_stress_mean = stresses(:, 2)
      state%shear_stress_2 = stresses(:, 3)
   end subroutine fill_properties

   !> Summaries on n/2, n/4 and n/8 intervals, n those of the finest level, as far as these levels
   !> are solved accurately enough and no cycle has changed them since.
   pure function coarser_summaries(hierarchy) result(coarser)
      type(line_hierarchy_t), intent(in) :: hierarchy
      type(line_summary_t), allocatable :: coarser(:)
      integer :: below

      allocate (coarser(0))
      if (hierarchy%coarsest < hierarchy%finest) return
      do below = 1, min(max_coarser, hierarchy%finest - 1)
         associate (level => hierarchy%levels(hierarchy%finest - below))
            if (.not. level%is_coarse_run) exit
            coarser = [coarser, level_summary(level)]
         end associate
      end do
   end function coarser_summaries

   !> Summary of the solution on a level, whose coefficients must be those of the solution.
   pure function level_summary(level) result(summary)
      type(line_level_t), intent(in) :: level
      type(line_summary_t) :: summary

      summary = summary_of_fields(level%x, level%state%pressure, level%state%film, 0.0_wp, &
         friction_of(level), level%state%asperity_pressure)
   end function level_summary

end module state_output

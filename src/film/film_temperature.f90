!> Temperature of the film, repeated until it is that of its own heat. Where load, radius and speeds
!> change in time it is that of the moment, as if it had lasted: heat passes the contact with it.
module film_temperature
   use film_heating, only: film_warmth, thermal_fall
   use film_shear, only: evaluate_friction
   use flow_law, only: block_size => slip_block
   use line_state, only: friction_t
   use kinds, only: wp
   use line_level, only: line_level_t, thin_oil
   use listener, only: listener_t
   use newton_line, only: solve_newton, step_tolerance
   use newton_work, only: newton_t
   use reynolds_line, only: evaluate_coefficients
   use lubricant, only: evaluate_stress, limited_stress
   implicit none (type, external)
   private

   public :: solve_warm, warm_film

   !> Change of ln mu over which the fall of the stress is taken.
   real(wp), parameter :: small = 0.01_wp
   !> Least share of a change that is made.
   real(wp), parameter :: least_share = 0.1_wp

   !> Change of the viscosity by the temperature that a solution may ask for: this share of its
   !> tolerance, but no less than the second; most rounds to it.
   real(wp), parameter :: share_of_tolerance = 1.0e-2_wp, least_change = 1.0e-6_wp
   integer, parameter :: most_rounds = 30

contains

   !> Solves a level as `solve_newton` does, with the temperature of its film; `newton%steps` counts
   !> all steps.
   subroutine solve_warm(newton, level, tolerance, max_steps, listener, film_is_exact)
      type(newton_t), intent(inout) :: newton
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: tolerance
      integer, intent(in) :: max_steps
      class(listener_t), intent(inout), optional :: listener
      logical, intent(in), optional :: film_is_exact
      real(wp) :: change
      integer :: round, steps

      steps = 0
      do round = 1, most_rounds
         call solve_newton(newton, level, step_tolerance(level, tolerance), max_steps, listener, &
            film_is_exact=film_is_exact)
         steps = steps + newton%steps
         if (.not. newton%is_converged) exit
         call warm_film(level, change)
         if (change <= max(share_of_tolerance*tolerance, least_change)) exit
      end do
      newton%steps = steps
   end subroutine solve_warm

   !> Moves the temperature of a level to that of the heat in its present film. The stress of a node
   !> falls with its own temperature: else one round overheats an oil and the next leaves it cold.
   !> Of the change a share is made that follows from the last two (B. M. Irons and R. C. Tuck, Int.
   !> J. Numer. Methods Eng. 1, 1969, 275). `change`: the whole one as it changes the ambient
   !> viscosity; 0 where no temperature is computed.
   pure subroutine warm_film(level, change)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(out) :: change
      type(friction_t) :: friction
      real(wp), dimension(0:level%n) :: stress, drive, fall, difference
      real(wp) :: sources(0:level%n, 3), driven(0:level%n + 1)
      real(wp), allocatable :: before(:)
      integer :: first, last

      change = 0.0_wp
      if (.not. allocated(level%heat)) return
      call evaluate_coefficients(level)
      call evaluate_friction(level, friction, stress, drive)
      associate (heat => level%heat, p => level%state%pressure, h => level%state%film, &
         oil => level%oil)
         do first = 0, level%n, block_size
            last = min(first + block_size - 1, level%n)
            call evaluate_stress(level%fluid, level%lambda*level%slide_to_roll/12, &
               drive(first:last), 1/h(first:last), oil%ln_mu(first:last) - small, fall(first:last))
         end do
         fall = limited_stress(level%fluid, p, fall)
         where (abs(stress) > 0.0_wp)
            fall = max(log(stress/fall)/small, 0.0_wp)*thermal_fall(heat%law, level%fluid, &
               heat%rise(:, 1), oil%ln_mu)
         else where
            fall = 0.0_wp
         end where
         sources = 0.0_wp
         sources(:, 1) = abs(stress)
         if (allocated(level%rough)) sources(:, 2) = level%rough%friction &
            *level%state%asperity_pressure
         sources = sources*(heat%law%shear_stress*abs(heat%law%speeds(2) - heat%law%speeds(1)))
         if (heat%law%has_flow) then
            driven = 0.0_wp   ! e (P(i) - P(i-1))^2 of the faces
            driven(1:level%n) = oil%face_mobility*(p(1:) - p(:level%n - 1))**2
            sources(:, 3) = (driven(:level%n) + driven(1:))/(oil%density*4*level%lambda &
               *level%dx**2)*heat%law%shear_stress*sum(heat%law%speeds)
            fall = (fall*sources(:, 1) + thermal_fall(heat%law, level%fluid, heat%rise(:, 1), &
               oil%ln_mu)*sources(:, 3))/max(sources(:, 1) + sources(:, 3), tiny(1.0_wp))
         end if
         before = heat%rise(:, 1)
         heat%rise = film_warmth(heat%law, level%dx, sources, h, before, fall)
         difference = heat%rise(:, 1) - before - heat%change
         heat%change = heat%change + difference
         change = heat%law%thermal_viscosity*maxval(abs(heat%change))
         if (heat%share > 0.0_wp) then
            heat%share = heat%share*dot_product(difference - heat%change, difference) &
               /max(dot_product(difference, difference), tiny(1.0_wp))
            heat%share = min(max(heat%share, least_share), 1.0_wp)
         else
            heat%share = 1.0_wp
         end if
         heat%rise(:, 1) = before + heat%share*heat%change
      end associate
      call thin_oil(level)
   end subroutine warm_film

end module film_temperature

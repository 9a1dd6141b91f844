!> The last solutions of a transient: a new one enters, and the first guess of the next comes out.
module march_history
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_level, only: line_level_t
   use lubricant, only: fluid_density_value
   use march_state, only: march_state_t
   use time_scheme, only: parabola_weights
   implicit none (type, external)
   private

   public :: extrapolate, remember

contains

   !> P (cut at 0) and H0 at the end of a step of `length`, by the parabola through the last three solutions; fewer while there
   !> are fewer.
   pure subroutine extrapolate(history, length, level, rigid_displacement)
      type(march_state_t), intent(in) :: history
      real(wp), intent(in) :: length
      type(line_level_t), intent(inout) :: level
      real(wp), intent(out) :: rigid_displacement
      real(wp) :: weights(3), last

      last = merge(history%lengths(1), 1.0_wp, history%size > 1)
      weights = parabola_weights(history%size, length/last, history%lengths(2)/last)
      associate (p => history%pressure, h0 => history%rigid_displacement)
         level%pressure = max(weights(1)*p(:, 1) + weights(2)*p(:, 2) + weights(3)*p(:, 3), 0.0_wp)
         rigid_displacement = dot_product(weights, h0)
      end associate
   end subroutine extrapolate

   !> Takes the present solution, at the end of a step of `length`, into the history.
   pure subroutine remember(history, contact, level, rigid_displacement, length)
      type(march_state_t), intent(inout) :: history
      type(line_contact_t), intent(in) :: contact
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: rigid_displacement, length

      if (.not. allocated(history%pressure)) allocate (history%pressure(0:level%n, 3), history%mass(0:level%n, 2), source=0.0_wp)
      history%pressure(:, 3) = history%pressure(:, 2)
      history%pressure(:, 2) = history%pressure(:, 1)
      history%pressure(:, 1) = level%pressure
      history%lengths = [length, history%lengths(1)]
      history%rigid_displacement = [rigid_displacement, history%rigid_displacement(1:2)]
      call fluid_density_value(contact%fluid, level%pressure, level%density)
      history%mass(:, 2) = history%mass(:, 1)
      history%mass(:, 1) = level%density*level%film
      history%size = min(history%size + 1, 3)
   end subroutine remember

end module march_history

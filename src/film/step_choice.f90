!> The time step of a transient: chosen where the user leaves it open, and always such that whole
!> steps end at the wanted time.
module step_choice
   use kinds, only: wp
   use line_contact, only: line_contact_t, shortest_passage
   use solver_settings, only: time_settings_t
   use wave_resolution, only: wanted_steps
   implicit none (type, external)
   private

   public :: choose_time_step, count_steps

   !> So much of a step is rounding: a step given to a few digits is not cut for it.
   real(wp), parameter :: rounding = 1.0e-3_wp

contains

   !> Sets the time step of a transient on a complete domain: the given one, or dX, but at least
   !> `wanted_steps` in the passage of the finest wave; made shorter so that a whole number of steps
   !> ends at `time%end_time`. A steady case stays as it is, and so does a step that has been
   !> through here.
   pure subroutine choose_time_step(contact, time)
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(inout) :: time
      real(wp) :: wanted

      if (.not. (time%is_transient .and. time%end_time > 0.0_wp)) return
      wanted = time%time_step
      if (.not. wanted > 0.0_wp) wanted = min((contact%domain%x_outlet - contact%domain%x_inlet) &
         /contact%domain%intervals, &
         shortest_passage(contact)/wanted_steps)
      time%time_step = time%end_time/max(1, ceiling(time%end_time/wanted - rounding))
   end subroutine choose_time_step

   !> Number of steps to the end, for a step from `choose_time_step`.
   pure function count_steps(time) result(steps)
      type(time_settings_t), intent(in) :: time
      integer :: steps

      steps = nint(time%end_time/time%time_step)
   end function count_steps

end module step_choice

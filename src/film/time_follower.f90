!> Somebody who repeats the time steps of a passage with other equations.
module time_follower
   use film_state, only: film_state_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use momentum_history, only: momentum_history_t
   use time_part, only: time_part_t
   implicit none (type, external)
   private

   public :: follower_t

   !> Repeats the steps.
   type, abstract :: follower_t
      !> Its pressure, film and H0 at the end of the last step.
      type(film_state_t) :: state
      !> Its largest difference of pressures across the film then [p_h].
      real(wp) :: pressure_variation = 0.0_wp
   contains
      !> From the smooth steady pressure of a contact, whose film the surfaces have entered, at
      !> T = 0; `reason` why it cannot.
      procedure(begin_interface), deferred :: begin
      !> Goes on by one part; `reason` why it cannot.
      procedure(advance_interface), deferred :: advance
      !> Where it stands after a step, and going on from there; `reason` why it cannot.
      procedure(kept_interface), deferred :: kept
      procedure(resume_interface), deferred :: resume
   end type follower_t

   abstract interface
      subroutine begin_interface(self, contact, state, reason)
         import :: follower_t, line_contact_t, line_state_t
         implicit none (type, external)
         class(follower_t), intent(inout) :: self
         type(line_contact_t), intent(in) :: contact
         type(line_state_t), intent(in) :: state
         character(:), allocatable, intent(out) :: reason
      end subroutine begin_interface

      subroutine advance_interface(self, part, reason)
         import :: follower_t, time_part_t
         implicit none (type, external)
         class(follower_t), intent(inout) :: self
         type(time_part_t), intent(in) :: part
         character(:), allocatable, intent(out) :: reason
      end subroutine advance_interface

      function kept_interface(self) result(history)
         import :: follower_t, momentum_history_t
         implicit none (type, external)
         class(follower_t), intent(in) :: self
         type(momentum_history_t) :: history
      end function kept_interface

      subroutine resume_interface(self, contact, state, history, reason)
         import :: follower_t, line_contact_t, line_state_t, momentum_history_t
         implicit none (type, external)
         class(follower_t), intent(inout) :: self
         type(line_contact_t), intent(in) :: contact
         type(line_state_t), intent(in) :: state
         type(momentum_history_t), intent(in) :: history
         character(:), allocatable, intent(out) :: reason
      end subroutine resume_interface
   end interface

end module time_follower

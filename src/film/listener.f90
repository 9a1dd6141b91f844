!> How a solver reports its progress and passes on time steps without knowing its listener.
module listener
   use errors, only: error_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use film_state, only: film_state_t
   use line_summary, only: line_summary_t
   use march_state, only: march_state_t, momentum_history_t, time_part_t
   implicit none (type, external)
   private

   public :: follower_t, is_stopped, listener_t, relay_t

   !> Repeats the time steps of a transient with other equations.
   type, abstract :: follower_t
      !> Its pressure, film and H0 at the end of the last step.
      type(film_state_t) :: state
      !> Its largest pressure difference across the film then [p_h].
      real(wp) :: pressure_variation = 0.0_wp
      !> State from which it resumes; not allocated: it begins at T = 0.
      type(momentum_history_t), allocatable :: earlier
   contains
      !> Begins at T = 0 from the smooth steady pressure of a contact whose film the surfaces have
      !> entered, or resumes from `earlier`; `reason`: why it cannot.
      procedure(start_interface), deferred :: start
      !> Advances by one part of a step; `reason`: why it cannot.
      procedure(advance_interface), deferred :: advance
      !> Returns its state after a step, to resume from.
      procedure(kept_interface), deferred :: kept
   end type follower_t

   abstract interface
      subroutine start_interface(self, contact, state, reason)
         import :: follower_t, line_contact_t, line_state_t
         class(follower_t), intent(inout) :: self
         type(line_contact_t), intent(in) :: contact
         type(line_state_t), intent(in) :: state
         character(:), allocatable, intent(out) :: reason
      end subroutine start_interface

      subroutine advance_interface(self, part, reason)
         import :: follower_t, time_part_t
         class(follower_t), intent(inout) :: self
         type(time_part_t), intent(in) :: part
         character(:), allocatable, intent(out) :: reason
      end subroutine advance_interface

      function kept_interface(self) result(history)
         import :: follower_t, momentum_history_t
         class(follower_t), intent(in) :: self
         type(momentum_history_t) :: history
      end function kept_interface
   end interface

   !> Listens to a solver. This type ignores everything: extend it to receive something.
   type :: listener_t
      !> The solver ends after this cycle or step, not converged (a full disk, a signal).
      logical :: is_stopping = .false.
      !> Why an auxiliary run has failed, memory or a library: none follows, and all end.
      type(error_t), allocatable :: error
      !> Number of time steps between states with shear stresses; 0: none.
      integer :: stress_stride = 0
      !> Repeats the time steps with other equations; not allocated: none.
      class(follower_t), allocatable :: follower
      !> Set by the solver after a steady solution: quantities on the coarser grids of its nested
      !> start, n/2 intervals, n/4 ...
      type(line_summary_t), allocatable :: coarser(:)
      !> Set by the solver on a graded grid: bounds of the errors by the grid, in the order of the
      !> table of quantities; NaN: not known.
      real(wp), allocatable :: grid_errors(:)
   contains
      !> Called after each time step, and once at T = 0 with step = 0.
      procedure :: on_step => ignore_step
      !> Called after each part of a time step that an error estimate has divided, but the last.
      procedure :: on_part => ignore_part
      !> Called when a new stage begins, and after each cycle of a steady solution.
      procedure :: on_stage => ignore_stage
      !> Whether to end the solver: called after each cycle of a steady solution, between the parts
      !> of its start, and before each time step.
      procedure :: wants_stop
   end type listener_t

   !> Listens to an auxiliary run: forwards stages to the parent run's listener, and stops when that
   !> one asks to.
   type, extends(listener_t) :: relay_t
      class(listener_t), pointer :: parent => null()
   contains
      procedure :: on_stage => forward_stage
      procedure :: wants_stop => ask_parent
   end type relay_t

contains

   !> Whether the listener, if any, asks to stop.
   logical function is_stopped(listener)
      class(listener_t), intent(inout), optional :: listener

      is_stopped = .false.
      if (present(listener)) is_stopped = listener%wants_stop()
   end function is_stopped

   !> Ignores time step `step` of `steps` (0 = the start) and its `state`, from which later steps
   !> continue with `history`; `report` as far as known.
   subroutine ignore_step(self, step, steps, state, history, report)
      class(listener_t), intent(inout) :: self
      integer, intent(in) :: step, steps
      type(line_state_t), intent(in) :: state
      type(march_state_t), intent(in) :: history
      type(report_t), intent(in) :: report

      associate (unused_self => self, unused_step => step, unused_steps => steps, &
         unused_state => state, unused_history => history, unused_report => report)
      end associate
   end subroutine ignore_step

   !> Ignores the `state` inside a time step.
   subroutine ignore_part(self, state)
      class(listener_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state

      associate (unused_self => self, unused_state => state)
      end associate
   end subroutine ignore_part

   !> Ignores a stage, described by `words`; for a cycle its number, from 1, and the residual and
   !> the load error after it [-].
   subroutine ignore_stage(self, words, cycle, residuals)
      class(listener_t), intent(inout) :: self
      character(*), intent(in) :: words
      integer, intent(in), optional :: cycle
      real(wp), intent(in), optional :: residuals(2)

      associate (unused_self => self, unused_words => words)
         if (present(cycle) .and. present(residuals)) return
      end associate
   end subroutine ignore_stage

   !> Whether `is_stopping` is set.
   logical function wants_stop(self)
      class(listener_t), intent(inout) :: self

      wants_stop = self%is_stopping
   end function wants_stop

   !> Forwards a stage, but not cycles.
   recursive subroutine forward_stage(self, words, cycle, residuals)
      class(relay_t), intent(inout) :: self
      character(*), intent(in) :: words
      integer, intent(in), optional :: cycle
      real(wp), intent(in), optional :: residuals(2)

      if (present(cycle) .or. present(residuals)) return
      call self%parent%on_stage(words)
   end subroutine forward_stage

   !> Asks the parent run's listener.
   recursive logical function ask_parent(self) result(wants_stop)
      class(relay_t), intent(inout) :: self

      wants_stop = self%parent%wants_stop()
      self%is_stopping = wants_stop
   end function ask_parent

end module listener

!> How a solver tells its progress and hands over time steps without knowing who listens.
module observer
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use march_state, only: march_state_t
   use time_part, only: time_part_t
   implicit none (type, external)
   private

   public :: is_stopped, lookout_t, observer_t

   !> Somebody who listens to a solver. This one ignores everything: who wants to know extends it.
   type :: observer_t
      !> Set by the observer: the solver ends after this cycle or step, as not converged (a full
      !> disk, a signal).
      logical :: wants_stop = .false.
      !> Set by the observer in `on_step`: it wants to keep where the transient stands
      !> (`keep_state`).
      logical :: wants_state = .false.
      !> Set by the observer: it repeats the time steps with other equations (`on_start`,
      !> `on_parts`).
      logical :: wants_parts = .false.
      !> Set by the observer: every how many time steps it wants shear stresses; 0: never.
      integer :: stress_stride = 0
   contains
      !> Whether the state of a time step is to have shear stresses.
      procedure, non_overridable :: wants_stresses
      !> After each cycle of a steady solve.
      procedure :: on_cycle => ignore_cycle
      !> After each time step, and once at T = 0 with step = 0.
      procedure :: on_step => ignore_step
      !> With `wants_parts`, before `on_step` at T = 0 or where a march goes on, and after each time
      !> step before `on_step`.
      procedure :: on_start => ignore_start
      procedure :: on_parts => ignore_parts
      !> After a time step for which `wants_state` is set.
      procedure :: keep_state => ignore_state
      !> After a steady solution: the summaries of the coarser grids that it has passed, of n/2
      !> intervals, n/4 ...
      procedure :: keep_coarser => ignore_coarser
      !> What is done from now on, in a few words for somebody who waits.
      procedure :: on_stage => ignore_stage
      !> Looks whether there is a reason to stop: after each cycle of a steady solve, and between
      !> the parts of its start.
      procedure :: look_outside => ignore_outside
   end type observer_t

   !> Listens to a run that serves another one: tells nobody of its cycles and steps, but ends a
   !> steady run where the other one's `watcher` wants to stop.
   type, extends(observer_t) :: lookout_t
      class(observer_t), pointer :: watcher => null()
   contains
      procedure :: on_stage => tell_watcher
      procedure :: look_outside => look_through
   end type lookout_t

contains

   !> Looks outside: whether `watcher` wants to stop. Without one nobody does.
   function is_stopped(watcher) result(answer)
      class(observer_t), intent(inout), optional :: watcher
      logical :: answer

      answer = .false.
      if (.not. present(watcher)) return
      call watcher%look_outside()
      answer = watcher%wants_stop
   end function is_stopped

   !> At step 0, and at every one of `stress_stride` after that.
   pure function wants_stresses(self, step) result(answer)
      class(observer_t), intent(in) :: self
      integer, intent(in) :: step
      logical :: answer

      answer = self%stress_stride > 0
      if (answer) answer = mod(step, self%stress_stride) == 0
   end function wants_stresses

   !> `cycle` counts from 1; `residual` and `load_error` are those after it [-].
   subroutine ignore_cycle(self, cycle, residual, load_error)
      class(observer_t), intent(inout) :: self
      integer, intent(in) :: cycle
      real(wp), intent(in) :: residual, load_error

      associate (unused_self => self, unused_cycle => cycle, unused_residual => residual, &
         unused_load_error => load_error)
      end associate
   end subroutine ignore_cycle

   !> Time step `step` of `steps` is done (0 = the start) and left `state`; `report` as far as it is
   !> known.
   subroutine ignore_step(self, step, steps, state, report)
      class(observer_t), intent(inout) :: self
      integer, intent(in) :: step, steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report

      associate (unused_self => self, unused_step => step, unused_steps => steps, &
         unused_state => state, unused_report => report)
      end associate
   end subroutine ignore_step

   !> T = 0: in `state` the smooth steady pressure of `contact`, with the film that the surfaces
   !> have entered; or, where a march goes on, its last state. A report that is not converged
   !> afterwards ends the march.
   subroutine ignore_start(self, contact, state, report)
      class(observer_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report

      associate (unused_self => self, unused_contact => contact, unused_state => state, &
         unused_report => report)
      end associate
   end subroutine ignore_start

   !> A time step has been solved in these parts. A report that is not converged afterwards ends the
   !> march.
   subroutine ignore_parts(self, parts, report)
      class(observer_t), intent(inout) :: self
      type(time_part_t), intent(in) :: parts(:)
      type(report_t), intent(inout) :: report

      associate (unused_self => self, unused_parts => parts, unused_report => report)
      end associate
   end subroutine ignore_parts

   !> Keeps nothing.
   subroutine ignore_state(self, history)
      class(observer_t), intent(inout) :: self
      type(march_state_t), intent(in) :: history

      associate (unused_history => history)
      end associate
      self%wants_state = .false.
   end subroutine ignore_state

   !> Keeps no summaries.
   subroutine ignore_coarser(self, coarser)
      class(observer_t), intent(inout) :: self
      type(line_summary_t), intent(in) :: coarser(:)

      associate (unused_self => self, unused_coarser => coarser)
      end associate
   end subroutine ignore_coarser

   !> Tells nobody.
   subroutine ignore_stage(self, words)
      class(observer_t), intent(inout) :: self
      character(*), intent(in) :: words

      associate (unused_self => self, unused_words => words)
      end associate
   end subroutine ignore_stage

   !> There is no outside.
   subroutine ignore_outside(self)
      class(observer_t), intent(inout) :: self

      associate (unused_self => self)
      end associate
   end subroutine ignore_outside

   !> Whoever waits for the other run waits for this one.
   recursive subroutine tell_watcher(self, words)
      class(lookout_t), intent(inout) :: self
      character(*), intent(in) :: words

      call self%watcher%on_stage(words)
   end subroutine tell_watcher

   !> Asks the watcher whether to stop.
   recursive subroutine look_through(self)
      class(lookout_t), intent(inout) :: self

      call self%watcher%look_outside()
      self%wants_stop = self%watcher%wants_stop
   end subroutine look_through

end module observer

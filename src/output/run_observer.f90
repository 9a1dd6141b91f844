!> Passes on what a solver tells: time steps to the result file, progress to the log. Stops the
!> solver when the run is interrupted, and keeps a checkpoint then and from time to time.
module run_observer
   use breakdown_text, only: breakdown_sentence
   use checkpoint, only: write_checkpoint
   use checkpoint_content, only: checkpoint_t
   use errors, only: error_t, fail, output_error
   use film_passage, only: new_passage
   use grid_estimates, only: take_coarser
   use iteration_report, only: phase_output, phase_transient, report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_state, only: line_state_t
   use line_summary, only: line_summary_t
   use march_state, only: march_state_t
   use momentum_history, only: momentum_history_t
   use observer, only: observer_t
   use progress_log, only: progress_log_t
   use result_writer, only: result_writer_t
   use scaling, only: scaling_t
   use signals, only: begin_activity, is_interrupted, set_patience
   use solver_settings, only: word_length
   use time_follower, only: follower_t
   use time_part, only: time_part_t
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: run_observer_t

   !> A run of this wall time [s] gets a checkpoint after its last step, before coarse runs and
   !> result.
   real(wp), parameter :: long_run = 5.0_wp

   !> Hands everything on to `writer` and `log`; stops the solver if nothing can be written any more
   !> or the run is interrupted.
   type, extends(observer_t) :: run_observer_t
      type(result_writer_t) :: writer
      type(progress_log_t) :: log
      !> Wall time spent on output, and wall time of earlier runs that this one goes on with [s].
      real(wp) :: output_seconds = 0.0_wp, earlier_seconds = 0.0_wp
      !> What identifies the case in its checkpoint.
      character(:), allocatable :: case
      !> Floor of the film H, and reference values, for what is told of a film breakdown.
      real(wp) :: film_floor = 0.0_wp
      type(scaling_t) :: scaling
      !> Intervals, time step and space scheme, given or chosen.
      integer :: intervals = 0
      real(wp) :: time_step = 0.0_wp
      character(len=word_length) :: space_scheme = 'auto'
      !> Wall time between checkpoints [s].
      real(wp) :: checkpoint_interval = huge(1.0_wp)
      !> Threads that the run may have.
      integer :: threads = 1
      !> Coarse runs are still wanted.
      logical :: has_coarse_runs = .false.
      !> The same time steps by the full momentum equations, where they are wanted, and where they
      !> go on from a checkpoint.
      class(follower_t), allocatable :: momentum
      type(momentum_history_t), allocatable :: momentum_before
      !> Why the last checkpoint could not be written; not allocated: it could.
      type(error_t), allocatable :: failure
      !> Seconds of the clock at the start and at the last checkpoint.
      real(wp), private :: start = 0.0_wp, last_checkpoint = 0.0_wp
   contains
      procedure :: on_cycle
      procedure :: on_step
      procedure :: on_start
      procedure :: on_parts
      procedure :: on_stage
      procedure :: keep_state
      procedure :: keep_coarser
      procedure :: look_outside
      !> The run begins.
      procedure :: start_clock
   end type run_observer_t

contains

   !> Sets the clocks.
   subroutine start_clock(self)
      class(run_observer_t), intent(inout) :: self

      self%start = wall_seconds()
      self%last_checkpoint = self%start
   end subroutine start_clock

   !> Passes a cycle to the log.
   subroutine on_cycle(self, cycle, residual, load_error)
      class(run_observer_t), intent(inout) :: self
      integer, intent(in) :: cycle
      real(wp), intent(in) :: residual, load_error

      call self%log%on_cycle(cycle, residual, load_error)
      self%wants_stop = is_interrupted()
   end subroutine on_cycle

   !> Stores a time step, then passes it to the log.
   subroutine on_step(self, step, steps, state, report)
      class(run_observer_t), intent(inout) :: self
      integer, intent(in) :: step, steps
      type(line_state_t), intent(in) :: state
      type(report_t), intent(in) :: report
      real(wp) :: begin

      begin = wall_seconds()
      call self%writer%store_step(step, steps, state, report)
      if (allocated(self%momentum)) then
         associate (writer => self%writer)
            if (step == 0) writer%film_passage = new_passage(steps, writer%profile_stride, &
               size(state%x))
            call writer%film_passage%make_room(steps)
            call writer%film_passage%add(step, state, self%momentum)
         end associate
      end if
      call self%log%on_step(step, steps, state, report)
      if (report%breakdown%is_now .and. report%breakdown%count == 1) call self%log%say_error( &
         breakdown_sentence(report%breakdown, self%film_floor, self%scaling))
      self%wants_stop = self%writer%has_failed() .or. is_interrupted()
      self%wants_state = is_interrupted() &
         .or. begin - self%last_checkpoint >= self%checkpoint_interval
      if (step == steps) self%wants_state = self%wants_state .or. begin - self%start > long_run
      self%wants_state = self%wants_state .and. .not. self%writer%has_failed()
      call set_patience(self%wants_state .or. step < steps)
      self%output_seconds = self%output_seconds + wall_seconds() - begin
   end subroutine on_step

   !> The full momentum equations begin, or go on.
   subroutine on_start(self, contact, state, report)
      class(run_observer_t), intent(inout) :: self
      type(line_contact_t), intent(in) :: contact
      type(line_state_t), intent(in) :: state
      type(report_t), intent(inout) :: report
      character(:), allocatable :: reason

      if (allocated(self%momentum_before)) then
         call self%momentum%resume(contact, state, self%momentum_before, reason)
         deallocate (self%momentum_before)
      else
         call self%momentum%begin(contact, state, reason)
      end if
      if (.not. allocated(reason)) return
      report%converged = .false.
      report%reason = reason
   end subroutine on_start

   !> The full momentum equations follow.
   subroutine on_parts(self, parts, report)
      class(run_observer_t), intent(inout) :: self
      type(time_part_t), intent(in) :: parts(:)
      type(report_t), intent(inout) :: report
      character(:), allocatable :: reason
      integer :: i

      do i = 1, size(parts)
         call self%momentum%advance(parts(i), reason)
         if (.not. allocated(reason)) cycle
         report%converged = .false.
         report%reason = reason
         return
      end do
   end subroutine on_parts

   !> What is done from now on: shown if it takes long.
   subroutine on_stage(self, words)
      class(run_observer_t), intent(inout) :: self
      character(*), intent(in) :: words

      associate (unused => self)
      end associate
      call begin_activity(words)
   end subroutine on_stage

   !> Writes a checkpoint. A failure is reported and does not stop the run: the last
   !> one is still there.
   subroutine keep_state(self, history)
      class(run_observer_t), intent(inout) :: self
      type(march_state_t), intent(in) :: history
      type(checkpoint_t) :: checkpoint
      real(wp) :: begin

      begin = wall_seconds()
      checkpoint%case = self%case
      checkpoint%march = history
      checkpoint%passage = self%writer%passage
      checkpoint%forecast = self%writer%bars%forecast
      checkpoint%statistics = self%writer%statistics
      if (allocated(self%momentum)) then
         checkpoint%momentum = self%momentum%kept()
         checkpoint%film_passage = self%writer%film_passage
      end if
      checkpoint%part = self%writer%store%part()
      checkpoint%intervals = self%intervals
      checkpoint%time_step = self%time_step
      checkpoint%space_scheme = trim(self%space_scheme)
      associate (report => checkpoint%march%report)
         report%wall_seconds = self%earlier_seconds + begin - self%start
         report%phase_seconds(phase_output) = self%output_seconds
         report%phase_seconds(phase_transient) = 0.0_wp
         report%phase_seconds(phase_transient) = max(report%wall_seconds &
            - sum(report%phase_seconds), 0.0_wp)
      end associate
      if (allocated(self%failure)) deallocate (self%failure)
      if (self%writer%sync()) then
         call write_checkpoint(checkpoint, self%writer%name%path//'.ckpt', self%failure)
      else
         call fail(self%failure, output_error, 'cannot write '//self%writer%name%path//'.part')
      end if
      if (allocated(self%failure)) then
         call self%log%say_error(self%failure%message)
      else
         self%writer%name%has_checkpoint = .true.
         call self%writer%name%expect_interruption(history%step)
      end if
      call set_patience(.false.)   ! until the next step
      self%wants_state = .false.
      self%last_checkpoint = wall_seconds()
      self%output_seconds = self%output_seconds + self%last_checkpoint - begin
   end subroutine keep_state

   !> Coarser grids that the solution has passed: they need not be run any more.
   subroutine keep_coarser(self, coarser)
      class(run_observer_t), intent(inout) :: self
      type(line_summary_t), intent(in) :: coarser(:)

      if (.not. self%has_coarse_runs .or. size(coarser) < 2) return
      call take_coarser(self%writer%bars, coarser)
      self%has_coarse_runs = .false.
   end subroutine keep_coarser

   !> Whether the run is interrupted.
   subroutine look_outside(self)
      class(run_observer_t), intent(inout) :: self

      self%wants_stop = self%wants_stop .or. is_interrupted()
   end subroutine look_outside

end module run_observer

!> Passes on what a solver tells: time steps to the result file, progress to the log. Stops the
!> solver when the run is interrupted, and keeps a checkpoint then and from time to time.
module run_observer
   use closing_table, only: breakdown_sentence
   use checkpoint, only: write_checkpoint
   use disk_file, only: sync_file
   use errors, only: error_t, fail, output_error
   use iteration_report, only: phase_output, phase_transient, report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use march_state, only: march_state_t
   use listener, only: listener_t
   use progress_log, only: progress_log_t
   use result_writer, only: result_writer_t
   use text, only: add_sentence
   use signals, only: begin_activity, is_interrupted, set_patience
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: run_observer_t

   !> Runs of this wall time [s] get a checkpoint after the last step, before coarse runs.
   real(wp), parameter :: long_run = 5.0_wp

   !> Hands everything on to `writer` and `log`; stops the solver on a failure or an interruption.
   type, extends(listener_t) :: run_observer_t
      type(result_writer_t) :: writer
      type(progress_log_t) :: log
      !> Wall time spent on output, and wall time of earlier runs that this one goes on with [s].
      real(wp) :: output_seconds = 0.0_wp, earlier_seconds = 0.0_wp
      !> Floor of the film H.
      real(wp) :: film_floor = 0.0_wp
      !> Wall time between checkpoints [s].
      real(wp) :: checkpoint_interval = huge(1.0_wp)
      !> Threads that the run may have.
      integer :: threads = 1
      !> Coarse runs are still wanted; the present run is one of those that choose its resolution.
      logical :: has_coarse_runs = .false., is_trial = .false.
      !> Why the last checkpoint could not be written; not allocated: it could.
      type(error_t), allocatable :: failure
      !> What should be known about the result; not allocated: nothing.
      character(:), allocatable :: note
      !> Seconds of the clock at the start and at the last checkpoint.
      real(wp) :: start = 0.0_wp, last_checkpoint = 0.0_wp
      !> More time steps follow.
      logical, private :: is_marching = .false.
   contains
      procedure :: on_step, on_part, on_stage, wants_stop, add_note
      procedure, private :: keep
   end type run_observer_t

contains

   !> Stores a time step, then passes it to the log.
   subroutine on_step(self, step, steps, state, history, report)
      class(run_observer_t), intent(inout) :: self
      integer, intent(in) :: step, steps
      type(line_state_t), intent(in) :: state
      type(march_state_t), intent(in) :: history
      type(report_t), intent(in) :: report
      real(wp) :: begin
      logical :: is_due, is_asked

      begin = wall_seconds()
      if (step == 0) self%output_seconds = 0.0_wp   ! without those of trial runs
      if (self%is_trial .and. step == 0) call self%writer%forget_steps()
      if (allocated(self%follower)) call self%writer%run%film_passage%add(state, self%follower)
      call self%writer%store_step(step, steps, state, report)
      if (self%is_trial) then   ! no checkpoint: another may be the result
         self%output_seconds = self%output_seconds + wall_seconds() - begin
         return
      end if
      call self%log%on_step(step, steps, state, report)
      if (report%breakdown%is_now .and. report%breakdown%count == 1) call self%log%say_error( &
         breakdown_sentence(report%breakdown, self%film_floor, self%log%scaling))
      self%is_stopping = allocated(self%writer%file%failure)
      is_asked = is_interrupted()
      is_due = is_asked .or. begin - self%last_checkpoint >= self%checkpoint_interval
      if (step == steps) is_due = is_due .or. begin - self%start > long_run
      is_due = is_due .and. .not. (self%is_stopping .or. allocated(self%writer%file%row))
      call set_patience(is_due .or. step < steps)
      self%output_seconds = self%output_seconds + wall_seconds() - begin
      if (is_due) call self%keep(state, history, report)
      self%is_marching = step < steps
      self%is_stopping = self%is_stopping .or. (is_asked .and. self%is_marching)
   end subroutine on_step

   !> Adds the state inside a time step to the extremes.
   subroutine on_part(self, state)
      class(run_observer_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      real(wp) :: begin

      begin = wall_seconds()
      call self%writer%run%passage%add(self%writer%quantities_of(state), state%time, .false.)
      self%output_seconds = self%output_seconds + wall_seconds() - begin
   end subroutine on_part

   !> Passes a cycle to the log; any other stage is printed after a few seconds.
   subroutine on_stage(self, words, cycle, residuals)
      class(run_observer_t), intent(inout) :: self
      character(*), intent(in) :: words
      integer, intent(in), optional :: cycle
      real(wp), intent(in), optional :: residuals(2)

      if (present(cycle)) then
         call self%log%on_cycle(words, cycle, residuals(1), residuals(2))
      else
         call begin_activity(words)
      end if
   end subroutine on_stage

   !> Logs `words`, if there are any, and adds them to the note of the result.
   subroutine add_note(self, words)
      class(run_observer_t), intent(inout) :: self
      character(*), intent(in) :: words

      if (words == '') return
      call self%log%say(self%log%file//': '//words)
      call add_sentence(self%note, words)
   end subroutine add_note

   !> Writes a checkpoint. A failure is reported and stops nothing: the last one is still there.
   subroutine keep(self, state, history, report)
      class(run_observer_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      type(march_state_t), intent(in) :: history
      type(report_t), intent(in) :: report
      real(wp) :: begin

      begin = wall_seconds()
      associate (run => self%writer%run)
         run%march = history
         run%march%film = state%film_thickness
         run%march%report = report
         if (allocated(self%follower)) run%momentum = self%follower%kept()
         run%part_digits = self%writer%store%sums%digits()
      end associate
      associate (cost => self%writer%run%march%report%cost)
         cost%wall_seconds = self%earlier_seconds + begin - self%start
         cost%phase_seconds(phase_output) = self%output_seconds
         cost%phase_seconds(phase_transient) = 0.0_wp
         cost%phase_seconds(phase_transient) = max(cost%wall_seconds - sum(cost%phase_seconds), &
            0.0_wp)
      end associate
      if (allocated(self%failure)) deallocate (self%failure)
      if (sync_file(self%writer%path//'.part')) then
         call write_checkpoint(self%writer%run, self%writer%path//'.ckpt', self%failure)
      else
         call fail(self%failure, output_error, 'cannot write '//self%writer%path//'.part')
      end if
      if (allocated(self%failure)) then
         call self%log%say_error(self%failure%message)
      else
         self%writer%has_checkpoint = .true.
         call self%writer%expect_interruption(history%step)
      end if
      call set_patience(.false.)   ! until the next step
      self%last_checkpoint = wall_seconds()
      self%output_seconds = self%output_seconds + self%last_checkpoint - begin
   end subroutine keep

   !> Whether nothing can be written any more, or the run is interrupted: between time steps only if
   !> the last one has kept a checkpoint for it, for a signal may come after that.
   logical function wants_stop(self)
      class(run_observer_t), intent(inout) :: self

      if (.not. self%is_marching) self%is_stopping = self%is_stopping .or. is_interrupted()
      wants_stop = self%is_stopping
   end function wants_stop

end module run_observer

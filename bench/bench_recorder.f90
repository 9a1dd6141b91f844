!> An observer that keeps the pressure of all time steps, the extremes over them, and an eye on the
!> clock.
module bench_recorder
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_state, only: line_state_t
   use line_summary, only: keep_extremes, line_summary_t, summary_of
   use listener, only: listener_t
   use march_state, only: march_state_t
   implicit none (type, external)
   private

   public :: recorder_t, start_recorder, record_steady, largest_difference

   !> What is kept of one run.
   type, extends(listener_t) :: recorder_t
      !> Seconds of processor time after which the run is stopped, counted from `start`.
      real(wp) :: limit = huge(1.0_wp), start = 0.0_wp
      !> True: keep pressure and extremes; false: only watch the clock.
      logical :: is_recording = .false.
      !> Largest residual of all time steps.
      real(wp) :: residual = 0.0_wp
      type(line_summary_t) :: summary
      !> P of all stored times (nx, 0:steps); only the steady solution: (nx, 0:0).
      real(wp), allocatable :: pressure(:, :)
   contains
      procedure :: wants_stop => is_over
      procedure :: on_step => keep_step
   end type recorder_t

contains

   !> Makes the recorder ready for a run.
   subroutine start_recorder(self, is_recording, limit)
      type(recorder_t), intent(out) :: self
      logical, intent(in) :: is_recording
      real(wp), intent(in) :: limit

      self%is_recording = is_recording
      self%limit = limit
      call cpu_time(self%start)
   end subroutine start_recorder

   !> Takes the fields of a steady solution.
   subroutine record_steady(self, state)
      type(recorder_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state

      self%summary = summary_of(state)
      if (.not. self%is_recording) return
      if (allocated(self%pressure)) deallocate (self%pressure)
      allocate (self%pressure(size(state%x), 0:0))
      self%pressure(:, 0) = state%pressure
   end subroutine record_steady

   !> Largest difference in P at the nodes and times that both have; NaN where neither grid contains
   !> the other.
   pure function largest_difference(one, other) result(difference)
      real(wp), intent(in) :: one(:, 0:), other(:, 0:)
      real(wp) :: difference
      integer :: stride_1, stride_2, times_1, times_2, n, steps, k

      n = min(size(one, 1), size(other, 1)) - 1
      steps = min(ubound(one, 2), ubound(other, 2))
      stride_1 = (size(one, 1) - 1)/n
      stride_2 = (size(other, 1) - 1)/n
      times_1 = ubound(one, 2)/max(steps, 1)
      times_2 = ubound(other, 2)/max(steps, 1)
      difference = 0.0_wp
      do k = 0, steps
         difference = max(difference, &
            maxval(abs(one(::stride_1, k*times_1) - other(::stride_2, k*times_2))))
      end do
   end function largest_difference

   !> Whether the run has had its time.
   function is_over(self)
      class(recorder_t), intent(inout) :: self
      logical :: is_over
      real(wp) :: now

      call cpu_time(now)
      self%is_stopping = self%is_stopping .or. now - self%start > self%limit
      is_over = self%is_stopping
   end function is_over

   !> Keeps a time step.
   subroutine keep_step(self, step, steps, state, history, report)
      class(recorder_t), intent(inout) :: self
      integer, intent(in) :: step
      integer, intent(in) :: steps
      type(line_state_t), intent(in) :: state
      type(march_state_t), intent(in) :: history
      type(report_t), intent(in) :: report

      associate (unused => history)
      end associate
      if (step > 0) self%residual = max(self%residual, report%residual)
      if (.not. self%is_recording) return
      if (step == 0) then
         self%summary = summary_of(state)
         if (allocated(self%pressure)) deallocate (self%pressure)
         allocate (self%pressure(size(state%x), 0:steps), source=0.0_wp)
      else
         call keep_extremes(self%summary, summary_of(state))
      end if
      self%pressure(:, step) = state%pressure
   end subroutine keep_step

end module bench_recorder

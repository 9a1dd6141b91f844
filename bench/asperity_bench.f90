!> Solves one line contact many times in one process, for bench, chart and targets.
!>
!>     asperity-bench CASE.nml RUNS SECONDS
!>
!> Prints comma-separated seconds, a line a run: wall time of setup, steady, transient and all, and
!> processor time. No run begins after SECONDS.
program asperity_bench
   use case_input, only: read_case
   use case_record, only: case_t
   use ehl_line_solver, only: solve_ehl_line
   use errors, only: error_t
   use experiment, only: side_runs_t, solution_t
   use findings, only: findings_t
   use iteration_report, only: phase_setup, phase_steady, phase_transient
   use kinds, only: wp
   use listener, only: listener_t
   use resolution_choice, only: choose_resolution
   use text_file, only: read_text_file
   use wall_clock, only: wall_seconds
   implicit none (type, external)

   type(error_t), allocatable :: error
   type(findings_t) :: findings
   type(case_t) :: case
   character(:), allocatable :: content
   character(len=4096) :: words(3)
   real(wp) :: start, seconds
   integer :: i, runs

   do i = 1, size(words)
      call get_command_argument(i, words(i))
   end do
   read (words(2:), *) runs, seconds
   call read_text_file(trim(words(1)), content, error)
   if (allocated(error)) error stop error%message
   call read_case(content, trim(words(1)), case, findings)
   if (findings%count > 0) error stop findings%report(trim(words(1)))
   ! a target has error bars of its own
   case%solver%wants_coarse_runs = case%solver%wants_coarse_runs .and. case%solver%target <= 0.0_wp
   print '(a)', 'setup,steady,transient,all,processor'
   start = wall_seconds()
   do i = 1, runs
      call time_one(case)
      if (wall_seconds() - start > seconds) exit
   end do

contains

   !> Solves `case` and prints its times. With a wanted accuracy in time, the choice of the grid is
   !> in that of all phases.
   subroutine time_one(case)
      type(case_t), intent(in) :: case
      type(error_t), allocatable :: error
      type(listener_t) :: listener
      type(case_t) :: own
      type(side_runs_t), allocatable :: side_runs
      type(solution_t), allocatable :: whole
      real(wp) :: start, processor(2)

      own = case
      call cpu_time(processor(1))
      start = wall_seconds()
      if (own%solver%target > 0.0_wp .and. own%time%is_transient) then
         call choose_resolution(own%contact, own%solver, own%time, side_runs, listener)
         if (allocated(listener%error)) error stop listener%error%message
         call move_alloc(side_runs%whole, whole)
      end if
      if (.not. allocated(whole)) then
         allocate (whole)
         call solve_ehl_line(own%contact, own%solver, own%time, listener, whole%state, &
            whole%report, error)
         if (allocated(error)) error stop error%message
      end if
      call cpu_time(processor(2))
      print '(*(es12.5, :, ","))', whole%report%cost%phase_seconds([phase_setup, phase_steady, &
         phase_transient]), wall_seconds() - start, processor(2) - processor(1)
   end subroutine time_one

end program asperity_bench

!> A dry case on its given grid, or on finer and finer grids until the contact area has the wanted
!> accuracy.
module dry_target
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use dry_case, only: dry_case_t
   use dry_errors, only: estimate_dry_errors
   use dry_resampling, only: dry_sweep_t
   use dry_resolution, only: area_doubt, dry_trial_t, finer_nodes, is_met
   use dry_scaling, only: dry_scaling_t, new_dry_scaling
   use dry_settings, only: dry_settings_t
   use dry_surfaces, only: is_refinable, refine_heights
   use dry_solution, only: dry_solution_t
   use dry_sweep, only: dry_outcome_t, dry_row_t, solve_dry_sweep
   use errors, only: error_t, input_error
   use iteration_report, only: phase_error_bars, phase_steady
   use kinds, only: wp
   use missing_value, only: not_known
   use signals, only: begin_activity
   use system_limits, only: memory_fault, thread_memory
   use text, only: add_sentence, to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_to_target

   !> Most nodes of a line and of an area that are chosen.
   integer, parameter :: max_chosen(2) = [2**20, 2**24]
   !> Times that are summed over the grids.
   integer, parameter :: times = 6

contains

   !> Solves all loads of `dry` and estimates the `errors` of its quantities (none: not wanted).
   !> With a target of the contact area the grid becomes the first one on which the estimate stays
   !> below it, or the finest allowed one, with a note. Times are those of all grids. Errors as in
   !> `solve_dry_sweep` and `refine_heights`.
   subroutine solve_to_target(dry, outcome, errors, error)
      type(dry_case_t), intent(inout) :: dry
      type(dry_outcome_t), intent(out) :: outcome
      type(dry_row_t), allocatable, intent(out) :: errors(:)
      type(error_t), allocatable, intent(out) :: error
      type(dry_trial_t), allocatable :: trials(:)
      type(dry_trial_t) :: trial
      real(wp) :: spent(times)
      integer :: most, nodes(2)

      allocate (trials(0))
      most = 0
      if (is_refinable(dry)) most = max_nodes(dry)
      spent = 0.0_wp
      do
         trial = dry_trial_t([dry%grid%nx, dry%grid%ny], not_known())
         call solve_grid(dry, outcome, errors, error)
         if (allocated(error)) then
            ! On a coarse grid there may be no contact at that separation.
            if (.not. dry%target > 0.0_wp .or. error%kind /= input_error) return
         else
            if (size(errors) > 0) trial%doubt = area_doubt(outcome%rows, errors)
         end if
         call add_times(outcome, spent)
         if (.not. dry%target > 0.0_wp) return
         if (is_met(trial, dry%target)) return
         trials = [trials, trial]
         nodes = finer_nodes(trials, dry%target, most)
         if (nodes(1) == 0) exit
         call refine_heights(dry, nodes, error)
         if (allocated(error)) return
      end do
      if (.not. allocated(error)) call note_unmet(dry, trial%doubt, most)
   end subroutine solve_to_target

   !> The sweep on the grid of `dry`, and the estimated `errors` of its quantities (none: not
   !> wanted). Errors as in `solve_dry_sweep`.
   subroutine solve_grid(dry, outcome, errors, error)
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(out) :: outcome
      type(dry_row_t), allocatable, intent(out) :: errors(:)
      type(error_t), allocatable, intent(out) :: error
      type(dry_scaling_t) :: scaling
      type(dry_settings_t) :: settings
      real(wp) :: start

      allocate (errors(0))
      start = wall_seconds()
      call begin_activity('solving')
      scaling = new_dry_scaling(dry%height, dry%lengths(1), dry%reduced_modulus)
      settings = dry%settings
      settings%keeps_pressures = dry%is_compared()
      call solve_dry_sweep(dry%grid, dry%height, scaling, dry%loads, settings, outcome, error)
      if (allocated(error)) return
      associate (report => outcome%solution%report)
         report%phase_seconds(phase_steady) = wall_seconds() - start
         call begin_activity('error bars on other grids')
         if (dry%has_error_bars) call estimate_dry_errors(dry_sweep_t(dry%grid, dry%height, &
            scaling, dry%loads, settings), outcome, errors, error)
         if (allocated(error)) return
         report%wall_seconds = wall_seconds() - start
         report%phase_seconds(phase_error_bars) = report%wall_seconds &
            - report%phase_seconds(phase_steady)
      end associate
      call judge_sweep(outcome%rows, outcome%solution)
   end subroutine solve_grid

   !> One report for all loads: converged if all are; transforms and iterations are summed.
   subroutine judge_sweep(rows, solution)
      type(dry_row_t), intent(in) :: rows(:)
      type(dry_solution_t), intent(inout) :: solution
      integer :: i

      solution%report%fft_pairs = sum(int(rows%fft_pairs, int64))
      solution%report%cycles = sum(rows%cycles)
      do i = 1, size(rows)
         if (rows(i)%is_converged) cycle
         solution%report%converged = .false.
         solution%report%reason = rows(i)%reason // ' at a mean pressure of ' &
            // to_text(rows(i)%mean_pressure) // ' Pa'
      end do
   end subroutine judge_sweep

   !> Adds the times of one grid to those `spent` before; both are the sums then.
   pure subroutine add_times(outcome, spent)
      type(dry_outcome_t), intent(inout) :: outcome
      real(wp), intent(inout) :: spent(times)

      associate (report => outcome%solution%report)
         spent = spent + [outcome%cpu_prepare, outcome%cpu_solve, outcome%wall_solve, &
            report%wall_seconds, report%phase_seconds(phase_steady), &
            report%phase_seconds(phase_error_bars)]
         outcome%cpu_prepare = spent(1)
         outcome%cpu_solve = spent(2)
         outcome%wall_solve = spent(3)
         report%wall_seconds = spent(4)
         report%phase_seconds(phase_steady) = spent(5)
         report%phase_seconds(phase_error_bars) = spent(6)
      end associate
   end subroutine add_times

   !> Most nodes that a grid for the target may have.
   function max_nodes(dry) result(most)
      type(dry_case_t), intent(in) :: dry
      integer :: most
      real(wp), parameter :: smaller = 0.9_wp

      most = max_chosen(merge(1, 2, dry%grid%ny == 1))
      do while (memory_fault('a grid', dry%memory_on([most/min(2, dry%grid%ny), min(2, &
         dry%grid%ny)]), thread_memory(dry%grid%threads)) /= '')
         most = int(smaller*most)
         if (most <= dry%grid%nx) exit
      end do
   end function max_nodes

   !> Notes that the target is not met by an estimated error of `doubt` (NaN: no solution, which is
   !> told elsewhere), and why.
   subroutine note_unmet(dry, doubt, most)
      type(dry_case_t), intent(inout) :: dry
      real(wp), intent(in) :: doubt
      integer, intent(in) :: most
      character(:), allocatable :: reason

      if (.not. ieee_is_finite(doubt)) return
      if (doubt <= dry%target) return
      reason = 'grids of more than '//to_text(most)//' nodes are not chosen'
      if (most < max_chosen(merge(1, 2, dry%grid%ny == 1))) reason = reason//' with this memory'
      if (most == 0) reason = 'without a period the heights of a file stay on their own nodes'
      call add_sentence(dry%note, 'the wanted accuracy is not met: of the contact area a '// &
         'relative error of '//to_text(doubt, 2)// &
         ' is estimated, '//to_text(dry%target, 2)//' was wanted, and '//reason)
   end subroutine note_unmet

end module dry_target

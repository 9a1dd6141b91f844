!> Solves a dry case on its grid, or on finer and finer grids until the contact area meets its
!> target accuracy.
module dry_target
   use dry_case, only: dry_case_t
   use dry_errors, only: area_doubt, dry_trial_t, estimate_dry_errors, finer_nodes, unknown_doubt
   use dry_record, only: dry_record_t, dry_sweep_t
   use dry_scaling, only: dry_scaling_t, new_dry_scaling
   use dry_settings, only: dry_settings_t
   use dry_surfaces, only: is_refinable, refine_heights
   use dry_sweep, only: solve_dry_sweep
   use errors, only: error_t, input_error
   use iteration_report, only: phase_count, phase_error_bars, phase_steady
   use kinds, only: wp
   use signals, only: begin_activity
   use system_limits, only: memory_fault, thread_memory
   use text, only: add_sentence, to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_to_target

   !> Most nodes of a line and of an area that are chosen.
   integer, parameter :: max_chosen(2) = [2**20, 2**24]

contains

   !> Solves all loads of `dry` and estimates the errors of its quantities, if asked for. With a
   !> target of the contact area, the grid becomes the first one whose estimate meets it, or the
   !> finest allowed one, with a note. Times cover all grids. Errors as in `solve_dry_sweep` and
   !> `refine_heights`.
   subroutine solve_to_target(dry, record, error)
      type(dry_case_t), intent(inout) :: dry
      type(dry_record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      type(dry_trial_t), allocatable :: trials(:)
      real(wp) :: seconds(size(record%outcome%seconds)), phases(phase_count)
      integer :: most, nodes(2)

      allocate (trials(0))
      most = 0
      if (is_refinable(dry)) most = max_nodes(dry)
      seconds = 0.0_wp
      phases = 0.0_wp
      do
         call solve_grid(dry, record, error)
         ! On a coarse grid there may be no contact at that separation.
         if (allocated(error)) then
            if (.not. dry%target > 0.0_wp .or. error%kind /= input_error) return
         end if
         trials = [trials, dry_trial_t([dry%grid%nx, dry%grid%ny])]
         associate (trial => trials(size(trials)), report => record%outcome%solution%report)
            if (.not. allocated(error)) trial%doubt = area_doubt(record%outcome)
            seconds = seconds + record%outcome%seconds
            phases = phases + report%cost%phase_seconds
            record%outcome%seconds = seconds
            report%cost%phase_seconds = phases
            report%cost%wall_seconds = sum(phases)
            if (.not. dry%target > 0.0_wp .or. trial%doubt <= dry%target) return
         end associate
         nodes = finer_nodes(trials, dry%target, most)
         if (nodes(1) == 0) exit
         call refine_heights(dry, nodes, error)
         if (allocated(error)) return
      end do
      if (.not. allocated(error)) call note_unmet(dry, trials(size(trials))%doubt, most)
   end subroutine solve_to_target

   !> Solves the grid of `dry` and estimates errors, if asked for. Errors as in `solve_dry_sweep`.
   subroutine solve_grid(dry, record, error)
      type(dry_case_t), intent(in) :: dry
      type(dry_record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      type(dry_scaling_t) :: scaling
      type(dry_settings_t) :: settings
      real(wp) :: start

      start = wall_seconds()
      call begin_activity('solving')
      scaling = new_dry_scaling(dry%height, dry%lengths(1), dry%reduced_modulus)
      settings = dry%settings
      settings%keeps_pressures = dry%is_compared()
      call solve_dry_sweep(dry%grid, dry%height, scaling, dry%loads, settings, record%outcome, &
         error)
      if (allocated(error)) return
      associate (seconds => record%outcome%solution%report%cost%phase_seconds)
         seconds(phase_steady) = wall_seconds() - start
         if (dry%is_compared()) record%sweep = dry_sweep_t(dry%grid, dry%height, scaling, &
            dry%loads, settings)
         call begin_activity('error bars on other grids')
         if (dry%has_error_bars) call estimate_dry_errors(record, error)   ! error: handed up
         seconds(phase_error_bars) = wall_seconds() - start - seconds(phase_steady)
      end associate
   end subroutine solve_grid

   !> Most nodes that a grid for the target may have.
   integer function max_nodes(dry) result(most)
      type(dry_case_t), intent(in) :: dry
      real(wp), parameter :: smaller = 0.9_wp

      most = max_chosen(merge(1, 2, dry%grid%ny == 1))
      do while (memory_fault('a grid', dry%memory_on([most/min(2, dry%grid%ny), min(2, &
         dry%grid%ny)]), thread_memory(dry%grid%threads)) /= '')
         most = int(smaller*most)
         if (most <= dry%grid%nx) exit
      end do
   end function max_nodes

   !> Notes that the target is not met by an estimated error of `doubt`, and why (without a solution
   !> the reason is told elsewhere).
   subroutine note_unmet(dry, doubt, most)
      type(dry_case_t), intent(inout) :: dry
      real(wp), intent(in) :: doubt
      integer, intent(in) :: most
      character(:), allocatable :: reason

      if (doubt >= unknown_doubt) return
      reason = 'grids of more than '//to_text(most)//' nodes are not chosen'
      if (most < max_chosen(merge(1, 2, dry%grid%ny == 1))) reason = reason//' with this memory'
      if (most == 0) reason = 'without a period the heights of a file stay on their own nodes'
      call add_sentence(dry%note, 'the wanted accuracy is not met: of the contact area a '// &
         'relative error of '//to_text(doubt, 2)// &
         ' is estimated, '//to_text(dry%target, 2)//' was wanted, and '//reason)
   end subroutine note_unmet

end module dry_target

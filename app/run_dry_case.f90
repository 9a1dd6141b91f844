!> One dry case from its record to its result file and its exit status: solved on its grid, or on
!> finer and finer grids until the contact area meets its target accuracy.
module run_dry_case
   use adequacy, only: adequacy_t
   use case_notes, only: note_unusual
   use result_end, only: case_outcome_t, outcome_of
   use case_record, only: case_t, list_dry
   use dry_adequacy, only: measure_dry_adequacy
   use dry_case, only: dry_case_t, make_heights
   use dry_errors, only: area_doubt, dry_trial_t, estimate_dry_errors, finer_nodes, unknown_doubt
   use dry_record, only: dry_record_t, dry_sweep_t
   use dry_result, only: close_dry_case, write_dry_adequacy, write_dry_result
   use dry_problem, only: dry_scaling_t, new_dry_scaling
   use dry_sweep, only: solve_dry_sweep
   use errors, only: error_t, fail, input_error
   use iteration_report, only: phase_count, phase_error_bars, phase_steady
   use kinds, only: wp
   use progress_log, only: progress_log_t
   use result_file, only: open_result, result_file_t
   use signals, only: begin_activity
   use system_limits, only: memory_fault, processors, thread_memory
   use text, only: add_sentence, to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_and_write

   !> Most nodes of a line and of an area that are chosen.
   integer, parameter :: max_chosen(2) = [2**20, 2**24]

contains

   !> Solves all loads of `case`, writes its result `path`, and prints a line for each to the `log`;
   !> areas use `threads`. Error, without a result: the memory, the result, a load without solution.
   subroutine solve_and_write(case, path, log, threads, ending, error)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      type(progress_log_t), intent(inout) :: log
      integer, intent(in) :: threads
      type(case_outcome_t), intent(out) :: ending
      type(error_t), allocatable, intent(out) :: error
      type(result_file_t) :: result
      type(dry_record_t) :: record
      type(adequacy_t) :: adequacy
      character(:), allocatable :: words

      associate (grid => case%dry%grid)
         if (grid%ny > 1) grid%threads = min(threads, processors())
         words = memory_fault('a grid', case%dry%memory_on([grid%nx, grid%ny]), &
            thread_memory(grid%threads))
         if (words /= '' .and. grid%threads > 1) words = words//', with '//to_text(grid%threads) &
            //' threads'
      end associate
      if (words /= '') call fail(error, input_error, case%file//': '//words)
      if (.not. allocated(error)) call open_result(result, case, path, error)
      if (allocated(error)) return
      associate (outcome => record%outcome, report => record%outcome%solution%report)
         call solve_to_target(case%dry, record, error)
         if (.not. allocated(error) .and. case%dry%wants_adequacy) then
            call begin_activity('looking at the model')
            call measure_dry_adequacy(record, case%dry%target, case%dry%radius > 0.0_wp, adequacy)
            call move_alloc(record%error, error)   ! error: handed up
         end if
         if (allocated(error)) then
            call result%discard()
            return
         end if
         call note_unusual(case, words)
         if (allocated(case%dry%note)) call add_sentence(words, case%dry%note)
         if (allocated(words)) call move_alloc(words, report%note)
         call list_dry(case)
         call result%begin_end(case)
         call write_dry_result(result%file, case%dry, outcome)
         call write_dry_adequacy(result%file, adequacy)
         call result%publish(report, error)
         if (allocated(error)) return
         call close_dry_case(log, case%dry, outcome, adequacy, result%path)
         ending = outcome_of(report)
      end associate
   end subroutine solve_and_write

   !> Solves all loads of `dry` and estimates the errors of its quantities, if asked for. With a
   !> target of the contact area, the grid becomes the first one whose estimate meets it, or the
   !> finest allowed one, with a note. Times cover all grids. Errors as in `solve_dry_sweep`;
   !> findings of the surfaces.
   subroutine solve_to_target(dry, record, error)
      type(dry_case_t), intent(inout) :: dry
      type(dry_record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      type(dry_trial_t), allocatable :: trials(:)
      character(:), allocatable :: reason
      real(wp) :: seconds(size(record%outcome%seconds)), phases(phase_count)
      integer :: most, nodes(2)

      allocate (trials(0))
      most = max_nodes(dry)
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
         dry%grid%nx = nodes(1)
         dry%grid%ny = nodes(2)
         call make_heights(dry)
         if (dry%values%findings%count > 0) then
            call fail(error, input_error, dry%values%findings%report('finer grid'))
            return
         end if
      end do
      if (allocated(error)) return
      associate (doubt => trials(size(trials))%doubt)
         if (doubt >= unknown_doubt) return   ! without a solution the reason is told elsewhere
         reason = 'grids of more than '//to_text(most)//' nodes are not chosen'
         if (most < max_chosen(merge(1, 2, dry%grid%ny == 1))) reason = reason//' with this memory'
         if (most == 0) reason = 'without a period the heights of a file stay on their own nodes'
         call add_sentence(dry%note, 'the target accuracy is not met: of the contact area a '// &
            'relative error of '//to_text(doubt, 2)//' is estimated, '//to_text(dry%target, 2) &
            //' is the target, and '//reason)
      end associate
   end subroutine solve_to_target

   !> Solves the grid of `dry` and estimates errors, if asked for. Errors as in `solve_dry_sweep`.
   subroutine solve_grid(dry, record, error)
      type(dry_case_t), intent(in) :: dry
      type(dry_record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      type(dry_scaling_t) :: scaling
      real(wp) :: start

      start = wall_seconds()
      call begin_activity('solving')
      scaling = new_dry_scaling(dry%height, dry%lengths(1), dry%reduced_modulus)
      call solve_dry_sweep(dry%grid, dry%height, scaling, dry%loads, dry%settings, &
         record%outcome, error)
      if (allocated(error)) return
      associate (seconds => record%outcome%solution%report%cost%phase_seconds)
         seconds(phase_steady) = wall_seconds() - start
         if (dry%is_compared()) record%sweep = dry_sweep_t(dry%grid, dry%height, scaling, &
            dry%loads, dry%settings)
         call begin_activity('error bars on other grids')
         if (dry%has_error_bars) call estimate_dry_errors(record)
         call move_alloc(record%error, error)   ! error: handed up
         seconds(phase_error_bars) = wall_seconds() - start - seconds(phase_steady)
      end associate
   end subroutine solve_grid

   !> Most nodes that a grid for the target may have; 0: heights of a file have no Fourier series.
   integer function max_nodes(dry) result(most)
      type(dry_case_t), intent(in) :: dry
      real(wp), parameter :: smaller = 0.9_wp

      most = 0
      if (.not. dry%is_periodic .and. (allocated(dry%files(1)%file) &
         .or. allocated(dry%files(2)%file))) return
      most = max_chosen(merge(1, 2, dry%grid%ny == 1))
      do while (memory_fault('a grid', dry%memory_on([most/min(2, dry%grid%ny), min(2, &
         dry%grid%ny)]), thread_memory(dry%grid%threads)) /= '')
         most = int(smaller*most)
         if (most <= dry%grid%nx) exit
      end do
   end function max_nodes

end module run_dry_case

!> One dry case from its record to its result file and its exit status.
module run_dry_case
   use, intrinsic :: iso_fortran_env, only: int64
   use case_outcome, only: give_up, status_converged, status_not_converged
   use case_record, only: case_t, result_path
   use dry_result, only: write_dry_result
   use dry_scaling, only: dry_scaling_t, new_dry_scaling
   use dry_solution, only: dry_solution_t
   use dry_sweep, only: dry_outcome_t, dry_row_t, solve_dry_sweep
   use errors, only: error_t
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use interruption, only: set_patience
   use iteration_report, only: phase_steady
   use kinds, only: wp
   use progress_log, only: new_progress_log, progress_log_t
   use quantity_text, only: wrapped
   use result_writer, only: open_result, result_writer_t
   use system_limits, only: processors
   use text, only: to_text
   use wall_clock, only: wall_seconds
   implicit none (type, external)
   private

   public :: solve_and_write

   !> Columns of a terminal that a note takes.
   integer, parameter :: columns = 80

contains

   !> Solves all loads of `case`, writes its result to the folder `output_dir` (empty: where the case says), tells a line a
   !> load unless `is_quiet`; areas are shared by `threads`.
   subroutine solve_and_write(case, output_dir, is_quiet, threads, status)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: output_dir
      logical, intent(in) :: is_quiet
      integer, intent(in) :: threads
      integer, intent(out) :: status
      type(result_writer_t) :: writer
      type(progress_log_t) :: log
      type(dry_scaling_t) :: scaling
      type(dry_outcome_t) :: outcome
      type(error_t), allocatable :: error
      real(wp) :: start

      log = new_progress_log(is_quiet)
      call open_result(writer, result_path(case, output_dir), error)
      if (allocated(error)) then
         call give_up(error, log, status)
         return
      end if
      call writer%describe(trim(case%problem), case%title, case%namelist)
      start = wall_seconds()
      associate (dry => case%dry)
         scaling = new_dry_scaling(dry%height, dry%lengths(1), dry%reduced_modulus)
         if (dry%grid%ny > 1) dry%grid%threads = min(threads, processors())
         call solve_dry_sweep(dry%grid, dry%height, scaling, dry%loads, dry%settings, outcome, error)
      end associate
      if (allocated(error)) then
         call writer%discard()
         call give_up(error, log, status)
         return
      end if
      outcome%solution%report%wall_seconds = wall_seconds() - start
      outcome%solution%report%phase_seconds(phase_steady) = outcome%solution%report%wall_seconds
      call judge_sweep(outcome%rows, outcome%solution)
      if (allocated(case%dry%note)) outcome%solution%report%note = case%dry%note
      writer%inputs = case%effective
      call set_patience(.true.)
      call write_dry_result(writer%file, case%dry, outcome%rows, outcome%fields, error)
      if (allocated(error)) then
         call writer%discard()
         call give_up(error, log, status)
         return
      end if
      call write_costs(writer%file, outcome)
      call writer%publish(outcome%solution%report, error)
      if (allocated(error)) then
         call give_up(error, log, status)
         return
      end if
      call tell(log, case%file(index(case%file, '/', back=.true.) + 1:), outcome%rows, outcome%solution, writer%path)
      status = merge(status_converged, status_not_converged, outcome%solution%report%converged)
   end subroutine solve_and_write

   !> What the solution took: /report/cpu_..., /report/transforms.
   subroutine write_costs(file, outcome)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_outcome_t), intent(in) :: outcome

      call write_dataset(file, '/report/cpu_seconds', outcome%cpu_prepare + outcome%cpu_solve, &
         new_label('processor time of the solution, planning of the transforms included', 's'))
      call write_dataset(file, '/report/cpu_prepare_seconds', outcome%cpu_prepare, new_label('the part for planning', 's'))
      call write_dataset(file, '/report/wall_solve_seconds', outcome%wall_solve, &
         new_label('wall time of the solution without planning', 's'))
      call write_dataset(file, '/report/transforms', real(outcome%transforms, wp), &
         new_label('transforms: size in x, in y, pairs in double, pairs in single precision', '1'))
   end subroutine write_costs

   !> The report of the last load speaks for all: one that has not converged is enough; transforms and iterations add up.
   subroutine judge_sweep(rows, solution)
      type(dry_row_t), intent(in) :: rows(:)
      type(dry_solution_t), intent(inout) :: solution
      integer :: i

      solution%report%fft_pairs = sum(int(rows%fft_pairs, int64))
      solution%report%cycles = sum(rows%cycles)
      do i = 1, size(rows)
         if (rows(i)%is_converged) cycle
         solution%report%converged = .false.
         solution%report%reason = rows(i)%reason // ' at a mean pressure of ' // to_text(rows(i)%mean_pressure) // ' Pa'
      end do
   end subroutine judge_sweep

   !> A table with a line for each load.
   subroutine tell(log, name, rows, solution, path)
      type(progress_log_t), intent(inout) :: log
      character(*), intent(in) :: name, path
      type(dry_row_t), intent(in) :: rows(:)
      type(dry_solution_t), intent(in) :: solution
      character(len=80) :: line
      integer :: i

      if (solution%report%converged) then
         call log%say(name // ': converged, ' // to_text(solution%report%cycles) // ' iterations, ' &
            // to_text(solution%report%wall_seconds, 3) // ' s')
      else
         call log%say_error(name // ': NOT CONVERGED: ' // solution%report%reason)
      end if
      call log%say('  mean pressure   contact   plastic   separation   largest p      error')
      do i = 1, size(rows)
         associate (row => rows(i))
            write (line, '(ss,2x,es10.3,a,2(f8.3,a),es11.3,a,es10.3,a,es9.1)') row%mean_pressure, ' Pa', &
               100.0_wp*row%contact_area_fraction, ' %', 100.0_wp*row%plastic_area_fraction, ' %', row%mean_separation, ' m', &
               row%p_max, ' Pa', row%kkt
         end associate
         call log%say(trim(line))
      end do
      if (allocated(solution%report%note)) call log%say('  ' // wrapped('note      ' // solution%report%note, columns - 2))
      call log%say('  result    ' // path)
   end subroutine tell

end module run_dry_case

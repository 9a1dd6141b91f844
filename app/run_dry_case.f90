!> One dry case from its record to its result file and its exit status.
module run_dry_case
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: int64
   use case_effective, only: list_dry
   use case_notes, only: note_unusual
   use case_outcome, only: case_outcome_t, give_up, outcome_of
   use case_record, only: case_t
   use dry_adequacy, only: measure_dry_adequacy
   use dry_adequacy_section, only: write_dry_adequacy
   use dry_case, only: dry_case_t
   use dry_influences, only: dry_adequacy_t
   use dry_resampling, only: dry_sweep_t
   use dry_result, only: write_dry_result
   use dry_solution, only: dry_solution_t
   use dry_sweep, only: dry_outcome_t, dry_row_t
   use dry_target, only: solve_to_target
   use errors, only: error_t, fail, input_error
   use hdf5_axes, only: make_counter, name_axes
   use hdf5_dataset, only: new_label, write_dataset
   use hdf5_file, only: hdf5_file_t
   use key_row, only: dry_area
   use influence_section, only: model_line
   use kinds, only: wp
   use progress_log, only: progress_log_t
   use quantity_text, only: number_text, wrapped
   use result_file, only: open_result, result_file_t
   use signals, only: begin_activity
   use surface_keys, only: has_shape, surfaces
   use system_limits, only: memory_fault, processors, thread_memory
   use text, only: add_sentence, counted, to_text
   implicit none (type, external)
   private

   public :: solve_and_write

   !> Columns of a terminal that a note takes.
   integer, parameter :: columns = 80
   !> A relative error below this is printed as none.
   real(wp), parameter :: rounding = 1.0e-7_wp

contains

   !> Solves all loads of `case`, writes its result `path`, tells the `log` a line for each load;
   !> areas use `threads` threads.
   subroutine solve_and_write(case, path, log, threads, ending)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: path
      type(progress_log_t), intent(inout) :: log
      integer, intent(in) :: threads
      type(case_outcome_t), intent(out) :: ending
      type(result_file_t) :: result
      type(dry_outcome_t) :: outcome
      type(dry_row_t), allocatable :: errors(:)
      type(dry_adequacy_t) :: adequacy
      type(error_t), allocatable :: error
      character(:), allocatable :: model, name, words

      if (case%problem == dry_area) case%dry%grid%threads = min(threads, processors())
      call check_memory(case, error)
      if (.not. allocated(error)) call open_result(result, path, error)
      if (allocated(error)) then
         call give_up(error, log, ending)
         return
      end if
      call result%describe(trim(case%problem), case%title, case%namelist)
      call solve_to_target(case%dry, outcome, errors, error)
      if (.not. allocated(error)) call look_at_model(case%dry, outcome, errors, adequacy, error)
      if (allocated(error)) then
         call result%discard()
         call give_up(error, log, ending)
         return
      end if
      call judge_sweep(outcome%rows, outcome%solution)
      call note_unusual(case, words)
      if (allocated(case%dry%note)) call add_sentence(words, case%dry%note)
      if (allocated(words)) call move_alloc(words, outcome%solution%report%note)
      call list_dry(case)
      result%inputs = case%effective
      call result%begin_end()
      call write_dry_result(result%file, case%dry, outcome, errors, error)
      if (allocated(error)) then
         call result%discard()
         call give_up(error, log, ending)
         return
      end if
      call write_dry_adequacy(result%file, adequacy)
      call write_costs(result%file, outcome)
      call result%publish(outcome%solution%report, error)
      if (allocated(error)) then
         call give_up(error, log, ending)
         return
      end if
      name = case%file(index(case%file, '/', back=.true.) + 1:)
      if (case%dry%target > 0.0_wp) call log%say(name // ': solved on ' // nodes_text(case%dry) &
         // ' nodes for an error of ' &
         // number_text(100.0_wp*case%dry%target, 2) // ' % of the contact area')
      model = ''
      if (allocated(adequacy%rows)) model = model_line(adequacy%rows%judged_t, adequacy%accuracy)
      call tell(log, name, outcome%rows, errors, outcome%solution, result%name%path, model)
      ending = outcome_of(outcome%solution%report)
   end subroutine solve_and_write

   !> Measures the `adequacy` of `dry` with its `outcome` and the estimated `errors` of that, if it
   !> is wanted. Fails (internal_error) if FFTW does.
   subroutine look_at_model(dry, outcome, errors, adequacy, error)
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      type(dry_row_t), intent(in) :: errors(:)
      type(dry_adequacy_t), intent(out) :: adequacy
      type(error_t), allocatable, intent(out) :: error

      if (.not. dry%wants_adequacy) return
      call begin_activity('looking at the model')
      call measure_dry_adequacy(dry_sweep_t(dry%grid, dry%height, outcome%scaling, dry%loads, &
         dry%settings), outcome, errors, dry%target, any(has_shape(dry%values, surfaces, &
         'parabola')), adequacy, error)
   end subroutine look_at_model

   !> Error (input_error): there is not enough memory for the grid and the threads.
   subroutine check_memory(case, error)
      type(case_t), intent(in) :: case
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault

      associate (grid => case%dry%grid)
         fault = memory_fault('a grid', case%dry%memory_on([grid%nx, grid%ny]), &
            thread_memory(grid%threads))
         if (fault /= '' .and. grid%threads > 1) fault = fault//', with '//to_text(grid%threads) &
            //' threads'
      end associate
      if (fault /= '') call fail(error, input_error, case%file//': '//fault)
   end subroutine check_memory

   !> The number of nodes, of an area nx x ny.
   pure function nodes_text(dry) result(words)
      type(dry_case_t), intent(in) :: dry
      character(:), allocatable :: words

      words = to_text(dry%grid%nx)
      if (dry%grid%ny > 1) words = words // ' x ' // to_text(dry%grid%ny)
   end function nodes_text

   !> What the solution took: /report/cpu_..., /report/transforms.
   subroutine write_costs(file, outcome)
      class(hdf5_file_t), intent(inout) :: file
      type(dry_outcome_t), intent(in) :: outcome

      call write_dataset(file, '/report/cpu_seconds', outcome%cpu_prepare + outcome%cpu_solve, &
         new_label('processor time of the solution, planning of the transforms included', 's'))
      call write_dataset(file, '/report/cpu_prepare_seconds', outcome%cpu_prepare, &
         new_label('the part for planning', 's'))
      call write_dataset(file, '/report/wall_solve_seconds', outcome%wall_solve, &
         new_label('wall time of the solution without planning', 's'))
      call write_dataset(file, '/report/transforms', real(outcome%transforms, wp), &
         new_label('transforms: size in x, in y, pairs in double, pairs in single precision', '1'))
      call make_counter(file, '/report/grid', size(outcome%transforms, 2), &
         'number of the grid of the transforms')
      call make_counter(file, '/report/transform_column', size(outcome%transforms, 1), &
         'number of: size in x, in y, pairs in double, pairs in single precision')
      call name_axes(file, '/report/transforms', '/report/transform_column', '/report/grid')
   end subroutine write_costs

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

   !> A table with a line for each load, under it the estimated errors; what there is to say of the
   !> `model`.
   subroutine tell(log, name, rows, errors, solution, path, model)
      type(progress_log_t), intent(inout) :: log
      character(*), intent(in) :: name, path, model
      type(dry_row_t), intent(in) :: rows(:), errors(:)
      type(dry_solution_t), intent(in) :: solution
      character(len=80) :: line
      integer :: i

      if (solution%report%converged) then
         call log%add_to_summary(name // ': converged, ' &
            // counted(solution%report%cycles, 'iteration') // ', ' &
            // to_text(solution%report%wall_seconds, 3) // ' s')
      else
         if (log%tells_apart()) call log%say_error(name // ': NOT CONVERGED: ' &
            // solution%report%reason)
         call log%add_to_summary(name // ': NOT CONVERGED: ' // solution%report%reason)
      end if
      call log%add_to_summary( &
         '  mean pressure   contact   plastic   separation   largest p      error')
      do i = 1, size(rows)
         associate (row => rows(i))
            write (line, '(ss,2x,es10.3,a,2(f8.3,a),es11.3,a,es10.3,a,es9.1)') row%mean_pressure, &
               ' Pa', &
               100.0_wp*row%contact_area_fraction, ' %', 100.0_wp*row%plastic_area_fraction, &
                  ' %', row%mean_separation, ' m', &
               row%p_max, ' Pa', row%kkt
         end associate
         call log%add_to_summary(trim(line))
         if (size(errors) > 0) call log%add_to_summary(error_line(rows(i), errors(i)))
      end do
      if (model /= '') call log%add_to_summary('  ' // wrapped(model, columns - 2, 12))
      if (allocated(solution%report%note)) call log%add_to_summary('  ' // wrapped('note      ' &
         // solution%report%note, columns - 2))
      call log%add_to_summary('  result    ' // path)
      call log%print_summary()
   end subroutine tell

   !> The line of estimated errors under that of a load, in percent of its quantities.
   function error_line(row, error) result(line)
      type(dry_row_t), intent(in) :: row, error
      character(:), allocatable :: line
      character(len=80) :: cells

      write (cells, '(a15,2a10,2a13)') '+-', percent(error%contact_area_fraction, &
         row%contact_area_fraction), &
         percent(error%plastic_area_fraction, row%plastic_area_fraction), &
            percent(error%mean_separation, row%mean_separation), &
         percent(error%p_max, row%p_max)
      line = trim(cells)
   end function error_line

   !> `error` in percent of `value`, right-justified as in the line above it; '-' if it is not
   !> known.
   function percent(error, value) result(cell)
      real(wp), intent(in) :: error, value
      character(:), allocatable :: cell

      cell = '-'
      if (.not. (ieee_is_finite(error) .and. abs(value) > 0.0_wp)) return
      cell = '0 %'
      if (error > rounding*abs(value)) cell = number_text(100.0_wp*error/abs(value), 2)//' %'
   end function percent

end module run_dry_case

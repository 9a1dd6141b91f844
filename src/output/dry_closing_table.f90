!> The closing table of a dry case, on standard output.
module dry_closing_table
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_case, only: dry_case_t
   use dry_influences, only: dry_adequacy_t
   use dry_sweep, only: dry_outcome_t, dry_row_t
   use adequacy_section, only: model_line
   use kinds, only: wp
   use progress_log, only: columns, progress_log_t
   use quantity_text, only: number_text, wrapped
   use text, only: counted, to_text
   implicit none (type, external)
   private

   public :: close_dry_case

   !> A relative error below this is printed as none.
   real(wp), parameter :: rounding = 1.0e-7_wp

contains

   !> A table with a line for each load of the case `name`, under it the estimated errors; what
   !> there is to say of the model; `path` of the result.
   subroutine close_dry_case(log, name, dry, outcome, errors, adequacy, path)
      type(progress_log_t), intent(inout) :: log
      character(*), intent(in) :: name, path
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      type(dry_row_t), intent(in) :: errors(:)
      type(dry_adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: words
      character(len=columns) :: line
      integer :: i

      if (dry%target > 0.0_wp) call log%say(name // ': solved on ' // nodes_text(dry) &
         // ' nodes for an error of ' // number_text(100.0_wp*dry%target, 2) &
         // ' % of the contact area')
      associate (rows => outcome%rows, solution => outcome%solution)
         if (solution%report%converged) then
            call log%add_to_summary(name // ': converged, ' &
               // counted(solution%report%cycles, 'iteration') // ', ' &
               // to_text(solution%report%wall_seconds, 3) // ' s')
         else
            if (log%prints_errors_apart()) call log%say_error(name // ': NOT CONVERGED: ' &
               // solution%report%reason)
            call log%add_to_summary(name // ': NOT CONVERGED: ' // solution%report%reason)
         end if
         call log%add_to_summary( &
            '  mean pressure   contact   plastic   separation   largest p      error')
         do i = 1, size(rows)
            associate (row => rows(i))
               write (line, '(ss,2x,es10.3,a,2(f8.3,a),es11.3,a,es10.3,a,es9.1)') &
                  row%mean_pressure, ' Pa', 100.0_wp*row%contact_area_fraction, ' %', &
                  100.0_wp*row%plastic_area_fraction, ' %', row%mean_separation, ' m', &
                  row%p_max, ' Pa', row%kkt
            end associate
            call log%add_to_summary(trim(line))
            if (size(errors) > 0) call log%add_to_summary(error_line(rows(i), errors(i)))
         end do
         if (allocated(adequacy%rows)) then
            words = model_line(adequacy%rows%judged_t, adequacy%accuracy)
            if (words /= '') call log%add_to_summary('  ' // wrapped(words, columns - 2, 12))
         end if
         if (allocated(solution%report%note)) call log%add_to_summary('  ' // wrapped('note      ' &
            // solution%report%note, columns - 2))
         call log%add_to_summary('  result    ' // path)
         call log%print_summary()
      end associate
   end subroutine close_dry_case

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

   !> The number of nodes, of an area nx x ny.
   pure function nodes_text(dry) result(words)
      type(dry_case_t), intent(in) :: dry
      character(:), allocatable :: words

      words = to_text(dry%grid%nx)
      if (dry%grid%ny > 1) words = words // ' x ' // to_text(dry%grid%ny)
   end function nodes_text

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

end module dry_closing_table

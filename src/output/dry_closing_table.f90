!> The closing table of a dry case, on standard output.
module dry_closing_table
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_case, only: dry_case_t
   use dry_adequacy, only: dry_adequacy_t
   use dry_quantities, only: contact_area, dry_outcome_t, mean_pressure, mean_separation, p_max, &
      plastic_area
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
   !> Quantities with an error in the table.
   integer, parameter :: columns_with_error(*) = [contact_area, plastic_area, &
      mean_separation, p_max]

contains

   !> A table with a line for each load of the case `name`, under it the estimated errors; what
   !> there is to say of the model; `path` of the result.
   subroutine close_dry_case(log, name, dry, outcome, adequacy, path)
      type(progress_log_t), intent(inout) :: log
      character(*), intent(in) :: name, path
      type(dry_case_t), intent(in) :: dry
      type(dry_outcome_t), intent(in) :: outcome
      type(dry_adequacy_t), intent(in) :: adequacy
      character(:), allocatable :: words
      character(len=columns) :: line
      integer :: i

      words = to_text(dry%grid%nx)
      if (dry%grid%ny > 1) words = words // ' x ' // to_text(dry%grid%ny)
      if (dry%target > 0.0_wp) call log%say(name // ': solved on ' // words // ' nodes for an '// &
         'error of ' // number_text(100.0_wp*dry%target, 2) // ' % of the contact area')
      associate (rows => outcome%rows, solution => outcome%solution)
         if (solution%report%converged) then
            call log%add_to_summary(name // ': converged, ' // counted(solution%report%cycles, &
               'iteration') // ', ' // to_text(solution%report%cost%wall_seconds, 3) // ' s')
         else
            if (log%prints_errors_apart()) call log%say_error(name // ': NOT CONVERGED: ' &
               // solution%report%reason)
            call log%add_to_summary(name // ': NOT CONVERGED: ' // solution%report%reason)
         end if
         call log%add_to_summary( &
            '  mean pressure   contact   plastic   separation   largest p      error')
         do i = 1, size(rows)
            associate (values => rows(i)%values)
               write (line, '(ss,2x,es10.3,a,2(f8.3,a),es11.3,a,es10.3,a,es9.1)') &
                  values(mean_pressure), ' Pa', 100.0_wp*values(contact_area), ' %', &
                  100.0_wp*values(plastic_area), ' %', values(mean_separation), ' m', &
                  values(p_max), ' Pa', rows(i)%kkt
               call log%add_to_summary(trim(line))
               if (.not. allocated(outcome%errors)) cycle
               write (line, '(a15,2a10,2a13)') '+-', percent(outcome%errors(:, i), values)
               call log%add_to_summary(trim(line))
            end associate
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

   !> Errors in percent of the values of a load, as cells of the closing table; '-' if not known.
   pure function percent(errors, values) result(cells)
      real(wp), intent(in) :: errors(:), values(:)
      character(len=10) :: cells(size(columns_with_error))
      integer :: i

      do i = 1, size(cells)
         associate (error => errors(columns_with_error(i)), &
            value => abs(values(columns_with_error(i))))
            cells(i) = '-'
            if (.not. (ieee_is_finite(error) .and. value > 0.0_wp)) cycle
            cells(i) = '0 %'
            if (error > rounding*value) cells(i) = number_text(100.0_wp*error/value, 2)//' %'
         end associate
      end do
      cells = adjustr(cells)
   end function percent

end module dry_closing_table

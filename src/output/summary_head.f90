!> `--summary`: the columns of a table of cases, and which cases have their row in it already.
module summary_head
   use adequacy_section, only: write_validity
   use build_info, only: git_commit, program_version
   use case_record, only: case_t, effective_text
   use dry_problem, only: kernel_element
   use dry_quantities, only: dry_count, dry_outcome_t, mean_pressure
   use dry_result, only: write_dry_result
   use errors, only: error_t, fail, input_error
   use file_bytes, only: checksum_t
   use hdf5_dataset, only: write_attribute
   use hdf5_file, only: hdf5_file_t
   use input_keys, only: key_rows
   use iteration_report, only: breakdown_t, report_t
   use key_row, only: has_word, lubricated, point
   use kinds, only: wp
   use line_summary, only: line_summary_t
   use result_sections, only: write_breakdown, write_mean_power, write_report, write_scaling, &
      write_summary
   use scaling, only: scaling_t
   use summary_row, only: csv_cell, new_row, set_columns, summary_row_t
   use text_file, only: open_lines, text_lines_t
   use validity, only: limit_t
   use validity_table, only: limit_count
   implicit none (type, external)
   private

   public :: plan_rows

contains

   !> Cases of one kind have the same columns: one problem, in SI or by Moes' numbers.
   pure function kind_of(case) result(kind)
      type(case_t), intent(in) :: case
      character(:), allocatable :: kind

      kind = trim(case%problem)
      if (case%scaling%is_dimensional) kind = kind//' in SI'
   end function kind_of

   !> Checksum of the namelist, and of what it names: heights, tables over time.
   pure function identity_of(case) result(digits)
      type(case_t), intent(in) :: case
      character(:), allocatable :: digits, files
      integer :: i

      digits = digits_of(case%namelist)
      files = ''
      do i = 1, size(case%effective)
         associate (entry => case%effective(i))
            if (index(entry%key, 'heights_') == 1 .or. entry%key == 'table_checksum') files = &
               files//effective_text(entry)//' '
         end associate
      end do
      if (files /= '') digits = digits//'-'//digits_of(files)
   end function identity_of

   !> Checksum of a text, filled up with zeros to a multiple of 8 bytes.
   pure function digits_of(text) result(digits)
      character(*), intent(in) :: text
      character(len=16) :: digits
      type(checksum_t) :: sums

      call sums%add(transfer(text//repeat(achar(0), modulo(-len(text), 8)), [0.0_wp]))
      digits = sums%digits()
   end function digits_of

   !> All columns that cases of this kind may have: what is written where everything is known.
   function head_of(case) result(row)
      type(case_t), intent(in) :: case
      type(summary_row_t) :: row
      type(hdf5_file_t) :: file
      type(report_t) :: report
      character(len=*), parameter :: first(*) = [character(len=7) :: 'case', 'input', 'program', &
         'outcome', 'reason']
      integer :: i

      allocate (file%row)
      file%row%is_head = .true.
      do i = 1, size(first)
         call file%row%set(trim(first(i)), '', '')
      end do
      if (case%problem == lubricated .or. case%problem == point) then
         call name_film_columns(file, case)
      else
         call name_dry_columns(file, case)
      end if
      call report%add(1.0_wp, 1.0_wp)
      report%note = ''
      report%fit%nodes_per_wave = 1.0_wp
      report%fit%steps_per_wave = 1.0_wp
      report%cost%peak_memory = 1.0_wp
      call write_report(file, report)
      do i = 1, size(key_rows)
         associate (key => key_rows(i))
            if (has_word(key%problems, trim(case%problem))) call file%row%set(trim(key%group) &
               //'.'//trim(key%key), trim(merge('1           ', key%unit, key%unit == '-')), '')
         end associate
      end do
      row = file%row
   end function head_of

   !> Columns of lubricated contacts.
   subroutine name_film_columns(file, case)
      type(hdf5_file_t), intent(inout) :: file
      type(case_t), intent(in) :: case
      type(line_summary_t) :: summary
      type(scaling_t) :: scaling
      type(limit_t) :: limits(limit_count)
      type(breakdown_t) :: breakdown

      scaling = case%scaling
      scaling%slide_to_roll = 1.0_wp
      scaling%hertz_pressure = 1.0_wp
      summary%of%value = 1.0_wp
      summary%of%time = 1.0_wp
      summary%of%extrapolated = 1.0_wp
      summary%of%error_estimate = 1.0_wp
      summary%of%error_grid = 1.0_wp
      call write_summary(file, summary, scaling, case%problem == lubricated, '', 1.0_wp)
      if (case%problem == lubricated) then
         call write_mean_power(file, summary, [line_summary_t ::], scaling, '')
         limits%value = 1.0_wp
         call write_validity(file, limits)
         breakdown%count = 1
         call write_breakdown(file, breakdown, scaling)
      end if
      call write_scaling(file, scaling)
      if (case%problem == point) call write_attribute(file, '/scaling', 'radius_ratio', 1.0_wp, '1')
   end subroutine name_film_columns

   !> Columns of dry contacts.
   subroutine name_dry_columns(file, case)
      type(hdf5_file_t), intent(inout) :: file
      type(case_t), intent(in) :: case
      type(case_t) :: whole
      type(dry_outcome_t) :: outcome
      type(error_t), allocatable :: error

      whole = case
      whole%dry%is_periodic = .true.
      whole%dry%grid%kernel = kernel_element
      whole%dry%loads%hardness = 1.0_wp
      if (allocated(whole%dry%loads%mean_pressure)) deallocate (whole%dry%loads%mean_pressure)
      allocate (outcome%rows(1), outcome%transforms(4, 1))
      outcome%rows%values(mean_pressure) = 1.0_wp
      allocate (outcome%errors(dry_count, 1), source=1.0_wp)
      outcome%transforms = 1
      outcome%scaling%pressure = 1.0_wp
      call write_dry_result(file, whole%dry, outcome, error)   ! error: nothing is computed
   end subroutine name_dry_columns

   !> Makes the columns of the table of `cases`, and looks which have a row of the same input by
   !> this program already, the last of its name: they keep outcome and reason if `is_resume`.
   !> Errors (input_error): the table is another one, or the cases need several.
   subroutine plan_rows(cases, is_resume, error)
      type(case_t), intent(inout) :: cases(:)
      logical, intent(in) :: is_resume
      type(error_t), allocatable, intent(out) :: error
      type(summary_row_t), allocatable :: row
      type(text_lines_t) :: lines
      logical :: is_there
      integer :: i

      if (size(cases) == 0) return
      do i = 1, size(cases)
         cases(i)%table%name = csv_cell(cases(i)%file)//','
         cases(i)%table%cells = cases(i)%table%name//identity_of(cases(i))//',' &
            //csv_cell(program_version//' '//git_commit())//','
         if (kind_of(cases(i)) == kind_of(cases(1))) cycle
         call fail(error, input_error, cases(i)%file//': found another problem than that of ' &
            //cases(1)%file//" (or one by Moes' numbers), expected one kind of cases for " &
            //cases(1)%table%path)
         return
      end do
      call set_columns(head_of(cases(1)))
      call new_row(row, cases(1)%table)
      inquire (file=row%path, exist=is_there)
      if (.not. is_there) return
      call open_lines(lines, row%path, error)
      if (.not. allocated(error)) call lines%next(is_there, error)
      if (allocated(error)) return
      if (is_there .and. index(row%first_line, lines%line(:lines%length)) /= 1) call fail(error, &
         input_error, row%path//': found another first line than that of this table, expected '// &
         'a new name: it is another file, or of another problem or version')
      do while (is_there .and. is_resume .and. .not. allocated(error))
         call lines%next(is_there, error)
         if (allocated(error)) exit
         ! the last line may be one that a killed process has left
         if (lines%place + lines%length <= lines%bytes) call keep_row(cases, &
            lines%line(:lines%length))
      end do
      call lines%close()
   end subroutine plan_rows

   !> Keeps what a `line` of the table says of the cases of its name.
   subroutine keep_row(cases, line)
      type(case_t), intent(inout) :: cases(:)
      character(*), intent(in) :: line
      integer :: k, first, last

      do k = 1, size(cases)
         associate (place => cases(k)%table)
            if (.not. begins(place%name)) cycle
            if (allocated(place%outcome)) deallocate (place%outcome)
            if (.not. begins(place%cells)) cycle
            first = len(place%cells) + 1
            last = first + index(line(first:), ',') - 2
            place%outcome = line(first:last)
            first = last + 2
            if (line(first:first) == '"') then
               first = first + 1
               last = first + index(line(first:), '",') - 2
            else
               last = first + index(line(first:), ',') - 2
            end if
            place%reason = line(first:last)
         end associate
      end do

   contains

      !> Whether the line begins so.
      pure logical function begins(cells)
         character(*), intent(in) :: cells

         begins = line(:min(len(cells), len(line))) == cells
      end function begins

   end subroutine keep_row

end module summary_head

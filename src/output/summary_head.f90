!> `--summary`: the columns of a table of cases, and which cases have their row in it already.
module summary_head
   use adequacy_section, only: write_validity
   use build_info, only: git_commit, program_version
   use case_record, only: case_identity, case_t
   use dry_case, only: dry_case_t
   use dry_problem, only: kernel_element
   use dry_quantities, only: dry_outcome_t, mean_pressure
   use dry_result, only: write_dry_result
   use errors, only: error_t, fail, input_error
   use file_bytes, only: checksum_t
   use hdf5_dataset, only: write_attribute
   use input_keys, only: key_rows
   use iteration_report, only: report_t
   use key_row, only: film, has_word, point
   use kinds, only: wp
   use line_summary, only: line_summary_t, quantity_t
   use result_labels, only: section_file_t
   use result_sections, only: write_breakdown, write_mean_power, write_report, write_scaling, &
      write_summary
   use summary_row, only: csv_cell, empty_row
   use text_file, only: open_lines, text_lines_t
   use validity, only: limit_count, limit_t
   implicit none (type, external)
   private

   public :: plan_rows

contains

   !> Makes the columns of the table of `cases`, and looks which have a row of the same input by
   !> this program already, the last of its name: they keep outcome and reason if `is_resume`.
   !> Errors (input_error): the table is another one, or the cases need several.
   subroutine plan_rows(cases, is_resume, error)
      type(case_t), intent(inout) :: cases(:)
      logical, intent(in) :: is_resume
      type(error_t), allocatable, intent(out) :: error
      type(text_lines_t) :: lines
      logical :: is_there
      integer :: i

      if (size(cases) == 0) return
      do i = 1, size(cases)
         associate (case => cases(i), first => cases(1))
            case%table%name = csv_cell(case%file)//','
            case%table%cells = case%table%name//digits_of(case%namelist)//'-' &
               //digits_of(case_identity(case))//','//csv_cell(program_version//' ' &
               //git_commit())//','
            if (case%problem == first%problem .and. (case%scaling%is_dimensional .eqv. &
               first%scaling%is_dimensional)) cycle
            call fail(error, input_error, case%file//': found another problem than that of ' &
               //first%file//" (or one by Moes' numbers), expected one kind of cases for " &
               //first%table%path)
            return
         end associate
      end do
      call make_columns(cases(1))
      inquire (file=cases(1)%table%path, exist=is_there)
      if (.not. is_there) return
      call open_lines(lines, cases(1)%table%path, error)
      if (.not. allocated(error)) call lines%next(is_there, error)
      if (allocated(error)) return
      if (is_there .and. index(empty_row%first_line, lines%line(:lines%length)) /= 1) call fail( &
         error, input_error, lines%file//': found another first line than that of this table, '// &
         'expected a new name: it is another file, or of another problem or version')
      do while (is_there .and. is_resume .and. .not. allocated(error))
         call lines%next(is_there, error)
         if (allocated(error)) exit
         ! the last line may be one that a killed process has left
         if (lines%place + lines%length <= lines%bytes) call keep_row(cases, &
            lines%line(:lines%length))
      end do
      call lines%close()
   end subroutine plan_rows

   !> Checksum of a text, filled up with zeros to a multiple of 8 bytes.
   pure function digits_of(text) result(digits)
      character(*), intent(in) :: text
      character(len=16) :: digits
      type(checksum_t) :: sums

      call sums%add(transfer(text//repeat(achar(0), modulo(-len(text), 8)), [0.0_wp]))
      digits = sums%digits()
   end function digits_of

   !> Keeps what a `line` of the table says of the cases of its name.
   subroutine keep_row(cases, line)
      type(case_t), intent(inout) :: cases(:)
      character(*), intent(in) :: line
      character(:), allocatable :: rest
      integer :: i

      do i = 1, size(cases)
         associate (place => cases(i)%table)
            if (line(:min(len(place%name), len(line))) /= place%name) cycle
            if (allocated(place%outcome)) deallocate (place%outcome)
            if (line(:min(len(place%cells), len(line))) /= place%cells) cycle
            rest = line(len(place%cells) + 1:)
            place%outcome = rest(:index(rest, ',') - 1)
            rest = rest(index(rest, ',') + 1:)
            place%reason = rest(:index(rest, ',') - 1)
            if (rest(:1) == '"') place%reason = rest(2:index(rest, '",') - 1)
         end associate
      end do
   end subroutine keep_row

   !> All columns that cases of this kind may have: what is written where everything is known.
   subroutine make_columns(case)
      type(case_t), intent(in) :: case
      type(section_file_t) :: file
      type(line_summary_t) :: summary
      type(limit_t) :: limits(limit_count)
      type(report_t) :: report
      type(dry_case_t) :: dry
      type(dry_outcome_t) :: outcome
      integer :: i

      allocate (file%row)
      allocate (file%row%columns(0))
      file%row%first_line = 'case,input,program'
      call file%row%set('outcome', '', '')
      call file%row%set('reason', '', '')
      if (has_word(film, trim(case%problem))) then
         file%scaling = case%scaling
         file%scaling%slide_to_roll = 1.0_wp
         file%scaling%hertz_pressure = 1.0_wp
         summary%of = quantity_t(1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 1.0_wp)
         limits%value = 1.0_wp
         report%breakdown%count = 1
         call write_summary(file, summary, .true., '', 1.0_wp)
         call write_scaling(file)
         call write_validity(file, limits)
         call write_breakdown(file, report%breakdown)
         if (case%problem == point) then
            call write_attribute(file, '/scaling', 'radius_ratio', 1.0_wp, '1')
         else
            call write_mean_power(file, summary, [line_summary_t ::], '')
         end if
      else
         dry = case%dry
         dry%is_periodic = .true.
         dry%grid%kernel = kernel_element
         dry%loads%hardness = 1.0_wp
         if (allocated(dry%loads%mean_pressure)) deallocate (dry%loads%mean_pressure)
         allocate (outcome%rows(1), outcome%transforms(4, 1))
         outcome%rows%values(mean_pressure) = 1.0_wp
         outcome%scaling%pressure = 1.0_wp
         call write_dry_result(file, dry, outcome)
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
      empty_row = file%row
   end subroutine make_columns

end module summary_head

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
   use summary_row, only: csv_cell, summary_row_t
   use text_file, only: open_lines, text_lines_t
   use validity, only: limit_t
   use validity_table, only: limit_count
   implicit none (type, external)
   private

   public :: begin_row, find_rows

   !> The columns of the last case, made once for all cases of its kind.
   type(summary_row_t), allocatable :: columns

contains

   !> Begins the row of a case, before it is solved.
   subroutine begin_row(row, case)
      type(summary_row_t), allocatable, intent(out) :: row
      type(case_t), intent(in) :: case

      if (allocated(columns)) then
         if (columns%kind /= kind_of(case)) deallocate (columns)
      end if
      if (.not. allocated(columns)) columns = head_of(case)
      row = columns
      row%path = case%table
      call row%set('case', '', csv_cell(case%file), .false.)
      call row%set('input', '', identity_of(case), .false.)
      call row%set('program', '', program_text(), .false.)
   end subroutine begin_row

   !> Cases of one kind have the same columns: one problem, in SI or by Moes' numbers.
   pure function kind_of(case) result(kind)
      type(case_t), intent(in) :: case
      character(:), allocatable :: kind

      kind = trim(case%problem)
      if (case%scaling%is_dimensional) kind = kind//' in SI'
   end function kind_of

   !> Version and commit.
   function program_text() result(text)
      character(:), allocatable :: text

      text = program_version//' '//git_commit()
   end function program_text

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
      file%row%kind = kind_of(case)
      do i = 1, size(first)
         call file%row%set(trim(first(i)), '', '', .false.)
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
               //'.'//trim(key%key), trim(merge('1           ', key%unit, key%unit == '-')), '', &
               .false.)
         end associate
      end do
      call file%row%finish_head()
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

   !> Which `cases` have a row of the same input by this program in their table already, the last of
   !> its name: those keep its outcome and reason if `is_resume`. Errors (input_error): the table is
   !> another one, or the cases need several.
   subroutine find_rows(cases, is_resume, error)
      type(case_t), intent(inout) :: cases(:)
      logical, intent(in) :: is_resume
      type(error_t), allocatable, intent(out) :: error
      type(summary_row_t), allocatable :: row
      type(text_lines_t) :: lines
      logical :: is_there
      integer :: i

      if (size(cases) == 0) return
      call begin_row(row, cases(1))
      do i = 2, size(cases)
         if (kind_of(cases(i)) /= kind_of(cases(1))) call fail(error, input_error, cases(i)%file//': found another '// &
            'problem than that of '//cases(1)%file//' (or one by Moes'' numbers), expected '// &
            'one kind of cases for '//cases(1)%table)
         if (allocated(error)) return
      end do
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
         if (lines%place + lines%length <= lines%bytes) call compare(lines%line(:lines%length))
      end do
      call lines%close()

   contains

      !> Looks for the case of a line.
      subroutine compare(line)
         character(*), intent(in) :: line
         character(:), allocatable :: cell, rest, words
         integer :: k, comma

         do k = 1, size(cases)
            cell = csv_cell(cases(k)%file)//','
            if (line(:min(len(cell), len(line))) /= cell) cycle
            cell = cell//identity_of(cases(k))//','//csv_cell(program_text())//','
            if (allocated(cases(k)%earlier)) deallocate (cases(k)%earlier)
            if (line(:min(len(cell), len(line))) /= cell) cycle
            rest = line(len(cell) + 1:)
            comma = index(rest, ',')
            cases(k)%earlier = rest(:comma - 1)
            words = rest(comma + 1:)
            if (words(1:1) == '"') then
               words = words(2:index(words(2:)//'",', '",'))
            else
               words = words(:index(words, ',') - 1)
            end if
            cases(k)%earlier_reason = words
         end do
      end subroutine compare

   end subroutine find_rows

end module summary_head

!> `asperity table`: a row for each result file, with its quantities in SI and their estimated
!> errors, as text, CSV or a JSON object a line. A file that cannot be read, or is not what was
!> written, is a row with the reason; NAME.h5.part one with the times so far. Or the profiles of one
!> result as CSV.
module result_table
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use build_info, only: program_name
   use dry_quantities, only: contact_area, dry_table, mean_separation, plastic_area
   use errors, only: error_t, fail, input_error
   use file_bytes, only: no_seal, seal_fault
   use hdf5_input, only: hdf5_input_t, open_hdf5_input
   use iteration_report, only: ending_text, has_converged, has_not_converged
   use kinds, only: exceeds, not_known, wp
   use quantities, only: quantity_rows
   use read_cases, only: status_bad_input
   use result_labels, only: field_names
   use progress_log, only: print_text, write_text
   use summary_row, only: csv_cell
   use text, only: counted, number_text, prefixed_text
   use transient_store, only: read_progress
   use validity, only: limit_rows, stokes_number, surface_slope
   implicit none (type, external)
   private

   public :: print_results

   !> Quantities of /summary that can be a column, and their heads in the text, whose lines fit a
   !> terminal: empty where it has none.
   character(len=31), parameter :: names(*) = [character(len=31) :: quantity_rows%name, &
      'lambda_ratio', limit_rows(stokes_number)%name, limit_rows(surface_slope)%name, &
      dry_table(contact_area)%name, dry_table(plastic_area)%name, dry_table(mean_separation)%name]
   character(len=10), parameter :: heads(*) = [character(len=10) :: merge(quantity_rows%short, &
      '         ', quantity_rows%name /= 'p_central'), 'lambda', '', '', 'contact', '', &
      'separation']
   !> Arrays of /solution that can be a column of --profiles, x first, then those of dry contacts.
   character(len=29), parameter :: profiles(*) = [character(len=29) :: field_names, 'gap', &
      'height_undeformed', 'height_loaded', 'height_unloaded', 'plastic_deformation']
   !> Problems whose fields are not over x alone.
   character(len=9), parameter :: maps(*) = [character(len=9) :: 'dry_area', 'ehl_point']
   character(len=*), parameter :: nl = new_line('a')
   !> Widest cell of the text; the layout from which on every result has a seal.
   integer, parameter :: cell_width = 512, sealed_layout = 3

   !> What a file says.
   type :: result_row_t
      character(:), allocatable :: file
      !> False: only `reason` is known.
      logical :: is_read = .false.
      logical :: is_converged = .false.
      character(:), allocatable :: problem, outcome, reason
      !> In SI; not known where the file has none.
      real(wp) :: values(size(names)), errors(size(names))
      !> Units of the values; empty: the file has none.
      character(len=16) :: units(size(names))
   end type result_row_t

   !> A quantity of a CSV table, in one of its units.
   type :: column_t
      integer :: number
      character(len=16) :: units
   end type column_t

contains

   !> Prints the table of `files` (n) as 'text', 'csv' or 'json', or the 'profiles' of the first;
   !> files that cannot be read make `status` that of bad input. Error: standard output is lost.
   subroutine print_results(files, form, status, error)
      character(*), intent(in) :: files(:), form
      integer, intent(inout) :: status
      type(error_t), allocatable, intent(out) :: error
      type(result_row_t), allocatable :: rows(:)
      integer :: i

      if (form == 'profiles') then
         call print_profiles(trim(files(1)), error)   ! error: handed up
         return
      end if
      allocate (rows(size(files)))
      do i = 1, size(files)
         call read_row(trim(files(i)), rows(i))
         if (.not. rows(i)%is_read) status = status_bad_input
         if (form /= 'json') cycle   ! columns and their widths come from all rows
         call write_text(json_line(rows(i))//nl, error)   ! error: stays
      end do
      if (form == 'csv') call write_csv(rows, error)   ! error: stays
      if (form == 'text') call write_table(rows, error)   ! error: stays
      call print_text('', error)   ! error: handed up
   end subroutine print_results

   !> Prints the arrays of /solution over x in SI as CSV. Errors: no readable result, or an area
   !> (input_error); standard output is lost.
   subroutine print_profiles(file, error)
      character(*), intent(in) :: file
      type(error_t), allocatable, intent(out) :: error
      type(hdf5_input_t) :: reader
      type(result_row_t) :: row
      real(wp), allocatable :: values(:, :)
      character(:), allocatable :: head, path
      integer :: i, k, columns

      call read_row(file, row)
      if (row%is_read .and. row%problem == '') row%reason = 'the run has not ended'
      if (any(row%problem == maps)) row%reason = 'an area has maps, no profile: read them with '// &
         'h5py or, with &output xdmf = .true., ParaView'
      if (.not. row%is_read .or. row%problem == '' .or. any(row%problem == maps)) then
         call fail(error, input_error, file//': '//row%reason)
         return
      end if
      call open_hdf5_input(reader, file, error)   ! error: the reader keeps it
      head = ''
      columns = 0
      do k = 1, size(profiles)
         path = '/solution/'//trim(profiles(k))
         if (k > 1 .and. .not. reader%has(path)) cycle
         associate (column => reader%reals(path)*reader%real_value(path, 'si_scale', 1.0_wp))
            if (allocated(reader%failure)) exit
            if (k == 1) allocate (values(size(column), size(profiles)))
            columns = columns + 1
            values(:, columns) = column
         end associate
         head = head//','//trim(profiles(k))//' ['//reader%text(path, 'si_units')//']'
      end do
      call reader%close(error)
      if (allocated(error)) return
      call write_text(head(2:)//nl, error)   ! error: stays
      do i = 1, size(values, 1)
         head = ''
         do k = 1, columns
            head = head//','//exact(values(i, k), '')
         end do
         call write_text(head(2:)//nl, error)   ! error: stays
      end do
      call print_text('', error)   ! error: handed up
   end subroutine print_profiles

   !> The row of one file.
   subroutine read_row(file, row)
      character(*), intent(in) :: file
      type(result_row_t), intent(out) :: row
      type(hdf5_input_t) :: reader
      type(error_t), allocatable :: error
      character(:), allocatable :: fault, path
      real(wp) :: time
      integer :: i, steps

      row%file = file
      row%problem = ''
      row%outcome = ''
      row%values = not_known()
      row%errors = not_known()
      row%units = ''
      call read_progress(file, steps, time)
      if (steps > 0) then
         row%is_read = .true.
         row%outcome = has_not_converged
         row%reason = counted(steps, 'time')//' to T '//number_text(time, 4)//': the run goes '// &
            'on, or was stopped'
         return
      end if
      fault = seal_fault(file)
      if (fault /= '' .and. fault /= no_seal) then   ! the library may not survive it
         row%reason = fault
         return
      end if
      call open_hdf5_input(reader, file, error)   ! error: the reader keeps it
      if (reader%text('/', 'program') /= program_name) call reader%refuse('program', &
         'found no result of '//program_name)
      row%problem = reader%text('/', 'problem')
      row%is_converged = exceeds(reader%real_value('/', 'converged'), 0.5_wp)
      row%outcome = reader%text_of('/', 'outcome')
      if (row%outcome == '') then   ! of an earlier version
         row%outcome = has_not_converged
         if (row%is_converged) row%outcome = has_converged
      end if
      row%reason = reader%text('/', 'reason')
      do i = 1, size(names)
         path = '/summary/'//trim(names(i))
         if (.not. reader%has(path)) cycle
         row%values(i) = reader%real_value(path)
         row%errors(i) = reader%real_value(path, 'error_estimate', not_known())
         row%units(i) = reader%text(path, 'units')
      end do
      if (reader%real_value('/', 'layout', 0.0_wp) >= sealed_layout) call reader%refuse( &
         'checksum', fault)
      call reader%close(error)
      row%is_read = .not. allocated(error)
      if (row%is_read) return
      row%reason = error%message   ! "cannot read FILE: reason"
      i = index(row%reason, file//': ')
      if (i > 0) row%reason = row%reason(i + len(file) + 2:)
   end subroutine read_row

   !> Writes columns of equal width: file, quantities with a prefix of their units, their errors in
   !> per cent, what there is to say. Error: standard output is lost.
   subroutine write_table(rows, error)
      type(result_row_t), intent(in) :: rows(:)
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: line
      character(len=cell_width), allocatable :: cells(:, :)
      integer, allocatable :: columns(:), widths(:)
      integer :: i, j, k

      columns = pack([(k, k=1, size(names))], heads /= '' .and. [(any(rows%units(k) /= ''), &
         k=1, size(names))])
      allocate (cells(size(rows) + 1, 2*size(columns) + 1))
      cells = ''
      cells(1, 1) = 'result'
      do i = 1, size(rows)
         cells(i + 1, 1) = rows(i)%file
      end do
      do j = 1, size(columns)
         k = columns(j)
         cells(1, 2*j) = heads(k)
         cells(1, 2*j + 1) = '+- %'
         of_column: do i = 1, size(rows)
            if (rows(i)%units(k) == '') cycle of_column
            associate (value => rows(i)%values(k), doubt => rows(i)%errors(k))
               cells(i + 1, 2*j) = number_text(value, 4)
               if (rows(i)%units(k) /= '1') cells(i + 1, 2*j) = prefixed_text(value, &
                  trim(rows(i)%units(k)))
               if (ieee_is_finite(doubt) .and. abs(value) > 0.0_wp) cells(i + 1, 2*j + 1) = &
                  number_text(100*abs(doubt/value), 2)
            end associate
         end do of_column
      end do
      widths = maxval(len_trim(cells), dim=1)
      do i = 1, size(cells, 1)
         line = ''
         do j = 1, size(cells, 2)
            line = line//cells(i, j)(:widths(j))//repeat(' ', 1 + mod(j, 2))
         end do
         if (i > 1) then
            associate (row => rows(i - 1))
               if (.not. row%is_read) then
                  line = line//'NOT READ: '//row%reason
               else if (row%outcome /= has_converged) then
                  line = line//ending_text(row%outcome, row%reason)
               end if
            end associate
         end if
         call write_text(trim(line)//nl, error)   ! error: stays
      end do
   end subroutine write_table

   !> Writes every quantity that any of the files has, with its error, a column for each unit; what
   !> is not known is empty. Error: standard output is lost.
   subroutine write_csv(rows, error)
      type(result_row_t), intent(in) :: rows(:)
      type(error_t), allocatable, intent(out) :: error
      type(column_t), allocatable :: columns(:)
      character(:), allocatable :: line, name
      integer :: i, k

      allocate (columns(0))   ! of each quantity all units that the rows have
      do k = 1, size(names)
         do i = 1, size(rows)
            associate (unit => rows(i)%units(k))
               if (unit /= '' .and. .not. any(rows(:i - 1)%units(k) == unit)) columns = &
                  [columns, column_t(k, unit)]
            end associate
         end do
      end do
      line = 'file,problem,converged,outcome,reason'
      do k = 1, size(columns)
         name = trim(names(columns(k)%number))
         associate (unit => ' ['//trim(columns(k)%units)//']')
            line = line//','//name//unit//','//name//'_error'//unit
         end associate
      end do
      call write_text(line//nl, error)   ! error: stays
      do i = 1, size(rows)
         associate (row => rows(i))
            line = csv_cell(row%file)//','//csv_cell(row%problem)//','//state(row, '')//',' &
               //row%outcome//','//csv_cell(row%reason)
            do k = 1, size(columns)
               associate (number => columns(k)%number)
                  if (row%units(number) == columns(k)%units) then
                     line = line//','//exact(row%values(number), '')//',' &
                        //exact(row%errors(number), '')
                  else
                     line = line//',,'
                  end if
               end associate
            end do
         end associate
         call write_text(line//nl, error)   ! error: stays
      end do
   end subroutine write_csv

   !> One result as a JSON object.
   pure function json_line(row) result(line)
      type(result_row_t), intent(in) :: row
      character(:), allocatable :: line
      integer :: k

      line = '{"file": '//json_text(row%file)//', "problem": '//json_text(row%problem) &
         //', "converged": '//state(row, 'null')//', "outcome": '//json_text(row%outcome) &
         //', "reason": '//json_text(row%reason)
      do k = 1, size(names)
         if (row%units(k) == '') cycle
         line = line//', "'//trim(names(k))//'": {"value": '//exact(row%values(k), 'null') &
            //', "error_estimate": '//exact(row%errors(k), 'null')//', "units": ' &
            //json_text(trim(row%units(k)))//'}'
      end do
      line = line//'}'
   end function json_line

   !> A text in quotes, without characters that JSON does not have.
   pure function json_text(string) result(quoted)
      character(*), intent(in) :: string
      character(:), allocatable :: quoted
      integer :: i

      quoted = '"'
      do i = 1, len(string)
         if (scan(string(i:i), '"'//achar(92)) > 0) quoted = quoted//achar(92)
         quoted = quoted//merge(' ', string(i:i), iachar(string(i:i)) < 32)
      end do
      quoted = quoted//'"'
   end function json_text

   !> Whether a result has converged; `missing` where that is not known.
   pure function state(row, missing) result(word)
      type(result_row_t), intent(in) :: row
      character(*), intent(in) :: missing
      character(:), allocatable :: word

      word = missing
      if (row%is_read) word = trim(merge('true ', 'false', row%is_converged))
   end function state

   !> A number with all digits that count; `missing` where it is not finite.
   pure function exact(value, missing) result(word)
      real(wp), intent(in) :: value
      character(*), intent(in) :: missing
      character(:), allocatable :: word
      character(len=32) :: buffer

      word = missing
      if (.not. ieee_is_finite(value)) return
      write (buffer, '(es24.11e3)') value
      word = trim(adjustl(buffer))
   end function exact

end module result_table

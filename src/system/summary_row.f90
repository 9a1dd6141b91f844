!> The row of a case in a table of many: what its result file would hold as single numbers and
!> words, as CSV. Names of columns are those of the gathered table (batch/result_row.py).
module summary_row
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use, intrinsic :: iso_c_binding, only: c_char, c_f_pointer, c_loc, c_null_char, c_size_t
   use c_library, only: c_strfromd
   use disk_file, only: append_line
   use errors, only: error_t, fail, output_error
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: csv_cell, new_row, set_columns, summary_row_t, table_place_t

   !> Column of the limits that are passed; where all of them and the values of a namelist stand.
   character(*), parameter :: passed = 'limits_passed', limits = '/adequacy/validity/', &
      inputs = '/input/effective/'

   !> Columns of case, input and program.
   integer, parameter :: own = 3

   !> A column, and what the row has there; not allocated: nothing.
   type :: column_t
      character(len=64) :: name = ''
      character(len=16) :: unit = ''
      character(:), allocatable :: text
   end type column_t

   !> A row, or while `is_head` the columns of all rows, which what is put there makes.
   type :: summary_row_t
      !> The table, its first line, and the cells of the first `own` columns with commas behind.
      character(:), allocatable :: path, first_line, first_cells
      logical :: is_head = .false.
      type(column_t), allocatable, private :: columns(:)
      !> The column of the last value: the next one is most often that of the next value.
      integer, private :: last = 0
      !> A value without its column.
      character(:), allocatable, private :: homeless
   contains
      procedure :: put, set, append
   end type summary_row_t

   !> The place of a case in a table.
   type :: table_place_t
      !> The table; how the row begins: the case, and with checksums of its input and the program.
      character(:), allocatable :: path, name, cells
      !> What a row of an earlier run says; not allocated: there is none.
      character(:), allocatable :: outcome, reason
   end type table_place_t

   !> The columns of all rows of this process, made once.
   type(summary_row_t), allocatable :: columns

contains

   !> Takes the value of a dataset, or of its `attribute` if that is not empty, if a table has it: a
   !> `text`, or `numbers` if it is one. `unit`: '=' stands for that of the value before.
   subroutine put(self, path, attribute, unit, text, numbers)
      class(summary_row_t), intent(inout) :: self
      character(*), intent(in) :: path, attribute, unit
      character(*), intent(in), optional :: text
      real(wp), intent(in), optional, contiguous, target :: numbers(..)
      real(wp), pointer :: number
      character(:), allocatable :: name

      if (present(numbers)) then
         if (size(numbers) /= 1) return
         call c_f_pointer(c_loc(numbers), number)
      end if
      name = path(index(path, '/', back=.true.) + 1:)
      select case (attribute)
      case ('', 'error_estimate')
         if (attribute /= '') name = name//'_error'
         if (index(path, '/report/') == 1) then
            name = 'report_'//name
         else if (index(path, limits) == 1 .and. attribute == '') then
            if (self%is_head) call self%set(passed, '', '')
            name = 'validity_'//name
         else if (index(path, '/summary/') /= 1 .and. index(path, '/sweep/') /= 1) then
            return
         end if
      case ('exceeded')
         if (number > 0.0_wp) call add_passed(self, name)
         return
      case ('outcome', 'reason')
         name = attribute
         if (path /= '/') return
      case default
         name = 'scaling_'//attribute
         if (index(path, inputs) == 1) name = path(len(inputs) + 1:)//'.'//attribute
         if (name(:8) == 'scaling_' .and. .not. (path == '/scaling' .and. present(numbers))) return
      end select
      if (present(numbers)) then
         call self%set(name, unit, exact_text(number))
      else
         call self%set(name, unit, csv_cell(text))
      end if
   end subroutine put

   !> Adds a limit to those that are passed.
   subroutine add_passed(self, name)
      class(summary_row_t), intent(inout) :: self
      character(*), intent(in) :: name

      associate (column => self%columns(place_of(self, passed)))
         if (allocated(column%text)) column%text = column%text//' '//name
         if (.not. allocated(column%text)) column%text = name
      end associate
   end subroutine add_passed

   !> Takes a cell; of two with one name the first counts. What is no key of the namelist (derived
   !> values, with a point in their names) may have no column.
   subroutine set(self, name, unit, text)
      class(summary_row_t), intent(inout) :: self
      character(*), intent(in) :: name, unit, text
      integer :: k

      k = place_of(self, name)
      if (k == 0 .and. self%is_head) then
         if (.not. allocated(self%columns)) allocate (self%columns(0))
         self%columns = [self%columns, column_t(name, unit)]
         k = size(self%columns)
         if (unit == '=') self%columns(k)%unit = self%columns(self%last)%unit
         self%last = k
      else if (k == 0) then
         if (index(name, '.') == 0) self%homeless = name
      else
         self%last = k
         if (self%is_head .or. allocated(self%columns(k)%text)) return
         self%columns(k)%text = text
      end if
   end subroutine set

   !> Number of the column `name`; 0: there is none.
   pure integer function place_of(self, name) result(k)
      class(summary_row_t), intent(in) :: self
      character(*), intent(in) :: name
      integer :: i, n

      k = 0
      if (.not. allocated(self%columns)) return
      n = size(self%columns)
      k = self%last
      do i = 1, n
         k = merge(1, k + 1, k == n)
         if (self%columns(k)%name == name) return
      end do
      k = 0
   end function place_of

   !> From now on rows have the columns of `head`, which are all there.
   subroutine set_columns(head)
      type(summary_row_t), intent(in) :: head
      character(:), allocatable :: line, name
      integer :: i

      line = ''
      do i = 1, size(head%columns)
         name = trim(head%columns(i)%name)
         if (head%columns(i)%unit /= '') name = name//' ['//trim(head%columns(i)%unit)//']'
         line = line//','//csv_cell(name)
      end do
      columns = head
      columns%first_line = line(2:)//new_line('a')
      columns%is_head = .false.
   end subroutine set_columns

   !> A row at a `place` of its table, with the columns of `set_columns`.
   subroutine new_row(row, place)
      type(summary_row_t), allocatable, intent(out) :: row
      type(table_place_t), intent(in) :: place

      row = columns
      row%path = place%path
      row%first_cells = place%cells
   end subroutine new_row

   !> Appends the row to its table. Error: it cannot be written, or the table is another one.
   subroutine append(self, error)
      class(summary_row_t), intent(in) :: self
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault, line
      integer :: i, length

      length = len(self%first_cells) + size(self%columns) - own
      do i = own + 1, size(self%columns)
         if (allocated(self%columns(i)%text)) length = length + len(self%columns(i)%text)
      end do
      allocate (character(len=length) :: line)
      length = len(self%first_cells)
      line(:length) = self%first_cells
      do i = own + 1, size(self%columns)
         if (allocated(self%columns(i)%text)) then
            line(length + 1:length + len(self%columns(i)%text)) = self%columns(i)%text
            length = length + len(self%columns(i)%text)
         end if
         length = length + 1
         line(length:length) = ','
      end do
      line(length:) = new_line('a')
      if (allocated(self%homeless)) then
         fault = 'it has no column '//self%homeless
      else
         fault = append_line(self%path, self%first_line, line)
      end if
      if (fault /= '') call fail(error, output_error, 'cannot write '//self%path//': '//fault)
   end subroutine append

   !> A text as a cell of a line, in quotes where it needs them.
   pure function csv_cell(string) result(cell)
      character(*), intent(in) :: string
      character(:), allocatable :: cell
      integer :: i

      cell = string
      if (scan(string, ',"'//achar(10)//achar(13)) == 0) return
      cell = '"'
      do i = 1, len(string)
         cell = cell//merge(' ', string(i:i), iachar(string(i:i)) < 32)
         if (string(i:i) == '"') cell = cell//'"'
      end do
      cell = cell//'"'
   end function csv_cell

   !> A number with which a reader gets the same bits. (A `write` takes five times as long.)
   function exact_text(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text
      character(kind=c_char, len=32), target :: buffer
      integer :: length

      text = 'nan'   ! without a sign
      if (ieee_is_nan(value)) return
      length = c_strfromd(c_loc(buffer), len(buffer, c_size_t), '%.17g'//c_null_char, value)
      text = buffer(:length)
   end function exact_text

end module summary_row

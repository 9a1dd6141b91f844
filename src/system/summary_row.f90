!> The row of a case in a table of many: what its result file would hold as single numbers and
!> words, as CSV. Names of columns are those of the gathered table (batch/result_row.py).
module summary_row
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_loc
   use disk_file, only: append_line
   use errors, only: error_t, fail, output_error
   use kinds, only: wp
   use text, only: formatted
   implicit none (type, external)
   private

   public :: csv_cell, summary_row_t, table_place_t

   !> Longest name of a column.
   integer, parameter :: name_length = 64
   !> Column of the limits that are passed.
   character(*), parameter :: passed = 'limits_passed'

   !> A column, and what the row has there; not allocated: nothing.
   type :: column_t
      character(len=name_length) :: name = ''
      character(:), allocatable :: text
   end type column_t

   !> The place of a case in a table.
   type :: table_place_t
      !> The table; how the row begins: the case, and with checksums of its input and the program.
      character(:), allocatable :: path, name, cells
      !> What a row of an earlier run says; not allocated: there is none.
      character(:), allocatable :: outcome, reason
   end type table_place_t

   !> A row, or without a place the columns of all rows, which what is put there makes.
   type :: summary_row_t
      type(table_place_t) :: place
      !> Names of all columns with their units, and the columns behind the cells of the place.
      character(:), allocatable :: first_line
      type(column_t), allocatable :: columns(:)
      !> The column of the last value (that of the next one most often follows it), and its unit.
      integer, private :: last = 0
      character(:), allocatable, private :: unit
      !> A value without its column.
      character(:), allocatable, private :: homeless
   contains
      procedure :: put, set, append
      procedure, private :: find
   end type summary_row_t

   !> What every row of this process begins with: the columns, made once.
   type(summary_row_t), public :: empty_row

contains

   !> Takes the value of a dataset, or of its `attribute` if that is not empty, if a table has it: a
   !> `text`, or `numbers` if it is one. `unit`: '=' stands for that of the value before.
   subroutine put(self, path, attribute, unit, text, numbers)
      class(summary_row_t), intent(inout) :: self
      character(*), intent(in) :: path, attribute, unit
      character(*), intent(in), optional :: text
      real(wp), intent(in), optional, contiguous, target :: numbers(..)
      real(wp), pointer :: number
      character(len=name_length) :: name, what
      integer :: k, slash

      if (path(:min(9, len(path))) == '/summary/' .and. all(attribute /= [character(len=14) :: &
         '', 'error_estimate'])) return
      if (present(numbers)) then
         if (size(numbers) /= 1) return
         call c_f_pointer(c_loc(numbers), number)
      end if
      slash = index(path, '/', back=.true.)
      name = path(slash + 1:)
      what = path(:slash)
      what(min(slash, name_length - 1) + 1:) = attribute   ! `//` would make a copy
      select case (what)
      case ('/summary/', '/sweep/')
      case ('/summary/error_estimate', '/sweep/error_estimate')
         name = trim(name)//'_error'
      case ('/report/')
         name = 'report_'//trim(name)
      case ('/adequacy/validity/')
         if (.not. allocated(self%place%path)) call self%set(passed, '', '')
         name = 'validity_'//trim(name)
      case ('/adequacy/validity/exceeded')
         if (.not. number > 0.0_wp) return
         k = self%find(passed)
         associate (column => self%columns(k))
            if (allocated(column%text)) column%text = column%text//' '//trim(name)
            if (.not. allocated(column%text)) column%text = trim(name)
         end associate
         return
      case ('/outcome', '/reason')
         name = attribute
      case default
         if (path(:slash) == '/input/effective/') then
            name = trim(name)//'.'//attribute
         else if (path == '/scaling' .and. present(numbers)) then
            name = 'scaling_'//attribute
         else
            return
         end if
      end select
      if (present(numbers)) then
         call self%set(name, unit, formatted(number, '%.17g'))   ! a reader gets the same bits
      else
         call self%set(name, unit, csv_cell(text))
      end if
   end subroutine put

   !> Takes a cell; of two with one name the first counts. What is no key of the namelist (derived
   !> values, with a point in their names) may have no column.
   subroutine set(self, name, unit, text)
      class(summary_row_t), intent(inout) :: self
      character(*), intent(in) :: name, unit, text
      integer :: k

      k = self%find(name)
      if (.not. allocated(self%place%path)) then
         if (unit /= '=') self%unit = unit
         if (k > 0) return
         self%columns = [self%columns, column_t(name)]
         self%first_line = self%first_line//','//trim(name)
         if (self%unit /= '') self%first_line = self%first_line//' ['//self%unit//']'
      else if (k > 0) then
         if (.not. allocated(self%columns(k)%text)) self%columns(k)%text = text
      else if (index(name, '.') == 0) then
         self%homeless = trim(name)
      end if
   end subroutine set

   !> Number of the column `name`, from the one behind the last that was found on; 0: there is none.
   integer function find(self, name) result(k)
      class(summary_row_t), intent(inout) :: self
      character(*), intent(in) :: name
      character(len=name_length) :: padded
      integer :: i

      padded = name   ! of equal lengths they are compared without a call
      do i = 1, size(self%columns)
         k = modulo(self%last + i - 1, size(self%columns)) + 1
         if (self%columns(k)%name /= padded) cycle
         self%last = k
         return
      end do
      k = 0
   end function find

   !> Appends the row to its table. Error: it cannot be written, or the table is another one.
   subroutine append(self, error)
      class(summary_row_t), intent(in) :: self
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: fault, line
      integer :: i, last, length

      length = size(self%columns)
      do i = 1, size(self%columns)
         if (allocated(self%columns(i)%text)) length = length + len(self%columns(i)%text)
      end do
      line = self%place%cells//repeat(',', length)
      last = len(self%place%cells) - 1   ! without the commas
      do i = 1, size(self%columns)
         if (.not. allocated(self%columns(i)%text)) cycle
         length = len(self%columns(i)%text)
         line(last + i + 1:last + i + length) = self%columns(i)%text
         last = last + length
      end do
      line(len(line):) = new_line('a')
      if (allocated(self%homeless)) then
         fault = 'it has no column '//self%homeless
      else
         fault = append_line(self%place%path, self%first_line//new_line('a'), line)
      end if
      if (fault /= '') call fail(error, output_error, 'cannot write '//self%place%path//': '//fault)
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

end module summary_row

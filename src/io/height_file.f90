!> Measured heights from a file: CSV with a header line, or HDF5.
module height_file
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use errors, only: error_t, fail, input_error
   use hdf5_reader, only: read_hdf5_heights
   use kinds, only: wp
   use text, only: to_lower, to_text
   use text_file, only: read_text_file
   implicit none (type, external)
   private

   public :: heights_t, read_heights

   !> Largest error of a position, in spacings, that still counts as uniform.
   real(wp), parameter :: most_uneven = 1.0e-3_wp

   !> Heights on a uniform grid.
   type :: heights_t
      !> Heights (nx*ny) [m], x fastest.
      real(wp), allocatable :: z(:)
      !> nx, ny; ny = 1: a profile.
      integer :: grid(2) = 0
      !> Spacing of the nodes [m]; 0: the file does not tell.
      real(wp) :: spacing(2) = 0.0_wp
   end type heights_t

contains

   !> Reads `file`; `dataset` names the column of a CSV file (empty: the second) or the path in an HDF5 file.
   !> Errors (input_error): no such file, column or dataset; gaps, numbers that are none; uneven positions; fewer than two
   !> nodes.
   subroutine read_heights(file, dataset, heights, error)
      character(*), intent(in) :: file, dataset
      type(heights_t), intent(out) :: heights
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: content, ending
      integer :: bad

      ending = to_lower(file(index(file, '.', back=.true.) + 1:))
      if (ending == 'h5' .or. ending == 'hdf5') then
         call read_hdf5_heights(file, dataset, heights%z, heights%grid, heights%spacing, error)
      else
         call read_text_file(file, content, error)
         if (allocated(error)) return
         call read_table(content, file, dataset, heights, error)
      end if
      if (allocated(error)) return
      if (size(heights%z) < 2) then
         call fail(error, input_error, 'found ' // to_text(size(heights%z)) // ' node in ' // file // ', expected at least 2')
         return
      end if
      bad = findloc(ieee_is_finite(heights%z), .false., dim=1)
      if (bad > 0) call fail(error, input_error, 'found a height that is no number (a gap) at node ' // to_text(bad) // ' in ' &
         // file // ', expected heights without gaps')
   end subroutine read_heights

   !> Reads a CSV table: a header line, then x and heights.
   subroutine read_table(content, file, dataset, heights, error)
      character(*), intent(in) :: content, file, dataset
      type(heights_t), intent(inout) :: heights
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: x(:)
      integer :: column, first, last, line, rows

      rows = max(count([(content(line:line) == new_line('a'), line=1, len(content))]), 1)
      allocate (x(rows), heights%z(rows))
      last = line_end(content, 1)
      column = column_of(content(:last), dataset)
      if (column == 0) then
         call fail(error, input_error, 'found no column ' // dataset // ' in the header of ' // file // ': ' // content(:last))
         return
      end if
      rows = 0
      line = 1
      do while (last < len(content))
         first = last + 2
         last = line_end(content, first)
         line = line + 1
         if (first > len(content)) exit
         if (len_trim(content(first:last)) == 0) cycle
         rows = rows + 1
         if (rows > size(x)) exit
         call read_row(content(first:last), column, x(rows), heights%z(rows), error)
         if (allocated(error)) then
            error%message = file // ':' // to_text(line) // ': ' // error%message
            return
         end if
      end do
      heights%z = heights%z(:rows)
      heights%grid = [rows, 1]
      if (rows < 2) return
      call find_spacing(x(:rows), file, heights%spacing(1), error)
   end subroutine read_table

   !> Index of the last character of the line that begins at `first`.
   pure function line_end(content, first) result(last)
      character(*), intent(in) :: content
      integer, intent(in) :: first
      integer :: last

      last = len(content)
      if (first > len(content)) return
      if (index(content(first:), new_line('a')) > 0) last = first + index(content(first:), new_line('a')) - 2
   end function line_end

   !> Number of the column named `dataset` in a header (empty: 2); 0 if there is none.
   pure function column_of(header, dataset) result(column)
      character(*), intent(in) :: header, dataset
      integer :: column
      integer :: i

      column = 2
      if (dataset == '') return
      do i = 1, 1 + count([(header(i:i) == ',', i=1, len(header))])
         column = i
         if (trim(adjustl(field(header, i))) == trim(dataset)) return
      end do
      column = 0
   end function column_of

   !> Field number `i` of a line of fields separated by commas; empty if there are fewer.
   pure function field(line, i) result(content)
      character(*), intent(in) :: line
      integer, intent(in) :: i
      character(:), allocatable :: content
      integer :: comma, k

      content = line
      if (len(content) > 0) then
         if (content(len(content):) == achar(13)) content = content(:len(content) - 1)
      end if
      do k = 1, i
         comma = index(content, ',')
         if (k == i) exit
         if (comma == 0) then
            content = ''
         else
            content = content(comma + 1:)
         end if
      end do
      if (comma > 0) content = content(:comma - 1)
   end function field

   !> x from the first and z from the given column of one line. Error: not a number.
   pure subroutine read_row(line, column, x, z, error)
      character(*), intent(in) :: line
      integer, intent(in) :: column
      real(wp), intent(out) :: x, z
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: content
      integer :: status

      z = 0.0_wp
      content = field(line, 1)
      read (content, *, iostat=status) x
      if (status == 0) then
         content = field(line, column)
         status = 1
         if (len_trim(content) > 0) read (content, *, iostat=status) z
      end if
      if (status /= 0) call fail(error, input_error, "found '" // content // "', expected a number")
   end subroutine read_row

   !> Spacing of uniform, rising positions. Error: they are not.
   pure subroutine find_spacing(x, file, spacing, error)
      real(wp), intent(in) :: x(:)
      character(*), intent(in) :: file
      real(wp), intent(out) :: spacing
      type(error_t), allocatable, intent(out) :: error
      integer :: i, n

      n = size(x)
      spacing = (x(n) - x(1))/(n - 1)
      if (.not. spacing > 0.0_wp) then
         call fail(error, input_error, 'found positions that do not rise in ' // file)
         return
      end if
      do i = 2, n
         if (abs(x(i) - x(1) - (i - 1)*spacing) <= most_uneven*spacing) cycle
         call fail(error, input_error, 'found uneven positions in ' // file // ' (node ' // to_text(i) &
            // '), expected a uniform grid')
         return
      end do
   end subroutine find_spacing

end module height_file

!> The names above the columns of a table, and the units among them.
module csv_header
   use csv_dialect, only: blanks, csv_dialect_t, find_field, is_number, number_of_fields
   use kinds, only: wp
   use length_units, only: find_unit, units_per_metre
   implicit none (type, external)
   private

   public :: are_units, column_named, csv_name_t, names_of, unit_among, unit_of, without_brackets

   character(*), parameter :: opening = '[({', closing = '])}'

   !> One name.
   type :: csv_name_t
      character(:), allocatable :: text
   end type csv_name_t

contains

   !> The names in a line. Between blanks as separators a part in brackets belongs to the name
   !> before it.
   pure function names_of(dialect, line) result(names)
      type(csv_dialect_t), intent(in) :: dialect
      character(*), intent(in) :: line
      type(csv_name_t), allocatable :: names(:)
      integer :: depth, first, i, last, n

      allocate (names(number_of_fields(dialect, line)))
      n = 0
      depth = 0
      do i = 1, size(names)
         call find_field(dialect, line, i, first, last)
         associate (field => line(first:last))
            if (dialect%separator == ' ' .and. n > 0 .and. (depth > 0 &
               .or. scan(field, opening) == 1)) then
               names(n)%text = names(n)%text//' '//field
            else
               n = n + 1
               names(n)%text = field
            end if
            depth = depth + count_in(field, opening) - count_in(field, closing)
         end associate
      end do
      names = names(:n)
   end function names_of

   !> How many characters of `field` are in `set`.
   pure function count_in(field, set) result(number)
      character(*), intent(in) :: field, set
      integer :: number
      integer :: i

      number = 0
      do i = 1, len(field)
         if (index(set, field(i:i)) > 0) number = number + 1
      end do
   end function count_in

   !> Number of the column with the name `wanted`, or with that name in front of its unit if this is
   !> so of one column only; 0: there is none.
   pure function column_named(names, wanted) result(column)
      type(csv_name_t), intent(in) :: names(:)
      character(*), intent(in) :: wanted
      integer :: column
      character(:), allocatable :: unit
      integer :: found, i, last

      found = 0
      do column = 1, size(names)
         if (names(column)%text == trim(wanted)) return
      end do
      column = 0
      do i = 1, size(names)
         call find_unit(names(i)%text, unit, last)
         if (unit == '' .or. names(i)%text(:last) /= wanted) cycle
         found = found + 1
         column = i
      end do
      if (found > 1) column = 0
   end function column_named

   !> The unit in a name, empty if there is none.
   pure function unit_of(name) result(unit)
      type(csv_name_t), intent(in) :: name
      character(:), allocatable :: unit
      integer :: last

      call find_unit(name%text, unit, last)
   end function unit_of

   !> Whether names are the units of their columns: that of the first or the second is a length, and
   !> none is a number.
   pure function are_units(names)
      type(csv_name_t), intent(in) :: names(:)
      logical :: are_units
      character(:), allocatable :: word
      real(wp) :: per_metre
      integer :: i

      are_units = .false.
      do i = 1, size(names)
         if (is_number(csv_dialect_t(';', '.'), names(i)%text)) then
            are_units = .false.
            return
         end if
         if (i > 2) cycle
         call units_per_metre(without_brackets(names(i)%text), per_metre, word)
         are_units = are_units .or. word /= ''
      end do
   end function are_units

   !> A unit without brackets around it.
   pure function without_brackets(name) result(unit)
      character(*), intent(in) :: name
      character(:), allocatable :: unit
      integer :: last

      unit = trim(adjustl(name))
      last = len(unit)
      if (last < 3) return
      if (index(opening, unit(1:1)) > 0 .and. index(closing, unit(last:last)) > 0) unit = &
         trim(adjustl(unit(2:last - 1)))
   end function without_brackets

   !> The first word of a comment that is a unit of length below a metre; empty if there is none.
   pure function unit_among(comment) result(unit)
      character(*), intent(in) :: comment
      character(:), allocatable :: unit
      character(*), parameter :: marks = blanks//'#%,;:=[](){}<>/_"'''
      character(:), allocatable :: word
      real(wp) :: per_metre
      integer :: first, length

      unit = ''
      first = 1
      do while (first <= len(comment))
         length = scan(comment(first:)//' ', marks) - 1
         call units_per_metre(comment(first:first + length - 1), per_metre, word)
         if (word /= '' .and. word /= 'm' .and. word /= 'in' .and. length > 0) then
            unit = comment(first:first + length - 1)
            return
         end if
         first = first + length + 1
      end do
   end function unit_among

end module csv_header

!> The values of one namelist entry: cut into pieces, and each piece read as a number, a logical or a word.
!>
!> A piece is checked against the Fortran grammar before Fortran reads it, so that nothing is read by halves, nothing
!> overflows and NaN or infinity do not get in.
module namelist_values
   use kinds, only: wp
   use text, only: to_lower, to_text
   implicit none (type, external)
   private

   public :: piece_t, split_values, read_real, read_integer, read_logical

   !> One value as written; of a string the content without its quotes.
   type :: piece_t
      character(:), allocatable :: text
      logical :: is_string = .false.
   end type piece_t

   !> Most values of one key.
   integer, parameter, public :: most_values = 2000
   !> Longest number [characters].
   integer, parameter :: longest_number = 60
   !> Decimal exponents that a number in working precision can have, one kept as a reserve.
   integer, parameter :: largest_exponent = 307

contains

   !> Cuts `values` at blanks and commas; expands repeat counts as in 3*0.1.
   !>
   !> `problem` is allocated, with the words after "found", if the text is not a list of values.
   subroutine split_values(values, pieces, problem)
      character(*), intent(in) :: values
      type(piece_t), allocatable, intent(out) :: pieces(:)
      character(:), allocatable, intent(out) :: problem
      type(piece_t), allocatable :: list(:)
      type(piece_t) :: piece
      integer :: position, count, repeats
      logical :: comma_before

      allocate (list(most_values))
      count = 0
      comma_before = .true.
      position = 1
      do
         position = next_nonblank(values, position)
         if (position > len(values)) exit
         if (values(position:position) == ',') then
            if (comma_before) then
               problem = 'an empty value before a comma'
               return
            end if
            comma_before = .true.
            position = position + 1
            cycle
         end if
         comma_before = .false.
         call read_repeats(values, position, repeats)
         call read_piece(values, position, piece, problem)
         if (allocated(problem)) return
         if (repeats < 1 .or. count + repeats > most_values) then
            problem = 'a repeat count or list outside 1 to ' // to_text(most_values) // ' values'
            return
         end if
         list(count + 1:count + repeats) = piece
         count = count + repeats
      end do
      if (count == 0) problem = 'an empty value'
      pieces = list(:count)
   end subroutine split_values

   !> Reads the `n*` of a repeated value at `position`; repeats = 1 without, -1 if n is too long.
   subroutine read_repeats(values, position, repeats)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      integer, intent(out) :: repeats
      integer :: digits

      repeats = 1
      digits = verify(values(position:), '0123456789') - 1
      if (digits < 1) return
      if (values(position + digits:position + digits) /= '*') return
      repeats = -1
      if (digits < 8) read (values(position:position + digits - 1), *) repeats
      position = position + digits + 1
   end subroutine read_repeats

   !> Reads the string or the bare value at `position`. Problem: nothing there (after `n*`).
   subroutine read_piece(values, position, piece, problem)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      type(piece_t), intent(out) :: piece
      character(:), allocatable, intent(out) :: problem
      character(len=1) :: mark
      integer :: length

      mark = ' '
      if (position <= len(values)) mark = values(position:position)
      if (mark == ' ' .or. mark == ',') then
         problem = 'a repeat count without a value'
      else if (mark == "'" .or. mark == '"') then
         call read_string(values, position, piece)
      else
         length = scan(values(position:), ' ,''"') - 1
         if (length < 0) length = len(values) - position + 1
         piece%text = values(position:position + length - 1)
         position = position + length
      end if
   end subroutine read_piece

   !> Reads the string at `position`; a doubled quote inside stands for one.
   subroutine read_string(values, position, piece)
      character(*), intent(in) :: values
      integer, intent(inout) :: position
      type(piece_t), intent(out) :: piece
      character(:), allocatable :: content
      character(len=1) :: mark
      integer :: length

      mark = values(position:position)
      allocate (character(len=len(values)) :: content)
      length = 0
      position = position + 1
      do while (position <= len(values))
         if (values(position:position) == mark) then
            if (position == len(values)) exit
            if (values(position + 1:position + 1) /= mark) exit
            position = position + 1
         end if
         length = length + 1
         content(length:length) = values(position:position)
         position = position + 1
      end do
      position = position + 1
      piece%is_string = .true.
      piece%text = content(:length)
   end subroutine read_string

   !> First position from `start` on that is not blank; len + 1: none.
   pure function next_nonblank(string, start) result(position)
      character(*), intent(in) :: string
      integer, intent(in) :: start
      integer :: position

      position = start
      do while (position <= len(string))
         if (string(position:position) /= ' ') return
         position = position + 1
      end do
   end function next_nonblank

   !> Reads a real number (Fortran syntax, exponent letters e, d, q). `good` is false for everything else, also for a
   !> number that working precision cannot hold, NaN and infinity.
   subroutine read_real(piece, value, good)
      type(piece_t), intent(in) :: piece
      real(wp), intent(out) :: value
      logical, intent(out) :: good
      character(:), allocatable :: mantissa
      character(len=longest_number + 10) :: buffer
      integer :: letter, exponent, status, magnitude

      value = 0.0_wp
      good = .false.
      if (piece%is_string .or. len(piece%text) > longest_number) return
      letter = scan(piece%text, 'eEdDqQ')
      if (letter == 0 .and. len(piece%text) > 1) letter = scan(piece%text(2:), '+-') + 1
      if (letter <= 1) letter = len(piece%text) + 1
      mantissa = piece%text(:letter - 1)
      if (.not. is_mantissa(mantissa)) return
      exponent = 0
      if (letter <= len(piece%text)) then
         call read_exponent(piece%text(letter:), exponent, good)
         if (.not. good) return
      end if
      good = .false.
      if (scan(mantissa, '123456789') > 0) then
         magnitude = exponent + leading_exponent(mantissa)
         if (abs(magnitude) > largest_exponent) return
      else
         exponent = 0
      end if
      write (buffer, '(a,a,i0)') mantissa, 'e', exponent
      read (buffer, *, iostat=status) value
      good = status == 0
   end subroutine read_real

   !> True for [+-]digits[.digits] with at least one digit.
   pure function is_mantissa(string)
      character(*), intent(in) :: string
      logical :: is_mantissa
      integer :: start, point

      start = 1
      if (index(string, '+') == 1 .or. index(string, '-') == 1) start = 2
      point = index(string, '.')
      is_mantissa = scan(string, '0123456789') > 0 .and. verify(string(start:), '0123456789.') == 0 &
         .and. index(string, '.', back=.true.) == point
   end function is_mantissa

   !> Reads an exponent with its letter, or only with its sign: e-8, D+3, +3.
   subroutine read_exponent(string, exponent, good)
      character(*), intent(in) :: string
      integer, intent(out) :: exponent
      logical, intent(out) :: good
      integer :: start, digits, status

      start = 1
      exponent = 0
      if (scan(string(1:1), 'eEdDqQ') == 1) start = 2
      good = .false.
      digits = start
      if (start <= len(string)) then
         if (scan(string(start:start), '+-') == 1) digits = start + 1
      end if
      if (digits > len(string) .or. len(string) - digits > 6) return
      if (verify(string(digits:), '0123456789') > 0) return
      read (string(start:), *, iostat=status) exponent
      good = status == 0
   end subroutine read_exponent

   !> Decimal exponent of the first digit of `mantissa` that is not zero.
   pure function leading_exponent(mantissa) result(exponent)
      character(*), intent(in) :: mantissa
      integer :: exponent
      integer :: point, first

      point = index(mantissa, '.')
      if (point == 0) point = len(mantissa) + 1
      first = scan(mantissa, '123456789')
      exponent = point - first
      if (first < point) exponent = exponent - 1
   end function leading_exponent

   !> Reads an integer of default kind; `good` is false for everything else.
   subroutine read_integer(piece, value, good)
      type(piece_t), intent(in) :: piece
      integer, intent(out) :: value
      logical, intent(out) :: good
      integer :: start, status

      value = 0
      good = .false.
      if (piece%is_string .or. len(piece%text) > longest_number) return
      start = 1
      if (scan(piece%text(1:1), '+-') == 1) start = 2
      if (start > len(piece%text)) return
      if (verify(piece%text(start:), '0123456789') > 0) return
      read (piece%text, *, iostat=status) value
      good = status == 0
   end subroutine read_integer

   !> Reads a logical: .true., .false., true, false, .t., .f., t, f in any case.
   subroutine read_logical(piece, value, good)
      type(piece_t), intent(in) :: piece
      logical, intent(out) :: value
      logical, intent(out) :: good

      value = .false.
      good = .not. piece%is_string
      if (.not. good) return
      select case (to_lower(piece%text))
      case ('.true.', 'true', '.t.', 't')
         value = .true.
      case ('.false.', 'false', '.f.', 'f')
         value = .false.
      case default
         good = .false.
      end select
   end subroutine read_logical

end module namelist_values

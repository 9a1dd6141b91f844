!> The one strict reader of numbers: of namelists, height files, options, ranges of keys.
!>
!> A text is checked against the Fortran grammar before Fortran reads it, so that no text is read in
!> part, no number overflows, and NaN and infinity are refused. List-directed reads are not used:
!> they read `1/2` as 1 and `2*3` as 3.
module number_text
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: read_integer, read_real

   !> Longest number [characters].
   integer, parameter :: longest_number = 60
   !> Largest decimal exponent of a number in working precision, less one as a reserve.
   integer, parameter :: largest_exponent = 307
   !> Digits up to which working precision holds every integer exactly.
   integer, parameter :: most_digits = 15
   !> Powers of ten that it holds exactly.
   real(wp), parameter :: powers_of_ten(0:22) = [1e0_wp, 1e1_wp, 1e2_wp, 1e3_wp, 1e4_wp, 1e5_wp, &
      1e6_wp, 1e7_wp, 1e8_wp, 1e9_wp, 1e10_wp, 1e11_wp, 1e12_wp, 1e13_wp, 1e14_wp, 1e15_wp, &
      1e16_wp, 1e17_wp, 1e18_wp, 1e19_wp, 1e20_wp, 1e21_wp, 1e22_wp]

contains

   !> Reads a real number (Fortran syntax, exponents e, d, q) that fills all of `string`; `good` is
   !> false for all else, and for what working precision cannot hold, NaN and infinity.
   pure subroutine read_real(string, value, good)
      character(*), intent(in) :: string
      real(wp), intent(out) :: value
      logical, intent(out) :: good
      character(len=longest_number + 10) :: buffer
      integer :: first, letter, point, status
      integer(int64) :: exponent
      logical :: is_short

      value = 0.0_wp
      good = .false.
      if (len(string) > longest_number) return
      letter = scan(string, 'eEdDqQ')
      if (letter == 0 .and. len(string) > 1) letter = scan(string(2:), '+-') + 1
      if (letter <= 1) letter = len(string) + 1
      associate (mantissa => string(:letter - 1))
         if (.not. is_mantissa(mantissa)) return
         exponent = 0
         if (letter <= len(string)) then   ! with its letter, or only with its sign: e-8, D+3, +3
            first = letter + scan(string(letter:letter), 'eEdDqQ')
            if (len(string) - first > 7) return
            call read_integer(string(first:), exponent, good)
            if (.not. good) return
         end if
         good = .false.
         first = scan(mantissa, '123456789')
         if (first > 0) then
            point = index(mantissa, '.')
            if (point == 0) point = len(mantissa) + 1
            if (first < point) point = point - 1
            if (abs(exponent + point - first) > largest_exponent) return   ! of its first digit
         else
            exponent = 0
         end if
         call read_short(mantissa, int(exponent), value, is_short)
         if (is_short) then
            good = .true.
            return
         end if
         write (buffer, '(a,a,ss,i0)') mantissa, 'e', exponent
      end associate
      read (buffer, '(f70.0)', iostat=status) value
      good = status == 0
   end subroutine read_real

   !> Reads a number of few digits, as nearly all are, without Fortran's input, which takes fifty
   !> times as long: an integer that is held exactly, times or over a power of ten that is too, is
   !> rounded once, so that the value is the nearest one. For others `is_short` is false.
   pure subroutine read_short(mantissa, exponent, value, is_short)
      character(*), intent(in) :: mantissa
      integer, intent(in) :: exponent
      real(wp), intent(inout) :: value
      logical, intent(out) :: is_short
      integer :: digit, i, power
      integer(int64) :: number

      is_short = len(mantissa) <= most_digits
      if (.not. is_short) return
      number = 0_int64
      power = exponent
      do i = 1, len(mantissa)
         digit = iachar(mantissa(i:i)) - iachar('0')
         if (digit >= 0 .and. digit <= 9) number = 10_int64*number + digit
      end do
      i = index(mantissa, '.')
      if (i > 0) power = power - (len(mantissa) - i)
      is_short = abs(power) <= ubound(powers_of_ten, 1)
      if (.not. is_short) return
      value = real(number, wp)
      if (mantissa(1:1) == '-') value = -value
      if (power < 0) value = value/powers_of_ten(-power)
      if (power > 0) value = value*powers_of_ten(power)
   end subroutine read_short

   !> Whether `string` is [+-]digits[.digits] with at least one digit.
   pure logical function is_mantissa(string)
      character(*), intent(in) :: string
      integer :: start, point

      start = 1
      if (index(string, '+') == 1 .or. index(string, '-') == 1) start = 2
      point = index(string, '.')
      is_mantissa = scan(string, '0123456789') > 0 .and. index(string, '.', back=.true.) == point &
         .and. verify(string(start:), '0123456789.') == 0
   end function is_mantissa

   !> Reads [+-]digits that fill all of `string`; `good` is false for all else and beyond 64 bits.
   pure subroutine read_integer(string, value, good)
      character(*), intent(in) :: string
      integer(int64), intent(out) :: value
      logical, intent(out) :: good
      character(len=longest_number) :: buffer
      integer :: i, start, status

      value = 0_int64
      good = .false.
      if (len(string) == 0 .or. len(string) > longest_number) return
      start = 1
      if (scan(string(1:1), '+-') == 1) start = 2
      if (start > len(string)) return
      if (verify(string(start:), '0123456789') > 0) return
      if (len(string) <= most_digits) then
         do i = start, len(string)
            value = 10_int64*value + (iachar(string(i:i)) - iachar('0'))
         end do
         if (string(1:1) == '-') value = -value
         good = .true.
         return
      end if
      buffer = string
      read (buffer, '(i60)', iostat=status) value
      good = status == 0
   end subroutine read_integer

end module number_text

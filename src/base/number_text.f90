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

   !> Longest real number [characters].
   integer, parameter :: longest_number = 60
   !> Largest decimal exponent of a number in working precision, less one as a reserve.
   integer, parameter :: largest_exponent = 307
   !> Digits up to which working precision holds every integer exactly, and its largest exact power
   !> of ten.
   integer, parameter :: most_digits = 15, largest_power = 22

contains

   !> Reads a real number (Fortran syntax, exponents e, d, q) that fills all of `string`; `good` is
   !> false for all else, and for what working precision cannot hold, NaN and infinity.
   !>
   !> Fortran's input takes fifty times as long as a number of few digits needs, as nearly all are:
   !> an integer that is held exactly, times or over a power of ten that is too, is rounded once, so
   !> that the value is the nearest one.
   pure subroutine read_real(string, value, good)
      character(*), intent(in) :: string
      real(wp), intent(out) :: value
      logical, intent(out) :: good
      character(len=longest_number + 10) :: buffer
      integer :: digit, digits, i, power, status
      integer(int64) :: exponent, number
      logical :: has_point

      value = 0.0_wp
      good = .false.
      if (len(string) > longest_number) return
      number = 0_int64
      digits = 0   ! from the first that is not 0
      power = 0
      has_point = .false.
      do i = sign_end(string) + 1, len(string)
         digit = iachar(string(i:i)) - iachar('0')
         if (digit >= 0 .and. digit <= 9) then
            good = .true.
            if (digits + digit > 0) digits = digits + 1
            if (digits <= most_digits) number = 10_int64*number + digit
            if (has_point) power = power - 1
         else if (string(i:i) == '.' .and. .not. has_point) then
            has_point = .true.
         else
            exit
         end if
      end do
      exponent = 0_int64
      if (good .and. i <= len(string)) call read_exponent(string(i:), exponent, good)
      if (digits == 0) exponent = -power
      power = power + int(exponent)
      if (abs(power + digits - 1) > largest_exponent) good = .false.   ! of the first digit
      if (.not. good) return
      if (digits <= most_digits .and. abs(power) <= largest_power) then
         value = real(number, wp)*10.0_wp**max(power, 0)/10.0_wp**max(-power, 0)
         if (string(1:1) == '-') value = -value
      else
         write (buffer, '(a,a,ss,i0)') string(:i - 1), 'e', exponent
         read (buffer, '(f70.0)', iostat=status) value
         good = status == 0
      end if
   end subroutine read_real

   !> Reads an exponent with its letter, or only with its sign: e-8, D+3, +3.
   pure subroutine read_exponent(string, exponent, good)
      character(*), intent(in) :: string
      integer(int64), intent(out) :: exponent
      logical, intent(out) :: good
      integer :: letter

      letter = scan(string(1:1), 'eEdDqQ')
      exponent = 0_int64
      good = letter + sign_end(string) > 0 .and. len(string) - letter <= 8
      if (good) call read_integer(string(letter + 1:), exponent, good)
      if (.not. good) exponent = 0_int64
   end subroutine read_exponent

   !> 1 if a text begins with a sign, else 0.
   pure integer function sign_end(string)
      character(*), intent(in) :: string

      sign_end = scan(string(:min(1, len(string))), '+-')
   end function sign_end

   !> Reads [+-]digits that fill all of `string`; `good` is false for all else and beyond 64 bits.
   pure subroutine read_integer(string, value, good)
      character(*), intent(in) :: string
      integer(int64), intent(out) :: value
      logical, intent(out) :: good
      integer :: digit, i

      value = 0_int64
      good = .false.
      do i = sign_end(string) + 1, len(string)
         digit = iachar(string(i:i)) - iachar('0')
         good = digit >= 0 .and. digit <= 9
         if (good) good = value <= (huge(value) - digit)/10
         if (.not. good) return
         value = 10*value + digit
      end do
      if (good .and. string(1:1) == '-') value = -value
   end subroutine read_integer

end module number_text

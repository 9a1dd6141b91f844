!> Quantities and sentences for the screen.
module quantity_text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: duration_text, number_text, prefixed_text, shortened, wrapped

contains

   !> A number with `digits` significant digits; integers up to 1e9 without a point; 'unknown' if it
   !> is not finite.
   pure function number_text(value, digits) result(string)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      character(:), allocatable :: string

      if (.not. ieee_is_finite(value)) then
         string = 'unknown'
      else if (abs(value) >= huge(1.0_wp)) then
         string = 'unknown'
      else if (abs(value) < 1.0e9_wp .and. abs(value - anint(value)) <= 0.0_wp) then
         string = to_text(nint(value))
      else
         string = to_text(value, digits)
         if (string(len(string):) == '.') string = string(:len(string) - 1)
      end if
   end function number_text

   !> A quantity with four digits and an SI prefix, as 433.6 nm; 'unknown' if not finite.
   pure function prefixed_text(value, unit) result(string)
      real(wp), intent(in) :: value
      character(*), intent(in) :: unit
      character(:), allocatable :: string
      character(len=*), parameter :: prefixes = 'pnum kMGT'
      integer :: exponent

      if (.not. ieee_is_finite(value)) then
         string = 'unknown'
         return
      end if
      exponent = 0
      if (abs(value) > 0.0_wp) exponent = floor(log10(abs(value))/3.0_wp)
      exponent = min(max(exponent, -4), 4)
      string = '0 '//unit
      if (abs(value) > 0.0_wp) string = to_text(value/10.0_wp**(3*exponent), 4)//' ' &
         //trim(adjustl(prefixes(exponent + 5:exponent + 5)))//unit
   end function prefixed_text

   !> A time span [s] in its two largest units.
   pure function duration_text(seconds) result(string)
      real(wp), intent(in) :: seconds
      character(:), allocatable :: string
      integer :: whole

      whole = nint(min(max(seconds, 0.0_wp), 1.0e9_wp))
      if (whole < 60) then
         string = to_text(whole)//' s'
      else if (whole < 3600) then
         string = to_text(whole/60)//' min '//to_text(mod(whole, 60))//' s'
      else
         string = to_text(whole/3600)//' h '//to_text(mod(whole, 3600)/60)//' min'
      end if
   end function duration_text

   !> `string` in at most `length` characters, with an ellipsis for its middle.
   pure function shortened(string, length) result(short)
      character(*), intent(in) :: string
      integer, intent(in) :: length
      character(:), allocatable :: short
      integer :: head, tail

      short = string
      if (len(string) <= length) return
      head = (length - 3)/2
      tail = length - 3 - head
      short = string(:head)//'...'//string(len(string) - tail + 1:)
   end function shortened

   !> `string` broken at blanks into lines of at most `length` characters, the second and later ones
   !> indented by `indent` blanks (default: 2); a longer word has a separate line.
   pure function wrapped(string, length, indent) result(lines)
      character(*), intent(in) :: string
      integer, intent(in) :: length
      integer, intent(in), optional :: indent
      character(:), allocatable :: lines, margin, rest
      integer :: blank, first

      margin = '  '
      if (present(indent)) margin = repeat(' ', indent)
      lines = ''
      rest = trim(string)
      do while (len(rest) > length)
         first = verify(rest, ' ')
         blank = index(rest(:length + 1), ' ', back=.true.)
         if (blank < first) blank = first - 1 + index(rest(first:), ' ')
         if (blank < first) exit
         lines = lines//trim(rest(:blank - 1))//new_line('a')
         rest = margin//rest(blank + 1:)
      end do
      lines = lines//rest
   end function wrapped

end module quantity_text

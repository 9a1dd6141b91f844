!> Numbers and words as text for messages and tables.
module text
   use, intrinsic :: iso_fortran_env, only: int64
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: add_sentence, count_of, counted, joined, rounded_down, rounded_up, to_lower, to_text

   !> A number or logical as short text without surrounding blanks.
   interface to_text
      module procedure :: integer_to_text, long_to_text, real_to_text
   end interface to_text

contains

   !> An integer in as few characters as it needs.
   pure function integer_to_text(value) result(string)
      integer, intent(in) :: value
      character(:), allocatable :: string

      string = long_to_text(int(value, int64))
   end function integer_to_text

   !> A 64-bit integer in as few characters as it needs.
   pure function long_to_text(value) result(string)
      integer(int64), intent(in) :: value
      character(:), allocatable :: string
      character(len=24) :: buffer

      write (buffer, '(ss,i0)') value   ! ss: no plus sign, whatever GFORTRAN_OPTIONAL_PLUS says
      string = trim(buffer)
   end function long_to_text

   !> A real with `digits` (6, at most 17): fixed point for 1e-3 <= |value| < 1e6, else scientific.
   pure function real_to_text(value, digits) result(string)
      real(wp), intent(in) :: value
      integer, intent(in), optional :: digits
      character(:), allocatable :: string
      character(len=40) :: buffer
      character(len=16) :: form
      integer :: shown, decimals

      shown = 6
      if (present(digits)) shown = min(max(digits, 1), 17)
      if (.not. ieee_is_finite(value)) then
         form = '(ss,f40.0)'
      else if (abs(value) >= 1.0e-3_wp .and. abs(value) < 1.0e6_wp) then
         decimals = max(shown - 1 - floor(log10(abs(value))), 0)
         form = '(ss,f40.' // integer_to_text(decimals) // ')'
      else
         ! Without its width an exponent of three digits loses its E.
         form = '(ss,es40.' // integer_to_text(shown - 1) // trim(merge('e3)', ')  ', abs(value) &
            >= 9.9e99_wp .or. (abs(value) > 0.0_wp .and. abs(value) < 1.0e-99_wp)))
      end if
      write (buffer, form) value
      string = trim(adjustl(buffer))
      if (string(len(string):) == '.') string = string(:len(string) - 1)
   end function real_to_text

   !> A `value` > 0 with this many `digits`, rounded up: a least value that may be copied.
   pure function rounded_up(value, digits) result(string)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      character(:), allocatable :: string
      real(wp) :: unit

      unit = last_digit(value, digits)
      string = real_to_text(unit*(aint(value/unit) + 1), digits)
   end function rounded_up

   !> The same, rounded down: a largest value that may be copied.
   pure function rounded_down(value, digits) result(string)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      character(:), allocatable :: string
      real(wp) :: unit

      unit = last_digit(value, digits)
      string = real_to_text(unit*aint(value/unit), digits)
   end function rounded_down

   !> Unit of the last of this many `digits` of a `value` > 0.
   pure real(wp) function last_digit(value, digits) result(unit)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits

      unit = 10.0_wp**(floor(log10(value)) - digits + 1)
   end function last_digit

   !> `string` with A-Z in lower case.
   pure function to_lower(string) result(lower)
      character(*), intent(in) :: string
      character(len(string)) :: lower
      integer :: i, code

      do i = 1, len(string)
         code = iachar(string(i:i))
         if (code >= iachar('A') .and. code <= iachar('Z')) code = code + 32
         lower(i:i) = achar(code)
      end do
   end function to_lower

   !> `words` joined by `mark`, or by `last` before the last one.
   pure function joined(words, mark, last) result(list)
      character(*), intent(in) :: words(:), mark
      character(*), intent(in), optional :: last
      character(:), allocatable :: list
      integer :: i

      list = ''
      do i = 1, size(words)
         if (i > 1 .and. i == size(words) .and. present(last)) then
            list = list // last
         else if (i > 1) then
            list = list // mark
         end if
         list = list // trim(words(i))
      end do
   end function joined

   !> Appends `sentence` to `note`; an empty one adds nothing.
   pure subroutine add_sentence(note, sentence)
      character(:), allocatable, intent(inout) :: note
      character(*), intent(in) :: sentence

      if (sentence == '') return
      if (.not. allocated(note)) note = ''
      if (note /= '') note = note // '; '
      note = note // sentence
   end subroutine add_sentence

   !> Number of times that `mark` is in `words`.
   pure function count_of(mark, words) result(number)
      character(len=1), intent(in) :: mark
      character(*), intent(in) :: words
      integer :: number, i

      number = 0
      do i = 1, len(words)
         if (words(i:i) == mark) number = number + 1
      end do
   end function count_of

   !> A number of things, such as `1 cycle` and `2 cycles`; `noun` is one of them.
   pure function counted(number, noun) result(string)
      integer, intent(in) :: number
      character(*), intent(in) :: noun
      character(:), allocatable :: string

      string = integer_to_text(number)//' '//noun
      if (number /= 1) string = string//'s'
   end function counted

end module text

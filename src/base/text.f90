!> Numbers, quantities, words and sentences as text for messages, tables and the screen.
module text
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_null_char, c_size_t
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: add_sentence, count_of, counted, duration_text, find_bad_byte, formatted, joined, &
      number_text, prefixed_text, quoted, rounded, shortened, to_lower, to_text, wrapped

   !> Most characters of the user's text that a message repeats.
   integer, parameter :: max_quoted = 48
   !> Room for a number or its format as the C library has them.
   integer, parameter :: number_room = 40

   !> A number or logical as short text without surrounding blanks.
   interface to_text
      module procedure :: integer_to_text, long_to_text, real_to_text
   end interface to_text

   interface
      !> strfromd(3) of the C library: a number as `format` says, with a zero at its end.
      pure subroutine c_strfromd(text, bytes, format, number) bind(c, name='strfromd')
         import :: c_char, c_double, c_size_t, number_room
         implicit none (type, external)
         character(kind=c_char), intent(out) :: text(number_room)
         integer(c_size_t), value :: bytes
         character(kind=c_char), intent(in) :: format(number_room)
         real(c_double), value :: number
      end subroutine c_strfromd
   end interface

contains

   !> A number as a `format` of C says: %.17g has all digits. (A `write` takes five times as long.)
   pure function formatted(value, format) result(string)
      real(wp), intent(in) :: value
      character(*), intent(in) :: format
      character(:), allocatable :: string
      character(kind=c_char, len=number_room) :: buffer, form

      form = format
      form(len(format) + 1:) = c_null_char
      call c_strfromd(buffer, len(buffer, c_size_t), form, value)
      string = buffer(:index(buffer, c_null_char) - 1)
   end function formatted

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
      integer :: first
      integer(int64) :: rest

      rest = value
      do first = len(buffer), 2, -1
         buffer(first:first) = achar(iachar('0') + int(abs(mod(rest, 10_int64))))
         rest = rest/10_int64
         if (rest == 0_int64) exit
      end do
      string = buffer(first:)
      if (value < 0_int64) string = '-'//string
   end function long_to_text

   !> A real with `digits` (6, at most 17): fixed point for 1e-3 <= |value| < 1e6, else scientific.
   pure function real_to_text(value, digits) result(string)
      real(wp), intent(in) :: value
      integer, intent(in), optional :: digits
      character(:), allocatable :: string
      character(len=9) :: buffer
      integer :: shown

      shown = 6
      if (present(digits)) shown = min(max(digits, 1), 17)
      if (.not. ieee_is_finite(value)) then
         write (buffer, '(ss,f9.0)') value   ! ss: no plus sign, whatever the environment says
         string = trim(adjustl(buffer))
      else if (abs(value) >= 1.0e-3_wp .and. abs(value) < 1.0e6_wp) then
         string = formatted(value, '%.'//integer_to_text(max(shown - 1 &
            - floor(log10(abs(value))), 0))//'f')
      else
         string = formatted(value, '%.'//integer_to_text(shown - 1)//'E')
         if (shown == 1) string = string(:index(string, 'E') - 1)//'.'//string(index(string, 'E'):)
      end if
   end function real_to_text

   !> A `value` > 0 with this many `digits`, rounded up or down: a limit that may be copied.
   pure function rounded(value, digits, up) result(string)
      real(wp), intent(in) :: value
      integer, intent(in) :: digits
      logical, intent(in) :: up
      character(:), allocatable :: string
      real(wp) :: unit

      unit = 10.0_wp**(floor(log10(value)) - digits + 1)   ! of the last digit
      string = real_to_text(unit*(aint(value/unit) + merge(1, 0, up)), digits)
   end function rounded

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

      number = count([(words(i:i) == mark, i=1, len(words))])
   end function count_of

   !> A number of things, such as `1 cycle` and `2 cycles`; `noun` is one of them.
   pure function counted(number, noun) result(string)
      integer, intent(in) :: number
      character(*), intent(in) :: noun
      character(:), allocatable :: string

      string = integer_to_text(number)//' '//noun
      if (number /= 1) string = string//'s'
   end function counted

   !> A number with so many significant digits, an integer up to 1e9 without a point, or 'unknown'.
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
      end if
   end function number_text

   !> A quantity with four digits and an SI prefix, as 433.6 nm; 'unknown' if not finite.
   pure function prefixed_text(value, unit) result(string)
      real(wp), intent(in) :: value
      character(*), intent(in) :: unit
      character(:), allocatable :: string
      character(len=*), parameter :: prefixes = 'pnum kMGT'
      integer :: exponent

      string = 'unknown'
      if (.not. ieee_is_finite(value)) return
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

   !> The user's text for a message: short, UTF-8, no control characters; 'nothing' if empty.
   pure function quoted(string) result(shown)
      character(*), intent(in) :: string
      character(:), allocatable :: shown
      integer :: i, last

      last = len_trim(string)
      if (last == 0) then
         shown = 'nothing'
         return
      end if
      if (last <= max_quoted) then
         shown = string(:last)
      else
         last = max_quoted
         do while (last > 1 .and. iand(iachar(string(last + 1:last + 1)), 192) == 128)
            last = last - 1
         end do
         shown = string(:last) // '...'
      end if
      do i = 1, len(shown)
         if (iachar(shown(i:i)) < 32) shown(i:i) = '?'
      end do
      i = find_bad_byte(shown)
      do while (i > 0)
         shown(i:i) = '?'
         i = find_bad_byte(shown)
      end do
   end function quoted

   !> Position of the first byte of `content` that is not UTF-8 text (0: none). Tab, line feed, form
   !> feed and carriage return are text; other control characters are not.
   pure function find_bad_byte(content) result(position)
      character(*), intent(in) :: content
      integer :: position, i, j, code, following

      i = 1
      do while (i <= len(content))
         position = i
         code = iachar(content(i:i))
         select case (code)
         case (9, 10, 12, 13, 32:126)
            following = 0
         case (194:223)
            following = 1
         case (224:239)
            following = 2
         case (240:244)
            following = 3
         case default
            return
         end select
         if (i + following > len(content)) return
         do j = i + 1, i + following
            if (iand(iachar(content(j:j)), 192) /= 128) return
         end do
         i = i + following + 1
      end do
      position = 0
   end function find_bad_byte

end module text

!> What a row of the key table holds, what a key expects, in words, and its ranges as a test: "> 0,
!> <= 0.5", "a power of two (times 3 or 5 or 7)" or "1e-4 to 5".
module key_row
   use kinds, only: wp
   use number_text, only: read_real
   use text, only: joined, to_text
   implicit none (type, external)
   private

   public :: expected_value, has_word, is_in_range, split_words, unit_question, word_list

   !> Kinds of values, and what is expected of them (of words: the words).
   character(len=7), parameter :: kinds(*) = [character(len=7) :: 'real', 'integer', 'logical', &
      'word', 'text', 'reals', 'words']
   character(len=18), parameter :: expectations(*) = [character(len=18) :: 'a real number', &
      'an integer', '.true. or .false.', '', 'a quoted text', 'real numbers', 'a list of']

   !> The problems: lubricated line and point; dry profiles and areas; several of them.
   character(*), parameter, public :: lubricated = 'ehl_line', point = 'ehl_point', &
      dry_line = 'dry_line', dry_area = 'dry_area', film = 'ehl_line ehl_point', &
      dry = 'dry_line dry_area', other_than_point = 'ehl_line dry_line dry_area', &
      every = 'ehl_line ehl_point dry_line dry_area'

   !> One group.
   type, public :: group_row_t
      character(len=12) :: group
      character(len=100) :: meaning
      !> Problems that know the group, separated by blanks.
      character(len=40) :: problems = lubricated
      !> True: it must be there.
      logical :: is_needed = .false.
      !> True: it must not be there together with &moes.
      logical :: yields_to_moes = .false.
   end type group_row_t

   !> One key.
   type, public :: key_t
      character(len=12) :: group
      character(len=24) :: key
      !> Problems that use the key, separated by blanks; each may have a row of its own.
      character(len=40) :: problems
      !> One of the kinds above.
      character(len=7) :: kind
      !> SI unit; '-' for a pure number, 'half-widths' for X; empty for words and texts.
      character(len=12) :: unit
      !> Default as namelist text, or 'required', 'chosen' (by the program), '-': with others only.
      character(len=32) :: default
      !> Of a number its range as a comma-separated list of comparisons, each of which must hold
      !> (`holds`); words that are built, separated by blanks; of a logical those beside it.
      character(len=96) :: allowed
      character(len=120) :: meaning
      !> Magnitudes that contacts have, "LOWEST to LARGEST" in the unit of the key: others are
      !> reported, as most often slips of a unit; empty: all of the range.
      character(len=20) :: typical = ''
      !> With what the key is used and needed: rules of module key_rules; empty: always, never.
      character(len=96) :: used = '', needed = ''
      !> Value with &moes where none is given.
      character(len=8) :: moes_default = ''
      !> Value in the template, behind '! ' as a comment, and behind ' | ' that of dry problems if
      !> it differs; empty: the default; '!': the default as a comment.
      character(len=80) :: example = ''
      !> Key of a method, whose default is right for nearly everyone: shown apart.
      logical :: is_expert = .false.
   end type key_t

contains

   !> What a key expects, for messages and tables: "a real number > 0 [m]".
   pure function expected_value(row) result(expected)
      type(key_t), intent(in) :: row
      character(:), allocatable :: expected

      expected = trim(expectations(findloc(kinds == row%kind, .true., dim=1)))
      if (row%unit /= '') then
         if (index(row%allowed, 'one of') == 1) expected = expected // ','
         expected = expected // ' ' // trim(row%allowed) // ' [' // trim(row%unit) // ']'
      else if (row%allowed /= '') then
         if (row%kind == 'logical') expected = expected // ' or'
         expected = trim(adjustl(expected // ' ' // word_list(row%allowed)))
      end if
   end function expected_value

   !> Blank-separated words as 'a', 'b' or 'c'.
   pure function word_list(words) result(list)
      character(*), intent(in) :: words
      character(:), allocatable :: list

      list = "'" // joined(split_words(words, ' '), "', '", last="' or '") // "'"
   end function word_list

   !> The parts of `words` between `mark` and `mark`, without blanks before them.
   pure function split_words(words, mark) result(each)
      character(*), intent(in) :: words
      character(len=1), intent(in) :: mark
      character(len=len(words)), allocatable :: each(:)
      integer :: first, last

      allocate (each(0))
      first = 1
      do while (first <= len_trim(words))
         last = first + index(words(first:) // mark, mark) - 2
         each = [character(len=len(words)) :: each, adjustl(words(first:last))]
         first = last + 2
      end do
   end function split_words

   !> True if `word`, blanks behind it or not, is one of the blank-separated `words`: asked 4000
   !> times a case, so no copies.
   pure elemental logical function has_word(words, word)
      character(*), intent(in) :: words, word
      integer :: first, length

      has_word = .false.
      length = len_trim(word)
      if (length == 0) return
      do first = 1, len(words) - length + 1
         if (words(first:first) /= word(1:1)) cycle   ! it is faster than `index`
         if (words(first:first + length - 1) /= word(:length)) cycle
         has_word = words(max(first - 1, 1):first - 1) == '' &
            .and. words(first + length:min(first + length, len(words))) == ''
         if (has_word) exit
      end do
      if (has_word) has_word = index(word(:length), ' ') == 0
   end function has_word

   !> True if `value` fulfils every comparison of the comma-separated `range`, which may be empty.
   pure elemental logical function is_in_range(value, range) result(inside)
      real(wp), intent(in) :: value
      character(*), intent(in) :: range

      inside = all(holds(value, split_words(trim(range), ',')))
   end function is_in_range

   !> One comparison: "> 0", ">= 0", "< 1", "<= 1", "/= 0", "a power of two (times 3 or 5 or 7)",
   !> "one of 2 3 5", or "1e-4 to 5", the magnitude of what is not 0.
   pure elemental logical function holds(value, comparison)
      real(wp), intent(in) :: value
      character(*), intent(in) :: comparison
      real(wp) :: bound, least
      integer :: blank, last
      logical :: good

      holds = .false.
      blank = index(comparison, ' ')
      last = len_trim(comparison)
      call read_real(comparison(index(comparison(:last), ' ', back=.true.) + 1:last), bound, good)
      select case (comparison(:blank - 1))
      case ('one')
         if (abs(value) < 1.0e9_wp) holds = has_word(comparison, to_text(nint(value)))
      case ('a')
         if (value >= 1.0_wp .and. value < 1.0e9_wp) holds = any(shiftr(nint(value), &
            trailz(nint(value))) == [1, 3, 5, 7])
      case ('>')
         holds = good .and. value > bound
      case ('>=')
         holds = good .and. value >= bound
      case ('<')
         holds = good .and. value < bound
      case ('<=')
         holds = good .and. value <= bound
      case ('/=')
         holds = good .and. abs(value - bound) > 0.0_wp
      case default
         call read_real(comparison(:blank - 1), least, good)
         holds = (good .and. abs(value) >= least .and. abs(value) <= bound) &
            .or. .not. abs(value) > 0.0_wp
      end select
   end function holds

   !> A question about the unit of a `value` that no usual contact has: the prefix with which it
   !> would be typical; empty: there is none.
   pure function unit_question(row, value) result(question)
      type(key_t), intent(in) :: row
      real(wp), intent(in) :: value
      character(:), allocatable :: question
      character(len=1), parameter :: prefixes(4) = ['G', 'M', 'm', 'u']
      real(wp), parameter :: factors(4) = [1.0e9_wp, 1.0e6_wp, 1.0e-3_wp, 1.0e-6_wp]
      integer :: i

      question = ''
      if (row%typical == '' .or. value <= 0.0_wp) return
      if (row%unit == '1/Pa' .and. is_in_range(1.0e-9_wp*value, row%typical)) question = &
         '; is it in 1/GPa?'
      if (all(row%unit /= ['Pa  ', 'm   ', 'Pa s'])) return
      i = findloc(is_in_range(factors*value, row%typical), .true., dim=1)
      if (i > 0) question = '; is it in '//prefixes(i)//trim(row%unit)//'?'
   end function unit_question

end module key_row

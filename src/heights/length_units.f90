!> Units of length in files of heights: spellings, and what names such as `x_mm`, `z [um]` say.
module length_units
   use kinds, only: wp
   use text, only: quoted, to_lower
   implicit none (type, external)
   private

   public :: find_unit, known_units, settle_unit, silence_fault, unit_among, units_per_metre

   !> A unit: word in keys and messages, size, spellings in lower case (a micro sign is u).
   type :: unit_t
      character(len=8) :: word
      real(wp) :: per_metre
      character(len=40) :: spellings
   end type unit_t

   !> Relative difference of two units that are the same.
   real(wp), parameter, public :: same_unit = 1.0e-6_wp
   real(wp), parameter :: inches = 1.0_wp/0.0254_wp
   type(unit_t), parameter :: units(*) = [unit_t('m', 1.0_wp, ' m metre meter'), &
      unit_t('cm', 1.0e2_wp, ' cm centimetre centimeter'), &
      unit_t('mm', 1.0e3_wp, ' mm millimetre millimeter'), &
      unit_t('um', 1.0e6_wp, ' um micron micrometre micrometer'), &
      unit_t('nm', 1.0e9_wp, ' nm nanometre nanometer'), &
      unit_t('angstrom', 1.0e10_wp, ' angstrom'), &
      unit_t('pm', 1.0e12_wp, ' pm picometre picometer'), unit_t('in', inches, ' in inch'), &
      unit_t('mil', 1.0e3_wp*inches, ' mil thou'), &
      unit_t('uin', 1.0e6_wp*inches, ' uin uinch microinch')]
   !> The words, for the key table and messages.
   character(*), parameter :: known_units = 'm cm mm um nm angstrom pm in mil uin'
   !> Behind an underscore, a blank, a hyphen or a point these are no units, but parts of names.
   character(len=4), parameter :: names_too(*) = ['in  ', 'mil ', 'thou']
   !> There these are units, though not of a length.
   character(len=6), parameter :: other_units(*) = [character(len=6) :: 'px', 'pixel', 'pixels', &
      'mv', 'deg', 'ms', 'km', 'ft', 'counts']
   !> Micro signs and the Angstrom in UTF-8, two ways each, and in Latin-1.
   character(len=3), parameter :: signs(*) = [character(len=3) :: char(194)//char(181), &
      char(206)//char(188), char(181), char(195)//char(133), char(226)//char(132)//char(171), &
      char(195)//char(165), char(197)]
   character(len=8), parameter :: ascii(*) = [character(len=8) :: 'u', 'u', 'u', 'angstrom', &
      'angstrom', 'angstrom', 'angstrom']

contains

   !> Units in a metre of the unit that `spelling` means (0: none), and its usual `word`.
   pure subroutine units_per_metre(spelling, per_metre, word)
      character(*), intent(in) :: spelling
      real(wp), intent(out) :: per_metre
      character(:), allocatable, intent(out) :: word
      character(:), allocatable :: plain
      integer :: i

      plain = in_ascii(spelling)
      if (len(plain) > 3 .and. index(plain, 's', back=.true.) == len(plain)) plain = &
         plain(:len(plain) - 1)
      per_metre = 0.0_wp
      word = ''
      if (plain == '' .or. index(plain, ' ') > 0) return
      do i = 1, size(units)
         if (index(units(i)%spellings, ' '//plain//' ') == 0) cycle
         per_metre = units(i)%per_metre
         word = trim(units(i)%word)
      end do
   end subroutine units_per_metre

   !> Lower case without surrounding blanks, micro sign and Angstrom in letters.
   pure function in_ascii(string) result(plain)
      character(*), intent(in) :: string
      character(:), allocatable :: plain
      integer :: bytes, i, place

      plain = trim(adjustl(string))
      do i = 1, size(signs)
         bytes = len_trim(signs(i))
         place = index(plain, signs(i)(:bytes))
         if (place > 0) plain = plain(:place - 1)//trim(ascii(i))//plain(place + bytes:)
      end do
      plain = to_lower(plain)
   end function in_ascii

   !> The unit that the name of a column has, as `stated` (empty: none), and where the name ends.
   pure subroutine find_unit(name, stated, last)
      character(*), intent(in) :: name
      character(:), allocatable, intent(out) :: stated
      integer, intent(out) :: last
      character(*), parameter :: opening = '[({<', closing = '])}>'
      character(:), allocatable :: plain, word
      real(wp) :: per_metre
      integer :: first, kind

      stated = ''
      last = len_trim(name)
      if (last == 0) return
      kind = index(closing, name(last:last))
      if (kind > 0) then
         first = index(name(:last), opening(kind:kind), back=.true.)
         if (first == 0) return
         stated = trim(adjustl(name(first + 1:last - 1)))
         if (stated == '') stated = name(first:last)
      else if (index(name(:last), '/', back=.true.) > 1) then
         first = index(name(:last), '/', back=.true.)
         stated = trim(adjustl(name(first + 1:last)))
      else
         first = scan(name(:last), '_ -.,', back=.true.)
         plain = in_ascii(name(first + 1:last))
         call units_per_metre(name(first + 1:last), per_metre, word)
         if (.not. (word /= '' .and. all(names_too /= plain) .or. any(other_units == plain))) return
         stated = name(first + 1:last)
      end if
      last = len_trim(name(:first - 1))
   end subroutine find_unit

   !> The first unit of length in a comment except metre and inch, which are words; empty: none.
   pure function unit_among(comment) result(unit)
      character(*), intent(in) :: comment
      character(:), allocatable :: unit, word
      real(wp) :: per_metre
      integer :: first, length

      first = 1
      do while (first <= len(comment))
         length = scan(comment(first:)//' ', '#%,;:=[](){}<>/_"'' '//achar(9)) - 1
         unit = comment(first:first + length - 1)
         call units_per_metre(unit, per_metre, word)
         if (word /= '' .and. word /= 'm' .and. word /= 'in') return
         first = first + length + 1
      end do
      unit = ''
   end function unit_among

   !> The fault that a unit is said of positions (1) or heights (2) alone and is no metre; or empty.
   pure function silence_fault(is_silent, per_metre) result(fault)
      logical, intent(in) :: is_silent(2)
      real(wp), intent(in) :: per_metre(2)
      character(:), allocatable :: fault

      fault = ''
      if (all(is_silent) .or. .not. any(is_silent)) return
      if (abs(abs(merge(per_metre(2), per_metre(1), is_silent(1))) - 1.0_wp) > same_unit) fault = &
         'found a unit of '//trim(merge('heights  ', 'positions', is_silent(1)))// &
         ' only, expected both, or the key '//merge('x_unit', 'z_unit', is_silent(1))
   end function silence_fault

   !> The unit that a file (`stated`, empty: none) and a key (`wanted`, empty: none) say together;
   !> metres if neither does. `fault`: they contradict each other, or the file says something else
   !> and the key nothing. `place` says where in the file, `key` is the name of the key.
   pure subroutine settle_unit(stated, wanted, place, key, per_metre, fault)
      character(*), intent(in) :: stated, wanted, place, key
      real(wp), intent(out) :: per_metre
      character(:), allocatable, intent(out) :: fault
      character(:), allocatable :: in_file, in_key
      real(wp) :: other

      fault = ''
      call units_per_metre(stated, per_metre, in_file)
      call units_per_metre(wanted, other, in_key)
      if (in_file == '' .and. in_key == '' .and. stated /= '') then
         fault = 'found the unit '//quoted(stated)//' in '//place//', expected one of '// &
            known_units//', or the key '//key
      else if (in_file /= '' .and. in_key /= '' .and. in_file /= in_key) then
         fault = 'found the unit '//quoted(stated)//' in '//place//', but '//key//" = '"//in_key// &
            "', expected the same of both"
      else if (in_file == '') then
         per_metre = other
         if (in_key == '') per_metre = 1.0_wp
      end if
   end subroutine settle_unit

end module length_units

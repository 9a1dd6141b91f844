!> Hints about mistyped names, and about values in a form that a namelist does not have.
module value_hints
   implicit none (type, external)
   private

   public :: answer_to, edit_distance, form_hint, nearest_known

   !> What words of a name that engineers look for begin with (with _ behind it: one of its words),
   !> and what to do instead.
   type :: answer_t
      character(len=12) :: part
      character(len=112) :: text
   end type answer_t

   type(answer_t), parameter :: answers(*) = [ &
      answer_t('point_', "problem = 'ehl_point' is for balls and crowned rollers"), &
      answer_t('ellip', "problem = 'ehl_point' has ellipses: radius_x_1, radius_y_1, ..."), &
      answer_t('target_p_max', 'target holds for p_max too, on the graded grid of a steady '// &
         'contact'), &
      answer_t('thesis', "'upwind2' is its new name"), &
      answer_t('sharp', "'kappa' is its new name"), &
      answer_t('parabola', 'with oil the radii of &bodies give it'), &
      answer_t('coating', 'coatings are not built: the bodies are homogeneous half-spaces'), &
      answer_t('layer', 'layers are not built: the bodies are homogeneous half-spaces'), &
      answer_t('temperature', 'give temperature [degC] of the inlet in &lubricant, with '// &
         'viscosity_grade, or in &thermal'), &
      answer_t('heat', 'give temperature [degC] of the inlet in &thermal'), &
      answer_t('grade', 'give viscosity_grade in &lubricant, the ISO VG class, with temperature'), &
      answer_t('mixed', 'give the law of the rough surfaces in &asperities'), &
      answer_t('friction', 'friction is a result: /summary/friction_coefficient'), &
      answer_t('grease', 'grease is not built: give the base oil, and &supply for starvation'), &
      answer_t('load_', 'give loads that vary in a table, &history file'), &
      answer_t('wear', 'wear and running-in are not built'), &
      answer_t('rpm', 'give the speeds of the surfaces [m/s]: 2 pi rpm/60 times the radius'), &
      answer_t('omega', 'give the speeds of the surfaces [m/s]: omega times the radius'), &
      answer_t('young', 'youngs_modulus_1 and youngs_modulus_2, or reduced_modulus'), &
      answer_t('diameter', 'give radius_1 and radius_2, or reduced_radius')]

   character(*), parameter :: digits = '0123456789'
   character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'

contains

   !> What `values`, the text of an entry that should have one value, or another number of values,
   !> seem to mean; empty: no idea. `is_whole`: its numbers have no decimals.
   pure function form_hint(values, is_whole) result(hint)
      character(*), intent(in) :: values
      logical, intent(in) :: is_whole
      character(:), allocatable :: hint, number, rest

      hint = ''
      rest = trim(adjustl(values(scan(values, ' ') + 1:)))
      number = trim(values)
      if (index(number, ',', back=.true.) == len(number)) number = trim(number(:len(number) - 1))
      if (scan(number(:1), '+-') > 0) number = number(2:)
      if (index(values, '#') > 0) then
         hint = '; a comment begins with !'
      else if (index(values, '*') > 0) then
         hint = '; n*value is a value n times, nothing is multiplied'
      else if (has_groups(number, is_whole)) then
         hint = '; the digits of a number are not grouped by commas'
      else if (has_decimal_comma(number)) then
         hint = '; numbers have a decimal point, not a comma'
      else if (scan(values(1:1), digits//'+-.') > 0 .and. scan(values, ' ') > 0 &
         .and. scan(rest, letters) == 1 .and. scan(rest, ' :,=') == 0 .and. len(rest) <= 4) then
         hint = '; the unit is not written behind the number'
      end if
   end function form_hint

   !> Whether a text is one number without a sign but for its one comma: digits in front of it,
   !> digits and an exponent behind it.
   pure logical function has_decimal_comma(text) result(has)
      character(*), intent(in) :: text
      integer :: comma, last

      has = .false.
      comma = index(text, ',')
      if (comma < 2 .or. comma == len(text)) return
      last = comma + verify(text(comma + 1:)//' ', digits) - 1
      has = verify(text(:comma - 1), digits//'.') == 0 .and. last > comma &
         .and. scan(text(comma - 1:comma - 1), digits) > 0 .and. verify(text(last + 1:), &
         digits//'eEdD+-') == 0 .and. scan(text(last + 1:), 'eEdD+-') <= 1
   end function has_decimal_comma

   !> Whether a text is one number without a sign but for commas between its digits, three by three:
   !> several commas, one in front of a decimal point, or one in a whole number.
   pure logical function has_groups(text, is_whole) result(has)
      character(*), intent(in) :: text
      logical, intent(in) :: is_whole
      character(:), allocatable :: decimals, whole
      integer :: commas, i

      decimals = text(index(text//'.', '.'):)
      whole = text(:len(text) - len(decimals))
      commas = count([(whole(i:i) == ',', i=1, len(whole))])
      has = commas > 0 .and. (decimals /= '' .or. is_whole .or. commas > 1) &
         .and. verify(decimals, digits//'.') == 0 .and. scan(whole, ',') /= 1
      do i = 1, len(whole)   ! every fourth from the last is a comma
         has = has .and. merge(whole(i:i) == ',', scan(whole(i:i), digits) > 0, &
            modulo(len(whole) - i, 4) == 3)
      end do
   end function has_groups

   !> What to do instead of a key or word that is not there; empty: no idea.
   pure function answer_to(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(answers)
         if (index('_'//name//'_', '_'//trim(answers(i)%part)) > 0) text = trim(answers(i)%text)
      end do
   end function answer_to

   !> The name nearest to `name` by edit distance; empty if none is within a third of its letters.
   pure function nearest_known(name, names) result(found)
      character(*), intent(in) :: name, names(:)
      character(:), allocatable :: found
      integer :: i, distance, smallest

      found = ''
      if (len(name) > 40) return
      smallest = max(1, len(name)/3) + 1
      do i = 1, size(names)
         if (names(i) == '') cycle
         distance = edit_distance(name, trim(names(i)))
         if (distance >= smallest) cycle
         smallest = distance
         found = trim(names(i))
      end do
   end function nearest_known

   !> Fewest insertions, deletions, replacements and swaps of neighbours that turn `a` into `b`.
   pure function edit_distance(a, b) result(distance)
      character(*), intent(in) :: a, b
      integer :: distance, i, j, cost, d(0:len(a), 0:len(b))

      d(:, 0) = [(i, i=0, len(a))]
      d(0, :) = [(j, j=0, len(b))]
      do j = 1, len(b)
         do i = 1, len(a)
            cost = merge(0, 1, a(i:i) == b(j:j))
            d(i, j) = min(d(i - 1, j) + 1, d(i, j - 1) + 1, d(i - 1, j - 1) + cost)
            if (i > 1 .and. j > 1) then
               if (a(i:i) == b(j - 1:j - 1) .and. a(i - 1:i - 1) == b(j:j)) d(i, &
                  j) = min(d(i, j), d(i - 2, j - 2) + 1)
            end if
         end do
      end do
      distance = d(len(a), len(b))
   end function edit_distance

end module value_hints

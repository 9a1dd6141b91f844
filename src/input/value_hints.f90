!> Hints about values that are written as elsewhere, but not in a namelist.
module value_hints
   implicit none (type, external)
   private

   public :: form_hint

   character(*), parameter :: digits = '0123456789'
   character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ'

contains

   !> What `values`, the text of an entry that should have one value, seem to mean; empty: no idea.
   pure function form_hint(values) result(hint)
      character(*), intent(in) :: values
      character(:), allocatable :: hint
      character(:), allocatable :: rest
      integer :: comma

      hint = ''
      comma = index(values, ',')
      rest = trim(adjustl(values(scan(values, ' ') + 1:)))
      if (index(values, '#') > 0) then
         hint = '; a comment begins with !'
      else if (index(values, '*') > 0) then
         hint = '; n*value is a value n times, nothing is multiplied'
      else if (comma > 1 .and. comma < len(values) .and. verify(values, digits//',+-eE.') == 0 &
         .and. index(values, ',', back=.true.) == comma) then
         hint = '; numbers have a decimal point, not a comma'
      else if (scan(values(1:1), digits//'+-.') > 0 .and. scan(values, ' ') > 0 &
         .and. scan(rest, letters) == 1 .and. scan(rest, ' :,=') == 0 .and. len(rest) <= 4) then
         hint = '; the unit is not written behind the number'
      end if
   end function form_hint

end module value_hints

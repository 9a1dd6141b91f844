!> Ranges of the key table, "> 0, <= 0.5", "a power of two (times 3 or 5 or 7)" or "1e-4 to 5", as
!> a test.
module key_range
   use kinds, only: wp
   use number_text, only: read_real
   implicit none (type, external)
   private

   public :: is_in_range, is_typical

contains

   !> True if `value` fulfils every comparison of the comma-separated `range`; true for an empty
   !> range.
   pure function is_in_range(value, range) result(inside)
      real(wp), intent(in) :: value
      character(*), intent(in) :: range
      logical :: inside
      integer :: start, length

      inside = .true.
      start = 1
      do while (start <= len_trim(range) .and. inside)
         length = index(range(start:), ',') - 1
         if (length < 0) length = len_trim(range(start:))
         inside = holds(value, trim(adjustl(range(start:start + length - 1))))
         start = start + length + 1
      end do
   end function is_in_range

   !> True if `value` is 0, or its magnitude within the `typical` range "LOWEST to LARGEST".
   pure elemental function is_typical(value, typical) result(inside)
      real(wp), intent(in) :: value
      character(*), intent(in) :: typical
      logical :: inside
      real(wp) :: lowest, largest
      integer :: middle
      logical :: good(2)

      middle = index(typical, ' to ')
      call read_real(typical(:middle - 1), lowest, good(1))
      call read_real(trim(typical(middle + 4:)), largest, good(2))
      inside = all(good) .and. abs(value) >= lowest .and. abs(value) <= largest
      inside = inside .or. .not. abs(value) > 0.0_wp
   end function is_typical

   !> One comparison: "> 0", ">= 0", "< 1", "<= 1", "/= 0" or "a power of two (times 3 or 5 or 7)".
   pure function holds(value, comparison)
      real(wp), intent(in) :: value
      character(*), intent(in) :: comparison
      logical :: holds
      real(wp) :: bound
      integer :: blank, number
      logical :: good

      blank = index(comparison, ' ')
      holds = .false.
      if (comparison == 'a power of two (times 3 or 5 or 7)') then
         if (value < 1.0_wp .or. value >= 1.0e9_wp) return
         number = nint(value)
         holds = any(shiftr(number, trailz(number)) == [1, 3, 5, 7])
         return
      end if
      call read_real(trim(comparison(blank + 1:)), bound, good)
      if (.not. good) return
      select case (comparison(:blank - 1))
      case ('>')
         holds = value > bound
      case ('>=')
         holds = value >= bound
      case ('<')
         holds = value < bound
      case ('<=')
         holds = value <= bound
      case ('/=')
         holds = value < bound .or. value > bound
      case default
         return
      end select
   end function holds

end module key_range

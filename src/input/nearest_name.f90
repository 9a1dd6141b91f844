!> The known name nearest to a mistyped one.
module nearest_name
   implicit none (type, external)
   private

   public :: nearest_known, edit_distance

contains

   !> The name of `names` with the smallest edit distance to `name`; empty if none is near (a third
   !> of its letters).
   pure function nearest_known(name, names) result(found)
      character(*), intent(in) :: name
      character(*), intent(in) :: names(:)
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
      integer :: distance
      integer :: i, j, cost
      integer :: d(0:len(a), 0:len(b))

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

end module nearest_name

!> Equal shares of work for threads.
module work_shares
   use, intrinsic :: iso_fortran_env, only: int64
   implicit none (type, external)
   private

   public :: share_end

contains

   !> The last of `items` items, counted from 1, that thread `share` of `shares` works on; its first
   !> is the one after share_end(share - 1, ...), and share_end(0, ...) is 0.
   pure elemental integer function share_end(share, shares, items)
      integer, intent(in) :: share, shares, items

      share_end = int(share*int(items, int64)/shares)
   end function share_end

end module work_shares

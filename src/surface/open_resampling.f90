!> Resamples heights of an open surface, given at cell centres, to another number of cells.
module open_resampling
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: interpolate_heights

contains

   !> Interpolates the heights `z` (nx*ny) from the cell centres of the grid `old` = nx, ny (4 or
   !> more cells in a direction, or 1) to those of the grid `new` of the same lengths, by the cubic
   !> through four neighbours in each direction.
   pure subroutine interpolate_heights(old, new, z)
      integer, intent(in) :: old(2), new(2)
      real(wp), allocatable, intent(inout) :: z(:)
      real(wp), allocatable :: rows(:)
      real(wp) :: weights(0:3)
      integer :: first, i, j, k

      allocate (rows(new(1)*old(2)), source=0.0_wp)
      do i = 1, new(1)
         call neighbours(i, old(1), new(1), first, weights)
         do k = 0, min(3, old(1) - 1)
            rows(i::new(1)) = rows(i::new(1)) + weights(k)*z(first + k::old(1))
         end do
      end do
      deallocate (z)
      allocate (z(new(1)*new(2)), source=0.0_wp)
      do j = 1, new(2)
         call neighbours(j, old(2), new(2), first, weights)
         associate (row => z(new(1)*(j - 1) + 1:new(1)*j))
            do k = 0, min(3, old(2) - 1)
               row = row + weights(k)*rows(new(1)*(first + k - 1) + 1:new(1)*(first + k))
            end do
         end associate
      end do
   end subroutine interpolate_heights

   !> Finds the `first` of the four old cells around the centre of the new cell `i`, and the
   !> Lagrange weights of all four; for a single old cell the first weight alone.
   pure subroutine neighbours(i, old, new, first, weights)
      integer, intent(in) :: i, old, new
      integer, intent(out) :: first
      real(wp), intent(out) :: weights(0:3)
      real(wp) :: t

      first = 1
      weights = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      if (old == 1) return
      t = (real(i, wp) - 0.5_wp)*old/new + 0.5_wp
      first = min(max(int(t) - 1, 1), old - 3)
      t = t - first
      weights = [-(t - 1)*(t - 2)*(t - 3)/6, t*(t - 2)*(t - 3)/2, -t*(t - 1)*(t - 3)/2, &
         t*(t - 1)*(t - 2)/6]
   end subroutine neighbours

end module open_resampling

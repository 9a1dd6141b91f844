!> Resamples heights to another number of nodes: periodic ones by the same Fourier series, as far as
!> both grids can carry it; those of an open surface, given at cell centres, by cubics.
module resampling
   use grid_transform, only: transform_back, transform_field
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: interpolate_heights, resample_heights

contains

   !> Resamples periodic heights `z` (nx*ny) from the grid `old` = nx, ny to `new` of the same
   !> lengths; both have a node at 0, or lie `at_centres` of cells, the first half a spacing from 0.
   !>
   !> More nodes interpolate: heights at shared nodes stay. Fewer nodes drop the harmonics from half
   !> their number on. The highest harmonic of an even number of old nodes is treated as a cosine,
   !> half of it at +n/2 and half at -n/2.
   subroutine resample_heights(old, new, z, at_centres)
      integer, intent(in) :: old(2), new(2)
      real(wp), allocatable, intent(inout) :: z(:)
      logical, intent(in), optional :: at_centres
      complex(wp), allocatable :: coarse(:, :), spectrum(:, :)
      real(wp) :: angle, nodes, share_x, share_y, shift(2)
      integer :: k, l

      ! Periods from the first old node to the first new one.
      shift = 0.0_wp
      if (present(at_centres)) shift = merge(0.5_wp/new - 0.5_wp/old, 0.0_wp, at_centres)
      call transform_field(old, z, coarse)
      nodes = real(old(1), wp)*real(old(2), wp)
      allocate (spectrum(0:new(1)/2, 0:new(2) - 1))
      do l = 0, new(2) - 1
         share_y = share_of(signed(l, new(2)), old(2), new(2))
         do k = 0, new(1)/2
            share_x = share_of(k, old(1), new(1))
            spectrum(k, l) = (0.0_wp, 0.0_wp)
            if (share_x*share_y > 0.0_wp) spectrum(k, l) = share_x*share_y/nodes*coarse(k, &
               modulo(signed(l, new(2)), old(2)))
            angle = 2.0_wp*pi*(k*shift(1) + signed(l, new(2))*shift(2))
            if (abs(angle) > 0.0_wp) spectrum(k, l) = spectrum(k, l)*cmplx(cos(angle), &
               sin(angle), wp)
         end do
      end do
      call transform_back(new, spectrum, z)
   end subroutine resample_heights

   !> Share of the old harmonic `k` that goes to the new one.
   pure real(wp) function share_of(k, old, new) result(share)
      integer, intent(in) :: k, old, new

      share = 0.0_wp
      if (old == new .or. 2*abs(k) < min(old, new)) then
         share = 1.0_wp
      else if (2*abs(k) == old .and. old < new) then
         share = 0.5_wp
      end if
   end function share_of

   !> Harmonic, negative in the second half, at position `l` in a spectrum of `n`.
   pure integer function signed(l, n) result(k)
      integer, intent(in) :: l, n

      k = merge(l, l - n, 2*l <= n)
   end function signed

   !> Interpolates heights `z` (nx*ny) from the cell centres of the grid `old` (4 or more in nx, ny,
   !> or 1) to those of `new` on the same lengths, by cubics through four neighbours.
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

end module resampling

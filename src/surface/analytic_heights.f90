!> Heights of surfaces given by formulas, at the nodes of a dry contact: ridges, dents, sinusoids,
!> parabolas.
module analytic_heights
   use features, only: feature_t, rough_surface_t, surface_height
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: node_positions, feature_heights, parabola_heights

contains

   !> Positions of `n` nodes on a domain of `length` [m]: i L/N if periodic, else cell centres
   !> (i + 1/2) L/N - L/2.
   pure function node_positions(n, length, is_periodic) result(x)
      integer, intent(in) :: n
      real(wp), intent(in) :: length
      logical, intent(in) :: is_periodic
      real(wp) :: x(n)
      integer :: i

      if (is_periodic) then
         x = [(length*real(i, wp)/n, i=0, n - 1)]
      else
         x = [(length*((real(i, wp) + 0.5_wp)/n - 0.5_wp), i=0, n - 1)]
      end if
   end function node_positions

   !> Heights (nx*ny) of `features` [m], the same at every y; on a periodic domain each node uses
   !> the nearest image of a feature. `x` (nx) are positions, `length` that of the domain [m].
   function feature_heights(features, x, ny, length, is_periodic) result(z)
      type(feature_t), intent(in) :: features(:)
      real(wp), intent(in) :: x(:), length
      integer, intent(in) :: ny
      logical, intent(in) :: is_periodic
      real(wp) :: z(size(x)*ny)
      type(rough_surface_t) :: one
      real(wp) :: row(size(x))
      integer :: i, j

      row = 0.0_wp
      one%speed = 0.0_wp
      do i = 1, size(features)
         one%features = [features(i)]
         one%features(1)%position = 0.0_wp
         row = row + surface_height(one, nearest_image(x - features(i)%position, length, &
            is_periodic), 0.0_wp)
      end do
      do j = 1, ny
         z((j - 1)*size(x) + 1:j*size(x)) = row
      end do
   end function feature_heights

   !> Heights (nx*ny) of a parabola -(x^2 + y^2)/(2 R) [m] with its top at x = y = 0; a line has
   !> `y` = [0].
   pure function parabola_heights(radius, x, y, lengths, is_periodic) result(z)
      real(wp), intent(in) :: radius, x(:), y(:), lengths(2)
      logical, intent(in) :: is_periodic
      real(wp) :: z(size(x)*size(y))
      integer :: j

      do j = 1, size(y)
         z((j - 1)*size(x) + 1:j*size(x)) = -(nearest_image(x, lengths(1), is_periodic)**2 &
            + nearest_image(y(j), lengths(2), is_periodic)**2)/(2.0_wp*radius)
      end do
   end function parabola_heights

   !> `distance`, on a periodic domain to the nearest image, -L/2 ... L/2; a direction without
   !> `length` has no images.
   pure elemental real(wp) function nearest_image(distance, length, is_periodic)
      real(wp), intent(in) :: distance, length
      logical, intent(in) :: is_periodic

      nearest_image = distance
      if (is_periodic .and. length > 0.0_wp) nearest_image = modulo(distance + 0.5_wp*length, &
         length) - 0.5_wp*length
   end function nearest_image

end module analytic_heights

!> Surfaces with features that are given by formulas and move with the surface in x, and heights at
!> the nodes of a dry contact: ridges, dents, sinusoids, parabolas.
module features
   use kinds, only: pi, wp
   use profile, only: profile_height, profile_t, row_at, smooth_ramp
   use time_table, only: time_table_t
   implicit none (type, external)
   private

   public :: displacement, feature_heights, node_positions, parabola_heights, surface_height

   !> The ridge (amplitude > 0) or dent (< 0) of (5.4).
   integer, parameter, public :: feature_ridge = 1
   !> A cos(2 pi (x - xc)/Lambda), infinitely long.
   integer, parameter, public :: feature_sinusoid = 2

   !> Beyond this many squared wavelengths from its centre a ridge is zero (10^-200).
   real(wp), parameter :: ridge_reach = 20.0_wp

   !> One feature; lengths in any unit, the same for position, wavelength and x.
   type, public :: feature_t
      !> `feature_ridge` or `feature_sinusoid`.
      integer :: kind
      !> Height A at the centre, in the unit of the heights.
      real(wp) :: amplitude
      !> Lambda > 0.
      real(wp) :: wavelength
      !> Centre at time 0.
      real(wp) :: position
      !> Whether `position` is known; else it is chosen when the surface is put into a contact.
      logical :: is_placed = .true.
      !> Wavelength and centre across; 0: the same at all y.
      real(wp) :: wavelength_y = 0.0_wp, position_y = 0.0_wp
   end type feature_t

   !> A surface: the sum of its features; none (size 0 or not allocated) = smooth. In a contact it
   !> is dimensionless: heights in b^2/R, lengths in b, speed 2 u_i/u_s per unit of T.
   type, public :: rough_surface_t
      type(feature_t), allocatable :: features(:)
      !> Speed at which the features move in x.
      real(wp) :: speed
      !> Half of the speed over time, if it changes; `speed` is then that at the largest u1 + u2.
      type(time_table_t), allocatable :: course
      !> Measured or synthetic heights, which move with the features.
      type(profile_t), allocatable :: profile
      !> Smooth entry: everything rises over this length behind a front that moves with the surface
      !> from `entry_position` at time 0; at rest over this time. 0: present from the start.
      real(wp) :: entry_length = 0.0_wp
      real(wp) :: entry_position = 0.0_wp
   end type rough_surface_t

contains

   !> Height psi of the surface at `x` (n), `y` (0 if it is not present) and `time`, positive out of
   !> the material: a ridge closes the gap.
   !>
   !> Enters the film thickness with a minus, H = ... - Psi_1 - Psi_2; (2.24) and (2.58) print a
   !> plus, against (2.72), (A.27) and the text of chapter 6.
   pure function surface_height(surface, x, time, y) result(psi)
      type(rough_surface_t), intent(in) :: surface
      real(wp), intent(in) :: x(:), time
      real(wp), intent(in), optional :: y
      real(wp) :: psi(size(x))
      real(wp) :: across, way
      integer :: i

      psi = 0.0_wp
      way = displacement(surface, time)
      if (allocated(surface%features)) then
         do i = 1, size(surface%features)
            associate (feature => surface%features(i))
               across = 0.0_wp
               if (present(y) .and. feature%wavelength_y > 0.0_wp) across = (y &
                  - feature%position_y)/feature%wavelength_y
               call add_feature(feature, x - (feature%position + way), across, psi)
            end associate
         end do
      end if
      if (allocated(surface%profile)) then
         if (allocated(surface%profile%rows) .and. present(y)) then
            psi = psi + profile_height(row_at(surface%profile, y), x - way)
         else
            psi = psi + profile_height(surface%profile, x - way)
         end if
      end if
      if (surface%entry_length > 0.0_wp) psi = psi*entered_share(surface, x, time)
   end function surface_height

   !> Distance that a surface has moved by `time`: the integral of its speed.
   pure real(wp) function displacement(surface, time) result(way)
      type(rough_surface_t), intent(in) :: surface
      real(wp), intent(in) :: time

      way = surface%speed*time
      if (allocated(surface%course)) way = 2*surface%course%integral(time)
   end function displacement

   !> Share to which an entering surface has risen: from 0 at its front to 1 `entry_length` behind.
   pure elemental real(wp) function entered_share(surface, x, time) result(share)
      type(rough_surface_t), intent(in) :: surface
      real(wp), intent(in) :: x, time
      real(wp) :: behind

      behind = time
      if (abs(surface%speed) > 0.0_wp) behind = sign(1.0_wp, surface%speed) &
         *(surface%entry_position + displacement(surface, time) - x)
      share = smooth_ramp(behind/surface%entry_length)
   end function entered_share

   !> Adds the heights of a feature at distances (n) from its centre and so many waves `across`.
   pure subroutine add_feature(feature, distance, across, psi)
      type(feature_t), intent(in) :: feature
      real(wp), intent(in), contiguous :: distance(:)
      real(wp), intent(in) :: across
      real(wp), intent(inout), contiguous :: psi(:)
      integer :: i

      select case (feature%kind)
      case (feature_ridge)
         do i = 1, size(psi)
            psi(i) = psi(i) + ridge(feature%amplitude, distance(i)/feature%wavelength, across)
         end do
      case (feature_sinusoid)
         psi = psi + feature%amplitude*cos(2.0_wp*pi*across)*cos(2.0_wp*pi*distance &
            /feature%wavelength)
      case default
         error stop 'add_feature: a feature without its case'
      end select
   end subroutine add_feature

   !> Ridge of (5.4), (A.9):  A 10^(-10 s^2) cos(2 pi s) at `waves` (x - xc)/Lambda and `across`
   !> (y - yc)/Lambda_y from its centre [-], s^2 the sum of their squares.
   !>
   !> C. H. Venner and A. A. Lubrecht, J. Tribol. 116, 1994, 186. `amplitude` A > 0 ridge, < 0 dent.
   !> Without a branch, so that the loop is vectorised.
   pure elemental function ridge(amplitude, waves, across) result(height)
      real(wp), intent(in) :: amplitude, waves, across
      real(wp) :: height, is_near, s

      s = sqrt(waves**2 + across**2)
      is_near = 0.5_wp + sign(0.5_wp, ridge_reach - s**2)
      s = is_near*s
      height = is_near*amplitude*exp(-10.0_wp*log(10.0_wp)*s**2)*cos(2.0_wp*pi*s)
   end function ridge

   !> Positions [m] of `n` nodes on a `length`: i L/N if periodic, else (i + 1/2) L/N - L/2.
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
      real(wp) :: row(size(x))
      integer :: i

      row = 0.0_wp
      do i = 1, size(features)
         call add_feature(features(i), nearest_image(x - features(i)%position, length, &
            is_periodic), 0.0_wp, row)
      end do
      z = reshape(spread(row, 2, ny), [size(z)])
   end function feature_heights

   !> Heights (nx*ny) of a parabola -(x^2 + y^2)/(2 R) [m]; a line has `y` = [0].
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

   !> `distance`, on a periodic domain of some `length` L to the nearest image, -L/2 ... L/2.
   pure elemental real(wp) function nearest_image(distance, length, is_periodic)
      real(wp), intent(in) :: distance, length
      logical, intent(in) :: is_periodic

      nearest_image = distance
      if (is_periodic .and. length > 0.0_wp) nearest_image = modulo(distance + 0.5_wp*length, &
         length) - 0.5_wp*length
   end function nearest_image

end module features

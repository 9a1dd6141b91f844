!> Surfaces with features that are given by formulas and move with the surface in x.
module features
   use kinds, only: pi, wp
   use profile, only: profile_height, profile_t, row_at, smooth_ramp
   use time_table, only: time_table_t
   implicit none (type, external)
   private

   public :: displacement, surface_height

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
      !> and is at `entry_position` at time 0; on a surface at rest over this time. 0: everything is
      !> present from the start.
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

   !> Share to which a surface that enters has risen: 0 before the front, 1 from `entry_length`
   !> behind it on.
   pure elemental real(wp) function entered_share(surface, x, time) result(share)
      type(rough_surface_t), intent(in) :: surface
      real(wp), intent(in) :: x, time

      if (surface%speed > 0.0_wp) then
         share = smooth_ramp((surface%entry_position + displacement(surface, time) &
            - x)/surface%entry_length)
      else if (surface%speed < 0.0_wp) then
         share = smooth_ramp((x - surface%entry_position - displacement(surface, &
            time))/surface%entry_length)
      else
         share = smooth_ramp(time/surface%entry_length)
      end if
   end function entered_share

   !> Adds the heights of one feature at the distances (n) from its present centre, and so many
   !> waves `across`.
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

end module features

!> A measured or synthetic profile: heights at equal distances, between which a cubic runs.
module profile
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: profile_height, profile_t, smooth_ramp

   !> Lengths in any unit, the same for spacing, start and x.
   type :: profile_t
      !> Heights (n), n >= 2, positive out of the material.
      real(wp), allocatable :: heights(:)
      !> Distance of the heights, > 0.
      real(wp) :: spacing = 1.0_wp
      !> Position of the first height at time 0.
      real(wp) :: start = 0.0_wp
      !> The profile repeats itself with the period n*spacing; else it is smooth outside.
      logical :: is_periodic = .false.
      !> At both ends of a profile that does not repeat the heights fade out over this length.
      real(wp) :: end_length = 0.0_wp
      !> Wavelength of the finest waves that are in it.
      real(wp) :: finest_wave = 0.0_wp
      !> `start` is known; else it is chosen where the surface is put into a contact.
      logical :: is_placed = .true.
   end type profile_t

contains

   !> Height of the profile at `x` (m), which must count from where the profile is at time 0.
   !>
   !> Between two heights the cubic of Catmull and Rom (1974): through the heights, with the slope of the neighbours there.
   pure function profile_height(profile, x) result(z)
      type(profile_t), intent(in) :: profile
      real(wp), intent(in) :: x(:)
      real(wp) :: z(size(x))
      real(wp) :: nodes, s, t, h(4), last
      integer :: i, k, n

      n = size(profile%heights)
      last = real(n - 1, wp)
      z = 0.0_wp
      do i = 1, size(x)
         nodes = (x(i) - profile%start)/profile%spacing
         if (profile%is_periodic) nodes = modulo(nodes, real(n, wp))
         if (.not. profile%is_periodic .and. (nodes < 0.0_wp .or. nodes > last)) cycle
         k = min(int(nodes), n - 1)
         t = nodes - k
         h = profile%heights(neighbours(k, n, profile%is_periodic))
         z(i) = h(2) + 0.5_wp*t*(h(3) - h(1) + t*(2*h(1) - 5*h(2) + 4*h(3) - h(4) + t*(3*(h(2) - h(3)) + h(4) - h(1))))
         if (profile%is_periodic .or. .not. profile%end_length > 0.0_wp) cycle
         s = min(nodes, last - nodes)*profile%spacing/profile%end_length
         z(i) = z(i)*smooth_ramp(s)
      end do
   end function profile_height

   !> The heights before, at, behind and two behind node `k` (0 = the first).
   pure function neighbours(k, n, is_periodic) result(place)
      integer, intent(in) :: k, n
      logical, intent(in) :: is_periodic
      integer :: place(4)

      place = [k - 1, k, k + 1, k + 2]
      if (is_periodic) then
         place = modulo(place, n) + 1
      else
         place = min(max(place, 0), n - 1) + 1
      end if
   end function neighbours

   !> 0 up to s = 0, 1 from s = 1 on, between them a rise with continuous slope and curvature.
   pure elemental function smooth_ramp(s) result(share)
      real(wp), intent(in) :: s
      real(wp) :: share
      real(wp) :: t

      t = min(max(s, 0.0_wp), 1.0_wp)
      share = t**3*(10.0_wp - t*(15.0_wp - 6.0_wp*t))
   end function smooth_ramp

end module profile

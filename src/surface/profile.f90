!> A measured or synthetic profile: equally spaced heights joined by a cubic.
!>
!> A long profile stays in its source; only a window of its heights is held, which `load_window`
!> moves. The profile does not depend on the window, to the bit.
module profile
   use errors, only: error_t
   use height_form, only: form_t, subtract_form
   use kinds, only: int64, wp
   implicit none (type, external)
   private

   public :: height_source_t, load_window, profile_height, profile_length, profile_t, row_at, &
      smooth_ramp

   !> Source of equally spaced heights 0 ... nodes - 1, too many for memory: any part, in any order.
   type, abstract :: height_source_t
      integer(int64) :: nodes = 0_int64
   contains
      !> Returns heights [m] from number `first` on, as many as `z` has.
      procedure(get_interface), deferred :: get
   end type height_source_t

   abstract interface

      !> The same part always gives the same bits. Error: the source cannot provide it.
      subroutine get_interface(self, first, z, error)
         import :: error_t, height_source_t, int64, wp
         class(height_source_t), intent(in) :: self
         integer(int64), intent(in) :: first
         real(wp), contiguous, intent(out) :: z(:)
         type(error_t), allocatable, intent(out) :: error
      end subroutine get_interface

   end interface

   !> Lengths in any unit, the same for spacing, start and x.
   type :: profile_t
      !> Heights of the window (m), positive out of the material; without a source all, 2 or more.
      real(wp), allocatable :: heights(:)
      !> Number of the first height of the window; those of the profile count from 0.
      integer(int64) :: first = 0_int64
      !> Source of the heights, the form that is taken off them, unit [m] of those in the window.
      class(height_source_t), allocatable :: source
      type(form_t) :: form
      real(wp) :: unit = 1.0_wp
      !> Fewest heights in a window, if the profile has them.
      integer(int64) :: window = 32768_int64
      !> Spacing of the heights, > 0.
      real(wp) :: spacing = 1.0_wp
      !> Position of the first height at time 0.
      real(wp) :: start = 0.0_wp
      !> Whether the profile repeats with the period n*spacing; else it is smooth outside.
      logical :: is_periodic = .false.
      !> At both ends of a profile that does not repeat, the heights fade out over this length.
      real(wp) :: end_length = 0.0_wp
      !> Wavelength of its finest waves.
      real(wp) :: finest_wave = 0.0_wp
      !> Of an area: heights (n, rows), `heights` its middle row; spacing of rows, y of the first.
      real(wp), allocatable :: rows(:, :)
      real(wp) :: row_spacing = 1.0_wp, first_row = 0.0_wp
      !> Whether `start` was given; else it is chosen when the surface is put into a contact.
      logical :: is_placed = .true.
   end type profile_t

contains

   !> Height of the profile at `x`, in its frame at time 0, which must lie in the window. Between
   !> two heights the cubic of Catmull and Rom (1974): through them, with the slope of neighbours.
   pure function profile_height(profile, x) result(z)
      type(profile_t), intent(in) :: profile
      real(wp), intent(in) :: x(:)
      real(wp) :: z(size(x)), nodes, s, t, h(4), last
      integer(int64) :: k, n, place(4)
      integer :: i

      n = node_count(profile)
      last = real(n - 1, wp)
      z = 0.0_wp
      do i = 1, size(x)
         nodes = (x(i) - profile%start)/profile%spacing
         if (profile%is_periodic) nodes = modulo(nodes, real(n, wp))
         if (.not. profile%is_periodic .and. (nodes < 0.0_wp .or. nodes > last)) cycle
         k = min(int(nodes, int64), n - 1)
         t = nodes - k
         place = [k - 1, k, k + 1, k + 2]   ! the heights before, at, behind and two behind k
         if (profile%is_periodic) then
            place = modulo(place - profile%first, n) + 1
         else
            place = min(max(place, 0_int64), n - 1) - profile%first + 1
         end if
         h = profile%heights(place)
         z(i) = h(2) + 0.5_wp*t*(h(3) - h(1) + t*(2*h(1) - 5*h(2) + 4*h(3) - h(4) &
            + t*(3*(h(2) - h(3)) + h(4) - h(1))))
         if (profile%is_periodic .or. .not. profile%end_length > 0.0_wp) cycle
         s = min(nodes, last - nodes)*profile%spacing/profile%end_length
         z(i) = z(i)*smooth_ramp(s)
      end do
   end function profile_height

   !> The profile of an area at `y`, between rows by the cubic of `profile_height`; an area that
   !> does not repeat fades out at its sides as it does at its ends.
   pure function row_at(area, y) result(row)
      type(profile_t), intent(in) :: area
      real(wp), intent(in) :: y
      type(profile_t) :: row, across
      real(wp) :: weights(1)
      integer :: k(4), m, nearest, rows

      rows = size(area%rows, 2)
      row%spacing = area%spacing
      row%start = area%start
      row%is_periodic = area%is_periodic
      row%end_length = area%end_length
      allocate (row%heights(size(area%rows, 1)), source=0.0_wp)
      across%spacing = area%row_spacing
      across%start = area%first_row
      across%is_periodic = area%is_periodic
      across%end_length = area%end_length
      allocate (across%heights(rows), source=0.0_wp)
      nearest = floor((y - area%first_row)/area%row_spacing)
      k = [(nearest + m, m=0, 3)]   ! the numbers, from 1, of the four rows around y
      k = merge(modulo(k - 1, rows) + 1, min(max(k, 1), rows), area%is_periodic)
      do m = 1, 4
         if (any(k(:m - 1) == k(m))) cycle
         across%heights(k(m)) = 1.0_wp
         weights = profile_height(across, [y])
         across%heights(k(m)) = 0.0_wp
         row%heights = row%heights + weights(1)*area%rows(:, k(m))
      end do
   end function row_at

   !> Moves the window so that it has all of x_low ... x_high; a periodic profile continues with its
   !> beginning. Error: that of the source.
   subroutine load_window(profile, x_low, x_high, error)
      type(profile_t), intent(inout) :: profile
      real(wp), intent(in) :: x_low, x_high
      type(error_t), allocatable, intent(out) :: error
      integer(int64) :: before_end, count, from, needed, n, to

      if (.not. allocated(profile%source)) return
      n = profile%source%nodes
      ! the four neighbours, and one more for the rounding of x
      from = floor((x_low - profile%start)/profile%spacing, int64) - 2
      to = floor((x_high - profile%start)/profile%spacing, int64) + 3
      if (.not. profile%is_periodic) then
         from = max(from, 0_int64)
         to = min(to, n - 1)
         if (to < from) return
      end if
      needed = min(to - from + 1, n)
      if (holds(profile, from, needed)) return
      count = min(max(profile%window, 2*needed), n)
      profile%first = from - (count - needed)/2
      if (profile%is_periodic) then
         profile%first = modulo(profile%first, n)
      else
         profile%first = min(max(profile%first, 0_int64), n - count)
      end if
      if (allocated(profile%heights)) deallocate (profile%heights)
      allocate (profile%heights(count))
      before_end = min(count, n - profile%first)
      call profile%source%get(profile%first, profile%heights(:before_end), error)
      if (.not. allocated(error) .and. before_end < count) call profile%source%get(0_int64, &
         profile%heights(before_end + 1:), error)
      if (allocated(error)) then
         deallocate (profile%heights)
         return
      end if
      call subtract_form(profile%form, profile%first, profile%heights(:before_end))
      call subtract_form(profile%form, 0_int64, profile%heights(before_end + 1:))
      profile%heights = profile%heights/profile%unit
   end subroutine load_window

   !> Whether the window has the `needed` heights from number `from` on.
   pure logical function holds(profile, from, needed)
      type(profile_t), intent(in) :: profile
      integer(int64), intent(in) :: from, needed
      integer(int64) :: place

      holds = .false.
      if (.not. allocated(profile%heights)) return
      place = from - profile%first
      if (profile%is_periodic) place = modulo(place, profile%source%nodes)
      holds = place >= 0 .and. place + needed <= size(profile%heights, kind=int64)
      if (profile%is_periodic) holds = holds .or. size(profile%heights, &
         kind=int64) == profile%source%nodes
   end function holds

   !> Number of heights of the profile.
   pure function node_count(profile) result(n)
      type(profile_t), intent(in) :: profile
      integer(int64) :: n

      if (allocated(profile%source)) then
         n = profile%source%nodes
      else
         n = size(profile%heights, kind=int64)
      end if
   end function node_count

   !> Distance of the last height from the first.
   pure real(wp) function profile_length(profile) result(length)
      type(profile_t), intent(in) :: profile

      length = (node_count(profile) - 1)*profile%spacing
   end function profile_length

   !> 0 up to s = 0, 1 from s = 1 on, between them a rise with continuous slope and curvature.
   pure elemental function smooth_ramp(s) result(share)
      real(wp), intent(in) :: s
      real(wp) :: share, t

      t = min(max(s, 0.0_wp), 1.0_wp)
      share = t**3*(10.0_wp - t*(15.0_wp - 6.0_wp*t))
   end function smooth_ramp

end module profile

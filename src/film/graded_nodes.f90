!> Nodes of a graded grid: the first ones by the expected film, and halved elements.
module graded_nodes
   use kinds, only: wp
   use time_table, only: monotone_slopes
   implicit none (type, external)
   private

   public :: first_nodes, monotone_cubic, refined_nodes

   !> The spacing is the first share of the length over which the pressure builds up, or the second
   !> of the distance from X = +-1 outside the contact, the third inside, there at most the fourth
   !> number.
   real(wp), parameter :: finest = 0.25_wp, outside = 0.15_wp, inside = 0.2_wp, coarsest = 0.12_wp
   !> Waves of the surfaces are resolved up to this distance from X = 0, at least.
   real(wp), parameter :: around = 2.0_wp
   !> A halved element errs by the rest of this share less. All elements are halved that err by more
   !> than the second over n, or the third of the largest error; only as many as bring the sums of
   !> all goals below the fourth.
   real(wp), parameter :: gain = 0.75_wp, least_share = 0.5_wp, share_of_largest = 0.05_wp, &
      enough = 0.9_wp
   !> Largest ratio of neighbours, with a margin; equal neighbours that err by less than this share
   !> over n together are joined on grids of more nodes than this.
   real(wp), parameter :: largest_ratio = 2.3_wp, joined_share = 0.02_wp
   integer, parameter :: least_joined = 150

contains

   !> The first nodes (0:n) of a contact with the central film `film`, refined by `factor`, between
   !> the `ends` X; around the contact no farther apart than `widest`.
   pure function first_nodes(film, factor, ends, widest) result(x)
      real(wp), intent(in) :: film, factor, ends(2), widest
      real(wp), allocatable :: x(:)
      real(wp) :: length

      length = sqrt(2*film)
      if (film < 1.0_wp) length = min(length, film**(2.0_wp/3))
      associate (front => walk(ends(1)), back => walk(ends(2)))
         allocate (x(0:size(front) + size(back)), source=[front(size(front):1:-1), 0.0_wp, back])
      end associate

   contains

      !> The nodes from X = 0, without it, to an end.
      pure function walk(end)
         real(wp), intent(in) :: end
         real(wp), allocatable :: walk(:)
         real(wp) :: place

         allocate (walk(0))
         place = 0.0_wp
         do
            place = place + spacing_at(place + 0.5_wp*spacing_at(place))
            if (place >= abs(end)) exit
            walk = [walk, sign(place, end)]
         end do
         walk = [walk, end]
      end function walk

      !> Spacing at a distance from X = 0.
      pure real(wp) function spacing_at(distance)
         real(wp), intent(in) :: distance

         spacing_at = max(finest*length*factor, merge(outside, inside, distance > 1.0_wp) &
            *abs(distance - 1))
         if (distance <= 1.0_wp) spacing_at = min(spacing_at, coarsest)
         if (distance <= max(ends(2), around)) spacing_at = min(spacing_at, widest)
      end function spacing_at

   end function first_nodes

   !> The nodes `x` (0:n) with those elements halved whose errors (elements, goals), relative to the
   !> goals, or which are `marked`; none shorter than twice its `least` spacing. Neighbours stay
   !> within a factor of two. Equal neighbours that err far less are joined. `is_final`: no element
   !> was halved.
   pure subroutine refined_nodes(x, errors, marked, least, refined, is_final)
      real(wp), intent(in) :: x(0:), errors(:, :), least(:)
      logical, intent(in) :: marked(:)
      real(wp), allocatable, intent(out) :: refined(:)
      logical, intent(out) :: is_final
      real(wp), dimension(size(marked)) :: h, halves, worst
      logical :: is_halved(size(marked)), is_kept(0:size(marked))
      integer :: i, n

      n = size(marked)
      h = x(1:) - x(:n - 1)
      worst = maxval(errors, 2)
      is_halved = (worst > threshold(errors, worst) .or. marked) .and. h > 2*least
      is_final = .not. any(is_halved)
      call balance(h, is_halved)
      is_kept = .true.
      if (n + 1 > least_joined) then
         halves = merge(0.5_wp*h, h, is_halved)
         do i = 2, n - 2   ! node i between elements i and i + 1
            if (is_halved(i) .or. is_halved(i + 1) .or. .not. is_kept(i - 1)) cycle
            if (worst(i) + worst(i + 1) >= joined_share/(n + 1) .or. abs(h(i + 1)/h(i) - 1) &
               >= 0.05_wp .or. abs(x(i)) <= 0.02_wp) cycle
            is_kept(i) = h(i) + h(i + 1) >= 2.1_wp*min(halves(i - 1), halves(i + 2))
         end do
      end if
      allocate (refined(0:count(is_kept) + count(is_halved) - 1))
      refined = pack(reshape([0.0_wp, 0.5_wp*(x(:n - 1) + x(1:)), x], [2, n + 1], order=[2, 1]), &
         reshape([.false., is_halved, is_kept], [2, n + 1], order=[2, 1]))
   end subroutine refined_nodes

   !> The error from which elements are halved.
   pure real(wp) function threshold(errors, worst)
      real(wp), intent(in) :: errors(:, :), worst(:)
      real(wp) :: bounds(2), sums(size(errors, 2))
      integer :: i

      threshold = max(least_share/(size(worst) + 1), min(share_of_largest*maxval(worst), 2.0_wp))
      bounds = [0.0_wp, 2*maxval(worst)]
      sums = sum(errors, 1)
      do i = 1, 30   ! the largest threshold that leaves all sums small enough
         if (maxval(sums - gain*matmul(merge(1.0_wp, 0.0_wp, worst >= sum(bounds)/2), errors)) &
            < enough) then
            bounds(1) = sum(bounds)/2
         else
            bounds(2) = sum(bounds)/2
         end if
      end do
      if (bounds(1) > 0.0_wp) threshold = max(threshold, 0.999_wp*bounds(1))
   end function threshold

   !> Halves elements until no neighbours differ by more than a factor of two.
   pure subroutine balance(h, is_halved)
      real(wp), intent(in) :: h(:)
      logical, intent(inout) :: is_halved(:)
      real(wp) :: new(size(h))
      logical :: was_halved(size(h))
      integer :: n

      n = size(h)
      do
         was_halved = is_halved
         new = merge(0.5_wp*h, h, was_halved)
         is_halved(:n - 1) = is_halved(:n - 1) .or. new(:n - 1) > largest_ratio*new(2:)
         is_halved(2:) = is_halved(2:) .or. new(2:) > largest_ratio*new(:n - 1)
         if (all(is_halved .eqv. was_halved)) return
      end do
   end subroutine balance

   !> Pressure at `new` nodes by monotone cubics (module time_table) through its values `p` at
   !> rising nodes `x`, 0 where the straight line is.
   pure function monotone_cubic(x, p, new) result(values)
      real(wp), intent(in) :: x(0:), p(0:), new(0:)
      real(wp) :: values(0:ubound(new, 1)), slope(0:ubound(x, 1)), h, t
      real(wp), dimension(ubound(x, 1)) :: rise, w
      integer :: e, i, n

      n = ubound(x, 1)
      w = x(1:) - x(:n - 1)
      rise = (p(1:) - p(:n - 1))/w
      slope = monotone_slopes(w, rise)
      e = 1
      do i = 0, ubound(new, 1)
         do while (x(e) < new(i) .and. e < n)
            e = e + 1
         end do
         h = w(e)
         t = (new(i) - x(e - 1))/h
         values(i) = p(e - 1) + t*h*(slope(e - 1) + t*(3*rise(e) - 2*slope(e - 1) - slope(e) &
            + t*(slope(e - 1) + slope(e) - 2*rise(e))))
         if (.not. p(e - 1) + t*h*rise(e) > 0.0_wp) values(i) = 0.0_wp
      end do
      values = max(values, 0.0_wp)
   end function monotone_cubic

end module graded_nodes

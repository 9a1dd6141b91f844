!> Line relaxation of the linear equations J v = f of a point contact: lines along X, one after the
!> other from both sides to the middle, or back.
!>
!> Where the flow of a node is strong beside its wedge, its pressure changes alone. Elsewhere a
!> change of 1 takes as much from the four neighbours, shared by the squares of the spacings: its
!> film then falls with the third power of the distance (A. A. Lubrecht, thesis, Twente, 1987). The
!> equations of a line hold all of the flow and the film up to two lines and six nodes away; they
!> are pentadiagonal, and dominated by the diagonal: no pivots.
module point_smoother
   use kinds, only: wp
   use point_level, only: point_level_t
   implicit none (type, external)
   private

   public :: factor_lines, sweep_lines

   !> Farthest node at which the film of a changed line is followed on the next one.
   integer, parameter :: far = 4
   !> Lines on either side of the middle one that wait until both halves are done.
   integer, parameter :: between = 2

   !> Factored lines (-2:2, nx-1, ny-1) and the films of both ways to change a node (0: alone), at
   !> distances along X, on its line and the next.
   type, public :: point_smoother_t
      real(wp), allocatable :: lines(:, :, :)
      real(wp) :: pattern(0:1, -far - 1:far + 1, 0:1) = 0.0_wp
      !> Shares of the neighbours along X, and of each node as neighbour across: less where its flow
      !> is strong, because its line may be done.
      real(wp) :: share_x = 0.25_wp
      real(wp), allocatable :: across(:, :)
   end type point_smoother_t

contains

   !> Sets and factors the matrices of all lines from the bands of the level.
   subroutine factor_lines(smoother, level)
      type(point_smoother_t), intent(inout) :: smoother
      type(point_level_t), intent(in) :: level
      real(wp) :: share_y
      integer :: d, j, l

      share_y = 0.5_wp*level%hx**2/(level%hx**2 + level%hy**2)
      smoother%share_x = 0.5_wp - share_y
      if (.not. allocated(smoother%across)) allocate (smoother%across(0:level%nx, 0:level%ny))
      smoother%across(:, :) = share_y*level%flowing*(1 - level%flow/level%diagonal)
      do l = 0, 1
         do d = -far - 1, far + 1
            associate (k => level%kernel)
               smoother%pattern(0, d, l) = k(abs(d), l)
               smoother%pattern(1, d, l) = k(abs(d), l) - smoother%share_x*(k(abs(d - 1), l) &
                  + k(abs(d + 1), l)) - share_y*(k(abs(d), abs(l - 1)) + k(abs(d), l + 1))
            end associate
         end do
      end do
      if (.not. allocated(smoother%lines)) allocate (smoother%lines(-2:2, level%nx - 1, &
         level%ny - 1))
      !$omp parallel do num_threads(level%threads) schedule(static)
      do j = 1, level%ny - 1
         call set_line(smoother, level, j, smoother%lines(:, :, j))
         call factor_line(smoother%lines(:, :, j))
      end do
      !$omp end parallel do
   end subroutine factor_lines

   !> Sets the matrix of line `j`: the change of row i with the unknown of node i + k.
   pure subroutine set_line(smoother, level, j, line)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j
      real(wp), intent(out) :: line(-2:, :)
      real(wp) :: alone, spread, film(0:1)
      integer :: c, i, k, m, nx

      nx = level%nx
      line = 0.0_wp
      associate (p => level%by_pressure, h => level%by_film, flowing => level%flowing, &
         kernel => smoother%pattern)
         rows: do i = 1, nx - 1
            if (.not. flowing(i, j) > 0.0_wp) then
               line(0, i) = 1.0_wp
               cycle rows
            end if
            unknowns: do k = max(-2, 1 - i), min(2, nx - 1 - i)
               c = i + k
               if (.not. flowing(c, j) > 0.0_wp) cycle unknowns
               alone = 0.0_wp
               spread = 0.0_wp
               if (k < 2) alone = p(3 + k, i, j)
               if (k > -2) spread = smoother%share_x*p(2 + k, i, j)*flowing(c - 1, j)
               if (k < 1) spread = spread + smoother%share_x*p(4 + k, i, j)*flowing(c + 1, j)
               if (k == 0) spread = spread + smoother%across(c, j - 1)*p(5, i, j) &
                  + smoother%across(c, j + 1)*p(6, i, j)
               film = (h(5, i, j) + h(6, i, j))*kernel(:, -k, 1)
               do m = -2, 1
                  film = film + h(3 + m, i, j)*kernel(:, m - k, 0)
               end do
               line(k, i) = alone + film(0)
               if (level%is_local(c, j) < 0.5_wp) line(k, i) = alone - spread + film(1)
            end do unknowns
         end do rows
      end associate
   end subroutine set_line

   !> Factors a pentadiagonal matrix in place: the factors of elimination, the inverse of the
   !> diagonal, and what is above it.
   pure subroutine factor_line(a)
      real(wp), intent(inout) :: a(-2:, :)
      integer :: i, n

      n = size(a, 2)
      do i = 1, n
         a(0, i) = 1/a(0, i)
         if (i < n) then
            a(-1, i + 1) = a(-1, i + 1)*a(0, i)
            a(0, i + 1) = a(0, i + 1) - a(-1, i + 1)*a(1, i)
            a(1, i + 1) = a(1, i + 1) - a(-1, i + 1)*a(2, i)
         end if
         if (i < n - 1) then
            a(-2, i + 2) = a(-2, i + 2)*a(0, i)
            a(-1, i + 2) = a(-1, i + 2) - a(-2, i + 2)*a(1, i)
            a(0, i + 2) = a(0, i + 2) - a(-2, i + 2)*a(2, i)
         end if
      end do
   end subroutine factor_line

   !> One sweep over all lines, from both sides to the middle or `outward`: adds the changes to `v`;
   !> `r` is the residual of v on entry and is used up. Two threads have a half each; the lines in
   !> the middle, which both would change, come one after the other.
   subroutine sweep_lines(smoother, level, outward, r, v)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      logical, intent(in) :: outward
      real(wp), intent(inout), dimension(0:level%nx, 0:level%ny) :: r, v
      integer :: count, half, last, middle, step

      middle = level%ny/2
      last = level%ny - 1
      if (outward) then
         call relax_line(smoother, level, middle, [-1, 1], r, v)
         do count = 1, between
            call relax_line(smoother, level, middle - count, [-1], r, v)
            call relax_line(smoother, level, middle + count, [1], r, v)
         end do
      end if
      !$omp parallel do num_threads(min(level%threads, 2)) private(count, step) schedule(static)
      do half = 1, 2
         step = merge(1, -1, (half == 1) .neqv. outward)
         do count = 1, merge(middle, level%ny - middle, half == 1) - between - 1
            if (outward) then
               call relax_line(smoother, level, middle + step*(between + count), [step], r, v)
            else
               call relax_line(smoother, level, merge(count, level%ny - count, half == 1), [step], &
                  r, v)
            end if
         end do
      end do
      !$omp end parallel do
      if (outward) return
      do count = between, 1, -1
         call relax_line(smoother, level, middle - count, [1], r, v)
         call relax_line(smoother, level, middle + count, [-1], r, v)
      end do
      call relax_line(smoother, level, middle, [integer ::], r, v)
   end subroutine sweep_lines

   !> Solves line `j` and changes the residuals of the next two lines in each of the directions
   !> `steps`.
   pure subroutine relax_line(smoother, level, j, steps, r, v)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j, steps(:)
      real(wp), intent(inout), dimension(0:level%nx, 0:level%ny) :: r, v
      real(wp) :: own(0:level%nx), parts(-far:level%nx + far, 0:1)
      integer :: i, nx

      nx = level%nx
      parts = 0.0_wp
      associate (a => smoother%lines, flowing => level%flowing, d => parts(1:nx - 1, 0))
         d = r(1:nx - 1, j)*flowing(1:nx - 1, j)
         d(2) = d(2) - a(-1, 2, j)*d(1)
         do i = 3, nx - 1
            d(i) = d(i) - a(-1, i, j)*d(i - 1) - a(-2, i, j)*d(i - 2)
         end do
         d(nx - 1) = d(nx - 1)*a(0, nx - 1, j)
         d(nx - 2) = (d(nx - 2) - a(1, nx - 2, j)*d(nx - 1))*a(0, nx - 2, j)
         do i = nx - 3, 1, -1
            d(i) = (d(i) - a(1, i, j)*d(i + 1) - a(2, i, j)*d(i + 2))*a(0, i, j)
         end do
         d = d*flowing(1:nx - 1, j)
         parts(1:nx - 1, 1) = d*(1 - level%is_local(1:nx - 1, j))
         own = flowing(:, j)*(parts(0:nx, 0) - smoother%share_x*(parts(-1:nx - 1, 1) &
            + parts(1:nx + 1, 1)))
      end associate
      parts(:, 0) = parts(:, 0) - parts(:, 1)
      v(:, j) = v(:, j) + own
      v(:, j - 1) = v(:, j - 1) - smoother%across(:, j - 1)*parts(0:nx, 1)
      v(:, j + 1) = v(:, j + 1) - smoother%across(:, j + 1)*parts(0:nx, 1)
      do i = 1, size(steps)
         call pass_on(smoother, level, j, steps(i), own, parts, r)
      end do
   end subroutine relax_line

   !> Changes the residuals of the lines at `step` and 2 `step` from line `j` by its change `own`;
   !> `parts` of it: of nodes alone, and of nodes with their neighbours.
   pure subroutine pass_on(smoother, level, j, step, own, parts, r)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j, step
      real(wp), intent(in) :: own(0:level%nx), parts(-far:level%nx + far, 0:1)
      real(wp), intent(inout) :: r(0:level%nx, 0:level%ny)
      real(wp), dimension(-2:level%nx + 1) :: beside, next_film, own_film
      integer :: c, i, next, nx, side

      nx = level%nx
      next = j + step
      if (next < 1 .or. next > level%ny - 1) return
      side = merge(5, 6, step > 0)   ! the band of the next line with this one
      beside = 0.0_wp
      beside(0:nx) = -smoother%across(:, next)*parts(0:nx, 1)
      next_film = 0.0_wp
      own_film = 0.0_wp
      do c = -far, far
         do i = max(-2, c - far), min(nx + 1, nx + far + c)
            next_film(i) = next_film(i) + smoother%pattern(0, c, 1)*parts(i - c, 0) &
               + smoother%pattern(1, c, 1)*parts(i - c, 1)
            own_film(i) = own_film(i) + smoother%pattern(0, c, 0)*parts(i - c, 0) &
               + smoother%pattern(1, c, 0)*parts(i - c, 1)
         end do
      end do
      associate (p => level%by_pressure, h => level%by_film)
         do i = 1, nx - 1
            r(i, next) = r(i, next) - p(side, i, next)*own(i) - h(side, i, next)*own_film(i) &
               - p(1, i, next)*beside(i - 2) - p(2, i, next)*beside(i - 1) &
               - p(3, i, next)*beside(i) - p(4, i, next)*beside(i + 1) &
               - h(1, i, next)*next_film(i - 2) - h(2, i, next)*next_film(i - 1) &
               - h(3, i, next)*next_film(i) - h(4, i, next)*next_film(i + 1)
         end do
         c = next + step
         if (c < 1 .or. c > level%ny - 1) return
         do i = 1, nx - 1
            r(i, c) = r(i, c) - p(side, i, c)*beside(i)
         end do
      end associate
   end subroutine pass_on

end module point_smoother

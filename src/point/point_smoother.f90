!> Line relaxation of the linear equations J v = f of a point contact: lines along X, one after the
!> other from both sides to the middle.
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

   !> Factored lines (nx-1, -2:2, ny-1) and the films of both ways to change a node (0: alone), at
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
      if (.not. allocated(smoother%lines)) allocate (smoother%lines(level%nx - 1, -2:2, &
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
      real(wp), intent(out), contiguous :: line(:, -2:)
      real(wp), dimension(level%nx - 1, -3:3) :: h, p
      real(wp) :: alone, spread
      integer :: c, i, k

      associate (flowing => level%flowing(:, j), n => level%nx - 1, film => smoother%pattern)
         p = 0.0_wp
         p(:, -2:1) = level%by_pressure(1:n, 1:4, j)
         h(:, -2:1) = level%by_film(1:n, 1:4, j)
         h(:, 2) = level%by_film(1:n, 5, j) + level%by_film(1:n, 6, j)
         line = 0.0_wp
         do k = -2, 2
            do i = max(1, 1 - k), min(n, n - k)
               c = i + k
               alone = p(i, k) + h(i, -2)*film(0, -2 - k, 0) + h(i, -1)*film(0, -1 - k, 0) &
                  + h(i, 0)*film(0, -k, 0) + h(i, 1)*film(0, 1 - k, 0) + h(i, 2)*film(0, -k, 1)
               spread = p(i, k) + h(i, -2)*film(1, -2 - k, 0) + h(i, -1)*film(1, -1 - k, 0) &
                  + h(i, 0)*film(1, -k, 0) + h(i, 1)*film(1, 1 - k, 0) + h(i, 2)*film(1, -k, 1) &
                  - smoother%share_x*(p(i, k - 1)*level%flowing(c - 1, j) &
                  + p(i, k + 1)*level%flowing(c + 1, j))
               line(i, k) = level%flowing(i, j)*level%flowing(c, j)*merge(spread, alone, &
                  level%is_local(c, j) < 0.5_wp)
            end do
         end do
         line(:, 0) = line(:, 0) + (1 - flowing(2:n + 1)) - flowing(2:n + 1)*(1 &
            - level%is_local(1:n, j))*(smoother%across(1:n, j - 1)*level%by_pressure(1:n, 5, j) &
            + smoother%across(1:n, j + 1)*level%by_pressure(1:n, 6, j))
      end associate
   end subroutine set_line

   !> Factors a pentadiagonal matrix in place: the factors of elimination, the inverse of the
   !> diagonal, and what is above it over that.
   pure subroutine factor_line(a)
      real(wp), intent(inout), contiguous :: a(:, -2:)
      integer :: i, n

      n = size(a, 1)
      do i = 1, n
         a(i, 0) = 1/a(i, 0)
         a(i, 1:2) = a(i, 1:2)*a(i, 0)
         if (i < n) then
            a(i + 1, 0) = a(i + 1, 0) - a(i + 1, -1)*a(i, 1)
            a(i + 1, 1) = a(i + 1, 1) - a(i + 1, -1)*a(i, 2)
            a(i + 1, -1) = a(i + 1, -1)*a(i, 0)
         end if
         if (i < n - 1) then
            a(i + 2, -1) = a(i + 2, -1) - a(i + 2, -2)*a(i, 1)
            a(i + 2, 0) = a(i + 2, 0) - a(i + 2, -2)*a(i, 2)
            a(i + 2, -2) = a(i + 2, -2)*a(i, 0)
         end if
      end do
   end subroutine factor_line

   !> One sweep over all lines, from both sides to the middle: adds the changes to `v`; `r` is the
   !> residual of v on entry and is used up. Two threads have a half each; the lines in the middle,
   !> which both would change, come one after the other.
   subroutine sweep_lines(smoother, level, r, v)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      real(wp), intent(inout), dimension(0:level%nx, 0:level%ny) :: r, v
      integer :: count, half, middle

      middle = level%ny/2
      !$omp parallel do num_threads(min(level%threads, 2)) private(count) schedule(static)
      do half = 1, 2
         do count = 1, merge(middle, level%ny - middle, half == 1) - between - 1
            call relax_line(smoother, level, merge(count, level%ny - count, half == 1), &
               merge(1, -1, half == 1), r, v)
         end do
      end do
      !$omp end parallel do
      do count = between, 1, -1
         call relax_line(smoother, level, middle - count, 1, r, v)
         call relax_line(smoother, level, middle + count, -1, r, v)
      end do
      call relax_line(smoother, level, middle, 0, r, v)
   end subroutine sweep_lines

   !> Solves line `j` and changes the residuals of the next two lines in the direction of `step`, if
   !> it is not 0.
   pure subroutine relax_line(smoother, level, j, step, r, v)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j, step
      real(wp), intent(inout), dimension(0:level%nx, 0:level%ny) :: r, v
      real(wp) :: own(0:level%nx), parts(-far - 1:level%nx + far + 1, 0:1)
      integer :: i, nx

      nx = level%nx
      parts = 0.0_wp
      associate (a => smoother%lines, flowing => level%flowing, d => parts(1:nx - 1, 0))
         ! written so that each value waits for one product and one difference
         d = r(1:nx - 1, j)*flowing(1:nx - 1, j)
         d(2) = d(2) - a(2, -1, j)*d(1)
         do i = 3, nx - 1
            d(i) = (d(i) - a(i, -2, j)*d(i - 2)) - a(i, -1, j)*d(i - 1)
         end do
         d = d*a(:, 0, j)
         d(nx - 2) = d(nx - 2) - a(nx - 2, 1, j)*d(nx - 1)
         do i = nx - 3, 1, -1
            d(i) = (d(i) - a(i, 2, j)*d(i + 2)) - a(i, 1, j)*d(i + 1)
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
      if (step /= 0) call pass_on(smoother, level, j, step, own, parts, r)
   end subroutine relax_line

   !> Changes the residuals of the lines at `step` and 2 `step` from line `j` by its change `own`;
   !> `parts` of it: of nodes alone, and of nodes with their neighbours.
   pure subroutine pass_on(smoother, level, j, step, own, parts, r)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j, step
      real(wp), intent(in) :: own(0:level%nx), parts(-far - 1:level%nx + far + 1, 0:1)
      real(wp), intent(inout) :: r(0:level%nx, 0:level%ny)
      real(wp), dimension(-1:level%nx) :: beside, next_film, own_film
      real(wp) :: w(0:1, 0:far, 0:1)
      integer :: c, i, next, nx, side

      nx = level%nx
      next = j + step
      if (next < 1 .or. next > level%ny - 1) return
      side = merge(5, 6, step > 0)   ! the band of the next line with this one
      beside(-1) = 0.0_wp
      beside(0:nx) = -smoother%across(:, next)*parts(0:nx, 1)
      w = smoother%pattern(:, 0:far, :)
      associate (a => parts(:, 0), b => parts(:, 1))
         do i = -1, nx
            c = i + far + 2   ! of a and b
            next_film(i) = w(0, 0, 1)*a(c) + w(0, 1, 1)*(a(c - 1) + a(c + 1)) &
               + w(0, 2, 1)*(a(c - 2) + a(c + 2)) + w(0, 3, 1)*(a(c - 3) + a(c + 3)) &
               + w(0, 4, 1)*(a(c - 4) + a(c + 4)) + w(1, 0, 1)*b(c) &
               + w(1, 1, 1)*(b(c - 1) + b(c + 1)) + w(1, 2, 1)*(b(c - 2) + b(c + 2)) &
               + w(1, 3, 1)*(b(c - 3) + b(c + 3)) + w(1, 4, 1)*(b(c - 4) + b(c + 4))
            own_film(i) = w(0, 0, 0)*a(c) + w(0, 1, 0)*(a(c - 1) + a(c + 1)) &
               + w(0, 2, 0)*(a(c - 2) + a(c + 2)) + w(0, 3, 0)*(a(c - 3) + a(c + 3)) &
               + w(0, 4, 0)*(a(c - 4) + a(c + 4)) + w(1, 0, 0)*b(c) &
               + w(1, 1, 0)*(b(c - 1) + b(c + 1)) + w(1, 2, 0)*(b(c - 2) + b(c + 2)) &
               + w(1, 3, 0)*(b(c - 3) + b(c + 3)) + w(1, 4, 0)*(b(c - 4) + b(c + 4))
         end do
      end associate
      associate (p => level%by_pressure, h => level%by_film)
         do i = 1, nx - 1
            r(i, next) = r(i, next) - p(i, side, next)*own(i) - h(i, side, next)*own_film(i) &
               - p(i, 1, next)*beside(i - 2) - p(i, 2, next)*beside(i - 1) &
               - p(i, 3, next)*beside(i) - p(i, 4, next)*beside(i + 1) &
               - h(i, 1, next)*next_film(i - 2) - h(i, 2, next)*next_film(i - 1) &
               - h(i, 3, next)*next_film(i) - h(i, 4, next)*next_film(i + 1)
         end do
         c = next + step
         if (c < 1 .or. c > level%ny - 1) return
         do i = 1, nx - 1
            r(i, c) = r(i, c) - p(i, side, c)*beside(i)
         end do
      end associate
   end subroutine pass_on

end module point_smoother

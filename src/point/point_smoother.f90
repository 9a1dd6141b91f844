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
   use point_level, only: last_flowing, point_level_t
   implicit none (type, external)
   private

   public :: factor_lines, sweep_lines

   !> Farthest node at which the film of a changed line is followed on the next one, of nodes that
   !> change with their neighbours; of others, where the flow outweighs the film: to the neighbours.
   integer, parameter :: far = 2
   !> Lines on either side of the middle one that wait until both halves are done.
   integer, parameter :: between = 2

   !> What a changed line is made of, by column: unknowns, those of nodes that change with their
   !> neighbours, change of P there and on the next line, film of that; room beyond both ends.
   integer, parameter :: unknown = 1, spread = 2, own = 3, beside = 4, film = 5, columns = 5, &
      room = max(far, 2)
   !> Nodes along X, from a changed one, whose film the equations of its line hold.
   integer, parameter :: reach = 4

   !> Factored lines (nx-1, -2:2, ny-1) and the films of both ways to change a node (0: alone), at
   !> distances along X, on its line and the next.
   type, public :: point_smoother_t
      real(wp), allocatable :: lines(:, :, :)
      real(wp) :: pattern(0:1, -reach:reach, 0:1) = 0.0_wp
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
      integer :: d, j, l, n

      share_y = 0.5_wp*level%hx**2/(level%hx**2 + level%hy**2)
      smoother%share_x = 0.5_wp - share_y
      if (.not. allocated(smoother%across)) allocate (smoother%across(0:level%nx, 0:level%ny))
      smoother%across(:, :) = share_y*level%flowing*(1 - level%flow/level%diagonal)
      do l = 0, 1
         do d = -reach, reach
            associate (k => level%kernel)
               smoother%pattern(0, d, l) = k(abs(d), l)
               smoother%pattern(1, d, l) = k(abs(d), l) - smoother%share_x*(k(abs(d - 1), l) &
                  + k(abs(d + 1), l)) - share_y*(k(abs(d), abs(l - 1)) + k(abs(d), l + 1))
            end associate
         end do
      end do
      if (.not. allocated(smoother%lines)) allocate (smoother%lines(level%nx - 1, -2:2, &
         level%ny - 1))
      !$omp parallel do num_threads(level%threads) private(n) schedule(static)
      do j = 1, level%ny - 1
         n = last_flowing(level, j)
         call set_line(smoother, level, j, n, smoother%lines(:, :, j))
         call factor_line(smoother%lines(:, :, j), level%flowing(1:n, j))
      end do
      !$omp end parallel do
   end subroutine factor_lines

   !> Sets the matrix of line `j` to node `n`: the change of row i with the unknown of node i + k.
   pure subroutine set_line(smoother, level, j, n, line)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j, n
      real(wp), intent(out), contiguous :: line(:, -2:)
      real(wp), dimension(n, -3:3) :: h, p
      real(wp) :: alone, more(-reach:reach, 0:1), rest
      integer :: c, i, k

      associate (flowing => level%flowing(:, j), film => smoother%pattern)
         more = film(1, :, :) - film(0, :, :)
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
               rest = h(i, -2)*more(-2 - k, 0) + h(i, -1)*more(-1 - k, 0) + h(i, 0)*more(-k, 0) &
                  + h(i, 1)*more(1 - k, 0) + h(i, 2)*more(-k, 1) - smoother%share_x*(p(i, k - 1) &
                  *level%flowing(c - 1, j) + p(i, k + 1)*level%flowing(c + 1, j))
               line(i, k) = level%flowing(i, j)*level%flowing(c, j)*(alone + (1 &
                  - level%is_local(c, j))*rest)
            end do
         end do
         line(:n, 0) = line(:n, 0) + (1 - flowing(2:n + 1)) - flowing(2:n + 1)*(1 &
            - level%is_local(1:n, j))*(smoother%across(1:n, j - 1)*level%by_pressure(1:n, 5, j) &
            + smoother%across(1:n, j + 1)*level%by_pressure(1:n, 6, j))
      end associate
   end subroutine set_line

   !> Factors as many rows of a pentadiagonal matrix as `flowing` has, in place, over their pivots:
   !> what elimination takes from rows before, the inverse of the pivot, 0 where nothing is flowing,
   !> and what is above it.
   pure subroutine factor_line(a, flowing)
      real(wp), intent(inout), contiguous :: a(:, -2:)
      real(wp), intent(in) :: flowing(:)
      real(wp) :: above(2), before(2), inverse
      integer :: i

      above = 0.0_wp
      before = 0.0_wp
      do i = 1, size(flowing)
         a(i, -1) = a(i, -1) - a(i, -2)*before(1)
         inverse = 1/(a(i, 0) - a(i, -2)*before(2) - a(i, -1)*above(1))
         a(i, 1) = a(i, 1) - a(i, -1)*above(2)
         a(i, :) = a(i, :)*inverse
         a(i, 0) = inverse*flowing(i)
         before = above
         above = a(i, 1:2)
      end do
   end subroutine factor_line

   !> One sweep over all lines, from both sides to the middle: adds the changes to `v`; `r` is the
   !> residual of v on entry and is used up. Two threads have a half each; the lines in the middle,
   !> which both would change, come one after the other.
   subroutine sweep_lines(smoother, level, r, v)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      real(wp), intent(inout), dimension(0:level%nx, 0:level%ny) :: r, v
      real(wp) :: work(-room:level%nx + room, columns, 2)
      integer :: count, half, middle

      middle = level%ny/2
      work = 0.0_wp
      !$omp parallel do num_threads(min(level%threads, 2)) private(count) schedule(static)
      do half = 1, 2
         do count = 1, merge(middle, level%ny - middle, half == 1) - between - 1
            call relax_line(smoother, level, merge(count, level%ny - count, half == 1), &
               merge(1, -1, half == 1), work(:, :, half), r, v)
         end do
      end do
      !$omp end parallel do
      do count = between, 1, -1
         call relax_line(smoother, level, middle - count, 1, work(:, :, 1), r, v)
         call relax_line(smoother, level, middle + count, -1, work(:, :, 1), r, v)
      end do
      call relax_line(smoother, level, middle, 0, work(:, :, 1), r, v)
   end subroutine sweep_lines

   !> Solves line `j` and changes the residuals of the next two lines in the direction of `step`, if
   !> it is not 0. `work` is 0 beyond both ends.
   pure subroutine relax_line(smoother, level, j, step, work, r, v)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j, step
      real(wp), intent(inout) :: work(-room:level%nx + room, columns)
      real(wp), intent(inout), dimension(0:level%nx, 0:level%ny) :: r, v
      integer :: i, n, next

      next = j + merge(step, 1, step /= 0)
      n = last_flowing(level, j)
      work(n + 1:, :) = 0.0_wp
      call solve_line(smoother%lines(:, :, j), r(1:n, j), work(-1:n + 2, unknown))
      do i = 1, n
         work(i, spread) = work(i, unknown)*(1 - level%is_local(i, j))
      end do
      do i = 1, n
         work(i, own) = level%flowing(i, j)*(work(i, unknown) - smoother%share_x*(work(i - 1, &
            spread) + work(i + 1, spread)))
         work(i, beside) = -smoother%across(i, next)*work(i, spread)
         v(i, j) = v(i, j) + work(i, own)
         v(i, next) = v(i, next) + work(i, beside)
         v(i, 2*j - next) = v(i, 2*j - next) - smoother%across(i, 2*j - next)*work(i, spread)
      end do
      if (step /= 0 .and. next >= 1 .and. next < level%ny) call pass_on(smoother, level, next, &
         step, work, r)
   end subroutine relax_line

   !> Computes the unknowns `d` of a factored line, 0 beyond both ends. (Written so that each waits
   !> for one product and one difference.)
   pure subroutine solve_line(line, right_side, d)
      real(wp), intent(in), contiguous :: line(:, -2:), right_side(:)
      real(wp), intent(inout), contiguous :: d(-1:)
      integer :: i

      do i = 1, size(right_side)
         d(i) = (right_side(i)*line(i, 0) - line(i, -2)*d(i - 2)) - line(i, -1)*d(i - 1)
      end do
      do i = size(right_side), 1, -1
         d(i) = (d(i) - line(i, 2)*d(i + 2)) - line(i, 1)*d(i + 1)
      end do
   end subroutine solve_line

   !> Changes the residuals of line `j` and the one at `step` from it by the change of the line
   !> before them.
   pure subroutine pass_on(smoother, level, j, step, work, r)
      type(point_smoother_t), intent(in) :: smoother
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j, step
      real(wp), intent(inout) :: work(-room:level%nx + room, columns)
      real(wp), intent(inout) :: r(0:level%nx, 0:level%ny)
      real(wp) :: w(0:far), w_all(0:1)
      integer :: i, n, side

      side = merge(5, 6, step > 0)   ! the band of this line with the one before
      w_all = smoother%pattern(0, 0:1, 1)
      w = smoother%pattern(1, 0:far, 1)
      w(0:1) = w(0:1) - w_all
      n = last_flowing(level, j)
      do i = 0, n + 1
         work(i, film) = w_all(0)*work(i, unknown) + w_all(1)*(work(i - 1, unknown) + work(i + 1, &
            unknown)) + w(0)*work(i, spread) + w(1)*(work(i - 1, spread) + work(i + 1, spread)) &
            + w(2)*(work(i - 2, spread) + work(i + 2, spread))
      end do
      associate (p => level%by_pressure, h => level%by_film)
         do i = 1, n
            r(i, j) = r(i, j) - (p(i, side, j)*work(i, own) + p(i, 2, j)*work(i - 1, beside) &
               + p(i, 3, j)*work(i, beside) + p(i, 4, j)*work(i + 1, beside) &
               + h(i, 1, j)*work(i - 2, film) + h(i, 2, j)*work(i - 1, film) &
               + h(i, 3, j)*work(i, film) + h(i, 4, j)*work(i + 1, film))
         end do
         if (j + step < 1 .or. j + step > level%ny - 1) return
         do i = 1, n
            r(i, j + step) = r(i, j + step) - p(i, side, j + step)*work(i, beside)
         end do
      end associate
   end subroutine pass_on

end module point_smoother

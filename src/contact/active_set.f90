!> Where a pressure may move, and how far it is from the solution: the one error measure of every dry method.
!>
!> With v = K p - z and the datum d (mean of v over 0 < p < H), gap = v - d; p_c = load/contact nodes, s = height scale:
!>
!>    E = max of |p gap|/(p_c s) where 0 < p < H,  -gap/s where p < H,  gap/s where p = H,  (-p, p - H)/p_c,  load error.
module active_set
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: real32
   use dry_problem, only: dry_grid_t, dry_problem_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: active_set_t, new_active_set

   !> Nodes of one row that are looked at together.
   integer, parameter :: block = 32

   !> The nodes F that may move: 0 < p < H; p = 0 with negative gap; p = H with positive gap.
   type :: active_set_t
      !> Number of nodes in F.
      integer :: count = 0
      !> Their indices, rising; the first `count` are in use.
      integer, allocatable :: node(:)
      !> r = -gap on F.
      real(wp), allocatable :: residual(:)
      !> d.
      real(wp) :: datum = 0.0_wp
      !> E; huge if anything is not finite.
      real(wp) :: error = huge(1.0_wp)
      !> |sum p - load|/load.
      real(wp) :: load_error = huge(1.0_wp)
      !> Nodes with p > 0 and with p = H.
      integer :: contacts = 0, capped = 0
      !> Nodes with p = H that are not in F.
      integer :: held = 0
      !> Blocks of each row; the least v of each, and whether it had p > 0 or nodes of F in the last survey.
      integer, private :: blocks = 0
      real(wp), allocatable, private :: lowest(:, :)
      logical, allocatable, private :: is_busy(:, :)
   contains
      procedure :: survey
      procedure :: follow
   end type active_set_t

   !> What the nodes of a survey add up to.
   type :: extremes_t
      real(wp) :: product, opening, penetration, negative, excess, sum
   end type extremes_t

contains

   !> Storage for a `grid`.
   subroutine new_active_set(self, grid)
      type(active_set_t), intent(out) :: self
      type(dry_grid_t), intent(in) :: grid

      allocate (self%node(grid%nx*grid%ny), self%residual(grid%nx*grid%ny))
      self%blocks = (grid%nx + block - 1)/block
      allocate (self%lowest(self%blocks, grid%ny), self%is_busy(self%blocks, grid%ny))
   end subroutine new_active_set

   !> Finds datum, F, residual and error of the pressure `p` with `v` = K p - z (both nx*ny).
   subroutine survey(self, problem, p, v)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: p(:), v(:)
      integer :: b, first, j, last

      !$omp parallel do num_threads(problem%grid%threads) private(b, first, last) schedule(static)
      do j = 1, problem%grid%ny
         do b = 1, self%blocks
            call bounds_of(problem%grid, b, j, first, last)
            self%lowest(b, j) = minval(v(first:last))
            self%is_busy(b, j) = maxval(abs(p(first:last))) > 0.0_wp
         end do
      end do
      !$omp end parallel do
      call find_datum(self, problem%hardness, p, v)
      call look_at_blocks(self, problem, p, v)
   end subroutine survey

   !> The same after p has been moved on F only: first adds `factor` times the product of `elastic` to `v`, in one go.
   subroutine follow(self, problem, factor, p, v)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp), intent(in) :: factor
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), contiguous, intent(inout) :: v(:)
      integer :: b, first, j, last, offset

      associate (product => problem%elastic%single%product)
         !$omp parallel do num_threads(problem%grid%threads) private(b, first, last, offset) schedule(static)
         do j = 1, problem%grid%ny
            offset = (j - 1)*problem%grid%nx
            do b = 1, self%blocks
               call bounds_of(problem%grid, b, j, first, last)
               call add_and_find_least(v(first:last), factor, product(first - offset:last - offset, j), self%lowest(b, j))
            end do
         end do
         !$omp end parallel do
      end associate
      call follow_datum(self, problem%hardness, p, v)
      call look_at_blocks(self, problem, p, v)
   end subroutine follow

   !> v = v + factor times product, and its least value.
   pure subroutine add_and_find_least(v, factor, product, least)
      real(wp), contiguous, intent(inout) :: v(:)
      real(wp), intent(in) :: factor
      real(real32), contiguous, intent(in) :: product(:)
      real(wp), intent(out) :: least
      real(wp) :: low(2)
      integer :: i, n

      n = size(v)
      low = v(n) + factor*product(n)
      do i = 1, n - 1, 2
         v(i) = v(i) + factor*product(i)
         v(i + 1) = v(i + 1) + factor*product(i + 1)
         low(1) = merge(v(i), low(1), v(i) < low(1))
         low(2) = merge(v(i + 1), low(2), v(i + 1) < low(2))
      end do
      if (mod(n, 2) == 1) v(n) = v(n) + factor*product(n)
      least = min(low(1), low(2))
   end subroutine add_and_find_least

   !> First and last node of block `b` in row `j`.
   pure subroutine bounds_of(grid, b, j, first, last)
      type(dry_grid_t), intent(in) :: grid
      integer, intent(in) :: b, j
      integer, intent(out) :: first, last

      first = (j - 1)*grid%nx + (b - 1)*block + 1
      last = min(first + block - 1, j*grid%nx)
   end subroutine bounds_of

   !> F, counts and error from the blocks that hold pressure or gaps below the datum.
   subroutine look_at_blocks(self, problem, p, v)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: p(:), v(:)
      type(extremes_t) :: extremes
      integer :: b, before, first, j, last

      self%count = 0
      self%contacts = 0
      self%capped = 0
      self%held = 0
      extremes = extremes_t(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)
      do j = 1, problem%grid%ny
         row: do b = 1, self%blocks
            if (self%lowest(b, j) >= self%datum .and. .not. self%is_busy(b, j)) cycle row
            call bounds_of(problem%grid, b, j, first, last)
            before = self%count + self%contacts
            call survey_block(self, problem%hardness, p, v, first, last, extremes)
            self%is_busy(b, j) = self%count + self%contacts > before
         end do row
      end do
      call judge(self, problem, extremes)
   end subroutine look_at_blocks

   !> Adds the nodes `first` ... `last` to F, to the counts and to the extremes.
   subroutine survey_block(self, hardness, p, v, first, last, extremes)
      class(active_set_t), intent(inout) :: self
      real(wp), intent(in) :: hardness
      real(wp), contiguous, intent(in) :: p(:), v(:)
      integer, intent(in) :: first, last
      type(extremes_t), intent(inout) :: extremes
      real(wp) :: gap
      integer :: i

      do i = first, last
         gap = v(i) - self%datum
         if (p(i) <= 0.0_wp) then
            extremes%negative = max(extremes%negative, -p(i))
            if (gap >= 0.0_wp) cycle
            extremes%opening = max(extremes%opening, -gap)
         else
            extremes%sum = extremes%sum + p(i)
            self%contacts = self%contacts + 1
            if (p(i) < hardness) then
               extremes%product = max(extremes%product, abs(p(i)*gap))
               extremes%opening = max(extremes%opening, -gap)
            else
               extremes%excess = max(extremes%excess, p(i) - hardness)
               self%capped = self%capped + 1
               extremes%penetration = max(extremes%penetration, gap)
               if (gap <= 0.0_wp) then
                  self%held = self%held + 1
                  cycle
               end if
            end if
         end if
         self%count = self%count + 1
         self%node(self%count) = i
         self%residual(self%count) = -gap
      end do
   end subroutine survey_block

   !> E from the extremes.
   subroutine judge(self, problem, extremes)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      type(extremes_t), intent(in) :: extremes
      real(wp) :: mean_pressure, scale

      self%error = huge(1.0_wp)
      self%load_error = huge(1.0_wp)
      if (.not. (ieee_is_finite(self%datum) .and. ieee_is_finite(extremes%sum))) return
      mean_pressure = problem%load/max(self%contacts, 1)
      scale = problem%height_scale
      if (scale <= 0.0_wp) scale = mean_pressure/problem%grid%nx
      self%load_error = abs(extremes%sum - problem%load)/problem%load
      self%error = max(extremes%product/(mean_pressure*scale), extremes%opening/scale, extremes%penetration/scale, &
                       extremes%negative/mean_pressure, extremes%excess/mean_pressure, self%load_error)
      if (.not. ieee_is_finite(self%error)) self%error = huge(1.0_wp)
   end subroutine judge

   !> d = mean of v over 0 < p < H; without such nodes the middle between the largest v under p = H and the smallest under
   !> p = 0, or the one of the two that exists.
   subroutine find_datum(self, hardness, p, v)
      class(active_set_t), intent(inout) :: self
      real(wp), intent(in) :: hardness
      real(wp), contiguous, intent(in) :: p(:), v(:)
      real(wp) :: total, highest, lowest
      integer :: i, free

      total = 0.0_wp
      free = 0
      do i = 1, size(p)
         if (p(i) > 0.0_wp .and. p(i) < hardness) then
            total = total + v(i)
            free = free + 1
         end if
      end do
      if (free > 0) then
         self%datum = total/free
         return
      end if
      highest = maxval(v, mask=p >= hardness)
      lowest = minval(v, mask=p <= 0.0_wp)
      if (highest > -huge(1.0_wp) .and. lowest < huge(1.0_wp)) then
         self%datum = 0.5_wp*(highest + lowest)
      else
         self%datum = merge(highest, lowest, highest > -huge(1.0_wp))
      end if
   end subroutine find_datum

   !> The same if nodes with 0 < p < H are in the last F only.
   subroutine follow_datum(self, hardness, p, v)
      class(active_set_t), intent(inout) :: self
      real(wp), intent(in) :: hardness
      real(wp), contiguous, intent(in) :: p(:), v(:)
      real(wp) :: total
      integer :: i, k, free

      total = 0.0_wp
      free = 0
      do k = 1, self%count
         i = self%node(k)
         if (p(i) > 0.0_wp .and. p(i) < hardness) then
            total = total + v(i)
            free = free + 1
         end if
      end do
      if (free > 0) then
         self%datum = total/free
      else
         call find_datum(self, hardness, p, v)
      end if
   end subroutine follow_datum

end module active_set

!> Finds where a pressure may move, and its distance from the solution: the one error measure of all
!> dry methods.
!>
!> With v = K p - z and the datum d (mean of v over 0 < p < H), gap = v - d; p_c = load/contact
!> nodes, s = height scale:
!>
!>    E = max of |p gap|/(p_c s) where 0 < p < H,  -gap/s where p < H,  gap/s where p = H,
!>        (-p, p - H)/p_c,  load error.
module active_set
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_fortran_env, only: real32
   use dry_problem, only: dry_grid_t, dry_problem_t, dry_solution_t
   use kinds, only: wp
   use work_shares, only: share_end
   implicit none (type, external)
   private

   public :: active_set_t, copy_survey, new_active_set, survey_solution

   !> Nodes of one row that are surveyed together.
   integer, parameter :: block = 64

   !> Sums and maxima over the nodes of a row. Sums are kept by rows: their order, and so every bit,
   !> is the same for any number of threads.
   type :: row_t
      !> Largest |p gap| on 0 < p < H, opening and penetration, excess of pressure over its bounds;
      !> sum of p.
      real(wp) :: product = 0.0_wp, opening = 0.0_wp, penetration = 0.0_wp, negative = 0.0_wp, &
         excess = 0.0_wp, sum = 0.0_wp
      !> Nodes in F, with p > 0, with p = H, and of these not in F.
      integer :: count = 0, contacts = 0, capped = 0, held = 0
   end type row_t

   !> The nodes F that may move: 0 < p < H; p = 0 with negative gap; p = H with positive gap.
   type :: active_set_t
      !> Number of nodes in F.
      integer :: count = 0
      !> Their indices, rising; the first `count` are in use.
      integer, allocatable :: node(:)
      !> Where each row begins in the list; one past its end for the row after the last (ny + 1).
      integer, allocatable :: begin(:)
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
      !> Blocks of each row; whether each had p > 0 or nodes of F in the last survey (blocks, ny).
      integer, private :: blocks = 0
      logical, allocatable, private :: is_busy(:, :)
      !> Sums and maxima of each row (ny).
      type(row_t), allocatable, private :: row(:)
   contains
      procedure :: follow, survey
   end type active_set_t

contains

   !> Allocates storage for a `grid`.
   subroutine new_active_set(self, grid)
      type(active_set_t), intent(out) :: self
      type(dry_grid_t), intent(in) :: grid

      allocate (self%node(grid%nx*grid%ny), self%residual(grid%nx*grid%ny), self%begin(grid%ny + 1))
      self%blocks = (grid%nx + block - 1)/block
      allocate (self%is_busy(self%blocks, grid%ny), self%row(grid%ny))
   end subroutine new_active_set

   !> Finds datum (unless given), F, residual and error of the pressure `p` with `v` = K p - z (both
   !> nx*ny).
   subroutine survey(self, problem, p, v, datum)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), contiguous, intent(inout) :: v(:)
      real(wp), intent(in), optional :: datum

      if (present(datum)) self%datum = datum
      if (.not. present(datum)) call find_datum(self, problem%hardness, p, v)
      self%is_busy = .true.
      call survey_rows(self, problem, 0.0_wp, p, v)
   end subroutine survey

   !> The same after p has changed on F only, which holds all nodes with 0 < p < H, and the datum by
   !> `rise`: also adds `factor` times the last product of `elastic` to `v`.
   subroutine follow(self, problem, factor, rise, p, v)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp), intent(in) :: factor, rise
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), contiguous, intent(inout) :: v(:)

      self%datum = self%datum + rise
      call survey_rows(self, problem, factor, p, v)
   end subroutine follow

   !> Adds `factor` times the last product to `v`, block by block, and finds F, counts and error
   !> from the blocks that hold pressure or gaps below the datum. Each thread has a share of the
   !> rows and of the list.
   subroutine survey_rows(self, problem, factor, p, v)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp), intent(in) :: factor
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), contiguous, intent(inout) :: v(:)
      integer :: j, last, t

      associate (nx => problem%grid%nx, ny => problem%grid%ny, threads => problem%grid%threads)
         !$omp parallel do num_threads(threads) private(j, last) schedule(static)
         do t = 1, threads
            last = nx*share_end(t - 1, threads, ny)
            do j = share_end(t - 1, threads, ny) + 1, share_end(t, threads, ny)
               call survey_row(self, problem, j, factor, p, v, last)
            end do
         end do
         !$omp end parallel do
      end associate
      call close_list(self, problem%grid)
      call judge(self, problem)
   end subroutine survey_rows

   !> Surveys one row, whose part of the list begins behind `last`; `last` moves to its end.
   subroutine survey_row(self, problem, j, factor, p, v, last)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      integer, intent(in) :: j
      real(wp), intent(in) :: factor
      real(wp), contiguous, intent(in) :: p(:)
      real(wp), contiguous, intent(inout) :: v(:)
      integer, intent(inout) :: last
      type(row_t) :: row
      real(wp) :: least
      integer :: b, before, lower, upper, offset

      row = row_t()
      offset = (j - 1)*problem%grid%nx
      blocks: do b = 1, self%blocks
         lower = offset + (b - 1)*block + 1
         upper = min(lower + block - 1, offset + problem%grid%nx)
         if (abs(factor) > 0.0_wp) then
            associate (product => problem%elastic%single%product)
               call add_and_find_least(v(lower:upper), factor, &
                  product(lower - offset:upper - offset, j), least)
            end associate
            if (least >= self%datum .and. .not. self%is_busy(b, j)) cycle blocks
         end if
         before = row%count + row%contacts
         call survey_block(self, problem%hardness, p(:upper), v(:upper), lower, last, row)
         self%is_busy(b, j) = row%count + row%contacts > before
      end do blocks
      self%row(j) = row
   end subroutine survey_row

   !> Adds `factor` times `product` to v, and finds its least value.
   pure subroutine add_and_find_least(v, factor, product, least)
      real(wp), contiguous, intent(inout) :: v(:)
      real(wp), intent(in) :: factor
      real(real32), contiguous, intent(in) :: product(:)
      real(wp), intent(out) :: least
      integer :: i

      least = huge(1.0_wp)
      !$omp simd reduction(min:least)
      do i = 1, size(v)
         v(i) = v(i) + factor*product(i)
         least = min(least, v(i))
      end do
   end subroutine add_and_find_least

   !> Adds the nodes from `lower` on to F behind `last`, and to their row.
   pure subroutine survey_block(self, hardness, p, v, lower, last, row)
      class(active_set_t), intent(inout) :: self
      real(wp), intent(in) :: hardness
      real(wp), contiguous, intent(in) :: p(:), v(:)
      integer, intent(in) :: lower
      integer, intent(inout) :: last
      type(row_t), intent(inout) :: row
      real(wp) :: gap
      integer :: i

      do i = lower, size(p)
         gap = v(i) - self%datum
         if (p(i) <= 0.0_wp) then
            if (p(i) < 0.0_wp) row%negative = max(row%negative, -p(i))
            if (gap >= 0.0_wp) cycle
            row%opening = max(row%opening, -gap)
         else
            row%sum = row%sum + p(i)
            row%contacts = row%contacts + 1
            if (p(i) < hardness) then
               row%product = max(row%product, abs(p(i)*gap))
               row%opening = max(row%opening, -gap)
            else
               row%excess = max(row%excess, p(i) - hardness)
               row%capped = row%capped + 1
               row%penetration = max(row%penetration, gap)
               if (gap <= 0.0_wp) then
                  row%held = row%held + 1
                  cycle
               end if
            end if
         end if
         last = last + 1
         row%count = row%count + 1
         self%node(last) = i
         self%residual(last) = -gap
      end do
   end subroutine survey_block

   !> Joins the threads' shares of the list, and finds where rows begin.
   pure subroutine close_list(self, grid)
      class(active_set_t), intent(inout) :: self
      type(dry_grid_t), intent(in) :: grid
      integer :: j, k, shift, t

      self%begin(1) = 1
      do j = 1, grid%ny
         self%begin(j + 1) = self%begin(j) + self%row(j)%count
      end do
      self%count = self%begin(grid%ny + 1) - 1
      do t = 2, grid%threads
         j = share_end(t - 1, grid%threads, grid%ny)
         shift = grid%nx*j + 1 - self%begin(j + 1)
         do k = self%begin(j + 1), self%begin(share_end(t, grid%threads, grid%ny) + 1) - 1
            self%node(k) = self%node(k + shift)
            self%residual(k) = self%residual(k + shift)
         end do
      end do
   end subroutine close_list

   !> Computes counts and E from the rows.
   subroutine judge(self, problem)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp) :: mean_pressure, scale, total

      self%contacts = sum(self%row%contacts)
      self%capped = sum(self%row%capped)
      self%held = sum(self%row%held)
      total = sum(self%row%sum)
      self%error = huge(1.0_wp)
      self%load_error = huge(1.0_wp)
      if (.not. (ieee_is_finite(self%datum) .and. ieee_is_finite(total))) return
      mean_pressure = problem%load/max(self%contacts, 1)
      scale = problem%height_scale
      if (scale <= 0.0_wp) scale = mean_pressure/problem%grid%nx
      self%load_error = abs(total - problem%load)/problem%load
      associate (row => self%row)
         self%error = max(maxval(row%product)/(mean_pressure*scale), maxval(row%opening)/scale, &
            maxval(row%penetration)/scale, &
                          maxval(row%negative)/mean_pressure, maxval(row%excess)/mean_pressure, &
                             self%load_error)
      end associate
      if (.not. ieee_is_finite(self%error)) self%error = huge(1.0_wp)
   end subroutine judge

   !> Sets d = mean of v over 0 < p < H; without such nodes the middle between the largest v under p
   !> = H and the smallest under p = 0, or the only one of the two.
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

   !> Copies datum, counts and error of the last survey. Only this routine declares a dry contact
   !> solved: its error is at most the `tolerance`.
   pure subroutine copy_survey(set, tolerance, solution)
      type(active_set_t), intent(in) :: set
      real(wp), intent(in) :: tolerance
      type(dry_solution_t), intent(inout) :: solution

      solution%datum = set%datum
      solution%contacts = set%contacts
      solution%capped = set%capped
      solution%kkt = set%error
      solution%report%residual = set%error
      solution%report%load_error = set%load_error
      solution%report%tolerance_effective = tolerance
      solution%report%converged = set%error <= tolerance
   end subroutine copy_survey

   !> Surveys the pressure and v of a `solution`, with a `datum` if given.
   subroutine survey_solution(problem, tolerance, solution, datum)
      type(dry_problem_t), intent(in) :: problem
      real(wp), intent(in) :: tolerance
      type(dry_solution_t), intent(inout) :: solution
      real(wp), intent(in), optional :: datum
      type(active_set_t) :: set

      call new_active_set(set, problem%grid)
      call set%survey(problem, solution%pressure, solution%v, datum)
      call copy_survey(set, tolerance, solution)
   end subroutine survey_solution

end module active_set

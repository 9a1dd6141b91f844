!> Where a pressure may move, and how far it is from the solution: the one error measure of every dry method.
!>
!> With v = K p - z and the datum d (mean of v over 0 < p < H), gap = v - d; p_c = load/contact nodes, s = height scale:
!>
!>    E = max of |p gap|/(p_c s) where 0 < p < H,  -gap/s where p < H,  gap/s where p = H,  (-p, p - H)/p_c,  load error.
module active_set
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use dry_problem, only: dry_problem_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: active_set_t, new_active_set

   !> Nodes that are looked at together.
   integer, parameter :: block = 64

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
      !> Since the last survey p has only changed on F.
      logical :: is_followed = .false.
   contains
      procedure :: survey
   end type active_set_t

   !> What the nodes of a survey add up to.
   type :: extremes_t
      real(wp) :: product, opening, penetration, negative, excess, sum
   end type extremes_t

contains

   !> Storage for a grid of `n` nodes.
   subroutine new_active_set(self, n)
      type(active_set_t), intent(out) :: self
      integer, intent(in) :: n

      allocate (self%node(n), self%residual(n))
   end subroutine new_active_set

   !> Finds datum, F, residual and error of the pressure `p` with `v` = K p - z (both nx*ny).
   !> If `is_followed`, p has been moved on the last F only.
   subroutine survey(self, problem, p, v)
      class(active_set_t), intent(inout) :: self
      type(dry_problem_t), intent(in) :: problem
      real(wp), contiguous, intent(in) :: p(:), v(:)
      type(extremes_t) :: extremes
      integer :: first, last

      call find_datum(self, problem%hardness, p, v)
      self%count = 0
      self%contacts = 0
      self%capped = 0
      self%held = 0
      extremes = extremes_t(0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp)
      do first = 1, size(p), block
         last = min(first + block - 1, size(p))
         if (minval(v(first:last)) >= self%datum .and. maxval(abs(p(first:last))) <= 0.0_wp) cycle
         call survey_block(self, problem%hardness, p, v, first, last, extremes)
      end do
      call judge(self, problem, extremes)
      self%is_followed = .true.
   end subroutine survey

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
      integer :: i, k, free

      total = 0.0_wp
      free = 0
      if (self%is_followed) then
         do k = 1, self%count
            i = self%node(k)
            if (p(i) > 0.0_wp .and. p(i) < hardness) then
               total = total + v(i)
               free = free + 1
            end if
         end do
      else
         do i = 1, size(p)
            if (p(i) > 0.0_wp .and. p(i) < hardness) then
               total = total + v(i)
               free = free + 1
            end if
         end do
      end if
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

end module active_set

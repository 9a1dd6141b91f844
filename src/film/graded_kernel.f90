!> Deflection of an elastic half-space in plane strain under a pressure that is linear between nodes
!> anywhere, in O(n), and with the transposed matrix.
!>
!> Beyond the two elements of a node, which are exact, the kernel is a sum of exponentials,
!>
!>     ln d = C - sum_l w_l exp(-a_l d),
!>
!> good to the accuracy asked for between the smallest spacing and the length: the trapezoidal rule
!> of ln d = Int (exp(-t) - exp(-t d))/t dt in ln t, of which the slow exponentials, which are
!> smooth, are replaced by a few with the same moments. One sweep in each direction carries the
!> integrals of all exponentials from element to element.
module graded_kernel
   use linear_systems, only: solve_dense
   use errors, only: error_t
   use half_space, only: element_deflections
   use kinds, only: not_known, pi, wp
   implicit none (type, external)
   private

   public :: element_exponentials, graded_kernel_t, new_graded_kernel

   !> Accuracy of films: rounding.
   real(wp), parameter, public :: exact = 1.0e-12_wp
   !> Exponentials in place of all that decay by less than 1/e along the length, over the logarithm
   !> of the accuracy.
   real(wp), parameter :: slow_share = 0.45_wp
   !> Below this a h the integrals are series.
   real(wp), parameter :: small = 5.0e-2_wp
   !> Entries of K on either side of the diagonal that are kept, exact.
   integer, parameter :: band_width = 4

   !> The matrix K (0:n, 0:n) of rising nodes, times the elasticity.
   type :: graded_kernel_t
      !> K(j+d, j), (-4:4, 0:n); weights of Int P dX.
      real(wp), allocatable :: band(:, :), weights(:)
      real(wp), private :: factor = 0.0_wp, constant = 0.0_wp
      !> Of every element: decay of the exponentials along it, and their integrals with the hats of
      !> its near and its far end, times w_l (terms, n); its own deflection at the end of a hat, and
      !> at the other one, without the constant.
      real(wp), allocatable, private :: decay(:, :), near(:, :), far(:, :), own(:), other(:)
   contains
      procedure :: multiply, multiply_transposed
   end type graded_kernel_t

contains

   !> Prepares the kernel of rising nodes `x` (0:n), ln d with an absolute `accuracy`.
   subroutine new_graded_kernel(kernel, x, elasticity, accuracy)
      type(graded_kernel_t), intent(out) :: kernel
      real(wp), intent(in), contiguous :: x(0:)
      real(wp), intent(in) :: elasticity, accuracy
      real(wp), allocatable :: rate(:), weight(:)
      real(wp) :: spacing(ubound(x, 1))
      integer :: e, n

      n = ubound(x, 1)
      spacing = x(1:) - x(:n - 1)
      call sum_exponentials(minval(spacing), x(n) - x(0), accuracy, rate, weight)
      allocate (kernel%decay(size(rate), n), kernel%near(size(rate), n), &
         kernel%far(size(rate), n), kernel%band(-band_width:band_width, 0:n), &
         kernel%weights(0:n), source=0.0_wp)
      call element_exponentials(rate, spacing, kernel%decay, kernel%near, kernel%far)
      do e = 1, n
         kernel%near(:, e) = weight*kernel%near(:, e)
         kernel%far(:, e) = weight*kernel%far(:, e)
      end do
      call element_deflections(x, band_width, kernel%band)
      kernel%band = elasticity*kernel%band
      kernel%factor = elasticity/pi
      kernel%constant = sum(weight*exp(-rate))
      kernel%weights(1:) = 0.5_wp*spacing
      kernel%weights(:n - 1) = kernel%weights(:n - 1) + 0.5_wp*spacing
      kernel%own = spacing*(0.5_wp*log(spacing) - 0.75_wp - 0.5_wp*kernel%constant)
      kernel%other = spacing*(0.5_wp*log(spacing) - 0.25_wp - 0.5_wp*kernel%constant)
   end subroutine new_graded_kernel

   !> Rising rates a_l and weights w_l of ln d between `nearest` and `farthest`.
   subroutine sum_exponentials(nearest, farthest, accuracy, rate, weight)
      real(wp), intent(in) :: nearest, farthest, accuracy
      real(wp), allocatable, intent(out) :: rate(:), weight(:)
      real(wp), allocatable :: matrix(:, :), moments(:), slow(:)
      integer, allocatable :: pivots(:)
      type(error_t), allocatable :: error
      real(wp) :: first, last, step
      integer :: count_slow, i, slow_terms

      slow_terms = nint(slow_share*abs(log(accuracy)))
      allocate (matrix(slow_terms, slow_terms), moments(slow_terms), pivots(slow_terms))
      step = 0.97_wp*pi**2/abs(log(accuracy))
      first = log(accuracy/farthest)
      last = log(1.3_wp*abs(log(accuracy))/nearest)
      rate = [(exp(first + i*step), i=0, ceiling((last - first)/step))]
      count_slow = count(rate*farthest < 1.0_wp)
      slow = [(0.5_wp - 0.5_wp*cos((i - 0.5_wp)*pi/slow_terms), i=1, slow_terms)]
      do i = 1, slow_terms
         matrix(i, :) = slow**i
         moments(i) = step*sum((rate(:count_slow)*farthest)**i)
      end do
      call solve_dense(matrix, moments, pivots, error)
      if (allocated(error)) moments = not_known()   ! the points differ: never
      weight = [moments, (step, i=count_slow + 1, size(rate))]
      rate = [slow/farthest, rate(count_slow + 1:)]
   end subroutine sum_exponentials

   !> Along elements of the given spacing (n): exp(-a h), and the integrals of exp(-a d) with the
   !> hat that is 1 where d = 0, and with that which is 1 at the other end (size(rate), n), for
   !> rising rates a.
   pure subroutine element_exponentials(rate, spacing, decay, near, far)
      real(wp), intent(in) :: rate(:), spacing(:)
      real(wp), intent(out), contiguous, dimension(:, :) :: decay, near, far
      real(wp) :: a(size(rate))
      integer :: e, l, series

      do e = 1, size(spacing)
         a = rate*spacing(e)
         decay(:, e) = exp(-a)
         series = count(a < small)
         do l = 1, series
            near(l, e) = spacing(e)*(1/2.0_wp - a(l)*(1/6.0_wp - a(l)*(1/24.0_wp - a(l) &
               *(1/120.0_wp - a(l)*(1/720.0_wp - a(l)*(1/5040.0_wp - a(l)/40320))))))
            far(l, e) = spacing(e)*(1/2.0_wp - a(l)*(1/3.0_wp - a(l)*(1/8.0_wp - a(l) &
               *(1/30.0_wp - a(l)*(1/144.0_wp - a(l)*(1/840.0_wp - a(l)/5760))))))
         end do
         do l = series + 1, size(rate)
            near(l, e) = spacing(e)*(a(l) - 1 + decay(l, e))/a(l)**2
            far(l, e) = spacing(e)*(1 - decay(l, e)*(1 + a(l)))/a(l)**2
         end do
      end do
   end subroutine element_exponentials

   !> Computes `d` = K `p`, (0:n) both: one sweep carries what lies to the left of a node, the other
   !> what lies to its right.
   pure subroutine multiply(self, p, d)
      class(graded_kernel_t), intent(in) :: self
      real(wp), intent(in), contiguous :: p(0:)
      real(wp), intent(out), contiguous :: d(0:)
      real(wp) :: state(size(self%decay, 1)), total
      integer :: e, from, k, l, n, side, to

      n = ubound(p, 1)
      d = self%constant*dot_product(self%weights, p)
      d(1:) = d(1:) + self%own*p(1:) + self%other*p(:n - 1)
      d(:n - 1) = d(:n - 1) + self%own*p(:n - 1) + self%other*p(1:)
      do side = 0, 1
         state = 0.0_wp
         do k = 1, n
            e = merge(k, n + 1 - k, side == 0)
            from = e - 1 + side
            to = e - side
            total = 0.0_wp
            !$omp simd reduction(+:total)
            do l = 1, size(state)
               state(l) = self%decay(l, e)*state(l)
               total = total + state(l)
               state(l) = state(l) + self%far(l, e)*p(from) + self%near(l, e)*p(to)
            end do
            d(to) = d(to) - total
         end do
      end do
      d = self%factor*d
   end subroutine multiply

   !> Computes `p` = K^T `d`, (0:n) both: one sweep carries the nodes to the right of an element,
   !> the other those to its left.
   pure subroutine multiply_transposed(self, d, p)
      class(graded_kernel_t), intent(in) :: self
      real(wp), intent(in), contiguous :: d(0:)
      real(wp), intent(out), contiguous :: p(0:)
      real(wp) :: state(size(self%decay, 1)), by_far, by_near
      integer :: e, from, k, l, n, side, to

      n = ubound(d, 1)
      p = self%constant*sum(d)*self%weights
      p(1:) = p(1:) + self%own*d(1:) + self%other*d(:n - 1)
      p(:n - 1) = p(:n - 1) + self%own*d(:n - 1) + self%other*d(1:)
      do side = 0, 1
         state = 0.0_wp
         do k = 1, n
            e = merge(n + 1 - k, k, side == 0)
            from = e - 1 + side
            to = e - side
            by_far = 0.0_wp
            by_near = 0.0_wp
            !$omp simd reduction(+:by_far, by_near)
            do l = 1, size(state)
               by_far = by_far + self%far(l, e)*state(l)
               by_near = by_near + self%near(l, e)*state(l)
               state(l) = self%decay(l, e)*(state(l) + d(to))
            end do
            p(from) = p(from) - by_far
            p(to) = p(to) - by_near
         end do
      end do
      p = self%factor*p
   end subroutine multiply_transposed

end module graded_kernel

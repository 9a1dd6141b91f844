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

   !> Accuracy of final films: rounding.
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
      !> Of every element: exponentials that reach across it or a neighbour; their decay along it,
      !> and what the hats of its left node and of its right one add to them beyond it, times w_l
      !> (terms, n); its own deflection at the end of a hat, and at the other one.
      integer, allocatable, private :: active(:)
      real(wp), allocatable, private :: decay(:, :), onward(:, :), backward(:, :), own(:), other(:)
   contains
      procedure :: multiply, multiply_transposed
   end type graded_kernel_t

contains

   !> Prepares the kernel of rising nodes `x` (0:n), ln d with an absolute `accuracy`.
   subroutine new_graded_kernel(kernel, x, elasticity, accuracy)
      type(graded_kernel_t), intent(out) :: kernel
      real(wp), intent(in), contiguous :: x(0:)
      real(wp), intent(in) :: elasticity, accuracy
      real(wp), allocatable :: rate(:), weight(:), near(:, :), far(:, :)
      real(wp) :: spacing(ubound(x, 1))
      integer :: e, m, n

      n = ubound(x, 1)
      spacing = x(1:) - x(:n - 1)
      call sum_exponentials(minval(spacing), x(n) - x(0), accuracy, rate, weight)
      m = size(rate)
      allocate (kernel%decay(m, n), near(m, 0:n + 1), far(m, n), kernel%onward(m, n), &
         kernel%backward(m, n), kernel%band(-band_width:band_width, 0:n), kernel%weights(0:n), &
         source=0.0_wp)
      kernel%active = [(count(rate*minval(spacing(max(e - 1, 1):min(e + 1, n))) &
         < -log(accuracy)), e=1, n)]
      call element_exponentials(rate, spacing, kernel%active, kernel%decay, near(:, 1:n), far)
      kernel%factor = elasticity/pi
      kernel%constant = sum(weight*exp(-rate))
      kernel%own = spacing*(0.5_wp*log(spacing) - 0.75_wp - 0.5_wp*kernel%constant)
      kernel%other = kernel%own + 0.5_wp*spacing
      do e = 1, n
         m = kernel%active(e)
         kernel%onward(:m, e) = weight(:m)*(far(:m, e) + kernel%decay(:m, e)*near(:m, e - 1))
         kernel%backward(:m, e) = weight(:m)*(far(:m, e) + kernel%decay(:m, e)*near(:m, e + 1))
         ! the exponentials of an element in itself are no part of K
         kernel%other(e) = kernel%other(e) + dot_product(weight(:m), far(:m, e))
      end do
      call element_deflections(x, band_width, kernel%band)
      kernel%band = elasticity*kernel%band
      kernel%weights(1:) = 0.5_wp*spacing
      kernel%weights(:n - 1) = kernel%weights(:n - 1) + 0.5_wp*spacing
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
   !> hat that is 1 where d = 0, and with that which is 1 at the other end (size(rate), n), for the
   !> first `active` (n) of rising rates a; others are left as they are.
   pure subroutine element_exponentials(rate, spacing, active, decay, near, far)
      real(wp), intent(in) :: rate(:), spacing(:)
      integer, intent(in) :: active(:)
      real(wp), intent(inout), contiguous, dimension(:, :) :: decay, near, far
      real(wp) :: a(size(rate))
      integer :: e, l, m, series

      do e = 1, size(spacing)
         m = active(e)
         a(:m) = rate(:m)*spacing(e)
         decay(:m, e) = exp(-a(:m))
         series = count(a(:m) < small)
         do l = 1, series
            near(l, e) = spacing(e)*(1/2.0_wp - a(l)*(1/6.0_wp - a(l)*(1/24.0_wp - a(l) &
               *(1/120.0_wp - a(l)*(1/720.0_wp - a(l)*(1/5040.0_wp - a(l)/40320))))))
            far(l, e) = spacing(e)*(1/2.0_wp - a(l)*(1/3.0_wp - a(l)*(1/8.0_wp - a(l) &
               *(1/30.0_wp - a(l)*(1/144.0_wp - a(l)*(1/840.0_wp - a(l)/5760))))))
         end do
         do l = series + 1, m
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
      integer :: e, l, n

      n = ubound(p, 1)
      d = self%constant*dot_product(self%weights, p)
      d(1:) = d(1:) + self%own*p(1:) + self%other*p(:n - 1)
      d(:n - 1) = d(:n - 1) + self%own*p(:n - 1) + self%other*p(1:)
      state = 0.0_wp   ! what is left of exponentials that an element ends is as good as 0
      do e = 1, n
         total = 0.0_wp
         !$omp simd reduction(+:total)
         do l = 1, self%active(e)
            state(l) = self%decay(l, e)*state(l) + self%onward(l, e)*p(e - 1)
            total = total + state(l)
         end do
         d(e) = d(e) - total
      end do
      state = 0.0_wp
      do e = n, 1, -1
         total = 0.0_wp
         !$omp simd reduction(+:total)
         do l = 1, self%active(e)
            state(l) = self%decay(l, e)*state(l) + self%backward(l, e)*p(e)
            total = total + state(l)
         end do
         d(e - 1) = d(e - 1) - total
      end do
      d = self%factor*d
   end subroutine multiply

   !> Computes `p` = K^T `d`, (0:n) both: one sweep carries the nodes to the right of an element,
   !> the other those to its left.
   pure subroutine multiply_transposed(self, d, p)
      class(graded_kernel_t), intent(in) :: self
      real(wp), intent(in), contiguous :: d(0:)
      real(wp), intent(out), contiguous :: p(0:)
      real(wp) :: state(size(self%decay, 1)), total
      integer :: e, l, n

      n = ubound(d, 1)
      p = self%constant*sum(d)*self%weights
      p(1:) = p(1:) + self%own*d(1:) + self%other*d(:n - 1)
      p(:n - 1) = p(:n - 1) + self%own*d(:n - 1) + self%other*d(1:)
      state = 0.0_wp
      do e = n, 1, -1
         total = 0.0_wp
         !$omp simd reduction(+:total)
         do l = 1, self%active(e)
            state(l) = self%decay(l, min(e + 1, n))*state(l) + d(e)
            total = total + self%onward(l, e)*state(l)
         end do
         p(e - 1) = p(e - 1) - total
      end do
      state = 0.0_wp
      do e = 1, n
         total = 0.0_wp
         !$omp simd reduction(+:total)
         do l = 1, self%active(e)
            state(l) = self%decay(l, max(e - 1, 1))*state(l) + d(e - 1)
            total = total + self%backward(l, e)*state(l)
         end do
         p(e) = p(e) - total
      end do
      p = self%factor*p
   end subroutine multiply_transposed

end module graded_kernel

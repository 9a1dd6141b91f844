!> Elastic half-space in plane strain: surface deflection under a pressure that is constant over
!> each cell of a uniform grid, whose matrix is Toeplitz, or linear between nodes anywhere. The
!> logarithmic kernel is integrated exactly.
module half_space
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: deflection_by_elements, element_deflections, line_kernel, line_deflection_coefficients

   !> From this cell distance on the series is used: its terms up to j^-12 leave an error of 1e-18
   !> there, while the closed form loses digits by cancellation in proportion to j.
   integer, parameter, public :: series_start = 10
   !> Distance from the middle of an element, over half its length, from which its moments are
   !> series, with this many terms, and their coefficients.
   real(wp), parameter :: far = 6.0_wp
   integer, parameter :: terms = 10
   integer :: counter
   real(wp), parameter :: even_terms(terms) = [(1/real(counter*(2*counter + 1), wp), &
      counter=1, terms)], odd_terms(terms) = [(1/real((2*counter - 1)*(2*counter + 1), wp), &
      counter=1, terms)]

contains

   !> Integral of ln|t| over the cell [j - 1/2, j + 1/2], j = 0 ... `n` (cell widths):
   !>
   !> kappa_j = (j + 1/2)(ln|j + 1/2| - 1) - (j - 1/2)(ln|j - 1/2| - 1) = ln j - sum_m 1/( 2m
   !> (2m + 1) (2j)^(2m) ).
   !>
   !> It is K_ij of (2.68) over dX, less ln dX. (2.68) lacks the outer signs in print: its terms are
   !> (d + dX/2)(ln|d + dX/2| - 1) - (d - dX/2)(ln|d - dX/2| - 1), d = X_i - X_j.
   pure function line_kernel(n) result(kappa)
      integer, intent(in) :: n
      real(wp) :: kappa(0:n), above, below, y
      integer :: j

      do j = 0, min(n, series_start - 1)
         above = real(j, wp) + 0.5_wp
         below = real(j, wp) - 0.5_wp
         kappa(j) = above*(log(above) - 1.0_wp) - below*(log(abs(below)) - 1.0_wp)
      end do
      do j = series_start, n
         y = 1.0_wp/(2.0_wp*real(j, wp))**2
         kappa(j) = log(real(j, wp)) - y*(1.0_wp/6.0_wp + y*(1.0_wp/20.0_wp + y*(1.0_wp/42.0_wp &
                    + y*(1.0_wp/72.0_wp + y*(1.0_wp/110.0_wp + y/156.0_wp)))))
      end do
   end function line_kernel

   !> k_j = K_j/pi = dX (ln dX + kappa_j)/pi, j = 0 ... `n` [-], with `dx` > 0 the grid spacing in
   !> half-widths.
   !>
   !> Deflection in (2.58), (2.67): D_i = - sum_j k_|i-j| P_j (minus: (2.67) brings it to the left
   !> side).
   pure function line_deflection_coefficients(n, dx) result(k)
      integer, intent(in) :: n
      real(wp), intent(in) :: dx
      real(wp) :: k(0:n)

      k = dx*(log(dx) + line_kernel(n))/pi
   end function line_deflection_coefficients

   !> Computes the entries K_ij, |i - j| <= `width`, of rising nodes `x` (0:n) [half-widths], with P
   !> linear between them: D_i = - sum_j K_ij P_j, k(i-j, j) = K_ij, 0 outside,
   !>
   !>     K_ij = 1/pi Int ln|x_i - s| hat_j(s) ds
   !>
   !> by the moments A0, A1 of every element, 2 w long, at u = (x_i - middle)/w: the hat at its
   !> left end has the part w/2 (A0 - A1), at its right end w/2 (A0 + A1). Near the element in
   !> closed form, farther by the series, as differences would cancel.
   pure subroutine element_deflections(x, width, k)
      real(wp), intent(in), contiguous :: x(0:)
      integer, intent(in) :: width
      real(wp), intent(out), contiguous :: k(-width:, 0:)
      real(wp) :: a0, a1, half, middle
      integer :: e, i, n

      n = ubound(x, 1)
      k = 0.0_wp
      do e = 1, n
         half = 0.5_wp*(x(e) - x(e - 1))
         middle = 0.5_wp*(x(e) + x(e - 1))
         do i = max(0, e - 1 - width), min(n, e + width)
            if (i == e - 1 .or. i == e) then
               a0 = 2*log(2*half) - 2
               a1 = 2*(e - i) - 1
            else
               call evaluate_moments(x(i) - middle, half, a0, a1)
            end if
            if (i - e < width) k(i - e + 1, e - 1) = k(i - e + 1, e - 1) + 0.5_wp*half/pi*(a0 - a1)
            if (i - e >= -width) k(i - e, e) = k(i - e, e) + 0.5_wp*half/pi*(a0 + a1)
         end do
      end do
   end subroutine element_deflections

   !> K p at `points` outside the rising nodes `x` (0:n) by the pressure `p` (0:n), linear between
   !> them [half-widths].
   pure function deflection_by_elements(x, p, points) result(deflection)
      real(wp), intent(in) :: x(0:), p(0:), points(:)
      real(wp) :: deflection(size(points))
      real(wp) :: a0, a1, half, middle
      integer :: e, i

      deflection = 0.0_wp
      do e = 1, ubound(x, 1)
         half = 0.5_wp*(x(e) - x(e - 1))
         middle = 0.5_wp*(x(e) + x(e - 1))
         do i = 1, size(points)
            call evaluate_moments(points(i) - middle, half, a0, a1)
            deflection(i) = deflection(i) + 0.5_wp*half/pi*((p(e - 1) + p(e))*a0 + (p(e) - p(e &
               - 1))*a1)
         end do
      end do
   end function deflection_by_elements

   !> A0 and A1 at `distance` from the middle of an element, not at its ends: far from it by their
   !> series.
   pure subroutine evaluate_moments(distance, half, a0, a1)
      real(wp), intent(in) :: distance, half
      real(wp), intent(out) :: a0, a1
      real(wp) :: above, below, u

      if (abs(distance) > far*half) then
         call far_moments(distance, half, a0, a1)
         return
      end if
      u = distance/half
      above = log(max(abs(1 + u), tiny(u)))
      below = log(max(abs(1 - u), tiny(u)))
      a0 = (1 + u)*above + (1 - u)*below - 2 + 2*log(half)
      a1 = 0.5_wp*(u**2 - 1)*(above - below) - u
   end subroutine evaluate_moments

   !> A0 and A1 at `distance` > `far` half from the middle of an element by their series.
   pure subroutine far_moments(distance, half, a0, a1)
      real(wp), intent(in) :: distance, half
      real(wp), intent(out) :: a0, a1
      real(wp) :: y
      integer :: m

      a0 = 0.0_wp
      a1 = 0.0_wp
      y = (half/distance)**2
      do m = terms, 1, -1
         a0 = (a0 + even_terms(m))*y
         a1 = (a1 + odd_terms(m))*y
      end do
      a0 = 2*log(abs(distance)) - a0
      a1 = -2*distance/half*a1
   end subroutine far_moments

end module half_space

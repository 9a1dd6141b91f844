!> Elastic half-space: surface deflection under a pressure.
!>
!> In oil (plane strain), of a pressure that is constant over each cell of a uniform grid, whose
!> matrix is Toeplitz, or linear between nodes anywhere. The logarithmic kernel is integrated
!> exactly.
!>
!> Dry, for lines (plane strain) and areas, periodic and open: all kernels belong to the operator G
!> whose transfer function is 1/q, q the wavenumber: u = (4/E') G p, with 2/E' = (1-nu_1^2)/E_1 +
!> (1-nu_2^2)/E_2. (The thesis prints 4/(n E') in (3.8), (3.9), (3.13) and 2/(E' sqrt(n^2 + m^2))
!> in (3.14): wavenumbers without their 2 pi/L, and in (3.14) a factor of 2 less.) In space G is
!> -(1/pi) ln|x| for a line and 1/(2 pi r) for an area (K. L. Johnson, Contact Mechanics, 1985,
!> sections 2.3, 3.2, 13.2). The deflection at wavenumber 0 is a free constant, taken as 0.
module half_space
   use kinds, only: pi, wp
   implicit none (type, external)
   private

   public :: band_limited_response, deflection_by_elements, element_deflections, element_response, &
      line_deflection_coefficients, line_kernel, open_area_kernel, wavenumbers

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

   !> Beyond this many element widths the kernel of an element is a series in its size: its terms up
   !> to the fourth power leave an error of 1e-12 there, while the closed form loses digits in
   !> proportion to the square of the distance.
   real(wp), parameter :: far_elements = 40.0_wp
   !> Images of the wavenumber on either side that the element kernel sums, under a smooth window.
   integer, parameter :: images = 24
   !> Steepness of the window; with it the sum is accurate to 1e-8.
   real(wp), parameter :: steepness = 4.3_wp

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
      real(wp) :: above, below, u, y
      integer :: m

      if (abs(distance) > far*half) then
         a0 = 0.0_wp
         a1 = 0.0_wp
         y = (half/distance)**2
         do m = terms, 1, -1
            a0 = (a0 + even_terms(m))*y
            a1 = (a1 + odd_terms(m))*y
         end do
         a0 = 2*log(abs(distance)) - a0
         a1 = -2*distance/half*a1
      else
         u = distance/half
         above = log(max(abs(1 + u), tiny(u)))
         below = log(max(abs(1 - u), tiny(u)))
         a0 = (1 + u)*above + (1 - u)*below - 2 + 2*log(half)
         a1 = 0.5_wp*(u**2 - 1)*(above - below) - u
      end if
   end subroutine evaluate_moments

   !> Wavenumbers q(0:nx/2, 0:ny-1) [1/m] of a periodic cell `length_x` x `length_y` in the order of
   !> the FFT; `ny` = 1 is a line.
   pure function wavenumbers(nx, ny, length_x, length_y) result(q)
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: length_x, length_y
      real(wp) :: q(0:nx/2, 0:ny - 1)
      integer :: i, j

      do j = 0, ny/2
         do i = 0, nx/2
            q(i, j) = 2.0_wp*pi*sqrt((real(i, wp)/length_x)**2 + (real(j, wp)/length_y)**2)
         end do
         if (j > 0) q(:, ny - j) = q(:, j)
      end do
   end function wavenumbers

   !> Band-limited response 1/q (0:nx/2, 0:ny-1) [m]: the transfer function at the wavenumbers of
   !> the grid, 0 at q = 0 (H. M. Stanley and T. Kato, J. Tribol. 119, 1997, 481).
   pure function band_limited_response(nx, ny, length_x, length_y) result(response)
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: length_x, length_y
      real(wp) :: response(0:nx/2, 0:ny - 1)

      response = wavenumbers(nx, ny, length_x, length_y)
      response(0, 0) = 1.0_wp
      response = 1.0_wp/response
      response(0, 0) = 0.0_wp
   end function band_limited_response

   !> Response (0:nx/2, 0:ny-1) [m] at the nodes to a pressure that is constant over each element
   !> around a node: the sum of sinc(q_x dx/2) sinc(q_y dy/2)/q over all images q + 2 pi (k/dx,
   !> l/dy) of the wavenumber. The terms of the sum alternate; a smooth window over `images` of them
   !> leaves an error of 1e-8.
   pure function element_response(nx, ny, length_x, length_y) result(response)
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: length_x, length_y
      real(wp) :: response(0:nx/2, 0:ny - 1), part_x(-images:images, 0:nx/2), part_y(-images:images)
      integer :: i, images_y, j, k, l

      images_y = merge(images, 0, ny > 1)
      do i = 0, nx/2
         part_x(:, i) = [(image_share(real(i, wp)/nx + k), k=-images, images)]
      end do
      response = 0.0_wp
      do j = 0, ny/2
         part_y = [(image_share(real(j, wp)/ny + l), l=-images, images)]
         if (ny == 1) part_y = 1.0_wp
         do i = 0, nx/2
            do l = -images_y, images_y
               response(i, j) = response(i, j) + sum(part_x(:, i)*part_y(l) &
                  /(tiny(1.0_wp) + 2.0_wp*pi*[(hypot((real(i, wp) + k*nx)/length_x, &
                  (real(j, wp) + l*ny)/length_y), k=-images, images)]))
            end do
         end do
         if (j > 0) response(:, ny - j) = response(:, j)
      end do
      response(0, 0) = 0.0_wp
   end function element_response

   !> Share of the image at `waves` waves per element in one direction: sinc times a window that
   !> falls smoothly from 1 to 0 past the last image, as narrow in space as in wavenumber.
   pure elemental real(wp) function image_share(waves)
      real(wp), intent(in) :: waves

      image_share = 0.5_wp*erfc(steepness*(2.0_wp*abs(waves/(images + 1)) - 1.0_wp))
      if (abs(waves) > 0.0_wp) image_share = image_share*(sin(pi*waves)/(pi*waves))
   end function image_share

   !> Kernel of an open area (0:nx-1, 0:ny-1) [m]: deflection at element distance (i, j) under unit
   !> pressure on one rectangle `dx` x `dy` [m] (A. E. H. Love, Phil. Trans. R. Soc. A 228, 1929,
   !> 377).
   pure function open_area_kernel(nx, ny, dx, dy) result(kernel)
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: dx, dy
      real(wp) :: kernel(0:nx - 1, 0:ny - 1)
      integer :: i, j

      do j = 0, ny - 1
         do i = 0, nx - 1
            kernel(i, j) = rectangle(i*dx, j*dy, dx, dy)
         end do
      end do
   end function open_area_kernel

   !> Integral of 1/(2 pi r) over the rectangle `dx` x `dy` centred at the distance (`x`, `y`) >= 0.
   pure elemental function rectangle(x, y, dx, dy) result(integral)
      real(wp), intent(in) :: x, y, dx, dy
      real(wp) :: integral, c2, s2, r2

      r2 = x*x + y*y
      if (r2 <= (far_elements*max(dx, dy))**2) then
         integral = corner(x + dx/2, y + dy/2) - corner(x - dx/2, y + dy/2) &
            - corner(x + dx/2, y - dy/2) + corner(x - dx/2, y - dy/2)
      else
         ! Taylor series of 1/r about the centre, averaged over the rectangle.
         c2 = x*x/r2
         s2 = y*y/r2
         integral = dx*dy/sqrt(r2)*(1.0_wp + (dx*dx*(3.0_wp*c2 - 1.0_wp) &
            + dy*dy*(3.0_wp*s2 - 1.0_wp))/(24.0_wp*r2) + (dx**4 &
            *(105.0_wp*c2*c2 - 90.0_wp*c2 + 9.0_wp) + dy**4*(105.0_wp*s2*s2 - 90.0_wp*s2 &
            + 9.0_wp))/(1920.0_wp*r2*r2) + dx*dx*dy*dy*(105.0_wp*c2*s2 - 12.0_wp)/(576.0_wp*r2*r2))
      end if
      integral = integral/(2.0_wp*pi)
   end function rectangle

   !> Integral of 1/r over the rectangle between the origin and (x, y): x asinh(y/|x|) + y
   !> asinh(x/|y|).
   pure elemental real(wp) function corner(x, y)
      real(wp), intent(in) :: x, y

      corner = 0.0_wp
      if (abs(x) > 0.0_wp) corner = corner + x*asinh(y/abs(x))
      if (abs(y) > 0.0_wp) corner = corner + y*asinh(x/abs(y))
   end function corner

end module half_space

!> Eyring's law between walls that slide along X, with a pressure gradient along and across: the
!> flow of a point contact.
!>
!> With the stress s = s_m + Sigma zeta over tau_0, zeta = -1 ... 1 across the film, and the shear
!> rate sinh|s| s/|s| over tau_0/mu,
!>
!>     1/2 Int sinh|s| s/|s| d zeta = (B, 0) ,   F = 3/2 Int zeta sinh|s| s/|s| d zeta ,
!>
!> Sigma = h/(2 tau_0) grad p, B = mu |u2 - u1|/(tau_0 h): F/Sigma is the slip factor of each
!> direction. F is S Sigma of module eyring where Sigma lies along X, and (sqrt(1 + B^2) Sigma_x,
!> B/arsinh(B) Sigma_y) for small Sigma. Its derivative by Sigma is symmetric and positive.
module eyring_plane
   use eyring, only: ds, s, series_limit
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: plane_flow

   !> Nodes and weights of Gauss' rules on (-1, 1), those above 0.
   real(wp), parameter :: four(2, 2) = reshape([0.339981043584856265_wp, 0.652145154862546143_wp, &
      0.861136311594052575_wp, 0.347854845137453857_wp], [2, 2])
   real(wp), parameter :: eight(2, 4) = reshape([0.183434642495649805_wp, &
      0.362683783378361983_wp, 0.525532409916328986_wp, 0.313706645877887287_wp, &
      0.796666477413626740_wp, 0.222381034453374471_wp, 0.960289856497536232_wp, &
      0.101228536290376259_wp], [2, 4])
   !> |Sigma| up to which the first serves, to 1e-10, and that of each part of the film which the
   !> second has to itself beyond; above `largest_sigma`, which no solution comes near, the slip
   !> factor stays, above `largest_ln_b`, too.
   real(wp), parameter :: gentle = 0.15_wp, steep = 2.5_wp, largest_sigma = 24.0_wp, &
      largest_ln_b = 300.0_wp
   !> |Sigma| below which the gradient does not thin the oil, to 1e-11 of its flow.
   real(wp), parameter, public :: least_sigma = 1.0e-5_wp
   integer, parameter :: max_steps = 60
   real(wp), parameter :: accuracy = 1.0e-7_wp   ! of the last step but one; then its square

   !> F and its derivatives, by Sigma (F, Sigma) and by ln B, all over exp(growth), and the stress
   !> in the middle over tau_0.
   type, public :: plane_flow_t
      real(wp) :: stress(2) = 0.0_wp, growth = 0.0_wp, flow(2) = 0.0_wp, by_sigma(2, 2) = 0.0_wp, &
         by_ln_b(2) = 0.0_wp
   end type plane_flow_t

   !> Halves of the integrals of the shear rate, of zeta times it, and of 1, zeta and zeta^2 times
   !> its derivative by s (xx, xy, yy), all over exp(growth).
   type :: moments_t
      real(wp) :: growth = 0.0_wp, rate(2) = 0.0_wp, flow(2) = 0.0_wp, a(9) = 0.0_wp
   end type moments_t

contains

   !> The flow of Sigma = `sigma` and ln B = `ln_b`, from Newton's method for s_m.
   pure function plane_flow(sigma, ln_b) result(plane)
      real(wp), intent(in) :: sigma(2), ln_b
      type(plane_flow_t) :: plane
      type(moments_t) :: m
      real(wp) :: b, change(2), excess, inverse(3), length, within(2)
      integer :: step

      excess = max(1.0_wp, norm2(sigma)/largest_sigma)
      within = sigma/excess
      length = norm2(within)
      b = exp(min(ln_b, largest_ln_b))
      plane%stress = first_stress(within, length, b)
      do step = 1, max_steps
         call set_moments(m, plane%stress, within, length)
         inverse = [m%a(3), -m%a(2), m%a(1)]/(m%a(1)*m%a(3) - m%a(2)**2)
         change = times(inverse, [b*exp(-m%growth) - m%rate(1), -m%rate(2)])
         change = change*min(1.0_wp, 1/max(norm2(change), tiny(1.0_wp)))
         plane%stress = plane%stress + change
         if (maxval(abs(change)) < accuracy) exit
      end do
      plane%growth = m%growth
      plane%flow = 3*excess*(m%flow + times(m%a(4:6), change))
      plane%by_ln_b = 3*excess*b*exp(-m%growth)*times(m%a(4:6), inverse(1:2))
      plane%by_sigma(:, 1) = 3*(m%a(7:8) - times(m%a(4:6), times(inverse, m%a(4:5))))
      plane%by_sigma(:, 2) = 3*(m%a(8:9) - times(m%a(4:6), times(inverse, m%a(5:6))))
   end function plane_flow

   !> The product of the symmetric matrix (xx, xy, yy) and a vector.
   pure function times(a, x) result(y)
      real(wp), intent(in) :: a(3), x(2)
      real(wp) :: y(2)

      y(1) = a(1)*x(1) + a(2)*x(2)
      y(2) = a(2)*x(1) + a(3)*x(2)
   end function times

   !> The stress in the middle: exact where Sigma lies along X, or to its fourth power.
   pure function first_stress(sigma, length, b) result(x)
      real(wp), intent(in) :: sigma(2), length, b
      real(wp) :: x(2)
      real(wp) :: g, k

      if (length > gentle) then
         x = [asinh(b*length/sinh(length)), 0.0_wp]
         return
      end if
      x = [asinh(b), 0.0_wp]
      call shear_rate(x(1), g, k)
      x = x - [x(1)*(sigma(1)**2*g + sigma(2)**2*k)/(6*(g + k*x(1)**2)), &
         k*x(1)*product(sigma)/(3*g)]
   end function first_stress

   !> sinh(t)/t and its derivative by t, over t, both over e^t.
   pure elemental subroutine shear_rate(t, g, k)
      real(wp), intent(in) :: t
      real(wp), intent(out) :: g, k
      real(wp) :: u

      if (t < series_limit) then
         u = t**2
         g = exp(-t)*(s(0) + u*(s(1) + u*(s(2) + u*(s(3) + u*(s(4) + u*(s(5) + u*s(6)))))))
         k = exp(-t)*(ds(0) + u*(ds(1) + u*(ds(2) + u*(ds(3) + u*(ds(4) + u*(ds(5) + u*ds(6)))))))
      else
         u = exp(-2*t)
         g = 0.5_wp*(1 - u)/t
         k = (0.5_wp*(1 + u) - g)/t**2
      end if
   end subroutine shear_rate

   !> Sets the moments for the stress `x` in the middle and Sigma = `sigma` of `length`.
   pure subroutine set_moments(m, x, sigma, length)
      type(moments_t), intent(out) :: m
      real(wp), intent(in) :: x(2), sigma(2), length
      integer :: k, parts

      m%growth = max(norm2(x + sigma), norm2(x - sigma))
      if (length < gentle) then
         call add_part(m, x, sigma, four, 0.0_wp, 1.0_wp)
         return
      end if
      parts = 1
      do while (length > steep*parts)
         parts = 2*parts
      end do
      do k = 1, parts
         call add_part(m, x, sigma, eight, (2*k - 1.0_wp)/parts - 1, 1.0_wp/parts)
      end do
   end subroutine set_moments

   !> Adds the part of the film within `half` of zeta = `middle` by a `rule`.
   pure subroutine add_part(m, x, sigma, rule, middle, half)
      type(moments_t), intent(inout) :: m
      real(wp), intent(in) :: x(2), sigma(2), rule(:, :), middle, half
      real(wp) :: a(3), g, k, t, u, v, weight, zeta
      integer :: i, side

      do i = 1, size(rule, 2)
         do side = -1, 1, 2
            zeta = middle + side*half*rule(1, i)
            u = x(1) + zeta*sigma(1)
            v = x(2) + zeta*sigma(2)
            t = sqrt(u**2 + v**2)
            call shear_rate(t, g, k)
            weight = 0.5_wp*half*rule(2, i)*exp(t - m%growth)
            g = weight*g
            k = weight*k
            a = [g + k*u**2, k*u*v, g + k*v**2]
            m%rate = m%rate + g*[u, v]
            m%flow = m%flow + zeta*g*[u, v]
            m%a(1:3) = m%a(1:3) + a
            m%a(4:6) = m%a(4:6) + zeta*a
            m%a(7:9) = m%a(7:9) + zeta**2*a
         end do
      end do
   end subroutine add_part

end module eyring_plane

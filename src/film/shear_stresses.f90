!> Shear stress in the film of a line contact, on both walls and between them, and the velocity of
!> the oil across it.
!>
!> Across the film the stress is linear, tau = tau_m + (z - h/2) dp/dx with z from surface 1 to
!> surface 2, (2.6): tau_m is the mean, given by the flow law and u2 - u1, and the walls have tau_m
!> -+ (h/2) dp/dx. The film pulls surface 1 with tau in +x and surface 2 with -tau. In units of p_h
!> b/R.
module shear_stresses
   use flow_law, only: block_size => slip_block, largest_exponent
   use kinds, only: wp
   use lubricant, only: fluid_t, fluid_viscosity
   use rheology, only: evaluate_stress, flow_shapes, ln_slip
   implicit none (type, external)
   private

   public :: evaluate_nodes, film_stresses, stress_block_t, velocity_profile

   !> Up to `block_size` nodes: H dP/dX and mean stress.
   type :: stress_block_t
      real(wp), dimension(block_size) :: drive, stress
   end type stress_block_t

contains

   !> Stress at the wall of surface 1, mean stress, and stress at the wall of surface 2, (nx, 3), on
   !> the nodes `x` of a uniform grid, from pressure `p`, film `h` and, if present, values `known`
   !> of ln(mu/mu_0), each (nx); 0 where the film cavitates, as the width that oil fills is not
   !> known there; the oil begins at the first node.
   pure function film_stresses(fluid, lambda, slide_to_roll, x, p, h, known) result(stresses)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      real(wp), intent(in), contiguous, optional :: known(:)
      real(wp) :: stresses(size(x), 3), ln_mu(size(x))
      type(stress_block_t) :: block
      integer :: first, last, m

      if (present(known)) then
         ln_mu = known
      else
         call fluid_viscosity(fluid, p, ln_mu)
      end if
      do first = 1, size(x), block_size
         last = min(first + block_size - 1, size(x))
         m = last - first + 1
         call evaluate_nodes(fluid, lambda*slide_to_roll/12, x(2) - x(1), p, h, ln_mu, first, block)
         stresses(first:last, 1) = block%stress(:m) - 0.5_wp*block%drive(:m)
         stresses(first:last, 2) = block%stress(:m)
         stresses(first:last, 3) = block%stress(:m) + 0.5_wp*block%drive(:m)
      end do
      do last = 2, size(x)
         if (p(last) <= 0.0_wp) stresses(last, :) = 0.0_wp
      end do
   end function film_stresses

   !> Drive H dP/dX and mean stress of up to `block_size` nodes from `first` on, the first being 1,
   !> from p, h and ln(mu/mu_0), each (nx).
   !> The slope of P is the central difference, that of the first interval at the first node, and 0
   !> at the last. `couette` is lambda/6 (u2 - u1)/(u1 + u2).
   ! allow(too-many-arguments)  the fields of a film, and where in them
   pure subroutine evaluate_nodes(fluid, couette, dx, p, h, ln_mu, first, block)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette, dx
      real(wp), intent(in), contiguous :: p(:), h(:), ln_mu(:)
      integer, intent(in) :: first
      type(stress_block_t), intent(inout) :: block
      real(wp) :: inverse_film(block_size), factor
      integer :: i, last, m

      last = min(first + block_size - 1, size(p))
      m = last - first + 1
      factor = 0.5_wp/dx
      do i = max(first, 2), min(last, size(p) - 1)
         block%drive(i - first + 1) = factor*h(i)*(p(i + 1) - p(i - 1))
      end do
      if (first == 1) block%drive(1) = 2*factor*h(1)*(p(2) - p(1))
      if (last == size(p)) block%drive(m) = 0.0_wp
      inverse_film(:m) = 1/h(first:last)
      call evaluate_stress(fluid, couette, block%drive(:m), inverse_film(:m), ln_mu(first:last), &
         block%stress(:m))
   end subroutine evaluate_nodes

   !> u/(u1 + u2) at zeta = z/h = 0, 1/layers ... 1 from surface 1 to surface 2, (layers + 1, nx),
   !> on the nodes `x` of a uniform grid, from pressure `p` >= 0 and film `h` > 0, each (nx).
   !>
   !> Closed form of module eyring. Its mean across the film is the flow of the Reynolds equation at
   !> the node, with the slope of P by the central difference, of the first interval at the first
   !> node, and 0 at the last. Where the film cavitates it is the straight line of shear alone.
   pure function velocity_profile(fluid, lambda, slide_to_roll, x, p, h, layers) result(u)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      integer, intent(in) :: layers
      real(wp) :: u(layers + 1, size(x))
      real(wp), dimension(layers + 1) :: y, sliding, driven
      real(wp) :: drive(size(x)), ln_mu(size(x)), flow
      integer :: i, n

      n = size(x)
      drive(1) = h(1)*(p(2) - p(1))/(x(2) - x(1))
      drive(2:n - 1) = h(2:n - 1)*(p(3:) - p(:n - 2))/(x(3:) - x(:n - 2))
      drive(n) = 0.0_wp
      where (p(2:) <= 0.0_wp) drive(2:) = 0.0_wp
      call fluid_viscosity(fluid, p, ln_mu)
      y = [(real(2*i - layers, wp)/layers, i=0, layers)]
      do i = 1, n
         call flow_shapes(fluid, drive(i), y, sliding, driven)
         flow = h(i)*drive(i)/(2*lambda)*exp(min(ln_slip(fluid, drive(i), h(i), ln_mu(i)) &
            - ln_mu(i), largest_exponent))
         u(:, i) = 0.5_wp + 0.25_wp*slide_to_roll*sliding - flow*driven
      end do
   end function velocity_profile

end module shear_stresses

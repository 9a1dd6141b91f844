!> Shear stress in the film of a line contact, on both walls and between them.
!>
!> Across the film the stress is linear, tau = tau_m + (z - h/2) dp/dx with z from surface 1 to
!> surface 2, (2.6): tau_m is the mean, which the law of flow gives from u2 - u1, and the walls have
!> tau_m -+ (h/2) dp/dx. The film pulls surface 1 with tau in +x and surface 2 with -tau. In units
!> of p_h b/R.
module shear_stresses
   use flow_law, only: block_size => slip_block
   use kinds, only: wp
   use lubricant, only: fluid_t, fluid_viscosity
   use rheology, only: evaluate_stress
   implicit none (type, external)
   private

   public :: evaluate_nodes, film_stresses, stress_block_t

   !> Up to `block_size` nodes: H dP/dX and mean stress.
   type :: stress_block_t
      real(wp), dimension(block_size) :: drive, stress
   end type stress_block_t

contains

   !> Stress at the wall of surface 1, mean stress, and stress at the wall of surface 2, (nx, 3), on
   !> the nodes `x` of a uniform grid, from pressure `p`, film `h` and, where they are at hand,
   !> values `known` of ln(mu/mu_0), each (nx): 0 where the film cavitates, for how much of the
   !> width oil fills there is not known; the oil begins at the first node.
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

end module shear_stresses

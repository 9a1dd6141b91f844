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
   use lubricant, only: evaluate_stress, flow_shapes, fluid_t, fluid_viscosity, limited_stress, &
      ln_slip
   use quantities, only: node_spacings
   implicit none (type, external)
   private

   public :: evaluate_drive, film_stresses, velocity_profile

contains

   !> Stress at the wall of surface 1, mean stress, and stress at the wall of surface 2, (nx, 3), on
   !> the nodes `x` of a rising grid, from pressure `p`, film `h` and ln(mu/mu_0) of a warm oil,
   !> each (nx); 0 where the film cavitates, as the width that oil fills is not known there; the oil
   !> begins at the first node.
   pure function film_stresses(fluid, lambda, slide_to_roll, x, p, h, warm_ln_mu) result(stresses)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      real(wp), intent(in), contiguous, optional :: warm_ln_mu(:)
      real(wp) :: stresses(size(x), 3)
      real(wp), dimension(size(x)) :: drive, inverse_film, ln_mu
      integer :: first, last

      call fluid_viscosity(fluid, p, ln_mu)
      if (present(warm_ln_mu)) ln_mu = warm_ln_mu
      call evaluate_drive(node_spacings(x), p, h, drive)
      inverse_film = 1/h
      do first = 1, size(x), block_size
         last = min(first + block_size - 1, size(x))
         call evaluate_stress(fluid, lambda*slide_to_roll/12, drive(first:last), &
            inverse_film(first:last), ln_mu(first:last), stresses(first:last, 2))
      end do
      stresses(:, 2) = limited_stress(fluid, p, stresses(:, 2))
      stresses(:, 1) = stresses(:, 2) - 0.5_wp*drive
      stresses(:, 3) = stresses(:, 2) + 0.5_wp*drive
      do last = 2, size(x)
         if (p(last) <= 0.0_wp) stresses(last, :) = 0.0_wp
      end do
   end function film_stresses

   !> H dP/dX of the pressure p and the film h, each (nx), on nodes at the distances `gap` (nx - 1).
   !> The slope of P is that of the parabola through three nodes (on an even grid the central
   !> difference), at the first node that of the first interval, and 0 at the last.
   pure subroutine evaluate_drive(gap, p, h, drive)
      real(wp), intent(in), contiguous :: gap(:), p(:), h(:)
      real(wp), intent(out), contiguous :: drive(:)
      real(wp) :: ratio, factor
      integer :: i

      drive(1) = 1/gap(1)*h(1)*(p(2) - p(1))
      do i = 2, size(p) - 1
         ratio = gap(i - 1)/gap(i)
         factor = 1/(gap(i - 1) + gap(i))
         drive(i) = factor*h(i)*(ratio*p(i + 1) - p(i - 1)/ratio + (1/ratio - ratio)*p(i))
      end do
      drive(size(p)) = 0.0_wp
   end subroutine evaluate_drive

   !> u/(u1 + u2) at zeta = z/h = 0, 1/layers ... 1 from surface 1 to surface 2, (layers + 1, nx),
   !> on the nodes `x` of a rising grid, from pressure `p` >= 0 and film `h` > 0, each (nx).
   !>
   !> Closed form of module eyring. Its mean across the film is the flow of the Reynolds equation at
   !> the node, by evaluate_drive. Where the film cavitates it is the straight line of shear alone.
   pure function velocity_profile(fluid, lambda, slide_to_roll, x, p, h, layers) result(u)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      integer, intent(in) :: layers
      real(wp) :: u(layers + 1, size(x))
      real(wp), dimension(layers + 1) :: y, sliding, driven
      real(wp) :: drive(size(x)), ln_mu(size(x)), flow
      integer :: i

      call evaluate_drive(node_spacings(x), p, h, drive)
      where (p(2:) <= 0.0_wp) drive(2:) = 0.0_wp
      call fluid_viscosity(fluid, p, ln_mu)
      y = [(real(2*i - layers, wp)/layers, i=0, layers)]
      do i = 1, size(x)
         call flow_shapes(fluid, drive(i), y, sliding, driven)
         flow = h(i)*drive(i)/(2*lambda)*exp(min(ln_slip(fluid, drive(i), h(i), ln_mu(i)) &
            - ln_mu(i), largest_exponent))
         u(:, i) = 0.5_wp + 0.25_wp*slide_to_roll*sliding - flow*driven
      end do
   end function velocity_profile

end module shear_stresses

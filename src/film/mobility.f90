!> Mobility e = rho H^3 S/mu of the Reynolds-Eyring equation on a grid, with its derivatives.
!>
!> All laws are joined in ONE exponential, e = rho H^3 f exp(g - ln mu) with S = f exp(g), to avoid
!> overflow (ln mu reaches 714). Nodes are computed in blocks that stay in cache; each loop calls
!> only the laws' array loops.
module mobility
   use flow_law, only: block_size => slip_block, largest_exponent, slip_t
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_t, fluid_viscosity
   implicit none (type, external)
   private

   public :: fluid_mobility, fluid_mobility_slopes, mobility_slopes_t

   !> Mobility, density and their partial derivatives, each (0:n).
   type :: mobility_slopes_t
      !> e, and its derivatives by P(i), H(i) and the slope dP/dX(i) inside S.
      real(wp), allocatable :: e(:), e_p(:), e_h(:), e_slope(:)
      !> rho and d rho/dP.
      real(wp), allocatable :: rho(:), rho_p(:)
   end type mobility_slopes_t

contains

   !> Mobility `e`, density `rho` and `all_ln_mu` = ln(mu/mu_0) at all nodes; p >= 0, h > 0 (0:n).
   !> The slope inside S is the central difference of p, and of its `compensation` where that is
   !> kept, 0 at both ends; S follows its formula at every node, also where P = 0.
   ! allow(too-many-arguments)  the last are optional
   pure subroutine fluid_mobility(fluid, dx, p, h, e, rho, compensation, all_ln_mu)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      real(wp), intent(out), contiguous :: e(0:), rho(0:)
      real(wp), intent(in), contiguous, optional :: compensation(0:)
      real(wp), intent(out), contiguous, optional :: all_ln_mu(0:)
      real(wp), dimension(block_size) :: ln_mu, drive, inverse_film
      type(slip_t) :: slip
      integer :: first, last, m

      do first = 0, ubound(p, 1), block_size
         last = min(first + block_size - 1, ubound(p, 1))
         m = last - first + 1
         call fluid_viscosity(fluid, p(first:last), ln_mu(:m))
         if (present(all_ln_mu)) all_ln_mu(first:last) = ln_mu(:m)
         call fluid_density(fluid, p(first:last), rho(first:last))
         if (allocated(fluid%rheology)) then
            call drive_at_nodes(dx, p, h, first, drive(:m), inverse_film(:m), compensation)
            call fluid%rheology%evaluate_slip(drive(:m), inverse_film(:m), ln_mu(:m), .false., slip)
         end if
         e(first:last) = rho(first:last)*h(first:last)**3*slip%factor(:m)*exp(min(slip%growth(:m) &
            - ln_mu(:m), largest_exponent))
      end do
   end subroutine fluid_mobility

   !> H dP/dX at the nodes from `first` on by central differences, 0 at both ends, and 1/H.
   pure subroutine drive_at_nodes(dx, p, h, first, drive, inverse_film, compensation)
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      integer, intent(in) :: first
      real(wp), intent(out), contiguous :: drive(:), inverse_film(:)
      real(wp), intent(in), contiguous, optional :: compensation(0:)
      real(wp) :: factor
      integer :: i, n

      n = ubound(p, 1)
      factor = 0.5_wp/dx
      do i = max(first, 1), min(first + size(drive) - 1, n - 1)
         drive(i - first + 1) = factor*h(i)*(p(i + 1) - p(i - 1))
      end do
      if (present(compensation)) then
         do i = max(first, 1), min(first + size(drive) - 1, n - 1)
            drive(i - first + 1) = drive(i - first + 1) + factor*h(i)*(compensation(i + 1) &
               - compensation(i - 1))
         end do
      end if
      if (first == 0) drive(1) = 0.0_wp
      if (first + size(drive) - 1 == n) drive(n - first + 1) = 0.0_wp
      inverse_film = 1.0_wp/h(first:first + size(drive) - 1)
   end subroutine drive_at_nodes

   !> Mobility, density and derivatives for the Jacobian; p >= 0, h > 0, and the compensation of p
   !> where it is kept (0:n).
   pure subroutine fluid_mobility_slopes(fluid, dx, p, h, slopes, compensation)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: dx
      real(wp), intent(in), contiguous :: p(0:), h(0:)
      type(mobility_slopes_t), intent(inout) :: slopes
      real(wp), intent(in), contiguous, optional :: compensation(0:)
      real(wp), dimension(block_size) :: ln_mu, mu_p, drive, inverse_film
      type(slip_t) :: slip
      integer :: first, last, m, n

      n = ubound(p, 1)
      do first = 0, n, block_size
         last = min(first + block_size - 1, n)
         m = last - first + 1
         call fluid_viscosity(fluid, p(first:last), ln_mu(:m), mu_p(:m))
         call fluid_density(fluid, p(first:last), slopes%rho(first:last), slopes%rho_p(first:last))
         if (allocated(fluid%rheology)) then
            call drive_at_nodes(dx, p, h, first, drive(:m), inverse_film(:m), compensation)
            call fluid%rheology%evaluate_slip(drive(:m), inverse_film(:m), ln_mu(:m), .true., slip)
         end if
         associate (e => slopes%e(first:last), rho => slopes%rho(first:last), film => h(first:last))
            e = rho*film**3*slip%factor(:m)*exp(min(slip%growth(:m) - ln_mu(:m), largest_exponent))
            slopes%e_p(first:last) = e*(slopes%rho_p(first:last)/rho &
               + (slip%by_ln_mu(:m) - 1)*mu_p(:m))
            slopes%e_h(first:last) = e*(3 + slip%by_ln_film(:m))/film
            slopes%e_slope(first:last) = e*slip%by_drive(:m)*film
         end associate
      end do
      slopes%e_slope(0) = 0.0_wp
      slopes%e_slope(n) = 0.0_wp
   end subroutine fluid_mobility_slopes

end module mobility

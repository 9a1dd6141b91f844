!> Pressure-density law as rho/rho_0 with its derivative by pressure.
module density
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: dowson_higginson_densities

   !> Pressure constant C1 [Pa] of (2.28), (2.63); D. Dowson and G. R. Higginson,
   !> Elasto-hydrodynamic lubrication, 1966.
   real(wp), parameter, public :: dowson_higginson_c1 = 5.9e8_wp
   !> Density ratio C2 [-] of (2.28), (2.63) to which the law tends at infinite pressure; same
   !> source.
   real(wp), parameter :: dowson_higginson_c2 = 1.34_wp

contains

   !> Dowson and Higginson's law (2.28), (2.63) on arrays (n), in one loop that the compiler
   !> vectorises:  rho/rho_0 = (C1 + C2 p)/(C1 + p).
   !>
   !> `p` >= 0 and `c1` > 0 in one and the same unit (SI, or both divided by the Hertz pressure).
   !> `rho` = rho/rho_0 [-], between 1 and C2; `drho`, where it is asked for, its derivative by p
   !> [1/unit of p].
   pure subroutine dowson_higginson_densities(p, c1, rho, drho)
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(in) :: c1
      real(wp), intent(out), contiguous :: rho(:)
      real(wp), intent(out), contiguous, optional :: drho(:)
      real(wp) :: unused
      integer :: i

      if (present(drho)) then
         do i = 1, size(p)
            call dowson_higginson(p(i), c1, rho(i), drho(i))
         end do
      else
         do i = 1, size(p)
            call dowson_higginson(p(i), c1, rho(i), unused)
         end do
      end if
   end subroutine dowson_higginson_densities

   !> The law at one pressure; private, so that position-independent code inlines it in the loops
   !> too.
   pure elemental subroutine dowson_higginson(p, c1, rho, drho)
      real(wp), intent(in) :: p, c1
      real(wp), intent(out) :: rho, drho
      real(wp) :: fraction

      fraction = 1.0_wp/(c1 + p)
      rho = (c1 + dowson_higginson_c2*p)*fraction
      drho = (dowson_higginson_c2 - 1.0_wp)*(c1*fraction)*fraction
   end subroutine dowson_higginson

end module density

!> Mobilities with their derivatives, of nodes (module mobility) and of faces (face_mobility).
module mobility_slopes
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: face_slopes_t, mobility_slopes_t

   !> Bound of ln(S/mu): a wild iterate (|Sigma| beyond 500 at low pressure) must not overflow. No
   !> solution comes near it.
   real(wp), parameter, public :: largest_exponent = 500.0_wp

   !> Mobility, density and their partial derivatives, each (0:n).
   type :: mobility_slopes_t
      !> e, and its derivatives by P(i), H(i) and the slope dP/dX(i) inside S.
      real(wp), allocatable :: e(:), e_p(:), e_h(:), e_slope(:)
      !> rho and d rho/dP.
      real(wp), allocatable :: rho(:), rho_p(:)
   end type mobility_slopes_t

   !> Mobility of the faces (1:n), face i left of node i, and its partial derivatives by P and H of
   !> both nodes.
   type :: face_slopes_t
      real(wp), allocatable :: e(:), by_p_left(:), by_p_right(:), by_h_left(:), by_h_right(:)
   end type face_slopes_t

end module mobility_slopes

!> The bands of the Jacobian of the discrete Reynolds equation, and what they are formed from.
module jacobian_bands
   use kinds, only: wp
   use mobility_slopes, only: face_slopes_t, mobility_slopes_t
   implicit none (type, external)
   private

   public :: new_jacobian, reynolds_jacobian_t

   !> Bands by offset and row: by_pressure(o, i) = dL_R(i)/dP(i+o), by_film(o, i) = dL_R(i)/dH(i+o).
   type :: reynolds_jacobian_t
      !> (-2:2, 0:n)
      real(wp), allocatable :: by_pressure(:, :)
      !> (-2:1, 0:n)
      real(wp), allocatable :: by_film(:, :)
      !> Diagonal of the elastic Jacobian JP - JH K (0:n), negative in a sound state.
      real(wp), allocatable :: diagonal(:)
      type(mobility_slopes_t) :: slopes
      !> Mobility of the faces in the kappa scheme; allocated when first used.
      type(face_slopes_t) :: faces
   end type reynolds_jacobian_t

contains

   !> Allocates the bands for `n` intervals.
   pure subroutine new_jacobian(jacobian, n)
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      integer, intent(in) :: n

      if (allocated(jacobian%diagonal)) then
         if (size(jacobian%diagonal) == n + 1) return
         deallocate (jacobian%by_pressure, jacobian%by_film, jacobian%diagonal)
         deallocate (jacobian%slopes%e, jacobian%slopes%e_p, jacobian%slopes%e_h, &
            jacobian%slopes%e_slope)
         deallocate (jacobian%slopes%rho, jacobian%slopes%rho_p)
         jacobian%faces = face_slopes_t()
      end if
      allocate (jacobian%by_pressure(-2:2, 0:n), jacobian%by_film(-2:1, 0:n), &
         jacobian%diagonal(0:n), source=0.0_wp)
      allocate (jacobian%slopes%e(0:n), jacobian%slopes%e_p(0:n), jacobian%slopes%e_h(0:n), &
         jacobian%slopes%e_slope(0:n))
      allocate (jacobian%slopes%rho(0:n), jacobian%slopes%rho_p(0:n))
   end subroutine new_jacobian

end module jacobian_bands

!> Film equation (2.58): H = X^2/2 - Psi_1 - Psi_2 + H0 - K P, on a coarse grid with the right side
!> of the coarse problem, `rhs_film`. K is that of the level: of rigid bodies it is zero.
module film_equation
   use kinds, only: wp
   use line_level, only: line_level_t, thinnest_film
   implicit none (type, external)
   private

   public :: elastic_film, evaluate_deflection, take_film, update_film

contains

   !> K P of the present pressure, by FFT.
   subroutine evaluate_deflection(level)
      type(line_level_t), intent(inout) :: level

      if (.not. level%elasticity > 0.0_wp) return   ! it has been 0 from the start
      call level%convolution%apply(level%state%pressure, level%deflection)
      level%products = level%products + 1
   end subroutine evaluate_deflection

   !> The film (0:n) of the present H0 and of the last K P; it may be closed (H <= 0).
   pure function elastic_film(level) result(film)
      type(line_level_t), intent(in) :: level
      real(wp) :: film(0:level%n)

      film = level%rhs_film + level%state%rigid_displacement - level%deflection
   end function elastic_film

   !> The film of the level becomes that of the present pressure and H0.
   subroutine take_film(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_deflection(level)
      level%state%film = elastic_film(level)
   end subroutine take_film

   !> The film of the present pressure, guarded: it may at most halve in one go, so that it stays
   !> positive.
   subroutine update_film(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_deflection(level)
      level%state%film = max(elastic_film(level), 0.5_wp*level%state%film, thinnest_film)
   end subroutine update_film

end module film_equation

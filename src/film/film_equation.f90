!> Film equation (2.58): H = X^2/2 - Psi_1 - Psi_2 + H0 - K P, on a coarse grid with the right side
!> of the coarse problem, `rhs_film`. K is that of the level: zero for rigid bodies.
!>
!> Force balance (2.60) by the trapezoidal rule, P = 0 at both ends: dX sum P = `rhs_load`, which is
!> pi/2, or on a coarse grid the load of the coarse problem.
module film_equation
   use kinds, only: wp
   use line_level, only: line_level_t, thinnest_film
   implicit none (type, external)
   private

   public :: carried_load, elastic_film, evaluate_deflection, load_defect, &
      set_film, update_film

contains

   !> Computes K P of the present pressure by FFT.
   subroutine evaluate_deflection(level)
      type(line_level_t), intent(inout) :: level

      if (.not. level%elastic%elasticity > 0.0_wp) return   ! it has been 0 from the start
      call level%elastic%apply(level%state%pressure, level%elastic%deflection)
   end subroutine evaluate_deflection

   !> Film (0:n) of the present H0 and the last K P; it may be closed (H <= 0).
   pure function elastic_film(level) result(film)
      type(line_level_t), intent(in) :: level
      real(wp) :: film(0:level%n)

      film = level%rhs_film + level%state%rigid_displacement - level%elastic%deflection
   end function elastic_film

   !> Sets the film of the level from its present pressure and H0.
   subroutine set_film(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_deflection(level)
      level%state%film = elastic_film(level)
   end subroutine set_film

   !> Sets the film from the present pressure and H0, but reduces it by at most half, so that it
   !> stays positive.
   subroutine update_film(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_deflection(level)
      level%state%film = max(elastic_film(level), 0.5_wp*level%state%film, thinnest_film)
   end subroutine update_film

   !> Load carried by the pressure, dX sum P.
   pure real(wp) function carried_load(level) result(load)
      type(line_level_t), intent(in) :: level

      load = level%dx*sum(level%state%pressure)
   end function carried_load

   !> Missing load, rhs_load - dX sum P.
   pure real(wp) function load_defect(level) result(defect)
      type(line_level_t), intent(in) :: level

      defect = level%rhs_load - carried_load(level)
   end function load_defect

end module film_equation

!> Film equation (2.58): H = X^2/2 - Psi_1 - Psi_2 + H0 - K P, on a coarse grid with the right side
!> of the coarse problem, `rhs_film`. K is that of the level: zero for rigid bodies.
!>
!> Force balance (2.60) by the trapezoidal rule, P = 0 at both ends: dX sum P = `rhs_load`, which is
!> pi/2, or on a coarse grid the load of the coarse problem.
!>
!> Where asperities touch, P is the sum of their pressure and that of the oil, and H of (2.58) the
!> separation of the mean planes: the film is the mean gap that belongs to it (module asperities).
module film_equation
   use asperities, only: asperity_pressure, flow_factor, mean_gap
   use kinds, only: wp
   use line_level, only: line_level_t, thinnest_film
   implicit none (type, external)
   private

   public :: carried_load, elastic_film, evaluate_deflection, load_defect, &
      set_film, share_pressure, total_pressure, update_film

contains

   !> Computes K P of the present pressure by FFT.
   subroutine evaluate_deflection(level)
      type(line_level_t), intent(inout) :: level

      if (.not. level%elastic%elasticity > 0.0_wp) return   ! it has been 0 from the start
      if (allocated(level%rough)) then
         call level%elastic%apply(total_pressure(level), level%elastic%deflection)
      else
         call level%elastic%apply(level%state%pressure, level%elastic%deflection)
      end if
   end subroutine evaluate_deflection

   !> Pressure of oil and asperities (0:n).
   pure function total_pressure(level) result(p)
      type(line_level_t), intent(in) :: level
      real(wp) :: p(0:level%n)

      p = level%state%pressure
      if (allocated(level%rough)) p = p + level%state%asperity_pressure
   end function total_pressure

   !> Film (0:n) of the present H0 and the last K P; it may be closed (H <= 0).
   pure function elastic_film(level) result(film)
      type(line_level_t), intent(in) :: level
      real(wp) :: film(0:level%n)

      film = level%rhs_film + level%state%rigid_displacement - level%elastic%deflection
   end function elastic_film

   !> Sets the film of the level from its present pressure and H0; between rough surfaces also
   !> separation, mean gap and what the asperities do there: none at both ends, where P = 0.
   subroutine set_film(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_deflection(level)
      level%state%film = elastic_film(level)
      if (.not. allocated(level%rough)) return
      associate (rough => level%rough, h => level%state%separation, film => level%state%film)
         h = film
         call asperity_pressure(rough%law, h, rough%pressure, rough%slope)
         rough%pressure([0, level%n]) = 0.0_wp
         rough%slope([0, level%n]) = 0.0_wp
         call mean_gap(rough%law, h, film, rough%gap_slope)
         if (rough%law%has_flow_factor) call flow_factor(rough%law, h, film, rough%gap_slope, &
            rough%factor, rough%ln_slope)
      end associate
   end subroutine set_film

   !> Sets film and gap of the level from `state%pressure` as the total, and shares that: oil bears
   !> what the asperities do not.
   subroutine share_pressure(level)
      type(line_level_t), intent(inout) :: level

      level%state%asperity_pressure = 0.0_wp
      call set_film(level)
      level%state%asperity_pressure = min(level%state%pressure, level%rough%pressure)
      level%state%pressure = level%state%pressure - level%state%asperity_pressure
   end subroutine share_pressure

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
      if (allocated(level%rough)) load = load + level%dx*sum(level%state%asperity_pressure)
   end function carried_load

   !> Missing load, rhs_load - dX sum P.
   pure real(wp) function load_defect(level) result(defect)
      type(line_level_t), intent(in) :: level

      defect = level%rhs_load - carried_load(level)
   end function load_defect

end module film_equation

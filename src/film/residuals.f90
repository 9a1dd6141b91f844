!> The residuals that decide on convergence.
module residuals
   use film_equation, only: carried_load, elastic_film, evaluate_deflection, load_defect
   use inlet_tail, only: tail_of
   use kinds, only: wp
   use line_level, only: contact_load, line_level_t
   use reynolds_line, only: evaluate_reynolds
   implicit none (type, external)
   private

   public :: measure_residual, residual_t

   !> Residuals of the original problem in the unit of d(rho H)/dX, see `measure_residual`.
   type :: residual_t
      !> max |r|/lambda over P > 0, max(r, 0)/lambda where P = 0.
      real(wp) :: reynolds = huge(1.0_wp)
      !> |dX sum P - pi/2|, with the load of the tail of this state.
      real(wp) :: load = huge(1.0_wp)
      !> Round-off floor of `reynolds`, see `round_off`.
      real(wp) :: floor = 0.0_wp
      !> False if the film of the pressure closes somewhere, so that there is no residual.
      logical :: film_is_open = .false.
   end type residual_t

contains

   !> Computes the residuals with the film that belongs exactly to the pressure. The level's film
   !> becomes that film unless it closes; with `film_is_exact` it already is.
   subroutine measure_residual(level, residual, film_is_exact)
      type(line_level_t), intent(inout) :: level
      type(residual_t), intent(out) :: residual
      logical, intent(in), optional :: film_is_exact
      real(wp) :: tail_pressure, tail_load
      logical :: is_at_hand

      is_at_hand = .false.
      if (present(film_is_exact)) is_at_hand = film_is_exact
      level%work%nodes = level%state%film
      if (.not. is_at_hand) then
         call evaluate_deflection(level)
         level%work%nodes = elastic_film(level)
      end if
      residual%load = abs(load_defect(level))
      residual%film_is_open = all(level%work%nodes > 0.0_wp)
      if (.not. residual%film_is_open) return
      level%state%film = level%work%nodes
      call evaluate_reynolds(level)
      if (level%has_tail) then
         call tail_of(level, tail_pressure, tail_load)
         residual%load = abs(contact_load - tail_load - carried_load(level))
      end if
      level%work%nodes = (level%operator - level%rhs_reynolds)/level%lambda
      level%work%nodes(0) = 0.0_wp
      level%work%nodes(level%n) = 0.0_wp
      residual%reynolds = maxval(merge(abs(level%work%nodes), max(level%work%nodes, 0.0_wp), &
         level%state%pressure > 0.0_wp))
      residual%floor = round_off(level)
   end subroutine measure_residual

   !> Round-off of |r|/lambda: 4e-16 ( max(e P)/(lambda dX^2) + max(H)/dT ), by P and H in their
   !> differences; with the compensation of P, 1e-15 ( max(H) + max|K P|/pi )/dX, by the mass flux:
   !> by e, H and the terms of H.
   pure real(wp) function round_off(level) result(floor)
      type(line_level_t), intent(in) :: level

      if (allocated(level%state%compensation)) then
         floor = 1.0e-15_wp*(maxval(level%state%film) + maxval(abs(level%elastic%deflection))) &
            /level%dx
      else
         floor = 4.0e-16_wp*(maxval(level%oil%face_mobility*max(level%state%pressure(1:), &
            level%state%pressure(:level%n - 1))) &
            /(level%lambda*level%dx**2) + maxval(level%state%film)*level%inverse_time_step)
      end if
   end function round_off

end module residuals

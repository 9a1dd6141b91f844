!> Effect of the full momentum equations on a transient, time by time, against the Reynolds equation
!> on the same grid.
module film_passage
   use kinds, only: wp
   use line_state, only: line_state_t
   use quantities, only: central_value, parabola_minimum
   use listener, only: follower_t
   implicit none (type, external)
   private

   public :: film_passage_t, new_passage

   !> Series over the time steps, T = 0 first (0:steps), and profiles of every `stride`-th one.
   type :: film_passage_t
      integer :: stride = 1
      !> Last step added.
      integer :: last = -1
      !> T; smallest film, film at X = 0 and largest pressure by the full equations (series 1 to 3)
      !> and by the Reynolds equation (4 to 6); largest differences of the mean pressure [p_h] and
      !> of the film [b^2/R], largest difference of pressures across the film [p_h] (7 to 9).
      real(wp), allocatable :: time(:), series(:, :)
      !> Mean pressure and film of the profiles (nx, 0:steps/stride).
      real(wp), allocatable :: pressure(:, :), film(:, :)
   contains
      procedure :: add, make_room
   end type film_passage_t

contains

   !> Allocates room for this many steps on nx nodes.
   pure function new_passage(steps, stride, nx) result(passage)
      integer, intent(in) :: steps, stride, nx
      type(film_passage_t) :: passage

      passage%stride = stride
      allocate (passage%time(0:steps), passage%series(9, 0:steps), &
         passage%pressure(nx, 0:steps/stride), passage%film(nx, 0:steps/stride), source=0.0_wp)
   end function new_passage

   !> Makes room for this many steps, if there is less, and keeps the values added so far.
   pure subroutine make_room(self, steps)
      class(film_passage_t), intent(inout) :: self
      integer, intent(in) :: steps
      type(film_passage_t) :: wide
      integer :: profiles

      if (ubound(self%time, 1) >= steps) return
      wide = new_passage(steps, self%stride, size(self%pressure, 1))
      profiles = self%last/self%stride
      wide%last = self%last
      wide%time(:self%last) = self%time(:self%last)
      wide%series(:, :self%last) = self%series(:, :self%last)
      wide%pressure(:, :profiles) = self%pressure(:, :profiles)
      wide%film(:, :profiles) = self%film(:, :profiles)
      self%time = wide%time
      self%series = wide%series
      self%pressure = wide%pressure
      self%film = wide%film
   end subroutine make_room

   !> Adds the end of a time step; `state` is that of the Reynolds equation.
   subroutine add(self, step, state, follower)
      class(film_passage_t), intent(inout) :: self
      integer, intent(in) :: step
      type(line_state_t), intent(in) :: state
      class(follower_t), intent(in) :: follower

      self%last = step
      self%time(step) = state%time
      associate (full => follower%state)
         self%series(:, step) = [extremes(full%pressure, full%film), extremes(state%pressure, &
            state%film_thickness), maxval(abs(full%pressure - state%pressure)), &
            maxval(abs(full%film - state%film_thickness)), follower%pressure_variation]
         if (mod(step, self%stride) /= 0) return
         self%pressure(:, step/self%stride) = full%pressure
         self%film(:, step/self%stride) = full%film
      end associate

   contains

      !> Smallest and central film, largest pressure.
      function extremes(p, film)
         real(wp), intent(in) :: p(:), film(:)
         real(wp) :: extremes(3)

         extremes = [parabola_minimum(state%x, film), central_value(state%x, film), maxval(p)]
      end function extremes

   end subroutine add

end module film_passage

!> State of the march of the full momentum equations: everything that its later steps and its result
!> depend on, so that an interrupted run resumes without changing a bit; and the prediction of the
!> next film from the last ones.
module momentum_history
   use film_state, only: film_state_t
   use kinds, only: wp
   use march_state, only: parabola_weights
   implicit none (type, external)
   private

   public :: excess_t, max_excesses, momentum_history_t, newton_cost_t, next_count, past_t, &
      weights_of

   !> Most films that predict the next one.
   integer, parameter :: max_excesses = 3

   !> Quantities of an old time that the equations need, or a combination of several: H, z1 (0:n),
   !> rho H of the layers (layers, 0:n).
   type :: past_t
      real(wp), allocatable :: film(:), lower(:), mass(:, :)
   end type past_t

   !> P (layers, 0:n), U (layers, n), V (0:layers, 0:n) and H0 of a film, or their excess over those
   !> of the Reynolds equation at the same time; U over that of the thin film with its P and H.
   type :: excess_t
      real(wp), allocatable :: p(:, :), u(:, :), v(:, :)
      real(wp) :: rigid_displacement = 0.0_wp
   end type excess_t

   !> Newton steps, factorisations of the matrix, steps of GMRES.
   type :: newton_cost_t
      integer :: steps = 0, factorisations = 0, linear_iterations = 0
   end type newton_cost_t

   !> Cost of a march: time steps, or parts of them, most Newton steps for one, and the number of
   !> those with more than three.
   type, extends(newton_cost_t) :: march_cost_t
      integer :: solutions = 0, most_steps = 0, longer = 0
   end type march_cost_t

   !> History of the march, the newest first, and its present film.
   type, extends(march_cost_t) :: momentum_history_t
      integer :: layers = 0
      !> Film of the Reynolds equation, and heights Psi_1 and Psi_2 of the walls (0:n, 2).
      type(film_state_t) :: reynolds
      real(wp), allocatable :: heights(:, :)
      !> Numbers of `past` and of `excess` in use.
      integer :: times = 0, films = 0
      type(past_t) :: past(2)
      type(excess_t) :: excess(max_excesses)
      !> Time from each of these films back to the next older one.
      real(wp) :: lengths(max_excesses - 1) = 0.0_wp
      !> Number of films that predict the next one.
      integer :: best_count = 0
      !> Largest T_max so far.
      real(wp) :: stress_rise = 0.0_wp
      !> Set in a stored state: the present film, its H (0:n), half the weight of the new value in
      !> d/dT, and the contribution of the old ones to it.
      type(excess_t) :: flow
      real(wp), allocatable :: film(:)
      real(wp) :: half_rate = 0.0_wp
      type(past_t) :: made_of_old
   end type momentum_history_t

contains

   !> Weights of the last `count` films in the prediction for the end of a step of this length.
   pure function weights_of(past, length, count) result(weights)
      type(momentum_history_t), intent(in) :: past
      real(wp), intent(in) :: length
      integer, intent(in) :: count
      real(wp) :: weights(max_excesses), last

      weights = 0.0_wp
      last = merge(past%lengths(1), 1.0_wp, past%films > 1)
      if (count > 0) weights = parabola_weights(count, length/last, past%lengths(2)/last)
   end function weights_of

   !> Number of films that would best have predicted the present `excess` after a step of this
   !> length: pressures and velocities count alike.
   integer function next_count(past, excess, length) result(best)
      type(momentum_history_t), intent(in) :: past
      type(excess_t), intent(in) :: excess
      real(wp), intent(in) :: length
      real(wp) :: miss, smallest, weights(max_excesses)
      real(wp), allocatable :: p(:, :), u(:, :)
      integer :: count, k

      best = 0
      smallest = huge(1.0_wp)
      do count = 0, past%films
         weights = weights_of(past, length, count)
         p = excess%p
         u = excess%u
         do k = 1, count
            p = p - weights(k)*past%excess(k)%p
            u = u - weights(k)*past%excess(k)%u
         end do
         miss = max(maxval(abs(p)), maxval(abs(u)))
         if (miss < smallest) best = count
         smallest = min(miss, smallest)
      end do
   end function next_count

end module momentum_history

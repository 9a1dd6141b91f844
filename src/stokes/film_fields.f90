!> Fields of a solution of the momentum equations over X and zeta, and its differences from the
!> Reynolds equation on the same grid.
!>
!> Effect of the full momentum equations on a transient, time by time, against the Reynolds equation
!> on the same grid.
module film_fields
   use kinds, only: wp
   use line_state, only: line_state_t
   use listener, only: follower_t
   use march_state, only: newton_cost_t
   use momentum_problem, only: film_flow_t, layer_centres, momentum_problem_t
   use momentum_rows, only: momentum_terms_t
   use quantities, only: central_value, parabola_minimum
   use thin_film_flow, only: shear_differences, shear_viscosity
   implicit none (type, external)
   private

   public :: copy_fields, film_fields_t, film_passage_t, stress_rise

   !> A transient by the full equations, at the present time and up to it.
   type :: film_passage_t
      !> Smallest film, film at X = 0 and largest pressure (1 to 3), their relative differences from
      !> the Reynolds equation (4 to 6), largest differences of the mean pressure [p_h] and of the
      !> film [b^2/R], largest difference of pressures across the film [p_h] (7 to 9).
      real(wp) :: series(9) = 0.0_wp
      !> Extremes over time: smallest films and largest pressure, the same by the Reynolds equation
      !> (4 to 6), largest differences.
      real(wp) :: extremes(9) = [huge(1.0_wp), huge(1.0_wp), 0.0_wp, huge(1.0_wp), huge(1.0_wp), &
         0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
      !> Mean pressure and film (nx).
      real(wp), allocatable :: pressure(:), film(:)
   contains
      procedure :: add, compare
   end type film_passage_t

   !> Fields (layers, nx) in the middle of the layers at the nodes.
   type, extends(newton_cost_t) :: film_fields_t
      !> zeta of the layers (layers): 0 at surface 1, 1 at surface 2.
      real(wp), allocatable :: zeta(:)
      !> u and w over u_s, P = p/p_h, tau_xz/p_h, viscosity under shear over mu_0.
      real(wp), allocatable :: u(:, :), w(:, :), pressure(:, :), shear_stress(:, :), viscosity(:, :)
      !> Pressure and film of the Reynolds equation on the same nodes (nx).
      real(wp), allocatable :: reynolds_pressure(:), reynolds_film(:)
      !> Relative differences of h_min, h_central and p_max from the Reynolds equation; largest
      !> |difference| of the mean pressure and largest difference of P across the film [p_h].
      real(wp) :: h_min = 0.0_wp, h_central = 0.0_wp, p_max = 0.0_wp, pressure_change = 0.0_wp, &
         pressure_variation = 0.0_wp
      !> T_max, see `stress_rise`; in a transient the largest.
      real(wp) :: stress_rise = 0.0_wp
   end type film_fields_t

contains

   !> Adds the end of a time step; `state` is that of the Reynolds equation.
   subroutine add(self, state, follower)
      class(film_passage_t), intent(inout) :: self
      type(line_state_t), intent(in) :: state
      class(follower_t), intent(in) :: follower
      integer, parameter :: films(*) = [1, 2, 4, 5], others(*) = [3, 6, 7, 8, 9]
      real(wp) :: s(9)

      self%pressure = follower%state%pressure
      self%film = follower%state%film
      s = [extremes(self%pressure, self%film), extremes(state%pressure, state%film_thickness), &
         maxval(abs(self%pressure - state%pressure)), &
         maxval(abs(self%film - state%film_thickness)), follower%pressure_variation]
      self%series = [s(:3), s(:3)/s(4:6) - 1, s(7:)]
      self%extremes(films) = min(self%extremes(films), s(films))
      self%extremes(others) = max(self%extremes(others), s(others))

   contains

      !> Smallest and central film, largest pressure.
      function extremes(p, film)
         real(wp), intent(in) :: p(:), film(:)
         real(wp) :: extremes(3)

         extremes = [parabola_minimum(state%x, film), central_value(state%x, film), maxval(p)]
      end function extremes

   end subroutine add

   !> T_max, the largest d tau_xz/dp at a given shear rate, of the thin film with the pressure and
   !> height of this flow: tau of the sliding and of the pressure gradient. At 1 the equations
   !> change type: the momentum across the film then changes the pressure as much as that along it.
   !> The stress of the flow itself cannot serve: oil turns with a curved film, by delta^2 W_X, and
   !> while U does not yet turn with it, as in a first approximation, a stiff oil has stresses from
   !> that which are in no solution (T of thousands in pure rolling).
   pure real(wp) function stress_rise(problem, terms) result(largest)
      type(momentum_problem_t), intent(in) :: problem
      type(momentum_terms_t), intent(in) :: terms
      real(wp), dimension(0:problem%layers) :: rate, eta, by_ln_mu, by_shear2
      real(wp) :: columns
      integer :: f

      largest = 0.0_wp
      columns = 2.0_wp*problem%layers
      associate (s => terms%stresses, thin => terms%reynolds)
         do f = 1, problem%n
            rate = (thin%shear(:, f) + shear_differences(thin%u(:, f), problem%speed)) &
               /terms%geometry%face_film(f)
            call shear_viscosity(problem%shear_scale, sum(s%ln_mu(:, f - 1:f))/columns, rate**2, &
               eta, by_ln_mu, by_shear2)
            largest = max(largest, maxval(abs(rate*by_ln_mu))*sum(s%ln_mu_p(:, f - 1:f))/columns)
         end do
      end associate
      largest = problem%kappa*sqrt(problem%delta2)*largest
   end function stress_rise

   !> Sets the fields of a flow with its terms: means of the values around each point.
   pure subroutine copy_fields(problem, flow, terms, fields)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(in) :: terms
      type(film_fields_t), intent(inout) :: fields
      real(wp) :: delta, stress(0:problem%layers)
      integer :: i, left, right

      delta = sqrt(problem%delta2)
      associate (m => problem%layers, n => problem%n, s => terms%stresses, w => terms%kinematics%w)
         fields%zeta = layer_centres(m)
         fields%pressure = flow%p
         allocate (fields%u(m, n + 1), fields%w(m, n + 1), fields%shear_stress(m, n + 1), &
            fields%viscosity(m, n + 1))
         do i = 0, n
            left = max(i, 1)
            right = min(i + 1, n)
            fields%u(:, i + 1) = 0.5_wp*(flow%u(:, left) + flow%u(:, right))
            fields%w(:, i + 1) = 0.5_wp*delta*(w(:m - 1, i) + w(1:, i))
            stress = 0.5_wp*problem%kappa*delta*(s%xz(:, left) + s%xz(:, right))
            fields%shear_stress(:, i + 1) = 0.5_wp*(stress(:m - 1) + stress(1:))
            fields%viscosity(:, i + 1) = 0.25_wp*(s%corner_eta(:m - 1, left) &
               + s%corner_eta(1:, left) + s%corner_eta(:m - 1, right) + s%corner_eta(1:, right))
         end do
         fields%viscosity(:, 2:n) = s%eta(:, 1:n - 1)
      end associate
      fields%pressure_variation = maxval(maxval(flow%p, 1) - minval(flow%p, 1))
   end subroutine copy_fields

   !> Sets the differences of a transient: of films from the smallest over all times, of pressures
   !> and differences from the largest.
   pure subroutine compare(self, fields)
      class(film_passage_t), intent(in) :: self
      type(film_fields_t), intent(inout) :: fields

      associate (s => self%extremes)
         fields%h_min = s(1)/s(4) - 1
         fields%h_central = s(2)/s(5) - 1
         fields%p_max = s(3)/s(6) - 1
         fields%pressure_change = s(7)
         fields%pressure_variation = s(9)
      end associate
   end subroutine compare

end module film_fields

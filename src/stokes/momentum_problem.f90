!> Flow between two given surfaces with its full momentum equations: data, grid and unknowns.
!>
!> Scaled as the line contact, but by the film across it: x by b, z by h_ref = b^2/R, u by u_s = u1
!> + u2, w by u_s h_ref/b, p by p_h, mu by mu_0; delta = h_ref/b = b/R. The film lies between Z =
!> z1(X) and z1(X) + H(X), and is divided into `layers` by zeta, Z = z1 + zeta H.
!>
!> Staggered grid: pressures in the layers at the nodes of the Reynolds equation, velocities U in
!> the layers at the faces between nodes (face f lies left of node f), fluxes V across the film at
!> the nodes on the edges between layers. V = W - U dZ/dX (per u_s h_ref/b) crosses lines of
!> constant zeta; no oil crosses the walls, V = 0 there.
module momentum_problem
   use kinds, only: wp
   use lubricant, only: fluid_t
   use momentum_history, only: excess_t, past_t
   implicit none (type, external)
   private

   public :: film_flow_t, mean_pressure, momentum_problem_t, new_flow

   !> Flow at the inlet, where P is given: nothing across the film changes along it, dV/dX = 0; oil
   !> enters along the lines of constant zeta, V = 0; or, with dV/dX = 0, the velocities at the
   !> first face have the profile of the thin film, and the middle layer the balance of momentum.
   integer, parameter :: inlet_even = 1
   integer, parameter, public :: inlet_parallel = 2, inlet_thin = 3

   !> Grid and numbers of the equations.
   type :: momentum_equations_t
      !> Intervals in X, layers across the film.
      integer :: n = 0, layers = 0
      !> dX and dzeta.
      real(wp) :: dx = 0.0_wp, dz = 0.0_wp
      !> Speed parameter of the Reynolds equation, and kappa = lambda/6 of the momentum equations.
      real(wp) :: lambda = 0.0_wp, kappa = 0.0_wp
      !> delta^2; 0: the Reynolds equation.
      real(wp) :: delta2 = 0.0_wp
      !> rho_0 u_s^2/p_h; 0: no inertia.
      real(wp) :: inertia = 0.0_wp
      !> Speeds u1/u_s of the lower and u2/u_s of the upper wall, along the wall.
      real(wp) :: speed(2) = 0.0_wp
      type(fluid_t) :: fluid
      !> mu_0 u_s/(tau_0 h_ref) of Eyring's law, 0 for a Newtonian oil.
      real(wp) :: shear_scale = 0.0_wp
   end type momentum_equations_t

   !> Data of one problem. Arrays (0:n) unless stated.
   type, extends(momentum_equations_t) :: momentum_problem_t
      !> Lower wall z1 = lower_share H + lower_shape.
      real(wp) :: lower_share = 0.0_wp
      real(wp), allocatable :: lower_shape(:)
      !> Slopes at the faces (n, 2), upwards, of the roughness that the walls carry along; not
      !> allocated: smooth walls.
      real(wp), allocatable :: wave_slope(:, :)
      !> 1/2 dy/dT = half_rate y - old: half the weight of the new value, and the contribution of
      !> the old ones of H, z1 and of rho H in the layers (layers, 0:n). half_rate = 0: steady.
      real(wp) :: half_rate = 0.0_wp
      type(past_t) :: old
      !> Columns whose pressure is given (both ends, and cavitated ones), and that pressure.
      logical, allocatable :: is_held(:)
      real(wp), allocatable :: held_pressure(:)
      !> One of the inlets above.
      integer :: inlet = inlet_even
      !> Shares of the layers (layers) in the pressure that loads the bodies; not allocated: the
      !> mean.
      real(wp), allocatable :: loading_shares(:)
   end type momentum_problem_t

   !> Unknowns U (layers, n), V (0:layers, 0:n), P (layers, 0:n), and the film H (0:n); H0 is that
   !> of the level.
   type, extends(excess_t) :: film_flow_t
      real(wp), allocatable :: film(:)
      !> Shares of the layers in the mean of P (layers).
      real(wp), allocatable, private :: shares(:)
   end type film_flow_t

contains

   !> Allocates the flow of a problem, zero.
   pure subroutine new_flow(flow, problem)
      type(film_flow_t), intent(out) :: flow
      type(momentum_problem_t), intent(in) :: problem

      associate (m => problem%layers, n => problem%n)
         allocate (flow%u(m, n), flow%v(0:m, 0:n), flow%p(m, 0:n), flow%film(0:n), source=0.0_wp)
         allocate (flow%shares(m), source=1.0_wp/m)
      end associate
      if (allocated(problem%loading_shares)) flow%shares(:) = problem%loading_shares
   end subroutine new_flow

   !> Mean pressure across the film (0:n), as it loads the bodies.
   pure function mean_pressure(flow) result(mean)
      type(film_flow_t), intent(in) :: flow
      real(wp) :: mean(0:ubound(flow%p, 2))

      mean = matmul(flow%shares, flow%p)
   end function mean_pressure

end module momentum_problem

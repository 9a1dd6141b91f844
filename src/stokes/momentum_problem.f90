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
!>
!> Positions, slopes and speeds of the walls follow from the film.
module momentum_problem
   use kinds, only: wp
   use lubricant, only: fluid_t
   use march_state, only: excess_t, past_t
   implicit none (type, external)
   private

   public :: differentiate_geometry, evaluate_geometry, film_flow_t, film_geometry_t, &
      layer_centres, layer_edges, mean_pressure, momentum_problem_t, new_flow

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
   end type momentum_problem_t

   !> Unknowns U (layers, n), V (0:layers, 0:n), P (layers, 0:n), and the film H (0:n); H0 is that
   !> of the level.
   type, extends(excess_t) :: film_flow_t
      real(wp), allocatable :: film(:)
   end type film_flow_t

   !> At nodes (0:n) and faces (1:n): film, slopes dz1/dX and dH/dX, speeds of the walls along x; at
   !> the nodes half the time derivatives, 1/2 dz1/dT and 1/2 dH/dT.
   type :: film_geometry_t
      real(wp), allocatable :: film(:), lower_slope(:), film_slope(:)
      real(wp), allocatable :: face_film(:), face_lower_slope(:), face_film_slope(:)
      real(wp), allocatable :: wall_speed(:, :), lower_rate(:), film_rate(:)
   end type film_geometry_t

contains

   !> Allocates the flow of a problem, zero.
   pure subroutine new_flow(flow, problem)
      type(film_flow_t), intent(out) :: flow
      type(momentum_problem_t), intent(in) :: problem

      associate (m => problem%layers, n => problem%n)
         allocate (flow%u(m, n), flow%v(0:m, 0:n), flow%p(m, 0:n), flow%film(0:n), source=0.0_wp)
      end associate
   end subroutine new_flow

   !> Mean pressure across the film (0:n), which loads the bodies.
   pure function mean_pressure(flow) result(mean)
      type(film_flow_t), intent(in) :: flow
      real(wp) :: mean(0:ubound(flow%p, 2)), shares(size(flow%p, 1))

      shares = 1.0_wp/size(shares)
      mean = matmul(shares, flow%p)
   end function mean_pressure

   !> zeta of the middles of the layers (m).
   pure function layer_centres(m) result(zeta)
      integer, intent(in) :: m
      real(wp) :: zeta(m)
      integer :: j

      zeta = [((j - 0.5_wp)/m, j=1, m)]
   end function layer_centres

   !> zeta of the edges of the layers (0:m), walls included.
   pure function layer_edges(m) result(zeta)
      integer, intent(in) :: m
      real(wp) :: zeta(0:m)
      integer :: k

      zeta = [(real(k, wp)/m, k=0, m)]
   end function layer_edges

   !> Computes the geometry of a film (0:n). A smooth wall moves along itself, with u_i cos(theta)
   !> along x, and carries its roughness along.
   pure subroutine evaluate_geometry(problem, film, geometry)
      type(momentum_problem_t), intent(in) :: problem
      real(wp), intent(in) :: film(0:)
      type(film_geometry_t), intent(inout) :: geometry
      real(wp) :: lower(0:problem%n)

      lower = problem%lower_share*film + problem%lower_shape
      call evaluate_slopes(problem%dx, film, lower, geometry)
      associate (slopes => wall_slopes(problem, geometry))
         geometry%wall_speed = reshape([problem%speed(1)/sqrt(1 + problem%delta2*slopes(:, 1)**2), &
            problem%speed(2)/sqrt(1 + problem%delta2*slopes(:, 2)**2)], [problem%n, 2])
      end associate
      geometry%lower_rate(:) = problem%half_rate*lower
      geometry%film_rate(:) = problem%half_rate*film
      if (.not. problem%half_rate > 0.0_wp) return
      geometry%lower_rate = geometry%lower_rate - problem%old%lower
      geometry%film_rate = geometry%film_rate - problem%old%film
   end subroutine evaluate_geometry

   !> Slopes of the smooth walls at the faces (n, 2).
   pure function wall_slopes(problem, geometry) result(slopes)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      real(wp) :: slopes(problem%n, 2)

      slopes(:, 1) = geometry%face_lower_slope
      slopes(:, 2) = geometry%face_lower_slope + geometry%face_film_slope
      if (allocated(problem%wave_slope)) slopes = slopes - problem%wave_slope
   end function wall_slopes

   !> Computes the change of the geometry with a change `film` of the film.
   pure subroutine differentiate_geometry(problem, geometry, film, change)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      real(wp), intent(in) :: film(0:)
      type(film_geometry_t), intent(inout) :: change

      call evaluate_slopes(problem%dx, film, problem%lower_share*film, change)
      associate (d2 => problem%delta2, slopes => wall_slopes(problem, geometry), &
         d_one => change%face_lower_slope, &
         d_two => change%face_lower_slope + change%face_film_slope)
         change%wall_speed = reshape([-problem%speed(1)*d2*slopes(:, 1)*d_one &
            /sqrt(1 + d2*slopes(:, 1)**2)**3, -problem%speed(2)*d2*slopes(:, 2)*d_two &
            /sqrt(1 + d2*slopes(:, 2)**2)**3], [problem%n, 2])
      end associate
      change%film_rate(:) = problem%half_rate*film
      change%lower_rate(:) = problem%lower_share*change%film_rate
   end subroutine differentiate_geometry

   !> Sets films and slopes; at the ends of the domain the slopes of the first and the last face.
   pure subroutine evaluate_slopes(dx, film, lower, geometry)
      real(wp), intent(in) :: dx, film(0:), lower(0:)
      type(film_geometry_t), intent(inout) :: geometry
      integer :: n

      n = ubound(film, 1)
      if (.not. allocated(geometry%film)) allocate (geometry%film(0:n), geometry%lower_slope(0:n), &
         geometry%film_slope(0:n), geometry%lower_rate(0:n), geometry%film_rate(0:n))
      geometry%film(:) = film
      geometry%face_film = 0.5_wp*(film(:n - 1) + film(1:))
      geometry%face_lower_slope = (lower(1:) - lower(:n - 1))/dx
      geometry%face_film_slope = (film(1:) - film(:n - 1))/dx
      geometry%lower_slope(:) = node_slopes(geometry%face_lower_slope)
      geometry%film_slope(:) = node_slopes(geometry%face_film_slope)
   end subroutine evaluate_slopes

   !> Slopes at the nodes (n + 1) from those at the faces (n): central.
   pure function node_slopes(faces) result(nodes)
      real(wp), intent(in) :: faces(:)
      real(wp) :: nodes(size(faces) + 1)
      integer :: n

      n = size(faces)
      nodes = [faces(1), 0.5_wp*(faces(:n - 1) + faces(2:)), faces(n)]
   end function node_slopes

end module momentum_problem

!> Positions and slopes of the walls, and their speeds along x, from the film.
module film_geometry
   use kinds, only: wp
   use momentum_problem, only: momentum_problem_t
   implicit none (type, external)
   private

   public :: differentiate_geometry, film_geometry_t, layer_centres, layer_edges, evaluate_geometry

   !> At nodes (0:n) and faces (1:n): film, slopes dz1/dX and dH/dX, speeds of the walls along x; at
   !> the nodes half the time derivatives, 1/2 dz1/dT and 1/2 dH/dT.
   type :: film_geometry_t
      real(wp), allocatable :: film(:), lower_slope(:), film_slope(:)
      real(wp), allocatable :: face_film(:), face_lower_slope(:), face_film_slope(:)
      real(wp), allocatable :: wall_speed(:, :), lower_rate(:), film_rate(:)
   end type film_geometry_t

contains

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

end module film_geometry

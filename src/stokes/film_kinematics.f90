!> Shear and stretching of the film from its velocities, and their changes.
!>
!> Corners lie at the faces on the edges between layers (0:m, n), centres at the nodes in the middle
!> of the layers (m, 1:n-1). With V = W - U dZ/dX - 1/2 dZ/dT and q = (dZ/dX)/H:
!>
!>     g_xz = U_zeta/H + delta^2 ( W_X - q W_zeta ),   u_x = U_X - q U_zeta,
!>     D = u_x + w_z = ( (H U)_X + V_zeta + 1/2 dH/dT )/H,
!>     rest^2 = delta^2/2 ( (2 u_x - 2/3 D)^2 + (2 w_z - 2/3 D)^2 + (2/3 D)^2 ),
!>
!> the part of the shear rate squared, g^2 = g_xz^2 + rest^2, that a thin film does not have.
module film_kinematics
   use film_geometry, only: film_geometry_t, layer_centres, layer_edges
   use kinds, only: wp
   use momentum_problem, only: film_flow_t, momentum_problem_t
   use thin_film_flow, only: shear_differences
   implicit none (type, external)
   private

   public :: corner_means, differentiate_kinematics, film_kinematics_t, new_kinematics, &
      evaluate_kinematics

   !> Third of the trace, which the stresses of a compressible oil lack: tau_xx = eta (2 u_x - 2/3
   !> D).
   real(wp), parameter, public :: trace_share = 2.0_wp/3.0_wp

   !> Kinematics of a flow, or their changes.
   type :: film_kinematics_t
      !> dU/dzeta at the corners; of a change what the differences of U lack of it.
      real(wp), allocatable :: shear(:, :), lacking(:, :)
      !> U on the edges at the faces (0:m, n), at the nodes (0:m, 0:n), and W and dW/dzeta there.
      real(wp), allocatable :: edge_u(:, :), node_u(:, :), w(:, :), w_slope(:, :)
      !> g_xz at the corners and its mean at the centres; u_x, D, rest^2 at the centres (m, 0:n; at
      !> the ends rest^2 of their neighbours, 0 for the others).
      real(wp), allocatable :: rate(:, :), mean_rate(:, :), stretching(:, :), dilatation(:, :), &
         rest2(:, :)
   end type film_kinematics_t

contains

   !> Allocates storage.
   pure subroutine new_kinematics(kinematics, m, n)
      type(film_kinematics_t), intent(out) :: kinematics
      integer, intent(in) :: m, n

      associate (k => kinematics)
         allocate (k%shear(0:m, n), k%edge_u(0:m, n), k%rate(0:m, n), source=0.0_wp)
         allocate (k%node_u(0:m, 0:n), k%w(0:m, 0:n), k%w_slope(0:m, 0:n), source=0.0_wp)
         allocate (k%mean_rate(m, 0:n), k%stretching(m, 0:n), k%dilatation(m, 0:n), &
            k%rest2(m, 0:n), source=0.0_wp)
      end associate
   end subroutine new_kinematics

   !> Computes the kinematics from velocities `u` (m, n), fluxes `v` (0:m, 0:n) and `lacking` (0:m,
   !> n), the shear less the differences of U.
   pure subroutine evaluate_kinematics(problem, geometry, u, v, lacking, kinematics)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      real(wp), intent(in) :: u(:, :), v(0:, 0:), lacking(0:, :)
      type(film_kinematics_t), intent(inout) :: kinematics
      real(wp) :: edges(0:problem%layers), centres(problem%layers), q(problem%layers)
      integer :: f, i, m, n

      m = problem%layers
      n = problem%n
      edges = layer_edges(m)
      centres = layer_centres(m)
      associate (k => kinematics, g => geometry, dx => problem%dx, dz => problem%dz)
         do f = 1, n
            k%shear(:, f) = shear_differences(u(:, f), g%wall_speed(f, :)) + lacking(:, f)
            k%edge_u(:, f) = edge_means(u(:, f), g%wall_speed(f, :))
         end do
         call average_nodes(k%edge_u, k%node_u)
         do i = 0, n
            k%w(:, i) = v(:, i) + k%node_u(:, i)*(g%lower_slope(i) + edges*g%film_slope(i)) &
               + g%lower_rate(i) + edges*g%film_rate(i)
            k%w_slope(:, i) = edge_slopes(k%w(:, i))
         end do
         do f = 1, n
            k%rate(:, f) = k%shear(:, f)/g%face_film(f) + problem%delta2*((k%w(:, f) &
               - k%w(:, f - 1))/dx - (g%face_lower_slope(f) + edges*g%face_film_slope(f)) &
               /g%face_film(f)*0.5_wp*(k%w_slope(:, f - 1) + k%w_slope(:, f)))
         end do
         do i = 1, n - 1
            q = (g%lower_slope(i) + centres*g%film_slope(i))/g%film(i)
            k%stretching(:, i) = (u(:, i + 1) - u(:, i))/dx - q*corner_means(k%shear(:, i:i + 1))
            k%dilatation(:, i) = ((g%face_film(i + 1)*u(:, i + 1) - g%face_film(i)*u(:, i))/dx &
               + (v(1:, i) - v(:m - 1, i))/dz + g%film_rate(i))/g%film(i)
            k%mean_rate(:, i) = corner_means(k%rate(:, i:i + 1))
            associate (x => 2*k%stretching(:, i) - trace_share*k%dilatation(:, i), &
               y => trace_share*k%dilatation(:, i))
               ! the third of three stretchings whose sum is 0
               k%rest2(:, i) = 0.5_wp*problem%delta2*(x**2 + (x - y)**2 + y**2)
            end associate
         end do
         k%rest2(:, 0) = k%rest2(:, 1)
         k%rest2(:, n) = k%rest2(:, n - 1)
      end associate
   end subroutine evaluate_kinematics

   !> Their change with changes of geometry, velocities and fluxes; `change%lacking` is known.
   pure subroutine differentiate_kinematics(problem, geometry, d_geometry, u, kinematics, d_flow, &
      change)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry, d_geometry
      real(wp), intent(in) :: u(:, :)
      type(film_kinematics_t), intent(in) :: kinematics
      type(film_flow_t), intent(in) :: d_flow
      type(film_kinematics_t), intent(inout) :: change
      real(wp) :: edges(0:problem%layers), centres(problem%layers)
      real(wp) :: q(0:problem%layers), d_q(0:problem%layers)
      integer :: f, i, m, n

      m = problem%layers
      n = problem%n
      edges = layer_edges(m)
      centres = layer_centres(m)
      associate (k => kinematics, g => geometry, d_g => d_geometry, dx => problem%dx, &
         dz => problem%dz, d_u => d_flow%u, d_v => d_flow%v)
         do f = 1, n
            change%shear(:, f) = shear_differences(d_u(:, f), d_g%wall_speed(f, :)) &
               + change%lacking(:, f)
            change%edge_u(:, f) = edge_means(d_u(:, f), d_g%wall_speed(f, :))
         end do
         call average_nodes(change%edge_u, change%node_u)
         do i = 0, n
            change%w(:, i) = d_v(:, i) + change%node_u(:, i)*(g%lower_slope(i) &
               + edges*g%film_slope(i)) + k%node_u(:, i)*(d_g%lower_slope(i) &
               + edges*d_g%film_slope(i)) + d_g%lower_rate(i) + edges*d_g%film_rate(i)
            change%w_slope(:, i) = edge_slopes(change%w(:, i))
         end do
         do f = 1, n
            q = (g%face_lower_slope(f) + edges*g%face_film_slope(f))/g%face_film(f)
            d_q = (d_g%face_lower_slope(f) + edges*d_g%face_film_slope(f) &
               - q*d_g%face_film(f))/g%face_film(f)
            change%rate(:, f) = (change%shear(:, f) - k%shear(:, f)*(d_g%face_film(f) &
               /g%face_film(f)))/g%face_film(f) + problem%delta2*((change%w(:, f) - change%w(:, f &
               - 1))/dx - 0.5_wp*q*(change%w_slope(:, f - 1) + change%w_slope(:, f)) - 0.5_wp*d_q &
               *(k%w_slope(:, f - 1) + k%w_slope(:, f)))
         end do
         do i = 1, n - 1
            q(1:) = (g%lower_slope(i) + centres*g%film_slope(i))/g%film(i)
            d_q(1:) = (d_g%lower_slope(i) + centres*d_g%film_slope(i) - q(1:)*d_g%film(i))/g%film(i)
            change%stretching(:, i) = (d_u(:, i + 1) - d_u(:, i))/dx - q(1:) &
               *corner_means(change%shear(:, i:i + 1)) - d_q(1:)*corner_means(k%shear(:, i:i + 1))
            change%dilatation(:, i) = ((g%face_film(i + 1)*d_u(:, i + 1) - g%face_film(i)*d_u(:, &
               i) + d_g%face_film(i + 1)*u(:, i + 1) - d_g%face_film(i)*u(:, i))/dx + (d_v(1:, i) &
               - d_v(:m - 1, i))/dz + d_g%film_rate(i) - k%dilatation(:, i)*d_g%film(i))/g%film(i)
            change%mean_rate(:, i) = corner_means(change%rate(:, i:i + 1))
            associate (x => 2*k%stretching(:, i) - trace_share*k%dilatation(:, i), &
               y => trace_share*k%dilatation(:, i), d_x => 2*change%stretching(:, i) &
               - trace_share*change%dilatation(:, i), d_y => trace_share*change%dilatation(:, i))
               change%rest2(:, i) = problem%delta2*(x*d_x + (x - y)*(d_x - d_y) + y*d_y)
            end associate
         end do
         change%rest2(:, 0) = change%rest2(:, 1)
         change%rest2(:, n) = change%rest2(:, n - 1)
      end associate
   end subroutine differentiate_kinematics

   !> Values on the edges (0:m): means between layers, at the walls those of the walls.
   pure function edge_means(values, walls) result(edges)
      real(wp), intent(in) :: values(:), walls(2)
      real(wp) :: edges(0:size(values))
      integer :: m

      m = size(values)
      edges(0) = walls(1)
      edges(1:m - 1) = 0.5_wp*(values(:m - 1) + values(2:))
      edges(m) = walls(2)
   end function edge_means

   !> Averages faces (:, n) to nodes (:, 0:n); the ends take the first and the last face.
   pure subroutine average_nodes(faces, nodes)
      real(wp), intent(in) :: faces(0:, :)
      real(wp), intent(inout) :: nodes(0:, 0:)
      integer :: n

      n = size(faces, 2)
      nodes(:, 0) = faces(:, 1)
      nodes(:, 1:n - 1) = 0.5_wp*(faces(:, :n - 1) + faces(:, 2:))
      nodes(:, n) = faces(:, n)
   end subroutine average_nodes

   !> Second-order slopes by zeta on the edges (0:m).
   pure function edge_slopes(values) result(slopes)
      real(wp), intent(in) :: values(0:)
      real(wp) :: slopes(0:size(values) - 1)
      integer :: m

      m = size(values) - 1
      slopes(0) = 0.5_wp*m*(-3*values(0) + 4*values(1) - values(2))
      slopes(1:m - 1) = 0.5_wp*m*(values(2:) - values(:m - 2))
      slopes(m) = 0.5_wp*m*(3*values(m) - 4*values(m - 1) + values(m - 2))
   end function edge_slopes

   !> Means (m) of the four corners of the two faces at a node.
   pure function corner_means(corners) result(means)
      real(wp), intent(in) :: corners(0:, :)
      real(wp) :: means(size(corners, 1) - 1)
      integer :: m

      m = size(corners, 1) - 1
      means = 0.25_wp*(corners(:m - 1, 1) + corners(1:, 1) + corners(:m - 1, 2) + corners(1:, 2))
   end function corner_means

end module film_kinematics

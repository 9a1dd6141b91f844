!> Shear and stretching of the film from its velocities, the stresses from them and the pressures,
!> and their changes.
!>
!> Corners lie at the faces on the edges between layers (0:m, n), centres at the nodes in the middle
!> of the layers (m, 1:n-1). With V = W - U dZ/dX - 1/2 dZ/dT and q = (dZ/dX)/H:
!>
!>     g_xz = U_zeta/H + delta^2 ( W_X - q W_zeta ),   u_x = U_X - q U_zeta,
!>     D = u_x + w_z = ( (H U)_X + V_zeta + 1/2 dH/dT )/H,
!>     rest^2 = delta^2/2 ( (2 u_x - 2/3 D)^2 + (2 w_z - 2/3 D)^2 + (2/3 D)^2 ),
!>
!> the part of the shear rate squared, g^2 = g_xz^2 + rest^2, that a thin film does not have, and
!>
!>     tau_xz = eta g_xz (corners),  tau_xx = eta (2 u_x - 2/3 D),  tau_zz = eta (2 w_z - 2/3 D)
!>
!> (centres), w_z = D - u_x, in the unit mu_0 u_s/h_ref; in tau_xx and tau_zz it is multiplied by
!> delta = h_ref/b. eta by module thin_film_flow at g^2. The ln mu of a corner is the mean of its
!> four layers, as that of a face in the kappa scheme.
module film_kinematics
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_viscosity
   use momentum_problem, only: film_flow_t, film_geometry_t, layer_centres, layer_edges, &
      momentum_problem_t
   use thin_film_flow, only: shear_differences, shear_viscosity
   implicit none (type, external)
   private

   public :: change_of_stresses, corner_means, corner_values, differentiate_kinematics, &
      evaluate_kinematics, evaluate_stresses, film_kinematics_t, film_stresses_t, new_kinematics, &
      new_stresses, stress_change_t

   !> Third of the trace, which the stresses of a compressible oil lack: tau_xx = eta (2 u_x - 2/3
   !> D).
   real(wp), parameter :: trace_share = 2.0_wp/3.0_wp

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

   !> Viscosity and density, stresses, and derivatives for their changes.
   type :: film_stresses_t
      !> ln mu, its slope by P, rho, its slope (m, 0:n).
      real(wp), allocatable :: ln_mu(:, :), ln_mu_p(:, :), rho(:, :), rho_p(:, :)
      !> tau_xz (0:m, n), its derivatives by g_xz, rest^2 and ln mu there, and eta.
      real(wp), allocatable :: xz(:, :), xz_by_rate(:, :), xz_by_rest2(:, :), xz_by_ln_mu(:, :), &
         corner_eta(:, :)
      !> eta of the centres (m, 0:n) and its derivatives by g^2 and ln mu; H tau_xx, tau_xx, tau_zz.
      real(wp), allocatable :: eta(:, :), eta_by_shear2(:, :), eta_by_ln_mu(:, :), hxx(:, :), &
         xx(:, :), zz(:, :)
   end type film_stresses_t

   !> Changes of tau_xz (0:m, n), and H tau_xx, tau_xx and tau_zz (m, 0:n).
   type :: stress_change_t
      real(wp), allocatable :: xz(:, :), hxx(:, :), xx(:, :), zz(:, :), ln_mu(:, :)
   end type stress_change_t

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

   !> Allocates storage.
   pure subroutine new_stresses(stresses, m, n)
      type(film_stresses_t), intent(out) :: stresses
      integer, intent(in) :: m, n

      associate (s => stresses)
         allocate (s%ln_mu(m, 0:n), s%ln_mu_p(m, 0:n), s%rho(m, 0:n), s%rho_p(m, 0:n), &
            source=0.0_wp)
         allocate (s%xz(0:m, n), s%xz_by_rate(0:m, n), s%xz_by_rest2(0:m, n), &
            s%xz_by_ln_mu(0:m, n), s%corner_eta(0:m, n), source=0.0_wp)
         allocate (s%eta(m, 0:n), s%eta_by_shear2(m, 0:n), s%eta_by_ln_mu(m, 0:n), &
            s%hxx(m, 0:n), s%xx(m, 0:n), s%zz(m, 0:n), source=0.0_wp)
      end associate
   end subroutine new_stresses

   !> Computes the stresses from pressures (m, 0:n) and kinematics.
   pure subroutine evaluate_stresses(problem, geometry, p, kinematics, stresses)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      real(wp), intent(in), contiguous :: p(:, 0:)
      type(film_kinematics_t), intent(in) :: kinematics
      type(film_stresses_t), intent(inout) :: stresses
      real(wp), dimension(0:problem%layers) :: by_shear2, by_ln_mu
      integer :: f, i, n

      n = problem%n
      associate (s => stresses, k => kinematics, scale => problem%shear_scale)
         do i = 0, n
            call fluid_viscosity(problem%fluid, p(:, i), s%ln_mu(:, i), s%ln_mu_p(:, i))
            call fluid_density(problem%fluid, p(:, i), s%rho(:, i), s%rho_p(:, i))
         end do
         do f = 1, n
            associate (rate => k%rate(:, f))
               call shear_viscosity(scale, corner_values(s%ln_mu(:, f - 1:f), .true.), &
                  rate**2 + corner_values(k%rest2(:, f - 1:f), .false.), &
                  s%corner_eta(:, f), by_ln_mu, by_shear2)
               s%xz(:, f) = s%corner_eta(:, f)*rate
               s%xz_by_rate(:, f) = s%corner_eta(:, f) + 2*rate**2*by_shear2
               s%xz_by_rest2(:, f) = rate*by_shear2
               s%xz_by_ln_mu(:, f) = rate*by_ln_mu
            end associate
         end do
         do i = 1, n - 1
            call shear_viscosity(scale, s%ln_mu(:, i), k%mean_rate(:, i)**2 + k%rest2(:, i), &
               s%eta(:, i), s%eta_by_ln_mu(:, i), s%eta_by_shear2(:, i))
            s%xx(:, i) = s%eta(:, i)*(2*k%stretching(:, i) - trace_share*k%dilatation(:, i))
            s%zz(:, i) = s%eta(:, i)*((2 - trace_share)*k%dilatation(:, i) - 2*k%stretching(:, i))
            s%hxx(:, i) = geometry%film(i)*s%xx(:, i)
         end do
         call end_stresses(s%hxx, s%xx, geometry%film)
      end associate
   end subroutine evaluate_stresses

   !> Keeps H tau_xx constant along the first and the last interval.
   pure subroutine end_stresses(hxx, xx, film)
      real(wp), intent(inout) :: hxx(:, 0:), xx(:, 0:)
      real(wp), intent(in) :: film(0:)
      integer :: n

      n = ubound(film, 1)
      hxx(:, 0) = hxx(:, 1)
      hxx(:, n) = hxx(:, n - 1)
      xx(:, 0) = hxx(:, 0)/film(0)
      xx(:, n) = hxx(:, n)/film(n)
   end subroutine end_stresses

   !> Change of the stresses with changes of the flow's film and pressures and of the kinematics.
   pure subroutine change_of_stresses(problem, geometry, kinematics, stresses, d_flow, &
      d_kinematics, change)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      type(film_kinematics_t), intent(in) :: kinematics, d_kinematics
      type(film_stresses_t), intent(in) :: stresses
      type(film_flow_t), intent(in) :: d_flow
      type(stress_change_t), intent(inout) :: change
      real(wp) :: d_eta(problem%layers)
      integer :: f, i, m, n

      m = problem%layers
      n = problem%n
      associate (s => stresses, k => kinematics, d_k => d_kinematics, d_film => d_flow%film)
         if (.not. allocated(change%xz)) allocate (change%xz(0:m, n), change%hxx(m, 0:n), &
            change%xx(m, 0:n), change%zz(m, 0:n), change%ln_mu(m, 0:n))
         change%ln_mu(:, :) = s%ln_mu_p*d_flow%p
         do f = 1, n
            change%xz(:, f) = s%xz_by_rate(:, f)*d_k%rate(:, f) &
               + s%xz_by_rest2(:, f)*corner_values(d_k%rest2(:, f - 1:f), .false.) &
               + s%xz_by_ln_mu(:, f)*corner_values(change%ln_mu(:, f - 1:f), .true.)
         end do
         do i = 1, n - 1
            d_eta = s%eta_by_ln_mu(:, i)*change%ln_mu(:, i) + s%eta_by_shear2(:, i) &
               *(2*k%mean_rate(:, i)*d_k%mean_rate(:, i) + d_k%rest2(:, i))
            change%xx(:, i) = d_eta*(2*k%stretching(:, i) - trace_share*k%dilatation(:, i)) &
               + s%eta(:, i)*(2*d_k%stretching(:, i) - trace_share*d_k%dilatation(:, i))
            change%zz(:, i) = d_eta*((2 - trace_share)*k%dilatation(:, i) - 2*k%stretching(:, i)) &
               + s%eta(:, i)*((2 - trace_share)*d_k%dilatation(:, i) - 2*d_k%stretching(:, i))
            change%hxx(:, i) = geometry%film(i)*change%xx(:, i) + d_film(i)*s%xx(:, i)
         end do
         call end_stresses(change%hxx, change%xx, geometry%film)
         change%xx(:, 0) = change%xx(:, 0) - s%xx(:, 0)*d_film(0)/geometry%film(0)
         change%xx(:, n) = change%xx(:, n) - s%xx(:, n)*d_film(n)/geometry%film(n)
      end associate
   end subroutine change_of_stresses

   !> Values at the corners of a face (0:m) from those in the layers of both nodes (m, 2): means, at
   !> the walls extrapolated linearly or, else, those of the layer there.
   pure function corner_values(layers, is_linear) result(corners)
      real(wp), intent(in) :: layers(:, :)
      logical, intent(in) :: is_linear
      real(wp) :: corners(0:size(layers, 1)), face(size(layers, 1))
      integer :: m

      m = size(layers, 1)
      face = 0.5_wp*(layers(:, 1) + layers(:, 2))
      corners(1:m - 1) = 0.5_wp*(face(:m - 1) + face(2:))
      corners(0) = face(1)
      corners(m) = face(m)
      if (.not. is_linear) return
      corners(0) = 1.5_wp*face(1) - 0.5_wp*face(2)
      corners(m) = 1.5_wp*face(m) - 0.5_wp*face(m - 1)
   end function corner_values

end module film_kinematics

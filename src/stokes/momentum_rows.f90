!> The discrete equations of the film: mass and momentum along x and across, and their changes.
!>
!>     mass  (rho H U)_X + (rho V)_zeta + 1/2 (rho H)_T = 0
!>     x     H P_X - Z_X P_zeta - kappa ( tau_xz_zeta
!>              + delta^2 ( (H tau_xx)_X - (Z_X tau_xx)_zeta ) ) = 0
!>     z     P_zeta - kappa delta^2 ( (H tau_xz)_X + (tau_zz - Z_X tau_xz)_zeta ) = 0
!>
!> with inertia if asked for; mass (m, 0:n) at the nodes, x (m, n) over kappa at the faces, z
!> (1:m-1, 0:n) on the inner edges at the nodes. Columns whose pressure is held have P - P_held for
!> mass and V for z; at the inlet V is that of the next node.
!>
!> Inertia of the steady flow, added to the left sides, N = rho_0 u_s^2/p_h:
!>
!>     along   N H rho ( U U_X + V/H U_zeta ),   across   N delta^2 H rho ( U W_X + V/H W_zeta ),
module momentum_rows
   use film_kinematics, only: change_of_stresses, corner_means, corner_values, &
      differentiate_kinematics, evaluate_kinematics, evaluate_stresses, film_kinematics_t, &
      film_stresses_t, new_kinematics, new_stresses, stress_change_t
   use kinds, only: wp
   use momentum_problem, only: differentiate_geometry, evaluate_geometry, film_flow_t, &
      film_geometry_t, layer_centres, layer_edges, mean_pressure, momentum_problem_t
   use reynolds_part, only: change_of_profile, evaluate_reynolds_part, reynolds_part_t, &
      wedge_change
   implicit none (type, external)
   private

   public :: column_mass, evaluate_rows, inertia_across, inertia_along, mass_flux, &
      momentum_rows_t, momentum_terms_t, rows_change

   !> Residuals, or their changes.
   type :: momentum_rows_t
      real(wp), allocatable :: mass(:, :), x(:, :), z(:, :)
   end type momentum_rows_t

   !> Terms of the equations at one flow, and storage for changes of it.
   type :: momentum_terms_t
      type(film_geometry_t) :: geometry
      type(film_kinematics_t) :: kinematics
      type(film_stresses_t) :: stresses
      type(reynolds_part_t) :: reynolds
      type(film_geometry_t), private :: d_geometry
      type(film_kinematics_t), private :: d_kinematics
      type(stress_change_t), private :: d_stresses
   end type momentum_terms_t

contains

   !> Computes terms and residuals of a flow.
   pure subroutine evaluate_rows(problem, flow, terms, rows)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(inout) :: terms
      type(momentum_rows_t), intent(inout) :: rows
      integer :: f, i, m

      m = problem%layers
      call new_storage(problem, terms, rows)
      call evaluate_geometry(problem, flow%film, terms%geometry)
      call evaluate_reynolds_part(problem, terms%geometry, mean_pressure(flow), terms%reynolds)
      call evaluate_kinematics(problem, terms%geometry, flow%u, flow%v, terms%reynolds%shear, &
         terms%kinematics)
      call evaluate_stresses(problem, terms%geometry, flow%p, terms%kinematics, terms%stresses)
      associate (g => terms%geometry, s => terms%stresses, kappa => problem%kappa, &
         dx => problem%dx, d2 => problem%delta2)
         do f = 1, problem%n
            associate (slopes => layer_slopes(g%face_lower_slope(f), g%face_film_slope(f), m))
               rows%x(:, f) = (g%face_film(f)*(flow%p(:, f) - flow%p(:, f - 1))/dx &
                  - slopes*centre_slopes(0.5_wp*(flow%p(:, f - 1) + flow%p(:, f))))/kappa &
                  - edge_differences(s%xz(:, f) - d2*edge_slope_times(g%face_lower_slope(f), &
                  g%face_film_slope(f), corner_values(s%xx(:, f - 1:f), .true.))) &
                  - d2*(s%hxx(:, f) - s%hxx(:, f - 1))/dx
            end associate
         end do
         do i = 1, problem%n - 1
            rows%z(:, i) = inner_differences(flow%p(:, i)) - kappa*d2*( &
               (g%face_film(i + 1)*s%xz(1:m - 1, i + 1) - g%face_film(i)*s%xz(1:m - 1, i))/dx &
               + inner_differences(s%zz(:, i) - layer_slopes(g%lower_slope(i), g%film_slope(i), m) &
               *corner_means(s%xz(:, i:i + 1))))
         end do
      end associate
      if (problem%inertia > 0.0_wp) call add_inertia(problem, flow, terms, rows)
      call evaluate_mass(problem, flow, terms, rows%mass)
      call hold_columns(problem, flow%p, flow%v, problem%held_pressure, rows)
   end subroutine evaluate_rows

   !> Adds the inertia of the flow. (`rows_change` neglects its change: it is a millionth of the
   !> pressure.)
   pure subroutine add_inertia(problem, flow, terms, rows)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(in) :: terms
      type(momentum_rows_t), intent(inout) :: rows
      integer :: i

      associate (g => terms%geometry, k => terms%kinematics, rho => terms%stresses%rho)
         do i = 1, problem%n
            rows%x(:, i) = rows%x(:, i) + problem%inertia/problem%kappa &
               *inertia_along(problem, g, k, flow, rho, i)
         end do
         do i = 1, problem%n - 1
            rows%z(:, i) = rows%z(:, i) + problem%inertia*problem%delta2 &
               *inertia_across(problem, g, k, flow, rho, i)
         end do
      end associate
   end subroutine add_inertia

   !> Allocates terms and rows.
   pure subroutine new_storage(problem, terms, rows)
      type(momentum_problem_t), intent(in) :: problem
      type(momentum_terms_t), intent(inout) :: terms
      type(momentum_rows_t), intent(inout) :: rows

      associate (m => problem%layers, n => problem%n)
         if (.not. allocated(rows%x)) allocate (rows%x(m, n), rows%mass(m, 0:n), &
            rows%z(m - 1, 0:n), source=0.0_wp)
         if (allocated(terms%d_kinematics%lacking)) return
         call new_kinematics(terms%kinematics, m, n)
         call new_kinematics(terms%d_kinematics, m, n)
         call new_stresses(terms%stresses, m, n)
         allocate (terms%d_kinematics%lacking(0:m, n), source=0.0_wp)
      end associate
   end subroutine new_storage

   !> Computes the mass balance of the layers at the inner nodes.
   pure subroutine evaluate_mass(problem, flow, terms, mass)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(in) :: terms
      real(wp), intent(inout) :: mass(:, 0:)
      real(wp) :: flux(problem%layers, problem%n), across(0:problem%layers)
      integer :: i, m

      m = problem%layers
      flux = layer_flux(problem, flow, terms)
      across = 0.0_wp
      do i = 1, problem%n - 1
         associate (rho => terms%stresses%rho(:, i))
            across(1:m - 1) = 0.5_wp*(rho(:m - 1) + rho(2:))*flow%v(1:m - 1, i)
         end associate
         mass(:, i) = (flux(:, i + 1) - flux(:, i))/problem%dx + edge_differences(across)
      end do
      if (problem%half_rate > 0.0_wp) mass(:, 1:problem%n - 1) = mass(:, 1:problem%n - 1) &
         + squeeze(problem, flow, terms)
   end subroutine evaluate_mass

   !> 1/2 d(rho H)/dT of the layers at the inner nodes (m, 1:n-1).
   pure function squeeze(problem, flow, terms)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(in) :: terms
      real(wp) :: squeeze(problem%layers, problem%n - 1)
      integer :: i

      do i = 1, problem%n - 1
         squeeze(:, i) = problem%half_rate*terms%stresses%rho(:, i)*flow%film(i) &
            - problem%old%mass(:, i)
      end do
   end function squeeze

   !> Mass flux rho H U of the layers at the faces (m, n): the wedge with the mean speed of the
   !> walls, plus the excess of U over that.
   pure function layer_flux(problem, flow, terms) result(flux)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(in) :: terms
      real(wp) :: flux(problem%layers, problem%n), rolling
      integer :: f

      rolling = 0.5_wp*sum(problem%speed)
      associate (rho => terms%stresses%rho, h => flow%film)
         do f = 1, problem%n
            flux(:, f) = rolling*(rho(:, f - 1)*h(f - 1) + terms%reynolds%wedge(f)) &
               + sqrt(rho(:, f - 1)*h(f - 1)*rho(:, f)*h(f))*(flow%u(:, f) - rolling)
         end do
      end associate
   end function layer_flux

   !> Mass flux through the film at the faces (n), in the unit rho_0 u_s b^2/R.
   pure function mass_flux(problem, flow, terms) result(flux)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(in) :: terms
      real(wp) :: flux(problem%n)

      flux = sum(layer_flux(problem, flow, terms), 1)*problem%dz
   end function mass_flux

   !> Mean mass balance of each column (0:n), held columns too; 0 at the ends.
   pure function column_mass(problem, flow, terms) result(mass)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow
      type(momentum_terms_t), intent(in) :: terms
      real(wp) :: mass(0:problem%n), flux(problem%n)

      flux = mass_flux(problem, flow, terms)
      mass = 0.0_wp
      mass(1:problem%n - 1) = (flux(2:) - flux(:problem%n - 1))/problem%dx
      if (problem%half_rate > 0.0_wp) mass(1:problem%n - 1) = mass(1:problem%n - 1) &
         + sum(squeeze(problem, flow, terms), 1)*problem%dz
   end function column_mass

   !> Sets the rows of held columns, and of V at the inlet; all are linear.
   pure subroutine hold_columns(problem, p, v, held_pressure, rows)
      type(momentum_problem_t), intent(in) :: problem
      real(wp), intent(in) :: p(:, 0:), v(0:, 0:), held_pressure(0:)
      type(momentum_rows_t), intent(inout) :: rows
      integer :: i

      do i = 0, problem%n
         if (.not. problem%is_held(i)) cycle
         rows%mass(:, i) = p(:, i) - held_pressure(i)
         rows%z(:, i) = v(1:problem%layers - 1, i)
      end do
      rows%z(:, 0) = v(1:problem%layers - 1, 0) - v(1:problem%layers - 1, 1)
   end subroutine hold_columns

   !> Computes the change of the rows with a change of the flow. `d_mean` (0:n) is that of the mean
   !> pressure in the Reynolds part; the pressures of the layers change by `change%p`.
   pure subroutine rows_change(problem, flow, terms, change, d_mean, rows)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow, change
      type(momentum_terms_t), intent(inout) :: terms
      real(wp), intent(in) :: d_mean(0:)
      type(momentum_rows_t), intent(inout) :: rows
      real(wp) :: held(0:problem%n)

      held = 0.0_wp
      call new_storage(problem, terms, rows)
      call differentiate_geometry(problem, terms%geometry, change%film, terms%d_geometry)
      call change_of_profile(terms%reynolds%shear_by, d_mean, change%film, &
         terms%d_kinematics%lacking)
      call differentiate_kinematics(problem, terms%geometry, terms%d_geometry, flow%u, &
         terms%kinematics, change, terms%d_kinematics)
      call change_of_stresses(problem, terms%geometry, terms%kinematics, terms%stresses, change, &
         terms%d_kinematics, terms%d_stresses)
      call change_momentum(problem, flow, terms, change, rows)
      call change_mass(problem, flow, terms, change, d_mean, rows%mass)
      call hold_columns(problem, change%p, change%v, held, rows)
   end subroutine rows_change

   !> Computes the changes of the rows of momentum.
   pure subroutine change_momentum(problem, flow, terms, change, rows)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow, change
      type(momentum_terms_t), intent(in) :: terms
      type(momentum_rows_t), intent(inout) :: rows
      integer :: f, i, m

      m = problem%layers
      associate (g => terms%geometry, d_g => terms%d_geometry, s => terms%stresses, &
         d_s => terms%d_stresses, kappa => problem%kappa, dx => problem%dx, d2 => problem%delta2)
         do f = 1, problem%n
            rows%x(:, f) = (d_g%face_film(f)*(flow%p(:, f) - flow%p(:, f - 1))/dx &
               + g%face_film(f)*(change%p(:, f) - change%p(:, f - 1))/dx &
               - layer_slopes(d_g%face_lower_slope(f), d_g%face_film_slope(f), m) &
               *centre_slopes(0.5_wp*(flow%p(:, f - 1) + flow%p(:, f))) &
               - layer_slopes(g%face_lower_slope(f), g%face_film_slope(f), m) &
               *centre_slopes(0.5_wp*(change%p(:, f - 1) + change%p(:, f))))/kappa &
               - edge_differences(d_s%xz(:, f) - d2*(edge_slope_times(g%face_lower_slope(f), &
               g%face_film_slope(f), corner_values(d_s%xx(:, f - 1:f), .true.)) &
               + edge_slope_times(d_g%face_lower_slope(f), d_g%face_film_slope(f), &
               corner_values(s%xx(:, f - 1:f), .true.)))) &
               - d2*(d_s%hxx(:, f) - d_s%hxx(:, f - 1))/dx
         end do
         do i = 1, problem%n - 1
            rows%z(:, i) = inner_differences(change%p(:, i)) - kappa*d2*( &
               (g%face_film(i + 1)*d_s%xz(1:m - 1, i + 1) - g%face_film(i)*d_s%xz(1:m - 1, i) &
               + d_g%face_film(i + 1)*s%xz(1:m - 1, i + 1) &
               - d_g%face_film(i)*s%xz(1:m - 1, i))/dx &
               + inner_differences(d_s%zz(:, i) &
               - layer_slopes(g%lower_slope(i), g%film_slope(i), m) &
               *corner_means(d_s%xz(:, i:i + 1)) &
               - layer_slopes(d_g%lower_slope(i), d_g%film_slope(i), m) &
               *corner_means(s%xz(:, i:i + 1))))
         end do
      end associate
   end subroutine change_momentum

   !> Computes the changes of the mass balance.
   pure subroutine change_mass(problem, flow, terms, change, d_mean, mass)
      type(momentum_problem_t), intent(in) :: problem
      type(film_flow_t), intent(in) :: flow, change
      type(momentum_terms_t), intent(in) :: terms
      real(wp), intent(in) :: d_mean(0:)
      real(wp), intent(inout) :: mass(:, 0:)
      real(wp) :: flux(problem%layers, problem%n), across(0:problem%layers), wedge(problem%n), &
         rolling
      integer :: f, i, m

      m = problem%layers
      rolling = 0.5_wp*sum(problem%speed)
      wedge = wedge_change(problem, terms%reynolds, mean_pressure(flow), flow%film, d_mean, &
         change%film)
      associate (rho => terms%stresses%rho, rho_p => terms%stresses%rho_p, h => flow%film, &
         d_p => change%p, d_h => change%film)
         do f = 1, problem%n
            flux(:, f) = rolling*(rho_p(:, f - 1)*d_p(:, f - 1)*h(f - 1) + rho(:, f - 1)*d_h(f &
               - 1) + wedge(f)) + sqrt(rho(:, f - 1)*h(f - 1)*rho(:, f)*h(f))*(change%u(:, f) &
               + 0.5_wp*(flow%u(:, f) - rolling)*(rho_p(:, f - 1)*d_p(:, f - 1)/rho(:, f - 1) &
               + rho_p(:, f)*d_p(:, f)/rho(:, f) + d_h(f - 1)/h(f - 1) + d_h(f)/h(f)))
         end do
         across = 0.0_wp
         do i = 1, problem%n - 1
            across(1:m - 1) = 0.5_wp*((rho(:m - 1, i) + rho(2:, i))*change%v(1:m - 1, i) &
               + (rho_p(:m - 1, i)*d_p(:m - 1, i) + rho_p(2:, i)*d_p(2:, i))*flow%v(1:m - 1, i))
            mass(:, i) = (flux(:, i + 1) - flux(:, i))/problem%dx + edge_differences(across) &
               + problem%half_rate*(rho_p(:, i)*d_p(:, i)*h(i) + rho(:, i)*d_h(i))
         end do
      end associate
   end subroutine change_mass

   !> dZ/dX in the middle of the layers.
   pure function layer_slopes(lower, thickening, m) result(slopes)
      real(wp), intent(in) :: lower, thickening
      integer, intent(in) :: m
      real(wp) :: slopes(m)

      slopes = lower + thickening*layer_centres(m)
   end function layer_slopes

   !> dZ/dX on the edges times values there (0:m).
   pure function edge_slope_times(lower, thickening, values) result(products)
      real(wp), intent(in) :: lower, thickening, values(0:)
      real(wp) :: products(0:ubound(values, 1))

      products = (lower + thickening*layer_edges(ubound(values, 1)))*values
   end function edge_slope_times

   !> Differences by zeta (m) of values on the edges (0:m).
   pure function edge_differences(values) result(differences)
      real(wp), intent(in) :: values(0:)
      real(wp) :: differences(ubound(values, 1))
      integer :: m

      m = ubound(values, 1)
      differences = m*(values(1:) - values(:m - 1))
   end function edge_differences

   !> Differences by zeta on the inner edges (m - 1) of values in the layers (m).
   pure function inner_differences(values) result(differences)
      real(wp), intent(in) :: values(:)
      real(wp) :: differences(size(values) - 1)
      integer :: m

      m = size(values)
      differences = m*(values(2:) - values(:m - 1))
   end function inner_differences

   !> Slopes by zeta in the layers (m): mean of those on both edges, extrapolated at the walls.
   pure function centre_slopes(values) result(slopes)
      real(wp), intent(in) :: values(:)
      real(wp) :: slopes(size(values)), edges(0:size(values))
      integer :: m

      m = size(values)
      edges(1:m - 1) = inner_differences(values)
      edges(0) = 2*edges(1) - edges(2)
      edges(m) = 2*edges(m - 1) - edges(m - 2)
      slopes = 0.5_wp*(edges(:m - 1) + edges(1:))
   end function centre_slopes

   !> H rho (U U_X + V/H U_zeta) in the layers at face f; 0 at the first and the last face.
   pure function inertia_along(problem, geometry, kinematics, flow, rho, f) result(inertia)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      type(film_kinematics_t), intent(in) :: kinematics
      type(film_flow_t), intent(in) :: flow
      real(wp), intent(in) :: rho(:, 0:)
      integer, intent(in) :: f
      real(wp) :: inertia(problem%layers)

      inertia = 0.0_wp
      if (f == 1 .or. f == problem%n) return
      associate (m => problem%layers, u => flow%u, v => flow%v, shear => kinematics%shear)
         inertia = 0.5_wp*(rho(:, f - 1) + rho(:, f))*(geometry%face_film(f)*u(:, f)*(u(:, f + 1) &
            - u(:, f - 1))/(2*problem%dx) + 0.25_wp*(v(:m - 1, f - 1) + v(1:, f - 1) + v(:m - 1, &
            f) + v(1:, f))*0.5_wp*(shear(:m - 1, f) + shear(1:, f)))
      end associate
   end function inertia_along

   !> H rho (U W_X + V/H W_zeta) on the inner edges at node i, not at the ends.
   pure function inertia_across(problem, geometry, kinematics, flow, rho, i) result(inertia)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      type(film_kinematics_t), intent(in) :: kinematics
      type(film_flow_t), intent(in) :: flow
      real(wp), intent(in) :: rho(:, 0:)
      integer, intent(in) :: i
      real(wp) :: inertia(problem%layers - 1)

      associate (m => problem%layers, k => kinematics)
         inertia = 0.5_wp*(rho(:m - 1, i) + rho(2:, i))*(geometry%film(i)*k%node_u(1:m - 1, i) &
            *(k%w(1:m - 1, i + 1) - k%w(1:m - 1, i - 1))/(2*problem%dx) &
            + flow%v(1:m - 1, i)*k%w_slope(1:m - 1, i))
      end associate
   end function inertia_across

end module momentum_rows

!> Inertia of the steady flow in a film: the convective terms of the momentum equations.
!>
!>     along   N H rho ( U U_X + V/H U_zeta ),   across   N delta^2 H rho ( U W_X + V/H W_zeta ),
!>
!> to be added to the left sides of module momentum_rows; N = rho_0 u_s^2/p_h.
module film_inertia
   use film_geometry, only: film_geometry_t
   use film_kinematics, only: film_kinematics_t
   use kinds, only: wp
   use momentum_problem, only: film_flow_t, momentum_problem_t
   implicit none (type, external)
   private

   public :: inertia_across, inertia_along

contains

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

end module film_inertia

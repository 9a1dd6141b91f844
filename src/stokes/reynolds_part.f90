!> Parts of the full equations from the discrete Reynolds equation: the velocities of its film and
!> the mass flux of its wedge, at all faces.
!>
!> With them the full equations at delta = 0 are the discrete Reynolds equation of the kappa scheme,
!> on any number of layers, and a difference between the two is free of its errors.
module reynolds_part
   use film_state, only: film_state_t
   use kinds, only: wp
   use lubricant, only: fluid_viscosity
   use mobility, only: coefficients_t, fluid_face_mobility, mobility_slopes_t
   use momentum_problem, only: film_geometry_t, momentum_problem_t
   use reynolds_line, only: third_order_share, third_order_slope
   use thin_film_flow, only: face_flow_t, layer_flow, shear_differences
   implicit none (type, external)
   private

   public :: change_of_profile, evaluate_reynolds_part, reynolds_part_t, wedge_change

   !> Derivatives are by P and H left, then P and H right of the face.
   type :: reynolds_part_t
      !> rho at the mean pressure and d rho/dP (0:n).
      real(wp), allocatable :: rho(:), rho_p(:)
      !> Velocities of the layers (m, n), and H gamma less their differences (0:m, n); with
      !> derivatives (:, 4, n).
      real(wp), allocatable :: u(:, :), shear(:, :), u_by(:, :, :), shear_by(:, :, :)
      !> Third-order flux rho H of the faces (n) less that of the node upstream.
      real(wp), allocatable :: wedge(:)
   end type reynolds_part_t

contains

   !> Computes the part at the mean `pressure` and the film of the nodes.
   pure subroutine evaluate_reynolds_part(problem, geometry, pressure, part)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      real(wp), intent(in) :: pressure(0:)
      type(reynolds_part_t), intent(inout) :: part
      type(film_state_t) :: state
      type(coefficients_t) :: oil
      type(mobility_slopes_t) :: slopes
      real(wp) :: ln_mu(0:problem%n), ln_mu_p(0:problem%n), excess, excess_by(4)
      type(face_flow_t) :: face
      integer :: f

      associate (m => problem%layers, n => problem%n, film => geometry%film)
         if (.not. allocated(part%u)) allocate (part%u(m, n), part%shear(0:m, n), part%u_by(m, 4, &
            n), part%shear_by(0:m, 4, n), part%wedge(n), part%rho(0:n), part%rho_p(0:n))
         allocate (state%pressure(0:n), source=pressure)
         allocate (state%film(0:n), source=film)
         allocate (oil%density(0:n), oil%ln_mu(0:n), oil%face_mobility(n), slopes%rho_p(0:n), &
            slopes%by_p_left(n), slopes%by_p_right(n), slopes%by_h_left(n), slopes%by_h_right(n))
         call fluid_viscosity(problem%fluid, pressure, ln_mu, ln_mu_p)
         call fluid_face_mobility(problem%fluid, [problem%dx], state, oil, slopes)
         part%rho(:) = oil%density
         part%rho_p(:) = slopes%rho_p
         face = face_flow_t(speed=problem%speed, kappa=problem%kappa, &
            shear_scale=problem%shear_scale)
         do f = 1, n
            face%ln_mu = 0.5_wp*(ln_mu(f - 1) + ln_mu(f))
            face%slope = (pressure(f) - pressure(f - 1))/problem%dx
            face%film = geometry%face_film(f)
            call reynolds_excess(f, excess, excess_by)
            call evaluate_profile(face, f, problem%dx, ln_mu_p(f - 1:f), excess, excess_by, part)
         end do
      end associate
      call evaluate_wedge(problem, pressure, geometry%film, part)

   contains

      !> Mean of U over the film at face f by the discrete Reynolds equation, less the mean speed of
      !> the walls.
      pure subroutine reynolds_excess(f, excess, by)
         integer, intent(in) :: f
         real(wp), intent(out) :: excess, by(4)
         real(wp) :: flow, step

         associate (h => geometry%film(f - 1:f), rho => part%rho(f - 1:f), &
            rho_p => part%rho_p(f - 1:f))
            step = pressure(f) - pressure(f - 1)
            flow = 1/(2*problem%lambda*problem%dx*sqrt(rho(1)*h(1)*rho(2)*h(2)))
            excess = -oil%face_mobility(f)*step*flow
            by = -flow*([slopes%by_p_left(f), slopes%by_h_left(f), slopes%by_p_right(f), &
               slopes%by_h_right(f)]*step + oil%face_mobility(f)*[-1, 0, 1, 0]) &
               - 0.5_wp*excess*[rho_p(1)/rho(1), 1/h(1), rho_p(2)/rho(2), 1/h(2)]
         end associate
      end subroutine reynolds_excess

   end subroutine evaluate_reynolds_part

   !> Velocities and lacking shear at face `f` whose mean of U is by `excess` above that of the
   !> walls.
   pure subroutine evaluate_profile(face, f, dx, ln_mu_p, excess, excess_by, part)
      type(face_flow_t), intent(in) :: face
      integer, intent(in) :: f
      real(wp), intent(in) :: dx, ln_mu_p(2), excess, excess_by(4)
      type(reynolds_part_t), intent(inout) :: part
      real(wp), dimension(size(part%u, 1)) :: u, parabola, u_by
      real(wp) :: plain_by(size(u), 3), rates_by(0:size(u), 3), shear(0:size(u)), chain(3, 4)
      real(wp), parameter :: no_walls(2) = 0.0_wp
      integer :: i, j, m

      m = size(u)
      call layer_flow(face, m, u, plain_by, shear, rates_by)
      ! mean over a layer of 6 zeta (1 - zeta)
      parabola = [((3*real(j**2 - (j - 1)**2, wp)*m - 2*real(j**3 - (j - 1)**3, wp))/m**2, j=1, m)]
      chain(:, 1) = [0.5_wp*ln_mu_p(1), -1/dx, 0.0_wp]
      chain(:, 2) = [0.0_wp, 0.0_wp, 0.5_wp/face%film]
      chain(:, 3) = [0.5_wp*ln_mu_p(2), 1/dx, 0.0_wp]
      chain(:, 4) = chain(:, 2)
      do i = 1, 4
         u_by = matmul(plain_by, chain(:, i))
         u_by = u_by + parabola*(excess_by(i) - sum(u_by)/m)
         part%u_by(:, i, f) = u_by
         part%shear_by(:, i, f) = matmul(rates_by, chain(:, i)) - shear_differences(u_by, no_walls)
      end do
      part%u(:, f) = u + parabola*(excess + 0.5_wp*sum(face%speed) - sum(u)/m)
      part%shear(:, f) = shear - shear_differences(part%u(:, f), face%speed)
   end subroutine evaluate_profile

   !> Computes the wedge flux rho H at the faces (module reynolds_line) less that of the node
   !> upstream.
   pure subroutine evaluate_wedge(problem, pressure, film, part)
      type(momentum_problem_t), intent(in) :: problem
      real(wp), intent(in) :: pressure(0:), film(0:)
      type(reynolds_part_t), intent(inout) :: part
      real(wp) :: mass(0:problem%n)
      integer :: f

      mass = part%rho*film
      part%wedge(1) = 0.5_wp*(mass(1) - mass(0))
      do f = 2, problem%n
         part%wedge(f) = 0.5_wp*(mass(f - 1) - mass(f - 2)) &
            + third_order_share(problem%fluid%alpha_bar*second(pressure, f))/3*second(mass, f)
      end do
   end subroutine evaluate_wedge

   !> Change of `wedge` (n) with changes of pressure and film at the nodes.
   pure function wedge_change(problem, part, pressure, film, d_pressure, d_film) result(change)
      type(momentum_problem_t), intent(in) :: problem
      type(reynolds_part_t), intent(in) :: part
      real(wp), intent(in) :: pressure(0:), film(0:), d_pressure(0:), d_film(0:)
      real(wp) :: change(problem%n), mass(0:problem%n), d_mass(0:problem%n), curvature
      integer :: f

      mass = part%rho*film
      d_mass = part%rho_p*d_pressure*film + part%rho*d_film
      change(1) = 0.5_wp*(d_mass(1) - d_mass(0))
      associate (alpha => problem%fluid%alpha_bar)
         do f = 2, problem%n
            curvature = alpha*second(pressure, f)
            change(f) = 0.5_wp*(d_mass(f - 1) - d_mass(f - 2)) &
               + (third_order_share(curvature)*second(d_mass, f) &
               + third_order_slope(curvature)*alpha*second(d_pressure, f)*second(mass, f))/3
         end do
      end associate
   end function wedge_change

   !> Second difference around the node upstream of face f.
   pure real(wp) function second(values, f)
      real(wp), intent(in) :: values(0:)
      integer, intent(in) :: f

      second = values(f - 2) - 2*values(f - 1) + values(f)
   end function second

   !> Computes the change of one of the part's profiles (:, n), by its derivatives `by`, with
   !> changes of pressure and film at the nodes.
   pure subroutine change_of_profile(by, d_pressure, d_film, change)
      real(wp), intent(in) :: by(:, :, :), d_pressure(0:), d_film(0:)
      real(wp), intent(out) :: change(:, :)
      integer :: f

      do f = 1, size(by, 3)
         change(:, f) = by(:, 1, f)*d_pressure(f - 1) + by(:, 2, f)*d_film(f - 1) &
            + by(:, 3, f)*d_pressure(f) + by(:, 4, f)*d_film(f)
      end do
   end subroutine change_of_profile

end module reynolds_part

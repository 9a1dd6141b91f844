!> Stresses of the film from its shear rates and pressures, and their changes.
!>
!>     tau_xz = eta g_xz (corners),  tau_xx = eta (2 u_x - 2/3 D),  tau_zz = eta (2 w_z - 2/3 D)
!>
!> (centres), w_z = D - u_x, in the unit mu_0 u_s/h_ref; in tau_xx and tau_zz it is multiplied by
!> delta = h_ref/b. eta by module thin_film_flow at g^2 = g_xz^2 + rest^2. The ln mu of a corner is
!> the mean of its four layers, as that of a face in the kappa scheme.
module film_stresses
   use film_geometry, only: film_geometry_t
   use film_kinematics, only: film_kinematics_t, trace_share
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_viscosity
   use momentum_problem, only: momentum_problem_t
   use thin_film_flow, only: shear_viscosity
   implicit none (type, external)
   private

   public :: change_of_stresses, corner_values, film_stresses_t, new_stresses, stress_change_t, &
      evaluate_stresses

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

   !> Change of the stresses with changes of the film, of the pressures (m, 0:n) and of the
   !> kinematics.
   ! allow(too-many-arguments)  values with their changes
   pure subroutine change_of_stresses(problem, geometry, kinematics, stresses, d_film, d_p, &
      d_kinematics, change)
      type(momentum_problem_t), intent(in) :: problem
      type(film_geometry_t), intent(in) :: geometry
      type(film_kinematics_t), intent(in) :: kinematics, d_kinematics
      type(film_stresses_t), intent(in) :: stresses
      real(wp), intent(in) :: d_film(0:), d_p(:, 0:)
      type(stress_change_t), intent(inout) :: change
      real(wp) :: d_eta(problem%layers)
      integer :: f, i, m, n

      m = problem%layers
      n = problem%n
      associate (s => stresses, k => kinematics, d_k => d_kinematics)
         if (.not. allocated(change%xz)) allocate (change%xz(0:m, n), change%hxx(m, 0:n), &
            change%xx(m, 0:n), change%zz(m, 0:n), change%ln_mu(m, 0:n))
         change%ln_mu(:, :) = s%ln_mu_p*d_p
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

end module film_stresses

!> Reynolds-Eyring equation of the steady line contact on nodes anywhere, P linear between them.
!>
!> The mass flux in the middle of element i, between nodes i-1 and i with the spacing h,
!>
!>     q(i) = -e(i) (P(i) - P(i-1))/(lambda h) + (1 - a - c) rH(i-1) + a rH(i-2) + c rH(i)
!>     a = -h^2/(4 k (k + h)),  c = (h/2 + k)/(2 (k + h)),  k: spacing of element i-1
!>
!> takes rH = rho H by the parabola through three nodes and e by module mobility; a = 0, c =
!> 1/2 in the first element. The same flux leaves an element and enters the next one, whatever their
!> ratio: r(i) = q(i) - q(i+1) is 0 where P > 0. The film follows exactly from P (module
!> graded_kernel), H = H0 + X^2/2 - Psi - K P, and Int P dX = pi/2.
!>
!> Behind X = 0 or where P falls, where ln mu changes by more than 1 in an element, and in two
!> elements on either side, the scheme is the safe one: a = -h/(2 k), c = 0, and the mean of e at
!> both nodes. A pressure spike that is not resolved overshoots without it.
module graded_line
   use features, only: surface_height
   use film_state, only: film_state_t
   use flow_law, only: block_size => slip_block, largest_exponent, slip_t
   use graded_kernel, only: exact, graded_kernel_t, new_graded_kernel
   use kinds, only: pi, wp
   use line_contact, only: line_contact_t
   use lubricant, only: fluid_density, fluid_t, fluid_viscosity
   use mobility, only: coefficients_t, fluid_face_mobility, mobility_slopes_t
   implicit none (type, external)
   private

   public :: evaluate, graded_line_t, new_graded_line, point_mobility, set_pressure, steep_elements

   !> Change of ln mu in an element from which the scheme is the safe one, and elements on either
   !> side that are, too.
   real(wp), parameter :: steep = 1.0_wp
   integer, parameter, public :: margin = 2

   !> Nodes 0..n, elements 1..n, element i in front of node i, and the contact on them.
   type :: graded_grid_t
      integer :: n = 0
      real(wp) :: lambda = 0.0_wp
      type(fluid_t) :: fluid
      !> X of the nodes, and spacing of the elements [b].
      real(wp), allocatable :: x(:), spacing(:)
      !> X^2/2 - Psi_1 - Psi_2 of the nodes; K of the film, and its elasticity.
      real(wp), allocatable :: gap(:)
      type(graded_kernel_t) :: elastic
      real(wp) :: elasticity = 1.0_wp
      !> Weights a and c of the wedge, and whether the scheme is the safe one.
      real(wp), allocatable :: upstream(:), downstream(:)
      logical, allocatable :: is_safe(:)
   end type graded_grid_t

   !> A grid with its unknowns, and the equations at them.
   type, extends(graded_grid_t) :: graded_line_t
      type(film_state_t) :: state
      type(coefficients_t) :: oil
      type(mobility_slopes_t) :: slopes
      !> q of the elements, and its derivatives by P and H of nodes i-2 ... i, (-2:0, n).
      real(wp), allocatable :: flux(:), flux_by_p(:, :), flux_by_h(:, :)
      !> Derivatives of -r(i) by P and H of nodes i-2 ... i+1, (-2:2 with a 0, -2:1; n-1), and by
      !> P(i) alone, with its film.
      real(wp), allocatable :: by_pressure(:, :), by_film(:, :), diagonal(:)
      !> Where P + r/diagonal <= 0 a node is cavitated (n-1). Change of P that r, or there P, asks
      !> for.
      logical, allocatable :: is_cavitated(:)
      real(wp), allocatable :: pull(:)
      !> pi/2 - Int P dX; norm of the changes asked for; largest of |r| over the smallest film, P of
      !> cavitated nodes over the largest, and the load's.
      real(wp) :: load_defect = 0.0_wp, merit = huge(1.0_wp), error = huge(1.0_wp)
   end type graded_line_t

contains

   !> Prepares the problem of a contact at rest on rising nodes `x` (0:n) with zero unknowns; the
   !> scheme is the safe one in all elements, or where `pressure` (0:n) rises steeply.
   subroutine new_graded_line(line, contact, fluid, x, pressure)
      type(graded_line_t), intent(out) :: line
      type(line_contact_t), intent(in) :: contact
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: x(0:)
      real(wp), intent(in), optional :: pressure(0:)
      integer :: n

      n = ubound(x, 1)
      line%n = n
      line%lambda = contact%lambda
      line%fluid = fluid
      allocate (line%x(0:n), line%gap(0:n), line%is_cavitated(n - 1))
      line%x = x
      line%spacing = x(1:) - x(:n - 1)
      line%gap = 0.5_wp*x**2 - surface_height(contact%surface_1, x, 0.0_wp) &
         - surface_height(contact%surface_2, x, 0.0_wp)
      line%elasticity = contact%elasticity
      call new_graded_kernel(line%elastic, line%x, line%elasticity, exact)
      allocate (line%state%pressure(0:n), line%state%film(0:n), line%oil%density(0:n), &
         line%oil%ln_mu(0:n), line%slopes%rho_p(0:n), source=0.0_wp)
      allocate (line%oil%face_mobility(n), line%slopes%by_p_left(n), line%slopes%by_p_right(n), &
         line%slopes%by_h_left(n), line%slopes%by_h_right(n), line%flux(n), line%pull(n - 1), &
         line%flux_by_p(-2:0, n), line%flux_by_h(-2:0, n), &
         line%diagonal(n - 1), line%by_pressure(-2:2, n - 1), line%by_film(-2:1, n - 1))
      call choose_scheme(line, pressure)
   end subroutine new_graded_line

   !> Chooses the elements with the safe scheme, all without a pressure, and sets the weights of the
   !> wedge.
   pure subroutine choose_scheme(line, pressure)
      type(graded_line_t), intent(inout) :: line
      real(wp), intent(in), optional :: pressure(0:)
      logical :: is_steep(line%n)
      integer :: i

      allocate (line%is_safe(line%n), source=.true.)
      if (present(pressure)) then
         is_steep = steep_elements(line, pressure)
         do i = 1, line%n
            line%is_safe(i) = any(is_steep(max(1, i - margin):min(line%n, i + margin)))
         end do
      end if
      associate (h => line%spacing(2:), k => line%spacing(:line%n - 1), safe => line%is_safe(2:))
         line%upstream = [0.0_wp, merge(-h/(2*k), -h**2/(4*k*(k + h)), safe)]
         line%downstream = [0.5_wp, merge(0*h, (0.5_wp*h + k)/(2*(k + h)), safe)]
      end associate
   end subroutine choose_scheme

   !> Whether ln mu of a pressure (0:n) changes by over `steep`, behind X = 0 or where it falls.
   pure function steep_elements(line, pressure) result(is_steep)
      class(graded_line_t), intent(in) :: line
      real(wp), intent(in) :: pressure(0:)
      logical :: is_steep(line%n)
      real(wp) :: ln_mu(0:line%n)

      call fluid_viscosity(line%fluid, pressure, ln_mu)
      is_steep = abs(ln_mu(1:) - ln_mu(:line%n - 1)) > steep .and. (line%x(1:) > 0.0_wp &
         .or. pressure(1:) < pressure(:line%n - 1))
   end function steep_elements

   !> Sets the pressure (0:n), the rigid displacement and their film.
   pure subroutine set_pressure(line, pressure, rigid_displacement)
      type(graded_line_t), intent(inout) :: line
      real(wp), intent(in), contiguous :: pressure(0:)
      real(wp), intent(in) :: rigid_displacement

      line%state%pressure = pressure
      line%state%rigid_displacement = rigid_displacement
      call line%elastic%multiply(pressure, line%state%film)
      line%state%film = rigid_displacement + line%gap - line%state%film
   end subroutine set_pressure

   !> Evaluates the equations with their derivatives at the present pressure and positive film.
   pure subroutine evaluate(line)
      type(graded_line_t), intent(inout) :: line
      real(wp) :: residual
      integer :: i, n

      n = line%n
      call fluid_face_mobility(line%fluid, line%spacing, line%state, line%oil, line%slopes)
      if (any(line%is_safe)) call take_safe_mobility(line)
      call evaluate_flux(line)
      associate (p => line%state%pressure(1:n - 1), d => line%diagonal, pull => line%pull)
         line%error = 0.0_wp
         do i = 1, n - 1
            d(i) = max(abs(line%by_pressure(0, i) - dot_product(line%by_film(max(-2, -i):, i), &
               line%elastic%band(max(-2, -i):1, i))), tiny(1.0_wp))
            residual = line%flux(i) - line%flux(i + 1)
            pull(i) = residual/d(i)
            line%is_cavitated(i) = p(i) + pull(i) <= 0.0_wp
            if (.not. line%is_cavitated(i)) line%error = max(line%error, abs(residual))
         end do
         where (line%is_cavitated) pull = -p
         line%load_defect = 0.5_wp*pi - dot_product(line%elastic%weights, line%state%pressure)
         line%merit = norm2(pull) + abs(line%load_defect)
         line%error = max(line%error/minval(line%state%film), abs(line%load_defect), &
            max(maxval(p, line%is_cavitated), 0.0_wp)/max(maxval(p), tiny(1.0_wp)))
      end associate
   end subroutine evaluate

   !> Sets the flux of the elements, and the derivatives of -r = q(i+1) - q(i).
   pure subroutine evaluate_flux(line)
      type(graded_line_t), intent(inout) :: line
      real(wp) :: c, own, rise
      integer :: i, m, n

      n = line%n
      associate (p => line%state%pressure, h => line%state%film, rho => line%oil%density, &
         rho_p => line%slopes%rho_p, e => line%oil%face_mobility, a => line%upstream, &
         b => line%downstream, slopes => line%slopes, by_p => line%flux_by_p, &
         by_h => line%flux_by_h)
         do i = 1, n
            m = max(i - 2, 0)
            c = 1/(line%lambda*line%spacing(i))
            own = 1 - a(i) - b(i)
            rise = p(i) - p(i - 1)
            line%flux(i) = a(i)*rho(m)*h(m) + own*rho(i - 1)*h(i - 1) + b(i)*rho(i)*h(i) &
               - c*e(i)*rise
            by_p(:, i) = [a(i)*rho_p(m)*h(m), own*rho_p(i - 1)*h(i - 1) &
               - c*(slopes%by_p_left(i)*rise - e(i)), b(i)*rho_p(i)*h(i) &
               - c*(slopes%by_p_right(i)*rise + e(i))]
            by_h(:, i) = [a(i)*rho(m), own*rho(i - 1) - c*slopes%by_h_left(i)*rise, &
               b(i)*rho(i) - c*slopes%by_h_right(i)*rise]
         end do
         line%by_pressure(-1:1, :) = by_p(:, 2:)
         line%by_film(-1:1, :) = by_h(:, 2:)
         line%by_pressure([-2, 2], :) = 0.0_wp
         line%by_film(-2, :) = 0.0_wp
         line%by_pressure(-2:0, :) = line%by_pressure(-2:0, :) - by_p(:, :n - 1)
         line%by_film(-2:0, :) = line%by_film(-2:0, :) - by_h(:, :n - 1)
      end associate
   end subroutine evaluate_flux

   !> Replaces the mobility of the elements with the safe scheme by the mean of both nodes, each
   !> with the slope of P in the element.
   pure subroutine take_safe_mobility(line)
      type(graded_line_t), intent(inout) :: line
      real(wp), dimension(count(line%is_safe)) :: e, slope
      real(wp) :: by(size(e), 3)
      integer :: i, safe(size(e)), side

      safe = pack([(i, i=1, line%n)], line%is_safe)
      associate (p => line%state%pressure, h => line%state%film, mean => line%oil%face_mobility, &
         slopes => line%slopes)
         slope = (p(safe) - p(safe - 1))/line%spacing(safe)
         mean(safe) = 0.0_wp
         slopes%by_p_left(safe) = 0.0_wp
         slopes%by_p_right(safe) = 0.0_wp
         do side = 0, 1
            call point_mobility(line%fluid, p(safe - 1 + side), h(safe - 1 + side), slope, e, by)
            by(:, 3) = by(:, 3)/line%spacing(safe)
            mean(safe) = mean(safe) + 0.5_wp*e
            slopes%by_p_left(safe) = slopes%by_p_left(safe) + 0.5_wp*((1 - side)*by(:, 1) &
               - by(:, 3))
            slopes%by_p_right(safe) = slopes%by_p_right(safe) + 0.5_wp*(side*by(:, 1) + by(:, 3))
            if (side == 0) slopes%by_h_left(safe) = 0.5_wp*by(:, 2)
            if (side == 1) slopes%by_h_right(safe) = 0.5_wp*by(:, 2)
         end do
      end associate
   end subroutine take_safe_mobility

   !> Mobility e = rho H^3 S/mu at points (m) with the pressure `p`, the film `h` and the slope
   !> dP/dX, and its derivatives `by` them (m, 3).
   pure subroutine point_mobility(fluid, p, h, slope, e, by)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in), contiguous :: p(:), h(:), slope(:)
      real(wp), intent(out), contiguous :: e(:), by(:, :)
      real(wp), dimension(block_size) :: ln_mu, mu_p, rho, rho_p
      type(slip_t) :: slip
      integer :: first, last, m

      do first = 1, size(p), block_size
         last = min(first + block_size - 1, size(p))
         m = last - first + 1
         call fluid_viscosity(fluid, p(first:last), ln_mu(:m), mu_p(:m))
         call fluid_density(fluid, p(first:last), rho(:m), rho_p(:m))
         if (allocated(fluid%rheology)) call fluid%rheology%evaluate_slip(h(first:last) &
            *slope(first:last), 1/h(first:last), ln_mu(:m), .true., slip)
         e(first:last) = rho(:m)*h(first:last)**3*slip%factor(:m)*exp(min(slip%growth(:m) &
            - ln_mu(:m), largest_exponent))
         by(first:last, 1) = e(first:last)*(rho_p(:m)/rho(:m) + (slip%by_ln_mu(:m) - 1)*mu_p(:m))
         by(first:last, 2) = e(first:last)*(3 + slip%by_ln_film(:m))/h(first:last)
         by(first:last, 3) = e(first:last)*slip%by_drive(:m)*h(first:last)
      end do
   end subroutine point_mobility

end module graded_line

!> One grid of the lubricated line contact: nodes, unknowns, right sides, kernel and work space,
!> allocated once.
!>
!> Film equation (2.58): H = X^2/2 - Psi_1 - Psi_2 + H0 - K P, on a coarse grid with the right side
!> of the coarse problem, `rhs_film`. K is that of the level: zero for rigid bodies.
!>
!> Force balance (2.60) by the trapezoidal rule, P = 0 at both ends: dX sum P = `rhs_load`, which is
!> pi/2, or on a coarse grid the load of the coarse problem.
!>
!> Where asperities touch, P is the sum of their pressure and that of the oil, and H of (2.58) the
!> separation of the mean planes: the film is the mean gap that belongs to it (module asperities).
module line_level
   use asperities, only: asperities_t, asperity_pressure, flow_factor, mean_gap
   use duty, only: moment_t
   use errors, only: error_t
   use film_heating, only: heating_t, thinning
   use film_state, only: film_state_t
   use half_space, only: line_deflection_coefficients
   use kinds, only: pi, wp
   use lubricant, only: fluid_t
   use mobility, only: coefficients_t
   use toeplitz, only: new_toeplitz, toeplitz_t
   implicit none (type, external)
   private

   public :: carried_load, elastic_film, evaluate_deflection, has_close_exit, line_level_t, &
      load_defect, new_level, set_film, set_plain_problem, share_pressure, thin_oil, &
      total_pressure, turn, update_film

   !> Smallest film after a sweep [b^2/R]: a film that is halved a thousand times must not reach 0,
   !> by which the slip factor divides; the cube of this is still above 0.
   real(wp), parameter, public :: thinnest_film = 1.0e-30_wp
   !> Largest pressure after a sweep [p_h]; no sweep begins above it: a diverging iteration stays
   !> finite until its residual ends it.
   real(wp), parameter, public :: largest_pressure = 1.0e6_wp
   !> Load of the contact: the Hertz pressure integrated over X.
   real(wp), parameter, public :: contact_load = 0.5_wp*pi

   !> Deformation of the bodies by a pressure on the grid.
   type, public :: elastic_line_t
      !> Fraction of the deformation, that of the contact; 0: rigid bodies.
      real(wp) :: elasticity = 1.0_wp
      !> Kernel K_j/pi, j = 0..n, times the elasticity, and its product by FFT.
      real(wp), allocatable :: kernel(:)
      type(toeplitz_t) :: convolution
      !> Products with the kernel so far (one FFT pair each).
      integer :: products = 0
      !> K P/pi at the last evaluation (0:n).
      real(wp), allocatable :: deflection(:)
   contains
      procedure :: apply => apply_kernel
   end type elastic_line_t

   !> Rough surfaces whose asperities touch.
   type, public :: rough_gap_t
      type(asperities_t) :: law
      !> Boundary friction coefficient over b/R.
      real(wp) :: friction = 0.0_wp
      !> Pressure of the asperities at the present separation and its slope, slope of the mean gap,
      !> factor of the flow and slope of its logarithm (0:n).
      real(wp), allocatable :: pressure(:), slope(:), gap_slope(:), factor(:), ln_slope(:)
   end type rough_gap_t

   !> Warm film.
   type, public :: warm_film_t
      type(heating_t) :: law
      !> Temperature rises [K] of the mean film and of surfaces 1 and 2 (0:n, 3), the last change
      !> asked of the first (0:n), and the share of it that was made; 0: none yet.
      real(wp), allocatable :: rise(:, :), change(:)
      real(wp) :: share = 0.0_wp
   end type warm_film_t

   !> Additions of a coarse problem to a grid (module fas_cycle).
   type :: coarse_problem_t
      !> Last node with P > 0 where the problem is posed, distance [dX] behind it at which the
      !> finest grid has P = 0, and the addition to the conductance e/dX^2 to the next node.
      integer :: exit_node = 0
      real(wp) :: exit_distance = 1.0_wp, exit_conductance = 0.0_wp
      !> P and H with which it was posed (0:n).
      real(wp), allocatable :: start_pressure(:), start_film(:)
   end type coarse_problem_t

   !> Work space of smoothers and transfers (0:n): dL_R/dH at a node and the elastic diagonal
   !> dL_R/dP - (K_0/pi) dL_R/dH of the smoothers, values and corrections of the nodes.
   type :: level_work_t
      real(wp), allocatable :: film_diagonal(:), diagonal(:), nodes(:), correction(:)
   end type level_work_t

   !> A uniform grid of n intervals on [x_inlet, x_outlet]: spacing dX [b] and nodes X (0:n).
   type :: line_nodes_t
      integer :: n = 0
      real(wp) :: dx = 0.0_wp
      real(wp), allocatable :: x(:)
   end type line_nodes_t

   !> The problem on a grid; arrays are (0:n) unless stated.
   type, extends(line_nodes_t) :: line_problem_t
      !> Film of smooth rigid bodies with H0 = 0, X^2/2 less the deflection by a tail, and the load
      !> of the nodes (module line_hierarchy).
      real(wp), allocatable :: gap(:)
      real(wp) :: load = contact_load
      !> Load, radius and speeds at the present time, and |u1 + u2|/u_ref.
      type(moment_t) :: moment
      real(wp) :: entrainment = 1.0_wp
      !> The oil flows towards +X; -1: that is towards -x (module contact_moment).
      real(wp) :: direction = 1.0_wp
      !> Speed parameter lambda and scaled laws of the oil, as in the contact.
      real(wp) :: lambda = 0.0_wp
      type(fluid_t) :: fluid
      !> 2 (u2 - u1)/u_ref along X, which is the slide-to-roll ratio of a contact in steady motion.
      real(wp) :: slide_to_roll = 0.0_wp
      !> Space scheme: kappa, else upwind2 (module reynolds_line).
      logical :: is_kappa = .false.
      !> 1/dT of the time step, 0 in the steady problem.
      real(wp) :: inverse_time_step = 0.0_wp
      !> Right sides: L_R(P, H) = rhs_reynolds, H - H0 + K P = rhs_film, dX sum P = rhs_load.
      real(wp), allocatable :: rhs_reynolds(:), rhs_film(:)
      real(wp) :: rhs_load = contact_load
   end type line_problem_t

   !> A grid with its problem, unknowns and work space.
   type, extends(line_problem_t) :: line_level_t
      type(film_state_t) :: state
      !> Pressure and film solve the original problem on this grid accurately enough to be compared
      !> with finer ones.
      logical :: is_coarse_run = .false.
      !> L_R at the last evaluation, the coefficients then, and the deformation of the bodies.
      real(wp), allocatable :: operator(:)
      type(coefficients_t) :: oil
      type(elastic_line_t) :: elastic
      !> Not allocated: smooth surfaces, or whose asperities do not touch.
      type(rough_gap_t), allocatable :: rough
      !> Not allocated: all oil has the temperature of the inlet.
      type(warm_film_t), allocatable :: heat
      type(coarse_problem_t) :: posed
      type(level_work_t) :: work
   end type line_level_t

contains

   !> Allocates a level of `n` intervals between the `ends` X of the domain with zero unknowns and
   !> plans its convolution. `elasticity`: that of the contact, 1 by default.
   subroutine new_level(level, lambda, fluid, ends, n, error, elasticity)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: lambda
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: ends(2)
      integer, intent(in) :: n
      type(error_t), allocatable, intent(out) :: error
      real(wp), intent(in), optional :: elasticity
      integer :: i

      level%n = n
      level%dx = (ends(2) - ends(1))/n
      level%lambda = lambda
      level%fluid = fluid
      allocate (level%x(0:n), level%gap(0:n), level%elastic%kernel(0:n))
      level%x = [(ends(1) + i*level%dx, i=0, n - 1), ends(2)]
      level%gap = 0.5_wp*level%x**2
      allocate (level%state%pressure(0:n), level%state%film(0:n), level%rhs_reynolds(0:n), &
         level%rhs_film(0:n), level%operator(0:n), source=0.0_wp)
      associate (elastic => level%elastic, oil => level%oil, posed => level%posed, &
         work => level%work)
         if (present(elasticity)) elastic%elasticity = elasticity
         elastic%kernel = elastic%elasticity*line_deflection_coefficients(n, level%dx)
         call new_toeplitz(elastic%convolution, elastic%kernel, error)
         if (allocated(error)) return
         allocate (elastic%deflection(0:n), posed%start_pressure(0:n), posed%start_film(0:n), &
            oil%mobility(0:n), oil%density(0:n), oil%ln_mu(0:n), oil%face_mobility(n), &
            work%nodes(0:n), work%correction(0:n), source=0.0_wp)
         allocate (work%film_diagonal(0:n), work%diagonal(0:n), source=-1.0_wp)
      end associate
   end subroutine new_level

   !> Computes the deflection K p/pi of a pressure (0:n) by FFT.
   subroutine apply_kernel(self, p, deflection)
      class(elastic_line_t), intent(inout) :: self
      real(wp), intent(in), contiguous :: p(:)
      real(wp), intent(out), contiguous :: deflection(:)

      call self%convolution%apply(p, deflection)
      self%products = self%products + 1
   end subroutine apply_kernel

   !> Sets the right sides of the original (not the coarse-grid) steady problem for surface heights
   !> `roughness` = Psi_1 + Psi_2.
   pure subroutine set_plain_problem(level, roughness)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: roughness(0:)

      level%rhs_reynolds = 0.0_wp
      level%rhs_film = level%gap - roughness
      level%rhs_load = level%load
      level%inverse_time_step = 0.0_wp
      level%posed%exit_node = 0
      level%posed%exit_conductance = 0.0_wp
   end subroutine set_plain_problem

   !> Sets what the temperature of the film does to the viscosity.
   pure subroutine thin_oil(level)
      type(line_level_t), intent(inout) :: level

      call thinning(level%heat%law, level%fluid, level%heat%rise(:, 1), level%oil%factor, &
         level%oil%shift)
   end subroutine thin_oil

   !> Turns X and the state of a level.
   pure subroutine turn(level)
      type(line_level_t), intent(inout) :: level

      level%direction = -level%direction
      level%x(:) = -level%x(level%n:0:-1)
      associate (state => level%state, n => level%n)
         state%pressure(:) = state%pressure(n:0:-1)
         state%film(:) = state%film(n:0:-1)
      end associate
   end subroutine turn

   !> Whether the finest grid has P = 0 before the next node of this one, where P is still 0.
   pure logical function has_close_exit(level) result(is_close)
      type(line_level_t), intent(in) :: level

      is_close = level%posed%exit_conductance > 0.0_wp
      if (is_close) is_close = level%state%pressure(level%posed%exit_node + 1) <= 0.0_wp
   end function has_close_exit

   !> Computes K P of the present pressure by FFT.
   subroutine evaluate_deflection(level)
      type(line_level_t), intent(inout) :: level

      if (.not. level%elastic%elasticity > 0.0_wp) return   ! it has been 0 from the start
      if (allocated(level%rough)) then
         call level%elastic%apply(total_pressure(level), level%elastic%deflection)
      else
         call level%elastic%apply(level%state%pressure, level%elastic%deflection)
      end if
   end subroutine evaluate_deflection

   !> Pressure of oil and asperities (0:n).
   pure function total_pressure(level) result(p)
      type(line_level_t), intent(in) :: level
      real(wp) :: p(0:level%n)

      p = level%state%pressure
      if (allocated(level%rough)) p = p + level%state%asperity_pressure
   end function total_pressure

   !> Film (0:n) of the present H0 and the last K P; it may be closed (H <= 0).
   pure function elastic_film(level) result(film)
      type(line_level_t), intent(in) :: level
      real(wp) :: film(0:level%n)

      film = level%rhs_film + level%state%rigid_displacement - level%elastic%deflection
   end function elastic_film

   !> Sets the film of the level from its present pressure and H0; between rough surfaces also
   !> separation, mean gap and what the asperities do there: none at both ends, where P = 0.
   subroutine set_film(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_deflection(level)
      level%state%film = elastic_film(level)
      if (.not. allocated(level%rough)) return
      associate (rough => level%rough, h => level%state%separation, film => level%state%film)
         h = film
         call asperity_pressure(rough%law, h, rough%pressure, rough%slope)
         rough%pressure([0, level%n]) = 0.0_wp
         rough%slope([0, level%n]) = 0.0_wp
         call mean_gap(rough%law, h, film, rough%gap_slope)
         if (rough%law%has_flow_factor) call flow_factor(rough%law, h, film, rough%gap_slope, &
            rough%factor, rough%ln_slope)
      end associate
   end subroutine set_film

   !> Sets film and gap of the level from `state%pressure` as the total, and shares that: oil bears
   !> what the asperities do not.
   subroutine share_pressure(level)
      type(line_level_t), intent(inout) :: level

      level%state%asperity_pressure = 0.0_wp
      call set_film(level)
      level%state%asperity_pressure = min(level%state%pressure, level%rough%pressure)
      level%state%pressure = level%state%pressure - level%state%asperity_pressure
   end subroutine share_pressure

   !> Sets the film from the present pressure and H0, but reduces it by at most half, so that it
   !> stays positive.
   subroutine update_film(level)
      type(line_level_t), intent(inout) :: level

      call evaluate_deflection(level)
      level%state%film = max(elastic_film(level), 0.5_wp*level%state%film, thinnest_film)
   end subroutine update_film

   !> Load carried by the pressure, dX sum P.
   pure real(wp) function carried_load(level) result(load)
      type(line_level_t), intent(in) :: level

      load = level%dx*sum(level%state%pressure)
      if (allocated(level%rough)) load = load + level%dx*sum(level%state%asperity_pressure)
   end function carried_load

   !> Missing load, rhs_load - dX sum P.
   pure real(wp) function load_defect(level) result(defect)
      type(line_level_t), intent(in) :: level

      defect = level%rhs_load - carried_load(level)
   end function load_defect

end module line_level

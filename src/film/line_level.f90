!> One grid of the lubricated line contact: nodes, unknowns, right sides, kernel and work space,
!> allocated once.
module line_level
   use constants, only: pi
   use errors, only: error_t
   use half_space, only: line_deflection_coefficients
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use toeplitz, only: new_toeplitz, toeplitz_t
   implicit none (type, external)
   private

   public :: line_level_t, new_level, set_plain_problem, start_from_pressure, update_film, &
      film_of, has_close_exit, load_defect

   !> No sweep takes a film below this [b^2/R]: a film that is halved a thousand times must not
   !> reach 0, where its mobility is no number; its cube is one still.
   real(wp), parameter, public :: thinnest_film = 1.0e-30_wp
   !> No sweep takes a pressure above this, in Hertz's, and none begins there: an iterate that is
   !> lost stays a number until its residual ends it.
   real(wp), parameter, public :: largest_pressure = 1.0e6_wp

   !> A uniform grid of n intervals on [x_inlet, x_outlet]; arrays are (0:n) unless stated.
   type :: line_level_t
      !> Intervals.
      integer :: n = 0
      !> Spacing dX [b].
      real(wp) :: dx = 0.0_wp
      !> Space scheme: kappa, else that of the thesis (module reynolds_line).
      logical :: is_kappa = .false.
      !> 1/dT of the time step, 0 in the steady problem.
      real(wp) :: inverse_time_step = 0.0_wp
      !> Pressure and film are the solution of the original problem on this grid, accurate enough to
      !> be compared with finer ones.
      logical :: is_companion = .false.
      !> Pressure and load in front of the grid are those of module inlet_tail.
      logical :: has_tail = .false.
      !> Coarse problems: the last node with P > 0 where they are posed, how far behind it [dX] the
      !> finest grid has P = 0 again, and what that adds to the conductance e/dX^2 to the next node
      !> (module fas_cycle).
      integer :: exit_node = 0
      real(wp) :: exit_distance = 1.0_wp, exit_conductance = 0.0_wp
      !> Products with the kernel so far (one FFT pair each).
      integer :: products = 0
      !> Nodes X.
      real(wp), allocatable :: x(:)
      !> Unknowns: pressure P >= 0 and film thickness H > 0.
      real(wp), allocatable :: pressure(:), film(:)
      !> What rounding has cut off P in Newton's steps (0:n); the slopes of L_R are those of P and
      !> of this. Allocated only while cycles run that need it (module cycle_control).
      real(wp), allocatable :: pressure_rest(:)
      !> Right sides: L_R(P, H) = rhs_reynolds, H - H0 + K P = rhs_film, dX sum P = rhs_load.
      real(wp), allocatable :: rhs_reynolds(:), rhs_film(:)
      real(wp) :: rhs_load = 0.5_wp*pi
      !> Kernel K_j/pi, j = 0..n, and its product by FFT.
      real(wp), allocatable :: kernel(:)
      type(toeplitz_t) :: convolution
      !> Coefficients e = rho H^3 S/mu (of the thesis's scheme) and rho, the operator L_R, and K
      !> P/pi, at the last evaluation.
      real(wp), allocatable :: mobility(:), density(:), operator(:), deflection(:)
      !> Mobility e(i-1/2) of the face left of node i (1:n), at the last evaluation.
      real(wp), allocatable :: face_mobility(:)
      !> dL_R/dH at a node and the elastic diagonal dL_R/dP - (K_0/pi) dL_R/dH, for the smoothers.
      real(wp), allocatable :: film_diagonal(:), diagonal(:)
      !> Work space of smoothers and transfers.
      real(wp), allocatable :: work(:), correction(:)
      !> Restricted unknowns, kept to form the coarse-grid correction.
      real(wp), allocatable :: pressure_start(:), film_start(:)
   end type line_level_t

contains

   !> Allocates a level of `n` intervals with unknowns zero and plans its convolution.
   subroutine new_level(level, contact, n, error)
      type(line_level_t), intent(inout) :: level
      type(line_contact_t), intent(in) :: contact
      integer, intent(in) :: n
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      level%n = n
      level%dx = (contact%domain%x_outlet - contact%domain%x_inlet)/n
      allocate (level%x(0:n))
      do i = 0, n
         level%x(i) = contact%domain%x_inlet + i*level%dx
      end do
      level%x(n) = contact%domain%x_outlet
      allocate (level%kernel(0:n))
      level%kernel = line_deflection_coefficients(n, level%dx)
      call new_toeplitz(level%convolution, level%kernel, error)
      if (allocated(error)) return
      allocate (level%pressure(0:n), level%film(0:n), level%rhs_reynolds(0:n), &
         level%rhs_film(0:n), source=0.0_wp)
      allocate (level%mobility(0:n), level%density(0:n), level%operator(0:n), &
         level%deflection(0:n), source=0.0_wp)
      allocate (level%face_mobility(n), source=0.0_wp)
      allocate (level%work(0:n), level%correction(0:n), level%pressure_start(0:n), &
         level%film_start(0:n), source=0.0_wp)
      allocate (level%film_diagonal(0:n), level%diagonal(0:n), source=-1.0_wp)
   end subroutine new_level

   !> The right sides of the original (not the coarse-grid) steady problem for surface heights
   !> `roughness` = Psi_1 + Psi_2.
   pure subroutine set_plain_problem(level, roughness)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: roughness(0:)

      level%rhs_reynolds = 0.0_wp
      level%rhs_film = 0.5_wp*level%x**2 - roughness
      level%rhs_load = 0.5_wp*pi
      level%inverse_time_step = 0.0_wp
      level%exit_node = 0
      level%exit_conductance = 0.0_wp
   end subroutine set_plain_problem

   !> Takes over a pressure and the film that belongs to it.
   subroutine start_from_pressure(level, pressure, rigid_displacement)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: pressure(0:)
      real(wp), intent(in) :: rigid_displacement

      level%pressure = pressure
      call film_of(level, rigid_displacement, level%film)
   end subroutine start_from_pressure

   !> Film equation (2.58): film = rhs_film + H0 - K P (rhs_film = X^2/2 - Psi_1 - Psi_2 on the
   !> finest grid).
   subroutine film_of(level, rigid_displacement, film)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: rigid_displacement
      real(wp), intent(out) :: film(0:)

      call level%convolution%apply(level%pressure, level%deflection)
      level%products = level%products + 1
      film = level%rhs_film + rigid_displacement - level%deflection
   end subroutine film_of

   !> The film of the present pressure, guarded: it may at most halve in one go, so that it stays
   !> positive.
   subroutine update_film(level, rigid_displacement)
      type(line_level_t), intent(inout) :: level
      real(wp), intent(in) :: rigid_displacement

      call level%convolution%apply(level%pressure, level%deflection)
      level%products = level%products + 1
      level%film = max(level%rhs_film + rigid_displacement - level%deflection, 0.5_wp*level%film, &
         thinnest_film)
   end subroutine update_film

   !> Force balance (2.60) by the trapezoidal rule (P = 0 at both ends, or what an inlet tail
   !> carries is not in rhs_load): rhs_load - dX sum P.
   pure function load_defect(level) result(defect)
      type(line_level_t), intent(in) :: level
      real(wp) :: defect

      defect = level%rhs_load - level%dx*sum(level%pressure)
   end function load_defect

   !> Whether the finest grid has P = 0 before the next node of this one, which has P = 0 still.
   pure function has_close_exit(level) result(is_close)
      type(line_level_t), intent(in) :: level
      logical :: is_close

      is_close = level%exit_conductance > 0.0_wp
      if (is_close) is_close = level%pressure(level%exit_node + 1) <= 0.0_wp
   end function has_close_exit

end module line_level

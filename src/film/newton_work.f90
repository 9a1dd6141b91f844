!> Work space and outcome of Newton's method, and the linear system of one of its steps.
!>
!> Its unknowns are the changes of P(1..n-1) and H0. Row i < n is the Reynolds equation of node i
!> divided by the elastic diagonal (the identity where the node is cavitated), row n the force
!> balance.
!>
!> Exact Jacobian of the discrete Reynolds-Eyring operator L_R(P, H) of `reynolds_line`: bands in P
!> and in H.
!>
!> With the film equation H = ... + H0 - K P it gives the elastic Jacobian J = JP - JH K of the
!> Newton methods.
!>
!> Where oil is conserved, a cavitated node passes on a change dq of what arrives: what leaves it
!> changes by `carry` dq, which is all of it in the steady state, and else theta rho H keeps a part.
!> Bands of cavitated rows are those of dq, and the row behind a cavity has no bands of what leaves
!> that. (Of relative order dX in what leaves, the difference of the changes of rho H at the node
!> and at the face is left out.)
module newton_work
   use kinds, only: wp
   use line_level, only: has_close_exit, line_level_t
   use film_state, only: film_state_t
   use lubricant, only: thins
   use mobility, only: fluid_mobility, mobility_slopes_t
   use reynolds_line, only: apply_reynolds, evaluate_coefficients, is_third_order, &
      third_order_share, third_order_slope, wedge_weights
   implicit none (type, external)
   private

   public :: allocate_work, evaluate_jacobian, linear_solver_t, new_jacobian, newton_t, &
      reynolds_jacobian_t, share_rows

   !> Bands by offset and row: by_pressure(o, i) = dL_R(i)/dP(i+o), by_film(o, i) = dL_R(i)/dH(i+o).
   type :: reynolds_jacobian_t
      !> (-2:2, 0:n)
      real(wp), allocatable :: by_pressure(:, :)
      !> (-2:1, 0:n)
      real(wp), allocatable :: by_film(:, :)
      !> Diagonal of the elastic Jacobian JP - JH K (0:n), negative in a sound state.
      real(wp), allocatable :: diagonal(:)
      !> Share of a change of what arrives at a node that leaves it (0:n), 0 unless it cavitates and
      !> conserves its oil; allocated if that is so.
      real(wp), allocatable :: carry(:)
      type(mobility_slopes_t) :: slopes
   end type reynolds_jacobian_t

   !> A solver of the system.
   type, abstract :: linear_solver_t
      !> Share of the right side that an iterative solution may leave.
      real(wp) :: tolerance = 1.0e-2_wp
      !> Bound on the Reynolds residual |r| that it may leave.
      real(wp) :: goal = huge(1.0_wp)
      !> Iterations of the last call (0 for a direct solution).
      integer :: iterations = 0
   contains
      procedure(solve_interface), deferred :: solve
   end type linear_solver_t

   !> Linear solver, Jacobian, step and outcome.
   type :: newton_t
      class(linear_solver_t), allocatable :: linear
      type(reynolds_jacobian_t) :: jacobian
      real(wp), allocatable :: step(:)
      !> State before the last step.
      type(film_state_t) :: before
      logical, allocatable :: is_cavitated(:)
      !> Wall stress per H dP/dX of the lubricant; 0 for a Newtonian one.
      real(wp) :: stress_scale = 0.0_wp
      !> Whether steps are bent (`bend_step`): Newtonian lubricants.
      logical :: is_bent = .false.
      !> Largest |r| of the nodes not cavitated, at the last linearisation.
      real(wp) :: residual = 0.0_wp
      !> Newton steps of the last call, and steps of the linear solver in all calls.
      integer :: steps = 0, linear_iterations = 0
      !> Nodes with pressure at the last step, and steps in a row in which few have come or gone.
      integer :: active = 0, creeping = 0
      !> Size of the last step in P and H0; below `tolerance` when converged.
      real(wp) :: last_step = huge(1.0_wp)
      !> Largest relative change of a film in the last step.
      real(wp) :: last_film_step = huge(1.0_wp)
      !> True if the last call ended by its tolerance or at round-off.
      logical :: is_converged = .false.
   end type newton_t

   abstract interface
      !> Solves with `jacobian`, whose bands are already divided by the elastic diagonal; `step` (n)
      !> is the right side on entry and the solution on return. `is_solved` is false if the system
      !> is singular.
      subroutine solve_interface(self, level, jacobian, is_cavitated, step, is_solved)
         import :: line_level_t, linear_solver_t, reynolds_jacobian_t, wp
         class(linear_solver_t), intent(inout), target :: self
         type(line_level_t), intent(inout), target :: level
         type(reynolds_jacobian_t), intent(in), target :: jacobian
         logical, intent(in) :: is_cavitated(:)
         real(wp), intent(inout) :: step(:)
         logical, intent(out) :: is_solved
      end subroutine solve_interface
   end interface

contains

   !> Allocates the bands for `n` intervals.
   pure subroutine new_jacobian(jacobian, n)
      type(reynolds_jacobian_t), intent(out) :: jacobian
      integer, intent(in) :: n

      allocate (jacobian%by_pressure(-2:2, 0:n), jacobian%by_film(-2:1, 0:n), &
         jacobian%diagonal(0:n), source=0.0_wp)
      associate (slopes => jacobian%slopes)
         allocate (slopes%rho_p(0:n), slopes%e_p(0:n), slopes%e_h(0:n), slopes%e_slope(0:n))
      end associate
   end subroutine new_jacobian

   !> Allocates work space for n intervals and resets the count of steps.
   subroutine allocate_work(newton, n)
      type(newton_t), intent(inout) :: newton
      integer, intent(in) :: n

      newton%steps = 0
      newton%last_step = huge(1.0_wp)
      if (allocated(newton%step)) then
         if (size(newton%step) == n) return
         deallocate (newton%step, newton%is_cavitated)
      end if
      allocate (newton%step(n), newton%is_cavitated(n - 1))
      call new_jacobian(newton%jacobian, n)
   end subroutine allocate_work

   !> Turns rows, divided by their diagonals, from oil pressure and mean gap to total pressure and
   !> separation, where asperities touch: dP_oil = dP - pc' dH where oil fills the gap; elsewhere it
   !> is -P_oil, which goes to the right side `step` (1:n-1), and the row says P = pc(H). What such
   !> a row knows of dq goes on to the rows behind. (The change of H two nodes downstream, with a
   !> thinning oil, is taken one node nearer.)
   pure subroutine share_rows(level, jacobian, is_cavitated, step)
      type(line_level_t), intent(in) :: level
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      logical, intent(in) :: is_cavitated(:)
      real(wp), intent(inout) :: step(:)
      real(wp) :: diagonal, known, passed, right
      integer :: i, o

      associate (jp => jacobian%by_pressure, jh => jacobian%by_film, rough => level%rough, &
         kernel => level%elastic%kernel, solid => level%state%asperity_pressure, &
         oil => level%state%pressure)
         passed = 0.0_wp
         do i = 1, level%n - 1
            known = passed/jacobian%diagonal(i)
            do o = max(-2, -i), 1
               jh(o, i) = jh(o, i)*rough%gap_slope(i + o)
            end do
            do o = max(-2, 1 - i), min(2, level%n - 1 - i)
               if (is_cavitated(i + o)) then
                  known = known + jp(o, i)*oil(i + o)
                  jp(o, i) = 0.0_wp
               else
                  known = known - jp(o, i)*(solid(i + o) - rough%pressure(i + o))
                  jh(min(o, 1), i) = jh(min(o, 1), i) - rough%slope(i + o)*jp(o, i)
               end if
            end do
            passed = 0.0_wp
            if (allocated(jacobian%carry)) passed = jacobian%carry(i)*known*jacobian%diagonal(i)
            right = step(i) + known
            if (is_cavitated(i)) then
               step(i) = rough%pressure(i) - solid(i) - oil(i)
               cycle
            end if
            diagonal = jp(0, i) - jh(-2, i)*kernel(2) - jh(-1, i)*kernel(1) - jh(0, i)*kernel(0) &
               - jh(1, i)*kernel(1)
            jacobian%diagonal(i) = diagonal*jacobian%diagonal(i)
            jp(:, i) = jp(:, i)/diagonal
            jh(:, i) = jh(:, i)/diagonal
            step(i) = right/diagonal
         end do
      end associate
   end subroutine share_rows

   !> Computes the bands at the present pressure and film of the level; rows 0 and n stay zero. The
   !> laws are evaluated once: the level receives its coefficients and the operator L_R from the
   !> same values (as from `evaluate_reynolds`).
   pure subroutine evaluate_jacobian(level, jacobian)
      type(line_level_t), intent(inout) :: level
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      real(wp) :: left_p(-2:1), left_h(-2:0), right_p(-2:1), right_h(-2:0), weights(-2:0)
      integer :: i, n, o

      n = level%n
      associate (slopes => jacobian%slopes)
         if (level%is_kappa .and. .not. allocated(slopes%by_p_left)) allocate ( &
            slopes%by_p_left(n), slopes%by_p_right(n), slopes%by_h_left(n), slopes%by_h_right(n))
         call evaluate_coefficients(level, slopes)
         ! in the kappa scheme Newton's method bends steps by the mobility of the nodes
         if (level%is_kappa .and. .not. thins(level%fluid)) call fluid_mobility(level%fluid, &
            level%dx, level%state, level%oil, slopes)
      end associate
      call apply_reynolds(level)
      call differentiate_flux(level, jacobian, 1, right_p, right_h)
      associate (jp => jacobian%by_pressure, jh => jacobian%by_film, kernel => &
         level%elastic%kernel, rho_p => jacobian%slopes%rho_p, rho => level%oil%density, &
         h => level%state%film)
         do i = 1, n - 1
            left_p = right_p
            left_h = right_h
            call differentiate_flux(level, jacobian, i + 1, right_p, right_h)
            jp(:, i) = [-left_p(-2), right_p(-2) - left_p(-1), right_p(-1) - left_p(0), &
               right_p(0) - left_p(1), right_p(1)]
            jh(:, i) = [-left_h(-2), right_h(-2) - left_h(-1), right_h(-1) - left_h(0), right_h(0)]
            ! rH(i-2) ... rH(i) in the wedge and the squeeze term, the same from the second row on
            if (i <= 2) weights = wedge_weights(i)*level%lambda*level%entrainment/level%dx &
               + [0.0_wp, 0.0_wp, level%lambda*level%inverse_time_step]
            do o = -1, 0
               jp(o, i) = jp(o, i) - weights(o)*rho_p(i + o)*h(i + o)
               jh(o, i) = jh(o, i) - weights(o)*rho(i + o)
            end do
            if (i > 1) then
               jp(-2, i) = jp(-2, i) - weights(-2)*rho_p(i - 2)*h(i - 2)
               jh(-2, i) = jh(-2, i) - weights(-2)*rho(i - 2)
            end if
            jacobian%diagonal(i) = jp(0, i) - jh(-2, i)*kernel(2) - jh(-1, i)*kernel(1) - jh(0, &
               i)*kernel(0) - jh(1, i)*kernel(1)
         end do
         if (has_close_exit(level)) then
            i = level%posed%exit_node
            jp(0, i) = jp(0, i) - level%posed%exit_conductance
            jacobian%diagonal(i) = jacobian%diagonal(i) - level%posed%exit_conductance
         end if
      end associate
      if (allocated(level%oil%saturation)) call pass_on_oil(level, jacobian)
   end subroutine evaluate_jacobian

   !> Takes from the bands what cavitated nodes hold and let go, and computes what they pass on.
   pure subroutine pass_on_oil(level, jacobian)
      type(line_level_t), intent(in) :: level
      type(reynolds_jacobian_t), intent(inout) :: jacobian
      real(wp) :: flux, content, weights(-2:0), wedge
      logical :: arrives
      integer :: i

      if (.not. allocated(jacobian%carry)) allocate (jacobian%carry(0:level%n), source=0.0_wp)
      wedge = level%lambda*level%entrainment/level%dx
      associate (h => level%state%film, rho => level%oil%density, rho_p => jacobian%slopes%rho_p, &
         theta => level%oil%saturation)
         arrives = 0.5_wp*(rho(0)*h(0) + rho(1)*h(1)) <= level%oil%supply
         do i = 1, level%n - 1
            weights = 0.0_wp
            if (.not. arrives) weights = wedge*[-0.5_wp, 1.5_wp, 0.0_wp]
            if (.not. arrives .and. i == 1) weights = wedge*[0.0_wp, 0.5_wp, 0.5_wp]
            arrives = .not. theta(i) < 1.0_wp
            jacobian%carry(i) = 0.0_wp
            if (.not. arrives) then
               content = level%lambda*level%inverse_time_step
               weights = weights - [0.0_wp, -0.5_wp*wedge, 1.5_wp*wedge + content]
               flux = wedge*(1.5_wp*rho(i)*h(i) - 0.5_wp*rho(i - 1)*h(i - 1))
               jacobian%carry(i) = flux/(flux + content*rho(i)*h(i))
            end if
            associate (j => max(i - 2, 0))
               jacobian%by_pressure(j - i:0, i) = jacobian%by_pressure(j - i:0, i) &
                  - weights(j - i:)*rho_p(j:i)*h(j:i)
               jacobian%by_film(j - i:0, i) = jacobian%by_film(j - i:0, i) &
                  - weights(j - i:)*rho(j:i)
            end associate
         end do
      end associate
   end subroutine pass_on_oil

   !> Derivatives of the flux e(i-1/2) (P(i) - P(i-1))/dX^2 through the face left of node i, with
   !> the kappa scheme's addition to the mass flux rH there, by P(i-2..i+1) and H(i-2..i).
   pure subroutine differentiate_flux(level, jacobian, i, flux_p, flux_h)
      type(line_level_t), intent(in) :: level
      type(reynolds_jacobian_t), intent(in) :: jacobian
      integer, intent(in) :: i
      real(wp), intent(out) :: flux_p(-2:1), flux_h(-2:0)
      real(wp) :: slope, conductance, left, right

      slope = (level%state%pressure(i) - level%state%pressure(i - 1))/level%dx**2
      conductance = level%oil%face_mobility(i)/level%dx**2
      if (level%is_kappa) then
         associate (s => jacobian%slopes)
            flux_p = [0.0_wp, s%by_p_left(i)*slope - conductance, &
               s%by_p_right(i)*slope + conductance, 0.0_wp]
            flux_h = [0.0_wp, s%by_h_left(i)*slope, s%by_h_right(i)*slope]
         end associate
         if (i > 1 .and. is_third_order(level, max(i - 1, 0))) call &
            add_third_order_slopes(level, jacobian%slopes%rho_p(i - 2:i), i, flux_p(:0), flux_h)
      else
         associate (s => jacobian%slopes)
            left = 0.25_wp*s%e_slope(i - 1)*slope/level%dx
            right = 0.25_wp*s%e_slope(i)*slope/level%dx
            flux_p = [-left, 0.5_wp*s%e_p(i - 1)*slope - conductance - right, &
               0.5_wp*s%e_p(i)*slope + conductance + left, right]
            flux_h = [0.0_wp, 0.5_wp*s%e_h(i - 1)*slope, 0.5_wp*s%e_h(i)*slope]
         end associate
      end if
   end subroutine differentiate_flux

   !> Adds the part of -lambda/dX theta/3 ( rH(i) - 2 rH(i-1) + rH(i-2) ) to these derivatives.
   pure subroutine add_third_order_slopes(level, rho_p, i, flux_p, flux_h)
      type(line_level_t), intent(in) :: level
      integer, intent(in) :: i
      real(wp), intent(in) :: rho_p(-2:0)
      real(wp), intent(inout) :: flux_p(-2:0), flux_h(-2:0)
      real(wp), parameter :: second(-2:0) = [1.0_wp, -2.0_wp, 1.0_wp]
      real(wp) :: factor, curvature, share

      associate (p => level%state%pressure(i - 2:i), h => level%state%film(i - 2:i), &
         rho => level%oil%density(i - 2:i), alpha => level%fluid%alpha_bar)
         factor = level%lambda*level%entrainment/(3*level%dx)
         curvature = alpha*dot_product(second, p)
         share = third_order_share(curvature)
         flux_p = flux_p - factor*second*(share*rho_p*h + alpha*third_order_slope(curvature) &
            *dot_product(second, rho*h))
         flux_h = flux_h - factor*second*share*rho
      end associate
   end subroutine add_third_order_slopes

end module newton_work

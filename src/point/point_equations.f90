!> Discrete Reynolds equation of the point contact: residual and exact Jacobian.
!>
!>     r(i, j) = ( Q(i+1/2, j) - Q(i-1/2, j) )/hx^2 + ( Q(i, j+1/2) - Q(i, j-1/2) )/hy^2
!>             - U ( 3 rH(i) - 4 rH(i-1) + rH(i-2) )/(2 hx) - ( rH(i)/dT_eff - old )
!>     Q(1|2) = (E1 + E2)/2 L(m1, m2) (P2 - P1) ,  E = rho H^3/lambda ,  m = S/mu
!>
!> of first order in the wedge at i = 1, U = 1 unless the speeds change in time; P >= 0, r <= 0,
!> P r = 0. In a contact that comes to rest sqrt(E1 E2) replaces the mean of both, which would drain
!> the smaller film until it closes. The logarithmic mean L(a, b) = (a - b)/(ln a - ln b) is exact
!> where ln mu is linear, and Q never falls with the pressure that drives it, however steep ln mu
!> is: the arithmetic mean of e has twice the error. The gradient thins an Eyring oil further: P2 -
!> P1 is then what drives as much oil as F of module eyring_plane, for ln mu and H in the middle of
!> the face, over its limit S Sigma.
module point_equations
   use eyring_plane, only: least_sigma, plane_flow, plane_flow_t
   use mobility, only: mean_fluidity
   use flow_law, only: largest_exponent
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_viscosity, sliding_number, thins
   use point_contact, only: point_contact_t
   use point_level, only: point_level_t
   use reynolds_line, only: wedge_weights
   use work_shares, only: share_end
   implicit none (type, external)
   private

   public :: evaluate

   !> What a row of nodes is made of, by column: P, H, E, rho, rho', then ln of the effective
   !> viscosity along x and its slopes by P and H; the same across; ln of the viscosity, its slope.
   integer, parameter :: of_p = 1, of_h = 2, of_e = 3, of_rho = 4, of_drho = 5, along_x = 6, &
      along_y = 9, plain = 12, node_columns = 13
   !> What a face has: flux, flow by P1 and P2 with E as it is, change with P1, P2, H1, H2, with the
   !> slope of P across.
   integer, parameter :: flux = 1, flow_1 = 2, flow_2 = 3, by_p1 = 4, by_p2 = 5, by_h1 = 6, &
      by_h2 = 7, by_turn = 8, face_columns = 8
   !> A node's flow is strong if both faces along X have more than this share of the wedge.
   real(wp), parameter :: strong_flow = 0.43_wp
   !> Least B of sliding: below it both effective viscosities are that of the oil.
   real(wp), parameter :: least_sliding = 1.0e-9_wp
   real(wp), parameter :: round_off = 4.0e-16_wp

contains

   !> Computes residual, its diagonal and floor at the present pressure and film; with `has_bands`
   !> the Jacobian too.
   subroutine evaluate(level, contact, has_bands)
      type(point_level_t), intent(inout) :: level
      type(point_contact_t), intent(in) :: contact
      logical, intent(in) :: has_bands
      real(wp) :: floors(level%threads)
      integer :: t

      if (thins(contact%fluid) .and. .not. allocated(level%corners)) allocate ( &
         level%corners(0:level%nx, 4, 0:level%ny), source=0.0_wp)
      !$omp parallel do num_threads(level%threads) schedule(static)
      do t = 1, level%threads
         call evaluate_rows(level, contact, has_bands, share_end(t - 1, level%threads, level%ny &
            - 1) + 1, share_end(t, level%threads, level%ny - 1), floors(t))
      end do
      !$omp end parallel do
      level%floor = round_off*maxval(floors)*(1/level%hx**2 + 1/level%hy**2)
   end subroutine evaluate

   !> The same for the rows from `first` to `last`; `largest`: of their flow times pressure.
   subroutine evaluate_rows(level, contact, has_bands, first, last, largest)
      type(point_level_t), intent(inout) :: level
      type(point_contact_t), intent(in) :: contact
      logical, intent(in) :: has_bands
      integer, intent(in) :: first, last
      real(wp), intent(out) :: largest
      real(wp), allocatable :: nodes(:, :, :), along(:, :), across(:, :, :), before(:, :)
      real(wp) :: fluidity(0:level%nx)
      integer :: j, new, old

      allocate (nodes(0:level%nx, node_columns, 0:1), across(0:level%nx, face_columns, 0:1))
      allocate (along(0:level%nx, face_columns), before(0:level%nx, node_columns))
      largest = 0.0_wp
      call fill_nodes(contact, level%nx, level%pressure(:, first - 1), level%film(:, first - 1), &
         before)
      call fill_nodes(contact, level%nx, level%pressure(:, first), level%film(:, first), &
         nodes(:, :, 1))
      call fill_faces(level, contact, first - 1, along_y, before, nodes(:, :, 1), across(:, :, 1))
      do j = first, last
         old = mod(j - first + 1, 2)
         new = 1 - old
         call fill_nodes(contact, level%nx, level%pressure(:, j + 1), level%film(:, j + 1), &
            nodes(:, :, new))
         call fill_faces(level, contact, j, along_y, nodes(:, :, old), nodes(:, :, new), &
            across(:, :, new))
         call fill_faces(level, contact, j, along_x, nodes(:, :, old), nodes(:, :, old), along)
         call assemble_row(level, j, nodes(:, :, old), along, across(:, :, old), across(:, :, new))
         if (has_bands) call assemble_bands(level, j, nodes(:, :, old), along, across(:, :, old), &
            across(:, :, new))
         fluidity = exp(-nodes(:, along_x, old))
         largest = max(largest, maxval(nodes(:, of_e, old)*fluidity*nodes(:, of_p, old)))
      end do
   end subroutine evaluate_rows

   !> Fills the columns of a row of nodes.
   subroutine fill_nodes(contact, nx, p, h, nodes)
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx
      real(wp), intent(in) :: p(0:nx), h(0:nx)
      real(wp), intent(out) :: nodes(0:nx, node_columns)
      real(wp) :: b(0:nx), curve(0:nx), root(0:nx)

      nodes(:, of_p) = p
      nodes(:, of_h) = h
      call fluid_density(contact%fluid, p, nodes(:, of_rho), nodes(:, of_drho))
      nodes(:, of_e) = nodes(:, of_rho)*h**3/contact%lambda
      call fluid_viscosity(contact%fluid, p, nodes(:, along_x), nodes(:, along_x + 1))
      nodes(:, along_x + 2) = 0.0_wp
      nodes(:, along_y:along_y + 2) = nodes(:, along_x:along_x + 2)
      nodes(:, plain:plain + 1) = nodes(:, along_x:along_x + 1)
      if (thins(contact%fluid)) then
         b = max(sliding_number(contact%fluid)*exp(min(nodes(:, along_x), largest_exponent))/h, &
            least_sliding)
         root = sqrt(1 + b**2)
         curve = b/root/asinh(b)   ! d ln arsinh B/d ln B
         nodes(:, along_y) = nodes(:, along_y) - log(b/asinh(b))
         nodes(:, along_y + 1) = nodes(:, along_y + 1)*curve
         nodes(:, along_y + 2) = (1 - curve)/h
         nodes(:, along_x) = nodes(:, along_x) - log(root)
         nodes(:, along_x + 1) = nodes(:, along_x + 1)/root**2
         nodes(:, along_x + 2) = (b/root)**2/h
      end if
   end subroutine fill_nodes

   !> Fills the columns of the faces between the nodes i of row `one` = `j` and i + 1 of it, or i of
   !> row `two` = j + 1; `axis`: first column of the viscosity along it.
   pure subroutine fill_faces(level, contact, j, axis, one, two, faces)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: j, axis
      real(wp), intent(in) :: one(0:level%nx, node_columns), two(0:level%nx, node_columns)
      real(wp), intent(out) :: faces(0:level%nx, face_columns)
      real(wp), dimension(0:level%nx - merge(1, 0, axis == along_x)) :: drop, exponent, fluidity, &
         shape_factor, slant
      real(wp), dimension(0:4, 0:level%nx) :: slopes
      real(wp) :: e, e_1, e_2, mean, slope_1, slope_2
      integer :: i, k, last, shift
      logical :: thinned

      last = ubound(drop, 1)
      shift = level%nx - last
      call mean_fluidity(one(:last, axis), two(shift:, axis), exponent, shape_factor, slant)
      fluidity = exp(exponent)*shape_factor
      drop = two(shift:, of_p) - one(:last, of_p)
      thinned = thins(contact%fluid)
      if (thinned) then
         slopes(0, :last) = drop
         call thin_drops(level, contact, j, axis, one, two, slopes(:, :last))
         drop = slopes(0, :last)
      end if
      do i = 0, last
         k = i + shift
         mean = fluidity(i)
         slope_1 = -0.5_wp*mean*drop(i)*(1 + slant(i))
         slope_2 = -0.5_wp*mean*drop(i)*(1 - slant(i))
         e_1 = one(i, of_e)
         e_2 = two(k, of_e)
         e = 0.5_wp*(e_1 + e_2)
         if (contact%rests) then
            e = sqrt(e_1*e_2)
            e_1 = e
            e_2 = e
         end if
         faces(i, flux) = e*mean*drop(i)
         faces(i, flow_1) = e*(mean - slope_1*one(i, axis + 1))
         faces(i, flow_2) = e*(mean + slope_2*two(k, axis + 1))
         if (thinned) then
            ! a change of ln mu and of ln H in the middle is half of that of a node
            faces(i, flow_1) = faces(i, flow_1) + e*mean*(slopes(1, i) - 0.5_wp*slopes(3, &
               i)*one(i, plain + 1))
            faces(i, flow_2) = faces(i, flow_2) + e*mean*(slopes(1, i) + 0.5_wp*slopes(3, &
               i)*two(k, plain + 1))
            faces(i, by_turn) = e*mean*slopes(2, i)
         end if
         faces(i, by_p1) = 0.5_wp*mean*drop(i)*e_1*one(i, of_drho)/one(i, of_rho) &
            - faces(i, flow_1)
         faces(i, by_p2) = 0.5_wp*mean*drop(i)*e_2*two(k, of_drho)/two(k, of_rho) &
            + faces(i, flow_2)
         faces(i, by_h1) = 1.5_wp*mean*drop(i)*e_1/one(i, of_h) &
            + e*slope_1*one(i, axis + 2)
         faces(i, by_h2) = 1.5_wp*mean*drop(i)*e_2/two(k, of_h) &
            + e*slope_2*two(k, axis + 2)
         if (thinned) then
            faces(i, by_h1) = faces(i, by_h1) + 0.5_wp*e*mean*slopes(4, i)/one(i, of_h)
            faces(i, by_h2) = faces(i, by_h2) + 0.5_wp*e*mean*slopes(4, i)/two(k, of_h)
         end if
      end do
   end subroutine fill_faces

   !> Turns the drops P2 - P1 of `fill_faces`, `drops(0, :)`, into those that drive as much oil
   !> without thinning by the gradient, and sets their change with P2 - P1, less 1, with the slope
   !> of P across, with ln mu, and with ln H.
   pure subroutine thin_drops(level, contact, j, axis, one, two, drops)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: j, axis
      real(wp), intent(in) :: one(0:level%nx, node_columns), two(0:level%nx, node_columns)
      real(wp), intent(inout) :: drops(0:, 0:)
      type(plane_flow_t) :: plane
      real(wp) :: b, curve, h, ln_b, scale, share, sigma(2), spacing, unit
      integer :: i, k, of

      drops(1:, :) = 0.0_wp
      of = merge(1, 2, axis == along_x)
      spacing = merge(level%hx, level%hy, of == 1)
      do i = of - 1, ubound(drops, 2) - (of - 1)
         k = i + 2 - of
         h = sqrt(one(i, of_h)*two(k, of_h))
         unit = contact%fluid%rheology%sigma_scale*h
         associate (p => level%pressure)
            if (of == 1) then
               sigma = [drops(0, i)/level%hx, 0.25_wp*sum(p(i:k, j + 1) - p(i:k, j - 1))/level%hy]
            else
               sigma = [0.25_wp*sum(p(i + 1, j:j + 1) - p(i - 1, j:j + 1))/level%hx, &
                  drops(0, i)/level%hy]
            end if
         end associate
         sigma = unit*sigma
         if (norm2(sigma) < least_sigma) cycle
         ln_b = contact%fluid%rheology%ln_b_scale + 0.5_wp*(one(i, plain) + two(k, plain)) - log(h)
         plane = plane_flow(sigma, ln_b)
         b = max(exp(min(ln_b, 0.5_wp*largest_exponent)), least_sliding)
         share = b/hypot(1.0_wp, b)
         if (of == 1) then
            scale = log(hypot(1.0_wp, b))
            curve = share**2
         else
            scale = log(b/asinh(b))
            curve = 1 - share/asinh(b)
         end if
         ! over the slip factor of the limit, from Sigma to drops
         scale = exp(plane%growth - scale)*spacing/unit
         drops(0, i) = scale*plane%flow(of)
         drops(1, i) = scale*plane%by_sigma(of, of)*unit/spacing - 1
         drops(2, i) = scale*plane%by_sigma(of, 3 - of)*unit
         drops(3, i) = scale*plane%by_ln_b(of) - drops(0, i)*curve
         drops(4, i) = scale*dot_product(plane%by_sigma(of, :), sigma) - drops(0, i) - drops(3, i)
      end do
   end subroutine thin_drops

   !> Residual and diagonal of row `j`; face i lies between nodes i and i + 1.
   pure subroutine assemble_row(level, j, nodes, along, below, above)
      type(point_level_t), intent(inout) :: level
      integer, intent(in) :: j
      real(wp), intent(in) :: nodes(0:level%nx, node_columns), along(0:level%nx, face_columns), &
         below(0:level%nx, face_columns), above(0:level%nx, face_columns)
      real(wp) :: ix, iy, mass(0:level%nx), own
      integer :: i, nx

      nx = level%nx
      own = wedge_diagonal(level)
      ix = 1/level%hx**2
      iy = 1/level%hy**2
      mass = nodes(:, of_rho)*nodes(:, of_h)/level%hx
      associate (r => level%residual, d => level%diagonal)
         do i = 1, nx - 1
            r(i, j) = ix*(along(i, flux) - along(i - 1, flux)) + iy*(above(i, flux) &
               - below(i, flux))
            level%flow(i, j) = ix*(along(i, flow_1) + along(i - 1, flow_2)) &
               + iy*(above(i, flow_1) + below(i, flow_2))
            d(i, j) = level%flow(i, j) + nodes(i, of_rho)*own
         end do
         r(1, j) = r(1, j) - level%entrainment*(mass(1) - mass(0))
         r(2:nx - 1, j) = r(2:nx - 1, j) - level%entrainment*(1.5_wp*mass(2:nx - 1) &
            - 2*mass(1:nx - 2) + 0.5_wp*mass(0:nx - 3))
         if (allocated(level%old_squeeze)) r(1:nx - 1, j) = r(1:nx - 1, j) - (level%hx &
            *level%inverse_time_step*mass(1:nx - 1) + level%old_squeeze(1:nx - 1, j))
      end associate
   end subroutine assemble_row

   !> Change of wedge and squeeze of a node with its own pressure, by the deflection; density 1.
   pure real(wp) function wedge_diagonal(level) result(diagonal)
      type(point_level_t), intent(in) :: level
      real(wp) :: weights(-2:0)

      weights = level%entrainment*wedge_weights(2)
      diagonal = dot_product(weights(0:-2:-1), level%kernel(0:2, 0))/level%hx &
         + level%inverse_time_step*level%kernel(0, 0)
   end function wedge_diagonal

   !> Bands of row `j`, and where its flow is strong.
   pure subroutine assemble_bands(level, j, nodes, along, below, above)
      type(point_level_t), intent(inout) :: level
      integer, intent(in) :: j
      real(wp), intent(in) :: nodes(0:level%nx, node_columns), along(0:level%nx, face_columns), &
         below(0:level%nx, face_columns), above(0:level%nx, face_columns)
      real(wp) :: ix, iy, strong
      integer :: i

      ix = 1/level%hx**2
      iy = 1/level%hy**2
      strong = strong_flow*wedge_diagonal(level)
      level%rise(:, j) = nodes(:, along_x + 1)
      call set_flow(level%by_pressure(:, :, j), by_p1, by_p2)
      call set_flow(level%by_film(:, :, j), by_h1, by_h2)
      call set_wedge(level%by_pressure(:, :, j), nodes(:, of_drho)*nodes(:, of_h))
      call set_wedge(level%by_film(:, :, j), nodes(:, of_rho))
      if (allocated(level%corners)) call add_turns(level%by_pressure(:, :, j), level%corners(:, :, &
         j))
      do i = 1, level%nx - 1
         level%is_local(i, j) = merge(1.0_wp, 0.0_wp, min(ix*along(i, flow_1), &
            ix*along(i - 1, flow_2)) > strong)
      end do

   contains

      !> Adds the changes with the slopes of P across the faces to those with the neighbours of a
      !> node, and sets those with the corners (i-1, j-1), (i+1, j-1), (i-1, j+1), (i+1, j+1).
      pure subroutine add_turns(p, corners)
         real(wp), intent(inout), contiguous :: p(0:, :)
         real(wp), intent(out), contiguous :: corners(0:, :)
         real(wp) :: left, right, lower, upper
         integer :: i

         do i = 1, level%nx - 1
            left = ix*along(i - 1, by_turn)/(4*level%hy)
            right = ix*along(i, by_turn)/(4*level%hy)
            lower = iy*below(i, by_turn)/(4*level%hx)
            upper = iy*above(i, by_turn)/(4*level%hx)
            p(i, 2) = p(i, 2) + lower - upper
            p(i, 4) = p(i, 4) + upper - lower
            p(i, 5) = p(i, 5) + left - right
            p(i, 6) = p(i, 6) + right - left
            corners(i, :) = [left + lower, -right - lower, -left - upper, right + upper]
         end do
      end subroutine add_turns

      !> Change of the flow of all nodes with P or H, by the columns of the two nodes of a face.
      pure subroutine set_flow(change, one, two)
         real(wp), intent(inout), contiguous :: change(0:, :)
         integer, intent(in) :: one, two
         integer :: i

         do i = 1, level%nx - 1
            change(i, 2) = -ix*along(i - 1, one)
            change(i, 3) = ix*(along(i, one) - along(i - 1, two)) + iy*(above(i, one) &
               - below(i, two))
            change(i, 4) = ix*along(i, two)
            change(i, 5) = -iy*below(i, one)
            change(i, 6) = iy*above(i, two)
         end do
      end subroutine set_flow

      !> Adds that of wedge and squeeze, of the rho H that changes by `mass` with P or H.
      pure subroutine set_wedge(change, mass)
         real(wp), intent(inout), contiguous :: change(0:, :)
         real(wp), intent(in) :: mass(0:)
         real(wp) :: w(-2:0)
         integer :: i

         w = level%entrainment*wedge_weights(1)/level%hx
         change(1, 2:3) = change(1, 2:3) - w(-1:0)*mass(0:1)
         w = level%entrainment*wedge_weights(2)/level%hx
         do i = 2, level%nx - 1
            change(i, 1) = -w(-2)*mass(i - 2)
            change(i, 2) = change(i, 2) - w(-1)*mass(i - 1)
            change(i, 3) = change(i, 3) - w(0)*mass(i)
         end do
         do i = 1, level%nx - 1
            change(i, 3) = change(i, 3) - level%inverse_time_step*mass(i)
         end do
      end subroutine set_wedge

   end subroutine assemble_bands

end module point_equations

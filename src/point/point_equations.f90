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
   use mobility, only: fluidity_between
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

   !> What a row of nodes is made of, by column: P, H, E, rho, d ln rho/dP, rho H, its change
   !> with P, then ln of the effective viscosity along x, its slope by P, the fluidity and, of a
   !> thinning oil, the slope by H; the same across; ln of the viscosity, its slope.
   integer, parameter :: of_p = 1, of_h = 2, of_e = 3, of_rho = 4, of_dln_rho = 5, of_mass = 6, &
      of_mass_by_p = 7, along_x = 8, along_y = 12, plain = 16, node_columns = 17
   !> What a face has: flux, flow by P1 and P2 with E as it is, change with P1, P2, H1, H2, with the
   !> slope of P across; mean E and fluidity, the slant of that, and the drop P2 - P1 with, for an
   !> oil that thins, its four changes.
   integer, parameter :: flux = 1, flow_1 = 2, flow_2 = 3, by_p1 = 4, by_p2 = 5, by_h1 = 6, &
      by_h2 = 7, by_turn = 8, of_both = 9, fluidity = 10, slant = 11, drop = 12, face_columns = 16
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
         call assemble_row(level, j, has_bands, nodes(:, :, old), along, across(:, :, old), &
            across(:, :, new))
         largest = max(largest, maxval(nodes(:, of_e, old)*nodes(:, along_x + 2, old) &
            *nodes(:, of_p, old)))
      end do
   end subroutine evaluate_rows

   !> Fills the columns of a row of nodes.
   subroutine fill_nodes(contact, nx, p, h, nodes)
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx
      real(wp), intent(in) :: p(0:nx), h(0:nx)
      real(wp), intent(out) :: nodes(0:nx, node_columns)
      real(wp) :: b, curve, root
      integer :: i

      nodes(:, of_p) = p
      nodes(:, of_h) = h
      call fluid_density(contact%fluid, p, nodes(:, of_rho), nodes(:, of_dln_rho))
      call fluid_viscosity(contact%fluid, p, nodes(:, along_x), nodes(:, along_x + 1))
      nodes(:, of_mass_by_p) = nodes(:, of_dln_rho)*h
      nodes(:, of_dln_rho) = nodes(:, of_dln_rho)/nodes(:, of_rho)
      nodes(:, of_mass) = nodes(:, of_rho)*h
      nodes(:, of_e) = nodes(:, of_mass)*h**2/contact%lambda
      if (thins(contact%fluid)) then
         nodes(:, plain:plain + 1) = nodes(:, along_x:along_x + 1)
         do i = 0, nx
            b = max(sliding_number(contact%fluid)*exp(min(nodes(i, plain), &
               largest_exponent))/h(i), least_sliding)
            root = sqrt(1 + b**2)
            curve = b/root/asinh(b)   ! d ln arsinh B/d ln B
            nodes(i, along_y) = nodes(i, plain) - log(b/asinh(b))
            nodes(i, along_y + 1) = nodes(i, plain + 1)*curve
            nodes(i, along_y + 3) = (1 - curve)/h(i)
            nodes(i, along_x) = nodes(i, plain) - log(root)
            nodes(i, along_x + 1) = nodes(i, plain + 1)/root**2
            nodes(i, along_x + 3) = (b/root)**2/h(i)
         end do
         nodes(:, along_y + 2) = exp(-nodes(:, along_y))
      end if
      nodes(:, along_x + 2) = exp(-nodes(:, along_x))
   end subroutine fill_nodes

   !> Fills the columns of the faces between the nodes i of row `one` = `j` and i + 1 of it, or i of
   !> row `two` = j + 1; `axis`: first column of the viscosity along it.
   pure subroutine fill_faces(level, contact, j, axis, one, two, faces)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: j, axis
      real(wp), intent(in) :: one(0:level%nx, node_columns), two(0:level%nx, node_columns)
      real(wp), intent(out) :: faces(0:level%nx, face_columns)
      real(wp) :: change(2), e, e_1, e_2, half
      integer :: i, k, last, of, shift
      logical :: rests, thinned

      shift = merge(1, 0, axis == along_x)
      last = level%nx - shift
      thinned = thins(contact%fluid)
      rests = contact%rests
      of = merge(axis, along_x, thinned)
      call fluidity_between(one(:last, of), two(shift:, of), one(:last, of + 2), two(shift:, of &
         + 2), faces(:last, fluidity), faces(:last, slant))
      faces(:last, drop) = two(shift:, of_p) - one(:last, of_p)
      if (thinned) call thin_drops(level, contact, j, axis, one, two, faces)
      do i = 0, last
         k = i + shift
         e_1 = one(i, of_e)
         e_2 = two(k, of_e)
         if (rests) then
            e_1 = sqrt(e_1*e_2)
            e_2 = e_1
         end if
         e = 0.5_wp*(e_1 + e_2)
         half = 0.5_wp*faces(i, fluidity)*faces(i, drop)
         faces(i, of_both) = e
         faces(i, flux) = 2*e*half
         faces(i, flow_1) = e*(faces(i, fluidity) + half*(1 + faces(i, slant))*one(i, of + 1))
         faces(i, flow_2) = e*(faces(i, fluidity) - half*(1 - faces(i, slant))*two(k, of + 1))
         faces(i, by_p1) = half*e_1*one(i, of_dln_rho) - faces(i, flow_1)
         faces(i, by_p2) = half*e_2*two(k, of_dln_rho) + faces(i, flow_2)
         faces(i, by_h1) = 3*half*e_1/one(i, of_h)
         faces(i, by_h2) = 3*half*e_2/two(k, of_h)
      end do
      if (.not. thinned) return
      do i = 0, last
         k = i + shift
         e = faces(i, of_both)*faces(i, fluidity)
         half = 0.5_wp*e*faces(i, drop)
         ! a change of ln mu and of ln H in the middle is half of that of a node
         change = e*(faces(i, drop + 1) + 0.5_wp*faces(i, drop + 3)*[-one(i, plain + 1), two(k, &
            plain + 1)])
         faces(i, flow_1:flow_2) = faces(i, flow_1:flow_2) + change
         faces(i, by_turn) = e*faces(i, drop + 2)
         faces(i, by_p1:by_p2) = faces(i, by_p1:by_p2) + [-change(1), change(2)]
         faces(i, by_h1) = faces(i, by_h1) - half*(1 + faces(i, slant))*one(i, of + 3) &
            + 0.5_wp*e*faces(i, drop + 4)/one(i, of_h)
         faces(i, by_h2) = faces(i, by_h2) - half*(1 - faces(i, slant))*two(k, of + 3) &
            + 0.5_wp*e*faces(i, drop + 4)/two(k, of_h)
      end do
   end subroutine fill_faces

   !> Turns the drops P2 - P1 of `fill_faces` into those that drive as much oil without thinning by
   !> the gradient, and sets their change with P2 - P1, less 1, with the slope of P across, with ln
   !> mu, and with ln H.
   pure subroutine thin_drops(level, contact, j, axis, one, two, faces)
      type(point_level_t), intent(in) :: level
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: j, axis
      real(wp), intent(in) :: one(0:level%nx, node_columns), two(0:level%nx, node_columns)
      real(wp), intent(inout) :: faces(0:level%nx, face_columns)
      type(plane_flow_t) :: plane
      real(wp) :: b, curve, h, ln_b, scale, share, sigma(2), spacing, unit
      integer :: i, k, of

      faces(:, drop + 1:drop + 4) = 0.0_wp
      of = merge(1, 2, axis == along_x)
      spacing = merge(level%hx, level%hy, of == 1)
      do i = of - 1, level%nx - 1
         k = i + 2 - of
         h = sqrt(one(i, of_h)*two(k, of_h))
         unit = contact%fluid%rheology%sigma_scale*h
         associate (p => level%pressure)
            if (of == 1) then
               sigma = [faces(i, drop)/level%hx, 0.25_wp*sum(p(i:k, j + 1) - p(i:k, j &
                  - 1))/level%hy]
            else
               sigma = [0.25_wp*sum(p(i + 1, j:j + 1) - p(i - 1, j:j + 1))/level%hx, &
                  faces(i, drop)/level%hy]
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
         faces(i, drop) = scale*plane%flow(of)
         faces(i, drop + 1) = scale*plane%by_sigma(of, of)*unit/spacing - 1
         faces(i, drop + 2) = scale*plane%by_sigma(of, 3 - of)*unit
         faces(i, drop + 3) = scale*plane%by_ln_b(of) - faces(i, drop)*curve
         faces(i, drop + 4) = scale*dot_product(plane%by_sigma(of, :), sigma) - faces(i, drop) &
            - faces(i, drop + 3)
      end do
   end subroutine thin_drops

   !> Residual and diagonal of row `j`, and its bands, and where its flow is strong; face i lies
   !> between nodes i and i + 1.
   pure subroutine assemble_row(level, j, has_bands, nodes, along, below, above)
      type(point_level_t), intent(inout) :: level
      integer, intent(in) :: j
      logical, intent(in) :: has_bands
      real(wp), intent(in) :: nodes(0:level%nx, node_columns), along(0:level%nx, face_columns), &
         below(0:level%nx, face_columns), above(0:level%nx, face_columns)
      real(wp) :: ix, iy, own, w(-2:0)
      integer :: i, nx

      nx = level%nx
      ix = 1/level%hx**2
      iy = 1/level%hy**2
      ! change of wedge and squeeze of a node with its own pressure, by the deflection; density 1
      w = level%entrainment*wedge_weights(2)
      own = dot_product(w(0:-2:-1), level%kernel(0:2, 0))/level%hx &
         + level%inverse_time_step*level%kernel(0, 0)
      associate (r => level%residual, d => level%diagonal)
         w = level%entrainment*wedge_weights(2)/level%hx
         do i = 1, nx - 1
            r(i, j) = ix*(along(i, flux) - along(i - 1, flux)) + iy*(above(i, flux) &
               - below(i, flux))
            level%flow(i, j) = ix*(along(i, flow_1) + along(i - 1, flow_2)) &
               + iy*(above(i, flow_1) + below(i, flow_2))
            d(i, j) = level%flow(i, j) + nodes(i, of_rho)*own
         end do
         r(1, j) = r(1, j) - level%entrainment/level%hx*(nodes(1, of_mass) - nodes(0, of_mass))
         do i = 2, nx - 1
            r(i, j) = r(i, j) - (w(0)*nodes(i, of_mass) + w(-1)*nodes(i - 1, of_mass) &
               + w(-2)*nodes(i - 2, of_mass))
         end do
         if (allocated(level%old_squeeze)) r(1:nx - 1, j) = r(1:nx - 1, j) &
            - (level%inverse_time_step*nodes(1:nx - 1, of_mass) + level%old_squeeze(1:nx - 1, j))
      end associate
      if (.not. has_bands) return
      level%rise(:, j) = nodes(:, along_x + 1)
      call set_bands(level%by_pressure(:, :, j), by_p1, by_p2, of_mass_by_p)
      call set_bands(level%by_film(:, :, j), by_h1, by_h2, of_rho)
      if (allocated(level%corners)) call add_turns(level%by_pressure(:, :, j), level%corners(:, :, &
         j))
      do i = 1, level%nx - 1
         level%is_local(i, j) = merge(1.0_wp, 0.0_wp, min(ix*along(i, flow_1), &
            ix*along(i - 1, flow_2)) > strong_flow*own)
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

      !> Change of flow, wedge and squeeze of all nodes with P or H: by the columns of the two nodes
      !> of a face, and that of the change of rho H.
      pure subroutine set_bands(change, one, two, of_change)
         real(wp), intent(inout), contiguous :: change(0:, :)
         integer, intent(in) :: one, two, of_change
         real(wp) :: w(-2:0)
         integer :: i

         w = level%entrainment*wedge_weights(2)/level%hx
         do i = 1, level%nx - 1
            change(i, 2) = -ix*along(i - 1, one) - w(-1)*nodes(i - 1, of_change)
            change(i, 3) = ix*(along(i, one) - along(i - 1, two)) + iy*(above(i, one) &
               - below(i, two)) - (w(0) + level%inverse_time_step)*nodes(i, of_change)
            change(i, 4) = ix*along(i, two)
            change(i, 5) = -iy*below(i, one)
            change(i, 6) = iy*above(i, two)
         end do
         change(2:level%nx - 1, 1) = -w(-2)*nodes(0:level%nx - 3, of_change)
         w = w - level%entrainment*wedge_weights(1)/level%hx
         change(1, 2:3) = change(1, 2:3) + w(-1:0)*nodes(0:1, of_change)
      end subroutine set_bands

   end subroutine assemble_row

end module point_equations

!> Discrete Reynolds equation of the point contact: residual and exact Jacobian.
!>
!>     r(i, j) = ( Q(i+1/2, j) - Q(i-1/2, j) )/hx^2 + ( Q(i, j+1/2) - Q(i, j-1/2) )/hy^2
!>             - ( 3 rH(i) - 4 rH(i-1) + rH(i-2) )/(2 hx) - ( rH(i)/dT_eff - old )
!>     Q(1|2) = (E1 + E2)/2 L(m1, m2) (P2 - P1) ,  E = rho H^3/lambda ,  m = S/mu
!>
!> of first order in the wedge at i = 1; P >= 0, r <= 0, P r = 0. The logarithmic mean L(a, b) =
!> (a - b)/(ln a - ln b) is exact where ln mu is linear, and Q never falls with the pressure that
!> drives it, however steep ln mu is: the arithmetic mean of e has twice the error.
module point_equations
   use face_mobility, only: mean_fluidity
   use flow_law, only: largest_exponent
   use kinds, only: wp
   use lubricant, only: fluid_density, fluid_viscosity
   use point_contact, only: point_contact_t
   use point_level, only: point_level_t
   use reynolds_line, only: wedge_weights
   use rheology, only: sliding_number, thins
   use work_shares, only: share_end
   implicit none (type, external)
   private

   public :: evaluate, multiply_bands

   !> What a row of nodes is made of, by column: P, H, E, rho, rho', then ln of the effective
   !> viscosity along x and its slopes by P and H; the same across.
   integer, parameter :: of_p = 1, of_h = 2, of_e = 3, of_rho = 4, of_drho = 5, along_x = 6, &
      along_y = 9, node_columns = 11
   !> What a face has: flux, flow by P1 and P2 with E as it is, change with P1, P2, H1, H2.
   integer, parameter :: flux = 1, flow_1 = 2, flow_2 = 3, by_p1 = 4, by_p2 = 5, by_h1 = 6, &
      by_h2 = 7, face_columns = 7
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
      call fill_faces(level%nx, 0, before, nodes(:, :, 1), along_y, across(:, :, 1))
      do j = first, last
         old = mod(j - first + 1, 2)
         new = 1 - old
         call fill_nodes(contact, level%nx, level%pressure(:, j + 1), level%film(:, j + 1), &
            nodes(:, :, new))
         call fill_faces(level%nx, 0, nodes(:, :, old), nodes(:, :, new), along_y, &
            across(:, :, new))
         call fill_faces(level%nx, 1, nodes(:, :, old), nodes(:, :, old), along_x, along)
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

   !> Fills the columns of the faces between the nodes i of row `one` and i + `shift` of row `two`;
   !> `axis`: first column of their viscosity along it.
   pure subroutine fill_faces(nx, shift, one, two, axis, faces)
      integer, intent(in) :: nx, shift, axis
      real(wp), intent(in) :: one(0:nx, node_columns), two(0:nx, node_columns)
      real(wp), intent(out) :: faces(0:nx, face_columns)
      real(wp), dimension(0:nx - shift) :: exponent, fluidity, shape_factor, slant
      real(wp) :: drop, e, mean, slope_1, slope_2
      integer :: i, k

      call mean_fluidity(one(:nx - shift, axis), two(shift:, axis), exponent, shape_factor, slant)
      fluidity = exp(exponent)*shape_factor
      do i = 0, nx - shift
         k = i + shift
         mean = fluidity(i)
         drop = two(k, of_p) - one(i, of_p)
         slope_1 = -0.5_wp*mean*drop*(1 + slant(i))
         slope_2 = -0.5_wp*mean*drop*(1 - slant(i))
         e = 0.5_wp*(one(i, of_e) + two(k, of_e))
         faces(i, flux) = e*mean*drop
         faces(i, flow_1) = e*(mean - slope_1*one(i, axis + 1))
         faces(i, flow_2) = e*(mean + slope_2*two(k, axis + 1))
         faces(i, by_p1) = 0.5_wp*mean*drop*one(i, of_e)*one(i, of_drho)/one(i, of_rho) &
            - faces(i, flow_1)
         faces(i, by_p2) = 0.5_wp*mean*drop*two(k, of_e)*two(k, of_drho)/two(k, of_rho) &
            + faces(i, flow_2)
         faces(i, by_h1) = 1.5_wp*mean*drop*one(i, of_e)/one(i, of_h) + e*slope_1*one(i, axis + 2)
         faces(i, by_h2) = 1.5_wp*mean*drop*two(k, of_e)/two(k, of_h) + e*slope_2*two(k, axis + 2)
      end do
   end subroutine fill_faces

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
         r(1, j) = r(1, j) - (mass(1) - mass(0))
         r(2:nx - 1, j) = r(2:nx - 1, j) - (1.5_wp*mass(2:nx - 1) - 2*mass(1:nx - 2) &
            + 0.5_wp*mass(0:nx - 3))
         if (allocated(level%old_squeeze)) r(1:nx - 1, j) = r(1:nx - 1, j) - (level%hx &
            *level%inverse_time_step*mass(1:nx - 1) + level%old_squeeze(1:nx - 1, j))
      end associate
   end subroutine assemble_row

   !> Change of wedge and squeeze of a node with its own pressure, by the deflection; density 1.
   pure real(wp) function wedge_diagonal(level) result(diagonal)
      type(point_level_t), intent(in) :: level
      real(wp) :: weights(-2:0)

      weights = wedge_weights(2)
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
      do i = 1, level%nx - 1
         level%is_local(i, j) = merge(1.0_wp, 0.0_wp, min(ix*along(i, flow_1), &
            ix*along(i - 1, flow_2)) > strong)
      end do

   contains

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

         w = wedge_weights(1)/level%hx
         change(1, 2:3) = change(1, 2:3) - w(-1:0)*mass(0:1)
         w = wedge_weights(2)/level%hx
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

   !> Computes y = J (v, dH) on the flowing nodes, 0 elsewhere: `v` the change of the pressure,
   !> `change` that of the film.
   subroutine multiply_bands(level, v, change, y)
      type(point_level_t), intent(in) :: level
      real(wp), intent(in), dimension(0:level%nx, 0:level%ny) :: v, change
      real(wp), intent(out) :: y(0:level%nx, 0:level%ny)
      integer :: j

      y(:, 0) = 0.0_wp
      y(:, level%ny) = 0.0_wp
      !$omp parallel do num_threads(level%threads) schedule(static)
      do j = 1, level%ny - 1
         call multiply_row(level%by_pressure(:, :, j), level%by_film(:, :, j), v(:, j - 1:j + 1), &
            change(:, j - 1:j + 1), y(:, j))
         y(:, j) = level%flowing(:, j)*y(:, j)
      end do
      !$omp end parallel do
   end subroutine multiply_bands

   !> The row of J (v, change) that has the bands `p` and `h`; `v` and `change` on its three rows.
   pure subroutine multiply_row(p, h, v, change, y)
      real(wp), intent(in), contiguous :: p(0:, :), h(0:, :), v(0:, -1:), change(0:, -1:)
      real(wp), intent(out), contiguous :: y(0:)
      integer :: i, n

      n = ubound(y, 1)
      y(0) = 0.0_wp
      y(n) = 0.0_wp
      y(1) = sum(p(1, 2:4)*v(0:2, 0)) + p(1, 5)*v(1, -1) + p(1, 6)*v(1, 1) &
         + sum(h(1, 2:4)*change(0:2, 0)) + h(1, 5)*change(1, -1) + h(1, 6)*change(1, 1)
      do i = 2, n - 1
         y(i) = p(i, 1)*v(i - 2, 0) + p(i, 2)*v(i - 1, 0) + p(i, 3)*v(i, 0) + p(i, 4)*v(i + 1, 0) &
            + p(i, 5)*v(i, -1) + p(i, 6)*v(i, 1) + h(i, 1)*change(i - 2, 0) &
            + h(i, 2)*change(i - 1, 0) + h(i, 3)*change(i, 0) + h(i, 4)*change(i + 1, 0) &
            + h(i, 5)*change(i, -1) + h(i, 6)*change(i, 1)
      end do
   end subroutine multiply_row

end module point_equations

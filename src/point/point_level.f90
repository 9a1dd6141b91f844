!> One grid of a point contact: its nodes, fields and elastic deflection.
!>
!> Fields are (0:nx, 0:ny), x fastest, the border included. Their elastic deflection is that of a
!> pressure constant over the cell around each node, C times A. E. H. Love's integral (module
!> half_space).
module point_level
   use errors, only: error_t
   use features, only: surface_height
   use half_space, only: open_area_kernel
   use kinds, only: pi, wp
   use point_contact, only: point_contact_t
   use spectral_product, only: new_convolution, spectral_product_t
   implicit none (type, external)
   private

   public :: deflect, last_flowing, load_on, multiply_bands, new_level, set_point_film, &
      set_surfaces, turn_nodes

   !> Distance, in nodes, up to which the deflection is kept.
   integer, parameter :: reach = 64
   !> Neighbours of a node in its equation: (i-2 ... i+1, j), (i, j-1), (i, j+1).
   integer, parameter, public :: bands = 6

   !> The nodes, and the threads that share work on them.
   type :: point_grid_t
      integer :: nx = 0, ny = 0, threads = 1
      real(wp) :: hx = 0.0_wp, hy = 0.0_wp
      !> Positions (0:nx) and (0:ny), times the `direction` of the flow: a contact is turned by 180
      !> degrees when that changes.
      real(wp), allocatable :: x(:), y(:)
      real(wp) :: direction = 1.0_wp
      !> Gap of the rigid bodies less the heights of the surfaces.
      real(wp), allocatable :: rigid(:, :)
      !> Weight of rho H in the squeeze term, 0 in a steady contact, and what older times leave of
      !> it; not allocated: 0.
      real(wp) :: inverse_time_step = 0.0_wp
      real(wp), allocatable :: old_squeeze(:, :)
      !> Sum of the speeds, of its reference.
      real(wp) :: entrainment = 1.0_wp
      !> Deflection by a unit pressure at small distances (of small grids at all), and the product
      !> with all of it.
      real(wp), allocatable :: kernel(:, :)
      type(spectral_product_t) :: elastic
   end type point_grid_t

   !> Grid and fields. Do not copy it: it owns FFTW plans.
   type, extends(point_grid_t), public :: point_level_t
      real(wp), allocatable :: pressure(:, :), film(:, :)
      real(wp) :: rigid_displacement = 0.0_wp
      !> 1 where oil flows under pressure, 0 where it cavitates and on the border.
      real(wp), allocatable :: flowing(:, :)
      !> Residual r, its diagonal, the part of the flow in it, and the round-off of r.
      real(wp), allocatable :: residual(:, :), diagonal(:, :), flow(:, :)
      real(wp) :: floor = 0.0_wp
      !> Jacobian (0:nx, bands, 0:ny): change of r with P and with H.
      real(wp), allocatable :: by_pressure(:, :, :), by_film(:, :, :)
      !> The same with P at (i-+1, j-1), (i-+1, j+1) of an oil that thins, else not allocated.
      real(wp), allocatable :: corners(:, :, :)
      !> 1 where the flow is strong beside the wedge, else 0; d ln mu/dP along X.
      real(wp), allocatable :: is_local(:, :), rise(:, :)
   end type point_level_t

contains

   !> Makes the level of `nx` times `ny` intervals for the domain of `contact`, planned for
   !> `threads`. Fails (internal_error) if FFTW does.
   subroutine new_level(level, contact, nx, ny, threads, error)
      type(point_level_t), intent(inout) :: level
      type(point_contact_t), intent(in) :: contact
      integer, intent(in) :: nx, ny, threads
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: kernel(:, :)
      integer :: i

      level%threads = threads
      level%nx = nx
      level%ny = ny
      allocate (level%x(0:nx), level%y(0:ny), level%rigid(0:nx, 0:ny))
      associate (domain => contact%domain)
         level%hx = (domain%x_outlet - domain%x_inlet)/nx
         level%hy = 2*domain%y_half_width/ny
         level%x(:) = [(domain%x_inlet + i*level%hx, i=0, nx)]
         level%y(:) = [((i - 0.5_wp*ny)*level%hy, i=0, ny)]
      end associate
      call set_surfaces(level, contact, 0.0_wp)
      allocate (level%pressure, level%film, level%flowing, mold=level%rigid)
      allocate (level%diagonal(0:nx, 0:ny), source=1.0_wp)
      allocate (level%residual(0:nx, 0:ny), level%flow(0:nx, 0:ny), level%rise(0:nx, 0:ny), &
         level%is_local(0:nx, 0:ny), level%by_pressure(0:nx, bands, 0:ny), &
         level%by_film(0:nx, bands, 0:ny), source=0.0_wp)
      kernel = 2*pi*contact%ellipse%compliance*open_area_kernel(nx + 1, ny + 1, level%hx, level%hy)
      allocate (level%kernel(0:min(reach, nx), 0:min(reach, ny)))
      level%kernel = kernel(:size(level%kernel, 1), :size(level%kernel, 2))
      call new_convolution(level%elastic, kernel, threads, error)   ! error: handed up
   end subroutine new_level

   !> Sets the gap of the rigid bodies less the heights of both surfaces at a `time`, and speed and
   !> direction of the moment of `contact`.
   pure subroutine set_surfaces(level, contact, time)
      type(point_level_t), intent(inout) :: level
      type(point_contact_t), intent(in) :: contact
      real(wp), intent(in) :: time
      integer :: j

      level%entrainment = abs(sum(contact%moment%speeds))
      if (level%direction*sum(contact%moment%speeds) < 0.0_wp) call turn_nodes(level)
      associate (q => contact%curvature, x => level%direction*level%x, &
         y => level%direction*level%y)
         do j = 0, level%ny
            level%rigid(:, j) = 0.5_wp*q(1)*x**2 + q(2)*x*y(j + 1) &
               + 0.5_wp*q(3)*y(j + 1)**2 - surface_height(contact%surface_1, x, time, y(j + 1)) &
               - surface_height(contact%surface_2, x, time, y(j + 1))
         end do
      end associate
   end subroutine set_surfaces

   !> Turns the nodes of a level to the other direction of the flow; its fields stay.
   pure subroutine turn_nodes(level)
      type(point_level_t), intent(inout) :: level

      level%direction = -level%direction
      level%x(:) = -level%x(level%nx:0:-1)
      level%y(:) = -level%y(level%ny:0:-1)
   end subroutine turn_nodes

   !> Computes the deflection of the pressure `p`, both on all nodes.
   subroutine deflect(level, p, deflection)
      type(point_level_t), intent(inout) :: level
      real(wp), intent(in) :: p((level%nx + 1)*(level%ny + 1))
      real(wp), intent(out) :: deflection((level%nx + 1)*(level%ny + 1))

      call level%elastic%apply(p, deflection)
   end subroutine deflect

   !> Sets the film to that of the pressure and of H0.
   subroutine set_point_film(level)
      type(point_level_t), intent(inout) :: level

      call deflect(level, level%pressure, level%film)
      level%film = level%rigid_displacement + level%rigid + level%film
   end subroutine set_point_film

   !> hx hy times the sum of the pressure `p` on all nodes.
   pure real(wp) function load_on(level, p) result(load)
      type(point_level_t), intent(in) :: level
      real(wp), intent(in) :: p((level%nx + 1)*(level%ny + 1))

      load = level%hx*level%hy*sum(p)
   end function load_on

   !> Last node of line `j` that flows; 1 if none does.
   pure integer function last_flowing(level, j) result(i)
      type(point_level_t), intent(in) :: level
      integer, intent(in) :: j

      do i = level%nx - 1, 2, -1
         if (level%flowing(i, j) > 0.0_wp) exit
      end do
   end function last_flowing

   !> Computes y = J (v, dH) on the flowing nodes, 0 elsewhere: `v` the change of the pressure,
   !> `change` that of the film; with a `right_side` what it leaves of that.
   subroutine multiply_bands(level, v, change, y, right_side)
      type(point_level_t), intent(in) :: level
      real(wp), intent(in), dimension(0:level%nx, 0:level%ny) :: v, change
      real(wp), intent(out) :: y(0:level%nx, 0:level%ny)
      real(wp), intent(in), optional :: right_side(0:level%nx, 0:level%ny)
      integer :: j, n

      y(:, 0) = 0.0_wp
      y(:, level%ny) = 0.0_wp
      !$omp parallel do num_threads(level%threads) private(n) schedule(static)
      do j = 1, level%ny - 1
         n = last_flowing(level, j) + 1
         call multiply_row(level%by_pressure(:, :, j), level%by_film(:, :, j), v(:, j - 1:j + 1), &
            change(:, j - 1:j + 1), y(:n, j))
         if (allocated(level%corners)) call add_corners(level%corners(:, :, j), v(:, j - 1:j + 1), &
            y(:n, j))
         if (present(right_side)) y(:n, j) = right_side(:n, j) - y(:n, j)
         y(:n, j) = level%flowing(:n, j)*y(:n, j)
         y(n + 1:, j) = 0.0_wp
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

   !> Adds what the `corners` of a row do to its product.
   pure subroutine add_corners(corners, v, y)
      real(wp), intent(in), contiguous :: corners(0:, :), v(0:, -1:)
      real(wp), intent(inout), contiguous :: y(0:)
      integer :: i

      do i = 1, ubound(y, 1) - 1
         y(i) = y(i) + corners(i, 1)*v(i - 1, -1) + corners(i, 2)*v(i + 1, -1) &
            + corners(i, 3)*v(i - 1, 1) + corners(i, 4)*v(i + 1, 1)
      end do
   end subroutine add_corners

end module point_level

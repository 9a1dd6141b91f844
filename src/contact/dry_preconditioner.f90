!> An approximate inverse of K on the nodes that may move: |q|, whole by FFT, or in two levels.
!>
!> Two levels: |q| = |q|(1 - g) + |q| g with a Gaussian g. The first part is short in space and becomes a stencil on the
!> listed nodes; the second is smooth and is done by FFT on a grid `coarsening` times coarser, with linear spreading and
!> interpolation, whose transfer functions are divided out. Both parts are symmetric and stay positive definite.
module dry_preconditioner
   use, intrinsic :: iso_fortran_env, only: real32
   use constants, only: pi
   use dry_problem, only: dry_grid_t
   use errors, only: error_t
   use half_space_response, only: wavenumbers
   use kinds, only: wp
   use single_product, only: new_single_product => new_grid_product, single_product_t => grid_product_t
   use spectral_product, only: new_spectral_product, spectral_product_t
   implicit none (type, external)
   private

   public :: dry_preconditioner_t, new_dry_preconditioner

   !> Coarsening of the second level.
   integer, parameter :: coarsening = 4
   !> Reach of the stencil in nodes, r <= reach + 1/2, and width of the Gaussian in nodes, for areas and for lines. Chosen so
   !> that the two parts add up to 0.95 to 1.12 (areas), 0.97 to 1.02 (lines) of |q|.
   integer, parameter :: area_reach = 4, line_reach = 6
   real(wp), parameter :: area_width = 2.68_wp, line_width = 1.6_wp
   !> Nodes a side of the small grid on which the stencil is computed.
   integer, parameter :: template = 64
   !> Nodes of one row that the stencil takes together.
   integer, parameter :: lane = 8
   !> Share of the nodes from which on the whole |q| is cheaper: areas, lines.
   real(wp), parameter :: most_area = 0.1_wp, most_line = 0.4_wp

   !> Prepared products. Not to be copied: it owns FFTW plans.
   type :: dry_preconditioner_t
      private
      integer :: nx = 0, ny = 0
      !> False: only the whole |q| fits the grid.
      logical :: has_levels = .false.
      logical :: has_whole = .false.
      !> Stencil (-reach:reach, -reach_y:reach_y), single precision like the field it acts on.
      real(real32), allocatable :: stencil(:, :)
      integer :: reach = 0, reach_y = 0
      !> Width of the Gaussian [nodes].
      real(wp) :: width = 0.0_wp
      !> r scaled to 1, zero off the list, with a periodic rim: (1-reach:nx+reach+lane, 1-reach_y:ny+reach_y).
      real(real32), allocatable :: field(:, :)
      !> The coarse level.
      integer :: cx = 0, cy = 0
      type(single_product_t) :: coarse
      real(wp), allocatable :: coarse_in(:), coarse_out(:)
      !> The whole |q|, made when it is first needed.
      type(single_product_t) :: whole
   contains
      procedure :: precondition
      procedure :: transforms
   end type dry_preconditioner_t

contains

   !> Prepares |q| on `grid`. The two levels need a grid that can be coarsened and is not too small.
   !> Fails (internal_error) if FFTW does.
   subroutine new_dry_preconditioner(self, grid, error)
      type(dry_preconditioner_t), intent(inout) :: self
      type(dry_grid_t), intent(in) :: grid
      type(error_t), allocatable, intent(out) :: error
      integer :: cx, cy

      self%nx = grid%nx
      self%ny = grid%ny
      self%has_levels = grid%nx >= template .and. mod(grid%nx, coarsening) == 0
      if (grid%ny > 1) self%has_levels = self%has_levels .and. grid%ny >= template .and. mod(grid%ny, coarsening) == 0
      self%has_whole = .false.
      if (.not. self%has_levels) then
         call prepare_whole(self, grid, error)
         return
      end if
      cx = grid%nx/coarsening
      cy = max(grid%ny/coarsening, 1)
      self%reach = merge(area_reach, line_reach, grid%ny > 1)
      self%reach_y = merge(area_reach, 0, grid%ny > 1)
      self%width = merge(area_width, line_width, grid%ny > 1)
      allocate (self%field(1 - self%reach:grid%nx + self%reach + lane, 1 - self%reach_y:grid%ny + self%reach_y), source=0.0_real32)
      allocate (self%coarse_in(cx*cy), self%coarse_out(cx*cy))
      self%cx = cx
      self%cy = cy
      call new_single_product(self%coarse, [cx, cy], [cx, cy], grid%threads, error)
      if (allocated(error)) return
      call self%coarse%set_symbol(coarse_symbol(grid, self%width, cx, cy))
      call make_stencil(self, grid, error)
   end subroutine new_dry_preconditioner

   !> Plans the whole |q|.
   subroutine prepare_whole(self, grid, error)
      type(dry_preconditioner_t), intent(inout) :: self
      type(dry_grid_t), intent(in) :: grid
      type(error_t), allocatable, intent(out) :: error

      associate (nx => grid%nx, ny => grid%ny)
         call new_single_product(self%whole, [nx, ny], [nx, ny], grid%threads, error)
         if (allocated(error)) return
         call self%whole%set_symbol(wavenumbers(nx, ny, 1.0_wp, grid%aspect))
      end associate
      self%has_whole = .true.
   end subroutine prepare_whole

   !> |q| g over the transfer functions of spreading and interpolation (sinc^2 each, in either direction), for a coarse grid
   !> of `cx` x `cy` nodes.
   pure function coarse_symbol(grid, width, cx, cy) result(symbol)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: width
      integer, intent(in) :: cx, cy
      real(wp) :: symbol(0:cx/2, 0:cy - 1)
      real(wp) :: angle_x, angle_y
      integer :: i, j

      symbol = wavenumbers(cx, cy, 1.0_wp, grid%aspect)
      do j = 0, cy - 1
         angle_y = merge(2.0_wp*pi*merge(j, j - cy, 2*j <= cy)/grid%ny, 0.0_wp, grid%ny > 1)
         do i = 0, cx/2
            angle_x = 2.0_wp*pi*i/grid%nx
            symbol(i, j) = symbol(i, j)*exp(-0.5_wp*width**2*(angle_x**2 + angle_y**2)) &
               /(hat(angle_x)*hat(angle_y))**2/merge(coarsening**2, coarsening, grid%ny > 1)
         end do
      end do
   end function coarse_symbol

   !> Transfer function sinc^2 of linear interpolation at the `angle` per fine node.
   pure elemental function hat(angle)
      real(wp), intent(in) :: angle
      real(wp) :: hat
      real(wp) :: half

      half = 0.5_wp*coarsening*angle
      hat = 1.0_wp
      if (abs(half) > 0.0_wp) hat = (sin(half)/half)**2
   end function hat

   !> The stencil of |q|(1 - g), from a small periodic grid of the same spacing: it is short enough not to feel the period.
   subroutine make_stencil(self, grid, error)
      type(dry_preconditioner_t), intent(inout) :: self
      type(dry_grid_t), intent(in) :: grid
      type(error_t), allocatable, intent(out) :: error
      type(spectral_product_t) :: small
      real(wp), allocatable :: symbol(:, :), impulse(:), answer(:)
      real(wp) :: angle_x, angle_y
      integer :: i, j, nx, ny

      nx = template
      ny = merge(template, 1, grid%ny > 1)
      allocate (symbol(0:nx/2, 0:ny - 1), impulse(nx*ny), answer(nx*ny))
      symbol(:, :) = wavenumbers(nx, ny, real(nx, wp)/grid%nx, grid%aspect*ny/grid%ny)
      do j = 0, ny - 1
         angle_y = 2.0_wp*pi*merge(j, j - ny, 2*j <= ny)/ny
         do i = 0, nx/2
            angle_x = 2.0_wp*pi*i/nx
            symbol(i, j) = symbol(i, j)*(1.0_wp - exp(-0.5_wp*self%width**2*(angle_x**2 + angle_y**2)))
         end do
      end do
      call new_spectral_product(small, nx, ny, symbol, 1, error)
      if (allocated(error)) return
      impulse = 0.0_wp
      impulse(1) = 1.0_wp
      call small%apply(impulse, answer)
      associate (r => self%reach, ry => self%reach_y)
         allocate (self%stencil(-r:r, -ry:ry), source=0.0_real32)
         do j = -ry, ry
            do i = -r, r
               if (i*i + j*j <= r*(r + 1)) self%stencil(i, j) = real(answer(modulo(i, nx) + 1 + nx*modulo(j, ny)), real32)
            end do
         end do
         ! Cut off, its transfer function may fall below zero at long waves.
         self%stencil(0, 0) = self%stencil(0, 0) + max(0.0_real32, -sum(self%stencil))
      end associate
   end subroutine make_stencil

   !> s = M r on the nodes `node` (rising); `r` and `s` are lists like `node`. Fails (internal_error) if FFTW does.
   subroutine precondition(self, grid, node, r, s, error)
      class(dry_preconditioner_t), intent(inout) :: self
      type(dry_grid_t), intent(in) :: grid
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: r(:)
      real(wp), contiguous, intent(out) :: s(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp) :: scale

      if (.not. self%has_levels .or. size(node) > merge(most_area, most_line, self%ny > 1)*self%nx*real(self%ny, wp)) then
         if (.not. self%has_whole) then
            call prepare_whole(self, grid, error)
            if (allocated(error)) return
         end if
         call self%whole%apply_listed(node, r, scale)
         call self%whole%gather(node, scale, s)
      else
         scale = maxval(abs(r))
         if (scale <= 0.0_wp) scale = 1.0_wp
         call coarse_part(self, node, r, s)
         call fill_field(self, node, r, 1.0_wp/scale)
         call stencil_part(self, node, scale, s)
         call fill_field(self, node, r, 0.0_wp)
      end if
   end subroutine precondition

   !> s = the smooth part of |q| on r: spread to the coarse grid, transform, interpolate.
   subroutine coarse_part(self, node, r, s)
      class(dry_preconditioner_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: r(:)
      real(wp), contiguous, intent(out) :: s(:)
      integer :: first, j, next

      self%coarse_in = 0.0_wp
      next = 1
      do j = 0, self%ny - 1
         first = next
         call pass_row(node, (j + 1)*self%nx, next)
         if (next > first) call spread_row(self, j, node(first:next - 1), r(first:next - 1))
      end do
      call self%coarse%apply(self%coarse_in, self%coarse_out)
      next = 1
      do j = 0, self%ny - 1
         first = next
         call pass_row(node, (j + 1)*self%nx, next)
         if (next > first) call interpolate_row(self, j, node(first:next - 1), s(first:next - 1))
      end do
   end subroutine coarse_part

   !> Moves `next` behind the nodes up to `last`.
   pure subroutine pass_row(node, last, next)
      integer, contiguous, intent(in) :: node(:)
      integer, intent(in) :: last
      integer, intent(inout) :: next

      do while (next <= size(node))
         if (node(next) > last) return
         next = next + 1
      end do
   end subroutine pass_row

   !> The two coarse rows round the fine row `j` (from 0): where they begin, and the weight of the second.
   pure subroutine coarse_rows(self, j, lower, upper, weight)
      class(dry_preconditioner_t), intent(in) :: self
      integer, intent(in) :: j
      integer, intent(out) :: lower, upper
      real(wp), intent(out) :: weight

      lower = j/coarsening
      weight = real(j - coarsening*lower, wp)/coarsening
      upper = self%cx*modulo(lower + 1, self%cy)
      lower = self%cx*lower
   end subroutine coarse_rows

   !> Spreads the values `r` on nodes of the fine row `j` to the coarse grid.
   pure subroutine spread_row(self, j, node, r)
      class(dry_preconditioner_t), intent(inout) :: self
      integer, intent(in) :: j
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: r(:)
      real(wp) :: fx, fy, row(0:self%cx)
      integer :: i, k, lower, upper

      row = 0.0_wp
      do k = 1, size(node)
         i = node(k) - j*self%nx - 1
         fx = real(modulo(i, coarsening), wp)/coarsening
         i = i/coarsening
         row(i) = row(i) + (1.0_wp - fx)*r(k)
         row(i + 1) = row(i + 1) + fx*r(k)
      end do
      row(0) = row(0) + row(self%cx)
      call coarse_rows(self, j, lower, upper, fy)
      associate (cx => self%cx, values => self%coarse_in)
         values(lower + 1:lower + cx) = values(lower + 1:lower + cx) + (1.0_wp - fy)*row(:cx - 1)
         values(upper + 1:upper + cx) = values(upper + 1:upper + cx) + fy*row(:cx - 1)
      end associate
   end subroutine spread_row

   !> Interpolates from the coarse grid to nodes of the fine row `j`.
   pure subroutine interpolate_row(self, j, node, s)
      class(dry_preconditioner_t), intent(in) :: self
      integer, intent(in) :: j
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(out) :: s(:)
      real(wp) :: fx, fy, row(0:self%cx)
      integer :: i, k, lower, upper

      call coarse_rows(self, j, lower, upper, fy)
      associate (cx => self%cx, values => self%coarse_out)
         row(:cx - 1) = (1.0_wp - fy)*values(lower + 1:lower + cx) + fy*values(upper + 1:upper + cx)
         row(cx) = row(0)
      end associate
      do k = 1, size(node)
         i = node(k) - j*self%nx - 1
         fx = real(modulo(i, coarsening), wp)/coarsening
         i = i/coarsening
         s(k) = (1.0_wp - fx)*row(i) + fx*row(i + 1)
      end do
   end subroutine interpolate_row

   !> Puts r times `factor` on the field and on its periodic rim.
   pure subroutine fill_field(self, node, r, factor)
      class(dry_preconditioner_t), intent(inout) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), contiguous, intent(in) :: r(:)
      real(wp), intent(in) :: factor
      real(real32) :: value
      integer :: ix, iy, k, row_end

      iy = 1
      row_end = self%nx
      do k = 1, size(node)
         do while (node(k) > row_end)
            iy = iy + 1
            row_end = row_end + self%nx
         end do
         ix = node(k) - row_end + self%nx
         value = real(r(k)*factor, real32)
         call fill_row(self%field(:, iy), self%reach, self%nx, ix, value)
         if (iy <= self%reach_y) call fill_row(self%field(:, iy + self%ny), self%reach, self%nx, ix, value)
         if (iy > self%ny - self%reach_y) call fill_row(self%field(:, iy - self%ny), self%reach, self%nx, ix, value)
      end do
   end subroutine fill_field

   !> Sets node `ix` of a row and its images beyond the ends.
   pure subroutine fill_row(row, reach, nx, ix, value)
      integer, intent(in) :: reach, nx, ix
      real(real32), intent(inout) :: row(1 - reach:)
      real(real32), intent(in) :: value

      row(ix) = value
      if (ix <= reach + lane) row(ix + nx) = value
      if (ix > nx - reach) row(ix - nx) = value
   end subroutine fill_row

   !> Adds the stencil's part, `scale` times the sum over neighbours in the field, to s.
   pure subroutine stencil_part(self, node, scale, s)
      class(dry_preconditioner_t), intent(in) :: self
      integer, contiguous, intent(in) :: node(:)
      real(wp), intent(in) :: scale
      real(wp), contiguous, intent(inout) :: s(:)
      real(real32) :: lanes(0:lane - 1)
      integer :: end_of_lane, first, ix, iy, k, last, row_end

      iy = 1
      row_end = self%nx
      k = 1
      do while (k <= size(node))
         do while (node(k) > row_end)
            iy = iy + 1
            row_end = row_end + self%nx
         end do
         first = node(k)
         ix = first - row_end + self%nx
         call stencil_lanes(self%field, self%stencil, self%reach, self%reach_y, ix, iy, lanes)
         end_of_lane = min(first + lane - 1, row_end)
         last = k
         next: do while (last < size(node))
            if (node(last + 1) > end_of_lane) exit next
            last = last + 1
         end do next
         s(k:last) = s(k:last) + scale*lanes(node(k:last) - first)
         k = last + 1
      end do
   end subroutine stencil_part

   !> The stencil's sums at the nodes ix ... ix + lane - 1 of row iy.
   pure subroutine stencil_lanes(field, stencil, reach, reach_y, ix, iy, lanes)
      integer, intent(in) :: reach, reach_y, ix, iy
      real(real32), contiguous, intent(in) :: field(1 - reach:, 1 - reach_y:)
      real(real32), contiguous, intent(in) :: stencil(-reach:, -reach_y:)
      real(real32), intent(out) :: lanes(0:lane - 1)
      integer :: i, j, m

      lanes = 0.0_real32
      do j = -reach_y, reach_y
         do i = -reach, reach
            do m = 0, lane - 1
               lanes(m) = lanes(m) + stencil(i, j)*field(ix + m + i, iy + j)
            end do
         end do
      end do
   end subroutine stencil_lanes

   !> Transforms done: size, pairs in double, pairs in single precision (4, 2).
   pure function transforms(self)
      class(dry_preconditioner_t), intent(in) :: self
      integer :: transforms(4, 2)

      transforms(:, 1) = [self%cx, self%cy, 0, int(self%coarse%pairs)]
      transforms(:, 2) = [self%nx, self%ny, 0, int(self%whole%pairs)]
   end function transforms

end module dry_preconditioner

!> Where contact ends between the nodes: what edges of patches make wrong in areas and loads.
!>
!> A contact ends between its last node and the next one, at a place that is chance. Counted nodes
!> do not tell it, and the load of the last node is wrong by a share of its pressure.
module contact_edges
   use dry_problem, only: dry_grid_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: edge_load, edges_of, line_excess

   !> Nodes that are counted beyond the edge of a contact of a line, against the pressure of its
   !> last node over that of the one before: a polynomial through Hertz contacts of 60 to 1800 nodes
   !> (bench/family_dry.py), at most 0.004 off. Pressures rise like a root from the edge, so that
   !> all edges are alike.
   real(wp), parameter :: excess(0:3) = [0.6747_wp, -0.9940_wp, -0.4311_wp, -0.2298_wp]
   !> The largest such ratio, and the excess of an edge whose place is not known: the mean.
   real(wp), parameter :: largest_ratio = 0.71_wp, mean_excess = 0.17_wp

contains

   !> Number of neighbours in x and y one of which is `inside` (nx*ny) and the other not, of the
   !> periodic grid.
   pure function edges_of(grid, inside) result(edges)
      type(dry_grid_t), intent(in) :: grid
      logical, intent(in) :: inside(:)
      integer :: edges
      logical, allocatable :: map(:, :)

      map = reshape(inside, [grid%nx, grid%ny])
      edges = count(map .neqv. cshift(map, 1, 1)) + count(map .neqv. cshift(map, 1, 2))
   end function edges_of

   !> Root of the sum of squares of the differences of `pressure` (nx*ny) over those edges, over the
   !> whole load: the share of the load that is chance, if that of each edge is.
   pure function edge_load(grid, pressure, inside) result(share)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: pressure(:)
      logical, intent(in) :: inside(:)
      real(wp) :: share
      integer :: i, j, k, right, up

      share = 0.0_wp
      do j = 1, grid%ny
         do i = 1, grid%nx
            k = (j - 1)*grid%nx + i
            right = k + merge(1, 1 - grid%nx, i < grid%nx)
            up = k + merge(grid%nx, -(grid%ny - 1)*grid%nx, j < grid%ny)
            if (inside(k) .neqv. inside(right)) share = share + (pressure(k) - pressure(right))**2
            if (inside(k) .neqv. inside(up)) share = share + (pressure(k) - pressure(up))**2
         end do
      end do
      share = sqrt(share)/sum(pressure)
   end function edge_load

   !> How many nodes too many are in contact on a periodic line of this `pressure`.
   pure function line_excess(pressure) result(nodes)
      real(wp), intent(in) :: pressure(0:)
      real(wp) :: nodes
      integer :: i, inner, n, side

      n = size(pressure)
      nodes = 0.0_wp
      do side = -1, 1, 2
         along: do i = 0, n - 1
            if (.not. pressure(i) > 0.0_wp) cycle along
            if (pressure(modulo(i + side, n)) > 0.0_wp) cycle along
            inner = modulo(i - side, n)
            if (pressure(inner) > pressure(i)) then
               nodes = nodes + excess_at(pressure(i)/pressure(inner))
            else
               nodes = nodes + mean_excess
            end if
         end do along
      end do
   end function line_excess

   !> That of one edge.
   pure function excess_at(ratio) result(nodes)
      real(wp), intent(in) :: ratio
      real(wp) :: nodes, r

      r = min(ratio, largest_ratio)
      nodes = excess(0) + r*(excess(1) + r*(excess(2) + r*excess(3)))
   end function excess_at

end module contact_edges

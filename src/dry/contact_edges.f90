!> Errors of areas and loads because a contact ends anywhere between its last node and the next: the
!> number of nodes does not show where, and the load of the last node errs by a share of its
!> pressure. And the crest of a contact pressure between the nodes.
module contact_edges
   use dry_problem, only: dry_grid_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: crest_of, find_edges, line_excess

   !> Nodes counted beyond the edge of a line contact, as a function of the pressure of its last
   !> node over that of the node before: a polynomial fitted to Hertz contacts of 60 to 1800 nodes
   !> (bench/family_dry.py), within 0.004. Pressures rise as a root from every edge, so that all
   !> edges are alike.
   real(wp), parameter :: excess(0:3) = [0.6747_wp, -0.9940_wp, -0.4311_wp, -0.2298_wp]
   !> The largest such ratio, and the mean excess, for an edge of unknown position.
   real(wp), parameter :: largest_ratio = 0.71_wp, mean_excess = 0.17_wp

   !> Nodes below this share of the largest pressure have no vertex above it.
   real(wp), parameter :: crest_share = 0.5_wp

contains

   !> Counts pairs of neighbours in x and y on the periodic grid of which only one is in contact, or
   !> only one at the `hardness` (`edges`), and computes the random share of the load: the root of
   !> the sum of squared pressure differences at the edges of contact, over the load.
   subroutine find_edges(nx, ny, pressure, hardness, edges, share)
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: pressure(nx, ny), hardness
      integer, intent(out) :: edges(2)
      real(wp), intent(out) :: share
      real(wp) :: around(4)
      integer :: i, j, outside

      edges = 0
      share = 0.0_wp
      do j = 1, ny
         nodes: do i = 1, nx
            associate (here => pressure(i, j))
               if (.not. here > 0.0_wp) cycle nodes
               around = [pressure(modulo(i - 2, nx) + 1, j), pressure(modulo(i, nx) + 1, j), &
                  pressure(i, modulo(j - 2, ny) + 1), pressure(i, modulo(j, ny) + 1)]
               outside = count(.not. around > 0.0_wp)
               edges(1) = edges(1) + outside
               if (here >= hardness) edges(2) = edges(2) + count(around < hardness)
               share = share + outside*here**2
            end associate
         end do nodes
      end do
      share = sqrt(share)/sum(pressure)
   end subroutine find_edges

   !> Number of nodes in contact beyond the edges, on a periodic line of this `pressure`.
   pure real(wp) function line_excess(pressure) result(nodes)
      real(wp), intent(in) :: pressure(0:)
      real(wp) :: r
      integer :: i, inner, n, side

      n = size(pressure)
      nodes = 0.0_wp
      do side = -1, 1, 2
         along: do i = 0, n - 1
            if (.not. pressure(i) > 0.0_wp .or. pressure(modulo(i + side, n)) > 0.0_wp) cycle along
            inner = modulo(i - side, n)
            if (pressure(inner) > pressure(i)) then
               r = min(pressure(i)/pressure(inner), largest_ratio)
               nodes = nodes + excess(0) + r*(excess(1) + r*(excess(2) + r*excess(3)))
            else
               nodes = nodes + mean_excess
            end if
         end do along
      end do
   end function line_excess

   !> Highest vertex of the parabolas in x and y through those nodes of the `pressure` (nx*ny) that
   !> are not lower than their neighbours.
   pure real(wp) function crest_of(grid, pressure) result(crest)
      type(dry_grid_t), intent(in) :: grid
      real(wp), intent(in) :: pressure(:)
      real(wp) :: least, x(3), y(3)
      integer :: i, j, row

      crest = maxval(pressure)
      least = crest_share*crest
      do j = 0, grid%ny - 1
         row = j*grid%nx
         nodes: do i = 0, grid%nx - 1
            if (.not. pressure(row + i + 1) > least) cycle nodes
            x = pressure(row + modulo(i + [-1, 0, 1], grid%nx) + 1)
            y = pressure(modulo(j + [-1, 0, 1], grid%ny)*grid%nx + i + 1)
            if (x(2) < max(x(1), x(3), y(1), y(3))) cycle nodes
            crest = max(crest, x(2) + vertex_above(x) + vertex_above(y))
         end do nodes
      end do
   end function crest_of

   !> Height of the vertex of the parabola through three values above the middle one, the largest.
   pure real(wp) function vertex_above(values) result(height)
      real(wp), intent(in) :: values(3)
      real(wp) :: bend

      height = 0.0_wp
      bend = 2.0_wp*values(2) - values(1) - values(3)
      if (bend > 0.0_wp) height = (values(3) - values(1))**2/(8.0_wp*bend)
   end function vertex_above

end module contact_edges

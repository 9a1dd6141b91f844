!> Where contact ends between the nodes: what edges of patches make wrong in areas and loads.
!>
!> A contact ends between its last node and the next one, at a place that is chance. Counted nodes
!> do not tell it, and the load of the last node is wrong by a share of its pressure.
module contact_edges
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

   !> Number of neighbours in x and y one of which has at least the pressure `least` and the other
   !> not, of the periodic grid.
   pure function edges_of(nx, ny, pressure, least) result(edges)
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: pressure(nx, ny), least
      integer :: edges
      integer :: i, j, next

      edges = 0
      do j = 1, ny
         next = modulo(j, ny) + 1
         edges = edges + merge(1, 0, pressure(nx, j) >= least .neqv. pressure(1, j) >= least)
         do i = 1, nx - 1
            edges = edges + merge(1, 0, pressure(i, j) >= least .neqv. pressure(i + 1, j) >= least)
         end do
         do i = 1, nx
            edges = edges + merge(1, 0, pressure(i, j) >= least .neqv. pressure(i, next) >= least)
         end do
      end do
   end function edges_of

   !> Root of the sum of squares of the differences of `pressure` between neighbours one of which is
   !> in contact and the other not, over the whole load: the share of the load that is chance, if
   !> that of each edge is.
   pure function edge_load(nx, ny, pressure) result(share)
      integer, intent(in) :: nx, ny
      real(wp), intent(in) :: pressure(nx, ny)
      real(wp) :: share
      integer :: i, j, next

      share = 0.0_wp
      do j = 1, ny
         next = modulo(j, ny) + 1
         do i = 1, nx - 1
            share = share + jump(pressure(i, j), pressure(i + 1, j)) &
               + jump(pressure(i, j), pressure(i, next))
         end do
         share = share + jump(pressure(nx, j), pressure(1, j)) &
            + jump(pressure(nx, j), pressure(nx, next))
      end do
      share = sqrt(share)/sum(pressure)
   end function edge_load

   !> Square of the difference of two pressures, if one of them alone is in contact.
   pure function jump(one, other)
      real(wp), intent(in) :: one, other
      real(wp) :: jump

      jump = 0.0_wp
      if (one > 0.0_wp .neqv. other > 0.0_wp) jump = (one - other)**2
   end function jump

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

!> Finds the crest of a contact pressure between the nodes.
module pressure_shape
   use dry_problem, only: dry_grid_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: crest_of

   !> Nodes below this share of the largest pressure have no vertex above it.
   real(wp), parameter :: crest_share = 0.5_wp

contains

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

end module pressure_shape

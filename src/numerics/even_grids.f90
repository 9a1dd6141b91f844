!> Numbers of nodes that suit a grid: even, with fast transforms and coarse grids below.
module even_grids
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: even_nodes

   !> Chosen numbers of nodes are these times a power of two.
   integer, parameter :: sizes(*) = [8, 9, 10, 12, 14, 15], first_unit = 2

contains

   !> Fewest nodes in one direction not below `least`, or the most not above `most`; 0: none.
   pure elemental function even_nodes(least, most) result(nodes)
      real(wp), intent(in) :: least, most
      integer :: nodes, i, unit

      nodes = 0
      unit = first_unit
      do
         do i = 1, size(sizes)
            if (sizes(i)*unit > most) return
            nodes = sizes(i)*unit
            if (nodes >= least) return
         end do
         unit = 2*unit
      end do
   end function even_nodes

end module even_grids

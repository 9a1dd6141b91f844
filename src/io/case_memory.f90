!> The memory that a case needs at least, known before any of it is allocated: what is refused could not have run. A case that is
!> not refused may still need more. The numbers lie below those of runs: of 22 cases of random size, by each method, the bound was
!> 0.39 to 0.86 of the peak of the process.
module case_memory
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: dry_memory, lubricated_memory

   !> Largest number of nodes of an area: the padded transforms of an open one count four times as many in 32 bits.
   integer, parameter, public :: most_nodes = 536870911

   !> Bytes a node of dry lines and areas, periodic and open; bytes an interval of lubricated lines.
   real(wp), parameter :: of_line(2) = [140.0_wp, 160.0_wp], of_area(2) = [110.0_wp, 150.0_wp], of_interval = 450.0_wp
   !> Bytes a number of a dense matrix.
   real(wp), parameter :: of_number = 8.0_wp

contains

   !> Of a dry case with nodes(1) times nodes(2) nodes [bytes].
   pure function dry_memory(nodes, is_periodic) result(bytes)
      integer, intent(in) :: nodes(2)
      logical, intent(in) :: is_periodic
      real(wp) :: bytes
      integer :: kind

      kind = merge(1, 2, is_periodic)
      bytes = product(real(nodes, wp))*merge(of_line(kind), of_area(kind), nodes(2) == 1)
   end function dry_memory

   !> Of a lubricated case; `is_dense`: with a full matrix [bytes].
   pure function lubricated_memory(intervals, is_dense) result(bytes)
      integer, intent(in) :: intervals
      logical, intent(in) :: is_dense
      real(wp) :: bytes

      bytes = of_interval*intervals
      if (is_dense) bytes = bytes + of_number*real(intervals, wp)**2
   end function lubricated_memory

end module case_memory

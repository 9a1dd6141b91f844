!> The memory that a case needs at most [bytes], known before any of it is allocated.
!>
!> The bytes of a node are above the highest peaks of processes of every size and method
!> (docs/decisions.md).
module case_memory
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: dry_memory, lubricated_memory

contains

   !> Of a dry case with nodes(1) times nodes(2) nodes. `refined`: nodes of the largest grid beside
   !> which one of up to twice as many in each direction is solved; 0: none.
   pure function dry_memory(nodes, is_periodic, refined) result(bytes)
      integer, intent(in) :: nodes(2)
      logical, intent(in) :: is_periodic
      real(wp), intent(in) :: refined
      real(wp) :: bytes
      real(wp), parameter :: of_node = 460.0_wp, of_node_periodic = 330.0_wp, &
         of_refined_node = 1300.0_wp

      bytes = product(real(nodes, wp)) &
         *merge(of_node_periodic, of_node, is_periodic .and. nodes(2) > 1)
      bytes = max(bytes, of_refined_node*refined)
   end function dry_memory

   !> Of a lubricated case with `steps` time steps (0: steady). `is_dense`: with a full matrix.
   !> `layers` (0: none): layers across the film, m of them with 3 m - 1 unknowns an interval, each
   !> with a column of a band matrix that reaches 4 m + 3 to both sides, and pressure and film of
   !> all times.
   pure function lubricated_memory(intervals, steps, is_dense, layers) result(bytes)
      integer, intent(in) :: intervals
      real(wp), intent(in) :: steps
      logical, intent(in) :: is_dense
      integer, intent(in) :: layers
      real(wp) :: bytes
      real(wp), parameter :: of_interval = 1400.0_wp, of_step = 1000.0_wp, of_entry = 9.0_wp, &
         of_profile = 16.0_wp
      real(wp) :: m, n

      m = layers
      n = intervals
      bytes = of_interval*n + of_step*steps
      if (is_dense) bytes = bytes + of_entry*n**2
      if (layers > 0) bytes = bytes + (8*m*(36*m + 130) + of_profile*steps)*n
   end function lubricated_memory

end module case_memory

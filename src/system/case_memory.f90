!> The memory that a case needs at most, known before any of it is allocated, so that none of its
!> allocations fails.
!>
!> The numbers are the highest measured peaks of processes of every size and method
!> (docs/decisions.md).
module case_memory
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use system_limits, only: memory_t, of_program
   implicit none (type, external)
   private

   public :: area_memory, dry_memory, file_memory, lubricated_memory

   !> Largest number of nodes of an area: the padded transforms of an open one count four times as
   !> many in 32 bits.
   integer, parameter, public :: max_nodes = 536870911

   !> Bytes a node of dry lines and areas, periodic and open; the same where grids up to twice as
   !> fine in each direction are solved, too; bytes an interval of lubricated lines, steady and in
   !> time; bytes a time step, most of them the history of residuals; bytes a node of a file of
   !> heights.
   real(wp), parameter :: of_line(2) = [430.0_wp, 460.0_wp], of_area(2) = [330.0_wp, 460.0_wp], &
      of_finer_line(2) = [700.0_wp, 960.0_wp], of_finer_area(2) = [1050.0_wp, 1300.0_wp], &
      of_interval(2) = [1000.0_wp, 1400.0_wp], of_step = 1000.0_wp, of_height = 100.0_wp
   !> Bytes an interval and time step, where pressure and film of all times are held.
   real(wp), parameter :: of_profile = 16.0_wp
   !> Bytes a number of a dense matrix.
   real(wp), parameter :: of_number = 8.3_wp
   !> Bytes that OpenBLAS reserves for its thread; it uses few of them.
   real(wp), parameter :: of_blas = 136.0e6_wp

contains

   !> Of a dry case with nodes(1) times nodes(2) nodes, and grids of up to so many `refined` ones
   !> (0: none) beside which finer ones are solved.
   pure function dry_memory(nodes, is_periodic, refined) result(need)
      integer, intent(in) :: nodes(2)
      logical, intent(in) :: is_periodic
      real(wp), intent(in) :: refined
      type(memory_t) :: need
      integer :: kind

      kind = merge(1, 2, is_periodic)
      if (nodes(2) == 1) then
         need%used = max(of_line(kind)*nodes(1), of_finer_line(kind)*refined)
      else
         need%used = max(of_area(kind)*product(real(nodes, wp)), of_finer_area(kind)*refined)
      end if
      need%used = of_program + need%used
      need%reserved = need%used
   end function dry_memory

   !> What a periodic area of so many nodes usually takes of it [bytes], elastic and in one load.
   pure function area_memory(nodes) result(bytes)
      integer(int64), intent(in) :: nodes
      real(wp) :: bytes
      real(wp), parameter :: of_node = 125.0_wp

      bytes = of_node*real(nodes, wp)
   end function area_memory

   !> Of a lubricated case with `steps` time steps (0: steady); `is_dense`: with a full matrix;
   !> `layers` > 0: with so many across the film, whose unknowns stand in a band matrix.
   pure function lubricated_memory(intervals, steps, is_dense, layers) result(need)
      integer, intent(in) :: intervals
      real(wp), intent(in) :: steps
      logical, intent(in) :: is_dense
      integer, intent(in), optional :: layers
      type(memory_t) :: need

      need%used = of_program + merge(of_interval(2), of_interval(1), steps > 0.0_wp)*intervals &
         + of_step*steps
      if (is_dense) need%used = need%used + of_number*real(intervals, wp)**2
      if (present(layers)) need%used = need%used + of_layers(real(layers, wp))*intervals &
         + merge(of_profile, 0.0_wp, layers > 0)*intervals*steps
      need%reserved = need%used + of_blas
   end function lubricated_memory

   !> Bytes an interval with m layers: 3m - 1 unknowns, each with a column of a band matrix that
   !> reaches 4m + 3 to both sides, and about a hundred fields.
   pure function of_layers(m) result(bytes)
      real(wp), intent(in) :: m
      real(wp) :: bytes

      bytes = 8*(3*m*(3*(4*m + 3) + 1) + 100*m)
   end function of_layers

   !> Of the heights of a file of so many nodes, all held at once.
   pure function file_memory(nodes) result(need)
      real(wp), intent(in) :: nodes
      type(memory_t) :: need

      need = memory_t(of_program + of_height*nodes, of_program + of_height*nodes)
   end function file_memory

end module case_memory

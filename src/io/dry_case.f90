!> A dry contact as it will be solved: grid, heights, loads, in SI.
module dry_case
   use dry_problem, only: dry_grid_t
   use dry_solution, only: dry_settings_t
   use dry_sweep, only: dry_loads_t
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: dry_case_t

   !> Made by `fill_dry_case` of module dry_input.
   type :: dry_case_t
      type(dry_grid_t) :: grid
      !> Lx, Ly [m]; a line has Ly = 0.
      real(wp) :: lengths(2)
      logical :: is_periodic
      !> Composite height z_1 + z_2 (nx*ny) [m].
      real(wp), allocatable :: height(:)
      !> E' [Pa].
      real(wp) :: reduced_modulus
      type(dry_loads_t) :: loads
      type(dry_settings_t) :: settings
      !> Errors are estimated.
      logical :: has_error_bars
      !> What the reader of the result should know about it; not allocated: nothing.
      character(:), allocatable :: note
   end type dry_case_t

end module dry_case

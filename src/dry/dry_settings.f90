!> Loads of a dry contact, and how to solve it. Plain records without behaviour.
module dry_settings
   use, intrinsic :: iso_fortran_env, only: real32
   use kinds, only: wp
   implicit none (type, external)
   private

   public :: dry_loads_t, dry_settings_t

   !> Methods.
   integer, parameter, public :: method_conjugate_gradient = 1, method_steepest_descent = 2

   !> Default bound on the error measure, and default limit of iterations.
   real(wp), parameter, public :: dry_tolerance = 1.0e-8_wp
   integer, parameter, public :: dry_cycles = 10000

   !> Most nodes of a grid whose error bars use finer ones, if its surface has short waves.
   integer, parameter, public :: max_nodes_to_refine = 2**18

   !> How to solve.
   type :: dry_settings_t
      integer :: method = method_conjugate_gradient
      !> Bound on the error measure.
      real(wp) :: tolerance = dry_tolerance
      !> Most iterations.
      integer :: max_cycles = dry_cycles
      !> Whether a guess is enough, which single precision gives.
      logical :: is_rough = .false.
      !> Whether to keep the pressures of all loads.
      logical :: keeps_pressures = .false.
      !> Pressures from which the loads start (nx*ny, loads), dimensionless; not allocated: none.
      real(real32), allocatable :: starts(:, :)
   end type dry_settings_t

   !> Loads and hardness, SI.
   type :: dry_loads_t
      !> Mean pressures, in the order in which they act [Pa].
      real(wp), allocatable :: mean_pressure(:)
      !> Separations as in `dry_row_t` instead [m].
      real(wp), allocatable :: separation(:)
      !> Hardness [Pa]; huge: elastic.
      real(wp) :: hardness
      !> Whether each load finds the surface left by the one before, else the virgin one.
      logical :: has_history = .false.
   end type dry_loads_t

end module dry_settings

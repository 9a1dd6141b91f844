!> The loads of a dry contact, how to solve it, and the solution for one load.
module dry_solution
   use, intrinsic :: iso_fortran_env, only: real32
   use iteration_report, only: report_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: dry_loads_t, dry_settings_t, dry_solution_t, end_of_iteration

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

   !> Pressure and gaps for one load, dimensionless, fields (nx*ny).
   type :: dry_solution_t
      real(wp), allocatable :: pressure(:)
      !> v = K p - z: gap = v - datum where p < H, plastic deformation datum - v where p = H.
      real(wp), allocatable :: v(:)
      real(wp) :: datum = 0.0_wp
      !> Nodes with p > 0, with p = H; 0 contacts: no solution yet.
      integer :: contacts = 0, capped = 0
      !> Error measure.
      real(wp) :: kkt = huge(1.0_wp)
      type(report_t) :: report
      !> Transforms made: size mx x my, pairs in double, pairs in single precision (4, any number of
      !> grids).
      integer, allocatable :: transforms(:, :)
   end type dry_solution_t

contains

   !> Why an iteration of at most `max_cycles` ended at `error`; `is_stalled`: the error had stopped
   !> falling.
   function end_of_iteration(report, error, max_cycles, is_stalled) result(reason)
      type(report_t), intent(in) :: report
      real(wp), intent(in) :: error
      integer, intent(in) :: max_cycles
      logical, intent(in) :: is_stalled
      character(:), allocatable :: reason

      if (report%converged) then
         reason = 'converged'
      else if (error >= huge(1.0_wp)) then
         reason = 'values are not finite'
      else if (is_stalled) then
         reason = 'the error has stopped falling at ' // to_text(error, 3)
      else
         reason = 'the error is ' // to_text(error, 3) // ' after '// &
            '' // to_text(max_cycles) // ' iterations'
      end if
   end function end_of_iteration

end module dry_solution

!> The solution of a dry contact for one load.
module dry_solution
   use iteration_report, only: report_t
   use kinds, only: wp
   use text, only: to_text
   implicit none (type, external)
   private

   public :: dry_solution_t, end_of_iteration

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

!> How much ingredients of a dry contact change its quantities, as it is measured and told.
module dry_influences
   use kinds, only: wp
   use verdicts, only: judged_t, usual_accuracy
   implicit none (type, external)
   private

   !> Quantities that are compared: contact area, mean separation, largest pressure.
   integer, parameter, public :: compared_count = 3
   !> Names of the compared quantities in /sweep.
   character(len=21), parameter, public :: compared_names(compared_count) = &
      [character(len=21) :: 'contact_area_fraction', 'mean_separation', 'p_max']
   !> The second grid of a measurement is this many times as coarse as the first.
   real(wp), parameter, public :: coarsening = 2.0_wp

   !> One ingredient, or the grid.
   type, extends(judged_t), public :: dry_influence_t
      !> Relative change of each quantity and its error; NaN: not known.
      real(wp) :: change(compared_count), error(compared_count)
   end type dry_influence_t

   !> What is known of the adequacy of a dry model.
   type, public :: dry_adequacy_t
      !> Not allocated: nothing was measured.
      type(dry_influence_t), allocatable :: rows(:)
      !> The relative error that counts.
      real(wp) :: accuracy = usual_accuracy
      !> The mean pressure under which it was measured, the largest of the sweep [Pa].
      real(wp) :: mean_pressure = 0.0_wp
      !> How many times coarser than the result's the finer of both grids was.
      real(wp) :: ratio = 1.0_wp
   end type dry_adequacy_t

end module dry_influences

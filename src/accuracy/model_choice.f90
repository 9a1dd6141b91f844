!> The leanest model that is adequate for a wanted accuracy, chosen before the run.
!>
!> Only what saves something is looked at. A steady contact is solved with every ingredient: that
!> costs less than to find out what it could do without. So are oil and bodies of a passage, whose
!> time steps cost as much, or more, with a leaner law (docs/decisions.md). What saves is a steady
!> solution in place of a passage. Where nothing that is rough moves, d/dT is 0 as soon as the
!> start is forgotten: that needs no measurement. Where low roughness moves, its influence is
!> measured, by passages with and without it on two coarse grids.
module model_choice
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use ablation_runs, only: set_change
   use ablations, only: has_roughness, ingredient_t, ingredients_of, roughness, squeeze
   use adequacy, only: compared, influence_t, new_influence
   use coarse_passages, only: changes_without, run_passages
   use entry_zone, only: is_moving
   use errors, only: error_t
   use expected_film, only: film_estimate
   use features, only: rough_surface_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, move_profiles
   use model_decision, only: at_rest, changes_little, cheap_in_motion, cheap_passage, &
      cheap_steady, goes_along, may_matter, model_choice_t, not_measured, start_counts, too_high, &
      wanted
   use listener, only: listener_t
   use passage_pairs, only: newton_per_step, passage_grids, passages_t, scene_t, schemes, widths
   use passage_times, only: new_passage_times
   use quantities, only: h_central, h_min, quantity_count
   use wave_resolution, only: choose_time_step
   implicit none (type, external)
   private

   public :: choose_model

   !> What is left out may change a quantity by this share of the target, its error counted: the
   !> rest is for grid, time step and domain.
   real(wp), parameter :: leave_share = 0.25_wp
   !> Roughness that is higher than this many times the target, over the film, is not looked at: of
   !> 20 passages that could do without (seeds 12 and 13 of bench/auto.py) four had more, and so had
   !> nearly all that could not.
   real(wp), parameter :: highest = 0.75_wp
   !> Cost of measuring over that of the passage on the default grid, and what it may be in any case
   !> (nodes times Newton steps).
   real(wp), parameter :: cost_share = 0.2_wp, least_cost = 2.0e4_wp

contains

   !> Decides on every ingredient of an open `scene` for a relative error `target` > 0;
   !> `needs_passage`: a passage it stays.
   subroutine choose_model(scene, target, needs_passage, choice, listener, error)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: target
      logical, intent(in) :: needs_passage
      type(model_choice_t), intent(out) :: choice
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(scene_t) :: whole
      type(ingredient_t), allocatable :: list(:)
      integer :: i

      list = ingredients_of(scene%contact, scene%time%is_transient)
      ! of smooth surfaces it is not measured, but decided on
      if (scene%time%is_transient .and. .not. any(list%kind == squeeze)) list = [list, &
         ingredient_t(squeeze, 'squeeze', 'the steady solution')]
      choice%rows = [(new_influence(trim(list(i)%name), trim(list(i)%text)), i=1, size(list))]
      allocate (choice%is_left_out(size(list)), source=.false.)
      allocate (choice%why(size(list)), source=cheap_steady)
      if (.not. scene%time%is_transient) return
      choice%why = wanted
      if (needs_passage) return
      choice%why = cheap_passage
      whole = scene
      call choose_time_step(whole%contact, whole%time)
      call move_profiles(whole%contact, 0.0_wp, error)
      if (allocated(error)) return
      call listener%on_stage('measuring what the model needs')
      if (moves(scene%contact%surface_1) .or. moves(scene%contact%surface_2)) then
         where (list%kind == squeeze) choice%why = cheap_in_motion
         call look_at_roughness(whole, list, target, choice, listener, &
            error)   ! error: the caller looks
      else if (counts_late(whole)) then
         where (list%kind >= roughness) choice%why = cheap_steady
         choice%is_steady = .true.
         choice%is_left_out = list%kind == squeeze
         choice%is_smooth = .not. any(list%kind == roughness)
         where (choice%is_left_out) choice%why = at_rest
      else
         choice%why = start_counts
      end if
   end subroutine choose_model

   !> Whether the quantities of a passage count from when its start is forgotten.
   pure function counts_late(scene)
      type(scene_t), intent(in) :: scene
      logical :: counts_late

      associate (times => new_passage_times(scene%contact, scene%time))
         counts_late = times%counts_from >= times%settled_from .and. times%end_time &
            >= times%needed_end
      end associate
   end function counts_late

   !> Leaves out the roughness of a passage, and its motion, if it is low and surely changes little.
   subroutine look_at_roughness(scene, list, target, choice, listener, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: list(:)
      real(wp), intent(in) :: target
      type(model_choice_t), intent(inout) :: choice
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      integer :: i

      i = findloc(list%kind, roughness, 1)
      choice%why(i) = too_high
      if (height_of(scene%contact) > highest*target*film_estimate(scene%contact)) return
      call measure(scene, list(i), choice%rows(i), choice%grids, listener, error)
      if (allocated(error)) return
      choice%why(i) = not_measured
      associate (row => choice%rows(i))
         if (.not. all(ieee_is_finite(row%change([h_min, h_central])))) return
         choice%why(i) = may_matter
         if (largest_influence(row) > leave_share*target) return
         choice%influence = abs(row%change) + row%error
      end associate
      choice%is_steady = .true.
      choice%is_smooth = .true.
      choice%is_left_out = list%kind >= squeeze
      where (choice%is_left_out) choice%why = goes_along
      choice%why(i) = changes_little
   end subroutine look_at_roughness

   !> The largest |change| + error of a row; unknown values (NaN) are skipped.
   pure function largest_influence(row) result(largest)
      type(influence_t), intent(in) :: row
      real(wp) :: largest
      integer :: i

      largest = 0.0_wp
      do i = 1, quantity_count
         if (compared(i) .and. ieee_is_finite(row%change(i))) largest = max(largest, &
            abs(row%change(i)) + row%error(i))
      end do
   end function largest_influence

   !> The change of all quantities without the roughness, on the two finest grids that the budget
   !> allows. What a spike may add to both pressures alike does not count.
   subroutine measure(scene, ingredient, row, grids, listener, error)
      type(scene_t), intent(in) :: scene
      type(ingredient_t), intent(in) :: ingredient
      type(influence_t), intent(inout) :: row
      integer, intent(out) :: grids(2)
      class(listener_t), intent(inout), target :: listener
      type(error_t), allocatable, intent(out) :: error
      type(passages_t) :: passages
      real(wp) :: changes(quantity_count, 2), doubt(quantity_count, 2), budget
      logical :: is_known
      integer :: k

      associate (time => scene%time, n => scene%contact%domain%intervals)
         budget = max(cost_share*newton_per_step*n*time%end_time/time%time_step, least_cost)
      end associate
      grids = passage_grids(scene, 0, budget)   ! smooth surfaces take no second passage
      if (any(grids == 0)) return
      do k = 1, size(schemes)
         call run_passages(scene, grids, schemes(k), passages, listener, error)
         if (allocated(error) .or. listener%is_stopping) return
         if (.not. passages%is_known) cycle
         call changes_without(passages, ingredient, changes, doubt, is_known, listener, error)
         if (allocated(error)) return
         if (.not. is_known) cycle
         doubt = 0.0_wp
         call set_change(row, changes, doubt, widths)
         return
      end do
   end subroutine measure

   !> The largest height of both surfaces together [b^2/R], as far as it is at hand.
   pure function height_of(contact) result(height)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: height

      height = height_on(contact%surface_1) + height_on(contact%surface_2)
   end function height_of

   !> That of one surface.
   pure function height_on(surface) result(height)
      type(rough_surface_t), intent(in) :: surface
      real(wp) :: height

      height = 0.0_wp
      if (allocated(surface%features)) height = sum(abs(surface%features%amplitude))
      if (.not. allocated(surface%profile)) return
      if (allocated(surface%profile%heights)) height = height &
         + maxval([0.0_wp, abs(surface%profile%heights)])
   end function height_on

   !> Whether a surface is rough and moves.
   pure function moves(surface)
      type(rough_surface_t), intent(in) :: surface
      logical :: moves

      moves = has_roughness(surface) .and. is_moving(surface)
   end function moves

end module model_choice

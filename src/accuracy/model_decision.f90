!> Decisions on the ingredients of the model before a run, their reasons, and their consequences for
!> the contact and for the errors of its result.
module model_decision
   use adequacy, only: influence_t
   use kinds, only: wp
   use line_contact, only: line_contact_t, without_surfaces
   use quantities, only: quantity_count
   use solver_settings, only: time_settings_t
   implicit none (type, external)
   private

   public :: model_choice_t, number_choice_t, apply_model

   !> Why an ingredient is kept or left out, short for the closing table and in full.
   type :: reason_t
      character(len=22) :: short
      character(len=72) :: text
   end type reason_t

   integer, parameter, public :: cheap_steady = 1, cheap_passage = 2, cheap_in_motion = 3, &
      too_high = 4, not_measured = 5, may_matter = 6, changes_little = 7, goes_along = 8, &
      wanted = 9, at_rest = 10, start_counts = 11, never_steady = 12
   type(reason_t), parameter, public :: reasons(*) = [ &
      reason_t('cheap at rest', 'a steady contact is solved faster than measured'), &
      reason_t('no cheaper without', 'a time step without it costs as much'), &
      reason_t('no cheaper without', 'steady solutions at all places cost as much as time steps'), &
      reason_t('too high', 'the roughness is too high for the film to leave it out'), &
      reason_t('not measured', 'its influence could not be measured on coarse grids'), &
      reason_t('may matter', 'it may change more than a quarter of the target'), &
      reason_t('', 'it surely changes less than a quarter of the target'), &
      reason_t('with roughness', 'it belongs to the roughness, which is left out'), &
      reason_t('passage is wanted', 'film_thresholds and checkpoints need the passage'), &
      reason_t('at rest', 'nothing that is rough moves, and the start is forgotten'), &
      reason_t('the start counts', 'the quantities count from before the start is forgotten'), &
      reason_t('stops or reverses', 'the contact stops or reverses: no steady film there')]

   !> A number of the solution that was chosen or given.
   type :: number_choice_t
      !> Name; the numerical choice in /adequacy that its error belongs to (blank: none); whether it
      !> was chosen or given; its value.
      character(len=9) :: name
      character(len=9) :: judged_as
      character(len=12) :: decision
      character(len=40) :: text
   end type number_choice_t

   !> The decision on each ingredient.
   type :: model_choice_t
      !> Not allocated: there was nothing to decide. Changes are known if they were measured.
      type(influence_t), allocatable :: rows(:)
      logical, allocatable :: is_left_out(:)
      !> Rows of `reasons`.
      integer, allocatable :: why(:)
      !> Whether the transient is solved as a steady contact, and that with smooth surfaces; as a
      !> steady contact at each moment.
      logical :: is_steady = .false., is_smooth = .false., is_quasi_steady = .false.
      !> Bound on the relative change of each quantity by what is left out; NaN: not known.
      real(wp) :: influence(quantity_count) = 0.0_wp
      !> Intervals of the grids on which it was measured; 0: it was not.
      integer :: grids(2) = 0
      !> Grid, domain, time step and method of the run; not allocated: not known yet.
      type(number_choice_t), allocatable :: numbers(:)
   end type model_choice_t

contains

   !> Sets contact and time to the chosen model.
   pure subroutine apply_model(choice, contact, time)
      type(model_choice_t), intent(in) :: choice
      type(line_contact_t), intent(inout) :: contact
      type(time_settings_t), intent(inout) :: time

      if (choice%is_quasi_steady) then
         time%scheme = 'quasi_steady'
         time%tolerance = 0.0_wp
      end if
      if (.not. choice%is_steady) return
      time = time_settings_t()
      ! nothing enters any more
      contact%surface_1%entry_length = 0.0_wp
      contact%surface_2%entry_length = 0.0_wp
      if (choice%is_smooth) contact = without_surfaces(contact)
   end subroutine apply_model

end module model_decision

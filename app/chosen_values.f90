!> What the program has chosen in place of the user, for the list of effective values of a result.
module chosen_values
   use case_record, only: case_t, set_effective
   use features, only: rough_surface_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use passage_times, only: passage_times_t
   use profile, only: profile_length
   implicit none (type, external)
   private

   public :: fill_chosen, fill_passage

contains

   !> What the program has chosen in place of the user goes into the list of effective values; 0:
   !> not used by the method.
   subroutine fill_chosen(case, contact, report)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(in) :: contact
      type(report_t), intent(in) :: report

      call set_effective(case, 'domain', 'x_inlet', contact%domain%x_inlet)
      call set_effective(case, 'domain', 'inlet', trim(contact%domain%inlet))
      call set_effective(case, 'domain', 'x_outlet', contact%domain%x_outlet)
      call set_effective(case, 'domain', 'intervals', contact%domain%intervals)
      if (case%time%is_transient) call set_effective(case, 'time', 'time_step', case%time%time_step)
      call set_effective(case, 'solver', 'space_scheme', trim(merge('kappa  ', 'upwind2', &
         case%solver%space_scheme == 'kappa')))
      call set_effective(case, 'solver', 'levels', report%levels)
      call set_effective(case, 'solver', 'tolerance', report%tolerance)
      call set_effective(case, 'solver', 'max_cycles', report%max_cycles)
      call set_effective(case, 'solver', 'pre_sweeps', report%pre_sweeps)
      call set_effective(case, 'solver', 'post_sweeps', report%post_sweeps)
      call set_effective(case, 'solver', 'coarse_sweeps', report%coarse_sweeps)
      call set_effective(case, 'solver', 'relaxation', report%relaxation)
      call set_effective(case, 'solver', 'load_relaxation', report%load_relaxation)
   end subroutine fill_chosen

   !> The same of the times that count, and of where the surfaces began.
   subroutine fill_passage(case, contact, times)
      type(case_t), intent(inout) :: case
      type(line_contact_t), intent(in) :: contact
      type(passage_times_t), intent(in) :: times

      if (case%time%is_transient) call set_effective(case, 'time', 'statistics_from', &
         times%counts_from)
      call fill_positions(case, 'surface_1', contact%surface_1, has_free_profile(case%surface_1))
      call fill_positions(case, 'surface_2', contact%surface_2, has_free_profile(case%surface_2))
   end subroutine fill_passage

   !> The centres of the features of one surface, or of a profile that the program has placed.
   subroutine fill_positions(case, group, surface, has_placed_profile)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(rough_surface_t), intent(in) :: surface
      logical, intent(in) :: has_placed_profile

      if (size(surface%features) > 0) call set_effective(case, group, 'position', &
         surface%features%position)
      if (has_placed_profile .and. allocated(surface%profile)) call set_effective(case, group, &
         'position', surface%profile%start + 0.5_wp*profile_length(surface%profile))
   end subroutine fill_positions

   !> Whether a surface has a profile whose place is left to the program.
   pure function has_free_profile(surface)
      type(rough_surface_t), intent(in) :: surface
      logical :: has_free_profile

      has_free_profile = allocated(surface%profile)
      if (has_free_profile) has_free_profile = .not. surface%profile%is_placed
   end function has_free_profile

end module chosen_values

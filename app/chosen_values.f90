!> What the program has chosen in place of the user, for the list of effective values of a result.
module chosen_values
   use case_record, only: case_t, set_effective
   use features, only: rough_surface_t
   use iteration_report, only: report_t
   use kinds, only: wp
   use model_decision, only: model_choice_t, number_choice_t
   use passage_times, only: passage_times_t
   use profile, only: profile_length
   use quantity_text, only: number_text
   implicit none (type, external)
   private

   public :: fill_chosen, fill_numbers

contains

   !> Lists what the program has chosen in place of the user among the effective values, with the
   !> `times` that count and where the surfaces began; 0: not used by the method.
   subroutine fill_chosen(case, report, times)
      type(case_t), intent(inout) :: case
      type(report_t), intent(in) :: report
      type(passage_times_t), intent(in) :: times

      associate (domain => case%contact%domain)
         call set_effective(case, 'domain', 'x_inlet', [domain%x_inlet])
         call set_effective(case, 'domain', 'inlet', text=trim(domain%inlet))
         call set_effective(case, 'domain', 'x_outlet', [domain%x_outlet])
         call set_effective(case, 'domain', 'intervals', integer=domain%intervals)
      end associate
      if (case%time%is_transient) then
         call set_effective(case, 'time', 'end_time', [case%time%end_time])
         call set_effective(case, 'time', 'time_step', [case%time%time_step])
      end if
      call set_effective(case, 'solver', 'space_scheme', text=trim(merge('kappa  ', 'upwind2', &
         case%solver%space_scheme == 'kappa')))
      associate (numbers => report%numbers)
         call set_effective(case, 'solver', 'levels', integer=numbers%levels)
         call set_effective(case, 'solver', 'tolerance', [numbers%tolerance])
         call set_effective(case, 'solver', 'max_cycles', integer=numbers%max_cycles)
         call set_effective(case, 'solver', 'pre_sweeps', integer=numbers%pre_sweeps)
         call set_effective(case, 'solver', 'post_sweeps', integer=numbers%post_sweeps)
         call set_effective(case, 'solver', 'coarse_sweeps', integer=numbers%coarse_sweeps)
         call set_effective(case, 'solver', 'relaxation', [numbers%relaxation])
         call set_effective(case, 'solver', 'load_relaxation', [numbers%load_relaxation])
      end associate
      if (case%time%is_transient) call set_effective(case, 'time', 'statistics_from', &
         [times%counts_from])
      call fill_positions(case, 'surface_1', case%surface_1, case%contact%surface_1)
      call fill_positions(case, 'surface_2', case%surface_2, case%contact%surface_2)
   end subroutine fill_chosen

   !> Grid, domain, time step and method of a `case` with model = 'auto': its target chooses grid
   !> and time step, the rest may be given.
   pure subroutine fill_numbers(case, report, choice)
      type(case_t), intent(in) :: case
      type(report_t), intent(in) :: report
      type(model_choice_t), intent(inout) :: choice
      character(:), allocatable :: method

      if (case%model /= 'auto') return
      method = 'none'
      if (allocated(report%method)) method = report%method
      associate (given => case%domain, domain => case%contact%domain)
         choice%numbers = [number_choice_t('grid', 'grid', 'chosen', &
            number_text(real(domain%intervals, wp), 9)//' intervals'), &
            number_choice_t('domain', 'domain', ends_decision(given%has_inlet, given%has_outlet), &
            number_text(domain%x_inlet, 3)//' to '//number_text(domain%x_outlet, 3)), &
            number_choice_t('method', 'iteration', trim(merge('chosen', 'given ', &
            case%solver%method == 'auto')), method)]
      end associate
      if (case%time%is_transient) choice%numbers = [choice%numbers(:2), &
         number_choice_t('time_step', '', 'chosen', 'dT '//number_text(case%time%time_step, 4)), &
         choice%numbers(3)]
   end subroutine fill_numbers

   !> Whether the ends of a domain were given.
   pure function ends_decision(has_inlet, has_outlet) result(words)
      logical, intent(in) :: has_inlet, has_outlet
      character(len=12) :: words

      words = 'chosen'
      if (has_inlet) words = 'inlet given'
      if (has_outlet) words = 'outlet given'
      if (has_inlet .and. has_outlet) words = 'given'
   end function ends_decision

   !> The centres of the features of a `surface`, or of a profile `given` without its place.
   subroutine fill_positions(case, group, given, surface)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: group
      type(rough_surface_t), intent(in) :: given, surface

      if (size(surface%features) > 0) call set_effective(case, group, 'position', &
         surface%features%position)
      if (.not. (allocated(given%profile) .and. allocated(surface%profile))) return
      if (.not. given%profile%is_placed) call set_effective(case, group, 'position', &
         [surface%profile%start + 0.5_wp*profile_length(surface%profile)])
   end subroutine fill_positions

end module chosen_values

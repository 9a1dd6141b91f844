!> From a case in SI to the dimensionless contact that the solver knows.
module line_case
   use case_record, only: case_t
   use domain_choice, only: choose_domain
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use line_profiles, only: place_surface
   use moes, only: moes_m_sum_from_mean, moes_l_sum_from_mean
   use passage_times, only: place_features
   use solver_settings, only: solver_settings_t
   use scaling, only: scaling_t, new_scaling, new_moes_scaling, scaled_fluid
   use surface_scaling, only: scaled_surface
   implicit none (type, external)
   private

   public :: build_line_contact, scaled_solver

contains

   !> Makes `scaling` and `contact` of a case.
   !> The domain is as in the case: what is left open there is chosen by the solver.
   subroutine build_line_contact(case, scaling, contact)
      type(case_t), intent(in) :: case
      type(scaling_t), intent(out) :: scaling
      type(line_contact_t), intent(out) :: contact
      type(line_contact_t) :: whole

      if (case%has_moes) then
         call new_moes_scaling(scaling, case%moes_m, case%moes_l, case%lubricant)
      else
         call new_scaling(scaling, case%bodies, case%lubricant, case%load_per_length)
      end if
      contact%lambda = scaling%lambda
      contact%moes_m_sum = moes_m_sum_from_mean(scaling%moes_m)
      contact%moes_l_sum = moes_l_sum_from_mean(scaling%moes_l)
      contact%slide_to_roll = scaling%slide_to_roll
      contact%fluid = scaled_fluid(scaling, case%lubricant, case%bodies)
      contact%domain = case%domain
      if (scaling%is_dimensional) then
         contact%surface_1 = scaled_surface(case%surface_1, scaling)
         contact%surface_2 = scaled_surface(case%surface_2, scaling)
         whole = contact
         ! the domain that the solver will choose: the inlet depends on the wanted accuracy
         if (whole%domain%has_inlet) then
            call choose_domain(whole)
         else
            call choose_domain(whole, case%accuracy%target)
         end if
         call place_surface(contact%surface_1, whole%domain%x_inlet, whole%domain%x_outlet)
         call place_surface(contact%surface_2, whole%domain%x_inlet, whole%domain%x_outlet)
         if (case%time%is_transient) call place_features(contact)
      else
         allocate (contact%surface_1%features(0), contact%surface_2%features(0))
         contact%surface_1%speed = 1.0_wp
         contact%surface_2%speed = 1.0_wp
      end if
   end subroutine build_line_contact

   !> The settings of the solver, with the floor of the film as H.
   pure function scaled_solver(case, scaling) result(settings)
      type(case_t), intent(in) :: case
      type(scaling_t), intent(in) :: scaling
      type(solver_settings_t) :: settings

      settings = case%solver
      if (scaling%is_dimensional) settings%film_floor = case%film_floor/scaling%film
   end function scaled_solver

end module line_case

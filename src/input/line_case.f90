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
   use scaling, only: scaled_fluid
   use surface_scaling, only: scaled_surface
   implicit none (type, external)
   private

   public :: build_line_contact, scaled_solver

contains

   !> The contact of a case, with its whole domain: what the case leaves open is
   !> chosen here.
   subroutine build_line_contact(case, contact)
      type(case_t), intent(in) :: case
      type(line_contact_t), intent(out) :: contact

      contact%lambda = case%scaling%lambda
      contact%moes_m_sum = moes_m_sum_from_mean(case%scaling%moes_m)
      contact%moes_l_sum = moes_l_sum_from_mean(case%scaling%moes_l)
      contact%slide_to_roll = case%scaling%slide_to_roll
      contact%fluid = scaled_fluid(case%scaling, case%lubricant, case%bodies)
      contact%domain = case%domain
      if (case%scaling%is_dimensional) then
         contact%surface_1 = scaled_surface(case%surface_1, case%scaling)
         contact%surface_2 = scaled_surface(case%surface_2, case%scaling)
      else
         allocate (contact%surface_1%features(0), contact%surface_2%features(0))
         contact%surface_1%speed = 1.0_wp
         contact%surface_2%speed = 1.0_wp
      end if
      call choose_domain(contact, case%accuracy%target)
      call place_surface(contact%surface_1, contact%domain%x_inlet, contact%domain%x_outlet)
      call place_surface(contact%surface_2, contact%domain%x_inlet, contact%domain%x_outlet)
      if (case%time%is_transient) call place_features(contact)
   end subroutine build_line_contact

   !> The settings of the solver, with the floor of the film as H.
   pure function scaled_solver(case) result(settings)
      type(case_t), intent(in) :: case
      type(solver_settings_t) :: settings

      settings = case%solver
      if (case%scaling%is_dimensional) settings%film_floor = case%film_floor/case%scaling%film
   end function scaled_solver

end module line_case

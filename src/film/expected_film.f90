!> Film of a contact by formulas, before it is solved: to choose domains, grids and starts, and to
!> estimate the effect of another oil.
module expected_film
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use moes, only: central_film
   use thinned_film, only: thinned_central_film
   implicit none (type, external)
   private

   public :: film_estimate, newtonian_film, share_with_viscosity

contains

   !> Central film H_c [b^2/R] of the smooth contact by the Moes fit, reduced by shear thinning.
   pure real(wp) function film_estimate(contact) result(film)
      type(line_contact_t), intent(in) :: contact

      film = thinned_central_film(contact%fluid, contact%lambda, newtonian_film(contact))
   end function film_estimate

   !> The same for a Newtonian lubricant.
   pure real(wp) function newtonian_film(contact) result(film)
      type(line_contact_t), intent(in) :: contact

      film = central_film(contact%moes_m_sum, contact%moes_l_sum, contact%elasticity)
   end function newtonian_film

   !> Central film of a contact with `factor` > 0 times its viscosity, relative to that at its full
   !> viscosity: M ~ mu_0^(-1/2), L ~ mu_0^(1/4) at the same alpha; lambda and Eyring's B ~ mu_0.
   pure real(wp) function share_with_viscosity(contact, factor) result(share)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      type(line_contact_t) :: other

      other%elasticity = contact%elasticity
      other%fluid = contact%fluid
      if (allocated(other%fluid%rheology)) other%fluid%rheology%ln_b_scale = &
         contact%fluid%rheology%ln_b_scale + log(factor)
      other%lambda = factor*contact%lambda
      other%moes_m_sum = contact%moes_m_sum/sqrt(factor)
      other%moes_l_sum = contact%moes_l_sum*sqrt(sqrt(factor))
      share = film_estimate(other)/film_estimate(contact)
   end function share_with_viscosity

end module expected_film

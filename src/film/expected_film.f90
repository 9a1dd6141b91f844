!> The film that formulas expect of a contact before it is solved: for the choice of domains, grids
!> and starts only.
module expected_film
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use moes, only: central_film
   use thinned_film, only: thinned_central_film
   implicit none (type, external)
   private

   public :: film_estimate, newtonian_film

contains

   !> Central film H_c [b^2/R] of the smooth contact by the Moes fit, less for a thinning lubricant.
   pure function film_estimate(contact) result(film)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: film

      film = thinned_central_film(contact%fluid, contact%lambda, newtonian_film(contact))
   end function film_estimate

   !> The same of a Newtonian lubricant.
   pure function newtonian_film(contact) result(film)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: film

      film = central_film(contact%moes_m_sum, contact%moes_l_sum, contact%elasticity)
   end function newtonian_film

end module expected_film

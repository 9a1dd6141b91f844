!> The lubricated line contact in dimensionless form: everything that (2.57)-(2.64) of the thesis need.
module line_contact
   use kinds, only: wp
   use lubricant, only: fluid_t
   use moes, only: central_film
   use features, only: rough_surface_t
   use solver_settings, only: domain_t
   implicit none (type, external)
   private

   public :: line_contact_t, film_estimate

   !> Data of one dimensionless contact.
   type :: line_contact_t
      !> Speed parameter lambda of (2.55), corrected: 6 u_s R^2 mu_0/(p_h b^3) [-], > 0.
      real(wp) :: lambda = 0.0_wp
      !> Moes load parameter M, SUM velocity [-].
      real(wp) :: moes_m_sum = 0.0_wp
      !> Moes lubricant parameter L, SUM velocity [-].
      real(wp) :: moes_l_sum = 0.0_wp
      !> Scaled lubricant laws.
      type(fluid_t) :: fluid
      !> Scaled surfaces: heights in b^2/R, lengths in b, speeds dX/dT.
      type(rough_surface_t) :: surface_1, surface_2
      !> Domain in half-widths; after `choose_domain` everything in it is set.
      type(domain_t) :: domain
   end type line_contact_t

contains

   !> Central film H_c [b^2/R] of the smooth contact by the Moes fit: for the choice of grids and starts only.
   pure function film_estimate(contact) result(film)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: film

      film = central_film(contact%moes_m_sum, contact%moes_l_sum)
   end function film_estimate

end module line_contact

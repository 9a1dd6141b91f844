!> The lubricated line contact in dimensionless form: everything that (2.57)-(2.64) of the thesis need.
module line_contact
   use kinds, only: wp
   use lubricant, only: fluid_t
   use moes, only: central_film
   use features, only: rough_surface_t
   use solver_settings, only: domain_t
   implicit none (type, external)
   private

   public :: film_estimate, line_contact_t, nodes_in_finest_wave

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

   !> Nodes in the finest wave of the profiles, on a complete domain; huge if there is no profile.
   pure function nodes_in_finest_wave(contact) result(nodes)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: nodes
      real(wp) :: dx

      dx = (contact%domain%x_outlet - contact%domain%x_inlet)/contact%domain%intervals
      nodes = huge(1.0_wp)
      if (allocated(contact%surface_1%profile)) nodes = contact%surface_1%profile%finest_wave/dx
      if (allocated(contact%surface_2%profile)) nodes = min(nodes, contact%surface_2%profile%finest_wave/dx)
   end function nodes_in_finest_wave

end module line_contact

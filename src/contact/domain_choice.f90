!> Domain and grid from the regime, where the user leaves them open.
!>
!> With S = sqrt(2 H_c) and H_c from the Moes fit, an inlet at X = -(1 + c S), c^2 = 9.5^2 + 42^2 r^3, r = rigid film over
!> fit, leaves h_min starved by about 1e-3 (against twice the domain, M 0.01-1000, L 0-30: 0.05-1.27e-3 in 71 runs, most
!> where the regimes meet, M 0.3-1). For another tolerance t:
!> c^2 = (9.5 (1e-3/t)^0.4)^2 + 42^2 r^3 (1e-3/t).
module domain_choice
   use kinds, only: wp
   use line_contact, only: film_estimate, line_contact_t, newtonian_film
   use moes, only: rigid_film
   implicit none (type, external)
   private

   public :: choose_domain, inlet_error, intervals_for, intervals_for_film

   !> Spacing that gives 1 % in the central film: dX <= 0.045 sqrt(H_c).
   real(wp), parameter, public :: accurate_spacing = 0.045_wp
   !> Largest spacing with a positive discrete film: dX <= 0.3 sqrt(H_c), about (see `intervals_for_film`).
   real(wp), parameter, public :: coarsest_spacing = 0.3_wp
   !> Share by which a chosen inlet may starve the film.
   real(wp), parameter :: default_inlet_error = 1.0e-3_wp
   integer, parameter :: fewest_intervals = 256, most_intervals = 2**20

contains

   !> Fills what `contact%domain` leaves open: inlet, outlet, intervals. For a wanted relative error `target` > 0 of the film the
   !> inlet takes at most its eighth.
   pure subroutine choose_domain(contact, target)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in), optional :: target
      real(wp) :: film, reach, tolerance

      tolerance = default_inlet_error
      if (present(target)) then
         if (target > 0.0_wp) tolerance = min(tolerance, 0.125_wp*target)
      end if
      film = newtonian_film(contact)
      reach = inlet_reach(contact, tolerance)
      associate (domain => contact%domain)
         if (.not. domain%has_inlet) domain%x_inlet = -(1 + reach*sqrt(2*film))
         if (.not. domain%has_outlet) domain%x_outlet = max(1.5_wp, 1 + 0.5_wp*sqrt(2*film))
         domain%has_inlet = .true.
         domain%has_outlet = .true.
         if (domain%intervals <= 0) then
            domain%intervals = min(max(intervals_for(contact, accurate_spacing), fewest_intervals), most_intervals)
         end if
      end associate
   end subroutine choose_domain

   !> c of an inlet at X = -(1 + c S) that starves the film by the share `tolerance`.
   pure function inlet_reach(contact, tolerance) result(reach)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: tolerance
      real(wp) :: reach, rigid_share, ratio

      rigid_share = rigid_film(contact%moes_m_sum)/newtonian_film(contact)
      ratio = default_inlet_error/tolerance
      reach = sqrt((9.5_wp*ratio**0.4_wp)**2 + 42.0_wp**2*rigid_share**3*ratio)
   end function inlet_reach

   !> Relative error of the film thickness because the inlet is where it is and not far away: the inverse of the rule
   !> above, by bisection, between 1e-6 and 1.
   pure function inlet_error(contact) result(error)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: error, reach, lower, upper
      integer :: i

      reach = (-contact%domain%x_inlet - 1)/sqrt(2*newtonian_film(contact))
      lower = log(1.0e-6_wp)
      upper = 0.0_wp
      do i = 1, 40
         error = exp(0.5_wp*(lower + upper))
         if (inlet_reach(contact, error) > reach) then
            lower = log(error)
         else
            upper = log(error)
         end if
      end do
   end function inlet_error

   !> Smallest 2^k with dX <= factor sqrt(H_c), on the contact's domain.
   pure function intervals_for(contact, factor) result(intervals)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      integer :: intervals
      real(wp) :: wanted

      wanted = (contact%domain%x_outlet - contact%domain%x_inlet)/(factor*sqrt(film_estimate(contact)))
      intervals = 2
      do while (intervals < wanted .and. intervals < 2**28)
         intervals = 2*intervals
      end do
   end function intervals_for

   !> Smallest 2^k on which a discrete film is positive: dX <= 0.3 sqrt(H_c), and dX <= sqrt(H_c/(0.85 max(M, 1)^0.4)), which
   !> is less for M (sum velocity) above 800. Measured with Newton's method over M 1-2000, L 2.5-40 on 2^4 to 2^12 intervals:
   !> from this number on all Newtonian contacts have a solution, below half of it hardly any with M >= 30.
   pure function intervals_for_film(contact) result(intervals)
      type(line_contact_t), intent(in) :: contact
      integer :: intervals

      intervals = intervals_for(contact, min(coarsest_spacing, 1/sqrt(0.85_wp*max(contact%moes_m_sum, 1.0_wp)**0.4_wp)))
   end function intervals_for_film

end module domain_choice

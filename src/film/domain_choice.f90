!> Chooses domain and grid from the regime where the user does not give them.
!>
!> The film ruptures before the outlet X = max(1.5, 1 + S/2), S = sqrt(2 H_c): with rigid bodies at
!> most 0.9 of the way from X = 1 to it (200 contacts, M 0.01-2000, L 0-40, half of them with
!> Eyring's law).
!>
!> With S = sqrt(2 H_c) and H_c from the Moes fit, an inlet at X = -(1 + c S) with P = 0, c^2 =
!> 9.5^2 + 42^2 r^3, r = rigid film over fit, starves h_min by about 1e-3 (against twice the domain,
!> M 0.01-1000, L 0-30: 0.05-1.27e-3 in 71 runs, most where the regimes meet, M 0.3-1). For another
!> tolerance t: c^2 = (9.5 (1e-3/t)^0.4)^2 + 42^2 r^3 (1e-3/t).
!>
!> The second term is the load missing in front of the inlet, 2 r/c^2 of the total, times the
!> sensitivity of the film to the load: r^2 for a Newtonian oil. The film of an oil that sliding
!> thins in the inlet falls with the load as between rigid bodies, so r^2 becomes r^2 + (1 - r^2) (1
!> - 1/S^2), with S^2 = 1 + B^2 the slip factor without slope, B at H_c and 3 mu_0.
module domain_choice
   use asperities, only: asperity_pressure
   use contact_moment, only: clearing_film, film_estimate, least_speed, moments_of, &
      newtonian_film, own_contact, sample_count, width_of
   use kinds, only: pi, wp
   use line_contact, only: closing_slope, domain_t, finest_wave, line_contact_t
   use moes, only: rigid_film
   use lubricant, only: sliding_number
   use text, only: to_text
   use wave_resolution, only: intervals_at_least, nodes_in_wave, wanted_nodes
   implicit none (type, external)
   private

   public :: choose_anew, choose_domain, cut_asperities, find_finest_moment, inlet_error, &
      inlet_pressure_error, intervals_for, intervals_for_film

   !> Spacing that gives 1 % in the central film: dX <= 0.045 sqrt(H_c).
   real(wp), parameter, public :: accurate_spacing = 0.045_wp
   !> Largest spacing with a positive discrete film: about dX <= 0.3 sqrt(H_c) (see
   !> `intervals_for_film`).
   real(wp), parameter, public :: coarsest_spacing = 0.3_wp
   !> Largest share by which a chosen inlet starves the film.
   real(wp), parameter :: default_inlet_error = 1.0e-3_wp
   !> Least share of the errors by the inlet that is left with a tail (module line_hierarchy).
   real(wp), parameter :: tail_share = 0.1_wp
   !> Viscosity at which sliding thins the oil where the pressure builds up [mu_0].
   real(wp), parameter :: inlet_viscosity = 3.0_wp
   !> Margin of an outlet behind waves, and its largest distance from the end of the contact
   !> relative to smooth surfaces.
   real(wp), parameter :: wave_margin = 1.1_wp, max_widening = 3.0_wp
   !> c of the inlet X = -(1 + c S) of a graded grid, on which a far inlet costs little: the film
   !> errs there by 2e-5 in the lightest contacts, with 1/c^2 (load in front of it).
   real(wp), parameter :: far_reach = 300.0_wp
   !> c of both ends where asperities touch, S of the film that clears them: gap c^2 S^2/2 there.
   real(wp), parameter :: asperity_reach = 2.0_wp
   !> Share of the load that asperities beyond an end may bear.
   real(wp), parameter :: largest_cut = 1.0e-3_wp
   !> Largest outlet [half-widths].
   real(wp), parameter, public :: farthest = 1000.0_wp
   integer, parameter :: min_intervals = 256, max_intervals = 2**20
   !> Most intervals that waves alone can require: a transient on this grid takes minutes.
   integer, parameter :: max_for_waves = 2**16
   !> Most intervals that a thin film of a moment can require.
   integer, parameter :: max_for_duty = 2**13

contains

   !> Chooses what `contact%domain` leaves open: what lies in front of the inlet, inlet, outlet,
   !> intervals. With a relative target error `target` > 0 of the film, the inlet takes at most an
   !> eighth of it.
   pure recursive subroutine choose_domain(contact, target)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in), optional :: target

      if (allocated(contact%duty)) call choose_ends_for_duty(contact, target)
      associate (domain => contact%domain)
         if (domain%grid == 'auto') domain%grid = merge('graded', 'even  ', &
            finest_wave(contact) >= huge(1.0_wp))
         if (.not. domain%has_outlet) then
            domain%x_outlet = chosen_outlet(contact)
            domain%has_outlet = .true.
            domain%may_lengthen = .true.
         end if
         call choose_inlet(contact, target)
         if (domain%intervals > 0) return
         call choose_intervals(contact)
         domain%intervals_are_chosen = .true.
      end associate
   end subroutine choose_domain

   !> Chooses the ends for all moments of a duty, beyond those of each.
   pure recursive subroutine choose_ends_for_duty(contact, target)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in), optional :: target
      type(line_contact_t) :: own
      real(wp) :: ends(2), far(2), width
      integer :: i

      far = 0.0_wp
      associate (domain => contact%domain, times => contact%duty%samples(sample_count))
         do i = 1, size(times)
            own = own_contact(contact, times(i), least_speed)
            own%domain = domain_t(intervals=min_intervals)
            call choose_domain(own, target)
            associate (moment => contact%duty%at(times(i)))
               width = width_of(moment)
               ends = width*[own%domain%x_inlet, own%domain%x_outlet]
               if (sum(moment%speeds) < 0.0_wp) ends = -ends([2, 1])
            end associate
            far = [min(far(1), ends(1)), max(far(2), ends(2))]
         end do
         if (.not. domain%has_inlet) domain%x_inlet = far(1)
         if (.not. domain%has_inlet) domain%inlet_is_chosen = .true.
         if (.not. domain%has_outlet) domain%x_outlet = far(2)
         domain%has_inlet = .true.
         domain%has_outlet = .true.
      end associate
   end subroutine choose_ends_for_duty

   !> The moment of a duty whose film needs the finest grid, and the spacing for 1 % there.
   pure subroutine find_finest_moment(contact, when, spacing)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(out) :: when, spacing
      real(wp) :: wanted
      integer :: i

      when = 0.0_wp
      spacing = huge(spacing)
      associate (times => contact%duty%samples(sample_count))
         do i = 1, size(times)
            wanted = width_of(contact%duty%at(times(i)))*accurate_spacing &
               *sqrt(film_estimate(own_contact(contact, times(i), least_speed)))
            if (wanted >= spacing) cycle
            spacing = wanted
            when = times(i)
         end do
      end associate
   end subroutine find_finest_moment

   !> Chooses a domain anew except for what the user gave; `moves_out`: with the outlet at twice its
   !> distance from the end of the contact.
   pure subroutine choose_anew(contact, target, moves_out)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: target
      logical, intent(in), optional :: moves_out

      associate (domain => contact%domain)
         domain%has_outlet = present(moves_out) .or. .not. domain%may_lengthen
         if (present(moves_out)) then
            domain%x_outlet = min(2*domain%x_outlet - 1, farthest)
            domain%moves = domain%moves + 1
         end if
         domain%has_inlet = .not. domain%inlet_is_chosen
         if (domain%intervals_are_chosen) domain%intervals = 0
      end associate
      call choose_domain(contact, target)
   end subroutine choose_anew

   !> Outlet chosen by the program: behind X = sqrt(1 + s^2) the gap opens, about as sqrt(X^2 - 1),
   !> faster than passing waves of slope s close it, and pressure does not build up again; farther
   !> out on a graded grid, where that costs nothing.
   pure function chosen_outlet(contact) result(x_outlet)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: x_outlet, smooth

      x_outlet = max(1.5_wp, 1 + sqrt(2*newtonian_film(contact)))
      if (contact%domain%grid == 'graded') return
      smooth = 1 + max(0.5_wp, 0.5_wp*sqrt(2*newtonian_film(contact)), &
         asperity_reach*sqrt(2*clearing_film(contact)))
      x_outlet = max(smooth, min(wave_margin*sqrt(1 + closing_slope(contact)**2), &
         1 + max_widening*(smooth - 1)))
   end function chosen_outlet

   !> What to say of a domain that ends where asperities still press; empty: it does not.
   !>
   !> Their pressure at its nearer end is estimated at the gap that Hertz's contact has there, (X
   !> sqrt(X^2 - 1) - arcosh X)/2, above a middle where they bear p_h, or above the film. Beyond the
   !> end it falls by e over pc/(-pc' sqrt(X^2 - 1)). (In 32 contacts that end where asperities bear
   !> 0.01 to 0.5 p_h it was 0.7 to 2.4 times that.)
   pure function cut_asperities(contact) result(words)
      type(line_contact_t), intent(in) :: contact
      character(:), allocatable :: words
      character(len=*), parameter :: keys(2) = [character(len=8) :: 'x_inlet', 'x_outlet']
      real(wp) :: away, middle, pressure(1), slope(1)
      integer :: end, row

      words = ''
      if (.not. (allocated(contact%asperities) .and. contact%elasticity > 0.0_wp)) return
      associate (law => contact%asperities, ends => [contact%domain%x_inlet, &
         contact%domain%x_outlet])
         row = findloc(law%ln_pressure < 0.0_wp, .true., 1)
         if (row == 0) row = size(law%ln_pressure)
         middle = law%separation(row) - law%ln_pressure(row)/law%slope(row)
         end = minloc(abs(ends), 1)
         away = max(abs(ends(end)), 1.0_wp)
         call asperity_pressure(law, [max(middle, newtonian_film(contact)) &
            + 0.5_wp*(away*sqrt(away**2 - 1) - acosh(away))], pressure, slope)
         if (pressure(1)**2 <= largest_cut*0.5_wp*pi*abs(slope(1))*sqrt(away**2 - 1)) return
         away = 1 + asperity_reach*sqrt(2*clearing_film(contact))
         words = 'the domain ends at X = '//to_text(ends(end), 4)//', where asperities still '// &
            'press with about '//to_text(pressure(1), 2)//' of the Hertz pressure: leave out '// &
            trim(keys(end))//' or set it to '//to_text(sign(away, ends(end)), 4)
      end associate
   end function cut_asperities

   !> Chooses the inlet, unless given; `target` as above.
   pure subroutine choose_inlet(contact, target)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in), optional :: target
      real(wp) :: reach, tolerance

      tolerance = default_inlet_error
      if (present(target)) then
         if (target > 0.0_wp) tolerance = min(tolerance, 0.125_wp*target)
      end if
      associate (domain => contact%domain)
         if (domain%has_inlet) return
         if (domain%has_tail) tolerance = tolerance/tail_share
         reach = inlet_reach(contact, tolerance)
         if (domain%grid == 'graded') reach = far_reach
         domain%x_inlet = -(1 + max(sqrt(2*newtonian_film(contact))*reach, &
            asperity_reach*sqrt(2*clearing_film(contact))))
         domain%has_inlet = .true.
         domain%inlet_is_chosen = .true.
      end associate
   end subroutine choose_inlet

   !> Chooses the intervals of the contact's domain: for 1 % in the central film, and for its waves.
   pure subroutine choose_intervals(contact)
      type(line_contact_t), intent(inout) :: contact
      real(wp) :: spacing, when

      associate (domain => contact%domain, intervals => contact%domain%intervals)
         if (allocated(contact%duty)) then
            call find_finest_moment(contact, when, spacing)
            intervals = intervals_at_least(min(max((domain%x_outlet - domain%x_inlet)/spacing, &
               real(min_intervals, wp)), real(max_for_duty, wp)))
         else
            intervals = min(max(intervals_for(contact, accurate_spacing), min_intervals), &
               max_intervals)
         end if
         intervals = max(intervals, min(intervals_at_least(wanted_nodes/nodes_in_wave(contact) &
            *intervals), max_for_waves))
      end associate
   end subroutine choose_intervals

   !> c of an inlet at X = -(1 + c S) that starves the film by the share `tolerance`.
   pure function inlet_reach(contact, tolerance) result(reach)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: tolerance
      real(wp) :: reach, rigid_share, load_effect, b_squared, ratio

      rigid_share = rigid_film(contact%moes_m_sum)/newtonian_film(contact)
      ! 1 - 1/S^2 where the pressure builds up: 0 if sliding does not thin the oil, up to 1
      b_squared = (inlet_viscosity*sliding_number(contact%fluid)/newtonian_film(contact))**2
      load_effect = rigid_share**2
      load_effect = load_effect + max(1 - load_effect, 0.0_wp)*(b_squared/(1 + b_squared))
      ratio = default_inlet_error/tolerance
      reach = sqrt((9.5_wp*ratio**0.4_wp)**2 + 42.0_wp**2*(rigid_share*load_effect)*ratio)
   end function inlet_reach

   !> Relative loss of film against an inlet far away, with a duty the largest of its moments; with
   !> a tail its `share_left`.
   pure real(wp) function inlet_error(contact) result(error)
      type(line_contact_t), intent(in) :: contact

      error = film_error(contact)
      if (allocated(contact%duty)) error = maxval(film_error(moments_of(contact)))
   end function inlet_error

   !> The same of a contact without a duty.
   pure elemental real(wp) function film_error(contact) result(error)
      type(line_contact_t), intent(in) :: contact

      error = loss_without_tail(contact)*share_left(contact)
   end function film_error

   !> Share of the errors by the inlet that is left with a tail in front of it, 1 without: of second
   !> order in them. (48 passages of waves, fitted on 24: films err by less than a tenth of the
   !> bound, the largest pressure by a fifth, the rolling force by more in two.)
   pure real(wp) function share_left(contact) result(share)
      type(line_contact_t), intent(in) :: contact

      share = 1.0_wp
      if (contact%domain%has_tail) share = min(1.0_wp, max(tail_share, loss_without_tail(contact)))
   end function share_left

   !> Relative loss of film without a tail: the inverse of the rule above, by bisection between 1e-6
   !> and 100. The rule holds for small losses: above 1/20 it is a bound (heavy contacts) or an
   !> estimate (light ones).
   pure function loss_without_tail(contact) result(error)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: error, reach, lower, upper
      integer :: i

      reach = (-contact%domain%x_inlet - 1)/sqrt(2*newtonian_film(contact))
      lower = log(1.0e-6_wp)
      upper = log(100.0_wp)
      do i = 1, 40
         error = exp(0.5_wp*(lower + upper))
         if (inlet_reach(contact, error) > reach) then
            lower = log(error)
         else
            upper = log(error)
         end if
      end do
   end function loss_without_tail

   !> Bound on the relative error of the largest pressure by the position of the inlet; with a duty
   !> the largest of its moments.
   pure real(wp) function inlet_pressure_error(contact) result(error)
      type(line_contact_t), intent(in) :: contact

      error = pressure_error(contact)
      if (allocated(contact%duty)) error = maxval(pressure_error(moments_of(contact)))
   end function inlet_pressure_error

   !> The bound of a contact without a duty.
   !>
   !> Without pressure at X_i the pressure is lower by that of the parabolic gap there, 4 lambda/(3
   !> |X_i|^3), from X_i to the contact, and missing in front of X_i: together the load 2
   !> lambda/X_i^2, so that the contact carries the share w = 4 lambda/(pi X_i^2) more. Its pressure
   !> grows by w/2 (Hertz) to 3 w/2 (rigid film: load ~ 1/H, pressure ~ H^(-3/2)). With X_i^2 - 1,
   !> for the narrower gap next to the contact, the error was 0.2 to 0.8 of twice w (1/2 + r) in 40
   !> of 42 contacts without a spike, at most 1.1 (M 0.1-1000, L 0-40, c 2-30, a third with Eyring's
   !> law).
   pure elemental real(wp) function pressure_error(contact) result(error)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: film, missing

      film = newtonian_film(contact)
      associate (x => contact%domain%x_inlet)
         missing = 4*contact%lambda/(pi*max(x**2 - 1, tiny(1.0_wp)))
         error = (1 + 2*rigid_film(contact%moes_m_sum)/film)*min(missing, 1.0_wp)
         error = error*share_left(contact)
      end associate
   end function pressure_error

   !> Smallest 2^k with dX <= factor sqrt(H_c) on the contact's domain.
   pure integer function intervals_for(contact, factor) result(intervals)
      type(line_contact_t), intent(in) :: contact
      real(wp), intent(in) :: factor
      real(wp) :: wanted

      wanted = (contact%domain%x_outlet - contact%domain%x_inlet) &
         /(factor*sqrt(film_estimate(contact)))
      intervals = 2
      do while (intervals < wanted .and. intervals < 2**28)
         intervals = 2*intervals
      end do
   end function intervals_for

   !> Smallest 2^k with a positive discrete film: dX <= 0.3 sqrt(H_c) and dX <= sqrt(H_c/(0.85
   !> max(M, 1)^0.4)), which is less for M (sum velocity) above 800. Measured with Newton's method
   !> over M 1-2000, L 2.5-40 on 2^4 to 2^12 intervals: from this number on all Newtonian contacts
   !> have a solution, below half of it hardly any with M >= 30.
   pure integer function intervals_for_film(contact) result(intervals)
      type(line_contact_t), intent(in) :: contact

      intervals = intervals_for(contact, &
         min(coarsest_spacing, 1/sqrt(0.85_wp*max(contact%moes_m_sum, 1.0_wp)**0.4_wp)))
   end function intervals_for_film

end module domain_choice

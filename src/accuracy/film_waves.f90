!> Loss of the waves that features leave in the film, by grid and time step.
!>
!> Second-order schemes shift such a wave by a phase, and finally lose it (docs/theory.md, error
!> estimates). Coarser grids lose it as well: changes from grid to grid show the error of the
!> pressures only while the phase is small, that of the film at X = 0 until the wave is lost.
!>
!> The numbers come from 22 contacts (M_sum 34 to 290, p_h 0.6 to 2.8 GPa, waves of 0.07 to 1 b and
!> 7 to 51 % of the film).
module film_waves
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use features, only: rough_surface_t
   use kinds, only: not_known, pi, wp
   use line_contact, only: line_contact_t, time_settings_t
   use line_summary, only: line_summary_t
   use lubricant, only: fluid_viscosity, ln_slip
   use pressure_errors, only: spike_law_t
   use quantities, only: h_central, p_central, p_max
   use text, only: rounded
   implicit none (type, external)
   private

   public :: doubt_lost_waves, film_waves_t, lost_waves, new_film_waves

   !> A pressure is not known if it may err by more than this share of P at X = 0; a wave below this
   !> share of the film does not matter to the film.
   real(wp), parameter :: large_share = 0.05_wp
   !> Errors of the pressures over the phase; that up to which grids show them; that of a lost wave.
   real(wp), parameter :: safety = 2.0_wp, seen_phase = 0.1_wp, lost_phase = 0.5_wp
   !> Steps of the search for a sufficient spacing.
   real(wp), parameter :: finer = 1.1_wp

   !> Waves of a transient; none if nothing moves or the bodies are rigid.
   type :: film_waves_t
      !> k and A (waves), both > 0; not allocated: none.
      real(wp), allocatable :: wavenumber(:), height(:)
      !> 0: not known.
      real(wp) :: time_step = 0.0_wp
   end type film_waves_t

contains

   !> The waves of a `contact` in time, without those of profiles, which have no single height.
   pure function new_film_waves(contact, time) result(waves)
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      type(film_waves_t) :: waves

      waves%time_step = time%time_step
      if (.not. time%is_transient .or. contact%elasticity <= 0.0_wp) return
      allocate (waves%wavenumber(0), waves%height(0))
      call add_waves(contact%surface_1, waves)
      call add_waves(contact%surface_2, waves)
   end function new_film_waves

   !> Adds the waves of a surface.
   pure subroutine add_waves(surface, waves)
      type(rough_surface_t), intent(in) :: surface
      type(film_waves_t), intent(inout) :: waves

      if (.not. allocated(surface%features) .or. .not. abs(surface%speed) > 0.0_wp) return
      waves%wavenumber = [waves%wavenumber, 2*pi*abs(surface%speed)/surface%features%wavelength]
      waves%height = [waves%height, abs(surface%features%amplitude)]
   end subroutine add_waves

   !> Adds the loss of waves to the errors of the pressures of `summary` on a grid of spacing `dx`;
   !> if the loss is large they, and the film at X = 0, are not known.
   pure subroutine doubt_lost_waves(waves, law, dx, summary)
      type(film_waves_t), intent(in) :: waves
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(inout) :: summary
      integer, parameter :: rows(3) = [h_central, p_max, p_central]
      real(wp) :: doubt(2)

      doubt = doubts(waves, law, max(dx, waves%time_step), summary)
      associate (of => summary%of(rows), more => doubt([1, 2, 2]))
         summary%of(rows)%error_grid = of%error_grid + more
         where (.not. ieee_is_finite(more)) summary%of(rows)%extrapolated = not_known()
      end associate
   end subroutine doubt_lost_waves

   !> Says that quantities are not known because of lost waves, and which spacing and time step
   !> would do; empty: they are known.
   pure function lost_waves(waves, law, dx, summary) result(words)
      type(film_waves_t), intent(in) :: waves
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: dx
      type(line_summary_t), intent(in) :: summary
      character(:), allocatable :: words
      real(wp) :: spacing

      words = ''
      spacing = max(dx, waves%time_step)
      if (all(ieee_is_finite(doubts(waves, law, spacing, summary)))) return
      do while (.not. all(ieee_is_finite(doubts(waves, law, spacing, summary))))
         spacing = spacing/finer
      end do
      words = 'this grid loses a wave that a feature leaves in the film; dX and time_step of '// &
         rounded(spacing, 2, up=.false.)//' would keep it'
   end function lost_waves

   !> Errors of H and P at X = 0 by waves with this `spacing` and time step; NaN if large, 0 if H
   !> and P are not known themselves.
   pure function doubts(waves, law, spacing, summary) result(doubt)
      type(film_waves_t), intent(in) :: waves
      type(spike_law_t), intent(in) :: law
      real(wp), intent(in) :: spacing
      type(line_summary_t), intent(in) :: summary
      real(wp) :: doubt(2)
      real(wp) :: area, ln_mu(1)
      real(wp), allocatable :: phase(:)

      doubt = 0.0_wp
      if (.not. allocated(waves%wavenumber)) return
      associate (k => waves%wavenumber, film => summary%of(h_central)%value, &
         pressure => summary%of(p_central)%value)
         if (size(k) == 0 .or. .not. all(ieee_is_finite([film, pressure]))) return
         call fluid_viscosity(law%fluid, [pressure], ln_mu)
         ! l_flow^2 with the S of sliding alone
         area = exp(3*log(film) - ln_mu(1) + ln_slip(law%fluid, 0.0_wp, film, ln_mu(1)) &
            - log(law%lambda))
         phase = k*(k*spacing)**2/3/max(1.0_wp, area*k**3)
         if (any(phase > lost_phase .and. waves%height > large_share*film)) doubt(1) = not_known()
         doubt(2) = maxval(k*waves%height*min(1.0_wp, safety*phase), mask=phase > seen_phase)
         doubt(2) = max(0.0_wp, doubt(2))
         if (doubt(2) > large_share*pressure) doubt(2) = not_known()
      end associate
   end function doubts

end module film_waves

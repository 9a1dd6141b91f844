!> The lubricated line contact in dimensionless form: everything that (2.57)-(2.64) of the thesis
!> need.
module line_contact
   use constants, only: pi
   use kinds, only: wp
   use lubricant, only: fluid_t
   use errors, only: error_t
   use features, only: rough_surface_t
   use profile, only: load_window
   use solver_settings, only: domain_t
   implicit none (type, external)
   private

   public :: closing_slope, finest_wave, intervals_for_waves, is_smooth, line_contact_t, &
      move_profiles, shortest_passage

   !> Intervals in the finest wave (feature, sinusoid, profile) below which companions on n/4 may
   !> not see it.
   integer, parameter, public :: min_in_wave = 16
   !> A surface slower than this dX/dT counts as at rest, one without waves has waves of this length
   !> [b].
   real(wp), parameter :: slow = 1.0e-6_wp, longest = 1.0e9_wp

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

   !> Intervals from which three grids, n, n/2 and n/4, all see every wave of the surfaces; 1 if
   !> they are smooth. Domain complete.
   pure function intervals_for_waves(contact) result(intervals)
      type(line_contact_t), intent(in) :: contact
      integer :: intervals
      real(wp) :: wave

      wave = min(finest_wave(contact%surface_1), finest_wave(contact%surface_2))
      intervals = ceiling(min(min_in_wave*(contact%domain%x_outlet - contact%domain%x_inlet) &
         /max(wave, 1.0e-9_wp), 1.0e9_wp))
   end function intervals_for_waves

   !> Whether both surfaces are smooth.
   pure function is_smooth(contact)
      type(line_contact_t), intent(in) :: contact
      logical :: is_smooth

      is_smooth = min(finest_wave(contact%surface_1), &
         finest_wave(contact%surface_2)) >= huge(1.0_wp)
   end function is_smooth

   !> Slope by which the features of both surfaces close the film as they pass: of each surface the
   !> steepest one, 2 pi A/wavelength, times how fast it moves relative to the flow, |1 - dX/dT|;
   !> profiles, whose slopes differ, are left out.
   pure function closing_slope(contact) result(slope)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: slope

      slope = slope_of(contact%surface_1) + slope_of(contact%surface_2)

   contains

      !> That of one surface.
      pure function slope_of(surface) result(slope)
         type(rough_surface_t), intent(in) :: surface
         real(wp) :: slope

         slope = 0.0_wp
         if (.not. allocated(surface%features)) return
         if (size(surface%features) == 0) return
         slope = 2*pi*abs(1 - surface%speed)*maxval(abs(surface%features%amplitude) &
            /surface%features%wavelength)
      end function slope_of

   end function closing_slope

   !> Time T in which the finest wave of a moving surface passes a place; above 1e9 if there is
   !> none.
   pure function shortest_passage(contact) result(time)
      type(line_contact_t), intent(in) :: contact
      real(wp) :: time

      time = min(min(finest_wave(contact%surface_1), longest)/max(abs(contact%surface_1%speed), &
         slow), &
         min(finest_wave(contact%surface_2), longest)/max(abs(contact%surface_2%speed), slow))
   end function shortest_passage

   !> Shortest wavelength of a surface [b]; huge if it is smooth.
   pure function finest_wave(surface) result(wave)
      type(rough_surface_t), intent(in) :: surface
      real(wp) :: wave

      wave = huge(1.0_wp)
      if (allocated(surface%features)) wave = minval([wave, surface%features%wavelength])
      if (allocated(surface%profile)) wave = min(wave, surface%profile%finest_wave)
   end function finest_wave

   !> Has the profiles of both surfaces at hand for the whole of a complete domain at `time`. Error:
   !> a file cannot be read.
   subroutine move_profiles(contact, time, error)
      type(line_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: time
      type(error_t), allocatable, intent(out) :: error

      call move_profile(contact%surface_1, contact%domain, time, error)
      if (.not. allocated(error)) call move_profile(contact%surface_2, contact%domain, time, error)
   end subroutine move_profiles

   !> The same of one surface.
   subroutine move_profile(surface, domain, time, error)
      type(rough_surface_t), intent(inout) :: surface
      type(domain_t), intent(in) :: domain
      real(wp), intent(in) :: time
      type(error_t), allocatable, intent(out) :: error

      if (allocated(surface%profile)) call load_window(surface%profile, &
         domain%x_inlet - surface%speed*time, &
         domain%x_outlet - surface%speed*time, error)
   end subroutine move_profile

end module line_contact

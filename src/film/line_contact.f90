!> The lubricated line contact in dimensionless form: all data of (2.57)-(2.64) of the thesis.
module line_contact
   use asperities, only: asperities_t
   use duty, only: duty_t
   use kinds, only: pi, wp
   use lubricant, only: fluid_t
   use errors, only: error_t
   use features, only: displacement, rough_surface_t
   use film_heating, only: heating_t
   use profile, only: load_window
   use solver_settings, only: domain_t
   implicit none (type, external)
   private

   public :: closing_slope, finest_wave, inlet_tail_t, intervals_for_waves, line_contact_t, &
      move_profiles, rough_contact_t, shortest_passage, smoothen, &
      smoothen_both, without_surfaces

   !> Fewest intervals in the finest wave (feature, sinusoid, profile): with fewer, coarse runs on
   !> n/4 may miss it.
   integer, parameter, public :: min_in_wave = 16
   !> A surface with |dX/dT| below this is at rest; one without waves has this wavelength [b].
   real(wp), parameter :: slow = 1.0e-6_wp, longest = 1.0e9_wp

   !> Pressure in front of the domain, at rising nodes that end in it (module inlet_tail).
   type :: inlet_tail_t
      real(wp), allocatable :: x(:), pressure(:)
   end type inlet_tail_t

   !> What line and point contacts have: where they are solved, and the surfaces that pass.
   type :: rough_contact_t
      !> Scaled surfaces: heights in b^2/R, lengths in b, speeds dX/dT.
      type(rough_surface_t) :: surface_1, surface_2
      !> Domain in half-widths; complete after `choose_domain`.
      type(domain_t) :: domain
      !> Slide-to-roll ratio 2 (u2 - u1)/(u1 + u2) [-], positive if surface 2 is faster; NaN: speeds
      !> not known. Shear stresses need it, the solver does not.
      real(wp) :: slide_to_roll = 0.0_wp
      !> Half-width of the dry contact along X [b]; central film to be expected of a point contact.
      real(wp) :: half_length = 1.0_wp, expected_film = 0.0_wp
      !> Load, radius and speeds over time; lambda, the fluid, M and L are then those of the
      !> reference state. Not allocated: constant.
      type(duty_t), allocatable :: duty
   end type rough_contact_t

   !> Data of one dimensionless contact.
   type, extends(rough_contact_t) :: line_contact_t
      !> Speed parameter lambda of (2.55), corrected: 6 u_s R^2 mu_0/(p_h b^3) [-], > 0.
      real(wp) :: lambda = 0.0_wp
      !> Moes load parameter M, SUM velocity [-].
      real(wp) :: moes_m_sum = 0.0_wp
      !> Moes lubricant parameter L, SUM velocity [-].
      real(wp) :: moes_l_sum = 0.0_wp
      !> Scaled lubricant laws.
      type(fluid_t) :: fluid
      !> Oil is conserved in cavities, and what arrives per u1 + u2 at most (module reynolds_line).
      logical :: conserves_oil = .false.
      real(wp) :: supply = huge(1.0_wp)
      !> Rough surfaces whose asperities touch; not allocated: none do.
      type(asperities_t), allocatable :: asperities
      !> The heat of sliding warms film and surfaces; not allocated: they stay as cold as the inlet.
      type(heating_t), allocatable :: heating
      !> What lies in front of it, if the domain has a tail and it is known.
      type(inlet_tail_t), allocatable :: tail
      !> Fraction of the deformation of the bodies: 1, all of it; 0, rigid bodies; between, bodies
      !> stiffer by its inverse.
      real(wp) :: elasticity = 1.0_wp
      !> b/R; where it is not known that of steel at 1 GPa.
      real(wp) :: slope = 0.02_wp
   end type line_contact_t

contains

   !> Intervals from which the three grids n, n/2 and n/4 resolve every wave of the surfaces; 1 if
   !> they are smooth. The domain must be complete.
   pure integer function intervals_for_waves(contact) result(intervals)
      class(rough_contact_t), intent(in) :: contact

      intervals = ceiling(min(min_in_wave*(contact%domain%x_outlet - contact%domain%x_inlet) &
         /max(finest_wave(contact), 1.0e-9_wp), 1.0e9_wp))
   end function intervals_for_waves

   !> Shortest wavelength of both surfaces [b]; huge if they are smooth.
   pure real(wp) function finest_wave(contact) result(wave)
      class(rough_contact_t), intent(in) :: contact

      wave = min(wave_of(contact%surface_1), wave_of(contact%surface_2))
   end function finest_wave

   !> Slope by which the features of both surfaces close the film as they pass: for each surface the
   !> steepest one, 2 pi A/wavelength, times its speed relative to the flow, |1 - dX/dT|; profiles,
   !> whose slopes differ, are left out.
   pure real(wp) function closing_slope(contact) result(slope)
      class(rough_contact_t), intent(in) :: contact

      slope = slope_of(contact%surface_1) + slope_of(contact%surface_2)

   contains

      !> The same of one surface.
      pure real(wp) function slope_of(surface) result(slope)
         type(rough_surface_t), intent(in) :: surface

         slope = 0.0_wp
         if (.not. allocated(surface%features)) return
         if (size(surface%features) == 0) return
         slope = 2*pi*abs(1 - surface%speed)*maxval(abs(surface%features%amplitude) &
            /surface%features%wavelength)
      end function slope_of

   end function closing_slope

   !> Time T in which the finest wave of a moving surface passes a point; above 1e9: none.
   pure real(wp) function shortest_passage(contact) result(time)
      class(rough_contact_t), intent(in) :: contact

      time = min(passage_of(contact%surface_1), passage_of(contact%surface_2))

   contains

      !> The same of one surface.
      pure real(wp) function passage_of(surface) result(time)
         type(rough_surface_t), intent(in) :: surface

         time = min(wave_of(surface), longest)/max(abs(surface%speed), slow)
      end function passage_of

   end function shortest_passage

   !> Shortest wavelength of a surface [b]; huge if it is smooth.
   pure real(wp) function wave_of(surface) result(wave)
      type(rough_surface_t), intent(in) :: surface

      wave = huge(1.0_wp)
      if (allocated(surface%features)) wave = minval([wave, surface%features%wavelength, &
         pack(surface%features%wavelength_y, surface%features%wavelength_y > 0.0_wp)])
      if (allocated(surface%profile)) wave = min(wave, surface%profile%finest_wave)
   end function wave_of

   !> The contact with smooth surfaces.
   pure function without_surfaces(contact) result(smooth)
      type(line_contact_t), intent(in) :: contact
      type(line_contact_t) :: smooth

      smooth = contact
      call smoothen_both(smooth)
   end function without_surfaces

   !> Removes features and profiles from both surfaces.
   pure subroutine smoothen_both(contact)
      class(rough_contact_t), intent(inout) :: contact

      call smoothen(contact%surface_1)
      call smoothen(contact%surface_2)
   end subroutine smoothen_both

   !> Removes features and profile from a surface.
   pure subroutine smoothen(surface)
      type(rough_surface_t), intent(inout) :: surface

      if (allocated(surface%profile)) deallocate (surface%profile)
      if (allocated(surface%features)) deallocate (surface%features)
      allocate (surface%features(0))
   end subroutine smoothen

   !> Loads the part of both profiles that covers a complete domain at `time`. Error: a file cannot
   !> be read.
   subroutine move_profiles(contact, time, error)
      class(rough_contact_t), intent(inout) :: contact
      real(wp), intent(in) :: time
      type(error_t), allocatable, intent(out) :: error

      associate (ends => [contact%domain%x_inlet, contact%domain%x_outlet], &
         one => contact%surface_1, two => contact%surface_2)
         if (allocated(one%profile)) call load_window(one%profile, ends(1) - displacement(one, &
            time), ends(2) - displacement(one, time), error)
         if (allocated(error)) return
         if (allocated(two%profile)) call load_window(two%profile, ends(1) - displacement(two, &
            time), ends(2) - displacement(two, time), error)   ! error: the caller looks
      end associate
   end subroutine move_profiles

end module line_contact

!> Which roughness is inside the contact, and where the contact begins for the film: at X = -1 - S/2
!> with S = sqrt(2 H_c).
module entry_zone
   use features, only: feature_ridge, feature_sinusoid, feature_t, rough_surface_t
   use kinds, only: wp
   use contact_moment, only: film_estimate
   use line_contact, only: line_contact_t, rough_contact_t
   use profile, only: profile_length
   implicit none (type, external)
   private

   public :: arrival_of, first_passage, front_arrival, has_something_inside, has_waves, &
      is_moving, is_ridge, is_wave, last_passage, zone_of, zone_t

   !> Half length of a ridge in wavelengths: its height there is 0.3 % of that at its centre.
   real(wp), parameter, public :: half_ridge = 0.5_wp
   !> The contact begins at X = -1 - c S.
   real(wp), parameter :: border = 0.5_wp
   !> A surface with |dX/dT| below this is at rest.
   real(wp), parameter :: slow = 1.0e-6_wp

   !> Position of the contact, and the time that the film takes through it.
   type :: zone_t
      !> S = sqrt(2 H_c), and |X| of the end of the dry contact and of the border.
      real(wp) :: width, end, border
      real(wp) :: transit
   end type zone_t

contains

   !> Where the contact begins and ends for features that enter it.
   pure function zone_of(contact) result(zone)
      class(rough_contact_t), intent(in) :: contact
      type(zone_t) :: zone
      real(wp) :: film

      film = contact%expected_film
      select type (contact)
      class is (line_contact_t)
         film = film_estimate(contact)
      end select
      zone%width = sqrt(2*film)
      zone%end = contact%half_length
      zone%border = zone%end + border*zone%width
      zone%transit = 2*zone%end + zone%width
   end function zone_of

   !> Whether a surface is rough along its full length, however far it moves.
   pure logical function has_waves(surface)
      type(rough_surface_t), intent(in) :: surface

      has_waves = .false.
      if (allocated(surface%features)) has_waves = any(is_wave(surface%features))
      if (allocated(surface%profile)) has_waves = has_waves .or. surface%profile%is_periodic
   end function has_waves

   !> Whether a ridge or a profile reaches into the contact at T = 0. A profile at rest is meant
   !> to be inside.
   pure logical function has_something_inside(surface, zone) result(is_inside)
      type(rough_surface_t), intent(in) :: surface
      type(zone_t), intent(in) :: zone

      is_inside = .false.
      if (allocated(surface%features)) is_inside = any(is_ridge(surface%features) .and. &
         abs(surface%features%position) - half_ridge*surface%features%wavelength < zone%border)
      if (.not. allocated(surface%profile)) return
      associate (profile => surface%profile)
         is_inside = is_inside .or. (profile%start < zone%border .and. profile%start &
            + profile_length(profile) > -zone%border)
      end associate
   end function has_something_inside

   !> Whether a feature is a sinusoid of non-zero amplitude.
   pure elemental logical function is_wave(feature)
      type(feature_t), intent(in) :: feature

      is_wave = feature%kind == feature_sinusoid .and. abs(feature%amplitude) > 0.0_wp
   end function is_wave

   !> Whether a feature is a ridge or dent of non-zero amplitude and known position.
   pure elemental logical function is_ridge(feature)
      type(feature_t), intent(in) :: feature

      is_ridge = feature%kind == feature_ridge .and. abs(feature%amplitude) > 0.0_wp &
         .and. feature%is_placed
   end function is_ridge

   !> Whether a surface moves.
   pure logical function is_moving(surface)
      type(rough_surface_t), intent(in) :: surface

      is_moving = abs(surface%speed) > slow
   end function is_moving

   !> Time at which the first roughness of a surface reaches the contact; 0: inside at T = 0; huge:
   !> never.
   pure real(wp) function arrival_of(surface, zone) result(time)
      type(rough_surface_t), intent(in) :: surface
      type(zone_t), intent(in) :: zone

      time = first_passage(surface, zone)
      if (has_waves(surface)) time = 0.0_wp
      time = max(time, front_arrival(surface, zone))
   end function arrival_of

   !> Time at which the front of a smooth entry of a moving surface reaches the contact; 0 without
   !> one.
   pure real(wp) function front_arrival(surface, zone) result(time)
      type(rough_surface_t), intent(in) :: surface
      type(zone_t), intent(in) :: zone

      time = 0.0_wp
      if (surface%entry_length > 0.0_wp .and. is_moving(surface)) time = &
         max(abs(surface%entry_position) - zone%border, 0.0_wp)/abs(surface%speed)
   end function front_arrival

   !> The same for ridges, dents and a profile of finite length, without a smooth entry.
   pure real(wp) function first_passage(surface, zone) result(time)
      type(rough_surface_t), intent(in) :: surface
      type(zone_t), intent(in) :: zone

      time = huge(time)
      if (allocated(surface%features)) then
         associate (f => surface%features)
            time = minval([time, pack(reached(f%position, half_ridge*f%wavelength), is_ridge(f))])
         end associate
      end if
      if (allocated(surface%profile)) then
         if (surface%profile%is_periodic) return
         associate (half => 0.5_wp*profile_length(surface%profile))
            time = min(time, reached(surface%profile%start + half, half))
         end associate
      end if

   contains

      !> Time at which a feature around `centre`, with a length of 2 `half`, reaches the contact.
      pure elemental function reached(centre, half) result(when)
         real(wp), intent(in) :: centre, half
         real(wp) :: when, distance

         when = 0.0_wp
         if (abs(centre) - half < zone%border) return
         when = huge(when)
         if (.not. is_moving(surface)) return
         distance = -sign(1.0_wp, surface%speed)*centre - half - zone%border
         if (distance >= 0.0_wp) when = distance/abs(surface%speed)
      end function reached

   end function first_passage

   !> Time at which the last ridge of a moving surface leaves the contact at its `end` [|X|].
   pure real(wp) function last_passage(surface, end) result(time)
      type(rough_surface_t), intent(in) :: surface
      real(wp), intent(in) :: end

      time = 0.0_wp
      if (.not. (allocated(surface%features) .and. is_moving(surface))) return
      associate (f => surface%features)
         time = maxval([time, pack(end + half_ridge*f%wavelength &
            - sign(1.0_wp, surface%speed)*f%position, is_ridge(f))/abs(surface%speed)])
      end associate
   end function last_passage

end module entry_zone

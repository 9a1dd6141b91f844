!> Times of a transient that count for its quantities: those after its start is forgotten.
!>
!> At T = 0 the film is that of the smooth contact, and surfaces that are then inside the contact
!> have entered it without a new solve. With S = sqrt(2 H_c) the film forms in front of X = -1 - S/2
!> and moves through the contact with the mean speed, one half-width per unit of T, in the time 2 +
!> S. The effect of the start on an extreme was below 1.4 % after that time in 9 waves of 5 to 35 %
!> of the film, below 0.1 % after 1.6 times that, and fell by a factor of 10 or more in each further
!> such time. A ridge that begins in front of X = -1 - S/2 is free of the start: its film differs by
!> less than 0.4 % from that of a start far outside (10 contacts).
!>
!> A transient of waves only becomes periodic: its quantities are those of the last complete
!> periods.
module passage_times
   use entry_zone, only: arrival_of, half_ridge, first_passage, front_arrival, &
      has_something_inside, has_waves, is_moving, is_ridge, is_wave, last_passage, zone_of, zone_t
   use duty, only: moment_t, span_of
   use features, only: feature_ridge, rough_surface_t
   use kinds, only: wp
   use line_contact, only: rough_contact_t, time_settings_t
   use profile, only: profile_length
   use text, only: add_sentence, rounded, to_text
   implicit none (type, external)
   private

   public :: new_passage_times, passage_note, passage_times_t, place_features, sufficient_end

   !> The start is forgotten after `settling` times 2 + S; `comparable` times suffice for a
   !> comparison.
   real(wp), parameter :: settling = 1.5_wp, comparable = 1.0_wp
   !> Quantities of periodic transients cover complete periods of at least this many times 2 + S.
   real(wp), parameter :: least_window = 1.0_wp/3.0_wp
   !> A feature is placed in front of X = -1 - c S.
   real(wp), parameter :: entry = 1.0_wp
   !> Several waves repeat themselves when each is within this part of its period from where it was;
   !> searched up to this many periods of the slowest.
   real(wp), parameter :: same_phase = 0.05_wp
   integer, parameter :: max_periods = 1000
   !> Times are equal within this share of the end.
   real(wp), parameter :: rounding = 1.0e-9_wp

   !> Times of one transient, all T.
   type :: passage_times_t
      !> Quantities are the extremes from this time on.
      real(wp) :: counts_from = 0.0_wp
      !> If a period is known: the extremes between this time and `counts_from` show how far the
      !> transient is from periodic.
      real(wp) :: earlier_from = 0.0_wp
      !> Period of the transient; 0: none.
      real(wp) :: period = 0.0_wp
      !> From this time on the start is forgotten and all waves have entered.
      real(wp) :: settled_from = 0.0_wp
      !> Before this time the contact is still smooth; 0 if that lasts to the end.
      real(wp) :: arrival = 0.0_wp
      !> End time that the transient needs.
      real(wp) :: needed_end = 0.0_wp
      real(wp) :: end_time = 0.0_wp
      !> At T = 0 roughness is inside the contact, without a smooth entry.
      logical :: is_artificial = .false.
      !> The user gave `counts_from`.
      logical :: is_given = .false.
   contains
      procedure :: counts, is_earlier, is_settled, lengthened, statistics_from
   end type passage_times_t

contains

   !> Whether the quantities at `time` count.
   pure elemental logical function counts(self, time)
      class(passage_times_t), intent(in) :: self
      real(wp), intent(in) :: time

      counts = time >= self%counts_from - rounding*self%end_time
   end function counts

   !> Time from which statistics of the film count: not while the contact is still smooth, unless
   !> the user gave it.
   pure real(wp) function statistics_from(self) result(from)
      class(passage_times_t), intent(in) :: self

      from = self%counts_from
      if (.not. self%is_given) from = max(from, self%arrival)
      from = from - rounding*self%end_time
   end function statistics_from

   !> Whether the quantities at `time` belong to the comparison.
   pure elemental logical function is_earlier(self, time)
      class(passage_times_t), intent(in) :: self
      real(wp), intent(in) :: time

      is_earlier = self%period > 0.0_wp .and. time >= self%earlier_from - rounding*self%end_time &
         .and. time <= self%counts_from + rounding*self%end_time
   end function is_earlier

   !> The times of a run that goes on for another period.
   pure function lengthened(self) result(times)
      class(passage_times_t), intent(in) :: self
      type(passage_times_t) :: times

      times = self
      times%earlier_from = self%counts_from
      times%counts_from = self%end_time
      times%end_time = self%end_time + self%period
   end function lengthened

   !> Whether the start is forgotten when the times that count begin; true if the user gave that
   !> time.
   pure logical function is_settled(self)
      class(passage_times_t), intent(in) :: self

      is_settled = self%is_given .or. .not. self%is_artificial &
         .or. self%end_time >= self%needed_end*(1 - rounding)
   end function is_settled

   !> The times of a contact whose features are placed.
   pure function new_passage_times(contact, time) result(times)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      type(passage_times_t) :: times
      type(zone_t) :: zone
      real(wp) :: window

      times%end_time = time%end_time
      if (.not. time%is_transient) return
      if (allocated(contact%duty)) then
         call settle_duty(contact, time, times)
         return
      end if
      zone = zone_of(contact)
      call settle_surface(contact%surface_1, zone, times)
      call settle_surface(contact%surface_2, zone, times)
      times%needed_end = times%settled_from
      times%arrival = min(arrival_of(contact%surface_1, zone), arrival_of(contact%surface_2, zone))
      if (times%arrival > time%end_time) times%arrival = 0.0_wp
      if (time%statistics_from >= 0.0_wp) then
         times%is_given = .true.
         times%counts_from = time%statistics_from
         return
      end if
      times%period = common_period([periods_of(contact%surface_1), periods_of(contact%surface_2)])
      if (times%period > 0.0_wp) then
         window = times%period*ceiling(least_window*zone%transit/times%period)
         times%needed_end = max(times%settled_from + window, &
            times%settled_from - (settling - comparable)*zone%transit + 2*window)
         times%counts_from = max(time%end_time - window, min(times%settled_from, time%end_time))
         times%earlier_from = max(time%end_time - 2*window, 0.0_wp)
      else if (times%settled_from < time%end_time) then
         times%counts_from = times%settled_from
      else if (times%is_artificial) then
         times%counts_from = time%end_time
      end if
   end function new_passage_times

   !> Times of a contact with a duty: all of one that does not repeat, else the last cycle, which
   !> the one before shows to be periodic or not; two more cycles than the oil of the start needs to
   !> leave the contact.
   pure subroutine settle_duty(contact, time, times)
      class(rough_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      type(passage_times_t), intent(inout) :: times
      type(zone_t) :: zone
      type(moment_t) :: moment
      real(wp) :: way
      integer :: i
      integer, parameter :: samples = 200, most_cycles = 100

      times%is_given = time%statistics_from >= 0.0_wp
      times%counts_from = max(time%statistics_from, 0.0_wp)
      times%needed_end = span_of(contact%duty)
      if (times%is_given .or. .not. contact%duty%load%is_periodic) return
      times%period = times%needed_end
      way = 0.0_wp
      do i = 1, samples
         moment = contact%duty%at(times%period*(i - 0.5_wp)/samples)
         way = way + times%period/samples*abs(sum(moment%speeds))
      end do
      zone = zone_of(contact)
      way = way/(settling*zone%transit)
      times%needed_end = times%period*(2 + ceiling(1/max(way, 1.0_wp/most_cycles) - rounding))
      times%counts_from = max(time%end_time - times%period, 0.0_wp)
      times%earlier_from = max(time%end_time - 2*times%period, 0.0_wp)
   end subroutine settle_duty

   !> End time T at which the quantities of a contact are complete: the start is forgotten, features
   !> and profiles have passed, waves have become periodic; 0: nothing rough moves.
   pure real(wp) function sufficient_end(contact) result(end_time)
      class(rough_contact_t), intent(in) :: contact
      type(passage_times_t) :: times

      times = new_passage_times(contact, time_settings_t(is_transient=.true., &
         end_time=huge(1.0_wp)))
      end_time = times%needed_end
      if (allocated(contact%duty)) return
      end_time = max(end_time, passage_end(contact%surface_1, contact%half_length, &
         times%settled_from), passage_end(contact%surface_2, contact%half_length, &
         times%settled_from))
   end function sufficient_end

   !> Time at which the ridges and the profile of a surface have passed the `end` of the contact, a
   !> periodic one once after `settled_from`; 0: it has none, or is at rest.
   pure real(wp) function passage_end(surface, end, settled_from) result(time)
      type(rough_surface_t), intent(in) :: surface
      real(wp), intent(in) :: end, settled_from
      real(wp) :: way

      time = last_passage(surface, end)
      if (.not. (allocated(surface%profile) .and. is_moving(surface))) return
      associate (profile => surface%profile, length => profile_length(surface%profile))
         way = end - profile%start
         if (surface%speed < 0.0_wp) way = end + profile%start + length
         if (profile%is_periodic) way = length + abs(surface%speed)*settled_from
         time = max(time, way/abs(surface%speed))
      end associate
   end function passage_end

   !> Sets whether a surface is artificial at T = 0, until when, and when its waves fill the
   !> contact.
   pure subroutine settle_surface(surface, zone, times)
      type(rough_surface_t), intent(in) :: surface
      type(zone_t), intent(in) :: zone
      type(passage_times_t), intent(inout) :: times
      real(wp) :: settled
      logical :: is_inside, is_full

      is_full = has_waves(surface)
      is_inside = is_full .or. has_something_inside(surface, zone)
      if (.not. is_inside) return
      settled = settling*zone%transit
      if (surface%entry_length > 0.0_wp) then
         if (is_moving(surface) .and. .not. is_full) return   ! nothing rises in front of the front
         settled = settled + entering_time(surface, zone)
      else
         times%is_artificial = .true.
      end if
      times%settled_from = max(times%settled_from, settled)
   end subroutine settle_surface

   !> Delay until the film comes from a complete wave, which rises behind a front or with time,
   !> against a wave that is present at T = 0.
   pure real(wp) function entering_time(surface, zone) result(time)
      type(rough_surface_t), intent(in) :: surface
      type(zone_t), intent(in) :: zone

      time = surface%entry_length
      if (.not. is_moving(surface)) return
      associate (speed => abs(surface%speed), distance => abs(surface%entry_position) - zone%border)
         time = (max(distance, 0.0_wp) + surface%entry_length)/speed
         if (surface%speed > 0.0_wp) then
            time = time + max(zone%transit/speed - settling*zone%transit, 0.0_wp)
         else
            time = time + zone%transit/speed   ! the film is made at the other side
         end if
      end associate
   end function entering_time

   !> Time in which each wave of a moving surface moves by its length; huge where something of it
   !> does not repeat itself.
   pure function periods_of(surface) result(periods)
      type(rough_surface_t), intent(in) :: surface
      real(wp), allocatable :: periods(:)

      allocate (periods(0))
      if (.not. is_moving(surface)) return
      if (allocated(surface%profile)) periods = [huge(1.0_wp)]
      if (.not. allocated(surface%features)) return
      if (any(is_ridge(surface%features))) periods = [huge(1.0_wp)]
      periods = [periods, pack(surface%features%wavelength, is_wave(surface%features)) &
         /abs(surface%speed)]
   end function periods_of

   !> Shortest time after which all waves nearly repeat themselves; 0 without waves, or with a
   !> period of huge.
   pure real(wp) function common_period(periods) result(period)
      real(wp), intent(in) :: periods(:)
      integer :: i

      period = 0.0_wp
      if (size(periods) == 0 .or. any(periods >= huge(1.0_wp))) return
      do i = 1, max_periods
         period = i*maxval(periods)
         if (all(abs(period/periods - anint(period/periods)) <= same_phase)) return
      end do
   end function common_period

   !> Places the features of moving surfaces that have no position just in front of the contact, on
   !> the side they come from; if something else must settle first, so far that they enter after it.
   pure subroutine place_features(contact)
      class(rough_contact_t), intent(inout) :: contact
      type(passage_times_t) :: times
      type(zone_t) :: zone

      zone = zone_of(contact)
      call settle_surface(contact%surface_1, zone, times)
      call settle_surface(contact%surface_2, zone, times)
      call place_on(contact%surface_1)
      call place_on(contact%surface_2)

   contains

      !> Places the features of one surface; a sinusoid has a crest at X = 0.
      pure subroutine place_on(surface)
         type(rough_surface_t), intent(inout) :: surface
         real(wp) :: distance
         integer :: i

         if (.not. allocated(surface%features)) return
         do i = 1, size(surface%features)
            associate (feature => surface%features(i))
               if (feature%is_placed) cycle
               feature%is_placed = .true.
               if (feature%kind /= feature_ridge .or. .not. is_moving(surface)) cycle
               distance = zone%end + entry*zone%width + abs(surface%speed)*times%settled_from
               if (surface%entry_length > 0.0_wp) distance = max(distance, &
                  abs(surface%entry_position) + surface%entry_length)
               feature%position = sign(distance + half_ridge*feature%wavelength, -surface%speed)
            end associate
         end do
      end subroutine place_on

   end subroutine place_features

   !> Note on the times: quantities that include the start, an incomplete passage; empty: none.
   pure function passage_note(contact, times) result(note)
      class(rough_contact_t), intent(in) :: contact
      type(passage_times_t), intent(in) :: times
      character(:), allocatable :: note
      real(wp) :: left

      note = ''
      if (.not. times%settled_from > 0.0_wp .or. allocated(contact%duty)) then
         continue
      else if (times%is_given) then
         if (times%is_artificial .and. times%counts_from < times%settled_from*(1 &
            - rounding)) note = &
            'statistics_from lies in the artificial start, which is forgotten by T = ' &
               //to_text(times%settled_from, 3)
      else if (times%end_time < times%needed_end*(1 - rounding)) then
         note = 'the surfaces have not filled the contact before T = ' &
            //to_text(times%settled_from, 3)
         if (times%is_artificial) note = 'the artificial start is in the quantities: it is ' &
            //'forgotten by T = '//to_text(times%settled_from, 3)
         if (times%period > 0.0_wp) note = note//', and a period takes '//to_text(times%period, 3)
         note = note//'; end_time = '//rounded(times%needed_end, 3, up=.true.)//' or more is needed'
      else
         note = uncounted_passage(contact, times%settled_from)
      end if
      left = max(last_passage(contact%surface_1, contact%half_length), &
         last_passage(contact%surface_2, contact%half_length))
      if (left > times%end_time*(1 + rounding)) call add_sentence(note, &
         'a feature is still in the contact or in front of it at the end: end_time = ' &
         //rounded(left, 3, up=.true.)//' or more is needed')
   end function passage_note

   !> Note on features that pass before the quantities count, at `from`; empty: none.
   pure function uncounted_passage(contact, from) result(note)
      class(rough_contact_t), intent(in) :: contact
      real(wp), intent(in) :: from
      character(:), allocatable :: note
      real(wp) :: first(2), shifts(2)

      note = ''
      first = [own_passage(contact%surface_1), own_passage(contact%surface_2)]
      shifts = (from - min(first, from))*abs([contact%surface_1%speed, contact%surface_2%speed])
      if (minval(first) >= from*(1 - rounding)) return
      note = 'enters the contact at T = '//to_text(minval(first), 3)
      if (.not. minval(first) > 0.0_wp) note = 'stands in the contact at T = 0'
      note = 'a feature that moves '//note//': of its passage only what comes after T = ' &
         //to_text(from, 3)//' counts; position further outside'
      if (minval(first) > 0.0_wp) note = note//', by '//to_text(maxval(shifts), 3)//','
      note = note//' shows all of it'

   contains

      !> Time at which the first feature of a surface reaches the contact; huge if it is at rest.
      pure real(wp) function own_passage(surface) result(time)
         type(rough_surface_t), intent(in) :: surface

         time = huge(time)
         if (is_moving(surface)) time = max(first_passage(surface, zone_of(contact)), &
            front_arrival(surface, zone_of(contact)))
      end function own_passage

   end function uncounted_passage

end module passage_times

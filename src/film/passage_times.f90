!> Which times of a transient count for its quantities: from when its start is forgotten.
!>
!> At T = 0 the film is that of the smooth contact, and surfaces that are then inside the contact
!> have entered it without a new solve. With S = sqrt(2 H_c) the film is made in front of
!> X = -1 - S/2 and carried through the contact with the mean speed, one half-width per unit of T,
!> in the time 2 + S. What the start has left of an extreme was below 1.4 % after that time in 9
!> waves of 5 to 35 % of the film, below 0.1 % after 1.6 times that, and fell by a factor of 10 or
!> more in each further such time. A ridge that begins in front of X = -1 - S/2 leaves nothing of
!> the start: its film differs by less than 0.4 % from that of a start far outside (10 contacts).
!>
!> A passage of nothing but waves becomes periodic: its quantities are those of the last whole
!> periods.
module passage_times
   use entry_zone, only: arrival_of, half_ridge, first_passage, front_arrival, &
      has_something_inside, has_waves, is_moving, is_ridge, is_wave, last_passage, zone_of, zone_t
   use features, only: feature_ridge, rough_surface_t
   use kinds, only: wp
   use line_contact, only: line_contact_t
   use solver_settings, only: time_settings_t
   use text, only: add_sentence, rounded_up, to_text
   implicit none (type, external)
   private

   public :: new_passage_times, passage_note, passage_times_t, place_features

   !> The start is forgotten after this many times 2 + S, and half of that suffices for a
   !> comparison.
   real(wp), parameter :: settling = 1.5_wp, comparable = 1.0_wp
   !> Quantities of periodic passages are taken over whole periods that last this many times 2 + S
   !> at least.
   real(wp), parameter :: least_window = 1.0_wp/3.0_wp
   !> A feature is put in front of X = -1 - c S.
   real(wp), parameter :: entry = 1.0_wp
   !> Several waves repeat themselves where each is this part of its period from where it was, at
   !> most; looked for up to this many periods of the slowest.
   real(wp), parameter :: same_phase = 0.05_wp
   integer, parameter :: max_periods = 1000
   !> Times are equal to this share of the end.
   real(wp), parameter :: rounding = 1.0e-9_wp

   !> The times of one passage, all T.
   type :: passage_times_t
      !> Quantities are the extremes over this time and all later ones.
      real(wp) :: counts_from = 0.0_wp
      !> Where a period is known: the extremes between this time and `counts_from` tell how far the
      !> passage is from periodic.
      real(wp) :: earlier_from = 0.0_wp
      !> Period of the passage; 0: it has none.
      real(wp) :: period = 0.0_wp
      !> From here on the start is forgotten and all waves have entered.
      real(wp) :: settled_from = 0.0_wp
      !> Before this time the contact is smooth still; 0 where that lasts to the end.
      real(wp) :: arrival = 0.0_wp
      !> End that the passage needs.
      real(wp) :: needed_end = 0.0_wp
      real(wp) :: end_time = 0.0_wp
      !> At T = 0 something stands inside the contact.
      logical :: is_artificial = .false.
      !> `counts_from` is the user's.
      logical :: is_given = .false.
   contains
      !> Whether a time counts, and whether it belongs to the comparison.
      procedure :: counts
      procedure :: is_earlier
      !> From when statistics of the film count.
      procedure :: statistics_from
      !> Whether the run lasts until the quantities have nothing of the start in them.
      procedure :: is_settled
   end type passage_times_t

contains

   !> Whether the quantities at `time` count.
   pure elemental function counts(self, time)
      class(passage_times_t), intent(in) :: self
      real(wp), intent(in) :: time
      logical :: counts

      counts = time >= self%counts_from - rounding*self%end_time
   end function counts

   !> Statistics of the film count no times at which the contact is smooth still, unless the user
   !> has said from when.
   pure function statistics_from(self) result(from)
      class(passage_times_t), intent(in) :: self
      real(wp) :: from

      from = self%counts_from
      if (.not. self%is_given) from = max(from, self%arrival)
      from = from - rounding*self%end_time
   end function statistics_from

   !> Whether the quantities at `time` are those to compare with.
   pure elemental function is_earlier(self, time)
      class(passage_times_t), intent(in) :: self
      real(wp), intent(in) :: time
      logical :: is_earlier

      is_earlier = self%period > 0.0_wp .and. time >= self%earlier_from - rounding*self%end_time &
         .and. time <= self%counts_from + rounding*self%end_time
   end function is_earlier

   !> Whether the start is forgotten where the times begin that count; of a given beginning nothing
   !> is asked.
   pure function is_settled(self)
      class(passage_times_t), intent(in) :: self
      logical :: is_settled

      is_settled = self%is_given .or. .not. self%is_artificial &
         .or. self%end_time >= self%needed_end*(1 - rounding)
   end function is_settled

   !> The times of a contact whose features are placed.
   pure function new_passage_times(contact, time) result(times)
      type(line_contact_t), intent(in) :: contact
      type(time_settings_t), intent(in) :: time
      type(passage_times_t) :: times
      type(zone_t) :: zone
      real(wp) :: window
      logical :: is_periodic

      times%end_time = time%end_time
      if (.not. time%is_transient) return
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
      is_periodic = is_repeating(contact%surface_1) .and. is_repeating(contact%surface_2)
      if (.not. is_periodic) times%period = 0.0_wp
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

   !> Whether a surface is artificial at T = 0, and until when; when its waves fill the contact.
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

   !> How much later than from T = 0 on the film is made of a whole wave, where that rises behind a
   !> front or with time.
   pure function entering_time(surface, zone) result(time)
      type(rough_surface_t), intent(in) :: surface
      type(zone_t), intent(in) :: zone
      real(wp) :: time

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

   !> Whether a surface is at rest, or nothing of it moves but waves.
   pure function is_repeating(surface)
      type(rough_surface_t), intent(in) :: surface
      logical :: is_repeating

      is_repeating = .true.
      if (.not. is_moving(surface)) return
      is_repeating = .not. allocated(surface%profile)
      if (allocated(surface%features)) is_repeating = is_repeating &
         .and. .not. any(is_ridge(surface%features))
   end function is_repeating

   !> Time in which each wave of a moving surface goes on by its length.
   pure function periods_of(surface) result(periods)
      type(rough_surface_t), intent(in) :: surface
      real(wp), allocatable :: periods(:)

      allocate (periods(0))
      if (is_moving(surface) .and. allocated(surface%features)) periods = &
         pack(surface%features%wavelength, &
         is_wave(surface%features))/abs(surface%speed)
   end function periods_of

   !> The shortest time in which all waves repeat themselves, about; 0 without waves.
   pure function common_period(periods) result(period)
      real(wp), intent(in) :: periods(:)
      real(wp) :: period
      integer :: i

      period = 0.0_wp
      if (size(periods) == 0) return
      do i = 1, max_periods
         period = i*maxval(periods)
         if (all(abs(period/periods - anint(period/periods)) <= same_phase)) return
      end do
   end function common_period

   !> Puts the features of moving surfaces that have no place just in front of the contact, on the
   !> side they come from; where something else has to settle first, so far that they enter after
   !> it.
   pure subroutine place_features(contact)
      type(line_contact_t), intent(inout) :: contact
      type(passage_times_t) :: times
      type(zone_t) :: zone

      zone = zone_of(contact)
      call settle_surface(contact%surface_1, zone, times)
      call settle_surface(contact%surface_2, zone, times)
      call place_on(contact%surface_1)
      call place_on(contact%surface_2)

   contains

      !> The features of one surface; a sinusoid has a crest at X = 0.
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
               distance = 1 + entry*zone%width + abs(surface%speed)*times%settled_from
               if (surface%entry_length > 0.0_wp) distance = max(distance, &
                  abs(surface%entry_position) + surface%entry_length)
               feature%position = sign(distance + half_ridge*feature%wavelength, -surface%speed)
            end associate
         end do
      end subroutine place_on

   end subroutine place_features

   !> What should be known about the times: quantities that have the start in them, a passage that
   !> is not whole; empty: nothing.
   pure function passage_note(contact, times) result(note)
      type(line_contact_t), intent(in) :: contact
      type(passage_times_t), intent(in) :: times
      character(:), allocatable :: note
      real(wp) :: left

      note = ''
      if (.not. times%settled_from > 0.0_wp) then
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
         note = note//'; end_time = '//rounded_up(times%needed_end, 3)//' or more is needed'
      else
         note = uncounted_passage(contact, times%settled_from)
      end if
      left = max(last_passage(contact%surface_1), last_passage(contact%surface_2))
      if (left > times%end_time*(1 + rounding)) call add_sentence(note, &
         'a feature is still in the contact or in front of it at the end: end_time = ' &
         //rounded_up(left, 3)//' or more is needed')
   end function passage_note

   !> What should be known of features that pass before the quantities count, `from` then on.
   pure function uncounted_passage(contact, from) result(note)
      type(line_contact_t), intent(in) :: contact
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

      !> When the first feature of a surface reaches the contact; huge where it is at rest.
      pure function own_passage(surface) result(time)
         type(rough_surface_t), intent(in) :: surface
         real(wp) :: time

         time = huge(time)
         if (is_moving(surface)) time = max(first_passage(surface, zone_of(contact)), &
            front_arrival(surface, zone_of(contact)))
      end function own_passage

   end function uncounted_passage

end module passage_times

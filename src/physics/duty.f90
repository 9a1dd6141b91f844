!> What a contact does over time: its load, radius and speeds, relative to a reference state.
module duty
   use kinds, only: wp
   use time_table, only: time_table_t
   implicit none (type, external)
   private

   public :: duty_rows_t, duty_t, is_reference, moment_t, span_of

   !> Columns of a table in SI.
   integer, parameter, public :: of_time = 1, of_angle = 2, of_load = 3, of_radius = 4, &
      of_speeds(2) = [5, 6]

   !> A table in SI.
   type :: duty_rows_t
      !> Columns (rows, 6) by the constants above: time [s], angle [deg], w [N/m], R [m], u_1 and
      !> u_2 [m/s]; which of them the table has.
      real(wp), allocatable :: values(:, :)
      logical :: has(6) = .false.
      !> Straight lines between the rows, or monotone cubics; whether it is repeated.
      logical :: is_linear = .true., is_periodic = .false.
      !> Checksum of its numbers.
      character(:), allocatable :: digits
   end type duty_rows_t

   !> The contact at one time: w/w_ref, R/R_ref, and (u_1, u_2)/u_ref with u_ref the reference of
   !> u_1 + u_2.
   type :: moment_t
      real(wp) :: load = 1.0_wp, radius = 1.0_wp, speeds(2) = 0.5_wp
   end type moment_t

   !> The same over T = t u_ref/(2 b_ref).
   type :: duty_t
      type(time_table_t) :: load, radius, speeds(2)
   contains
      procedure :: at, always_moves, kinks, rolls, samples
   end type duty_t

contains

   !> Whether a moment has load, radius and sum of speeds of the reference state.
   pure logical function is_reference(moment)
      type(moment_t), intent(in) :: moment

      is_reference = .not. any(abs([moment%load, moment%radius, sum(moment%speeds)] - 1) > 0.0_wp)
   end function is_reference

   !> The moment at `time`.
   pure function at(self, time) result(moment)
      class(duty_t), intent(in) :: self
      real(wp), intent(in) :: time
      type(moment_t) :: moment

      moment = moment_t(self%load%value(time), self%radius%value(time), &
         [self%speeds(1)%value(time), self%speeds(2)%value(time)])
   end function at

   !> Times between `from` and `to`, rising, at which something changes its slope.
   pure function kinks(self, from, to) result(times)
      class(duty_t), intent(in) :: self
      real(wp), intent(in) :: from, to
      real(wp), allocatable :: times(:)
      real(wp), allocatable :: all(:)
      real(wp) :: next

      all = [self%load%kinks(from, to), self%radius%kinks(from, to), &
         self%speeds(1)%kinks(from, to), self%speeds(2)%kinks(from, to)]
      allocate (times(0))
      next = from
      do while (any(all > next))
         next = minval(all, all > next)
         times = [times, next]
      end do
   end function kinks

   !> Whether u1 + u2 has the same sign in all rows, and there more than a `share` of its reference.
   pure logical function always_moves(self, share)
      class(duty_t), intent(in) :: self
      real(wp), intent(in) :: share

      associate (sum => self%speeds(1)%values + self%speeds(2)%values)
         always_moves = all(sum*sign(1.0_wp, sum(1)) > share)
      end associate
   end function always_moves

   !> Whether both surfaces move to +x in all rows.
   pure logical function rolls(self)
      class(duty_t), intent(in) :: self

      rolls = all(min(self%speeds(1)%values, self%speeds(2)%values) > 0.0_wp)
   end function rolls

   !> Time from its first to its last row.
   pure real(wp) function span_of(duty) result(span)
      type(duty_t), intent(in) :: duty

      span = duty%load%times(size(duty%load%times)) - duty%load%times(1)
   end function span_of

   !> At most `most` rows of the table, evenly picked, the first and the last among them.
   pure function samples(self, most) result(times)
      class(duty_t), intent(in) :: self
      integer, intent(in) :: most
      real(wp), allocatable :: times(:)
      integer :: count, i

      associate (n => size(self%load%times))
         count = min(n, most)
         times = self%load%times([(1 + nint(real(n - 1, wp)*i/(count - 1)), i=0, count - 1)])
      end associate
   end function samples

end module duty

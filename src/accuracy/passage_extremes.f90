!> Extremes of the quantities of a transient over the times that count, gathered step by step, and
!> their distance from periodicity.
module passage_extremes
   use kinds, only: not_known, wp
   use line_summary, only: keep_extremes, line_summary_t
   use passage_times, only: passage_times_t
   implicit none (type, external)
   private

   public :: passage_extremes_t

   !> Extremes so far.
   type :: passage_extremes_t
      type(passage_times_t) :: times
      !> Over the times that count, and over the period before them; known if the logicals say so.
      type(line_summary_t) :: counted, earlier
      logical :: has_counted = .false., has_earlier = .false.
   contains
      procedure :: add, extremes
   end type passage_extremes_t

contains

   !> Adds the quantities of one time; the last one always counts. At the end of a run that goes on
   !> the next cycle begins.
   pure subroutine add(self, summary, time, is_last)
      class(passage_extremes_t), intent(inout) :: self
      type(line_summary_t), intent(in) :: summary
      real(wp), intent(in) :: time
      logical, intent(in) :: is_last
      type(passage_times_t) :: longer

      if (self%times%is_earlier(time)) call widen(self%earlier, self%has_earlier, summary)
      if (is_last .or. self%times%counts(time)) call widen(self%counted, self%has_counted, summary)
      longer = self%times%lengthened()
      if (is_last .or. .not. longer%counts(time)) return
      self%times = longer
      self%earlier = self%counted
      self%has_earlier = .true.
      self%has_counted = .false.
      call widen(self%counted, self%has_counted, summary)
   end subroutine add

   !> Widens extremes by the quantities of another time, or begins with them.
   pure subroutine widen(extremes, is_known, summary)
      type(line_summary_t), intent(inout) :: extremes
      logical, intent(inout) :: is_known
      type(line_summary_t), intent(in) :: summary

      if (.not. is_known) extremes = summary
      call keep_extremes(extremes, summary)
      is_known = .true.
   end subroutine widen

   !> The extremes; those of the `last` state for a run that ended before anything counts.
   pure function extremes(self, last) result(summary)
      class(passage_extremes_t), intent(in) :: self
      type(line_summary_t), intent(in) :: last
      type(line_summary_t) :: summary

      summary = last
      if (self%has_counted) summary = self%counted
      if (self%has_earlier .and. self%has_counted) summary%of%error_start = abs( &
         summary%of%value - self%earlier%of%value)
      if (.not. self%times%is_settled()) summary%of%error_start = not_known()   ! the start counts
   end function extremes

end module passage_extremes

!> Measured influence of an inlet with a tail or close to the contact: quantities on a coarser grid
!> of the same domain and, at the same spacing, on a longer domain.
!>
!> The remainder beyond the tail (module inlet_tail) falls with the fourth power of its distance, so
!> that the longer domain is as good as infinite, and the change is that on the grid of the result
!> (40 contacts, M 0.1-30, L 0-40, mostly Eyring: on a quarter of the intervals 0.8 to 1.1 times it,
!> except where it passes through zero). A pressure spike, which jumps with the position of the
!> nodes, is not compared: the largest pressure is that next to it.
module inlet_change
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use line_summary, only: line_summary_t, value_between
   use missing_value, only: quotient
   use quantities, only: h_central, quantity_count, quantity_rows, rule_crest
   implicit none (type, external)
   private

   public :: change_by_inlet, film_loss, inlet_change_t

   !> An estimate is this many times the change plus this share of the largest change, since a
   !> single one may be small by chance.
   real(wp), parameter :: safety = 1.1_wp, doubt = 0.15_wp

   !> Fields whose quantities may be unknown or 0 in a solution.
   character(len=*), parameter :: may_be_unknown(3) = [character(len=20) :: 'x', &
      'friction_coefficient', 'power']

   !> Quantities on the same and on the longer domain.
   type :: inlet_change_t
      logical :: is_known = .false.
      type(line_summary_t) :: near, far
   end type inlet_change_t

contains

   !> Estimated errors of all quantities by the inlet: relative; of positions in units of b.
   pure function change_by_inlet(self) result(errors)
      type(inlet_change_t), intent(in) :: self
      real(wp) :: errors(quantity_count)

      errors = abs(changes(self))
      errors = safety*errors + doubt*maxval(errors, quantity_rows%field == 'film_thickness')
      where (quantity_rows%field == 'pressure') errors = errors*(1 + doubt)
   end function change_by_inlet

   !> Share of the central film lost by starvation; 0 if the inlet thickens it.
   pure real(wp) function film_loss(self) result(loss)
      type(inlet_change_t), intent(in) :: self

      loss = max(1 - quotient(value_between(self%near, h_central), value_between(self%far, &
         h_central)), 0.0_wp)
   end function film_loss

   !> Changes relative to the value on the same domain; 0 for positions or forces that are not
   !> known.
   pure function changes(self)
      type(inlet_change_t), intent(in) :: self
      real(wp) :: changes(quantity_count)
      real(wp) :: near, far
      integer :: i

      do i = 1, quantity_count
         near = compared_value(self, self%near, i)
         far = compared_value(self, self%far, i)
         if (quantity_rows(i)%field == 'x') then
            changes(i) = near - far
         else
            changes(i) = 1 - quotient(far, near)
         end if
         if (any(quantity_rows(i)%field == may_be_unknown)) changes(i) = merge(changes(i), &
            0.0_wp, ieee_is_finite(changes(i)))
      end do
   end function changes

   !> The compared value of row `i` of a `summary`: that between nodes; of crests the one next to a
   !> spike, if both have one.
   pure real(wp) function compared_value(self, summary, i) result(value)
      type(inlet_change_t), intent(in) :: self
      type(line_summary_t), intent(in) :: summary
      integer, intent(in) :: i

      value = value_between(summary, i)
      if (quantity_rows(i)%rule /= rule_crest) return
      if (all(ieee_is_finite([self%near%crests%spike, self%far%crests%spike, &
         self%near%crests%other, self%far%crests%other]))) value = summary%crests%other
   end function compared_value

end module inlet_change

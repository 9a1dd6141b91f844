!> What an inlet changes that has a tail in front of it or lies near the contact: quantities of the
!> same contact on a coarser grid of the same domain, and on a longer one at the same spacing.
!>
!> What the tail leaves out (module inlet_tail) falls with the fourth power of its distance, so that
!> the longer domain is as good as endless, and the change is that on the answer's own grid (40
!> contacts, M 0.1-30, L 0-40, mostly Eyring: on a quarter of the intervals 0.8 to 1.1 times it, but
!> where it passes through zero). Of a pressure spike, which jumps with the place of the nodes,
!> nothing is compared: the largest pressure is that beside it.
module inlet_change
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use line_summary, only: line_summary_t, value_between
   use missing_value, only: quotient
   use quantities, only: h_central, quantity_count, quantity_rows, rule_crest
   implicit none (type, external)
   private

   public :: change_by_inlet, film_loss, inlet_change_t

   !> An estimate is this many times the change, and this share of the largest one: a quantity may
   !> change little by chance.
   real(wp), parameter :: safety = 1.1_wp, doubt = 0.15_wp

   !> Fields whose quantities may be not known, or 0, in a solution.
   character(len=*), parameter :: may_be_unknown(3) = [character(len=20) :: 'x', &
      'friction_coefficient', 'power']

   !> Those of the same domain and of the longer one.
   type :: inlet_change_t
      logical :: is_known = .false.
      type(line_summary_t) :: near, far
   end type inlet_change_t

contains

   !> Estimated errors of all quantities because of the inlet: relative, of positions in units of b.
   pure function change_by_inlet(self) result(errors)
      type(inlet_change_t), intent(in) :: self
      real(wp) :: errors(quantity_count)

      errors = abs(changes(self))
      errors = safety*errors + doubt*maxval(errors, quantity_rows%field == 'film_thickness')
      where (quantity_rows%field == 'pressure') errors = errors*(1 + doubt)
   end function change_by_inlet

   !> Share of the central film that the inlet starves it of; 0 if it thickens it.
   pure function film_loss(self) result(loss)
      type(inlet_change_t), intent(in) :: self
      real(wp) :: loss

      loss = max(1 - quotient(value_between(self%near, h_central), value_between(self%far, &
         h_central)), 0.0_wp)
   end function film_loss

   !> The changes themselves, in parts of the value of the same domain; 0 where it is not known of a
   !> position, or of forces.
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

   !> What is compared of row `i` of a `summary`, one of both: the value between the nodes, of
   !> crests that beside a spike, where both have one.
   pure function compared_value(self, summary, i) result(value)
      type(inlet_change_t), intent(in) :: self
      type(line_summary_t), intent(in) :: summary
      integer, intent(in) :: i
      real(wp) :: value

      value = value_between(summary, i)
      if (quantity_rows(i)%rule /= rule_crest) return
      if (all(ieee_is_finite([self%near%crests%spike, self%far%crests%spike, &
         self%near%crests%other, self%far%crests%other]))) value = summary%crests%other
   end function compared_value

end module inlet_change

!> What an inlet with a tail in front of it changes: figures of the same contact on a coarser grid
!> of the same domain, and on one twice as long at the same spacing.
!>
!> What the tail leaves out (module inlet_tail) falls with the fourth power of its distance, so that
!> the longer domain is as good as endless, and the change is that on the answer's own grid (40
!> contacts, M 0.1-30, L 0-40, mostly Eyring: on a quarter of the intervals 0.8 to 1.1 times it, but
!> where it passes through zero). Of a pressure spike, which jumps with the place of the nodes,
!> nothing is compared: the largest pressure is that beside it.
module inlet_change
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use line_summary, only: crests_t, line_summary_t
   implicit none (type, external)
   private

   public :: change_by_inlet, inlet_change_t

   !> An estimate is so many times the change, and this share of the largest one: a figure may
   !> change little by chance.
   real(wp), parameter :: safety = 1.1_wp, doubt = 0.15_wp

   !> Figures of the same domain and of the longer one.
   type :: inlet_change_t
      logical :: is_known = .false.
      type(line_summary_t) :: near, far
   end type inlet_change_t

contains

   !> Estimated errors because of the inlet: of h_min and h_central, relative, of p_max, relative,
   !> and of the exit [b].
   pure function change_by_inlet(self) result(errors)
      type(inlet_change_t), intent(in) :: self
      real(wp) :: errors(4)

      associate (near => self%near, far => self%far)
         errors(1) = near%h_min%value/far%h_min%value - 1
         errors(2) = near%h_central%value/far%h_central%value - 1
         errors(3) = crest_beside(near%crests)/crest_beside(far%crests) - 1
         errors(4) = near%x_cavitation%extrapolated - far%x_cavitation%extrapolated
      end associate
      errors = abs(errors)
      if (.not. ieee_is_finite(errors(4))) errors(4) = 0.0_wp
      errors = safety*errors + doubt*maxval(errors(:2))
      errors(3) = errors(3)*(1 + doubt)
   end function change_by_inlet

   !> The largest pressure beside a spike.
   pure function crest_beside(crests) result(pressure)
      type(crests_t), intent(in) :: crests
      real(wp) :: pressure

      pressure = crests%highest
      if (ieee_is_finite(crests%other)) pressure = crests%other
   end function crest_beside

end module inlet_change

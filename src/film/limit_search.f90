!> Computes T_max and the largest slope of a film, see module line_state.
module limit_search
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use kinds, only: wp
   use lubricant, only: evaluate_stress_rise, fluid_t, fluid_viscosity
   use missing_value, only: not_known
   use line_state, only: reynolds_limits_t
   implicit none (type, external)
   private

   public :: film_limits

   !> Slopes count where the pressure exceeds this share of its largest value.
   real(wp), parameter :: loaded_share = 0.01_wp
   !> Nodes in a block.
   integer, parameter :: block_size = 16

contains

   !> Limits of the pressure `p` >= 0 and the film `h` > 0 on nodes `x` (nx), which
   !> rise, with `slide_to_roll` = (u2 - u1)/((u1 + u2)/2) (NaN: not known).
   pure function film_limits(fluid, lambda, slide_to_roll, x, p, h) result(limits)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: lambda, slide_to_roll
      real(wp), intent(in), contiguous :: x(:), p(:), h(:)
      type(reynolds_limits_t) :: limits
      real(wp) :: loaded
      integer :: i

      loaded = loaded_share*maxval(p)
      do i = 2, size(p)
         if (min(p(i - 1), p(i)) > loaded) limits%surface_slope = max(limits%surface_slope, &
            abs(h(i) - h(i - 1))/(x(i) - x(i - 1)))
      end do
      limits%stokes_number = not_known()
      if (ieee_is_finite(slide_to_roll)) limits%stokes_number = largest_rise(fluid, &
         lambda*slide_to_roll/12, p, h)
   end function film_limits

   !> Largest d tau/dp of the nodes. It grows with viscosity, its slope and 1/H, so that the
   !> extremes of p and H in a block of nodes bound it there, and few blocks need evaluation. (This
   !> is done in every time step.)
   pure real(wp) function largest_rise(fluid, couette, p, h) result(largest)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: p(:), h(:)
      real(wp), dimension((size(p) - 1)/block_size + 1) :: lowest, highest, thinnest, ln_mu, &
         slope, other_slope, bound
      integer :: b, first, last

      do b = 1, size(bound)
         first = (b - 1)*block_size + 1
         last = min(b*block_size, size(p))
         lowest(b) = minval(p(first:last))
         highest(b) = maxval(p(first:last))
         thinnest(b) = minval(h(first:last))
      end do
      call fluid_viscosity(fluid, lowest, ln_mu, other_slope)
      call fluid_viscosity(fluid, highest, ln_mu, slope)
      call evaluate_stress_rise(fluid, couette, thinnest, ln_mu, max(slope, other_slope), bound)
      largest = 0.0_wp
      do while (maxval(bound) > largest)
         b = maxloc(bound, 1)
         first = (b - 1)*block_size + 1
         last = min(b*block_size, size(p))
         largest = max(largest, rise_of(fluid, couette, p(first:last), h(first:last)))
         bound(b) = 0.0_wp
      end do
   end function largest_rise

   !> The same in one block.
   pure real(wp) function rise_of(fluid, couette, p, h) result(largest)
      type(fluid_t), intent(in) :: fluid
      real(wp), intent(in) :: couette
      real(wp), intent(in), contiguous :: p(:), h(:)
      real(wp), dimension(size(p)) :: ln_mu, slope, rise

      call fluid_viscosity(fluid, p, ln_mu, slope)
      call evaluate_stress_rise(fluid, couette, h, ln_mu, slope, rise)
      largest = maxval(rise)
   end function rise_of

end module limit_search
